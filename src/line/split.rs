//! A line that runs on past the end of its edge, to another one or into texture, is split where it turns, or before a gap
//! beyond which hardly anything follows.

use heapless::Vec;

use super::knot::Knot;
use super::line::Line;
use super::straight::{Mean, points, straight_part, turn_beside};
use super::tuning::{LEAST_BROKEN_KINK_Q16, LEAST_KINK_Q16, LEAST_STRAIGHT_KNOTS, MOST_GAP, UNBROKEN_SHARE};
use crate::edge::EdgePoint;

/// The first one beyond a gap that is too long for the fewer points on one of its sides: such a part lies on the way of
/// the other by chance. Of knots of so many rows, as a power of two.
fn beyond_gap(means: &[Mean], span_log2: u8) -> Option<usize> {
    let (all, mut before) = (points(means), 0);
    let is_too_long = means.iter().zip(means.iter().skip(1)).position(|(last, next)| {
        before += u32::from(last.points);
        let empty = u32::from(next.knot.saturating_sub(last.knot).saturating_sub(1));
        MOST_GAP.1 * (empty << span_log2) > MOST_GAP.0 * before.min(all - before)
    });
    is_too_long.map(|last| last + 1)
}

/// Where a line is cut in two.
pub(super) struct Cut {
    /// One beyond the last knot before, and the first one after.
    kept: usize,
    left: usize,
    /// The last point before, and the first one after.
    end: EdgePoint,
    start: EdgePoint,
    /// None where they are no line: two knots would always lie on a straight one.
    pub(super) points_before: u16,
    pub(super) points_after: u16,
}

impl<const KNOTS: usize> Line<KNOTS> {
    /// Where a line is to be cut.
    #[inline(never)] // its list takes room on the stack only while it is asked
    pub(super) fn cut(&self) -> Option<Cut> {
        let mut means: Vec<Mean, KNOTS> = Vec::new();
        self.knots.iter().enumerate().filter_map(Mean::of).for_each(|mean| {
            // There is room: as many as knots.
            let _ = means.push(mean);
        });
        let (before, after) = self.sides(&means)?;
        let kept = before.last().map_or(0, |mean| usize::from(mean.knot) + 1);
        let left = after.first().map_or(self.knots.len(), |mean| usize::from(mean.knot));
        let end = before.last().map(|mean| self.point_along(mean, mean.end_row(), &self.first));
        let start = after.first().map(|mean| self.point_along(mean, mean.start_row(), &self.last));
        let is_line = |means: &&[Mean]| means.len() >= LEAST_STRAIGHT_KNOTS;
        let points_of = |means| Some(means).filter(is_line).map_or(0, points).min(u16::MAX.into()) as u16;
        if ![before, after].iter().any(is_line) {
            return None;
        }
        Some(Cut {
            kept,
            left,
            end: end.unwrap_or(Some(self.first))?,
            start: start.unwrap_or(Some(self.last))?,
            points_before: points_of(before),
            points_after: points_of(after),
        })
    }

    /// Its means on both sides of a cut: at a gap, or of a line that is straight in a part only, before or after that
    /// part. The knot beside the straight part, in which the line turns, belongs to neither side; there may be none
    /// beyond it.
    fn sides<'m>(&self, means: &'m [Mean]) -> Option<(&'m [Mean], &'m [Mean])> {
        // Edge points may be sparse.
        if let Some(at) = beyond_gap(means, self.span_log2).filter(|_| self.is_of_pixels()) {
            return means.split_at_checked(at);
        }
        let rows = u32::from(self.first.row.abs_diff(self.last.row)) + 1;
        let is_broken = self.is_of_pixels() && UNBROKEN_SHARE.1 * u32::from(self.points) < UNBROKEN_SHARE.0 * rows;
        let least_q16 = if is_broken { LEAST_BROKEN_KINK_Q16 } else { LEAST_KINK_Q16 };
        let part = straight_part(&self.knots, means, least_q16)?;
        let turn = turn_beside(means, &part)?;
        Some((means.get(..turn)?, means.get(turn + 1..)?))
    }

    /// Gives up what comes after a cut.
    pub(super) fn keep_before(&mut self, cut: &Cut) {
        self.knots.truncate(cut.kept);
        (self.last, self.points) = (cut.end, cut.points_before);
        // The parts of a line through which the light has left it are pieces as well.
        if self.left_by_light.is_some() {
            self.mark_left_by_light();
        }
    }

    /// Gives up what comes before a cut.
    pub(super) fn keep_after(&mut self, cut: &Cut) {
        let from = Knot::of(&cut.start, &self.first);
        for index in cut.left..self.knots.len() {
            let Some(knot) = self.knots.get(index).map(|knot| knot.relative_to(&from)) else { break };
            let Some(room) = self.knots.get_mut(index - cut.left) else { break };
            *room = knot;
        }
        self.knots.truncate(self.knots.len().saturating_sub(cut.left));
        (self.first, self.points) = (cut.start, cut.points_after);
        // As in [`Self::keep_before`].
        self.begins_with_light = self.left_by_light.is_some();
    }

    /// A point of the line, so many rows after the first one: on the way from the mean of a knot to a point.
    fn point_along(&self, mean: &Mean, rows: i32, to: &EdgePoint) -> Option<EdgePoint> {
        let rows = u16::try_from(rows).ok()?;
        let all_rows = self.last.row.abs_diff(self.first.row);
        let to_row_q8 = i64::from(to.row.abs_diff(self.first.row)) << 8;
        let to_column_q16 = i64::from(to.column_q16) - i64::from(self.first.column_q16);
        let (row_q8, column_q16) = (i64::from(mean.row_q8), i64::from(mean.column_q16));
        let off_q8 = (i64::from(rows) << 8) - row_q8;
        let turn_q16 = (to_column_q16 - column_q16).saturating_mul(off_q8).checked_div(to_row_q8 - row_q8).unwrap_or(0);
        let column_q16 = i64::from(self.first.column_q16) + column_q16 + turn_q16;
        let time_ns = self.last.time_ns.saturating_sub(self.first.time_ns).checked_mul(rows.into())?;
        let time_ns = self.first.time_ns.saturating_add(time_ns.checked_div(all_rows.into())?);
        let row = if self.last.row < self.first.row {
            self.first.row - rows.min(self.first.row)
        } else {
            self.first.row.saturating_add(rows)
        };
        Some(EdgePoint { row, column_q16: i32::try_from(column_q16).ok()?, time_ns, ..*to })
    }
}

#[cfg(test)]
mod tests {
    use rand::rngs::StdRng;
    use rand::{Rng, SeedableRng};

    use super::Line;
    use crate::edge::EdgePoint;

    const ROWS: u16 = 480;

    fn point(row: u16, column_px: f64, sigma_px: f64) -> EdgePoint {
        let q16 = |px: f64| (px * 65536.0) as i32;
        let at = EdgePoint::new(row, q16(column_px), i64::from(row) * 30_000);
        EdgePoint { sigma_q16: q16(sigma_px).unsigned_abs().max(1), ..at }
    }

    fn line<const KNOTS: usize>(mut column_px: impl FnMut(u16) -> f64, sigma_px: f64) -> Line<KNOTS> {
        let mut line = Line::new(point(0, column_px(0), sigma_px));
        (1..ROWS).for_each(|row| line.push(point(row, column_px(row), sigma_px)).expect("rows in order"));
        line
    }

    /// White noise, and a wander that falls off over a dozen rows, as real edges have.
    fn noise(random: &mut StdRng, white_px: f64, wander_px: f64) -> impl FnMut() -> f64 {
        let normal = |random: &mut StdRng| (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0;
        let (mut random, mut wander) = (StdRng::seed_from_u64(random.random()), normal(random));
        move || {
            wander = 0.85 * wander + 0.527 * normal(&mut random);
            white_px * normal(&mut random) + wander_px * wander
        }
    }

    /// Of 4000 lines none is split, whether its noise is white or wanders.
    #[test]
    fn straight_lines_stay_whole() {
        let mut random = StdRng::seed_from_u64(1);
        for index in 0..4000_u16 {
            let slope = random.random_range(-1.0..1.0);
            let (white_px, wander_px) = (random.random_range(0.02..0.5), f64::from(index % 5) * 0.05);
            let mut noise = noise(&mut random, white_px, wander_px);
            let column_px = |row: u16| 700.0 + slope * f64::from(row) + noise();
            let is_split =
                if index % 2 == 0 { split_of::<16>(column_px, white_px) } else { split_of::<64>(column_px, white_px) };
            assert!(!is_split, "line {index}: {white_px} px of noise, {wander_px} of wander");
        }
    }

    fn split_of<const KNOTS: usize>(column_px: impl FnMut(u16) -> f64, sigma_px: f64) -> bool {
        line::<KNOTS>(column_px, sigma_px).cut().is_some()
    }

    /// As lenses and turning cameras make them.
    #[test]
    fn curves_stay_whole() {
        let mut random = StdRng::seed_from_u64(2);
        for index in 0..400_u16 {
            let (sagitta_px, turn) = (random.random_range(-40.0..40.0), random.random_range(-0.5..0.5));
            let white_px = random.random_range(0.02..0.3);
            let mut noise = noise(&mut random, white_px, 0.05);
            let curve = |row: u16| {
                let part = f64::from(row) / f64::from(ROWS);
                400.0 + turn * f64::from(row) + 4.0 * sagitta_px * part * (1.0 - part) + noise()
            };
            assert!(!split_of::<16>(curve, white_px), "line {index}: {sagitta_px} px, {white_px} px of noise");
        }
    }

    /// A line that is seen in some of its rows, and lies aside in those from `from` on.
    fn broken(rows: impl Iterator<Item = u16>, from: u16, aside_px: f64) -> Line<16> {
        let mut line = Line::new(point(0, 300.0, 0.05));
        let column_px = |row| if row < from { 300.0 } else { 300.0 + aside_px };
        rows.for_each(|row| line.push(point(row, column_px(row), 0.05)).expect("rows in order"));
        line
    }

    fn of_pixels(mut line: Line<16>) -> Line<16> {
        line.mark_as_of_pixels();
        line
    }

    /// What follows beyond a gap is shorter than two thirds of it, or longer.
    #[test]
    fn a_line_ends_before_a_gap_beyond_which_hardly_anything_follows() {
        let seen = |from, rows: u16| of_pixels(broken((1..160).chain(from..from + rows), 0, 0.0));
        // Two knots are no line.
        for (from, rows, points) in [(240, 40, 0), (320, 80, 80)] {
            let whole = seen(from, rows);
            let cut = whole.cut().expect("two parts");
            let (mut first, mut later) = (whole.clone(), whole);
            first.keep_before(&cut);
            later.keep_after(&cut);
            assert_eq!((first.points, first.last.row), (160, 159));
            assert_eq!((later.points, later.first.row), (points, from));
        }
        assert!(seen(240, 64).cut().is_none());
    }

    /// Edge points may be sparse: every second knot is empty.
    #[test]
    fn points_of_few_rows_are_one_line() {
        let sparse = || broken((16..128).step_by(16), 0, 0.0);
        assert!(sparse().cut().is_none() && of_pixels(sparse()).cut().is_some());
    }

    /// Where another edge may go on, less than elsewhere is no wander.
    #[test]
    fn broken_lines_turn_sooner() {
        for (aside_px, is_cut) in [(0.6, false), (2.0, true)] {
            let broken = of_pixels(broken((1..160).chain(240..400), 240, aside_px));
            assert_eq!(broken.cut().is_some(), is_cut, "{aside_px} px");
        }
        assert!(of_pixels(broken(1..320, 160, 2.0)).cut().is_none());
    }

    /// What is left of a broken line is straight but for a wander of a fifth of a pixel, fast or so slow that its knots
    /// show all of it, and ends where it lies aside.
    #[test]
    fn straight_parts_wander_but_do_not_bend() {
        for wander_rows in [12.0, 25.0] {
            let column_px = |row: u16| {
                let wander_px = 0.2 * (f64::from(row) / wander_rows).sin();
                if row < 240 { 300.0 + wander_px } else { 301.5 }
            };
            let mut line: Line<16> = Line::new(point(0, column_px(0), 0.02));
            let rows = (1..160).chain(240..304);
            rows.for_each(|row| line.push(point(row, column_px(row), 0.02)).expect("rows in order"));
            let line = of_pixels(line);
            let cut = line.cut().expect("two parts");
            let mut first = line.clone();
            first.keep_before(&cut);
            assert_eq!(first.last.row, 159, "{wander_rows} rows");
        }
    }

    /// Beside a turn of many pixels a part that a lens bends by one is as straight as any.
    #[test]
    fn straight_parts_of_lines_that_turn_far_may_be_bent() {
        for (sagitta_px, is_whole) in [(1.0, true), (6.0, false)] {
            let column_px = |row: u16| {
                let part = f64::from(row.min(320)) / 320.0;
                let bent_px = 4.0 * sagitta_px * part * (1.0 - part);
                300.0 + bent_px + 0.25 * f64::from(row.saturating_sub(320))
            };
            let whole: Line<16> = line(column_px, 0.02);
            let mut first = whole.clone();
            first.keep_before(&whole.cut().expect("two parts"));
            assert_eq!((288..=320).contains(&first.last.row), is_whole, "{sagitta_px} px: {}", first.last.row);
        }
    }

    /// Two of six knots always lie on a straight line.
    #[test]
    fn what_is_straight_nowhere_stays_whole() {
        let column_px = |row: u16| if (row / 64).is_multiple_of(2) { 300.0 } else { 308.0 };
        let mut line: Line<8> = Line::new(point(0, column_px(0), 0.1));
        (1..384).for_each(|row| line.push(point(row, column_px(row), 0.1)).expect("rows in order"));
        assert_eq!(line.knots.len(), 6);
        assert!(line.cut().is_none());
    }

    /// What both parts know is what the whole line knew of their rows.
    #[test]
    fn both_parts_keep_what_they_know() {
        let turning = |end: u16| move |row: u16| 300.0 + 0.25 * f64::from(row.saturating_sub(end));
        for end in [175, 240, 304] {
            let column_px = turning(end);
            let whole: Line<16> = line(column_px, 0.1);
            let cut = whole.cut().expect("two parts");
            let (mut first, mut later) = (whole.clone(), whole.clone());
            first.keep_before(&cut);
            later.keep_after(&cut);
            assert!(later.first.row.abs_diff(end) <= 32, "{end}: {:?}", later.first);
            // But for the knot in which it turns.
            assert_eq!(first.points + later.points + 32, whole.points);
            for part in [&first, &later] {
                let rows = part.last.row - part.first.row + 1;
                assert_eq!(part.points, rows, "{end}");
                for knot in &part.knots {
                    let points = i64::from(knot.points);
                    let first_row = i64::from(part.first.row);
                    let rows = first_row * points + i64::from(knot.rows);
                    assert_eq!(part.first.time_ns * points + knot.times_ns, rows * 30_000);
                    let mean_px = (part.first.column_q16 as f64 + knot.columns_q16 as f64 / points as f64) / 65536.0;
                    let mean_row = rows as f64 / points as f64;
                    let off_px = mean_px - 300.0 - 0.25 * (mean_row - f64::from(end)).max(0.0);
                    assert!(off_px.abs() < 0.01, "{end}, row {mean_row}: {off_px}");
                }
            }
        }
    }
}
