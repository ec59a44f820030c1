//! HM01B0 on a Raspberry Pi Pico or Pico 2: registers over I²C, pixels through PIO and DMA, a distance for each post.
//!
//! | Pico | HM01B0 | |
//! | --- | --- | --- |
//! | GP4, GP5 | SDA, SCL | pull-ups of 2.2 to 10 kΩ, mostly on the module |
//! | GP6 to GP13 | D0 to D7 | |
//! | GP14 | PCLKO | |
//! | GP15 | LVLD | line valid |
//! | GP16 | FVLD | frame valid |
//! | GP18 | MCLK | 12.5 MHz from here; leave it open where the module has a clock of its own |
//! | 3V3, GND | AVDD, IOVDD, GND | as the module asks for |
//!
//! *Expect* the chip and its line time, then for each frame a line for each edge: status, distance and sigma. What it
//! says of a simulated scene is in `README.md`.
#![no_std]
#![no_main]

mod board;
mod hm01b0;
mod rows;

use defmt_rtt as _;
use panic_probe as _;

use board::Board;
use rows::{RowError, Rows};
use shutter_range::sensor::{Sensor, SensorError};
use shutter_range::{
    BoardRanger, Camera, Distortion, Intrinsics, MotionBlur, Response, Setup, Sigmas, Twist, Uncertainty,
};

/// Of the lens: focal length over pixel pitch, 2.1 mm / 3.6 µm here. Calibrate it, or range a post at a known distance.
const FOCAL_PX: f32 = 583.0;
/// The robot drives to the right, seen from the camera, at this speed. A moving robot has a [`Trajectory`] of its wheel
/// and gyroscope samples instead, as the firmware for the STM32H743 shows.
///
/// [`Trajectory`]: shutter_range::Trajectory
const VELOCITY_M_S: [f32; 3] = [0.2, 0.0, 0.0];
/// Lines of exposure: 9.6 ms.
const EXPOSURE_LINES: u16 = 5;

type BusError = board::BusError;

/// What the sensor itself says of its timing, with what is known of the lens.
fn setup(sensor: &mut Sensor<&mut board::Bus>) -> Result<Setup<f32>, SensorError<BusError>> {
    let mode = sensor.mode()?;
    defmt::info!(
        "{} x {} pixels, {} ps a line, {} ppm",
        mode.columns,
        mode.rows(),
        mode.readout.line_time_ps(),
        mode.sigma_ppm
    );
    let camera = Camera::new(Intrinsics::centred(mode.columns, mode.rows(), FOCAL_PX), Distortion::NONE)?;
    let uncertainty = Uncertainty::default().with_sigma_readout(mode.sigma());
    let setup = Setup::new(camera, mode.readout)?.with_uncertainty(uncertainty)?.with_response(Response::Linear);
    Ok(setup.with_motion_blur(MotionBlur::from_exposure(mode.exposure_s()))?)
}

/// Takes the rows of a frame as they come. A row that the last one's work has made late tears the frame.
fn take_frame(setup: &Setup<f32>, ranger: &mut BoardRanger, mut rows: Rows) -> Rows {
    rows.begin_frame();
    for row in 0..setup.readout().rows() {
        match rows.next() {
            Ok(pixels) => {
                if let Err(refused) = ranger.row(setup, row, pixels) {
                    defmt::warn!("{}", refused);
                }
            }
            Err(RowError::Late) => {
                ranger.tear();
                break;
            }
        }
    }
    if ranger.is_torn() {
        defmt::warn!("torn frame");
    }
    ranger.end_frame(setup);
    rows
}

fn run(board: Board) -> Result<(), SensorError<BusError>> {
    let Board { mut bus, rows, mut delay } = board;
    hm01b0::initialise(&mut bus, &mut delay)?;
    let mut sensor = Sensor::find(&mut bus, board::MCLK_HZ)?;
    defmt::info!("{}", sensor.chip());
    sensor.set_exposure_lines(EXPOSURE_LINES)?;
    let setup = setup(&mut sensor)?;
    let motion = Twist::level(VELOCITY_M_S)?;
    hm01b0::stream(sensor.release())?;

    let Some(ranger) = cortex_m::singleton!(: BoardRanger = BoardRanger::new()) else { return Ok(()) };
    let mut rows = rows;
    loop {
        rows = take_frame(&setup, ranger, rows);
        while let Some(range) = ranger.next_range(&setup, &motion) {
            let depth = range.depth(Sigmas(2.0));
            defmt::info!("column {}: {}, {}", range.column_at_first_row, range.status, depth);
        }
        defmt::info!("frame, {}", ranger.counters());
    }
}

#[board::entry]
fn main() -> ! {
    if let Err(error) = run(board::start()) {
        defmt::error!("{}", error);
    }
    loop {
        cortex_m::asm::wfi();
    }
}
