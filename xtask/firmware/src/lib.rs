//! What the programs for the boards share: an exact counter of instructions, a painted stack, and the job that the host
//! has written.
#![no_std]
#![deny(unsafe_code)]

pub mod counter;
pub mod file;
pub mod frames;
#[cfg(all(feature = "guard", target_arch = "arm"))]
mod guard;
pub mod small;
pub mod stack;

/// Makes `main` the program that is called after reset; its return ends the emulation.
#[macro_export]
macro_rules! program {
    ($main:path) => {
        #[cfg(target_arch = "arm")]
        use cortex_m_rt::entry;
        #[cfg(target_arch = "riscv32")]
        use riscv_rt::entry;

        #[entry]
        fn start() -> ! {
            $main();
            semihosting::process::exit(0)
        }
    };
}

/// The same with tables in memory that is zeroed at reset, and a measured stack.
#[macro_export]
macro_rules! small_program {
    ($main:path) => {
        $crate::small_program!($main, $crate::small::Tables, new);
    };
    ($main:path, $tables:ty, $new:ident) => {
        #[cfg(target_arch = "arm")]
        use cortex_m_rt::entry;
        #[cfg(target_arch = "riscv32")]
        use riscv_rt::entry;

        #[entry]
        fn start() -> ! {
            static mut TABLES: $tables = <$tables>::$new();
            #[cfg(target_arch = "arm")]
            let tables = TABLES;
            // The entry of this core hands no static over; there is no other use of it.
            #[cfg(target_arch = "riscv32")]
            let tables = unsafe { &mut *(&raw mut TABLES) };
            $crate::small::measure(|| $main(tables))
        }
    };
}

/// The number type that is measured.
#[cfg(any(feature = "f32", not(any(feature = "f64", feature = "micro", feature = "fixed"))))]
pub type Number = f32;
#[cfg(all(feature = "f64", not(feature = "f32")))]
pub type Number = f64;
#[cfg(all(feature = "micro", not(any(feature = "f32", feature = "f64"))))]
pub type Number = shutter_range::Micro;
#[cfg(all(feature = "fixed", not(any(feature = "f32", feature = "f64", feature = "micro"))))]
pub type Number = shutter_range::Q32;
