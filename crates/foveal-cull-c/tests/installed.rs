//! The installed library: programs in C and C++ find it by pkg-config and by CMake, shared and static.
#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "tests")]

mod common;

use common::{crate_dir, done, library_dir, scratch};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Installs into a folder whose name has a space.
fn install(folder: &Path) -> PathBuf {
    let prefix = folder.join("a prefix");
    let mut install = Command::new(crate_dir().join("install.sh"));
    let said = done(install.arg(&prefix).arg("--from").arg(library_dir()));
    let said = String::from_utf8(said.stdout).unwrap();
    assert!(said.contains(env!("CARGO_PKG_VERSION")), "{said}");
    prefix
}

fn has(name: &str) -> bool {
    let found = Command::new(name).arg("--version").output();
    found.is_ok_and(|o| o.status.success())
}

fn example(name: &str) -> String {
    let path = crate_dir().join("examples").join(name);
    path.to_str().unwrap().to_owned()
}

/// Runs a program by the installed shared library, or by none.
fn run(program: &Path, libraries: Option<&Path>) {
    let mut command = Command::new(program);
    command.env_remove("LD_LIBRARY_PATH");
    if let Some(folder) = libraries {
        command.env("LD_LIBRARY_PATH", folder);
        command.env("DYLD_LIBRARY_PATH", folder);
    }
    done(&mut command);
}

#[test]
fn pkg_config_finds_what_is_installed() {
    if !has("pkg-config") {
        println!("skipped: there is no pkg-config");
        return;
    }
    let folder = scratch("pkg-config");
    let prefix = install(&folder);
    let libraries = prefix.join("lib");
    let pkg_config = || {
        let mut command = Command::new("pkg-config");
        command.env("PKG_CONFIG_PATH", libraries.join("pkgconfig"));
        command
    };
    let wanted = format!("foveal_cull = {}", env!("CARGO_PKG_VERSION"));
    done(pkg_config().arg("--exists").arg(wanted));
    let build = |source: &str, compiler: &str, more: &[&str]| {
        let program = folder.join("program");
        let flags = done(
            pkg_config()
                .args(["--cflags", "--libs", "foveal_cull"])
                .args(more),
        );
        let flags = String::from_utf8(flags.stdout).unwrap();
        // As in a makefile: the shell takes the flags apart.
        let script = format!("{compiler} '{source}' -o '{}' {flags}", program.display());
        done(Command::new("sh").arg("-c").arg(script));
        program
    };
    let (street, jobs) = (example("street.c"), example("jobs.cpp"));
    let cpp = "c++ -std=c++17 -pthread";
    for (source, compiler) in [(&street, "cc"), (&jobs, cpp)] {
        run(&build(source, compiler, &[]), Some(&libraries));
    }
    // Without the shared library the static one is taken.
    for entry in std::fs::read_dir(&libraries).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        if name.contains(".so") || name.contains(".dylib") {
            std::fs::remove_file(path).unwrap();
        }
    }
    for (source, compiler) in [(&street, "cc"), (&jobs, cpp)] {
        run(&build(source, compiler, &["--static"]), None);
    }
}

/// The name of the generator whose program there is.
fn cmake_generator() -> Option<&'static str> {
    if !has("cmake") {
        println!("skipped: there is no cmake");
        return None;
    }
    let generators = [("make", "Unix Makefiles"), ("ninja", "Ninja")];
    let found = generators.into_iter().find(|(name, _)| has(name));
    if found.is_none() {
        println!("skipped: there is neither make nor ninja for cmake");
    }
    found.map(|(_, generator)| generator)
}

/// A project that looks for a version of the library.
struct Project {
    folder: PathBuf,
    prefix: PathBuf,
    generator: &'static str,
}

impl Project {
    /// Configures the project anew; whether the library was found.
    fn configure(&self, version: &str, text: &str) -> bool {
        let source = self.folder.join("project");
        let _ = std::fs::remove_dir_all(self.build());
        std::fs::create_dir_all(&source).unwrap();
        let text = format!(
            "cmake_minimum_required(VERSION 3.16)\nproject(user C)\n\
             find_package(foveal_cull {version} CONFIG REQUIRED)\n{text}"
        );
        std::fs::write(source.join("CMakeLists.txt"), text).unwrap();
        let mut command = Command::new("cmake");
        command.arg("-G").arg(self.generator);
        command.arg("-S").arg(&source).arg("-B").arg(self.build());
        let mut at = std::ffi::OsString::from("-DCMAKE_PREFIX_PATH=");
        at.push(&self.prefix);
        let output = command.arg(at).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        // What was refused was seen.
        assert!(
            output.status.success() || said.contains("considered but not accepted"),
            "{said}"
        );
        output.status.success()
    }

    fn build(&self) -> PathBuf {
        self.folder.join("build")
    }
}

#[test]
fn cmake_finds_what_is_installed() {
    let Some(generator) = cmake_generator() else {
        return;
    };
    let folder = scratch("cmake");
    let prefix = install(&folder);
    let project = Project {
        folder,
        prefix,
        generator,
    };
    // A project in C alone needs no compiler for C++.
    let street = example("street.c");
    let of_c = format!(
        "add_executable(shared \"{street}\")\ntarget_link_libraries(shared PRIVATE foveal::cull)\n\
         add_executable(static \"{street}\")\ntarget_link_libraries(static PRIVATE foveal::cull_static)\n"
    );
    let jobs = example("jobs.cpp");
    let of_cpp = format!(
        "enable_language(CXX)\nset(CMAKE_CXX_STANDARD 17)\nfind_package(Threads REQUIRED)\n\
         add_executable(shared \"{jobs}\")\n\
         target_link_libraries(shared PRIVATE foveal::cull Threads::Threads)\n\
         add_executable(static \"{jobs}\")\n\
         target_link_libraries(static PRIVATE foveal::cull_static Threads::Threads)\n"
    );
    let series = format!(
        "{}.{}",
        env!("CARGO_PKG_VERSION_MAJOR"),
        env!("CARGO_PKG_VERSION_MINOR")
    );
    for text in [of_c, of_cpp] {
        assert!(project.configure(&series, &text));
        done(Command::new("cmake").arg("--build").arg(project.build()));
        run(&project.build().join("shared"), None);
        run(&project.build().join("static"), None);
    }
}

#[test]
fn cmake_takes_versions_that_this_one_stands_in_for_and_no_others() {
    let Some(generator) = cmake_generator() else {
        return;
    };
    let folder = scratch("cmake-versions");
    let prefix = install(&folder);
    let project = Project {
        folder,
        prefix,
        generator,
    };
    let number = |text: &str| text.parse::<u32>().unwrap();
    let major = number(env!("CARGO_PKG_VERSION_MAJOR"));
    let minor = number(env!("CARGO_PKG_VERSION_MINOR"));
    let patch = number(env!("CARGO_PKG_VERSION_PATCH"));
    for good in [
        String::new(),
        format!("{major}.{minor}"),
        format!("{major}.{minor}.{patch}"),
        format!("{major}.{minor}.{patch} EXACT"),
    ] {
        assert!(project.configure(&good, ""), "{good}");
    }
    for bad in [
        format!("{major}.{minor}.{}", patch + 1),
        format!("{major}.{}", minor + 1),
        format!("{}.{minor}", major + 1),
        format!("{}", major + 1),
    ] {
        assert!(!project.configure(&bad, ""), "{bad}");
    }
}
