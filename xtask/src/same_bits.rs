//! `cargo xtask same-bits`: one fixed run gives the same bits on the desktop and on every board.

use std::fs;

use anyhow::{Result, ensure};
use budget_job::digest::{self, PARTS};
use clap::{Args, ValueEnum};
use rand::SeedableRng;
use rand::rngs::StdRng;
use serde::Deserialize;
use shutter_range::{EdgePoint, Micro, Polarity, Q32};

use crate::board::{BackEnd, Board, Opt};
use crate::firmware::{Firmware, root};
use crate::job::{Job, Motion, Rig};
use crate::points::{Drive, Edge};
use crate::uses::{TURNING, points_of_row, row_by_row};

/// Compares the digests of a fixed run: frames of the simulator, reference edges, a sequence, a trajectory.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Only this board (several times for several); the desktop is always one
    #[arg(long)]
    board: Vec<Board>,
    /// No board: prints what the desktop gives
    #[arg(long)]
    desktop: bool,
    /// Only this number type
    #[arg(long)]
    backend: Vec<BackEnd>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let chosen = |board: &&Board| !arguments.desktop && (arguments.board.is_empty() || arguments.board.contains(board));
    let job = job()?;
    let boards: Vec<_> = Board::value_variants().iter().filter(chosen).collect();
    let on_boards: Vec<_> = boards.iter().map(|board| on_board(**board, &job)).collect::<Result<_>>()?;
    let mut differing = 0;
    for backend in BackEnd::value_variants() {
        if !arguments.backend.is_empty() && !arguments.backend.contains(backend) {
            continue;
        }
        let desktop = on_desktop(*backend, &job).map(|digest| format!("{digest:016x}"));
        println!("{backend:5} desktop {}", desktop.join(" "));
        for (board, told) in boards.iter().zip(&on_boards) {
            let of_backend = told.iter().filter(|words| words.first() == Some(&backend.to_string()));
            let digests: Vec<_> = of_backend.filter_map(|words| words.get(1).cloned()).collect();
            let same = desktop.as_slice() == digests;
            println!("{backend:5} {board:7} {}", if same { "the same".into() } else { digests.join(" ") });
            differing += u8::from(!same);
        }
    }
    ensure!(differing == 0, "{differing} boards give other bits than the desktop, in the order of {PARTS:?}");
    Ok(())
}

fn on_desktop(backend: BackEnd, job: &Job) -> [u64; PARTS.len()] {
    let mut job = budget_job::job::Job(job.bytes());
    match backend {
        BackEnd::F32 => digest::run::<f32>(&mut job),
        BackEnd::F64 => digest::run::<f64>(&mut job),
        BackEnd::Micro => digest::run::<Micro>(&mut job),
        BackEnd::Fixed => digest::run::<Q32>(&mut job),
    }
}

/// Digests, each after its back end.
fn on_board(board: Board, job: &Job) -> Result<Vec<Vec<String>>> {
    Firmware::build(board, None, Opt::Speed, &["same_bits"])?.run("same_bits", job)
}

#[derive(Deserialize)]
struct ReferenceEdge {
    camera: ReferenceCamera,
    velocity_m_s: [f64; 3],
    rate_rad_s: [f64; 3],
    gravity: [f64; 3],
    rows: Vec<u16>,
    columns: Vec<f64>,
}

#[derive(Deserialize)]
struct ReferenceCamera {
    cols: u16,
    rows: u16,
    fx: f64,
    cx: f64,
    cy: f64,
    readout_s: f64,
}

/// What [`digest::run`] reads.
fn job() -> Result<Job> {
    let mut job = Job::default();
    reference_edges(&mut job)?;
    sequence(&mut job);
    trajectory(&mut job);
    Ok(job)
}

fn reference_edges(job: &mut Job) -> Result<()> {
    let text = fs::read_to_string(root().join("host_tests/data/lines.json"))?;
    let edges: Vec<ReferenceEdge> = serde_json::from_str(&text)?;
    job.count(edges.len());
    for edge in &edges {
        let camera = &edge.camera;
        let rig = Rig {
            columns: camera.cols,
            rows: camera.rows,
            readout_ns: (camera.readout_s * 1e9).round() as i64,
            focal_px: camera.fx,
            centre_px: [camera.cx, camera.cy],
            ..Rig::QVGA
        };
        let point = |(row, column): (&u16, &f64)| {
            let time_ns = (rig.row_time_s(*row) * 1e9).round() as i64;
            EdgePoint::new(*row, (column * 65536.0).round() as i32, time_ns)
        };
        job.rig(&rig);
        let &ReferenceEdge { velocity_m_s, rate_rad_s, gravity, .. } = edge;
        job.motion(&Motion { velocity_m_s, rate_rad_s, gravity });
        job.line(&edge.rows.iter().zip(&edge.columns).map(point).collect::<Vec<_>>());
    }
    Ok(())
}

fn sequence(job: &mut Job) {
    const FRAMES: u16 = 3;
    let drive = Drive { motion: TURNING, frame_s: 0.0333 };
    let rig = Rig { sigmas: [0.001_745, 0.0035, 0.02, 0.01, 0.01, 0.000_1, 0.01], ..Rig::QVGA };
    job.rig(&rig);
    job.motion(&drive.motion);
    job.u16(FRAMES);
    for frame in 0..FRAMES {
        row_by_row(job, &rig, &points_of_row(&rig, &drive, frame, 6));
        job.motion(&drive.motion_of(frame + 1));
    }
}

fn trajectory(job: &mut Job) {
    const LINES: u16 = 4;
    let rig = Rig { distortion: [-0.28, 0.07, 0.000_5, -0.000_3, 0.0], ..Rig::QVGA };
    let drive = Drive { motion: TURNING, frame_s: 0.0333 };
    job.rig(&rig);
    job.u16(LINES);
    for k in 0..LINES {
        let mut random = StdRng::seed_from_u64(k.into());
        let edge = Edge { bearing: 0.15 * f64::from(k) - 0.2, depth_m: 1.0 + f64::from(k), polarity: Polarity::Rising };
        job.line(&edge.points(&rig, &drive, 0, &mut random));
    }
}
