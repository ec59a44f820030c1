//! [`Filter`]: where a line goes: a line fit with fading memory, updated point by point.

use super::tuning::{
    LEAST_MEMORY_POINTS, MAX_GATE_Q16, MEMORY_POINTS, MOST_SCATTER_Q16, ROWS_ALIKE, ROWS_ALIKE_IN_TEXTURE,
    SCATTER_MEMORY_POINTS,
};
use crate::setup::Limits;

/// Filtered column and slope of a line, and how far its points scatter about them.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Filter {
    /// At the last point's row, in 1/65536 px.
    pub(super) column_q16: i32,
    /// In 1/65536 px per row of readout.
    pub(super) slope_q16: i32,
    /// Mean distance of the last points from where they were expected, in 1/65536 px.
    pub(super) scatter_q16: u16,
    /// How far off its prediction a point of the next row may lie, in 1/256 px, as it was some points ago.
    pub(super) gate_q8: u16,
}

/// How many points a filter remembers, and what follows from it.
#[derive(Clone, Copy)]
pub(super) struct Memory(&'static Gains);

/// What follows from the number of points: made when the library is compiled, so that no quotient is taken for a point.
struct Gains {
    points: u16,
    /// Part of the gate of a new line, for each row since the last point, in 1/256.
    gate_q8: u16,
    /// Part of the steepest slope that the slope may still be off, in 1/32768: everything after one point, ever less
    /// after.
    slope_off_q15: u16,
    /// Parts of what a point is off that column, slope and scatter follow, in 1/65536.
    column_q16: u16,
    turn_q16: u16,
    scatter_q16: u16,
    /// [`spread_q4`] in the next row, elsewhere and in texture.
    spreads_q4: [u16; 2],
}

static GAINS: [Gains; MEMORY_POINTS as usize] = {
    let mut gains = [const { Gains::of(1) }; MEMORY_POINTS as usize];
    let mut points = 1;
    while points < MEMORY_POINTS {
        points += 1;
        gains[points as usize - 1] = Gains::of(points);
    }
    gains
};

impl Gains {
    const fn of(n: u32) -> Self {
        let count = n * (n + 1);
        let remembered = if n < SCATTER_MEMORY_POINTS { n } else { SCATTER_MEMORY_POINTS };
        Self {
            points: n as u16,
            gate_q8: ((8 << 8) / n) as u16,
            slope_off_q15: ((1 << 15) / (n * n)) as u16,
            column_q16: part_q16(4 * n - 2, count),
            turn_q16: part_q16(6, count),
            scatter_q16: part_q16(1, remembered),
            spreads_q4: [spread_q4(n, 1, ROWS_ALIKE) as u16, spread_q4(n, 1, ROWS_ALIKE_IN_TEXTURE) as u16],
        }
    }
}

/// A part in 1/65536; all but one of these where it is all.
const fn part_q16(numerator: u32, denominator: u32) -> u16 {
    let part_q16 = (numerator << 16) / denominator;
    if part_q16 < u16::MAX as u32 { part_q16 as u16 } else { u16::MAX }
}

/// Root of 1 and the variance of a line through n points, `rows` ahead of them, in sixteenths: 4/n + 12 rows/n² + 12
/// rows²/n³ of a point's; more, since rows err alike.
const fn spread_q4(n: u32, rows: u32, alike: u32) -> u32 {
    // Farther ahead the widest gate holds anyway.
    let rows = if rows < 256 { rows } else { 256 };
    let of_line = 256 * alike as u64 * (4 * n * n + 12 * rows * n + 12 * rows * rows) as u64;
    match of_line.checked_div((n * n * n) as u64) {
        Some(of_line_q8) => (256 + of_line_q8 as u32).isqrt(),
        None => u32::MAX,
    }
}

impl Memory {
    /// Of a line of `points` in `rows`: fewer where rows are sparse, since a curve bends between them.
    pub(super) fn of(points: u16, rows: u16) -> Self {
        let (points, rows) = (u32::from(points.max(1)), u32::from(rows));
        let most = if points >= rows {
            MEMORY_POINTS
        } else {
            (MEMORY_POINTS * points).checked_div(rows).unwrap_or(0).max(LEAST_MEMORY_POINTS)
        };
        let [first, ..] = &GAINS;
        Self(GAINS.get(points.min(most) as usize - 1).unwrap_or(first))
    }

    /// How far off its prediction a point may lie so many rows on, beyond its own noise, in 1/65536 px: the better a
    /// line is known, the less an edge may miss it; over a gap it may have bent.
    pub(super) fn gate_q16(self, rows: u16, limits: &Limits) -> u32 {
        let (gate_q16, slope_q16) = (limits.gate_q16.min(MAX_GATE_Q16), limits.max_slope_q16.min(MAX_GATE_Q16));
        // Both fit: the widest gate has 22 bits.
        let bend_q16 = ((gate_q16 >> 4) * u32::from(self.0.gate_q8)) >> 4;
        let slope_off_q16 = ((slope_q16 >> 6) * u32::from(self.0.slope_off_q15)) >> 9;
        let (bend_q16, off_q16) = match rows {
            1 => (bend_q16, slope_off_q16),
            _ => (bend_q16.saturating_mul(rows.into()), slope_off_q16.saturating_mul(rows.into())),
        };
        bend_q16.min(gate_q16).saturating_add(off_q16)
    }
}

/// One part of a value, to the nearest: cut off, what is followed would be biased.
fn part(value: i32, gain_q16: u16) -> i32 {
    // In two products of 32 bits, which all cores have.
    let below_q16 = (value as u32 & 0xFFFF) * u32::from(gain_q16) + (1 << 15);
    (value >> 16) * i32::from(gain_q16) + (below_q16 >> 16) as i32
}

impl Filter {
    /// At a line's first point.
    pub(super) const fn new(column_q16: i32) -> Self {
        Self { column_q16, slope_q16: 0, scatter_q16: MOST_SCATTER_Q16, gate_q8: 0 }
    }

    /// The column so many rows on, in 1/65536 px.
    pub(super) fn column_after(&self, rows: u16) -> i32 {
        if rows == 1 {
            return self.column_q16.saturating_add(self.slope_q16);
        }
        self.column_q16.saturating_add(self.slope_q16.saturating_mul(rows.into()))
    }

    /// Four sigma of a point about its prediction so many rows on, in 1/65536 px: of the point itself, and of a line
    /// through the remembered ones.
    pub(super) fn scatter_gate_q16(&self, memory: Memory, rows: u16, in_texture: bool) -> u32 {
        let Gains { points, spreads_q4: [elsewhere_q4, texture_q4], .. } = *memory.0;
        let (next_q4, alike) =
            if in_texture { (texture_q4, ROWS_ALIKE_IN_TEXTURE) } else { (elsewhere_q4, ROWS_ALIKE) };
        let spread_q4 = if rows == 1 { next_q4.into() } else { spread_q4(points.into(), rows.into(), alike) };
        let scatter_q16 = u32::from(self.scatter_q16).max(1 << 12);
        // Four sigma are five mean deviations.
        (1 << 13) + ((5 * scatter_q16).saturating_mul(spread_q4) >> 4)
    }

    /// Goes on to a point so many rows after the last one. In texture another edge that crosses must not lead the line
    /// astray: what is off by more than twice the scatter counts as that.
    pub(super) fn follow(&mut self, column_q16: i32, memory: Memory, rows: u16, in_texture: bool) {
        let predicted_q16 = self.column_after(rows);
        // No gate is as wide as that.
        let off_q16 = column_q16.saturating_sub(predicted_q16).clamp(-(1 << 28), 1 << 28);
        let twice_q16 = 2 * i32::from(self.scatter_q16);
        self.scatter(off_q16, memory);
        let off_q16 = if in_texture { off_q16.clamp(-twice_q16, twice_q16) } else { off_q16 };
        self.column_q16 = predicted_q16.saturating_add(part(off_q16, memory.0.column_q16));
        let turn_q16 = part(off_q16, memory.0.turn_q16);
        let turn_q16 = if rows > 1 { turn_q16.checked_div(rows.into()).unwrap_or(0) } else { turn_q16 };
        self.slope_q16 = self.slope_q16.saturating_add(turn_q16).clamp(-(1 << 30), 1 << 30);
    }

    /// Likewise to a point of the next row, off its prediction by less than a gate, elsewhere than in texture. The scatter
    /// is left to [`Self::scatter`].
    #[inline(always)]
    pub(super) fn follow_next(&mut self, off_q16: i32, predicted_q16: i32, memory: Memory) {
        self.column_q16 = predicted_q16.saturating_add(part(off_q16, memory.0.column_q16));
        self.slope_q16 = self.slope_q16.saturating_add(part(off_q16, memory.0.turn_q16));
    }

    /// Takes the size of what a point is off for the scatter.
    #[inline(always)]
    pub(super) fn scatter(&mut self, off_q16: i32, memory: Memory) {
        let scatter_q16 = i32::from(self.scatter_q16);
        let more_q16 = off_q16.abs().min(4 * scatter_q16) - scatter_q16;
        let mean_q16 = scatter_q16 + part(more_q16, memory.0.scatter_q16);
        self.scatter_q16 = mean_q16.clamp(1, i32::from(MOST_SCATTER_Q16)) as u16;
    }
}

#[cfg(test)]
mod tests {
    use super::{Filter, Memory};
    use crate::setup::Limits;

    /// After n points of a straight line in successive rows, column and slope are those of a least-squares fit through
    /// all of them.
    #[test]
    fn it_is_a_line_fit() {
        for slope_q16 in [-40_000_i32, 0, 700, 65_536] {
            let mut filter = Filter::new(100 << 16);
            for row in 1..64_u16 {
                let column_q16 = (100 << 16) + slope_q16 * i32::from(row);
                filter.follow(column_q16, Memory::of(row + 1, row + 1), 1, false);
                assert!((filter.column_q16 - column_q16).abs() <= 64, "{row}: {filter:?}");
                assert!((filter.slope_q16 - slope_q16).abs() <= 64, "{row}: {filter:?}");
            }
        }
    }

    /// What noise in the points does to column and slope: variances of 4/n and 12/n³ of a point's.
    #[test]
    fn its_noise_is_that_of_a_line_fit() {
        const POINTS: u16 = 64;
        let at = |seed: u32| {
            let mut mixed = seed;
            (0..8).fold(0_i32, |sum, _| {
                mixed = (mixed ^ (mixed >> 15)).wrapping_mul(0x2c1b_3c6d).wrapping_add(0x9e37_79b9);
                sum + (mixed >> 18) as i32 - 8192
            })
        };
        let (mut columns, mut slopes, mut points) = (0_i64, 0_i64, 0_i64);
        let runs = 400_u32;
        for run in 0..runs {
            let mut filter = Filter::new(at(run * 1000));
            for row in 1..POINTS {
                let off_q16 = at(run * 1000 + u32::from(row));
                points += i64::from(off_q16) * i64::from(off_q16);
                filter.follow(off_q16, Memory::of(row + 1, row + 1), 1, false);
            }
            columns += i64::from(filter.column_q16) * i64::from(filter.column_q16);
            slopes += i64::from(filter.slope_q16) * i64::from(filter.slope_q16) * 4096;
        }
        let (n, runs) = (f64::from(POINTS), f64::from(runs));
        let variance = points as f64 / (runs * (n - 1.0));
        // Four sigma of a variance from 400 runs: √(2/400) each.
        let ratio = |found: f64, expected: f64| found / (runs * variance * expected);
        let (column, slope) = (ratio(columns as f64, 4.0 / n), ratio(slopes as f64 / 4096.0, 12.0 / (n * n * n)));
        assert!((0.7..1.3).contains(&column) && (0.7..1.3).contains(&slope), "{column}, {slope}");
    }

    #[test]
    fn gates_narrow_with_points_and_widen_with_rows() {
        let limits = Limits::DEFAULT;
        let gate = |points, rows| Memory::of(points, points).gate_q16(rows, &limits);
        assert_eq!(gate(1, 1), limits.gate_q16 + limits.max_slope_q16);
        assert!(gate(64, 1).abs_diff(limits.gate_q16 / 8) < 64, "{}", gate(64, 1));
        assert!(gate(20, 2) > gate(20, 1) && gate(20, u16::MAX) >= gate(20, 100));
    }

    /// A line of every other row remembers as far back in rows as one of every row.
    #[test]
    fn sparse_rows_are_remembered_as_long() {
        let points = |points, rows| Memory::of(points, rows).0.points;
        assert_eq!([points(200, 200), points(200, 400), points(200, 60_000), points(5, 5)], [64, 32, 16, 5]);
        assert_eq!([points(0, 0), points(1, 1), points(u16::MAX, u16::MAX)], [1, 1, 64]);
    }
}
