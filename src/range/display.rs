//! A [`Range`] as a person reads it: "1.21 m ± 0.03", "farther than 12 m", "leans".

use core::fmt::{self, Display, Formatter};

use super::estimate::Sigmas;
use super::range::Range;
use super::status::RangeStatus;
use crate::scalar::Scalar;

impl<S: Scalar> Display for Range<S> {
    /// Depth and one standard deviation, with as many decimals as the deviation is worth; the lower bound at two
    /// standard deviations where the edge is far; otherwise why there is no distance.
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        let depth = self.depth(Sigmas(S::ONE + S::ONE));
        match (self.status, depth.estimate_m, depth.nearest_m) {
            (RangeStatus::Ok, Some((depth_m, sigma_m)), _) => {
                let (depth_m, sigma_m) = (depth_m.to_f64(), sigma_m.to_f64());
                let decimals = decimals_of_first_digit(sigma_m);
                write!(formatter, "{depth_m:.decimals$} m ± {sigma_m:.decimals$}")
            }
            (RangeStatus::Far, _, Some(nearest_m)) => {
                let (bound_m, decimals) = round_down(nearest_m.to_f64());
                write!(formatter, "farther than {bound_m:.decimals$} m")
            }
            (status, ..) => formatter.write_str(reason(status)),
        }
    }
}

const fn reason(status: RangeStatus) -> &'static str {
    match status {
        // Beyond what the numbers can hold.
        RangeStatus::Ok => "too near to tell",
        RangeStatus::Far => "far",
        RangeStatus::Slow => "the motion says too little",
        RangeStatus::Inconsistent => "slopes against the motion",
        RangeStatus::Leaning => "leans",
        RangeStatus::Moving => "moves",
        RangeStatus::Tentative => "too little evidence yet",
        RangeStatus::Bent => "is bent",
        RangeStatus::Cluttered => "may be clutter",
        RangeStatus::Short => "too short",
        RangeStatus::Sideways => "runs along the rows",
    }
}

/// More are not shown.
const MOST_DECIMALS: usize = 6;

/// How many decimals show the first digit of a number that is not zero.
fn decimals_of_first_digit(mut value: f64) -> usize {
    let mut decimals = 0;
    // 0.95 is shown as 1.
    while value < 0.95 && decimals < MOST_DECIMALS {
        value *= 10.0;
        decimals += 1;
    }
    decimals
}

/// A lower bound with two digits, which stays one when it is rounded, and its number of decimals.
fn round_down(value: f64) -> (f64, usize) {
    let (mut scaled, mut scale, mut decimals) = (value, 1.0, 0);
    while scaled < 10.0 && decimals < MOST_DECIMALS {
        scaled *= 10.0;
        scale *= 10.0;
        decimals += 1;
    }
    // Beyond whole numbers there is nothing to round.
    let whole = if scaled < 1e9 { scaled as u32 as f64 } else { scaled };
    (whole / scale, decimals)
}
