//! The numbers of this room that were chosen rather than derived: unit, reason, and the test that breaks without them.

/// A line is one by chance unless its mean contrast exceeds that of parallel lines around by so many of their deviations. A frame
/// has some 10⁵ places for a line, which normal values need 4.5 for; texture has longer tails, the tracker follows what is
/// strongest, and crossing bars are coherent (`false_distances::of_clutter` with 11; fewer real edges with more).
pub(super) const CHANCE_SIGMAS: u64 = 12;

/// Rows of texture that err alike: 2 to 4 were found in gravel, 8 where its cells are 12 px high (`false_distances::of_texture`).
pub(super) const ALIKE_ROWS: u64 = 8;

/// Where the texture around a line is looked at, in pixels beyond its blur: within a few gates, on either side.
pub(super) const AROUND_PX: [i32; 8] = [-8, 12, -16, 20, -24, 28, -32, 36];

/// One of these places is looked at in every second row, so that each is seen again after 16 rows: texture has changed by
/// then, and other upright edges hardly (`false_distances::of_texture` with fewer, fences with more).
pub(super) const LOOK_ROWS: u16 = 2;

/// So many changes tell how much the texture changes; with fewer, everything around a line counts as texture, also upright
/// edges (`false_distances::of_texture`).
pub(super) const LEAST_CHANGES: u16 = 8;

/// A line is stitched to another whose contrast is at least all but one of so many parts of its own: texture passes for the rest of
/// an edge where its place alone decides (`prominence::lines_of_another_contrast_are_not_alike`; on a photograph 30 % of lines
/// ran on by more than a third of their edge without it, and 18 % with it).
pub(super) const LIKE_PARTS: i64 = 3;
