//! Circles among the source files of a crate.
//!
//! A file imports another one if a path in it (`crate::`, `super::`, `self::` or a child module's
//! name) leads to an item of that file. Paths are followed through re-exports to the file that
//! declares the item, so a `mod.rs` that only re-exports is a façade and joins nothing. Code under
//! `#[cfg(test)]` does not count. Methods that are called on a value leave no path and are not
//! seen.
//!
//! ```
//! let folder = env!("CARGO_MANIFEST_DIR");
//! assert_eq!(foveal_imports::circles(folder)?, []);
//! # Ok::<(), std::io::Error>(())
//! ```

mod graph;
mod modules;
mod tokens;

pub use graph::Circle;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Finds all circles among the files of the crate in `folder` (which holds `src`), in the order of
/// their first file.
///
/// # Errors
/// An I/O error if a source file cannot be read.
pub fn circles(folder: impl AsRef<Path>) -> std::io::Result<Vec<Circle>> {
    let src = folder.as_ref().join("src");
    let mut files = BTreeMap::new();
    collect(&src, &src, &mut files)?;
    Ok(circles_of(&files))
}

/// Circles among files by their path within `src`.
fn circles_of(files: &BTreeMap<PathBuf, String>) -> Vec<Circle> {
    let mut imports = graph::Imports::default();
    for root in ["lib.rs", "main.rs"] {
        if files.contains_key(Path::new(root)) {
            modules::Modules::of(Path::new(root), files).add_imports(&mut imports);
        }
    }
    imports.circles()
}

/// Reads every `.rs` file below `folder`.
fn collect(
    folder: &Path,
    src: &Path,
    files: &mut BTreeMap<PathBuf, String>,
) -> std::io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            collect(&path, src, files)?;
        } else if path.extension().is_some_and(|e| e == "rs") {
            let name = path.strip_prefix(src).unwrap_or(&path).to_path_buf();
            files.insert(name, std::fs::read_to_string(&path)?);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(files: &[(&str, &str)]) -> Vec<Vec<String>> {
        let files = files
            .iter()
            .map(|(path, text)| (PathBuf::from(path), (*text).to_owned()))
            .collect();
        circles_of(&files)
            .iter()
            .map(|c| c.files.iter().map(|f| f.display().to_string()).collect())
            .collect()
    }

    #[test]
    fn two_files_that_import_each_other_are_a_circle() {
        let a = ("a.rs", "use crate::b::B;\npub struct A(B);");
        let b = ("b.rs", "pub struct B;\nfn f(_: &crate::a::A) {}");
        assert_eq!(
            found(&[("lib.rs", "mod a;\nmod b;"), a, b]),
            [["a.rs", "b.rs"]]
        );
        let free = ("b.rs", "pub struct B;");
        assert!(found(&[("lib.rs", "mod a;\nmod b;"), a, free]).is_empty());
    }

    #[test]
    fn a_circle_through_three_files_in_folders_is_one() {
        let files = [
            ("main.rs", "mod x; mod y;\nfn main() { x::one::f() }"),
            ("x/mod.rs", "pub(crate) mod one;\npub(crate) mod two;"),
            (
                "x/one.rs",
                "use super::two::{self, g};\npub(crate) fn f() { g(); two::g() }",
            ),
            ("x/two.rs", "pub(crate) fn g() { crate::y::h() }"),
            (
                "y.rs",
                "use crate::x::{one::f as again};\npub(crate) fn h() { again() }",
            ),
        ];
        assert_eq!(found(&files), [["x/one.rs", "x/two.rs", "y.rs"]]);
    }

    #[test]
    fn a_parent_that_its_children_use_is_a_circle_and_a_facade_is_none() {
        let child = ("p/c.rs", "use super::T;\npub fn f(_: T) {}");
        let parent = ("p/mod.rs", "mod c;\npub use c::f;\npub struct T;");
        assert_eq!(
            found(&[("lib.rs", "mod p;"), parent, child]),
            [["p/c.rs", "p/mod.rs"]]
        );
        let facade = ("p/mod.rs", "mod c;\nmod t;\npub use c::f;\npub use t::T;");
        let own = ("p/t.rs", "pub struct T;");
        assert!(found(&[("lib.rs", "mod p;"), facade, child, own]).is_empty());
    }

    #[test]
    fn tests_comments_strings_and_visibility_do_not_count() {
        let a = (
            "a.rs",
            "//! crate::b\nuse crate::b::B;\npub struct A(B);\npub(in crate::b) fn f<'a>(c: char) -> bool { c == '\"' }",
        );
        let b = (
            "b.rs",
            "/* /* */ crate::a::A */\npub struct B;\nconst S: &str = \"crate::a::A\";\nconst R: &str = r#\"\"crate::a\"#;\n\
             #[cfg(test)]\nmod tests {\n    use crate::a::A;\n    fn f() { if true { } }\n}\n\
             #[cfg(all(test, unix))]\nuse crate::a::A;\n#[cfg(test)] mod more;",
        );
        let more = ("b/more.rs", "use crate::a::A;");
        let lib = ("lib.rs", "mod a;\nmod b;");
        assert!(found(&[lib, a, b, more]).is_empty());
        let with_feature = (
            "b.rs",
            "pub struct B;\n#[cfg(any(test, feature = \"x\"))]\nuse crate::a::A;",
        );
        assert_eq!(found(&[lib, a, with_feature]).len(), 1);
    }

    #[test]
    fn re_exports_and_globs_of_the_root_lead_to_the_file_that_declares() {
        let lib = (
            "lib.rs",
            "mod a;\nmod b;\nmod c;\npub use a::A;\npub use c::*;",
        );
        let a = ("a.rs", "pub struct A;\nfn f(_: crate::b::B) {}");
        let b = ("b.rs", "pub struct B(crate::A);");
        let c = ("c.rs", "pub struct C;");
        assert_eq!(found(&[lib, a, b, c]), [["a.rs", "b.rs"]]);
        let b = ("b.rs", "use crate::C;\npub struct B(C);");
        let c = ("c.rs", "pub struct C;\nfn f(_: crate::b::B) {}");
        assert_eq!(found(&[lib, a, b, c]), [["b.rs", "c.rs"]]);
    }

    #[test]
    fn macros_that_name_paths_count_where_they_are_written() {
        let lib = ("lib.rs", "mod a;\nmod b;");
        let a = (
            "a.rs",
            "macro_rules! m { ($e:expr) => { $crate::b::f($e) } }\npub(crate) use m;",
        );
        let b = (
            "b.rs",
            "use crate::a::m;\npub(crate) fn f(_: u32) {}\nfn g() { m!(1) }",
        );
        assert_eq!(found(&[lib, a, b]), [["a.rs", "b.rs"]]);
    }
}
