//! [`Shading`]: how bright a bar is across its width.

use super::checked::check;
use crate::error::ParameterError;

/// How bright a bar is across its width.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Shading {
    /// Alike everywhere.
    Flat,
    /// As a dull cylinder in light from one side: the cosine of the angle between its surface and the light, where that
    /// is positive. Its sides stay where the flat bar has them.
    Cylinder {
        /// Where the light comes from, in radians from the camera's side of the bar, −π to π; positive: from the right.
        light_rad: f32,
        /// Share of the light that comes from everywhere, 0 to 1.
        ambient: f32,
    },
}

impl Shading {
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        const PI: f32 = core::f32::consts::PI;
        match *self {
            Self::Flat => Ok(()),
            Self::Cylinder { light_rad, ambient } => check([
                ("light_rad", light_rad, [-PI, PI], "-pi to pi (rad)"),
                ("ambient", ambient, [0.0, 1.0], "0 to 1"),
            ]),
        }
    }

    /// Brightness at the left and at the right limb, as a share of the bar's level.
    pub(super) fn at_limbs(&self) -> [f32; 2] {
        self.cylinder().map_or([1.0; 2], |cylinder| [-1.0, 1.0].map(|side| cylinder.limb(side)))
    }

    pub(super) fn cylinder(&self) -> Option<Cylinder> {
        match *self {
            Self::Flat => None,
            Self::Cylinder { light_rad, ambient } => {
                Some(Cylinder { sine: libm::sinf(light_rad), cosine: libm::cosf(light_rad), ambient })
            }
        }
    }
}

/// The brightness of a cylinder over x, −1 at the left limb to 1 at the right one: `max(0, x sin φ + √(1 − x²) cos φ)`.
#[derive(Clone, Copy)]
pub(super) struct Cylinder {
    sine: f32,
    cosine: f32,
    ambient: f32,
}

impl Cylinder {
    /// Mean over a stretch of x, above zero wide. Beyond the limbs it goes on as bright as they are.
    pub(super) fn mean(&self, from: f32, to: f32) -> f32 {
        let lit = (self.integral(to) - self.integral(from)) / (to - from);
        self.ambient + (1.0 - self.ambient) * lit.clamp(0.0, 1.0)
    }

    fn limb(&self, side: f32) -> f32 {
        self.ambient + (1.0 - self.ambient) * self.lit_limb(side)
    }

    fn lit_limb(&self, side: f32) -> f32 {
        (side * self.sine).max(0.0)
    }

    /// Integral of the lit part.
    fn integral(&self, x: f32) -> f32 {
        let inside = x.clamp(-1.0, 1.0);
        let beyond = (x - 1.0).max(0.0) * self.lit_limb(1.0) + (x + 1.0).min(0.0) * self.lit_limb(-1.0);
        // Lit is what lies on the light's side of the terminator.
        let lit = if self.sine < 0.0 { inside.min(self.cosine) } else { inside.max(-self.cosine) };
        let half_moon = lit * libm::sqrtf((1.0 - lit * lit).max(0.0)) + libm::asinf(lit);
        0.5 * (self.sine * lit * lit + self.cosine * half_moon) + beyond
    }
}

#[cfg(test)]
mod tests {
    use super::Shading;

    /// Against sums of the cosine.
    #[test]
    fn means_against_sums() {
        for degrees in [-170.0_f32, -90.0, -75.0, 0.0, 30.0, 75.0, 90.0, 120.0, 180.0] {
            let light_rad = degrees.to_radians();
            let cylinder = Shading::Cylinder { light_rad, ambient: 0.1 }.cylinder().expect("a cylinder");
            let shade = |x: f32| {
                let inside = x.clamp(-1.0, 1.0);
                let facing = libm::sqrtf(1.0 - inside * inside);
                0.1 + 0.9 * (inside * libm::sinf(light_rad) + facing * libm::cosf(light_rad)).max(0.0)
            };
            for (from, to) in [(-1.3, -1.1), (-1.1, -0.8), (-0.5, 0.6), (0.9, 1.2), (-2.0, 2.0), (0.2, 0.21)] {
                let sum: f32 = (0..2000).map(|part| shade(from + (to - from) * (part as f32 + 0.5) / 2000.0)).sum();
                let (got, want) = (cylinder.mean(from, to), sum / 2000.0);
                assert!((got - want).abs() < 1e-3, "{degrees} degrees, {from} to {to}: {got} for {want}");
            }
        }
    }

    #[test]
    fn limbs() {
        let shading = Shading::Cylinder { light_rad: core::f32::consts::FRAC_PI_2, ambient: 0.2 };
        let [left, right] = shading.at_limbs();
        assert!((left - 0.2).abs() < 1e-6 && (right - 1.0).abs() < 1e-6, "{left}, {right}");
        assert_eq!(Shading::Flat.at_limbs(), [1.0; 2]);
    }
}
