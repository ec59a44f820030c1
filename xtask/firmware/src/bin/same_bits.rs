//! The run whose bits are the same everywhere: prints the digest of each of its parts.
#![no_std]
#![no_main]

use budget_firmware::{Number, file};
use budget_job::digest;
use semihosting::println;

budget_firmware::program!(run);

fn run() {
    let digests = digest::run::<Number>(&mut file::open());
    for (part, digest) in digest::PARTS.into_iter().zip(digests) {
        println!("{digest:016x} {part}");
    }
}
