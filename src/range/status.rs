//! [`RangeStatus`]: what a range is worth.

/// What a range is worth.
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
    /// Inverse depth below minus three sigma: the edge leans or moves.
    Inconsistent,
    /// No straight edge fits.
    Bent,
    /// Too few rows.
    Short,
    /// Upright edges run along the rows: the camera lies on its side, or looks straight up or down.
    Sideways,
}
