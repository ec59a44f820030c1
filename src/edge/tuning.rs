//! The numbers of this room that were chosen rather than derived: unit, reason, and the test that breaks without them.

use core::ops::Range;

/// Least noise: that of rounding to whole grey levels, in 1/256 (`scanning::noise_is_estimated`).
pub(super) const LEAST_NOISE_Q8: u32 = 74;

/// A row of fewer stretches is looked at four times as often in its first row, so that an edge in one of them is not
/// what is usual (`scanning::the_first_row_shows_a_single_edge`).
pub(super) const FEW_STRETCHES: usize = 3;

/// Columns of a row in which it is compared with those before (`scanning::fences_are_edges`).
pub(super) const DOWN_COLUMNS: usize = 8;

/// Columns in which the light is looked at, in every other row: the two kinds of rows of a mosaic differ
/// (`cargo xtask budget --use flat` with more).
pub(super) const LIGHT_COLUMNS: usize = 8;
pub(super) const LIGHT_ROWS: u16 = 2;

/// Light has changed where it has by one of so many parts, and by so many grey levels, of which an edge that passes one
/// of the columns makes as much (`edge::light::tests`).
pub(super) const LIGHT_CHANGE: u16 = 8;
pub(super) const LEAST_LIGHT: u16 = 4;

/// And by so many sigmas of a pixel: by five of the difference of two sums of eight
/// (`edge::light::tests::noise_is_no_light` with half as many).
pub(super) const LIGHT_SIGMAS: u32 = 20;

/// Once in so many rows, since each comparison costs some two hundred instructions a column
/// (`scanning::fences_are_edges`).
pub(super) const DOWN_ROWS: u8 = 32;

/// At first, one time after the other: so many tell what is usual to a fifth (`fences::edges_of_fences_are_lines`).
pub(super) const SETTLED_LOOKS: u8 = 8;

/// Later ones move it by one part in one more than this (`scanning::the_threshold_follows_the_noise`).
pub(super) const MEMORY_LOOKS: u32 = 3;

/// Texture is what changes over so many rows: as far down as the windows of the scanner are apart across
/// (`clutter::texture_is_no_bar`).
pub(super) const TEXTURE_LAG: u8 = 4;

/// What is usual across a row is that of upright edges where it is so many times what is usual down the rows: the two
/// are good to a factor of 1.7 each (`scanning::fences_are_edges`, `scanning::noise_is_no_edge`).
pub(super) const UPRIGHT_RATIO: u32 = 3;

/// Least difference of two sums of four pixels that counts: six grey levels of contrast
/// (`frames::faint_and_noisy_bars_are_found`).
pub(super) const LEAST_DIFFERENCE: u32 = 24;

/// A row in which an edge of so many grey levels of contrast is hidden by what is usual cannot be read: a quarter of
/// all levels (`fences::rows_that_cannot_be_read_are_counted`).
pub(super) const MOST_HIDDEN: u32 = 64;

/// A difference counts if it exceeds so many sigma of what is usual (`scanning::the_threshold_follows_the_noise`).
pub(super) const NOISE_SIGMAS: u32 = 4;

/// Where that is texture, more than twice the noise, so many do: what is usual in the whole row says little of a place,
/// and which lines are texture is decided along them (`fences::edges_of_fences_are_lines` with four; with two of them
/// texture hides the edges).
pub(super) const TEXTURE_SIGMAS: u32 = 3;

/// Where texture elsewhere in the row asks for more, so many sigma of noise are enough where it is quiet
/// (`clutter::faint_bars_where_it_is_quiet` with twice as many).
pub(super) const QUIET_SIGMAS: u32 = 6;

/// It is quiet where in so many looks no more than a quarter of sixteen spans of eight pixels have differed by as much: a
/// shorter while, or half of them, may be texture (`false_distances::of_texture` and `false_distances::of_clutter` with
/// either).
pub(super) const MOST_QUIET: u32 = 4;
pub(super) const QUIET_LOOKS: u8 = 8;

/// A look is taken in every so many scanned rows, since it is another scan of the row
/// (`cargo xtask budget --use clutter`).
pub(super) const QUIET_TURNS: u8 = 3;

/// It is followed in so many groups of these spans, from the left: in the first 2048 pixels of a row, since each takes a
/// byte of the scanner (`knots::sizes_in_memory_are_as_documented` with twice as many).
pub(super) const QUIET_GROUPS: usize = 16;

/// The largest difference of an edge exceeds so many halves of a sigma of noise: four sigma are exceeded by chance in
/// every hundredth row of 160 places (`scanning::noise_is_no_edge`).
pub(super) const PEAK_SIGMAS_Q1: u32 = 9;

/// Least share of a step that lies between two pixels where each has been made black or white; a lens of 0.3 px,
/// sharper than any, leaves three quarters there at most (`thresholded::jumps_of_a_pixel_are_not_far` with more than
/// all).
pub(super) const ABRUPT: (u32, u32) = (15, 16);

/// What a row shows so wide, in 1/256 px, may be more than one step. Two that are 4 px apart are 1.7 px wide where one
/// is three times the other, and two equal ones that are 8 px apart are 4.5 px wide at a blur of 2 px
/// (`parallel_edges::two_equal_steps_are_two_lines`). Beyond, noise breaks the slope of a long blur
/// (`parallel_edges::one_blurred_edge_is_one_line`, `frames::bars_are_found_through_long_blur_and_noise` with twice as
/// much); below, it is one step.
pub(super) const STAIRCASE_Q8: Range<u16> = 3 << 7..9 << 7;

/// Between two steps the slope falls, and rises again, by at least so many eighths of the difference of an edge: two and
/// a half sigma of it (`parallel_edges::fainter_steps_are_two_lines` with six,
/// `parallel_edges::one_blurred_edge_is_one_line` with four); and by so many grey levels of two pixels, of which
/// rounding explains four (`parallel_edges::one_blurred_edge_is_one_line` with two).
pub(super) const RISE_Q3: u32 = 5;
pub(super) const LEAST_RISE: u32 = 6;

/// And by one in so many parts of what is left between them, so that this is three quarters of either at most
/// (`parallel_edges::an_uneven_slope_is_one_edge`, `parallel_edges::two_equal_steps_are_two_lines`).
pub(super) const RISE_PARTS: i32 = 3;

/// Two lines of one polarity are two edges where they are so much farther apart than two sigma of their blur: of what
/// noise breaks the parts are nearer to each other (`clutter::crossing_bars_lead_no_line_astray` with two sigma,
/// `parallel_edges::two_equal_steps_are_two_lines` with five).
pub(super) const APART: (u32, u32) = (5, 4);

/// Neighbouring classes of blur differ by this ratio: a template that is 7 % too wide or too narrow costs less than 0.5
/// % of the column's noise (`edge::refine::tests::widths_are_unbiased_and_as_noisy_as_stated`).
pub(super) const CLASS_RATIO: (u16, u16) = (23, 20);

/// Blur of a sharp lens, half a pixel, and of the pixel itself, in 1/256 px (`frames::sigma_is_honest`).
pub(super) const LEAST_BLUR_Q8: u16 = 148;

/// What an edge is taken to be blurred at least before more is known, in 1/256 px: by a usual lens and the pixel
/// (`frames::sigma_is_honest`).
pub(super) const USUAL_BLUR_Q8: u16 = 195;

/// Longest blur that is told from a slope of the brightness, in 1/256 px
/// (`frames::bars_are_found_through_long_motion_blur`).
pub(super) const MOST_BLUR_Q8: u16 = 12 << 8;

/// Variance of a usual lens's blur of 0.7 px, in 1/65536 square pixel; more is motion
/// (`edge::refine::tests::widths_are_unbiased_and_as_noisy_as_stated`).
pub(super) const LENS_VARIANCE_Q16: i32 = 32113;

/// Beyond this blur, in 1/256 px, the scanner tells the width only roughly, and a row on its own is fitted in several
/// steps (`frames::bars_are_found_through_long_motion_blur`).
pub(super) const LONG_BLUR_Q8: u16 = 4 << 8;

/// Pixels of plateau on either side that tell its level, beside as many as the flank's half has: the longer the blur,
/// the more a wrong level shifts the edge (`frames::sigma_is_honest`).
pub(crate) const PLATEAU: i32 = 4;

/// Beside texture a plateau counts as so many pixels of the flank: with none, columns change where a row is found to be
/// beside texture; with two, what crosses the plateau shifts the edge
/// (`edges_beside_texture::their_columns_are_those_of_all_frames`, `clutter::crossing_bars_lead_no_line_astray`).
pub(super) const TEXTURED_PLATEAU: i32 = 1;

/// Most steps in which levels and blur of an edge are found each from the other: long ones settle in four or five
/// (`frames::bars_are_found_through_long_motion_blur`).
pub(super) const MOST_SETTLING_STEPS: usize = 6;

/// Most steps after the first from where an edge is expected to where it is
/// (`frames::bars_are_found_through_long_motion_blur`).
pub(super) const MOST_CORRECTIONS: usize = 3;

/// Least contrast of an edge, in 1/256 grey level, below the scanner's six levels
/// (`frames::faint_bars_without_noise_are_not_bent`).
pub(super) const LEAST_CONTRAST_Q8: i32 = 4 << 8;

/// How far a neighbour may bias the scanner's column of an edge, in 1/65536 px
/// (`frames::a_rod_three_pixels_wide_has_the_right_depth_and_shifted_sides`).
pub(super) const MOST_DRAWN_Q16: u32 = 5 << 14;

/// How far apart the scanner and a line may find one edge, in 1/65536 px
/// (`edge::window::tests::an_edge_that_is_found_twice_is_one`).
pub(super) const SAME_EDGE_Q16: u32 = 1 << 16;

/// An edge that a row shows on its own must be so far from a neighbour, in 1/65536 px: nearer ones hide each other's
/// levels (`frames::a_rod_three_pixels_wide_has_the_right_depth_and_shifted_sides`).
pub(super) const LEAST_APART_Q16: u32 = 5 << 16;

/// That is decided only where the column's sigma is below this, in 1/65536 px
/// (`frames::faint_and_noisy_bars_are_found`).
pub(super) const SURE_SIGMA_Q16: u32 = 1 << 13;

/// Rows with texture that make a line one beside texture, probably and surely
/// (`clutter::crossing_bars_lead_no_line_astray`).
pub(super) const FEW_TEXTURED_ROWS: u16 = 4;
pub(super) const MANY_TEXTURED_ROWS: u16 = 12;

/// Rows of a line from which the running means of levels, blur, noise and their scatter are taken, and which they
/// remember; and rows from one of these to the next, once there have been twice as many: 2 to these powers. The fewer
/// they are, the noisier are the means
/// (`edge::refine::tests::widths_are_unbiased_and_as_noisy_as_stated`, `cargo xtask budget --use "two bars"`).
pub(super) const MEMORY_LOG2: u32 = 3;
pub(super) const LEARN_ROWS_LOG2: u32 = 2;

/// The noise that a row on its own shows is off by up to a factor of two: the first rows of the edge move it by a part
/// in so many, as a power of two (`edge::refine::tests::widths_are_unbiased_and_as_noisy_as_stated`).
pub(super) const LEAST_NOISE_ROWS_LOG2: u32 = 2;

/// Rows, as a power of two, between which the root of the noise changes by less than a tenth of itself: it is taken
/// anew only then, and in each of the first ones (`frames::sigma_is_honest`).
pub(super) const RENEWAL_ROWS_LOG2: u32 = 4;

/// An edge whose column is off the expected one by up to one of so many parts of its blur, as a power of two, is
/// located in one step (`clutter::crossing_bars_lead_no_line_astray` and
/// `frames::short_bars_are_found_in_a_clear_view` with a quarter).
pub(super) const ONE_STEP_PARTS_LOG2: u32 = 3;

/// So is one that is off by as many sigma of the row's noise: another step would follow the noise
/// (`cargo xtask budget --use "noise 12"`, and `clutter::crossing_bars_lead_no_line_astray` where texture counts as
/// noise).
pub(super) const ONE_STEP_SIGMAS: u32 = 2;

/// A row whose residual variance is so many times that of the rows before shows something else
/// (`clutter::crossing_bars_lead_no_line_astray`).
pub(super) const MOST_RESIDUAL: u32 = 9;
