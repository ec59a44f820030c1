//! What a whole frame says of a setup or of its pixels that is probably wrong.

mod suspicion;
mod edges;
mod pixels;

pub use edges::FrameReport;
pub use pixels::PixelReport;
pub use suspicion::{Share, Suspicion};
