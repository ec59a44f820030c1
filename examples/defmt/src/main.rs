//! Logs ranges with defmt: the board sends a few bytes a line, the desktop turns them into text.
#![no_std]
#![no_main]

use cortex_m as _; // the critical section that the logger takes
use defmt_semihosting as _; // the logger
use semihosting as _; // the panic handler: message on stderr, exit code 101

use shutter_range::{EdgePoint, ParameterError, Ranger, Setup, Sigmas, Twist};

/// A post of 2.5 m, passed at 1.5 m/s, in a QVGA frame; the second edge lies behind the horizon of what can be told.
fn run() -> Result<(), ParameterError> {
    let setup = Setup::pinhole(320, 240, 300.0_f32, 16_666_667)?;
    let readout = *setup.readout();
    let motion = Twist::level([-1.5, 0.0, 0.0])?;
    defmt::info!("{}", setup.readout());
    let mut ranger: Ranger<4, 12, 4> = Ranger::new();
    for row in 0..readout.rows() {
        let time_ns = readout.row_time_ns(row);
        let shift_px = |depth_m: f32| 300.0 * 1.5 * (time_ns as f32 * 1e-9) / depth_m;
        for column_px in [100.0 + shift_px(2.5), 200.0 + shift_px(500.0)] {
            let edge = EdgePoint::new(row, (column_px * 65536.0) as i32, time_ns);
            if let Err(refused) = ranger.edge_point(&setup, edge) {
                defmt::warn!("{}", refused);
            }
        }
    }
    // Too late: the row has been read already.
    if let Err(refused) = ranger.edge_point(&setup, EdgePoint::new(7, 0, 0)) {
        defmt::warn!("{}", refused);
    }
    ranger.end_frame(&setup);
    while let Some(range) = ranger.next_range(&setup, &motion) {
        defmt::info!("{}: {}", range.status, range.depth(Sigmas(2.0)));
        defmt::debug!("{}", range);
    }
    defmt::info!("{}", ranger.counters());
    Ok(())
}

#[cortex_m_rt::entry]
fn main() -> ! {
    match run() {
        Ok(()) => semihosting::process::exit(0),
        Err(error) => {
            defmt::error!("{}", error);
            semihosting::process::exit(1)
        }
    }
}
