//! One word for one idea: the glossary has every word, and no name in the code uses one of them for
//! another idea.
//!
//! The glossary is at the top of `firmware/controller/src/lib.rs`. [`RESERVED`] lists the names that
//! would use a word of it with another meaning. The words for what the robot does, its reasons, are
//! explained in `plan-compiler/MISSION.md`.

use std::path::Path;

use it::root;
use robot_io::Reason;
use syn::visit::{self, Visit};
use syn::{Ident, ImplItemFn, ItemEnum, ItemFn, ItemMod, ItemStruct, ItemTrait, ItemType};
use syn::{TraitItemFn, Visibility};

/// Words that the glossary must explain.
const WORDS: &[&str] = &[
    "advice",
    "applicability",
    "aspect of interest",
    "atomic action",
    "behaviour",
    "blob",
    "cell grid",
    "commands",
    "criticality",
    "drive",
    "fix",
    "gain",
    "guidance",
    "hold",
    "layer",
    "link",
    "map frame",
    "mission",
    "observer",
    "packet",
    "parallel plan",
    "percepts",
    "place",
    "plan frame",
    "production",
    "protection interval",
    "run",
    "scenario",
    "schema",
    "serial plan",
    "simulation",
    "situation grid",
    "tick",
    "transport",
];

/// What a name is given to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// A struct, an enum, a trait or a type alias.
    Type,
    /// A module, also by the name of its file or folder.
    Module,
    /// A function or a method.
    Function,
    /// A function or a method that is `pub`.
    PublicFunction,
}

/// A name that only some files may define.
struct Reserved {
    kind: Kind,
    name: &'static str,
    /// Beginnings of the paths of the files that may define it.
    allowed: &'static [&'static str],
    /// Names to use instead.
    instead: &'static str,
    reason: &'static str,
}

const fn reserved(
    kind: Kind,
    name: &'static str,
    allowed: &'static [&'static str],
    instead: &'static str,
    reason: &'static str,
) -> Reserved {
    Reserved { kind, name, allowed, instead, reason }
}

use Kind::{Function, Module, PublicFunction, Type};

const FRAME: &str = "a frame is a plan frame or a map frame; on the link it is a packet";
const GRID: &str = "the grid is the cell grid of `math`";
const LINK: &str = "the link is the radio link to the operator";
const PLACE: &str = "a place is a place on the globe or a position in a source text";
const SPEECH: &str = "code reports, prints or returns; it does not speak";

/// OpenStreetMap's own data model calls a line a way.
const OSM: &str = "plan-compiler/maps/src/formats/osm";

/// Names that use a word of the glossary with another meaning, or an unclear word for one of its
/// ideas.
const RESERVED: &[Reserved] = &[
    reserved(Type, "Frame", &[], "PlanFrame, MapFrame, Packet", FRAME),
    reserved(Module, "frame", &[], "plan_frame, map_frame, packet", FRAME),
    reserved(Module, "frames", &[], "plan_frames, packets", FRAME),
    reserved(PublicFunction, "frame", &[], "plan_frame, map_frame, packet", FRAME),
    reserved(PublicFunction, "frames", &[], "plan_frames, packets", FRAME),
    reserved(Type, "Grid", &["shared/math/"], "SituationGrid", GRID),
    reserved(Module, "grid", &["shared/math/", "shared/plan-format/"], "situation_grid", GRID),
    reserved(
        Type,
        "Plan",
        &[],
        "ParallelPlan, LivePlan",
        "a plan is a parallel plan, a serial plan or the live plan of a behaviour",
    ),
    reserved(Type, "Link", &["firmware/runtime/src/link"], "Transport", LINK),
    reserved(
        Module,
        "link",
        // The second one sets up the linker of a board's image.
        &["firmware/runtime/src/link", "boards/table/src/link"],
        "transport, packet",
        LINK,
    ),
    reserved(
        Type,
        "Drive",
        &[],
        "Steering, Motion",
        "to drive is to turn a vector into speed and turn rate",
    ),
    reserved(
        Type,
        "Differential",
        &[],
        "a variant of Steering",
        "it is a kind of steering, not a thing of its own",
    ),
    reserved(
        Type,
        "Motion",
        &["firmware/controller/src/drive.rs"],
        "StepResult",
        "a motion is a speed and a turn rate",
    ),
    reserved(Type, "Wish", &[], "Intent", "behaviours have an intent for the tick"),
    reserved(Function, "wish", &[], "intent", "behaviours have an intent for the tick"),
    reserved(
        Type,
        "Way",
        &[OSM],
        "Steering, Route, Transition",
        "a way is a route, a kind of steering or a choice",
    ),
    reserved(Type, "Level", &[], "Layer, Severity", "what plans have is called a layer"),
    reserved(
        Type,
        "Place",
        &[
            "plan-compiler/maps/src/problem.rs",
            "plan-compiler/maps/src/formats/globe.rs",
            "plan-compiler/src/commands/description.rs",
            OSM,
        ],
        "Position, Placement, State",
        PLACE,
    ),
    reserved(Function, "told", &[], "reported, printed", SPEECH),
    reserved(Function, "said", &[], "reported, printed", SPEECH),
    reserved(Function, "mend", &[], "repair, help", "software is fixed or repaired"),
    reserved(Function, "mended", &[], "repaired", "software is fixed or repaired"),
    reserved(Function, "go_north", &[], "advance_row", "a search has no compass"),
    reserved(Function, "is_in_the_open", &[], "has_free_path", "it tests for a free path"),
];

/// The glossary's entries in their order: word and meaning.
fn glossary() -> Vec<(String, String)> {
    let file = root().join("firmware/controller/src/lib.rs");
    let text = std::fs::read_to_string(file).expect("the controller is readable");
    let docs: Vec<&str> = text.lines().map_while(|line| line.strip_prefix("//!")).collect();
    let docs = docs.join("\n");
    let entries = docs.split("\n - **").skip(1);
    entries
        .map(|entry| {
            let entry = entry.split("\n\n").next().unwrap_or_default();
            let (word, meaning) = entry.split_once("**:").expect("an entry is `**word**: meaning`");
            (word.to_owned(), meaning.split_whitespace().collect::<Vec<_>>().join(" "))
        })
        .collect()
}

#[test]
fn the_glossary_explains_every_word_once() {
    let entries = glossary();
    let words: Vec<&str> = entries.iter().map(|(word, _)| word.as_str()).collect();
    let missing: Vec<_> = WORDS.iter().filter(|word| !words.contains(word)).collect();
    assert!(missing.is_empty(), "the glossary does not explain {missing:?}");
    assert!(words.is_sorted_by(|a, b| a < b), "sort the glossary, one entry per word: {words:?}");
    for (word, meaning) in &entries {
        assert!(meaning.split(' ').count() >= 3, "{word} needs a meaning, not \"{meaning}\"");
    }
}

/// The variants of [`Reason`], from its source.
#[test]
fn every_reason_is_explained() {
    let read = |file: &str| std::fs::read_to_string(root().join(file)).expect("it is readable");
    let source = read("shared/robot-io/src/commands.rs");
    let variants = source.split_once("pub enum Reason {").expect("the enum").1;
    let variants = variants.split_once('}').expect("its end").0.lines().map(str::trim);
    let variants: Vec<_> = variants.filter_map(|line| line.strip_suffix(',')).collect();
    assert!(variants.contains(&format!("{:?}", Reason::LowBattery).as_str()), "{variants:?}");
    let document = read("plan-compiler/MISSION.md");
    for variant in variants.iter().filter(|line| !line.starts_with("///")) {
        assert!(document.contains(&format!("\n| `{variant}` | ")), "MISSION.md lacks `{variant}`");
    }
}

/// A name that a file defines, and the keyword before it.
type Defined = (Kind, String, &'static str);

/// Collects the names that a file defines.
#[derive(Default)]
struct Names(Vec<Defined>);

impl Names {
    fn add(&mut self, kind: Kind, keyword: &'static str, name: &Ident) {
        self.0.push((kind, name.to_string(), keyword));
    }

    fn add_function(&mut self, visibility: &Visibility, name: &Ident) {
        self.add(Function, "fn", name);
        if matches!(visibility, Visibility::Public(_)) {
            self.add(PublicFunction, "fn", name);
        }
    }
}

impl Visit<'_> for Names {
    fn visit_item_struct(&mut self, item: &ItemStruct) {
        self.add(Type, "struct", &item.ident);
    }

    fn visit_item_enum(&mut self, item: &ItemEnum) {
        self.add(Type, "enum", &item.ident);
    }

    fn visit_item_type(&mut self, item: &ItemType) {
        self.add(Type, "type", &item.ident);
    }

    fn visit_item_trait(&mut self, item: &ItemTrait) {
        self.add(Type, "trait", &item.ident);
        visit::visit_item_trait(self, item);
    }

    fn visit_item_mod(&mut self, item: &ItemMod) {
        // A module in a file of its own is found by that file.
        if item.content.is_some() {
            self.add(Module, "mod", &item.ident);
        }
        visit::visit_item_mod(self, item);
    }

    fn visit_item_fn(&mut self, item: &ItemFn) {
        self.add_function(&item.vis, &item.sig.ident);
        visit::visit_item_fn(self, item);
    }

    fn visit_impl_item_fn(&mut self, item: &ImplItemFn) {
        self.add_function(&item.vis, &item.sig.ident);
        visit::visit_impl_item_fn(self, item);
    }

    fn visit_trait_item_fn(&mut self, item: &TraitItemFn) {
        self.add(Function, "fn", &item.sig.ident);
    }
}

/// The names that a source text defines, and the modules that its path names.
fn names(file: &str, text: &str) -> Vec<Defined> {
    let mut names = Names::default();
    names.visit_file(&syn::parse_file(text).expect("a source is Rust"));
    let path = Path::new(file);
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let folder = path.parent().and_then(Path::file_name).unwrap_or_default().to_string_lossy();
    let module = if stem == "mod" { folder } else { stem };
    names.0.push((Module, module.into_owned(), "mod"));
    names.0
}

/// The definitions of a file that use a reserved name.
fn misused(file: &str, text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for (kind, name, keyword) in names(file, text) {
        let row = RESERVED.iter().find(|row| row.kind == kind && row.name == name);
        let row = row.filter(|row| !row.allowed.iter().any(|start| file.starts_with(start)));
        if let Some(Reserved { instead, reason, .. }) = row {
            let kind = match kind {
                Type => "type",
                Module => "module",
                Function | PublicFunction => "function",
            };
            // The module of a whole file is on its first line.
            let definition = format!("{keyword} {name}");
            let line = text.lines().position(|line| line.contains(&definition)).unwrap_or(0) + 1;
            found.push(format!("{file}:{line}: {kind} `{name}`: {reason}; use {instead}"));
        }
    }
    found
}

#[test]
fn a_name_means_what_the_glossary_says() {
    let mut found = Vec::new();
    super::layering::visit(root(), &mut |path| {
        if path.extension().is_some_and(|extension| extension == "rs") {
            let file = path.strip_prefix(root()).expect("below the root").to_string_lossy();
            let text = std::fs::read_to_string(path).expect("a source is readable");
            found.extend(misused(&file.replace('\\', "/"), &text));
        }
    });
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn reserved_names_are_found_and_allowed_ones_are_not() {
    let text = "pub struct Grid;\nimpl Grid {\n    fn told(&self) {}\n}\nmod link { trait Way {} }";
    let lines = |file: &str| -> Vec<String> {
        let found = misused(file, text);
        found.iter().filter_map(|line| Some(line.split_once(": ")?.1.to_owned())).collect()
    };
    let found = lines("firmware/x/src/frame/mod.rs");
    let starts =
        ["type `Grid`", "function `told`", "module `link`", "type `Way`", "module `frame`"];
    assert_eq!(found.len(), starts.len(), "{found:#?}");
    for (line, start) in found.iter().zip(starts) {
        assert!(line.starts_with(start), "{line}");
    }
    let found = lines("shared/math/src/grid.rs");
    assert!(!found.iter().any(|line| line.contains("`Grid`") || line.contains("`grid`")));
    assert!(lines(&format!("{OSM}/link.rs")).iter().all(|line| !line.contains("`Way`")));
}
