//! Runs every target on its seeds and on a bounded number of their mutations, the same on each run.

use fuzz::{Mutations, TARGETS, Target};
use std::panic::catch_unwind;
use std::time::{Duration, Instant};

/// Most mutations of one target.
const MUTATIONS: usize = 2_000;
/// Time after which a target gets no further mutations; the coverage-guided run does the rest.
const TIME: Duration = Duration::from_secs(6);

/// Time limit for one input, generous for a busy machine.
const MAX_TIME: Duration = Duration::from_secs(20);
/// Failures after which a target is given up.
const MAX_FAILURES: usize = 20;

/// Upper limit for the sum of all corpora, bytes.
const MAX_CORPUS_BYTES: u64 = 200_000;

#[test]
fn every_target_survives_its_seeds_and_mutations_of_them() {
    let mut failures = Vec::new();
    for target in TARGETS {
        let seeds = target.seeds();
        assert!(!seeds.is_empty(), "{} has no seeds", target.name);
        failures.extend(seeds.iter().filter_map(|seed| failure(target, seed)));
        let (start, mut count) = (Instant::now(), 0);
        for input in Mutations::new(&seeds, 1).take(MUTATIONS) {
            failures.extend(failure(target, &input));
            count += 1;
            if start.elapsed() > TIME || failures.len() >= MAX_FAILURES {
                break;
            }
        }
        eprintln!("{}: {} seeds, {count} mutations", target.name, seeds.len());
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Runs a target on an input. If it panics or takes too long, keeps the input in a file for
/// `target run` and describes the failure.
fn failure(target: &Target, input: &[u8]) -> Option<String> {
    let start = Instant::now();
    let survived = catch_unwind(|| target.run(input)).is_ok();
    let took = start.elapsed();
    if survived && took < MAX_TIME {
        return None;
    }
    let name = format!("fuzz-{}-{:08x}", target.name, fuzz::checksum(input));
    let path = std::env::temp_dir().join(name);
    std::fs::write(&path, input).expect("the failing input can be kept");
    let what = if survived { format!("takes {took:?}") } else { "panics".into() };
    Some(format!("target {} {what} on {}", target.name, path.display()))
}

#[test]
fn the_corpus_is_small_and_each_folder_belongs_to_a_target() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus");
    let mut bytes = 0;
    for entry in std::fs::read_dir(folder).expect("there is a corpus") {
        let entry = entry.expect("an entry can be read");
        let name = entry.file_name().into_string().expect("a name in ASCII");
        assert!(Target::find(&name).is_some(), "corpus/{name} belongs to no target");
        for file in std::fs::read_dir(entry.path()).expect("a folder a target") {
            bytes += file.and_then(|file| file.metadata()).expect("it can be read").len();
        }
    }
    assert!(bytes <= MAX_CORPUS_BYTES, "{bytes} bytes");
}
