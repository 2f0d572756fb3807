//! Opening of a file that should be an MCAP; anything else is named, with the tool that converts it.

use std::fs::File;
use std::io::{BufReader, Seek, SeekFrom};
use std::path::Path;

use crate::error::FileError;
use crate::file_kind::{first_bytes, kind_of};

/// Opens an MCAP for reading.
///
/// # Errors
/// [`FileError::Io`], or [`FileError::Format`] naming what the file is instead.
pub(crate) fn open_mcap(path: &Path) -> Result<BufReader<File>, FileError> {
    let failed = |error: std::io::Error| FileError::Io {
        path: path.into(),
        action: "open",
        reason: error.to_string(),
    };
    let mut file = BufReader::with_capacity(1 << 16, File::open(path).map_err(failed)?);
    let start = first_bytes(&mut file).map_err(failed)?;
    file.seek(SeekFrom::Start(0)).map_err(failed)?;
    if start.starts_with(mcap::MAGIC) {
        return Ok(file);
    }
    let (found, advice) = match kind_of(&start) {
        _ if !start.is_empty() && mcap::MAGIC.starts_with(&start) => {
            ("the first bytes of an MCAP", "the rest is lost")
        }
        Some(kind) => kind,
        None => ("an unknown kind of file", "give an .mcap file"),
    };
    Err(FileError::Format {
        path: path.into(),
        found: found.into(),
        needed: "an MCAP file",
        advice: advice.into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_files_are_named_with_the_tool_that_converts_them() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("x");
        for (start, named) in [
            (&b"SQLite format 3\0..."[..], "ros2 bag convert"),
            (&[0x28, 0xb5, 0x2f, 0xfd, 0], "zstd -d"),
            (b"#ROSBAG V2.0\n", "ROS 1"),
            (b"", "empty"),
            (&mcap::MAGIC[..5], "the rest is lost"),
            (b"time,u,y\n", "unknown"),
        ] {
            std::fs::write(&path, start).expect("written");
            let error = open_mcap(&path).expect_err("not an MCAP").to_string();
            assert!(error.contains(named), "{error}");
        }
        assert!(matches!(
            open_mcap(&folder.path().join("none")),
            Err(FileError::Io { .. })
        ));
    }
}
