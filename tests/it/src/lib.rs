//! What the integration tests share: where the project and the data made by others lie.

use std::path::{Path, PathBuf};

/// The project's root.
pub fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

/// A file of the project's own maps.
pub fn own_map(name: &str) -> PathBuf {
    root().join("tests/maps").join(name)
}

/// The folder of real files made by others, which lies beside the project on our machines and
/// in CI but is not part of it. Where it is missing this says so, and the caller returns.
pub fn real_data(folder: &str) -> Option<PathBuf> {
    let path = root().join("../shared/data").join(folder);
    if path.is_dir() {
        return Some(path);
    }
    eprintln!("skipped: no {} beside the project (real files made by others)", path.display());
    None
}
