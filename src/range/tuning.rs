//! Every number of this stage that was chosen rather than derived.

/// Rows over which the roughness of an edge is alike: real edges keep half of their correlation over six rows, which
/// makes sixteen rows as good as one independent value (`cargo test real_edges`).
pub(super) const ROUGHNESS_ROWS: i32 = 16;

/// A wander that is alike over more than this share of an edge passes for its place and slope (`cargo test
/// real_cameras`).
pub(super) const LONGEST_WANDER: (i32, i32) = (2, 5);

/// Modes of the residuals that tell how much the edge wanders: fewer tell it badly, and of a slow wander higher ones
/// show nothing (`cargo test wander`).
pub(super) const WANDER_MODES: usize = 6;

/// Beyond so many sigmas of chance the stated noise is too small (`cargo test white_noise_stays_white_noise`).
pub(super) const NOISY_SIGMAS: i32 = 4;

/// Beyond so many, an edge that is said to be straight wanders (`cargo test wander`).
pub(super) const WANDERING_SIGMAS: i32 = 2;

/// A bend is what departs from a straight line by more than so many sigmas of noise and the limit: of lines of a dozen
/// noisy rows noise alone makes one in ten depart by more than the limit (`cargo test noise_is_no_bend`).
pub(super) const NO_BEND_SIGMAS: i32 = 2;

/// A deviation of more sigmas counts as so many: squares of larger ones would leave single precision no room for the
/// others.
pub(super) const MOST_SIGMAS: i32 = 1_000;

/// A round that moves the estimate by less than this part of a sigma is the last: 1/50. The next one would move it by
/// the square of that (`cargo test least_squares` allows 1/100).
pub(super) const SETTLED_PART: i32 = 50;

/// Nor is another round needed that would change each sigma by less than this part (`cargo test least_squares`).
pub(super) const SAME_SIGMA_PART: i32 = 1_000;

/// Where only sigmas have changed, equations linearised this part of a sigma away are as good as new ones: 1/4. New
/// ones would move it by the hundredth part of a sigma at most.
pub(super) const NEARBY_PART: i32 = 4;

/// Rounds without settling after which a line is no straight edge. Most take two; with a wide prior on the tilt up to
/// five.
pub(super) const MOST_ROUNDS: usize = 10;

/// Rounds after which only half of each step is taken: where tilt and depth go together, whole ones may go to and fro
/// for ever (`cargo test forward_motion`).
pub(super) const FULL_ROUNDS: usize = 6;

/// Below this share of its value for a level camera, a row runs along upright edges: one pixel of column weighs as ten
/// do there (`cargo test statuses`).
pub(super) const LEAST_CROSSING: (i32, i32) = (1, 10);

/// A solution behind the camera gives way to one in front unless that fits worse by three sigma: the square of it.
pub(super) const MIRROR_COST: i32 = 9;

/// The solution in front is about as far from the camera as the one behind it. What comes out this many times nearer
/// has not settled but run away, to where rounding decides (`cargo test agreement`).
pub(super) const MIRROR_REACH: i32 = 4;

/// Of the two paths that explain a blur, one that fits worse than the other by five sigma before its rounds is not
/// tried: the square of it. What lies between them is decided by their rounds (`cargo test blur`).
pub(super) const RIVAL_COST: i32 = 25;

/// Beyond so many times the robust scale a sample may be an outlier.
pub(super) const SUSPICIOUS: i32 = 3;

/// Where the largest deviation is more than three times so many sigmas, outliers are looked for before the first
/// estimate has settled: otherwise the dearest line costs twice as much (`cargo xtask budget --check`).
pub(super) const FAR_SIGMAS: i32 = 5;

/// What scatters by more than so many sigmas is no straight edge: which of several minima it is nearest to tells
/// nothing, and looking makes the dearest line half as dear again (`cargo xtask budget --check`).
pub(super) const MOST_SCATTER: i32 = 30;

/// Beyond so many times the robust scale, and 16/N more, a sample of N is an outlier (`cargo test outliers`).
pub(super) const OUTLIER: i32 = 4;

/// How often outliers are looked for: those that are far off hide others (`cargo test more_than_a_third`).
pub(super) const MOST_REJECTIONS: usize = 4;

/// Rounds of reweighting, none of which linearises anew. Twelve bring the fit within a tenth of a sigma of least
/// absolute deviations; more would make the worst line dearer and nothing better.
pub(super) const REWEIGHTING_ROUNDS: usize = 12;

/// The rounds of reweighting end where no scale would change by more than this part: 1/20, which is a tenth of its
/// deviation.
pub(super) const REWEIGHTED_PART: i32 = 20;

/// A line of pixels may scatter by so many of its sigmas for each length of roughness, and by as many as this in any
/// case: the fewer there are, the less tells a wander from pieces of several edges
/// (`cargo test false_distances::of_clutter` with twice as many, `cargo test short_bars` with half of the latter).
pub(super) const MISFIT_PER_LENGTH: (i32, i32) = (3, 4);
pub(super) const USUAL_MISFIT: (i32, i32) = (3, 2);

/// Where the curve of a line tells less than two fifths of its depth, the prior of the tilt tells it from its twin (`cargo
/// test the_right_one_of_several_minima` with more, `cargo test coverage` with less).
pub(super) const CURVE_PART: (i32, i32) = (2, 5);

/// Whether there is a twin is not asked where its turning point is more than so many sigmas away: the prior of the tilt
/// rules it out, and it costs rounds (`cargo test the_right_one_of_several_minima` with fewer).
pub(super) const FARTHEST_TURN: i32 = 32;

/// Where what lies between twins fits worse by less than so many sigmas, both are in sigma (`cargo test
/// the_right_one_of_several_minima` with less).
pub(super) const LEAST_BARRIER: i32 = 4;

/// Likewise where a twin fits worse by less than three sigma: the square of it (the same test with half of it).
pub(super) const TWIN_COST: i32 = 9;
