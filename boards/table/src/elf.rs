//! Reads the memory use of a linked image from its section headers (ELF-32, little-endian, after
//! the "Tool Interface Standard: Executable and Linking Format", version 1.2).

/// Bytes of an image, as `size` counts them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sizes {
    /// Code and constants: flash.
    pub text: u32,
    /// Initialised statics: flash and RAM.
    pub data: u32,
    /// Zeroed and uninitialised statics: RAM.
    pub bss: u32,
}

const SECTION_BYTES: usize = 40;
const NOBITS: u32 = 8;
const WRITE: u32 = 1;
const ALLOC: u32 = 2;

/// The sizes of an image; `None` if it is truncated or not an ELF-32 file.
pub fn sizes(image: &[u8]) -> Option<Sizes> {
    let half = |at: usize| Some(usize::from(u16::from_le_bytes(*image.get(at..)?.first_chunk()?)));
    let word = |at: usize| Some(u32::from_le_bytes(*image.get(at..)?.first_chunk()?));
    // Class 1: 32 bits. Encoding 1: little-endian.
    if !image.starts_with(b"\x7fELF\x01\x01") || half(46)? != SECTION_BYTES {
        return None;
    }
    let (headers, count) = (word(32)? as usize, half(48)?);
    let mut sizes = Sizes::default();
    for index in 0..count {
        let header = headers + index * SECTION_BYTES;
        let (kind, flags, size) = (word(header + 4)?, word(header + 8)?, word(header + 20)?);
        match (flags & ALLOC != 0, kind == NOBITS, flags & WRITE != 0) {
            (false, ..) => {}
            (true, true, _) => sizes.bss += size,
            (true, false, true) => sizes.data += size,
            (true, false, false) => sizes.text += size,
        }
    }
    Some(sizes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An ELF header and a section header for each (type, flags, size).
    fn image(sections: &[(u32, u32, u32)]) -> Vec<u8> {
        let mut bytes = vec![0; 52];
        bytes[..6].copy_from_slice(b"\x7fELF\x01\x01");
        bytes[32..36].copy_from_slice(&52_u32.to_le_bytes());
        bytes[46..48].copy_from_slice(&40_u16.to_le_bytes());
        bytes[48..50].copy_from_slice(&(sections.len() as u16).to_le_bytes());
        for &(kind, flags, size) in sections {
            for word in [0, kind, flags, 0, 0, size, 0, 0, 0, 0] {
                bytes.extend(word.to_le_bytes());
            }
        }
        bytes
    }

    #[test]
    fn sections_count_by_the_memory_they_occupy() {
        // Null, code, constants, statics, zeroed statics, debug information.
        let sections =
            [(0, 0, 0), (1, 6, 1000), (1, 2, 200), (1, 3, 30), (8, 3, 4), (1, 0, 50_000)];
        let image = image(&sections);
        assert_eq!(sizes(&image), Some(Sizes { text: 1200, data: 30, bss: 4 }));
        assert_eq!(sizes(&image[..image.len() - 40]), None, "cut off");
        assert_eq!(sizes(b"\x7fELF\x02\x01"), None, "64 bits");
    }
}
