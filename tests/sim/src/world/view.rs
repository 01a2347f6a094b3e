//! What the many rays from one point may meet.

use super::{Part, World, around};
use crate::Point;
use crate::geometry::Circle;
use math::scalar::wide;

/// The surfaces within reach of one point. A ring of rays is answered faster from here than by
/// [`World::range`] for each ray, and with the same distances to the last bit.
#[derive(Debug)]
pub struct View {
    from: Point,
    most_m: f64,
    parts: Vec<Seen>,
}

/// A part and the directions in which it lies.
#[derive(Debug)]
struct Seen {
    part: Part,
    /// Unit vector to the middle of these directions.
    middle: Point,
    /// Rays meet the part only if the cosine of their angle to the middle is at least this.
    least: f64,
}

/// What rounding may take from such a cosine.
const ROUNDING: f64 = 1e-9;

impl View {
    pub(super) fn new(world: &World, from: Point, most_m: f64) -> Self {
        let mut numbers = Vec::new();
        world.within(around(from, most_m), &mut |part| numbers.push(part));
        numbers.sort_unstable();
        numbers.dedup();
        let mut view = Self { from, most_m, parts: Vec::with_capacity(numbers.len()) };
        numbers.iter().for_each(|&number| view.add(world.parts[number as usize]));
        view
    }

    /// The same view with another disc in it.
    pub fn with(mut self, disc: Circle) -> Self {
        self.add(Part::Disc { centre: disc.centre, radius: disc.radius_m });
        self
    }

    fn add(&mut self, part: Part) {
        let (middle, least) = part.directions(self.from).unwrap_or(([1.0, 0.0], -1.0));
        self.parts.push(Seen { part, middle, least: least - ROUNDING });
    }

    /// Distance along a ray to the first surface, metres; `None` if none is within reach. From
    /// within a disc: 0.
    pub fn range(&self, heading_rad: f64) -> Option<f64> {
        if self.parts.is_empty() {
            return None;
        }
        let (sine, cosine) = wide::sin_cos(heading_rad);
        let along = [cosine, sine];
        let is_met =
            |seen: &&Seen| along[0] * seen.middle[0] + along[1] * seen.middle[1] >= seen.least;
        let hits =
            self.parts.iter().filter(is_met).filter_map(|seen| seen.part.hit(self.from, along));
        hits.filter(|&hit| hit < self.most_m).reduce(f64::min)
    }
}

impl Part {
    /// The directions in which this part lies from a point: the middle one, and the cosine of the
    /// largest angle to it. `None` if that may be every direction.
    fn directions(&self, from: Point) -> Option<(Point, f64)> {
        let unit = |to: Point| {
            let gap = [to[0] - from[0], to[1] - from[1]];
            let length = wide::sqrt(gap[0] * gap[0] + gap[1] * gap[1]);
            (length > ROUNDING).then(|| ([gap[0] / length, gap[1] / length], length))
        };
        match *self {
            Self::Segment { from: a, to: b } => {
                let ((a, _), (b, _)) = (unit(a)?, unit(b)?);
                let sum = [a[0] + b[0], a[1] + b[1]];
                let length = wide::sqrt(sum[0] * sum[0] + sum[1] * sum[1]);
                // Seen from a point on the segment, its ends lie in opposite directions.
                let middle = (length > 1e-3).then(|| [sum[0] / length, sum[1] / length])?;
                Some((middle, middle[0] * a[0] + middle[1] * a[1]))
            }
            Self::Disc { centre, radius } => {
                let (middle, length) = unit(centre)?;
                let sine = radius / length;
                (sine < 1.0).then(|| (middle, wide::sqrt(1.0 - sine * sine)))
            }
        }
    }
}
