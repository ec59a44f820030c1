//! [`Simulator`]: from a scene, a camera and its motion to rows of pixels.

use heapless::Vec;

use super::checked::check;
use super::encoding::RowEncoder;
use super::exposure::Exposure;
use super::flicker::Flicker;
use super::layer::{Layer, RowView, Softness};
use super::noise::RowNoise;
use super::random::{hash, mix};
use super::row_texture::RowTexture;
use super::scene::Scene;
use super::swing::Swing;
use super::tint::Tint;
use super::view::{Lens, Vector, View};
use crate::error::ParameterError;
use crate::format::PixelFormat;
use crate::motion::{Motion, Twist};
use crate::setup::{Camera, Distortion, Readout};

/// Yields the pixel rows that a rolling-shutter camera would record of a [`Scene`].
///
/// The motion continues without end: [`Simulator::at_frame`] gives any later frame. All random numbers depend on
/// nothing but seed, frame, row and column, so rows can be rendered in any order and any number of times.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Simulator<'a, const OBJECTS: usize> {
    scene: &'a Scene<OBJECTS>,
    lens: Lens,
    columns: u16,
    readout: Readout,
    velocity_m_s: Vector,
    rate_rad_s: Vector,
    gravity: Vector,
    exposure: Exposure,
    softness: Option<Softness>,
    flicker: Option<Flicker>,
    swing: Option<Swing>,
    tint: Tint,
    seed: u64,
    frame: u32,
    start_ns: i64,
}

impl<'a, const OBJECTS: usize> Simulator<'a, OBJECTS> {
    /// A simulator at frame 0, which starts at time zero. `motion` and the objects of the scene are in the axes of its
    /// start.
    ///
    /// *Errors*: a camera with distortion, which is not simulated; a readout with another number of rows than the
    /// camera; an exposure outside the limits of its fields.
    pub fn new(
        scene: &'a Scene<OBJECTS>,
        camera: &Camera<f32>,
        readout: &Readout,
        motion: &Twist<f32>,
        exposure: Exposure,
        seed: u64,
    ) -> Result<Self, ParameterError> {
        if *camera.distortion() != Distortion::NONE {
            let largest = camera
                .distortion()
                .to_opencv()
                .into_iter()
                .fold(0.0, |a: f32, b| if b.abs() > a.abs() { b } else { a });
            return Err(ParameterError::new(
                "distortion",
                f64::from(largest),
                "none: the simulator has no lens but a pinhole",
            ));
        }
        let intrinsics = camera.intrinsics();
        if readout.rows() != intrinsics.rows {
            let expected = "the number of rows of the camera's image";
            return Err(ParameterError::new("rows of the readout", f64::from(readout.rows()), expected));
        }
        exposure.check()?;
        Ok(Self {
            scene,
            lens: Lens::new(intrinsics),
            columns: intrinsics.columns,
            readout: *readout,
            velocity_m_s: motion.velocity_m_s().map(f64::from),
            rate_rad_s: motion.rate_rad_s().map(f64::from),
            gravity: motion.gravity().map(f64::from),
            exposure,
            softness: None,
            flicker: None,
            swing: None,
            tint: Tint::NEUTRAL,
            seed,
            frame: 0,
            start_ns: 0,
        })
    }

    /// The same at another frame: `frame` is its number, which selects the noise and nothing else, and `start_ns` the
    /// time of its start (the middle of the exposure of the row read first) in nanoseconds since the start of frame 0.
    #[must_use]
    pub const fn at_frame(self, frame: u32, start_ns: i64) -> Self {
        Self { frame, start_ns, ..self }
    }

    /// The same with a lens that is softer (or sharper) towards the corners: its blur at the image's farthest corner,
    /// one sigma in pixels, 0 to 20. In between its square grows with the square of the distance from the principal
    /// point. It shows on the edges of bars, not on rails and ends.
    ///
    /// *Errors*: a blur outside these limits.
    pub fn with_corner_blur(self, psf_sigma_px: f32) -> Result<Self, ParameterError> {
        check([("psf_sigma_px", psf_sigma_px, [0.0, 20.0], "0 to 20 (px)")])?;
        let (cx, cy) = self.lens.principal_point();
        let farther = |centre: f64, size: u16| centre.abs().max((f64::from(size) - 1.0 - centre).abs()) as f32;
        let (x, y) = (farther(cx, self.columns), farther(cy, self.rows()));
        let grown = psf_sigma_px * psf_sigma_px - self.exposure.psf_sigma_px * self.exposure.psf_sigma_px;
        let variance_per_px2 = grown / (x * x + y * y).max(1.0);
        let softness = Softness { centre: [cx as f32, cy as f32], variance_per_px2 };
        Ok(Self { softness: Some(softness), ..self })
    }

    /// The same in light that flickers, in time with the start of frame 0.
    ///
    /// *Errors*: a frequency, depth or duty outside the limits of its fields.
    pub fn with_flicker(self, flicker: Flicker) -> Result<Self, ParameterError> {
        flicker.check()?;
        Ok(Self { flicker: Some(flicker), ..self })
    }

    /// The same with a camera that also turns back and forth.
    ///
    /// *Errors*: an angle or a frequency outside the limits of its field.
    pub fn with_swing(self, swing: Swing) -> Result<Self, ParameterError> {
        swing.check()?;
        Ok(Self { swing: Some(swing), ..self })
    }

    /// The same with colours, which a mosaic shows ([`Simulator::row_in`]).
    ///
    /// *Errors*: an offset or a gain outside the limits of its field.
    pub fn with_tint(self, tint: Tint) -> Result<Self, ParameterError> {
        tint.check()?;
        Ok(Self { tint, ..self })
    }

    /// The camera's motion in the axes of *this* frame's start, as a range finder needs it; in frame 0 it is as given.
    ///
    /// *Errors*: a component of an extreme velocity that rotation has driven beyond the limit of [`Twist`].
    pub fn motion(&self) -> Result<Twist<f32>, ParameterError> {
        let view = self.view(0.0);
        let gravity = view.in_camera(self.gravity);
        let swing = self.swing.map_or(0.0, |swing| swing.rate(self.start_s()));
        let rate = core::array::from_fn(|axis| self.rate_rad_s[axis] + swing * gravity[axis]);
        let [velocity, rate, gravity] =
            [view.in_camera(self.velocity_m_s), rate, gravity].map(|vector| vector.map(|component| component as f32));
        Twist::new(velocity, rate, gravity)
    }

    /// Renders one row of the image into `pixels`, from column 0 on: as many pixels as the image has columns, or as
    /// there is room for; any further pixels are left as they are. A row beyond the image counts as the last one.
    ///
    /// *Cost*: for each object three projections of two lines in double precision; for each column one hash and a few
    /// operations for each object; for each pixel within reach of an edge (4.5 sigma of the lens and half of the motion
    /// blur) one or two pairs of `erfcf` and `expf`. *Stack*: about 100 bytes for each of `OBJECTS`.
    pub fn row(&self, row: u16, pixels: &mut [u8]) {
        let mut pixels = pixels.iter_mut();
        // The conversion cuts off below 0 and above 255.
        self.levels(row, pixels.len(), &Tint::NEUTRAL, |level| {
            if let Some(pixel) = pixels.next() {
                *pixel = (level + 0.5) as u8;
            }
        });
    }

    /// As [`row`](Self::row), but in 1/256 of a grey level, 0 to 65535: what the sensor has before a camera makes eight
    /// bits of it ([`Pipeline`](super::Pipeline)).
    pub fn row_q8(&self, row: u16, levels: &mut [u16]) {
        let mut levels = levels.iter_mut();
        self.levels(row, levels.len(), &Tint::NEUTRAL, |level| {
            if let Some(level_q8) = levels.next() {
                *level_q8 = (level * 256.0 + 0.5) as u16;
            }
        });
    }

    /// As [`row`](Self::row), but as the sensor delivers it in a format: [`PixelFormat::row_bytes`] bytes, or as many
    /// as there is room for. A mosaic is RGGB and shows the colours of [`Simulator::with_tint`]; all else is grey.
    pub fn row_in(&self, row: u16, format: PixelFormat, bytes: &mut [u8]) {
        let tint = if format.is_mosaic() { self.tint } else { Tint::NEUTRAL };
        let mut encoder = RowEncoder::new(format, bytes);
        self.levels(row, self.columns.into(), &tint, |level| encoder.push(level));
    }

    /// The levels of a row with their noise, for so many columns at most.
    fn levels(&self, row: u16, columns: usize, tint: &Tint, mut take: impl FnMut(f32)) {
        let row = self.nearest_row(row);
        let view = self.row_view(row);
        let [_, middle, _] = &view.views;
        let mut background = RowTexture::new(self.scene.background(), middle, &self.lens, f64::from(row));
        let mut layers: Vec<Layer, OBJECTS> = Vec::new();
        for layer in self.scene.objects().iter().filter_map(|object| Layer::new(object, &view)) {
            // Never full: there are no more layers than objects.
            layers.push(layer).ok();
        }
        let frame_key = hash(mix(self.seed), u64::from(self.frame));
        let mut noise = RowNoise::new(&self.exposure, frame_key, row);
        let light = self.brightness(row);
        for column in (0..self.columns).take(columns) {
            let x = f32::from(column);
            let level = layers.iter_mut().fold(background.level(x), |behind, layer| layer.cover(x, behind));
            take(noise.noisy(column, tint.level(row, column, level * light)));
        }
    }

    /// Of the light during the exposure of a row, relative to its mean.
    fn brightness(&self, row: u16) -> f32 {
        let middle_s = self.start_s() + self.row_time_s(row);
        self.flicker.map_or(1.0, |flicker| flicker.brightness(middle_s, f64::from(self.exposure.time_s)) as f32)
    }

    pub(super) const fn scene(&self) -> &'a Scene<OBJECTS> {
        self.scene
    }

    pub(super) const fn lens(&self) -> &Lens {
        &self.lens
    }

    pub(super) const fn columns(&self) -> u16 {
        self.columns
    }

    pub(super) const fn rows(&self) -> u16 {
        self.readout.rows()
    }

    pub(super) const fn gravity(&self) -> Vector {
        self.gravity
    }

    /// The camera `time_s` seconds after the start of this frame.
    pub(super) fn view(&self, time_s: f64) -> View {
        let time_s = self.start_s() + time_s;
        let view = View::after(time_s, self.velocity_m_s, self.rate_rad_s);
        self.swing.map_or(view, |swing| view.turned(self.gravity, swing.angle(time_s)))
    }

    const fn start_s(&self) -> f64 {
        self.start_ns as f64 * 1e-9
    }

    /// Seconds from the start of the frame to the middle of the row's exposure.
    pub(super) fn row_time_s(&self, row: u16) -> f64 {
        self.readout.row_time_ns(row) as f64 * 1e-9
    }

    fn row_view(&self, row: u16) -> RowView<'_> {
        let time_s = self.row_time_s(row);
        let half = 0.5 * f64::from(self.exposure.time_s);
        let middle = self.view(time_s);
        let views = if half > 0.0 { [self.view(time_s - half), middle, self.view(time_s + half)] } else { [middle; 3] };
        RowView {
            lens: &self.lens,
            views,
            gravity: self.gravity,
            exposure: &self.exposure,
            softness: self.softness,
            columns: self.columns,
            row: f64::from(row),
        }
    }

    fn nearest_row(&self, row: u16) -> u16 {
        row.min(self.rows().saturating_sub(1))
    }
}
