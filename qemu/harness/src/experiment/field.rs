//! The scattered posts of an experiment.

use math::scalar::wide;
use sim::{Point, Random, Stream, World};

use maps::{Extent, Feature, Role, Shape};

/// Number of posts.
pub const POSTS: usize = 213;
/// Smallest and largest radius, metres.
const RADIUS_M: [f64; 2] = [0.7, 1.5];
/// Least distance between the centres of two posts, metres.
const APART_M: f64 = 9.0;
/// Least room between a post and a place where robots start or go, metres.
const ROOM_M: f64 = 3.0;
/// Least room between a post and a building, metres.
const WALL_ROOM_M: f64 = 1.0;
/// Draws before a field is given up. The fields of the experiment need a few thousand.
const DRAWS: usize = 1_000_000;

/// Draws posts on a map: apart from each other, from its obstacles, from `places`, and from the
/// line along the southern edge where the team starts (`start_y` metres north). Fewer than asked
/// for if the map has no room.
pub fn posts(
    extent: &Extent,
    obstacles: &World,
    places: &[Point],
    start_y: f64,
    count: usize,
    seed: u64,
) -> Vec<Feature> {
    let mut random = Random::new(seed, Stream::Obstacles);
    let mut posts: Vec<(Point, f64)> = Vec::new();
    for _ in 0..DRAWS {
        if posts.len() == count {
            break;
        }
        let at = [0, 1].map(|axis| {
            let low = extent.corner[axis];
            random.between(low, low + extent.size[axis])
        });
        let radius = random.between(RADIUS_M[0], RADIUS_M[1]);
        let far =
            |from: Point, metres: f64| wide::hypot(at[0] - from[0], at[1] - from[1]) >= metres;
        let is_free = at[1] - radius - start_y >= ROOM_M
            && places.iter().all(|&place| far(place, radius + ROOM_M))
            && posts.iter().all(|&(post, _)| far(post, APART_M))
            && obstacles.is_clear(at, radius + WALL_ROOM_M);
        if is_free {
            posts.push((at, radius));
        }
    }
    posts.into_iter().map(|(centre, radius)| feature(centre, radius)).collect()
}

fn feature(centre: Point, radius: f64) -> Feature {
    Feature {
        shape: Shape::Circle { centre, radius },
        role: Role::Obstacle,
        name: "post".to_owned(),
        height_m: None,
        span: 0..0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two walls, a goal and the southern edge keep their room, and a seed gives one field.
    #[test]
    fn posts_keep_apart_from_each_other_and_from_places() {
        let extent = Extent { corner: [0.0, 0.0], size: [250.0, 250.0] };
        let wall = Shape::Polyline(vec![[40.0, 50.0], [66.0, 50.0], [66.0, 120.0]]);
        let world = World::new([&wall]);
        let places = [[76.0, 56.5], [175.0, 245.5]];
        let seeds = (0..40).chain([u64::MAX]);
        for seed in seeds {
            let posts = posts(&extent, &world, &places, 2.0, POSTS, seed);
            assert_eq!(posts.len(), POSTS, "{seed}");
            let discs: Vec<(Point, f64)> = posts
                .iter()
                .map(|post| match post.shape {
                    Shape::Circle { centre, radius } => (centre, radius),
                    _ => panic!("{post:?}"),
                })
                .collect();
            let gap = |a: Point, b: Point| wide::hypot(a[0] - b[0], a[1] - b[1]);
            for (index, &(at, radius)) in discs.iter().enumerate() {
                assert!((0.7..1.5).contains(&radius) && at[1] - radius >= 5.0, "{seed}");
                assert!(
                    places.iter().all(|&place| gap(place, at) >= radius + 3.0),
                    "{seed} {at:?}"
                );
                assert!(world.is_clear(at, radius + WALL_ROOM_M), "{seed}");
                assert!(
                    discs[..index].iter().all(|&(other, _)| gap(other, at) >= APART_M),
                    "{seed}"
                );
            }
        }
    }
}
