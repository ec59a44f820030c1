//! [`Texture`]: smooth random grey on the background.

/// Value noise: random levels on a square grid of bearings (x/z and y/z at the first frame's start), with smooth
/// interpolation between them. It is infinitely far away, so only the camera's rotation moves it. It is sampled in the
/// middle of the row's exposure and not blurred: keep cells several pixels large.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Texture {
    /// Largest deviation from the background's level in grey levels, 0 to 255.
    pub contrast: f32,
    /// Size of a grid cell as a bearing, 10⁻⁴ to 10; times the focal length it is in pixels.
    pub cell: f32,
    /// Selects the pattern; independent of the seed of the noise.
    pub seed: u32,
}

impl Texture {
    /// No texture.
    pub const NONE: Self = Self { contrast: 0.0, cell: 1.0, seed: 0 };
}
