//! The run whose bits are the same everywhere: prints the digest of each of its parts, for each number type.
#![no_std]
#![no_main]

use core::fmt::Debug;

use budget_firmware::file;
use budget_job::digest;
use semihosting::println;
use shutter_range::{Micro, Q32, Scalar};

budget_firmware::program!(run);

fn run() {
    print::<f32>("f32");
    print::<f64>("f64");
    print::<Micro>("micro");
    print::<Q32>("fixed");
}

fn print<S: Scalar + Debug>(backend: &str) {
    for digest in digest::run::<S>(&mut file::open()) {
        println!("{backend} {digest:016x}");
    }
}
