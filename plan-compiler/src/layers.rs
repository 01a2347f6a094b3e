//! Layers before any goal: a stack of terrains, each at least as constrained as the one below it.
//!
//! Each layer says what it adds; the stack yields its terrain, which also blocks all that the layers
//! below it block. So a robot that follows a layer is never led into an obstacle of a less
//! constrained one (W, section 2.3). Tolls multiply and speed limits add up from layer to layer; they
//! never free a cell.

use crate::terrain::Terrain;
use crate::tolls::Tolls;
use maps::Bitmap;
use plan_format::Cell;

/// A layer before any goal.
#[derive(Clone, Debug)]
pub struct Layer {
    /// Its name, unique in its stack.
    pub name: String,
    /// What it and all layers below it block.
    pub terrain: Terrain,
    /// Its speed limits and those of all layers below it.
    pub limits: Limits,
}

/// The speed limits of the cells of a grid.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Limits {
    /// Cells with a limit, cm/s, the lowest limit first. Where they overlap, the lowest counts.
    zones: Vec<(u16, Bitmap)>,
}

impl Limits {
    /// Lowers the limit in some cells to this one, m/s.
    pub fn lower(&mut self, cells: &Bitmap, limit_mps: f64) {
        let limit = Self::in_cmps(limit_mps);
        match self.zones.binary_search_by_key(&limit, |zone| zone.0) {
            Ok(at) => self.zones[at].1.add_all(cells),
            Err(at) => self.zones.insert(at, (limit, cells.clone())),
        }
    }

    /// A limit in m/s as whole cm/s.
    pub fn in_cmps(limit_mps: f64) -> u16 {
        ((limit_mps * 100.0 + 0.5) as u16).max(1)
    }

    /// Whether no cell has a limit.
    pub fn is_none(&self) -> bool {
        self.zones.is_empty()
    }

    /// The limit of a cell, cm/s.
    pub fn at(&self, cell: Cell) -> Option<u16> {
        self.zones.iter().find(|(_, cells)| cells.get(cell)).map(|&(limit, _)| limit)
    }
}

/// Layers from the least to the most constrained.
#[derive(Clone, Debug, Default)]
pub struct Stack {
    layers: Vec<Layer>,
}

impl Stack {
    /// Puts a layer on top; `added` are the cells that it blocks besides those below it.
    pub fn add(&mut self, name: &str, added: Bitmap) {
        let (tolls, limits) = self.inherited();
        self.push(name, added, tolls, limits);
    }

    /// As [`Stack::add`]. `add_tolls` multiplies the tolls of the layers below by those that the layer
    /// adds, and lowers their speed limits.
    pub fn add_with_tolls(
        &mut self,
        name: &str,
        added: Bitmap,
        add_tolls: impl FnOnce(&mut Tolls, &mut Limits),
    ) {
        let (tolls, mut limits) = self.inherited();
        let mut tolls = tolls.unwrap_or_else(|| Tolls::none(added.columns(), added.rows()));
        add_tolls(&mut tolls, &mut limits);
        self.push(name, added, Some(tolls), limits);
    }

    /// The tolls and the speed limits of the uppermost layer.
    fn inherited(&self) -> (Option<Tolls>, Limits) {
        let below = self.layers.last();
        let tolls = below.and_then(|below| below.terrain.tolls.clone());
        (tolls, below.map(|below| below.limits.clone()).unwrap_or_default())
    }

    fn push(&mut self, name: &str, mut blocked: Bitmap, tolls: Option<Tolls>, limits: Limits) {
        if let Some(below) = self.layers.last() {
            blocked.add_all(&below.terrain.blocked);
        }
        let terrain = Terrain::new(blocked);
        let terrain = match tolls {
            Some(tolls) => terrain.with_tolls(tolls),
            None => terrain,
        };
        self.layers.push(Layer { name: name.to_owned(), terrain, limits });
    }

    /// The layers, the least constrained first.
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_layer_has_what_lies_below_it() {
        let cell = |column| Bitmap::from_fn(4, 1, |at| at.column == column);
        let mut stack = Stack::default();
        for (name, column) in [("physical", 0), ("comms", 2), ("night", 2)] {
            stack.add(name, cell(column));
        }
        let blocked: Vec<Vec<u32>> = stack
            .layers()
            .iter()
            .map(|layer| layer.terrain.blocked.iter().map(|cell| cell.column).collect())
            .collect();
        assert_eq!(blocked, [vec![0], vec![0, 2], vec![0, 2]]);
        let [physical, comms, _] = stack.layers() else { panic!("three layers") };
        assert!(comms.terrain.nests_in(&physical.terrain));
        assert!(!physical.terrain.nests_in(&comms.terrain));
        let gaps: Vec<Cell> = physical.terrain.gaps(&comms.terrain).collect();
        assert_eq!(gaps, [Cell::new(2, 0)]);
    }
}
