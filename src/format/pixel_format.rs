//! [`PixelFormat`]: a format that is chosen while the program runs.

use core::fmt::{self, Display, Formatter};
use core::str::FromStr;

use super::pixels::{MosaicRow, Pixels};
use super::raw10::Raw10;
use super::rgb565::{ByteOrder, Rgb565};
use super::strided::Strided;
use super::wide::Wide;
use crate::error::FormatNameError;

/// The formats by name, for programs that learn only while they run which one they get. Firmware knows its sensor's and
/// takes that view itself, which is faster.
///
/// ```
/// use shutter_range::format::{PixelFormat, Pixels};
/// let format: PixelFormat = "uyvy".parse()?;
/// assert_eq!(format.row_bytes(320), Some(640));
/// assert_eq!(format.row(&[128, 7, 128, 9], 0).level_q8(1), 9 << 8);
/// # Ok::<(), shutter_range::FormatNameError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum PixelFormat {
    /// `gray8`: a byte a pixel.
    #[default]
    Grey8,
    /// `yuyv`: YUV 4:2:2, luma first.
    Yuyv,
    /// `yvyu`: the same with V before U.
    Yvyu,
    /// `uyvy`: YUV 4:2:2, luma second.
    Uyvy,
    /// `vyuy`: the same with V before U.
    Vyuy,
    /// `rgb565le`: the lower byte first.
    Rgb565Le,
    /// `rgb565be`: the upper byte first.
    Rgb565Be,
    /// `gray10p`: grey RAW10, packed.
    Grey10Packed,
    /// `gray10le`: ten bits in sixteen, the lower byte first.
    Grey10,
    /// `gray12le`: twelve bits in sixteen.
    Grey12,
    /// `bayer8`: a mosaic, a byte a pixel.
    Bayer8,
    /// `bayer10p`: a mosaic in RAW10, packed.
    Bayer10Packed,
    /// `bayer10le`: a mosaic, ten bits in sixteen.
    Bayer10,
    /// `bayer12le`: a mosaic, twelve bits in sixteen.
    Bayer12,
}

impl PixelFormat {
    /// All of them.
    pub const ALL: [Self; 14] = [
        Self::Grey8,
        Self::Yuyv,
        Self::Yvyu,
        Self::Uyvy,
        Self::Vyuy,
        Self::Rgb565Le,
        Self::Rgb565Be,
        Self::Grey10Packed,
        Self::Grey10,
        Self::Grey12,
        Self::Bayer8,
        Self::Bayer10Packed,
        Self::Bayer10,
        Self::Bayer12,
    ];

    /// The name under which [`FromStr`] knows it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Grey8 => "gray8",
            Self::Yuyv => "yuyv",
            Self::Yvyu => "yvyu",
            Self::Uyvy => "uyvy",
            Self::Vyuy => "vyuy",
            Self::Rgb565Le => "rgb565le",
            Self::Rgb565Be => "rgb565be",
            Self::Grey10Packed => "gray10p",
            Self::Grey10 => "gray10le",
            Self::Grey12 => "gray12le",
            Self::Bayer8 => "bayer8",
            Self::Bayer10Packed => "bayer10p",
            Self::Bayer10 => "bayer10le",
            Self::Bayer12 => "bayer12le",
        }
    }

    /// Whether it is a colour mosaic.
    #[must_use]
    pub const fn is_mosaic(self) -> bool {
        matches!(self, Self::Bayer8 | Self::Bayer10Packed | Self::Bayer10 | Self::Bayer12)
    }

    /// Bytes of a row of so many pixels; `None` where a row cannot have that many, as four share five bytes of RAW10.
    #[must_use]
    pub const fn row_bytes(self, columns: u16) -> Option<usize> {
        let columns = columns as usize;
        match self {
            Self::Grey8 | Self::Bayer8 => Some(columns),
            Self::Grey10Packed | Self::Bayer10Packed if !columns.is_multiple_of(4) => None,
            Self::Grey10Packed | Self::Bayer10Packed => Some(columns / 4 * 5),
            _ => Some(2 * columns),
        }
    }

    /// Row `row` of the image, in these bytes.
    #[must_use]
    pub fn row(self, bytes: &[u8], row: u16) -> FormatRow<'_> {
        let samples = match self {
            Self::Grey8 | Self::Bayer8 => Samples::Bytes(Strided::new(bytes, 0, 1)),
            Self::Yuyv | Self::Yvyu => Samples::Bytes(Strided::luma_first(bytes)),
            Self::Uyvy | Self::Vyuy => Samples::Bytes(Strided::luma_second(bytes)),
            Self::Rgb565Le => Samples::Rgb(Rgb565::new(bytes, ByteOrder::LittleEndian)),
            Self::Rgb565Be => Samples::Rgb(Rgb565::new(bytes, ByteOrder::BigEndian)),
            Self::Grey10Packed | Self::Bayer10Packed => Samples::Packed(Raw10::new(bytes)),
            Self::Grey10 | Self::Bayer10 => Samples::Wide10(Wide::new(bytes)),
            Self::Grey12 | Self::Bayer12 => Samples::Wide12(Wide::new(bytes)),
        };
        FormatRow { samples, mosaic_row: self.is_mosaic().then_some(MosaicRow::of(row)) }
    }
}

impl Display for PixelFormat {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

impl FromStr for PixelFormat {
    type Err = FormatNameError;

    fn from_str(name: &str) -> Result<Self, FormatNameError> {
        Self::ALL.into_iter().find(|format| format.name() == name).ok_or(FormatNameError)
    }
}

/// A row in a format that is known at run time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FormatRow<'b> {
    samples: Samples<'b>,
    mosaic_row: Option<MosaicRow>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Samples<'b> {
    Bytes(Strided<'b>),
    Rgb(Rgb565<'b>),
    Packed(Raw10<'b>),
    Wide10(Wide<'b, 10>),
    Wide12(Wide<'b, 12>),
}

impl Pixels for FormatRow<'_> {
    fn columns(&self) -> usize {
        match self.samples {
            Samples::Bytes(bytes) => bytes.columns(),
            Samples::Rgb(rgb) => rgb.columns(),
            Samples::Packed(packed) => packed.columns(),
            Samples::Wide10(wide) => wide.columns(),
            Samples::Wide12(wide) => wide.columns(),
        }
    }

    fn level_q8(&self, column: usize) -> u16 {
        match self.samples {
            Samples::Bytes(bytes) => bytes.level_q8(column),
            Samples::Rgb(rgb) => rgb.level_q8(column),
            Samples::Packed(packed) => packed.level_q8(column),
            Samples::Wide10(wide) => wide.level_q8(column),
            Samples::Wide12(wide) => wide.level_q8(column),
        }
    }

    fn mosaic_row(&self) -> Option<MosaicRow> {
        self.mosaic_row
    }
}
