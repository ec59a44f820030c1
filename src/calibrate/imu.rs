//! [`ImuCalibration`]: when the gyroscope's samples are, and where down is, from upright edges before a camera that
//! turns.

use heapless::Vec;

use super::normal_equations::{Group, NormalEquations, Solution};
use super::tuning::{MOST_IMU_MISFIT, OFFSET_PRIOR, STEEP};
use crate::error::{FitError, ParameterError};
use crate::line::Line;
use crate::motion::Motion;
use crate::range::fit;
use crate::scalar::{Scalar, add, cross, dot, hypot, scale};
use crate::setup::{Setup, Uncertainty, tilt_per_pitch};

/// Takes the lines of upright edges in frames of a camera that turns and hardly moves, each with the motion that the
/// gyroscope tells for three offsets of its clock, and says by how much clock and gravity are off.
///
/// With the right offset and the right gravity all edges are upright. A lean that follows the change of the rotation
/// rate is an offset in time, one that all edges share is roll, and one in proportion to the bearing is pitch. At rest
/// there is no offset to be seen, and the lean of the edges is the camera's roll and pitch alone.
///
/// Each edge leans a little for itself, alike in all frames: it has a name, by which its own lean is told from the
/// rest.
///
/// The offset is linear in the lean as long as it is small against the time in which the rotation changes: repeat with
/// the offset found until it stays.
///
/// *Memory*: 20 numbers, and 6 for each of `EDGES`. *Cost*: three fits for each line.
///
/// *Source*: docs/model.md, section 11.4.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ImuCalibration<S, const EDGES: usize> {
    gravity: [S; 3],
    step_s: S,
    sigma_lean: S,
    equations: NormalEquations<S>,
    /// Names of the edges and the sums over their lines.
    edges: Vec<(u32, Group<S>), EDGES>,
    lines: u32,
    left_out: u32,
}

/// What the lines say, relative to what their motions assumed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct ImuEstimate<S> {
    /// To be added to the offset of the gyroscope's clock, in seconds: camera time is stamp plus offset.
    pub time_offset_s: S,
    /// One standard deviation; 0.1 s where the rotation does not change enough to tell.
    pub sigma_time_offset_s: S,
    /// Direction of down in the camera's axes.
    pub gravity: [S; 3],
    /// Change of gravity towards the right of the image, in radians.
    pub roll_rad: S,
    /// One standard deviation, the leans of the edges included.
    pub sigma_roll_rad: S,
    /// Change of gravity towards the scene, in radians.
    pub pitch_rad: S,
    /// One standard deviation; edges at one bearing alone do not tell it.
    pub sigma_pitch_rad: S,
    /// Root mean square of the remaining leans in units of what was stated.
    pub misfit: S,
    /// Lines that it rests on.
    pub lines: u32,
    /// Lines left out: they lean by more than an upright edge can, or there was no room for their edge.
    pub lines_left_out: u32,
}

/// Why lines say nothing of clock and gravity.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ImuRefusal<S> {
    /// Fewer than eight lines of upright edges.
    TooFewLines(u32),
    /// The leans follow neither clock nor gravity: other axes or signs of the gyroscope, or a camera that moves.
    Inconsistent {
        /// Root mean square of the remaining leans in units of what was stated.
        misfit: S,
    },
}

impl<S> ImuRefusal<S> {
    /// Its name in lower case.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::TooFewLines(_) => "too_few_lines",
            Self::Inconsistent { .. } => "inconsistent",
        }
    }
}

impl<S: Scalar> core::fmt::Display for ImuRefusal<S> {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::TooFewLines(lines) => write!(formatter, "{lines} lines of upright edges: at least 8 are needed"),
            Self::Inconsistent { misfit } => write!(
                formatter,
                "the edges lean by {:.0} times what was stated, whatever clock and gravity are: does the camera move, or are axes \
                 or signs of the gyroscope wrong?",
                misfit.to_f64()
            ),
        }
    }
}

impl<S: Scalar> core::error::Error for ImuRefusal<S> {}

/// Fewer lines may be of one edge.
const LEAST_LINES: u32 = 8;

impl<S: Scalar, const EDGES: usize> ImuCalibration<S, EDGES> {
    /// For motions with this gravity, whose clocks are a step apart, and for edges that lean by `sigma_lean` (a slope),
    /// each for itself.
    ///
    /// *Errors*: a gravity that lies in the image plane's axis, a step that is not 10⁻⁶ to 0.1 s, a lean that is not
    /// above zero and at most 0.1.
    pub fn new(gravity: [S; 3], step_s: S, sigma_lean: S) -> Result<Self, ParameterError> {
        let length = dot(gravity, gravity).sqrt();
        let down = scale(gravity, S::ONE / length);
        let [x, y, _] = down;
        if !(hypot(x, y) > S::ratio(1, 4)) {
            return Err(ParameterError::new(
                "gravity",
                length.to_f64(),
                "a direction at least 15 degrees off the optical axis",
            ));
        }
        if !(step_s >= S::ratio(1, 1_000_000) && step_s <= S::ratio(1, 10)) {
            return Err(ParameterError::new("step_s", step_s.to_f64(), "0.000001 to 0.1 (s)"));
        }
        if !(sigma_lean > S::ZERO && sigma_lean <= S::ratio(1, 10)) {
            return Err(ParameterError::new("sigma_lean", sigma_lean.to_f64(), "above 0, at most 0.1 (slope)"));
        }
        Ok(Self {
            gravity: down,
            step_s,
            sigma_lean,
            equations: NormalEquations::EMPTY,
            edges: Vec::new(),
            lines: 0,
            left_out: 0,
        })
    }

    /// A line of the edge with this name, with the motion that its frame has with the clock a step early, as it is, and
    /// a step late: offsets less a step, as they are, and plus a step.
    ///
    /// Of the setup's uncertainty, the noise of the rotation rate and the roughness of the edges count.
    ///
    /// *Errors*: as [`fit`]; the line is then left out.
    pub fn line<M: Motion<S>, const KNOTS: usize>(
        &mut self,
        setup: &Setup<S>,
        motions: [&M; 3],
        edge: u32,
        line: &Line<KNOTS>,
    ) -> Result<(), FitError> {
        let stated = setup.uncertainty();
        let free = Uncertainty::NONE
            .with_sigma_tilt(S::ONE)
            .with_edge_roughness_px(stated.edge_roughness_px)
            .with_sigma_rate_rad_s(stated.sigma_rate_rad_s);
        // All of it is within its limits.
        let setup = setup.with_uncertainty(free).unwrap_or(*setup);
        let fitted = |motion: &M| fit::<S, M, KNOTS>(&setup, motion, line.samples());
        let [early, now, late] = motions;
        let (early, now, late) = (fitted(early)?, fitted(now)?, fitted(late)?);
        let is_upright = now.tilt.abs() < S::ratio(STEEP.0, STEEP.1);
        let Some(group) = self.group(edge).filter(|_| is_upright) else {
            self.left_out = self.left_out.saturating_add(1);
            return Ok(());
        };
        let per_s = (late.tilt - early.tilt) / (self.step_s + self.step_s);
        let [roll, pitch] = self.per_gravity(now.bearing);
        // A lean to the side shows the more the farther the edge is off the axis; one towards the camera does not show.
        let shown = S::ONE / (S::ONE + now.bearing * now.bearing).sqrt();
        let (x, y, sigma) = (scale([roll, pitch, -per_s], shown), now.tilt * shown, now.sigma_tilt * shown);
        if let Some((_, sums)) = self.edges.get_mut(group) {
            sums.add(x, y, sigma);
        }
        self.equations.add(x, y, sigma);
        self.lines = self.lines.saturating_add(1);
        Ok(())
    }

    /// Where the sums of an edge are; `None` where there is no room for another one.
    fn group(&mut self, edge: u32) -> Option<usize> {
        let known = self.edges.iter().position(|(name, _)| *name == edge);
        known.or_else(|| self.edges.push((edge, Group::EMPTY)).ok().map(|()| self.edges.len() - 1))
    }

    /// Unit vectors across gravity: in the image plane, and towards the scene.
    fn across(&self) -> [[S; 3]; 2] {
        let [x, y, _] = self.gravity;
        let length = hypot(x, y);
        let right = [y / length, -x / length, S::ZERO];
        [right, cross(right, self.gravity)]
    }

    /// Lean in the image of an edge at a bearing for a unit change of gravity in either direction.
    fn per_gravity(&self, bearing: S) -> [S; 2] {
        [S::ONE, tilt_per_pitch(bearing, self.gravity)]
    }

    /// Roll, pitch and offset with each edge's own lean taken out.
    fn solved(&self, variances: S) -> Option<Solution<S>> {
        let mut equations = self.equations.with_variances(variances);
        self.edges.iter().for_each(|(_, group)| equations.take_out(group, variances, self.sigma_lean));
        let angle = S::ratio(1, 2);
        equations.add_priors([angle, angle, S::ratio(OFFSET_PRIOR.0, OFFSET_PRIOR.1)]);
        equations.solve()
    }

    /// Offset and gravity from the lines so far.
    ///
    /// *Errors*: [`ImuRefusal`] says why they cannot be told.
    pub fn estimate(&self) -> Result<ImuEstimate<S>, ImuRefusal<S>> {
        if self.lines < LEAST_LINES {
            return Err(ImuRefusal::TooFewLines(self.lines));
        }
        let unsound = ImuRefusal::Inconsistent { misfit: S::UNKNOWN };
        let first = self.solved(S::ONE).ok_or(unsound)?;
        let spare = S::from_ratio(i64::from(self.lines) - 3, 1);
        let misfit = (first.squares / spare).sqrt();
        if !(misfit <= S::from_i32(MOST_IMU_MISFIT)) {
            return Err(ImuRefusal::Inconsistent { misfit });
        }
        // What the columns' noise does not explain, such as noise of the gyroscope, is more noise, and no more lean.
        let inflation = misfit.max(S::ONE);
        let solution = self.solved(inflation * inflation).ok_or(unsound)?;
        let [roll_rad, pitch_rad, time_offset_s] = solution.unknowns;
        let [sigma_roll_rad, sigma_pitch_rad, sigma_time_offset_s] = solution.sigmas;
        let [right, forward] = self.across();
        let changed = add(self.gravity, add(scale(right, roll_rad), scale(forward, pitch_rad)));
        Ok(ImuEstimate {
            time_offset_s,
            sigma_time_offset_s,
            gravity: scale(changed, S::ONE / dot(changed, changed).sqrt()),
            roll_rad,
            sigma_roll_rad,
            pitch_rad,
            sigma_pitch_rad,
            misfit,
            lines: self.lines,
            lines_left_out: self.left_out,
        })
    }
}
