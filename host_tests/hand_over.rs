//! `hand_over`: rows from one side to the other, and what becomes of those for which there is no buffer.

use std::thread;

use shutter_range::hand_over::{RowQueue, RowReceiver, RowSender};
use shutter_range::{BoardRanger, DesktopRanger, EdgePoint, RowError, Scanner, Setup, Twist};

const fn assert_send<T: Send>() {}
const _: () = {
    assert_send::<BoardRanger>();
    assert_send::<DesktopRanger>();
    assert_send::<Scanner>();
    assert_send::<RowSender<'static, &'static mut [u8; 320]>>();
    assert_send::<RowReceiver<'static, &'static mut [u8; 320]>>();
};

/// A full queue loses whole rows and counts them; what was handed over before is untouched.
#[test]
fn a_slow_receiver_loses_whole_rows() {
    let mut queue = RowQueue::<Box<[u8; 4]>, 3>::new();
    let (mut sender, mut receiver) = queue.split();
    for _ in 0..2 {
        receiver.give_back(Box::default()).expect("room for two");
    }
    assert!(receiver.give_back(Box::default()).is_err(), "no room for a third");
    let mut filling = Box::new([0; 4]);
    for level in 1..=5 {
        *filling = [level; 4];
        filling = sender.hand_over(filling);
    }
    assert_eq!(sender.lost_rows(), 3);
    let rows: Vec<_> = std::iter::from_fn(|| receiver.next()).collect();
    let told: Vec<_> = rows.iter().map(|sent| (sent.frame, sent.row, sent.lost_rows, *sent.content)).collect();
    assert_eq!(told, [(0, 0, 0, [1; 4]), (0, 1, 0, [2; 4])]);
    for sent in rows {
        receiver.give_back(sent.content).expect("as many places as buffers");
    }
    // The next row says what was lost before it, and that rows are missing.
    filling = sender.hand_over(filling);
    sender.end_frame();
    let _ = sender.hand_over(filling);
    let told: Vec<_> =
        std::iter::from_fn(|| receiver.next()).map(|sent| (sent.frame, sent.row, sent.lost_rows)).collect();
    assert_eq!(told, [(0, 5, 3), (1, 0, 3)]);
}

#[test]
fn a_lost_row_tears_the_frame() {
    let setup = Setup::pinhole(32, 8, 30.0_f32, 8_000_000).expect("a sound setup");
    let mut queue = RowQueue::<Box<[u8; 32]>, 2>::new();
    let (mut sender, mut receiver) = queue.split();
    receiver.give_back(Box::new([9; 32])).expect("room for one");
    let mut ranger = BoardRanger::new();
    let mut filling = Box::new([9; 32]);
    let (mut results, mut kept) = (Vec::new(), Vec::new());
    for row in 0..8 {
        filling = sender.hand_over(filling);
        // Busy during rows 3 and 4.
        while let Some(sent) = receiver.next() {
            results.push(ranger.row(&setup, sent.row, &*sent.content));
            kept.push(sent.content);
        }
        if ![2, 3].contains(&row) {
            kept.drain(..).for_each(|buffer| receiver.give_back(buffer).expect("as many places as buffers"));
        }
    }
    assert_eq!(results[..3], [Ok(()); 3]);
    assert_eq!(results[3..], [Err(RowError::Order { row: 5, expected: 3 }), Err(RowError::Torn), Err(RowError::Torn)]);
    assert!(ranger.is_torn() && sender.lost_rows() == 2);
}

/// From another thread, as an interrupt would: every row comes once and whole, in order, or is counted.
#[test]
fn rows_of_another_thread() {
    const ROWS: u32 = 20_000;
    let mut queue = RowQueue::<Box<[u32; 16]>, 5>::new();
    let (mut sender, mut receiver) = queue.split();
    for _ in 0..4 {
        receiver.give_back(Box::default()).expect("room for four");
    }
    thread::scope(|scope| {
        let interrupt = scope.spawn(move || {
            let mut filling = Box::new([0; 16]);
            for number in 0..ROWS {
                *filling = [number; 16];
                filling = sender.hand_over(filling);
                if number % 64 == 63 {
                    sender.end_frame();
                }
            }
            sender.lost_rows()
        });
        let (mut seen, mut last) = (0, None);
        loop {
            let is_over = interrupt.is_finished();
            match receiver.next() {
                Some(sent) => {
                    let number = sent.frame * 64 + u32::from(sent.row);
                    assert_eq!(*sent.content, [number; 16]);
                    assert!(last < Some(number), "{number} after {last:?}");
                    assert_eq!(number, seen + sent.lost_rows, "nothing is lost uncounted");
                    (seen, last) = (seen + 1, Some(number));
                    receiver.give_back(sent.content).expect("as many places as buffers");
                }
                None if is_over => break,
                None => thread::yield_now(),
            }
        }
        assert_eq!(seen + interrupt.join().expect("no panic"), ROWS);
    });
}

/// An interrupt that searches its rows itself hands over edge points: the same ranges come out as from points that went
/// no way.
#[test]
fn edge_points_go_the_same_way() {
    type Points = heapless::Vec<EdgePoint, 16>;
    let setup = Setup::pinhole(64, 48, 60.0_f32, 8_000_000).expect("a sound setup");
    let motion = Twist::level([-2.0, 0.0, 0.0]).expect("a motion");
    let mut queue = RowQueue::<Box<Points>, 3>::new();
    let (mut sender, mut receiver) = queue.split();
    receiver.give_back(Box::default()).expect("room for two");
    let (mut sent_points, mut direct) = (BoardRanger::new(), BoardRanger::new());
    let (mut scanner, mut filling) = (Scanner::new(), Box::<Points>::default());
    for row in 0..48 {
        let edge = 24 + usize::from(row) / 6;
        let pixels: [u8; 64] = std::array::from_fn(|column| if column < edge { 40 } else { 200 });
        let time_ns = setup.readout().row_time_ns(row);
        filling.clear();
        scanner.scan(&pixels, |point| filling.push(point.at(row, time_ns)).expect("few edges in a row"));
        for point in filling.iter() {
            direct.edge_point(&setup, *point).expect("in order");
        }
        filling = sender.hand_over(filling);
        while let Some(sent) = receiver.next() {
            for point in sent.content.iter() {
                sent_points.edge_point(&setup, *point).expect("in order");
            }
            receiver.give_back(sent.content).expect("as many places as buffers");
        }
    }
    let [received, expected] = [sent_points, direct].map(|mut ranger| {
        ranger.end_frame(&setup);
        std::iter::from_fn(|| ranger.next_range(&setup, &motion)).collect::<Vec<_>>()
    });
    assert_eq!(sender.lost_rows(), 0);
    assert!(!expected.is_empty(), "an edge");
    assert_eq!(received, expected);
}
