//! Files that are there whole or not at all.
//!
//! Bytes go to a temporary name in the destination's folder, are synchronised to the disk and then
//! renamed. Nobody ever sees half a file under the final name: not after Ctrl-C, not after a power
//! cut, and not another process that works in the same folder.

use std::collections::HashSet;
use std::fs::{self, File};
use std::io::{ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, bail};

/// Checks that a file can be written at `path`, without touching one that is there. `-`, by which
/// commands mean standard output, is no file.
///
/// # Errors
/// Names the folder or the file and what is in the way.
pub fn check_writable(path: &Path) -> anyhow::Result<()> {
    if path == Path::new("-") {
        bail!("cannot write '-': this cannot go to standard output; a file of that name is './-'");
    }
    let destination = destination(path)?;
    let folder = folder_of(&destination);
    if !folder.is_dir() {
        let what = if folder.exists() {
            "is not a folder"
        } else {
            "does not exist"
        };
        bail!(
            "cannot write '{}': the folder '{}' {what}",
            path.display(),
            folder.display()
        );
    }
    temporary(&destination, SUFFIX)
        .map(drop)
        .with_context(|| format!("cannot write '{}'", path.display()))
}

/// Whether two of these paths are the same file, however they are written: `a.png` is `./a.png`,
/// and a link is what it leads to.
pub fn any_twice<'a>(paths: impl IntoIterator<Item = &'a Path>) -> bool {
    let mut seen = HashSet::new();
    paths
        .into_iter()
        .any(|path| !seen.insert(one_spelling(path)))
}

/// Whether a file that is to be written would replace one that is read.
pub fn replaces(written: &Path, read: &Path) -> bool {
    read.is_file() && any_twice([read, written])
}

/// The same path for every way to write a file's path, whether the file exists or not.
fn one_spelling(path: &Path) -> PathBuf {
    let path = destination(path).unwrap_or_else(|_| path.to_owned());
    let in_folder = || {
        let folder = fs::canonicalize(folder_of(&path)).ok()?;
        Some(folder.join(path.file_name()?))
    };
    fs::canonicalize(&path)
        .ok()
        .or_else(in_folder)
        .or_else(|| std::path::absolute(&path).ok())
        .unwrap_or(path)
}

/// Writes `bytes` to `path`, replacing a regular file that is there.
///
/// # Errors
/// Names the file and the system's reason; `path` is then as it was before.
pub fn write(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    write_with(path, |file| file.write_all(bytes))
}

/// Writes to `path` what `content` writes, replacing a regular file that is there.
///
/// # Errors
/// Names the file and the system's reason; `path` is then as it was before.
pub fn write_with(
    path: &Path,
    content: impl FnOnce(&mut File) -> std::io::Result<()>,
) -> anyhow::Result<()> {
    let destination = destination(path)?;
    let written = || -> std::io::Result<()> {
        let mut file = temporary(&destination, SUFFIX)?;
        content(file.as_file_mut())?;
        file.as_file().sync_all()?;
        file.persist(&destination).map_err(|e| e.error)?;
        sync_folder(folder_of(&destination));
        Ok(())
    };
    written().with_context(|| format!("cannot write '{}'", path.display()))
}

/// A file that another program writes. It vanishes unless it is finished.
#[derive(Debug)]
pub struct Pending {
    temporary: tempfile::TempPath,
    destination: PathBuf,
}

impl Pending {
    /// An empty file beside `path`, whose name ends in `suffix`.
    ///
    /// # Errors
    /// Names the file and the system's reason.
    pub fn new(path: &Path, suffix: &str) -> anyhow::Result<Self> {
        let destination = destination(path)?;
        let temporary = temporary(&destination, suffix)
            .with_context(|| format!("cannot write '{}'", path.display()))?
            .into_temp_path();
        Ok(Self {
            temporary,
            destination,
        })
    }

    /// Where to write.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.temporary
    }

    /// Puts the file under its name.
    ///
    /// # Errors
    /// Names the file and the system's reason.
    pub fn finish(self) -> anyhow::Result<()> {
        let Self {
            temporary,
            destination,
        } = self;
        let finished = || -> std::io::Result<()> {
            File::open(&temporary)?.sync_all()?;
            temporary.persist(&destination).map_err(|e| e.error)?;
            sync_folder(folder_of(&destination));
            Ok(())
        };
        finished().with_context(|| format!("cannot write '{}'", destination.display()))
    }
}

/// True when a finished file is there. A PNG file whose end is missing is not finished: another
/// program may have cut it off.
pub fn is_finished(path: &Path) -> bool {
    let is_there = fs::metadata(path).is_ok_and(|m| m.is_file() && m.len() > 0);
    let is_png = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("png"));
    is_there && (!is_png || has_png_end(path).unwrap_or(false))
}

/// The last chunk of every PNG file: no bytes, its name, its checksum.
const PNG_END: [u8; 12] = *b"\0\0\0\0IEND\xaeB`\x82";

fn has_png_end(path: &Path) -> std::io::Result<bool> {
    let mut file = File::open(path)?;
    file.seek(SeekFrom::End(-(PNG_END.len() as i64)))?;
    let mut end = [0; PNG_END.len()];
    file.read_exact(&mut end)?;
    Ok(end == PNG_END)
}

/// How the names of temporary files end, but for those of other programs.
const SUFFIX: &str = ".tmp";

/// Most bytes of a file's name in the name of its temporary file, which has a dozen more: systems
/// allow 255.
const LONGEST_NAME: usize = 230;

/// Age from which a temporary file is abandoned: far more than writing one takes.
const ABANDONED: Duration = Duration::from_secs(600);

/// The same of a [`Pending`] file, whose program may hold bytes back for many slow frames.
const ABANDONED_PENDING: Duration = Duration::from_secs(24 * 3600);

/// Removes what jobs that were killed left while they wrote `files`, all in one folder: temporary
/// files that nobody has written to for ten minutes, those of other programs for a day, by the
/// folder's own clock.
pub fn remove_abandoned<'a>(files: impl IntoIterator<Item = &'a Path>) {
    let mut files = files.into_iter().peekable();
    let Some(folder) = files.peek().map(|file| folder_of(file).to_owned()) else {
        return;
    };
    let names: HashSet<String> = files.map(short_name).collect();
    let now = tempfile::NamedTempFile::new_in(&folder)
        .and_then(|probe| probe.as_file().metadata()?.modified());
    let (Ok(now), Ok(entries)) = (now, fs::read_dir(&folder)) else {
        return;
    };
    for entry in entries.flatten() {
        let entry_name = entry.file_name();
        let temporary = entry_name.to_str().unwrap_or_default();
        let is_ours = destination_name(temporary).is_some_and(|name| names.contains(name));
        let least_age = match temporary.ends_with(SUFFIX) {
            true => ABANDONED,
            false => ABANDONED_PENDING,
        };
        let modified = entry.metadata().and_then(|metadata| metadata.modified());
        let age = modified.ok().and_then(|time| now.duration_since(time).ok());
        if is_ours && age.is_some_and(|age| age > least_age) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// The short name of the file that a temporary file is to become: of `.frame.png.a1B2c3.tmp`,
/// `frame.png`.
fn destination_name(temporary: &str) -> Option<&str> {
    let (rest, _ending) = temporary.strip_prefix('.')?.rsplit_once('.')?;
    let (name, random) = rest.rsplit_once('.')?;
    let is_random = random.len() == 6 && random.bytes().all(|b| b.is_ascii_alphanumeric());
    (is_random && !name.is_empty()).then_some(name)
}

/// Where the bytes really go: behind links, so that a link stays a link; never over a device or a
/// folder.
fn destination(path: &Path) -> anyhow::Result<PathBuf> {
    match fs::metadata(path) {
        Ok(found) if found.is_dir() => bail!("cannot write '{}': it is a folder", path.display()),
        Ok(found) if !found.is_file() => {
            bail!(
                "cannot write '{}': it is not a regular file",
                path.display()
            )
        }
        Ok(_) => {
            fs::canonicalize(path).with_context(|| format!("cannot write '{}'", path.display()))
        }
        Err(error) if error.kind() == ErrorKind::NotFound => match fs::read_link(path) {
            // A link to a file that is not there yet.
            Ok(target) => destination(&folder_of(path).join(target)),
            Err(_) => Ok(path.to_owned()),
        },
        Err(error) => Err(error).with_context(|| format!("cannot write '{}'", path.display())),
    }
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// As much of a file's name as a temporary file has in its own.
fn short_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    name[..name.floor_char_boundary(LONGEST_NAME)].to_owned()
}

fn temporary(destination: &Path, suffix: &str) -> std::io::Result<tempfile::NamedTempFile> {
    let prefix = format!(".{}.", short_name(destination));
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(suffix);
    // Temporary files are private by default; this one becomes an ordinary file, which the umask
    // governs.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder_of(destination))
}

/// Makes the rename itself durable where the system can; the file is whole either way.
fn sync_folder(folder: &Path) {
    if cfg!(unix) {
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .unwrap()
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_written_file_is_whole_and_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        write(&path, b"first").unwrap();
        write(&path, b"second").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"second");
        assert_eq!(names(folder.path()), ["a.bin"]);
    }

    #[test]
    fn a_picture_without_its_end_is_not_finished() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let mut whole = b"picture".to_vec();
        whole.extend(PNG_END);
        fs::write(&path, &whole).unwrap();
        assert!(is_finished(&path));
        for length in [0, 3, whole.len() - 1] {
            fs::write(&path, &whole[..length]).unwrap();
            assert!(!is_finished(&path), "{length}");
        }
        // What has no such end is finished when it has bytes.
        let other = folder.path().join("a.exr");
        fs::write(&other, b"x").unwrap();
        assert!(is_finished(&other));
    }

    #[test]
    fn one_file_is_the_same_however_its_path_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let inner = folder.path().join("inner");
        fs::create_dir(&inner).unwrap();
        let file = folder.path().join("a.png");
        let same = |other: &Path| any_twice([file.as_path(), other]);
        // A file that is not there yet, and one that is.
        for _ in 0..2 {
            assert!(same(&inner.join("../a.png")) && same(&folder.path().join("./a.png")));
            assert!(!same(&inner.join("a.png")) && !same(&folder.path().join("b.png")));
            #[cfg(unix)]
            {
                let link = inner.join("link.png");
                std::os::unix::fs::symlink("../a.png", &link).unwrap();
                assert!(same(&link));
                fs::remove_file(&link).unwrap();
            }
            fs::write(&file, "picture").unwrap();
        }
    }

    #[test]
    fn abandoned_files_are_removed_and_no_others() {
        let folder = tempfile::tempdir().unwrap();
        let old = std::time::SystemTime::now() - 2 * ABANDONED;
        let make = |name: &str, is_old: bool| {
            let file = File::create(folder.path().join(name)).unwrap();
            if is_old {
                file.set_modified(old).unwrap();
            }
        };
        for name in [
            ".f1.png.a1B2c3.mp4",
            ".f1.png.a1B2c3.tmp",
            ".f2.png.a1B2c3.tmp",
            ".f1.png.claim-0",
            "f1.png",
        ] {
            make(name, true);
        }
        make(".f1.png.d4E5f6.tmp", false);
        remove_abandoned([folder.path().join("f1.png").as_path()]);
        let left = [
            ".f1.png.a1B2c3.mp4",
            ".f1.png.claim-0",
            ".f1.png.d4E5f6.tmp",
            ".f2.png.a1B2c3.tmp",
            "f1.png",
        ];
        assert_eq!(names(folder.path()), left);
    }

    #[test]
    fn a_temporary_file_is_known_by_its_name() {
        let path = Path::new("a.b.png");
        let made = tempfile::tempdir().unwrap();
        let file = temporary(&made.path().join(path), ".tmp").unwrap();
        let name = file.path().file_name().unwrap().to_str().unwrap();
        assert_eq!(destination_name(name), Some("a.b.png"));
        for other in [
            "a.b.png",
            ".a",
            ".a.tmp",
            ".hidden.file.tmp",
            "..abcdef.tmp",
        ] {
            assert_eq!(destination_name(other), None, "{other}");
        }
    }

    #[test]
    fn checking_leaves_nothing_behind() {
        let folder = tempfile::tempdir().unwrap();
        check_writable(&folder.path().join("a.png")).unwrap();
        assert!(names(folder.path()).is_empty());
    }

    #[test]
    fn standard_output_is_no_file() {
        let error = check_writable(Path::new("-")).unwrap_err().to_string();
        assert!(error.contains("standard output"), "{error}");
    }

    #[test]
    fn a_folder_and_a_missing_folder_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let error = check_writable(folder.path()).unwrap_err().to_string();
        assert!(error.contains("is a folder"), "{error}");
        let error = check_writable(&folder.path().join("no/a.png"))
            .unwrap_err()
            .to_string();
        assert!(error.contains("does not exist"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn a_device_is_never_replaced_and_a_link_stays_a_link() {
        assert!(check_writable(Path::new("/dev/null")).is_err());
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        fs::write(&file, "old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        write(&link, b"new").unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&file).unwrap(), b"new");
        // A link to a file that is not there yet.
        fs::remove_file(&file).unwrap();
        let second = folder.path().join("second");
        std::os::unix::fs::symlink("link", &second).unwrap();
        check_writable(&second).unwrap();
        write(&second, b"first").unwrap();
        assert!(fs::symlink_metadata(&second).unwrap().is_symlink());
        assert_eq!(fs::read(&file).unwrap(), b"first");
        assert_eq!(names(folder.path()), ["file", "link", "second"]);
        // One to a folder that is not there, and one to itself.
        for target in ["none/file", "self"] {
            let link = folder.path().join("self");
            std::os::unix::fs::symlink(target, &link).unwrap();
            let error = check_writable(&link).unwrap_err().to_string();
            assert!(error.contains("self"), "{error}");
            fs::remove_file(&link).unwrap();
        }
    }

    // Elsewhere whole paths are limited.
    #[cfg(unix)]
    #[test]
    fn a_name_may_be_as_long_as_the_system_lets_it() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a".repeat(251), "ä".repeat(125) + "b"] {
            let path = folder.path().join(name + ".png");
            check_writable(&path).unwrap();
            write(&path, b"bytes").unwrap();
            assert_eq!(fs::read(&path).unwrap(), b"bytes");
            Pending::new(&path, ".webm").unwrap().finish().unwrap();
            // Abandoned files are known by as much of the name as they have.
            let left = temporary(&path, ".tmp").unwrap();
            let old = std::time::SystemTime::now() - 2 * ABANDONED;
            left.as_file().set_modified(old).unwrap();
            remove_abandoned([path.as_path()]);
            assert!(!left.path().exists());
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_written_file_can_be_read_by_others_as_the_umask_says() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let (ours, plain) = (folder.path().join("ours"), folder.path().join("plain"));
        write(&ours, b"x").unwrap();
        fs::write(&plain, b"x").unwrap();
        let mode = |p: &Path| fs::metadata(p).unwrap().permissions().mode();
        assert_eq!(mode(&ours), mode(&plain));
    }
}
