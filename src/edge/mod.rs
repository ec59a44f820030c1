//! From a row of pixels to edge points, in integers.

mod tuning;
mod point;
mod pixel_row;
mod noise;
mod scanned_point;
mod coarse_scan;
mod fine_scan;
mod scan;
mod spread_function;
mod weight;
mod feet;
mod factor;
mod norms;
mod products;
mod template;
mod moments;
mod level_moments;
mod window;
mod whole_window;
mod near_window;
mod model;
mod fit;
mod quick_fit;
mod refine;
mod usual_row;
mod overshoot;

pub(crate) use model::EdgeModel;
pub(crate) use pixel_row::PixelRow;
pub use point::{EdgePoint, Polarity};
pub(crate) use refine::LocatedPoint;
pub use scan::Scanner;
pub use scanned_point::ScannedPoint;
pub(crate) use spread_function::SpreadFunction;
pub(crate) use tuning::PLATEAU;
pub(crate) use window::{Neighbours, Untracked};
