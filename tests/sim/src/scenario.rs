//! A scenario: plans, the map that they were compiled from, and the world as it truly is.

use crate::{
    Body, Chassis, Limits, Pilot, Point, Random, ReceiverSettings, Robot, SensorSettings,
    SensorSuite, Stream, Surroundings, World,
};
use maps::Map;
use math::Vec2;
use plan_format::grid::cost_metres;
use plan_format::{Answer, Blob, Layer, ParallelPlan};

/// How a robot's run begins.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// Position of the body's centre, metres.
    pub position: Point,
    /// Radians counter-clockwise from east.
    pub heading_rad: f64,
    /// Seed for every random draw.
    pub seed: u64,
    /// How good the sensors are.
    pub sensors: SensorSettings,
}

/// What a robot knows, and what is there.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// The known map: what the plans were compiled from.
    pub map: Map,
    /// The true world, which may hold more or less than the map. The robot perceives it by its
    /// sensors only.
    pub truth: World,
    /// The plans, as a robot gets them.
    pub blob: Vec<u8>,
    /// What the robot's work changes, where there is any.
    pub surroundings: Option<Surroundings>,
}

impl Scenario {
    /// A scenario in which the map is true. Panics where the blob is damaged.
    pub fn new(map: Map, blob: Vec<u8>, surroundings: Option<Surroundings>) -> Self {
        let scenario = Self { truth: World::of_map(&map), map, blob, surroundings };
        scenario.plan();
        scenario
    }

    /// The plans as a robot sees them.
    pub fn plan(&self) -> Blob<'_> {
        Blob::parse_exact(&self.blob).expect("the blob is whole")
    }

    /// The parallel plan that the robot follows.
    pub fn parallel_plan(&self) -> ParallelPlan<'_> {
        let plan = self.plan();
        plan.parallel_plan(plan.parameters().plan.into()).expect("a blob has plans")
    }

    /// The layer that the robot follows from a place: the most constrained one that has a
    /// route from there; `None` where none has.
    pub fn layer_from(&self, place: Point) -> Option<Layer<'_>> {
        let (plan, parallel) = (self.plan(), self.parallel_plan());
        let mut layers =
            (0..parallel.layer_count()).rev().filter_map(|index| parallel.layer(index));
        layers.find(|layer| way_m(&plan, layer, place).is_some())
    }

    /// A place with a route where the body is clear of obstacles, drawn by chance; `None`
    /// where many draws find none.
    pub fn draw_start(&self, seed: u64) -> Option<Point> {
        const DRAWS: usize = 100_000;
        let (plan, mut random) = (self.plan(), Random::new(seed, Stream::Start));
        let grid = plan.grid();
        let mut draw = |axis: usize, cells: u32| {
            let low = grid.corner_m[axis];
            random.between(low, low + f64::from(cells) * grid.resolution_m)
        };
        let radius_m = plan.parameters().vehicle.radius_m.into();
        (0..DRAWS)
            .map(|_| [draw(0, grid.columns), draw(1, grid.rows)])
            .find(|&point| self.layer_from(point).is_some() && self.truth.is_clear(point, radius_m))
    }

    /// When a run ends: it has arrived where the robot believes the goal to be, which its
    /// receiver puts up to three sigma off in almost all cases.
    fn limits(&self, start: &Start) -> Limits {
        let sigma_m = start.sensors.gps.map_or(0.0, |gps| gps.sigma_m);
        let tolerance_m = f64::from(self.plan().parameters().schemas.goal_tolerance_m);
        Limits {
            goal_tolerance_m: tolerance_m + 0.2 + 3.0 * sigma_m,
            ends_at_goal: self.plan().mission().behaviours().is_empty(),
            ..Limits::to_goal(self.parallel_plan().goal_m())
        }
    }

    /// The usual sensors, with the receiver that the surroundings name.
    pub fn sensors(&self) -> SensorSettings {
        let usual = SensorSettings::USUAL;
        let sigma_m = self.surroundings.as_ref().and_then(|surroundings| surroundings.gps_sigma);
        let gps = usual
            .gps
            .map(|gps| ReceiverSettings { sigma_m: sigma_m.unwrap_or(gps.sigma_m), ..gps });
        SensorSettings { gps, ..usual }
    }

    /// A robot before its first tick; the error says why it cannot start.
    pub fn robot<P: Pilot>(
        &self,
        start: &Start,
        pilot: P,
    ) -> Result<Robot<SensorSuite, P>, String> {
        let reference = self.map.reference.as_ref();
        let reference = reference.ok_or(
            "the map does not say where on the globe it lies, and the robot drives by GPS; give \
             it a reference: GLOBAL_REF_POINT LAT LON in an overlay",
        )?;
        let vehicle = self.plan().parameters().vehicle;
        let chassis = Chassis { radius_m: vehicle.radius_m.into(), ..Chassis::default() };
        if !self.truth.is_clear(start.position, chassis.radius_m) {
            let nearest = near_clear(&self.truth, start.position, chassis.radius_m);
            let elsewhere = nearest.map_or_else(
                || "start elsewhere: --start X,Y".to_owned(),
                |at| format!("a clear place near it: --start {:.2},{:.2}", at[0], at[1]),
            );
            let [x, y] = start.position;
            return Err(format!(
                "at the start ({x:.2}, {y:.2}) the body stands in an obstacle; {elsewhere}"
            ));
        }
        let sensors = SensorSuite::new(start.sensors, reference, start.seed);
        let body = Body::new(chassis, start.position, start.heading_rad);
        let robot = Robot::new(body, sensors, pilot, self.limits(start));
        Ok(match &self.surroundings {
            Some(surroundings) => robot.within(surroundings.clone()),
            None => robot,
        })
    }
}

/// A place near another one where a body is clear of obstacles, of those on rings about it.
fn near_clear(world: &World, about: Point, radius_m: f64) -> Option<Point> {
    const RINGS: u32 = 200;
    const RING_M: f64 = 0.25;
    let steps = [-1.0, 0.0, 1.0];
    let directions = steps.iter().flat_map(|x| steps.iter().map(move |y| [*x, *y]));
    (1..=RINGS).find_map(|ring| {
        let reach_m = f64::from(ring) * RING_M;
        let mut places =
            directions.clone().map(|step| [0, 1].map(|axis| about[axis] + reach_m * step[axis]));
        places.find(|&place| world.is_clear(place, radius_m))
    })
}

/// Length of a layer's route from a place to the goal, metres; `None` where there is none.
pub fn way_m(blob: &Blob<'_>, layer: &Layer<'_>, from: Point) -> Option<f64> {
    let cell = blob.cell_at(Vec2::new(from[0] as f32, from[1] as f32))?;
    match layer.look_up(cell) {
        Answer::Move { cost, .. } => Some(cost_metres(cost, blob.grid().resolution_m)),
        Answer::Goal => Some(0.0),
        _ => None,
    }
}
