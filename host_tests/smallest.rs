//! What a program uses that is to be small finds what the usual program finds.

use shutter_range::format::{Compact, Pixels};
use shutter_range::sim::{Background, Bar, Exposure, Scene, Simulator};
use shutter_range::{
    BoardRanger, EdgePoint, Line, Motion, MotionBlur, Pose, Range, RangeStatus, Ranger, Repair, RowError, Setup,
    Strict, Translation, Twist,
};

use crate::journey::{normal, seed};

const COLUMNS: u16 = 320;
const ROWS: u16 = 240;

fn setup() -> Setup<f32> {
    Setup::pinhole(COLUMNS, ROWS, 300.0, 33_300_000).expect("a sound setup")
}

fn motion() -> Twist<f32> {
    Twist::level([-1.5, 0.0, 0.0]).expect("a sound motion")
}

/// Bars that stand alone, one before the other, and side by side.
fn frame(seed: u64) -> Vec<[u8; COLUMNS as usize]> {
    let bars = [(-0.4, 1.0, 0.12, 60.0), (-0.05, 2.0, 0.2, 90.0), (0.15, 3.0, 0.04, 40.0), (0.19, 3.0, 0.04, 40.0)];
    frame_of(&bars.map(|(bearing, depth_m, width_m, level)| Bar::upright(bearing, depth_m, width_m, level)), seed)
}

fn frame_of(bars: &[Bar], seed: u64) -> Vec<[u8; COLUMNS as usize]> {
    let mut scene = Scene::<8>::new(Background::plain(170.0)).expect("a sound background");
    for bar in bars {
        scene.push(*bar).expect("a sound bar");
    }
    let (setup, exposure) = (setup(), Exposure { time_s: 0.002, psf_sigma_px: 0.7, read_noise: 2.5, shot_gain: 0.03 });
    let simulator = Simulator::new(&scene, setup.camera(), setup.readout(), &motion(), exposure, seed);
    let simulator = simulator.expect("sound parameters");
    let row = |row| {
        let mut pixels = [0; COLUMNS as usize];
        simulator.row(row, &mut pixels);
        pixels
    };
    (0..ROWS).map(row).collect()
}

fn taken<'r, P: Pixels>(rows: &'r [[u8; COLUMNS as usize]], format: impl Fn(&'r [u8]) -> P) -> BoardRanger {
    taken_by(BoardRanger::new(), rows, format)
}

type StrictRanger = Ranger<16, 12, 32, Strict>;

fn taken_by<'r, P: Pixels, R: Repair>(
    mut ranger: Ranger<16, 12, 32, R>,
    rows: &'r [[u8; COLUMNS as usize]],
    format: impl Fn(&'r [u8]) -> P,
) -> Ranger<16, 12, 32, R> {
    let setup = setup();
    for (row, pixels) in (0..).zip(rows) {
        ranger.row(&setup, row, format(pixels)).expect("rows in order");
    }
    ranger.end_frame(&setup);
    ranger
}

/// The same edges at the same depths, to a fraction of what noise does to each: in some rows between neighbours other
/// points are found.
#[test]
fn compact_rows_show_the_same_edges() {
    let mut squares = 0.0;
    for seed in 1..=10 {
        let rows = frame(seed);
        let ranges = |mut ranger: BoardRanger| ranger.ranges(&setup(), &motion());
        let (usual, compact) = (ranges(taken(&rows, |row| row)), ranges(taken(&rows, Compact)));
        assert_eq!((usual.len(), compact.len()), (8, 8), "seed {seed}");
        for (usual, compact) in usual.iter().zip(&compact) {
            assert_eq!(usual.status, RangeStatus::Ok, "seed {seed}: {usual:?}");
            assert_eq!(compact.status, RangeStatus::Ok, "seed {seed}: {compact:?}");
            let [usual, compact] = [usual, compact].map(|range| range.estimate);
            let sigma_per_m = usual.budget.noise_per_m.max(compact.budget.noise_per_m);
            let off = (compact.inverse_depth_per_m - usual.inverse_depth_per_m) / sigma_per_m;
            squares += off * off;
        }
    }
    let apart = (squares / 80.0).sqrt();
    assert!(apart < 0.3, "{apart} sigma");
}

fn lines<R: Repair, const LINES: usize, const KNOTS: usize, const POINTS: usize>(
    mut ranger: Ranger<LINES, KNOTS, POINTS, R>,
) -> impl Iterator<Item = Line<KNOTS>> {
    core::iter::from_fn(move || ranger.next_line())
}

/// Without an exposure there is no blur to measure; with one, only the places count.
#[test]
fn without_blur_it_is_the_range_of_an_unknown_exposure() {
    let (unknown, motion) = (setup(), motion());
    let known = unknown.with_motion_blur(MotionBlur::from_exposure(0.002)).expect("sound blur");
    for line in lines(taken(&frame(1), |row| row)) {
        let range = Range::from_line(&unknown, &motion, &line);
        assert_eq!(Range::without_blur(&unknown, &motion, &line), range);
        let without = Range::without_blur(&known, &motion, &line);
        assert_eq!(without, range);
        assert!(without.lens_blur.is_none() && Range::from_line(&known, &motion, &line).lens_blur.is_some());
    }
}

/// A translation is the twist that turns by nothing, to the last bit; so is a motion of one's own that says nothing of
/// itself.
#[test]
fn a_translation_is_a_twist_that_does_not_turn() {
    struct Plain(Twist<f32>);
    impl Motion<f32> for Plain {
        fn pose(&self, time_s: f32) -> Pose<f32> {
            self.0.pose(time_s)
        }

        fn gravity(&self) -> [f32; 3] {
            self.0.gravity()
        }
    }
    let (velocity_m_s, gravity) = ([-1.5, 0.1, 0.3], [0.05, 0.99, -0.08]);
    let twist = Twist::new(velocity_m_s, [0.0; 3], gravity).expect("a sound motion");
    let translation = Translation::new(velocity_m_s, gravity).expect("a sound motion");
    assert_eq!(translation.pose(0.02), twist.pose(0.02));
    assert_eq!(translation.gravity(), twist.gravity());
    assert_eq!(translation.velocity_m_s(), twist.velocity_m_s());
    for line in lines(taken(&frame(2), |row| row)) {
        let range = Range::from_line(&setup(), &twist, &line);
        assert_eq!(Range::from_line(&setup(), &translation, &line), range);
        let plain = Range::from_line(&setup(), &Plain(twist), &line);
        let off = plain.estimate.inverse_depth_per_m - range.estimate.inverse_depth_per_m;
        assert!(off.abs() < 0.01 * range.estimate.sigma_inverse_depth_per_m, "{plain:?}, {range:?}");
    }
    assert!(Translation::level([f32::NAN, 0.0, 0.0]).is_err() && Translation::new(velocity_m_s, [0.0; 3]).is_err());
}

#[test]
fn a_translation_is_checked_again_when_read() {
    let motion = Translation::level([1.5_f32, -0.25, 0.5]).expect("a sound motion");
    let text = serde_json::to_string(&motion).expect("writes");
    assert_eq!(serde_json::from_str::<Translation<f32>>(&text).expect("reads"), motion);
    for (sound, broken) in [("1.5", "15000.0"), ("[0.0,1.0,0.0]", "[0.0,0.0,0.0]")] {
        let nonsense = text.replace(sound, broken);
        assert!(nonsense != text && serde_json::from_str::<Translation<f32>>(&nonsense).is_err(), "{nonsense}");
    }
}

/// Of clean edges hardly any is refused, and the others are told as usual: what roughness does to a sigma is not followed
/// but bounded.
#[test]
fn strict_ranges_of_clean_edges_are_the_usual_ones() {
    let (mut all, mut refused) = (0, 0);
    for line in (1..=10).flat_map(|seed| lines(taken(&frame(seed), Compact))) {
        let usual = Range::without_blur(&setup(), &motion(), &line);
        let strict = Range::strict(&setup(), &motion(), &line);
        all += 1;
        if strict.status == RangeStatus::Bent {
            refused += 1;
            continue;
        }
        assert_eq!((usual.status, strict.status), (RangeStatus::Ok, RangeStatus::Ok));
        let sigmas_per_m = [usual, strict].map(|range| range.estimate.sigma_inverse_depth_per_m);
        let off_per_m = (strict.estimate.inverse_depth_per_m - usual.estimate.inverse_depth_per_m).abs();
        assert!(off_per_m < 0.1 * sigmas_per_m[0] && sigmas_per_m[1] > 0.9 * sigmas_per_m[0], "{usual:?}, {strict:?}");
    }
    assert!(all == 80 && refused < 8, "{refused} of {all}");
}

/// Where the usual fit gives a wider sigma, or leaves points out, the strict one gives no depth.
#[test]
fn what_a_strict_fit_would_have_to_repair_is_bent() {
    // How far off the straight edge a row is, in pixels.
    let line = |off_px: fn(u16) -> f32| {
        let point = |row: u16| {
            let column_px = 100.0 + 0.1 * f32::from(row) + off_px(row);
            EdgePoint::new(row, (column_px * 65536.0) as i32, setup().readout().row_time_ns(row))
        };
        let mut line: Line<8> = Line::new(point(0));
        (1..ROWS).for_each(|row| line.push(point(row)).expect("rows in order"));
        line
    };
    let statuses = |line: &Line<8>| {
        let (setup, motion) = (setup(), motion());
        [Range::without_blur(&setup, &motion, line), Range::strict(&setup, &motion, line)].map(|range| range.status)
    };
    assert_eq!(statuses(&line(|_| 0.0)), [RangeStatus::Ok; 2]);
    let wander = line(|row| 0.4 * (f32::from(row) / 15.0).sin());
    assert_eq!(statuses(&wander), [RangeStatus::Ok, RangeStatus::Bent]);
    let outlier = line(|row| if (96..128).contains(&row) { 3.0 } else { 0.0 });
    assert_eq!(statuses(&outlier), [RangeStatus::Ok, RangeStatus::Bent]);
}

/// Whatever a line keeps of its rows, three knots or sixteen.
#[test]
fn a_strict_range_needs_no_number_of_knots() {
    fn assert_straight<const KNOTS: usize>() {
        let random = &mut seed(82);
        let (mut noisy, mut refused) = (0, 0);
        for rows in (40..=ROWS).step_by(10) {
            for hidden in [0..0, rows / 4..rows / 2] {
                let mut line = |noise_px: f64, sagitta_px: f64| {
                    let mut point = |row: u16| {
                        let off = 2.0 * f64::from(row) / f64::from(rows) - 1.0;
                        let off_px = noise_px * normal(random) + sagitta_px * off * off;
                        let column_px = 100.0 + 0.1 * f64::from(row) + off_px;
                        let time_ns = setup().readout().row_time_ns(row);
                        EdgePoint::new(row, (column_px * 65536.0) as i32, time_ns).with_sigma_q16(6554)
                    };
                    let mut line: Line<KNOTS> = Line::new(point(0));
                    let seen = (1..rows).filter(|row| !hidden.contains(row));
                    seen.for_each(|row| line.push(point(row)).expect("rows in order"));
                    Range::strict(&setup(), &motion(), &line).status
                };
                let name = format!("{KNOTS} knots, {rows} rows, {hidden:?} hidden");
                assert_ne!(line(0.0, 0.0), RangeStatus::Bent, "{name}");
                noisy += 1;
                refused += u32::from(line(0.1, 0.0) == RangeStatus::Bent);
                // No knot departs by 1.5 px, but most by more than noise and roughness do.
                assert_eq!(line(0.0, 2.0), RangeStatus::Bent, "{name}");
            }
        }
        assert!(10 * refused < noisy, "{KNOTS} knots: {refused} of {noisy}");
    }
    assert_straight::<4>();
    assert_straight::<5>();
    assert_straight::<6>();
    assert_straight::<7>();
    assert_straight::<8>();
    assert_straight::<16>();
}

/// Where nothing is to be repaired.
#[test]
fn a_strict_ranger_takes_the_same_lines() {
    for seed in 1..=3 {
        let rows = frame(seed);
        let strict: Vec<_> = lines(taken_by(StrictRanger::strict(), &rows, Compact)).collect();
        assert_eq!(strict, lines(taken(&rows, Compact)).collect::<Vec<_>>(), "seed {seed}");
    }
}

/// A post that stands on one that leans: the usual ranger parts them.
#[test]
fn what_turns_is_one_line_and_bent() {
    let setup = setup();
    let column_px = |row: u16| 100.0 + if row < 120 { 0.0 } else { 0.05 * f32::from(row - 120) };
    let point = |row: u16| EdgePoint::new(row, (column_px(row) * 65536.0) as i32, setup.readout().row_time_ns(row));
    let (mut usual, mut strict) = (BoardRanger::new(), StrictRanger::strict());
    for row in 0..ROWS {
        usual.edge_point(&setup, point(row)).expect("points in order");
        strict.edge_point(&setup, point(row)).expect("points in order");
    }
    usual.end_frame(&setup);
    strict.end_frame(&setup);
    assert_eq!(lines(usual).count(), 2);
    let statuses: Vec<_> = lines(strict).map(|line| Range::strict(&setup, &motion(), &line).status).collect();
    assert_eq!(statuses, [RangeStatus::Bent]);
}

/// Bytes were lost in the middle of the frame: the usual ranger notices it, and a strict one shows each edge as two.
#[test]
fn that_all_lines_jump_is_not_noticed() {
    let mut rows = frame(4);
    rows.iter_mut().skip(120).for_each(|row| row.rotate_left(20));
    let (setup, mut usual, mut strict) = (setup(), BoardRanger::new(), StrictRanger::strict());
    let jump = (0..).zip(&rows).find_map(|(row, pixels)| usual.row(&setup, row, pixels).err());
    assert!(matches!(jump, Some(RowError::Jump { row: 118..=122 })), "{jump:?}");
    for (row, pixels) in (0..).zip(&rows) {
        strict.row(&setup, row, pixels).expect("rows in order");
    }
    strict.end_frame(&setup);
    assert!(lines(strict).count() > 8);
}

/// Rows that are only scanned: each edge is told, and no worse than its sigma of noise and roughness says.
#[test]
fn scanned_points_are_ranged_as_well_as_their_sigma_says() {
    let (setup, motion) = (setup(), motion());
    let mut squares = 0.0;
    for seed in 1..=20 {
        let rows = frame_of(&[Bar::upright(-0.2, 1.0, 0.12, 60.0), Bar::upright(0.2, 2.0, 0.12, 60.0)], seed);
        let mut ranger = StrictRanger::strict();
        for (row, pixels) in (0..).zip(&rows) {
            ranger.scanned_row(&setup, row, pixels).expect("rows in order");
        }
        ranger.end_frame(&setup);
        let ranges: Vec<_> = lines(ranger).map(|line| Range::strict(&setup, &motion, &line)).collect();
        assert_eq!(ranges.len(), 4, "seed {seed}");
        for Range { status, estimate, .. } in ranges {
            assert_eq!(status, RangeStatus::Ok, "seed {seed}: {estimate:?}");
            let depth_m = if estimate.bearing < 0.0 { 1.0 } else { 2.0 };
            let off = (estimate.inverse_depth_per_m - 1.0 / depth_m) / estimate.budget.noise_per_m;
            squares += off * off;
        }
    }
    let off = (squares / 80.0).sqrt();
    assert!(off < 1.0, "{off} sigma");
}

/// More edges than a row's buffer holds.
#[test]
fn scanned_rows_that_cannot_be_read_are_counted() {
    let setup = setup();
    let pixels: [u8; COLUMNS as usize] = core::array::from_fn(|column| if column / 8 % 2 == 0 { 60 } else { 180 });
    let mut ranger: Ranger<8, 8, 16, Strict> = Ranger::strict();
    for row in 0..ROWS {
        ranger.scanned_row(&setup, row, &pixels).expect("rows in order");
    }
    assert_eq!(ranger.counters().crowded_rows, u32::from(ROWS));
    assert!(ranger.counters().dropped_points > u32::from(ROWS));
}
