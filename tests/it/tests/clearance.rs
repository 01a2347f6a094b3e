//! The campus of the demo keeps routes off walls where there is room, at hardly a longer way.

use maps::raster::{RasterOptions, rasterise};
use maps::{Bitmap, Grid, Role};
use plan_compiler::compile::compile;
use plan_compiler::mission::Band;
use plan_compiler::project::{Project, Request, load};
use plan_compiler::route;
use plan_format::{Blob, Direction};

/// Distance from the robot's centre to walls that keeps its body of 0.4 m a metre off them.
const KEPT_M: f64 = 1.4;
/// Side of the cells in which distances from walls are tested.
const FINE_M: f64 = 0.05;

fn campus() -> Project {
    let mut problems = Vec::new();
    let path = it::root().join("tests/maps/campus.opar");
    let project = load(Request { path, ..Request::default() }, &mut problems).unwrap();
    assert!(!maps::problem::has_errors(&problems), "{problems:?}");
    project
}

/// The cells nearer to a wall than a metre from the body, less two of these cells.
fn near_walls(project: &Project) -> (Grid, Bitmap) {
    let extent = project.map.extent;
    let [columns, rows] = extent.size.map(|size| (size / FINE_M) as u32);
    let grid = Grid { columns, rows, resolution_m: FINE_M, corner_m: extent.corner };
    let options = RasterOptions { robot_radius_m: KEPT_M - 2.0 * FINE_M, fill_walls: false };
    let mut map = project.map.clone();
    map.boundary = None;
    (grid, rasterise(&map, &grid, &|feature| feature.role == Role::Obstacle, &options))
}

/// What the routes to the north gate from all over the campus come to.
#[derive(Debug)]
struct Routes {
    length_m: f64,
    turn_rad: f64,
    /// How many of their points are near walls.
    near: usize,
}

fn routes(project: &Project, (fine, near): &(Grid, Bitmap)) -> Routes {
    let mut problems = Vec::new();
    let blob = compile(&project.input(), &|_, _| (), &mut problems).expect("the campus is built");
    let blob = Blob::parse_exact(&blob).unwrap();
    let parallel = blob.find("north-gate").unwrap();
    let layer = parallel.layer(0).unwrap();
    let is_near = |at: &[f64; 2]| fine.cell_at(at[0], at[1]).is_some_and(|cell| near.get(cell));
    let mut all = Routes { length_m: 0.0, turn_rad: 0.0, near: 0 };
    for step in 0..100u32 {
        let start = [step % 10, step / 10].map(|at| 12.5 + 25.0 * f64::from(at));
        if is_near(&start) {
            continue;
        }
        let route = route::follow(blob.grid(), &parallel, &layer, start).unwrap();
        all.length_m += route.length_m;
        // The start and the goal are where the user wants them.
        let cells = &route.points[1..route.points.len() - 1];
        all.near += cells.iter().filter(|at| is_near(at)).count();
        let headings: Vec<u8> = cells
            .windows(2)
            .map(|two| {
                let step = [0, 1].map(|axis| (two[1][axis] - two[0][axis]).round() as i32);
                let all = Direction::ALL.into_iter();
                let direction = all.clone().find(|d| {
                    let (dx, dy) = d.step();
                    [dx, dy] == step
                });
                direction.expect("one step").code()
            })
            .collect();
        for two in headings.windows(2) {
            let turned = two[0].abs_diff(two[1]);
            all.turn_rad += f64::from(turned.min(8 - turned)) * std::f64::consts::FRAC_PI_4;
        }
    }
    all
}

#[test]
fn the_campus_keeps_a_metre_off_walls_and_turns_less() {
    let shipped = campus();
    let near = near_walls(&shipped);
    let mut tight = campus();
    tight.mission.robot_radius_m = Some(0.0);
    let least = routes(&tight, &near);
    assert!(least.near > 100, "routes of a point: {least:?}");
    tight.mission.robot_radius_m = Some(0.4);
    // A toll around walls does what obstacles that are grown by a metre do, and keeps gates open.
    let mut tolled = tight.clone();
    let mut rule = plan_compiler::mission::LayerRule {
        name: plan_compiler::mission::Named {
            name: "physical".into(),
            place: maps::problem::Place {
                source: std::sync::Arc::new(maps::Source { name: "m".into(), text: String::new() }),
                span: 0..0,
                label: String::new(),
            },
        },
        areas: Vec::new(),
        tolls: Default::default(),
    };
    rule.tolls.clearance.push(Band { within_m: 1.0, eighths: 10 });
    tolled.mission.layers.push(rule);
    for (name, project) in [("shipped", shipped), ("tolled", tolled)] {
        let kept = routes(&project, &near);
        println!("{name}: {kept:?} instead of {least:?}");
        assert_eq!(kept.near, 0, "{name}");
        assert!(kept.length_m <= 1.03 * least.length_m, "{name}: {kept:?} {least:?}");
        assert!(kept.turn_rad < least.turn_rad, "{name}: {kept:?} {least:?}");
    }
}
