//! The table of modes that drivers set.

use super::chip::Chip;
use super::register::Register;
use super::typical::{Kind, TypicalMode};
use super::{gc0308, gc2145, hm01b0, hm0360, mt9m114, omnivision as ov, ov2640, ov3660, ov5640, ov7670, ov7725};

/// Modes that drivers set, with the registers that they set them by.
///
/// ```
/// use shutter_range::sensor::{Chip, typical_modes};
/// let modes = typical_modes().iter().filter(|mode| mode.chip == Chip::Ov2640);
/// for typical in modes {
///     let mode = typical.mode().expect("a sound table");
///     println!("{}: {} ps from row to row ({})", typical.name, mode.readout.line_time_ps(), typical.kind.name());
/// }
/// ```
#[must_use]
pub fn typical_modes() -> &'static [TypicalMode] {
    MODES
}

/// A line of the table.
macro_rules! mode {
    (
        $chip:ident, $name:literal, $mhz:literal, $kind:ident, $source:literal,
        $($module:ident { $($register:ident = $value:expr),+ $(,)? }),+
    ) => {
        TypicalMode {
            chip: Chip::$chip,
            name: $name,
            clock_hz: $mhz * 1_000_000,
            source: $source,
            kind: Kind::$kind,
            values: { static VALUES: &[(&Register, u32)] = &[$($((&$module::$register, $value)),+),+]; VALUES },
        }
    };
}

static MODES: &[TypicalMode] = &[
    mode!(Ov7670, "VGA YUV", 24, Computed, "data sheet: 30 frames/s at 24 MHz", ov7670 {
        CLOCK = 0x80, FIRST_COLUMN = 158, END_COLUMN = 14, FIRST_ROW = 10, END_ROW = 490,
    }),
    mode!(Ov7670, "VGA YUV, 10 MHz", 10, Documented, "the data sheet's 30 frames/s at 24 MHz, slowed down", ov7670 {
        CLOCK = 0x80, FIRST_COLUMN = 158, END_COLUMN = 14, FIRST_ROW = 10, END_ROW = 490,
    }),
    mode!(Ov7670, "QVGA YUV, 12 MHz x 4", 12, Computed, "esp32-camera: 30 frames/s", ov7670 {
        PLL = 1, FIRST_COLUMN = 158, END_COLUMN = 14, FIRST_ROW = 10, END_ROW = 490, SCALING = 1,
        PIXEL_CLOCK_DIVIDER = 9, DOWNSAMPLING = 1,
    }),
    mode!(Ov7725, "VGA YUV", 24, Computed, "application note: 30 frames/s at 24 MHz", ov7725 {
        CLOCK = 0x01, PLL = 1, COLUMNS = 656, ROWS = 480, OUTPUT_COLUMNS = 640, OUTPUT_ROWS = 480,
    }),
    mode!(Ov7725, "VGA, OpenMV H7", 12, Computed, "OpenMV: 60 frames/s", ov7725 {
        CLOCK = 0x40, PLL = 1, COLUMNS = 656, ROWS = 480, OUTPUT_COLUMNS = 640, OUTPUT_ROWS = 480,
    }),
    mode!(Ov7725, "QVGA, OpenMV H7", 12, Computed, "OpenMV: 150 frames/s", ov7725 {
        CLOCK = 0x40, PLL = 1, QVGA = 1, COLUMNS = 320, ROWS = 240, OUTPUT_COLUMNS = 320, OUTPUT_ROWS = 240,
    }),
    mode!(Ov2640, "UXGA", 20, Computed, "data sheet: 15 frames/s at 24 MHz", ov2640 {
        COLUMNS = 400, ROWS = 300, OUTPUT_COLUMNS = 400, OUTPUT_ROWS = 300,
    }),
    mode!(Ov2640, "SVGA", 20, Computed, "application note: 30 frames/s at 24 MHz", ov2640 {
        RESOLUTION = 4, COLUMNS = 200, ROWS = 150, OUTPUT_COLUMNS = 200, OUTPUT_ROWS = 150,
    }),
    mode!(Ov2640, "VGA JPEG, esp32-camera", 20, Computed, "SVGA, scaled to 480 rows", ov2640 {
        RESOLUTION = 4, COLUMNS = 200, ROWS = 150, OUTPUT_COLUMNS = 160, OUTPUT_ROWS = 120,
    }),
    mode!(Ov2640, "CIF JPEG, esp32-camera", 20, Measured, "esp32-camera issue 81: 50 frames/s, 60 at 24 MHz", ov2640 {
        RESOLUTION = 2, COLUMNS = 100, ROWS = 74, OUTPUT_COLUMNS = 100, OUTPUT_ROWS = 74,
    }),
    mode!(Ov3660, "QXGA JPEG, esp32-camera", 20, Computed, "esp32-camera: core clock of 40 MHz",
        ov3660 { MULTIPLIER = 24, SYSTEM_DIVIDER = 1, PRE_DIVIDER = 3 },
        ov {
            LAST_COLUMN = 2079, LAST_ROW = 1547, OUTPUT_COLUMNS = 2048, OUTPUT_ROWS = 1536, LINE_CLOCKS = 2300,
            FRAME_LINES = 1564, COLUMN_OFFSET = 16, ROW_OFFSET = 6, COLUMN_STEPS = 0x11, ROW_STEPS = 0x11,
        }
    ),
    mode!(Ov3660, "XGA JPEG, esp32-camera", 20, Computed, "esp32-camera: core clock of 50 MHz",
        ov3660 { MULTIPLIER = 30, SYSTEM_DIVIDER = 1, PRE_DIVIDER = 3 },
        ov {
            LAST_COLUMN = 2079, LAST_ROW = 1547, OUTPUT_COLUMNS = 1024, OUTPUT_ROWS = 768, LINE_CLOCKS = 2300,
            FRAME_LINES = 783, COLUMN_OFFSET = 8, ROW_OFFSET = 2, COLUMN_STEPS = 0x31, ROW_STEPS = 0x31,
        }
    ),
    mode!(Ov3660, "VGA RGB, esp32-camera", 16, Computed, "esp32-camera: 4.44 frames/s; scaled to 480 rows",
        ov3660 { MULTIPLIER = 4, SYSTEM_DIVIDER = 1, LAST_DIVIDER = 2 },
        ov {
            LAST_COLUMN = 2079, LAST_ROW = 1547, OUTPUT_COLUMNS = 640, OUTPUT_ROWS = 480, LINE_CLOCKS = 2300,
            FRAME_LINES = 783, COLUMN_OFFSET = 8, ROW_OFFSET = 2, COLUMN_STEPS = 0x31, ROW_STEPS = 0x31, SCALING = 1,
        }
    ),
    mode!(Ov5640, "5 MP", 24, Computed, "Linux: 15 frames/s at 84 MHz",
        ov5640 { BIT_MODE = 8, SYSTEM_DIVIDER = 1, MULTIPLIER = 84, PRE_DIVIDER = 3, CORE_DIVIDER = 2 },
        ov {
            LAST_COLUMN = 2623, LAST_ROW = 1951, OUTPUT_COLUMNS = 2592, OUTPUT_ROWS = 1944, LINE_CLOCKS = 2844,
            FRAME_LINES = 1968, COLUMN_OFFSET = 16, ROW_OFFSET = 4, COLUMN_STEPS = 0x11, ROW_STEPS = 0x11,
        }
    ),
    mode!(Ov5640, "1080p", 24, Computed, "Linux: 30 frames/s at 84 MHz",
        ov5640 { BIT_MODE = 8, SYSTEM_DIVIDER = 1, MULTIPLIER = 84, PRE_DIVIDER = 3, CORE_DIVIDER = 2 },
        ov {
            FIRST_COLUMN = 336, FIRST_ROW = 434, LAST_COLUMN = 2287, LAST_ROW = 1521, OUTPUT_COLUMNS = 1920,
            OUTPUT_ROWS = 1080, LINE_CLOCKS = 2500, FRAME_LINES = 1120, COLUMN_OFFSET = 16, ROW_OFFSET = 4,
            COLUMN_STEPS = 0x11, ROW_STEPS = 0x11,
        }
    ),
    mode!(Ov5640, "VGA JPEG, esp32-camera", 20, Documented, "esp32-camera: core clock of 45 MHz; scaled to 480 rows",
        ov5640 { BIT_MODE = 10, SYSTEM_DIVIDER = 4, MULTIPLIER = 180, PRE_DIVIDER = 2, CORE_DIVIDER = 2 },
        ov {
            LAST_COLUMN = 2623, LAST_ROW = 1951, OUTPUT_COLUMNS = 640, OUTPUT_ROWS = 480, LINE_CLOCKS = 2060,
            FRAME_LINES = 984, COLUMN_OFFSET = 16, ROW_OFFSET = 8, COLUMN_STEPS = 0x31, ROW_STEPS = 0x31, SCALING = 1,
        }
    ),
    mode!(Hm01b0, "QVGA", 12, Measured, "hm01b0-esp-idf-driver: 59.94 frames/s on hardware", hm01b0 {
        LINE_CLOCKS = 376, FRAME_LINES = 266, COLUMN_STEP = 1, ROW_STEP = 1, QVGA_WINDOW = 1, CLOCK = 2,
    }),
    mode!(Hm01b0, "QVGA, OpenMV", 6, Documented, "OpenMV: up to 60 frames/s", hm01b0 {
        LINE_CLOCKS = 376, FRAME_LINES = 260, COLUMN_STEP = 1, ROW_STEP = 1, QVGA_WINDOW = 1, CLOCK = 3,
    }),
    mode!(Hm01b0, "324 x 324", 6, Documented, "Zephyr: up to 45 frames/s", hm01b0 {
        LINE_CLOCKS = 376, FRAME_LINES = 344, COLUMN_STEP = 1, ROW_STEP = 1, CLOCK = 3,
    }),
    mode!(Hm01b0, "QQVGA, OpenMV", 6, Documented, "SparkFun: up to 120 frames/s", hm01b0 {
        LINE_CLOCKS = 376, FRAME_LINES = 132, COLUMN_STEP = 3, ROW_STEP = 3, QVGA_WINDOW = 1, CLOCK = 3,
    }),
    mode!(Hm0360, "VGA", 24, Documented, "Zephyr: settings for 60 frames/s", hm0360 {
        LINE_CLOCKS = 768, FRAME_LINES = 532, WINDOW = 1,
    }),
    mode!(Hm0360, "QVGA", 24, Documented, "OpenMV and Zephyr: core clock of 12 MHz", hm0360 {
        CLOCK = 1, LINE_CLOCKS = 376, FRAME_LINES = 265, COLUMN_SUBSAMPLING = 1, ROW_SUBSAMPLING = 1, WINDOW = 1,
    }),
    mode!(Gc0308, "VGA", 24, Documented, "Linux: settings and formula; at most 30 frames/s", gc0308 {
        COLUMN_BLANKING = 64, ROW_BLANKING = 32, ROWS = 488, COLUMNS = 648, ROWS_BEFORE = 2, ROWS_AFTER = 2,
        SAMPLE_HOLD = 80, CROP = 1, CROP_ROWS = 480, CROP_COLUMNS = 640, SUBSAMPLE_ROWS = 1, SUBSAMPLE_COLUMNS = 1,
    }),
    mode!(Gc0308, "QVGA", 24, Documented, "Linux: every second row", gc0308 {
        COLUMN_BLANKING = 64, ROW_BLANKING = 32, ROWS = 488, COLUMNS = 648, ROWS_BEFORE = 2, ROWS_AFTER = 2,
        SAMPLE_HOLD = 80, CROP = 1, CROP_ROWS = 240, CROP_COLUMNS = 320, SUBSAMPLE_ROWS = 2, SUBSAMPLE_COLUMNS = 2,
    }),
    mode!(Gc2145, "UXGA", 24, Computed, "Linux: 20 frames/s", gc2145 {
        MULTIPLIER = 4, COLUMN_BLANKING = 342, ROW_BLANKING = 16, ROWS = 1216, COLUMNS = 1618, SAMPLE_HOLD = 46,
        CROP = 1, CROP_ROWS = 1200, CROP_COLUMNS = 1600, SUBSAMPLE_ROWS = 1, SUBSAMPLE_COLUMNS = 1,
    }),
    mode!(Gc2145, "720p", 24, Computed, "Linux: 30 frames/s", gc2145 {
        MULTIPLIER = 3, COLUMN_BLANKING = 342, ROW_BLANKING = 17, FIRST_ROW = 240, FIRST_COLUMN = 160, ROWS = 736,
        COLUMNS = 1296, SAMPLE_HOLD = 46, CROP = 1, CROP_ROWS = 720, CROP_COLUMNS = 1280, SUBSAMPLE_ROWS = 1,
        SUBSAMPLE_COLUMNS = 1,
    }),
    mode!(Gc2145, "VGA", 24, Documented, "Linux: settings for 30 frames/s; two rows of five", gc2145 {
        MULTIPLIER = 6, SCALER = 1, COLUMN_BLANKING = 304, ROW_BLANKING = 12, ROWS = 1216, COLUMNS = 1618,
        SAMPLE_HOLD = 46, CROP = 1, CROP_ROWS = 480, CROP_COLUMNS = 640, SUBSAMPLE_ROWS = 5, SUBSAMPLE_COLUMNS = 5,
        KEPT_ROWS = 0x0123_0000, KEPT_COLUMNS = 0x0123_0000,
    }),
    mode!(Gc2145, "VGA, Nicla Vision", 12, Documented, "OpenMV: settings", gc2145 {
        MULTIPLIER = 5, COLUMN_BLANKING = 284, ROW_BLANKING = 50, FIRST_ROW = 372, FIRST_COLUMN = 480, ROWS = 488,
        COLUMNS = 656, SAMPLE_HOLD = 46, MIRROR = 1, FLIP = 1, CROP = 1, CROP_ROWS = 480, CROP_COLUMNS = 640,
        SUBSAMPLE_ROWS = 1, SUBSAMPLE_COLUMNS = 1,
    }),
    mode!(Mt9m114, "1280 x 960", 24, Computed, "Linux: 30 frames/s at 48 MHz", mt9m114 {
        FRAME_LINES = 997, LINE_CLOCKS = 1604, LAST_ROW = 971, STATED_CLOCK = 48_000_000, CROP_COLUMNS = 1280,
        CROP_ROWS = 960, OUTPUT_COLUMNS = 1280, OUTPUT_ROWS = 960, PLL_M = 32, PLL_N = 1, PLL_P = 7,
    }),
    mode!(Mt9m114, "VGA, OpenMV H7 R2", 24, Documented, "OpenMV: settings; rows binned by two", mt9m114 {
        FRAME_LINES = 528, LINE_CLOCKS = 1182, LAST_ROW = 971, STATED_CLOCK = 48_000_000, COLUMN_BINNING = 3,
        ROW_BINNING = 3, CROP_COLUMNS = 640, CROP_ROWS = 480, OUTPUT_COLUMNS = 640, OUTPUT_ROWS = 480, PLL_M = 32,
        PLL_N = 1, PLL_P = 7,
    }),
];
