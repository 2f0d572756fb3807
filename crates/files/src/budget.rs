//! Budget of bytes for what is read of a file: by the length of the file, and by what the user allows.
//!
//! Wherever a file says how much follows, or holds more than it is long, the bytes are asked for here
//! before they are taken. Whoever asks also hears that somebody wants the reading to stop.

use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use crate::error::FileError;

/// What a file of any length may take: 64 MiB.
const FREE: u64 = 64 << 20;
/// What a file may take for each of its bytes: recordings are packed to a tenth, emptiness to a
/// thousandth.
const FOR_EACH_BYTE: u64 = 40;

/// The most memory that a reading may take, in bytes.
static MOST: AtomicU64 = AtomicU64::new(u64::MAX);
/// Whether readings are to stop.
static STOPPED: AtomicBool = AtomicBool::new(false);

/// Lets what is read of a file take no more memory than this in the whole process; `None` lifts the limit.
pub fn limit_memory(most_bytes: Option<u64>) {
    MOST.store(most_bytes.unwrap_or(u64::MAX), Ordering::Relaxed);
}

/// Ends every reading in this process with [`FileError::Stopped`], soon.
pub fn stop_reading() {
    STOPPED.store(true, Ordering::Relaxed);
}

/// Bytes that may be taken for a file.
#[derive(Debug, Clone)]
pub(crate) struct Budget {
    path: PathBuf,
    /// Length of the file, where it bounds what may be taken.
    length: Option<u64>,
    /// The most memory that the user allows.
    allowed: u64,
    taken: u64,
}

impl Budget {
    /// Memory for a file of this length.
    pub(crate) fn of(path: &Path, length: u64) -> Self {
        Self {
            length: Some(length),
            ..Self::allowed(path)
        }
    }

    /// Memory for a file that is there.
    ///
    /// # Errors
    /// [`FileError::Io`] of one that is not.
    pub(crate) fn of_file(path: &Path) -> Result<Self, FileError> {
        let metadata = std::fs::metadata(path).map_err(FileError::cannot("open", path))?;
        Ok(Self::of(path, metadata.len()))
    }

    /// Memory for what is known to be in the file.
    pub(crate) fn allowed(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            length: None,
            allowed: MOST.load(Ordering::Relaxed),
            taken: 0,
        }
    }

    /// Room on a disk for a file of this length.
    pub(crate) fn on_disk(path: &Path, length: u64) -> Self {
        Self {
            allowed: u64::MAX,
            ..Self::of(path, length)
        }
    }

    /// How many bytes may be taken in all.
    pub(crate) fn most(&self) -> u64 {
        self.allowed.min(self.by_length())
    }

    fn by_length(&self) -> u64 {
        self.length.map_or(u64::MAX, by_length)
    }

    /// Takes bytes for something, beside those taken before.
    ///
    /// # Errors
    /// [`FileError::TooLarge`] if there are not as many left, [`FileError::Stopped`].
    pub(crate) fn take(&mut self, what: impl Display, bytes: u64) -> Result<(), FileError> {
        self.taken = self.taken.saturating_add(bytes);
        self.check(what, self.taken)
    }

    /// Whether something may have so many bytes in all.
    ///
    /// # Errors
    /// As [`Budget::take`].
    pub(crate) fn check(&self, what: impl Display, bytes: u64) -> Result<(), FileError> {
        if STOPPED.load(Ordering::Relaxed) {
            let path = self.path.clone();
            return Err(FileError::Stopped { path });
        }
        if bytes > self.most() {
            return Err(self.too_large(what, bytes));
        }
        Ok(())
    }

    fn too_large(&self, what: impl Display, bytes: u64) -> FileError {
        let length = self.length.filter(|_| bytes > self.by_length());
        FileError::TooLarge {
            path: self.path.clone(),
            what: what.to_string(),
            size: size(bytes),
            reason: length.map_or_else(
                || self.beyond_allowed(),
                |length| self.beyond_length(length),
            ),
        }
    }

    fn beyond_allowed(&self) -> String {
        let allowed = size(self.allowed);
        format!("--max-memory allows {allowed}; raise it, or give a shorter recording")
    }

    fn beyond_length(&self, length: u64) -> String {
        let (length, most) = (size(length), size(self.by_length()));
        format!(
            "a file of {length} may hold {most}; if it does hold more, unpack it and give what was in it"
        )
    }
}

/// What may be taken for so many packed bytes, in all.
pub(crate) fn most_of(length: u64) -> u64 {
    by_length(length).min(MOST.load(Ordering::Relaxed))
}

/// What is reasonable for so many packed bytes, whatever the user allows.
pub(crate) fn by_length(length: u64) -> u64 {
    length.saturating_mul(FOR_EACH_BYTE).max(FREE)
}

/// Bytes in words.
fn size(bytes: u64) -> String {
    let units = [(1e9, "GB"), (1e6, "MB"), (1e3, "kB")];
    let bytes = bytes as f64;
    let fitting = units.into_iter().find(|(unit, _)| bytes >= *unit);
    fitting.map_or_else(
        || format!("{bytes} bytes"),
        |(unit, name)| format!("{:.1} {name}", bytes / unit),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_file_may_take_grows_with_its_length() {
        let path = Path::new("a.npz");
        let mut budget = Budget::of(path, 1_900_000);
        budget.take("array u", 40_000_000).expect("within");
        let error = budget.take("array y", 1 << 31).expect_err("beyond");
        assert_eq!(
            error.to_string(),
            "a.npz: array y would take 2.2 GB; a file of 1.9 MB may hold 76.0 MB; if it does hold more, unpack it \
             and give what was in it"
        );
        assert!(Budget::of(path, 10).check("array u", FREE).is_ok());
        assert!(Budget::allowed(path).check("array u", u64::MAX).is_ok());
    }

    #[test]
    fn what_the_user_allows_bounds_memory_and_no_disk() {
        let path = Path::new("a.npz");
        let few = |budget: Budget| Budget {
            allowed: 1000,
            ..budget
        };
        let error = few(Budget::of(path, 1_000_000)).check("array u", 2000);
        assert_eq!(
            error.expect_err("beyond").to_string(),
            "a.npz: array u would take 2.0 kB; --max-memory allows 1.0 kB; raise it, or give a shorter recording"
        );
        assert_eq!(Budget::on_disk(path, 1).most(), FREE);
    }
}
