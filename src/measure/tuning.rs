//! Numbers that were chosen rather than derived, and the tests in `host_tests/measure.rs` that break when they are
//! wrong.

/// Stamps that are looked at together before any is trusted. Of nine, two may be wrong: fewer than half of the 36
/// slopes between them are. More would only delay the first answer (`late_interrupts_and_missed_ones_do_no_harm`).
pub(super) const ACQUISITION_STAMPS: usize = 9;

/// Pairs of those stamps.
pub(super) const ACQUISITION_PAIRS: usize = ACQUISITION_STAMPS * (ACQUISITION_STAMPS - 1) / 2;

/// The first gate in deviations that two thirds of the stamps do not exceed. Of nine honest stamps, 0.4 % of all sets
/// have one beyond eight; of six to eight, 0.1 % to 0.3 % beyond 24. Fewer than six do not show which of them is
/// wrong: all are used, and their scatter widens sigma (`two_sigma_hold_what_they_say`,
/// `scatter_that_few_stamps_show_widens_sigma`).
pub(super) const FULL_GATE_DEVIATIONS: i64 = 8;
pub(super) const PARTIAL_GATE_DEVIATIONS: i64 = 24;
pub(super) const FEWEST_TO_TELL_OUTLIERS: usize = 6;

/// Stamps whose deviation is more than a quarter of the widest gate have no period: those of noise lie anywhere in the
/// gate, half its width off on average (`noise_is_no_period`).
pub(super) const LEAST_DEVIATIONS_IN_WIDEST_GATE: i64 = 4;

/// The gate in mean deviations from the prediction: six sigma. A narrower one would cut into honest jitter, and the
/// stated sigma would be too small (`two_sigma_hold_what_they_say`).
pub(super) const GATE_DEVIATIONS: i64 = 8;

/// No gate below three ticks: rounding to whole ticks alone moves a stamp by half a tick and its prediction by one.
pub(super) const LEAST_GATE_TICKS: i64 = 3;

/// Nor above a quarter of a period, or above 1/16 of a turn of the counter: beyond, a stamp belongs to neighbours as
/// well.
pub(super) const WIDEST_GATES_PER_PERIOD: i64 = 4;
pub(super) const WIDEST_GATES_PER_TURN: i64 = 16;

/// How much of a stamp's error moves the predicted phase, as a shift: a quarter, so that jitter averages out.
pub(super) const PHASE_GAIN_SHIFT: u32 = 2;

/// How much of it moves the predicted period: 1/64, well damped beside a phase gain of a quarter.
pub(super) const PERIOD_GAIN_SHIFT: u32 = 6;

/// How fast the mean deviation follows: over 16 stamps. Of each stamp no more than three mean deviations count, or
/// one late stamp that slips in would widen the gate for the next (`late_interrupts_and_missed_ones_do_no_harm`).
pub(super) const DEVIATION_SHIFT: u32 = 4;
pub(super) const MOST_DEVIATIONS: i64 = 3;

/// An interval is half of another to within an eighth.
pub(super) const SHARE_OF_A_HALF: i64 = 8;

/// An outlier counts two, a stamp that fits takes one off: above a third of outliers, or with sixteen in a row, the
/// mode has changed, or a long gap was not told. Then it begins anew (`another_mode_is_noticed`).
pub(super) const STRANGE: u8 = 2;
pub(super) const TOO_STRANGE: u8 = 32;

/// Periods longer than a turn of the counter: so many may be missed. Each more is another place where a late stamp
/// fits by chance (`a_frame_longer_than_a_turn_of_the_counter`).
pub(super) const MISSED_BEYOND_A_TURN: i64 = 4;

/// A straight piece ends after so many stamps or periods, before the sums of its squares could overflow.
pub(super) const PIECE_STAMPS: i64 = 1024;
pub(super) const PIECE_PERIODS: i64 = 1 << 14;

/// Beyond so many degrees of freedom the past counts half: a period drifts with the temperature.
pub(super) const LONGEST_MEMORY: i64 = 1 << 20;
