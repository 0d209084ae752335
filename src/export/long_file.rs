//! Files that are written from beginning to end and may become longer than memory. The system keeps written bytes in memory for those
//! who read them soon. Of a long recording that is all memory in the end, and each new page costs more than the writing.

use crate::file::Partial;
use std::io::{Result, Write};
use std::ops::Range;

/// Bytes after which the system is asked, so that two such parts are in memory. A file of fewer stays there whole.
const PART: u64 = 1 << 25;

/// A file of which the system keeps the end in memory.
#[derive(Debug)]
pub(super) struct LongFile {
    file: Partial,
    parts: Parts,
}

impl LongFile {
    pub(super) const fn new(file: Partial) -> Self {
        Self { file, parts: Parts { size: PART, written: 0, begun: 0..0 } }
    }

    pub(super) fn into_inner(self) -> Partial {
        self.file
    }
}

impl Write for LongFile {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        let count = self.file.write(bytes)?;
        if let Some(part) = self.parts.more(count as u64) {
            let_go(&self.file, part);
        }
        Ok(count)
    }

    fn flush(&mut self) -> Result<()> {
        self.file.flush()
    }
}

/// How far a file is written, and to the disk.
#[derive(Debug)]
struct Parts {
    size: u64,
    written: u64,
    /// What the system began to write to the disk last.
    begun: Range<u64>,
}

impl Parts {
    /// Counts bytes. Where these complete a part, what the system is to let go of: it begins to write what is new, and keeps no more
    /// of what it began to write before.
    const fn more(&mut self, bytes: u64) -> Option<Range<u64>> {
        self.written += bytes;
        if self.written - self.begun.end < self.size {
            return None;
        }
        let part = self.begun.start..self.written;
        self.begun = self.begun.end..self.written;
        Some(part)
    }
}

/// Tells the system that no one reads a part of a file soon.
#[cfg(target_os = "linux")]
fn let_go(file: &Partial, part: Range<u64>) {
    use rustix::fs::{Advice, fadvise};
    // advice: where it is not taken, the file is as good
    let _ = fadvise(file, part.start, std::num::NonZeroU64::new(part.end - part.start), Advice::DontNeed);
}

#[cfg(not(target_os = "linux"))]
fn let_go(_: &Partial, _: Range<u64>) {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_is_named_when_it_is_new_and_once_more() {
        let mut parts = Parts { size: 100, written: 0, begun: 0..0 };
        let named: Vec<_> =
            [60, 30, 10, 250, 99, 1].map(|bytes| parts.more(bytes)).into_iter().flatten().collect();
        assert_eq!(named, [0..100, 0..350, 100..450]);
        assert_eq!(parts.begun, 350..450);
    }

    #[test]
    fn the_file_has_the_bytes_that_were_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("long");
        let mut file = LongFile::new(Partial::create(&path).unwrap());
        file.parts.size = 10_000;
        let bytes: Vec<u8> = (0..100_003_u32).map(|number| number.to_le_bytes()[0]).collect();
        for piece in bytes.chunks(1_111) {
            file.write_all(piece).unwrap();
        }
        assert!(file.parts.begun.end > 80_000, "{:?}", file.parts);
        file.into_inner().finish().unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), bytes);
    }
}
