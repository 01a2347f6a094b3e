//! Where arcs end, and whether a round body that drives along one keeps clear of a point.

use math::{Vec2, scalar, vector};

use crate::scan::LEAST_DISTANCE_M;

/// Share of the distance to a point that the body may use up by passing it. A body that is nearer
/// to a point than it should be may pass it and leave it, and approach it a little.
pub(crate) const KEPT: f32 = 0.98;

/// Nearer to a point than this, the body does not approach it at all, metres.
const TOUCH_M: f32 = 0.01;

/// A way that turns by less than this is straight, radians: its end is off by less than the
/// length times half of this.
const STRAIGHT_RAD: f32 = 0.01;

/// A round body and the distance that it keeps from what it passes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Radius, metres.
    pub radius_m: f32,
    /// Distance to keep, metres.
    pub aside_m: f32,
}

impl Body {
    /// The distance that the body's centre must keep from a point that is now `distance_m` away.
    pub(crate) fn reach_m(&self, distance_m: f32) -> f32 {
        let wide_m = self.radius_m + self.aside_m;
        if KEPT * distance_m >= wide_m {
            return wide_m;
        }
        let touch_m = scalar::smaller(wide_m, self.radius_m + TOUCH_M);
        // A point at the body's side stays free in spite of rounding.
        let kept_m = scalar::smaller(touch_m, 0.9999 * distance_m);
        scalar::smaller(wide_m, scalar::larger(KEPT * distance_m, kept_m))
    }
}

/// What a body drives along, ahead: an arc or a straight line. Arcs of more than half a turn count
/// as whole circles.
#[derive(Clone, Copy, Debug)]
pub struct Arc {
    pub(crate) length_m: f32,
    turned_rad: f32,
    is_to_the_right: bool,
    /// Radius of the arc, metres; 0 for a straight way.
    arc_m: f32,
    /// Heading at the end of an arc to the left, as a vector of length 1.
    end: Vec2,
}

impl Arc {
    /// A way of this length and curvature, 1/m, positive to the left.
    pub fn new(length_m: f32, curvature_per_m: f32) -> Self {
        let turned_rad = length_m * curvature_per_m.abs();
        let is_straight = turned_rad < STRAIGHT_RAD;
        let arc_m = if is_straight { 0.0 } else { 1.0 / curvature_per_m.abs() };
        let end = if is_straight { Vec2::new(1.0, 0.0) } else { vector::from_angle(turned_rad) };
        Self { length_m, turned_rad, is_to_the_right: curvature_per_m < 0.0, arc_m, end }
    }

    /// Whether the way leads away from a point all along. The point is not ahead. On the inside of an
    /// arc, it is also not farther aside than the arc's centre: towards what is, the arc turns.
    pub(crate) fn leaves_behind(&self, point: Vec2) -> bool {
        let to_the_inside_m = if self.is_to_the_right { -point.y } else { point.y };
        let is_straight = self.arc_m == 0.0;
        point.x <= 0.0
            && self.turned_rad < 0.5 * scalar::PI
            && (is_straight || to_the_inside_m <= self.arc_m)
    }

    /// Whether the body touches nothing at `point`, which is `distance_m` away now.
    pub(crate) fn is_clear_of(&self, body: &Body, point: Vec2, distance_m: f32) -> bool {
        let nearest_m = self.length_m + body.radius_m + body.aside_m;
        // No point of the way is farther from here than its length.
        if distance_m >= nearest_m || self.leaves_behind(point) {
            return true;
        }
        self.is_clear_by(body.reach_m(distance_m), point)
    }

    /// The same for a point whose distance is not known; a root is taken only close to the body.
    pub(crate) fn is_clear_of_place(&self, body: &Body, point: Vec2) -> bool {
        let wide_m = body.radius_m + body.aside_m;
        let nearest_m = self.length_m + wide_m;
        let distance_m2 = point.norm_squared();
        if distance_m2 >= nearest_m * nearest_m || self.leaves_behind(point) {
            return true;
        }
        let is_far = KEPT * KEPT * distance_m2 >= wide_m * wide_m;
        let near_m = || body.reach_m(scalar::larger(scalar::sqrt(distance_m2), LEAST_DISTANCE_M));
        self.is_clear_by(if is_far { wide_m } else { near_m() }, point)
    }

    /// Whether the way keeps `reach_m` from a point that is neither behind it nor too far away.
    fn is_clear_by(&self, reach_m: f32, point: Vec2) -> bool {
        let &Self { length_m, turned_rad, is_to_the_right, arc_m, end } = self;
        if arc_m == 0.0 {
            let beyond_m = scalar::larger(point.x - length_m, 0.0);
            return point.y * point.y + beyond_m * beyond_m >= reach_m * reach_m;
        }
        let to_the_inside_m = if is_to_the_right { -point.y } else { point.y };
        // The point about the arc's centre: the arc begins at (0, arc) and ends at
        // arc x (sin, cos) of the turn.
        let about = Vec2::new(point.x, arc_m - to_the_inside_m);
        let is_abreast = about.x >= 0.0 && end.y * about.y - end.x * about.x >= 0.0;
        if turned_rad >= scalar::PI || is_abreast {
            let distance = about.norm_squared();
            let (inner_m, outer_m) = (scalar::larger(arc_m - reach_m, 0.0), arc_m + reach_m);
            distance <= inner_m * inner_m || distance >= outer_m * outer_m
        } else {
            let from_end = about - Vec2::new(end.y, end.x) * arc_m;
            from_end.norm_squared() >= reach_m * reach_m
        }
    }
}

/// The end of an arc that begins at 0 towards +x, metres. Of more than half a turn, only half.
pub(crate) fn end_of(length_m: f32, curvature_per_m: f32) -> Vec2 {
    let turned_rad = scalar::clamp(length_m * curvature_per_m, -scalar::PI, scalar::PI);
    if turned_rad.abs() < STRAIGHT_RAD {
        return Vec2::new(length_m, 0.0);
    }
    let end = vector::from_angle(turned_rad);
    Vec2::new(end.y / curvature_per_m, (1.0 - end.x) / curvature_per_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body(radius_m: f32) -> Body {
        Body { radius_m, aside_m: 0.0 }
    }

    /// A body with a radius of 0.5 m that shall keep 0.1 m. Closer to a point than that, it may use up
    /// 2 % of the distance, down to a centimetre, and there it approaches no more.
    #[test]
    fn a_body_that_is_too_near_may_pass_and_not_approach() {
        let body = Body { radius_m: 0.5, aside_m: 0.1 };
        for (distance_m, reach_m) in [(0.7, 0.6), (0.6, 0.588), (0.515, 0.51), (0.505, 0.50495)] {
            let found = body.reach_m(distance_m);
            assert!((found - reach_m).abs() < 1e-5, "{distance_m}: {found}");
        }
    }

    /// The same rules for a place whose distance is not known yet.
    #[test]
    fn a_place_is_met_as_a_reading_there_is() {
        for (place, is_clear) in [
            ((1.2, 0.0), false),
            ((1.4, 0.0), true),
            ((-0.2, 0.0), true),
            ((0.5, 0.31), true),
            ((0.5, 0.29), false),
            ((0.0, 0.2), true),
            ((0.1, 0.2), false),
            // What the body touches at its side already does not come closer.
            ((0.001, 0.29), true),
        ] {
            let place = Vec2::new(place.0, place.1);
            let found = Arc::new(1.0, 0.0).is_clear_of_place(&body(0.3), place);
            assert_eq!(found, is_clear, "{place}");
        }
        // A long way meets what is at its end, and a body keeps its distance aside.
        let [ahead, beside] = [Vec2::new(3.2, 0.0), Vec2::new(0.8, 0.35)];
        assert!(!Arc::new(3.0, 0.0).is_clear_of_place(&body(0.3), ahead));
        let keeps = Body { radius_m: 0.3, aside_m: 0.1 };
        assert!(!Arc::new(1.0, 0.0).is_clear_of_place(&keeps, beside));
        // A tight arc of less than a quarter turn leaves its centre behind.
        let centre = Vec2::new(-0.01, 0.15);
        assert!(Arc::new(0.2, 5.0).is_clear_of_place(&body(0.3), centre));
        // More than a quarter turn leads back to what was behind.
        let turn = Arc::new(3.6, 1.0);
        let behind = Vec2::new(-0.6, 1.0);
        assert!(!turn.is_clear_of(&body(0.95), behind, vector::length(behind)));
    }

    #[test]
    fn arcs_end_where_geometry_says() {
        let quarter_m = 0.25 * scalar::PI;
        for (length_m, curvature_per_m, x, y) in [
            (1.0, 0.0, 1.0, 0.0),
            (1.0, 0.005, 1.0, 0.0),
            (quarter_m, 2.0, 0.5, 0.5),
            (quarter_m, -2.0, 0.5, -0.5),
            (10.0, 2.0, 0.0, 1.0),
        ] {
            let end = end_of(length_m, curvature_per_m);
            assert!((end - Vec2::new(x, y)).norm() < 3e-3, "{length_m} {curvature_per_m}: {end:?}");
        }
    }
}
