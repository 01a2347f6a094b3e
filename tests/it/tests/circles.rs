//! Modules of a crate form no circle: if `a` uses `b`, then `b` does not use `a`, by whatever way.
//! Read from the sources, so that a circle fails here on the day it comes.
//!
//! What counts is who uses whom among the children of one module. A child may use what its parent
//! defines, and a parent its children. Unit tests do not count.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use syn::visit::{self, Visit};
use syn::{Attribute, ItemMod, ItemUse, UseTree};

/// A module by the names that lead to it from the crate's root.
type Module = Vec<String>;

/// The modules of one crate and what each of them uses.
#[derive(Default)]
struct Crate {
    modules: BTreeSet<Module>,
    /// What names mean in a module by its `use` declarations.
    aliases: BTreeMap<Module, BTreeMap<String, Vec<String>>>,
    /// Paths as they are written, by the module that writes them.
    paths: BTreeMap<Module, BTreeSet<Vec<String>>>,
}

/// Reads one file, and the modules that are written out in it.
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

fn is_for_tests(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        let is_cfg = attribute.path().is_ident("cfg");
        is_cfg && matches!(attribute.parse_args::<syn::Path>(), Ok(path) if path.is_ident("test"))
    })
}

impl Crate {
    /// Reads every source below a crate's `src`. Programs in `src/bin` are crates of their own.
    fn read(sources: &Path) -> Self {
        let mut found = Self::default();
        super::layering::visit(sources, &mut |path| {
            let below = path.strip_prefix(sources).expect("below the sources");
            if below.starts_with("bin") || below.extension().is_none_or(|kind| kind != "rs") {
                return;
            }
            let text = std::fs::read_to_string(path).expect("a source is readable");
            let file = syn::parse_file(&text).expect("a source is Rust");
            let module = module_of(below);
            found.modules.insert(module.clone());
            Reader { found: &mut found, module }.visit_file(&file);
        });
        found.modules.retain(|module| module.last().is_none_or(|name| name != "tests"));
        found
    }

    /// The module that a path leads to from a module; `None` if it leads out of the crate.
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
            // An alias may lead to another; none leads on for ever.
            if let Some(alias) = alias.filter(|alias| alias.as_slice() != path && depth < 8) {
                let onward: Vec<String> = alias.iter().chain(&rest[index + 1..]).cloned().collect();
                return self.target(&at, &onward, depth + 1);
            }
            return (!is_relative || index > 0).then_some(at);
        }
        Some(at)
    }

    /// Who uses whom among the children of each module, with one of the files that say so.
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

    /// Every circle, as the names of the modules along it.
    fn circles(&self) -> Vec<String> {
        let mut circles = Vec::new();
        for (parent, uses) in self.uses() {
            for start in uses.keys() {
                let Some(way) = way_back(&uses, start) else { continue };
                // Each circle is listed once, from its first module.
                if way.iter().all(|name| name >= start) {
                    let from = if parent.is_empty() { "crate".into() } else { parent.join("::") };
                    circles.push(format!("in {from}: {} -> {start}", way.join(" -> ")));
                }
            }
        }
        circles
    }
}

/// The shortest way from a module over others back to itself.
fn way_back(uses: &BTreeMap<String, BTreeMap<String, Module>>, start: &str) -> Option<Vec<String>> {
    let mut seen = BTreeSet::new();
    let mut ways = std::collections::VecDeque::from([vec![start.to_owned()]]);
    while let Some(way) = ways.pop_front() {
        for used in uses.get(way.last()?).into_iter().flat_map(BTreeMap::keys) {
            if used == start {
                return Some(way);
            }
            if seen.insert(used.clone()) {
                ways.push_back(way.iter().chain([used]).cloned().collect());
            }
        }
    }
    None
}

/// `a/b.rs` and `a/b/mod.rs` are both module `a::b`; `lib.rs` and `main.rs` are the root.
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
            let of = manifest.parent().and_then(|path| path.strip_prefix(it::root()).ok());
            let of = of.expect("below the root").display().to_string();
            circles
                .extend(Crate::read(&sources).circles().iter().map(|way| format!("{of}, {way}")));
        }
    }
    assert!(circles.is_empty(), "{}", circles.join("\n"));
}
