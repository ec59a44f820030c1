//! [`Scene`]: what stands before the camera.

use core::mem;

use heapless::Vec;

use super::bar::Bar;
use super::checked::{DEPTH_M, FAR_M, GREY, check};
use super::texture::Texture;
use crate::error::ParameterError;

/// A horizontal bar of constant grey and infinite length, parallel to the first frame's image plane.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Rail {
    /// Depth z in metres, 0.01 to 10⁶.
    pub depth_m: f32,
    /// y of the upper edge at x = 0 in metres, −10⁶ to `bottom_m`; negative is above the camera.
    pub top_m: f32,
    /// y of the lower edge at x = 0 in metres, `top_m` to 10⁶.
    pub bottom_m: f32,
    /// Grey level, 0 to 255.
    pub level: f32,
}

impl Rail {
    fn check(&self) -> Result<(), ParameterError> {
        check([
            ("depth_m", self.depth_m, DEPTH_M, "0.01 to 1000000 (m)"),
            ("top_m", self.top_m, [-FAR_M, self.bottom_m], "-1000000 to bottom_m (m, downwards)"),
            ("bottom_m", self.bottom_m, [self.top_m, FAR_M], "top_m to 1000000 (m, downwards)"),
            ("level", self.level, GREY, "0 to 255"),
        ])
    }
}

/// An object of a [`Scene`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Object {
    /// An upright or leaning bar.
    Bar(Bar),
    /// A horizontal one.
    Rail(Rail),
}

impl Object {
    /// Depth in metres at the first frame's start.
    #[must_use]
    pub const fn depth_m(&self) -> f32 {
        match self {
            Self::Bar(bar) => bar.depth_m,
            Self::Rail(rail) => rail.depth_m,
        }
    }

    pub(super) const fn level(&self) -> f32 {
        match self {
            Self::Bar(bar) => bar.level,
            Self::Rail(rail) => rail.level,
        }
    }
}

impl From<Bar> for Object {
    fn from(bar: Bar) -> Self {
        Self::Bar(bar)
    }
}

impl From<Rail> for Object {
    fn from(rail: Rail) -> Self {
        Self::Rail(rail)
    }
}

/// What is seen where there is no object; infinitely far away.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Background {
    /// Grey level, 0 to 255.
    pub level: f32,
    /// Texture upon it.
    pub texture: Texture,
}

impl Background {
    /// One grey level, 0 to 255.
    #[must_use]
    pub const fn plain(level: f32) -> Self {
        Self { level, texture: Texture::NONE }
    }

    /// A grey level, 0 to 255, and a texture.
    #[must_use]
    pub const fn textured(level: f32, texture: Texture) -> Self {
        Self { level, texture }
    }
}

/// Up to `OBJECTS` bars and rails before a background, nearer ones before farther ones (by their depth at the first
/// frame's start, whatever comes later). 64 bytes for each object.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "RawScene<OBJECTS>"))]
pub struct Scene<const OBJECTS: usize> {
    background: Background,
    /// The farthest first.
    objects: Vec<Object, OBJECTS>,
}

impl<const OBJECTS: usize> Scene<OBJECTS> {
    /// An empty scene.
    ///
    /// *Errors*: a level outside 0 to 255; a texture with a contrast outside 0 to 255 or cells outside 10⁻⁴ to 10.
    pub fn new(background: Background) -> Result<Self, ParameterError> {
        let Texture { contrast, cell, .. } = background.texture;
        check([
            ("level", background.level, GREY, "0 to 255"),
            ("contrast", contrast, GREY, "0 to 255 (grey levels)"),
            ("cell", cell, [1e-4, 10.0], "0.0001 to 10 (bearing)"),
        ])?;
        Ok(Self { background, objects: Vec::new() })
    }

    /// Adds a bar or a rail. Where two are at the same depth, the one added later is in front.
    ///
    /// *Errors*: a field outside the limits that its documentation states; a scene that holds `OBJECTS` already.
    pub fn push(&mut self, object: impl Into<Object>) -> Result<(), ParameterError> {
        let mut object = object.into();
        match &object {
            Object::Bar(bar) => bar.check()?,
            Object::Rail(rail) => rail.check()?,
        }
        let full = ParameterError::new("objects", OBJECTS as f64, "fewer than the scene has room for");
        if self.objects.is_full() {
            return Err(full);
        }
        // Each nearer object moves up by one place.
        let mut placed = false;
        for slot in &mut self.objects {
            placed |= object.depth_m() > slot.depth_m();
            if placed {
                mem::swap(slot, &mut object);
            }
        }
        self.objects.push(object).map_err(|_| full)
    }

    /// The background as given.
    #[must_use]
    pub const fn background(&self) -> &Background {
        &self.background
    }

    /// The objects, the farthest first.
    #[must_use]
    pub fn objects(&self) -> &[Object] {
        &self.objects
    }
}

#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct RawScene<const OBJECTS: usize> {
    background: Background,
    objects: Vec<Object, OBJECTS>,
}

#[cfg(feature = "serde")]
impl<const OBJECTS: usize> TryFrom<RawScene<OBJECTS>> for Scene<OBJECTS> {
    type Error = ParameterError;

    fn try_from(raw: RawScene<OBJECTS>) -> Result<Self, ParameterError> {
        let mut scene = Self::new(raw.background)?;
        for object in raw.objects {
            scene.push(object)?;
        }
        Ok(scene)
    }
}
