//! The modules of a crate: their files, their names for other modules' items, and the paths that
//! they use.

use crate::graph::Imports;
use crate::tokens::{Token, tokens};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A module.
#[derive(Debug, Default)]
struct Module {
    file: PathBuf,
    parent: Option<usize>,
    children: BTreeMap<String, usize>,
    /// Names that `use` brings in, and where they lead.
    names: BTreeMap<String, Vec<String>>,
    /// Modules of which everything is brought in.
    globs: Vec<Vec<String>>,
    /// All paths that lead to other modules.
    paths: Vec<Vec<String>>,
}

/// All modules below one root, which is number 0.
#[derive(Debug)]
pub(crate) struct Modules<'a> {
    files: &'a BTreeMap<PathBuf, String>,
    modules: Vec<Module>,
}

/// Re-exports of re-exports are followed so far.
const MOST_RE_EXPORTS: usize = 16;

impl<'a> Modules<'a> {
    pub(crate) fn of(root: &Path, files: &'a BTreeMap<PathBuf, String>) -> Self {
        let mut modules = Self {
            files,
            modules: vec![Module {
                file: root.to_path_buf(),
                ..Module::default()
            }],
        };
        modules.read_file(0, Path::new(""));
        modules
    }

    /// Adds which file imports which.
    pub(crate) fn add_imports(&self, imports: &mut Imports) {
        for (number, module) in self.modules.iter().enumerate() {
            for path in &module.paths {
                if let Some(to) = self.resolve(number, path, MOST_RE_EXPORTS) {
                    imports.add(&module.file, &self.modules[to].file);
                }
            }
        }
    }

    /// The module that declares what a path leads to; none for other crates' items.
    fn resolve(&self, from: usize, path: &[String], depth: usize) -> Option<usize> {
        let (mut at, mut rest) = (from, path);
        let mut rooted = false;
        while let Some((first, after)) = rest.split_first() {
            match first.as_str() {
                "crate" => at = 0,
                "self" => {}
                "super" => at = self.modules[at].parent?,
                name => {
                    let module = &self.modules[at];
                    if let Some(&child) = module.children.get(name) {
                        at = child;
                    } else if let Some(to) = module.names.get(name).filter(|to| to[..] != [name]) {
                        let mut to = to.clone();
                        to.extend(after.iter().cloned());
                        let depth = depth.checked_sub(1)?;
                        return self.resolve(at, &to, depth);
                    } else {
                        return rooted.then(|| self.declares(at, name, depth));
                    }
                }
            }
            (rooted, rest) = (true, after);
        }
        Some(at)
    }

    /// The module that declares an item which is not brought in by name: this one, or one that it
    /// takes everything from.
    fn declares(&self, at: usize, name: &str, depth: usize) -> usize {
        let Some(depth) = depth.checked_sub(1) else {
            return at;
        };
        let globs = &self.modules[at].globs;
        globs
            .iter()
            .filter_map(|glob| self.resolve(at, glob, depth))
            .find(|&module| module != at && self.has(module, name))
            .unwrap_or(at)
    }

    /// Whether a file's text declares or brings in an item of this name.
    fn has(&self, module: usize, name: &str) -> bool {
        let text = self.files.get(&self.modules[module].file);
        let list = tokens(text.map_or("", String::as_str));
        const KINDS: [&str; 9] = [
            "struct", "enum", "fn", "trait", "type", "const", "static", "union", "mod",
        ];
        self.modules[module].names.contains_key(name)
            || list.windows(2).any(|pair| {
                KINDS.iter().any(|kind| pair[0].is_ident(kind)) && pair[1].is_ident(name)
            })
    }

    fn read_file(&mut self, module: usize, folder: &Path) {
        let files = self.files;
        let text = files.get(&self.modules[module].file);
        let list = tokens(text.map_or("", String::as_str));
        self.read(module, folder, &list);
    }

    /// Reads a module's tokens; its children's files lie in `folder`.
    fn read(&mut self, module: usize, folder: &Path, list: &[Token]) {
        let mut i = 0;
        let mut path_attribute = None;
        while i < list.len() {
            let token = &list[i];
            if token.is('#') {
                let open = i + 1 + usize::from(list.get(i + 1).is_some_and(|t| t.is('!')));
                let end = after_group(list, open);
                let attribute = &list[(open + 1).min(end)..end.saturating_sub(1).max(open + 1)];
                if let [Token::Ident(key), Token::Punct('='), Token::Text(path)] = attribute
                    && key == "path"
                {
                    path_attribute = Some(path.clone());
                }
                i = if is_test(attribute) {
                    after_item(list, end)
                } else {
                    end
                };
                continue;
            }
            if token.is_ident("pub") && list.get(i + 1).is_some_and(|t| t.is('(')) {
                i = after_group(list, i + 1);
                continue;
            }
            if token.is_ident("mod")
                && let Some(Token::Ident(name)) = list.get(i + 1)
            {
                i = self.child(module, folder, name, path_attribute.take(), list, i + 2);
                continue;
            }
            if token.is_ident("use") && (i == 0 || !is_path(&list[i - 1])) {
                let mut end = i + 1;
                self.use_tree(module, list, &mut end, &[]);
                i = end;
                continue;
            }
            i = self.path(module, list, i);
        }
    }

    /// Reads `mod name;` or `mod name { .. }`; gives the position after it.
    fn child(
        &mut self,
        module: usize,
        folder: &Path,
        name: &str,
        path_attribute: Option<String>,
        list: &[Token],
        i: usize,
    ) -> usize {
        let number = self.modules.len();
        let below = folder.join(name);
        let inline = list.get(i).is_some_and(|t| t.is('{'));
        let file = if inline {
            self.modules[module].file.clone()
        } else if let Some(path) = path_attribute {
            let beside = self.modules[module].file.parent();
            beside.unwrap_or(Path::new("")).join(path)
        } else {
            let file = folder.join(format!("{name}.rs"));
            if self.files.contains_key(&file) {
                file
            } else {
                below.join("mod.rs")
            }
        };
        self.modules.push(Module {
            file,
            parent: Some(module),
            ..Module::default()
        });
        self.modules[module]
            .children
            .insert(name.to_owned(), number);
        if inline {
            let end = after_group(list, i);
            self.read(number, &below, &list[i + 1..end - 1]);
            return end;
        }
        self.read_file(number, &below);
        i + 1
    }

    /// Reads what follows `use`, or a part of it.
    fn use_tree(&mut self, module: usize, list: &[Token], i: &mut usize, before: &[String]) {
        let mut path = before.to_vec();
        if list.get(*i) == Some(&Token::Colons) {
            // Another crate.
            path.push("::".to_owned());
            *i += 1;
        }
        while let Some(token) = list.get(*i) {
            *i += 1;
            match token {
                Token::Ident(name) if name == "as" => {
                    if let Some(Token::Ident(alias)) = list.get(*i) {
                        self.brings_in(module, alias.clone(), path);
                        *i += 1;
                    }
                    return;
                }
                Token::Ident(name) if name == "self" && !path.is_empty() => {}
                Token::Ident(name) => path.push(name.clone()),
                Token::Colons => {}
                Token::Punct('*') => {
                    self.modules[module].globs.push(path.clone());
                    self.modules[module].paths.push(path);
                    return;
                }
                Token::Punct('{') => {
                    while *i < list.len() && !list[*i].is('}') {
                        if list[*i].is(',') {
                            *i += 1;
                        } else {
                            self.use_tree(module, list, i, &path);
                        }
                    }
                    *i += 1;
                    return;
                }
                _ => {
                    *i -= 1;
                    break;
                }
            }
        }
        if let Some(name) = path.last().cloned() {
            self.brings_in(module, name, path);
        }
    }

    fn brings_in(&mut self, module: usize, name: String, path: Vec<String>) {
        self.modules[module].names.insert(name, path.clone());
        self.modules[module].paths.push(path);
    }

    /// Keeps the path that begins here, if one does; gives the position after it.
    fn path(&mut self, module: usize, list: &[Token], i: usize) -> usize {
        let Token::Ident(first) = &list[i] else {
            return i + 1;
        };
        let begins = (i == 0 || !is_path(&list[i - 1])) && list.get(i + 1) == Some(&Token::Colons);
        if !begins {
            return i + 1;
        }
        let mut path = vec![first.clone()];
        let mut at = i + 1;
        while let (Some(Token::Colons), Some(Token::Ident(name))) = (list.get(at), list.get(at + 1))
        {
            path.push(name.clone());
            at += 2;
        }
        self.modules[module].paths.push(path);
        at
    }
}

fn is_path(before: &Token) -> bool {
    *before == Token::Colons
}

/// Whether an attribute says that what follows is for tests alone.
fn is_test(attribute: &[Token]) -> bool {
    match attribute {
        [cfg, Token::Punct('('), rest @ ..] if cfg.is_ident("cfg") => match rest {
            [only, Token::Punct(')')] => only.is_ident("test"),
            [all, ..] if all.is_ident("all") => rest.iter().any(|t| t.is_ident("test")),
            _ => false,
        },
        _ => false,
    }
}

/// The position after the group of brackets that opens at `i`.
fn after_group(list: &[Token], i: usize) -> usize {
    let mut depth = 0;
    for (k, token) in list.iter().enumerate().skip(i) {
        match token {
            Token::Punct('(' | '[' | '{') => depth += 1,
            Token::Punct(')' | ']' | '}') => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return k + 1;
        }
    }
    list.len()
}

/// The position after the item that begins at `i`: its semicolon, or its braces.
fn after_item(list: &[Token], mut i: usize) -> usize {
    while i < list.len() {
        match &list[i] {
            Token::Punct(';' | ',') => return i + 1,
            Token::Punct('{') => return after_item_braces(list, i),
            Token::Punct('(' | '[') => i = after_group(list, i),
            _ => i += 1,
        }
    }
    i
}

/// The position after braces, and after the semicolon of a `use` that ends with them.
fn after_item_braces(list: &[Token], i: usize) -> usize {
    let end = after_group(list, i);
    end + usize::from(list.get(end).is_some_and(|t| t.is(';')))
}
