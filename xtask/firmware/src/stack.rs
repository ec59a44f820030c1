//! How deep the stack has grown: the free part is painted, and later searched for the deepest word that has changed.
#![allow(unsafe_code)]

const PAINT: u32 = 0xa5c3_96e1;

/// A painted part of the stack, below the caller.
pub struct Painted {
    /// Where the caller's frame was.
    top: usize,
    bottom: usize,
}

impl Painted {
    /// Left alone, for the frames of the functions here.
    const OWN: usize = 256;

    /// Paints so many bytes below the caller.
    #[inline(never)]
    pub fn below(bytes: usize) -> Self {
        let marker = 0_u32;
        let top = core::hint::black_box(&raw const marker) as usize;
        let bottom = top.saturating_sub(bytes) & !3;
        let mut at = bottom;
        while at < top - Self::OWN {
            // SAFETY: free stack: the map leaves the caller more of it than it asks for, and nothing lives below its
            // frame.
            unsafe { (at as *mut u32).write_volatile(PAINT) };
            at += 4;
        }
        Self { top, bottom }
    }

    /// Bytes of stack that were used since, to 256 where it was fewer.
    #[inline(never)]
    pub fn used(&self) -> usize {
        let mut at = self.bottom;
        // SAFETY: as above.
        while at < self.top - Self::OWN && unsafe { (at as *const u32).read_volatile() } == PAINT {
            at += 4;
        }
        self.top - at
    }
}

/// Bytes between the top of the stack and the caller.
#[inline(never)]
pub fn above() -> usize {
    unsafe extern "C" {
        static _stack_start: u32;
    }
    let marker = 0_u32;
    (&raw const _stack_start as usize).saturating_sub(core::hint::black_box(&raw const marker) as usize)
}

/// Bytes between the caller and the end of what the map leaves for the stack.
#[inline(never)]
pub fn free() -> usize {
    #[cfg(target_arch = "arm")]
    {
        unsafe extern "C" {
            static _stack_end: u32;
        }
        let marker = 0_u32;
        let above_end = core::hint::black_box(&raw const marker) as usize - &raw const _stack_end as usize;
        // The caller's other calls stand a little lower.
        above_end.saturating_sub(Painted::OWN)
    }
    // virt has more than any program takes
    #[cfg(target_arch = "riscv32")]
    {
        1 << 20
    }
}
