//! Counts a file's objects that are not on the map, by kind.

use super::Tags;
use std::collections::HashMap;

/// Most kinds that are counted separately.
const MAX_KINDS: usize = 4096;
/// Most kinds that are listed, the most frequent first.
const LISTED: usize = 12;
/// Most characters shown of a kind.
const SHOWN: usize = 40;
/// Keys that identify an object, the most telling first.
const TELLING: [&str; 18] = [
    "building", "barrier", "natural", "waterway", "man_made", "landuse", "leisure", "amenity",
    "highway", "railway", "power", "shop", "tourism", "historic", "place", "boundary", "layer",
    "type",
];
/// Keys that describe the data's source rather than the object.
const BOOKKEEPING: [&str; 10] = [
    "name",
    "id",
    "osm_id",
    "osm_way_id",
    "source",
    "created_by",
    "note",
    "goal",
    "version",
    "timestamp",
];

/// Objects that are ignored.
#[derive(Debug, Default)]
pub(in crate::formats) struct Unused {
    kinds: HashMap<String, usize>,
    total: usize,
}

impl Unused {
    pub(in crate::formats) fn add(&mut self, tags: &Tags) {
        self.total += 1;
        let kind = kind(tags);
        let has_room = self.kinds.len() < MAX_KINDS;
        match self.kinds.get_mut(&kind) {
            Some(count) => *count += 1,
            None if has_room => {
                self.kinds.insert(kind, 1);
            }
            None => {}
        }
    }

    pub(in crate::formats) fn total(&self) -> usize {
        self.total
    }

    /// `highway=residential 12, amenity=bench 3 and others 2`.
    pub(in crate::formats) fn list(&self) -> String {
        let mut kinds: Vec<(&String, &usize)> = self.kinds.iter().collect();
        kinds.sort_by(|a, b| b.1.cmp(a.1).then(a.0.cmp(b.0)));
        kinds.truncate(LISTED);
        let rest = self.total - kinds.iter().map(|(_, count)| **count).sum::<usize>();
        let listed: Vec<String> =
            kinds.iter().map(|(kind, count)| format!("{kind} {count}")).collect();
        let others = if rest > 0 { format!(" and others {rest}") } else { String::new() };
        format!("{}{others}", listed.join(", "))
    }
}

/// The tag that identifies an object best.
fn kind(tags: &Tags) -> String {
    let telling = TELLING
        .iter()
        .find_map(|key| tags.0.iter().find(|(known, _)| known.trim().eq_ignore_ascii_case(key)));
    let is_bookkeeping = |key: &str| {
        BOOKKEEPING.iter().any(|known| key.eq_ignore_ascii_case(known))
            || key.starts_with(['@', '_'])
            || key.starts_with("addr:")
    };
    let other = || tags.0.iter().find(|(key, _)| !is_bookkeeping(key));
    match telling.or_else(other).or_else(|| tags.0.first()) {
        Some((key, value)) => {
            let text = format!("{}={}", key.trim(), value.trim());
            let shown = text.chars().map(|c| if c.is_control() { ' ' } else { c });
            shown.take(SHOWN).collect()
        }
        None => "no tags".into(),
    }
}
