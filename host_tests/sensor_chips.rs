//! Registers as the drivers of each chip write them, and the timing that follows.

use shutter_range::sensor::{Chip, Mode, Sensor};

use crate::sensor_bus::FakeSensor;
use crate::sensor_images::{
    gc0308, gc0308_two_thirds, gc2145, gc2145_vga, hm01b0, hm01b0_qqvga, hm0360, hm0360_qvga, mt9m114, mt9m114_vga,
    ov2640, ov2640_uxga, ov3660, ov3660_vga, ov5640, ov5640_vga, ov7670, ov7670_qvga, ov7725, ov7725_qvga,
};

/// A chip as a driver leaves it, and the timing of that mode by its sources.
pub(crate) struct Case {
    pub(crate) name: &'static str,
    pub(crate) chip: Chip,
    pub(crate) clock_hz: u32,
    pub(crate) sensor: fn() -> FakeSensor,
    /// Line time of the sensor in µs, of a row of the image in µs, frames a second.
    timing: [f64; 3],
    size: [u16; 2],
    exposure_us: f64,
    sigma_ppm: u32,
}

pub(crate) const CASES: &[Case] = &[
    Case {
        name: "OV7670, VGA, 24 MHz",
        chip: Chip::Ov7670,
        clock_hz: 24_000_000,
        sensor: ov7670,
        timing: [65.333, 65.333, 30.01],
        size: [640, 480],
        // AECH 0x3e and COM1 2: 250 lines.
        exposure_us: 250.0 * 65.333_333,
        sigma_ppm: 1_000,
    },
    Case {
        name: "OV7670, QVGA with dummy pixels and lines, 12 MHz x 4 / 2",
        chip: Chip::Ov7670,
        clock_hz: 12_000_000,
        sensor: ov7670_qvga,
        // 784 + 256 pixel periods of two clocks; 510 + 2 + 256 lines.
        timing: [86.667, 173.333, 15.024],
        size: [320, 240],
        exposure_us: 250.0 * 86.666_667,
        sigma_ppm: 1_000,
    },
    Case {
        name: "OV7725, VGA, 12 MHz x 4",
        chip: Chip::Ov7725,
        clock_hz: 12_000_000,
        sensor: ov7725,
        timing: [32.667, 32.667, 60.02],
        size: [640, 480],
        exposure_us: 300.0 * 32.666_667,
        sigma_ppm: 1_000,
    },
    Case {
        name: "OV7725, QVGA, 12 MHz x 4",
        chip: Chip::Ov7725,
        clock_hz: 12_000_000,
        sensor: ov7725_qvga,
        timing: [24.0, 24.0, 149.88],
        size: [320, 240],
        exposure_us: 300.0 * 24.0,
        sigma_ppm: 1_000,
    },
    Case {
        name: "OV2640, CIF, 24 MHz",
        chip: Chip::Ov2640,
        clock_hz: 24_000_000,
        sensor: ov2640,
        timing: [49.583, 49.583, 60.02],
        size: [400, 296],
        exposure_us: 204.0 * 49.583_333,
        sigma_ppm: 1_000,
    },
    Case {
        name: "OV2640, UXGA to 1280 x 960, 20 MHz",
        chip: Chip::Ov2640,
        clock_hz: 20_000_000,
        sensor: ov2640_uxga,
        timing: [64.067, 80.083, 12.507],
        size: [1280, 960],
        exposure_us: 1231.0 * 64.066_667,
        sigma_ppm: 1_000,
    },
    Case {
        name: "OV3660, QXGA, 20 MHz",
        chip: Chip::Ov3660,
        clock_hz: 20_000_000,
        sensor: ov3660,
        timing: [57.5, 57.5, 11.12],
        size: [2048, 1536],
        // 256.5 lines.
        exposure_us: 256.5 * 57.5,
        sigma_ppm: 1_000,
    },
    Case {
        name: "OV3660, VGA in RGB, 16 MHz",
        chip: Chip::Ov3660,
        clock_hz: 16_000_000,
        sensor: ov3660_vga,
        timing: [287.5, 461.198, 4.442],
        size: [640, 480],
        exposure_us: 256.5 * 287.5,
        sigma_ppm: 1_000,
    },
    Case {
        name: "OV5640, 1080p, 24 MHz",
        chip: Chip::Ov5640,
        clock_hz: 24_000_000,
        sensor: ov5640,
        timing: [29.762, 29.762, 30.0],
        size: [1920, 1080],
        exposure_us: 1008.0 * 29.761_905,
        sigma_ppm: 1_000,
    },
    Case {
        name: "OV5640, VGA, 20 MHz",
        chip: Chip::Ov5640,
        clock_hz: 20_000_000,
        sensor: ov5640_vga,
        timing: [45.778, 91.556, 22.2],
        size: [640, 480],
        exposure_us: 1008.0 * 45.777_778,
        sigma_ppm: 1_000,
    },
    Case {
        name: "HM01B0, QVGA, 12 MHz / 2",
        chip: Chip::Hm01b0,
        clock_hz: 12_000_000,
        sensor: hm01b0,
        timing: [62.667, 62.667, 59.99],
        size: [324, 244],
        exposure_us: 264.0 * 62.666_667,
        sigma_ppm: 1_000,
    },
    Case {
        name: "HM01B0, QQVGA, 6 MHz",
        chip: Chip::Hm01b0,
        clock_hz: 6_000_000,
        sensor: hm01b0_qqvga,
        timing: [62.667, 62.667, 120.89],
        size: [162, 122],
        exposure_us: 32.0 * 62.666_667,
        sigma_ppm: 1_000,
    },
    Case {
        name: "HM0360, VGA, 24 MHz",
        chip: Chip::Hm0360,
        clock_hz: 24_000_000,
        sensor: hm0360,
        timing: [32.0, 32.0, 58.74],
        size: [640, 480],
        exposure_us: 264.0 * 32.0,
        sigma_ppm: 50_000,
    },
    Case {
        name: "HM0360, QVGA, 24 MHz / 2",
        chip: Chip::Hm0360,
        clock_hz: 24_000_000,
        sensor: hm0360_qvga,
        timing: [31.333, 31.333, 120.43],
        size: [320, 240],
        exposure_us: 264.0 * 31.333_333,
        sigma_ppm: 50_000,
    },
    Case {
        name: "GC0308, VGA, 24 MHz",
        chip: Chip::Gc0308,
        clock_hz: 24_000_000,
        sensor: gc0308,
        timing: [66.333, 66.333, 28.77],
        size: [640, 480],
        exposure_us: 600.0 * 66.333_333,
        sigma_ppm: 50_000,
    },
    Case {
        name: "GC0308, two rows of three, 24 MHz / 2",
        chip: Chip::Gc0308,
        clock_hz: 24_000_000,
        sensor: gc0308_two_thirds,
        timing: [132.667, 199.0, 14.385],
        size: [426, 320],
        exposure_us: 600.0 * 132.666_667,
        sigma_ppm: 50_000,
    },
    Case {
        name: "GC2145, UXGA, 24 MHz",
        chip: Chip::Gc2145,
        clock_hz: 24_000_000,
        sensor: gc2145,
        timing: [40.033, 40.033, 20.02],
        size: [1600, 1200],
        exposure_us: 1250.0 * 40.033_333,
        sigma_ppm: 1_000,
    },
    Case {
        name: "GC2145, VGA of two rows in five, 24 MHz",
        chip: Chip::Gc2145,
        clock_hz: 24_000_000,
        sensor: gc2145_vga,
        timing: [27.690, 69.226, 29.03],
        size: [640, 480],
        exposure_us: 1250.0 * 27.690_476,
        sigma_ppm: 50_000,
    },
    Case {
        name: "MT9M114, 1280 x 960, 24 MHz",
        chip: Chip::Mt9m114,
        clock_hz: 24_000_000,
        sensor: mt9m114,
        timing: [33.417, 33.417, 30.02],
        size: [1280, 960],
        exposure_us: 400.0 * 33.416_667,
        sigma_ppm: 1_000,
    },
    Case {
        name: "MT9M114, VGA binned by two, 24 MHz",
        chip: Chip::Mt9m114,
        clock_hz: 24_000_000,
        sensor: mt9m114_vga,
        timing: [24.625, 24.625, 76.91],
        size: [640, 480],
        exposure_us: 400.0 * 24.625,
        sigma_ppm: 1_000,
    },
];

impl Case {
    pub(crate) fn mode(&self) -> Mode {
        let mut fake = (self.sensor)();
        let mut sensor = Sensor::new(&mut fake, self.chip, self.clock_hz).unwrap_or_else(|error| panic!("{error}"));
        sensor.mode().unwrap_or_else(|error| panic!("{}: {error}", self.name))
    }
}

fn assert_near(got: f64, expected: f64, what: &str) {
    assert!((got / expected - 1.0).abs() < 1e-4, "{what}: {got}, but {expected} is right");
}

#[test]
fn each_chip_says_the_timing_of_its_modes() {
    for case in CASES {
        let mode = case.mode();
        let [line_us, row_us, rate_hz] = case.timing;
        assert_near(mode.sensor_line_time_ps as f64 * 1e-6, line_us, case.name);
        assert_near(mode.readout.line_time_ps() as f64 * 1e-6, row_us, case.name);
        assert!((1e9 / mode.frame_time_ns() as f64 / rate_hz - 1.0).abs() < 1e-3, "{}: {mode:?}", case.name);
        assert_near(mode.exposure_ns() as f64 * 1e-3, case.exposure_us, case.name);
        assert_near(mode.exposure_s::<f64>(), case.exposure_us * 1e-6, case.name);
        assert_eq!([mode.columns, mode.rows()], case.size, "{}", case.name);
        assert_eq!(mode.sigma_ppm, case.sigma_ppm, "{}", case.name);
        assert!((mode.sigma::<f64>() - f64::from(case.sigma_ppm) * 1e-6).abs() < 1e-12);
    }
}

#[test]
fn every_chip_has_two_modes_here() {
    for chip in Chip::ALL {
        assert_eq!(CASES.iter().filter(|case| case.chip == chip).count(), 2, "{}", chip.name());
    }
}

#[test]
fn flips_and_automatic_exposure_are_told_and_leave_the_readout_alone() {
    let told = |name: &str| {
        let case = CASES.iter().find(|case| case.name.starts_with(name)).unwrap_or_else(|| panic!("no {name}"));
        let mode = case.mode();
        assert_eq!(mode.readout.direction(), shutter_range::ReadoutDirection::TopToBottom);
        (mode.mirrored, mode.flipped, mode.automatic_exposure)
    };
    assert_eq!(told("OV7670, VGA"), (false, false, true));
    assert_eq!(told("OV7670, QVGA"), (true, true, false));
    assert_eq!(told("OV7725, VGA"), (false, false, true));
    assert_eq!(told("OV7725, QVGA"), (true, true, true));
    assert_eq!(told("OV2640, CIF"), (false, false, true));
    assert_eq!(told("OV2640, UXGA"), (false, true, false));
    assert_eq!(told("OV3660, QXGA"), (false, false, false));
    assert_eq!(told("OV3660, VGA"), (true, true, true));
    assert_eq!(told("OV5640, 1080p"), (true, false, true));
    assert_eq!(told("OV5640, VGA"), (false, false, true));
    assert_eq!(told("HM01B0, QVGA"), (false, false, true));
    assert_eq!(told("HM01B0, QQVGA"), (true, true, false));
    assert_eq!(told("HM0360, VGA"), (false, false, true));
    assert_eq!(told("GC0308, VGA"), (false, false, true));
    assert_eq!(told("GC0308, two"), (true, true, true));
    assert_eq!(told("GC2145, UXGA"), (false, false, true));
    assert_eq!(told("MT9M114, VGA"), (true, true, true));
}

#[test]
fn the_window_says_which_pixels_the_image_shows() {
    let window = |name: &str| {
        let case = CASES.iter().find(|case| case.name.starts_with(name)).unwrap_or_else(|| panic!("no {name}"));
        let mode = case.mode();
        let window = mode.window;
        ([window.first_column, window.first_row, window.columns, window.rows], mode.lines)
    };
    assert_eq!(window("OV7670, VGA"), ([158, 10, 640, 480], 480));
    assert_eq!(window("OV7725, QVGA"), ([252, 6, 640, 480], 240));
    assert_eq!(window("OV2640, CIF"), ([0, 0, 1600, 1184], 296));
    assert_eq!(window("OV3660, VGA"), ([16, 4, 2048, 1540], 770));
    assert_eq!(window("OV5640, 1080p"), ([352, 438, 1920, 1080], 1080));
    assert_eq!(window("OV5640, VGA"), ([32, 16, 2560, 1920], 960));
    assert_eq!(window("HM01B0, QVGA"), ([0, 40, 324, 244], 244));
    assert_eq!(window("HM0360, QVGA"), ([8, 8, 640, 480], 240));
    assert_eq!(window("GC0308, two"), ([0, 0, 639, 480], 480));
    assert_eq!(window("GC2145, VGA"), ([0, 0, 1600, 1200], 1200));
    assert_eq!(window("MT9M114, VGA"), ([4, 4, 1280, 960], 480));
}
