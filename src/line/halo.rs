//! [`Halo`]: overshoot beside an edge, the mark of sharpening. docs/model.md, section 5.4.

/// What the feet of a flank have beyond a blurred step, away from the level on the other side: sums over the rows that
/// were looked at, in quarters of a grey level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Halo {
    left: i16,
    right: i16,
    rows: u16,
}

impl Halo {
    pub(super) fn add_row(&mut self, [left, right]: [i16; 2]) {
        self.add(&Self { left, right, rows: 1 });
    }

    pub(super) fn add(&mut self, other: &Self) {
        let sums = [self.left, self.right].into_iter().zip([other.left, other.right]);
        // The mean of so many rows is known well enough without more of them.
        if sums.into_iter().any(|(sum, more)| sum.checked_add(more).is_none()) {
            return;
        }
        self.left += other.left;
        self.right += other.right;
        self.rows = self.rows.saturating_add(other.rows);
    }

    pub(super) const fn rows(&self) -> u16 {
        self.rows
    }

    /// Mean overshoot of a row and a side, in 1/2¹⁸ of a grey level; zero where the levels do not overshoot.
    pub(super) fn mean_q18(&self) -> u32 {
        let both = i32::from(self.left) + i32::from(self.right);
        ((both.max(0) as u32) << 15).checked_div(self.rows.into()).unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::Halo;

    fn mean(rows: &[[i16; 2]]) -> u32 {
        let mut halo = Halo::default();
        rows.iter().for_each(|row| halo.add_row(*row));
        halo.mean_q18()
    }

    /// What a wrong column makes of one side it takes from the other.
    #[test]
    fn it_is_the_mean_of_both_sides() {
        assert_eq!(mean(&[[8, 12], [8, 4]]), 8 << 16);
        assert_eq!(mean(&[[8, -8], [-20, 20]]), 0);
        assert_eq!(mean(&[[-8, -20]]), 0);
        assert_eq!(mean(&[]), 0);
    }

    #[test]
    fn it_stays_the_mean_of_ever_so_many_rows() {
        assert_eq!(mean(&[[64, 64]; 4000]), 64 << 16);
    }
}
