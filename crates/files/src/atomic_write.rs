//! Atomic writing, the one way this crate writes a file: into `NAME.part`, synced, then renamed. A
//! reader never sees half a file under its final name, a failure keeps what was written, and two
//! processes cannot write the same file.

use std::error::Error;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::error::{FileError, chain};

/// What to do when the output exists already.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Overwrite {
    /// Leave it alone and say so; so too with what an unfinished run left in `NAME.part`: it may be
    /// all there is of a measurement.
    #[default]
    Refuse,
    /// Leave a complete file alone, but replace what an unfinished run left: for work that can be
    /// done again.
    Resume,
    /// Replace it, once the new file is complete.
    Replace,
}

/// Any error of what fills a file.
pub type BoxError = Box<dyn Error + Send + Sync>;

/// Where a file is kept until it is complete: its name with `.part` behind it.
#[must_use]
pub fn part_path(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".part");
    PathBuf::from(name)
}

/// Writes `path` by `fill`, so that it appears complete or not at all.
///
/// # Errors
/// [`FileError::Exists`], [`FileError::Leftover`], [`FileError::Busy`], or [`FileError::Write`]
/// with the whole chain of reasons; what was written stays in `NAME.part`.
pub(crate) fn write_file(
    path: &Path,
    overwrite: Overwrite,
    fill: impl FnOnce(&mut BufWriter<&File>) -> Result<(), BoxError>,
) -> Result<(), FileError> {
    let part = part_path(path);
    let file = open_part(path, &part, overwrite)?;
    let failed = |error: &(dyn Error + 'static)| FileError::Write {
        path: path.into(),
        part: part.clone(),
        saved_bytes: file.metadata().map_or(0, |meta| meta.len()),
        reason: chain(error),
    };
    let mut writer = BufWriter::with_capacity(1 << 18, &file);
    let filled = fill(&mut writer);
    let flushed = writer.flush(); // before the bytes that were saved are counted
    drop(writer);
    filled.map_err(|error| failed(&*error))?;
    flushed.map_err(|error| failed(&error))?;
    file.sync_all().map_err(|error| failed(&error))?;
    std::fs::rename(&part, path).map_err(|error| failed(&error))?;
    sync_folder(path);
    Ok(())
}

/// Writes `content` to `path` in the same way.
///
/// # Errors
/// [`FileError::Exists`], [`FileError::Leftover`], [`FileError::Busy`] or [`FileError::Write`].
pub fn write_bytes(path: &Path, overwrite: Overwrite, content: &[u8]) -> Result<(), FileError> {
    write_file(path, overwrite, |file| Ok(file.write_all(content)?))
}

/// Creates a folder, and those above it, where they do not exist yet.
///
/// # Errors
/// [`FileError::Io`].
pub fn create_folder(folder: &Path) -> Result<(), FileError> {
    std::fs::create_dir_all(folder).map_err(FileError::cannot("create the folder", folder))
}

/// Refuses an output that exists, before any work is done for it; a link, a device or a pipe always.
///
/// # Errors
/// [`FileError::Exists`], [`FileError::NoFile`].
pub fn check_free(path: &Path, overwrite: Overwrite) -> Result<(), FileError> {
    let Ok(there) = path.symlink_metadata() else {
        return Ok(());
    };
    if overwrite != Overwrite::Replace {
        return Err(FileError::Exists { path: path.into() });
    }
    let kind = match there.file_type() {
        kind if kind.is_file() => return Ok(()),
        kind if kind.is_symlink() => "a symbolic link",
        kind if kind.is_dir() => "a folder",
        _ => "a device, a pipe or a socket",
    };
    let path = path.into();
    Err(FileError::NoFile { path, kind })
}

/// Refuses an output that is one of the files it is made of, by whatever name.
///
/// # Errors
/// [`FileError::Input`].
pub fn check_not_read<'a>(
    output: &Path,
    inputs: impl IntoIterator<Item = &'a Path>,
) -> Result<(), FileError> {
    let Ok(there) = output.canonicalize() else {
        return Ok(());
    };
    let is_output = |input: &Path| input.canonicalize().is_ok_and(|input| input == there);
    match inputs.into_iter().any(is_output) {
        true => Err(FileError::Input {
            path: output.into(),
        }),
        false => Ok(()),
    }
}

/// Opens `part` for the writing of `path`, locked and empty.
fn open_part(path: &Path, part: &Path, overwrite: Overwrite) -> Result<File, FileError> {
    check_free(path, overwrite)?;
    let left_over = part.symlink_metadata().is_ok();
    let failed = FileError::cannot("create", part);
    let file = OpenOptions::new()
        .write(true)
        .create(true)
        .truncate(false)
        .open(part)
        .map_err(failed)?;
    lock(&file, part)?;
    if left_over && overwrite == Overwrite::Refuse {
        return Err(FileError::Leftover { path: part.into() });
    }
    if file.metadata().is_ok_and(|meta| meta.is_file()) {
        file.set_len(0).map_err(failed)?;
    }
    Ok(file)
}

/// Refuses a file that another process is writing.
fn lock(file: &File, part: &Path) -> Result<(), FileError> {
    if let Err(TryLockError::WouldBlock) = file.try_lock() {
        return Err(FileError::Busy { path: part.into() });
    }
    // a file system without locks (some network folders) must not keep anyone from writing
    Ok(())
}

/// Makes the rename last through a power failure, where folders can be synced; the file itself is
/// safe either way.
fn sync_folder(path: &Path) {
    let folder = path
        .parent()
        .filter(|parent| !parent.as_os_str().is_empty())
        .unwrap_or(Path::new("."));
    File::open(folder).and_then(|folder| folder.sync_all()).ok();
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn an_existing_file_is_kept_or_replaced_as_told() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("a.json");
        write_bytes(&path, Overwrite::Refuse, b"one").expect("nothing in the way");
        assert!(matches!(
            write_bytes(&path, Overwrite::Refuse, b"two"),
            Err(FileError::Exists { .. })
        ));
        assert_eq!(fs::read(&path).expect("written"), b"one");
        write_bytes(&path, Overwrite::Replace, b"two").expect("replaces");
        assert_eq!(fs::read(&path).expect("written"), b"two");
        assert!(!part_path(&path).exists());
    }

    #[test]
    fn a_leftover_is_only_replaced_when_told() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("a.mcap");
        fs::write(part_path(&path), b"measured").expect("written");
        assert!(matches!(
            write_bytes(&path, Overwrite::Refuse, b"new"),
            Err(FileError::Leftover { .. })
        ));
        assert_eq!(fs::read(part_path(&path)).expect("kept"), b"measured");
        write_bytes(&path, Overwrite::Resume, b"new").expect("replaces the leftover");
        assert!(matches!(
            write_bytes(&path, Overwrite::Resume, b"newer"),
            Err(FileError::Exists { .. })
        ));
        assert_eq!(fs::read(&path).expect("written"), b"new");
    }

    #[test]
    fn two_writers_of_one_file_do_not_mix() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("a.mcap");
        let outer = write_file(&path, Overwrite::Replace, |_| {
            assert!(matches!(
                write_bytes(&path, Overwrite::Replace, b"second"),
                Err(FileError::Busy { .. })
            ));
            Ok(())
        });
        outer.expect("the first one goes on");
    }

    #[test]
    fn a_failure_names_the_reason_and_keeps_what_was_written() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("a.json");
        let error = write_file(&path, Overwrite::Refuse, |file| {
            file.write_all(b"half")?;
            Err(mcap::McapError::Io(std::io::ErrorKind::StorageFull.into()).into())
        });
        let error = error.expect_err("the fill failed").to_string();
        assert!(
            error.contains("no storage space") && error.contains("a.json.part"),
            "{error}"
        );
        assert!(error.contains("4 bytes"), "{error}");
        assert!(!path.exists());
        assert_eq!(fs::read(part_path(&path)).expect("kept"), b"half");
    }

    #[cfg(unix)]
    #[test]
    fn what_is_no_file_is_never_replaced() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = folder.path().join("a.json");
        fs::write(&file, b"measured").expect("written");
        let link = folder.path().join("link.json");
        std::os::unix::fs::symlink(&file, &link).expect("a link");
        let socket = folder.path().join("socket");
        let _bound = std::os::unix::net::UnixListener::bind(&socket).expect("a socket");
        for (path, word) in [
            (&*link, "link"),
            (folder.path(), "folder"),
            (&*socket, "socket"),
        ] {
            let refused = write_bytes(path, Overwrite::Replace, b"x").expect_err("no file");
            assert!(refused.to_string().contains(word), "{refused}");
        }
        assert_eq!(fs::read(&file).expect("kept"), b"measured");
        assert!(link.is_symlink() && socket.symlink_metadata().is_ok());
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_told_as_such() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("a.json");
        std::os::unix::fs::symlink("/dev/full", part_path(&path)).expect("a link");
        let error = write_bytes(&path, Overwrite::Replace, b"x")
            .expect_err("the disk is full")
            .to_string();
        assert!(error.contains("No space left on device"), "{error}");
        let folder = Path::new("/proc/nowhere/a.json");
        assert!(matches!(
            write_bytes(folder, Overwrite::Refuse, b"x"),
            Err(FileError::Io { .. })
        ));
    }
}
