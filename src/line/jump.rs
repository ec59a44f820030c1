//! Whether the lines of a frame all jump at one row: then the frame is torn, or its light is pulsed.

use heapless::Vec;

use super::track::{State, Track};
use super::tuning::{
    JUMP_ROWS, LEAST_JUMP_Q16, MOST_ASKED, MOST_BROKEN, MOST_CHANCE_Q32, MOST_JUMP_ROWS, MOST_PULSE_Q16, SAME_JUMP_Q16,
    YOUNG_POINTS,
};
use crate::edge::Polarity;

/// The lines on either side of a row.
///
/// Where rows are missing, frames are mixed, bytes are lost or the light is pulsed, the edges are all displaced at one
/// row: each line that comes to it breaks off, and goes on elsewhere. Edges of the world that end and begin at one row,
/// as windows do, do not all go on by the same displacement.
///
/// *Cost*: of the order of 24 times the square of the lines that begin there, where any breaks off; else a look at each
/// line.
pub(super) struct Jump<const LINES: usize> {
    /// Of the image, in 1/65536 px.
    columns_q16: i64,
    /// The first of them, which stand for all.
    broken: Vec<Broken, MOST_BROKEN>,
    all_broken: usize,
    begun: Vec<Begun, LINES>,
    /// Slopes of the lines that go on, in 1/65536 px per row.
    whole: Vec<i32, LINES>,
}

/// A line that breaks off: where it should have gone on.
struct Broken {
    column_q16: i64,
    slope_q16: i32,
    polarity: Polarity,
    /// That it had before.
    rows: u16,
}

impl Broken {
    /// Whether it has stayed within a pixel, as between two pulses of light.
    fn is_at_rest(&self) -> bool {
        (i64::from(self.slope_q16) * i64::from(self.rows)).abs() < LEAST_JUMP_Q16
    }
}

/// How far an edge may move between two pulses of light, in 1/65536 px.
const PULSE_Q16: core::ops::RangeInclusive<i64> = LEAST_JUMP_Q16..=MOST_PULSE_Q16;

/// A line that begins.
struct Begun {
    column_q16: i64,
    polarity: Polarity,
}

/// What may displace the lines.
#[derive(Clone, Copy)]
enum Displacement {
    /// Bytes of a row were lost: each by as much, in 1/65536 px, and what leaves a row goes on in the next one.
    Columns(i64),
    /// Rows are missing, or are of another frame: each as far as it moves in so many rows.
    Rows(i64),
    /// Pulses of light show the edges at rest, now here and now there, the nearer ones farther: some pixels to the
    /// right, or to the left.
    Right,
    Left,
}

impl<const LINES: usize> Jump<LINES> {
    pub(super) fn new(columns: u16) -> Self {
        let (broken, begun, whole) = (Vec::new(), Vec::new(), Vec::new());
        Self { columns_q16: i64::from(columns) << 16, broken, all_broken: 0, begun, whole }
    }

    /// Sorts in a line under way, as seen from `row`, by what it does `age` rows before.
    pub(super) fn add<const KNOTS: usize>(&mut self, track: &Track<KNOTS>, row: u16, age: u16) {
        let (first, last) = (track.line.first(), track.line.last());
        let (since_first, since_last) = (row.abs_diff(first.row), row.abs_diff(last.row));
        let is_old = track.state != State::Tentative && since_first >= age + YOUNG_POINTS;
        let polarity = first.polarity;
        // There is room: one of either for each line. Of those that break off the first stand for all.
        if is_old && since_last >= age.saturating_sub(JUMP_ROWS) && since_last <= age + JUMP_ROWS {
            let rows = i64::from(since_last) - i64::from(age);
            let slope_q16 = track.filter.slope_q16;
            let column_q16 = i64::from(track.filter.column_q16) + rows * i64::from(slope_q16);
            let _ = self.broken.push(Broken { column_q16, slope_q16, polarity, rows: since_first - since_last });
            self.all_broken += 1;
        } else if is_old && since_last < age {
            let _ = self.whole.push(track.filter.slope_q16);
        } else if since_first.abs_diff(age) <= JUMP_ROWS && track.line.points() >= YOUNG_POINTS / 2 {
            let _ = self.begun.push(Begun { column_q16: i64::from(first.column_q16), polarity });
        }
    }

    /// Whether all lines go on elsewhere by one and the same displacement, or all but one in four, and chance hardly
    /// makes that.
    pub(super) fn is_common(&self) -> bool {
        let asked = self.broken.iter().take(MOST_ASKED);
        let is_shift = |line: &Broken| {
            let begun = self.begun.iter().filter(|begun| begun.polarity == line.polarity);
            begun.map(|begun| begun.column_q16 - line.column_q16).any(|jump_q16| {
                let rows = jump_q16.checked_div(i64::from(line.slope_q16)).filter(|rows| rows.abs() <= MOST_JUMP_ROWS);
                self.is_displaced(Displacement::Columns(jump_q16))
                    || rows.is_some_and(|rows| self.is_displaced(Displacement::Rows(rows)))
            })
        };
        self.is_displaced(Displacement::Right) || self.is_displaced(Displacement::Left) || asked.clone().any(is_shift)
    }

    /// Whether hardly any line that should be displaced by a pixel or more is not, no more lines go on as they were,
    /// and chance hardly makes that.
    #[inline(never)] // it is asked from four places, and seldom
    fn is_displaced(&self, displacement: Displacement) -> bool {
        let moves = |slope_q16: i32| match displacement {
            Displacement::Rows(rows) => (rows * i64::from(slope_q16)).abs() >= LEAST_JUMP_Q16,
            Displacement::Columns(columns_q16) => columns_q16.abs() >= LEAST_JUMP_Q16,
            Displacement::Right | Displacement::Left => true,
        };
        let moved = self.broken.iter().filter(|line| moves(line.slope_q16) && self.goes_on(line, displacement));
        let whole = self.whole.iter().filter(|slope_q16| moves(**slope_q16)).count();
        let are_all = |count: usize| 4 * count * self.all_broken >= 3 * self.broken.len() * (self.all_broken + whole);
        // Most displacements are none: a few lines tell.
        if !are_all(self.broken.len()) || self.broken.len() < self.whole.len() {
            return false;
        }
        let count = moved.clone().count();
        let stays = || self.broken.iter().filter(|line| self.goes_on(line, Displacement::Rows(0))).count();
        are_all(count)
            && count >= self.whole.len()
            && count > stays()
            && self.chance_q32(moved, displacement) <= MOST_CHANCE_Q32
    }

    /// How often such lines break off within the same rows, and others begin where they are displaced to, if neither
    /// has to do with the other, in 1/2³².
    fn chance_q32<'a>(&self, mut moved: impl Iterator<Item = &'a Broken>, displacement: Displacement) -> u64 {
        let begun = self.begun.len() as u64;
        let (trials, width_q16) = match displacement {
            // One line and each that begins make a displacement; all others agree with it.
            Displacement::Columns(_) | Displacement::Rows(_) => {
                let _ = moved.next();
                (MOST_ASKED as u64 * begun, 2 * SAME_JUMP_Q16)
            }
            Displacement::Right | Displacement::Left => (2, MOST_PULSE_Q16.unsigned_abs()),
        };
        let rows = u64::from(2 * JUMP_ROWS + 1);
        moved.fold(trials << 32, |chance_q32, line| {
            let within = rows * begun * width_q16;
            let among = u64::from(line.rows.max(1)) * self.columns_q16.unsigned_abs();
            let part_q16 = (within << 8).checked_div(among >> 8).unwrap_or(1 << 16).min(1 << 16);
            (chance_q32 >> 16).saturating_mul(part_q16)
        })
    }

    /// Whether a line begins where this one is displaced to.
    #[inline(never)]
    fn goes_on(&self, line: &Broken, displacement: Displacement) -> bool {
        self.begun.iter().filter(|begun| begun.polarity == line.polarity).any(|begun| {
            let jump_q16 = begun.column_q16 - line.column_q16;
            match displacement {
                Displacement::Columns(columns_q16) => {
                    let apart_q16 = jump_q16.abs_diff(columns_q16);
                    apart_q16.min(self.columns_q16.unsigned_abs().abs_diff(apart_q16)) <= SAME_JUMP_Q16
                }
                Displacement::Rows(rows) => jump_q16.abs_diff(rows * i64::from(line.slope_q16)) <= SAME_JUMP_Q16,
                Displacement::Right => line.is_at_rest() && PULSE_Q16.contains(&jump_q16),
                Displacement::Left => line.is_at_rest() && PULSE_Q16.contains(&-jump_q16),
            }
        })
    }
}
