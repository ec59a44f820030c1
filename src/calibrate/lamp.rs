//! [`Lamp`]: a light of known frequency.

use crate::error::ParameterError;
use crate::scalar::Scalar;

/// A light whose brightness changes periodically, at a frequency that is known.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Lamp<S> {
    frequency_hz: S,
    sigma: S,
}

impl<S: Scalar> Lamp<S> {
    /// A lamp that is driven at a frequency in hertz, 1 to 100 000: a LED with PWM, a strobe. Its clock is taken to be
    /// a crystal, good to 100 ppm.
    ///
    /// *Errors*: a frequency outside these limits.
    pub fn new(frequency_hz: S) -> Result<Self, ParameterError> {
        if !(frequency_hz >= S::ONE && frequency_hz <= S::from_i32(100_000)) {
            return Err(ParameterError::new("frequency_hz", frequency_hz.to_f64(), "1 to 100000 (Hz)"));
        }
        Ok(Self { frequency_hz, sigma: S::ratio(1, 10_000) })
    }

    /// A lamp on mains of 50 Hz: its light has 100 Hz. Large grids keep that to 0.02 Hz of the mains, one standard
    /// deviation.
    #[must_use]
    pub fn on_50_hz_mains() -> Self {
        Self { frequency_hz: S::from_i32(100), sigma: S::ratio(4, 10_000) }
    }

    /// The same on mains of 60 Hz: 120 Hz.
    #[must_use]
    pub fn on_60_hz_mains() -> Self {
        Self { frequency_hz: S::from_i32(120), sigma: S::ratio(4, 10_000) }
    }

    /// The same with another relative sigma of the frequency: 0.01 for the RC oscillator of a microcontroller.
    ///
    /// *Errors*: a sigma outside 0 to 1.
    pub fn with_sigma(self, sigma: S) -> Result<Self, ParameterError> {
        if !(sigma >= S::ZERO && sigma <= S::ONE) {
            return Err(ParameterError::new("sigma", sigma.to_f64(), "0 to 1 (relative)"));
        }
        Ok(Self { sigma, ..self })
    }

    /// Periods in a second.
    #[must_use]
    pub const fn frequency_hz(&self) -> S {
        self.frequency_hz
    }

    /// Relative standard deviation of the frequency.
    #[must_use]
    pub const fn sigma(&self) -> S {
        self.sigma
    }
}
