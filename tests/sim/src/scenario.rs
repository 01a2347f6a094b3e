//! A scenario: plans, the map that they were compiled from, and the true world.

use crate::geometry::distance;
use crate::{
    Actuators, Body, Channel, Chassis, Conditions, Disc, Faulty, Limits, Outcome, Pilot,
    PilotError, PlannedFault, Point, Random, ReceiverSettings, Robot, SensorSettings, SensorSuite,
    Sensors, Simulation, Stream, Surroundings, World, Worlds,
};
use maps::{Map, Reference, Shape};
use math::{GeoPoint, Vec2};
use plan_format::grid::cost_metres;
use plan_format::{Answer, Blob, Layer, ParallelPlan, Parameters};

/// Where a map lies in the simulator if its file does not place it on the globe: 45 N, 8 E.
pub const LOCAL_ORIGIN: GeoPoint = GeoPoint { lat_e7: 450_000_000, lon_e7: 80_000_000 };

/// Places a map without a reference to the globe at [`LOCAL_ORIGIN`], its south-west corner there
/// and north up, so that a simulated robot can drive on it by GPS. Returns a note for the user;
/// `None` if the map has its own reference. Call it before the map is compiled: the robot takes
/// the origin from its blob.
pub fn place_on_globe(map: &mut Map) -> Option<String> {
    if map.reference.is_some() {
        return None;
    }
    let at = map.extent.corner;
    map.reference = Some(Reference { place: LOCAL_ORIGIN, at, heading_rad: 0.0 });
    let [x, y] = at;
    Some(format!(
        "the map does not say where on the globe it lies; this simulation places its south-west \
         corner ({x:.2}, {y:.2}) at 45 N, 8 E, with north up"
    ))
}

/// The start of a robot's run.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// Position of the body's centre, metres.
    pub position: Point,
    /// Heading, radians counter-clockwise from east.
    pub heading_rad: f64,
    /// Seed for every random draw.
    pub seed: u64,
    /// The sensors and their errors.
    pub sensors: SensorSettings,
}

/// What a robot knows, and the true world.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// The known map, the source of the plans.
    pub map: Map,
    /// The true world. It may have more or fewer obstacles than the map, and the robot perceives it
    /// by its sensors only.
    pub truth: World,
    /// The blob with the robot's plans.
    pub blob: Vec<u8>,
    /// Tanks and fields that the robot's work changes, if there are any.
    pub surroundings: Option<Surroundings>,
    /// Sensors, body, moving discs and faults.
    pub conditions: Conditions,
    /// Shapes of obstacles that are truly there and not on the map, for pictures.
    pub unmapped: Vec<Shape>,
    /// Shapes of obstacles that are on the map and not there, for pictures.
    pub absent: Vec<Shape>,
    /// What the user should know about this simulation, a sentence each.
    pub notes: Vec<String>,
}

impl Scenario {
    /// A scenario in which the world is as in the map. Panics if the blob is damaged.
    pub fn new(map: Map, blob: Vec<u8>, surroundings: Option<Surroundings>) -> Self {
        let scenario = Self {
            truth: World::of_map(&map),
            map,
            blob,
            surroundings,
            conditions: Conditions::default(),
            unmapped: Vec::new(),
            absent: Vec::new(),
            notes: Vec::new(),
        };
        scenario.plan();
        scenario
    }

    /// The same scenario under these conditions.
    #[must_use]
    pub fn under(self, conditions: Conditions) -> Self {
        Self { conditions, ..self }
    }

    /// The same scenario in a world that differs from the map. `worlds.known` must be the map that
    /// the blob was compiled from.
    #[must_use]
    pub fn in_world(self, worlds: Worlds) -> Self {
        let Worlds { known, truth, unmapped, absent } = worlds;
        Self { map: known, truth, unmapped, absent, ..self }
    }

    /// The parsed blob.
    pub fn plan(&self) -> Blob<'_> {
        Blob::parse_exact(&self.blob).expect("the blob is sound")
    }

    /// The parallel plan that the robot follows.
    pub fn parallel_plan(&self) -> ParallelPlan<'_> {
        let plan = self.plan();
        plan.parallel_plan(plan.parameters().plan.into()).expect("a blob has plans")
    }

    /// The layer that the robot follows from a position: the most constrained one with a route
    /// from there; `None` if no layer has one.
    pub fn layer_from(&self, position: Point) -> Option<Layer<'_>> {
        let (plan, parallel) = (self.plan(), self.parallel_plan());
        let mut layers =
            (0..parallel.layer_count()).rev().filter_map(|index| parallel.layer(index));
        layers.find(|layer| route_m(&plan, layer, position).is_some())
    }

    /// Draws a random position that has a route and where the body is clear of obstacles; `None`
    /// if many draws find none.
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

    /// The limits of a run. The robot stops where it believes the goal or the goal's cell to be; its
    /// receiver is almost always less than three sigma off.
    fn limits(&self, start: &Start) -> Limits {
        let sigma_m = start.sensors.gps.map_or(0.0, |gps| gps.sigma_m);
        let plan = self.plan();
        let parameters = plan.parameters();
        let tolerance_m = f64::from(parameters.schemas.goal_tolerance_m);
        let diagonal_m = std::f64::consts::SQRT_2 * plan.grid().resolution_m;
        let usual = Limits::to_goal(self.parallel_plan().goal_m());
        Limits {
            goal_tolerance_m: tolerance_m.max(diagonal_m) + 0.2 + 3.0 * sigma_m,
            ends_at_goal: self.plan().mission().behaviours().is_empty(),
            trapped_after_s: patience_s(&usual, usual_speed_mps(parameters)),
            ..usual
        }
    }

    /// The usual sensors under the scenario's conditions, with the GPS sigma of the surroundings.
    pub fn sensors(&self) -> SensorSettings {
        let usual = SensorSettings::USUAL;
        let sigma_m = self.surroundings.as_ref().and_then(|surroundings| surroundings.gps_sigma);
        let gps = usual
            .gps
            .map(|gps| ReceiverSettings { sigma_m: sigma_m.unwrap_or(gps.sigma_m), ..gps });
        self.conditions.sensors(SensorSettings { gps, ..usual })
    }

    /// A simulation of robots in this scenario's true world, with its moving discs.
    pub fn simulation<S: Sensors, P: Pilot>(
        &self,
        robots: impl IntoIterator<Item = Robot<S, P>>,
    ) -> Simulation<'_, S, P> {
        Simulation::new(&self.truth, robots).with_discs(&self.conditions.discs)
    }

    /// Runs a robot to the end, alone in this scenario.
    pub fn run<S: Sensors, P: Pilot>(&self, robot: Robot<S, P>) -> Result<Outcome, PilotError> {
        let outcomes = self.simulation([robot]).finish()?;
        Ok(outcomes.into_iter().next().expect("one robot has one outcome"))
    }

    /// A robot before its first tick. The error is a message for the user: an obstacle is at the
    /// start, or the map was compiled without a reference to the globe (see [`place_on_globe`]).
    pub fn robot<P: Pilot>(
        &self,
        start: &Start,
        pilot: P,
    ) -> Result<Robot<Box<dyn Sensors>, P>, String> {
        let reference = self.map.reference.as_ref();
        let reference = reference.ok_or(
            "the map does not say where on the globe it lies, but the robot drives by GPS",
        )?;
        let chassis = self.conditions.chassis(Chassis::of(&self.plan().parameters().vehicle));
        if !self.truth.is_clear(start.position, chassis.radius_m) {
            let nearest = near_clear(&self.truth, start.position, chassis.radius_m);
            let elsewhere = nearest.map_or_else(
                || "choose another start: --start X,Y".to_owned(),
                |at| format!("a clear position nearby: --start {:.2},{:.2}", at[0], at[1]),
            );
            let [x, y] = start.position;
            return Err(format!(
                "the start ({x:.2}, {y:.2}) is too close to an obstacle; {elsewhere}"
            ));
        }
        let discs = self.conditions.discs.iter();
        let gap_m = |disc: &Disc| distance(disc.at(0.0), start.position) - disc.radius_m;
        if let Some(disc) = discs.clone().find(|disc| gap_m(disc) < chassis.radius_m) {
            let ([x, y], [at_x, at_y]) = (start.position, disc.at(0.0));
            return Err(format!(
                "the start ({x:.2}, {y:.2}) is inside a disc, which starts at ({at_x:.2}, \
                 {at_y:.2}); choose another start: --start X,Y, or another `path` or `start` of the \
                 disc"
            ));
        }
        let mut sensors: Box<dyn Sensors> =
            Box::new(SensorSuite::new(start.sensors, reference, start.seed));
        let mut actuators = Vec::new();
        for (planned, number) in self.conditions.faults.iter().zip(0_u64..) {
            let PlannedFault { channel, fault, window_s } = planned.clone();
            // Each fault has its own draws.
            let seed = start.seed.wrapping_add(number << 32);
            match channel {
                Channel::Actuators => actuators.push(Actuators::new(fault, window_s, seed)),
                _ => sensors = Box::new(Faulty::new(sensors, fault, channel, window_s, seed)),
            }
        }
        let body = Body::new(chassis, start.position, start.heading_rad);
        let parallel = self.parallel_plan();
        let several = parallel.goals_m().filter(|_| parallel.has_several_goals());
        let robot = Robot::new(body, sensors, pilot, self.limits(start))
            .with_goals(several)
            .with_actuators(actuators);
        Ok(match &self.surroundings {
            Some(surroundings) => robot.within(surroundings.clone()),
            None => robot,
        })
    }
}

/// The speed of a robot that nothing slows down, m/s.
fn usual_speed_mps(parameters: &Parameters) -> f64 {
    let vehicle = &parameters.vehicle;
    vehicle.max_speed_mps.min(vehicle.base_speed_mps).into()
}

/// Time after which a robot of this speed counts as trapped, seconds: as `progress.after`, at least
/// twice the time that it needs to leave the area.
fn patience_s(limits: &Limits, speed_mps: f64) -> f64 {
    let needed_s = 2.0 * limits.trapped_within_m / speed_mps;
    if needed_s.is_finite() { limits.trapped_after_s.max(needed_s) } else { limits.trapped_after_s }
}

/// A position near `from` where a body is clear of obstacles, searched on growing rings.
fn near_clear(world: &World, from: Point, radius_m: f64) -> Option<Point> {
    const RINGS: u32 = 200;
    const RING_M: f64 = 0.25;
    let steps = [-1.0, 0.0, 1.0];
    let directions = steps.iter().flat_map(|x| steps.iter().map(move |y| [*x, *y]));
    (1..=RINGS).find_map(|ring| {
        let reach_m = f64::from(ring) * RING_M;
        let mut positions =
            directions.clone().map(|step| [0, 1].map(|axis| from[axis] + reach_m * step[axis]));
        positions.find(|&position| world.is_clear(position, radius_m))
    })
}

/// Length of a layer's route from a position to the goal, metres; `None` if there is none.
pub fn route_m(blob: &Blob<'_>, layer: &Layer<'_>, from: Point) -> Option<f64> {
    let cell = blob.cell_at(Vec2::new(from[0] as f32, from[1] as f32))?;
    match layer.look_up(cell) {
        Answer::Move { cost, .. } => Some(cost_metres(cost, blob.grid().resolution_m)),
        Answer::Goal => Some(0.0),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slow_robot_has_time_to_leave_the_area_in_which_it_counts_as_trapped() {
        let limits = Limits::to_goal([0.0, 0.0]);
        for (speed_mps, patience) in [(1.0, 60.0), (0.1, 100.0), (0.05, 200.0), (0.0, 60.0)] {
            assert_eq!(patience_s(&limits, speed_mps), patience, "{speed_mps}");
        }
    }
}
