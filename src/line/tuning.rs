//! The numbers of this room that were chosen rather than derived: unit, reason, and the tests that watch them.

/// Half sigmas. A line is one by chance unless its mean contrast exceeds that of parallel lines around by 4.5 of their
/// deviations: a frame has some 10⁵ places for a line (`false_distances::of_clutter`, and fewer real edges with more).
pub(super) const CHANCE_SIGMAS_Q1: u64 = 9;

/// Mean square of what texture scatters about a line that it makes by chance, in 1/2³² px²: half a pixel
/// (`line::prominence::tests::a_straight_line_is_none_by_chance`).
pub(super) const CHANCE_SCATTER_Q32: u64 = 1 << 30;

/// Texture has longer tails than normal values, of which the mean of many rows keeps nothing: for so many rows the
/// limit above is doubled, for fewer it is more (`false_distances::of_texture`, `false_distances::of_clutter`).
pub(super) const TAIL_ROWS: u64 = 40;

/// Half sigmas. A halo exceeds so many of what noise makes of it (`false_distances::of_clutter` with less,
/// `real_cameras::sharpened_frames_said_to_be_linear` with more).
pub(super) const HALO_SIGMAS_Q1: u64 = 4;

/// How far the share of a step that lies within two pixels of an edge may be off in a look, in deviations of a step, in
/// 1/256: three sigma of texture, which moves the share by a third of what it adds to the step, and is alike in two looks
/// (`false_distances::of_clutter` with twice as much).
pub(super) const SHARE_SIGMAS_Q8: u32 = 320;

/// A Gaussian's variance, in 1/65536 square pixel, times what of that share is beyond a half, over what it lacks of one;
/// its deviation so follows to 3 % from 0.8 to 2.5 px. A box of the same variance leaves less of the step near
/// (`line::prominence::tests::the_blur_is_no_longer_than_that`).
pub(super) const GAUSSIAN_VARIANCE_Q16: u32 = 72_090;

/// Below this share, in 1/4096, nothing is told: rounding and levels that are not linear make as much of a long slope
/// (`line::prominence::tests::the_blur_is_no_longer_than_that`).
pub(super) const LEAST_SHARE_Q12: u32 = 2376;

/// Least variance of a blur that is told from it, in 1/65536 square pixel: sharpening, too, makes steps steep
/// (`line::prominence::tests::the_blur_is_no_longer_than_that`).
pub(super) const LEAST_VARIANCE_Q16: u32 = 1 << 16;

/// Rows that err alike: blur, levels and rounding are common to some of them
/// (`clutter::crossing_bars_lead_no_line_astray`).
pub(super) const ROWS_ALIKE: u32 = 2;

/// Likewise beside texture: 2 to 4 were found in gravel, 8 where its cells are 12 px high
/// (`false_distances::of_texture`).
pub(super) const ROWS_ALIKE_IN_TEXTURE: u32 = 8;

/// Where the texture around a line is looked at in its first row, in pixels beyond its blur: within a few gates, on
/// either side.
pub(super) const AROUND_PX: [i32; 8] = [-8, 12, -16, 20, -24, 28, -32, 36];

/// Later the line and one of the first so many of these places, in turn, are looked at in every so many rows, so that
/// each place is seen again after 16 rows: texture has changed by then, and other upright edges hardly
/// (`false_distances::of_texture` with fewer, fences with more). Rows between these are alike in texture
/// (`cargo xtask budget --use "two bars"`).
pub(super) const LOOK_PLACES: usize = 4;
pub(super) const LOOK_ROWS: u16 = 4;

/// So many changes tell how much the texture changes; with fewer, everything around a line counts as texture, also
/// upright edges (`false_distances::of_texture`).
pub(super) const LEAST_CHANGES: u16 = 8;

/// A line is stitched to another whose contrast is at least all but one of so many parts of its own: texture passes for
/// the rest of an edge where its place alone decides
/// (`line::prominence::tests::lines_of_another_contrast_are_not_alike`).
pub(super) const LIKE_PARTS: i64 = 3;

/// The filter's gain falls with the number of points down to this one's, so that it can follow a curve; fewer where
/// rows are sparse (`tracking::curved_edges_are_one_line`).
pub(super) const MEMORY_POINTS: u32 = 64;
pub(super) const LEAST_MEMORY_POINTS: u32 = 16;

/// Rows without an edge after which a line of pixels is hidden: its model would soon take texture for it
/// (`frames::a_line_goes_on_behind_a_rail`).
pub(super) const MOST_GUESSED_ROWS: u16 = 4;

/// A line goes on where its polarity has changed, as along a pole painted red and white, only after so many rows: blur
/// hides the edge for two (`painted` with one).
pub(super) const MOST_FLIP_ROWS: u16 = 4;

/// Where there is no room to stitch, a hidden line is looked for in every so many rows: they are most lines of a full
/// table (`cargo xtask budget --use clutter`, `frames::a_line_goes_on_behind_a_rail_when_the_table_is_full`).
pub(super) const HIDDEN_ROWS: u16 = 4;

/// A line of fewer points does not tell how steep it is; one of more is one of its own
/// (`frames::a_line_goes_on_behind_a_rail`, `clutter::posts_above_each_other_stay_two_edges`).
pub(super) const LEAST_STITCH_POINTS: u16 = 8;
pub(super) const MOST_STITCH_POINTS: u16 = 32;

/// However noisy the edges are, what goes on is no farther off than this, in 1/65536 px, and its slope parts from the
/// older line's by no more over the rows between them, or over so many where these are fewer: beyond it some edge is
/// always found in a busy scene (`line::continuation::tests::what_is_beside_or_turned_is_another_edge`).
pub(super) const MOST_STITCH_OFF_Q16: u32 = 2 << 16;
pub(super) const LEAST_TURN_ROWS: u16 = 16;

/// A slope's difference that is no turn, in 1/65536 px per row (`frames::a_line_goes_on_behind_a_rail`).
pub(super) const NO_TURN_Q16: u32 = 1 << 10;

/// Points in succession that the model has not located, after which it is made anew: it was made from something else
/// (`frames::bars_are_found_through_long_motion_blur`).
pub(super) const MOST_UNEXPECTED_POINTS: u8 = 8;

/// From so many points on they tell how much they scatter, as a mean over the second number of points
/// (`clutter::crossing_bars_lead_no_line_astray`).
pub(super) const SCATTER_POINTS: u16 = 12;
pub(super) const SCATTER_MEMORY_POINTS: u32 = 24;

/// Half a pixel, in 1/65536 px: what scatters more is no edge (`clutter::crossing_bars_lead_no_line_astray`).
pub(super) const MOST_SCATTER_Q16: u16 = 1 << 15;

/// No gate is wider, in 1/65536 px: that of a line whose rows are so sparse that it would take any point.
pub(super) const MAX_GATE_Q16: u32 = 48 << 16;

/// The gate of a line that its model locates changes slowly: it is taken anew once in so many points
/// (`clutter::crossing_bars_lead_no_line_astray`, `cargo xtask budget --use "two bars"`).
pub(super) const GATE_POINTS: u16 = 16;

/// A line that jumps ends, and begins again, within so many rows: each is found or lost a row or two late
/// (`jumps::missing_rows_are_noticed`).
pub(super) const JUMP_ROWS: u16 = 3;

/// Points of a line that begins after a jump when it is asked for, and least of one before: by then all have begun
/// (`jumps::mixed_frames_are_noticed`).
pub(super) const YOUNG_POINTS: u16 = 8;

/// A displacement of less than a pixel is no jump, in 1/65536 px: lines follow it (`jumps::whole_frames_do_not_jump`).
pub(super) const LEAST_JUMP_Q16: i64 = 1 << 16;

/// Two displacements within this are the same, in 1/65536 px: the columns of a line that ends and of one that begins
/// are each known to about half a pixel (`jumps::lost_bytes_are_noticed`).
pub(super) const SAME_JUMP_Q16: u64 = 3 << 15;

/// Rows by which frames that are mixed may differ: no frame is longer, and products with a slope stay small
/// (`jumps::mixed_frames_are_noticed`).
pub(super) const MOST_JUMP_ROWS: i64 = 1 << 15;

/// Of the lines that break off so many stand for all, and so many are asked where they go on: with all of them the work
/// of a row would grow with the fourth power of their number, and with one that is wrong no jump is seen
/// (`jumps::lost_bytes_are_noticed`, `jumps::a_fence_that_is_torn_is_noticed`).
pub(super) const MOST_BROKEN: usize = 8;
pub(super) const MOST_ASKED: usize = 3;

/// Farther than this an edge does not move between two pulses of light, in 1/65536 px: 10 ms at 3 m/s past a post 1 m
/// away (`jumps::pulsed_light_is_noticed`).
pub(super) const MOST_PULSE_Q16: i64 = 16 << 16;

/// A jump is none by chance where that makes one in 10⁵ rows in which lines break off, in 1/2³²
/// (`jumps::whole_frames_do_not_jump`, `clutter::texture_is_no_bar`).
pub(super) const MOST_CHANCE_Q32: u64 = (1 << 32) / 100_000;

/// Edges make steps within so many rows of where the light changes: as many as a short pulse takes to come, and as a
/// line that begins needs to tell where (`pulsed::pulsed_light_of_every_kind` with half as many).
pub(super) const STEP_ROWS: u16 = 24;

/// Light that cuts lines lets no more than so many times as many go on (`pulsed::pulsed_light_is_noticed` with one,
/// `steady_light::what_stands_still_in_steady_light_is_far` with five).
pub(super) const CUT_SHARE: u32 = 3;

/// Less than this is no step, in 1/65536 px: lines that break off in the dark go on in their place to half a pixel
/// (`pulsed::pulsed_light_is_noticed` with twice as much).
pub(super) const LEAST_STEP_Q16: i64 = 3 << 14;

/// So many more lines make a step to one side than begin elsewhere: with four, three of ten thousand frames in steady
/// light are torn (`steady_light::ten_thousand_frames_are_not_torn`; `pulsed::pulsed_light_is_noticed` with twice as
/// many).
pub(super) const LEAST_STEPS: i8 = 5;

/// A line may go on a step aside in a row so many rows from where it breaks off, in either direction: where pulses come and
/// go at the same time, one image of an edge fades while the next one grows; and it is looked for so many rows later, when
/// that has become a line (`pulsed::pulsed_light_is_noticed` with a quarter of either).
pub(super) const SUCCESSOR_ROWS: u16 = 24;
pub(super) const SUCCESSOR_DELAY_ROWS: u16 = 12;

/// So many lines, such a share of those that break off, and more than so many times as many as to the other side, go on a step
/// to one side: of a busy picture's lines half do by chance, to either side (`pulsed::pulsed_light_is_noticed` with two more,
/// `line::pieces::tests::most_make_steps_to_one_side`).
pub(super) const LEAST_PIECES: u8 = 2;
pub(super) const PIECES_SHARE: (u16, u16) = (2, 3);
pub(super) const PIECES_RATIO: u16 = 2;

/// What may begin is looked for in every so many rows: that is most of what an empty row costs, and a line is found so
/// much later at most (`frames::a_post_is_found_in_single_precision`, `cargo xtask budget --use flat`).
pub(super) const LOOK_FOR_NEW_ROWS: u16 = 3;

/// Beside located lines every so many rows are looked at: an edge that begins there is found that much later; each look
/// costs as much as locating its line (`cargo xtask budget --use "two bars"`).
pub(super) const LOOK_BESIDE_ROWS: u16 = 2 * LOOK_FOR_NEW_ROWS;

/// A scanned point so near to a line without blur, in 1/65536 px, is the line's own even if the line has one already: a
/// part of an edge that noise has broken (`parallel_edges::a_step_beside_one_three_times_as_strong_is_a_line` with twice;
/// `clutter::crossing_bars_lead_no_line_astray` with neither this nor two sigma of blur).
pub(super) const LEAST_NEAR_Q16: i32 = 3 << 15;

/// Where no place is free for another line, a row is scanned around those under way: this far beyond their gates, in
/// 1/65536 px, as far as the scanner's window of an edge reaches, and one beside which it is not read.
pub(super) const BESIDE_Q16: u32 = 13 << 16;

/// At most so many scanned points are refined in one row, since each costs more than a row of a line: those of other
/// lines when it is their turn (`frames::short_bars_are_found_in_a_clear_view` with 8); and one
/// for each line beyond 16, since larger images have more edges.
pub(super) const fn refined_a_row(lines: usize) -> u16 {
    10 + lines.saturating_sub(16) as u16
}

/// At most so many lines get a model in one row, since each costs as much as a dozen rows of a line, the first look
/// around included: the newest, since older ones may have no edge that a model can have. The points of the others are
/// refined alone until it is their turn (`fences::edges_of_fences_are_lines` with 2); of large tables for a
/// sixteenth of the lines.
pub(super) const fn models_a_row(lines: usize) -> usize {
    const LEAST: usize = 3;
    let part = lines / 16;
    if part > LEAST { part } else { LEAST }
}

/// A line is not straight where it departs by more than this from the way between its ends, in 1/65536 px, and by so
/// many sigmas of what is averaged there: real edges wander by less (`line::split::tests::straight_lines_stay_whole`).
pub(super) const LEAST_KINK_Q16: u64 = 1 << 17;
pub(super) const KINK_SIGMAS: u64 = 6;

/// Likewise of a line of which fewer rows show it than this share: where they miss, another edge may go on
/// (`line::split::tests::broken_lines_turn_sooner` with half of either).
pub(super) const LEAST_BROKEN_KINK_Q16: u64 = 1 << 15;
pub(super) const UNBROKEN_SHARE: (u32, u32) = (7, 8);

/// What goes on beyond a gap of more than so many rows for each of its points does so by chance
/// (`line::split::tests::a_line_ends_before_a_gap_beyond_which_hardly_anything_follows`; with one
/// `false_distances::of_clutter`).
pub(super) const MOST_GAP: (u32, u32) = (3, 2);

/// What is straight stays within this of one line, in 1/65536 px, or within one of so many parts of what the whole
/// departs: more than real edges wander, and less than what would bend a part
/// (`line::split::tests::straight_parts_wander_but_do_not_bend` with half and twice as much,
/// `line::split::tests::straight_parts_of_lines_that_turn_far_may_be_bent` with more parts).
pub(super) const STRAIGHT_Q16: u64 = 1 << 14;
pub(super) const STRAIGHT_PARTS: u64 = 12;

/// A straight part has at least such a share of the points (`splitting::a_line_ends_where_its_edge_turns` with 2/3).
pub(super) const LEAST_SHARE: (u32, u32) = (3, 10);

/// What stays within one of so many parts of what it departs, and so many sigmas, of a parabola is a curve: it has no
/// straight part (`line::split::tests::curves_stay_whole`).
pub(super) const CURVE_PARTS: u64 = 8;
pub(super) const CURVE_SIGMAS: u64 = 3;

/// Two knots always lie on a straight line (`line::split::tests::what_is_straight_nowhere_stays_whole`).
pub(super) const LEAST_STRAIGHT_KNOTS: usize = 3;

/// A part of fewer points is none: two lengths of roughness, without which nothing tells the end of an edge that frays
/// from another edge (`line::table::tests::short_parts_are_no_lines`).
pub(super) const LEAST_PART_POINTS: u16 = 32;
