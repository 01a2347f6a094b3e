//! Lines of a picture.

use super::text;
use svg::node::element::Path;

/// A pattern of dashes for SVG; `widths` count in widths of the line.
pub(super) fn dashes(widths: &[f64], line_px: f64) -> String {
    let lengths = widths.iter().map(|width| text::round(width * line_px).to_string());
    if widths.is_empty() { "none".to_owned() } else { lengths.collect::<Vec<_>>().join(" ") }
}

/// A line along a path, without a fill.
pub(super) fn stroke(path: String, colour: &str, width: f64) -> Path {
    Path::new()
        .set("d", path)
        .set("fill", "none")
        .set("stroke", colour)
        .set("stroke-width", text::round(width))
}
