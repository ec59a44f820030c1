//! [`Asides`]: what lies a step beside the ends of a line.

/// Whether another line of its kind is a step to the left, or to the right, where a line begins or breaks off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Asides {
    pub(super) left: bool,
    pub(super) right: bool,
}

impl Asides {
    pub(super) const NONE: Self = Self { left: false, right: false };

    pub(super) fn any(self) -> bool {
        self != Self::NONE
    }

    pub(super) const fn or(self, other: Self) -> Self {
        Self { left: self.left || other.left, right: self.right || other.right }
    }
}
