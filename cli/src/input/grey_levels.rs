//! Pictures of more than 8 bits: their grey levels are stretched to the range of the container, so that none is lost to
//! upper bits that are never used.

use anyhow::{Result, ensure};
use image::DynamicImage;

/// Levels of a 16-bit container that leave its upper bits unused.
#[derive(Clone, Copy)]
pub(crate) struct UnusedBits {
    /// The highest level.
    pub(crate) most: u16,
    /// As many as sensors have, and enough for it.
    pub(crate) bits: u32,
}

impl UnusedBits {
    fn of(samples: &[u16]) -> Option<Self> {
        const BITS: [u32; 4] = [8, 10, 12, 14];
        let most = highest(samples);
        BITS.into_iter().find(|bits| most < 1 << bits).map(|bits| Self { most, bits })
    }
}

/// The same picture with levels of so many bits as the whole range of its container; an 8-bit one as it is. Without
/// `bits`, tells whether upper ones are unused.
pub(crate) fn stretched(picture: DynamicImage, bits: Option<u32>) -> Result<(DynamicImage, Option<UnusedBits>)> {
    match picture {
        DynamicImage::ImageLuma16(_) | DynamicImage::ImageLumaA16(_) => {
            let mut grey = picture.into_luma16();
            let unused = stretch(&mut grey, bits)?;
            Ok((grey.into(), unused))
        }
        DynamicImage::ImageRgb16(_) | DynamicImage::ImageRgba16(_) => {
            let mut colour = picture.into_rgb16();
            let unused = stretch(&mut colour, bits)?;
            Ok((colour.into(), unused))
        }
        _ => Ok((picture, None)),
    }
}

fn stretch(samples: &mut [u16], bits: Option<u32>) -> Result<Option<UnusedBits>> {
    let Some(bits) = bits else { return Ok(UnusedBits::of(samples)) };
    let (found, most) = (highest(samples), (1_u32 << bits) - 1);
    ensure!(
        u32::from(found) <= most,
        "a grey level is {found}, but must be at most {most} (`camera.bits` of the setup is {bits})"
    );
    for sample in samples {
        // At most 65535.
        *sample = ((u32::from(*sample) * u32::from(u16::MAX) + most / 2) / most) as u16;
    }
    Ok(None)
}

fn highest(samples: &[u16]) -> u16 {
    samples.iter().copied().max().unwrap_or(0)
}
