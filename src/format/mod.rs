//! Rows of pixels in the format in which the sensor delivers them, straight from the DMA buffer.
//!
//! [`Ranger::row`](crate::Ranger::row) takes anything that is [`Pixels`]: plain grey bytes (`&[u8]`, arrays, `Vec`), or
//! one of these views of a buffer, which convert a pixel when it is looked at and nothing before. The code is made for
//! each format that a program uses; for plain grey it is what it would be without the others.
//!
//! | the sensor delivers | view | accuracy |
//! | --- | --- | --- |
//! | 8-bit grey, also with a stride and an offset | `&[u8]`, [`Strided`] | the measure of the others |
//! | YUV 4:2:2: YUYV, UYVY, YVYU, VYUY | [`Strided::luma_first`], [`Strided::luma_second`] | as grey |
//! | RGB 5:6:5, either byte order | [`Rgb565`] | as grey of 6 bits |
//! | RAW10, packed as MIPI CSI-2 has it | [`Raw10`] | as grey, with less rounding |
//! | 10 to 16 bits in 16 | [`Wide`] | as grey, with less rounding |
//! | a Bayer mosaic in any of these | [`Bayer`] around it | within 1.3 times grey |
//! | any of these, for a program with little flash | [`Compact`] around it | as without it |
//!
//! A buffer of words (`[u32]`, as DMA controllers often fill it) is one of bytes to `bytemuck::cast_slice`, without a
//! copy. Grey levels of YUV and RGB come with a tone curve, mostly that of sRGB; raw ones are linear: say so with
//! [`Setup::with_response`](crate::Setup::with_response).
//!
//! A format of one's own:
//!
//! ```
//! use shutter_range::format::Pixels;
//!
//! /// Four bits a pixel, the left one in the upper half of its byte.
//! #[derive(Clone, Copy)]
//! struct Nibbles<'b>(&'b [u8]);
//!
//! impl Pixels for Nibbles<'_> {
//!     fn columns(&self) -> usize {
//!         2 * self.0.len()
//!     }
//!
//!     fn level_q8(&self, column: usize) -> u16 {
//!         let pair = self.0.get(column / 2).copied().unwrap_or(0);
//!         let level = if column % 2 == 0 { pair >> 4 } else { pair & 15 };
//!         u16::from(level) * (17 << 8) // 15 is white
//!     }
//! }
//!
//! assert_eq!(Nibbles(&[0x0F, 0x80]).level_q8(1), 255 << 8);
//! ```

mod pixels;
mod strided;
mod rgb565;
mod raw10;
mod wide;
mod bayer;
mod compact;
mod pixel_format;

pub use bayer::Bayer;
pub use compact::Compact;
pub use pixel_format::{FormatRow, PixelFormat};
pub use pixels::{MosaicRow, Pixels};
pub use raw10::Raw10;
pub use rgb565::{ByteOrder, Rgb565};
pub use strided::Strided;
pub use wide::Wide;
