//! OPAR text in, map or mistakes out.

use super::*;
use crate::formats::dump::outcome;
use insta::assert_snapshot;
use proptest::prelude::*;

fn check_with(options: &OparOptions, text: &str) -> String {
    let source = Arc::new(Source { name: "a.opar".into(), text: text.into() });
    outcome(&read(&source, options))
}

fn check(text: &str) -> String {
    check_with(&OparOptions::default(), text)
}

/// One value per line.
fn lines(values: &str) -> String {
    values.split_whitespace().collect::<Vec<_>>().join("\n")
}

/// Sections 1 to 4 of a square of 100 m, then obstructions.
fn farm(obstructions: &str) -> String {
    let head = "Farm 51 7 4 0 0 100 0 100 100 0 100 0.9 1.1 14 0.45 0.284 1 1.33 0.284 0.588";
    lines(&format!("{head} {obstructions}"))
}

const BARN: &str = "1 6.5 51.0001 7.0001 4 0 0 25 0 25 12 0 12";
const WOOD: &str = "2 9 51.0005 7.0005 3 0 0 20 0 0 20";

#[test]
fn a_scenario_becomes_a_map() {
    assert_snapshot!(check(&farm(&format!("{BARN} {WOOD}"))), @r#"
    extent 0,0 + 100,100
    title "Farm"
    reference 51 7 at 0,0 heading 0
    boundary 0,0 100,0 100,100 0,100
    radio k 0.9 1.1 cutoff 14 near 0.45 0.284 1 far 1.33 0.284 0.588
    Obstacle "obstruction 1" polygon 7.02,11.125 32.02,11.125 32.02,23.125 7.02,23.125 high 6.5
    Attenuating "obstruction 2" polygon 35.099,55.624 55.099,55.624 35.099,75.624 high 9
    start "reference" 0,0
    "#);
}

#[test]
fn separators_and_annotations_change_nothing() {
    let plain = farm(&format!("{BARN} {WOOD}"));
    let mut lines = plain.lines();
    let mut decorated = format!("# made by hand\n\n  # SECTION 1\n{}\n", lines.next().unwrap());
    for (i, line) in lines.enumerate() {
        decorated.push_str(["", "# note 5\n", "\r\n", "OBSTRUCTION\n", "2nd part\n"][i % 5]);
        decorated.push_str(&format!(" {line}\t{}\r\n", ["", "metres 7", "# east"][i % 3]));
    }
    assert_eq!(check(&decorated), check(&plain));
}

#[test]
fn a_title_may_begin_with_a_number_or_be_left_out() {
    let plain = farm(BARN);
    let renamed = check(&plain.replacen("Farm", "3 blocks", 1));
    assert_eq!(renamed, check(&plain).replace("Farm", "3 blocks"));
    let untitled = check(plain.strip_prefix("Farm\n").unwrap());
    assert_eq!(untitled, check(&plain).replace("title \"Farm\"\n", ""));
}

#[test]
fn options_say_what_the_file_leaves_open() {
    let plain = farm(&format!("{BARN} 7 3 51.0005 7.0005 3 0 0 20 0 0 20"));
    let types = vec!["7=foliage".parse().unwrap(), "1=foliage".parse().unwrap()];
    let options = OparOptions { order: DeltaOrder::NorthEast, types, ..Default::default() };
    assert_snapshot!(check_with(&options, &plain), @r#"
    extent 0,0 + 100,100
    title "Farm"
    reference 51 7 at 0,0 heading 0
    boundary 0,0 0,100 100,100 100,0
    radio k 0.9 1.1 cutoff 14 near 0.45 0.284 1 far 1.33 0.284 0.588
    Attenuating "obstruction 1" polygon 7.02,11.125 7.02,36.125 19.02,36.125 19.02,11.125 high 6.5
    Attenuating "obstruction 2" polygon 35.099,55.624 35.099,75.624 55.099,55.624 high 3
    start "reference" 0,0
    "#);

    let degrees =
        "Farm 51 7 3 0 0 0.001 0 0 0.001 1 1 14 1 1 1 1 1 1 1 5 51.0001 7.0001 3 0 0 1e-4 0 0 1e-4";
    let options = OparOptions { units: DeltaUnit::Degrees, ..Default::default() };
    assert_snapshot!(check_with(&options, &lines(degrees)), @r#"
    extent 0,0 + 70.198,111.248
    title "Farm"
    reference 51 7 at 0,0 heading 0
    boundary 0,0 70.198,0 0,111.248
    radio k 1 1 cutoff 14 near 1 1 1 far 1 1 1
    Obstacle "obstruction 1" polygon 7.02,11.125 14.04,11.125 7.02,22.25 high 5
    start "reference" 0,0
    "#);
}

#[test]
fn deltas_in_the_other_unit_are_refused() {
    let degrees =
        "Farm 51 7 3 0 0 0.001 0 0 0.001 1 1 14 1 1 1 1 1 1 1 5 51.0001 7.0001 3 0 0 1e-4 0 0 1e-4";
    assert_snapshot!(check(&lines(degrees)), @r#"
      × the deltas look like degrees, not metres
       ╭─[a.opar:5:1]
     4 │ 3
     5 │ 0
       · ┬
       · ╰── none is larger than 0.001
     6 │ 0
       ╰────
      help: if they are degrees, pass --opar-units deg

    extent 0,0 + 0.001,0.001
    title "Farm"
    reference 51 7 at 0,0 heading 0
    boundary 0,0 0.001,0 0,0.001
    radio k 1 1 cutoff 14 near 1 1 1 far 1 1 1
    Obstacle "obstruction 1" polygon 7.02,11.125 7.02,11.125 7.02,11.125 high 5
    start "reference" 0,0
    "#);
    let options = OparOptions { units: DeltaUnit::Degrees, ..Default::default() };
    assert_snapshot!(check_with(&options, &farm("")), @r#"
      × the deltas look like metres, not degrees
       ╭─[a.opar:5:1]
     4 │ 4
     5 │ 0
       · ┬
       · ╰── the largest is 100
     6 │ 0
       ╰────
      help: if they are metres, omit --opar-units deg

    extent 0,0 + 7019767.767,11124827.693
    title "Farm"
    reference 51 7 at 0,0 heading 0
    boundary 0,0 7019767.767,0 7019767.767,11124827.693 0,11124827.693
    radio k 0.9 1.1 cutoff 14 near 0.45 0.284 1 far 1.33 0.284 0.588
    start "reference" 0,0
    "#);
}

#[test]
fn a_file_that_ends_early_says_before_what() {
    assert_snapshot!(check("Farm"), @r#"
      × the file ends before the latitude of the area
       ╭─[a.opar:1:1]
     1 │ Farm
       · ──┬─
       ·   ╰── nothing follows this
       ╰────
      help: add what is missing, or check the counts of delta pairs above

    no map
    "#);
    assert_snapshot!(check("Farm\n51\n7"), @r#"
      × the file ends before the number of delta pairs of the area
       ╭─[a.opar:3:1]
     2 │ 51
     3 │ 7
       · ┬
       · ╰── nothing follows this
       ╰────
      help: add what is missing, or check the counts of delta pairs above

    no map
    "#);
    assert_snapshot!(check(&lines("Farm 51 7 4 0 0 100 0 100 100")), @r#"
      × the file ends before the last delta of the area
       ╭─[a.opar:4:1]
     3 │ 7
     4 │ 4
       · ┬
       · ╰── 4 pairs expected, but 6 numbers follow
     5 │ 0
       ╰────
      help: correct the count, or add the missing deltas

    no map
    "#);
    assert_snapshot!(check(&lines("Farm 51 7 3 0 0 100 0 100 100 1 1 14")), @r#"
      × the file ends before a1
        ╭─[a.opar:13:1]
     12 │ 1
     13 │ 14
        · ─┬
        ·  ╰── nothing follows this
        ╰────
      help: add what is missing, or check the counts of delta pairs above

    no map
    "#);
    assert_snapshot!(check(&farm("1 6.5 51.0001")), @r#"
      × the file ends before the longitude of obstruction 1
        ╭─[a.opar:24:1]
     23 │ 6.5
     24 │ 51.0001
        · ───┬───
        ·    ╰── nothing follows this
        ╰────
      help: add what is missing, or check the counts of delta pairs above

    extent 0,0 + 100,100
    title "Farm"
    reference 51 7 at 0,0 heading 0
    boundary 0,0 100,0 100,100 0,100
    radio k 0.9 1.1 cutoff 14 near 0.45 0.284 1 far 1.33 0.284 0.588
    start "reference" 0,0
    "#);
}

#[test]
fn counts_must_be_counts_and_fit_the_file() {
    assert_snapshot!(check(&lines("Farm 51 7 1000000000 0 0 100")), @r#"
      × the file ends before the last delta of the area
       ╭─[a.opar:4:1]
     3 │ 7
     4 │ 1000000000
       · ─────┬────
       ·      ╰── 1000000000 pairs expected, but 3 numbers follow
     5 │ 0
       ╰────
      help: correct the count, or add the missing deltas

    no map
    "#);
    assert_snapshot!(check(&lines("Farm 51 7 1e300 0 0 100")), @r#"
      × the file ends before the last delta of the area
       ╭─[a.opar:4:1]
     3 │ 7
     4 │ 1e300
       · ──┬──
       ·   ╰── 1e300 pairs expected, but 3 numbers follow
     5 │ 0
       ╰────
      help: correct the count, or add the missing deltas

    no map
    "#);
    assert_snapshot!(check(&lines("Farm 51 7 3.5 0 0 100")), @r#"
      × the number of delta pairs of the area is not a count
       ╭─[a.opar:4:1]
     3 │ 7
     4 │ 3.5
       · ─┬─
       ·  ╰── must be a whole number
     5 │ 0
       ╰────
      help: check it, and that no number above is missing or surplus

    no map
    "#);
    assert_snapshot!(check(&lines("Farm 51 7 -4 0 0 100")), @r#"
      × the number of delta pairs of the area is not a count
       ╭─[a.opar:4:1]
     3 │ 7
     4 │ -4
       · ─┬
       ·  ╰── must be a whole number
     5 │ 0
       ╰────
      help: check it, and that no number above is missing or surplus

    no map
    "#);
    assert_snapshot!(check(&farm("1 6.5 51.0001 7.0001 2 0 0 25 0")), @r#"
      × obstruction 1 has fewer than three points
        ╭─[a.opar:26:1]
     25 │ 7.0001
     26 │ 2
        · ┬
        · ╰── a polygon needs at least three delta pairs
     27 │ 0
        ╰────
      help: add delta pairs, or leave the record out

    extent 0,0 + 100,100
    title "Farm"
    reference 51 7 at 0,0 heading 0
    boundary 0,0 100,0 100,100 0,100
    radio k 0.9 1.1 cutoff 14 near 0.45 0.284 1 far 1.33 0.284 0.588
    start "reference" 0,0
    "#);
}

#[test]
fn every_mistake_is_reported_at_once() {
    let text = "Farm\n151\n7\n3\n0\n0\n100\n0\n100\n100,5\n0.9\n1.1\n14\n1\n1\n1\n1\n1\n1\n";
    assert_snapshot!(check(text), @r#"
      × the latitude of the area is not on the globe
       ╭─[a.opar:2:1]
     1 │ Farm
     2 │ 151
       · ─┬─
       ·  ╰── must be -90 to 90 degrees
     3 │ 7
       ╰────
      help: latitude comes first: the two may be swapped

      × 100,5 is not a number
        ╭─[a.opar:10:1]
      9 │ 100
     10 │ 100,5
        · ──┬──
        ·   ╰── a value must come first on its line
     11 │ 0.9
        ╰────
      help: write a number as 12, -0.5 or 1.2e3, with a point

    extent 0,0 + 100,100.5
    title "Farm"
    boundary 0,0 100,0 100,100.5
    radio k 0.9 1.1 cutoff 14 near 1 1 1 far 1 1 1
    start "reference" 0,0
    "#);
    assert_snapshot!(
        check(&farm("3 6.5 51.0001 7.0001 3 0 0 25 0 25 12 1 4 51.0001 207 3 0 0 1e10 0 25 12 1 4 52 7 3 0 0 25 0 25 12")),
        @r#"
      × obstruction 1 has an unknown type
        ╭─[a.opar:22:1]
     21 │ 0.588
     22 │ 3
        · ┬
        · ╰── known types are 1 (building) and 2 (foliage)
     23 │ 6.5
        ╰────
      help: state what it is: --opar-type 3=building, or =foliage

      × the longitude of obstruction 2 is not on the globe
        ╭─[a.opar:36:1]
     35 │ 51.0001
     36 │ 207
        · ─┬─
        ·  ╰── must be -180 to 180 degrees
     37 │ 3
        ╰────
      help: check it, and the count of delta pairs before it

      × a delta of obstruction 2 is too large
        ╭─[a.opar:40:1]
     39 │ 0
     40 │ 1e10
        · ──┬─
        ·   ╰── beyond the largest map
     41 │ 0
        ╰────
      help: check it, and the count of delta pairs before it

      ⚠ obstruction 3 lies outside the area
        ╭─[a.opar:46:1]
     45 │ 4
     46 │ 52
        · ─┬
        ·  ╰── its position begins here
     47 │ 7
        ╰────
      help: check its latitude and longitude against section 2

    extent 0,0 + 100,100
    title "Farm"
    reference 51 7 at 0,0 heading 0
    boundary 0,0 100,0 100,100 0,100
    radio k 0.9 1.1 cutoff 14 near 0.45 0.284 1 far 1.33 0.284 0.588
    Obstacle "obstruction 1" polygon 7.02,11.125 32.02,11.125 32.02,23.125 high 6.5
    Obstacle "obstruction 2" polygon -11231628.427,11.125 9988768371.573,11.125 -11231603.427,23.125 high 4
    Obstacle "obstruction 3" polygon 0,111248.277 25,111248.277 25,111260.277 high 4
    start "reference" 0,0
    "#
    );
    assert_snapshot!(check(&lines("Farm 51 7 3 0 0 100 0 200 0 1 1 14 1 1 1 1 1 1")), @r#"
      × the area is empty
       ╭─[a.opar:2:1]
     1 │ Farm
     2 │ 51
       · ─┬
       ·  ╰── its delta pairs lie on one line
     3 │ 7
       ╰────
      help: check the delta pairs of section 2

    extent 0,0 + 200,0
    title "Farm"
    reference 51 7 at 0,0 heading 0
    boundary 0,0 100,0 200,0
    radio k 1 1 cutoff 14 near 1 1 1 far 1 1 1
    start "reference" 0,0
    "#);
}

#[test]
fn types_are_written_number_equals_kind() {
    let parse = |text: &str| text.parse::<ObstructionType>();
    let building = ObstructionType { number: 3, kind: ObstructionKind::Building };
    assert_eq!(parse("3=Building"), Ok(building));
    for wrong in ["3", "=foliage", "x=foliage", "3=tree", "-1=foliage", "1.5=foliage"] {
        assert!(parse(wrong).unwrap_err().contains("write N=building"), "{wrong}");
    }
}

proptest! {
    #[test]
    fn any_text_gives_a_map_or_mistakes(text in "\\PC{0,200}") {
        recognises(&text);
        check(&text);
    }

    #[test]
    fn any_soup_of_values_gives_a_map_or_mistakes(
        soup in prop::collection::vec(
            prop::sample::select(vec![
                "0", "1", "2", "3", "4", "51.0", "-7", "1e9", "1e308", "-0", "0.5", "100", "nan", "inf",
                "# x", "", "word", "12,5", "7 seven", "+", ".", "\u{e9}",
            ]),
            0..80,
        ),
        newline in prop::sample::select(vec!["\n", "\r\n", "\r"]),
    ) {
        let text = soup.join(newline);
        recognises(&text);
        check(&text);
        check(&farm(&text));
    }
}
