//! Layers before any goal: a stack of terrains, each at least as constrained as the one below it.
//!
//! Each layer says what it adds; the stack yields its terrain, which also blocks all that the layers
//! below it block. So a robot that follows a layer is never led into an obstacle of a less
//! constrained one (W, section 2.3).

use crate::terrain::Terrain;
use maps::Bitmap;

/// A layer before any goal.
#[derive(Clone, Debug)]
pub struct Layer {
    /// Its name, unique in its stack.
    pub name: String,
    /// What it and all layers below it block.
    pub terrain: Terrain,
}

/// Layers from the least to the most constrained.
#[derive(Clone, Debug, Default)]
pub struct Stack {
    layers: Vec<Layer>,
}

impl Stack {
    /// Puts a layer on top; `added` are the cells that it blocks besides those below it.
    pub fn add(&mut self, name: &str, added: Bitmap) {
        let mut blocked = added;
        if let Some(below) = self.layers.last() {
            blocked.add_all(&below.terrain.blocked);
        }
        self.layers.push(Layer { name: name.to_owned(), terrain: Terrain::new(blocked) });
    }

    /// The layers, the least constrained first.
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plan_format::Cell;

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
