//! A folder for input files and a way to run the tool in it.

use std::fs::{self, File};
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use tempfile::TempDir;

/// 640 × 480, to the left at 1.5 m/s, everything exact but the edges' 0.1 px.
pub(crate) const SETUP: &str = "\
[camera]
columns = 640
rows = 480
fx = 600
readout_s = 0.0333
sigma_readout = 0
sigma_focal = 0
edge_roughness_px = 0
[motion]
velocity_m_s = [-1.5, 0, 0]
sigma_speed = 0
[attitude]
sigma_tilt_deg = 0
";

/// Where [`SETUP`] sees an edge of this bearing and depth.
pub(crate) fn column(bearing: f64, depth_m: f64, row: u32) -> f64 {
    319.5 + 600.0 * (bearing + 1.5 / depth_m * f64::from(row) * 0.0333 / 480.0)
}

pub(crate) struct Folder(TempDir);

pub(crate) struct Outcome {
    pub(crate) code: i32,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Folder {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    pub(crate) fn with(self, name: &str, content: impl AsRef<[u8]>) -> Self {
        fs::write(self.0.path().join(name), content).expect("writing an input file");
        self
    }

    pub(crate) fn path(&self) -> &Path {
        self.0.path()
    }

    /// Makes a folder inside.
    pub(crate) fn make(&self, name: &str) {
        fs::create_dir_all(self.path().join(name)).expect("making a folder");
    }

    /// Makes a symbolic link inside; `to` is a path as seen from here.
    pub(crate) fn link(&self, to: &str, name: &str) {
        std::os::unix::fs::symlink(to, self.path().join(name)).expect("making a link");
    }

    pub(crate) fn hard_link(&self, to: &str, name: &str) {
        fs::hard_link(self.path().join(to), self.path().join(name)).expect("making a link");
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.0.path().join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// Names of all its files, sorted.
    pub(crate) fn files(&self) -> Vec<String> {
        self.files_of(".")
    }

    pub(crate) fn files_of(&self, folder: &str) -> Vec<String> {
        let entries = fs::read_dir(self.0.path().join(folder)).expect("a folder");
        let mut names: Vec<_> = entries.map(|entry| entry.expect("an entry").file_name()).collect();
        names.sort();
        names.into_iter().map(|name| name.into_string().expect("UTF-8")).collect()
    }

    /// A folder with `setup.toml` and `edges.csv`.
    pub(crate) fn of(setup: &str, edges: &str) -> Self {
        Self::new().with("setup.toml", setup).with("edges.csv", edges)
    }

    pub(crate) fn run(&self, arguments: &[&str]) -> Outcome {
        self.run_with_input(arguments, "")
    }

    pub(crate) fn run_with_input(&self, arguments: &[&str], input: &str) -> Outcome {
        self.run_with_bytes(arguments, input.as_bytes())
    }

    pub(crate) fn run_with_bytes(&self, arguments: &[&str], input: &[u8]) -> Outcome {
        let mut child = command(self.0.path(), arguments).spawn().expect("the tool starts");
        let mut pipe = child.stdin.take().expect("a pipe");
        let input = input.to_vec();
        // Beside it, since a tool that also writes much would wait for its reader. One that stops early closes its end.
        let writer = std::thread::spawn(move || pipe.write_all(&input).is_ok());
        let output = child.wait_with_output().expect("the tool ends");
        writer.join().expect("no panic");
        Outcome::new(output)
    }

    pub(crate) fn run_with_input_from(&self, input: File, arguments: &[&str]) -> Outcome {
        Outcome::new(command(self.0.path(), arguments).stdin(input).output().expect("the tool ends"))
    }

    pub(crate) fn run_with_output_to(&self, path: &str, arguments: &[&str]) -> Outcome {
        let output = File::options().write(true).open(path).expect("a place for the output");
        Outcome::new(command(self.0.path(), arguments).stdout(output).output().expect("the tool ends"))
    }

    /// Runs the tool where no file may have more than so many blocks of 512 bytes.
    pub(crate) fn run_with_file_limit(&self, blocks: &str, arguments: &[&str]) -> Outcome {
        // The signal would end the tool before the error reaches it.
        let script = "trap '' XFSZ; ulimit -f \"$0\"; exec \"$@\"";
        let mut shell = Command::new("sh");
        shell.args(["-c", script, blocks, env!("CARGO_BIN_EXE_shutter-range")]).args(arguments);
        Outcome::new(shell.current_dir(self.0.path()).output().expect("the tool ends"))
    }

    pub(crate) fn edges(&self) -> Outcome {
        self.run(&["edges", "edges.csv", "--setup", "setup.toml"])
    }

    /// The document of `edges --json`.
    pub(crate) fn document(&self) -> Value {
        self.run(&["edges", "edges.csv", "--setup", "setup.toml", "--json"]).json()
    }

    /// The ranges of its only frame.
    pub(crate) fn ranges(&self) -> Vec<Value> {
        let document = self.document();
        let frames = document["frames"].as_array().expect("frames");
        assert_eq!(frames.len(), 1, "{document}");
        frames[0]["ranges"].as_array().expect("ranges").clone()
    }
}

pub(crate) fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_shutter-range"));
    command.args(arguments).current_dir(folder);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

impl Outcome {
    pub(crate) fn new(output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
        let code = output.status.code().expect("no signal");
        Self { code, stdout: text(output.stdout), stderr: text(output.stderr) }
    }

    pub(crate) fn json(&self) -> Value {
        assert_eq!((self.code, self.stderr.as_str()), (0, ""));
        self.document()
    }

    /// The document of a run that may have failed for some frames.
    pub(crate) fn document(&self) -> Value {
        let document: Value = serde_json::from_str(&self.stdout).expect("one JSON document");
        for frame in document["frames"].as_array().into_iter().flatten().filter(|frame| frame["edges"].is_u64()) {
            assert_counts_add_up(frame);
        }
        document
    }
}

/// Every edge point belongs to a range, or is stray, or was dropped.
#[track_caller]
fn assert_counts_add_up(frame: &Value) {
    let ranges = frame["ranges"].as_array().expect("ranges");
    let in_ranges: f64 = ranges.iter().map(|range| number(range, "edges")).sum();
    let elsewhere = number(frame, "stray_edges") + number(frame, "dropped_edges");
    assert_eq!(number(frame, "edges"), in_ranges + elsewhere, "{frame}");
}

pub(crate) fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("{key} is no number: {value}"))
}

#[track_caller]
pub(crate) fn assert_near(value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance, "{value} is not {expected} ± {tolerance}");
}
