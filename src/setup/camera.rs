//! [`Camera`]: the direction in which each pixel looks.

use super::distortion::Distortion;
use super::optics::{CameraOptics, Optics};
use crate::error::ParameterError;
use crate::scalar::{Scalar, Whole};

/// Image size, focal lengths and principal point of a camera, all in pixels. [`Camera::new`] checks them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Intrinsics<S> {
    /// Width of the image in pixels.
    pub columns: u16,
    /// Height of the image in pixels.
    pub rows: u16,
    /// Focal length along the rows, in pixels.
    pub fx: S,
    /// Focal length along the columns, in pixels.
    pub fy: S,
    /// Column of the principal point; pixel centres are at whole numbers.
    pub cx: S,
    /// Row of the principal point.
    pub cy: S,
}

impl<S: Scalar> Intrinsics<S> {
    /// Square pixels and the principal point in the middle of the image; the focal length is in pixels.
    #[must_use]
    pub fn centred(columns: u16, rows: u16, focal_px: S) -> Self {
        let middle = |size: u16| S::ratio(i32::from(size) - 1, 2);
        Self { columns, rows, fx: focal_px, fy: focal_px, cx: middle(columns), cy: middle(rows) }
    }

    /// From the focal length in millimetres and the pitch of the image's pixels in micrometres (that of the sensor
    /// times the binning or scaling factor), with the principal point in the middle.
    #[must_use]
    pub fn from_focal_length(columns: u16, rows: u16, focal_length_mm: S, pixel_pitch_um: S) -> Self {
        Self::centred(columns, rows, focal_length_mm / pixel_pitch_um * S::from_i32(1000))
    }
}

/// A checked camera: intrinsics and distortion.
///
/// ```
/// use shutter_range::{Camera, Distortion, Intrinsics};
/// let camera = Camera::new(Intrinsics::centred(640, 480, 600.0_f32), Distortion::NONE)?;
/// let ray = camera.ray(319.5 + 60.0, 239.5).expect("in the image");
/// assert!((ray.u - 0.1).abs() < 1e-6 && ray.w == 0.0);
/// # Ok::<(), shutter_range::ParameterError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "RawCamera<S>"))]
#[cfg_attr(feature = "serde", serde(bound(deserialize = "S: Scalar + serde::Deserialize<'de>")))]
pub struct Camera<S> {
    intrinsics: Intrinsics<S>,
    distortion: Distortion<S>,
    #[cfg_attr(feature = "serde", serde(skip))]
    per_fx: S,
    #[cfg_attr(feature = "serde", serde(skip))]
    per_fy: S,
    /// Of any ideal or recorded point; zero where the lens does not distort.
    #[cfg_attr(feature = "serde", serde(skip))]
    largest: [S; 2],
    #[cfg_attr(feature = "serde", serde(skip))]
    optics: CameraOptics<S>,
}

/// A direction `(u, w, 1)` in the camera's axes (x right, y down, z forward), and how it changes along the row.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Ray<S> {
    /// Bearing to the right: x/z, the tangent of the paper's α, signed.
    pub u: S,
    /// Bearing downwards: y/z.
    pub w: S,
    /// Change of `u` per pixel of column.
    pub du_dcolumn: S,
    /// Change of `w` per pixel of column; not zero where the lens distorts.
    pub dw_dcolumn: S,
}

/// Most columns or rows: a column in 1/65536 px must fit a signed number of 32 bits.
const MAX_SIZE: u16 = 32_767;

impl<S: Scalar> Camera<S> {
    /// A camera whose parameters have been checked.
    ///
    /// *Errors*: an empty image or one beyond 32767 pixels; a focal length outside 1 to 10⁶ px; a principal point
    /// further than one image size outside; a coefficient of the distortion that is not finite or beyond 1000; a
    /// distortion that folds over inside the image, so that two directions would share a pixel.
    ///
    /// *Cost*: a few operations, or 512 inversions of the distortion.
    // Inlined, so that a program in which all lenses have none, as it can be seen, holds nothing of the distortion.
    #[inline]
    pub fn new(intrinsics: Intrinsics<S>, distortion: Distortion<S>) -> Result<Self, ParameterError> {
        let camera = Self::without_distortion(intrinsics)?;
        if distortion.is_none() { Ok(camera) } else { camera.with_distortion(distortion) }
    }

    /// *Errors*: those of [`Camera::new`] that are not the distortion's.
    pub(super) fn without_distortion(intrinsics: Intrinsics<S>) -> Result<Self, ParameterError> {
        let Intrinsics { columns, rows, fx, fy, cx, cy } = intrinsics;
        for (name, size) in [("columns", columns), ("rows", rows)] {
            if size == 0 || size > MAX_SIZE {
                return Err(ParameterError::of_whole(name, size.into(), "1 to 32767 (pixels)"));
            }
        }
        for (name, focal) in [("fx", fx), ("fy", fy)] {
            if !(focal.is_finite() && focal >= S::ONE && focal <= S::from_i32(1_000_000)) {
                return Err(ParameterError::new(name, focal.to_f64(), "1 to 1000000 (focal length in pixels)"));
            }
        }
        for (name, centre, size) in [("cx", cx, columns), ("cy", cy, rows)] {
            let size = S::from_i32(i32::from(size));
            if !(centre >= -size && centre <= size + size) {
                let expected = "at most one image size outside the image (pixels)";
                return Err(ParameterError::new(name, centre.to_f64(), expected));
            }
        }
        let (per_fx, per_fy, largest) = (S::ONE / fx, S::ONE / fy, [S::ZERO; 2]);
        let (distortion, optics) = (Distortion::NONE, CameraOptics::STRAIGHT);
        Ok(Self { intrinsics, distortion, per_fx, per_fy, largest, optics })
    }

    /// The same behind a lens that distorts.
    #[inline(never)]
    fn with_distortion(self, distortion: Distortion<S>) -> Result<Self, ParameterError> {
        for (name, value) in ["k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"].into_iter().zip(distortion.to_opencv()) {
            if !(value.is_finite() && value.abs() <= S::from_i32(1000)) {
                return Err(ParameterError::new(name, value.to_f64(), "finite, at most 1000 in size"));
            }
        }
        let mut camera = Self { distortion, optics: CameraOptics::DISTORTING, ..self };
        camera.refuse_folding()?;
        Ok(camera)
    }

    /// Intrinsics as given.
    #[must_use]
    pub const fn intrinsics(&self) -> &Intrinsics<S> {
        &self.intrinsics
    }

    /// Whether the lens does not distort.
    pub(crate) const fn is_straight(&self) -> bool {
        self.optics.is_straight()
    }

    /// `None` where it does not.
    pub(super) fn optics(&self) -> Option<&dyn Optics<S>> {
        self.optics.of(&self.distortion)
    }

    /// Changes of the bearings by a pixel along the row and along the column, without distortion.
    pub(super) const fn per_focal(&self) -> [S; 2] {
        [self.per_fx, self.per_fy]
    }

    /// The largest bearings of any ideal or recorded point; zero where the lens does not distort.
    pub(super) const fn largest(&self) -> [S; 2] {
        self.largest
    }

    /// Distortion as given.
    #[must_use]
    pub const fn distortion(&self) -> &Distortion<S> {
        &self.distortion
    }

    /// Whether a point lies in the image: its row is one of the image's, and its column, in 1/65536 px, is at most a
    /// pixel beyond the outermost pixel centres. Detectors that count from the pixels' corners put an edge at the
    /// border half a pixel beyond them.
    #[must_use]
    pub const fn contains(&self, column_q16: i32, row: u16) -> bool {
        self.contains_column(column_q16) && row < self.intrinsics.rows
    }

    /// Likewise of the column alone.
    pub(crate) const fn contains_column(&self, column_q16: i32) -> bool {
        const ONE: i32 = 1 << 16;
        let width = (self.intrinsics.columns as i32) << 16;
        column_q16 >= -ONE && column_q16 <= width
    }

    /// The direction in which the pixel at `column`, `row` looks; `None` where the model of the lens folds over, which
    /// is well outside the image.
    ///
    /// *Cost*: four operations, or an inversion of the distortion: 100 to 300.
    #[must_use]
    pub fn ray(&self, column: S, row: S) -> Option<Ray<S>> {
        let recorded = self.normalised(column, row);
        let straight = Ray { u: recorded[0], w: recorded[1], du_dcolumn: self.per_fx, dw_dcolumn: S::ZERO };
        let Some(optics) = self.optics() else { return Some(straight) };
        optics.undistorted(recorded).map(|ideal| {
            let [Whole(u), Whole(w)] = ideal.point;
            let [[Whole(du), _], [Whole(dw), _]] = ideal.jacobian;
            Ray { u, w, du_dcolumn: du * self.per_fx, dw_dcolumn: dw * self.per_fx }
        })
    }

    /// Where a direction `(u, w, 1)` is recorded: column and row in pixels.
    #[must_use]
    pub fn pixel(&self, u: S, w: S) -> (S, S) {
        let recorded = self.optics().map(|optics| optics.distorted([u, w]).point);
        let [u, w] = recorded.map_or([u, w], |point| point.map(|Whole(part)| part));
        let Intrinsics { fx, fy, cx, cy, .. } = self.intrinsics;
        (cx + fx * u, cy + fy * w)
    }

    pub(super) fn normalised(&self, column: S, row: S) -> [S; 2] {
        [(column - self.intrinsics.cx) * self.per_fx, (row - self.intrinsics.cy) * self.per_fy]
    }

    /// Goes from the principal point to the border of the image in 32 directions: the ideal point must move outwards at
    /// every step, and must map back to the recorded one. Takes down the largest.
    fn refuse_folding(&mut self) -> Result<(), ParameterError> {
        for spoke in 0..32 {
            let [u, w] = self.border_point(spoke);
            let mut reached = S::ZERO;
            for step in 1..=16 {
                let part = S::ratio(step, 16);
                let recorded = [u * part, w * part];
                let ideal = self.ideal_point(recorded);
                let radius = ideal.map_or(S::ZERO, |[u, w]| (u * u + w * w).sqrt());
                if !(radius > reached) {
                    let r2 = recorded[0] * recorded[0] + recorded[1] * recorded[1];
                    return Err(ParameterError::new(
                        "distortion",
                        r2.sqrt().to_f64(),
                        "a model that does not fold over inside the image (the value is the radius, in focal lengths, where it does)",
                    ));
                }
                reached = radius;
                let [ideal_u, ideal_w] = ideal.unwrap_or(recorded).map(S::abs);
                let [most_u, most_w] = self.largest;
                self.largest = [most_u.max(ideal_u).max(recorded[0].abs()), most_w.max(ideal_w).max(recorded[1].abs())];
            }
        }
        Ok(())
    }

    /// The ideal point, or `None` where the inversion fails or is close to failing.
    fn ideal_point(&self, recorded: [S; 2]) -> Option<[S; 2]> {
        let ideal = self.distortion.undistort(recorded)?.point.map(|Whole(part)| part);
        let back = self.distortion.distort(ideal);
        let [Whole(u), Whole(w)] = back.point;
        let round_trip_error = (u - recorded[0]).abs() + (w - recorded[1]).abs();
        // 1e-4 px, or what the type resolves.
        let tolerance = (self.per_fx * S::ratio(1, 10_000)).max(S::EPSILON * S::from_i32(32));
        // The scale of areas falls to zero at a fold, which may lie nearer between two of the directions than on them.
        let near_fold = back.determinant() < Whole(S::ratio(1, 8));
        (round_trip_error <= tolerance && !near_fold).then_some(ideal)
    }

    /// The normalised point number `index` of 32 around the border of the image.
    fn border_point(&self, index: i32) -> [S; 2] {
        let Intrinsics { columns, rows, .. } = self.intrinsics;
        // Two pixels outside, since a point may lie one pixel beyond the last pixel centre.
        let low = -S::from_i32(2);
        let right = S::from_i32(i32::from(columns) + 1);
        let bottom = S::from_i32(i32::from(rows) + 1);
        let part = S::ratio(index % 8, 8);
        let between = |from: S, to: S| from + (to - from) * part;
        let (column, row) = match index / 8 {
            0 => (between(low, right), low),
            1 => (right, between(low, bottom)),
            2 => (between(right, low), bottom),
            _ => (low, between(bottom, low)),
        };
        self.normalised(column, row)
    }
}

#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct RawCamera<S> {
    intrinsics: Intrinsics<S>,
    distortion: Distortion<S>,
}

#[cfg(feature = "serde")]
impl<S: Scalar> TryFrom<RawCamera<S>> for Camera<S> {
    type Error = ParameterError;

    fn try_from(raw: RawCamera<S>) -> Result<Self, ParameterError> {
        Self::new(raw.intrinsics, raw.distortion)
    }
}
