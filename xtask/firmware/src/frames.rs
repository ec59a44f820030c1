//! Frames of a job, whose rows a ranger takes: what each frame and its dearest row have cost.

use budget_job::job::{Job, Source};
use semihosting::println;
use shutter_range::{Ranger, RowError, Setup};

use crate::Number;
use crate::counter::Counter;
use crate::stack::Painted;

/// The ranger whose rows are measured.
pub type Table = Ranger<16, 16, 64>;

/// Reads frames of such rows and prints the instructions and the stack of each, and its dearest row. What `take` does
/// is counted.
pub fn count(
    job: &mut Job<impl Source>,
    setup: &Setup<Number>,
    row_bytes: usize,
    take: impl Fn(&mut Table, u16, &[u8]) -> Result<(), RowError>,
) {
    let counter = Counter::new();
    let mut bytes = [0_u8; 4096];
    let bytes = bytes.get_mut(..row_bytes).expect("no wider image");
    for _ in 0..job.u16() {
        let mut ranger = Table::new();
        let painted = Painted::below(1 << 16);
        let (mut all, mut most, mut dearest, mut lines) = (0, 0, 0, 0_u32);
        for row in 0..setup.readout().rows() {
            job.bytes(bytes);
            let (result, instructions) = counter.count(|| take(&mut ranger, row, bytes));
            // What the search makes may look torn: then the frame has no more rows that cost anything.
            assert!(matches!(result, Ok(()) | Err(RowError::Jump { .. } | RowError::Torn)), "rows in order");
            all += instructions;
            if instructions > most {
                (most, dearest) = (instructions, row);
            }
            while ranger.next_line().is_some() {
                lines += 1;
            }
        }
        let stack = painted.used();
        ranger.end_frame(setup);
        while ranger.next_line().is_some() {
            lines += 1;
        }
        println!("frame {all} {most} {dearest} {lines} {stack}");
    }
}
