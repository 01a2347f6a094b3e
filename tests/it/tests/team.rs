//! The team experiment: what a few trials show of the paper's findings, and what breaks them.

use harness::experiment::findings::{Rows, SIMPLE};
use harness::experiment::metric::Metric;
use harness::experiment::variation::Variation;
use harness::experiment::{Campaign, Row, Trial, table};

fn campaign(rows: &[Row], trials: u32, variation: Variation) -> Campaign {
    Campaign { rows: rows.to_vec(), trials, seed: 5, field: 5, variation, shard: (0, 1) }
}

fn run(rows: &[Row], trials: u32, variation: Variation) -> Vec<Trial> {
    campaign(rows, trials, variation).run(&|| ()).expect("the missions are sound")
}

fn mean(trials: &[Trial], row: Row, metric: Metric) -> f64 {
    Rows(trials).summary(row, metric).expect("the row has trials").mean
}

fn variant(name: &str) -> Variation {
    Variation::named(name).expect("there is such a variant")
}

/// The differences between rows that are far larger than the scatter of trials. The others need the
/// many trials of `cargo experiment`.
#[test]
fn w41_rows_differ_as_in_the_paper() {
    let trials = run(&Row::ALL, 2, Variation::default());
    let mean = |row, metric| mean(&trials, row, metric);
    assert!(trials.iter().all(|trial| trial.unfinished == 0), "{trials:#?}");
    for row in SIMPLE {
        assert!(mean(row, Metric::OneNetwork) < 0.35, "{row:?}");
        assert!(mean(row, Metric::Distance) < mean(Row::Parallel, Metric::Distance), "{row:?}");
        assert!(mean(row, Metric::Time) < mean(Row::Serial, Metric::Time), "{row:?}");
    }
    assert!(mean(Row::Parallel, Metric::OneNetwork) > 0.9);
    let serial = mean(Row::Serial, Metric::OneNetwork);
    assert!((0.55..0.9).contains(&serial), "{serial}");
    assert!(mean(Row::Serial, Metric::Coverage) > mean(Row::Parallel, Metric::Coverage));
}

/// Each trial depends on its row, its number and the seeds alone.
#[test]
fn shards_put_together_are_one_run_to_the_last_bit() {
    let whole = campaign(&[Row::MostlyPlan], 3, Variation::default());
    let shard = |index: u32| {
        let part = Campaign { shard: (index, 2), ..whole.clone() };
        let trials = part.run(&|| ()).expect("the missions are sound");
        let (name, trials) = table::read_csv(&table::csv("c", &trials)).expect("it was written");
        (index.to_string(), name, trials)
    };
    let (_, merged) = table::merge(vec![shard(1), shard(0)]).expect("the parts fit");
    assert_eq!(merged, whole.run(&|| ()).expect("the missions are sound"));
    let twice = vec![shard(0), shard(0)];
    assert!(table::merge(twice).expect_err("a trial twice").contains("is there twice"));
}

#[test]
fn a_team_that_starts_apart_or_may_go_either_way_round_loses_itself() {
    for name in ["independent-starts", "open-area"] {
        let trials = run(&[Row::Parallel], 4, variant(name));
        let share = mean(&trials, Row::Parallel, Metric::OneNetwork);
        assert!(share < 0.95, "{name}: {share}");
    }
}
