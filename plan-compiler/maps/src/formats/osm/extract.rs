//! The content of a file in any encoding, collected object by object within a memory budget.
//!
//! The highest version of an object counts; a version marked as deleted removes the object. Equal
//! versions complete each other: a server may send the tags and the outline of a way separately.

use crate::formats::globe::Bounds;
use crate::formats::tags::Tags;
use math::GeoPoint;
use std::collections::HashMap;
use std::ops::Range;

/// Memory budget for the objects of an extract, bytes: about 12 million nodes, a city of four
/// million people, far more than a robot needs.
pub(super) const BUDGET_BYTES: usize = 1 << 30;
/// Memory of a node without tags, including its share of half-empty tables, bytes.
const NODE_BYTES: usize = 72;
/// Memory of an object without its parts, bytes.
const OBJECT_BYTES: usize = 192;
/// Memory of a tag without its text, bytes.
const TAG_BYTES: usize = 96;
const REF_BYTES: usize = 16;
const MEMBER_BYTES: usize = 32;

/// The content of a file, in its order.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Extract {
    pub(super) bounds: Option<Bounds>,
    pub(super) places: HashMap<i64, GeoPoint>,
    /// Nodes with tags.
    pub(super) nodes: Vec<Object>,
    pub(super) ways: Vec<Way>,
    pub(super) relations: Vec<Relation>,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Object {
    pub(super) id: i64,
    pub(super) tags: Tags,
    /// Its bytes in a text file; empty for a binary file.
    pub(super) span: Range<usize>,
}

#[derive(Debug, PartialEq)]
pub(super) struct Way {
    pub(super) object: Object,
    /// Its nodes.
    pub(super) refs: Vec<i64>,
}

#[derive(Debug, PartialEq)]
pub(super) struct Relation {
    pub(super) object: Object,
    /// Those of its members that are ways.
    pub(super) members: Vec<Member>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Member {
    pub(super) way: i64,
    pub(super) is_inner: bool,
}

/// Version of an object, and whether this version deletes it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Version {
    pub(super) number: u32,
    pub(super) is_deleted: bool,
}

/// The file exceeds the memory budget.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TooMuch;

impl TooMuch {
    pub(super) const MESSAGE: &str =
        "it is larger than a robot's map needs to be: over 1 GiB of memory";
    pub(super) const HELP: &str =
        "cut out a smaller part: `osmium extract --bbox WEST,SOUTH,EAST,NORTH --strategy smart`";
}

/// The newest version of each object, in order of first occurrence.
#[derive(Debug)]
struct Newest<T> {
    at: HashMap<i64, usize>,
    all: Vec<(u32, Option<T>)>,
}

impl<T> Default for Newest<T> {
    fn default() -> Self {
        Self { at: HashMap::new(), all: Vec::new() }
    }
}

impl<T> Newest<T> {
    fn add(&mut self, id: i64, version: Version, value: T, merge: impl FnOnce(&mut T, T)) {
        let value = (!version.is_deleted).then_some(value);
        let Some((number, newest)) = self.at.get(&id).and_then(|at| self.all.get_mut(*at)) else {
            self.at.insert(id, self.all.len());
            self.all.push((version.number, value));
            return;
        };
        match (version.number.cmp(number), newest.as_mut(), value) {
            (std::cmp::Ordering::Less, ..) => {}
            (std::cmp::Ordering::Equal, Some(known), Some(more)) => merge(known, more),
            (_, _, value) => (*number, *newest) = (version.number, value),
        }
    }

    fn into_all(self) -> impl Iterator<Item = T> {
        self.all.into_iter().filter_map(|(_, value)| value)
    }
}

/// Collects the objects that an encoding's reader finds.
#[derive(Debug)]
pub(super) struct Builder {
    bounds: Option<Bounds>,
    places: Newest<GeoPoint>,
    nodes: Newest<Object>,
    ways: Newest<Way>,
    relations: Newest<Relation>,
    /// Remaining budget, bytes.
    left: usize,
    /// Last id given to a node without coordinates.
    unknown: i64,
}

impl Builder {
    pub(super) fn new(budget: usize) -> Self {
        Self {
            bounds: None,
            places: Newest::default(),
            nodes: Newest::default(),
            ways: Newest::default(),
            relations: Newest::default(),
            left: budget,
            unknown: i64::MIN,
        }
    }

    /// Charges memory to the budget before it is allocated.
    pub(super) fn take(&mut self, bytes: usize) -> Result<(), TooMuch> {
        self.left = self.left.checked_sub(bytes).ok_or(TooMuch)?;
        Ok(())
    }

    /// Charges the memory of one more tag.
    pub(super) fn take_tag(&mut self, key: &str, value: &str) -> Result<(), TooMuch> {
        self.take(TAG_BYTES + key.len() + value.len())
    }

    /// Charges the memory of one more reference.
    pub(super) fn take_ref(&mut self) -> Result<(), TooMuch> {
        self.take(REF_BYTES)
    }

    /// Charges the memory of one more member.
    pub(super) fn take_member(&mut self) -> Result<(), TooMuch> {
        self.take(MEMBER_BYTES)
    }

    /// Adds bounds: a file joined from several has the bounds of each.
    pub(super) fn bounds(&mut self, bounds: Bounds) {
        self.bounds = Some(self.bounds.map_or(bounds, |known| known.and(bounds)));
    }

    /// Adds a node's place from a way, unless the file gave the node already.
    pub(super) fn place(&mut self, id: i64, place: GeoPoint) -> Result<(), TooMuch> {
        if !self.places.at.contains_key(&id) {
            self.take(NODE_BYTES)?;
            self.places.add(id, Version::default(), place, |_, _| {});
        }
        Ok(())
    }

    /// Adds a node whose place alone is known; equal places are the same node.
    pub(super) fn unnamed(&mut self, place: Option<GeoPoint>) -> Result<i64, TooMuch> {
        let Some(place) = place else {
            self.unknown += 1;
            return Ok(self.unknown);
        };
        let id = id_of(place);
        self.place(id, place)?;
        Ok(id)
    }

    pub(super) fn node(
        &mut self,
        version: Version,
        object: Object,
        place: GeoPoint,
    ) -> Result<(), TooMuch> {
        self.take(NODE_BYTES)?;
        self.places.add(object.id, version, place, |_, _| {});
        if !object.tags.0.is_empty() || self.nodes.at.contains_key(&object.id) {
            self.take(OBJECT_BYTES)?;
            self.nodes.add(object.id, version, object, keep_tags);
        }
        Ok(())
    }

    pub(super) fn way(&mut self, version: Version, way: Way) -> Result<(), TooMuch> {
        self.take(OBJECT_BYTES)?;
        self.ways.add(way.object.id, version, way, |known, more| {
            keep_tags(&mut known.object, more.object);
            if known.refs.is_empty() {
                known.refs = more.refs;
            }
        });
        Ok(())
    }

    pub(super) fn relation(&mut self, version: Version, relation: Relation) -> Result<(), TooMuch> {
        self.take(OBJECT_BYTES)?;
        self.relations.add(relation.object.id, version, relation, |known, more| {
            keep_tags(&mut known.object, more.object);
            if known.members.is_empty() {
                known.members = more.members;
            }
        });
        Ok(())
    }

    pub(super) fn finish(self) -> Extract {
        let places = self.places;
        let place = |(id, at): (i64, usize)| Some((id, places.all.get(at)?.1?));
        let nodes = self.nodes.into_all().filter(|node| !node.tags.0.is_empty());
        Extract {
            bounds: self.bounds,
            places: places.at.into_iter().filter_map(place).collect(),
            nodes: nodes.collect(),
            ways: self.ways.into_all().collect(),
            relations: self.relations.into_all().collect(),
        }
    }
}

fn keep_tags(known: &mut Object, more: Object) {
    if known.tags.0.is_empty() {
        *known = more;
    }
}

/// An id made from a place. It differs from those of servers and editors, which count from 1
/// upwards or from -1 downwards.
pub(super) fn id_of(place: GeoPoint) -> i64 {
    // 31 bits of latitude, 32 of longitude; smaller ids are for nodes without a place.
    let lat = i64::from(place.lat_e7) + 900_000_000;
    let lon = i64::from(place.lon_e7) + 1_800_000_000;
    FIRST_PLACE + (lat << 32 | lon)
}

/// The id of the place 90 degrees south, 180 west.
const FIRST_PLACE: i64 = i64::MIN + (1 << 60);

/// The place that an id was made from, if any.
pub(super) fn place_of(id: i64) -> Option<GeoPoint> {
    let number = id.checked_sub(FIRST_PLACE).filter(|number| *number >= 0)?;
    let lat_e7 = i32::try_from((number >> 32) - 900_000_000).ok()?;
    let lon_e7 = i32::try_from((number & 0xffff_ffff) - 1_800_000_000).ok()?;
    Some(GeoPoint { lat_e7, lon_e7 }).filter(|place| place.is_valid())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn version(number: u32, is_deleted: bool) -> Version {
        Version { number, is_deleted }
    }

    fn way(id: i64, tag: &str, refs: &[i64]) -> Way {
        let tags = if tag.is_empty() { Vec::new() } else { vec![(tag.into(), "yes".into())] };
        Way { object: Object { id, tags: Tags(tags), span: 0..0 }, refs: refs.to_vec() }
    }

    fn check(ways: Vec<(Version, Way)>, expected: &[Way]) {
        let mut builder = Builder::new(BUDGET_BYTES);
        ways.into_iter().for_each(|(version, way)| builder.way(version, way).expect("room"));
        assert_eq!(builder.finish().ways, expected);
    }

    #[test]
    fn the_newest_version_counts_in_any_order() {
        let (old, new) = (|| way(1, "old", &[1, 2]), || way(1, "new", &[1, 3]));
        check(vec![(version(1, false), old()), (version(2, false), new())], &[new()]);
        check(vec![(version(2, false), new()), (version(1, false), old())], &[new()]);
        check(vec![(version(1, false), old()), (version(2, true), way(1, "", &[]))], &[]);
        check(vec![(version(2, true), way(1, "", &[])), (version(1, false), old())], &[]);
        let back =
            vec![(version(1, false), old()), (version(2, true), old()), (version(3, false), new())];
        check(back, &[new()]);
    }

    #[test]
    fn equal_versions_complete_each_other() {
        let same = || version(0, false);
        let whole = way(1, "building", &[1, 2]);
        check(vec![(same(), way(1, "building", &[])), (same(), way(1, "", &[1, 2]))], &[whole]);
        let whole = way(1, "building", &[1, 2]);
        check(vec![(same(), way(1, "", &[1, 2])), (same(), way(1, "building", &[]))], &[whole]);
    }

    #[test]
    fn the_budget_is_asked_before_memory_is_taken() {
        let mut builder = Builder::new(10 * NODE_BYTES);
        let place = |n: i32| GeoPoint { lat_e7: n, lon_e7: n };
        let taken = (0..100).take_while(|n| builder.unnamed(Some(place(*n))).is_ok()).count();
        assert_eq!(taken, 10);
        assert_eq!(builder.take_ref(), Err(TooMuch));
        // A known place is free.
        assert_eq!(builder.unnamed(Some(place(3))), Ok(id_of(place(3))));
    }

    #[test]
    fn places_have_numbers_of_their_own() {
        let corners = [-900_000_000, 0, 900_000_000].map(|lat_e7| {
            [-1_800_000_000, 0, 1_800_000_000].map(|lon_e7| {
                let place = GeoPoint { lat_e7, lon_e7 };
                assert_eq!(place_of(id_of(place)), Some(place));
                id_of(place)
            })
        });
        assert_eq!([-1, 0, 1, i64::MAX, i64::MIN + 1].map(place_of), [None; 5]);
        let mut ids = corners.concat();
        ids.sort_unstable();
        ids.dedup();
        assert_eq!(ids.len(), 9);
        assert!(ids[0] > i64::MIN + (1 << 59) && ids[8] < -(1 << 40));
    }
}
