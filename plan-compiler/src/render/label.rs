//! Text as shapes, so that a picture needs no font.

use font8x8::UnicodeFonts;
use std::fmt::Write;
use svg::node::element::Path;

/// Side of a glyph's pixel, in pixels of the picture.
const PIXEL: f64 = 1.5;
/// Pixels along a glyph's side.
const GLYPH: usize = 8;

/// How far the next letter stands, pixels.
pub(crate) fn advance_px() -> f64 {
    GLYPH as f64 * PIXEL
}

/// A line of text with its upper left corner at (x, y), pixels.
pub(crate) fn label(x: f64, y: f64, text: &str, colour: &str) -> Path {
    let mut path = String::new();
    for (index, character) in text.chars().enumerate() {
        for (row, bits) in glyph(character).into_iter().enumerate() {
            for column in (0..GLYPH).filter(|column| bits >> column & 1 == 1) {
                let left = x + (index * GLYPH + column) as f64 * PIXEL;
                let top = y + row as f64 * PIXEL;
                let _ = write!(path, "M{left} {top}h{PIXEL}v{PIXEL}h-{PIXEL}z");
            }
        }
    }
    Path::new().set("d", path).set("fill", colour)
}

/// Eight rows, the lowest bit in the west; a question mark for what the font lacks.
fn glyph(character: char) -> [u8; GLYPH] {
    font8x8::BASIC_FONTS
        .get(character)
        .or_else(|| font8x8::LATIN_FONTS.get(character))
        .or_else(|| font8x8::GREEK_FONTS.get(character))
        .or_else(|| font8x8::BASIC_FONTS.get('?'))
        .unwrap_or_default()
}
