//! Each file imports what it uses, and nothing else; and what browsers refuse where naga does not.

use std::collections::{BTreeMap, BTreeSet};

use super::{Line, Module, ROOTS, definitions, exports, lines};

/// The words of WGSL code, without comments, members after a point and attributes' names.
fn words(code: &str) -> Vec<&str> {
    let mut words = Vec::new();
    for line in code.lines() {
        let line = line.split("//").next().unwrap_or_default();
        let mut rest = line;
        while let Some(start) = rest.find(|c: char| c.is_ascii_alphabetic() || c == '_') {
            let before = rest[..start].trim_end().chars().last();
            let word = &rest[start..];
            let end = word
                .find(|c: char| !(c.is_ascii_alphanumeric() || c == '_'))
                .unwrap_or(word.len());
            let is_suffix = rest[..start].ends_with(|c: char| c.is_ascii_digit());
            if !matches!(before, Some('.' | '@')) && !is_suffix {
                words.push(&word[..end]);
            }
            rest = &word[end..];
        }
    }
    words
}

fn code_of(file: &str, variant: &[&str]) -> String {
    lines(file, variant)
        .filter_map(|line| match line {
            Line::Code(line) => Some(line),
            _ => None,
        })
        .collect::<Vec<_>>()
        .join("\n")
}

/// Names that a file declares at its top level.
fn declared(code: &str) -> BTreeSet<&str> {
    let mut names = BTreeSet::new();
    let mut depth = 0;
    for line in code.lines() {
        let line = line.split("//").next().unwrap_or_default();
        if depth == 0 {
            // Attributes and address spaces aside, the name follows the keyword.
            let found = words(line);
            let keyword = found
                .iter()
                .position(|w| ["fn", "struct", "const", "override", "alias", "var"].contains(w));
            if let Some(at) = keyword {
                let address_space = [
                    "private",
                    "workgroup",
                    "uniform",
                    "storage",
                    "read",
                    "read_write",
                ];
                let name = found[at + 1..].iter().find(|w| !address_space.contains(w));
                names.extend(name);
            }
        }
        depth += line.matches('{').count();
        depth -= line.matches('}').count();
    }
    names
}

/// Names that a file declares within functions and structs: words before a colon, and after `let`
/// and `var`.
fn local(code: &str) -> BTreeSet<&str> {
    let mut names = BTreeSet::new();
    for line in code.lines() {
        let line = line.split("//").next().unwrap_or_default();
        let found = words(line);
        for pair in found.windows(2) {
            if ["let", "var"].contains(&pair[0]) {
                names.insert(pair[1]);
            }
        }
        for part in line.split(':') {
            names.extend(
                part.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_'))
                    .next_back(),
            );
        }
    }
    names
}

/// A file and all that it exports.
fn take_in(
    file: &'static str,
    variant: &[&str],
    by: &'static str,
    imports: &mut BTreeMap<&'static str, &'static str>,
) {
    imports.insert(file, by);
    for export in exports(file, variant) {
        take_in(export, variant, by, imports);
    }
}

#[test]
fn files_import_what_they_use() {
    let mut problems = BTreeSet::new();
    // Whether an import is of use in any variant.
    let mut used: BTreeMap<(&str, &str), bool> = BTreeMap::new();
    for root in ROOTS {
        for variant in definitions(root) {
            let mut module = Module::default();
            module.take_in(root, &variant);
            let code: BTreeMap<_, _> = module
                .files
                .iter()
                .map(|&file| (file, code_of(file, &variant)))
                .collect();
            let mut places: BTreeMap<&str, &str> = BTreeMap::new();
            for (&file, code) in &code {
                for name in declared(code) {
                    if let Some(other) = places.insert(name, file) {
                        problems.insert(format!("{name} is declared in {other} and {file}"));
                    }
                }
            }
            for (&file, code) in &code {
                let (own, local) = (declared(code), local(code));
                // With the line that brings each.
                let mut imports = BTreeMap::new();
                let mut expected = BTreeSet::new();
                for line in lines(file, &variant) {
                    match line {
                        Line::Import(import) => take_in(import, &variant, import, &mut imports),
                        Line::Expects(names) => expected.extend(names.split(", ")),
                        _ => {}
                    }
                }
                let exported = exports(file, &variant);
                for import in imports.values() {
                    *used.entry((file, import)).or_default() |= exported.contains(import);
                }
                for word in words(code) {
                    let Some(&place) = places.get(word) else {
                        continue;
                    };
                    if let Some(by) = imports.get(place) {
                        used.insert((file, by), true);
                    }
                    let known =
                        own.contains(word) || local.contains(word) || expected.contains(word);
                    if !known && !imports.contains_key(place) {
                        problems.insert(format!(
                            "{file} uses {word} of {place}, which it does not import"
                        ));
                    }
                }
                for name in expected {
                    if !places.contains_key(name) {
                        problems.insert(format!(
                            "{root} {variant:?} does not define {name}, which {file} expects"
                        ));
                    }
                }
            }
        }
    }
    // Imported for its entry point.
    let passed_on = ["shared/full_screen.wgsl"];
    for ((file, import), used) in used {
        if !used && !passed_on.contains(&import) {
            problems.insert(format!("{file} imports {import}, which it does not use"));
        }
    }
    let problems: Vec<_> = problems.into_iter().collect();
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn no_file_imports_itself_by_way_of_others() {
    fn reaches(
        from: &'static str,
        to: &str,
        variant: &[&str],
        seen: &mut BTreeSet<&'static str>,
    ) -> bool {
        lines(from, variant).any(|line| match line {
            Line::Import(import) => {
                import == to || (seen.insert(import) && reaches(import, to, variant, seen))
            }
            _ => false,
        })
    }
    for root in ROOTS {
        for variant in definitions(root) {
            let mut module = Module::default();
            module.take_in(root, &variant);
            for &file in &module.files {
                assert!(
                    !reaches(file, file, &variant, &mut BTreeSet::new()),
                    "{file} imports itself in {root} {variant:?}"
                );
            }
        }
    }
}

/// The first statement that has `&&` and `||` side by side, without parentheses between them.
fn without_parentheses(code: &str) -> Option<String> {
    let code: Vec<_> = code
        .lines()
        .map(|line| line.split("//").next().unwrap_or_default())
        .collect();
    let code = code.join("\n");
    // What stands at each depth of parentheses.
    let mut depths = vec![None];
    let mut start = 0;
    for (i, c) in code.char_indices() {
        match c {
            '(' | '[' => depths.push(None),
            ')' | ']' => drop(depths.pop()),
            ';' | '{' | '}' | ',' => {
                *depths.last_mut()? = None;
                start = i + 1;
            }
            '&' | '|' if code[i..].starts_with(&format!("{c}{c}")) => {
                let before = depths.last_mut()?.replace(c);
                if before.is_some_and(|before| before != c) {
                    let end = code[i..].find(';').map_or(code.len(), |n| i + n);
                    return Some(code[start..end].trim().to_owned());
                }
            }
            _ => {}
        }
    }
    None
}

/// WGSL's grammar wants parentheses, and browsers insist; naga takes it without.
#[test]
fn and_and_or_do_not_meet_without_parentheses() {
    assert!(without_parentheses("x = a || b && c;").is_some());
    assert!(
        without_parentheses("x = f(a && b, c) || (a && b);\nif a || b { y = c && d; }").is_none()
    );
    for root in ROOTS {
        for variant in definitions(root) {
            let mut module = Module::default();
            module.take_in(root, &variant);
            for file in &module.files {
                let found = without_parentheses(&code_of(file, &variant));
                assert_eq!(found, None, "{file}");
            }
        }
    }
}
