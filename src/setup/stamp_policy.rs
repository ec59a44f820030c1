//! [`StampPolicy`]: whether the stamps of edge points or the readout tell the time of a row.

/// What tells when a row was exposed: the stamp of its edge points, or the readout.
///
/// A clock that ticks every millisecond, or a DMA block whose rows share one stamp, looks like a lean of every edge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum StampPolicy {
    /// The stamps, if they rise with the rows at the pace of the readout. Where they do not, in ticks, in blocks or
    /// late, the readout tells the time of the whole frame. A stamp outside the frame that the readout allows is an
    /// error.
    #[default]
    Checked,
    /// The stamps as they are: for a readout that is not known well.
    Trusted,
    /// The readout; stamps are not looked at.
    Ignored,
}
