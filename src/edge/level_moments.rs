//! [`LevelMoments`]: the levels of an edge from its own flank, where no plateau tells them.

use super::tuning::TEXTURED_PLATEAU;
use super::weight::Weight;

/// Nearest whole number to a quotient.
fn nearest(numerator: i32, denominator: i32) -> Option<i32> {
    let half = denominator / 2;
    (if numerator < 0 { numerator - half } else { numerator + half }).checked_div(denominator)
}

/// Inner products with a level's share of each pixel of the flank, in 1/256 each.
#[derive(Clone, Copy, Default)]
struct Level {
    own: i32,
    residual: i32,
    slope: i32,
}

impl Level {
    fn add(&mut self, residual_q6: i32, slope: i32, share: i32) {
        self.own += share * share;
        self.residual += share * residual_q6;
        self.slope += share * slope;
    }

    /// With its plateau, whose level is the one to expect.
    fn with_plateau(self) -> Self {
        Self { own: self.own + (TEXTURED_PLATEAU << 16), ..self }
    }

    /// Less what another level explains, of whose share it has a part.
    fn without(self, other: &Self, part_q12: i32, shared: i32) -> Self {
        let of = |value: i32| ((i64::from(part_q12) * i64::from(value)) >> 12) as i32;
        Self {
            own: (self.own - of(shared)).max(1 << 12),
            residual: self.residual - of(other.residual),
            slope: self.slope - of(other.slope),
        }
    }
}

/// Sums over the pixels of a flank: of residuals, of the right level's share, and of their products with each other and
/// with the slope.
#[derive(Clone, Copy, Default)]
pub(super) struct Shares {
    pub(super) residual: i32,
    pub(super) right: i32,
    pub(super) right_right: i32,
    pub(super) right_residual: i32,
    pub(super) slope: i32,
    pub(super) right_slope: i32,
}

/// Those of the left and of the right level, and of the two with each other.
#[derive(Default)]
pub(super) struct LevelMoments {
    left: Level,
    right: Level,
    shared: i32,
}

/// The levels that an edge's own pixels show.
pub(super) struct FreeLevels {
    /// Minus the expected ones, in 1/256 grey level.
    pub(super) off_q8: [i32; 2],
    /// Of the slope, less what the levels explain.
    pub(super) slope_slope: i32,
}

impl LevelMoments {
    /// From sums over a flank of so many pixels: of residuals, of the right level's share, and of products.
    pub(super) const fn of_sums(pixels: i32, sums: &Shares) -> Self {
        let Shares { residual, right, right_right, right_residual, slope, right_slope } = *sums;
        let left = Level {
            own: (pixels << 16) - (right << 9) + right_right,
            residual: (residual << 8) - right_residual,
            slope: (slope << 8) - right_slope,
        };
        let of_right = Level { own: right_right, residual: right_residual, slope: right_slope };
        Self { left, right: of_right, shared: (right << 8) - right_right }
    }

    /// What an error of the levels, left and right, by one grey level does to the product of the residuals with the
    /// slope, in 1/64 grey level.
    pub(super) const fn slopes(&self) -> [i32; 2] {
        [self.left.slope, self.right.slope]
    }

    pub(super) fn add(&mut self, residual_q6: i32, weight: &Weight) {
        let (slope, right) = (i32::from(weight.slope), i32::from(weight.step >> 7));
        let left = (1 << 8) - right;
        self.left.add(residual_q6, slope, left);
        self.right.add(residual_q6, slope, right);
        self.shared += left * right;
    }

    /// Leaves it to the edge's own pixels to tell the levels, by orthogonalisation; those to expect, the plateaus',
    /// count as [`TEXTURED_PLATEAU`] pixels each. `None` where too little of the edge is in view.
    pub(super) fn free(&self, residual_slope: i32, slope_slope: i32) -> Option<FreeLevels> {
        let left = self.left.with_plateau();
        let common_q12 = nearest((self.shared >> 8) << 12, left.own >> 8)?;
        let right = self.right.with_plateau().without(&left, common_q12, self.shared);
        // In 1/256 grey level.
        let level = |product: i32, own: i32| nearest((product >> 8).clamp(-(1 << 20), 1 << 20) << 10, own >> 8);
        let (mut slope_slope, mut residual_slope) = (i64::from(slope_slope), i64::from(residual_slope));
        for one in [left, right] {
            let of_slope_q12 = i64::from(nearest((one.slope >> 8) << 12, one.own >> 8)?);
            slope_slope -= (of_slope_q12 * i64::from(one.slope)) >> 12;
            residual_slope -= (of_slope_q12 * i64::from(one.residual)) >> 12;
        }
        let slope_slope = i32::try_from(slope_slope).ok().filter(|slope_slope| *slope_slope >= 1 << 10)?;
        let shift_q8 = i64::from(nearest(residual_slope.clamp(-(1 << 30), 1 << 30) as i32, slope_slope >> 8)?);
        let saturate = |product: i64| product.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32;
        let rest = |one: &Level| one.residual.saturating_sub(saturate((shift_q8 * i64::from(one.slope)) >> 8));
        let right_q8 = level(rest(&right), right.own)?;
        let of_right = (i64::from(right_q8) * i64::from(self.shared)) >> 10;
        let left_q8 = level(rest(&left).saturating_sub(saturate(of_right)), left.own)?;
        let off_q8 = [left_q8, right_q8];
        off_q8.into_iter().all(|off_q8| off_q8.abs() <= 255 << 8).then_some(FreeLevels { off_q8, slope_slope })
    }
}
