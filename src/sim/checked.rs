//! The check of a scene's parameters, and the limits that several of them share.

use crate::error::ParameterError;

/// What is farther than this, in metres, is nowhere.
pub(super) const FAR_M: f32 = 1e6;
pub(super) const DEPTH_M: [f32; 2] = [0.01, FAR_M];
pub(super) const GREY: [f32; 2] = [0.0, 255.0];

/// Refuses the first of the parameters that is not finite or not within its limits.
pub(super) fn check<const N: usize>(
    parameters: [(&'static str, f32, [f32; 2], &'static str); N],
) -> Result<(), ParameterError> {
    for (name, value, [least, most], expected) in parameters {
        if !(value >= least && value <= most) {
            return Err(ParameterError::new(name, f64::from(value), expected));
        }
    }
    Ok(())
}
