//! `cargo xtask budget`: measures, and writes or checks `docs/budget.csv`.

use std::collections::BTreeSet;
use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::{Args, ValueEnum};

use crate::board::{BackEnd, Board, Opt};
use crate::document;
use crate::figure::{self, Figure};
use crate::firmware::{Firmware, root};
use crate::uses::USES;
use crate::worst;

/// A figure that has grown by more than this share is a change that the table must tell.
const TOLERANCE: f64 = 0.02;

/// Measures instructions, flash, RAM and stack on emulated boards, and writes docs/budget.csv and docs/budget.md.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Only this board (several times for several)
    #[arg(long)]
    board: Vec<Board>,
    /// Only this number type (without: those that one would choose on the board)
    #[arg(long)]
    backend: Vec<BackEnd>,
    /// Only this optimisation
    #[arg(long)]
    opt: Vec<Opt>,
    /// Only this use, such as "two bars" or "line worst"
    #[arg(long = "use")]
    of: Vec<String>,
    /// Print and write nothing
    #[arg(long)]
    print: bool,
    /// Measure what CI checks, and fail where a figure is more than 2 % above the table; write nothing
    #[arg(long)]
    check: bool,
    /// Search the dearest rows anew (minutes), into xtask/worst_rows.csv
    #[arg(long)]
    search: bool,
}

/// What CI measures.
const CHECKED: [(Board, BackEnd); 3] =
    [(Board::M4F, BackEnd::F32), (Board::M0, BackEnd::Fixed), (Board::M0, BackEnd::F32)];

fn csv_path() -> PathBuf {
    root().join("docs/budget.csv")
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    if arguments.search {
        return worst::search(&Firmware::build(Board::M4F, Some(BackEnd::F32), Opt::Speed, &["rows"])?);
    }
    if let Some(name) = arguments.of.iter().find(|name| !USES.iter().any(|of| of.is_named(name))) {
        let names: Vec<_> = USES.iter().map(|of| of.name).collect();
        bail!("no use is called \"{name}\", but {}", names.join(", "));
    }
    let mut grown = 0;
    for (board, backend, opt) in configurations(arguments) {
        let measured = measure(arguments, board, backend, opt)?;
        if arguments.check {
            grown += count_grown(&measured)?;
        } else if !arguments.print {
            write(measured)?;
        }
    }
    if grown > 0 {
        bail!(
            "{grown} figures are above the table: make them smaller, or run `cargo xtask budget` and commit the table, too"
        );
    }
    Ok(())
}

/// What the arguments ask for.
fn configurations(arguments: &Arguments) -> Vec<(Board, BackEnd, Opt)> {
    let mut all = Vec::new();
    for opt in chosen(&arguments.opt, if arguments.check { &[Opt::Speed] } else { Opt::value_variants() }) {
        for board in chosen(&arguments.board, Board::value_variants()) {
            for backend in chosen(&arguments.backend, board.back_ends()) {
                if !arguments.check || CHECKED.contains(&(board, backend)) {
                    all.push((board, backend, opt));
                }
            }
        }
    }
    all
}

fn chosen<T: Copy>(asked: &[T], all: &[T]) -> Vec<T> {
    if asked.is_empty() { all.to_vec() } else { asked.to_vec() }
}

fn measure(arguments: &Arguments, board: Board, backend: BackEnd, opt: Opt) -> Result<Vec<Figure>> {
    let asked = |name: &&crate::uses::Use| {
        let named = arguments.of.is_empty() || arguments.of.iter().any(|of| name.is_named(of));
        named && (name.solves || backend == BackEnd::F32)
    };
    let uses: Vec<_> = USES.iter().filter(asked).collect();
    if uses.is_empty() {
        return Ok(Vec::new());
    }
    let programs: BTreeSet<_> = uses.iter().map(|of| of.program()).collect();
    let firmware = Firmware::build(board, Some(backend), opt, &programs.into_iter().collect::<Vec<_>>())?;
    let mut figures = Vec::new();
    for of in uses {
        for (quantity, value) in of.measure(&firmware)? {
            let digits = if quantity == "instructions_per_pixel" { 2 } else { 0 };
            let value = format!("{value:.digits$}");
            println!("{board:4} {backend:5} {opt} {:18} {quantity:23} {value:>10}", of.name);
            figures.push(Figure { board, backend, opt, of: of.name.into(), quantity: quantity.into(), value });
        }
    }
    Ok(figures)
}

/// Puts the figures into the table.
fn write(measured: Vec<Figure>) -> Result<()> {
    let mut table = if csv_path().exists() { figure::read(&csv_path())? } else { Vec::new() };
    table.retain(|old| !measured.iter().any(|new| new.is_of_same(old)));
    table.extend(measured);
    let place = |figure: &Figure| USES.iter().position(|of| of.name == figure.of);
    table.retain(|figure| place(figure).is_some());
    table.sort_by_key(|figure| (figure.opt, figure.board, figure.backend, place(figure), figure.quantity.clone()));
    figure::write(&csv_path(), &table)?;
    document::write(&table)
}

/// Says which figures have grown beyond the table, or are not in it.
fn count_grown(measured: &[Figure]) -> Result<usize> {
    let table = figure::read(&csv_path())?;
    let of_table = |new: &Figure| table.iter().find(|old| old.is_of_same(new)).map_or(0.0, Figure::number);
    let has_grown = |new: &&Figure| new.number() > of_table(new) * (1.0 + TOLERANCE);
    let grown: Vec<_> = measured.iter().filter(has_grown).collect();
    for new in &grown {
        let Figure { board, backend, of, quantity, value, .. } = new;
        println!("above the table: {board} {backend} {of}: {quantity} is {value}, not {}", of_table(new));
    }
    Ok(grown.len())
}
