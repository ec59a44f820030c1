//! Registers as the drivers of each chip write them, and the timing that follows.

use shutter_range::sensor::{Chip, Mode, Sensor};

use crate::sensor_bus::{FakeSensor, I2C_WIDE, I2C_WORDS, SCCB, SCCB_WIDE, paged};

/// A chip as a driver leaves it, and what `sensors` tables say of that mode.
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

const OV7670: &[(u16, u16)] = &[
    (0x0a, 0x76),
    (0x0b, 0x73),
    (0x1c, 0x7f),
    (0x1d, 0xa2),
    // Linux and OpenMV: VGA, window 158 to 14 and 10 to 490, banding filter, automatic exposure.
    (0x11, 0x80),
    (0x6b, 0x0a),
    (0x12, 0x00),
    (0x17, 0x13),
    (0x18, 0x01),
    (0x32, 0xb6),
    (0x19, 0x02),
    (0x1a, 0x7a),
    (0x03, 0x0a),
    (0x0c, 0x00),
    (0x3e, 0x00),
    (0x70, 0x3a),
    (0x71, 0x35),
    (0x72, 0x11),
    (0x73, 0xf0),
    (0x04, 0x42),
    (0x07, 0x80),
    (0x10, 0x3e),
    (0x13, 0xe7),
    (0x1e, 0x07),
];

fn ov7670() -> FakeSensor {
    FakeSensor::new(0x21, SCCB, OV7670)
}

/// QVGA of esp32-camera: PLL, no divider, downsampling by hand, dummy pixels and lines, mirrored.
fn ov7670_qvga() -> FakeSensor {
    let qvga = [(0x11, 0x00), (0x6b, 0x4a), (0x0c, 0x04), (0x3e, 0x19), (0x72, 0x11), (0x73, 0xf1), (0x1e, 0x37)];
    ov7670().with(&qvga).with(&[(0x2a, 0x10), (0x2b, 0x00), (0x2d, 0x02), (0x93, 0x01), (0x13, 0xe6)])
}

const OV7725: &[(u16, u16)] = &[
    (0x0a, 0x77),
    (0x0b, 0x21),
    (0x1c, 0x7f),
    (0x1d, 0xa2),
    // OpenMV: VGA.
    (0x0c, 0x00),
    (0x0d, 0x41),
    (0x11, 0xc0),
    (0x12, 0x06),
    (0x13, 0xff),
    (0x17, 0x22),
    (0x18, 0xa4),
    (0x19, 0x07),
    (0x1a, 0xf0),
    (0x32, 0x00),
    (0x29, 0xa0),
    (0x2c, 0xf0),
    (0x2a, 0x00),
    (0x2b, 0x00),
    (0x08, 0x01),
    (0x10, 0x2c),
];

fn ov7725() -> FakeSensor {
    FakeSensor::new(0x21, SCCB, OV7725)
}

fn ov7725_qvga() -> FakeSensor {
    let qvga = [(0x12, 0x46), (0x17, 0x3f), (0x18, 0x50), (0x19, 0x03), (0x1a, 0x78), (0x29, 0x50), (0x2c, 0x78)];
    ov7725().with(&qvga).with(&[(0x0c, 0xd0)])
}

/// esp32-camera: CIF.
fn ov2640() -> FakeSensor {
    let dsp = [
        (0x05, 0x00),
        (0x50, 0x80),
        (0x51, 0x64),
        (0x52, 0x4a),
        (0x53, 0x00),
        (0x54, 0x00),
        (0x55, 0x00),
        (0x57, 0x00),
        (0x5a, 0x64),
        (0x5b, 0x4a),
        (0x5c, 0x00),
        (0xc0, 0x32),
        (0xc1, 0x25),
        (0x8c, 0x00),
        (0xd3, 0x08),
    ];
    let sensor = [
        (0x0a, 0x26),
        (0x0b, 0x42),
        (0x1c, 0x7f),
        (0x1d, 0xa2),
        (0x11, 0x00),
        (0x12, 0x20),
        (0x13, 0xe5),
        (0x04, 0x28),
        (0x10, 0x33),
        (0x45, 0x00),
        (0x46, 0x00),
        (0x47, 0x00),
    ];
    FakeSensor::new(0x30, paged(0xff), &dsp).with_page(1, &sensor)
}

/// UXGA, scaled to 1280 × 960, exposure of 3 + 4 · 51 + 1024 lines by hand, upside down.
fn ov2640_uxga() -> FakeSensor {
    let dsp = [(0x51, 0x90), (0x52, 0x2c), (0x55, 0x88), (0x5a, 0x40), (0x5b, 0xf0), (0x5c, 0x01)];
    ov2640().with(&dsp).with_page(1, &[(0x12, 0x00), (0x13, 0xe4), (0x04, 0x6b), (0x45, 0x01)])
}

const OV3660: &[(u16, u16)] = &[
    (0x300a, 0x36),
    (0x300b, 0x60),
    // esp32-camera: QXGA, JPEG.
    (0x303a, 0x00),
    (0x303b, 0x18),
    (0x303c, 0x11),
    (0x303d, 0x30),
    (0x3800, 0x00),
    (0x3801, 0x00),
    (0x3804, 0x08),
    (0x3805, 0x1f),
    (0x3806, 0x06),
    (0x3807, 0x0b),
    (0x3808, 0x08),
    (0x3809, 0x00),
    (0x380a, 0x06),
    (0x380b, 0x00),
    (0x380c, 0x08),
    (0x380d, 0xfc),
    (0x380e, 0x06),
    (0x380f, 0x1c),
    (0x3811, 0x10),
    (0x3813, 0x06),
    (0x3814, 0x11),
    (0x3815, 0x11),
    (0x3820, 0x40),
    (0x3821, 0x20),
    (0x5001, 0x83),
    (0x3500, 0x00),
    (0x3501, 0x10),
    (0x3502, 0x08),
    (0x3503, 0x01),
];

fn ov3660() -> FakeSensor {
    FakeSensor::new(0x3c, SCCB_WIDE, OV3660)
}

/// VGA in RGB: binned and scaled, the slow clock, mirrored and upside down.
fn ov3660_vga() -> FakeSensor {
    ov3660().with(&[
        (0x303b, 0x04),
        (0x303d, 0x02),
        (0x3808, 0x02),
        (0x3809, 0x80),
        (0x380a, 0x01),
        (0x380b, 0xe0),
        (0x380e, 0x03),
        (0x380f, 0x0f),
        (0x3811, 0x08),
        (0x3813, 0x02),
        (0x3814, 0x31),
        (0x3815, 0x31),
        (0x3820, 0x07),
        (0x3821, 0x07),
        (0x5001, 0xa3),
        (0x3503, 0x00),
    ])
}

const OV5640: &[(u16, u16)] = &[
    (0x300a, 0x56),
    (0x300b, 0x40),
    // Linux: 1080p on the parallel port.
    (0x3034, 0x18),
    (0x3035, 0x11),
    (0x3036, 0x54),
    (0x3037, 0x03),
    (0x3039, 0x00),
    (0x3108, 0x16),
    (0x3800, 0x01),
    (0x3801, 0x50),
    (0x3802, 0x01),
    (0x3803, 0xb2),
    (0x3804, 0x08),
    (0x3805, 0xef),
    (0x3806, 0x05),
    (0x3807, 0xf1),
    (0x3808, 0x07),
    (0x3809, 0x80),
    (0x380a, 0x04),
    (0x380b, 0x38),
    (0x380c, 0x09),
    (0x380d, 0xc4),
    (0x380e, 0x04),
    (0x380f, 0x60),
    (0x3811, 0x10),
    (0x3813, 0x04),
    (0x3814, 0x11),
    (0x3815, 0x11),
    (0x3820, 0x40),
    (0x3821, 0x06),
    (0x5001, 0x83),
    (0x3500, 0x00),
    (0x3501, 0x3f),
    (0x3502, 0x00),
    (0x3503, 0x00),
];

fn ov5640() -> FakeSensor {
    FakeSensor::new(0x3c, SCCB_WIDE, OV5640)
}

/// esp32-camera: VGA, JPEG, 960 lines for 480 rows.
fn ov5640_vga() -> FakeSensor {
    ov5640().with(&[
        (0x3034, 0x1a),
        (0x3035, 0x41),
        (0x3036, 0xb4),
        (0x3037, 0x02),
        (0x3108, 0x26),
        (0x3800, 0x00),
        (0x3801, 0x00),
        (0x3802, 0x00),
        (0x3803, 0x00),
        (0x3804, 0x0a),
        (0x3805, 0x3f),
        (0x3806, 0x07),
        (0x3807, 0x9f),
        (0x3808, 0x02),
        (0x3809, 0x80),
        (0x380a, 0x01),
        (0x380b, 0xe0),
        (0x380c, 0x08),
        (0x380d, 0x0c),
        (0x380e, 0x03),
        (0x380f, 0xd8),
        (0x3813, 0x08),
        (0x3814, 0x31),
        (0x3815, 0x31),
        (0x3820, 0x01),
        (0x3821, 0x21),
        (0x5001, 0xa3),
    ])
}

const HM01B0: &[(u16, u16)] = &[
    (0x0000, 0x01),
    (0x0001, 0xb0),
    (0x0101, 0x00),
    (0x0202, 0x01),
    (0x0203, 0x08),
    (0x0340, 0x01),
    (0x0341, 0x0a),
    (0x0342, 0x01),
    (0x0343, 0x78),
    (0x0383, 0x01),
    (0x0387, 0x01),
    (0x0390, 0x00),
    (0x2100, 0x01),
    (0x3010, 0x01),
    (0x3060, 0x0a),
    (0x3067, 0x00),
];

fn hm01b0() -> FakeSensor {
    FakeSensor::new(0x24, I2C_WIDE, HM01B0)
}

/// OpenMV: QQVGA by binning, on the whole clock, turned by half a turn.
fn hm01b0_qqvga() -> FakeSensor {
    let binned = [(0x0340, 0x00), (0x0341, 0x84), (0x0383, 0x03), (0x0387, 0x03), (0x0390, 0x03), (0x3060, 0x0b)];
    hm01b0().with(&binned).with(&[(0x0101, 0x03), (0x2100, 0x00), (0x0202, 0x00), (0x0203, 0x20)])
}

const HM0360: &[(u16, u16)] = &[
    (0x0000, 0x03),
    (0x0001, 0x60),
    (0x0101, 0x00),
    (0x0202, 0x01),
    (0x0203, 0x08),
    (0x0300, 0x08),
    (0x0340, 0x02),
    (0x0341, 0x14),
    (0x0342, 0x03),
    (0x0343, 0x00),
    (0x0380, 0x00),
    (0x0381, 0x00),
    (0x2000, 0x5f),
    (0x3024, 0x08),
    (0x3030, 0x01),
];

fn hm0360() -> FakeSensor {
    FakeSensor::new(0x24, I2C_WIDE, HM0360)
}

/// QVGA, at the other address.
fn hm0360_qvga() -> FakeSensor {
    let qvga =
        [(0x0300, 0x09), (0x0340, 0x01), (0x0341, 0x09), (0x0342, 0x01), (0x0343, 0x78), (0x0380, 1), (0x0381, 1)];
    hm0360().with(&qvga).at(0x12)
}

const GC0308: &[(u16, u16)] = &[
    (0x00, 0x9b),
    // Linux: VGA.
    (0x01, 0x40),
    (0x02, 0x20),
    (0x03, 0x02),
    (0x04, 0x58),
    (0x09, 0x01),
    (0x0a, 0xe8),
    (0x0b, 0x02),
    (0x0c, 0x88),
    (0x0d, 0x02),
    (0x0e, 0x02),
    (0x0f, 0x00),
    (0x12, 0x50),
    (0x14, 0x10),
    (0x22, 0x57),
    (0x28, 0x00),
    (0x46, 0x80),
    (0x49, 0x01),
    (0x4a, 0xe0),
    (0x4b, 0x02),
    (0x4c, 0x80),
];

fn gc0308() -> FakeSensor {
    let page1 = [(0x54, 0x11), (0x55, 0x03), (0x56, 0x00), (0x57, 0x00), (0x58, 0x00), (0x59, 0x00)];
    FakeSensor::new(0x21, paged(0xfe), GC0308).with_page(1, &page1)
}

/// esp32-camera: two thirds of every row and column of a window, nothing cut, half the clock, left on page 1.
fn gc0308_two_thirds() -> FakeSensor {
    let page1 = [(0x54, 0x33), (0x55, 0x01), (0x56, 0x02), (0x57, 0x00), (0x58, 0x02), (0x59, 0x00)];
    gc0308().with(&[(0x46, 0x00), (0x28, 0x10), (0x14, 0x13)]).with_page(1, &page1).on_page(1)
}

const GC2145: &[(u16, u16)] = &[
    (0xf0, 0x21),
    (0xf1, 0x45),
    // Linux: UXGA.
    (0xf7, 0x1d),
    (0xf8, 0x84),
    (0xfa, 0x00),
    (0xfd, 0x00),
    (0x03, 0x04),
    (0x04, 0xe2),
    (0x05, 0x01),
    (0x06, 0x56),
    (0x07, 0x00),
    (0x08, 0x10),
    (0x0d, 0x04),
    (0x0e, 0xc0),
    (0x0f, 0x06),
    (0x10, 0x52),
    (0x11, 0x00),
    (0x12, 0x2e),
    (0x17, 0x14),
    (0x90, 0x01),
    (0x95, 0x04),
    (0x96, 0xb0),
    (0x97, 0x06),
    (0x98, 0x40),
    (0x99, 0x11),
    (0xb6, 0x01),
];

fn gc2145() -> FakeSensor {
    FakeSensor::new(0x3c, paged(0xfe), GC2145)
}

/// Linux: VGA, four of five after a half.
fn gc2145_vga() -> FakeSensor {
    gc2145().with(&[
        (0xf8, 0x86),
        (0xfd, 0x01),
        (0x05, 0x01),
        (0x06, 0x30),
        (0x08, 0x0c),
        (0x95, 0x01),
        (0x96, 0xe0),
        (0x97, 0x02),
        (0x98, 0x80),
        (0x99, 0x55),
        (0x9a, 0x06),
        (0x9b, 0x01),
        (0x9c, 0x23),
        (0x9f, 0x01),
        (0xa0, 0x23),
    ])
}

const MT9M114: &[(u16, u16)] = &[
    (0x0000, 0x2481),
    (0x300a, 997),
    (0x300c, 1604),
    (0x3012, 400),
    (0xa804, 0x00ff),
    (0xc800, 0x0004),
    (0xc802, 0x0004),
    (0xc804, 0x03cb),
    (0xc808, 0x02dc),
    (0xc80a, 0x6c00),
    (0xc834, 0x0000),
    (0xc858, 1280),
    (0xc85a, 960),
    (0xc868, 1280),
    (0xc86a, 960),
    (0xc980, 0x0120),
    (0xc982, 0x0700),
];

fn mt9m114() -> FakeSensor {
    FakeSensor::new(0x48, I2C_WORDS, MT9M114)
}

/// OpenMV: VGA, binned by two, mounted upside down.
fn mt9m114_vga() -> FakeSensor {
    mt9m114().with(&[
        (0x300a, 528),
        (0x300c, 1182),
        (0xc834, 0x0333),
        (0xc858, 640),
        (0xc85a, 480),
        (0xc868, 640),
        (0xc86a, 480),
    ])
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
