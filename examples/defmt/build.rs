//! What the linker needs beside the repository's `-Tlink.x`: the repository's memory.x, and defmt's script. In `rustflags`
//! it would make `core` another one than that of all other programs.
fn main() {
    println!("cargo:rustc-link-search=../..");
    println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
    println!("cargo:rerun-if-changed=build.rs");
}
