//! From a row of pixels to edge points, in integers.

mod tuning;
mod point;
mod pixel_row;
mod noise;
mod scan;
mod spread_function;
mod weight;
mod factor;
mod norms;
mod template;
mod moments;
mod level_moments;
mod window;
mod whole_window;
mod model;
mod fit;
mod refine;

pub(crate) use model::EdgeModel;
pub(crate) use pixel_row::PixelRow;
pub use point::{EdgePoint, Polarity};
pub use scan::{ScannedPoint, Scanner};
pub(crate) use spread_function::SpreadFunction;
pub(crate) use tuning::PLATEAU;
pub(crate) use window::Neighbours;
