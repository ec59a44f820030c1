//! Torn frames: a missing, repeated or late row is noticed, never becomes a distance, and the next frame is as it
//! should be.

use shutter_range::sim::Exposure;
use shutter_range::{ReadoutDirection, RowError, Setup, Uncertainty};

use crate::rendered::{COLUMNS, Frame, ROWS, SmallRanger, TOP, assert_found, moving, post, ranges_of, render};

/// A whole frame; then one that `tear` tears, which yields nothing; then again a whole one.
fn assert_recovers(name: &str, direction: ReadoutDirection, tear: impl Fn(&mut SmallRanger, &Setup<f32>, &Frame)) {
    let world = moving(1.5);
    let (frame, truths) = render(&post(), &world, direction, Exposure::default(), 1);
    let setup = world.setup_read::<f32>(Uncertainty::NONE, direction);
    let mut ranger = SmallRanger::new();
    assert_found(name, &ranges_of(&mut ranger, &setup, &world, &frame), &truths, 0.01);
    tear(&mut ranger, &setup, &frame);
    assert!(ranger.is_torn(), "{name}");
    for index in [0, 1, 120, 239] {
        let row = setup.readout().row_after(index);
        assert_eq!(ranger.row(&setup, row, &frame[usize::from(row)]), Err(RowError::Torn), "{name}");
    }
    assert_eq!(ranger.ranges(&setup, &world.motion()), [], "{name}");
    ranger.end_frame(&setup);
    assert_eq!(ranger.ranges(&setup, &world.motion()), [], "{name}");
    assert!(!ranger.is_torn(), "{name}");
    assert_found(name, &ranges_of(&mut ranger, &setup, &world, &frame), &truths, 0.01);
}

/// The first rows of a frame, in the order of readout.
fn feed(ranger: &mut SmallRanger, setup: &Setup<f32>, frame: &Frame, rows: u16) {
    for index in 0..rows {
        let row = setup.readout().row_after(index);
        ranger.row(setup, row, &frame[usize::from(row)]).expect("rows in order");
    }
}

#[test]
fn torn_frames_yield_nothing_and_the_next_one_is_whole() {
    for direction in [TOP, ReadoutDirection::BottomToTop] {
        let bottom_up = direction == ReadoutDirection::BottomToTop;
        let row_at = |index: u16| if bottom_up { 239 - index } else { index };
        // Index of the row in the order of readout, and which one comes instead: left out, repeated, long gone, not
        // there.
        for (index, instead) in [(100, 101), (100, 99), (100, 20), (1, 0), (0, 1), (0, 120), (239, 238)] {
            assert_recovers(&format!("{instead} for {index}"), direction, |ranger, setup, frame| {
                feed(ranger, setup, frame, index);
                let (row, expected) = (row_at(instead), row_at(index));
                let refused = ranger.row(setup, row, &frame[usize::from(row)]);
                assert_eq!(refused, Err(RowError::Order { row, expected }));
            });
        }
        for row in [240, 241, u16::MAX] {
            assert_recovers(&format!("row {row}"), direction, |ranger, setup, frame| {
                feed(ranger, setup, frame, 100);
                let refused = ranger.row(setup, row, &frame[0]);
                assert_eq!(refused, Err(RowError::Order { row, expected: row_at(100) }));
            });
        }
        for pixels in [0, 1, 319, 321] {
            assert_recovers(&format!("{pixels} pixels"), direction, |ranger, setup, frame| {
                feed(ranger, setup, frame, 100);
                let refused = ranger.row(setup, row_at(100), &vec![0; pixels]);
                assert_eq!(refused, Err(RowError::Length { row: row_at(100), pixels, columns: COLUMNS }));
            });
        }
        for rows in [0, 1, 100, 240] {
            assert_recovers("torn by the driver", direction, |ranger, setup, frame| {
                feed(ranger, setup, frame, rows);
                ranger.tear();
            });
        }
    }
}

/// As when the end of the frame was overlooked.
#[test]
fn one_row_too_many_tears_the_frame() {
    assert_recovers("the next frame's first row", TOP, |ranger, setup, frame| {
        feed(ranger, setup, frame, ROWS);
        assert!(matches!(ranger.row(setup, 0, &frame[0]), Err(RowError::Order { row: 0, .. })));
    });
}
