//! A blob in the formats of flashing tools: its bytes, Intel HEX or UF2.
//!
//! Intel HEX and UF2 contain the address, so that users cannot mistype it. HEX follows Intel's
//! "Hexadecimal Object File Format Specification", revision A: data records of 16 bytes under
//! extended linear addresses. UF2 follows Microsoft's specification: blocks of 512 bytes, each with
//! the address of its 256 data bytes.
//!
//! Deliberately absent: reading them back. Every other command takes the blob itself.

use crate::boards::{BOARDS, Board};
use std::borrow::Cow;
use std::fmt::Write;
use std::path::Path;

/// How a blob is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Image {
    /// Its bytes only.
    Raw,
    /// Intel HEX.
    Hex {
        /// Flash address of the blob.
        address: u32,
    },
    /// UF2.
    Uf2 {
        /// Flash address of the blob.
        address: u32,
        /// UF2 family of the boot loaders that accept the file.
        family: u32,
    },
}

impl Image {
    /// The format that a file's extension asks for: `.hex`, `.uf2`, or the blob itself for all
    /// others.
    ///
    /// # Errors
    /// A sentence for the user if the board is missing or does not accept the format.
    pub fn of(path: &Path, board: Option<&Board>) -> Result<Self, String> {
        let extension = path.extension().and_then(|extension| extension.to_str());
        let extension = extension.unwrap_or_default().to_ascii_lowercase();
        let board = match (extension.as_str(), board) {
            ("hex" | "uf2", Some(board)) => board,
            ("hex" | "uf2", None) => {
                let names: Vec<&str> = BOARDS.iter().map(|board| board.name.as_str()).collect();
                let names = names.join(", ");
                return Err(format!(
                    "a .{extension} file contains the plans' flash address, so name the board: \
                     --board with one of {names}"
                ));
            }
            _ => return Ok(Self::Raw),
        };
        let address = board.memory.plans.address;
        match (extension.as_str(), board.uf2_family) {
            ("hex", _) => Ok(Self::Hex { address }),
            (_, Some(family)) => Ok(Self::Uf2 { address, family }),
            (_, None) => Err(format!(
                "{} has no boot loader that accepts UF2; write a .hex or .bin file instead",
                board.name
            )),
        }
    }

    /// The bytes of the file.
    pub fn encode<'b>(&self, blob: &'b [u8]) -> Cow<'b, [u8]> {
        match *self {
            Self::Raw => blob.into(),
            Self::Hex { address } => hex(address, blob).into_bytes().into(),
            Self::Uf2 { address, family } => uf2(address, family, blob).into(),
        }
    }
}

/// Bytes of one data record, as most tools write them.
const RECORD_BYTES: usize = 16;
/// Bytes that one extended linear address covers.
const SEGMENT_BYTES: usize = 0x1_0000;

const DATA: u8 = 0x00;
const END_OF_FILE: u8 = 0x01;
const EXTENDED_LINEAR_ADDRESS: u8 = 0x04;

/// Intel HEX of bytes from an address on; the address must be a multiple of 64 KiB.
fn hex(address: u32, bytes: &[u8]) -> String {
    debug_assert_eq!(address as usize % SEGMENT_BYTES, 0);
    let mut text = String::with_capacity(bytes.len() * 3);
    for (segment, bytes) in (address >> 16..).zip(bytes.chunks(SEGMENT_BYTES)) {
        record(&mut text, EXTENDED_LINEAR_ADDRESS, 0, &(segment as u16).to_be_bytes());
        for (index, bytes) in bytes.chunks(RECORD_BYTES).enumerate() {
            record(&mut text, DATA, (index * RECORD_BYTES) as u16, bytes);
        }
    }
    record(&mut text, END_OF_FILE, 0, &[]);
    text
}

/// One line: length, address, kind and bytes, then a checksum that makes their sum zero.
fn record(text: &mut String, kind: u8, address: u16, bytes: &[u8]) {
    let [high, low] = address.to_be_bytes();
    let head = [bytes.len() as u8, high, low, kind];
    let sum = head.iter().chain(bytes).fold(0u8, |sum, &byte| sum.wrapping_add(byte));
    text.push(':');
    for byte in head.iter().chain(bytes).chain([&sum.wrapping_neg()]) {
        // Writing to a string does not fail.
        let _ = write!(text, "{byte:02X}");
    }
    text.push('\n');
}

const UF2_START: [u32; 2] = [0x0A32_4655, 0x9E5D_5157];
const UF2_END: u32 = 0x0AB1_6F30;
/// Flag: the block contains the family.
const FAMILY_PRESENT: u32 = 0x2000;
/// Bytes of a block.
const BLOCK_BYTES: usize = 512;
/// Bytes of a block that reach the flash: one page.
const PAYLOAD_BYTES: usize = 256;
/// Erased flash, which fills the last page: boot loaders accept whole pages only.
const ERASED: u8 = 0xFF;

/// UF2 of bytes from an address on.
fn uf2(address: u32, family: u32, bytes: &[u8]) -> Vec<u8> {
    let blocks = bytes.len().div_ceil(PAYLOAD_BYTES);
    let mut out = Vec::with_capacity(blocks * BLOCK_BYTES);
    for (index, payload) in bytes.chunks(PAYLOAD_BYTES).enumerate() {
        let start = out.len();
        let at = address + (index * PAYLOAD_BYTES) as u32;
        let [first, second] = UF2_START;
        let size = PAYLOAD_BYTES as u32;
        for word in [first, second, FAMILY_PRESENT, at, size, index as u32, blocks as u32, family] {
            out.extend_from_slice(&word.to_le_bytes());
        }
        out.extend_from_slice(payload);
        out.resize(out.len() + PAYLOAD_BYTES - payload.len(), ERASED);
        out.resize(start + BLOCK_BYTES - size_of_val(&UF2_END), 0);
        out.extend_from_slice(&UF2_END.to_le_bytes());
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use maps::formats::foreign::wrapped;

    #[test]
    fn names_and_boards_say_how_a_blob_is_written() {
        let of = |name: &str, board: &str| Image::of(Path::new(name), Board::find(board));
        assert_eq!(of("plans.bin", ""), Ok(Image::Raw));
        assert_eq!(of("/dev/null", "pico2"), Ok(Image::Raw));
        assert_eq!(of("hex", "pico2"), Ok(Image::Raw));
        assert_eq!(of("a.b/p.HEX", "stm32f405"), Ok(Image::Hex { address: 0x080C_0000 }));
        let (address, family) = (0x1020_0000, 0xE48B_FF59);
        assert_eq!(of("p.uf2", "pico2"), Ok(Image::Uf2 { address, family }));
        assert!(of("p.hex", "").unwrap_err().contains("nrf52840-dk, stm32f405, pico2"));
        assert!(of("p.uf2", "stm32f405").unwrap_err().starts_with("stm32f405 has no boot loader"));
    }

    #[test]
    fn wrapped_blobs_are_known_by_their_first_bytes() {
        assert_eq!(wrapped(hex(0, b"x").as_bytes()), Some("Intel HEX"));
        assert_eq!(wrapped(&uf2(0, 0, b"x")), Some("UF2"));
        assert_eq!(wrapped(&plan_format::MAGIC), None);
    }

    #[test]
    fn hex_is_what_is_worked_out_by_hand() {
        // 04 + 08 + 0C = 18, 100 - 18 = E8; 03 + 01 + 02 + FF = 105, 100 - 05 = FB.
        let expected = ":02000004080CE6\n:030000000102FFFB\n:00000001FF\n";
        assert_eq!(hex(0x080C_0000, &[1, 2, 0xFF]), expected);
        assert_eq!(hex(0, &[]), ":00000001FF\n");
    }

    #[test]
    fn hex_goes_on_in_the_next_segment() {
        let text = hex(0x1020_0000, &vec![0; 0x1_0001]);
        let lines: Vec<&str> = text.lines().collect();
        // 4096 records of the first segment, then the second segment and its one byte.
        assert_eq!(lines[0], ":020000041020CA");
        assert_eq!(lines[4096], format!(":10FFF000{}01", "00".repeat(16)));
        assert_eq!(lines[4097..], [":020000041021C9", ":0100000000FF", ":00000001FF"]);
    }

    #[test]
    fn uf2_is_what_is_worked_out_by_hand() {
        let blocks = uf2(0x1020_0000, 0xE48B_FF59, &[7; 257]);
        assert_eq!(blocks.len(), 1024);
        let head = [
            [0x55, 0x46, 0x32, 0x0A], // "UF2\n"
            [0x57, 0x51, 0x5D, 0x9E],
            [0x00, 0x20, 0x00, 0x00], // names its family
            [0x00, 0x01, 0x20, 0x10], // the second page
            [0x00, 0x01, 0x00, 0x00], // 256 bytes
            [0x01, 0x00, 0x00, 0x00], // block 1
            [0x02, 0x00, 0x00, 0x00], // of 2
            [0x59, 0xFF, 0x8B, 0xE4],
        ];
        assert_eq!(blocks[512..544], *head.as_flattened());
        assert_eq!((blocks[544], blocks[545], blocks[544 + 255]), (7, 0xFF, 0xFF));
        assert!(blocks[800..1020].iter().all(|&byte| byte == 0));
        assert_eq!(blocks[1020..], [0x30, 0x6F, 0xB1, 0x0A]);
        assert_eq!(blocks[12..16], [0x00, 0x00, 0x20, 0x10]);
        assert_eq!(blocks[32..288], [7; 256]);
        assert!(uf2(0, 0, &[]).is_empty());
    }
}
