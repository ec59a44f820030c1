//! [`RangeStatus`]: what a range is worth, and the one place where that is decided.

use core::fmt::{self, Display, Formatter};

use crate::scalar::Scalar;

/// What a range is worth. One status, one cause; where several hold, the first that makes the number worthless.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum RangeStatus {
    /// A straight upright edge, inverse depth above three sigma.
    Ok,
    /// Inverse depth within three sigma of zero: the nearest possible depth is the news.
    Far,
    /// The motion says too little: sigma of inverse depth above 0.33 per metre.
    Slow,
    /// Inverse depth below minus three sigma: the slope is against the motion.
    Inconsistent,
    /// The edge leans more than its prior allows: by its own fit, or because its blur contradicts its slope. In a
    /// sequence that has measured the lean, only beyond [`Limits::max_lean_q16`](crate::Limits::max_lean_q16).
    Leaning,
    /// Several frames show the edge where a static one cannot be.
    Moving,
    /// In a sequence: the line alone would be refused as cluttered or short, or is new where other edges are known or
    /// wholly beside one of them, and too few frames agree yet.
    Tentative,
    /// No straight edge fits: a part departs by more than
    /// [`Limits::max_departure_q16`](crate::Limits::max_departure_q16), or the camera would pass the edge within the
    /// frame. So is what stands still from where the light of the rows changes, or up to there, or goes on a step aside as
    /// most edges of the frame do: in pulsed light a piece of an edge does, however near it is. Of a [strict](crate::Range::strict) range: its points scatter more than stated.
    Bent,
    /// So much texture around it, or so few rows that scatter so much, that this line may be one by chance.
    Cluttered,
    /// Too few rows.
    Short,
    /// Upright edges run along the rows: the camera lies on its side, or looks straight up or down.
    Sideways,
}

/// Beyond so many sigmas a number differs from zero.
const SIGNIFICANT_SIGMAS: i32 = 3;

/// Largest sigma of an inverse depth that still says something, in hundredths per metre: an edge at 1 m is then told
/// from infinity by three sigmas.
const MOST_SIGMA_CENTI_PER_M: i32 = 33;

/// What can speak against a line whose numbers look sound.
#[derive(Clone, Copy)]
pub(crate) enum Objection {
    Clutter,
    /// The blur contradicts the slope.
    Blur,
    /// It begins or breaks off where the light changes.
    Light,
    /// The fit itself tells a lean that the prior excludes.
    FittedLean,
    Motion,
    /// Too few frames agree on a weak line, or on a new one.
    FewFrames,
}

impl RangeStatus {
    /// From the numbers of an estimate alone.
    pub(super) fn of_numbers<S: Scalar>(inverse_depth_per_m: S, sigma_per_m: S, is_bent: bool) -> Self {
        let significant = sigma_per_m * S::from_i32(SIGNIFICANT_SIGMAS);
        if is_bent {
            Self::Bent
        } else if !(sigma_per_m <= S::ratio(MOST_SIGMA_CENTI_PER_M, 100) && inverse_depth_per_m.is_finite()) {
            Self::Slow
        } else if inverse_depth_per_m > significant {
            Self::Ok
        } else if inverse_depth_per_m < -significant {
            Self::Inconsistent
        } else {
            Self::Far
        }
    }

    /// The same with what else speaks against the line. Where the numbers refuse it already, that is told.
    #[must_use]
    pub(crate) fn unless(self, objection: Objection, holds: bool) -> Self {
        let is_sound = match objection {
            Objection::FittedLean | Objection::Blur => matches!(self, Self::Ok | Self::Far),
            // A piece of an edge in pulsed light stands still.
            Objection::Light => self == Self::Far,
            // What moves may look as if it leaned.
            Objection::Motion => matches!(self, Self::Ok | Self::Leaning),
            Objection::FewFrames => matches!(self, Self::Ok | Self::Inconsistent),
            _ => self == Self::Ok,
        };
        if !(holds && is_sound) {
            return self;
        }
        match objection {
            Objection::FittedLean | Objection::Blur => Self::Leaning,
            Objection::Clutter => Self::Cluttered,
            Objection::Light => Self::Bent,
            Objection::Motion => Self::Moving,
            Objection::FewFrames => Self::Tentative,
        }
    }

    /// Whether the slope is that of a depth, as far as this line tells, so that bounds of a depth follow from it.
    #[must_use]
    pub const fn bounds_depth(self) -> bool {
        matches!(self, Self::Ok | Self::Far | Self::Slow | Self::Short)
    }

    /// The name of the status in lower case, as the command line has it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::Far => "far",
            Self::Slow => "slow",
            Self::Inconsistent => "inconsistent",
            Self::Leaning => "leaning",
            Self::Moving => "moving",
            Self::Tentative => "tentative",
            Self::Bent => "bent",
            Self::Cluttered => "cluttered",
            Self::Short => "short",
            Self::Sideways => "sideways",
        }
    }
}

impl Display for RangeStatus {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}
