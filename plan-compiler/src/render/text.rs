//! Text, and the font that ships with the program.
//!
//! An SVG names the font and its substitutes, so that a browser draws text that can be searched and
//! copied, with or without the font; a PNG is drawn with the font itself. DejaVu Sans is wide:
//! almost every other font needs less room for the same words, so texts that do not overlap here do
//! not overlap in other fonts.
//!
//! The font is a subset: Latin, Greek, Cyrillic, arrows. Characters outside it are boxes in a PNG;
//! an SVG shows them in the viewer's own fonts.
//!
//! Deliberately absent: shaping. Words are measured character by character.

use super::palette::INK;
use skrifa::instance::{LocationRef, Size};
use skrifa::{FontRef, MetadataProvider};
use std::collections::HashMap;
use std::sync::LazyLock;
use svg::node::element::Text;

/// The font, for the rasteriser.
pub(crate) static FONT: &[u8] = include_bytes!("font/DejaVuSans.ttf");
/// The name of the font.
pub(crate) const FAMILY: &str = "DejaVu Sans";
/// The font and its substitutes, for the root of every picture.
pub(crate) const FAMILIES: &str = "'DejaVu Sans', Verdana, Geneva, sans-serif";

/// Assumed width of a character that the font lacks, in multiples of the font size: an emoji's
/// width.
const UNKNOWN_EM: f64 = 1.3;
/// Height of capital letters above the base line, in multiples of the font size.
pub(crate) const CAPITALS_EM: f64 = 0.73;

/// Widths of the font's characters, in multiples of the font size.
static ADVANCES_EM: LazyLock<HashMap<char, f64>> = LazyLock::new(|| {
    let Ok(font) = FontRef::new(FONT) else { return HashMap::new() };
    let metrics = font.glyph_metrics(Size::new(1.0), LocationRef::default());
    let width = |(code, glyph)| {
        let width = metrics.advance_width(glyph)?;
        Some((char::from_u32(code)?, f64::from(width)))
    };
    font.charmap().mappings().filter_map(width).collect()
});

/// Position of a text relative to its point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Anchor {
    /// It begins there.
    #[default]
    Start,
    /// Its middle is there.
    Middle,
    /// It ends there.
    End,
}

/// Width of a text, pixels.
pub(crate) fn width_px(text: &str, size_px: f64) -> f64 {
    let advance = |character| ADVANCES_EM.get(&character).copied().unwrap_or(UNKNOWN_EM);
    size_px * text.chars().map(advance).sum::<f64>()
}

/// The characters of a text that a PNG shows as boxes.
pub(crate) fn lacking(text: &str) -> impl Iterator<Item = char> + '_ {
    text.chars().filter(|c| !ADVANCES_EM.contains_key(c) && !c.is_control())
}

/// A line of text with its base line at (x, y), pixels.
pub(crate) fn line(at: [f64; 2], text: &str, size_px: f64, anchor: Anchor) -> Text {
    let anchor = match anchor {
        Anchor::Start => "start",
        Anchor::Middle => "middle",
        Anchor::End => "end",
    };
    Text::new(clean(text))
        .set("x", round(at[0]))
        .set("y", round(at[1]))
        .set("font-size", round(size_px))
        .set("text-anchor", anchor)
        .set("fill", INK)
}

/// The text without characters that XML forbids or that could reorder or hide other text.
pub(crate) fn clean(text: &str) -> String {
    let is_formatting = |c: char| {
        matches!(c, '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2060}'..='\u{206f}')
            || matches!(c, '\u{61c}' | '\u{feff}')
    };
    let is_forbidden =
        |c: char| c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}' | '\u{2028}' | '\u{2029}');
    let shown = text.chars().filter(|&c| !is_formatting(c));
    shown.map(|c| if is_forbidden(c) { char::REPLACEMENT_CHARACTER } else { c }).collect()
}

/// The text, or its beginning and an ellipsis if it is wider than `room_px`.
pub(crate) fn fit(text: &str, size_px: f64, room_px: f64) -> String {
    let text = clean(text);
    if width_px(&text, size_px) <= room_px {
        return text;
    }
    let mut kept = text;
    while kept.pop().is_some() {
        let shortened = format!("{}…", kept.trim_end());
        if width_px(&shortened, size_px) <= room_px {
            return shortened;
        }
    }
    String::new()
}

/// Rounds to a hundredth of a pixel, which keeps files short.
pub(crate) fn round(pixels: f64) -> f64 {
    (pixels * 100.0).round() / 100.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_as_wide_as_the_font_says() {
        // DejaVu Sans: 2048 units an em; `i` 569, `M` 1767, a blank 651.
        for (text, units) in [("i", 569.0), ("M", 1767.0), (" ", 651.0), ("Mi i", 3556.0)] {
            let expected = units / 2048.0 * 20.0;
            assert!((width_px(text, 20.0) - expected).abs() < 0.01, "{text}");
        }
        assert_eq!(width_px("界", 10.0), 13.0);
        for character in "AZaz09äöüßéñøåłčžșğıαΩДяёї→°±–—…€".chars()
        {
            assert!(ADVANCES_EM.contains_key(&character), "{character} is missing");
        }
    }

    #[test]
    fn long_texts_end_in_an_ellipsis_and_fit() {
        assert_eq!(fit("gate", 10.0, 100.0), "gate");
        let short = fit("the gate in the north", 10.0, 60.0);
        assert!(short.ends_with('…') && short.starts_with("the"), "{short}");
        assert!(width_px(&short, 10.0) <= 60.0);
        assert_eq!(fit("gate", 10.0, 1.0), "");
    }

    #[test]
    fn what_xml_forbids_is_replaced() {
        assert_eq!(clean("a\u{1b}[2J\u{0}b\u{202e}c\u{fffe}"), "a\u{fffd}[2J\u{fffd}bc\u{fffd}");
        assert_eq!(
            line([0.0, 0.0], "<&>", 10.0, Anchor::Start).to_string().matches('&').count(),
            3
        );
    }
}
