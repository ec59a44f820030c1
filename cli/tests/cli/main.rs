//! The tool as its users meet it: arguments and files in, text, JSON and exit codes out.

mod calibration;
mod edges;
mod figures;
mod frame_times;
mod frames;
mod full_disks;
mod help;
mod hints;
mod imu;
mod limits;
mod overlays;
mod painting;
mod plans;
mod posts;
mod reference_lines;
mod refusals;
mod sensors;
mod sequences;
mod setup_files;
mod simulation_folders;
mod simulations;
mod stamps;
mod table2;
mod tool;
mod trajectories;
mod unusual_values;
