//! The material libraries that an OBJ file names.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use super::builder::Builder;
use super::lines::unquoted;
use super::mtl;
use crate::gltf::Resolver;
use crate::{Code, Warning};

/// Most material libraries of a file.
pub(super) const MAX_LIBRARIES: usize = 64;

pub(super) const TOO_MANY_LIBRARIES: &str = "names more than 64 material libraries";

/// The materials that faces use, as far as they are found.
pub(super) struct Materials<'a> {
    used: &'a [String],
    number_of: HashMap<&'a str, usize>,
    /// Of each in use: its number in the document.
    found: Vec<Option<usize>>,
    /// Names of the libraries that are read, or cannot be.
    tried: HashSet<String>,
    resolver: &'a Resolver<'a>,
    builder: &'a mut Builder,
    notes: &'a mut Vec<Warning>,
}

impl<'a> Materials<'a> {
    pub(super) fn new(
        used: &'a [String],
        resolver: &'a Resolver<'a>,
        builder: &'a mut Builder,
        notes: &'a mut Vec<Warning>,
    ) -> Self {
        let numbers = used.iter().enumerate();
        Self {
            used,
            number_of: numbers.map(|(i, name)| (name.as_str(), i)).collect(),
            found: vec![None; used.len()],
            tried: HashSet::new(),
            resolver,
            builder,
            notes,
        }
    }

    /// Reads what a line names: one library with blanks in its name, or several.
    pub(super) fn read(&mut self, line: &str) {
        let line = unquoted(line).replace('\\', "/");
        let Err(cause) = self.read_one(&line) else {
            return;
        };
        let causes = if line.contains(char::is_whitespace) {
            // Several names, it is none itself.
            self.tried.remove(&line);
            self.read_each(&line).unwrap_or_else(|| vec![cause])
        } else {
            vec![cause]
        };
        for cause in causes {
            let text = format!("mtllib: {cause}");
            self.notes
                .push(Warning::new(Code::MaterialUnreadable, text));
        }
    }

    /// Reads the libraries of a line; tells of those that cannot be, or nothing where none can.
    fn read_each(&mut self, line: &str) -> Option<Vec<String>> {
        let mut causes = Vec::new();
        let mut has_read = false;
        for name in line.split_whitespace().take_while(|w| !w.starts_with('#')) {
            match self.read_one(unquoted(name)) {
                Ok(()) => has_read = true,
                Err(cause) if cause == TOO_MANY_LIBRARIES => {
                    causes.push(cause);
                    return Some(causes);
                }
                Err(cause) => causes.push(cause),
            }
        }
        has_read.then_some(causes)
    }

    /// Reads the library of the OBJ file's own name, where materials are missing: both may have been
    /// renamed.
    pub(super) fn read_own(&mut self, file: &str) {
        let own = Path::new(file).with_extension("mtl");
        let own = own.file_name().and_then(|name| name.to_str());
        if let Some(own) = own
            && self.found.contains(&None)
        {
            // It need not be there.
            let _ = self.read_one(own);
        }
    }

    /// Reads a library, once. One in folders that are not there, as those of another machine, is looked
    /// for beside the OBJ file.
    fn read_one(&mut self, name: &str) -> Result<(), String> {
        let beside = name.rsplit_once('/').map(|(_, beside)| beside);
        match (self.read_at(name), beside) {
            (Err(cause), Some(beside)) => self.read_at(beside).map_err(|_| cause),
            (result, _) => result,
        }
    }

    fn read_at(&mut self, name: &str) -> Result<(), String> {
        if self.tried.contains(name) {
            return Ok(());
        }
        if self.tried.len() == MAX_LIBRARIES {
            return Err(TOO_MANY_LIBRARIES.to_owned());
        }
        self.tried.insert(name.to_owned());
        let bytes = (self.resolver)(name)?;
        let folder = name.rsplit_once('/').map_or("", |(folder, _)| folder);
        for material in mtl::parse(&bytes) {
            let Some(&number) = self.number_of.get(material.name.as_str()) else {
                continue;
            };
            // The first of a name holds.
            if self.found[number].is_none() {
                let surface = material.surface(folder, self.builder, self.notes);
                self.found[number] = Some(self.builder.material(&surface));
            }
        }
        Ok(())
    }

    /// The number of each material in the document; a warning names some that no library has.
    pub(super) fn finish(self) -> Vec<Option<usize>> {
        let all = self.used.iter().zip(&self.found);
        let missing = all.filter(|(_, number)| number.is_none());
        let missing: Vec<&str> = missing.map(|(name, _)| name.as_str()).take(10).collect();
        if !missing.is_empty() {
            let text = format!(
                "usemtl: no library has the materials {}",
                missing.join(", ")
            );
            self.notes
                .push(Warning::new(Code::MaterialUnreadable, text));
        }
        self.found
    }
}
