//! Paths that the integration tests share: the project, its maps, and files made by others.

use std::path::{Path, PathBuf};

/// The project's root.
pub fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

/// The path of one of the project's own maps.
pub fn own_map(name: &str) -> PathBuf {
    root().join("tests/maps").join(name)
}

/// A folder of real files made by others. It lies beside the project on our machines and in CI, but
/// is not part of the project. If it is missing, this prints a note, and the test must return.
pub fn real_data(folder: &str) -> Option<PathBuf> {
    let path = root().join("../shared/data").join(folder);
    if path.is_dir() {
        return Some(path);
    }
    eprintln!("skipped: no {} beside the project (real files made by others)", path.display());
    None
}
