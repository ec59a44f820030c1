//! Numbers that were chosen rather than derived, and the tests that break when they are wrong.

/// Bands of fewer periods in a frame are not told from a scene that changes: the main lobe of the taper is two periods
/// wide (`host_tests/flicker.rs`, `too_few_periods`).
pub(super) const LEAST_PERIODS: i32 = 2;

/// A peak of the spectrum must exceed its floor as seldom by chance as a normal variate six sigma: once in 10⁹ bins
/// (`noise_has_no_bands`).
pub(super) const PEAK_SIGMAS: i32 = 6;

/// The fundamental is the peak that has most of the others among so many harmonics: in bands that nearly stand still,
/// pulses show their high harmonics best (`harmonics_are_resolved`).
pub(super) const FAMILY: i32 = 16;

/// Harmonics that are looked at where they may disturb the fundamental: those nearest to it.
pub(super) const HARMONICS: i32 = 4;

/// Candidates for the fundamental: the highest peaks. A fundamental that is not among them is weaker than as many of
/// its harmonics, which the share below would refuse anyway.
pub(super) const CANDIDATES: usize = 16;

/// A fundamental has at least this share (1/50) of the power of its first harmonics. Where bands nearly stand still
/// from frame to frame, the differences show harmonics the more the higher they are, and a strobe's fundamental has
/// 1/30; a lamp whose two half waves differ has a little power at half its frequency, which is not its fundamental
/// (`a_lamp_with_uneven_half_waves`).
pub(super) const LEAST_SHARE: (i32, i32) = (1, 50);

/// The pairs of frames must agree to within so many times their own sigmas, as a root mean square; beyond, they are not
/// frames of one camera in one mode (`frames_that_disagree`).
pub(super) const MOST_SCATTER: i32 = 30;

/// An exposure within this (1/33) of a whole number of periods leaves less than 3 % of the bands
/// (`exposure_of_a_multiple`).
pub(super) const NEAR_A_MULTIPLE: (i32, i32) = (1, 33);

/// A pass that is off by more than four robust sigmas, and more where there are few, is an outlier; never more than a
/// third of them (`outliers_are_found`).
pub(super) const OUTLIER_SIGMAS: i32 = 4;

/// Rounds of least absolute deviations, which outliers do not draw towards themselves; the weights have settled long
/// before.
pub(super) const REWEIGHTING_ROUNDS: usize = 16;

/// Passes that fit worse than this many times their stated sigmas contradict each other: a sign, a unit or a column is
/// wrong. Speeds that are ten times worse known than stated still pass (`contradictory_passes`).
pub(super) const MOST_MISFIT: i32 = 10;

/// What is known beforehand of a gyroscope's clock, one sigma: 0.1 s. More has to be found in the driver
/// (`at_rest_there_is_roll_and_no_offset`).
pub(super) const OFFSET_PRIOR: (i32, i32) = (1, 10);

/// Lines that lean by more than 15° are no upright edges (`leaning_bars_are_left_out`).
pub(super) const STEEP: (i32, i32) = (268, 1000);

/// Leans that remain beyond so many times what was stated follow neither clock nor gravity
/// (`a_wrong_sign_is_inconsistent`).
pub(super) const MOST_IMU_MISFIT: i32 = 5;
