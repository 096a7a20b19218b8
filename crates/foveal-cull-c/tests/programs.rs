//! The examples in C and C++, built and run as a user does, and under sanitizers.
#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{Language, compiler, crate_dir, done, library_dir, program, scratch};
use std::path::Path;
use std::process::Command;

const EXAMPLES: [(&str, Language); 9] = [
    ("examples/street.c", Language::C),
    ("examples/jobs.cpp", Language::Cpp),
    ("tests/moc_shim.cpp", Language::Cpp),
    ("tests/macros.cpp", Language::Cpp),
    ("tests/occludees.c", Language::C),
    ("examples/shadows.c", Language::C),
    ("tests/receivers.cpp", Language::Cpp),
    ("tests/usefulness.cpp", Language::Cpp),
    ("tests/mesh_options.cpp", Language::Cpp),
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
