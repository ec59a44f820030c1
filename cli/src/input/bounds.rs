//! [`Bounds`]: what a number in an input file must be, as a test and in words.

use std::fmt::{self, Display, Formatter};

/// A range of numbers, both ends included.
#[derive(Clone, Copy)]
pub(crate) struct Bounds {
    least: f64,
    most: f64,
    whole: bool,
    /// Unit or meaning.
    what: &'static str,
}

impl Bounds {
    pub(crate) const fn number(least: f64, most: f64, what: &'static str) -> Self {
        Self { least, most, whole: false, what }
    }

    pub(crate) const fn whole(least: f64, most: f64, what: &'static str) -> Self {
        Self { least, most, whole: true, what }
    }

    pub(crate) const fn above_zero(most: f64, what: &'static str) -> Self {
        Self::number(f64::MIN_POSITIVE, most, what)
    }

    /// Any number but NaN and the infinite ones.
    pub(crate) const fn finite(what: &'static str) -> Self {
        Self::number(f64::MIN, f64::MAX, what)
    }

    pub(crate) fn contain(&self, value: f64) -> bool {
        (self.least..=self.most).contains(&value) && (!self.whole || value.fract() == 0.0)
    }
}

impl Display for Bounds {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { least, most, whole, what } = *self;
        let kind = if whole { "whole number" } else { "number" };
        if least == f64::MIN {
            write!(f, "a finite {kind} ({what})")
        } else if least == f64::MIN_POSITIVE {
            write!(f, "a {kind} above 0, at most {most} ({what})")
        } else {
            write!(f, "a {kind} from {least} to {most} ({what})")
        }
    }
}
