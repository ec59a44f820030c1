//! The commands, one file each.

pub(crate) mod setup;
pub(crate) mod table2;
pub(crate) mod edges;
pub(crate) mod frame;
pub(crate) mod inspect;
pub(crate) mod simulate;
pub(crate) mod sensors;
pub(crate) mod calibrate_flicker;
pub(crate) mod calibrate_scale;
pub(crate) mod calibrate_imu;
pub(crate) mod plan;
pub(crate) mod figure_charts;
pub(crate) mod figures;
