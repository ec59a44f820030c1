//! What OV3660 and OV5640 have in common: all but the clock.
//!
//! A line takes HTS clocks of the sensor's core, a frame VTS lines. The window is read with every row or, by the
//! vertical increments, with every second or fourth one; each line that is read takes one line time, also where it is
//! the mean of two rows. What is left within the offsets goes to a scaler, or is cut to the image where that is off.

use super::description::{Description, FrameSetting, Protocol, ReadRegister, Setting};
use super::error::SensorError;
use super::mode::{Clock, Evidence, Timing};
use super::register::{Register, registers};

registers! {
    PRODUCT = "CHIP_ID": 0x300a, 0x300b => "product: 0x3660 or 0x5640";
    FIRST_COLUMN = "X_ADDR_ST": 0x3800 / 0x0f, 0x3801 => "first column of the window in the array";
    FIRST_ROW = "Y_ADDR_ST": 0x3802 / 0x0f, 0x3803 => "first row of the window in the array";
    LAST_COLUMN = "X_ADDR_END": 0x3804 / 0x0f, 0x3805 => "last column of the window in the array";
    LAST_ROW = "Y_ADDR_END": 0x3806 / 0x0f, 0x3807 => "last row of the window in the array";
    OUTPUT_COLUMNS = "X_OUTPUT_SIZE": 0x3808 / 0x0f, 0x3809 => "columns of the image";
    OUTPUT_ROWS = "Y_OUTPUT_SIZE": 0x380a / 0x0f, 0x380b => "rows of the image";
    LINE_CLOCKS = "X_TOTAL_SIZE (HTS)": 0x380c / 0x1f, 0x380d => "clocks of a line";
    FRAME_LINES = "Y_TOTAL_SIZE (VTS)": 0x380e, 0x380f => "lines of a frame";
    COLUMN_OFFSET = "X_OFFSET": 0x3810 / 0x0f, 0x3811 => "columns left out on either side";
    ROW_OFFSET = "Y_OFFSET": 0x3812 / 0x07, 0x3813 => "lines left out on either side";
    COLUMN_STEPS = "X_INC": 0x3814 => "[7:4] step after odd columns, [3:0] after even ones";
    ROW_STEPS = "Y_INC": 0x3815 => "[7:4] step after odd rows, [3:0] after even ones";
    FLIP = "TIMING_TC_REG20[2:1]": 0x3820 / 0x06 => "upside down";
    MIRROR = "TIMING_TC_REG21[2:1]": 0x3821 / 0x06 => "mirror left to right";
    SCALING = "ISP_CONTROL_01[5]": 0x5001 / 0x20 => "the image is scaled";
    EXPOSURE = "AEC_PK_EXPOSURE": 0x3500 / 0x0f, 0x3501, 0x3502 => "exposure in 1/16 line";
    MANUAL_EXPOSURE = "AEC_PK_MANUAL[0]": 0x3503 / 0x01 => "exposure by hand";
}

pub(super) const DESCRIPTION: Description = Description {
    name: "",
    addresses: &[0x3c],
    protocol: Protocol { wide_address: true, wide_data: false, repeated_start: false, page: None },
    identity: &[],
    registers: REGISTERS,
    exposure: Setting { register: &EXPOSURE, shift: 4 },
    manual_exposure: (&MANUAL_EXPOSURE, 1),
    exposure_margin_lines: 4,
    frame: FrameSetting::Whole(&FRAME_LINES),
    commit: None,
};

pub(super) fn timing<R: ReadRegister>(
    r: &mut R,
    clock: Clock,
    evidence: Evidence,
) -> Result<Timing, SensorError<R::BusError>> {
    let (first_column, columns, column_offset) = side(r, &FIRST_COLUMN, &LAST_COLUMN, &COLUMN_OFFSET)?;
    let (first_row, rows, row_offset) = side(r, &FIRST_ROW, &LAST_ROW, &ROW_OFFSET)?;
    let (column_step, row_step) = (step(r, &COLUMN_STEPS)?, step(r, &ROW_STEPS)?);
    let [output_columns, output_rows] = [r.read_above_zero(&OUTPUT_COLUMNS)?, r.read_above_zero(&OUTPUT_ROWS)?];
    let [columns_used, lines] = if r.is_set(&SCALING)? {
        let within =
            |size: u32, step: u32, offset: u32| (size >> step).checked_sub(2 * offset).filter(|size| *size > 0);
        let Some(lines) = within(rows, row_step, row_offset) else {
            let expected = "less than half of the lines that are read";
            return Err(SensorError::Register { register: &ROW_OFFSET, value: row_offset, expected });
        };
        [within(columns, column_step, column_offset).unwrap_or(output_columns), lines]
    } else {
        [output_columns, output_rows]
    };
    Ok(Timing {
        line_clocks: r.read_above_zero(&LINE_CLOCKS)?,
        clock,
        frame_lines: r.read_above_zero(&FRAME_LINES)?,
        exposure_sixteenths: r.read(&EXPOSURE)?,
        automatic_exposure: !r.is_set(&MANUAL_EXPOSURE)?,
        mirrored: r.is_set(&MIRROR)?,
        flipped: r.is_set(&FLIP)?,
        columns: output_columns,
        rows: output_rows,
        lines,
        window: [
            first_column + (column_offset << column_step),
            first_row + (row_offset << row_step),
            columns_used << column_step,
            lines << row_step,
        ],
        evidence,
    })
}

/// First pixel, number of pixels, and offset.
fn side<R: ReadRegister>(
    r: &mut R,
    first: &'static Register,
    last: &'static Register,
    offset: &'static Register,
) -> Result<(u32, u32, u32), SensorError<R::BusError>> {
    let (start, end) = (r.read(first)?, r.read(last)?);
    match (end + 1).checked_sub(start).filter(|size| *size > 0) {
        Some(size) => Ok((start, size, r.read(offset)?)),
        None => Err(SensorError::Register { register: last, value: end, expected: "at least that of the start" }),
    }
}

/// How often the number of rows is halved: the mean of the two steps is 1, 2 or 4.
fn step<R: ReadRegister>(r: &mut R, steps: &'static Register) -> Result<u32, SensorError<R::BusError>> {
    let value = r.read(steps)?;
    match (value >> 4) + (value & 0x0f) {
        2 => Ok(0),
        4 => Ok(1),
        8 => Ok(2),
        _ => Err(SensorError::Register { register: steps, value, expected: "0x11, 0x31 or 0x71" }),
    }
}
