//! [`Down`]: the direction of down, as told, learned from a sequence, or fitted to a single frame.

use anyhow::{Result, ensure};
use shutter_range::{Line, Motion, Pose, Setup, Vertical};

use super::tracking::KNOTS;
use crate::input::setup::GravitySource;

/// The vertical of the frames so far, unless the setup has told it.
pub(crate) struct Down {
    source: GravitySource,
    vertical: Vertical<f64>,
}

/// A motion with another direction of down.
pub(crate) struct WithGravity<'a, M> {
    motion: &'a M,
    gravity: [f64; 3],
}

impl<M: Motion<f64>> Motion<f64> for WithGravity<'_, M> {
    fn pose(&self, time_s: f64) -> Pose<f64> {
        self.motion.pose(time_s)
    }

    fn gravity(&self) -> [f64; 3] {
        self.gravity
    }

    fn keeps_attitude(&self) -> bool {
        self.motion.keeps_attitude()
    }
}

impl Down {
    pub(crate) fn new(source: GravitySource, is_sequence: bool) -> Result<Self> {
        ensure!(
            source != GravitySource::Learned || is_sequence,
            "`attitude.gravity` is \"learn\", but must be three numbers or \"fit\" for frames that are no sequence \
             (--frame-interval-s, --frame-times)"
        );
        ensure!(
            source != GravitySource::Fitted || !is_sequence,
            "`attitude.gravity` is \"fit\", but must be three numbers or \"learn\" for a sequence"
        );
        Ok(Self { source, vertical: Vertical::level() })
    }

    /// Looks for it in the lines of a frame, where nothing is known yet. A hint where that fails.
    pub(crate) fn seek<M: Motion<f64>>(
        &mut self,
        setup: &mut Setup<f64>,
        motion: &M,
        lines: &[Line<KNOTS>],
    ) -> Result<Option<String>> {
        let hint = match self.source {
            GravitySource::Told => return Ok(None),
            GravitySource::Learned => self.begin(setup, motion, lines).err(),
            GravitySource::Fitted => self.fit(setup, motion, lines)?.err(),
        };
        *setup = with_sigma_gravity(setup, self.vertical.sigma_rad())?;
        Ok(hint)
    }

    fn begin<M: Motion<f64>>(
        &mut self,
        setup: &Setup<f64>,
        motion: &M,
        lines: &[Line<KNOTS>],
    ) -> std::result::Result<(), String> {
        let is_known = self.vertical.is_told() || self.vertical.begin(setup, &self.motion(motion), lines.iter());
        if is_known { Ok(()) } else { Err("no five edges agree on a vertical: gravity is not learned yet".to_string()) }
    }

    fn fit<M: Motion<f64>>(
        &mut self,
        setup: &Setup<f64>,
        motion: &M,
        lines: &[Line<KNOTS>],
    ) -> Result<std::result::Result<(), String>> {
        self.vertical = Vertical::level();
        self.vertical.begin(setup, &self.motion(motion), lines.iter());
        let setup = with_sigma_gravity(setup, self.vertical.sigma_rad())?;
        let fitted = Vertical::fit(&setup, &self.motion(motion), lines);
        self.vertical = fitted.unwrap_or(self.vertical);
        let exposure = if setup.motion_blur().is_none() { "exposure_s, " } else { "" };
        Ok(fitted.map(|_| ()).ok_or_else(|| {
            format!(
                "gravity cannot be fitted to this frame: fewer than five edges tell their lean apart from their distance. \
                 Give {exposure}several frames (\"learn\") or gravity itself"
            )
        }))
    }

    /// The motion with the direction of down that is used.
    pub(crate) fn motion<'a, M: Motion<f64>>(&self, motion: &'a M) -> WithGravity<'a, M> {
        let gravity = if self.source == GravitySource::Told { motion.gravity() } else { self.vertical.gravity() };
        WithGravity { motion, gravity }
    }

    /// What a sequence learns from, if it does.
    pub(crate) fn learned(&mut self) -> Option<&mut Vertical<f64>> {
        (self.source == GravitySource::Learned).then_some(&mut self.vertical)
    }

    pub(crate) fn advance(&mut self, pose: &Pose<f64>, elapsed_s: f64) {
        self.vertical.advance(pose, elapsed_s);
    }
}

fn with_sigma_gravity(setup: &Setup<f64>, sigma_rad: f64) -> Result<Setup<f64>> {
    Ok(setup.with_uncertainty(setup.uncertainty().with_sigma_gravity(sigma_rad))?)
}
