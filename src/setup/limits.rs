//! [`Limits`]: what counts as one line.

use crate::error::ParameterError;

/// What the tracker takes for one edge, and how long a line must be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Limits {
    /// Steepest slope that a line may begin with, in 1/65536 px of column per row.
    pub max_slope_q16: u32,
    /// How far an edge may lie from the column that a young line predicts, beyond four sigma of its noise, in 1/65536 px;
    /// an eighth of it where the line has 64 edges. Of pixels, no farther than four times as far as the line's edges scatter.
    pub gate_q16: u32,
    /// Edges after which a tentative line is confirmed.
    pub confirm_points: u16,
    /// Rows in a row without an edge after which a tentative line is dropped.
    pub tentative_gap_rows: u16,
    /// Rows in a row without an edge after which a confirmed line ends; two more for each edge it has, or one for every two where
    /// its edges are somebody's own.
    pub gap_rows: u16,
    /// A line of fewer edges is `short`.
    pub min_points: u16,
    /// A line of which a knot departs by more than this from the best straight edge, in 1/65536 px, is `bent`. Smaller
    /// departures enlarge sigma instead.
    pub max_departure_q16: u32,
    /// In a sequence whose parallax has measured it, an edge may lean by this slope, in 1/65536, and stay `ok`.
    pub max_lean_q16: u32,
}

impl Limits {
    /// Up to one pixel per row; 2 px of gate; confirmed after 5 edges, over gaps of 2 rows, later 12; 8 edges make a range; 1.5 px of
    /// departure; 5° of lean.
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
            if value > most { Err(ParameterError::new(name, f64::from(value), expected)) } else { Ok(()) }
        };
        wide("max_slope_q16", self.max_slope_q16)?;
        wide("gate_q16", self.gate_q16)?;
        wide("max_departure_q16", self.max_departure_q16)?;
        wide("max_lean_q16", self.max_lean_q16)?;
        for (name, value, least) in [("confirm_points", self.confirm_points, 2), ("min_points", self.min_points, 3)] {
            if value < least {
                return Err(ParameterError::new(name, f64::from(value), "at least 2 to confirm, 3 for a range"));
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
