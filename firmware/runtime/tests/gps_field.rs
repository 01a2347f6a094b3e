//! Files that once failed, compared with a table of the right results.
//!
//! The files come from third parties and are not part of the project: without them this test
//! prints a note and returns. `gps_corpus.rs` has generated cases of the same kinds.

use std::path::Path;

use runtime::gps::Decoder;

#[test]
fn files_from_the_field_give_the_solutions_of_their_table() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/field/gnss");
    let Ok(table) = std::fs::read_to_string(folder.join("expected.tsv")) else {
        eprintln!(
            "skipped: {} is missing (files from third parties, not part of the project)",
            folder.display()
        );
        return;
    };
    let rows: Vec<Vec<&str>> = table
        .lines()
        .filter(|line| !line.starts_with('#') && !line.trim().is_empty())
        .map(|line| line.split('\t').collect())
        .collect();
    assert!(rows.len() >= 16, "the table has {} rows", rows.len());
    for row in rows {
        let [file, valid, moving] = row[..] else { panic!("three columns in {row:?}") };
        let (was_valid, was_moving) = counts(&folder.join(file));
        assert_eq!(was_valid.to_string(), valid, "{file}");
        assert!(moving == "-" || was_moving.to_string() == moving, "{file}: {was_moving}");
    }
    // Not in the table: GGA of a second talker, without a fix, in each of six epochs.
    assert_eq!(counts(&folder.join("nmea_second_gga_without_fix.nmea")), (6, 6));
}

/// Number of valid solutions of a file, and of those with velocity.
fn counts(path: &Path) -> (usize, usize) {
    let bytes = std::fs::read(path).expect("a listed file is readable");
    let mut decoder = Decoder::default();
    let solutions = bytes.iter().filter_map(|&byte| decoder.push(byte));
    let valid: Vec<_> = solutions.filter(|solution| solution.is_valid).collect();
    (valid.len(), valid.iter().filter(|solution| solution.velocity_mmps.is_some()).count())
}
