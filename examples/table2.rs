//! The paper's field test, Table 2: 40 distances from the measured angles, in single precision.
//!
//! Desktop: `cargo run --release --example table2`
//! Board (emulated Cortex-M4F): `cargo run --release --example table2 --target thumbv7em-none-eabihf`
//! Prints what is in `table2.out`.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod board;

use board::say;
use shutter_range::Scalar;
use shutter_range::rse::{PAPER_KAPPA, Shear};

const TABLE: &str = include_str!("../host_tests/data/table2.csv");

struct Measurement {
    case: u8,
    readout_s: f32,
    speed_m_s: f32,
    gps_m: f32,
    rse_deg: f32,
    published_m: f32,
}

/// One line of the table: `case,shutter_s,speed_m_s,distance_m,rse_deg,estimated_m,error_m`.
fn parse(line: &str) -> Option<Measurement> {
    let mut fields = line.trim().split(',');
    let case = fields.next()?.parse().ok()?;
    let (numerator, denominator) = fields.next()?.split_once('/')?;
    let readout_s = numerator.parse::<f32>().ok()? / denominator.parse::<f32>().ok()?;
    let mut number = || fields.next()?.parse::<f32>().ok();
    Some(Measurement {
        case,
        readout_s,
        speed_m_s: number()?,
        gps_m: number()?,
        rse_deg: number()?,
        published_m: number()?,
    })
}

fn main() {
    let shear = Shear::parallel(PAPER_KAPPA as f32, 0.0);
    let mut rows = 0_u16;
    let mut squares = 0.0;
    say!("case  speed m/s  angle deg   GPS m  published m  computed m");
    for row in TABLE.lines().skip(1).filter_map(parse) {
        let computed_m = shear.distance_m(row.rse_deg.to_radians(), row.speed_m_s, row.readout_s);
        say!(
            "{:4}  {:9.4}  {:9.2}  {:6.3}  {:11.4}  {:10.4}",
            row.case,
            row.speed_m_s,
            row.rse_deg,
            row.gps_m,
            row.published_m,
            computed_m
        );
        squares += (computed_m - row.gps_m) * (computed_m - row.gps_m);
        rows += 1;
    }
    say!("{rows} rows, RMS error against GPS {:.3} m", Scalar::sqrt(squares / f32::from(rows)));
}
