//! [`Flicker`]: light that is not steady.

use super::checked::check;
use crate::error::ParameterError;

/// How the light of a scene flickers. Its mean brightness is that of the scene's levels, so that pulses are brighter
/// than them by 1/duty.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Flicker {
    /// Periods in a second, 1 to 10⁵; lamps on mains have twice the frequency of the mains.
    pub frequency_hz: f32,
    /// Share of the light that flickers, 0 to 1.
    pub depth: f32,
    /// Share of the period in which a pulsed lamp is on, 0.001 to 1; `None`: a sine.
    pub duty: Option<f32>,
}

impl Flicker {
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        check([
            ("frequency_hz", self.frequency_hz, [1.0, 1e5], "1 to 100000 (Hz)"),
            ("depth", self.depth, [0.0, 1.0], "0 to 1"),
            ("duty", self.duty.unwrap_or(1.0), [0.001, 1.0], "0.001 to 1"),
        ])
    }

    /// Mean brightness over an exposure whose middle is at a time, relative to the mean over a long time.
    pub(super) fn brightness(&self, middle_s: f64, exposure_s: f64) -> f64 {
        let frequency_hz = f64::from(self.frequency_hz);
        let (middle, periods) = (frequency_hz * middle_s, frequency_hz * exposure_s);
        let flickering = match self.duty {
            Some(duty) => mean_of_pulses(middle, periods.max(1e-9), f64::from(duty)),
            None => 1.0 + mean_of_cosine(middle, periods),
        };
        1.0 + f64::from(self.depth) * (flickering - 1.0)
    }
}

fn mean_of_cosine(middle: f64, periods: f64) -> f64 {
    let angle = core::f64::consts::PI * periods;
    let sinc = if angle > 1e-6 { libm::sin(angle) / angle } else { 1.0 };
    sinc * libm::cos(core::f64::consts::TAU * middle)
}

/// Pulses begin at whole numbers of periods.
fn mean_of_pulses(middle: f64, periods: f64, duty: f64) -> f64 {
    let on_until = |end: f64| {
        let whole = libm::floor(end);
        whole * duty + (end - whole).min(duty)
    };
    (on_until(middle + 0.5 * periods) - on_until(middle - 0.5 * periods)) / (periods * duty)
}
