//! Files of several pictures, such as the stream of a motion JPEG: which of them is meant?

use anyhow::{Result, ensure};
use image::ImageFormat;

use super::jpeg;

/// Refuses a file in which another picture follows the first one. Other bytes may follow: zeros that fill a block, or
/// the video clip that some phones append.
pub(crate) fn refuse(bytes: &[u8], format: ImageFormat) -> Result<()> {
    let end = match format {
        ImageFormat::Jpeg => jpeg::end_of_only_picture(bytes),
        ImageFormat::Png => end_of_png(bytes),
        ImageFormat::Bmp => end_of_bmp(bytes),
        // Of netpbm files the decoder knows the end.
        _ => None,
    };
    let rest = end.and_then(|end| bytes.get(end..)).unwrap_or_default();
    let padding = rest.iter().take_while(|byte| **byte == 0).count();
    let begins_another = |rest: &[u8]| image::guess_format(rest).is_ok_and(|other| other == format);
    ensure!(
        !rest.get(padding..).is_some_and(begins_another),
        "another picture begins at byte {}, but a file must hold one frame: split it (of a motion JPEG: ffmpeg -f mjpeg \
         -i FILE -c copy frame-%04d.jpg)",
        bytes.len() - rest.len() + padding
    );
    Ok(())
}

/// After its last chunk. A chunk has its length, its name, its content and a checksum.
fn end_of_png(bytes: &[u8]) -> Option<usize> {
    const SIGNATURE: usize = 8;
    let mut at = SIGNATURE;
    loop {
        let (length, name) = bytes.get(at..at + 8)?.split_at(4);
        at = at.checked_add(12 + u32::from_be_bytes(length.try_into().ok()?) as usize)?;
        if name == b"IEND" {
            return Some(at);
        }
    }
}

/// As its header says.
fn end_of_bmp(bytes: &[u8]) -> Option<usize> {
    Some(u32::from_le_bytes(bytes.get(2..6)?.try_into().ok()?) as usize)
}
