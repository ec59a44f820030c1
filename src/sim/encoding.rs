//! From grey levels to the bytes of a [`PixelFormat`].

use crate::format::PixelFormat;

/// Writes the pixels of a row, one after the other.
pub(super) struct RowEncoder<'b> {
    format: PixelFormat,
    bytes: &'b mut [u8],
    column: usize,
}

/// Chroma of grey.
const NO_COLOUR: u8 = 128;

impl<'b> RowEncoder<'b> {
    pub(super) const fn new(format: PixelFormat, bytes: &'b mut [u8]) -> Self {
        Self { format, bytes, column: 0 }
    }

    /// The next pixel; one for which there is no room is left out. Conversions cut off what is below black and above
    /// white.
    pub(super) fn push(&mut self, level: f32) {
        let column = self.column;
        self.column += 1;
        match self.format {
            PixelFormat::Yuyv | PixelFormat::Yvyu => self.put(2 * column, [rounded(level), NO_COLOUR]),
            PixelFormat::Uyvy | PixelFormat::Vyuy => self.put(2 * column, [NO_COLOUR, rounded(level)]),
            PixelFormat::Rgb565Le => self.put(2 * column, rgb565(level).to_le_bytes()),
            PixelFormat::Rgb565Be => self.put(2 * column, rgb565(level).to_be_bytes()),
            PixelFormat::Grey10 | PixelFormat::Bayer10 => self.put(2 * column, steps(level, 10).to_le_bytes()),
            PixelFormat::Grey12 | PixelFormat::Bayer12 => self.put(2 * column, steps(level, 12).to_le_bytes()),
            PixelFormat::Grey10Packed | PixelFormat::Bayer10Packed => self.pack(column, steps(level, 10)),
            PixelFormat::Grey8 | PixelFormat::Bayer8 => self.put(column, [rounded(level)]),
        }
    }

    fn put<const N: usize>(&mut self, at: usize, value: [u8; N]) {
        if let Some(bytes) = self.bytes.get_mut(at..).and_then(|rest| rest.first_chunk_mut()) {
            *bytes = value;
        }
    }

    /// RAW10: the lower bits of four pixels share a byte behind them.
    fn pack(&mut self, column: usize, value: u16) {
        let (group, place) = (column / 4 * 5, column % 4);
        self.put(group + place, [(value >> 2) as u8]);
        if let Some(lower) = self.bytes.get_mut(group + 4) {
            let others = if place == 0 { 0 } else { *lower };
            *lower = others | ((value & 3) as u8) << (2 * place);
        }
    }
}

fn rounded(level: f32) -> u8 {
    (level + 0.5) as u8
}

/// So many bits: 2^(bits − 8) steps are a grey level.
fn steps(level: f32, bits: u32) -> u16 {
    let per_level = f32::from(1_u16 << (bits - 8));
    ((level * per_level + 0.5) as u16).min((1 << bits) - 1)
}

fn rgb565(level: f32) -> u16 {
    let share = |steps: u16| ((level / 255.0 * f32::from(steps) + 0.5) as u16).min(steps);
    share(31) << 11 | share(63) << 5 | share(31)
}
