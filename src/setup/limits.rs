//! [`Limits`]: which points make one line, and how long a line must be.

use crate::error::ParameterError;

/// Which points the tracker takes for those of one edge, and how long a line must be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Limits {
    /// Steepest slope of a line when it is confirmed, in 1/65536 px of column per row, at most 1024 px.
    pub max_slope_q16: u32,
    /// Half-width of the gate: how far a point may lie from the predicted column, beyond four sigma of its noise, in
    /// 1/65536 px, at most 1024 px. It holds for a new line and narrows to an eighth by the line's 64th point. In rows
    /// of pixels the gate is also at most four sigma of the scatter of the line's own points.
    pub gate_q16: u32,
    /// Points after which a tentative line is confirmed: at least 2.
    pub confirm_points: u16,
    /// Consecutive rows without a point after which a tentative line is dropped.
    pub tentative_gap_rows: u16,
    /// Consecutive rows without a point after which a confirmed line ends. A long line may be hidden for longer: by two
    /// more rows for each of its points if they were found in rows of pixels, by half a row for each if they were
    /// handed over as points.
    pub gap_rows: u16,
    /// Points that make a range, at least 3: a line of fewer is [`Short`](crate::RangeStatus::Short).
    pub min_points: u16,
    /// A line of which a knot departs by more than this from the best straight edge, in 1/65536 px and at most
    /// 1024 px, is `bent`: by two sigma of its noise beyond it. Smaller departures enlarge sigma instead.
    pub max_departure_q16: u32,
    /// In a sequence whose parallax has measured it, an edge may lean by this slope, in 1/65536 and at most 1024, and stay
    /// `ok`.
    pub max_lean_q16: u32,
}

impl Limits {
    /// Slopes up to one pixel per row; a gate of 2 px; 5 points confirm a line and 8 make a range; gaps of 2 rows
    /// before and 12 rows after a line is confirmed; 1.5 px of departure; 5° of lean.
    pub const DEFAULT: Self = Self {
        max_slope_q16: 1 << 16,
        gate_q16: 2 << 16,
        confirm_points: 5,
        tentative_gap_rows: 2,
        gap_rows: 12,
        min_points: 8,
        max_departure_q16: 3 << 15,
        max_lean_q16: 5_734,
    };

    /// The same with another [`max_slope_q16`](Self::max_slope_q16).
    #[must_use]
    pub const fn with_max_slope_q16(mut self, max_slope_q16: u32) -> Self {
        self.max_slope_q16 = max_slope_q16;
        self
    }

    /// The same with another [`gate_q16`](Self::gate_q16).
    #[must_use]
    pub const fn with_gate_q16(mut self, gate_q16: u32) -> Self {
        self.gate_q16 = gate_q16;
        self
    }

    /// The same with another [`confirm_points`](Self::confirm_points).
    #[must_use]
    pub const fn with_confirm_points(mut self, confirm_points: u16) -> Self {
        self.confirm_points = confirm_points;
        self
    }

    /// The same with another [`tentative_gap_rows`](Self::tentative_gap_rows).
    #[must_use]
    pub const fn with_tentative_gap_rows(mut self, tentative_gap_rows: u16) -> Self {
        self.tentative_gap_rows = tentative_gap_rows;
        self
    }

    /// The same with another [`gap_rows`](Self::gap_rows).
    #[must_use]
    pub const fn with_gap_rows(mut self, gap_rows: u16) -> Self {
        self.gap_rows = gap_rows;
        self
    }

    /// The same with another [`min_points`](Self::min_points).
    #[must_use]
    pub const fn with_min_points(mut self, min_points: u16) -> Self {
        self.min_points = min_points;
        self
    }

    /// The same with another [`max_departure_q16`](Self::max_departure_q16).
    #[must_use]
    pub const fn with_max_departure_q16(mut self, max_departure_q16: u32) -> Self {
        self.max_departure_q16 = max_departure_q16;
        self
    }

    /// The same with another [`max_lean_q16`](Self::max_lean_q16).
    #[must_use]
    pub const fn with_max_lean_q16(mut self, max_lean_q16: u32) -> Self {
        self.max_lean_q16 = max_lean_q16;
        self
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        let wide = |name, value: u32| {
            let most = 1024 << 16;
            let expected = "at most 1024 px, in 1/65536 px";
            if value > most { Err(ParameterError::of_whole(name, value.into(), expected)) } else { Ok(()) }
        };
        wide("max_slope_q16", self.max_slope_q16)?;
        wide("gate_q16", self.gate_q16)?;
        wide("max_departure_q16", self.max_departure_q16)?;
        wide("max_lean_q16", self.max_lean_q16)?;
        for (name, value, least) in [("confirm_points", self.confirm_points, 2), ("min_points", self.min_points, 3)] {
            if value < least {
                return Err(ParameterError::of_whole(name, value.into(), "at least 2 to confirm, 3 for a range"));
            }
        }
        Ok(())
    }
}

impl Default for Limits {
    fn default() -> Self {
        Self::DEFAULT
    }
}
