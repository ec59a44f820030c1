//! [`Video`]: frames of a y4m stream, the form in which ffmpeg hands out any video.

use std::io::{BufRead, Read};

use anyhow::{Context, Result, anyhow, bail, ensure};
use image::{DynamicImage, GrayImage, ImageBuffer, Luma};

use super::grey_levels;
use super::picture::{Picture, refuse_other_size};
use super::size::Size;

/// A header has a few dozen bytes.
const LONGEST_HEADER: u64 = 1024;

pub(crate) struct Video<R> {
    input: R,
    size: Size,
    /// Significant bits of a sample; those above 8 take two bytes, the lower one first.
    bits: u32,
    /// Of the colour, which follows the grey levels.
    colour_bytes: u64,
    is_over: bool,
}

impl<R: BufRead> Video<R> {
    /// Reads the header; frames must be of this size, if one is given.
    pub(crate) fn open(mut input: R, expected: Option<Size>) -> Result<Self> {
        let header = line(&mut input)?.context("the stream is empty")?;
        let mut words = header.split(' ');
        if words.next() != Some("YUV4MPEG2") {
            let shown: String = header.chars().take(20).collect();
            bail!("the stream begins with `{shown}`, but must be y4m: ffmpeg -i VIDEO -f yuv4mpegpipe -");
        }
        let words: Vec<_> = words.collect();
        let value = |tag: char| words.iter().find_map(|word| word.strip_prefix(tag));
        let side = |tag: char| -> Result<u32> {
            let text = value(tag).with_context(|| format!("the y4m header has no {tag}"))?;
            text.parse().map_err(|_| anyhow!("the y4m header has {tag}{text}, but must have a number of pixels"))
        };
        let size = Size { columns: side('W')?, rows: side('H')? };
        refuse_other_size(size, expected)?;
        if let Some(interlaced @ ("t" | "b" | "m")) = value('I') {
            bail!(
                "the y4m header has I{interlaced}, but frames must not be interlaced: half of their rows are of another time"
            );
        }
        let colours = value('C').unwrap_or("420");
        let (bits, colour_samples) = samples(colours, size).with_context(|| {
            format!("the y4m header has C{colours}, but must have mono, 420, 411, 422 or 444 (ffmpeg: -pix_fmt gray)")
        })?;
        let colour_bytes = colour_samples * if bits > 8 { 2 } else { 1 };
        Ok(Self { input, size, bits, colour_bytes, is_over: false })
    }

    /// The next frame; `None` at the end. Nothing comes after an error.
    pub(crate) fn next_frame(&mut self) -> Result<Option<Picture>> {
        if self.is_over {
            return Ok(None);
        }
        let frame = self.read_frame();
        self.is_over = !matches!(frame, Ok(Some(_)));
        frame
    }

    fn read_frame(&mut self) -> Result<Option<Picture>> {
        let Some(header) = line(&mut self.input)? else { return Ok(None) };
        let is_frame = header == "FRAME" || header.starts_with("FRAME ");
        ensure!(is_frame, "the stream is damaged: a frame must begin with FRAME");
        let grey_bytes = self.size.pixels() * if self.bits > 8 { 2 } else { 1 };
        let mut grey = Vec::new();
        (&mut self.input).take(grey_bytes).read_to_end(&mut grey)?;
        let skipped = std::io::copy(&mut (&mut self.input).take(self.colour_bytes), &mut std::io::sink())?;
        let is_whole = grey.len() as u64 == grey_bytes && skipped == self.colour_bytes;
        ensure!(is_whole, "the stream is truncated: it ends within the frame");
        self.picture(grey).map(Some)
    }

    fn picture(&self, grey: Vec<u8>) -> Result<Picture> {
        let Size { columns, rows } = self.size;
        let picture: Option<DynamicImage> = if self.bits > 8 {
            let levels = grey.as_chunks().0.iter().map(|pair| u16::from_le_bytes(*pair)).collect();
            ImageBuffer::<Luma<u16>, Vec<u16>>::from_raw(columns, rows, levels).map(Into::into)
        } else {
            GrayImage::from_raw(columns, rows, grey).map(Into::into)
        };
        let (image, unused_bits) = grey_levels::stretched(picture.context("too few pixels")?, Some(self.bits))?;
        Ok(Picture { image, dump: None, unused_bits, is_torn: false })
    }
}

/// A line without its end; `None` at the end of the stream.
fn line(input: &mut impl BufRead) -> Result<Option<String>> {
    let mut line = Vec::new();
    input.take(LONGEST_HEADER).read_until(b'\n', &mut line)?;
    if line.is_empty() {
        return Ok(None);
    }
    ensure!(
        line.pop() == Some(b'\n'),
        "the stream is no y4m, or it is truncated: a header must end within {LONGEST_HEADER} bytes"
    );
    Ok(Some(String::from_utf8_lossy(&line).into_owned()))
}

/// Significant bits, and samples of colour beside those of grey.
fn samples(colours: &str, size: Size) -> Option<(u32, u64)> {
    let (layout, bits) = match colours.split_once('p') {
        Some((layout, bits)) if bits.bytes().all(|b| b.is_ascii_digit()) => (layout, bits),
        _ => colours.strip_prefix("mono").map_or((colours, ""), |bits| ("mono", bits)),
    };
    let bits = if bits.is_empty() { 8 } else { bits.parse().ok().filter(|bits| (9..=16).contains(bits))? };
    let part =
        |columns: u32, rows: u32| 2 * u64::from(size.columns.div_ceil(columns)) * u64::from(size.rows.div_ceil(rows));
    let colour = match layout {
        "mono" => 0,
        "420" | "420jpeg" | "420paldv" | "420mpeg2" => part(2, 2),
        "411" => part(4, 1),
        "422" => part(2, 1),
        "444" => part(1, 1),
        _ => return None,
    };
    Some((bits, colour))
}
