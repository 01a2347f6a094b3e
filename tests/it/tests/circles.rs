//! Modules do not depend on each other in a circle: if `a` uses `b`, then `b` does not use `a`,
//! neither directly nor through other modules.
//!
//! The test reads the sources of every crate and compares the children of each module with each
//! other. Not counted: what a child uses of its parents or a parent of its children, and unit tests.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::path::{Path, PathBuf};

use syn::visit::{self, Visit};
use syn::{Attribute, ItemMod, ItemUse, UseTree};

/// A module, as its path from the crate's root.
type Module = Vec<String>;

/// The modules of one crate, and the paths that each of them uses.
#[derive(Default)]
struct Crate {
    modules: BTreeSet<Module>,
    /// For each module, the names that its `use` declarations define, with their paths.
    aliases: BTreeMap<Module, BTreeMap<String, Vec<String>>>,
    /// For each module, the paths in its code, as written.
    paths: BTreeMap<Module, BTreeSet<Vec<String>>>,
}

/// Reads one file with its inline modules.
struct Reader<'c> {
    found: &'c mut Crate,
    module: Module,
}

impl Visit<'_> for Reader<'_> {
    fn visit_item_mod(&mut self, item: &ItemMod) {
        if is_for_tests(&item.attrs) || item.content.is_none() {
            return;
        }
        self.module.push(item.ident.to_string());
        self.found.modules.insert(self.module.clone());
        visit::visit_item_mod(self, item);
        self.module.pop();
    }

    fn visit_item_use(&mut self, item: &ItemUse) {
        if !is_for_tests(&item.attrs) {
            self.read_use(&item.tree, Vec::new());
        }
    }

    fn visit_path(&mut self, path: &syn::Path) {
        let names = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
        self.found.paths.entry(self.module.clone()).or_default().insert(names);
        visit::visit_path(self, path);
    }
}

impl Reader<'_> {
    /// Adds the names and paths of a `use` declaration; `path` leads to the tree.
    fn read_use(&mut self, tree: &UseTree, mut path: Vec<String>) {
        let name = match tree {
            UseTree::Path(rest) => {
                path.push(rest.ident.to_string());
                return self.read_use(&rest.tree, path);
            }
            UseTree::Group(group) => {
                return group.items.iter().for_each(|tree| self.read_use(tree, path.clone()));
            }
            UseTree::Name(name) => {
                path.push(name.ident.to_string());
                name.ident.to_string()
            }
            UseTree::Rename(name) => {
                path.push(name.ident.to_string());
                name.rename.to_string()
            }
            _ => "*".to_owned(),
        };
        if path.last().is_some_and(|last| last == "self") {
            path.pop();
        }
        let name = if name == "self" { path.last().cloned().unwrap_or(name) } else { name };
        self.found.paths.entry(self.module.clone()).or_default().insert(path.clone());
        self.found.aliases.entry(self.module.clone()).or_default().insert(name, path);
    }
}

/// Whether an item has the attribute `#[cfg(test)]`.
fn is_for_tests(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        let is_cfg = attribute.path().is_ident("cfg");
        is_cfg && matches!(attribute.parse_args::<syn::Path>(), Ok(path) if path.is_ident("test"))
    })
}

impl Crate {
    /// Reads every source below a crate's `src`, except `src/bin`, whose programs are separate
    /// crates.
    fn read(sources: &Path) -> Self {
        let mut found = Self::default();
        super::layering::visit(sources, &mut |path| {
            let below = path.strip_prefix(sources).expect("below the sources");
            if below.starts_with("bin") || below.extension().is_none_or(|kind| kind != "rs") {
                return;
            }
            let text = std::fs::read_to_string(path).expect("a source is readable");
            found.add(below, &text);
        });
        found
    }

    /// Adds the modules of one source; `file` is its path below `src`. Files of unit tests are
    /// left out.
    fn add(&mut self, file: &Path, text: &str) {
        let module = module_of(file);
        if module.last().is_some_and(|name| name == "tests") {
            return;
        }
        let file = syn::parse_file(text).expect("a source is Rust");
        self.modules.insert(module.clone());
        Reader { found: self, module }.visit_file(&file);
    }

    /// The module that a path leads to from the module `from`; `None` if it leads out of the crate.
    /// `depth` counts the aliases followed so far.
    fn target(&self, from: &Module, path: &[String], depth: usize) -> Option<Module> {
        let (first, mut rest) = path.split_first()?;
        let mut at = match first.as_str() {
            "crate" => Module::new(),
            "self" => from.clone(),
            "super" => from[..from.len().checked_sub(1)?].to_vec(),
            _ => {
                rest = path;
                from.clone()
            }
        };
        let is_relative = rest.len() == path.len();
        for (index, name) in rest.iter().enumerate() {
            if name == "super" {
                at.pop()?;
                continue;
            }
            at.push(name.clone());
            if self.modules.contains(&at) {
                continue;
            }
            at.pop();
            let alias = self.aliases.get(&at).and_then(|aliases| aliases.get(name));
            // An alias may lead to another; the limit ends a chain that does not end itself.
            if let Some(alias) = alias.filter(|alias| alias.as_slice() != path && depth < 8) {
                let onward: Vec<String> = alias.iter().chain(&rest[index + 1..]).cloned().collect();
                return self.target(&at, &onward, depth + 1);
            }
            return (!is_relative || index > 0).then_some(at);
        }
        Some(at)
    }

    /// For each module, which of its children use which others, each with a module that does so.
    fn uses(&self) -> BTreeMap<Module, BTreeMap<String, BTreeMap<String, Module>>> {
        let mut uses: BTreeMap<Module, BTreeMap<String, BTreeMap<String, Module>>> =
            BTreeMap::new();
        for (from, paths) in self.paths.iter().filter(|(from, _)| self.modules.contains(*from)) {
            for to in paths.iter().filter_map(|path| self.target(from, path, 0)) {
                let shared = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
                if let (Some(user), Some(used)) = (from.get(shared), to.get(shared)) {
                    let siblings = uses.entry(from[..shared].to_vec()).or_default();
                    siblings.entry(user.clone()).or_default().insert(used.clone(), from.clone());
                }
            }
        }
        uses
    }

    /// Every circle, as text: the names of the modules along it.
    fn circles(&self) -> Vec<String> {
        let mut circles = Vec::new();
        for (parent, uses) in self.uses() {
            for start in uses.keys() {
                let Some(circle) = circle_from(&uses, start) else { continue };
                // A circle is found from each of its modules, but listed only from the first.
                if circle.iter().all(|name| name >= start) {
                    let from = if parent.is_empty() { "crate".into() } else { parent.join("::") };
                    circles.push(format!("in {from}: {} -> {start}", circle.join(" -> ")));
                }
            }
        }
        circles
    }
}

/// The shortest circle from a module back to itself, found by a breadth-first search.
fn circle_from(
    uses: &BTreeMap<String, BTreeMap<String, Module>>,
    start: &str,
) -> Option<Vec<String>> {
    let mut seen = BTreeSet::new();
    let mut paths = VecDeque::from([vec![start.to_owned()]]);
    while let Some(path) = paths.pop_front() {
        for used in uses.get(path.last()?).into_iter().flat_map(BTreeMap::keys) {
            if used == start {
                return Some(path);
            }
            if seen.insert(used.clone()) {
                paths.push_back(path.iter().chain([used]).cloned().collect());
            }
        }
    }
    None
}

/// The module of a file: `a::b` for `a/b.rs` and `a/b/mod.rs`, the root for `lib.rs` and `main.rs`.
fn module_of(file: &Path) -> Module {
    let mut names: Module =
        file.with_extension("").iter().map(|name| name.to_string_lossy().into_owned()).collect();
    if names.last().is_some_and(|last| ["lib", "main", "mod"].contains(&last.as_str())) {
        names.pop();
    }
    names
}

#[test]
fn modules_form_no_circles() {
    let mut circles = Vec::new();
    for manifest in super::layering::manifests() {
        let sources: PathBuf = manifest.with_file_name("src");
        if sources.is_dir() {
            let folder = manifest.parent().and_then(|path| path.strip_prefix(it::root()).ok());
            let folder = folder.expect("below the root").display().to_string();
            let found = Crate::read(&sources).circles();
            circles.extend(found.iter().map(|circle| format!("{folder}, {circle}")));
        }
    }
    assert!(circles.is_empty(), "{}", circles.join("\n"));
}

#[test]
fn circles_are_found_through_paths_aliases_and_further_modules() {
    let check = |files: &[(&str, &str)], expected: &[&str]| {
        let mut found = Crate::default();
        files.iter().for_each(|(file, text)| found.add(Path::new(file), text));
        assert_eq!(found.circles(), expected, "{files:?}");
    };
    let root = ("lib.rs", "mod a;\nmod b;\nmod c;\npub use b::B;");
    let a = ("a.rs", "use crate::B;\npub struct A(B);");
    // Without a circle: `a` uses `b`, through the name that the root exports.
    check(&[root, a, ("b.rs", "pub struct B;")], &[]);
    check(&[root, a, ("b.rs", "pub struct B;\n#[cfg(test)]\nmod tests { use crate::a::A; }")], &[]);
    // Directly, by a path in the code.
    check(&[root, a, ("b.rs", "pub struct B(super::a::A);")], &["in crate: a -> b -> a"]);
    // Through `c`, and from a module within `b`.
    let c = ("c/mod.rs", "use crate::a as other;\npub struct C(other::A);");
    let within = ("b/within.rs", "fn f() -> super::super::c::C { todo() }");
    let b = ("b.rs", "mod within;\npub struct B;");
    check(&[root, a, b, c, within], &["in crate: a -> b -> c -> a"]);
    // Below a module.
    let x = ("b/x.rs", "use super::y::Y;");
    let y = ("b/y.rs", "use crate::b::x;\nfn f() { x::g() }");
    check(&[root, a, b, x, y], &["in b: x -> y -> x"]);
}
