//! The bytes of a plan with several goals, and what a reader refuses.

use super::picture::Picture;
use super::{draft, hex, resealed};
use plan_compiler::pack::with_goals;
use plan_format::{Blob, BlobError, Cell, Draft, WriteError, limits, write};

/// Five cells in a row with a goal at either end, the second one where the first layer of a third goal
/// would be off the map.
fn pair() -> Draft {
    let mut draft = draft(&[Picture::of(&["G...."]).field(false)]);
    let plan = &mut draft.plans[0];
    plan.goals_m = vec![[0.5, 0.5], [-3.0, 0.5], [4.5, 0.5]];
    let query = plan_compiler::search::Query {
        terrain: &plan_compiler::terrain::Terrain::new(maps::Bitmap::new(5, 1)),
        goals: &[Cell::new(0, 0), Cell::new(4, 0)],
        corners: Default::default(),
    };
    let field = plan_compiler::search::solve(&query);
    let packed = plan_compiler::pack::pack(&field);
    plan.layers[0].packed =
        with_goals(packed, &[(0, Cell::new(0, 0)), (2, Cell::new(4, 0))]).expect("a small layer");
    draft
}

#[test]
fn a_plan_with_several_goals_has_these_bytes() {
    let bytes = write(&pair()).unwrap();
    let blob = Blob::parse_exact(&bytes).unwrap();
    let plan = blob.parallel_plan(0).unwrap();
    assert_eq!(plan.goals_m().collect::<Vec<_>>(), [[0.5, 0.5], [-3.0, 0.5], [4.5, 0.5]]);
    assert_eq!((plan.goal_count(), plan.goal_m()), (3, [0.5, 0.5]));
    let layer = plan.layer(0).unwrap();
    let numbers: Vec<u8> = (0..5).map(|column| layer.goal_number(Cell::new(column, 0))).collect();
    assert_eq!([numbers[0], numbers[1], numbers[3], numbers[4]], [0, 0, 2, 2]);
    assert_eq!(plan.goal_at(2), math::Vec2::new(4.5, 0.5));
    // Numbers that no goal has.
    assert_eq!([3, u8::MAX].map(|number| plan.goal_at(number)), [plan.goal(); 2]);
    let has = |part: &str| hex(&bytes).contains(part);
    // Name at 0, 6 bytes, 1 layer and the flag of several goals, from layer 0.
    assert!(has("16 00 00 06 81 00 00"));
    // Name at 6, 8 bytes, rank 0 and the flag.
    assert!(has("22 06 00 08 40"));
    // The list: three goals, the second one at -3, 0.5.
    assert!(has("03 00 00 00 00 00 00 00 00 00 e0 3f 00 00 00 00 00 00 e0 3f \
                 00 00 00 00 00 00 08 c0 00 00 00 00 00 00 e0 3f \
                 00 00 00 00 00 00 12 40 00 00 00 00 00 00 e0 3f"));
}

#[test]
fn goals_that_contradict_each_other_are_refused() {
    let refusal = |change: &dyn Fn(&mut Draft)| {
        let mut changed = pair();
        change(&mut changed);
        write(&changed).unwrap_err()
    };
    let name = || ("goal 0".to_owned(), "physical".to_owned());
    let count = |goals| WriteError::GoalCount { plan: name().0, goals };
    assert_eq!(refusal(&|d| d.plans[0].goals_m.clear()), count(0));
    assert_eq!(refusal(&|d| d.plans[0].goals_m = vec![[0.5, 0.5]; 17]), count(17));
    let mismatch = || WriteError::Goals { plan: name().0, layer: name().1 };
    assert_eq!(refusal(&|d| d.plans[0].goals_m.truncate(1)), mismatch());
    assert_eq!(refusal(&|d| d.plans[0].layers[0].packed.goals = None), mismatch());
    // The layer names a third goal.
    let refused = WriteError::Refused;
    assert_eq!(refusal(&|d| d.plans[0].goals_m.truncate(2)), refused(BlobError::Cells));
    let all_off = &|d: &mut Draft| d.plans[0].goals_m = vec![[-3.0, 0.5]; 3];
    assert_eq!(refusal(all_off), refused(BlobError::Goal));
    assert_eq!(refusal(&|d| d.plans[0].goals_m[1][0] = 1e6), refused(BlobError::Goal));
    assert_eq!(refusal(&|d| d.plans[0].goals_m[1][0] = f64::NAN), refused(BlobError::Goal));
    // All sixteen.
    let mut full = pair();
    full.plans[0].goals_m.resize(limits::MAX_GOALS, [0.0, 0.0]);
    assert_eq!(
        Blob::parse(&write(&full).unwrap()).unwrap().parallel_plan(0).unwrap().goal_count(),
        16
    );
}

/// Every byte of the blob is changed in several ways, with a correct checksum: the reader refuses the
/// blob, or its answers name a goal of the list.
#[test]
fn damaged_goals_are_refused_or_harmless() {
    let sound = write(&pair()).unwrap();
    let mut refused = 0;
    for at in 28..sound.len() {
        for change in [1, 2, 4, 8, 16, 32, 64, 128, 0xff, 0x7f] {
            let mut bytes = sound.clone();
            bytes[at] ^= change;
            let bytes = resealed(bytes);
            let Ok(blob) = Blob::parse(&bytes) else {
                refused += 1;
                continue;
            };
            for plan in blob.parallel_plans() {
                let goals = plan.goals_m().count();
                assert!((1..=limits::MAX_GOALS).contains(&goals), "byte {at}");
                for layer in plan.layers() {
                    let cells = (0..6).flat_map(|row| (0..7).map(move |c| Cell::new(c, row)));
                    let numbers = cells.map(|cell| usize::from(layer.goal_number(cell)));
                    assert!(numbers.max().is_some_and(|most| most < goals), "byte {at}");
                }
            }
        }
    }
    assert!(refused > 1_000, "{refused}");
}
