//! Progress on standard error, if that is a terminal.

use indicatif::{ProgressBar, ProgressStyle};

/// A run of this many frames is over in a second.
const FEW_FRAMES: u64 = 5;

pub(crate) fn bar(frames: u64) -> ProgressBar {
    if frames <= FEW_FRAMES {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template("{bar:40} {pos}/{len} frames, {eta} left");
    let bar = ProgressBar::new(frames);
    match style {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
