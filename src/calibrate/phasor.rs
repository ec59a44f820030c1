//! [`Phasor`]: turning through equal angles without trigonometry, whose errors in a coarse back end would pass for a
//! frequency.

use crate::scalar::Scalar;

/// A complex number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Phasor<S> {
    pub(super) re: S,
    pub(super) im: S,
}

/// The angle is halved so often for the series, and doubled again.
const HALVINGS: i32 = 3;

impl<S: Scalar> Phasor<S> {
    pub(super) const ZERO: Self = Self { re: S::ZERO, im: S::ZERO };
    pub(super) const ONE: Self = Self { re: S::ONE, im: S::ZERO };

    /// exp(i · 2π · turns), for half a turn at most: a series of an eighth of the angle, good to 10⁻¹².
    pub(super) fn of_turns(turns: S) -> Self {
        let angle = turns * S::from_ratio(6_283_185_307_179_586, 1_000_000_000_000_000) * S::ratio(1, 1 << HALVINGS);
        let square = angle * angle;
        let (mut cosine, mut sine) = (S::ONE, S::ONE);
        for k in (1..=6).rev() {
            cosine = S::ONE - cosine * square * S::ratio(1, (2 * k - 1) * (2 * k));
            sine = S::ONE - sine * square * S::ratio(1, 2 * k * (2 * k + 1));
        }
        let eighth = Self { re: cosine, im: sine * angle };
        (0..HALVINGS).fold(eighth, |phasor, _| phasor.times(phasor))
    }

    pub(super) fn times(self, other: Self) -> Self {
        Self { re: self.re * other.re - self.im * other.im, im: self.re * other.im + self.im * other.re }
    }

    pub(super) fn plus(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }

    pub(super) fn scaled(self, factor: S) -> Self {
        Self { re: self.re * factor, im: self.im * factor }
    }

    /// Squared size.
    pub(super) fn power(self) -> S {
        self.re * self.re + self.im * self.im
    }

    /// Real part of the product of one with the conjugate of the other.
    pub(super) fn along(self, other: Self) -> S {
        self.re * other.re + self.im * other.im
    }
}
