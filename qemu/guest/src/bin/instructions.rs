//! Counts the instructions of using the blob in its region. Prints one name and number per line.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    counts::print();
    semihosting::process::exit(0)
}

#[cfg(not(target_os = "none"))]
fn main() {
    guest::explain();
}

#[cfg(target_os = "none")]
mod counts {
    use controller::State;
    use core::hint::black_box;
    use guest::counter::Counter;
    use math::Vec2;
    use plan_format::{Answer, Blob, Layer, ParallelPlan};
    use robot_io::{Commands, Fix, Operator, Percepts, RangeReading, Reason, Receiver};
    use semihosting::println;

    /// Sampled positions along each axis of the map.
    const SAMPLES: u32 = 25;
    /// Counted ticks.
    const TICKS: u64 = 200;
    /// Counted ticks with behaviours, enough for many combinations of events.
    const BEHAVING_TICKS: u64 = 2_000;
    /// Obstacles in each counted tick, all near enough to repel.
    const OBSTACLES: usize = 8;
    /// Time between two ticks, microseconds.
    const PERIOD_US: u64 = runtime::TICK_PERIOD_US;

    pub(crate) fn print() {
        let counter = Counter::start();
        // No count includes the cost of the measurement itself.
        let mark = counter.mark();
        let overhead = counter.since(mark);
        let count = |mark| counter.since(mark) - overhead;

        let mark = counter.mark();
        let parsed = Blob::parse(black_box(runtime::plan_region()));
        let validation = count(mark);
        let blob = parsed.expect("the harness loads a valid blob");
        let parallel = chosen(&blob);
        let layer = parallel.layer(parallel.layer_count() - 1).expect("plans have layers");

        println!("blob-validation {validation}");
        println!("look-up-worst {}", worst_look_up(&blob, &layer, counter, overhead));
        let start = start(&blob, &parallel);
        let count = |ticks, change| worst_tick(&blob, start, ticks, change, (counter, overhead));
        println!("tick-8-obstacles-worst {}", count(TICKS, sparse).0);
        println!("tick-crowded-worst {}", count(TICKS, crowded).0);
        println!("tick-stack-bytes {}", tick_stack(&blob, start, 0));
        println!("control-state-bytes {}", size_of::<State>());
        println!("plan-view-bytes {}", size_of::<Blob<'_>>());
        if !blob.mission().behaviours().is_empty() {
            let (worst, tick) = count(BEHAVING_TICKS, sparse);
            println!("behaviours-tick-worst {worst}");
            println!("behaviours-tick-crowded-worst {}", count(BEHAVING_TICKS, crowded).0);
            println!("behaviours-tick-stack-bytes {}", tick_stack(&blob, start, tick));
        }
    }

    fn chosen(blob: &Blob<'static>) -> ParallelPlan<'static> {
        blob.parallel_plan(blob.parameters().plan.into()).expect("the blob has plans")
    }

    /// Most instructions from a position to an answer, sampled over the map.
    fn worst_look_up(blob: &Blob<'_>, layer: &Layer<'_>, counter: Counter, overhead: u32) -> u32 {
        let mut worst = 0;
        for step in 0..SAMPLES * SAMPLES {
            let point = black_box(sample(blob, step));
            let mark = counter.mark();
            let answer = look_up(blob, layer, point);
            worst = worst.max(counter.since(mark) - overhead);
            black_box(answer);
        }
        worst
    }

    #[inline(never)]
    fn look_up(blob: &Blob<'_>, layer: &Layer<'_>, point: Vec2) -> Answer {
        blob.cell_at(point).map_or(Answer::OffMap, |cell| layer.look_up(cell))
    }

    /// A point of a regular grid over the map.
    fn sample(blob: &Blob<'_>, step: u32) -> Vec2 {
        let grid = blob.grid();
        let at = |corner: f64, cells: u32, index: u32| {
            let share = (f64::from(index) + 0.5) / f64::from(SAMPLES);
            (corner + f64::from(cells) * grid.resolution_m * share) as f32
        };
        Vec2::new(
            at(grid.corner_m[0], grid.columns, step % SAMPLES),
            at(grid.corner_m[1], grid.rows, step / SAMPLES),
        )
    }

    /// Stack of a whole tick after `ticks` others, bytes.
    #[inline(never)]
    fn tick_stack(blob: &Blob<'_>, start: Vec2, ticks: u64) -> usize {
        let mut state = State::new(blob);
        for tick in 0..ticks {
            controller::tick(blob, &mut state, &percepts(blob, start, tick));
        }
        let percepts = percepts(blob, start, ticks);
        guest::memory::stack_bytes_of(|| {
            black_box(controller::tick(black_box(blob), &mut state, black_box(&percepts)));
        })
    }

    /// A position with a route, away from the goal.
    fn start(blob: &Blob<'_>, parallel: &ParallelPlan<'_>) -> Vec2 {
        let layer = parallel.layer(0).expect("plans have layers");
        (0..SAMPLES * SAMPLES)
            .map(|step| sample(blob, step))
            .find(|&point| {
                // The robot drives around the point.
                let mut around = (0..8).map(|step| on_circle(point, step as f32 * 0.8).0);
                around.all(|at| is_far_from_goal(blob, &layer, at))
            })
            .expect("some sample has a route")
    }

    /// Most instructions of a whole tick while driving with a new fix and the percepts that `change`
    /// makes, and the number of that tick.
    #[inline(never)]
    fn worst_tick(
        blob: &Blob<'_>,
        start: Vec2,
        ticks: u64,
        change: fn(Percepts, u64) -> Percepts,
        (counter, overhead): (Counter, u32),
    ) -> (u32, u64) {
        let mut state = State::new(blob);
        let mut worst = (0, 0);
        for tick in 0..ticks {
            let percepts = change(percepts(blob, start, tick), tick);
            let mark = counter.mark();
            let commands = controller::tick(black_box(blob), &mut state, black_box(&percepts));
            let instructions = counter.since(mark) - overhead;
            assert_whole(&commands);
            if instructions > worst.0 {
                worst = (instructions, tick);
            }
        }
        worst
    }

    /// The percepts as they are.
    fn sparse(percepts: Percepts, _tick: u64) -> Percepts {
        percepts
    }

    /// Panics if the tick ended before schemas, detour and brakes.
    fn assert_whole(commands: &Commands) {
        let is_whole =
            matches!(commands.reason, Reason::Driving | Reason::Escaping | Reason::ObstacleStop);
        assert!(is_whole, "a counted tick is a whole tick: {:?}", commands.reason);
    }

    /// The percepts with an obstacle near the body in every sector, which breathe in and out.
    fn crowded(percepts: Percepts, tick: u64) -> Percepts {
        let gap_m = 0.02 + 0.6 * wave(tick, 41);
        let ranges = (0..16).map(|sector| RangeReading {
            bearing_rad: math::scalar::wrap_angle(sector as f32 * (math::scalar::TAU / 16.0)),
            distance_m: 0.4 + gap_m + 0.3 * wave(tick * 7 + sector * 5, 13),
        });
        Percepts { ranges: ranges.collect(), ..percepts }
    }

    fn is_far_from_goal(blob: &Blob<'_>, layer: &Layer<'_>, point: Vec2) -> bool {
        let goal = blob.goal().expect("the blob has plans");
        (point - goal).norm_squared() > 100.0
            && matches!(look_up(blob, layer, point), Answer::Move { .. })
    }

    /// A triangle wave between 0 and 1 with a period of `2 * period` ticks.
    fn wave(tick: u64, period: u64) -> f32 {
        let phase = tick % (2 * period);
        phase.min(2 * period - phase) as f32 / period as f32
    }

    /// Position and heading on a circle of 1 m around a point.
    fn on_circle(centre: Vec2, angle_rad: f32) -> (Vec2, f32) {
        let heading_rad = math::scalar::wrap_angle(angle_rad + core::f32::consts::FRAC_PI_2);
        (centre + math::vector::from_angle(angle_rad), heading_rad)
    }

    /// Consistent percepts of a robot that drives in a circle at 1 m/s: a tick in which the robot
    /// doubts a sensor would end early.
    fn percepts(blob: &Blob<'_>, centre: Vec2, tick: u64) -> Percepts {
        let frame = blob.map_frame().expect("the blob is on the globe");
        let time_us = (tick + 1) * PERIOD_US;
        // A different angle in each tick, over several turns.
        let turn_rad = tick as f32 * 0.05;
        let (at, heading_rad) = on_circle(centre, turn_rad);
        let velocity = math::vector::from_angle(heading_rad) * 1e3;
        Percepts {
            time_us,
            fix: Some(Fix {
                time_us,
                is_valid: true,
                place: frame.to_geodetic(at),
                accuracy_mm: 100,
                velocity_mmps: Some([velocity.x as i32, velocity.y as i32]),
                receiver_ms: Some((tick * 50) as u32),
            }),
            receiver: Receiver::Sound,
            heading_rad: Some(heading_rad),
            speed_mps: Some(1.0),
            turn_rate_radps: Some(1.0),
            ranges: (0..OBSTACLES)
                .map(|index| RangeReading {
                    bearing_rad: math::scalar::wrap_angle(index as f32 * 0.7 + turn_rad),
                    distance_m: 2.0 + index as f32 * 0.1,
                })
                .collect(),
            inputs: [5_u64, 7, 11, 13, 17, 19, 23, 29].map(|period| Some(wave(tick, period))),
            operator: Operator { is_armed: true, ..Operator::default() },
            scan_us: Some(time_us),
            ..Percepts::default()
        }
    }
}
