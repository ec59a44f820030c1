//! [`Budget`]: which part of an inverse depth's sigma comes from where.

use crate::scalar::{Scalar, hypot};

/// One standard deviation of inverse depth from each source, in 1/m. The squares add up to the square of the whole.
///
/// In a sequence, the part of an error of speed or rotation that has drifted since counts as noise.
///
/// Noise and lean are independent from edge to edge and average out over edges; the rest is correlated over all edges
/// of a frame and does not: weight edges by [`independent_per_m`](Self::independent_per_m), then add
/// [`correlated_per_m`](Self::correlated_per_m) to the result.
///
/// Which source dominates, for a level camera that moves sideways at v past an edge at depth Z, with f the focal length
/// in pixels and l the line time:
///
/// | source | relative error of Z | when it dominates |
/// | --- | --- | --- |
/// | noise | σ_x √(12/N³) Z/(f v l) | few rows N, far edges, low contrast |
/// | lean, gravity | σ_β Z/(f v l) | one frame without a known exposure: nearly always |
/// | lens | the error of the blur measurement, where lean or gravity would be larger | long exposure, unknown lens |
/// | speed | σ_v/v | near edges, several frames |
/// | rate | σ_ω Z/v | far edges, slow cameras |
/// | readout | σ_s/s | near edges, one frame |
/// | focal | about σ_f/f, more beside the axis | near edges, several frames |
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Budget<S> {
    /// Noise of the edge's columns and widths.
    pub noise_per_m: S,
    /// The edge's own lean, as far as it has not been measured.
    pub lean_per_m: S,
    /// Roll and pitch of gravity.
    pub gravity_per_m: S,
    /// The lens's own blur, where the blur of the edge has entered the estimate.
    pub lens_per_m: S,
    /// Speed.
    pub speed_per_m: S,
    /// Rotation rate.
    pub rate_per_m: S,
    /// Readout time.
    pub readout_per_m: S,
    /// Focal length.
    pub focal_per_m: S,
}

/// A part of a [`Budget`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum ErrorSource {
    /// [`Budget::noise_per_m`]
    Noise,
    /// [`Budget::lean_per_m`]
    Lean,
    /// [`Budget::gravity_per_m`]
    Gravity,
    /// [`Budget::lens_per_m`]
    Lens,
    /// [`Budget::speed_per_m`]
    Speed,
    /// [`Budget::rate_per_m`]
    Rate,
    /// [`Budget::readout_per_m`]
    Readout,
    /// [`Budget::focal_per_m`]
    Focal,
}

impl<S: Scalar> Budget<S> {
    pub(crate) fn of_noise(noise_per_m: S) -> Self {
        let none = S::ZERO;
        Self {
            noise_per_m,
            lean_per_m: none,
            gravity_per_m: none,
            lens_per_m: none,
            speed_per_m: none,
            rate_per_m: none,
            readout_per_m: none,
            focal_per_m: none,
        }
    }

    /// All parts with their names.
    #[must_use]
    pub fn parts(&self) -> [(ErrorSource, S); 8] {
        [
            (ErrorSource::Noise, self.noise_per_m),
            (ErrorSource::Lean, self.lean_per_m),
            (ErrorSource::Gravity, self.gravity_per_m),
            (ErrorSource::Lens, self.lens_per_m),
            (ErrorSource::Speed, self.speed_per_m),
            (ErrorSource::Rate, self.rate_per_m),
            (ErrorSource::Readout, self.readout_per_m),
            (ErrorSource::Focal, self.focal_per_m),
        ]
    }

    /// The largest part.
    #[must_use]
    pub fn dominant(&self) -> ErrorSource {
        let larger = |most: (ErrorSource, S), next: (ErrorSource, S)| if next.1 > most.1 { next } else { most };
        self.parts().into_iter().fold((ErrorSource::Noise, self.noise_per_m), larger).0
    }

    /// One standard deviation of the part that is independent from edge to edge: noise and lean.
    #[must_use]
    pub fn independent_per_m(&self) -> S {
        hypot(self.noise_per_m, self.lean_per_m)
    }

    /// One standard deviation of the part that is correlated over all edges of a frame.
    #[must_use]
    pub fn correlated_per_m(&self) -> S {
        let parts = [
            self.gravity_per_m,
            self.lens_per_m,
            self.speed_per_m,
            self.rate_per_m,
            self.readout_per_m,
            self.focal_per_m,
        ];
        parts.into_iter().fold(S::ZERO, hypot)
    }
}
