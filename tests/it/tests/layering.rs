//! Checks on the structure of the project: dependencies run one way, `unsafe` stays where it is
//! allowed, and every crate and every test that the documents name exists. All is read from the
//! manifests and sources.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use it::root;

/// The project's crates, each with those that it may use. A crate without a row fails the test, so
/// that a new crate gets its layer deliberately.
const MAY_USE: &[(&str, &[&str])] = &[
    ("math", &[]),
    ("plan-format", &["math"]),
    ("board-table", &[]),
    ("robot-io", &["math"]),
    ("advice", &["math", "plan-format"]),
    ("schemas", &["math", "plan-format", "robot-io"]),
    ("parts", &["plan-format"]),
    ("grammar", &["parts", "plan-format"]),
    ("monitor", &["parts", "plan-format"]),
    ("behaviour", &["fuzzy", "grammar", "math", "monitor", "parts", "plan-format"]),
    ("fuzzy", &["math", "plan-format"]),
    ("controller", &["advice", "behaviour", "math", "plan-format", "robot-io", "schemas"]),
    ("runtime", &["controller", "math", "plan-format", "robot-io"]),
    ("maps", &["math"]),
    (
        "plan-compiler",
        &[
            "advice",
            "behaviour",
            "board-table",
            "controller",
            "fuzzy",
            "grammar",
            "maps",
            "math",
            "monitor",
            "plan-format",
            "robot-io",
        ],
    ),
    ("nrf52840-dk", &["board-table", "math", "plan-format", "robot-io", "runtime"]),
    ("stm32f405", &["board-table", "math", "plan-format", "robot-io", "runtime"]),
    ("stm32h743", &["board-table", "math", "plan-format", "robot-io", "runtime"]),
    ("pico2", &["board-table", "math", "plan-format", "robot-io", "runtime"]),
    ("guest", &["board-table", "controller", "math", "plan-format", "robot-io", "runtime"]),
    ("fixtures", &["plan-format"]),
    ("sim", &["maps", "math", "plan-format", "robot-io", "runtime"]),
    (
        "soak",
        &[
            "behaviour",
            "controller",
            "fixtures",
            "maps",
            "math",
            "monitor",
            "plan-compiler",
            "plan-format",
            "robot-io",
        ],
    ),
    (
        "fuzz",
        &[
            "controller",
            "maps",
            "math",
            "plan-compiler",
            "plan-format",
            "robot-io",
            "runtime",
            "sim",
            "soak",
        ],
    ),
    (
        "harness",
        &[
            "board-table",
            "maps",
            "math",
            "plan-compiler",
            "plan-format",
            "robot-io",
            "runtime",
            "sim",
            "soak",
        ],
    ),
    (
        "it",
        &[
            "behaviour",
            "board-table",
            "controller",
            "harness",
            "maps",
            "math",
            "plan-compiler",
            "plan-format",
            "robot-io",
            "runtime",
            "sim",
            "soak",
        ],
    ),
];

/// Folders whose code may be `unsafe`: the shell, the boards and the QEMU guest.
const MAY_BE_UNSAFE: &[&str] = &["firmware/runtime", "boards/fault.rs", "qemu/guest"];

/// Files and folders at the root, besides dot files and build output.
const AT_ROOT: &[&str] = &[
    "CHANGELOG.md",
    "Cargo.lock",
    "Cargo.toml",
    "LICENSE-APACHE",
    "LICENSE-MIT",
    "README.md",
    "SECURITY.md",
    "boards",
    "clippy.toml",
    "deny.toml",
    "firmware",
    "plan-compiler",
    "qemu",
    "rust-toolchain.toml",
    "rustfmt.toml",
    "shared",
    "tests",
];

#[test]
fn dependencies_run_one_way() {
    let allowed: BTreeMap<_, _> =
        MAY_USE.iter().map(|(name, uses)| (*name, uses.iter().copied().collect())).collect();
    let ours: BTreeSet<&str> = allowed.keys().copied().collect();
    let mut wrong = Vec::new();
    for manifest in manifests() {
        let document = read_manifest(&manifest);
        let name = crate_name(&document);
        let Some(may): Option<&BTreeSet<&str>> = allowed.get(name.as_str()) else {
            wrong.push(format!("{name} has no row in MAY_USE"));
            continue;
        };
        for used in dependencies(document.as_table()) {
            if ours.contains(used.as_str()) && !may.contains(used.as_str()) {
                wrong.push(format!("{name} must not use {used}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn unsafe_code_stays_in_its_folders() {
    let mut wrong = Vec::new();
    visit(root(), &mut |path| {
        if path.extension().is_some_and(|extension| extension == "rs") {
            let relative = path.strip_prefix(root()).expect("below the root");
            let text = std::fs::read_to_string(path).expect("a source file is readable");
            if lowers_unsafe_lint(&text)
                && !MAY_BE_UNSAFE.iter().any(|folder| relative.starts_with(folder))
            {
                wrong.push(format!("{} lowers the lint on unsafe code", relative.display()));
            }
        }
    });
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Whether an attribute of a source file lowers the lint on unsafe code.
fn lowers_unsafe_lint(text: &str) -> bool {
    ["allow(", "expect(", "warn("].iter().any(|attribute| {
        let lists = text.split(attribute).skip(1).filter_map(|rest| rest.split(')').next());
        lists.flat_map(|list| list.split(',')).any(|lint| lint.trim() == concat!("unsafe", "_code"))
    })
}

#[test]
fn every_attribute_that_lowers_the_unsafe_lint_is_found() {
    for lowered in [
        "#![allow(UNSAFE)]",
        r#"#[expect(UNSAFE, reason = "flash")]"#,
        "#[allow(\n    dead_code,\n    UNSAFE,\n)]",
        r#"#![cfg_attr(target_os = "none", warn(UNSAFE))]"#,
    ] {
        let text = lowered.replace("UNSAFE", concat!("unsafe", "_code"));
        assert!(lowers_unsafe_lint(&text), "{text}");
    }
    for kept in ["#![deny(UNSAFE)]", "#[expect(dead_code)]", r#"slot.expect("is unsafe")"#] {
        let text = kept.replace("UNSAFE", concat!("unsafe", "_code"));
        assert!(!lowers_unsafe_lint(&text), "{text}");
    }
}

#[test]
fn every_crate_uses_the_workspace_lints() {
    for manifest in manifests() {
        let text = std::fs::read_to_string(&manifest).expect("a manifest is readable");
        assert!(text.contains("[lints]\nworkspace = true"), "{}", manifest.display());
    }
}

#[test]
fn the_root_holds_nothing_else() {
    for entry in std::fs::read_dir(root()).expect("the root is readable") {
        let name = entry.expect("an entry is readable").file_name().into_string().expect("UTF-8");
        let known = name.starts_with('.') || name == "target" || AT_ROOT.contains(&name.as_str());
        assert!(known, "{name} does not belong at the root");
    }
}

/// The rows of the README's code map: the crate in each folder, where there is one.
fn code_map() -> Vec<String> {
    let readme = std::fs::read_to_string(root().join("README.md")).expect("there is a README");
    let (_, table) = readme.split_once("| folder |").expect("the README has a code map");
    let rows = table.lines().skip(2).take_while(|line| line.starts_with('|'));
    let folders = rows.filter_map(|row| row.split('`').nth(1));
    folders
        .filter_map(|folder| {
            let manifest = root().join(folder).join("Cargo.toml");
            manifest.is_file().then(|| crate_name(&read_manifest(&manifest)))
        })
        .collect()
}

/// The code map of the README names the folder of every crate.
#[test]
fn the_readme_maps_every_crate() {
    let mapped: BTreeSet<String> = code_map().into_iter().collect();
    let ours: BTreeSet<String> =
        manifests().iter().map(|manifest| crate_name(&read_manifest(manifest))).collect();
    assert_eq!(mapped, ours);
}

#[test]
fn each_crate_of_the_code_map_stands_below_those_that_it_uses() {
    let map = code_map();
    let row = |name: &str| map.iter().position(|mapped| mapped == name);
    let mut wrong = Vec::new();
    for (name, uses) in MAY_USE {
        for used in *uses {
            if row(used) >= row(name) {
                wrong.push(format!("{name} stands above {used}, which it may use"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn one_version_of_rust_is_pinned_stated_and_documented() {
    let read = |file: &str| std::fs::read_to_string(root().join(file)).expect("it is there");
    let table = |file: &str| read(file).parse::<toml_edit::DocumentMut>().expect("it is TOML");
    let pinned = table("rust-toolchain.toml");
    let pinned = pinned["toolchain"]["channel"].as_str().expect("a channel").to_owned();
    let stated = table("Cargo.toml");
    let stated = stated["workspace"]["package"]["rust-version"].as_str().expect("a version");
    // CI builds with the pinned version only, so it proves no older one.
    assert_eq!(pinned, format!("{stated}.0"));
    for document in ["README.md", ".github/CONTRIBUTING.md"] {
        assert!(read(document).contains(&format!("Rust {stated} ")), "{document}: not {stated}");
    }
    for manifest in manifests() {
        let manifest = read_manifest(&manifest);
        let taken = &manifest["package"]["rust-version"]["workspace"];
        assert_eq!(taken.as_bool(), Some(true), "{} states its own", crate_name(&manifest));
    }
}

/// The code and the tests that a requirement names exist; a requirement without a test is marked open.
#[test]
fn every_requirement_names_code_and_tests_that_exist() {
    let table = std::fs::read_to_string(root().join("tests/REQUIREMENTS.md")).expect("it is there");
    let mut sources = String::new();
    for top in ["shared", "firmware", "qemu", "tests", "plan-compiler"] {
        visit(&root().join(top), &mut |path| {
            if path.extension().is_some_and(|extension| extension == "rs") {
                sources += &std::fs::read_to_string(path).expect("a source file is readable");
            }
        });
    }
    let mut wrong = Vec::new();
    for row in table.lines().filter(|line| line.starts_with("| W") || line.starts_with("| H")) {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        let (id, place, proof) = (cells[1], cells[3], cells[4]);
        let paths = place.split('`').skip(1).step_by(2).filter(|path| path.contains('/'));
        for path in paths.filter(|path| !root().join(path).exists()) {
            wrong.push(format!("{id}: `{path}` does not exist"));
        }
        // Every second part is between backticks; the name of a test has an underscore.
        let names = proof.split('`').skip(1).step_by(2).filter(|name| name.contains('_'));
        for name in names {
            if !sources.contains(&format!("fn {name}(")) {
                wrong.push(format!("{id}: the test `{name}` does not exist"));
            }
        }
        if proof.is_empty() {
            wrong.push(format!("{id} is neither proved nor open"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

pub(crate) fn manifests() -> Vec<std::path::PathBuf> {
    let mut found = Vec::new();
    for top in ["shared", "firmware", "boards", "qemu", "tests", "plan-compiler"] {
        visit(&root().join(top), &mut |path| {
            if path.file_name().is_some_and(|name| name == "Cargo.toml") {
                found.push(path.to_owned());
            }
        });
    }
    assert!(found.len() >= MAY_USE.len(), "some crates were not found");
    found
}

fn read_manifest(path: &Path) -> toml_edit::Document<String> {
    let text = std::fs::read_to_string(path).expect("a manifest is readable");
    text.parse().expect("a manifest is TOML")
}

/// The package's name in other manifests: without the prefix of published packages.
fn crate_name(manifest: &toml_edit::Document<String>) -> String {
    let package = manifest["package"]["name"].as_str().expect("a package has a name");
    package.strip_prefix("wayfield-").unwrap_or(package).to_owned()
}

fn dependencies(table: &toml_edit::Table) -> Vec<String> {
    let mut names = Vec::new();
    // Only dependencies that are linked into a product count, not those of tests.
    for section in ["dependencies", "build-dependencies"] {
        if let Some(entries) = table.get(section).and_then(|item| item.as_table_like()) {
            names.extend(entries.iter().map(|(name, _)| name.to_owned()));
        }
    }
    if let Some(targets) = table.get("target").and_then(|item| item.as_table_like()) {
        for (_, target) in targets.iter() {
            if let Some(target) = target.as_table() {
                names.extend(dependencies(target));
            }
        }
    }
    names
}

/// Calls `seen` for every file below `path`, except build output, dot files and dot folders.
pub(crate) fn visit(path: &Path, seen: &mut dyn FnMut(&Path)) {
    for entry in std::fs::read_dir(path).expect("a folder is readable") {
        let entry = entry.expect("an entry is readable").path();
        let name = entry.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if name.starts_with('.') || name == "target" {
            continue;
        }
        if entry.is_dir() {
            visit(&entry, seen);
        } else {
            seen(&entry);
        }
    }
}
