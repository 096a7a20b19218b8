//! The examples in C and C++, built and run as a user does, and under sanitizers.
#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{Language, compiler, crate_dir, done, library_dir, program, scratch};
use std::path::Path;
use std::process::Command;

const EXAMPLES: [(&str, Language); 7] = [
    ("examples/street.c", Language::C),
    ("examples/jobs.cpp", Language::Cpp),
    ("tests/moc_shim.cpp", Language::Cpp),
    ("tests/macros.cpp", Language::Cpp),
    ("tests/occludees.c", Language::C),
    ("examples/shadows.c", Language::C),
    ("tests/receivers.cpp", Language::Cpp),
];

fn run(program: &Path) -> String {
    // Some containers do not let a program look at itself as the leak detector does.
    let output = done(Command::new(program).env("ASAN_OPTIONS", "detect_leaks=0"));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn examples_run_with_the_static_library() {
    let folder = scratch("static");
    let outputs = EXAMPLES
        .map(|(source, language)| run(&program(language, &crate_dir().join(source), &folder, &[])));
    assert!(outputs[0].contains("400 carts"), "{}", outputs[0]);
    assert!(
        outputs[1].contains("no occluder with this id")
            && outputs[1].contains("'ids'[2399]: the set has no occludee with this id"),
        "{}",
        outputs[1]
    );
    assert!(outputs[4].contains("carts hidden"), "{}", outputs[4]);
    assert!(
        outputs[5].contains("of 6 shadow maps are drawn"),
        "{}",
        outputs[5]
    );
}

#[test]
fn examples_run_with_the_shared_library() {
    let folder = scratch("shared");
    let name = if cfg!(target_os = "macos") {
        "libfoveal_cull_c.dylib"
    } else {
        "libfoveal_cull_c.so"
    };
    let library = library_dir().join(name);
    assert!(library.exists(), "{}", library.display());
    // Under the name by which the dynamic linker looks for it.
    let (major, minor) = (
        env!("CARGO_PKG_VERSION_MAJOR"),
        env!("CARGO_PKG_VERSION_MINOR"),
    );
    std::fs::copy(&library, folder.join(name)).unwrap();
    std::fs::copy(&library, folder.join(format!("{name}.{major}.{minor}"))).unwrap();
    let program = folder.join("street");
    let mut command = compiler(Language::C);
    command
        .arg(crate_dir().join(EXAMPLES[0].0))
        .arg("-o")
        .arg(&program);
    done(command.arg("-L").arg(&folder).arg("-lfoveal_cull_c"));
    let output = done(Command::new(&program).env("LD_LIBRARY_PATH", &folder));
    assert!(String::from_utf8_lossy(&output.stdout).contains("400 carts"));
}

#[test]
fn examples_are_clean_under_sanitizers() {
    let folder = scratch("sanitizers");
    let probe = folder.join("probe.c");
    std::fs::write(&probe, "int main(void) { return 0; }\n").unwrap();
    let flags = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"];
    let out = folder.join("probe");
    let built = compiler(Language::C)
        .args(flags)
        .arg(&probe)
        .arg("-o")
        .arg(&out)
        .output();
    let runs = built.is_ok_and(|o| o.status.success())
        && Command::new(&out).status().is_ok_and(|s| s.success());
    if !runs {
        println!("skipped: the compiler lacks {}", flags[0]);
        return;
    }
    for (source, language) in EXAMPLES {
        run(&program(
            language,
            &crate_dir().join(source),
            &folder,
            &flags,
        ));
    }
}

#[test]
fn what_is_installed_is_found_by_pkg_config_and_by_cmake() {
    let folder = scratch("installed");
    let prefix = folder.join("prefix");
    let mut install = Command::new(crate_dir().join("install.sh"));
    let said = done(install.arg(&prefix).arg("--from").arg(library_dir()));
    let said = String::from_utf8(said.stdout).unwrap();
    assert!(said.contains(env!("CARGO_PKG_VERSION")), "{said}");
    let source = crate_dir().join(EXAMPLES[0].0);
    let has = |name: &str| {
        let found = Command::new(name).arg("--version").output();
        let found = found.is_ok_and(|o| o.status.success());
        if !found {
            println!("skipped: there is no {name}");
        }
        found
    };
    if has("pkg-config") {
        let mut flags = Command::new("pkg-config");
        flags.env("PKG_CONFIG_PATH", prefix.join("lib/pkgconfig"));
        let flags = done(flags.args(["--cflags", "--libs", "--static", "foveal_cull"]));
        let flags = String::from_utf8(flags.stdout).unwrap();
        let program = folder.join("street");
        // The headers of the installation, not of the repository.
        let mut command = Command::new("cc");
        command.arg(&source).arg("-o").arg(&program);
        done(command.args(flags.split_whitespace()));
        done(Command::new(&program).env("LD_LIBRARY_PATH", prefix.join("lib")));
    }
    if has("cmake") {
        let project = folder.join("project");
        std::fs::create_dir_all(&project).unwrap();
        let jobs = crate_dir().join(EXAMPLES[1].0);
        let text = format!(
            "cmake_minimum_required(VERSION 3.16)\nproject(user C CXX)\n\
             find_package(foveal_cull {} CONFIG REQUIRED)\nfind_package(Threads REQUIRED)\n\
             add_executable(street {})\ntarget_link_libraries(street foveal::cull)\n\
             add_executable(jobs {})\ntarget_compile_features(jobs PRIVATE cxx_std_17)\n\
             target_link_libraries(jobs foveal::cull_static Threads::Threads)\n",
            env!("CARGO_PKG_VERSION"),
            source.display(),
            jobs.display()
        );
        std::fs::write(project.join("CMakeLists.txt"), text).unwrap();
        let build = folder.join("build");
        let mut configure = Command::new("cmake");
        configure.arg("-S").arg(&project).arg("-B").arg(&build);
        let mut at = std::ffi::OsString::from("-DCMAKE_PREFIX_PATH=");
        at.push(&prefix);
        done(configure.arg(at));
        done(Command::new("cmake").arg("--build").arg(&build));
        done(&mut Command::new(build.join("street")));
        done(&mut Command::new(build.join("jobs")));
    }
}
