//! Directives in WGSL files, and the module that a file and its imports make.
//!
//! | directive | meaning |
//! |---|---|
//! | `#import shared/frame.wgsl` | takes in another file, from `src/`, once per module and before this file |
//! | `#export shared/vertex.wgsl` | the same; files that import this one may use the other's names too |
//! | `#expects band, queue` | names that the importing shader defines |
//! | `#variant REDUCED LAYERED` | the shader can be made with these names defined; without such a line it has one variant, with none |
//! | `#ifdef NAME`, `#ifndef NAME`, `#else`, `#endif` | lines for some variants; `TABLES` is defined where tables are textures |
//!
//! `enable` directives go to the beginning of the module. Tests hold each file to what it imports
//! and expects.

include!(concat!(env!("OUT_DIR"), "/shaders.rs"));

/// A shader file that nothing else imports, in one of its variants.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shader {
    file: &'static str,
    /// Names that are defined.
    variant: &'static [&'static str],
}

impl Shader {
    const fn plain(file: &'static str) -> Self {
        Self { file, variant: &[] }
    }

    /// The same file with these names defined, which are those of one of its `#variant` lines.
    pub(crate) const fn variant(self, variant: &'static [&'static str]) -> Self {
        Self { variant, ..self }
    }

    /// What tells it from others.
    pub(crate) const fn name(self) -> (&'static str, &'static [&'static str]) {
        (self.file, self.variant)
    }

    /// A file in each of its variants.
    #[cfg(test)]
    pub(crate) fn variants_of(file: &'static str) -> impl Iterator<Item = Self> {
        variants(file).map(move |names| Self {
            file,
            variant: names.leak(),
        })
    }

    /// Whether its file's name ends like this, or this is defined.
    #[cfg(test)]
    pub(crate) fn is_named(self, name: &str) -> bool {
        self.file.ends_with(name) || self.variant.contains(&name)
    }

    /// The module's source for a device whose tables are textures or buffers (`gpu/table.rs`).
    pub(crate) fn source(self, texture_tables: bool) -> String {
        assert!(
            variants(self.file).any(|v| v == self.variant),
            "{} has no variant {:?}",
            self.file,
            self.variant
        );
        let mut module = Module::default();
        module.take_in(self.file, &defined(self.variant, texture_tables));
        format!("{}{}", module.enables, module.text)
    }
}

/// The text of a file; the build has checked that imports exist.
fn text(file: &str) -> &'static str {
    let found = FILES.binary_search_by_key(&file, |&(name, _)| name);
    found.map_or("", |at| FILES[at].1)
}

/// The names that a variant defines, with what follows from the device: `TABLES` where tables are
/// textures, which they always are for the reduced renderer.
fn defined(variant: &[&'static str], texture_tables: bool) -> Vec<&'static str> {
    let mut names = variant.to_vec();
    if texture_tables || variant.contains(&"REDUCED") {
        names.push("TABLES");
    }
    names
}

/// All that a file is composed with: each variant, with buffers and with textures.
#[cfg(test)]
fn definitions(file: &str) -> impl Iterator<Item = Vec<&'static str>> {
    variants(file).flat_map(|v| [false, true].map(|texture_tables| defined(&v, texture_tables)))
}

/// The names that each variant of a file defines.
fn variants(file: &str) -> impl Iterator<Item = Vec<&'static str>> {
    let lines: Vec<_> = text(file)
        .lines()
        .filter_map(|line| line.trim().strip_prefix("#variant"))
        .map(|names| names.split_whitespace().collect())
        .collect();
    let plain = lines.is_empty().then(Vec::new);
    lines.into_iter().chain(plain)
}

/// Files that a file exports in one variant.
#[cfg(test)]
fn exports(file: &str, variant: &[&str]) -> Vec<&'static str> {
    lines(file, variant)
        .filter_map(|line| match line {
            Line::Import(import) if text(file).contains(&format!("#export {import}")) => {
                Some(import)
            }
            _ => None,
        })
        .collect()
}

/// What is left of a line in one variant.
enum Line<'a> {
    Import(&'a str),
    #[cfg_attr(not(test), expect(dead_code, reason = "tests read the names"))]
    Expects(&'a str),
    Enable(&'a str),
    Code(&'a str),
}

/// A file's lines in one variant, without its conditions and its list of variants.
fn lines(file: &str, variant: &[&str]) -> impl Iterator<Item = Line<'static>> {
    let mut taken = vec![true];
    text(file).lines().filter_map(move |line| {
        let is_defined = |name: &str| variant.contains(&name.trim());
        let all = taken.iter().all(|&t| t);
        let Some(directive) = line.trim_start().strip_prefix('#') else {
            return match all {
                true if line.starts_with("enable ") => Some(Line::Enable(line)),
                true => Some(Line::Code(line)),
                false => None,
            };
        };
        let (word, rest) = directive.split_once(' ').unwrap_or((directive, ""));
        match word {
            "ifdef" => taken.push(is_defined(rest)),
            "ifndef" => taken.push(!is_defined(rest)),
            "else" => taken.iter_mut().rev().take(1).for_each(|t| *t = !*t),
            "endif" => drop(taken.pop()),
            "import" | "export" if all => return Some(Line::Import(rest.trim())),
            "expects" if all => return Some(Line::Expects(rest.trim())),
            "import" | "export" | "expects" | "variant" => {}
            // The build has refused all others.
            _ => {}
        }
        None
    })
}

#[derive(Default)]
struct Module {
    files: Vec<&'static str>,
    enables: String,
    text: String,
}

impl Module {
    fn take_in(&mut self, file: &'static str, variant: &[&str]) {
        if self.files.contains(&file) {
            return;
        }
        self.files.push(file);
        // Where an error of the compiler's comes from.
        let mut own = format!("// src/{file}\n");
        for line in lines(file, variant) {
            match line {
                Line::Import(import) => self.take_in(import, variant),
                Line::Expects(_) => {}
                Line::Enable(line) => self.enables.extend([line, "\n"]),
                Line::Code(line) => own.extend([line, "\n"]),
            }
        }
        self.text.push_str(&own);
    }
}

#[cfg(test)]
mod tests;
