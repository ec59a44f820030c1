//! [`Firmware`]: the measuring programs, built for one board and run on it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail, ensure};
use object::{Object, ObjectSection, ObjectSymbol};

use crate::board::{BackEnd, Board, Opt};
use crate::job::Job;

/// A program that hangs is ended after this.
const SECONDS: &str = "120";

/// Routines for floating-point numbers on cores that do not calculate with them, as the compiler's library has them.
const OF_SINGLES: [&str; 8] =
    ["__addsf3", "__subsf3", "__mulsf3", "__divsf3", "__floatsisf", "__floatdisf", "__fixsfsi", "__fixsfdi"];
const OF_DOUBLES: [&str; 8] =
    ["__adddf3", "__subdf3", "__muldf3", "__divdf3", "__extendsfdf2", "__truncdfsf2", "__floatsidf", "__fixdfsi"];

/// Of lenses with distortion.
const OF_LENSES: [&str; 1] = ["undistort"];

/// The programs of `xtask/firmware`, linked for a board, a back end or all of them, and an optimisation.
pub(crate) struct Firmware {
    board: Board,
    backend: Option<BackEnd>,
    programs: PathBuf,
}

/// What a linked program takes.
pub(crate) struct Size {
    pub(crate) flash: u64,
    pub(crate) ram: u64,
}

pub(crate) fn root() -> PathBuf {
    let mut root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    root.pop();
    root
}

/// The feature that chooses a back end, or all of them.
fn feature(backend: Option<BackEnd>) -> String {
    backend.map_or_else(|| "all".into(), |backend| backend.to_string())
}

impl Firmware {
    /// Builds these programs, for all back ends where none is given.
    pub(crate) fn build(board: Board, backend: Option<BackEnd>, opt: Opt, programs: &[&str]) -> Result<Self> {
        let root = root();
        let directory = root.join("target/bare").join(board.cpu().unwrap_or_default());
        let mut cargo = Command::new(root.join(".ci/bare"));
        cargo.args(["build", "--quiet", "--release", "--locked", "--manifest-path", "xtask/firmware/Cargo.toml"]);
        let mut features = feature(backend);
        if let Some(map) = board.map() {
            // Where memory is short, a fault is to be a message.
            cargo.env("MEMORY_MAP", map);
            features += ",guard";
        }
        cargo.args(["--features", &features, "--target", board.target()]);
        programs.iter().for_each(|program| {
            cargo.args(["--bin", program]);
        });
        cargo.arg("--target-dir").arg(&directory);
        if let Some(cpu) = board.cpu() {
            let target = board.target();
            cargo.arg("--config").arg(format!(r#"target.{target}.rustflags = ["-C", "target-cpu={cpu}"]"#));
        }
        cargo.env("CARGO_PROFILE_RELEASE_OPT_LEVEL", opt.to_string()).current_dir(&root);
        let status = cargo.status().context(".ci/bare")?;
        ensure!(status.success(), "the firmware for {board} with {features} does not build");
        Ok(Self { board, backend, programs: directory.join(board.target()).join("release") })
    }

    /// Runs a program with a job; what it prints, line by line and word by word.
    pub(crate) fn run(&self, program: &str, job: &Job) -> Result<Vec<Vec<String>>> {
        let directory = root().join("target/budget").join(format!("{}-{program}", self.board));
        fs::create_dir_all(&directory)?;
        fs::write(directory.join("job"), job.bytes())?;
        let (qemu, machine) = self.board.qemu().split_first().context("a program")?;
        let output = Command::new("timeout")
            .args([SECONDS, qemu])
            .args(machine)
            .args(["-nographic", "-semihosting-config", "enable=on,target=native", "-kernel"])
            .arg(self.program(program))
            .current_dir(&directory)
            .stdin(Stdio::null())
            .output()
            .context(*qemu)?;
        // Characters one by one go to the console of QEMU, its standard error.
        let text = String::from_utf8_lossy(&output.stdout) + String::from_utf8_lossy(&output.stderr);
        match output.status.code() {
            Some(0) => {}
            Some(124) => bail!("{program} on {}: no end within {SECONDS} s\n{text}", self.board),
            Some(134) => {
                bail!("{program} on {}: the core has locked up: too little RAM for the stack\n{text}", self.board)
            }
            _ => bail!("{program} on {}: {}\n{text}", self.board, output.status),
        }
        Ok(text.lines().map(|line| line.split(' ').map(str::to_owned).collect()).collect())
    }

    /// Flash: what is loaded; RAM: what is writable, without the stack.
    pub(crate) fn size(&self, program: &str) -> Result<Size> {
        let path = self.program(program);
        let data = fs::read(&path).with_context(|| path.display().to_string())?;
        let elf = object::File::parse(&*data)?;
        let mut size = Size { flash: 0, ram: 0 };
        for section in elf.sections() {
            let object::SectionFlags::Elf { sh_flags } = section.flags() else { continue };
            if sh_flags & u64::from(object::elf::SHF_ALLOC) == 0 || section.name()? == ".stack" {
                continue;
            }
            let in_file = section.kind() != object::SectionKind::UninitializedData;
            size.flash += if in_file { section.size() } else { 0 };
            size.ram += if sh_flags & u64::from(object::elf::SHF_WRITE) == 0 { 0 } else { section.size() };
        }
        ensure!(size.flash > 1000, "{}: the program is empty", path.display());
        Ok(size)
    }

    /// Refuses a program that holds what it does not use: arithmetic of another number type than its own, doubles in
    /// single precision and any floating point in fixed point, and what only a lens with distortion needs.
    pub(crate) fn ensure_nothing_foreign(&self, program: &str) -> Result<()> {
        let foreign: &[&[&str]] = match self.backend {
            Some(BackEnd::F32 | BackEnd::Micro) => &[&OF_DOUBLES, &OF_LENSES],
            Some(BackEnd::Fixed) => &[&OF_SINGLES, &OF_DOUBLES, &OF_LENSES],
            Some(BackEnd::F64) | None => &[&OF_LENSES],
        };
        let path = self.program(program);
        let data = fs::read(&path).with_context(|| path.display().to_string())?;
        let elf = object::File::parse(&*data)?;
        let mut names = elf.symbols().filter_map(|symbol| symbol.name().ok()).peekable();
        ensure!(names.peek().is_some(), "{}: no symbols to check", path.display());
        let found = names.find(|name| foreign.iter().flat_map(|of| of.iter()).any(|routine| name.contains(routine)));
        ensure!(found.is_none(), "{program} in {} holds {}", feature(self.backend), found.unwrap_or_default());
        Ok(())
    }

    fn program(&self, name: &str) -> PathBuf {
        Path::new(&self.programs).join(name)
    }
}
