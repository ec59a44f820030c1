//! [`Knot`]: the points of a line in a span of rows, summed.

use crate::edge::EdgePoint;

/// Sums over the points of a line in a span of rows, relative to the line's first point: exact, and independent of the
/// order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Knot {
    pub(crate) columns_q16: i64,
    pub(crate) times_ns: i64,
    pub(crate) variances_q32: u64,
    pub(crate) rows: u32,
    pub(crate) widths_q8: u32,
    pub(crate) points: u16,
    /// Number of points whose width was measured.
    pub(crate) widths: u16,
}

impl Knot {
    pub(crate) const EMPTY: Self =
        Self { columns_q16: 0, times_ns: 0, variances_q32: 0, rows: 0, widths_q8: 0, points: 0, widths: 0 };

    pub(super) fn of(point: &EdgePoint, first: &EdgePoint) -> Self {
        let mut knot = Self::EMPTY;
        knot.add_point(point, first);
        knot
    }

    /// Adds a point of the line that begins with `first`. Only times can saturate.
    pub(super) fn add_point(&mut self, point: &EdgePoint, first: &EdgePoint) {
        let time_ns = point.time_ns.saturating_sub(first.time_ns);
        self.add_sums(point, first, self.times_ns.saturating_add(time_ns));
    }

    /// Likewise of a point whose time a [`Ranger`](crate::Ranger) has checked: the sum over a line's 65536 rows fits.
    #[inline(always)]
    pub(super) fn add_checked(&mut self, point: &EdgePoint, first: &EdgePoint) {
        let time_ns = point.time_ns.wrapping_sub(first.time_ns);
        self.add_sums(point, first, self.times_ns.wrapping_add(time_ns));
    }

    #[inline(always)]
    fn add_sums(&mut self, point: &EdgePoint, first: &EdgePoint, times_ns: i64) {
        self.times_ns = times_ns;
        self.columns_q16 += i64::from(point.column_q16) - i64::from(first.column_q16);
        // No weight is infinite. Sums over a line's 65536 rows fit: of squares below 2⁴⁹, of rows and of widths below
        // 2¹⁶.
        self.variances_q32 =
            self.variances_q32.wrapping_add(square(point.sigma_q16.clamp(1, EdgePoint::MAX_SIGMA_Q16)));
        self.rows = self.rows.wrapping_add(point.row.abs_diff(first.row).into());
        self.widths_q8 = self.widths_q8.wrapping_add(point.width_q8.into());
        self.points = self.points.saturating_add(1);
        self.widths = self.widths.saturating_add((point.width_q8 > 0).into());
    }

    /// The same relative to another first point, which lies at `start` relative to this one's: a knot of one point.
    pub(super) fn relative_to(&self, start: &Self) -> Self {
        let points = self.points;
        Self {
            columns_q16: self.columns_q16.saturating_sub(start.columns_q16 * i64::from(points)),
            times_ns: self.times_ns.saturating_sub(start.times_ns.saturating_mul(i64::from(points))),
            rows: self.rows.saturating_sub(start.rows * u32::from(points)),
            ..*self
        }
    }

    /// Adds the sums of another knot. Only times can saturate, and not those of points that a [`Ranger`](crate::Ranger)
    /// has checked.
    pub(crate) fn add(&mut self, other: &Self) {
        *self = self.and(other);
    }

    /// The sums of both, likewise.
    // Inlined, so that it is written where it is to be and copied nowhere.
    #[inline(always)]
    pub(super) fn and(&self, other: &Self) -> Self {
        Self {
            columns_q16: self.columns_q16.wrapping_add(other.columns_q16),
            times_ns: self.times_ns.saturating_add(other.times_ns),
            variances_q32: self.variances_q32.wrapping_add(other.variances_q32),
            rows: self.rows.wrapping_add(other.rows),
            widths_q8: self.widths_q8.wrapping_add(other.widths_q8),
            points: self.points.saturating_add(other.points),
            widths: self.widths.saturating_add(other.widths),
        }
    }
}

fn square(sigma_q16: u32) -> u64 {
    match u16::try_from(sigma_q16) {
        // Where there is no atomic word there is no long product either: in 32 bits where it fits, as that of most
        // sigmas does.
        Ok(small_q16) if !cfg!(target_has_atomic = "32") => u64::from(u32::from(small_q16) * u32::from(small_q16)),
        _ => u64::from(sigma_q16) * u64::from(sigma_q16),
    }
}
