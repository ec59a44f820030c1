//! Files in: setups, edge points, trajectories, pictures and scenes, with errors that name what is wrong where.

pub(crate) mod nearest;
pub(crate) mod bounds;
pub(crate) mod size;
pub(crate) mod raw_frame;
pub(crate) mod file_identity;
pub(crate) mod bounded_read;
pub(crate) mod toml_file;
pub(crate) mod keys;
pub(crate) mod usual;
pub(crate) mod camera_keys;
pub(crate) mod setup;
pub(crate) mod table_file;
pub(crate) mod edge_file;
pub(crate) mod frame_times;
pub(crate) mod trajectory_file;
pub(crate) mod grey_levels;
pub(crate) mod picture;
pub(crate) mod scene_file;
