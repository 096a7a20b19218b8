//! Links of the documentation: every one leads to a file, and to a heading that is there; the book
//! names every page.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

use std::collections::BTreeSet;
use std::fs;
use std::path::{Component, Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The Markdown files that people read, by their paths from the root.
fn pages() -> Vec<PathBuf> {
    let root = root();
    let mut pages = Vec::new();
    let mut folders = vec![PathBuf::new(), "docs".into()];
    folders.extend(subfolders(Path::new("docs")));
    folders.extend(subfolders(Path::new("crates")));
    folders.extend(subfolders(Path::new("integrations")));
    for folder in folders {
        for entry in fs::read_dir(root.join(&folder)).unwrap() {
            let name = PathBuf::from(entry.unwrap().file_name());
            if name.extension().is_some_and(|e| e == "md") {
                pages.push(folder.join(name));
            }
        }
    }
    pages.sort();
    pages
}

fn subfolders(folder: &Path) -> Vec<PathBuf> {
    fs::read_dir(root().join(folder))
        .unwrap()
        .map(|entry| entry.unwrap())
        .filter(|entry| entry.path().is_dir())
        .map(|entry| folder.join(entry.file_name()))
        .collect()
}

/// A page without its blocks and spans of code.
fn prose(text: &str) -> String {
    let mut out = String::new();
    let mut is_code = false;
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            is_code = !is_code;
        } else if !is_code {
            // Parts between single backquotes are code.
            let parts = line.split('`').step_by(2).collect::<Vec<_>>();
            out.push_str(&parts.join("`"));
            out.push('\n');
        }
    }
    out
}

/// Targets of `[text](target)` and `![text](target)`.
fn links(text: &str) -> Vec<String> {
    let prose = prose(text);
    let ends = prose.split("](").skip(1);
    ends.filter_map(|rest| Some(rest.split_once(')')?.0.to_owned()))
        .collect()
}

/// Anchors of a page's headings, as websites for Markdown make them: lower case, letters, digits,
/// hyphens and underscores, spaces as hyphens.
fn anchors(text: &str) -> BTreeSet<String> {
    let mut is_code = false;
    let mut found = BTreeSet::new();
    for line in text.lines() {
        if line.starts_with("```") {
            is_code = !is_code;
        }
        if is_code || !line.starts_with('#') {
            continue;
        }
        let anchor = line.trim_start_matches('#').trim().chars();
        let anchor = anchor.filter_map(|c| match c {
            ' ' => Some('-'),
            c if c.is_alphanumeric() || c == '-' || c == '_' => Some(c.to_ascii_lowercase()),
            _ => None,
        });
        found.insert(anchor.collect());
    }
    found
}

/// `a/b/../c` as `a/c`.
fn plain(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => {
                assert!(out.pop(), "{} leads out of the repository", path.display())
            }
            Component::CurDir => {}
            part => out.push(part),
        }
    }
    out
}

#[test]
fn every_link_leads_somewhere() {
    let root = root();
    let mut checked = 0;
    for page in pages() {
        let text = fs::read_to_string(root.join(&page)).unwrap();
        for link in links(&text) {
            if link.contains("://") {
                continue;
            }
            let (file, anchor) = link.split_once('#').unwrap_or((&link, ""));
            let target = match file {
                "" => page.clone(),
                // The summary lies at the root of the book.
                _ if page.ends_with("book/SUMMARY.md") => PathBuf::from(file),
                _ => plain(&page.parent().unwrap().join(file)),
            };
            let at = format!("{}: ({link})", page.display());
            assert!(
                root.join(&target).exists(),
                "{at}: there is no {}",
                target.display()
            );
            if !anchor.is_empty() {
                let text = fs::read_to_string(root.join(&target)).unwrap();
                assert!(
                    anchors(&text).contains(anchor),
                    "{at}: there is no heading #{anchor}"
                );
            }
            checked += 1;
        }
    }
    assert!(checked > 100, "{checked} links were found");
}

#[test]
fn the_book_names_every_page() {
    let summary = fs::read_to_string(root().join("docs/book/SUMMARY.md")).unwrap();
    let named: BTreeSet<PathBuf> = links(&summary).into_iter().map(PathBuf::from).collect();
    let there: BTreeSet<PathBuf> = pages()
        .into_iter()
        .filter(|page| !page.ends_with("SUMMARY.md"))
        // Written by a command, for whoever runs it.
        .filter(|page| !page.starts_with("docs/benchmarks/generated"))
        .collect();
    let missing: Vec<_> = there.difference(&named).collect();
    assert!(missing.is_empty(), "docs/book/SUMMARY.md lacks {missing:?}");
    assert!(named.is_subset(&there), "{:?}", named.difference(&there));
}

#[test]
fn links_in_code_are_none() {
    let text = "See [a](b.md#c-d) and `[x](y)`.\n```\n[p](q)\n```\n![i](j.png)";
    assert_eq!(links(text), ["b.md#c-d", "j.png"]);
    assert!(anchors("## Add a *stage*, `x_y`").contains("add-a-stage-x_y"));
}
