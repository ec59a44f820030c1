//! [`Light`]: whether the light of a frame's rows changes, all over them.

use super::pixel_row::grey;
use super::tuning::{LEAST_LIGHT, LIGHT_CHANGE, LIGHT_COLUMNS, LIGHT_ROWS, LIGHT_SIGMAS};
use crate::format::Pixels;

/// The light of a frame's rows. Where all columns become brighter or darker by one and the same factor, it is the light
/// that changes, or a shadow; what stands there is brighter in some columns and darker in others.
///
/// A frame begins in the dark, so that the first row is one in which the light changes.
///
/// *Cost*: some hundred instructions in every other row.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Light {
    /// What later rows are compared with.
    levels: [u8; LIGHT_COLUMNS],
    changed_row: u16,
    /// Sum of the levels of the brightest row.
    brightest: u16,
    is_dark: bool,
    has_changed: bool,
    has_returned: bool,
}

impl Light {
    /// Before a frame.
    pub(crate) const UNSEEN: Self = Self {
        levels: [0; LIGHT_COLUMNS],
        changed_row: 0,
        brightest: 0,
        is_dark: false,
        has_changed: false,
        has_returned: false,
    };

    /// The row in which it has changed last.
    pub(crate) const fn changed_row(&self) -> u16 {
        self.changed_row
    }

    /// Whether it has changed since it came: a frame may begin with rows of its border.
    pub(crate) const fn has_changed(&self) -> bool {
        self.has_changed
    }

    /// Whether less of it is left than a change of where it was brightest.
    pub(crate) const fn is_dark(&self) -> bool {
        self.is_dark
    }

    /// Whether it has gone, and has not done so before: the frame may have a border.
    pub(crate) const fn may_be_border(&self) -> bool {
        self.is_dark && !self.has_returned
    }

    /// Takes the next row of a frame, whose pixels have so much noise.
    pub(crate) fn take(&mut self, row: u16, pixels: &impl Pixels, noise_q8: impl FnOnce() -> u32) {
        // Of a mosaic, whose two kinds of rows differ, only one.
        if !row.is_multiple_of(LIGHT_ROWS) {
            return;
        }
        let levels = levels(pixels);
        let [before, now]: [u16; 2] =
            [&self.levels, &levels].map(|levels| levels.iter().map(|level| u16::from(*level)).sum());
        let has_come = before == 0 || now / LIGHT_CHANGE > self.brightest;
        self.brightest = now.max(self.brightest);
        let was_dark = core::mem::replace(&mut self.is_dark, now < self.brightest / LIGHT_CHANGE);
        self.has_returned |= was_dark && !self.is_dark && self.has_changed;
        let change = now.abs_diff(before);
        if change < (before / LIGHT_CHANGE).max(LEAST_LIGHT * LIGHT_COLUMNS as u16)
            || u32::from(change) < (LIGHT_SIGMAS * noise_q8()) >> 8
        {
            return;
        }
        if self.changes_alike(&levels, before.into(), now.into()) {
            self.changed_row = row;
            self.has_changed |= !has_come;
        }
        self.levels = levels;
    }

    /// Whether three columns of four change by the factor of all together: by half as much at least, and half as much
    /// again at most. In the others an edge may pass.
    fn changes_alike(&self, levels: &[u8; LIGHT_COLUMNS], before: u32, now: u32) -> bool {
        let change = before.abs_diff(now);
        let alike = self.levels.iter().zip(levels).filter(|(was, is)| {
            let (was, is) = (u32::from(**was), u32::from(**is));
            2 * (is * before).abs_diff(was * now) <= was * change + u32::from(LEAST_LIGHT) * before
        });
        4 * alike.count() >= 3 * LIGHT_COLUMNS
    }
}

/// Grey levels at uneven distances, so that a fence that moves does not change all of them alike.
#[inline(always)]
fn levels(pixels: &impl Pixels) -> [u8; LIGHT_COLUMNS] {
    /// In eighths of the mean distance.
    const OFF: [usize; LIGHT_COLUMNS] = [0, 5, 2, 7, 3, 6, 1, 4];
    let spacing = pixels.columns() / LIGHT_COLUMNS;
    let (mut levels, mut from) = ([0; LIGHT_COLUMNS], 0_usize);
    for (level, off) in levels.iter_mut().zip(OFF) {
        let column = from.saturating_add(off.saturating_mul(spacing) / LIGHT_COLUMNS);
        *level = grey(pixels, column..column.saturating_add(1), &mut [0]).first().copied().unwrap_or(0);
        from = from.saturating_add(spacing);
    }
    levels
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use rand::rngs::StdRng;
    use rand::{Rng, SeedableRng};
    use rand_distr::StandardNormal;

    use super::Light;

    const NOISE_Q8: u32 = 1 << 8;

    /// Rows of black and white bars that are so bright, in per cent, in which the light changes, and which are dark.
    fn seen(percents: impl IntoIterator<Item = u32>) -> (Vec<u16>, Vec<u16>) {
        let mut light = Light::UNSEEN;
        let (mut changed, mut dark) = (Vec::new(), Vec::new());
        for (row, percent) in (0..).zip(percents) {
            let level = |column: usize| if (column / 30).is_multiple_of(3) { 40 } else { 200 };
            let pixels: [u8; 320] = core::array::from_fn(|column| (level(column) * percent / 100) as u8);
            light.take(row, &&pixels, || NOISE_Q8);
            changed.push(light.changed_row());
            dark.extend(light.is_dark().then_some(row));
        }
        changed.dedup();
        (changed, dark)
    }

    #[test]
    fn it_changes() {
        let changes = |percents: &dyn Fn(u32) -> u32| seen((0..60).map(percents)).0;
        assert_eq!(changes(&|_| 100), [0]);
        assert_eq!(changes(&|row| if row < 20 { 100 } else { 80 }), [0, 20]);
        assert_eq!(changes(&|row| if row < 20 { 100 } else { 95 }), [0], "too little");
        assert_eq!(changes(&|row| if row < 20 { 0 } else { 2 }), [0], "too little for what is dark");
        assert_eq!(changes(&|row| if row < 20 { 0 } else { 5 }), [0, 20]);
        assert_eq!(changes(&|row| 100 - row / 3), [0, 40], "little by little");
        assert_eq!(changes(&|row| if row % 30 < 15 { 0 } else { 100 }), [0, 16, 30, 46]);
    }

    #[test]
    fn it_is_dark_where_hardly_any_is_left() {
        let dark = |percent: u32| seen((0..20).map(|row| if row < 10 { 100 } else { percent })).1;
        assert!(dark(15).is_empty());
        assert_eq!(dark(10), Vec::from_iter(10..20));
    }

    /// After forty rows, ten of each brightness, in per cent.
    fn light_of(percents: [u32; 4]) -> Light {
        let mut light = Light::UNSEEN;
        (0..40).for_each(|row| light.take(row, &&[2 * percents[usize::from(row / 10)] as u8; 320], || NOISE_Q8));
        light
    }

    /// What a frame begins with may be its border.
    #[test]
    fn it_comes_before_it_changes() {
        let has_changed = |percents| light_of(percents).has_changed();
        assert!(!has_changed([100, 100, 100, 100]));
        assert!(!has_changed([1, 1, 100, 100]), "it comes");
        assert!(has_changed([100, 100, 50, 50]) && has_changed([100, 100, 1, 1]) && has_changed([1, 100, 1, 100]));
        assert!(has_changed([30, 30, 100, 100]));
    }

    /// Light that goes twice is no border.
    #[test]
    fn what_is_dark_to_the_end_may_be_a_border() {
        let is_border = |percents| light_of(percents).may_be_border();
        assert!(is_border([100, 100, 100, 1]) && is_border([1, 100, 50, 1]) && is_border([100, 50, 1, 1]));
        assert!(!is_border([100, 1, 100, 1]) && !is_border([100, 1, 50, 1]) && !is_border([1, 100, 100, 100]));
    }

    /// Nothing but noise in the dark.
    #[test]
    fn noise_is_no_light() {
        let mut random = StdRng::seed_from_u64(1);
        for noise in [1.0, 4.0, 8.0] {
            let mut light = Light::UNSEEN;
            for row in 0..2000 {
                let mut pixel = || (20.0 + noise * random.sample::<f64, _>(StandardNormal)).round() as u8;
                let pixels: [u8; 320] = core::array::from_fn(|_| pixel());
                light.take(row, &&pixels, || (256.0 * noise) as u32);
            }
            assert!(!light.has_changed(), "noise {noise}, row {}", light.changed_row());
        }
    }

    /// Half of the columns fall where those beside them rise more.
    #[test]
    fn what_stands_there_is_no_light() {
        let mut light = Light::UNSEEN;
        let bright: [u8; 320] = core::array::from_fn(|column| if column % 80 < 40 { 100 } else { 50 });
        let other: [u8; 320] = core::array::from_fn(|column| if column % 80 < 40 { 70 } else { 250 });
        for row in 0..20 {
            light.take(row, &if row < 10 { &bright } else { &other }, || NOISE_Q8);
        }
        assert_eq!(light.changed_row(), 0);
    }
}
