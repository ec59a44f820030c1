//! Pictures from files: what the file shows and nothing else, or an error. Each format has its own ways to be incomplete.

use std::io::Cursor;
use std::path::Path;

use anyhow::{Context, Error, Result, bail, ensure};
use image::codecs::pnm::PnmDecoder;
use image::{DynamicImage, GrayImage, ImageDecoder, ImageError, ImageFormat, ImageReader};

use super::bounded_read::{self, Limit, MEBIBYTE};
use super::grey_levels::{self, UnusedBits};
use super::raw_frame::RawFrame;
use super::size::Size;

/// A plain PPM has three numbers of five digits, each with a space.
const MOST_BYTES_PER_PIXEL: u64 = 18;
/// Thumbnails, colour profiles, and the video clip that some phones append to a JPEG.
const MOST_BYTES_BESIDE_PIXELS: u64 = 64 * MEBIBYTE;

pub(crate) struct Picture {
    pub(crate) image: DynamicImage,
    /// The pixels as the sensor delivered them, if the file is a dump.
    pub(crate) dump: Option<Vec<u8>>,
    /// Unless the file or the setup says how many bits its grey levels have.
    pub(crate) unused_bits: Option<UnusedBits>,
}

/// What pictures must be.
#[derive(Clone, Copy)]
pub(crate) struct PictureFormat {
    pub(crate) size: Size,
    /// The file is a plain dump of its pixels.
    pub(crate) raw: Option<RawFrame>,
    /// Significant bits of grey levels in a container of 16.
    pub(crate) bits: Option<u32>,
}

/// The size that the header of a picture states, for pictures of an unknown camera.
pub(crate) fn stated_size(path: &Path) -> Result<Size> {
    let name = || path.display().to_string();
    let reader = ImageReader::open(path).with_context(name)?.with_guessed_format().with_context(name)?;
    let (columns, rows) = reader.into_dimensions().map_err(damaged).with_context(name)?;
    Ok(Size { columns, rows })
}

/// The picture in a file.
pub(crate) fn load(path: &Path, format: &PictureFormat) -> Result<Picture> {
    let size = format.size;
    let picture = if let Some(raw) = format.raw {
        let limit = Limit { bytes: raw.bytes(), rule: &format!("--raw {raw} must have") };
        dump(bounded_read::read(path, &limit)?, &raw, &limit)
    } else {
        let bytes = size.pixels() * MOST_BYTES_PER_PIXEL + MOST_BYTES_BESIDE_PIXELS;
        let limit = Limit { bytes, rule: &format!("a picture of {size} pixels must have at most") };
        bounded_read::read(path, &limit).map(|bytes| decode(&bytes, format))?
    };
    picture.with_context(|| path.display().to_string())
}

fn dump(bytes: Vec<u8>, raw: &RawFrame, limit: &Limit<'_>) -> Result<Picture> {
    let found = bytes.len();
    ensure!(found as u64 == limit.bytes, "the file has {found} bytes, but {} {}", limit.rule, limit.bytes);
    let picture =
        GrayImage::from_raw(raw.size.columns, raw.size.rows, raw.grey(&bytes)).context("a frame of that size")?;
    Ok(Picture { image: picture.into(), dump: Some(bytes), unused_bits: None })
}

fn decode(bytes: &[u8], expected: &PictureFormat) -> Result<Picture> {
    ensure!(!bytes.is_empty(), "the file is empty");
    let format = image::guess_format(bytes).ok();
    let Some(format @ (ImageFormat::Png | ImageFormat::Jpeg | ImageFormat::Pnm)) = format else {
        bail!("the file is no PNG, JPEG or PGM/PPM; a plain dump needs --raw WIDTHxHEIGHT");
    };
    let mut reader = Cursor::new(bytes);
    let decoder = ImageReader::with_format(&mut reader, format).into_decoder().map_err(damaged)?;
    let (columns, rows) = decoder.dimensions();
    let (found, size) = (Size { columns, rows }, expected.size);
    // Before any pixel is read: a damaged header may promise more of them than there is memory for.
    ensure!(
        found == size,
        "the frame is {found} pixels, but must be {size} (`camera.columns` × `camera.rows` of the setup)"
    );
    ensure!(format != ImageFormat::Jpeg || jpeg_ends(bytes), "the file is truncated: a JPEG must have an end marker");
    let picture = DynamicImage::from_decoder(decoder).map_err(damaged)?;
    if format == ImageFormat::Pnm {
        refuse_second_frame(bytes, reader.position() as usize)?;
    }
    if states_its_range(bytes) {
        return Ok(Picture { image: picture, dump: None, unused_bits: None });
    }
    let (image, unused_bits) = grey_levels::stretched(picture, expected.bits)?;
    Ok(Picture { image, dump: None, unused_bits })
}

/// A netpbm file says which level is white; the decoder has stretched its levels. One that fills its container says no
/// more than any other file.
fn states_its_range(bytes: &[u8]) -> bool {
    let white = PnmDecoder::new(bytes).map(|decoder| decoder.header().maximal_sample());
    white.is_ok_and(|white| white != u32::from(u16::MAX))
}

fn damaged(error: ImageError) -> Error {
    Error::from(error).context("the file is truncated or damaged")
}

/// The decoder replaces what a truncated JPEG lacks by grey and reports no error. Embedded thumbnails have end markers as
/// well, but come before the first scan.
fn jpeg_ends(bytes: &[u8]) -> bool {
    const START_OF_SCAN: u8 = 0xDA;
    let mut rest = bytes.get(2..).unwrap_or_default();
    while let [0xFF, marker, high, low, ..] = *rest {
        let skipped = match marker {
            START_OF_SCAN => return rest.windows(2).any(|pair| pair == [0xFF, 0xD9]),
            // A fill byte before the marker.
            0xFF => 1,
            0x01 | 0xD0..=0xD9 => 2,
            _ => 2 + usize::from(u16::from_be_bytes([high, low])),
        };
        rest = rest.get(skipped..).unwrap_or_default();
    }
    false
}

/// Netpbm files may be concatenated, but which of the frames is meant?
fn refuse_second_frame(bytes: &[u8], end: usize) -> Result<()> {
    let is_text = matches!(bytes, [b'P', b'1'..=b'3', ..]);
    let rest = bytes.get(end..).unwrap_or_default();
    let rest = if is_text { rest.trim_ascii() } else { rest };
    ensure!(
        rest.is_empty(),
        "{} bytes are left after the first frame, but a file must hold one frame: split it (netpbm's pamsplit does)",
        rest.len()
    );
    Ok(())
}
