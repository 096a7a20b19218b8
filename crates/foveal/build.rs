//! Makes a table of the crate's shader files (`src/**/*.wgsl`), and a constant for each that no
//! other imports: `src/rate/owner.wgsl` becomes `RATE_OWNER`. `src/shader/compose.rs` reads the
//! directives.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() {
    println!("cargo::rerun-if-changed=src");
    let root = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it")).join("src");
    let mut files = BTreeMap::new();
    collect(&root, &root, &mut files);
    let imported: Vec<&str> = files.values().flat_map(|text| imports(text)).collect();
    for (name, text) in &files {
        check_directives(name, text);
        for import in imports(text) {
            assert!(
                files.contains_key(import),
                "src/{name}: `{import}` is imported, but there is no src/{import}"
            );
        }
    }
    let mut code = String::from("static FILES: &[(&str, &str)] = &[\n");
    for name in files.keys() {
        let _ = writeln!(code, "    ({name:?}, {:?}),", files[name]);
    }
    code.push_str("];\n");
    let roots: Vec<&String> = files
        .keys()
        .filter(|name| !imported.contains(&name.as_str()))
        .collect();
    for name in &roots {
        let constant = name
            .trim_end_matches(".wgsl")
            .replace('/', "_")
            .to_uppercase();
        let _ = writeln!(
            code,
            "/// `{name}`.\npub(crate) const {constant}: Shader = Shader::plain({name:?});"
        );
    }
    let _ = writeln!(
        code,
        "#[cfg(test)]\npub(crate) const ROOTS: &[&str] = &{roots:?};"
    );
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets it")).join("shaders.rs");
    fs::write(&out, code).expect("the output folder can be written to");
}

fn collect(root: &Path, folder: &Path, files: &mut BTreeMap<String, String>) {
    for entry in fs::read_dir(folder).expect("the sources can be listed") {
        let path = entry.expect("the sources can be listed").path();
        let is_hidden = path
            .file_name()
            .is_some_and(|n| n.to_string_lossy().starts_with('.'));
        if is_hidden {
            continue;
        }
        if path.is_dir() {
            collect(root, &path, files);
        } else if path.extension().is_some_and(|e| e == "wgsl") {
            let name = path.strip_prefix(root).expect("it lies below");
            let name = name.to_str().expect("names are ASCII").replace('\\', "/");
            let text = fs::read_to_string(&path).expect("the sources can be read");
            files.insert(name, text);
        }
    }
}

/// The files that a shader imports, in any of its variants.
fn imports(text: &str) -> impl Iterator<Item = &str> {
    text.lines()
        .filter_map(|line| {
            let line = line.trim();
            line.strip_prefix("#import ")
                .or(line.strip_prefix("#export "))
        })
        .map(str::trim)
}

/// Every directive is known, and conditions are closed.
fn check_directives(name: &str, text: &str) {
    // Of each condition that is open: whether its `#else` was there.
    let mut open = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        let Some(directive) = line.trim().strip_prefix('#') else {
            continue;
        };
        let word = directive.split(' ').next().unwrap_or_default();
        let is_right = match word {
            "import" | "export" | "expects" => directive.len() > word.len(),
            "variant" => open.is_empty(),
            "ifdef" | "ifndef" => {
                open.push(false);
                directive.split(' ').count() == 2
            }
            "else" => open
                .last_mut()
                .is_some_and(|seen| !std::mem::replace(seen, true)),
            "endif" => open.pop().is_some(),
            _ => false,
        };
        assert!(is_right, "src/{name}:{number}: '{line}' cannot stand here");
    }
    assert!(open.is_empty(), "src/{name}: an #ifdef is not closed");
}
