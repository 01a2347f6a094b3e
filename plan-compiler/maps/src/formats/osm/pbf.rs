//! OpenStreetMap's binary encoding: protocol buffers in compressed blocks.
//!
//! Source: the wiki of OpenStreetMap, "PBF Format"; field numbers are of its `.proto` files. A
//! block that unpacks to more than the format allows is refused, and every object is charged to the
//! memory budget before it is allocated, because a small file may hold many objects.

use super::extract::{
    BUDGET_BYTES, Builder, Extract, Member, Object, Relation, TooMuch, Version, Way,
};
use super::wire::{Damaged, Packed, Value, fields, zigzag};
use crate::formats::globe::Bounds;
use crate::formats::tags::Tags;
use crate::problem::Problem;
use flate2::read::ZlibDecoder;
use math::GeoPoint;
use std::io::Read;
use std::path::Path;

/// Features that this reader supports; a file that requires others is refused.
const FEATURES: [&[u8]; 4] =
    [b"OsmSchema-V0.6", b"DenseNodes", b"HistoricalInformation", b"LocationsOnWays"];
/// Limits of the format, bytes.
const MAX_HEADER_BYTES: usize = 64 << 10;
const MAX_BLOCK_BYTES: usize = 32 << 20;
/// Most that the blocks of a file may unpack to, bytes: several times the largest file.
const MAX_TOTAL_BYTES: usize = 4 << 30;
/// Most texts of a block; blocks usually hold 8,000 objects.
const MAX_STRINGS: usize = 1 << 20;
/// Compressions of blocks that are not supported, by field number.
const COMPRESSIONS: [(u64, &str); 4] = [(4, "lzma"), (5, "bzip2"), (6, "lz4"), (7, "zstd")];

/// Why a file cannot be read, and how to fix it.
struct Reason {
    message: String,
    help: &'static str,
}

impl Reason {
    fn new(message: impl Into<String>, help: &'static str) -> Self {
        Self { message: message.into(), help }
    }
}

const FETCH_AGAIN: &str =
    "it may be damaged or cut off: fetch it again, or check it with `osmium fileinfo -e`";

impl From<Damaged> for Reason {
    fn from(_: Damaged) -> Self {
        Self::new("it is damaged", FETCH_AGAIN)
    }
}

impl From<TooMuch> for Reason {
    fn from(_: TooMuch) -> Self {
        Self::new(TooMuch::MESSAGE, TooMuch::HELP)
    }
}

/// Whether bytes begin with the header that every such file has.
pub(super) fn recognises(bytes: &[u8]) -> bool {
    // Four bytes of length, then field 1 with nine bytes.
    bytes.get(4..).is_some_and(|rest| rest.starts_with(b"\x0a\x09OSMHeader"))
}

/// Reads an extract and warnings; an error if the file is damaged.
pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<(Extract, Vec<Problem>), Problem> {
    parse_within(path, bytes, BUDGET_BYTES)
}

/// As [`parse`], with a memory budget in bytes.
pub(super) fn parse_within(
    path: &Path,
    bytes: &[u8],
    budget: usize,
) -> Result<(Extract, Vec<Problem>), Problem> {
    let mut reader = Reader { builder: Builder::new(budget), off_the_globe: 0, has_header: false };
    if let Err(Reason { message, help }) = reader.file(bytes) {
        let name = path.display();
        return Err(Problem::error(format!("{name} cannot be read: {message}")).help(help));
    }
    let count = reader.off_the_globe;
    let warning = (count > 0)
        .then(|| Problem::warning(format!("{count} nodes are off the globe; they are left out")));
    Ok((reader.builder.finish(), warning.into_iter().collect()))
}

struct Reader {
    builder: Builder,
    off_the_globe: usize,
    has_header: bool,
}

/// Values that the objects of a block share.
struct Block<'a> {
    strings: Vec<&'a str>,
    /// Nanodegrees.
    granularity: i64,
    offset: [i64; 2],
}

impl Block<'_> {
    fn text(&self, index: u64) -> Result<&str, Damaged> {
        usize::try_from(index).ok().and_then(|at| self.strings.get(at)).copied().ok_or(Damaged)
    }

    /// A place from the block's numbers for latitude and longitude.
    fn place(&self, at: [i64; 2]) -> Option<GeoPoint> {
        let degrees = |axis: usize| {
            let nano = i128::from(at[axis]) * i128::from(self.granularity);
            (nano + i128::from(self.offset[axis])) as f64 / 1e9
        };
        GeoPoint::from_degrees(degrees(0), degrees(1))
    }
}

impl Reader {
    fn file(&mut self, mut rest: &[u8]) -> Result<(), Reason> {
        let mut total = 0usize;
        while !rest.is_empty() {
            let [kind, blob, after] = blob(rest)?;
            rest = after;
            if kind != b"OSMHeader" && kind != b"OSMData" {
                continue;
            }
            let block = unpack(blob)?;
            total = total.saturating_add(block.len());
            if total > MAX_TOTAL_BYTES {
                let limit = MAX_TOTAL_BYTES >> 30;
                let message = format!("its blocks unpack to more than {limit} GiB");
                return Err(Reason::new(message, TooMuch::HELP));
            }
            match kind {
                b"OSMHeader" => self.header(&block)?,
                _ => self.data(&block)?,
            }
        }
        match self.has_header {
            true => Ok(()),
            false => Err(Reason::new("it is not an OpenStreetMap file", FETCH_AGAIN)),
        }
    }

    fn header(&mut self, bytes: &[u8]) -> Result<(), Reason> {
        self.has_header = true;
        for field in fields(bytes) {
            match field? {
                (1, bbox) => {
                    if let Some(bounds) = bounds(bbox.bytes()?)? {
                        self.builder.bounds(bounds);
                    }
                }
                (4, feature) => {
                    let feature = feature.bytes()?;
                    if !FEATURES.contains(&feature) {
                        let feature = String::from_utf8_lossy(feature);
                        let feature = feature.chars().filter(|c| !c.is_control()).take(40);
                        let feature: String = feature.collect();
                        let message = format!("it needs a reader that understands {feature}");
                        let help = "rewrite it as a plain extract: `osmium cat -o out.osm.pbf`";
                        return Err(Reason::new(message, help));
                    }
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn data(&mut self, bytes: &[u8]) -> Result<(), Reason> {
        let mut block = Block { strings: Vec::new(), granularity: 100, offset: [0; 2] };
        for field in fields(bytes) {
            match field? {
                (1, table) => {
                    for text in fields(table.bytes()?) {
                        if block.strings.len() >= MAX_STRINGS {
                            let message = format!("a block has more than {MAX_STRINGS} texts");
                            return Err(Reason::new(message, FETCH_AGAIN));
                        }
                        let (_, text) = text?;
                        // Invalid UTF-8 matches no tag.
                        block.strings.push(std::str::from_utf8(text.bytes()?).unwrap_or_default());
                    }
                }
                (17, number) => block.granularity = number.number()? as i64,
                (19, number) => block.offset[0] = number.number()? as i64,
                (20, number) => block.offset[1] = number.number()? as i64,
                _ => {}
            }
        }
        for field in fields(bytes) {
            let (2, group) = field? else { continue };
            for object in fields(group.bytes()?) {
                match object? {
                    (1, node) => self.plain(&block, node.bytes()?)?,
                    (2, nodes) => self.dense(&block, nodes.bytes()?)?,
                    (3, way) => self.way(&block, way.bytes()?)?,
                    (4, relation) => self.relation(&block, relation.bytes()?)?,
                    _ => {}
                }
            }
        }
        Ok(())
    }

    fn add_node(
        &mut self,
        version: Version,
        object: Object,
        place: Option<GeoPoint>,
    ) -> Result<(), Reason> {
        // A deleted node has no place.
        let place = place.or(version.is_deleted.then_some(GeoPoint { lat_e7: 0, lon_e7: 0 }));
        match place {
            Some(place) => self.builder.node(version, object, place)?,
            None => self.off_the_globe += 1,
        }
        Ok(())
    }

    fn plain(&mut self, block: &Block<'_>, bytes: &[u8]) -> Result<(), Reason> {
        let (mut parts, mut at) = (Parts::default(), [0; 2]);
        for field in fields(bytes) {
            match field? {
                (1, id) => parts.id = zigzag(id.number()?),
                (8, lat) => at[0] = zigzag(lat.number()?),
                (9, lon) => at[1] = zigzag(lon.number()?),
                (number, value) => parts.part(number, value)?,
            }
        }
        let object = parts.object(block, &mut self.builder)?;
        self.add_node(parts.version, object, block.place(at))
    }

    fn dense(&mut self, block: &Block<'_>, bytes: &[u8]) -> Result<(), Reason> {
        let [mut ids, mut lats, mut lons] = [Packed::default(); 3];
        let [mut pairs, mut versions, mut visible] = [Packed::default(); 3];
        for field in fields(bytes) {
            match field? {
                (1, list) => ids = list.packed()?,
                (5, info) => {
                    for field in fields(info.bytes()?) {
                        match field? {
                            (1, list) => versions = list.packed()?,
                            (6, list) => visible = list.packed()?,
                            _ => {}
                        }
                    }
                }
                (8, list) => lats = list.packed()?,
                (9, list) => lons = list.packed()?,
                (10, list) => pairs = list.packed()?,
                _ => {}
            }
        }
        let (mut lats, mut lons) = (lats.deltas(), lons.deltas());
        for id in ids.deltas() {
            let (Some(lat), Some(lon)) = (lats.next(), lons.next()) else {
                return Err(Damaged.into());
            };
            let mut tags = Vec::new();
            while let Some(key) = pairs.next() {
                let key = block.text(key?)?;
                if key.is_empty() {
                    break;
                }
                let value = block.text(pairs.next().ok_or(Damaged)??)?;
                self.builder.take_tag(key, value)?;
                tags.push((key.to_owned(), value.to_owned()));
            }
            let number = versions.next().transpose()?.unwrap_or_default() as u32;
            let is_deleted = visible.next().transpose()? == Some(0);
            let place = block.place([lat?, lon?]);
            let object = Object { id: id?, tags: Tags(tags), span: 0..0 };
            self.add_node(Version { number, is_deleted }, object, place)?;
        }
        Ok(())
    }

    fn way(&mut self, block: &Block<'_>, bytes: &[u8]) -> Result<(), Reason> {
        let (mut parts, mut refs) = (Parts::default(), Packed::default());
        let (mut lats, mut lons) = (Packed::default(), Packed::default());
        for field in fields(bytes) {
            match field? {
                (1, id) => parts.id = id.number()? as i64,
                (8, list) => refs = list.packed()?,
                (9, list) => lats = list.packed()?,
                (10, list) => lons = list.packed()?,
                (number, value) => parts.part(number, value)?,
            }
        }
        let object = parts.object(block, &mut self.builder)?;
        let mut nodes = Vec::new();
        let (mut lats, mut lons) = (lats.deltas(), lons.deltas());
        for node in refs.deltas() {
            let node = node?;
            self.builder.take_ref()?;
            nodes.push(node);
            if let (Some(lat), Some(lon)) = (lats.next(), lons.next())
                && let Some(place) = block.place([lat?, lon?])
            {
                self.builder.place(node, place)?;
            }
        }
        Ok(self.builder.way(parts.version, Way { object, refs: nodes })?)
    }

    fn relation(&mut self, block: &Block<'_>, bytes: &[u8]) -> Result<(), Reason> {
        let (mut parts, mut roles) = (Parts::default(), Packed::default());
        let (mut ids, mut kinds) = (Packed::default(), Packed::default());
        for field in fields(bytes) {
            match field? {
                (1, id) => parts.id = id.number()? as i64,
                (8, list) => roles = list.packed()?,
                (9, list) => ids = list.packed()?,
                (10, list) => kinds = list.packed()?,
                (number, value) => parts.part(number, value)?,
            }
        }
        let object = parts.object(block, &mut self.builder)?;
        let mut members = Vec::new();
        for way in ids.deltas() {
            let (Some(role), Some(kind)) = (roles.next(), kinds.next()) else {
                return Err(Damaged.into());
            };
            let is_inner = block.text(role?)? == "inner";
            match kind? {
                1 => {
                    self.builder.take_member()?;
                    members.push(Member { way: way?, is_inner });
                }
                0 | 2 => {}
                _ => return Err(Damaged.into()),
            }
        }
        Ok(self.builder.relation(parts.version, Relation { object, members })?)
    }
}

/// Parts that nodes, ways and relations share.
#[derive(Default)]
struct Parts<'a> {
    id: i64,
    keys: Packed<'a>,
    values: Packed<'a>,
    version: Version,
}

impl<'a> Parts<'a> {
    fn part(&mut self, number: u64, value: Value<'a>) -> Result<(), Damaged> {
        match number {
            2 => self.keys = value.packed()?,
            3 => self.values = value.packed()?,
            4 => {
                for field in fields(value.bytes()?) {
                    match field? {
                        (1, number) => self.version.number = number.number()? as u32,
                        (6, visible) => self.version.is_deleted = visible.number()? == 0,
                        _ => {}
                    }
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn object(&self, block: &Block<'_>, builder: &mut Builder) -> Result<Object, Reason> {
        let mut tags = Vec::new();
        for (key, value) in self.keys.zip(self.values) {
            let (key, value) = (block.text(key?)?, block.text(value?)?);
            builder.take_tag(key, value)?;
            tags.push((key.to_owned(), value.to_owned()));
        }
        Ok(Object { id: self.id, tags: Tags(tags), span: 0..0 })
    }
}

/// The kind and the bytes of the first block of a file, and what follows it.
fn blob(bytes: &[u8]) -> Result<[&[u8]; 3], Reason> {
    let cut_off = || Reason::new("it ends within a block", FETCH_AGAIN);
    let (length, rest) = bytes.split_first_chunk::<4>().ok_or_else(cut_off)?;
    let length = u32::from_be_bytes(*length) as usize;
    if length > MAX_HEADER_BYTES {
        return Err(Reason::new("it is not an OpenStreetMap file", FETCH_AGAIN));
    }
    let (header, rest) = rest.split_at_checked(length).ok_or_else(cut_off)?;
    let (mut kind, mut size) = (&[][..], 0);
    for field in fields(header) {
        match field? {
            (1, value) => kind = value.bytes()?,
            (3, value) => size = usize::try_from(value.number()?).unwrap_or(usize::MAX),
            _ => {}
        }
    }
    let (blob, rest) = rest.split_at_checked(size).ok_or_else(cut_off)?;
    Ok([kind, blob, rest])
}

/// The bytes of a block.
fn unpack(blob: &[u8]) -> Result<Vec<u8>, Reason> {
    let mut unpacked = Vec::new();
    for field in fields(blob) {
        match field? {
            (1, raw) => unpacked = raw.bytes()?.to_vec(),
            (3, packed) => {
                let decoder = ZlibDecoder::new(packed.bytes()?);
                unpacked.clear();
                decoder
                    .take(MAX_BLOCK_BYTES as u64 + 1)
                    .read_to_end(&mut unpacked)
                    .map_err(|error| Reason::new(format!("zlib reports {error}"), FETCH_AGAIN))?;
            }
            (number, _) => {
                if let Some((_, kind)) = COMPRESSIONS.iter().find(|(field, _)| *field == number) {
                    let message = format!("it is compressed with {kind}, which is not supported");
                    let help = "rewrite it with zlib: `osmium cat IN.osm.pbf -o out.osm.pbf`";
                    return Err(Reason::new(message, help));
                }
            }
        }
    }
    if unpacked.len() > MAX_BLOCK_BYTES {
        let limit = MAX_BLOCK_BYTES >> 20;
        let message = format!("a block of it unpacks to more than {limit} MiB");
        return Err(Reason::new(message, FETCH_AGAIN));
    }
    Ok(unpacked)
}

fn bounds(bytes: &[u8]) -> Result<Option<Bounds>, Damaged> {
    // West, east, north, south, nanodegrees.
    let mut sides = [0i64; 4];
    for field in fields(bytes) {
        let (number, value) = field?;
        if let Some(side) = sides.get_mut((number as usize).wrapping_sub(1)) {
            *side = zigzag(value.number()?);
        }
    }
    // Rounded to 1e-7 degrees, as in XML.
    let [west, east, north, south] = sides.map(|nano| (nano as f64 / 1e2).round() / 1e7);
    Ok(Bounds::between([south, west], [north, east]))
}
