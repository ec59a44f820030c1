//! Instructions since a moment, exact to one: QEMU's virtual clock advances by a fixed time with each of them.

/// Counts instructions by ticks of the emulated clock, and knows how many make an instruction.
pub struct Counter {
    /// Ticks that [`KNOWN`] instructions take.
    ticks: u64,
    /// Ticks of reading the clock twice.
    empty: u32,
}

/// Instructions of the loop that calibrates: two in each of its passes.
const KNOWN: u64 = 2 * PASSES as u64;
const PASSES: u32 = 10_000;

impl Counter {
    /// Starts the clock and calibrates on a loop of known length.
    pub fn new() -> Self {
        clock::start();
        let began = clock::now();
        let empty = clock::now().wrapping_sub(began);
        let began = clock::now();
        clock::spin(PASSES);
        let short = clock::now().wrapping_sub(began);
        let began = clock::now();
        clock::spin(2 * PASSES);
        let long = clock::now().wrapping_sub(began);
        // What surrounds the loop falls out of the difference.
        Self { ticks: long.wrapping_sub(short).into(), empty }
    }

    /// Runs something; what it gives, and the instructions it took.
    #[inline(never)]
    pub fn count<T>(&self, run: impl FnOnce() -> T) -> (T, u64) {
        let began = clock::now();
        let result = core::hint::black_box(run());
        let ticks = clock::now().wrapping_sub(began).saturating_sub(self.empty);
        (result, (u64::from(ticks) * KNOWN + self.ticks / 2) / self.ticks)
    }
}

impl Default for Counter {
    fn default() -> Self {
        Self::new()
    }
}

/// A timer of the CMSDK, which counts down.
#[cfg(target_arch = "arm")]
#[allow(unsafe_code)]
mod clock {
    use core::arch::asm;

    /// The an505 (M33, with its main extension and TrustZone) has it in its secure world.
    #[cfg(armv8m)]
    const TIMER: *mut u32 = 0x5000_0000 as *mut u32;
    #[cfg(not(armv8m))]
    const TIMER: *mut u32 = 0x4000_0000 as *mut u32;

    pub(super) fn start() {
        // SAFETY: control, value and reload of the board's timer, which nothing else uses.
        unsafe {
            TIMER.add(2).write_volatile(u32::MAX);
            TIMER.add(1).write_volatile(u32::MAX);
            TIMER.write_volatile(1);
        }
    }

    #[inline(always)]
    pub(super) fn now() -> u32 {
        // SAFETY: the value of the board's timer; reading it changes nothing.
        !unsafe { TIMER.add(1).read_volatile() }
    }

    #[inline(never)]
    pub(super) fn spin(passes: u32) {
        // SAFETY: a loop of two instructions on one register.
        unsafe { asm!("2:", "subs {0}, #1", "bne 2b", inout(reg) passes => _, options(nomem, nostack)) }
    }
}

/// The counter of retired instructions.
#[cfg(target_arch = "riscv32")]
#[allow(unsafe_code)]
mod clock {
    use core::arch::asm;

    pub(super) fn start() {}

    #[inline(always)]
    pub(super) fn now() -> u32 {
        let instructions;
        // SAFETY: reading this counter changes nothing.
        unsafe { asm!("csrr {0}, minstret", out(reg) instructions, options(nostack)) }
        instructions
    }

    #[inline(never)]
    pub(super) fn spin(passes: u32) {
        // SAFETY: a loop of two instructions on one register.
        unsafe { asm!("2:", "addi {0}, {0}, -1", "bnez {0}, 2b", inout(reg) passes => _, options(nomem, nostack)) }
    }
}
