//! The check of a scene's parameters.

use crate::error::ParameterError;

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
