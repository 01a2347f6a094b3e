//! Every target over its seeds and a bounded number of mutations of them, the same on each run.

use fuzz::{Mutations, TARGETS, Target};
use std::panic::catch_unwind;
use std::time::{Duration, Instant};

/// Inputs of one target besides its seeds: as many as fit into the time, at most this number.
/// What does not fit is left to the coverage-guided run.
const MUTATIONS: usize = 2_000;
const TIME: Duration = Duration::from_secs(6);

/// Longer than this no input may take, on a machine that does much else besides.
const MAX_TIME: Duration = Duration::from_secs(20);
/// Failures after which the rest is not looked for.
const MAX_FAILURES: usize = 20;

/// Bytes that all committed corpora may take.
const MAX_CORPUS_BYTES: u64 = 200_000;

#[test]
fn every_target_survives_its_seeds_and_mutations_of_them() {
    let mut failures = Vec::new();
    for target in TARGETS {
        let seeds = target.seeds();
        assert!(!seeds.is_empty(), "{} has nothing to start from", target.name);
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

/// What fails on an input, which is kept for `target run`.
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
fn the_corpus_is_small_and_each_folder_is_a_targets() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus");
    let mut bytes = 0;
    for entry in std::fs::read_dir(folder).expect("there is a corpus") {
        let entry = entry.expect("an entry can be read");
        let name = entry.file_name().into_string().expect("a name in ASCII");
        assert!(Target::find(&name).is_some(), "corpus/{name} is no target's");
        for file in std::fs::read_dir(entry.path()).expect("a folder a target") {
            bytes += file.and_then(|file| file.metadata()).expect("it can be read").len();
        }
    }
    assert!(bytes <= MAX_CORPUS_BYTES, "{bytes} bytes");
}
