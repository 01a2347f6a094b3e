//! The team experiment: what a few trials show of the paper's findings, and what breaks them.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use harness::experiment::findings::{Rows, SIMPLE};
use harness::experiment::metric::Metric;
use harness::experiment::variation::Variation;
use harness::experiment::{Campaign, Row, Trial, table};
use harness::setup;
use serde_json::Value;

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
        let (name, trials) =
            table::read_csv(&table::csv(&whole.command(), &trials)).expect("it was written");
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

/// Each of these settings breaks an order of the times (a), which holds with the usual ones: slow
/// turns make the plan alone slow, posts make reactive robots slow, and short vectors make robots
/// slow that weigh their goal highly.
#[test]
fn without_turn_limit_posts_or_varying_speed_the_order_of_times_breaks() {
    let usual = Variation::default();
    let ratio = |slow, fast, variation| {
        let trials = run(&[fast, slow], 3, variation);
        mean(&trials, slow, Metric::Time) / mean(&trials, fast, Metric::Time)
    };
    let excess = |variation| ratio(Row::Plan, Row::MostlyPlan, variation) - 1.0;
    let (with, without) = (excess(usual), excess(variant("no-turn-limit")));
    assert!(with > 0.03 && without < 0.5 * with, "{with} {without}");
    for (slow, fast, name) in [
        (Row::Reactive, Row::Plan, "no-posts"),
        (Row::MostlyReactive, Row::MostlyPlan, "constant-speed"),
    ] {
        let (with, without) = (ratio(slow, fast, usual), ratio(slow, fast, variant(name)));
        assert!(with > 1.0 && without < 1.0, "{name}: {with} {without}");
    }
}

/// With one goal for all, robots without regard to communication meet at it (c), and reactive ones
/// never find room there.
#[test]
fn a_common_goal_keeps_reactive_robots_together() {
    let trials = run(&[Row::Reactive], 1, variant("common-goal"));
    let share = mean(&trials, Row::Reactive, Metric::OneNetwork);
    assert!(share > 0.35 && trials[0].unfinished > 0, "{trials:?}");
}

/// W37: the same trial with waits only, in which two robots never move again, and with time-outs and
/// steps aside.
#[test]
fn w37_a_team_that_only_waits_locks_and_one_that_steps_aside_does_not() {
    let only = |variation| {
        let (rows, shard) = (vec![Row::Serial], (75, 76));
        let one = Campaign { rows, trials: 76, seed: 2, field: 1, variation, shard };
        one.run(&|| ()).expect("the missions are sound").remove(0)
    };
    let (locked, usual) = (only(variant("waits-only")), only(Variation::default()));
    assert!(locked.unfinished >= 2, "{locked:?}");
    assert_eq!(usual.unfinished, 0, "{usual:?}");
}

fn command(folder: &Path, arguments: &str) -> (i32, String, String) {
    let program = setup::built("harness", "experiment", "dev", None).expect("the program is built");
    let mut command = Command::new(program);
    let Output { status, stdout, stderr } =
        command.args(arguments.split(' ')).current_dir(folder).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (status.code().expect("no signal"), text(stdout), text(stderr))
}

/// The object of `--json` has these keys, and a number a trial.
#[test]
fn the_command_prints_what_programs_read() {
    let folder = tempfile::tempdir().unwrap();
    let line = "--rows plan,34:66 --trials 2 --seed 7 --field 3 --json";
    let (status, out, err) = command(folder.path(), line);
    assert_eq!(status, 0, "{err}");
    let object: Value = serde_json::from_str(&out).expect("it is JSON");
    let rows = object["rows"].as_array().expect("a list of rows");
    let names: Vec<&str> = rows.iter().filter_map(|row| row["name"].as_str()).collect();
    assert_eq!(names, ["34:66", "plan"], "in the order of the paper's table");
    for row in rows {
        let keys: Vec<&str> = row.as_object().unwrap().keys().map(String::as_str).collect();
        let mut expected = vec!["name", "unfinished", "unfinished_robots", "connectivity"];
        let lists = ["time_s", "distance_m", "connected_s", "one_network", "coverage_m2"];
        expected.extend(lists.into_iter().chain(["coverage_disc_m2"]));
        expected.sort_unstable();
        assert_eq!(keys, expected);
        for list in lists.into_iter().chain(["coverage_disc_m2"]) {
            let numbers: Vec<f64> = serde_json::from_value(row[list].clone()).unwrap();
            assert!(numbers.len() == 2 && numbers.iter().all(|&number| number > 0.0), "{row}");
        }
        assert_eq!(row["unfinished"], 0);
        assert_eq!(row["unfinished_robots"], serde_json::json!([0, 0]), "one number a trial");
        let shares: Vec<f64> = serde_json::from_value(row["connectivity"].clone()).unwrap();
        assert!(shares.len() == 2 && shares.iter().all(|share| (0.0..=1.0).contains(share)));
    }
}

#[test]
fn shards_of_the_command_merge_into_the_file_of_one_run() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let run = |more: &str| command(at, &format!("--rows 66:34 --trials 3 --seed 7 {more}"));
    let whole = run("--csv whole.csv --figures figures");
    assert_eq!((whole.0, whole.2.as_str()), (0, ""));
    for shard in [1, 0] {
        assert_eq!(run(&format!("--shard {shard}/2 --csv {shard}.csv")).0, 0);
    }
    let merged = command(at, "--merge 1.csv 0.csv --csv merged.csv");
    assert_eq!(merged, whole, "the same table");
    let read = |name: &str| fs::read(at.join(name)).unwrap();
    assert_eq!(read("merged.csv"), read("whole.csv"));
    for figure in ["routes-66-34.svg", "time_s.svg", "coverage_m2.svg"] {
        let svg = read(&format!("figures/{figure}"));
        assert!(svg.starts_with(b"<svg"), "{figure}");
    }
    let (status, _, err) = command(at, "--merge 0.csv");
    assert!(status == 3 && err.contains("the first of them trial 1 of 66:34"), "{status} {err}");
    fs::write(
        at.join("other.csv"),
        String::from_utf8(read("whole.csv")).unwrap().replace("--seed 7", "--seed 8"),
    )
    .unwrap();
    let (status, _, err) = command(at, "--merge 0.csv other.csv");
    assert!(status == 3 && err.contains("are of different campaigns"), "{status} {err}");
}

#[test]
fn wrong_command_lines_and_files_have_their_status() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("notes.txt"), "hello\n").unwrap();
    for (arguments, status, message) in [
        ("--trials 0", 2, "0 is not in 1..=1000000"),
        ("--rows reactive,serail", 2, "not a row; the rows are reactive, 66:34"),
        ("--shard 4/4", 2, "write I/N with I below N"),
        ("--variant windy", 2, "not a variant; the variants are"),
        ("--beyond --variant no-posts", 2, "cannot be used with"),
        ("--merge notes.txt --rows plan", 2, "cannot be used with"),
        ("--merge gone.csv", 3, "gone.csv: "),
        ("--merge notes.txt", 3, "notes.txt: line 1: not a file that cargo experiment --csv wrote"),
        ("--csv gone/all.csv", 3, "the folder does not exist"),
    ] {
        let (ended, out, err) = command(folder.path(), arguments);
        assert!(ended == status && out.is_empty() && err.contains(message), "{arguments}: {err}");
    }
}
