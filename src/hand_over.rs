//! Rows from an interrupt to the main loop, without a lock and without a copy.
//!
//! Buffers go round: the interrupt fills one, [`RowSender::hand_over`] gives it to the main loop and gets an empty one
//! back, and the main loop returns it with [`RowReceiver::give_back`]. Where the main loop is too slow there is no
//! empty buffer: the interrupt keeps its own and fills it again, the row in it is lost and counted, and the rows that
//! follow say so, since one is missing: [`Ranger::row`](crate::Ranger::row) then tears the frame. Neither side ever
//! waits.
//!
//! Buffers are of any type, `&'static mut [u8; 320]` as a rule, and are moved, not copied. An interrupt that has the
//! time to search its row for edges, by a [`Scanner`](crate::Scanner) of its own, fills a `heapless::Vec` of
//! [`EdgePoint`](crate::EdgePoint)s instead: less is then handed over, and the main loop goes on with
//! [`Ranger::edge_point`](crate::Ranger::edge_point). Two queues of `heapless::spsc` carry them: plain loads and
//! stores, so that a Cortex-M0 can have it, and no critical section.
//!
//! ```
//! use shutter_range::hand_over::RowQueue;
//!
//! let (mut first, mut second) = ([0; 320], [0; 320]);
//! let mut queue = RowQueue::<&mut [u8; 320], 4>::new();
//! let (mut sender, mut receiver) = queue.split();
//! receiver.give_back(&mut second).expect("room"); // the spare one
//!
//! // In the interrupt, at the end of the transfer into the first buffer:
//! let mut filling = &mut first;
//! filling[7] = 200;
//! filling = sender.hand_over(filling);
//!
//! // In the main loop:
//! let row = receiver.next().expect("a row");
//! assert_eq!((row.frame, row.row, row.content[7]), (0, 0, 200));
//! receiver.give_back(row.content).expect("room");
//! ```

use heapless::spsc::{Consumer, Producer, Queue};

/// Buffers on their way: a `static`, or in the frame of a `main` that never returns. `N − 1` of them at most, that
/// which is being filled not counted.
pub struct RowQueue<B, const N: usize> {
    full: Queue<SentRow<B>, N>,
    empty: Queue<B, N>,
}

/// A row that has been read.
#[derive(Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SentRow<B> {
    /// Number of the frame, from 0 on; it goes on at 0 after the last one.
    pub frame: u32,
    /// How many rows of its frame were read before it: [`Readout::row_after`](crate::Readout::row_after) tells its row.
    pub row: u16,
    /// Rows that were lost since the queue was made, up to the time at which this one was handed over.
    pub lost_rows: u32,
    /// The buffer with its pixels, or its edge points.
    pub content: B,
}

impl<B, const N: usize> RowQueue<B, N> {
    /// Without any buffer.
    #[must_use]
    pub const fn new() -> Self {
        Self { full: Queue::new(), empty: Queue::new() }
    }

    /// The two ends.
    pub const fn split(&mut self) -> (RowSender<'_, B>, RowReceiver<'_, B>) {
        let ((full, rows), (back, empty)) = (self.full.split_const(), self.empty.split_const());
        (RowSender { full, empty, frame: 0, row: 0, lost_rows: 0 }, RowReceiver { rows, back })
    }
}

impl<B, const N: usize> Default for RowQueue<B, N> {
    fn default() -> Self {
        Self::new()
    }
}

/// The interrupt's end.
pub struct RowSender<'q, B> {
    full: Producer<'q, SentRow<B>>,
    empty: Consumer<'q, B>,
    frame: u32,
    row: u16,
    lost_rows: u32,
}

impl<B> RowSender<'_, B> {
    /// Takes the next row of the frame and gives a buffer for the one after it: another one, or the same where there is
    /// no other. The row is then lost.
    #[must_use]
    pub fn hand_over(&mut self, content: B) -> B {
        let row = self.row;
        self.row = row.saturating_add(1);
        let spare = if self.full.ready() { self.empty.dequeue() } else { None };
        let Some(spare) = spare else {
            self.lost_rows = self.lost_rows.saturating_add(1);
            return content;
        };
        let sent = SentRow { frame: self.frame, row, lost_rows: self.lost_rows, content };
        match self.full.enqueue(sent) {
            Ok(()) => spare,
            // There was room, and nobody else enqueues.
            Err(refused) => refused.content,
        }
    }

    /// The next row is the first of another frame.
    pub fn end_frame(&mut self) {
        self.frame = self.frame.wrapping_add(1);
        self.row = 0;
    }

    /// Rows that were lost since the queue was made.
    #[must_use]
    pub const fn lost_rows(&self) -> u32 {
        self.lost_rows
    }
}

/// The main loop's end.
pub struct RowReceiver<'q, B> {
    rows: Consumer<'q, SentRow<B>>,
    back: Producer<'q, B>,
}

impl<B> RowReceiver<'_, B> {
    /// The next row, if there is one: give its buffer back.
    #[expect(clippy::should_implement_trait, reason = "a row that is not there yet is not the end")]
    pub fn next(&mut self) -> Option<SentRow<B>> {
        self.rows.dequeue()
    }

    /// Gives a buffer back, or a new one in.
    ///
    /// *Errors*: there are as many as the queue holds.
    pub fn give_back(&mut self, buffer: B) -> Result<(), B> {
        self.back.enqueue(buffer)
    }
}
