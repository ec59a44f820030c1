//! [`Sequel`]: ranges of frame after frame, each on its own or as one sequence.

use anyhow::Result;
use shutter_range::{LensBlur, Line, Motion, MotionBlur, Pose, Range, Sequence, Setup};

use super::course::{CameraMotion, Course};
use super::tracking::KNOTS;
use crate::input::setup::SetupFile;

/// Room for more edges than a scene has.
const LANDMARKS: usize = 1024;

pub(crate) struct Sequel {
    setup: Setup<f64>,
    /// What is known of the lens, where the setup leaves that open.
    lens: Option<LensBlur<f64>>,
    /// `None` where frames are independent of each other.
    sequence: Option<Box<Sequence<f64, LANDMARKS>>>,
    /// From the start of the frame before to that of the next one, and the seconds in between.
    step: Option<(Pose<f64>, f64)>,
}

impl Sequel {
    pub(crate) fn new(file: &SetupFile, course: &Course) -> Self {
        let is_open = file.optics.lens_blur_px.is_none();
        let lens = file.setup.motion_blur().filter(|_| is_open).copied().map(LensBlur::new);
        let sequence = course.is_sequence().then(Box::default);
        Self { setup: file.setup, lens, sequence, step: None }
    }

    pub(crate) fn setup(&self) -> &Setup<f64> {
        &self.setup
    }

    /// Goes on to the next frame; `to_next_s` is how long it is from there to the one after.
    pub(crate) fn advance(&mut self, motion: &CameraMotion<'_>, to_next_s: f64) -> Result<()> {
        let step = self.step.replace((motion.pose(to_next_s), to_next_s));
        if let (Some(sequence), Some((pose, elapsed_s))) = (&mut self.sequence, step) {
            sequence.advance(&self.setup, &pose, elapsed_s, motion.gravity())?;
        }
        Ok(())
    }

    /// Nothing is known of the way to the next frame: what was before is of no use to it.
    pub(crate) fn restart(&mut self) {
        self.step = None;
        if let Some(sequence) = &mut self.sequence {
            sequence.clear();
        }
    }

    /// The ranges of a frame's lines.
    pub(crate) fn ranges(&mut self, motion: &CameraMotion<'_>, lines: &[Line<KNOTS>]) -> Result<Vec<Range<f64>>> {
        let mut ranges = Vec::new();
        let Some(sequence) = &mut self.sequence else {
            return self.independent(motion, lines);
        };
        sequence.lines(&self.setup, motion, lines, |range| ranges.push(range));
        if let Some(lens) = &mut self.lens {
            self.setup = learned(&self.setup, lens, &ranges)?;
        }
        Ok(ranges)
    }

    /// A frame on its own tells the lens, too: what it has told then serves all of its lines.
    fn independent(&self, motion: &CameraMotion<'_>, lines: &[Line<KNOTS>]) -> Result<Vec<Range<f64>>> {
        let of =
            |setup: &Setup<f64>| lines.iter().map(|line| Range::from_line(setup, motion, line)).collect::<Vec<_>>();
        let ranges = of(&self.setup);
        match self.lens {
            Some(mut lens) => Ok(of(&learned(&self.setup, &mut lens, &ranges)?)),
            None => Ok(ranges),
        }
    }
}

fn learned(setup: &Setup<f64>, lens: &mut LensBlur<f64>, ranges: &[Range<f64>]) -> Result<Setup<f64>> {
    ranges.iter().for_each(|range| lens.learn(range));
    let known: MotionBlur<f64> = lens.motion_blur();
    Ok(setup.with_motion_blur(known)?)
}
