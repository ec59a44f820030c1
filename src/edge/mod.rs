//! From a row of pixels to edge points, in integers.

mod point;
mod pixel_row;
mod scan;
mod spread_function;
mod moments;
mod window;
mod model;

pub(crate) use model::EdgeModel;
pub(crate) use pixel_row::PixelRow;
pub use point::{EdgePoint, Polarity};
pub use scan::{ScannedPoint, Scanner};
pub(crate) use spread_function::SpreadFunction;
pub(crate) use window::{Neighbours, PLATEAU};
