//! Every source file with unsafe code is in the list of ARCHITECTURE.md, with its proof.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// The source files below a folder; tests of a crate have no proofs to give.
fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

/// Whether a line of code, not of a comment, has unsafe code.
fn is_unsafe(line: &str) -> bool {
    let code = line.split("//").next().unwrap_or_default();
    [
        "unsafe {",
        "unsafe fn",
        "unsafe impl",
        "unsafe trait",
        "unsafe extern",
        "unsafe(",
    ]
    .iter()
    .any(|word| code.contains(word))
}

#[test]
fn every_file_with_unsafe_code_is_in_the_list_with_its_proof() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut files = Vec::new();
    for entry in fs::read_dir(root.join("crates")).unwrap() {
        sources(&entry.unwrap().path().join("src"), &mut files);
    }
    sources(&root.join("integrations"), &mut files);
    let page = fs::read_to_string(root.join("ARCHITECTURE.md")).unwrap();
    let section = page.split("## Unsafe code").nth(1).unwrap();
    let section = section.split("\n## ").next().unwrap();
    let mut listed = BTreeSet::new();
    for row in section.lines().filter(|line| line.starts_with("| `")) {
        let mut cells = row.split('|').skip(1);
        let names: Vec<&str> = cells
            .next()
            .unwrap()
            .split('`')
            .skip(1)
            .step_by(2)
            .collect();
        let proof = cells.nth(1).unwrap_or_default().trim();
        assert!(proof.len() > 20, "no proof: {row}");
        let start = names[0].split("/src/").next().unwrap();
        for name in &names {
            let name = name.strip_prefix(&format!("{start}/src/")).unwrap_or(name);
            listed.insert(format!("{start}/src/{name}"));
        }
    }
    let name = |path: &Path| {
        let path = path.strip_prefix(root.join("crates")).unwrap_or(path);
        path.to_str().unwrap().replace('\\', "/")
    };
    let found: BTreeSet<String> = files
        .iter()
        // Models and unit tests of their own.
        .filter(|path| !path.ends_with("workers/model.rs"))
        .filter(|path| fs::read_to_string(path).unwrap().lines().any(is_unsafe))
        .map(|path| name(path))
        .collect();
    assert_eq!(found, listed);
    assert!(found.len() > 10, "{found:?}");
}
