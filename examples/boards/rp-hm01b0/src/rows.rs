//! [`Rows`]: one row after the other from the camera's pins, while the last one is being looked at.

use crate::board::dma::{CH0, Channel, single_buffer};
use crate::board::pio::{Buffers, PIO0, PIOBuilder, PIOExt, RESETS, Running, Rx, SM0, ShiftDirection, StateMachine};

/// Columns of the sensor's window.
pub(crate) const COLUMNS: usize = 324;

type Words = [u32; COLUMNS / 4];
type Fifo = Rx<(PIO0, SM0)>;
type Transfer = single_buffer::Transfer<Channel<CH0>, Fifo, &'static mut Words>;

pub(crate) enum RowError {
    /// It had come before anybody asked for it: pixels of the next one may be lost.
    Late,
}

/// PIO puts four pixels into a word, DMA the words of a row into one of two buffers.
pub(crate) struct Rows {
    machine: StateMachine<(PIO0, SM0), Running>,
    /// Only while a method works it is none.
    source: Option<Source>,
    /// The row that came last.
    row: Option<&'static mut Words>,
}

enum Source {
    Idle(Channel<CH0>, Fifo, &'static mut Words),
    Filling(Transfer),
}

impl Rows {
    /// Pixels at eight pins from `first` on; behind them are their clock, line valid and frame valid.
    pub(crate) fn new(pio: PIO0, first: u8, channel: Channel<CH0>, resets: &mut RESETS) -> Self {
        let program = ::pio::pio_asm!(
            ".wrap_target",
            "wait 0 gpio 16", // between two frames
            "wait 1 gpio 16",
            "pixel:",
            "wait 1 gpio 15", // in a row
            "wait 1 gpio 14",
            "in pins, 8",
            "wait 0 gpio 14",
            "jmp pixel",
            ".wrap",
        );
        let (mut pio, machine, ..) = pio.split(resets);
        let Ok(installed) = pio.install(&program.program) else { defmt::panic!("no room for the program") };
        let (machine, fifo, _) = PIOBuilder::from_installed_program(installed)
            .in_pin_base(first)
            .in_shift_direction(ShiftDirection::Right)
            .autopush(true)
            .push_threshold(32)
            .buffers(Buffers::OnlyRx)
            .build(machine);
        let buffers =
            (cortex_m::singleton!(: Words = [0; COLUMNS / 4]), cortex_m::singleton!(: Words = [0; COLUMNS / 4]));
        let (Some(first), Some(second)) = buffers else { defmt::panic!("two cameras") };
        let source = Some(Source::Idle(channel, fifo, first));
        Self { machine: machine.start(), source, row: Some(second) }
    }

    /// Gives up what has come, and waits for the next frame to begin.
    pub(crate) fn begin_frame(&mut self) {
        self.machine.restart();
        let idle = match self.source.take() {
            Some(Source::Filling(transfer)) => Some(transfer.abort()),
            Some(Source::Idle(channel, fifo, buffer)) => Some((channel, fifo, buffer)),
            None => None,
        };
        self.source = idle.map(|(channel, mut fifo, buffer)| {
            while fifo.read().is_some() {}
            Source::Filling(single_buffer::Config::new(channel, fifo, buffer).start())
        });
    }

    /// The next row; the one after it is taken in meanwhile.
    pub(crate) fn next(&mut self) -> Result<&[u8], RowError> {
        let (Some(Source::Filling(transfer)), Some(free)) = (self.source.take(), self.row.take()) else {
            defmt::panic!("no frame has begun");
        };
        let is_late = transfer.is_done();
        let (channel, fifo, full) = transfer.wait();
        self.source = Some(Source::Filling(single_buffer::Config::new(channel, fifo, free).start()));
        let row = self.row.insert(full);
        if is_late { Err(RowError::Late) } else { Ok(bytemuck::cast_slice(&row[..])) }
    }
}
