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
    is_begun: bool,
    written: usize,
    is_read: bool,
}

impl FrameWriter {
    pub(crate) fn new(format: FrameFormat) -> Self {
        Self { format, is_begun: false, written: 0, is_read: true }
    }

    /// Begins a document, which may have no frame.
    pub(crate) fn begin(&mut self) -> Result<()> {
        self.is_begun = true;
        if self.format == FrameFormat::Json { self.print("{\n  \"frames\": [") } else { Ok(()) }
    }

    pub(crate) fn write(&mut self, frame: &Frame) -> Result<()> {
        let text = match self.format {
            FrameFormat::Table { colours } => {
                let between = if self.written > 0 { "\n" } else { "" };
                format!("{between}{}", range_table::frame(frame, colours))
            }
            FrameFormat::Json => {
                let between = if self.written > 0 { ",\n" } else { "\n" };
                // Texts have no line breaks within: those of JSON are escaped.
                format!("{between}    {}", terminal::json(frame)?.trim_end().replace('\n', "\n    "))
            }
            FrameFormat::JsonLines => terminal::json_line(frame)?,
        };
        self.written += 1;
        self.print(&text)
    }

    fn print(&mut self, text: &str) -> Result<()> {
        self.is_read = terminal::print(text)?;
        Ok(())
    }

    /// Whether anybody reads what is written.
    pub(crate) fn is_read(&self) -> bool {
        self.is_read
    }

    /// Ends a document that was begun.
    pub(crate) fn finish(mut self) -> Result<()> {
        let is_open = self.format == FrameFormat::Json && self.is_begun;
        if is_open { self.print("\n  ]\n}\n") } else { Ok(()) }
    }
}
