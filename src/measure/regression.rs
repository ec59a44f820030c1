//! A straight line through stamps, in sums of whole numbers: the period is its slope.
//!
//! Stamps come in pieces, one for each stretch without a gap that was not counted. The pieces share the slope and have
//! each their own phase, so what is added up is each piece's spread about its own means.

use super::tuning::{LONGEST_MEMORY, PIECE_PERIODS, PIECE_STAMPS};

/// Sums are in 1/65536: a piece's means are fractions.
const FRACTION_BITS: u32 = 16;

/// Deviations from the reference line, in ticks, whose squares a piece can add up: 2¹⁰ × 2⁵² is below 2⁶³.
const LARGEST_DEVIATION: i64 = 1 << 26;

/// The sums of one piece: n, Σk, Σk², Σr, Σkr, Σr² with periods k and ticks r beyond the reference line.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
struct Piece {
    count: i64,
    k: i64,
    kk: i64,
    r: i64,
    kr: i64,
    rr: i64,
}

/// Spreads about the means, added up over pieces, in 1/65536.
#[derive(Clone, Copy, Debug, Default)]
struct Spread {
    kk: i128,
    kr: i128,
    rr: i128,
    /// Stamps less pieces.
    freedom: i64,
}

/// The line: its reference period in ticks, the piece that grows, and what earlier ones told.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Regression {
    reference: i64,
    piece: Piece,
    #[cfg_attr(feature = "defmt", defmt(Debug2Format))]
    earlier: Spread,
}

/// A slope and its variance.
pub(super) struct Slope {
    /// Period in 1/2³² tick.
    pub(super) period_q32: u128,
    /// One standard deviation of it, likewise.
    pub(super) sigma_q32: u128,
}

impl Regression {
    pub(super) fn new(reference: i64) -> Self {
        Self { reference, piece: Piece::default(), earlier: Spread::default() }
    }

    pub(super) fn reference(&self) -> i64 {
        self.reference
    }

    /// Adds a stamp; `false` where the piece is full and must be ended first.
    pub(super) fn push(&mut self, periods: i64, ticks: i64) -> bool {
        let deviation = ticks - periods * self.reference;
        if self.piece.count >= PIECE_STAMPS || periods > PIECE_PERIODS || deviation.abs() > LARGEST_DEVIATION {
            return false;
        }
        self.piece.add(periods, deviation);
        true
    }

    /// The next stamp begins a piece of its own.
    pub(super) fn end_piece(&mut self) {
        self.earlier = self.spread();
        self.piece = Piece::default();
        if self.earlier.freedom > LONGEST_MEMORY {
            self.earlier = self.earlier.halved();
        }
    }

    fn spread(&self) -> Spread {
        let piece = self.piece.spread().unwrap_or_default();
        let earlier = &self.earlier;
        Spread {
            kk: earlier.kk + piece.kk,
            kr: earlier.kr + piece.kr,
            rr: earlier.rr + piece.rr,
            freedom: earlier.freedom + piece.freedom,
        }
    }

    /// The slope, where the stamps are no better than `least_variance` (ticks², in 1/65536). `None` for fewer than two
    /// stamps in one piece.
    pub(super) fn slope(&self, least_variance_q16: u64) -> Option<Slope> {
        let Spread { kk, kr, rr, freedom } = self.spread();
        let slope_q32 = (kr << 32).checked_div(kk)?;
        let explained = slope_q32.checked_mul(kr).map_or(0, |product| product >> 32);
        let variance = variance_q16(rr - explained, freedom - 1).max(u128::from(least_variance_q16));
        // Half of all bits for the numerator, so that it can be shifted by the other half.
        let sigma_q32 = (variance.min(1 << 63) << 64).checked_div(kk.unsigned_abs())?.isqrt();
        let period_q32 = (i128::from(self.reference) << 32) + slope_q32;
        Some(Slope { period_q32: period_q32.try_into().ok()?, sigma_q32 })
    }
}

/// Variance of a stamp from the squares that the line leaves, as it enters the variance of the slope.
///
/// A slope whose scatter is estimated from f degrees of freedom follows Student's law; its variance is f/(f-2) times
/// that with the scatter known, and so wide are two sigma from three degrees of freedom on. Below, the scatter is not
/// known at all.
fn variance_q16(squares_q16: i128, freedom: i64) -> u128 {
    let known = i128::from(freedom - 2).max(0);
    squares_q16.max(0).checked_div(known).unwrap_or(0).unsigned_abs()
}

impl Piece {
    fn add(&mut self, k: i64, r: i64) {
        self.count += 1;
        self.k += k;
        self.kk += k * k;
        self.r += r;
        self.kr += k * r;
        self.rr += r * r;
    }

    /// `None` for an empty piece.
    fn spread(&self) -> Option<Spread> {
        let count = i128::from(self.count);
        let about_means = |product: i64, a: i64, b: i64| {
            let scaled = (i128::from(product) * count - i128::from(a) * i128::from(b)) << FRACTION_BITS;
            scaled.checked_div(count)
        };
        Some(Spread {
            kk: about_means(self.kk, self.k, self.k)?,
            kr: about_means(self.kr, self.k, self.r)?,
            rr: about_means(self.rr, self.r, self.r)?,
            freedom: self.count - 1,
        })
    }
}

impl Spread {
    fn halved(self) -> Self {
        Self { kk: self.kk >> 1, kr: self.kr >> 1, rr: self.rr >> 1, freedom: self.freedom >> 1 }
    }
}
