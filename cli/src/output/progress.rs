//! Progress on standard error, if that is a terminal.

use indicatif::{ProgressBar, ProgressStyle};

/// Fewer are done before anyone looks.
const A_FEW: u64 = 5;

pub(crate) fn bar(frames: u64) -> ProgressBar {
    if frames <= A_FEW {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template("{bar:40} {pos}/{len} frames, {eta} left");
    let bar = ProgressBar::new(frames);
    match style {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
