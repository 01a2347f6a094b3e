//! Which keys a mission file sets, and where: the others follow from them.

use maps::problem::Place;
use std::collections::BTreeMap;

/// The keys that a mission file sets, as `section.name`, with their places.
#[derive(Clone, Debug, Default)]
pub struct Given {
    places: BTreeMap<String, Place>,
    is_paper: bool,
}

impl Given {
    pub(super) fn add(&mut self, path: String, place: Place) {
        self.places.insert(path, place);
    }

    /// Whether the file sets a key.
    pub fn has(&self, path: &str) -> bool {
        self.places.contains_key(path)
    }

    /// Whether the file starts from the paper's values.
    pub(super) fn is_paper(&self) -> bool {
        self.is_paper
    }

    pub(super) fn set_paper(&mut self) {
        self.is_paper = true;
    }

    /// Where the file sets a key.
    pub fn place(&self, path: &str) -> Option<&Place> {
        self.places.get(path)
    }
}
