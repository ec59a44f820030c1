//! Which line of a frame is which edge: where their places leave it open, their contrasts tell.

use shutter_range::{Motion, Range, Ranger, Sequence, Setup, Twist, Uncertainty};

const ROWS: u16 = 240;
const INTERVAL_S: f64 = 1.0 / 30.0;
const PX_PER_S: f64 = 450.0;

/// From dark to bright at a column that changes with the row.
struct Step {
    column: fn(u16, f64) -> f64,
    contrast: f64,
}

/// An edge 2 m away that leans so much against the motion that a frame shows it upright, as one that is far away.
fn near(row: u16, start_s: f64) -> f64 {
    let middle = f64::from(row) - 119.5;
    let leaning = -PX_PER_S * INTERVAL_S / f64::from(ROWS) * middle;
    100.0 + leaning + PX_PER_S * (start_s + f64::from(row) * INTERVAL_S / f64::from(ROWS))
}

/// Where the other one would be if it were far away.
fn far(_: u16, _: f64) -> f64 {
    108.0
}

fn pixels(row: u16, start_s: f64, steps: &[Step]) -> Vec<u8> {
    let level = |x: usize| {
        let step = |step: &Step| step.contrast * (x as f64 + 0.5 - (step.column)(row, start_s)).clamp(0.0, 1.0);
        40.0 + steps.iter().map(step).sum::<f64>()
    };
    (0..320).map(|x| level(x).round() as u8).collect()
}

/// What the second frame tells of the edge that the first one has shown.
fn second_frame(near_contrast: f64, far_contrast: f64) -> Vec<Range<f64>> {
    let five_degrees = Uncertainty::NONE.with_sigma_tilt(0.0875);
    let setup =
        Setup::pinhole(320, ROWS, 300.0, 33_333_333).expect("sound").with_uncertainty(five_degrees).expect("sound");
    let motion = Twist::level([-3.0, 0.0, 0.0]).expect("sound");
    let mut ranger: Ranger<16, 16, 64> = Ranger::new();
    let mut sequence: Sequence<f64, 16> = Sequence::new();
    let mut ranges = vec![];
    for frame in 0..2 {
        let start_s = f64::from(frame) * INTERVAL_S;
        let mut steps = vec![Step { column: near, contrast: near_contrast }];
        if frame == 1 {
            steps.push(Step { column: far, contrast: far_contrast });
        }
        for row in 0..ROWS {
            ranger.row(&setup, row, &pixels(row, start_s, &steps)[..]).expect("in order");
        }
        ranger.end_frame(&setup);
        ranges.clear();
        sequence.frame(&setup, &motion, &mut ranger, |range| ranges.push(range));
        sequence.advance(&setup, &motion.pose(INTERVAL_S), INTERVAL_S, motion.gravity()).expect("sound");
    }
    ranges
}

#[test]
fn contrast_tells_edges_apart() {
    for (near_contrast, far_contrast, is_near) in [(30.0, 120.0, true), (120.0, 30.0, true), (60.0, 68.0, false)] {
        let ranges = second_frame(near_contrast, far_contrast);
        let known: Vec<_> = ranges.iter().filter(|range| range.frames == 2).collect();
        let [range] = known.as_slice() else { panic!("{ranges:#?}") };
        // Of equal contrast, one that is where the first frame has it is taken. It looks an eighth weaker: the other is
        // near it.
        let expected = if is_near { 115.0 + 7.5 } else { 108.0 };
        assert!((range.column_at_first_row - expected).abs() < 4.0, "{near_contrast}, {far_contrast}: {range:#?}");
    }
}
