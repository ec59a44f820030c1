//! Edge points to ranges: prints the instructions and the stack of each point, each line, or each frame of a sequence.
#![no_std]
#![no_main]

use budget_firmware::Number;
use budget_firmware::counter::Counter;
use budget_firmware::file::{self, JobFile};
use budget_firmware::stack::Painted;
use budget_job::job::Job;
use semihosting::println;
use shutter_range::{Motion, Range, RangeStatus, Ranger, Scalar, Sequence, Setup, Twist};

budget_firmware::program!(run);

type Tables = Ranger<16, 16, 64>;
/// More than any of it takes.
const STACK: usize = 1 << 17;

fn run() {
    let counter = Counter::new();
    let mut job = file::open();
    let what = job.u16();
    let setup = job.setup();
    let motion = job.twist();
    match what {
        0 => edges(&counter, &mut job, &setup),
        1 => lines(&counter, &mut job, &setup, &motion),
        _ => sequence(&counter, &mut job, &setup, &motion),
    }
}

/// A frame of points, row by row.
fn edges(counter: &Counter, job: &mut Job<JobFile>, setup: &Setup<Number>) {
    let mut ranger = Tables::new();
    let painted = Painted::below(STACK);
    let (mut all, mut points) = (0, 0);
    for row in 0..setup.readout().rows() {
        for _ in 0..job.u16() {
            let point = job.point();
            let (result, instructions) = counter.count(|| ranger.edge_point(setup, point));
            result.expect("rows in order");
            all += instructions;
            points += 1;
        }
        let (result, instructions) = counter.count(|| ranger.end_row(setup, row));
        result.expect("rows in order");
        all += instructions;
    }
    println!("edges {all} {points} {}", painted.used());
}

fn lines(counter: &Counter, job: &mut Job<JobFile>, setup: &Setup<Number>, motion: &Twist<Number>) {
    for _ in 0..job.u16() {
        let line = job.line();
        let painted = Painted::below(STACK);
        let (range, instructions) = counter.count(|| Range::from_line(setup, motion, &line));
        tell("line", instructions, painted.used(), &range);
    }
}

fn sequence(counter: &Counter, job: &mut Job<JobFile>, setup: &Setup<Number>, first: &Twist<Number>) {
    let mut motion = *first;
    let mut ranger = Tables::new();
    let mut sequence: Sequence<Number, 16> = Sequence::new();
    let interval_s = Number::from_ratio(setup.readout().row_time_ns(setup.readout().rows()), 1_000_000_000);
    for _ in 0..job.u16() {
        for _ in 0..setup.readout().rows() {
            for _ in 0..job.u16() {
                ranger.edge_point(setup, job.point()).expect("rows in order");
            }
        }
        ranger.end_frame(setup);
        let (mut ranges, mut sound) = (0_u32, 0_u32);
        let painted = Painted::below(STACK);
        let ((), instructions) = counter.count(|| {
            sequence.frame(setup, &motion, &mut ranger, |range| {
                ranges += 1;
                sound += u32::from(matches!(range.status, RangeStatus::Ok | RangeStatus::Far));
            });
        });
        println!("sequence {instructions} {} {ranges} {sound}", painted.used());
        let pose = motion.pose(interval_s);
        motion = job.twist();
        sequence.advance(setup, &pose, interval_s, motion.gravity()).expect("sound gravity");
    }
}

fn tell(what: &str, instructions: u64, stack: usize, range: &Range<Number>) {
    let inverse_depth = range.estimate.inverse_depth_per_m.to_f64();
    println!("{what} {instructions} {stack} {:?} {inverse_depth} {}", range.status, range.points_used);
}
