//! Where a map's obstacles truly lie.

use crate::Point;
use maps::Shape;
use math::scalar::wide;

/// Where a map's obstacles truly lie: turned and scaled about a point, then shifted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// The point that turning and scaling do not move, metres.
    pub about: Point,
    /// Angle, radians counter-clockwise.
    pub turn_rad: f64,
    /// Scale; more than 0.
    pub scale: f64,
    /// Shift, metres.
    pub shift: Point,
}

impl Placement {
    /// As the map shows them.
    pub const HERE: Self = Self { about: [0.0; 2], turn_rad: 0.0, scale: 1.0, shift: [0.0; 2] };

    /// The true position of a point of the map.
    pub fn apply(&self, at: Point) -> Point {
        if *self == Self::HERE {
            return at;
        }
        let (c, s) = (wide::cos(self.turn_rad), wide::sin(self.turn_rad));
        let [x, y] = [0, 1].map(|axis| self.scale * (at[axis] - self.about[axis]));
        let turned = [c * x - s * y, s * x + c * y];
        [0, 1].map(|axis| turned[axis] + self.about[axis] + self.shift[axis])
    }

    /// The point of the map at a true position.
    pub fn undo(&self, at: Point) -> Point {
        if *self == Self::HERE {
            return at;
        }
        let (c, s) = (wide::cos(self.turn_rad), wide::sin(self.turn_rad));
        let [x, y] = [0, 1].map(|axis| at[axis] - self.about[axis] - self.shift[axis]);
        let turned = [c * x + s * y, c * y - s * x];
        [0, 1].map(|axis| turned[axis] / self.scale + self.about[axis])
    }

    /// The true shape of an obstacle of the map.
    pub fn shape(&self, shape: &Shape) -> Shape {
        let all = |points: &Vec<Point>| points.iter().map(|&at| self.apply(at)).collect();
        match shape {
            Shape::Circle { centre, radius } => {
                Shape::Circle { centre: self.apply(*centre), radius: self.scale * radius }
            }
            Shape::Polyline(points) => Shape::Polyline(all(points)),
            Shape::Polygon(rings) => Shape::Polygon(rings.iter().map(all).collect()),
        }
    }
}
