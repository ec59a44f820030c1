//! What GC0308 and GC2145 have in common: a subsampler that keeps some lines of every few.

use super::description::ReadRegister;
use super::error::SensorError;
use super::register::Register;

/// Of every so many lines the subsampler keeps those whose numbers stand in a list of nibbles; a number counts once.
///
/// The lists that drivers write bear this out: {0} of 2 is a half, {0, 2} of 3 two thirds, {0, 2, 4} of 5 three fifths.
///
/// Returns (kept, of).
pub(super) fn subsampling<R: ReadRegister>(
    r: &mut R,
    ratio: &'static Register,
    kept_lines: &'static Register,
) -> Result<(u32, u32), SensorError<R::BusError>> {
    let of = r.read_above_zero(ratio)?;
    let list = r.read(kept_lines)?;
    let nibbles = (0..8).map(|index| (list >> (4 * index)) & 0x0f);
    let seen = nibbles.filter(|line| *line < of).fold(0_u16, |seen, line| seen | 1 << line);
    Ok((seen.count_ones().max(1), of))
}
