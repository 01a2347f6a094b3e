//! The seal around a payload: magic, version, length, kind of payload, checksum.
//!
//! It is checked first, so that a blob of another version is refused for that reason and not as
//! damaged. It does not interpret the payload. `FORMAT.md` reserves the places of a rollback number
//! and a signature.

use crate::error::BlobError;
use crate::limits;

/// Version of the format that this build writes and reads.
pub const FORMAT_VERSION: u16 = 2;

/// The first bytes of every blob.
pub const MAGIC: [u8; 8] = *b"WAYFIELD";
/// Bytes of the header.
pub(crate) const HEADER_BYTES: usize = 28;
const LENGTH_AT: usize = 12;
const CHECKSUM_AT: usize = 24;

/// A hash of the payload's type, so that a reader refuses a payload that it would misread.
pub(crate) type Schema = [u8; 8];

/// The part of a region that is the blob, checksum verified, and its payload after the header.
pub(crate) struct Sealed<'a> {
    /// Header and payload.
    pub(crate) blob: &'a [u8],
    /// The bytes after the header.
    pub(crate) payload: &'a [u8],
}

/// Checks the header and the checksum of the blob at the start of a region; calls `beat` at bounded
/// intervals.
pub(crate) fn open(
    region: &[u8],
    expected: Schema,
    beat: impl FnMut(),
) -> Result<Sealed<'_>, BlobError> {
    let magic: [u8; 8] = match array_at(region, 0) {
        Some(magic) => magic,
        None if region.is_empty() => return Err(BlobError::Absent),
        None => return Err(BlobError::Truncated),
    };
    if magic == [0xff; 8] || magic == [0; 8] {
        return Err(BlobError::Absent);
    }
    if magic != MAGIC {
        return Err(BlobError::Magic);
    }
    let version = u16_at(region, 8).ok_or(BlobError::Truncated)?;
    if version != FORMAT_VERSION {
        return Err(BlobError::Version { found: version });
    }
    let header_length = u16_at(region, 10).ok_or(BlobError::Truncated)?;
    let length = u32_at(region, LENGTH_AT).ok_or(BlobError::Truncated)? as usize;
    let schema: Schema = array_at(region, 16).ok_or(BlobError::Truncated)?;
    let checksum = u32_at(region, CHECKSUM_AT).ok_or(BlobError::Truncated)?;
    if usize::from(header_length) != HEADER_BYTES || length < HEADER_BYTES {
        return Err(BlobError::Header);
    }
    if length > limits::MAX_BLOB_BYTES {
        return Err(BlobError::TooLarge);
    }
    let blob = region.get(..length).ok_or(BlobError::Truncated)?;
    let payload = blob.get(HEADER_BYTES..).ok_or(BlobError::Truncated)?;
    let before = blob.get(..CHECKSUM_AT).ok_or(BlobError::Truncated)?;
    if crc32(&[before, payload], beat) != checksum {
        return Err(BlobError::Checksum);
    }
    // After the checksum, so that a damaged hash is reported as damage.
    if schema != expected {
        return Err(BlobError::Schema);
    }
    Ok(Sealed { blob, payload })
}

/// Puts a header before a payload; `None` if the blob is too large.
#[cfg(feature = "std")]
pub(crate) fn seal(schema: Schema, payload: &[u8]) -> Option<Vec<u8>> {
    let length = HEADER_BYTES + payload.len();
    if length > limits::MAX_BLOB_BYTES {
        return None;
    }
    let mut blob = Vec::with_capacity(length);
    blob.extend_from_slice(&MAGIC);
    blob.extend_from_slice(&FORMAT_VERSION.to_le_bytes());
    blob.extend_from_slice(&(HEADER_BYTES as u16).to_le_bytes());
    blob.extend_from_slice(&(length as u32).to_le_bytes());
    blob.extend_from_slice(&schema);
    let checksum = crc32(&[&blob, payload], || ());
    blob.extend_from_slice(&checksum.to_le_bytes());
    blob.extend_from_slice(payload);
    Some(blob)
}

/// `N` bytes at an offset; `None` past the end.
fn array_at<const N: usize>(bytes: &[u8], offset: usize) -> Option<[u8; N]> {
    bytes.get(offset..)?.first_chunk::<N>().copied()
}

/// A `u16` at an offset.
fn u16_at(bytes: &[u8], offset: usize) -> Option<u16> {
    array_at(bytes, offset).map(u16::from_le_bytes)
}

/// A `u32` at an offset.
fn u32_at(bytes: &[u8], offset: usize) -> Option<u32> {
    array_at(bytes, offset).map(u32::from_le_bytes)
}

/// CRC-32/ISO-HDLC (as in Ethernet and zip) of the concatenated parts.
///
/// Own code, because the `crc` crate keeps a panic path, which the panic-free link refuses. A
/// byte-wise table takes about eight instructions per byte.
pub(crate) fn crc32(parts: &[&[u8]], mut beat: impl FnMut()) -> u32 {
    let mut crc = u32::MAX;
    for part in parts {
        for piece in part.chunks(limits::CHECKSUM_BYTES_PER_BEAT) {
            for &byte in piece {
                // The index is below 256, the table's length, so the bounds check is elided.
                crc = CRC_TABLE[usize::from(crc as u8 ^ byte)] ^ (crc >> 8);
            }
            beat();
        }
    }
    !crc
}

const CRC_TABLE: [u32; 256] = {
    let mut table = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        let mut crc = byte as u32;
        let mut bit = 0;
        while bit < 8 {
            crc = if crc & 1 == 1 { (crc >> 1) ^ 0xedb8_8320 } else { crc >> 1 };
            bit += 1;
        }
        table[byte] = crc;
        byte += 1;
    }
    table
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_payload_comes_back_from_its_seal() {
        let schema = *b"anything";
        let sealed = seal(schema, b"payload").unwrap();
        assert_eq!(sealed.len(), HEADER_BYTES + 7);
        assert_eq!(open(&sealed, schema, || ()).unwrap().payload, b"payload");
        let other = open(&sealed, *b"anyother", || ()).err();
        assert_eq!(other, Some(BlobError::Schema));
        // The rest of the region is not read and not part of the blob.
        let region = [&sealed[..], b"trailer"].concat();
        assert_eq!(open(&region, schema, || ()).unwrap().blob, sealed);
    }

    #[test]
    fn checksum_is_the_catalogued_one() {
        assert_eq!(crc32(&[b"1234", b"56789"], || ()), 0xcbf4_3926);
    }
}
