//! Dependency cycles among the files of a package.

use std::collections::{BTreeMap, BTreeSet};

use super::source::{Source, words};
use super::tree::{Finding, SourceTree};

/// Path of a module within its package; empty for the root.
type Module = Vec<String>;

/// Finds one dependency cycle per package: files that use each other, directly or through others.
pub(super) fn check(tree: &SourceTree) -> Vec<Finding> {
    let mut packages: BTreeMap<&str, Vec<&Source>> = BTreeMap::new();
    for source in tree.rust.iter().filter(|source| source.is_src()) {
        packages.entry(source.package()).or_default().push(source);
    }
    packages.values().filter_map(|sources| find_cycle(&Package::new(sources))).collect()
}

/// Files of a package by their modules, and the modules of re-exported names.
struct Package<'a> {
    files: BTreeMap<Module, &'a Source>,
    exports: BTreeMap<(Module, String), Module>,
}

impl<'a> Package<'a> {
    fn new(sources: &[&'a Source]) -> Self {
        let mut package = Self { files: BTreeMap::new(), exports: BTreeMap::new() };
        package.files.extend(sources.iter().map(|&source| (module(source), source)));
        let mut exports = Vec::new();
        for (module, source) in &package.files {
            for path in package.paths(module, source).into_iter().filter(|path| path.is_export) {
                exports.push(((module.clone(), path.name), path.target));
            }
        }
        package.exports.extend(exports);
        package
    }

    /// Returns the paths in the code of a file that lead to modules of the package.
    fn paths(&self, module: &Module, source: &Source) -> Vec<Path> {
        let code = source.code();
        let children = self.files.keys().filter(|m| m.len() == module.len() + 1 && m.starts_with(module));
        let starts =
            ["crate", "super"].map(str::to_owned).into_iter().chain(children.filter_map(|m| m.last().cloned()));
        let mut paths = Vec::new();
        for start in starts {
            for offset in words(code, &start).filter(|&k| code[k + start.len()..].starts_with("::")) {
                let before = code[..offset].trim_end();
                if before.ends_with("::") || before.ends_with('$') {
                    continue;
                }
                let statement = before.rsplit([';', '}']).next().unwrap_or_default().trim_start();
                let is_export = statement.starts_with("pub") && words(statement, "use").next().is_some();
                let root = match start.as_str() {
                    "crate" => Module::new(),
                    "super" => module[..module.len().saturating_sub(1)].to_vec(),
                    _ => [module.as_slice(), std::slice::from_ref(&start)].concat(),
                };
                for segments in expand(&code[offset + start.len() + 2..]) {
                    let mut target = root.clone();
                    let mut rest = segments.iter().peekable();
                    while let Some(segment) = rest.peek() {
                        if *segment == "super" {
                            target.pop();
                        } else if self.files.contains_key(&[target.as_slice(), &[(*segment).clone()]].concat()) {
                            target.push((*segment).clone());
                        } else {
                            break;
                        }
                        rest.next();
                    }
                    let name = rest.next().cloned().unwrap_or_default();
                    paths.push(Path { target, name, offset, is_export });
                }
            }
        }
        paths
    }

    /// Returns the module that defines a name which `module` defines or re-exports.
    fn definition(&self, module: Module, name: &str) -> Module {
        let mut module = module;
        // Re-exports of re-exports are few; the bound guards against cycles of them.
        for _ in 0..8 {
            match self.exports.get(&(module.clone(), name.to_owned())) {
                Some(next) => module.clone_from(next),
                None => break,
            }
        }
        module
    }

    /// Returns the files that a file uses, with the line of the first use, without re-exports.
    fn uses(&self, module: &Module, source: &Source) -> BTreeMap<Module, usize> {
        let mut uses = BTreeMap::new();
        for path in self.paths(module, source).into_iter().filter(|path| !path.is_export) {
            let target = self.definition(path.target, &path.name);
            if target != *module {
                uses.entry(target).or_insert(source.line_at(path.offset));
            }
        }
        uses
    }
}

/// A path in the code, as in `use a::b::C`: the module `a::b` and the name `C`.
struct Path {
    target: Module,
    name: String,
    offset: usize,
    is_export: bool,
}

/// Returns the paths of a use tree, such as `a::{b, c::d}`, or a plain path at the start of the text.
fn expand(text: &str) -> Vec<Module> {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let (mut rest, mut path, mut paths) = (text, Module::new(), Vec::new());
    // Lengths of the path at the open braces.
    let mut open: Vec<usize> = Vec::new();
    while let Some(first) = rest.chars().next() {
        let word = rest.find(|c| !is_word(c)).unwrap_or(rest.len());
        let (token, after) = rest.split_at(word.max(first.len_utf8()));
        rest = after;
        match token {
            "{" => open.push(path.len()),
            "," | " " | "\n" => {}
            "as" => rest = rest.trim_start().trim_start_matches(is_word),
            "}" => {
                open.pop();
                path.truncate(open.last().copied().unwrap_or(0));
            }
            _ => {
                path.extend((token != "self").then(|| token.to_owned()));
                match rest.strip_prefix("::") {
                    Some(more) if more.starts_with(|c: char| is_word(c) || c == '{' || c == '*') => {
                        rest = more;
                        continue;
                    }
                    _ => paths.push(path.clone()),
                }
                path.truncate(open.last().copied().unwrap_or(0));
            }
        }
        if open.is_empty() {
            break;
        }
    }
    paths
}

/// Returns the path of the module that is a file: `src/a/b.rs` and `src/a/b/mod.rs` are `a::b`.
fn module(source: &Source) -> Module {
    let path = source.path.split_once("/src/").map_or("", |(_, path)| path).trim_end_matches(".rs");
    let mut module: Module = path.split('/').map(str::to_owned).collect();
    let is_root = module.len() == 1 && module[0] == "lib";
    if is_root || module.last().is_some_and(|last| last == "mod") {
        module.pop();
    }
    module
}

/// Returns one dependency cycle of files, if there is any.
fn find_cycle(package: &Package<'_>) -> Option<Finding> {
    let mut uses: BTreeMap<&Module, BTreeMap<Module, usize>> =
        package.files.iter().map(|(module, source)| (module, package.uses(module, source))).collect();
    // Files that use no other file are not part of a cycle. They are removed repeatedly; cycles, and files that lead to
    // them, are left.
    loop {
        let left: BTreeSet<Module> = uses.keys().map(|module| (*module).clone()).collect();
        uses.values_mut().for_each(|targets| targets.retain(|target, _| left.contains(target)));
        let n = uses.len();
        uses.retain(|_, targets| !targets.is_empty());
        if uses.len() == n {
            break;
        }
    }
    let mut chain: Vec<&Module> = vec![uses.keys().next()?];
    loop {
        let next = uses[chain[chain.len() - 1]].keys().next()?;
        if let Some(start) = chain.iter().position(|module| *module == next) {
            let names: Vec<&str> =
                chain[start..].iter().chain([&next]).map(|module| package.files[*module].path.as_str()).collect();
            let line = uses[chain[chain.len() - 1]][next];
            let advice = format!("dependency cycle of files: {}", names.join(" -> "));
            return Some(Finding::new(&package.files[chain[chain.len() - 1]].path, line, advice));
        }
        chain.push(next);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(files: &[(&str, &str)]) -> Option<String> {
        let sources: Vec<Source> =
            files.iter().map(|(path, text)| Source::new(&format!("crates/mesh/src/{path}"), (*text).into())).collect();
        find_cycle(&Package::new(&sources.iter().collect::<Vec<_>>())).map(|finding| finding.advice)
    }

    #[test]
    fn cycles_are_found_through_re_exports_nested_uses_and_plain_paths() {
        let lib = ("lib.rs", "mod a; mod b; mod c;\npub use a::A;\npub use b::B;\n");
        let a = ("a.rs", "use std::fmt;\nuse crate::{\n    B,\n    c::{self, C as D},\n};\n");
        assert_eq!(of(&[lib, a, ("b.rs", "fn b() {}"), ("c.rs", "use super::b;")]), None);
        let found = of(&[lib, a, ("b.rs", "fn b() { crate::A::new() }"), ("c.rs", "")]).unwrap();
        assert!(found.contains("src/a.rs -> crates/mesh/src/b.rs -> crates/mesh/src/a.rs"), "{found}");
        assert!(of(&[lib, a, ("b.rs", ""), ("c.rs", "fn c() { super::A::new() }")]).is_some());
    }

    #[test]
    fn parents_and_children_may_not_use_each_other() {
        let child = ("a/b.rs", "use super::A;");
        assert_eq!(of(&[("lib.rs", "mod a;"), ("a/mod.rs", "mod b;\npub use b::B;\npub struct A;"), child]), None);
        assert!(of(&[("lib.rs", "mod a;"), ("a/mod.rs", "mod b;\nuse b::B;\npub struct A(B);"), child]).is_some());
        assert!(of(&[("lib.rs", "mod a;"), ("a/mod.rs", "mod b;\npub fn f() { b::g() }"), child]).is_some());
    }
}
