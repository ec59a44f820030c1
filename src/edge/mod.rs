//! From a row of pixels to edge points, in integers.

mod point;
mod scan;
mod spread_function;
mod moments;
mod window;
mod model;

pub(crate) use model::Profile;
pub use point::{Edge, Polarity};
pub use scan::{ScannedEdge, Scanner};
pub(crate) use window::Neighbours;
