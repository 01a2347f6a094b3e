//! The courses of the benchmark: worlds of the BARN challenge, and seeded ones.

use std::f64::consts::{FRAC_PI_2, PI};
use std::path::Path;

use maps::formats::{self, ReadOptions};
use maps::{Extent, Feature, Map, Role, Shape};
use serde::{Deserialize, Serialize};
use sim::{Point, Random, Stream, World};

use crate::setup::root;

/// A kind of course.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Suite {
    /// Fields of posts: the worlds of the challenge, or seeded ones of the same kind.
    Barn,
    /// A wall with a door.
    Doors,
    /// A corridor with two bends.
    Corridors,
    /// A court whose opening is behind the robot.
    Courtyards,
    /// Houses at random places.
    City,
    /// The campus of the tests.
    Campus,
}

/// A map with a start and a goal, and the robot's measured numbers.
#[derive(Clone, Debug)]
pub struct Course {
    /// The suite.
    pub suite: Suite,
    /// Its name in tables and pictures.
    pub name: String,
    /// The map of what is truly there.
    pub map: Map,
    /// Start, metres.
    pub start: Point,
    /// Heading at the start, radians.
    pub heading_rad: f64,
    /// Goal, metres.
    pub goal: Point,
    /// Time of the shortest path, seconds, if the course states it.
    pub optimal_s: Option<f64>,
    /// Radius of the body, metres.
    pub radius_m: f64,
    /// Top speed, m/s.
    pub max_speed_mps: f64,
    /// Side of a cell, metres.
    pub resolution_m: f64,
    /// Seed of its sensors, of unmapped obstacles and of discs.
    pub seed: u64,
}

impl Course {
    /// Time limit of a run, seconds.
    pub fn time_limit_s(&self) -> f64 {
        if self.suite == Suite::Campus { 600.0 } else { 120.0 }
    }
}

impl Suite {
    /// All suites, in the order of the table.
    pub const ALL: [Self; 6] =
        [Self::Barn, Self::Doors, Self::Corridors, Self::Courtyards, Self::City, Self::Campus];

    /// Its name on the command line and in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Barn => "barn",
            Self::Doors => "doors",
            Self::Corridors => "corridors",
            Self::Courtyards => "courtyards",
            Self::City => "city",
            Self::Campus => "campus",
        }
    }

    /// The suite of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|suite| suite.name() == name)
    }

    pub(super) fn courses(
        self,
        barn: Option<&Path>,
        count: usize,
        seed: u64,
    ) -> Result<Vec<Course>, String> {
        let seeds = (0..count as u64).map(|number| seed.wrapping_add(number));
        match (self, barn) {
            (Self::Barn, Some(folder)) => challenge(folder),
            (Self::Barn, None) => Ok(seeds.map(posts).collect()),
            (Self::Doors, _) => Ok(doors(seed)),
            (Self::Corridors, _) => Ok(corridors(seed)),
            (Self::Courtyards, _) => Ok(seeds.map(courtyard).collect()),
            (Self::City, _) => Ok(seeds.map(city).collect()),
            (Self::Campus, _) => campus(count.min(20), seed),
        }
    }
}

/// The worlds of the challenge with their times.
fn challenge(folder: &Path) -> Result<Vec<Course>, String> {
    let times = folder.join("optimal_times.tsv");
    let text =
        std::fs::read_to_string(&times).map_err(|error| format!("{}: {error}", times.display()))?;
    let lines = text.lines().skip(1).filter(|line| !line.trim().is_empty());
    let course = |line: &str| {
        let parsed = line.split_once('\t').and_then(|(number, time)| {
            Some((number.trim().parse::<u64>().ok()?, time.trim().parse::<f64>().ok()?))
        });
        let (number, optimal_s) = parsed
            .ok_or_else(|| format!("{}: `{line}` is not NUMBER<tab>SECONDS", times.display()))?;
        let path = folder.join(format!("world_{number}.ovl"));
        let map = formats::read(&path, &ReadOptions::default()).0;
        let map = map.ok_or_else(|| format!("{}: not a readable map", path.display()))?;
        Ok(Course {
            optimal_s: Some(optimal_s),
            ..field(format!("world_{number}"), map, number.wrapping_add(1))
        })
    };
    lines.map(course).collect()
}

/// A course of the challenge's kind: 10 m north through a field.
fn field(name: String, map: Map, seed: u64) -> Course {
    Course {
        suite: Suite::Barn,
        name,
        map,
        start: [3.75, 4.0],
        heading_rad: FRAC_PI_2,
        goal: [3.75, 14.0],
        optimal_s: None,
        radius_m: 0.25,
        max_speed_mps: 2.0,
        resolution_m: 0.05,
        seed,
    }
}

/// A field of posts, 4.5 m wide, that grows by a cellular automaton from random cells. The first
/// seed of several that leaves a way is taken.
fn posts(seed: u64) -> Course {
    const COLUMNS: usize = 30;
    const ROWS: usize = 66;
    const SIDE_M: f64 = 0.15;
    let corner = [1.5, 1.0];
    for attempt in 0_u64.. {
        let mut random = Random::new(seed.wrapping_add(attempt << 32), Stream::Obstacles);
        let share = random.between(0.15, 0.3);
        let mut cells = vec![vec![false; COLUMNS]; ROWS];
        cells.iter_mut().flatten().for_each(|cell| *cell = random.chance(share));
        for _ in 0..4 {
            let before = cells.clone();
            let around = |row: usize, column: usize| {
                let rows = row.saturating_sub(1)..=(row + 1).min(ROWS - 1);
                let columns = column.saturating_sub(1)..=(column + 1).min(COLUMNS - 1);
                let near = rows.flat_map(|r| columns.clone().map(move |c| (r, c)));
                near.filter(|&(r, c)| (r, c) != (row, column) && before[r][c]).count()
            };
            for (row, line) in cells.iter_mut().enumerate() {
                for (column, cell) in line.iter_mut().enumerate() {
                    *cell = match around(row, column) {
                        0 | 1 => false,
                        2..=4 => before[row][column],
                        _ => true,
                    };
                }
            }
        }
        let mut shapes = Vec::new();
        let mut post = |x: f64, y: f64| {
            shapes.push(Shape::Circle { centre: [x, y], radius: SIDE_M / 2.0 });
        };
        // The walls to both sides and behind the start.
        for step in 0..90 {
            let y = corner[1] + f64::from(step) * SIDE_M;
            post(corner[0] - SIDE_M / 2.0, y);
            post(corner[0] + 4.5 + SIDE_M / 2.0, y);
        }
        (0..30).for_each(|step| post(corner[0] + f64::from(step) * SIDE_M, corner[1]));
        for (row, line) in cells.iter().enumerate() {
            for (column, _) in line.iter().enumerate().filter(|(_, is_post)| **is_post) {
                let x = corner[0] + (column as f64 + 0.5) * SIDE_M;
                post(x, 4.6 + (row as f64 + 0.5) * SIDE_M * 0.13 * 66.0 / 8.6);
            }
        }
        let map = map([0.0, 0.0], [7.5, 15.5], shapes);
        let course = field(format!("posts {seed}"), map, seed);
        if is_passable(&course) {
            return course;
        }
    }
    unreachable!("an attempt with few posts leaves a way")
}

/// Whether the robot's plan has a route over this course.
fn is_passable(course: &Course) -> bool {
    let Course { goal: [x, y], radius_m, resolution_m, .. } = course;
    let mission = format!(
        "resolution = {resolution_m}\nrobot_radius = {}\n[goals]\ngoal = [{x}, {y}]\n",
        radius_m + 0.05
    );
    let scenario = crate::mission::of_map(&course.map, &mission, &Default::default(), 0);
    scenario.is_ok_and(|scenario| scenario.layer_from(course.start).is_some())
}

/// Doors from 0.2 m wider than the body to 2 m wider, each from ten starts on either side.
fn doors(seed: u64) -> Vec<Course> {
    let widths = [0.8, 0.9, 1.0, 1.2, 1.5, 2.6];
    let mut random = Random::new(seed, Stream::Start);
    let mut course = |width_m: f64, number: u64| {
        let wall = |from: f64, to: f64| {
            Shape::Polygon(vec![vec![[-0.1, from], [0.1, from], [0.1, to], [-0.1, to]]])
        };
        let shapes = vec![wall(-9.9, -width_m / 2.0), wall(width_m / 2.0, 9.9)];
        let side = if number.is_multiple_of(2) { -1.0 } else { 1.0 };
        let start = [side * random.between(1.5, 9.0), random.between(-8.0, 8.0)];
        rover(
            Suite::Doors,
            format!("door {width_m:.1} m, start {number}"),
            map([-10.0, -10.0], [20.0, 20.0], shapes),
            (start, random.between(-PI, PI)),
            [-side * 8.0, random.between(-8.0, 8.0)],
            seed.wrapping_add(number),
        )
    };
    widths
        .iter()
        .flat_map(|&width| (0..20).map(move |number| (width, number)))
        .map(|(width, number)| course(width, number))
        .collect()
}

/// Corridors with two right-angled bends, from 0.2 m wider than the body on.
fn corridors(seed: u64) -> Vec<Course> {
    let widths = [0.8, 0.9, 1.0, 1.2, 1.5, 2.0];
    let course = |(width_m, number): (f64, u64)| {
        let half = width_m / 2.0;
        // Two parallel lines at half the width about a way of three straight parts.
        let left =
            vec![[-2.0, half], [6.0 - half, half], [6.0 - half, 6.0 + half], [14.0, 6.0 + half]];
        let right =
            vec![[-2.0, -half], [6.0 + half, -half], [6.0 + half, 6.0 - half], [14.0, 6.0 - half]];
        let shapes = vec![Shape::Polyline(left), Shape::Polyline(right)];
        let map = map([-3.0, -3.0], [18.0, 12.0], shapes);
        let (start, goal) = ([-1.0, 0.0], [13.0, 6.0]);
        let (start, goal, heading_rad) =
            if number.is_multiple_of(2) { (start, goal, 0.0) } else { (goal, start, PI) };
        let name = format!(
            "corridor {width_m:.1} m, {}",
            if number.is_multiple_of(2) { "there" } else { "back" }
        );
        rover(Suite::Corridors, name, map, (start, heading_rad), goal, seed.wrapping_add(number))
    };
    widths.into_iter().flat_map(|width| [(width, 0), (width, 1)]).map(course).collect()
}

/// A court of three walls between the robot, inside, and the goal behind the far wall.
fn courtyard(seed: u64) -> Course {
    let mut random = Random::new(seed, Stream::Obstacles);
    let (depth_m, width_m) = (random.between(3.0, 10.0), random.between(2.0, 8.0));
    let half = width_m / 2.0;
    let walls = vec![[-depth_m, half], [0.0, half], [0.0, -half], [-depth_m, -half]];
    let map = map([-14.0, -8.0], [22.0, 16.0], vec![Shape::Polyline(walls)]);
    let start = [-random.between(0.8, depth_m - 0.5), random.between(-half + 0.6, half - 0.6)];
    let goal = [random.between(2.0, 6.0), random.between(-5.0, 5.0)];
    rover(Suite::Courtyards, format!("court {seed}"), map, (start, 0.0), goal, seed)
}

/// Forty houses on 40 m x 40 m, with start and goal in opposite corners.
fn city(seed: u64) -> Course {
    let mut random = Random::new(seed, Stream::Obstacles);
    let (start, goal) = ([2.0, 2.0], [38.0, 38.0]);
    let mut shapes = Vec::new();
    while shapes.len() < 40 {
        let [width, height] = [0, 1].map(|_| random.between(1.0, 5.0));
        let [x, y] = [random.between(0.0, 40.0 - width), random.between(0.0, 40.0 - height)];
        let rectangle = vec![[x, y], [x + width, y], [x + width, y + height], [x, y + height]];
        let shape = Shape::Polygon(vec![rectangle]);
        let world = World::new([&shape]);
        if world.is_clear(start, 1.0) && world.is_clear(goal, 1.0) {
            shapes.push(shape);
        }
    }
    let map = map([0.0, 0.0], [40.0, 40.0], shapes);
    let course =
        rover(Suite::City, format!("city {seed}"), map, (start, FRAC_PI_2 / 2.0), goal, seed);
    Course { resolution_m: 0.2, ..course }
}

/// The campus of the tests, from random starts to its north gate.
fn campus(count: usize, seed: u64) -> Result<Vec<Course>, String> {
    let path = root().join("tests/maps/campus.opar");
    let map = formats::read(&path, &ReadOptions::default()).0;
    let map = map.ok_or_else(|| format!("{}: not a readable map", path.display()))?;
    let goal = [125.5, 240.5];
    let mission = format!("resolution = 1.0\n[goals]\ngoal = [{}, {}]\n", goal[0], goal[1]);
    let scenario = crate::mission::of_map(&map, &mission, &Default::default(), 0)?;
    let course = |number: u64| {
        let seed = seed.wrapping_add(number);
        let start = scenario.draw_start(seed).ok_or("the campus has no free start")?;
        let name = format!("campus {seed}");
        let course = rover(Suite::Campus, name, map.clone(), (start, 0.0), goal, seed);
        Ok(Course { resolution_m: 1.0, max_speed_mps: 1.6, ..course })
    };
    (0..count as u64).map(course).collect()
}

/// A course of a rover with a radius of 0.3 m and a top speed of 1.6 m/s on cells of 0.1 m.
fn rover(
    suite: Suite,
    name: String,
    map: Map,
    (start, heading_rad): (Point, f64),
    goal: Point,
    seed: u64,
) -> Course {
    Course {
        suite,
        name,
        map,
        start,
        heading_rad,
        goal,
        optimal_s: None,
        radius_m: 0.3,
        max_speed_mps: 1.6,
        resolution_m: 0.1,
        seed,
    }
}

/// A map of obstacles: its south-west corner and its size, metres.
pub fn map(corner: Point, size: Point, shapes: Vec<Shape>) -> Map {
    let feature = |shape| Feature {
        shape,
        role: Role::Obstacle,
        name: String::new(),
        height_m: None,
        span: 0..0,
    };
    Map {
        features: shapes.into_iter().map(feature).collect(),
        ..Map::empty(Extent { corner, size })
    }
}
