//! [`FrameWriter`]: frames as they become known, so that none has to be kept.

use anyhow::Result;

use super::range_table;
use super::report::Frame;
use super::terminal;

#[derive(Clone, Copy, PartialEq)]
pub(crate) enum FrameFormat {
    Table {
        colours: bool,
    },
    /// One document for all.
    Json,
    /// A document on each line.
    JsonLines,
}

pub(crate) struct FrameWriter {
    format: FrameFormat,
    written: usize,
}

impl FrameWriter {
    pub(crate) fn new(format: FrameFormat) -> Self {
        Self { format, written: 0 }
    }

    pub(crate) fn write(&mut self, frame: &Frame) -> Result<()> {
        let text = match self.format {
            FrameFormat::Table { colours } => {
                let between = if self.written > 0 { "\n" } else { "" };
                format!("{between}{}", range_table::frame(frame, colours))
            }
            FrameFormat::Json => {
                let before = if self.written > 0 { ",\n" } else { "{\n  \"frames\": [\n" };
                // Texts have no line breaks within: those of JSON are escaped.
                format!("{before}    {}", terminal::json(frame)?.trim_end().replace('\n', "\n    "))
            }
            FrameFormat::JsonLines => terminal::json_line(frame)?,
        };
        self.written += 1;
        terminal::print(&text)
    }

    /// Without any frame there is nothing to print.
    pub(crate) fn finish(self) -> Result<()> {
        let is_open = self.format == FrameFormat::Json && self.written > 0;
        if is_open { terminal::print("\n  ]\n}\n") } else { Ok(()) }
    }
}
