//! A short run of every target; `./run fuzz` is the long one.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "tests")]

use std::time::Duration;

use foveal_fuzz::{Campaign, Counting, TARGETS};

#[global_allocator]
static COUNTING: Counting = Counting;

/// Three seconds of each target, and other inputs from `FOVEAL_FUZZ_SEED` on.
#[test]
fn some_seconds_of_each_target_find_nothing() {
    let seed = std::env::var("FOVEAL_FUZZ_SEED").map_or(0, |v| v.parse().unwrap());
    let folder = tempfile::tempdir().unwrap();
    for target in TARGETS {
        let campaign = Campaign {
            failures: folder.path().to_owned(),
            // The machine may be busy with other tests.
            patience: Duration::from_secs(60),
            ..Campaign::new(3, seed)
        };
        let outcome = campaign.run(target);
        println!(
            "{}: {} inputs, at most {:.1} MB each",
            target.name,
            outcome.inputs,
            outcome.most_bytes as f64 / 1e6
        );
        assert!(outcome.failures.is_empty(), "{:?}", outcome.failures);
        assert!(outcome.inputs > 10 && outcome.most_bytes > 0, "{target:?}");
    }
}

/// `cargo fuzz` runs the same targets: each has its file, and is named in the manifest.
#[test]
fn every_target_is_one_of_cargo_fuzz() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz");
    let manifest = std::fs::read_to_string(root.join("Cargo.toml")).unwrap();
    let mut files: Vec<String> = std::fs::read_dir(root.join("fuzz_targets"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    files.sort();
    let names = TARGETS.iter().map(|t| format!("{}.rs", t.name));
    assert_eq!(files, names.collect::<Vec<_>>());
    for target in TARGETS {
        let name = target.name;
        assert!(manifest.contains(&format!("name = \"{name}\"")), "{name}");
        let file = root.join(format!("fuzz_targets/{name}.rs"));
        let text = std::fs::read_to_string(file).unwrap();
        assert!(
            text.contains(&format!("foveal_fuzz::{name}(input)")),
            "{name}"
        );
    }
}
