//! What a whole frame says is wrong.

use shutter_range::{FrameReport, MotionBlur, PixelReport, Range, RangeStatus, Setup, Share, Suspicion, Uncertainty};

use crate::projection::Scene;
use crate::scenes::range_of;

fn ranges(statuses: &[RangeStatus]) -> Vec<Range<f64>> {
    let range = range_of(&Scene::vga(), Uncertainty::NONE, &Scene::vga().points());
    statuses.iter().map(|status| Range { status: *status, ..range }).collect()
}

fn suspicion_with(setup: &Setup<f64>, statuses: &[RangeStatus]) -> Option<Suspicion> {
    let mut report = FrameReport::new();
    ranges(statuses).iter().for_each(|range| report.add(range));
    report.suspicion(setup)
}

fn suspicion(statuses: &[RangeStatus]) -> Option<Suspicion> {
    suspicion_with(&Scene::vga().setup_with(Uncertainty::NONE), statuses)
}

#[test]
fn most_edges_of_a_frame_tell_a_mistake() {
    use RangeStatus::{Bent, Cluttered, Far, Inconsistent, Leaning, Moving, Ok, Short, Sideways, Slow};
    let all = Share { edges: 2, of: 2 };
    assert_eq!(suspicion(&[Inconsistent, Inconsistent]), Some(Suspicion::AgainstMotion(all)));
    assert_eq!(suspicion(&[Leaning, Leaning]), Some(Suspicion::Leaning(all)));
    assert_eq!(suspicion(&[Slow, Slow]), Some(Suspicion::Slow(all)));
    assert_eq!(suspicion(&[Bent, Bent]), Some(Suspicion::Bent(all)));
    assert_eq!(suspicion(&[Sideways, Sideways]), Some(Suspicion::Sideways(all)));
    let exposed = Scene::vga().setup_with::<f64>(Uncertainty::NONE).with_motion_blur(MotionBlur::from_exposure(0.004));
    let exposed = exposed.expect("a sound exposure");
    assert_eq!(suspicion_with(&exposed, &[Leaning, Leaning]), Some(Suspicion::LeaningByBlur(all)));
    // One edge may be what it seems, and as many good ones speak against a mistake.
    assert_eq!(suspicion(&[]), None);
    assert_eq!(suspicion(&[Inconsistent]), None);
    assert_eq!(suspicion(&[Inconsistent, Inconsistent, Ok, Ok]), None);
    let three = [Inconsistent, Inconsistent, Inconsistent];
    let share = Share { edges: 3, of: 5 };
    assert_eq!(suspicion(&[&three[..], &[Ok, Ok]].concat()), Some(Suspicion::AgainstMotion(share)));
    // What is far has no slope either way.
    let share = Share { edges: 3, of: 11 };
    assert_eq!(suspicion(&[&three[..], &[Far; 8]].concat()), Some(Suspicion::AgainstMotion(share)));
    assert_eq!(suspicion(&[&three[..], &[Far; 9]].concat()), None);
    assert_eq!(suspicion(&[Moving, Moving, Cluttered, Cluttered, Short, Short]), None);
}

fn suspicions(row: impl Fn(usize) -> Vec<u8>) -> Vec<Suspicion> {
    let mut report = PixelReport::new();
    (0..100).for_each(|number| report.row(&row(number)));
    report.suspicions().collect()
}

#[test]
fn pixels_that_are_no_picture() {
    let ramp = |row: usize| (0..200).map(|column| (column / 2 + row) as u8).collect::<Vec<_>>();
    assert_eq!(suspicions(ramp), []);
    assert_eq!(suspicions(|_| vec![]), []);
    assert_eq!(suspicions(|_| vec![0; 200]), [Suspicion::FewLevels { darkest: 0, brightest: 0 }]);
    // A few hot pixels are no picture; every hundredth is.
    let spotted = |every: usize| {
        move |row: usize| {
            (0..200)
                .map(|column| if (200 * row + column).is_multiple_of(every) { 255 } else { 9 + (column % 3) as u8 })
                .collect()
        }
    };
    assert_eq!(suspicions(spotted(2000)), [Suspicion::FewLevels { darkest: 9, brightest: 11 }]);
    assert_eq!(suspicions(spotted(100)), []);
    let mosaic = |row: usize| -> Vec<u8> {
        ramp(row).iter().zip(0..).map(|(level, at)| level + if at % 2 == 0 { 40 } else { 0 }).collect()
    };
    assert_eq!(suspicions(mosaic), [Suspicion::AlternatingColumns]);
    // As long as half of the rows are as they should be, nothing is said.
    let half = |row: usize| if row.is_multiple_of(2) { mosaic(row) } else { ramp(row) };
    assert_eq!(suspicions(half), []);
}
