//! [`choose`]: the best of several camera modes for what is wanted.

use core::fmt::{self, Display, Formatter};

use heapless::Vec;

use super::camera_mode::CameraMode;
use super::planner::Planner;
use super::prediction::Obstacle;
use super::target::Target;
use crate::error::ParameterError;
use crate::motion::{Motion, Twist};
use crate::scalar::{Scalar, dot, scale};

/// What is wanted of a camera mode: depths and speeds between which distances are known to a relative sigma.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Request<S> {
    /// The smallest depth in metres.
    pub nearest_m: S,
    /// The largest depth in metres.
    pub farthest_m: S,
    /// The lowest speed in m/s.
    pub slowest_m_s: S,
    /// The highest speed in m/s.
    pub fastest_m_s: S,
    /// The largest relative sigma.
    pub relative_sigma: S,
}

impl<S: Scalar> Request<S> {
    fn check(&self) -> Result<(), ParameterError> {
        let pairs = [
            ("nearest_m", self.nearest_m, S::ratio(1, 1000), self.farthest_m, "0.001 to farthest_m (m)"),
            ("farthest_m", self.farthest_m, self.nearest_m, S::from_i32(100_000), "nearest_m to 100000 (m)"),
            ("slowest_m_s", self.slowest_m_s, S::ratio(1, 1000), self.fastest_m_s, "0.001 to fastest_m_s (m/s)"),
            ("fastest_m_s", self.fastest_m_s, self.slowest_m_s, S::from_i32(1000), "slowest_m_s to 1000 (m/s)"),
            ("relative_sigma", self.relative_sigma, S::ratio(1, 100_000), S::ONE, "0.00001 to 1"),
        ];
        for (name, value, least, most, expected) in pairs {
            if !(value >= least && value <= most) {
                return Err(ParameterError::new(name, value.to_f64(), expected));
            }
        }
        Ok(())
    }
}

/// What a camera mode is worth for a [`Request`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Verdict<S> {
    /// It does what is wanted; with its largest relative sigma.
    Suits {
        /// Of the depths and speeds of the request.
        relative_sigma: S,
    },
    /// At this depth and speed distances are known too badly.
    Uncertain {
        /// In metres.
        depth_m: S,
        /// In m/s.
        speed_m_s: S,
        /// What it would be.
        relative_sigma: S,
    },
    /// At this depth and speed there would be no distance at all.
    Blocked {
        /// In metres.
        depth_m: S,
        /// In m/s.
        speed_m_s: S,
        /// Why.
        obstacle: Obstacle,
    },
}

impl<S: Scalar> Display for Verdict<S> {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        let percent = |relative: &S| relative.to_f64() * 100.0;
        match self {
            Self::Suits { relative_sigma } => {
                write!(formatter, "suits: sigma at most {:.2} %", percent(relative_sigma))
            }
            Self::Uncertain { depth_m, speed_m_s, relative_sigma } => write!(
                formatter,
                "sigma {:.2} % at {:.2} m and {:.2} m/s",
                percent(relative_sigma),
                depth_m.to_f64(),
                speed_m_s.to_f64()
            ),
            Self::Blocked { depth_m, speed_m_s, obstacle } => {
                write!(formatter, "{obstacle} at {:.2} m and {:.2} m/s", depth_m.to_f64(), speed_m_s.to_f64())
            }
        }
    }
}

/// The best of several modes, and what each of them is worth.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Choice<S, const MODES: usize> {
    /// Index of the mode that suits with the smallest of the largest sigmas; `None` where none suits.
    pub best: Option<usize>,
    /// Of each mode, in their order.
    pub verdicts: Vec<Verdict<S>, MODES>,
}

/// Chooses among at most `MODES` camera modes, for a target that is passed in the direction of a motion.
///
/// Each mode is tried at the nearest, the geometric mean and the farthest depth, at the lowest and at the highest
/// speed: sigma grows with depth and with slowness, blur and skew with nearness and speed.
///
/// *Errors*: a request or a target outside its limits, a motion without velocity, more modes than there is room for.
///
/// *Cost*: six predictions for each mode, so that a robot can choose while it drives.
pub fn choose<S: Scalar, const MODES: usize>(
    modes: &[CameraMode<S>],
    motion: &Twist<S>,
    target: Target<S>,
    request: &Request<S>,
) -> Result<Choice<S, MODES>, ParameterError> {
    request.check()?;
    let velocity_m_s = motion.velocity_m_s();
    let speed_m_s = dot(velocity_m_s, velocity_m_s).sqrt();
    if !(speed_m_s > S::ZERO) {
        return Err(ParameterError::new("velocity_m_s", speed_m_s.to_f64(), "a direction: not zero"));
    }
    let at_speed = |wanted: S| {
        Twist::new(scale(velocity_m_s, wanted / speed_m_s), motion.rate_rad_s(), motion.gravity())
            .map(|twist| (wanted, twist))
    };
    let motions = [at_speed(request.slowest_m_s)?, at_speed(request.fastest_m_s)?];
    let mut choice = Choice { best: None, verdicts: Vec::new() };
    let mut least = None;
    for (index, mode) in modes.iter().enumerate() {
        let verdict = judge(mode, &motions, target, request)?;
        match verdict {
            Verdict::Suits { relative_sigma } if least.is_none_or(|least| relative_sigma < least) => {
                (least, choice.best) = (Some(relative_sigma), Some(index));
            }
            _ => {}
        }
        let full = ParameterError::new("modes", modes.len() as f64, "at most MODES");
        choice.verdicts.push(verdict).map_err(|_| full)?;
    }
    Ok(choice)
}

/// What speaks most against a mode, or its largest sigma.
fn judge<S: Scalar>(
    mode: &CameraMode<S>,
    motions: &[(S, Twist<S>)],
    target: Target<S>,
    request: &Request<S>,
) -> Result<Verdict<S>, ParameterError> {
    let middle_m = (request.nearest_m * request.farthest_m).sqrt();
    let (mut largest, mut at) = (S::ZERO, (S::ZERO, S::ZERO));
    for (speed_m_s, motion) in motions {
        let planner = Planner::new(mode, motion, target)?;
        for depth_m in [request.nearest_m, middle_m, request.farthest_m] {
            let prediction = planner.predict(depth_m)?;
            if let Some(obstacle) = prediction.obstacle {
                return Ok(Verdict::Blocked { depth_m, speed_m_s: *speed_m_s, obstacle });
            }
            let relative_sigma = prediction.relative_sigma();
            if relative_sigma > largest {
                (largest, at) = (relative_sigma, (depth_m, *speed_m_s));
            }
        }
    }
    let (depth_m, speed_m_s) = at;
    Ok(if largest <= request.relative_sigma {
        Verdict::Suits { relative_sigma: largest }
    } else {
        Verdict::Uncertain { depth_m, speed_m_s, relative_sigma: largest }
    })
}
