//! What a camera makes of a pixel and its neighbours: sharpening, denoising, and grey from a colour mosaic.

use super::window::Rows;

/// The pixel of a row so far to the right of a column; at the borders the last pixel repeats.
fn pixel<const COLUMNS: usize>(row: &[u16; COLUMNS], column: usize, right: isize) -> u16 {
    let at = column.saturating_add_signed(right).min(COLUMNS.saturating_sub(1));
    row.get(at).copied().unwrap_or(0)
}

/// The nine pixels around one, row by row.
fn nine<const COLUMNS: usize>([_, above, here, below, _]: &Rows<'_, COLUMNS>, column: usize) -> [u16; 9] {
    let three = |row| [-1, 0, 1].map(|right| pixel(row, column, right));
    let ([a, b, c], [d, e, f], [g, h, i]) = (three(above), three(here), three(below));
    [a, b, c, d, e, f, g, h, i]
}

/// Adds so many times the difference to the mean of 3 × 3 pixels, weighted 1 2 1 both ways.
pub(super) fn sharpened_3x3<const COLUMNS: usize>(rows: &Rows<'_, COLUMNS>, strength: f32, out: &mut [u16; COLUMNS]) {
    let [_, above, here, below, _] = rows;
    let down = |column| {
        let [a, b, c] = [above, here, below].map(|row| u32::from(pixel(row, column, 0)));
        a + 2 * b + c
    };
    unsharp(here, strength, out, |column| {
        let [left, middle, right] = beside(column, COLUMNS).map(down);
        (left + 2 * middle + right) as f32 / 16.0
    });
}

/// Adds so many times the difference to the mean of 5 × 5 pixels, weighted 2 4 5 4 2 both ways.
pub(super) fn sharpened_5x5<const COLUMNS: usize>(rows: &Rows<'_, COLUMNS>, strength: f32, out: &mut [u16; COLUMNS]) {
    let [_, _, here, _, _] = rows;
    let bell = |[a, b, c, d, e]: [u32; 5]| 2 * (a + e) + 4 * (b + d) + 5 * c;
    let mut down = [0; COLUMNS];
    for (column, sum) in down.iter_mut().enumerate() {
        *sum = bell(rows.map(|row| u32::from(pixel(row, column, 0))));
    }
    let down = |column| down.get(column).copied().unwrap_or(0);
    unsharp(here, strength, out, |column| {
        let [left, _, right] = beside(column, COLUMNS);
        let ([far_left, ..], [.., far_right]) = (beside(left, COLUMNS), beside(right, COLUMNS));
        bell([far_left, left, column, right, far_right].map(down)) as f32 / 289.0
    });
}

/// A column and its neighbours within the image.
fn beside(column: usize, columns: usize) -> [usize; 3] {
    [column.saturating_sub(1), column, (column + 1).min(columns.saturating_sub(1))]
}

fn unsharp<const COLUMNS: usize>(
    here: &[u16; COLUMNS],
    strength: f32,
    out: &mut [u16; COLUMNS],
    mean: impl Fn(usize) -> f32,
) {
    for (column, (value, level)) in out.iter_mut().zip(here).enumerate() {
        let level = f32::from(*level);
        // The conversion cuts off below 0 and above 65535.
        *value = (level + strength * (level - mean(column)) + 0.5) as u16;
    }
}

/// The median of 3 × 3 pixels: with each column in order it is the median of the largest of the lowest, the median of
/// the middle ones and the smallest of the highest.
pub(super) fn median<const COLUMNS: usize>(rows: &Rows<'_, COLUMNS>, out: &mut [u16; COLUMNS]) {
    for (column, value) in out.iter_mut().enumerate() {
        let [a, b, c, d, e, f, g, h, i] = nine(rows, column);
        let ([l0, m0, h0], [l1, m1, h1], [l2, m2, h2]) = (ordered([a, d, g]), ordered([b, e, h]), ordered([c, f, i]));
        let [_, middle, _] = ordered([m0, m1, m2]);
        let [_, median, _] = ordered([l0.max(l1).max(l2), middle, h0.min(h1).min(h2)]);
        *value = median;
    }
}

fn ordered([a, b, c]: [u16; 3]) -> [u16; 3] {
    let (low, high) = (a.min(b), a.max(b));
    [low.min(c), high.min(low.max(c)), high.max(c)]
}

/// A mean of 3 × 3 pixels, each weighted by 1/(1 + d²), d its difference to the middle one in sigmas, so that edges
/// stay.
pub(super) fn bilateral<const COLUMNS: usize>(rows: &Rows<'_, COLUMNS>, sigma: f32, out: &mut [u16; COLUMNS]) {
    let per_sigma = 1.0 / (256.0 * sigma);
    for (column, value) in out.iter_mut().enumerate() {
        let around = nine(rows, column);
        let [_, _, _, _, middle, ..] = around;
        let (mut sum, mut weights) = (0.0, 0.0);
        for level in around {
            let off = (f32::from(level) - f32::from(middle)) * per_sigma;
            let weight = 1.0 / (1.0 + off * off);
            sum += weight * f32::from(level);
            weights += weight;
        }
        *value = (sum / weights + 0.5) as u16;
    }
}

/// Grey from a Bayer mosaic of red and green in even rows, green and blue in odd ones: the two missing colours of a
/// pixel are the means of their nearest pixels, and grey is 0.30 red, 0.59 green and 0.11 blue.
pub(super) fn demosaiced<const COLUMNS: usize>(number: usize, rows: &Rows<'_, COLUMNS>, out: &mut [u16; COLUMNS]) {
    const RED: u32 = 77;
    const GREEN: u32 = 150;
    const BLUE: u32 = 29;
    let is_red_row = number.is_multiple_of(2);
    let (own, other) = if is_red_row { (RED, BLUE) } else { (BLUE, RED) };
    for (column, value) in out.iter_mut().enumerate() {
        let [a, b, c, d, e, f, g, h, i] = nine(rows, column).map(u32::from);
        let is_green = (column % 2 == 1) == is_red_row;
        // Of the row's own colour, green, and the colour of the rows above and below; each in quarters.
        let [of_row, green, of_others] =
            if is_green { [2 * (d + f), 4 * e, 2 * (b + h)] } else { [4 * e, b + d + f + h, a + c + g + i] };
        *value = ((own * of_row + GREEN * green + other * of_others + 512) >> 10) as u16;
    }
}
