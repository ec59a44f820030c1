//! All host tests, one harness: the library's own code against the paper, the reference edges and synthetic scenes.

mod back_ends;
mod bad_input;
mod blur;
mod camera;
mod clutter;
mod coverage;
mod endpoints;
mod frames;
mod harness;
mod journey;
mod knots;
mod monte_carlo;
mod projection;
mod readout;
mod reference_lines;
mod scanning;
mod scenes;
mod sequence;
mod simulator;
mod statuses;
mod symmetries;
mod table2;
mod torn;
mod tracking;
mod trajectory;
mod uncertainty;
