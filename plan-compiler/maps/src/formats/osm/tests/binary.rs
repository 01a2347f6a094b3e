//! Features of the binary encoding: compressions, places in ways, versions, and small files with
//! many objects.

use super::super::pbf;
use super::super::wire::Damaged;
use super::writer::{Message, block, data, deltas, file, header, zigzag};
use super::*;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use std::io::Write;

const MIB: usize = 1 << 20;

/// A block of data as zlib packs it.
fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes).expect("memory");
    let packed = encoder.finish().expect("memory");
    block("OSMData", &Message::default().number(2, bytes.len() as u64).bytes(3, &packed))
}

/// Why a file is refused within a budget; empty if it is read.
fn refused(blocks: &[Vec<u8>], budget: usize) -> String {
    let bytes = [header(), blocks.concat()].concat();
    let read = pbf::parse_within(Path::new("a.pbf"), &bytes, budget);
    read.err().map(|problem| problem.message).unwrap_or_default()
}

const TOO_MUCH: &str =
    "a.pbf cannot be read: it is larger than a robot's map needs to be: over 1 GiB of memory";

/// Objects that take a byte or two in the file and many in memory, one case per kind.
#[test]
fn small_files_with_many_objects_are_refused_within_one_block() {
    let zeros = |count: usize| vec![0u64; count];
    let way = Message::default().number(1, 1).packed(8, zeros(4 * MIB));
    let relation = Message::default()
        .number(1, 1)
        .packed(8, zeros(MIB))
        .packed(9, zeros(MIB))
        .packed(10, vec![1; MIB]);
    let tags = Message::default().number(1, 1).packed(2, zeros(MIB)).packed(3, zeros(MIB));
    let dense =
        Message::default().packed(1, vec![2; MIB]).packed(8, zeros(MIB)).packed(9, zeros(MIB));
    let many = |field: u64, one: &[u8]| {
        (0..MIB).fold(Message::default(), |group, _| group.bytes(field, one))
    };
    let groups = [
        Message::default().bytes(3, &way.0),
        Message::default().bytes(4, &relation.0),
        Message::default().bytes(3, &tags.0),
        Message::default().bytes(2, &dense.0),
        many(3, b""),
        many(4, b""),
        many(1, &Message::default().number(1, 2).0),
    ];
    for (index, group) in groups.iter().enumerate() {
        let packed = zlib(&data(&[""], group).0);
        assert!(packed.len() < 64 << 10, "{index}: {}", packed.len());
        // Equal nodes are one node; all others are charged to the budget.
        let expected = if index == 6 { "" } else { TOO_MUCH };
        if index != 6 {
            assert_eq!(refused(std::slice::from_ref(&packed), 16 * MIB), expected, "{index}");
        }
        // The same spread over several blocks.
        if index == 0 {
            assert_eq!(refused(&vec![packed; 3], 128 * MIB), TOO_MUCH);
        }
    }
}

#[test]
fn blocks_unpack_to_no_more_than_the_format_allows() {
    let packed = zlib(&vec![0; 33 * MIB]);
    assert_eq!(
        refused(&[packed], 1 << 30),
        "a.pbf cannot be read: a block of it unpacks to more than 32 MiB"
    );
    let strings = (0..MIB + 1).fold(Message::default(), |table, _| table.bytes(1, b""));
    let packed = zlib(&Message::default().bytes(1, &strings.0).0);
    assert_eq!(
        refused(&[packed], 1 << 30),
        "a.pbf cannot be read: a block has more than 1048576 texts"
    );
}

#[test]
fn compressions_are_read_or_named() {
    let (text, square) = (["", "building", "yes"], [(1, 1), (5, 1), (5, 5), (1, 5)]);
    let dense = Message::default()
        .packed(1, deltas(1..=4))
        .packed(8, deltas(square.map(|(_, y)| y * 1000)))
        .packed(9, deltas(square.map(|(x, _)| x * 1000)));
    let way = Message::default().number(1, 1).packed(2, [1]).packed(3, [2]);
    let way = way.packed(8, deltas([1, 2, 3, 4, 1]));
    let group = Message::default().bytes(2, &dense.0).bytes(3, &way.0);
    let plain = read_with(&file(&text, &group));
    let packed = read_with(&[header(), zlib(&data(&text, &group).0)].concat());
    assert_eq!(outcome(&plain), outcome(&packed));
    assert!(outcome(&plain).contains("Obstacle"), "{}", outcome(&plain));
    for (field, kind) in [(4, "lzma"), (5, "bzip2"), (6, "lz4"), (7, "zstd")] {
        let blob = Message::default().number(2, 9).bytes(field, b"whatever");
        let expected =
            format!("a.pbf cannot be read: it is compressed with {kind}, which is not supported");
        assert_eq!(refused(&[block("OSMData", &blob)], 1 << 30), expected);
    }
}

/// As `osmium add-locations-to-ways` writes it: places in the ways instead of nodes.
#[test]
fn places_in_ways_are_used() {
    let way = Message::default().number(1, 1).packed(2, [1]).packed(3, [2]);
    let way = way.packed(8, deltas([7, 8, 9, 7]));
    let way = way
        .packed(9, deltas([1000, 1000, 5000, 1000]))
        .packed(10, deltas([1000, 5000, 5000, 1000]));
    let group = Message::default().bytes(3, &way.0);
    let (map, problems) = read_with(&file(&["", "building", "yes"], &group));
    let map = map.expect("a map");
    let Shape::Polygon(rings) = &map.features[0].shape else { panic!("{map:?}") };
    assert_eq!((rings.len(), rings[0].len()), (1, 3), "{}", drawn(&problems, false));
}

#[test]
fn versions_are_read_wherever_they_stand() {
    let info =
        |version: u64, visible: u64| Message::default().number(1, version).number(6, visible);
    let node = |info: Message, tag: &[u64]| {
        let node = Message::default().number(1, zigzag(1)).packed(2, tag.to_vec());
        let node = node.packed(3, tag.iter().map(|_| 2).collect::<Vec<_>>()).bytes(4, &info.0);
        Message::default().bytes(1, &node.number(8, zigzag(9)).number(9, zigzag(9)).0)
    };
    let other = Message::default().bytes(
        2,
        &Message::default()
            .packed(1, deltas([5, 6]))
            .bytes(5, &Message::default().packed(1, [1, 2]).packed(6, [1, 0]).0)
            .packed(8, deltas([0, 0]))
            .packed(9, deltas([0, 0]))
            .packed(10, [1, 2, 0, 1, 2, 0])
            .0,
    );
    let text = ["", "building", "yes"];
    for (last, expected) in [(1, 2), (0, 1)] {
        let all = [node(info(1, 1), &[1]), node(info(2, last), &[1]), other.clone()];
        let group = Message(all.map(|one| one.0).concat());
        let (map, problems) = read_with(&file(&text, &group));
        let count = map.expect("a map").features.len();
        assert_eq!(count, expected, "{}", drawn(&problems, false));
    }
}

#[test]
fn endless_numbers_are_damage() {
    let mut fields = super::super::wire::fields(&[0xff; 12]);
    assert_eq!(fields.next(), Some(Err(Damaged)));
    assert_eq!(fields.next(), None);
}
