//! Gives the linker the memory map of the board.

use std::path::PathBuf;
use std::{env, fs};

fn main() {
    let target = env::var("TARGET").expect("set by cargo");
    let map = match target.as_str() {
        _ if env::var("MEMORY_MAP").is_ok_and(|name| name == "microbit") => "memory/microbit.x",
        "thumbv8m.main-none-eabihf" => "memory/an505.x",
        target if target.starts_with("riscv32") => "memory/virt.x",
        _ => "memory/mps2.x",
    };
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("set by cargo"));
    fs::copy(map, out.join("memory.x")).expect("the map of the board");
    println!("cargo:rustc-link-search={}", out.display());
    if target.starts_with("riscv32") {
        // for Arm the repository's .cargo/config.toml says it
        println!("cargo:rustc-link-arg-bins=-Tmemory.x");
        println!("cargo:rustc-link-arg-bins=-Tlink.x");
    }
    println!("cargo:rustc-check-cfg=cfg(armv8m)");
    if target.starts_with("thumbv8m") {
        println!("cargo:rustc-cfg=armv8m");
    }
    println!("cargo:rerun-if-changed=memory");
    println!("cargo:rerun-if-env-changed=MEMORY_MAP");
    println!("cargo:rerun-if-changed=build.rs");
}
