//! The shapes of a map, prepared for the question which of them a line passes.

mod body;
mod cells;

pub(super) use body::{Body, Ray};
use cells::Cells;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree, SelectionFunction};

use super::Settings;
use crate::model::{Feature, Map, Role};

/// What a body is to radio.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// Radio passes over it.
    Obstacle,
    /// Radio passes through it, weakened.
    Foliage,
}

/// A stretch of a ray inside a body; `span` is in parts of the ray, from 0 to 1. A line that the
/// ray crosses has a span without length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stretch {
    pub(super) span: [f64; 2],
    pub(super) kind: Kind,
    /// Height of the body, metres; `None` if the map does not give it.
    pub(super) height_m: Option<f64>,
}

/// Everything on a map that weakens radio.
#[derive(Clone, Debug)]
pub(super) struct Scene {
    bodies: Vec<Body>,
    tree: RTree<Boxed>,
    cells: Option<Cells>,
}

/// The rectangle around a body, with its index.
type Boxed = GeomWithData<Rectangle<[f64; 2]>, usize>;

impl Scene {
    /// The features for which `counts` holds, and the map's cells.
    pub(super) fn of(map: &Map, settings: &Settings, counts: impl Fn(&Feature) -> bool) -> Self {
        let counted = map.features.iter().filter(|feature| counts(feature));
        let bodies: Vec<Body> =
            counted.filter_map(|feature| Body::of(feature, settings.small_m)).collect();
        let boxed = bodies.iter().enumerate().map(|(index, body)| {
            let [low, high] = body.corners();
            Boxed::new(Rectangle::from_corners(low, high), index)
        });
        let tree = RTree::bulk_load(boxed.collect());
        let cells = map.cells.as_ref().map(|cells| Cells::of(cells, settings.small_m));
        Self { bodies, tree, cells }
    }

    /// Whether the ray passes any body.
    pub(super) fn is_met_by(&self, ray: &Ray) -> bool {
        self.near(ray).any(|body| body.is_met_by(ray))
            || self.cells.as_ref().is_some_and(|cells| cells.is_met_by(ray))
    }

    /// Appends every stretch of the ray in a body.
    pub(super) fn stretches(&self, ray: &Ray, found: &mut Vec<Stretch>) {
        for body in self.near(ray) {
            body.stretches(ray, found);
        }
        if let Some(cells) = &self.cells {
            cells.stretches(ray, found);
        }
    }

    /// Bodies whose rectangles the ray meets.
    fn near<'s>(&'s self, ray: &'s Ray) -> impl Iterator<Item = &'s Body> {
        let boxed = self.tree.locate_with_selection_function(Along(*ray));
        boxed.map(|boxed| &self.bodies[boxed.data])
    }
}

/// Selects the rectangles that a ray meets.
struct Along(Ray);

impl SelectionFunction<Boxed> for Along {
    fn should_unpack_parent(&self, envelope: &AABB<[f64; 2]>) -> bool {
        self.0.meets_box(envelope.lower(), envelope.upper())
    }

    fn should_unpack_leaf(&self, leaf: &Boxed) -> bool {
        self.0.meets_box(leaf.geom().lower(), leaf.geom().upper())
    }
}

impl From<Role> for Kind {
    fn from(role: Role) -> Self {
        if role == Role::Attenuating { Self::Foliage } else { Self::Obstacle }
    }
}
