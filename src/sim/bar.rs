//! [`Bar`]: an upright or leaning bar, post or rod.

use super::checked::{DEPTH_M, FAR_M, GREY, check};
use super::contour::{Contour, Side};
use super::shading::Shading;
use super::view::Vector;
use crate::error::ParameterError;

/// A bar, upright or leaning; a thin one is a rod. It is straight and of constant grey unless its contour and its
/// shading say otherwise.
///
/// Its middle line passes through the point `(bearing · depth_m, 0, depth_m)` in the axes of the first frame's start
/// and follows gravity, or leans from it within the image plane. Both edges are at that depth.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Bar {
    /// x/z of the middle line, −100 to 100.
    pub bearing: f32,
    /// Depth z in metres, 0.01 to 10⁶.
    pub depth_m: f32,
    /// Width from the left to the right edge in metres, above zero to 10⁶.
    pub width_m: f32,
    /// Upper end in metres along the bar, counted downwards from the camera's y = 0, −10⁶ to `bottom_m`.
    pub top_m: f32,
    /// Lower end in metres, counted alike, `top_m` to 10⁶.
    pub bottom_m: f32,
    /// Lean in the image plane as a slope, −10 to 10; positive: the column grows with the row. Zero is upright.
    pub lean: f32,
    /// Grey level, 0 to 255; of a shaded bar where it faces the light.
    pub level: f32,
    /// How its edges depart from straight parallel lines.
    #[cfg_attr(feature = "serde", serde(default = "straight"))]
    pub contour: Contour,
    /// How bright it is across its width.
    #[cfg_attr(feature = "serde", serde(default = "flat"))]
    pub shading: Shading,
}

#[cfg(feature = "serde")]
const fn straight() -> Contour {
    Contour::STRAIGHT
}

#[cfg(feature = "serde")]
const fn flat() -> Shading {
    Shading::Flat
}

impl Bar {
    /// An upright bar that crosses the whole image: from 1 km above the camera to 1 km below it.
    #[must_use]
    pub const fn upright(bearing: f32, depth_m: f32, width_m: f32, level: f32) -> Self {
        let (contour, shading) = (Contour::STRAIGHT, Shading::Flat);
        Self { bearing, depth_m, width_m, top_m: -1000.0, bottom_m: 1000.0, lean: 0.0, level, contour, shading }
    }

    /// The same with ends, in metres downwards from the camera's y = 0.
    #[must_use]
    pub const fn between(self, top_m: f32, bottom_m: f32) -> Self {
        Self { top_m, bottom_m, ..self }
    }

    /// The same, leaning by a slope.
    #[must_use]
    pub const fn leaning(self, lean: f32) -> Self {
        Self { lean, ..self }
    }

    /// The same with sides that lean outwards by a slope, downwards along the bar: see [`Contour::taper`]. Give it ends
    /// before its sides meet.
    #[must_use]
    pub const fn tapered(self, taper: f32) -> Self {
        Self { contour: Contour { taper, ..self.contour }, ..self }
    }

    /// The same, bowed between its ends, which it must have: see [`Contour::bow_m`].
    #[must_use]
    pub const fn bowed(self, bow_m: f32) -> Self {
        Self { contour: Contour { bow_m, ..self.contour }, ..self }
    }

    /// The same with edges that wander by a sigma, alike over a length, both in metres: see [`Contour::roughness_m`].
    #[must_use]
    pub const fn rough(self, roughness_m: f32, roughness_length_m: f32, seed: u32) -> Self {
        Self { contour: Contour { roughness_m, roughness_length_m, seed, ..self.contour }, ..self }
    }

    /// The same as a cylinder in light from one side: see [`Shading::Cylinder`].
    #[must_use]
    pub const fn lit_from(self, light_rad: f32, ambient: f32) -> Self {
        Self { shading: Shading::Cylinder { light_rad, ambient }, ..self }
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        check([
            ("bearing", self.bearing, [-100.0, 100.0], "-100 to 100"),
            ("depth_m", self.depth_m, DEPTH_M, "0.01 to 1000000 (m)"),
            ("width_m", self.width_m, [f32::MIN_POSITIVE, FAR_M], "above zero to 1000000 (m)"),
            ("top_m", self.top_m, [-FAR_M, self.bottom_m], "-1000000 to bottom_m (m, downwards)"),
            ("bottom_m", self.bottom_m, [self.top_m, FAR_M], "top_m to 1000000 (m, downwards)"),
            ("lean", self.lean, [-10.0, 10.0], "-10 to 10 (slope)"),
            ("level", self.level, GREY, "0 to 255"),
        ])?;
        self.contour.check()?;
        self.shading.check()
    }

    pub(super) fn ends_m(&self) -> [f64; 2] {
        [self.top_m, self.bottom_m].map(f64::from)
    }

    /// Lean of one edge, its taper included.
    pub(super) fn lean_of(&self, side: Side) -> f64 {
        f64::from(self.lean) + side.sign() * f64::from(self.contour.taper)
    }

    /// The straight line of one edge, from which its contour departs along `across`.
    pub(super) fn edge_in_space(&self, side: Side, gravity: Vector) -> EdgeInSpace {
        let [gx, gy, gz] = gravity;
        let [across, down] = level_in_image(gravity);
        let lean = self.lean_of(side);
        let depth = f64::from(self.depth_m);
        let middle = f64::from(self.bearing) * depth;
        EdgeInSpace {
            foot_m: [middle + side.sign() * 0.5 * f64::from(self.width_m), 0.0, depth],
            along: [gx + lean * across, gy + lean * down, gz],
            across: [across, down, 0.0],
        }
    }
}

/// An edge at the first frame's start: its points are `foot_m + λ along`, λ in metres downwards.
#[derive(Clone, Copy)]
pub(super) struct EdgeInSpace {
    pub(super) foot_m: Vector,
    pub(super) along: Vector,
    pub(super) across: Vector,
}

/// The horizontal direction in the image plane; it points to the right for a level camera.
pub(super) fn level_in_image([gx, gy, _]: Vector) -> [f64; 2] {
    let length = libm::sqrt(gx * gx + gy * gy);
    if length > 0.0 { [gy / length, -gx / length] } else { [1.0, 0.0] }
}
