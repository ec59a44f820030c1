//! [`FrameSource`]: frames one after the other, from files that hold one each and from videos.

use std::fs::File;
use std::io::{BufRead, BufReader, stdin};
use std::path::{Path, PathBuf};

use anyhow::{Context, Error, Result, anyhow};

use super::picture::{self, Picture, PictureFormat};
use super::video::Video;

/// Standard input in place of a file.
const STANDARD_INPUT: &str = "-";

/// A y4m video, from a file or from standard input.
pub(crate) fn is_video(path: &Path) -> bool {
    let is_y4m = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("y4m"));
    is_y4m || path == Path::new(STANDARD_INPUT)
}

/// A frame that has been found but perhaps not read.
pub(crate) struct FoundFrame {
    pub(crate) name: String,
    /// Index of the file.
    pub(crate) file: usize,
    /// Its number in the video, if it is one.
    pub(crate) number: Option<usize>,
    content: Content,
}

enum Content {
    File(PathBuf),
    /// Of a video, which can only be read in order.
    Read(Result<Picture>),
}

impl FoundFrame {
    pub(crate) fn load(self, format: &PictureFormat) -> Result<Picture> {
        match self.content {
            Content::File(path) => picture::load(&path, format),
            Content::Read(picture) => picture.context(self.name),
        }
    }
}

pub(crate) struct FrameSource<'a> {
    files: std::iter::Enumerate<std::slice::Iter<'a, PathBuf>>,
    format: PictureFormat,
    video: Option<OpenVideo>,
}

struct OpenVideo {
    name: String,
    file: usize,
    frames: usize,
    video: Video<Box<dyn BufRead + Send>>,
}

impl<'a> FrameSource<'a> {
    pub(crate) fn new(files: &'a [PathBuf], format: PictureFormat) -> Self {
        Self { files: files.iter().enumerate(), format, video: None }
    }

    fn open(&self, path: &Path) -> Result<Video<Box<dyn BufRead + Send>>> {
        let input: Box<dyn BufRead + Send> = if path == Path::new(STANDARD_INPUT) {
            Box::new(BufReader::new(stdin()))
        } else {
            Box::new(BufReader::new(File::open(path).context("reading")?))
        };
        Video::open(input, self.format.size)
    }
}

impl Iterator for FrameSource<'_> {
    type Item = FoundFrame;

    fn next(&mut self) -> Option<FoundFrame> {
        loop {
            if let Some(found) = self.video.as_mut().and_then(OpenVideo::next) {
                return Some(found);
            }
            self.video = None;
            let (file, path) = self.files.next()?;
            let name = path.display().to_string();
            if !is_video(path) {
                return Some(FoundFrame { name, file, number: None, content: Content::File(path.clone()) });
            }
            match self.open(path) {
                Ok(video) => self.video = Some(OpenVideo { name, file, frames: 0, video }),
                Err(error) => return Some(FoundFrame { name, file, number: None, content: Content::Read(Err(error)) }),
            }
        }
    }
}

impl OpenVideo {
    /// Frames are called by the video's name and their number, from 0. One that has none is an error: whatever was to
    /// write it may have failed.
    fn next(&mut self) -> Option<FoundFrame> {
        let number = self.frames;
        let Some(picture) = self.video.next_frame().transpose() else {
            let error = anyhow!("the video has no frame: it ends after its header");
            self.frames += 1;
            return (number == 0).then(|| self.unread(error));
        };
        self.frames += 1;
        let name = format!("{}#{number}", self.name);
        Some(FoundFrame { name, file: self.file, number: Some(number), content: Content::Read(picture) })
    }

    fn unread(&self, error: Error) -> FoundFrame {
        FoundFrame { name: self.name.clone(), file: self.file, number: None, content: Content::Read(Err(error)) }
    }
}
