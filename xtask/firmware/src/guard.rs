//! A fault says so and ends the emulation, where it would loop for ever. After the stack has left its memory even that
//! faults: the core locks up, and the emulator stops.
#![allow(unsafe_code)]

use semihosting::sys::arm_compat::sys_writec;

#[cortex_m_rt::exception]
unsafe fn HardFault(_: &cortex_m_rt::ExceptionFrame) -> ! {
    b"the core has faulted\n".iter().for_each(|byte| sys_writec(*byte));
    semihosting::process::exit(70)
}
