//! [`Scanner`]: one row of pixels in, its edge points out, in integers.
//!
//! A row is scanned twice. The coarse scan compares the sums of four pixels before and after every second boundary and
//! keeps the spans of eight pixels where they differ by more than noise explains. The fine scan, in those spans alone,
//! slides the difference of the two windows over the row: each run of one sign above the noise is a point of an edge,
//! and the centroid of the run is its column.

use core::ops::Range;

use super::coarse_scan::coarse;
use super::fine_scan::fine;
use super::noise::{Across, Down, WINDOW};
use super::quiet::Quiet;
use super::scanned_point::ScannedPoint;
use super::tuning::{
    LEAST_DIFFERENCE, LEAST_NOISE_Q8, LEAST_RISE, MOST_HIDDEN, NOISE_SIGMAS, PEAK_SIGMAS_Q1, QUIET_SIGMAS, RISE_Q3,
    TEXTURE_SIGMAS, UPRIGHT_RATIO,
};
use crate::format::Pixels;

/// Finds the edge points of rows of pixels. All that it remembers is the noise and the texture of the rows so far, and
/// a few pixels of them: 84 bytes.
///
/// The threshold follows from the rows themselves, so neither exposure nor gain needs tuning: an edge is found where
/// the means of two neighbouring windows of four pixels differ by more than six grey levels and by more than four sigma
/// of what is usual in these rows, or three where that is not noise but texture; where it is quiet, six sigma of noise
/// are enough, whatever texture there is elsewhere. Noise and texture change down the rows as much as across them; where
/// what is usual across does not, upright edges are usual, as in a fence.
///
/// *Limits*: edges within eight pixels of the border are not found, nor any in rows of fewer than 32 pixels; a fence
/// whose contrast is below 40 levels may pass for texture. *Cost*: some six instructions a pixel, and fifteen more near
/// an edge.
///
/// ```
/// use shutter_range::Scanner;
/// let mut row = [40_u8; 64];
/// row[32..].fill(200);
/// row[31] = 120; // half covered: the edge is in the middle of pixel 31
/// let mut scanner = Scanner::new();
/// let mut points = 0;
/// scanner.scan(&row, |point| {
///     assert_eq!((point.column_q16 + (1 << 8)) >> 9, 31 << 7);
///     points += 1;
/// });
/// assert_eq!(points, 1);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Scanner {
    across: Across,
    down: Down,
    quiet: Quiet,
}

impl Scanner {
    /// Edges at least this far apart have no pixel of their windows in common.
    pub(crate) const SEES_ALONE_Q16: u32 = (2 * WINDOW as u32) << 16;

    /// A scanner that has seen nothing yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { across: Across::new(), down: Down::new(), quiet: Quiet::UNSEEN }
    }

    /// One sigma of a pixel's noise as the rows so far show it, in 1/256 grey level.
    #[must_use]
    pub const fn noise_q8(&self) -> u32 {
        let noise_q8 = usual(self.across.noise_q8(), self.down.noise_q8());
        if noise_q8 > LEAST_NOISE_Q8 { noise_q8 } else { LEAST_NOISE_Q8 }
    }

    /// The next row is the first of a frame. Without this the noise of its first rows is compared with the frame
    /// before.
    pub(crate) const fn begin_frame(&mut self) {
        self.down.begin_frame();
        self.quiet = Quiet::UNSEEN;
    }

    /// Scans a row, dark 0 to bright 255 if it is one of bytes, and hands its edge points to `found`, from left to
    /// right.
    pub fn scan(&mut self, pixels: impl Pixels, found: impl FnMut(ScannedPoint)) {
        let _ = self.scan_where(pixels, None, &[], true, found);
    }

    /// Passes over a row in which nothing new is looked for.
    pub(crate) fn pass(&mut self, pixels: impl Pixels) {
        self.down.learn(&pixels);
    }

    /// Whether texture or noise everywhere hides edges that are anything but faint.
    pub(crate) fn is_blinded(&self) -> bool {
        hides_edges(self.least_difference())
    }

    /// Scans a row, but only in the columns that are asked for, where these are given, and but for the flanks of known
    /// edges, from left to right: positions whose differences are these edges' own. What differs elsewhere in the spans
    /// with such a flank is looked at where `looks_beside` says so. Whether what is in view is hidden, as
    /// [`Scanner::is_blinded`] says.
    pub(crate) fn scan_where(
        &mut self,
        pixels: impl Pixels,
        asked: Option<&[Range<u16>]>,
        flanks: &[Range<u16>],
        looks_beside: bool,
        mut found: impl FnMut(ScannedPoint),
    ) -> bool {
        self.across.learn(&pixels);
        self.down.learn(&pixels);
        let noise_q8 = self.noise_q8();
        let anywhere = self.least_difference();
        let where_quiet = (QUIET_SIGMAS * of_noise(self.across.noise_q8())) >> 8;
        let least_peak = |least: u32| least.max(LEAST_DIFFERENCE).max((PEAK_SIGMAS_Q1 * of_noise(noise_q8)) >> 9);
        // Where neither is above the least difference, they are the same.
        let quiet = if where_quiet.max(LEAST_DIFFERENCE) < anywhere {
            self.quiet.begin_row();
            Some((least_peak(where_quiet), &mut self.quiet))
        } else {
            None
        };
        let mut seen = 0;
        let limits = |least: u32| {
            (least.max(LEAST_DIFFERENCE) as i32, ((least * RISE_Q3) >> 3).max(LEAST_RISE) as i32, noise_q8)
        };
        let (anywhere_limits, quiet_limits) = (limits(anywhere), limits(where_quiet));
        let mut ahead = flanks;
        let look = |stretch, is_quiet| {
            let limits = if is_quiet { quiet_limits } else { anywhere_limits };
            between(&mut ahead, stretch, |positions| seen = fine(&pixels, positions, seen, limits, &mut found));
        };
        if asked.is_none_or(|asked| !asked.is_empty()) {
            let explained = if looks_beside { &[] } else { flanks };
            coarse(&pixels, least_peak(anywhere), quiet, asked, explained, look);
        }
        hides_edges(anywhere)
    }

    /// How large a difference is that what is usual does not explain.
    fn least_difference(&self) -> u32 {
        let of_noise_q8 = of_noise(self.noise_q8());
        let usual_q8 = usual(self.across.difference_q8(), self.down.difference_q8()).max(of_noise_q8);
        // What is usual is texture where noise does not explain half of it.
        let of_texture_q8 = (TEXTURE_SIGMAS * usual_q8).max(2 * NOISE_SIGMAS * of_noise_q8);
        (NOISE_SIGMAS * usual_q8).min(of_texture_q8) >> 8
    }
}

/// One sigma of a difference, which sums eight pixels, in 1/256 grey level.
const fn of_noise(noise_q8: u32) -> u32 {
    noise_q8 * 181 / 64
}

/// Whether edges that are anything but faint differ by no more than this.
const fn hides_edges(least_difference: u32) -> bool {
    least_difference > WINDOW as u32 * MOST_HIDDEN
}

/// Whether what is usual across a row is so much less down the rows that it is upright edges.
const fn is_upright(across: u32, down: u32) -> bool {
    // As their quotient says it, for which cores without division take a hundred instructions.
    let down = if down < 1 << 30 { down } else { 1 << 30 };
    across >= UPRIGHT_RATIO * (down + 1)
}

const fn usual(across: u32, down: u32) -> u32 {
    if is_upright(across, down) { down } else { across }
}

/// Hands over the positions of a stretch, and the one before, which the coarse scan has not compared, but for those in
/// a flank. Leaves the flanks that are not behind this stretch.
fn between(flanks: &mut &[Range<u16>], stretch: Range<usize>, mut look: impl FnMut(Range<usize>)) {
    let (mut start, end) = (stretch.start.saturating_sub(1), stretch.end);
    while let [first, others @ ..] = *flanks
        && usize::from(first.end) <= start
    {
        *flanks = others;
    }
    for flank in *flanks {
        let (from, to) = (usize::from(flank.start), usize::from(flank.end));
        if from >= end {
            break;
        }
        if to > start {
            if from > start {
                look(start..from);
            }
            start = to;
        }
    }
    if start < end {
        look(start..end);
    }
}
