//! Blobs are read as they were written, and damaged blobs are refused.

mod goals;
mod hostile;
mod picture;
mod sizes;

use picture::{Picture, answer_of};
use plan_compiler::field::{ESCAPE, Field, NO_ESCAPE, UNREACHED, is_blocked};
use plan_compiler::pack::pack;
use plan_format::mission::MissionDraft;
use plan_format::{
    Answer, Blob, BlobError, Cell, Draft, Grid, LayerDraft, Origin, Parameters, PlanDraft,
    WriteError, grid::octile, limits, write,
};
use proptest::prelude::*;

fn draft(fields: &[Field]) -> Draft {
    let plan = |(number, field): (usize, &Field)| PlanDraft {
        name: format!("goal {number}"),
        goals_m: vec![[0.5, 0.5]],
        layers: vec![LayerDraft { name: "physical".into(), rank: 0, packed: pack(field) }],
    };
    let (columns, rows) = fields.first().map_or((0, 0), |field| (field.columns, field.rows));
    Draft {
        grid: Grid { columns, rows, resolution_m: 1.0, corner_m: [0.0, 0.0] },
        origin: None,
        parameters: Parameters::default(),
        plans: fields.iter().enumerate().map(plan).collect(),
        mission: MissionDraft::default(),
    }
}

fn tiny() -> Draft {
    let picture = Picture::of(&["..#.", ".##.", "G.#."]);
    let mut draft = draft(&[picture.field(false)]);
    draft.grid.corner_m = [0.0, -0.25];
    draft.origin = Some(Origin {
        place: math::GeoPoint { lat_e7: 337_756_000, lon_e7: -843_990_000 },
        at_m: [1.0, 2.0],
        heading_rad: 0.5,
    });
    draft
}

#[test]
fn a_tiny_blob_has_exactly_these_bytes() {
    let bytes = write(&tiny()).unwrap();
    let mut at = 0;
    for (meaning, expected) in TINY_BYTES {
        let end = bytes.len().min(at + expected.split(' ').count());
        assert_eq!(hex(&bytes[at..end]), *expected, "{meaning}, from byte {at}");
        at = end;
    }
    assert_eq!(at, bytes.len());
    let blob = Blob::parse_exact(&bytes).unwrap();
    assert_eq!(blob.origin(), tiny().origin);
    assert_eq!(blob.grid(), &tiny().grid);
    assert_eq!(blob.parameters(), &Parameters::default());
    assert_eq!(blob.goal(), Some(math::Vec2::new(0.5, 0.5)));
    let layer = blob.find("goal 0").unwrap().layer(0).unwrap();
    let counts = layer.counts();
    assert_eq!((counts.free, counts.blocked, counts.unreachable), (5, 4, 3));
    assert_eq!(layer.look_up(Cell::new(0, 0)), Answer::Goal);
    assert_eq!(layer.look_up(Cell::new(3, 0)), Answer::NoRoute);
    assert_eq!(layer.look_up(Cell::new(4, 0)), Answer::OffMap);
    assert_eq!(write(&tiny()).unwrap(), bytes, "the same draft gives the same bytes");
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect::<Vec<_>>().join(" ")
}

/// The bytes of [`tiny`] in their order. A change here is a change of the format.
const TINY_BYTES: &[(&str, &str)] = &[
    ("WAYFIELD", "57 41 59 46 49 45 4c 44"),
    ("version 2, 28 bytes of header", "02 00 1c 00"),
    ("446 bytes", "be 01 00 00"),
    ("schema hash", "20 62 21 06 ca c7 f1 f6"),
    ("checksum", "f7 9b 4d 20"),
    ("4 columns, 3 rows", "04 03"),
    ("cells of 1 m", "00 00 00 00 00 00 f0 3f"),
    ("corner 0, -0.25", "00 00 00 00 00 00 00 00 00 00 00 00 00 00 d0 bf"),
    ("an origin: 33.7756, -84.399 degrees", "01 c0 fd 8d c2 02 df 8f f2 a4 06"),
    ("its place 1, 2", "00 00 00 00 00 00 f0 3f 00 00 00 00 00 00 00 40"),
    ("its heading 0.5", "00 00 00 00 00 00 e0 3f"),
    ("plan 0, gains 0.5 1 0.05, route, static", "00 00 00 00 3f 00 00 80 3f cd cc 4c 3d 00 00"),
    ("differential, radius 0.3", "00 9a 99 99 3e"),
    ("speeds 1.6 1.6 0.3, turn rate 2.67", "cd cc cc 3f cd cc cc 3f 9a 99 99 3e aa aa 2a 40"),
    (
        "turn radius 0, brakes 2 m/s^2 after 0.1 s, reach 10",
        "00 00 00 00 00 00 00 40 a0 8d 06 00 00 20 41",
    ),
    ("stop distance 0.02, may creep, backs out once it has seen astern", "0b d7 a3 3c 01 01"),
    (
        "schema gains 1 1, sphere 0.8, margin 0.02",
        "00 00 80 3f 00 00 80 3f ce cc 4c 3f 0b d7 a3 3c",
    ),
    ("avoid-past: gain 0, sphere 8", "00 00 00 00 00 00 00 41"),
    ("look-ahead 0.48, detour after 4 s", "90 c2 f5 3e 80 92 f4 01"),
    ("tolerance 1, 10 ticks", "00 00 80 3f 0a"),
    ("2 s, 5000 mm, 15 m/s", "80 89 7a 88 27 00 00 70 41"),
    ("stop, stop", "00 00"),
    ("link lost after 1 s, disarm", "c0 84 3d 01"),
    ("ranges silent after 0.5 s, not required", "a0 c2 1e 00"),
    ("no progress after 60 s within 1 m, stop", "80 8e ce 1c 00 00 80 3f 00"),
    ("all checks, no fence, no battery", "00 00 00 00 00 00 00 00 00"),
    ("robot 0 of 1, links after 0.75 s", "00 01 b0 e3 2d b0 e3 2d"),
    (
        "any quality, gain 1, sphere 2, no tether of 20 m",
        "00 00 00 00 00 00 80 3f 00 00 00 40 00 00 00 a0 41",
    ),
    ("seed 1", "01"),
    ("22 bytes of plans: name at 0, 6 bytes, 1 layer from 0", "16 00 00 06 01 00 00"),
    ("goal 0.5, 0.5", "00 00 00 00 00 00 e0 3f 00 00 00 00 00 00 e0 3f"),
    ("34 bytes of layers: name at 6, 8 bytes, rank 0", "22 06 00 08 00"),
    ("terrain at 13, routes at 26, 2 roots at 27", "0d 00 00 00 1a 00 00 00 1b 00 00 00 02 00"),
    ("124 bytes, 5 free, 4 blocked", "7c 00 00 00 05 00 00 00 04 00 00 00"),
    ("3 unreachable", "03 00 00 00"),
    ("14 bytes of names: goal 0", "0e 67 6f 61 6c 20 30"),
    ("physical", "70 68 79 73 69 63 61 6c"),
    ("no mission", "00"),
    ("no recipe", "00"),
    ("124 bytes of cells", "7c"),
    ("entries of the terrain: free, escapes N, NW and W", "40 65 00 00"),
    ("block 0 of class 4, the next 7", "00 80 00 00 00 00 00 00 00 00 00 00 00 00 00 00"),
    ("8 of class 0", "00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00"),
    ("from word 9 on, indices of 2 bits", "30 00 24 00 30 00 00 00 00 00 00 00 00 00 00 00"),
    ("the table of the terrain", "09 00 00 00"),
    ("entries of the routes, the last first: no route", "ff ff 00 00"),
    ("root 0, root 1", "00 00 02 00"),
    ("block 0 of class 2, the next 7", "00 40 00 00 00 00 00 00 00 00 00 00 00 00 00 00"),
    ("8 of class 0", "00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00"),
    ("from word 24 on, borders at columns 3, 3, 1 and none", "33 81 88 88"),
    ("borders at columns 3, 3, 3 and none", "33 83 88 88"),
    ("the table of the routes", "18 00 00 00"),
    ("root 0 at 0, 0 for 0", "00 00 00 00 00 00 00 00"),
    ("root 1 at 0, 2 for 2 x 5741", "00 00 02 00 da 2c 00 00"),
];

#[test]
fn every_truncation_is_refused() {
    let blob = write(&tiny()).unwrap();
    for length in 0..blob.len() {
        let error = Blob::parse(&blob[..length]).unwrap_err();
        let expected = if length == 0 { BlobError::Absent } else { BlobError::Truncated };
        assert_eq!(error, expected, "{length} bytes");
        assert_ne!(error.code(), 0);
    }
}

#[test]
fn every_flipped_bit_is_refused() {
    let mut blob = write(&tiny()).unwrap();
    for bit in 0..blob.len() * 8 {
        blob[bit / 8] ^= 1 << (bit % 8);
        assert!(Blob::parse(&blob).is_err(), "bit {bit}");
        // Followed by erased flash.
        let region = [&blob[..], &[0xff; 64]].concat();
        assert!(Blob::parse(&region).is_err(), "bit {bit} in a larger region");
        blob[bit / 8] ^= 1 << (bit % 8);
    }
    assert!(Blob::parse(&blob).is_ok());
}

#[test]
fn a_region_may_be_larger_than_its_blob_but_a_file_may_not() {
    let mut region = write(&tiny()).unwrap();
    region.extend_from_slice(&[0xff; 100]);
    assert_eq!(Blob::parse(&region).unwrap().plan_count(), 1);
    assert_eq!(Blob::parse_exact(&region).unwrap_err(), BlobError::TrailingBytes);
    for erased in [[0xff; 64], [0; 64]] {
        assert_eq!(Blob::parse(&erased).unwrap_err(), BlobError::Absent);
    }
}

#[test]
fn a_foreign_blob_is_refused_with_the_reason() {
    let blob = write(&tiny()).unwrap();
    let with = |at: usize, bytes: &[u8]| {
        let mut other = blob.clone();
        other[at..at + bytes.len()].copy_from_slice(bytes);
        other
    };
    let refusal = |bytes: &[u8]| Blob::parse(bytes).unwrap_err();
    assert_eq!(refusal(&with(0, b"MCUBOOT!")), BlobError::Magic);
    assert_eq!(refusal(&with(8, &[9, 0])), BlobError::Version { found: 9 });
    assert_eq!(refusal(&with(10, &[29])), BlobError::Header);
    assert_eq!(refusal(&with(12, &u32::MAX.to_le_bytes())), BlobError::TooLarge);
    assert_eq!(refusal(&with(blob.len() - 1, &[1])), BlobError::Checksum);
    assert_eq!(refusal(&resealed(with(16, &[0; 8]))), BlobError::Schema);
}

/// The blob with its checksum corrected: CRC-32, bit by bit.
fn resealed(mut blob: Vec<u8>) -> Vec<u8> {
    let mut crc = u32::MAX;
    for &byte in blob[..24].iter().chain(&blob[28..]) {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 };
        }
    }
    blob[24..28].copy_from_slice(&(!crc).to_le_bytes());
    blob
}

#[test]
fn the_limits_hold_on_both_sides() {
    let field = Picture::of(&["G"]).field(false);
    let mut full = draft(&vec![field.clone(); limits::MAX_PLANS]);
    for plan in &mut full.plans {
        let layer =
            |number| LayerDraft { name: format!("{number:0>32}"), rank: 0, packed: pack(&field) };
        plan.layers = (0..limits::MAX_LAYERS).map(layer).collect();
    }
    let blob = write(&full).unwrap();
    let plan = Blob::parse(&blob).unwrap();
    let last = plan.parallel_plan(limits::MAX_PLANS - 1).unwrap();
    assert_eq!(last.layer_count(), limits::MAX_LAYERS);
    assert_eq!(last.layer(limits::MAX_LAYERS - 1).unwrap().look_up(Cell::new(0, 0)), Answer::Goal);
    assert!(last.layer(limits::MAX_LAYERS).is_none());
    assert_eq!(last.layers().count(), limits::MAX_LAYERS);
    assert_eq!(plan.parallel_plans().count(), limits::MAX_PLANS);
    assert!(plan.parallel_plan(limits::MAX_PLANS).is_none());

    let refusal = |change: &dyn Fn(&mut Draft)| {
        let mut changed = full.clone();
        change(&mut changed);
        write(&changed).unwrap_err()
    };
    let again = full.plans[0].clone();
    assert_eq!(refusal(&|d| d.plans.push(again.clone())), WriteError::TooManyPlans(65));
    let layers = |count| WriteError::LayerCount { plan: "goal 0".into(), layers: count };
    assert_eq!(refusal(&|d| d.plans[0].layers.clear()), layers(0));
    assert_eq!(refusal(&|d| d.plans[0].layers.push(again.layers[0].clone())), layers(9));
    for name in ["", " x", "x ", "a/b", "line\n", &"x".repeat(33)] {
        let error = refusal(&|d| d.plans[1].name = name.into());
        assert_eq!(error, WriteError::Name(name.into()));
    }
    let refused = |error| WriteError::Refused(error);
    let same = refusal(&|d| d.plans[1].name = "goal 0".into());
    assert_eq!(same, refused(BlobError::Name));
    let outside = refusal(&|d| d.plans[1].goals_m = vec![[1.0, 0.0]]);
    assert_eq!(outside, refused(BlobError::Goal));
    let nowhere = refusal(&|d| d.grid.corner_m = [f64::NAN, 0.0]);
    assert_eq!(nowhere, refused(BlobError::Grid));
    let lost = refusal(&|d| d.parameters.plan = limits::MAX_PLANS as u16);
    assert_eq!(lost, refused(BlobError::Parameters));
    let fast = refusal(&|d| d.parameters.vehicle.max_speed_mps = f32::INFINITY);
    assert!(matches!(fast, WriteError::Parameter { name: "vehicle.max_speed", .. }), "{fast}");
}

#[test]
fn a_blob_without_plans_and_a_plan_without_map_have_no_cells() {
    let mut empty = draft(&[]);
    let blob = write(&empty).unwrap();
    let blob = Blob::parse(&blob).unwrap();
    assert_eq!((blob.plan_count(), blob.goal()), (0, None));
    assert_eq!(blob.cell_at(math::Vec2::new(0.0, 0.0)), None);
    empty.grid.columns = 1;
    assert_eq!(write(&empty), Err(WriteError::Refused(BlobError::Grid)));

    let mut parameters = Parameters::default();
    parameters.vehicle.radius_m = f32::NAN;
    let goal = Some(math::Vec2::new(3.0, f32::NAN));
    let blob = Blob::without_map(parameters, None, goal);
    assert_eq!((blob.parameters(), blob.goal()), (&Parameters::default(), None));
    assert!(blob.find("goal 0").is_none());
}

#[test]
fn equal_layers_are_stored_once() {
    let field = Picture::of(&["....", ".#..", "G..."]).field(false);
    let one = write(&draft(std::slice::from_ref(&field))).unwrap().len();
    let two = write(&draft(&[field.clone(), field])).unwrap();
    // The records of a plan and a layer, and the plan's name.
    assert!(two.len() - one <= 22 + 33 + 8, "{} more", two.len() - one);
    let blob = Blob::parse(&two).unwrap();
    assert_eq!(blob.parallel_plan(1).unwrap().layer(0).unwrap().bytes(), 0);
}

#[test]
fn without_obstacles_every_cost_is_the_octile_distance() {
    let columns = 100;
    let goal = Cell::new(37, 50);
    let blocked = vec![false; 8_000];
    let picture =
        Picture { columns, rows: 80, blocked, goal: (goal.row * columns + goal.column) as usize };
    let blob = write(&draft(&[picture.field(false)])).unwrap();
    let layer = Blob::parse(&blob).unwrap().parallel_plan(0).unwrap().layer(0).unwrap();
    for index in (0..8_000).filter(|&index| index != picture.goal) {
        let cell = picture.cell(index);
        let least = octile(cell.column.abs_diff(goal.column), cell.row.abs_diff(goal.row));
        let answer = layer.look_up(cell);
        assert!(
            matches!(answer, Answer::Move { cost, .. } if cost == least),
            "{cell:?} {answer:?}"
        );
    }
    assert!(layer.bytes() < 150, "{} bytes for one root", layer.bytes());
}

#[test]
fn a_real_city_fits_its_budget() {
    let Some(folder) = it::real_data("movingai") else { return };
    let text = std::fs::read_to_string(folder.join("Berlin_0_1024.map")).unwrap();
    let lines: Vec<&str> = text.lines().skip(4).collect();
    let blocked = lines.iter().rev().flat_map(|line| line.bytes().map(|cell| cell != b'.'));
    let mut picture =
        Picture { columns: 1024, rows: 1024, blocked: blocked.collect(), goal: 512 * 1024 + 512 };
    for cut_corners in [false, true] {
        let goals = [(512, 512), (200, 700)].map(|(column, row)| {
            (row * 1024 + column..).find(|&index: &usize| !picture.blocked[index]).unwrap()
        });
        let fields = goals.map(|goal| {
            picture.goal = goal;
            picture.field(cut_corners)
        });
        let bytes = write(&draft(&fields)).unwrap();
        let blob = Blob::parse(&bytes).unwrap();
        let layer = |index| blob.parallel_plan(index).unwrap().layer(0).unwrap();
        for (index, field) in fields.iter().enumerate() {
            picture.check(field, &layer(index), cut_corners);
        }
        let bytes_per_cell = |bytes: usize| bytes as f64 / f64::from(1u32 << 20);
        let (all, further) = (bytes_per_cell(bytes.len()), bytes_per_cell(layer(1).bytes()));
        eprintln!("two layers {all:.3} bytes a cell, the second {further:.3}");
        assert!(all - further <= 0.15 && further <= 0.1);
    }
}

/// Maps of every texture: blocked cells as noise and in rectangles, and a goal.
fn pictures() -> impl Strategy<Value = Picture> {
    let rectangle = (0..90u32, 0..90u32, 1..20u32, 1..20u32);
    let rectangles = prop::collection::vec(rectangle, 0..30);
    (1..90u32, 1..90u32, rectangles, 0..50u32, any::<u64>()).prop_map(
        |(columns, rows, rectangles, noise_percent, seed)| {
            let mut random = seed;
            let mut next = move || {
                random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                (random >> 33) as u32
            };
            let cells = columns * rows;
            let mut blocked: Vec<bool> = (0..cells)
                .map(|index| {
                    let (x, y) = (index % columns, index / columns);
                    let inside = rectangles.iter().any(|&(left, low, width, height)| {
                        (left..left + width).contains(&x) && (low..low + height).contains(&y)
                    });
                    inside || next() % 100 < noise_percent
                })
                .collect();
            let goal = (next() % cells) as usize;
            blocked[goal] = false;
            Picture { columns, rows, blocked, goal }
        },
    )
}

/// Fields that no search would produce: any code with any cost.
fn fields() -> impl Strategy<Value = Field> {
    let costs = prop_oneof![0..100_000u32, any::<u32>(), Just(5741u32)];
    let codes = prop_oneof![0..=NO_ESCAPE, ESCAPE..ESCAPE + 8];
    (1..40u32, 1..40u32).prop_flat_map(move |(columns, rows)| {
        let cells = (columns * rows) as usize;
        let cost = prop::collection::vec(costs.clone(), cells);
        let code = prop::collection::vec(codes.clone(), cells);
        (cost, code).prop_map(move |(cost, code)| Field { columns, rows, unit: None, cost, code })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..Default::default() })]

    #[test]
    fn layers_of_any_map_answer_as_their_fields(picture in pictures(), cut_corners: bool) {
        let field = picture.field(cut_corners);
        let blob = write(&draft(std::slice::from_ref(&field))).unwrap();
        let layer = Blob::parse(&blob).unwrap().parallel_plan(0).unwrap().layer(0).unwrap();
        picture.check(&field, &layer, cut_corners);
        let counts = layer.counts();
        let blocked = field.code.iter().filter(|&&code| is_blocked(code)).count();
        let routed = field.cost.iter().filter(|&&cost| cost != UNREACHED).count();
        prop_assert_eq!((counts.blocked as usize, counts.free as usize), (blocked, routed));
        // 200 bytes for the fixed parts of the planes, which dominate on small maps.
        let most = layer.raw_bytes() + 200;
        prop_assert!(layer.bytes() <= most, "{} bytes", layer.bytes());
    }

    #[test]
    fn layers_answer_as_fields_that_contradict_themselves(field in fields()) {
        let blob = write(&draft(std::slice::from_ref(&field))).unwrap();
        let layer = Blob::parse(&blob).unwrap().parallel_plan(0).unwrap().layer(0).unwrap();
        for index in 0..field.cost.len() {
            let cell = Cell::new(index as u32 % field.columns, index as u32 / field.columns);
            prop_assert_eq!(layer.look_up(cell), answer_of(&field, index));
        }
    }

    #[test]
    fn no_bytes_make_the_reader_panic(
        bytes in prop::collection::vec(any::<u8>(), 0..300),
        at in 28usize..1000,
    ) {
        let _ = Blob::parse(&bytes);
        // With a correct header and checksum, so that the bytes reach the validation.
        let mut blob = write(&tiny()).unwrap();
        let at = at.min(blob.len() - 1);
        let end = (at + bytes.len()).min(blob.len());
        blob[at..end].copy_from_slice(&bytes[..end - at]);
        if let Ok(blob) = Blob::parse(&resealed(blob)) {
            let cells = (0..5).flat_map(|row| (0..5).map(move |column| Cell::new(column, row)));
            let layers = blob.parallel_plans().filter_map(|parallel| parallel.layer(0));
            for (layer, cell) in layers.flat_map(|layer| cells.clone().map(move |cell| (layer, cell))) {
                let _ = layer.look_up(cell);
            }
        }
    }
}
