//! [`Budget`]: which part of an inverse depth's sigma comes from where.

use crate::scalar::{Scalar, hypot};

/// One standard deviation of inverse depth from each source, in 1/m. Their squares add up to that of the whole.
///
/// What speed and rotation have done in earlier frames of a sequence, and have drifted since, counts as noise.
///
/// Noise and lean are each edge's own and average out over edges; the rest is common to all edges of a frame and does not:
/// weigh edges by [`own_per_m`](Self::own_per_m), then add [`common_per_m`](Self::common_per_m) to what is left.
///
/// Which source dominates, for a level camera that moves sideways at v past an edge at depth Z, with f the focal length in
/// pixels and l the line time:
///
/// | source | relative error of Z | when it dominates |
/// | --- | --- | --- |
/// | noise | σ_x √(12/N³) Z/(f v l) | few rows N, far edges, low contrast |
/// | lean, gravity | σ_β Z/(f v l) | one frame without a known exposure: nearly always |
/// | lens | of the blur's own, where lean or gravity would be larger | long exposure, unknown lens |
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
    /// The edge's own lean, as far as it is not measured.
    pub lean_per_m: S,
    /// Roll and pitch of gravity.
    pub gravity_per_m: S,
    /// The lens's own blur, where the edge's blur has borne on the estimate.
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

    /// One standard deviation of what is this edge's own: noise and lean.
    #[must_use]
    pub fn own_per_m(&self) -> S {
        hypot(self.noise_per_m, self.lean_per_m)
    }

    /// One standard deviation of what moves all edges of a frame together.
    #[must_use]
    pub fn common_per_m(&self) -> S {
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
