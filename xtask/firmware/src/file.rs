//! [`JobFile`]: the job in the working directory of the emulator.

use budget_job::job::{Job, Source};
use semihosting::fs::File;
use semihosting::io::Read;

/// A file of the host.
pub struct JobFile(File);

impl Source for JobFile {
    fn fill(&mut self, bytes: &mut [u8]) {
        self.0.read_exact(bytes).expect("a whole job");
    }
}

/// The file `job`.
pub fn open() -> Job<JobFile> {
    Job(JobFile(File::open(c"job").expect("a job in the working directory")))
}
