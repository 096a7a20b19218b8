//! The interface takes plain numbers.
#![allow(clippy::unwrap_used, reason = "tests")]

use std::path::Path;

/// Types of the library that does the arithmetic inside.
const FOREIGN: [&str; 9] = [
    "glam::", "DVec", "Vec3", "Vec4", "Mat3", "Mat4", "Affine3", "Quat", "Vec2",
];

fn files(folder: &Path, found: &mut Vec<std::path::PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files(&path, found);
        } else {
            found.push(path);
        }
    }
}

/// Public items of a file up to their body, and public fields.
fn declarations(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut open: Option<String> = None;
    for line in text.lines().take_while(|l| !l.starts_with("#[cfg(test)]")) {
        let line = line.trim();
        if line.starts_with("pub ") && open.is_none() {
            open = Some(String::new());
        }
        if let Some(text) = &mut open {
            text.push_str(line);
            text.push(' ');
            if line.ends_with(['{', ';', ','])
                && text.matches('(').count() == text.matches(')').count()
            {
                found.extend(open.take());
            }
        }
    }
    found
}

#[test]
fn no_public_item_names_a_foreign_maths_type() {
    let mut paths = Vec::new();
    files(
        &Path::new(env!("CARGO_MANIFEST_DIR")).join("src"),
        &mut paths,
    );
    let mut count = 0;
    for path in paths {
        let text = std::fs::read_to_string(&path).unwrap();
        for item in declarations(&text) {
            count += 1;
            let foreign = FOREIGN.iter().find(|f| item.contains(**f));
            assert!(foreign.is_none(), "{}: {item}", path.display());
        }
    }
    assert!(count > 100, "{count}");
    let bad = declarations("    pub fn a(\n        b: f32,\n        c: DVec3,\n    ) -> f32 {\n");
    assert!(bad.len() == 1 && bad[0].contains("DVec3"), "{bad:?}");
}
