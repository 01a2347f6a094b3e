//! Malicious blobs with a correct checksum: the work to check them is bounded, and every blob that
//! is not refused gives answers.

use super::{draft, resealed, tiny};
use controller::State;
use maps::Bitmap;
use plan_compiler::field::{ESCAPE, Field, NO_ROUTE};
use plan_compiler::layers::Limits;
use plan_compiler::pack::{pack, pack_with_limits};
use plan_compiler::search::{Corners, Query, solve};
use plan_compiler::terrain::Terrain;
use plan_compiler::tolls::Tolls;
use plan_format::{Blob, BlobError, Cell, Draft, LayerDraft, PlanDraft, limits, write};
use robot_io::{Fix, Operator, Percepts};

/// Cells along a side of the maps that repeat.
const SIDE: u32 = 512;
/// Cells per word of a table.
const SUPERBLOCK_CELLS: u32 = 32 * 32;
/// Size of a blob's header, bytes.
const HEADER_BYTES: usize = 28;
/// Size of the record of a layer, bytes.
const LAYER_BYTES: usize = 34;
/// Offsets in the record of the words that point to the tables of its planes.
const TABLES_AT: [usize; 2] = [4, 8];
/// Offset in the record of the number of free cells; the numbers of blocked cells and of cells
/// without a route follow.
const FREE_AT: usize = 22;

/// Checks a blob and counts the beats, which measure the work without a clock.
fn beats(blob: &[u8]) -> (Result<(), BlobError>, usize) {
    let mut beats = 0;
    let parsed = Blob::parse_paced(blob, || beats += 1);
    (parsed.map(|_| ()), beats)
}

/// The most beats that checking a blob of `bytes` bytes may take.
fn most_beats(bytes: usize) -> usize {
    let checks = bytes / 4 * limits::MAX_CHECKS_PER_WORD as usize;
    checks / limits::CHECKS_PER_BEAT as usize + bytes / limits::CHECKSUM_BYTES_PER_BEAT + 3
}

/// A layer that repeats in squares of 32 cells, so that its tables are long and point to few words.
/// No two costs in a square differ by a step, so there are no roots.
fn repeated() -> Field {
    let cell = |index: u32| {
        let (x, y) = (index % SIDE % 32, index / SIDE % 32);
        (x * 32 + y).wrapping_mul(0x9e37_79b9)
    };
    let code = |random: u32| match random >> 29 {
        0 => ESCAPE + (random >> 8) as u8 % 8,
        1 => NO_ROUTE,
        _ => (random >> 16) as u8 % 8,
    };
    let cells = || (0..SIDE * SIDE).map(cell);
    Field {
        columns: SIDE,
        rows: SIDE,
        unit: None,
        code: cells().map(code).collect(),
        cost: cells().collect(),
    }
}

/// A blob with `plans` plans of `layers` layers each, all with the same content.
fn shared(plans: usize, layers: usize, unit: Option<u8>) -> Vec<u8> {
    let packed = pack(&Field { unit, ..repeated() });
    let layer = |number| LayerDraft { name: format!("{number}"), rank: 0, packed: packed.clone() };
    let layers: Vec<LayerDraft> = (0..layers).map(layer).collect();
    let plan = |number| PlanDraft {
        name: format!("{number}"),
        goals_m: vec![[0.5, 0.5]],
        layers: layers.clone(),
    };
    let mut draft: Draft = draft(&[repeated()]);
    draft.plans = (0..plans).map(plan).collect();
    write(&draft).unwrap()
}

#[test]
fn layers_that_share_their_tables_are_checked_once() {
    for unit in [None, Some(1)] {
        let (one, all) = (shared(1, 1, unit), shared(limits::MAX_PLANS, limits::MAX_LAYERS, unit));
        let ((alone, beats_alone), (together, beats_together)) = (beats(&one), beats(&all));
        assert_eq!((alone, together), (Ok(()), Ok(())));
        // Checking the tables for each of the 512 layers would take hundreds of beats.
        assert!(beats_together <= beats_alone + 1, "{beats_together} beats, alone {beats_alone}");
    }
}

/// For a map with half the rows, a table of 256 words contains 129 overlapping tables, each a word
/// after the other. All of them are sound, and the layers of the blob use them all.
#[test]
fn overlapping_tables_are_refused_for_the_work() {
    let mut blob = shared(limits::MAX_PLANS, limits::MAX_LAYERS, None);
    // The directory begins with the size of the cell grid, as two numbers of two bytes.
    assert_eq!(blob[HEADER_BYTES..][..4], [0x80, 0x04, 0x80, 0x04]);
    blob[HEADER_BYTES + 3] = 0x02;
    let layers = layers_at(&blob);
    for number in 0..limits::MAX_BLOB_LAYERS {
        let record = &mut blob[layers + number * LAYER_BYTES..][..LAYER_BYTES];
        for at in TABLES_AT {
            add(&mut record[at..], number as u32 % (SIDE * SIDE / SUPERBLOCK_CELLS / 2 + 1));
        }
        record[FREE_AT..].fill(0);
        add(&mut record[FREE_AT..], SIDE * SIDE / 2);
    }
    let blob = resealed(blob);
    let (parsed, beats) = beats(&blob);
    assert_eq!(parsed, Err(BlobError::Work));
    assert_eq!(BlobError::Work.code(), 20);
    assert!(beats <= most_beats(blob.len()), "{beats} beats for {} bytes", blob.len());
}

/// The offset of the records of 512 layers in a blob: after the length of their section.
fn layers_at(blob: &[u8]) -> usize {
    let bytes = limits::MAX_BLOB_LAYERS * LAYER_BYTES;
    let length = [bytes as u8 | 128, (bytes >> 7) as u8 | 128, (bytes >> 14) as u8];
    let at = blob.windows(length.len()).position(|window| window == length);
    at.expect("the blob contains the section's length") + length.len()
}

/// Adds to a little-endian number of four bytes.
fn add(bytes: &mut [u8], more: u32) {
    let word = u32::from_le_bytes(bytes[..4].try_into().unwrap()).wrapping_add(more);
    bytes[..4].copy_from_slice(&word.to_le_bytes());
}

/// Queries a blob and runs some ticks with it; returns the number of cells that were queried.
fn query(blob: &Blob<'_>) -> usize {
    const MAX_CELLS: u32 = 64;
    let (columns, rows) = (blob.grid().columns, blob.grid().rows);
    let mut queried = 0;
    for parallel in blob.parallel_plans() {
        assert!(blob.find(parallel.name()).is_some());
        for layer in parallel.layers() {
            assert!(!layer.name().is_empty());
            for (row, column) in (0..=rows.min(MAX_CELLS))
                .flat_map(|row| (0..=columns.min(MAX_CELLS)).map(move |column| (row, column)))
            {
                let cell = Cell::new(column, row);
                let _ = (layer.look_up(cell), layer.step(cell), layer.speed_limit(cell));
                queried += 1;
            }
        }
    }
    let mut state = State::new(blob);
    for tick in 1..=8 {
        let commands = controller::tick(blob, &mut state, &percepts(blob, tick));
        assert!(commands.speed_mps.is_finite() && commands.turn_rate_radps.is_finite());
    }
    queried
}

/// Percepts of an armed robot that moves east from the map's corner.
fn percepts(blob: &Blob<'_>, tick: u64) -> Percepts {
    let time_us = tick * 50_000;
    let corner = blob.grid().corner_m;
    let at = math::Vec2::new(corner[0] as f32 + tick as f32 * 0.5, corner[1] as f32 + 0.5);
    let fix = blob.map_frame().map(|frame| Fix {
        time_us,
        is_valid: true,
        place: frame.to_geodetic(at),
        accuracy_mm: 500,
        velocity_mmps: Some([500, 0]),
        receiver_ms: Some(tick as u32 * 50),
    });
    let operator = Operator { is_armed: true, ..Operator::default() };
    let inputs = [Some(tick as f32 / 8.0); robot_io::limits::MAX_CHANNELS];
    Percepts { time_us, fix, heading_rad: Some(0.5), inputs, operator, ..Percepts::default() }
}

/// Small blobs that together have every kind of section.
fn small() -> Vec<Vec<u8>> {
    let with_behaviours = Draft { mission: soak::fixtures::endless_loop(), ..tiny() };
    vec![write(&tiny()).unwrap(), write(&with_behaviours).unwrap(), write(&tolled()).unwrap()]
}

/// Cells with several tolls, some in blocks of roots and some in blocks of own costs, and speed limits.
fn tolled() -> Draft {
    let blocked = Bitmap::from_fn(18, 9, |cell| cell.column == 6 && cell.row != 4);
    let tolls = Tolls::from_fn(18, 9, |cell| match cell.column {
        0..8 => 8 + (cell.column * 7 + cell.row * 5) % 11,
        8..12 => 16,
        _ => 8,
    });
    let terrain = Terrain::new(blocked).with_tolls(tolls);
    let (goal, corners) = (Cell::new(16, 1), Corners::Forbid);
    let field = solve(&Query { terrain: &terrain, goals: &[goal], corners });
    let mut limits = Limits::default();
    limits.lower(&Bitmap::from_fn(18, 9, |cell| cell.row > 5), 0.5);
    let mut draft = draft(std::slice::from_ref(&field));
    draft.plans[0].layers[0].packed = pack_with_limits(&field, &limits);
    draft
}

/// Each byte of a small blob becomes each other byte, and the checksum is corrected.
#[test]
fn every_changed_byte_with_a_correct_checksum_is_refused_or_answered() {
    for blob in small() {
        let (mut answered, mut refused) = (0, 0);
        for at in (0..blob.len()).filter(|at| !(24..28).contains(at)) {
            for other in (0..=u8::MAX).filter(|&other| other != blob[at]) {
                let mut changed = blob.clone();
                changed[at] = other;
                match Blob::parse(&resealed(changed)) {
                    Ok(plan) => answered += usize::from(query(&plan) < usize::MAX),
                    Err(_) => refused += 1,
                }
            }
        }
        eprintln!("{} bytes: {refused} changed blobs refused, {answered} answered", blob.len());
        assert!(refused > 10_000 && answered > 1_000, "{refused} and {answered}");
    }
}

/// A small blob truncated anywhere, with the length in its header and the checksum corrected.
#[test]
fn every_truncation_with_a_correct_checksum_is_refused() {
    for blob in small() {
        for length in HEADER_BYTES..blob.len() {
            let mut cut = blob[..length].to_vec();
            cut[12..16].copy_from_slice(&(length as u32).to_le_bytes());
            assert_eq!(Blob::parse(&resealed(cut)).err(), Some(BlobError::Directory), "{length}");
        }
    }
}
