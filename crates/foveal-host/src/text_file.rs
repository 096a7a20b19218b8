//! Text files: settings, camera paths, cameras, lenses, reports.

use std::fs::File;
use std::io::{Error, ErrorKind, Read, Result};
use std::path::Path;

/// Bytes of the largest text file that is read. Files without an end, as `/dev/zero`, stop here.
const MOST: u64 = 64 << 20;

/// Reads a text file. It may be a pipe, as a shell makes of `<(command)`.
///
/// # Errors
/// Where the file cannot be read, holds more than 64 MiB, or is no UTF-8.
pub fn read(path: &Path) -> Result<String> {
    let mut bytes = Vec::new();
    File::open(path)?.take(MOST + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > MOST {
        return Err(Error::new(
            ErrorKind::FileTooLarge,
            "it has more than 64 MiB",
        ));
    }
    String::from_utf8(bytes)
        .map_err(|_| Error::new(ErrorKind::InvalidData, "it is no text in UTF-8"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn a_file_without_an_end_is_an_error() {
        let error = read(Path::new("/dev/zero")).unwrap_err().to_string();
        assert!(error.contains("64 MiB"), "{error}");
    }

    #[test]
    fn bytes_that_are_no_text_are_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.toml");
        std::fs::write(&path, [0xff, 0xfe]).unwrap();
        assert!(read(&path).unwrap_err().to_string().contains("UTF-8"));
        std::fs::write(&path, "ü").unwrap();
        assert_eq!(read(&path).unwrap(), "ü");
    }
}
