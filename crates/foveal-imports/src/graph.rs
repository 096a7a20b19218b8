//! Files, who imports whom, and the circles among them.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::{Path, PathBuf};

/// Files that all import each other, directly or through others.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Circle {
    /// The files, by their path within `src`, sorted.
    pub files: Vec<PathBuf>,
    /// Who imports whom within the circle.
    pub imports: Vec<(PathBuf, PathBuf)>,
}

impl fmt::Display for Circle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (from, to) in &self.imports {
            writeln!(f, "{} imports {}", from.display(), to.display())?;
        }
        Ok(())
    }
}

/// Which file imports which.
#[derive(Debug, Default)]
pub(crate) struct Imports(BTreeMap<PathBuf, BTreeSet<PathBuf>>);

impl Imports {
    pub(crate) fn add(&mut self, from: &Path, to: &Path) {
        if from != to {
            let of = self.0.entry(from.to_path_buf()).or_default();
            of.insert(to.to_path_buf());
        }
    }

    /// All files that `from` imports, directly or through others.
    fn reached(&self, from: &Path) -> BTreeSet<&Path> {
        let (mut reached, mut open) = (BTreeSet::new(), vec![from]);
        while let Some(file) = open.pop() {
            for to in self.0.get(file).into_iter().flatten() {
                if reached.insert(to.as_path()) {
                    open.push(to);
                }
            }
        }
        reached
    }

    pub(crate) fn circles(&self) -> Vec<Circle> {
        let reached: BTreeMap<&Path, _> = self
            .0
            .keys()
            .map(|file| (file.as_path(), self.reached(file)))
            .collect();
        let mut done = BTreeSet::new();
        let mut circles = Vec::new();
        for (&file, to) in &reached {
            if !to.contains(file) || done.contains(file) {
                continue;
            }
            let back = |f: &&Path| reached.get(*f).is_some_and(|r| r.contains(file));
            let files: BTreeSet<&Path> = to.iter().copied().filter(|f| back(f)).collect();
            let within = |(from, to): (&PathBuf, &PathBuf)| {
                files.contains(from.as_path()) && files.contains(to.as_path())
            };
            let imports = self
                .0
                .iter()
                .flat_map(|(from, to)| to.iter().map(move |to| (from, to)))
                .filter(|&pair| within(pair))
                .map(|(from, to)| (from.clone(), to.clone()))
                .collect();
            done.extend(files.iter().copied());
            circles.push(Circle {
                files: files.into_iter().map(Path::to_path_buf).collect(),
                imports,
            });
        }
        circles
    }
}
