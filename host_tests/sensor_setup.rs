//! The ten lines of the README, from an I²C bus to a `Setup`.

use embedded_hal::i2c::I2c;
use embedded_hal_mock::eh1::i2c::Mock;
use shutter_range::sensor::{Chip, Sensor, SensorError};
use shutter_range::{Camera, Distortion, Intrinsics, MotionBlur, Setup, Uncertainty};

use crate::sensor_chips::CASES;
use crate::sensor_transactions::of_identity_and_mode;

fn setup<B: I2c>(i2c: &mut B) -> Result<Setup<f32>, SensorError<B::Error>> {
    let mut sensor = Sensor::find(i2c, 24_000_000)?; // 24 MHz go into the sensor
    let mode = sensor.mode()?; // as your driver has set it
    let camera = Camera::new(Intrinsics::centred(mode.columns, mode.rows(), 600.0), Distortion::NONE)?;
    let uncertainty = Uncertainty::default().with_sigma_readout(mode.sigma());
    let setup = Setup::new(camera, mode.readout)?.with_uncertainty(uncertainty)?;
    Ok(setup.with_motion_blur(MotionBlur::from_exposure(mode.exposure_s()))?)
}

#[test]
fn ten_lines_lead_from_a_bus_to_a_setup() {
    let case = CASES.iter().find(|case| case.chip == Chip::Ov7670).expect("a case of OV7670");
    let mut mock = Mock::new(&of_identity_and_mode(case));
    let setup = setup(&mut mock).expect("a sound mode");
    mock.done();
    assert_eq!((setup.camera().intrinsics().columns, setup.readout().rows()), (640, 480));
    assert_eq!(setup.readout().line_time_ps(), 65_333_333);
    assert_eq!(setup.uncertainty().sigma_readout, 0.001);
    // 250 lines.
    assert_eq!(setup.motion_blur().map(|blur| blur.exposure_s), Some(0.016_333_333));
}

#[test]
fn the_readme_shows_these_very_lines() {
    let here = include_str!("sensor_setup.rs");
    let begin = here.find("fn setup<").expect("the function");
    let end = begin + here[begin..].find("\n}\n").expect("its end") + 3;
    assert!(include_str!("../README.md").contains(&here[begin..end]));
}
