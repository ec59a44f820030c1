//! Pictures from files: what the file shows and nothing else, or an error. Each format has its own ways to be
//! incomplete.

use std::io::Cursor;
use std::path::Path;

use anyhow::{Context, Error, Result, anyhow, bail, ensure};
use image::codecs::pnm::PnmDecoder;
use image::{DynamicImage, GrayImage, ImageDecoder, ImageError, ImageFormat, ImageReader};

use super::bounded_read::{self, Limit, MEBIBYTE};
use super::grey_levels::{self, UnusedBits};
use super::jpeg::Jpeg;
use super::raw_frame::RawFrame;
use super::second_picture;
use super::size::Size;

/// A plain PPM has three numbers of five digits, each with a space.
const MOST_BYTES_PER_PIXEL: u64 = 18;
/// Thumbnails, colour profiles, and the video clip that some phones append to a JPEG.
const MOST_BYTES_BESIDE_PIXELS: u64 = 64 * MEBIBYTE;

/// Of a picture whose size is not known beforehand.
const LARGEST: Size = Size { columns: 20_000, rows: 10_000 };

pub(crate) struct Picture {
    pub(crate) image: DynamicImage,
    /// The pixels as the sensor delivered them, if the file is a dump.
    pub(crate) dump: Option<Vec<u8>>,
    /// Unless the file or the setup says how many bits its grey levels have.
    pub(crate) unused_bits: Option<UnusedBits>,
    /// A part was lost in transfer, nobody knows where: nothing in it can be trusted.
    pub(crate) is_torn: bool,
}

impl Picture {
    /// *Errors*: a part of it was lost.
    pub(crate) fn into_grey(self) -> Result<GrayImage> {
        ensure!(!self.is_torn, "bytes of this JPEG were lost");
        Ok(self.image.to_luma8())
    }
}

/// What pictures must be.
#[derive(Clone, Copy)]
pub(crate) struct PictureFormat {
    /// Any, if none is given; a plain dump needs one.
    pub(crate) size: Option<Size>,
    /// The file is a plain dump of its pixels.
    pub(crate) raw: Option<RawFrame>,
    /// Significant bits of grey levels in a container of 16.
    pub(crate) bits: Option<u32>,
}

/// A picture as grey levels, for what needs all of it.
pub(crate) fn load_grey(path: &Path, format: &PictureFormat) -> Result<GrayImage> {
    load(path, format)?.into_grey().with_context(|| path.display().to_string())
}

/// The picture in a file.
pub(crate) fn load(path: &Path, format: &PictureFormat) -> Result<Picture> {
    let picture = if let Some(raw) = format.raw {
        let limit = Limit { bytes: raw.bytes(), rule: &format!("--raw {raw} must have") };
        dump(bounded_read::read(path, &limit)?, &raw, &limit)
    } else {
        let size = format.size.unwrap_or(LARGEST);
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
    Ok(Picture { image: picture.into(), dump: Some(bytes), unused_bits: None, is_torn: false })
}

fn decode(bytes: &[u8], expected: &PictureFormat) -> Result<Picture> {
    ensure!(!bytes.is_empty(), "the file is empty");
    let (picture, is_torn) = match image::guess_format(bytes) {
        Ok(ImageFormat::Jpeg) => {
            second_picture::refuse(bytes, ImageFormat::Jpeg)?;
            let jpeg = Jpeg::open(bytes)?;
            refuse_other_size(jpeg.size, expected.size)?;
            jpeg.decode()?
        }
        Ok(format @ (ImageFormat::Bmp | ImageFormat::Png | ImageFormat::Pnm)) => {
            (plain(bytes, format, expected.size)?, false)
        }
        _ => bail!("the file is no PNG, JPEG, BMP or PGM/PPM; a plain dump needs --raw WIDTHxHEIGHT"),
    };
    if states_its_range(bytes) {
        return Ok(Picture { image: picture, dump: None, unused_bits: None, is_torn });
    }
    let (image, unused_bits) = grey_levels::stretched(picture, expected.bits)?;
    Ok(Picture { image, dump: None, unused_bits, is_torn })
}

fn plain(bytes: &[u8], format: ImageFormat, size: Option<Size>) -> Result<DynamicImage> {
    let mut reader = Cursor::new(bytes);
    let decoder = ImageReader::with_format(&mut reader, format).into_decoder().map_err(damaged)?;
    let (columns, rows) = decoder.dimensions();
    refuse_other_size(Size { columns, rows }, size)?;
    let picture = DynamicImage::from_decoder(decoder).map_err(damaged)?;
    match format {
        ImageFormat::Pnm => refuse_second_frame(bytes, reader.position() as usize)?,
        other => second_picture::refuse(bytes, other)?,
    }
    Ok(picture)
}

/// Before any pixel is read: a damaged header may promise more of them than there is memory for.
pub(crate) fn refuse_other_size(found: Size, size: Option<Size>) -> Result<()> {
    let Some(size) = size else {
        ensure!(
            found.pixels() <= LARGEST.pixels(),
            "the frame is {found} pixels, but must have at most {}",
            LARGEST.pixels()
        );
        return Ok(());
    };
    ensure!(
        found == size,
        "the frame is {found} pixels, but must be {size} (`camera.columns` × `camera.rows` of the setup)"
    );
    Ok(())
}

/// A netpbm file says which level is white; the decoder has stretched its levels. One that fills its container says no
/// more than any other file.
fn states_its_range(bytes: &[u8]) -> bool {
    let white = PnmDecoder::new(bytes).map(|decoder| decoder.header().maximal_sample());
    white.is_ok_and(|white| white != u32::from(u16::MAX))
}

/// With the cause alone: what is around it repeats it.
fn damaged(error: ImageError) -> Error {
    anyhow!("the file is truncated or damaged: {}", Error::from(error).root_cause())
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
