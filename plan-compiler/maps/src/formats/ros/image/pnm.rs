//! Checks that a PGM, PPM or PBM holds exactly the samples that its header promises. White space
//! after them is accepted: editors and scripts add a line end.
//!
//! The short header decides where every row begins. A file with converted line ends or a wrong
//! header decodes without an error, but is shifted by a pixel per row; only the number of bytes
//! reveals it.

use image::codecs::pnm::{PnmDecoder, PnmHeader, PnmSubtype, SampleEncoding};
use std::io::Cursor;

/// An error if the bytes of a decodable image contradict its header.
pub(super) fn check(bytes: &[u8]) -> Result<(), String> {
    let decoder = PnmDecoder::new(Cursor::new(bytes)).map_err(|error| error.to_string())?;
    let (at, header) = decoder.into_inner();
    let (head, data) = bytes.split_at((at.position() as usize).min(bytes.len()));
    if is_plain(&header) {
        return plain(&header, data);
    }
    let promised = samples(&header).saturating_mul(sample_bytes(&header));
    let (more, missing) =
        (data.len().saturating_sub(promised), promised.saturating_sub(data.len()));
    if more > 0 && head.contains(&b'\r') {
        return Err("its header has the line ends of Windows (CR LF), so that every row would be \
                    shifted; the file was converted as if it were text, or written by a faulty program"
            .into());
    }
    if more > 0 {
        let rest = data.get(promised..).unwrap_or_default();
        if !rest.trim_ascii().is_empty() {
            return Err(format!("it holds {} more than its header declares", count(more, "byte")));
        }
    }
    // The decoder refuses truncated files; only headers that it reads differently get here.
    if missing > 0 {
        return Err(format!("it holds {} less than its header declares", count(missing, "byte")));
    }
    let largest = header.maximal_sample();
    let is_above = |sample: &u8| u32::from(*sample) > largest;
    let mut values = data.iter().take(promised);
    if sample_bytes(&header) == 1 && !is_bitmap(&header) && values.any(is_above) {
        return Err(format!(
            "it holds values above the largest that its header declares, {largest}"
        ));
    }
    Ok(())
}

/// A number of things: `1 byte`, `2 bytes`.
fn count(number: usize, what: &str) -> String {
    format!("{number} {what}{}", if number == 1 { "" } else { "s" })
}

/// Checks samples that are written as text.
fn plain(header: &PnmHeader, data: &[u8]) -> Result<(), String> {
    let found = if is_bitmap(header) {
        data.iter().filter(|byte| !byte.is_ascii_whitespace()).count()
    } else {
        let words = data.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        let largest = header.maximal_sample();
        let number = |word: &[u8]| std::str::from_utf8(word).ok()?.parse::<u32>().ok();
        let mut found = 0;
        for word in words {
            if number(word).is_some_and(|number| number > largest) {
                return Err(format!(
                    "it holds values above the largest that its header declares, {largest}"
                ));
            }
            found += 1;
        }
        found
    };
    match found.checked_sub(samples(header)) {
        Some(more @ 1..) => {
            Err(format!("it holds {} more than its header declares", count(more, "value")))
        }
        _ => Ok(()),
    }
}

fn is_plain(header: &PnmHeader) -> bool {
    matches!(
        header.subtype(),
        PnmSubtype::Bitmap(SampleEncoding::Ascii)
            | PnmSubtype::Graymap(SampleEncoding::Ascii)
            | PnmSubtype::Pixmap(SampleEncoding::Ascii)
    )
}

fn is_bitmap(header: &PnmHeader) -> bool {
    matches!(header.subtype(), PnmSubtype::Bitmap(_))
}

/// Number of samples that a header promises; for a binary bitmap, number of bytes.
fn samples(header: &PnmHeader) -> usize {
    let (width, height) = (header.width() as usize, header.height() as usize);
    let per_row = match header.subtype() {
        PnmSubtype::Bitmap(SampleEncoding::Binary) => width.div_ceil(8),
        PnmSubtype::Bitmap(_) | PnmSubtype::Graymap(_) => width,
        PnmSubtype::Pixmap(_) => width.saturating_mul(3),
        PnmSubtype::ArbitraryMap => {
            let depth = header.as_arbitrary().map_or(1, |header| header.depth);
            width.saturating_mul(depth as usize)
        }
    };
    per_row.saturating_mul(height)
}

fn sample_bytes(header: &PnmHeader) -> usize {
    if header.maximal_sample() > 255 { 2 } else { 1 }
}
