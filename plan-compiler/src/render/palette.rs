//! Colours that people with any kind of colour vision can distinguish.
//!
//! Routes use colours of Okabe and Ito, costs a ramp of evenly decreasing lightness from the goal
//! on; the rest is grey. No meaning depends on colour alone: routes have dashes, marks have shapes,
//! and cells without a route are hatched.
//!
//! The tests below simulate protanopia, deuteranopia and tritanopia after Machado, Oliveira and
//! Fernandes (2009, severity 1). They require a CIEDE2000 distance between all colours that must be
//! distinguished, and the contrast that WCAG 2 demands of text (4.5) and of graphics (3).

/// Text and frames.
pub(crate) const INK: &str = "#1a1a1a";
/// Less important text.
pub(crate) const FAINT: &str = "#55595f";
/// The background of pictures.
pub(crate) const PAPER: &str = "#ffffff";
/// Exact obstacles.
pub(crate) const OBSTACLE: &str = "#1f1f1f";
/// Obstacles that the map does not show.
pub(crate) const UNMAPPED: &str = "#e69f00";
/// Blocked cells.
pub(crate) const BLOCKED: &str = "#6f6f6f";
/// The hatching of cells without a route, on paper.
pub(crate) const HATCH: &str = "#8c8c8c";
/// Dots on cells with a toll.
pub(crate) const TOLL: &str = "#33322e";
/// Areas that weaken radio.
pub(crate) const ATTENUATING: &str = "#009e73";
/// Zones.
pub(crate) const ZONE: &str = "#8f3f71";
/// Arrows of the advice.
pub(crate) const ADVICE: &str = "#12263a";
/// Borders between the areas of several goals.
pub(crate) const BORDER: &str = "#c94f8a";
/// The goal.
pub(crate) const GOAL: &str = "#f0e442";

/// The background of a graph's parts.
pub(crate) const PANEL: &str = "#f6f5f1";
/// Protection intervals of a graph.
pub(crate) const INTERVAL: &str = "#b3341f";
/// Backgrounds of the labels of rules in a graph, from NB to PB.
pub(crate) const SHADES: [&str; 7] =
    ["#f7f7f2", "#e6e6d2", "#dcd6a8", "#e0c070", "#dea552", "#d98838", "#cc6a28"];

/// Colours of routes, by behaviour.
pub(crate) const ROUTES: [&str; 5] = ["#d55e00", "#0072b2", "#000000", "#cc79a7", "#009e73"];
/// Dashes and gaps of routes, in line widths; empty for a solid line.
pub(crate) const DASHES: [&[f64]; 5] =
    [&[], &[4.0, 1.5], &[1.5, 1.5], &[6.0, 1.5, 1.5, 1.5], &[3.0, 3.0]];
/// A route that no behaviour drove.
pub(crate) const NO_BEHAVIOUR_STYLE: (&str, &[f64]) = ("#6b6b6b", &[0.8, 1.2]);

/// Colour and dashes of a route by its number. The first 25 and that of [`super::NO_BEHAVIOUR`] are
/// all different.
pub(crate) fn route(number: usize) -> (&'static str, &'static [f64]) {
    let count = ROUTES.len();
    match number {
        super::NO_BEHAVIOUR => NO_BEHAVIOUR_STYLE,
        _ => (ROUTES[number % count], DASHES[(number + number / count) % count]),
    }
}

/// Colours of cost from the goal to the farthest cell; the colours of bands are interpolated. The
/// lightness falls evenly, and yellow turns to blue, a difference that all but tritanopes see.
const RAMP: [[f64; 3]; 5] = [
    [255.0, 252.0, 215.0],
    [186.0, 219.0, 106.0],
    [157.0, 171.0, 107.0],
    [105.0, 152.0, 180.0],
    [81.0, 111.0, 170.0],
];

/// The colour of one of `bands` cost bands.
pub(crate) fn band(index: usize, bands: usize) -> [u8; 3] {
    let at = index as f64 / bands.saturating_sub(1).max(1) as f64;
    let scaled = at.clamp(0.0, 1.0) * (RAMP.len() - 1) as f64;
    let below = (scaled as usize).min(RAMP.len() - 2);
    let part = scaled - below as f64;
    let channel =
        |c: usize| (RAMP[below][c] + (RAMP[below + 1][c] - RAMP[below][c]) * part).round() as u8;
    [channel(0), channel(1), channel(2)]
}

/// `#rrggbb` as numbers.
pub(crate) fn rgb(colour: &str) -> [u8; 3] {
    let channel = |at: usize| {
        colour.get(at..at + 2).and_then(|digits| u8::from_str_radix(digits, 16).ok()).unwrap_or(0)
    };
    [channel(1), channel(3), channel(5)]
}

/// Numbers as `#rrggbb`.
pub(crate) fn hex([red, green, blue]: [u8; 3]) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

#[cfg(test)]
mod tests;
