//! JPEG: all of the picture, or an error, or the word that it is torn. What is lost in transfer is never taken for
//! seen.

use anyhow::{Context, Result, anyhow, ensure};
use image::{DynamicImage, GrayImage, RgbImage};
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use super::huffman_tables;
use super::jpeg_scan::ScanHeader;
use super::size::Size;

pub(crate) struct Jpeg {
    bytes: Vec<u8>,
    pub(crate) size: Size,
    is_grey: bool,
}

impl Jpeg {
    /// Reads the header. A frame of a motion JPEG leaves out the tables that all of its kind share.
    pub(crate) fn open(bytes: &[u8]) -> Result<Self> {
        let bytes = with_tables(bytes);
        let mut decoder = decoder(&bytes, ColorSpace::Luma, false);
        decoder.decode_headers().map_err(damaged)?;
        let (columns, rows) = decoder.dimensions().context("a JPEG without a size")?;
        let size = Size { columns: u32::try_from(columns)?, rows: u32::try_from(rows)? };
        let is_grey = decoder.input_colorspace() == Some(ColorSpace::Luma);
        Ok(Self { bytes, size, is_grey })
    }

    /// The picture, and whether it is torn: bytes were lost, so that parts of it lie where they do not belong and the
    /// rest is made up.
    pub(crate) fn decode(&self) -> Result<(DynamicImage, bool)> {
        ensure!(end(&self.bytes).is_some(), "the file is truncated: a JPEG must have an end marker");
        let is_whole = is_whole(&self.bytes);
        let colours = if self.is_grey { ColorSpace::Luma } else { ColorSpace::RGB };
        let mut decoder = decoder(&self.bytes, colours, is_whole.is_none());
        let pixels = decoder.decode().map_err(damaged)?;
        let Size { columns, rows } = self.size;
        let picture: Option<DynamicImage> = if self.is_grey {
            GrayImage::from_raw(columns, rows, pixels).map(Into::into)
        } else {
            RgbImage::from_raw(columns, rows, pixels).map(Into::into)
        };
        Ok((picture.context("a JPEG with too few pixels")?, is_whole == Some(false)))
    }
}

/// Unless it is strict, it replaces what is missing by grey.
fn decoder(bytes: &[u8], colours: ColorSpace, is_strict: bool) -> JpegDecoder<ZCursor<&[u8]>> {
    let options = DecoderOptions::default().set_strict_mode(is_strict);
    let options = options.set_max_width(usize::MAX).set_max_height(usize::MAX).jpeg_set_out_colorspace(colours);
    JpegDecoder::new_with_options(ZCursor::new(bytes), options)
}

fn damaged(error: zune_jpeg::errors::DecodeErrors) -> anyhow::Error {
    anyhow!("{error}").context("the file is truncated or damaged")
}

const START_OF_SCAN: u8 = 0xDA;
const HUFFMAN_TABLES: u8 = 0xC4;
const FURTHER_PICTURES: u8 = 0xE2;

/// The markers before the pixels, each with what follows it.
fn markers(bytes: &[u8]) -> impl Iterator<Item = (u8, &[u8])> {
    let mut rest = bytes.get(2..).unwrap_or_default();
    std::iter::from_fn(move || {
        let [0xFF, marker, high, low, ..] = *rest else { return None };
        let at = rest;
        let skipped = match marker {
            START_OF_SCAN => rest.len(),
            // A fill byte before the marker.
            0xFF => 1,
            0x01 | 0xD0..=0xD9 => 2,
            _ => 2 + usize::from(u16::from_be_bytes([high, low])),
        };
        rest = rest.get(skipped..).unwrap_or_default();
        Some((marker, at))
    })
}

/// The end of the first picture. Embedded thumbnails have end markers as well, but come before the first scan.
fn end(bytes: &[u8]) -> Option<usize> {
    let (_, scan) = markers(bytes).find(|(marker, _)| *marker == START_OF_SCAN)?;
    let length = scan.windows(2).position(|pair| pair == [0xFF, 0xD9])? + 2;
    Some(bytes.len() - scan.len() + length)
}

/// The same; `None` where the file lists the pictures in it: phones and stereo cameras put others after the one to look
/// at (CIPA DC-007).
pub(super) fn end_of_only_picture(bytes: &[u8]) -> Option<usize> {
    let lists_pictures = |(marker, segment): (u8, &[u8])| {
        marker == FURTHER_PICTURES && segment.get(4..).is_some_and(|content| content.starts_with(b"MPF\0"))
    };
    end(bytes).filter(|_| !markers(bytes).any(lists_pictures))
}

/// `None` for a progressive one, of which the decoder sees whether it ends too early.
fn is_whole(bytes: &[u8]) -> Option<bool> {
    let mut header = ScanHeader::default();
    for (marker, segment) in markers(bytes) {
        if marker == START_OF_SCAN {
            return header.is_whole(segment);
        }
        if !matches!(marker, 0x01 | 0xD0..=0xD9 | 0xFF) {
            header.take(marker, segment)?;
        }
    }
    None
}

fn with_tables(bytes: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    let (has_scan, has_tables) = markers(&bytes).fold((false, false), |(scan, tables), (marker, _)| {
        (scan || marker == START_OF_SCAN, tables || marker == HUFFMAN_TABLES)
    });
    if has_scan && !has_tables {
        bytes.splice(2..2, huffman_tables::segment());
    }
    bytes
}
