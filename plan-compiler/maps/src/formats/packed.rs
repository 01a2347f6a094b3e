//! Files that are compressed as a whole: gzip is read; others are refused with the program that
//! unpacks them.

use crate::problem::Problem;
use crate::source::MAX_FILE_BYTES;
use flate2::read::MultiGzDecoder;
use std::io::Read;
use std::path::Path;

/// Compressed files and archives: first bytes, name, program that unpacks them.
const KINDS: [(&[u8], &str, &str); 7] = [
    (b"BZh", "bzip2", "bunzip2"),
    (b"\xfd7zXZ\0", "xz", "unxz"),
    (b"\x28\xb5\x2f\xfd", "zstd", "unzstd"),
    (b"\x04\x22\x4d\x18", "lz4", "unlz4"),
    (b"PK\x03\x04", "zip", "unzip"),
    (b"7z\xbc\xaf\x27\x1c", "7-Zip", "7z x"),
    (b"\x1f\x9d", "compress", "gunzip"),
];
const GZIP: &[u8] = b"\x1f\x8b\x08";

/// The bytes of a map, unpacked if they are gzip.
pub(super) fn unpack(path: &Path, bytes: Vec<u8>) -> Result<Vec<u8>, Problem> {
    unpack_within(path, bytes, MAX_FILE_BYTES)
}

fn unpack_within(path: &Path, bytes: Vec<u8>, limit: u64) -> Result<Vec<u8>, Problem> {
    let name = path.display();
    if let Some((_, kind, program)) = KINDS.iter().find(|(magic, ..)| bytes.starts_with(magic)) {
        return Err(Problem::error(format!(
            "{name} is compressed with {kind}, which is not supported"
        ))
        .help(format!("unpack it first: {program} {name}")));
    }
    if !bytes.starts_with(GZIP) {
        return Ok(bytes);
    }
    let mut unpacked = Vec::new();
    let read = MultiGzDecoder::new(bytes.as_slice()).take(limit + 1).read_to_end(&mut unpacked);
    if let Err(error) = read {
        return Err(Problem::error(format!("{name} is damaged: gzip reports {error}"))
            .help("fetch it again; `gzip -t` checks it"));
    }
    if unpacked.len() as u64 > limit {
        let limit = limit >> 20;
        return Err(Problem::error(format!("unpacked, {name} is larger than {limit} MiB"))
            .help("crop the map to the area that the robot uses"));
    }
    Ok(unpacked)
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::Compression;
    use flate2::write::GzEncoder;
    use std::io::Write;

    fn gzip(bytes: &[u8]) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
        encoder.write_all(bytes).expect("memory");
        encoder.finish().expect("memory")
    }

    fn check(bytes: Vec<u8>, expected: &str) {
        let got = match unpack_within(Path::new("a.osm"), bytes, 1 << 20) {
            Ok(bytes) => String::from_utf8(bytes).expect("text"),
            Err(problem) => problem.message,
        };
        assert_eq!(got, expected);
    }

    #[test]
    fn compressed_files_are_unpacked_or_named() {
        check(b"<osm/>".to_vec(), "<osm/>");
        check(gzip(b"<osm/>"), "<osm/>");
        // Several members are one file.
        check([gzip(b"<osm>"), gzip(b"</osm>")].concat(), "<osm></osm>");
        check(b"BZh91AY".to_vec(), "a.osm is compressed with bzip2, which is not supported");
        check(b"PK\x03\x04....".to_vec(), "a.osm is compressed with zip, which is not supported");
        check(
            b"\x28\xb5\x2f\xfd..".to_vec(),
            "a.osm is compressed with zstd, which is not supported",
        );
        let cut = gzip(b"<osm/>");
        let damaged = unpack_within(Path::new("a"), cut[..cut.len() - 9].to_vec(), 99);
        assert!(damaged.is_err_and(|problem| problem.message.starts_with("a is damaged: gzip")));
    }

    #[test]
    fn unpacking_stops_at_the_limit() {
        check(gzip(&vec![b' '; 2 << 20]), "unpacked, a.osm is larger than 1 MiB");
    }
}
