//! The modules of a package, found as the compiler finds them, and the paths in their code.

use super::graph::Imports;
use super::tokens::{Kind, Token, tokens};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Reads all crates of the package in a folder: library, programs, build script, tests, examples.
pub fn read_package(folder: &Path, imports: &mut Imports) {
    let mut roots: Vec<PathBuf> = ["src/lib.rs", "src/main.rs", "build.rs"].map(|f| folder.join(f)).into();
    for inside in ["src/bin", "tests", "examples", "benches"] {
        roots.extend(rust_files(&folder.join(inside), false));
    }
    roots.retain(|root| root.is_file());
    let mut left: BTreeSet<PathBuf> = rust_files(&folder.join("src"), true).into_iter().collect();
    let main = folder.join("src/main.rs");
    for root in &roots {
        // Modules that a macro or a build script declares belong to the library, or else to the program.
        let adopts = root.ends_with("src/lib.rs") || (*root == main && !folder.join("src/lib.rs").is_file());
        let mut krate = Crate::new(root);
        if adopts {
            for file in &krate.files() {
                left.remove(file);
            }
            left.retain(|file| !roots.contains(file));
            krate.adopt(&folder.join("src"), &mut left);
        }
        krate.resolve(imports);
    }
}

/// Files of Rust in a folder, and in those below it where that is asked for.
pub fn rust_files(folder: &Path, deep: bool) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if deep && path.is_dir() {
            found.extend(rust_files(&path, true));
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// A module: where it stands, its children by name, and the paths that its code names.
#[derive(Default)]
struct Module {
    file: Option<PathBuf>,
    parent: usize,
    children: BTreeMap<String, usize>,
    /// Each with its line, and the name that a `use` gives it.
    paths: Vec<(Vec<String>, usize, Option<String>)>,
}

/// The modules of a crate; the first is its root.
struct Crate {
    modules: Vec<Module>,
    /// Files of the macros, which are named as if the root held them.
    macros: BTreeMap<String, PathBuf>,
}

impl Crate {
    fn new(root: &Path) -> Self {
        let first = Module { file: Some(root.to_owned()), ..Module::default() };
        let mut krate = Self { modules: vec![first], macros: BTreeMap::new() };
        krate.read(0, root, root.parent().unwrap_or(root).to_owned());
        krate
    }

    fn files(&self) -> Vec<PathBuf> {
        self.modules.iter().filter_map(|m| m.file.clone()).collect()
    }

    /// The child of this name, new where there is none.
    fn child(&mut self, parent: usize, name: &str) -> usize {
        if let Some(known) = self.modules[parent].children.get(name) {
            return *known;
        }
        self.modules.push(Module { parent, ..Module::default() });
        let index = self.modules.len() - 1;
        self.modules[parent].children.insert(name.to_owned(), index);
        index
    }

    /// Reads the code of a module from its file; modules declared in it lie in `folder`.
    fn read(&mut self, module: usize, file: &Path, folder: PathBuf) {
        let source = std::fs::read_to_string(file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        let tokens = tokens(&source);
        let mut code = Code { krate: self, tokens: &tokens, at: 0, file };
        code.items(module, &folder);
    }

    /// `beside` says that its modules lie beside the file, as those of a `mod.rs` do.
    fn read_file(&mut self, module: usize, file: PathBuf, beside: bool) {
        let folder = if beside || file.ends_with("mod.rs") {
            file.parent().unwrap_or(&file).to_owned()
        } else {
            file.with_extension("")
        };
        self.modules[module].file = Some(file.clone());
        self.read(module, &file, folder);
    }

    /// Takes in files that nothing declares in plain words, where their paths put them.
    fn adopt(&mut self, src: &Path, left: &mut BTreeSet<PathBuf>) {
        while let Some(file) = left.pop_first() {
            let path = file.strip_prefix(src).unwrap_or(&file).with_extension("");
            let module = path.iter().filter(|name| *name != "mod").fold(0, |parent, name| {
                let name = name.to_string_lossy();
                self.child(parent, &name)
            });
            // One that is written out in a file has no other.
            if self.modules[module].file.is_none() {
                self.read_file(module, file, false);
            }
            for known in self.files() {
                left.remove(&known);
            }
        }
    }

    /// The module that a path from `module` names or names something of, and how many words of the path
    /// it takes to get there. None for paths into other crates and for types.
    fn find(&self, module: usize, path: &[String], names: &Names) -> Option<(usize, usize)> {
        let (first, rest) = path.split_first()?;
        let child = |m: usize, name: &String| self.modules[m].children.get(name).copied();
        let mut at = match first.as_str() {
            "crate" => 0,
            "self" => module,
            "super" => self.modules[module].parent,
            _ => child(module, first).or_else(|| names.get(&(module, first.clone())).copied())?,
        };
        let mut taken = 1;
        for word in rest {
            at = match word.as_str() {
                "super" => self.modules[at].parent,
                "self" => at,
                _ => match child(at, word) {
                    Some(next) => next,
                    None => break,
                },
            };
            taken += 1;
        }
        Some((at, taken))
    }

    /// Adds what all modules import.
    fn resolve(&self, imports: &mut Imports) {
        // Names that a `use` gives to modules, by the module that holds it.
        let mut names = Names::new();
        for (index, module) in self.modules.iter().enumerate() {
            for (path, _, name) in &module.paths {
                if let (Some(name), Some((found, taken))) = (name, self.find(index, path, &Names::new()))
                    && taken == path.len()
                {
                    names.insert((index, name.clone()), found);
                }
            }
        }
        for (index, module) in self.modules.iter().enumerate() {
            for (path, line, _) in &module.paths {
                let found = match self.find(index, path, &names) {
                    Some((0, 1)) if path.len() == 2 => {
                        self.macros.get(&path[1]).map(PathBuf::as_path).or(self.file_of(0))
                    }
                    found => found.and_then(|(module, _)| self.file_of(module)),
                };
                if let (Some(to), Some(from)) = (found, self.file_of(index)) {
                    imports.add(from, to, *line, &path.join("::"));
                }
            }
        }
    }

    fn file_of(&self, module: usize) -> Option<&Path> {
        self.modules[module].file.as_deref()
    }
}

type Names = BTreeMap<(usize, String), usize>;

/// The code of one file while it is read.
struct Code<'c> {
    krate: &'c mut Crate,
    tokens: &'c [Token],
    at: usize,
    file: &'c Path,
}

/// Words that an item which `#[cfg(test)]` hides begins with.
const ITEMS: [&str; 13] = [
    "mod",
    "use",
    "fn",
    "impl",
    "struct",
    "enum",
    "const",
    "static",
    "type",
    "trait",
    "unsafe",
    "extern",
    "macro_rules",
];

impl Code<'_> {
    fn word(&self, ahead: usize) -> Option<&str> {
        match self.tokens.get(self.at + ahead).map(|t| &t.kind) {
            Some(Kind::Word(word)) => Some(word),
            _ => None,
        }
    }

    fn is(&self, ahead: usize, sign: char) -> bool {
        self.tokens.get(self.at + ahead).is_some_and(|t| t.kind == Kind::Sign(sign))
    }

    fn is_path(&self, ahead: usize) -> bool {
        self.tokens.get(self.at + ahead).is_some_and(|t| t.kind == Kind::Path)
    }

    fn line(&self) -> usize {
        self.tokens.get(self.at).map_or(0, |t| t.line)
    }

    /// Reads on until the brace that closes the module.
    fn items(&mut self, module: usize, folder: &Path) {
        let (mut depth, mut attributes) = (0, Attributes::default());
        while self.at < self.tokens.len() {
            if self.is(0, '#') && (self.is(1, '[') || (self.is(1, '!') && self.is(2, '['))) {
                self.attribute(&mut attributes);
                continue;
            }
            if self.word(0) == Some("pub") {
                self.at += 1;
                if self.is(0, '(') {
                    self.skip_group();
                }
                continue;
            }
            let given = std::mem::take(&mut attributes);
            if given.test && self.word(0).is_some_and(|word| ITEMS.contains(&word)) {
                self.skip_item();
            } else if self.word(0) == Some("mod") && self.word(1).is_some() {
                self.declaration(module, folder, given.path);
            } else if self.word(0) == Some("use") && !self.is(1, '<') {
                self.at += 1;
                self.imported(module, &[]);
            } else if self.word(0) == Some("macro_rules") && self.is(1, '!') {
                self.at += 2;
                if let Some(name) = self.word(0).map(str::to_owned) {
                    self.krate.macros.insert(name, self.file.to_owned());
                }
            } else if self.word(0).is_some() {
                self.path(module);
            } else {
                depth += i32::from(self.is(0, '{')) - i32::from(self.is(0, '}'));
                self.at += 1;
                if depth < 0 {
                    return;
                }
            }
        }
    }

    fn attribute(&mut self, attributes: &mut Attributes) {
        while !self.is(0, '[') {
            self.at += 1;
        }
        let begin = self.at;
        self.skip_group();
        let inside = &self.tokens[begin..self.at];
        let has = |word: &str| inside.iter().any(|t| t.kind == Kind::Word(word.to_owned()));
        match inside.get(1).map(|t| &t.kind) {
            Some(Kind::Word(first)) if first == "cfg" => attributes.test |= has("test") && !has("not"),
            Some(Kind::Word(first)) if first == "path" => {
                attributes.path = inside.iter().find_map(|t| match &t.kind {
                    Kind::Text(path) => Some(path.clone()),
                    _ => None,
                });
            }
            _ => {}
        }
    }

    /// Goes past the bracket that closes the one here.
    fn skip_group(&mut self) {
        let mut depth = 0;
        while self.at < self.tokens.len() {
            let opens = ['(', '[', '{'].iter().any(|c| self.is(0, *c));
            let closes = [')', ']', '}'].iter().any(|c| self.is(0, *c));
            depth += i32::from(opens) - i32::from(closes);
            self.at += 1;
            if depth == 0 {
                return;
            }
        }
    }

    fn skip_item(&mut self) {
        while self.at < self.tokens.len() && !self.is(0, ';') && !self.is(0, '{') {
            if self.is(0, '(') || self.is(0, '[') { self.skip_group() } else { self.at += 1 }
        }
        self.skip_group();
    }

    fn declaration(&mut self, module: usize, folder: &Path, path: Option<String>) {
        let name = self.word(1).unwrap_or_default().to_owned();
        self.at += 2;
        if self.is(0, '{') {
            self.at += 1;
            let child = self.krate.child(module, &name);
            self.krate.modules[child].file = Some(self.file.to_owned());
            self.items(child, &folder.join(&name));
        } else if self.is(0, ';') {
            let beside = path.is_some();
            let candidates = match path {
                Some(path) => vec![self.file.with_file_name(path)],
                None => vec![folder.join(format!("{name}.rs")), folder.join(&name).join("mod.rs")],
            };
            if let Some(file) = candidates.into_iter().find(|file| file.is_file()) {
                let child = self.krate.child(module, &name);
                let file = normal(&file);
                self.krate.read_file(child, file, beside);
            }
        }
    }

    /// A tree of a `use`, after `before`.
    fn imported(&mut self, module: usize, before: &[String]) {
        let (line, mut path) = (self.line(), before.to_vec());
        loop {
            if let Some(word) = self.word(0) {
                path.push(word.to_owned());
                self.at += 1;
            } else if self.is(0, '{') {
                self.at += 1;
                while self.at < self.tokens.len() && !self.is(0, '}') {
                    self.imported(module, &path);
                    self.at += usize::from(self.is(0, ','));
                }
                self.at += 1;
                return;
            } else if self.is(0, '*') {
                self.at += 1;
            }
            if self.is_path(0) {
                self.at += 1;
            } else {
                break;
            }
        }
        if path.last().is_some_and(|last| last == "self") && path.len() > 1 {
            path.pop();
        }
        let mut name = path.last().cloned();
        if self.word(0) == Some("as") {
            name = self.word(1).map(str::to_owned);
            self.at += 2;
        }
        self.krate.modules[module].paths.push((path, line, name));
        // The sign that ends it; a tree's own comma and brace are its caller's.
        if before.is_empty() {
            self.at += usize::from(self.is(0, ';'));
        }
    }

    /// A path in the code, or a lone word.
    fn path(&mut self, module: usize) {
        let after = |sign| self.at > 0 && self.tokens[self.at - 1].kind == sign;
        let is_field = after(Kind::Sign('.')) || after(Kind::Path);
        let is_fragment = after(Kind::Sign('$')) && self.word(0) != Some("crate");
        let (line, mut path) = (self.line(), Vec::new());
        while let Some(word) = self.word(0) {
            path.push(word.to_owned());
            self.at += 1;
            if !(self.is_path(0) && self.word(1).is_some()) {
                break;
            }
            self.at += 1;
        }
        if path.len() > 1 && !is_field && !is_fragment {
            self.krate.modules[module].paths.push((path, line, None));
        }
    }
}

#[derive(Default)]
struct Attributes {
    test: bool,
    path: Option<String>,
}

/// A path without `..` in it, so that one file has one name.
fn normal(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}
