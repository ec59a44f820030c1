//! [`Knowledge`]: what is known of an edge before its line is seen: a [`Prior`], or [`Nothing`].

use super::blur::Blur;
use super::equation::Equation;
use super::line_state::{LineState, Statement};
use super::line3::Line3;
use super::shared_error::SharedError;
use super::unknowns::Unknowns;
use crate::motion::Motion;
use crate::scalar::{Scalar, dot, over};
use crate::setup::Setup;

/// Earlier frames, or an upright edge, and the blur: each becomes an equation of the same least squares.
#[derive(Clone, Copy)]
pub(crate) struct Prior<'a, S: Scalar> {
    /// What earlier frames have told.
    pub(super) state: Option<(&'a LineState<S>, &'a [Statement<S>; 3])>,
    pub(super) blur: Option<&'a dyn Blur<S>>,
    /// Blur of the edge, one sigma in pixels.
    pub(super) width_px: S,
    /// Rows from one point to the next.
    pub(super) row_spacing: S,
    /// Samples that are known to be those of something else.
    pub(super) left_out: SampleSet,
    /// The line is drawn where the edge is to be expected: that its residuals are small says nothing of its noise.
    pub(super) is_drawn: bool,
}

/// A set of a line's samples by their places; those beyond the 64th are in no set.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct SampleSet(u64);

impl SampleSet {
    pub(crate) fn insert(&mut self, place: usize) {
        self.0 |= Self::bit(place);
    }

    pub(crate) fn contains(self, place: usize) -> bool {
        self.0 & Self::bit(place) != 0
    }

    fn bit(place: usize) -> u64 {
        u32::try_from(place).ok().and_then(|place| 1_u64.checked_shl(place)).unwrap_or(0)
    }
}

/// By how much a unit of a shared error has moved a prior equation.
pub(super) enum PriorError<'a, S> {
    /// That of the tilt alone.
    Tilt(S),
    /// Through the earlier frames.
    Earlier(&'a LineState<S>, Statement<S>),
}

impl<S: Scalar> PriorError<'_, S> {
    pub(super) fn of(&self, index: usize, error: SharedError) -> S {
        match self {
            Self::Tilt(amount) if error == SharedError::Tilt => *amount,
            Self::Tilt(_) => S::ZERO,
            Self::Earlier(state, statement) => {
                let effect = state.sensitivity.0.get(index).copied().unwrap_or([S::ZERO; 3]);
                dot(statement.coefficients, effect) * statement.per_sigma
            }
        }
    }
}

impl<'a, S: Scalar> Prior<'a, S> {
    /// Without the blur. An edge of earlier frames comes with its [`LineState::statements`].
    pub(super) fn new(state: Option<(&'a LineState<S>, &'a [Statement<S>; 3])>, left_out: SampleSet) -> Self {
        Self { state, blur: None, width_px: S::ONE, row_spacing: S::ONE, left_out, is_drawn: false }
    }
}

/// Of a line that nothing is known of, neither earlier frames nor a blur: a type of its own, so that a program whose
/// lines are all such does not hold what asks for them.
pub(crate) struct Nothing;

/// What may be known of an edge; without earlier frames it is upright but for the setup's sigma of tilt.
pub(crate) trait Knowledge<S: Scalar> {
    /// What earlier frames have told.
    fn state(&self) -> Option<(&LineState<S>, &[Statement<S>; 3])> {
        None
    }

    fn blur(&self) -> Option<&dyn Blur<S>> {
        None
    }

    /// Blur of the edge, one sigma in pixels.
    fn width_px(&self) -> S {
        S::ONE
    }

    /// Rows from one point to the next.
    fn row_spacing(&self) -> S {
        S::ONE
    }

    /// Whether a sample is known to be one of something else.
    fn leaves_out(&self, _sample: usize) -> bool {
        false
    }

    /// Whether the line is drawn where the edge is to be expected.
    fn is_drawn(&self) -> bool {
        false
    }

    /// The directions that samples are held against, and where the edge was.
    fn axes<M: Motion<S>>(&self, motion: &M) -> Line3<S> {
        self.state().map_or_else(|| Line3::start(motion.gravity()), |(state, _)| state.line3)
    }

    /// Its equations but for the blur's, linearised about `at`.
    fn equations(&self, setup: &Setup<S>, gravity: [S; 3], at: &Unknowns<S>, mut each: impl FnMut(Equation<S>)) {
        match self.state() {
            Some((state, statements)) => {
                stated(statements).for_each(|statement| each(statement.equation(&state.line3, at)));
            }
            None => {
                let per_sigma = per_sigma_of_tilt(setup, gravity, at);
                if per_sigma > S::ZERO {
                    each(Equation { w: per_sigma, y: -(at.tilt * per_sigma), ..Equation::NOTHING });
                }
            }
        }
    }

    /// What shared errors do to each of [`equations`](Self::equations), in the same order.
    fn errors(&self, setup: &Setup<S>, gravity: [S; 3], at: &Unknowns<S>, mut each: impl FnMut(PriorError<'_, S>)) {
        match self.state() {
            Some((state, statements)) => {
                stated(statements).for_each(|statement| each(PriorError::Earlier(state, *statement)));
            }
            None => {
                let per_sigma = per_sigma_of_tilt(setup, gravity, at);
                if per_sigma > S::ZERO {
                    each(PriorError::Tilt(per_sigma));
                }
            }
        }
    }
}

impl<S: Scalar> Knowledge<S> for Nothing {}

impl<S: Scalar> Knowledge<S> for Prior<'_, S> {
    fn state(&self) -> Option<(&LineState<S>, &[Statement<S>; 3])> {
        self.state
    }

    fn blur(&self) -> Option<&dyn Blur<S>> {
        self.blur
    }

    fn width_px(&self) -> S {
        self.width_px
    }

    fn row_spacing(&self) -> S {
        self.row_spacing
    }

    fn leaves_out(&self, sample: usize) -> bool {
        self.left_out.contains(sample)
    }

    fn is_drawn(&self) -> bool {
        self.is_drawn
    }
}

/// Those that say something.
fn stated<S: Scalar>(statements: &[Statement<S>; 3]) -> impl Iterator<Item = &Statement<S>> {
    statements.iter().filter(|statement| statement.per_sigma > S::ZERO)
}

/// An edge is upright, but for its lean and the direction of gravity. Zero for a sigma of zero: no tilt at all.
fn per_sigma_of_tilt<S: Scalar>(setup: &Setup<S>, gravity: [S; 3], at: &Unknowns<S>) -> S {
    over(setup.uncertainty().sigma_tilt_at(at.bearing, gravity))
}
