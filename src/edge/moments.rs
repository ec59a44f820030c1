//! [`Moments`]: inner products over the flank of an edge.

use super::spread_function::Place;

/// Inner products of the residual, the slope of the spread function and its change with the width, over the flank of an
/// edge; and the levels of the plateaus on either side.
#[derive(Default)]
pub(crate) struct Moments {
    pub(crate) pixels: i64,
    pub(crate) residual_residual: i64,
    pub(crate) residual_slope: i64,
    residual_widening: i64,
    pub(crate) slope: i64,
    pub(crate) slope_slope: i64,
    widening_widening: i64,
    widening_step: i64,
    residual_shape: i64,
    shape_shape: i64,
    shape_step: i64,
    widening_shape: i64,
    pub(crate) plateau_pixels: [i64; 2],
    /// The row's own levels minus the expected ones: those of the plateaus, until others are found.
    pub(crate) off_q16: [i64; 2],
}

impl Moments {
    pub(super) fn add(&mut self, residual: i64, place: &Place) {
        let (step, slope, widening) = (i64::from(place.step), i64::from(place.slope), i64::from(place.widening));
        self.pixels += 1;
        self.residual_residual += residual * residual;
        self.residual_slope += residual * slope;
        self.residual_widening += residual * widening;
        self.slope += slope;
        self.slope_slope += slope * slope;
        self.widening_widening += widening * widening;
        self.widening_step += widening * (step - (1 << 14));
        if place.shape != 0 {
            let shape = i64::from(place.shape);
            self.residual_shape += residual * shape;
            self.shape_shape += shape * shape;
            self.shape_step += shape * (step - (1 << 14));
            self.widening_shape += widening * shape;
        }
    }

    /// Whether both flanks are in view.
    pub(crate) const fn shows_edge(&self) -> bool {
        self.pixels >= 3 && self.slope_slope >= 1 << 24
    }

    /// Product of the residual with the slope, had the levels that the plateaus show been expected: of the slope's sum half
    /// belongs to either level.
    ///
    /// Means over rows are less noisy, but what they are off shifts all these rows alike: for a line it comes to the same,
    /// and each row for itself knows neither lag nor drift, and no bad start.
    pub(crate) fn residual_slope_of_plateaus(&self) -> i64 {
        let [left_q8, right_q8] = self.off_q16.map(|off_q16| off_q16 >> 8);
        self.residual_slope - (left_q8 + right_q8) * self.slope / 2
    }

    /// Products of the widening with the residual, had the row's own levels been expected (it changes sign in the middle), and
    /// with itself; and the same without what another lens would explain, which is less biased and noisier.
    pub(crate) fn widening(&self) -> [(i64, i64); 2] {
        let [left_q8, right_q8] = self.off_q16.map(|off_q16| off_q16 >> 8);
        let own = |residual: i64, step: i64| residual - (((right_q8 - left_q8) * step) >> 15);
        let residual = own(self.residual_widening, self.widening_step);
        let square = self.widening_widening >> 15;
        let part_q15 = self.widening_shape.checked_div(self.shape_shape >> 15).unwrap_or(0);
        let of_shape = (own(self.residual_shape, self.shape_step) * part_q15) >> 15;
        let shared = ((self.widening_shape >> 15) * part_q15) >> 15;
        [(residual, square), (residual - of_shape, square - shared)]
    }
}

/// Inner products with a level's share of each pixel of the flank.
#[derive(Clone, Copy, Default)]
struct Level {
    own: i64,
    residual: i64,
    slope: i64,
}

impl Level {
    fn add(&mut self, residual: i64, slope: i64, share: i64) {
        self.own += share * share;
        self.residual += share * residual;
        self.slope += share * slope;
    }
}

/// Those of the left and of the right level, and of the two with each other.
#[derive(Default)]
pub(crate) struct LevelMoments {
    left: Level,
    right: Level,
    shared: i64,
}

impl LevelMoments {
    pub(super) fn add(&mut self, residual: i64, place: &Place) {
        let (slope, right) = (i64::from(place.slope), i64::from(place.step));
        let left = (1 << 15) - right;
        self.left.add(residual, slope, left);
        self.right.add(residual, slope, right);
        self.shared += left * right;
    }
}

impl Moments {
    /// Leaves it to the edge's own pixels to tell the levels: takes out of the sums what the levels explain, by
    /// orthogonalisation, and finds what they are off. `None` where too little of the edge is in view.
    pub(crate) fn free_levels(&mut self, of_levels: LevelMoments) -> Option<()> {
        let LevelMoments { left, mut right, shared } = of_levels;
        let part = |of: i64, own: i64| (of << 15) / own.max(1);
        let common = part(shared, left.own);
        right.own = (right.own - ((common * shared) >> 15)).max(1 << 26);
        right.residual -= (common * left.residual) >> 15;
        right.slope -= (common * left.slope) >> 15;
        for level in [left, right] {
            self.slope_slope -= (part(level.slope, level.own) * level.slope) >> 15;
            self.residual_slope -= (part(level.slope, level.own) * level.residual) >> 15;
            self.residual_residual -= (part(level.residual, level.own) * level.residual) >> 15;
        }
        if !self.shows_edge() {
            return None;
        }
        let shift = part(self.residual_slope, self.slope_slope).clamp(-(1 << 24), 1 << 24);
        let [left_rest, right_rest] = [left, right].map(|level| level.residual - ((shift * level.slope) >> 15));
        let right_change = part(right_rest, right.own);
        let left_change = part(left_rest - ((right_change * shared) >> 15), left.own);
        self.off_q16 = [left_change << 8, right_change << 8];
        Some(())
    }
}
