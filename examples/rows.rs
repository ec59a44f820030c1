//! Rows come by an interrupt, 60 frames a second, and are ranged in the main loop as they come; then once more with a
//! main loop that is too slow on purpose, whose lost rows tear its frames.
//!
//! Board (emulated Cortex-M4F, 500 million instructions a second):
//! `BOARD_ICOUNT=shift=1,sleep=off cargo run --release --example rows --target thumbv7em-none-eabihf`
//! Prints what is in `rows.out`. On the desktop there is no such interrupt.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {
    println!("this example runs on the emulated board");
}

#[cfg(target_os = "none")]
mod on_board {
    use core::cell::RefCell;

    use cortex_m::interrupt::{self, Mutex};
    use cortex_m::peripheral::syst::SystClkSource;
    use cortex_m_rt::{entry, exception};

    use semihosting::{println as say, process};
    use shutter_range::hand_over::{RowQueue, RowReceiver, RowSender};
    use shutter_range::{Setup, Sigmas, SmallRanger, Twist};

    const COLUMNS: usize = 320;
    const ROWS: u16 = 240;
    /// With the blanking between frames.
    const LINES: u16 = 266;
    const FRAMES: u32 = 4;
    const FOCAL_PX: f32 = 300.0;
    const SPEED_M_S: f32 = 1.0;
    /// Of a clock of 25 MHz: 62.6 µs, 60.1 frames a second.
    const TICKS_PER_LINE: u32 = 1565;
    const LINE_NS: u64 = TICKS_PER_LINE as u64 * 40;

    type Buffer = &'static mut [u8; COLUMNS];
    type Sender = (RowSender<'static, Buffer>, Buffer);

    /// On its way to the interrupt, once.
    static SENDER: Mutex<RefCell<Option<Sender>>> = Mutex::new(RefCell::new(None));

    /// A dark post before a wall, by integers: what the DMA would have put into the buffer.
    fn expose(row: u16, pixels: &mut [u8; COLUMNS]) {
        // 1.5 m away: so many 1/256 px for each line.
        let shift_q8 =
            i32::from(row) * (256.0 * FOCAL_PX * SPEED_M_S / 1.5 * LINE_NS as f32 * 1e-9 * 256.0) as i32 / 256;
        let covered = |x_q8: i32, edge_q8: i32| (x_q8 - edge_q8 + 256).clamp(0, 512);
        for (pixel, x_q8) in pixels.iter_mut().zip((0..).step_by(256)) {
            let post = covered(x_q8, (140 << 8) + shift_q8) - covered(x_q8, (165 << 8) + shift_q8);
            // A little noise, which no estimator takes for an edge.
            *pixel = (190 - post * 120 / 512 + (x_q8 / 256 * 7 + i32::from(row) * 5) % 3) as u8;
        }
    }

    /// The end of a line.
    #[exception]
    fn SysTick() {
        static mut HERE: Option<Sender> = None;
        static mut LINE: u16 = 0;
        if HERE.is_none() {
            *HERE = interrupt::free(|token| SENDER.borrow(token).take());
        }
        let Some((mut sender, filling)) = HERE.take() else { return };
        let mut next = filling;
        if *LINE < ROWS {
            expose(*LINE, next);
            next = sender.hand_over(next);
        }
        *LINE += 1;
        if *LINE == LINES {
            *LINE = 0;
            sender.end_frame();
        }
        *HERE = Some((sender, next));
    }

    /// The frames so far, and what has become of their rows.
    struct Tally {
        frame: u32,
        rows: u32,
        lost_rows: u32,
    }

    /// Ends a frame, and tells what it has shown. There is time for that before the next one begins.
    fn finish(setup: &Setup<f32>, ranger: &mut SmallRanger, tally: &mut Tally) {
        let motion = Twist::level([-SPEED_M_S, 0.0, 0.0]).expect("a sound motion");
        let torn = if ranger.is_torn() || tally.rows < u32::from(ROWS) { ", torn" } else { "" };
        ranger.end_frame(setup);
        say!("frame {}: {} rows, {} lost so far{torn}", tally.frame, tally.rows, tally.lost_rows);
        while let Some(range) = ranger.next_range(setup, &motion) {
            let depth_m = range.depth(Sigmas(2.0)).estimate_m.map_or(0.0, |(depth_m, _)| depth_m);
            say!("  column {:.1}: {:?}, {depth_m:.2} m", range.column_at_first_row, range.status);
        }
        *tally = Tally { frame: tally.frame + 1, rows: 0, ..*tally };
    }

    /// Ranges some frames as they come, with so many instructions of other work for each row.
    fn range_frames(setup: &Setup<f32>, receiver: &mut RowReceiver<'static, Buffer>, until: u32, other_work: u32) {
        let mut ranger = const { SmallRanger::new() };
        let mut tally = Tally { frame: until - FRAMES, rows: 0, lost_rows: 0 };
        while tally.frame < until {
            let Some(sent) = receiver.next() else {
                cortex_m::asm::wfi();
                continue;
            };
            // The last rows of the frame before were lost.
            if sent.frame != tally.frame {
                finish(setup, &mut ranger, &mut tally);
            }
            tally = Tally { frame: sent.frame, rows: tally.rows + 1, lost_rows: sent.lost_rows };
            // A row that comes where another was due tears the frame.
            let _refused = ranger.row(setup, setup.readout().row_after(sent.row), &*sent.content);
            cortex_m::asm::delay(other_work);
            receiver.give_back(sent.content).expect("as many places as buffers");
            if sent.row == ROWS - 1 {
                finish(setup, &mut ranger, &mut tally);
            }
        }
    }

    #[entry]
    fn start() -> ! {
        static mut QUEUE: RowQueue<Buffer, 4> = RowQueue::new();
        static mut BUFFERS: [[u8; COLUMNS]; 4] = [[0; COLUMNS]; 4];
        let (sender, mut receiver) = QUEUE.split();
        let [filling, spare @ ..] = BUFFERS.each_mut();
        spare.into_iter().for_each(|buffer| receiver.give_back(buffer).expect("as many places as buffers"));
        interrupt::free(|token| SENDER.borrow(token).replace(Some((sender, filling))));

        let mut timer = cortex_m::Peripherals::take().expect("once").SYST;
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(TICKS_PER_LINE - 1);
        timer.clear_current();
        timer.enable_interrupt();
        timer.enable_counter();

        let setup = Setup::pinhole(COLUMNS as u16, ROWS, FOCAL_PX, u64::from(ROWS) * LINE_NS).expect("a sound setup");
        say!("in time:");
        range_frames(&setup, &mut receiver, FRAMES, 0);
        say!("too slow on purpose:");
        range_frames(&setup, &mut receiver, 2 * FRAMES, 60_000);
        process::exit(0)
    }
}
