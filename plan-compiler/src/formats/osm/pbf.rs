//! OpenStreetMap's binary encoding: protocol buffers in compressed blocks.

use super::{Extract, Member, Object, Relation, Way};
use crate::formats::globe::Bounds;
use crate::formats::tags::Tags;
use crate::problem::Problem;
use math::GeoPoint;
use osmpbf::{BlobDecode, BlobReader, Element, HeaderBlock, RelMemberType};
use std::panic::{self, AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// Most nodes of an extract, some 600 MB of memory: a country, far more than a robot drives in.
const MAX_NODES: usize = 1 << 24;
/// What the library decodes; a file that needs more cannot be understood.
const FEATURES: [&str; 2] = ["OsmSchema-V0.6", "DenseNodes"];

/// Whether bytes begin with the header that every such file has.
pub(super) fn recognises(bytes: &[u8]) -> bool {
    // Four bytes of length, then field 1, nine bytes long.
    bytes.get(4..).is_some_and(|rest| rest.starts_with(b"\x0a\x09OSMHeader"))
}

/// What an extract holds, and warnings; an error where the file is damaged.
pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<(Extract, Vec<Problem>), Problem> {
    let name = path.display();
    // The library panics on kinds of members that are not, and in debug builds on sums that
    // overflow. Only a damaged file holds either; nothing of the extract is used then.
    let decoded = quietly(|| catch_unwind(AssertUnwindSafe(|| decode(bytes))));
    decoded.unwrap_or_else(|_| Err("it holds numbers that mean nothing".into())).map_err(|reason| {
        Problem::error(format!("{name} cannot be read: {reason}")).mend(
            "it may be damaged or cut off: fetch it again, or check it with `osmium fileinfo -e`",
        )
    })
}

/// Runs something whose panics are caught and told in our own words. The hook is the whole
/// program's, so one at a time.
fn quietly<T>(run: impl FnOnce() -> T) -> T {
    static TURN: Mutex<()> = Mutex::new(());
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let hook = panic::take_hook();
    panic::set_hook(Box::new(|_| {}));
    let result = run();
    panic::set_hook(hook);
    result
}

fn decode(bytes: &[u8]) -> Result<(Extract, Vec<Problem>), String> {
    let mut extract = Extract::default();
    let mut off_the_globe = 0;
    let mut has_header = false;
    for blob in BlobReader::new(bytes) {
        match blob.map_err(say)?.decode().map_err(say)? {
            BlobDecode::OsmHeader(header) => {
                check(&header)?;
                has_header = true;
                extract.bounds = extract.bounds.or(bounds(&header));
            }
            BlobDecode::OsmData(block) => {
                block.for_each_element(|element| {
                    off_the_globe += usize::from(!add(&mut extract, &element));
                });
            }
            BlobDecode::Unknown(_) => {}
        }
        if extract.places.len() > MAX_NODES {
            return Err(format!("it has more than {MAX_NODES} nodes; cut out a smaller part"));
        }
    }
    if !has_header {
        return Err("it is no OpenStreetMap file".into());
    }
    let warning = (off_the_globe > 0).then(|| {
        Problem::warning(format!("{off_the_globe} nodes are off the globe; they are left out"))
    });
    Ok((extract, warning.into_iter().collect()))
}

fn say(error: osmpbf::Error) -> String {
    error.to_string()
}

fn check(header: &HeaderBlock) -> Result<(), String> {
    let known = |feature: &&String| !FEATURES.contains(&feature.as_str());
    match header.required_features().iter().find(known) {
        Some(feature) => Err(format!("it needs a reader that understands {feature}")),
        None => Ok(()),
    }
}

fn bounds(header: &HeaderBlock) -> Option<Bounds> {
    let bbox = header.bbox()?;
    // The library gives nanodegrees times 1e-9, which is not the nearest number to them.
    let corner = |lat: f64, lon: f64| [lat, lon].map(|degrees| (degrees * 1e7).round() / 1e7);
    Bounds::between(corner(bbox.bottom, bbox.left), corner(bbox.top, bbox.right))
}

/// Adds an element; whether it is on the globe.
fn add(extract: &mut Extract, element: &Element<'_>) -> bool {
    match element {
        Element::Node(node) => {
            let at = [node.nano_lat(), node.nano_lon()];
            return add_node(extract, node.id(), at, tags(node.tags()));
        }
        Element::DenseNode(node) => {
            let at = [node.nano_lat(), node.nano_lon()];
            return add_node(extract, node.id(), at, tags(node.tags()));
        }
        Element::Way(way) => extract.ways.push(Way {
            object: Object { id: way.id(), tags: tags(way.tags()), span: 0..0 },
            refs: way.refs().collect(),
        }),
        Element::Relation(relation) => {
            let members = relation.members();
            let ways = members.filter(|member| member.member_type == RelMemberType::Way);
            let members = ways.map(|member| Member {
                way: member.member_id,
                is_inner: member.role().is_ok_and(|role| role == "inner"),
            });
            extract.relations.push(Relation {
                object: Object { id: relation.id(), tags: tags(relation.tags()), span: 0..0 },
                members: members.collect(),
            });
        }
    }
    true
}

/// `at` is latitude and longitude in units of 1e-9 degrees.
fn add_node(extract: &mut Extract, id: i64, at: [i64; 2], tags: Tags) -> bool {
    let [lat, lon] = at.map(|nano| nano as f64 / 1e9);
    let Some(place) = GeoPoint::from_degrees(lat, lon) else { return false };
    extract.places.insert(id, place);
    if !tags.0.is_empty() {
        extract.nodes.push(Object { id, tags, span: 0..0 });
    }
    true
}

fn tags<'a>(pairs: impl Iterator<Item = (&'a str, &'a str)>) -> Tags {
    Tags(pairs.map(|(key, value)| (key.to_owned(), value.to_owned())).collect())
}
