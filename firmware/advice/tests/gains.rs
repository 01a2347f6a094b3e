//! W26, W28: layers selected by the gains of their constraints, on fields that the compiler solved.

use advice::{Choice, Kind, advise, advise_by_gains};
use maps::bitmap::Bitmap;
use plan_compiler::pack::pack;
use plan_compiler::search::{Corners, Query, solve};
use plan_compiler::terrain::Terrain;
use plan_format::limits::MAX_LAYERS;
use plan_format::mission::MissionDraft;
use plan_format::parameters::{LayerGain, LayerGains, Selection};
use plan_format::{
    Answer, Blob, Cell, Draft, Grid, LayerDraft, ParallelPlan, Parameters, PlanDraft, write,
};
use proptest::prelude::*;

const SIDE: u32 = 24;
const GOAL: Cell = Cell::new(SIDE - 1, SIDE - 1);

/// A plan of two layers; the second one has the cells `wall` as obstacles too, and rank 3.
fn with_plan<T>(wall: &[Cell], test: impl FnOnce(&ParallelPlan<'_>) -> T) -> T {
    let layer = |(name, rank, wall): (&str, u8, &[Cell])| {
        let terrain = Terrain::new(Bitmap::from_fn(SIDE, SIDE, |cell| wall.contains(&cell)));
        let query = Query { terrain: &terrain, goals: &[GOAL], corners: Corners::Forbid };
        LayerDraft { name: name.into(), rank, packed: pack(&solve(&query)) }
    };
    let grid = Grid { columns: SIDE, rows: SIDE, resolution_m: 1.0, corner_m: [0.0; 2] };
    let plan = PlanDraft {
        name: "gate".into(),
        goals_m: vec![grid.centre(GOAL)],
        layers: [("physical", 0, &[][..]), ("comms", 3, wall)].into_iter().map(layer).collect(),
    };
    let (parameters, mission) = (Parameters::default(), MissionDraft::default());
    let draft = Draft { grid, origin: None, parameters, plans: vec![plan], mission };
    let bytes = write(&draft).expect("the draft is in order");
    let blob = Blob::parse_exact(&bytes).expect("what was written is read");
    test(&blob.parallel_plan(0).expect("there is a plan"))
}

/// A wall from the southern edge up to `height`, in the middle.
fn wall(height: u32) -> Vec<Cell> {
    (0..height).map(|row| Cell::new(SIDE / 2, row)).collect()
}

fn gains(comms: f32) -> [f32; MAX_LAYERS] {
    let mut gains = [1.0; MAX_LAYERS];
    gains[3] = comms;
    gains
}

fn cost(plan: &ParallelPlan<'_>, layer: usize, cell: Cell) -> f32 {
    match plan.layer(layer).expect("there is such a layer").look_up(cell) {
        Answer::Move { cost, .. } => cost as f32,
        other => panic!("{other:?}"),
    }
}

proptest! {
    /// The choice flips where the costs say so: at the gain that makes both weighted costs equal.
    #[test]
    fn w26_the_choice_flips_at_the_predicted_gain(
        height in 2..SIDE - 1, column in 0..SIDE / 2, row in 0..SIDE - 1,
    ) {
        with_plan(&wall(height), |plan| {
            let cell = Cell::new(column, row);
            let threshold = cost(plan, 0, cell) / cost(plan, 1, cell);
            let layer = |gain: f32| {
                advise_by_gains(plan, Some(cell), &gains(gain), 0.0, &mut Choice::default()).layer
            };
            prop_assert_eq!(layer(threshold * 0.999), Some(1));
            prop_assert_eq!(layer(threshold * 1.001), Some(0));
            Ok(())
        })?;
    }
}

/// W28: a gain that changes counts in the next tick; among equal costs the most constrained layer is
/// followed.
#[test]
fn w28_a_changed_gain_counts_in_the_next_tick() {
    with_plan(&wall(20), |plan| {
        let mut choice = Choice::default();
        let mut layer = |gain| {
            let cell = Some(Cell::new(2, 2));
            advise_by_gains(plan, cell, &gains(gain), 0.02, &mut choice).layer
        };
        assert_eq!([0.2, 1.0, 0.2, 1.0].map(&mut layer), [Some(1), Some(0), Some(1), Some(0)]);
        let beyond = Some(Cell::new(SIDE - 3, 2));
        let advice = advise_by_gains(plan, beyond, &gains(1.0), 0.0, &mut Choice::default());
        assert_eq!(advice.layer, Some(1), "beyond the wall both cost the same");
    });
}

/// Gains that waver about the threshold do not make the robot waver.
#[test]
fn hysteresis_keeps_the_choice_while_costs_are_nearly_equal() {
    with_plan(&wall(20), |plan| {
        let cell = Cell::new(2, 2);
        let threshold = cost(plan, 0, cell) / cost(plan, 1, cell);
        let changes = |hysteresis: f32| {
            let mut choice = Choice::default();
            let layers: Vec<Option<u8>> = (0..100)
                .map(|tick| {
                    let gain = threshold * if tick % 2 == 0 { 0.995 } else { 1.005 };
                    let gains = gains(gain);
                    advise_by_gains(plan, Some(cell), &gains, hysteresis, &mut choice).layer
                })
                .collect();
            layers.windows(2).filter(|pair| pair[0] != pair[1]).count()
        };
        assert_eq!((changes(0.0), changes(0.02)), (99, 0));
    });
}

#[test]
fn a_layer_without_a_route_is_not_chosen_and_channels_replace_gains() {
    with_plan(&wall(SIDE), |plan| {
        let west = Some(Cell::new(2, 2));
        let mut choice = Choice::default();
        let cut = advise_by_gains(plan, west, &gains(0.1), 0.02, &mut choice);
        assert_eq!((cut.layer, cut.kind), (Some(0), Kind::Move), "the other layer is cut in two");
    });
    let mut rule = LayerGains::default();
    rule.gains[3] = LayerGain { gain: 0.25, channel: Some(5) };
    let mut channels = [None; 8];
    assert_eq!(rule.of_channels(&channels)[3], 0.25);
    channels[5] = Some(2.0);
    assert_eq!(rule.of_channels(&channels)[3], 2.0);
    channels[5] = Some(f32::NAN);
    assert_eq!(rule.of_channels(&channels)[3], 0.25, "a value that is not finite is missing");
    with_plan(&wall(20), |plan| {
        let cell = Some(Cell::new(2, 2));
        let advice = advise(plan, cell, Selection::Gains(rule), &mut Choice::default());
        assert_eq!(advice.layer, Some(1), "the gains of the blob count without channels");
    });
}
