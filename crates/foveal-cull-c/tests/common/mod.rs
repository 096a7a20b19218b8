//! The C and C++ compilers, and the library that the tests were built with.
#![allow(
    dead_code,
    unreachable_pub,
    clippy::unwrap_used,
    reason = "shared by several test programs, each using a part"
)]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A language with its compiler.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    C,
    Cpp,
}

pub fn crate_dir() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The folder with the libraries, beside the test's own program.
pub fn library_dir() -> PathBuf {
    let program = std::env::current_exe().unwrap();
    program.parent().unwrap().to_owned()
}

/// A new folder for the files of one test.
pub fn scratch(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// A compiler call with every warning as an error.
pub fn compiler(language: Language) -> Command {
    let (variable, name, standard) = match language {
        Language::C => ("CC", "cc", "-std=c99"),
        Language::Cpp => ("CXX", "c++", "-std=c++17"),
    };
    let mut command = Command::new(std::env::var(variable).unwrap_or_else(|_| name.to_owned()));
    command.args([
        standard,
        "-Wall",
        "-Wextra",
        "-Wpedantic",
        "-Werror",
        "-O1",
        "-g",
    ]);
    command.arg("-I").arg(crate_dir().join("include"));
    command
}

/// What a program needs that is linked with the static library.
pub const NATIVE: [&str; 4] = ["-lpthread", "-ldl", "-lm", "-lrt"];

pub fn done(command: &mut Command) -> Output {
    let output = command
        .output()
        .unwrap_or_else(|e| panic!("{command:?}: {e}"));
    assert!(
        output.status.success(),
        "{command:?}: {}\n{}{}",
        output.status,
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
    output
}

/// Compiles a source with the static library; gives the program.
pub fn program(language: Language, source: &Path, folder: &Path, flags: &[&str]) -> PathBuf {
    let program = folder.join(source.file_stem().unwrap());
    let library = library_dir().join("libfoveal_cull_c.a");
    assert!(library.exists(), "{}", library.display());
    let mut command = compiler(language);
    command.args(flags).arg(source).arg("-o").arg(&program);
    done(command.arg(library).args(NATIVE));
    program
}
