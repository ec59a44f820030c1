//! The commands, one file each.

pub(crate) mod setup;
pub(crate) mod table2;
pub(crate) mod edges;
pub(crate) mod frame;
pub(crate) mod inspect;
pub(crate) mod simulate;
pub(crate) mod sensors;
