//! Whether a PGM, PPM or PBM holds exactly the samples that its header promises.
//!
//! What a header of eight bytes says decides where every row begins. A file that went through a
//! program that changes line ends, or whose header does not fit, decodes without a fault and is
//! shifted by a pixel a row; the number of bytes gives it away.

use image::codecs::pnm::{PnmDecoder, PnmHeader, PnmSubtype, SampleEncoding};
use std::io::Cursor;

/// Why the bytes of an image that can be decoded are not what they say.
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
                    shifted; the file was changed as text is, or written by a wrong program"
            .into());
    }
    if more > 0 {
        return Err(format!("it holds {more} bytes more than its header says"));
    }
    // The decoder refuses what is cut off; only headers that it reads otherwise come here.
    if missing > 0 {
        return Err(format!("it holds {missing} bytes less than its header says"));
    }
    let largest = header.maximal_sample();
    let is_above = |sample: &u8| u32::from(*sample) > largest;
    if sample_bytes(&header) == 1 && !is_bitmap(&header) && data.iter().any(is_above) {
        return Err(format!("it holds values above the largest that its header says, {largest}"));
    }
    Ok(())
}

/// Samples as text.
fn plain(header: &PnmHeader, data: &[u8]) -> Result<(), String> {
    let count = if is_bitmap(header) {
        data.iter().filter(|byte| !byte.is_ascii_whitespace()).count()
    } else {
        let words = data.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        let largest = header.maximal_sample();
        let number = |word: &[u8]| std::str::from_utf8(word).ok()?.parse::<u32>().ok();
        let mut count = 0;
        for word in words {
            if number(word).is_some_and(|number| number > largest) {
                return Err(format!(
                    "it holds values above the largest that its header says, {largest}"
                ));
            }
            count += 1;
        }
        count
    };
    match count.checked_sub(samples(header)) {
        Some(more @ 1..) => Err(format!("it holds {more} values more than its header says")),
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

/// How many samples a header promises; of a binary bitmap how many bytes.
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
