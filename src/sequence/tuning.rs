//! Every number of this stage that was chosen rather than derived.

// Which line is which edge (docs/model.md, section 8.6)

/// Largest distance at which a line is still the edge, in sigmas: chance leaves out one of 3000
/// (`cargo test where_a_line_runs_on_past_a_known_edge` with half and twice as many).
pub(super) const GATE_SIGMAS: i32 = 4;

/// One sigma of how much the contrast of an edge changes from frame to frame, in hundredths of itself: 0.07 for two
/// thirds of real edges and 0.26 for all but one of 20, while those of different edges differ by a factor of three
/// (`cargo test contrast_tells_edges_apart`).
pub(super) const CONTRAST_PERCENT: i32 = 15;

/// A contrast counts for no more sigmas than this: backgrounds and lights change.
pub(super) const MOST_CONTRAST_SIGMAS: i32 = 3;

/// So far off may a line of the edge be for each sigma of the gate, in quarters of a pixel: edges bend, backgrounds and
/// neighbours draw their columns aside, and what moves should still be recognised
/// (`cargo test a_moving_object_looks_static` with half).
pub(super) const OFF_QUARTERS_PX: i32 = 3;

/// Error of a line's own column, in tenths of a pixel: what real edges wander in the median
/// (`cargo test a_clean_sequence_is_steady` with none).
pub(super) const COLUMN_DECIPIXELS: i32 = 1;

/// A line more sigmas off than this is not where a static edge can be
/// (`cargo test what_is_stated_of_the_motion_is_no_discontinuity` with half, `cargo test a_moving_object_looks_static`
/// with twice as many).
pub(super) const STATIC_SIGMAS: i32 = 5;

/// A third frame that is more sigmas off does not go on from two whose time was unsure: five would leave a depth that
/// is as many sigmas off (`cargo test a_frame_lost_before_the_second`).
pub(super) const DOUBTFUL_SIGMAS: i32 = 3;

/// Parts of an edge wander from its line, one sigma as a part of a pixel: 0.1 px in the median of real edges, 0.21 px
/// in one of ten (`cargo test where_a_line_runs_on_past_a_known_edge` with half as many parts).
pub(super) const WANDER_PARTS_PX: i32 = 4;

/// Half the width of the strip beside a prediction in which parallel lines are counted.
pub(super) const STRIP_PX: i32 = 32;

/// Two edges nearer than this shift each other's columns: the spread functions of both
/// (`cargo test association_is_by_prediction` with twice as much).
pub(super) const NEAR_PX: i32 = 8;

/// Fewer samples do not tell bearing, depth and tilt.
pub(super) const LEAST_SAMPLES: usize = 3;

// When an edge is told, and when it is forgotten

/// A line that stands out of the texture around by less than so many times what a single frame asks for waits for these
/// frames: in a drive through texture there are many single frames (`cargo test what_stands_out_a_little_waits`).
pub(super) const CLEAR_TIMES: u64 = 2;

/// Frames that must agree on an edge that no single one shows well: in two, time and depth are the same
/// (`cargo test waits_for_three_frames`).
pub(super) const TELLING_FRAMES: u32 = 3;

/// Tentative edges of a frame that may come to be told although their lines agree by chance: an upper bound, since most
/// lines are those of edges.
pub(super) const CHANCE_EDGES: i32 = 1;

/// Frames in a row that must agree with a static edge before one that has moved counts as static again: a second, at
/// usual rates (`cargo test what_has_moved_is_static_again`).
pub(super) const HOLD_OFF_FRAMES: u16 = 30;

/// A landmark that is missed in more frames in a row is forgotten: a second, at usual rates
/// (`cargo test what_is_hidden_is_remembered`).
pub(super) const MOST_MISSED: u16 = 30;

/// One sigma of the time between two frames which no other edge has shown to be right, as a part of it: after a lost
/// frame all is twice as far as it seems, which is within two sigma of an inverse depth that is good to this part
/// (`cargo test a_torn_frame_between_the_first_two`).
pub(super) const UNSURE_TIME: (i32, i32) = (3, 10);

/// How far backgrounds and neighbours that change from frame to frame draw the column of a whole edge aside, in units
/// of the roughness of edges: 0.09 px in the median of real edges, at 0.03 px of roughness
/// (`cargo test the_wander_of_an_edge_is_common` with half).
pub(super) const DRIFT_PER_ROUGHNESS: i32 = 3;

// Frames that do not follow on (section 8.9)

/// Edges that are asked; more tell it no better.
pub(super) const MOST_ASKED: usize = 32;

/// Fewer edges tell nothing of all.
pub(super) const LEAST_ASKED: i32 = 4;

/// Beyond so many sigmas in common the edges are off alike.
pub(super) const ALIKE_SIGMAS: i32 = 5;

/// A single edge counts for no more sigmas than this: one that moves does not speak for all.
pub(super) const MOST_SIGMAS_EACH: i32 = 3;

/// Frames for which an edge that is asked may have been hidden.
pub(super) const MOST_HIDDEN: u16 = 2;

/// Bins of the vote, and how many make an interval: from 1.6 intervals early to 1.6 late.
pub(super) const BINS: i32 = 64;
pub(super) const BINS_EACH: i32 = 20;

/// In two frames, one interval, time and depth are the same: edges that more frames have shown tell the time.
pub(super) const LEAST_FRAMES: u32 = 3;

/// A vote is sure to a part of an interval: of one that is less so, speed along the row and depth go together.
pub(super) const SURE_PART: i32 = 8;

/// Pairs within so many hundredths of an interval count: first those of the bins around the best one, then nearer ones.
pub(super) const WINDOWS: [i32; 3] = [10, 6, 4];

/// The lines that have told the time are those that then update the edges: not quite twice the evidence.
pub(super) const COUNTED_TWICE: i32 = 2;

// The vertical, learned (section 8.8)

/// A camera is level within 15°, two sigma.
pub(super) const LEVEL_CENTIRADIANS: i32 = 13;

/// Beyond this no vertical is sought: a cosine of 20°.
pub(super) const MOST_TILTED_PERCENT: i32 = 94;

/// So many lines, the longest of a frame, seek the vertical together.
pub(super) const LONGEST: usize = 48;

/// Lines that agree on a vertical, or it is not told.
pub(super) const LEAST_EDGES: usize = 5;

/// Lines within so many thousandths of a radian agree on a vertical: skew and lean spread them.
pub(super) const AGREE_MILLIRADIANS: i32 = 15;

/// Inverse depth of what a camera sees, and one sigma of it, in tenths per metre: nearer than that is rare.
pub(super) const USUAL_DECI_PER_M: i32 = 3;

/// Rounds of the reweighted least squares.
pub(super) const ROUNDS: usize = 12;

/// How fast a vertical becomes uncertain, in thousandths of a radian per second: mounts give way, wheels roll over
/// bumps.
pub(super) const DRIFT_MILLIRADIANS_PER_S: i32 = 5;

/// Better is never claimed, in ten thousandths of a radian: house fronts lean together.
pub(super) const LEAST_SIGMA_E4: i32 = 5;
