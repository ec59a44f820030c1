//! A file without its `mod` line would silently never run.

#[test]
fn every_file_is_a_module_of_the_harness() {
    let listed = include_str!("main.rs");
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/host_tests");
    for entry in std::fs::read_dir(folder).expect("the folder of this file") {
        let name = entry.expect("a readable folder").file_name().into_string().expect("a plain name");
        if let Some(module) = name.strip_suffix(".rs").filter(|module| *module != "main") {
            assert!(listed.contains(&format!("\nmod {module};")), "host_tests/{name} has no mod line in main.rs");
        }
    }
}
