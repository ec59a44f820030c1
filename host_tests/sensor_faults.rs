//! What can go wrong on the bus and in the registers, and what the driver may write.

use proptest::prelude::*;
use shutter_range::ParameterError;
use shutter_range::sensor::{Chip, Evidence, Sensor, SensorError};

use crate::scenes::seeded;
use crate::sensor_bus::{FakeSensor, Fault, SCCB, Step};
use crate::sensor_chips::CASES;

type Outcome<T> = Result<T, SensorError<Fault>>;

/// A use of a sensor with its chip and clock.
type Use = fn(&mut FakeSensor, Chip, u32) -> Outcome<()>;

/// All that a firmware does with a sensor, each at any step of which the bus may fail.
const USES: [(&str, Use); 5] = [
    ("new", |fake, chip, clock_hz| Sensor::new(fake, chip, clock_hz).map(drop)),
    ("find", |fake, _, clock_hz| Sensor::find(fake, clock_hz).map(drop)),
    ("mode", |fake, chip, clock_hz| Sensor::new(fake, chip, clock_hz)?.mode().map(drop)),
    ("exposure", |fake, chip, clock_hz| Sensor::new(fake, chip, clock_hz)?.set_exposure_lines(100)),
    ("frame", |fake, chip, clock_hz| {
        let mut sensor = Sensor::new(fake, chip, clock_hz)?;
        let lines = sensor.mode()?.frame_lines;
        sensor.set_frame_lines(lines + 7)
    }),
];

#[test]
fn every_step_of_the_bus_may_fail_and_says_so_with_the_bus_s_own_error() {
    for case in CASES {
        for (name, use_it) in USES {
            let whole = {
                let mut fake = (case.sensor)();
                use_it(&mut fake, case.chip, case.clock_hz).unwrap_or_else(|error| panic!("{}: {error}", case.name));
                fake.steps
            };
            assert!(whole >= 1);
            for step in 0..whole {
                let mut fake = (case.sensor)().failing_at(step);
                let error = use_it(&mut fake, case.chip, case.clock_hz).expect_err("a broken bus");
                assert_eq!(error, SensorError::Bus(Fault::Broken(step)), "{}, {name}, step {step}", case.name);
                assert_eq!(error.to_string(), format!("bus: Broken({step})"));
            }
        }
    }
}

#[test]
fn find_tells_every_chip_from_every_other() {
    for case in CASES {
        let mut fake = (case.sensor)();
        let sensor = Sensor::find(&mut fake, case.clock_hz).unwrap_or_else(|error| panic!("{}: {error}", case.name));
        assert_eq!(sensor.chip(), case.chip, "{}", case.name);
        assert!(case.chip.addresses().contains(&sensor.address()));
    }
}

/// Asking a chip whether it is another one changes nothing in it, not even its page.
#[test]
fn being_asked_in_vain_leaves_no_trace() {
    for case in CASES {
        for chip in Chip::ALL {
            if chip == case.chip || !chip.addresses().contains(&(case.sensor)().at) {
                continue;
            }
            // Addresses of two bytes, sent to a chip of one, write: that is why `find` has its order.
            let (before, mut fake) = ((case.sensor)(), (case.sensor)());
            let writes = !before.wiring.wide_address && matches!(chip, Chip::Ov3660 | Chip::Ov5640);
            if writes {
                continue;
            }
            let result = Sensor::new(&mut fake, chip, case.clock_hz);
            assert!(result.is_err(), "{} as {}", case.name, chip.name());
            assert!(fake.registers == before.registers && fake.page() == before.page(), "{}", case.name);
        }
    }
}

#[test]
fn reading_a_mode_changes_nothing_in_the_chip() {
    for case in CASES {
        let (before, mut fake) = ((case.sensor)(), (case.sensor)());
        Sensor::new(&mut fake, case.chip, case.clock_hz).and_then(|mut sensor| sensor.mode()).expect(case.name);
        assert!(fake.registers == before.registers && fake.page() == before.page(), "{}", case.name);
    }
}

#[test]
fn another_chip_is_named_by_what_it_says() {
    let mut fake = FakeSensor::new(0x21, SCCB, &[(0x0a, 0x77), (0x1c, 0x7f), (0x1d, 0xa2)]);
    let error = Sensor::new(&mut fake, Chip::Ov7670, 24_000_000).expect_err("an OV7725");
    let SensorError::WrongChip { register, value, expected } = error else { panic!("{error}") };
    assert_eq!((register.name, value, expected), ("PID", 0x77, 0x76));
    assert_eq!(error.to_string(), "another chip: PID at 0x0a is 0x77, but would be 0x76");
}

#[test]
fn nobody_on_the_bus() {
    let mut fake = FakeSensor::new(0x77, SCCB, &[]);
    assert_eq!(Sensor::find(&mut fake, 24_000_000).expect_err("nobody"), SensorError::NotFound);
    let error = Sensor::new(&mut fake, Chip::Hm0360, 24_000_000).expect_err("nobody");
    assert_eq!(error, SensorError::Bus(Fault::Absent));
    assert_eq!(fake.log, []);
}

/// The sensor of a case with other registers, as (page, address, value).
fn refusal(name: &str, registers: &[(u16, u16, u16)]) -> (&'static str, u32) {
    let case = CASES.iter().find(|case| case.name.starts_with(name)).unwrap_or_else(|| panic!("no {name}"));
    let mut fake = (case.sensor)();
    for &(page, address, value) in registers {
        fake = fake.with_page(page, &[(address, value)]);
    }
    let mut sensor = Sensor::new(&mut fake, case.chip, case.clock_hz).expect(name);
    match sensor.mode() {
        Err(SensorError::Register { register, value, .. }) => (register.name, value),
        other => panic!("{name}: {other:?}"),
    }
}

#[test]
fn impossible_values_are_refused_by_register_and_value() {
    assert_eq!(refusal("OV7670, VGA", &[(0, 0x1a, 0x01), (0, 0x03, 0x00)]), ("VSTOP", 4));
    assert_eq!(refusal("OV7670, VGA", &[(0, 0x12, 0x30)]), ("COM7", 0x30));
    assert_eq!(refusal("OV7670, VGA", &[(0, 0x0c, 0x08), (0, 0x71, 0x80)]), ("SCALING_YSC[6:0]", 0));
    assert_eq!(refusal("OV7725, VGA", &[(0, 0x2c, 0x00)]), ("VOUTSIZE, EXHCH[2]", 0));
    assert_eq!(refusal("OV2640, CIF", &[(1, 0x12, 0x60)]), ("COM7[6:4]", 6));
    assert_eq!(refusal("OV2640, CIF", &[(0, 0x5b, 0x00)]), ("OUTH", 0));
    assert_eq!(refusal("OV3660, QXGA", &[(0, 0x303b, 0x20)]), ("SC_PLLS_CTRL1[4:0]", 0));
    assert_eq!(refusal("OV3660, QXGA", &[(0, 0x3815, 0x21)]), ("Y_INC", 0x21));
    assert_eq!(refusal("OV3660, QXGA", &[(0, 0x3806, 0x00), (0, 0x3803, 0x0c)]), ("Y_ADDR_END", 0x0b));
    assert_eq!(refusal("OV3660, VGA", &[(0, 0x3812, 0x07)]), ("Y_OFFSET", 0x702));
    assert_eq!(refusal("OV5640, VGA", &[(0, 0x3036, 0x03)]), ("SC_PLL_CTRL2", 3));
    assert_eq!(refusal("OV5640, VGA", &[(0, 0x3035, 0x01)]), ("SC_PLL_CTRL1[7:4]", 0));
    assert_eq!(refusal("OV5640, VGA", &[(0, 0x3034, 0x1c)]), ("SC_PLL_CTRL0[3:0]", 0xc));
    assert_eq!(refusal("OV5640, VGA", &[(0, 0x3037, 0x09)]), ("SC_PLL_CTRL3[3:0]", 9));
    assert_eq!(refusal("OV5640, VGA", &[(0, 0x380c, 0), (0, 0x380d, 0)]), ("X_TOTAL_SIZE (HTS)", 0));
    assert_eq!(refusal("HM01B0, QVGA", &[(0, 0x0387, 0x02)]), ("READOUT_Y", 2));
    assert_eq!(refusal("HM0360, VGA", &[(0, 0x3024, 0x09)]), ("PMU_CFG_3[0]", 1));
    assert_eq!(refusal("HM0360, VGA", &[(0, 0x0381, 0x03)]), ("V_SUBSAMPLE", 3));
    assert_eq!(refusal("GC0308, VGA", &[(1, 0x54, 0x01)]), ("SUBSAMPLE[7:4]", 0));
    assert_eq!(refusal("GC2145, UXGA", &[(0, 0x0d, 0), (0, 0x0e, 0)]), ("WIN_HEIGHT", 0));
    assert_eq!(refusal("MT9M114, VGA", &[(0, 0xc804, 0x0004)]), ("CAM_SENSOR_CFG_Y_ADDR_END", 4));
    assert_eq!(refusal("MT9M114, VGA", &[(0, 0x300c, 0)]), ("LINE_LENGTH_PCK", 0));
}

#[test]
fn a_clock_that_no_board_has_is_refused() {
    for case in CASES {
        for clock_hz in [0, 24, u32::MAX] {
            let mut fake = (case.sensor)();
            let mut sensor = Sensor::new(&mut fake, case.chip, clock_hz).expect(case.name);
            let error = sensor.mode().expect_err("no such clock");
            let SensorError::Parameter(error) = error else { panic!("{error}") };
            assert_eq!((error.parameter, error.value), ("clock_hz", f64::from(clock_hz)), "{}", case.name);
        }
    }
}

/// What the sources leave open: the sensor of a case with other registers.
fn sigma_ppm(name: &str, registers: &[(u16, u16, u16)]) -> u32 {
    let case = CASES.iter().find(|case| case.name.starts_with(name)).unwrap_or_else(|| panic!("no {name}"));
    let mut fake = (case.sensor)();
    for &(page, address, value) in registers {
        fake = fake.with_page(page, &[(address, value)]);
    }
    Sensor::new(&mut fake, case.chip, case.clock_hz).and_then(|mut sensor| sensor.mode()).expect(name).sigma_ppm
}

#[test]
fn what_sources_leave_open_widens_sigma() {
    let disputed = Evidence::Disputed.sigma_ppm();
    let described = Evidence::Described.sigma_ppm();
    // A divider without the bit that everyone agrees on; raw Bayer; downsampling that follows the pixel clock.
    assert_eq!(sigma_ppm("OV7670, VGA", &[(0, 0x11, 0x01)]), disputed);
    assert_eq!(sigma_ppm("OV7670, VGA", &[(0, 0x12, 0x01)]), disputed);
    assert_eq!(sigma_ppm("OV7670, VGA", &[(0, 0x0c, 0x04), (0, 0x3e, 0x11)]), described);
    assert_eq!(sigma_ppm("OV7725, VGA", &[(0, 0x12, 0x03)]), described);
    assert_eq!(sigma_ppm("OV2640, CIF", &[(1, 0x11, 0x80)]), disputed);
    assert_eq!(sigma_ppm("OV2640, CIF", &[(1, 0x2b, 0x10)]), described);
    assert_eq!(sigma_ppm("OV3660, QXGA", &[(0, 0x303a, 0x80)]), described);
    assert_eq!(sigma_ppm("OV5640, VGA", &[(0, 0x3039, 0x80)]), disputed);
    assert_eq!(sigma_ppm("HM01B0, QVGA", &[(0, 0x3067, 0x01)]), described);
    assert_eq!(sigma_ppm("GC2145, UXGA", &[(0, 0xfa, 0x11)]), described);
    assert_eq!(sigma_ppm("MT9M114, 1280", &[(0, 0xc808, 0x02ae)]), described);
}

fn sensor_of(name: &str) -> (FakeSensor, Chip, u32) {
    let case = CASES.iter().find(|case| case.name.starts_with(name)).unwrap_or_else(|| panic!("no {name}"));
    ((case.sensor)(), case.chip, case.clock_hz)
}

#[test]
fn an_exposure_is_set_by_hand_and_read_back_and_nothing_else_changes() {
    for case in CASES {
        let mut fake = (case.sensor)();
        let mut sensor = Sensor::new(&mut fake, case.chip, case.clock_hz).expect(case.name);
        let before = sensor.mode().expect(case.name);
        sensor.set_exposure_lines(101).expect(case.name);
        let after = sensor.mode().expect(case.name);
        assert_eq!(after.exposure_sixteenths, 16 * 101, "{}", case.name);
        let mut expected = before;
        (expected.exposure_sixteenths, expected.automatic_exposure) = (16 * 101, false);
        assert_eq!(after, expected, "{}", case.name);
        assert_eq!(sensor.release().page(), (case.sensor)().page(), "{}", case.name);
    }
}

#[test]
fn a_frame_length_is_set_and_read_back_and_nothing_else_changes() {
    for case in CASES {
        let mut fake = (case.sensor)();
        let mut sensor = Sensor::new(&mut fake, case.chip, case.clock_hz).expect(case.name);
        let before = sensor.mode().expect(case.name);
        let lines = before.frame_lines + 300;
        sensor.set_frame_lines(lines).expect(case.name);
        let mut expected = before;
        expected.frame_lines = lines;
        assert_eq!(sensor.mode().expect(case.name), expected, "{}", case.name);
    }
}

/// OpenMV reads 324 rows with 265 lines in a frame: the chip makes them more, and a new length is that length.
#[test]
fn a_frame_that_was_set_too_short_is_as_long_as_its_rows() {
    let (fake, chip, clock_hz) = sensor_of("HM01B0, QVGA");
    let mut fake = fake.with(&[(0x3010, 0x00), (0x0340, 0x01), (0x0341, 0x09)]);
    let mut sensor = Sensor::new(&mut fake, chip, clock_hz).expect("an HM01B0");
    assert_eq!(sensor.mode().expect("sound").frame_lines, 324);
    sensor.set_frame_lines(400).expect("long enough");
    assert_eq!(sensor.mode().expect("sound").frame_lines, 400);
}

#[test]
fn bits_beside_a_setting_stay_as_they_are() {
    let (mut fake, chip, clock_hz) = sensor_of("OV2640, UXGA");
    let mut sensor = Sensor::new(&mut fake, chip, clock_hz).expect("an OV2640");
    sensor.set_exposure_lines(0x0402).expect("fits");
    // REG04 keeps its flip, and [5:2]; COM8 all but its lowest bit.
    assert_eq!((fake.value(1, 0x04), fake.value(1, 0x10), fake.value(1, 0x45)), (0x6a, 0x00, 0x01));
    assert_eq!(fake.value(1, 0x13), 0xe4);
}

#[test]
fn himax_chips_are_told_to_take_new_values_last() {
    for name in ["HM01B0, QVGA", "HM0360, VGA"] {
        let (mut fake, chip, clock_hz) = sensor_of(name);
        Sensor::new(&mut fake, chip, clock_hz).and_then(|mut sensor| sensor.set_exposure_lines(9)).expect(name);
        assert_eq!(fake.log.last(), Some(&Step::Write(vec![0x01, 0x04, 0x01])), "{name}");
    }
}

#[test]
fn settings_that_do_not_fit_are_refused_before_anything_is_written() {
    let refused = |result: Outcome<()>| match result {
        Err(SensorError::Parameter(ParameterError { parameter, value, .. })) => (parameter, value),
        other => panic!("{other:?}"),
    };
    for case in CASES {
        let (before, mut fake) = ((case.sensor)(), (case.sensor)());
        let mut sensor = Sensor::new(&mut fake, case.chip, case.clock_hz).expect(case.name);
        let mode = sensor.mode().expect(case.name);
        let longest = u16::try_from(mode.frame_lines).expect("a short frame");
        for lines in [0, longest, u16::MAX] {
            assert_eq!(refused(sensor.set_exposure_lines(lines)), ("lines", f64::from(lines)), "{}", case.name);
        }
        for lines in [0, mode.lines.into(), u32::MAX] {
            assert_eq!(refused(sensor.set_frame_lines(lines)), ("lines", f64::from(lines)), "{}", case.name);
        }
        let fake = sensor.release();
        assert!(fake.registers == before.registers && fake.page() == before.page(), "{}", case.name);
    }
}

#[test]
fn the_bus_comes_back() {
    let (mut fake, chip, clock_hz) = sensor_of("HM01B0, QVGA");
    let bus = Sensor::new(&mut fake, chip, clock_hz).expect("there").release();
    assert_eq!(bus.steps, 2);
}

proptest! {
    #![proptest_config(seeded(512))]

    /// Whatever the registers hold: a mode with sound numbers, or an error that names one of the chip's registers.
    #[test]
    fn any_registers_at_all(index in 0..CASES.len(), seed: u64, kept in 0..64_usize) {
        let case = &CASES[index];
        // The identity, and some of the driver's values, so that not always the first register is wrong.
        let whole = (case.sensor)();
        let mut fake = FakeSensor::new(whole.at, whole.wiring, &[]).with_noise(seed);
        let identity = if case.chip == Chip::Ov2640 { 1 } else { 0 };
        for (place, (&(page, address), &value)) in whole.registers.iter().enumerate() {
            let at_identity = matches!(address, 0x00..=0x01 | 0x0a..=0x0b | 0x1c..=0x1d | 0xf0..=0xf1 | 0x300a..=0x300b);
            let is_identity = page == identity && at_identity;
            if is_identity || (seed >> (place % 64)) & 1 == 0 || place < kept {
                fake = fake.with_page(page, &[(address, value)]);
            }
        }
        let mut sensor = Sensor::new(&mut fake, case.chip, case.clock_hz).expect(case.name);
        match sensor.mode() {
            Ok(mode) => {
                prop_assert!(mode.rows() > 0 && mode.columns > 0 && mode.lines > 0, "{mode:?}");
                prop_assert!(mode.sensor_line_time_ps > 0 && mode.sigma_ppm >= 1_000, "{mode:?}");
                let _ = sensor.set_exposure_lines(seed as u16);
                let _ = sensor.set_frame_lines(seed as u32);
            }
            Err(SensorError::Register { register, .. }) => {
                prop_assert!(case.chip.registers().any(|known| known == register), "{}", register.name);
            }
            Err(SensorError::Parameter(error)) => prop_assert_eq!(error.parameter, "line_time_ps"),
            Err(other) => prop_assert!(false, "{other}"),
        }
    }
}
