//! [`Halo`]: overshoot beside an edge, the mark of sharpening. docs/model.md, section 5.4.

/// What the feet of a flank have beyond a blurred step, away from the level on the other side: sum over the rows in which
/// the edge was located, in quarters of a grey level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Halo {
    sum: i32,
    rows: u16,
}

impl Halo {
    #[inline(always)]
    pub(super) fn add_row(&mut self, overshoot: i16) {
        // 65536 of them fit.
        self.sum = self.sum.wrapping_add(overshoot.into());
        self.rows = self.rows.saturating_add(1);
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.sum = self.sum.wrapping_add(other.sum);
        self.rows = self.rows.saturating_add(other.rows);
    }

    pub(super) const fn rows(&self) -> u16 {
        self.rows
    }

    /// Mean overshoot of a row and a side, in 1/2¹⁸ of a grey level; zero where the levels do not overshoot.
    pub(super) fn mean_q18(&self) -> u32 {
        let per_row = u64::from(self.sum.max(0) as u32) << 16;
        u32::try_from(per_row.checked_div(self.rows.into()).unwrap_or(0)).unwrap_or(u32::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::Halo;

    fn mean(rows: &[i16]) -> u32 {
        let mut halo = Halo::default();
        rows.iter().for_each(|row| halo.add_row(*row));
        halo.mean_q18()
    }

    #[test]
    fn it_is_a_mean() {
        assert_eq!(mean(&[20, 12]), 16 << 16);
        assert_eq!(mean(&[0, 0]), 0);
        assert_eq!(mean(&[-28]), 0);
        assert_eq!(mean(&[]), 0);
    }

    #[test]
    fn it_stays_the_mean_of_ever_so_many_rows() {
        assert_eq!(mean(&[64; 40_000]), 64 << 16);
    }
}
