//! The tool as its users meet it: arguments and files in, text, JSON and exit codes out.

mod courses;
mod edges;
mod frames;
mod overlays;
mod painting;
mod reference_lines;
mod refusals;
mod sensors;
mod sequences;
mod simulations;
mod table2;
mod tool;
