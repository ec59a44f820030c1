//! Results out: reports, tables, overlays, simulated frames, and progress.

pub(crate) mod safe_file;
pub(crate) mod outputs;
pub(crate) mod rounding;
pub(crate) mod text_table;
pub(crate) mod glyphs;
pub(crate) mod canvas;
pub(crate) mod progress;
pub(crate) mod terminal;
pub(crate) mod report;
pub(crate) mod range_table;
pub(crate) mod frame_writer;
pub(crate) mod markup;
pub(crate) mod birds_eye;
pub(crate) mod ground;
pub(crate) mod html_report;
pub(crate) mod truth;
pub(crate) mod motion_file;
pub(crate) mod simulation_folder;
pub(crate) mod overlay;
pub(crate) mod chart;
pub(crate) mod map;
