//! The rooms of `src/` and `cli/src/` stand in the order of the data: a module imports only what is declared before it.
//!
//! The order is that of the `mod` lines: in `lib.rs` and `main.rs` for the rooms, in a room's `mod.rs` for its files. A
//! module that imports only what stands before it cannot be part of a cycle.

use std::fs;
use std::path::{Path, PathBuf};

/// The code of a file without comments and without its tests.
fn code(path: &Path) -> String {
    let text = fs::read_to_string(path).expect("a readable source file");
    let text = text.split("#[cfg(test)]\nmod ").next().unwrap_or_default().to_owned();
    text.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

/// The modules that a file declares, in its order.
fn declared(path: &Path) -> Vec<String> {
    let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    let module = |line: &str| match &words(line)[..] {
        [.., keyword, name] if keyword == "mod" => name.strip_suffix(';').map(str::to_owned),
        _ => None,
    };
    code(path).lines().filter_map(module).collect()
}

/// What follows each `keyword::` in the code, one entry for each name of a group: `use crate::{a::B, c}` gives `a` and
/// `c`.
fn first_segments(code: &str, keyword: &str) -> Vec<String> {
    let prefix = format!("{keyword}::");
    let mut segments = Vec::new();
    for (at, _) in code.match_indices(&prefix) {
        let before = code[..at].chars().next_back();
        if before.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == '$') {
            continue;
        }
        let rest = &code[at + prefix.len()..];
        match rest.strip_prefix('{') {
            Some(group) => segments.extend(names_of_group(group)),
            None => segments.push(identifier(rest)),
        }
    }
    segments
}

fn identifier(text: &str) -> String {
    text.trim_start().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
}

/// The first name of each entry of a group, whose opening brace has been read.
fn names_of_group(text: &str) -> Vec<String> {
    let (mut depth, mut entry, mut names) = (0, String::new(), Vec::new());
    for c in text.chars() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            ',' if depth == 0 => names.push(std::mem::take(&mut entry)),
            c => entry.push(c),
        }
    }
    names.push(entry);
    names.iter().map(|entry| identifier(entry)).filter(|name| !name.is_empty()).collect()
}

fn position(modules: &[String], name: &str) -> Option<usize> {
    modules.iter().position(|module| module == name)
}

fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("a readable folder");
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("a readable entry").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "rs"));
    paths.sort();
    paths
}

fn stem(path: &Path) -> String {
    path.file_stem().and_then(|stem| stem.to_str()).expect("a plain name").to_owned()
}

/// What breaks the rules in the file `path` of the module `own` of the crate.
fn breaches(path: &Path, rooms: &[String], own: &str) -> Vec<String> {
    let index = position(rooms, own).unwrap_or_else(|| panic!("{} is not declared", path.display()));
    let breach = |name: String| match position(rooms, &name) {
        None => Some(format!("{} imports `{name}` through the crate root", path.display())),
        Some(other) if other > index => Some(format!("{} imports `{name}`, which stands after it", path.display())),
        Some(other) if other == index => Some(format!("{} imports its own room by `crate::{name}`", path.display())),
        Some(_) => None,
    };
    first_segments(&code(path), "crate").into_iter().filter_map(breach).collect()
}

/// The same within a room: files import their siblings by `super`, and only those declared before them.
fn breaches_in_room(path: &Path, siblings: &[String]) -> Vec<String> {
    let index = position(siblings, &stem(path)).unwrap_or_else(|| panic!("{} is not declared", path.display()));
    let breach = |name: String| match position(siblings, &name) {
        None => Some(format!("{} imports `{name}` through its room", path.display())),
        Some(other) if other >= index => Some(format!("{} imports `{name}`, which stands after it", path.display())),
        Some(_) => None,
    };
    first_segments(&code(path), "super").into_iter().filter_map(breach).collect()
}

fn breaches_of_crate(root: &Path) -> Vec<String> {
    let folder = root.parent().expect("the folder of the crate root");
    let rooms = declared(root);
    assert!(rooms.len() > 4, "{}: {rooms:?}", root.display());
    let mut found = Vec::new();
    for room in &rooms {
        let (file, inside) = (folder.join(format!("{room}.rs")), folder.join(room));
        if file.exists() {
            found.extend(breaches(&file, &rooms, room));
            continue;
        }
        let siblings = declared(&inside.join("mod.rs"));
        for path in sources(&inside) {
            found.extend(breaches(&path, &rooms, room));
            if stem(&path) != "mod" {
                found.extend(breaches_in_room(&path, &siblings));
            }
        }
    }
    found
}

fn checkout() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn the_library_imports_only_what_stands_before() {
    assert_eq!(breaches_of_crate(&checkout().join("src/lib.rs")), Vec::<String>::new());
}

#[test]
fn the_tool_imports_only_what_stands_before() {
    assert_eq!(breaches_of_crate(&checkout().join("cli/src/main.rs")), Vec::<String>::new());
}

#[test]
fn the_reader_of_imports_sees_groups_and_inline_paths() {
    let code = "use crate::{edge::Scanner, line::{Line, Knot}, Ranger};\nlet x = crate::motion::f();\nmycrate::no();";
    assert_eq!(first_segments(code, "crate"), ["edge", "line", "Ranger", "motion"]);
    assert_eq!(first_segments("use super::knot::{A, B};", "super"), ["knot"]);
}
