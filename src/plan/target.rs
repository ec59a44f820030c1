//! [`Target`]: what is to be ranged.

use crate::error::ParameterError;
use crate::scalar::Scalar;

/// An upright post before a background: what its edges are to look like.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Target<S> {
    /// Where it stands at frame start: x/z, positive to the right, −10 to 10.
    pub bearing: S,
    /// Width in metres, above zero to 10⁴: a narrow one leaves few pixels that tell its brightness.
    pub width_m: S,
    /// Upper end in metres, downwards from the camera, −10⁴ to `bottom_m`.
    pub top_m: S,
    /// Lower end in metres, `top_m` to 10⁴.
    pub bottom_m: S,
    /// Brightness of the post in grey levels, 0 to 255.
    pub level: S,
    /// Brightness of what is behind it, 0 to 255.
    pub background: S,
}

impl<S: Scalar> Target<S> {
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        let far = S::from_i32(10_000);
        let white = S::from_i32(255);
        let limits = [
            ("bearing", self.bearing, -S::from_i32(10), S::from_i32(10), "-10 to 10 (x/z)"),
            ("width_m", self.width_m, S::ratio(1, 10_000), far, "0.0001 to 10000 (m)"),
            ("top_m", self.top_m, -far, self.bottom_m, "-10000 to bottom_m (m, downwards)"),
            ("bottom_m", self.bottom_m, self.top_m, far, "top_m to 10000 (m, downwards)"),
            ("level", self.level, S::ZERO, white, "0 to 255"),
            ("background", self.background, S::ZERO, white, "0 to 255"),
        ];
        for (name, value, least, most, expected) in limits {
            if !(value >= least && value <= most) {
                return Err(ParameterError::new(name, value.to_f64(), expected));
            }
        }
        Ok(())
    }

    /// Grey levels between post and background.
    pub(super) fn contrast(&self) -> S {
        (self.level - self.background).abs()
    }

    pub(super) fn mean_level(&self) -> S {
        (self.level + self.background) * S::ratio(1, 2)
    }
}

impl<S: Scalar> Default for Target<S> {
    /// A post straight ahead, 12 cm wide and 1 m high, half of it above the camera, 110 grey levels darker than what is
    /// behind it.
    fn default() -> Self {
        Self {
            bearing: S::ZERO,
            width_m: S::ratio(12, 100),
            top_m: -S::ratio(1, 2),
            bottom_m: S::ratio(1, 2),
            level: S::from_i32(60),
            background: S::from_i32(170),
        }
    }
}
