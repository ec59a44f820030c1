//! The tables of `docs/budget.md` and the summary in the README, made from `docs/budget.csv` between two marks.

use std::fs;

use anyhow::{Context, Result};
use clap::ValueEnum;

use crate::board::{BackEnd, Board, Opt};
use crate::figure::Figure;
use crate::firmware::root;

const BEGIN: &str = "<!-- tables of budget.csv, made by the command -->\n";
const END: &str = "<!-- end of the tables -->\n";

/// Clocks in MHz of usual boards.
const CLOCKS_MHZ: [f64; 4] = [64.0, 133.0, 168.0, 480.0];
/// Cycles an instruction, from flash without waiting to flash that waits.
const CYCLES: [f64; 2] = [1.0, 1.5];
const QVGA_PIXELS: f64 = 320.0 * 240.0;

pub(crate) fn write(figures: &[Figure]) -> Result<()> {
    let table = Table(figures);
    let sections = [
        table.rows(),
        table.formats(),
        table.milliseconds(),
        table.solving(),
        table.sizes(Opt::Speed),
        table.sizes(Opt::Size),
    ];
    replace("docs/budget.md", &sections.join("\n"))?;
    replace("README.md", &table.summary())
}

/// Puts a text between the marks of a document.
fn replace(document: &str, tables: &str) -> Result<()> {
    let path = root().join(document);
    let text = fs::read_to_string(&path)?;
    let lost = || format!("{document} has lost a mark of its tables");
    let (before, rest) = text.split_once(BEGIN).with_context(lost)?;
    let (_, after) = rest.split_once(END).with_context(lost)?;
    fs::write(&path, format!("{before}{BEGIN}\n{tables}\n{END}{after}")).with_context(|| document.to_owned())
}

struct Table<'a>(&'a [Figure]);

impl Table<'_> {
    fn value(&self, board: Board, backend: BackEnd, opt: Opt, of: &str, quantity: &str) -> Option<f64> {
        let is_it = |figure: &&Figure| {
            let key = (figure.board, figure.backend, figure.opt) == (board, backend, opt);
            key && figure.of == of && figure.quantity == quantity
        };
        self.0.iter().find(is_it).map(Figure::number)
    }

    fn boards() -> impl Iterator<Item = Board> {
        Board::value_variants().iter().copied()
    }

    fn rows(&self) -> String {
        let uses = ["rows flat", "rows two bars", "rows five bars", "rows noise 12", "rows clutter", "rows fence"];
        let mut text = "Instructions a pixel of `Ranger::row`, QVGA, `Ranger<16, 16, 64>`, and the dearest row that a search finds:\n\n\
                        | board | flat | two bars | five bars | noise 12 | clutter | fence | dearest row | an edge point |\n\
                        |---|---|---|---|---|---|---|---|---|\n"
            .to_owned();
        for board in Self::boards() {
            let value = |of: &str, quantity: &str| self.value(board, BackEnd::F32, Opt::Speed, of, quantity);
            let mut cells: Vec<_> = uses.iter().map(|of| cell(value(of, "instructions_per_pixel"), 1)).collect();
            cells.push(cell(value("rows worst", "instructions_per_row"), 0));
            cells.push(cell(value("edge", "instructions"), 0));
            text += &line(&board.to_string(), &cells);
        }
        text
    }

    fn formats(&self) -> String {
        let uses = ["two bars", "compact", "two bars yuyv", "two bars rgb565le", "two bars gray10p", "two bars bayer8"];
        let mut text = "The same of the two bars in other pixel formats:\n\n\
                        | board | gray8 | compact | yuyv | rgb565le | gray10p | bayer8 |\n|---|---|---|---|---|---|---|\n"
            .to_owned();
        for board in Self::boards() {
            let value = |of: &str| self.value(board, BackEnd::F32, Opt::Speed, of, "instructions_per_pixel");
            text += &line(&board.to_string(), &uses.map(|of| cell(value(&format!("rows {of}")), 1)));
        }
        text
    }

    fn milliseconds(&self) -> String {
        let mut text =
            "Milliseconds for a QVGA frame of two bars, an estimate at 1.0 to 1.5 cycles an instruction:\n\n\
                        | board | 64 MHz | 133 MHz | 168 MHz | 480 MHz |\n|---|---|---|---|---|\n"
                .to_owned();
        for board in Self::boards() {
            let a_pixel = self.value(board, BackEnd::F32, Opt::Speed, "rows two bars", "instructions_per_pixel");
            let cells = CLOCKS_MHZ.map(|mhz| match a_pixel {
                Some(a_pixel) => {
                    let [least, most] = CYCLES.map(|cycles| a_pixel * QVGA_PIXELS * cycles / mhz / 1000.0);
                    format!("{least:.0}–{most:.0}")
                }
                None => "–".into(),
            });
            text += &line(&board.to_string(), &cells);
        }
        text
    }

    /// What matters for a choice, for the README.
    fn summary(&self) -> String {
        let mut text =
            "| core, number type | instructions a pixel, flat / two bars | a line | flash | statics + stack |\n\
                        |---|---|---|---|---|\n"
                .to_owned();
        for (board, backend) in Self::pairs() {
            let value = |backend, of: &str, quantity: &str| self.value(board, backend, Opt::Speed, of, quantity);
            let a_pixel = |of| cell(value(BackEnd::F32, of, "instructions_per_pixel"), 0);
            let kilobytes = |quantity| cell(value(backend, "pixels", quantity).map(|bytes| bytes / 1000.0), 1);
            if value(backend, "pixels", "flash_bytes").is_some() {
                let cells = [
                    format!("{} / {}", a_pixel("rows flat"), a_pixel("rows two bars")),
                    cell(value(backend, "line", "instructions").map(|count| count / 1000.0), 0) + " thousand",
                    kilobytes("flash_bytes") + " kB",
                    format!("{} + {} kB", kilobytes("ram_bytes"), kilobytes("stack_bytes")),
                ];
                text += &line(&format!("{board} `{backend}`"), &cells);
            }
        }
        text
    }

    fn solving(&self) -> String {
        let uses = ["line sideways", "line", "line distorted", "line uncertain", "line worst", "sequence"];
        let mut text = "Thousands of instructions for a line of 16 knots, and for a frame of a sequence of 16 edges; stack of a line:\n\n\
                        | board, back end | sideways | turning | distorted | all uncertain | worst | sequence | stack, bytes |\n\
                        |---|---|---|---|---|---|---|---|\n"
            .to_owned();
        for (board, backend) in Self::pairs() {
            let value = |of: &str, quantity: &str| self.value(board, backend, Opt::Speed, of, quantity);
            let thousands = |of: &&str| cell(value(of, "instructions").map(|count| count / 1000.0), 0);
            let mut cells: Vec<_> = uses.iter().map(thousands).collect();
            cells.push(cell(value("line", "stack_bytes"), 0));
            text += &line(&format!("{board} `{backend}`"), &cells);
        }
        text
    }

    fn sizes(&self, opt: Opt) -> String {
        let uses = ["edges", "scanned", "smallest", "pixels", "pixels sequence", "pixels trajectory"];
        let mut text = format!(
            "Flash, statics and stack of whole programs with tables for 8 lines, in bytes, `opt-level = {opt}`:\n\n\
             | board, back end | edge points | pixels, scanned | pixels, smallest | pixels | pixels, sequence | pixels, trajectory |\n|---|---|---|---|---|---|---|\n"
        );
        for (board, backend) in Self::pairs() {
            let value = |of, quantity| cell(self.value(board, backend, opt, of, quantity), 0);
            let cells = uses
                .map(|of| ["flash_bytes", "ram_bytes", "stack_bytes"].map(|quantity| value(of, quantity)).join(" / "));
            text += &line(&format!("{board} `{backend}`"), &cells);
        }
        text
    }

    fn pairs() -> impl Iterator<Item = (Board, BackEnd)> {
        Self::boards().flat_map(|board| BackEnd::value_variants().iter().map(move |backend| (board, *backend)))
    }
}

fn cell(value: Option<f64>, digits: usize) -> String {
    value.map_or("–".into(), |value| format!("{value:.digits$}"))
}

/// A line of a table, unless nothing of it was measured.
fn line(name: &str, cells: &[String]) -> String {
    let is_empty = cells.iter().all(|cell| cell.chars().all(|c| "– /".contains(c)));
    if is_empty { String::new() } else { format!("| {name} | {} |\n", cells.join(" | ")) }
}
