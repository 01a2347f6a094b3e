//! Tolls as a texture: dots, the denser the dearer a cell is.

use crate::field::eighths_of;
use crate::tolls::{LEAST, MOST};
use plan_format::{Cell, Grid, Layer};

/// The highest factor of each level above the first, eighths; level 0 is factor 1, without dots.
const UP_TO: [u32; 4] = [12, 16, 32, MOST];
/// Distance between the dots of each level above 0, in parts of the hatching's distance.
const APART: [f64; 4] = [2.0, 1.4, 1.0, 0.7];

/// A level of tolls that is drawn in one texture: 0 to 4.
pub(super) type Density = u8;

/// The level of a cell; 0 without a toll, and where the toll is not known.
pub(super) fn level(grid: &Grid, layer: &Layer<'_>, cell: Cell) -> Density {
    let eighths = eighths_of(grid, layer, cell).unwrap_or(LEAST);
    let above = UP_TO.iter().position(|&most| eighths <= most).unwrap_or(UP_TO.len() - 1);
    if eighths <= LEAST { 0 } else { above as Density + 1 }
}

/// What a level means.
pub(super) fn meaning(level: Density) -> String {
    let at = usize::from(level).saturating_sub(1).min(UP_TO.len() - 1);
    let factor = |eighths: u32| f64::from(eighths) / f64::from(LEAST);
    let below = at.checked_sub(1).map_or(LEAST, |at| UP_TO[at]);
    format!("toll above {} up to {}", factor(below), factor(UP_TO[at]))
}

/// Distance between the dots of a level, from the distance between hatching lines.
pub(super) fn apart(level: Density, hatch: f64) -> f64 {
    let at = usize::from(level).saturating_sub(1).min(APART.len() - 1);
    (APART[at] * hatch).max(2.0)
}

/// Whether a pixel belongs to a dot of a level.
pub(super) fn is_dot(level: Density, hatch_px: u32, x: u32, y: u32) -> bool {
    if level == 0 {
        return false;
    }
    let apart = apart(level, f64::from(hatch_px)) as u32;
    let dot = (hatch_px / 4).max(1);
    // Every other row is shifted by half a distance.
    let shift = y / apart % 2 * (apart / 2);
    (x + shift) % apart < dot && y % apart < dot
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dots_are_denser_where_it_is_dearer() {
        let count = |level| {
            let pixels = (0..120).flat_map(|y| (0..120).map(move |x| (x, y)));
            pixels.filter(|&(x, y)| is_dot(level, 6, x, y)).count()
        };
        let counts = [0, 1, 2, 3, 4].map(count);
        assert_eq!(counts[0], 0);
        assert!(counts.windows(2).all(|pair| pair[0] < pair[1]), "{counts:?}");
        assert_eq!(meaning(1), "toll above 1 up to 1.5");
        assert_eq!(meaning(4), "toll above 4 up to 32");
    }
}
