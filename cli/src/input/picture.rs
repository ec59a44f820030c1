//! Pictures from files: what the file shows and nothing else, or an error. The formats have their own ways to be cut short.

use std::io::Cursor;
use std::path::Path;

use anyhow::{Context, Error, Result, bail, ensure};
use image::{DynamicImage, GrayImage, ImageDecoder, ImageError, ImageFormat, ImageReader};

use super::size::Size;

/// The picture in a file, of that size; with `raw`, of a plain dump.
pub(crate) fn load(path: &Path, size: Size, raw: bool) -> Result<DynamicImage> {
    let name = path.display().to_string();
    let bytes = std::fs::read(path).with_context(|| format!("reading {name}"))?;
    let picture = if raw { dump(bytes, size) } else { decode(&bytes, size) };
    picture.context(name)
}

fn dump(bytes: Vec<u8>, size: Size) -> Result<DynamicImage> {
    let (found, due) = (bytes.len(), u64::from(size.columns) * u64::from(size.rows));
    let picture = GrayImage::from_raw(size.columns, size.rows, bytes).filter(|_| found as u64 == due);
    let picture = picture.with_context(|| format!("the file has {found} bytes, but --raw {size} must have {due}"))?;
    Ok(DynamicImage::ImageLuma8(picture))
}

fn decode(bytes: &[u8], size: Size) -> Result<DynamicImage> {
    ensure!(!bytes.is_empty(), "the file is empty");
    let format = image::guess_format(bytes).ok();
    let Some(format @ (ImageFormat::Png | ImageFormat::Jpeg | ImageFormat::Pnm)) = format else {
        bail!("the file is no PNG, JPEG or PGM/PPM; a plain dump needs --raw WIDTHxHEIGHT");
    };
    let decoder = ImageReader::with_format(Cursor::new(bytes), format).into_decoder().map_err(damaged)?;
    let (columns, rows) = decoder.dimensions();
    let found = Size { columns, rows };
    // Before the pixels, of which a wrong header may promise any number.
    ensure!(
        found == size,
        "the frame is {found} pixels, but must be {size} (`camera.columns` × `camera.rows` of the setup)"
    );
    ensure!(format != ImageFormat::Jpeg || jpeg_ends(bytes), "the file is truncated: a JPEG must have an end marker");
    DynamicImage::from_decoder(decoder).map_err(damaged)
}

fn damaged(error: ImageError) -> Error {
    Error::from(error).context("the file is truncated or damaged")
}

/// The decoder fills what a JPEG lacks with grey, so that it cannot tell. Embedded thumbnails have end markers as well,
/// but stand before the first scan.
fn jpeg_ends(bytes: &[u8]) -> bool {
    const START_OF_SCAN: u8 = 0xDA;
    let mut rest = bytes.get(2..).unwrap_or_default();
    while let [0xFF, marker, high, low, ..] = *rest {
        let skipped = match marker {
            START_OF_SCAN => return rest.windows(2).any(|pair| pair == [0xFF, 0xD9]),
            // A fill byte: the marker comes yet.
            0xFF => 1,
            0x01 | 0xD0..=0xD9 => 2,
            _ => 2 + usize::from(u16::from_be_bytes([high, low])),
        };
        rest = rest.get(skipped..).unwrap_or_default();
    }
    false
}
