//! [`Suspicion`]: what is probably wrong, as a sentence for a person.

use core::fmt::{self, Display, Formatter};

/// Some of the edges of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Share {
    /// How many.
    pub edges: u16,
    /// Of these, and those that are sound.
    pub of: u16,
}

/// A mistake that a frame shows. Its `Display` says what to check.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Suspicion {
    /// Edges slope against the motion: its sign is wrong, the readout's direction, or the image is mirrored.
    AgainstMotion(Share),
    /// Edges lean by their fit, with no exposure stated: gravity, readout or distortion is wrong.
    Leaning(Share),
    /// Edges lean by their fit or their blur: the exposure, the lens's blur or the response may be wrong as well.
    LeaningByBlur(Share),
    /// The motion says too little of them.
    Slow(Share),
    /// Edges are bent: motion or distortion is wrong, or the frames are not as the sensor read them.
    Bent(Share),
    /// Edges run along the rows: gravity is wrong, or the image was rotated.
    Sideways(Share),
    /// Nearly all grey levels lie within a hundredth of their range.
    FewLevels {
        /// But for a few pixels.
        darkest: u8,
        /// But for a few pixels.
        brightest: u8,
    },
    /// Neighbouring columns alternate, as those of a colour mosaic do, or of interleaved brightness and colour.
    AlternatingColumns,
}

impl Display for Suspicion {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        let (share, what) = match self {
            Self::FewLevels { darkest, brightest } => {
                return write!(
                    formatter,
                    "nearly all grey levels are {darkest} to {brightest} of 255: check exposure, lens cap and pixel format"
                );
            }
            Self::AlternatingColumns => {
                return formatter
                    .write_str("neighbouring columns alternate: convert a Bayer mosaic or YUYV to grey first");
            }
            Self::AgainstMotion(share) => {
                (share, "slope against the motion: check the sign of velocity_m_s, direction, or a mirrored image")
            }
            Self::Leaning(share) => (share, "lean: if they are upright, check gravity, readout and distortion"),
            Self::LeaningByBlur(share) => (
                share,
                "lean by their fit or their blur: if they are upright, check exposure_s, lens_blur_px and response; with \
                 sharpened or compressed frames leave exposure_s out",
            ),
            Self::Slow(share) => {
                (share, "are slow: check velocity_m_s; motion along the optical axis or along the edges shows no depth")
            }
            Self::Bent(share) => {
                (share, "are bent: check motion and distortion, and whether the frames are as the sensor read them")
            }
            Self::Sideways(share) => (share, "run along the rows: check gravity, and whether the picture was rotated"),
        };
        write!(formatter, "{} of {} edges {what}", share.edges, share.of)
    }
}
