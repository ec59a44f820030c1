//! [`Pipeline`]: what a camera does to its pixels before it delivers them.

use super::stage::{RunningStage, Stage};
use super::window::REACH;
use crate::error::ParameterError;

/// What a camera does to its pixels before it delivers them: stages in their order, row by row.
///
/// Rows of the sensor go in from the top of the image to the bottom (or from the bottom to the top: then the mosaic's
/// even rows count from there), finished ones come out in the same order, two rows later for each stage that looks at
/// neighbours. Beyond the borders of the image its last row or column repeats.
///
/// *Memory*: 10 bytes a column and 550 bytes for each stage; as much again on the stack while a row passes.
///
/// ```
/// use shutter_range::sim::{Pipeline, Stage, ToneCurve};
/// let mut camera = Pipeline::<320, 2>::new([Stage::Tone(ToneCurve::Srgb), Stage::Sharpen3(1.0)])?;
/// let sensor = [64 << 8; 320]; // in 1/256 of a grey level, as `Simulator::row_q8` has it
/// let mut rows = 0;
/// let mut finished = |pixels: &[u8; 320]| {
///     assert_eq!(*pixels, [137; 320]);
///     rows += 1;
/// };
/// for _ in 0..240 {
///     camera.row(&sensor, &mut finished);
/// }
/// camera.end_frame(&mut finished);
/// assert_eq!(rows, 240);
/// # Ok::<(), shutter_range::ParameterError>(())
/// ```
#[derive(Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Pipeline<const COLUMNS: usize, const STAGES: usize> {
    stages: [RunningStage<COLUMNS>; STAGES],
}

impl<const COLUMNS: usize, const STAGES: usize> Pipeline<COLUMNS, STAGES> {
    /// A camera that does this, in this order. Without stages it only rounds to eight bits.
    ///
    /// *Errors*: a parameter outside the limits that the [`Stage`] states.
    pub fn new(stages: [Stage; STAGES]) -> Result<Self, ParameterError> {
        stages.iter().try_for_each(Stage::check)?;
        Ok(Self { stages: stages.map(RunningStage::new) })
    }

    /// Takes the next row of the sensor, in 1/256 of a grey level, and hands out the row that is finished by it, if
    /// any.
    ///
    /// *Cost*: for each stage and pixel one hash, a table look-up, or 9 to 10 neighbours.
    pub fn row(&mut self, sensor: &[u16; COLUMNS], mut finished: impl FnMut(&[u8; COLUMNS])) {
        pass(&mut self.stages, sensor, &mut finished);
    }

    /// Hands out the rows that are left. What comes next begins a new frame.
    pub fn end_frame(&mut self, mut finished: impl FnMut(&[u8; COLUMNS])) {
        let mut stages = self.stages.as_mut_slice();
        while let Some((stage, later)) = stages.split_first_mut() {
            if let Some(last) = stage.last() {
                for _ in 0..REACH {
                    if let Some(row) = stage.push(&last) {
                        pass(later, &row, &mut finished);
                    }
                }
            }
            stage.end_frame();
            stages = later;
        }
    }
}

/// Through all stages that are left, and out.
fn pass<const COLUMNS: usize>(
    stages: &mut [RunningStage<COLUMNS>],
    row: &[u16; COLUMNS],
    finished: &mut dyn FnMut(&[u8; COLUMNS]),
) {
    match stages.split_first_mut() {
        Some((stage, later)) => {
            if let Some(row) = stage.push(row) {
                pass(later, &row, finished);
            }
        }
        // Rounded; 255 at most.
        None => finished(&row.map(|level_q8| (level_q8.saturating_add(128) >> 8) as u8)),
    }
}
