//! The whole way from rows to ranges behind one type, and the state of a frame.

mod frame;
mod ranger;
mod points;
mod pixels;

pub use ranger::{BoardRanger, DesktopRanger, Ranger, SmallRanger};
