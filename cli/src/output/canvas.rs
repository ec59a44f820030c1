//! [`Canvas`]: lines and labels over a picture. Whatever lies outside the picture is not drawn.

use image::{Rgb, RgbImage};

use super::glyphs;

/// In pixels: left and top are inside, right and bottom outside.
#[derive(Clone, Copy)]
pub(crate) struct Rectangle {
    pub(crate) left: i64,
    pub(crate) top: i64,
    pub(crate) right: i64,
    pub(crate) bottom: i64,
}

impl Rectangle {
    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        self.left < other.right && other.left < self.right && self.top < other.bottom && other.top < self.bottom
    }

    pub(crate) fn is_within(&self, other: &Self) -> bool {
        self.left >= other.left && self.right <= other.right && self.top >= other.top && self.bottom <= other.bottom
    }
}

pub(crate) struct Canvas {
    picture: RgbImage,
    /// Width and height of a character's pixels in those of the picture.
    scale: u32,
}

impl Canvas {
    /// Lines and labels grow with the picture, since a large one is shown reduced.
    pub(crate) fn new(picture: RgbImage) -> Self {
        let scale = 1 + picture.width().saturating_sub(1) / 800;
        Self { picture, scale }
    }

    pub(crate) fn into_picture(self) -> RgbImage {
        self.picture
    }

    pub(crate) fn scale(&self) -> i64 {
        self.scale.into()
    }

    pub(crate) fn bounds(&self) -> Rectangle {
        Rectangle { left: 0, top: 0, right: self.picture.width().into(), bottom: self.picture.height().into() }
    }

    fn dot(&mut self, column: i64, row: i64, colour: Rgb<u8>) {
        let position = u32::try_from(column).ok().zip(u32::try_from(row).ok());
        let pixel = position.and_then(|(column, row)| self.picture.get_pixel_mut_checked(column, row));
        if let Some(pixel) = pixel {
            *pixel = colour;
        }
    }

    /// A line of this width from one row to another. A flat line takes several columns of each row, so that it has no
    /// gaps.
    pub(crate) fn line(&mut self, from: (f64, u16), to: (f64, u16), width: i64, colour: Rgb<u8>) {
        let (first_row, last_row) = (i64::from(from.1), i64::from(to.1));
        let slope = (to.0 - from.0) / (last_row - first_row).max(1) as f64;
        for row in first_row..=last_row {
            let column = from.0 + slope * (row - first_row) as f64;
            let half_length = 0.5 * (slope.abs() - 1.0).max(0.0);
            let left = (column - half_length - 0.5 * (width - 1) as f64).round() as i64;
            let right = (column + half_length - 0.5 * (width - 1) as f64).round() as i64 + width;
            for column in left.max(-1)..right.min(self.bounds().right) {
                self.dot(column, row, colour);
            }
        }
    }

    /// Width and height of a label.
    pub(crate) fn label_size(&self, text: &str) -> (i64, i64) {
        let advance = i64::from(glyphs::WIDTH) + 1;
        let columns = text.chars().count() as i64 * advance - 1;
        ((columns + 4) * self.scale(), (i64::from(glyphs::HEIGHT) + 4) * self.scale())
    }

    /// A text on a dark box.
    pub(crate) fn label(&mut self, text: &str, area: &Rectangle, colour: Rgb<u8>) {
        const DARK: Rgb<u8> = Rgb([16, 16, 16]);
        for row in area.top..area.bottom {
            for column in area.left..area.right {
                self.dot(column, row, DARK);
            }
        }
        let scale = self.scale();
        let advance = (i64::from(glyphs::WIDTH) + 1) * scale;
        for (index, character) in text.chars().enumerate() {
            let left = area.left + 2 * scale + index as i64 * advance;
            self.character(character, left, area.top + 2 * scale, colour);
        }
    }

    fn character(&mut self, character: char, left: i64, top: i64, colour: Rgb<u8>) {
        let scale = self.scale();
        for (row, line) in glyphs::rows(character).iter().enumerate() {
            for (column, _) in line.match_indices('#') {
                for dot in 0..scale * scale {
                    let (x, y) = (column as i64 * scale + dot % scale, row as i64 * scale + dot / scale);
                    self.dot(left + x, top + y, colour);
                }
            }
        }
    }
}
