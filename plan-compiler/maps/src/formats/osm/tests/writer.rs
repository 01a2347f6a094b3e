//! Writes the binary encoding for tests: one uncompressed block with the fields that are read.
//!
//! Source: the wiki of OpenStreetMap, "PBF Format"; field numbers are of its `.proto` files.

use super::super::{Extract, Object};

/// How nodes are written.
#[derive(Clone, Copy)]
pub(super) enum Nodes {
    Dense,
    Plain,
}

/// Bytes of a protocol buffer message.
#[derive(Clone, Default)]
pub(super) struct Message(pub(super) Vec<u8>);

impl Message {
    pub(super) fn varint(&mut self, mut value: u64) {
        while value >= 0x80 {
            self.0.push(value as u8 | 0x80);
            value >>= 7;
        }
        self.0.push(value as u8);
    }

    pub(super) fn number(mut self, field: u64, value: u64) -> Self {
        self.varint(field << 3);
        self.varint(value);
        self
    }

    pub(super) fn bytes(mut self, field: u64, bytes: &[u8]) -> Self {
        self.varint(field << 3 | 2);
        self.varint(bytes.len() as u64);
        self.0.extend_from_slice(bytes);
        self
    }

    pub(super) fn packed(self, field: u64, values: impl IntoIterator<Item = u64>) -> Self {
        let mut list = Self::default();
        values.into_iter().for_each(|value| list.varint(value));
        self.bytes(field, &list.0)
    }
}

/// Zigzag encoding of a signed number.
pub(super) fn zigzag(value: i64) -> u64 {
    ((value << 1) ^ (value >> 63)) as u64
}

/// Packs each number as the difference from the previous one.
pub(super) fn deltas(values: impl IntoIterator<Item = i64>) -> Vec<u64> {
    let mut before = 0;
    values.into_iter().map(|value| zigzag(value - std::mem::replace(&mut before, value))).collect()
}

/// Table of texts; the first is empty.
struct Strings(Vec<String>);

impl Strings {
    fn number(&mut self, text: &str) -> u64 {
        let known = self.0.iter().position(|known| known == text);
        known.unwrap_or_else(|| {
            self.0.push(text.into());
            self.0.len() - 1
        }) as u64
    }

    fn tags(&mut self, message: Message, object: &Object) -> Message {
        let pairs = object.tags.0.iter();
        let (keys, values): (Vec<u64>, Vec<u64>) =
            pairs.map(|(key, value)| (self.number(key), self.number(value))).unzip();
        message.packed(2, keys).packed(3, values)
    }
}

fn blob(kind: &str, message: &Message) -> Vec<u8> {
    block(kind, &Message::default().bytes(1, &message.0))
}

/// A block of a file with any compression.
pub(super) fn block(kind: &str, blob: &Message) -> Vec<u8> {
    let header = Message::default().bytes(1, kind.as_bytes()).number(3, blob.0.len() as u64);
    [&(header.0.len() as u32).to_be_bytes()[..], &header.0, &blob.0].concat()
}

/// A file with one group of objects and these texts.
pub(super) fn file(strings: &[&str], group: &Message) -> Vec<u8> {
    let block = data(strings, group);
    [header(), blob("OSMData", &block)].concat()
}

/// The header of a file without bounds.
pub(super) fn header() -> Vec<u8> {
    blob("OSMHeader", &Message::default().bytes(4, b"OsmSchema-V0.6").bytes(4, b"DenseNodes"))
}

/// A block of data, uncompressed.
pub(super) fn data(strings: &[&str], group: &Message) -> Message {
    let table = strings.iter();
    let table = table.fold(Message::default(), |table, text| table.bytes(1, text.as_bytes()));
    Message::default().bytes(1, &table.0).bytes(2, &group.0)
}

/// The file of an extract.
pub(super) fn write(extract: &Extract, nodes: Nodes) -> Vec<u8> {
    let mut header = Message::default();
    if let Some([south, west, north, east]) = extract.bounds.map(|bounds| bounds.sides()) {
        let mut sides = Message::default();
        for (field, side) in [(1, west), (2, east), (3, north), (4, south)] {
            sides = sides.number(field, zigzag((side * 1e9).round() as i64));
        }
        header = header.bytes(1, &sides.0);
    }
    let header = header.bytes(4, b"OsmSchema-V0.6").bytes(4, b"DenseNodes");
    let mut strings = Strings(vec![String::new()]);
    let mut group = match nodes {
        Nodes::Dense => dense(extract, &mut strings),
        Nodes::Plain => plain(extract, &mut strings),
    };
    for way in &extract.ways {
        let message = Message::default().number(1, way.object.id as u64);
        let message = strings.tags(message, &way.object).packed(8, deltas(way.refs.clone()));
        group = group.bytes(3, &message.0);
    }
    for relation in &extract.relations {
        let message = Message::default().number(1, relation.object.id as u64);
        let role = |is_inner| if is_inner { "inner" } else { "outer" };
        let members = &relation.members;
        let roles: Vec<u64> =
            members.iter().map(|member| strings.number(role(member.is_inner))).collect();
        let message = strings
            .tags(message, &relation.object)
            .packed(8, roles)
            .packed(9, deltas(members.iter().map(|member| member.way)))
            .packed(10, members.iter().map(|_| 1));
        group = group.bytes(4, &message.0);
    }
    let table = strings.0.iter();
    let table = table.fold(Message::default(), |table, text| table.bytes(1, text.as_bytes()));
    let block = Message::default().bytes(1, &table.0).bytes(2, &group.0);
    [blob("OSMHeader", &header), blob("OSMData", &block)].concat()
}

/// Every node by number, with its tags.
fn all_nodes(extract: &Extract) -> Vec<(i64, [i64; 2], Option<&Object>)> {
    let mut ids: Vec<i64> = extract.places.keys().copied().collect();
    // Tagged nodes in their order, which is the order of drawing.
    ids.sort_by_key(|id| {
        (extract.nodes.iter().position(|node| node.id == *id).map_or(-1, |at| at as i64), *id)
    });
    let node = |id: i64| {
        let place = extract.places[&id];
        let at = [i64::from(place.lat_e7), i64::from(place.lon_e7)];
        (id, at, extract.nodes.iter().find(|node| node.id == id))
    };
    ids.into_iter().map(node).collect()
}

fn dense(extract: &Extract, strings: &mut Strings) -> Message {
    let nodes = all_nodes(extract);
    let mut tags = Vec::new();
    for (_, _, object) in &nodes {
        for (key, value) in object.iter().flat_map(|object| &object.tags.0) {
            tags.extend([strings.number(key), strings.number(value)]);
        }
        tags.push(0);
    }
    let dense = Message::default()
        .packed(1, deltas(nodes.iter().map(|(id, ..)| *id)))
        .packed(8, deltas(nodes.iter().map(|(_, at, _)| at[0])))
        .packed(9, deltas(nodes.iter().map(|(_, at, _)| at[1])))
        .packed(10, tags);
    Message::default().bytes(2, &dense.0)
}

fn plain(extract: &Extract, strings: &mut Strings) -> Message {
    let mut group = Message::default();
    for (id, at, object) in all_nodes(extract) {
        let mut node = Message::default().number(1, zigzag(id));
        if let Some(object) = object {
            node = strings.tags(node, object);
        }
        node = node.number(8, zigzag(at[0])).number(9, zigzag(at[1]));
        group = group.bytes(1, &node.0);
    }
    group
}

/// A file that requires a further feature.
pub(super) fn with_feature(file: &[u8], feature: &str) -> Vec<u8> {
    let header = Message::default().bytes(4, feature.as_bytes());
    [blob("OSMHeader", &header), file.to_vec()].concat()
}
