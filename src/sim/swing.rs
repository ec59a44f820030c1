//! [`Swing`]: a camera that turns back and forth.

use core::f64::consts::TAU;

use super::checked::check;
use crate::error::ParameterError;

/// How a camera turns back and forth about the direction of down, beside its other motion.
///
/// At time zero it looks ahead and turns the fastest. A second swing of a quarter of the angle and 2.3 times the
/// frequency lies over the first: of a single one, acceleration and angle are in proportion, which looks like a pitch
/// of the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Swing {
    /// To either side, in radians, 0 to 1.
    pub angle_rad: f32,
    /// Swings in a second, 0.01 to 10.
    pub frequency_hz: f32,
}

/// The second swing: its angle and frequency over those of the first.
const SECOND: (f64, f64) = (0.25, 2.3);

impl Swing {
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        check([
            ("angle_rad", self.angle_rad, [0.0, 1.0], "0 to 1 (rad)"),
            ("frequency_hz", self.frequency_hz, [0.01, 10.0], "0.01 to 10 (Hz)"),
        ])
    }

    /// Right-handed about down, in radians.
    pub(super) fn angle(&self, time_s: f64) -> f64 {
        let ((part, times), turn) = (SECOND, self.turn(time_s));
        f64::from(self.angle_rad) * (libm::sin(turn) + part * libm::sin(times * turn))
    }

    /// Of its change, in rad/s.
    pub(super) fn rate(&self, time_s: f64) -> f64 {
        let ((part, times), turn) = (SECOND, self.turn(time_s));
        let amplitude = f64::from(self.angle_rad) * TAU * f64::from(self.frequency_hz);
        amplitude * (libm::cos(turn) + part * times * libm::cos(times * turn))
    }

    fn turn(&self, time_s: f64) -> f64 {
        TAU * f64::from(self.frequency_hz) * time_s
    }
}
