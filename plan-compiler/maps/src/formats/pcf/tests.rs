//! Plans and the maps beside them in, map or mistakes out.

use super::*;
use crate::formats::dump::outcome;
use insta::assert_snapshot;
use proptest::prelude::*;

const PLAN: &str = "\
#This file stores a plan.

BEGIN_PLAN
#Plan ID
Plan
#Map File Name
yard.map
#Element Ordering
ORDERED
#Tethered
FALSE
#Plan contingency location
<1,0>
#Number of Elements
2
MOVETO
1
<2.5, 0.5>
RECONBUILDING
2
<0,0>
<0,1>
<1,1>
<0,0> <1,0> <1,1> <0,1>
anything
";

const YARD: &str = "type octile\nheight 2\nwidth 3\nmap\n.@.\n...\n";

/// Reads a plan in a folder with these files; removes the folder's path from messages.
fn check_among(files: &[(&str, &str)], text: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let source = Arc::new(Source { name: "a.pcf".into(), text: text.into() });
    let read = read(&folder.path().join("a.pcf"), &source, &ReadOptions::default());
    outcome(&read).replace(&format!("{}/", folder.path().display()), "")
}

fn check(text: &str) -> String {
    check_among(&[("yard.map", YARD)], text)
}

#[test]
fn goals_lie_in_the_map_that_is_named() {
    assert!(recognises(PLAN));
    assert_snapshot!(check(PLAN), @r#"
    extent 0,0 + 3,2
    resolution 1
    cells 3 x 2 of 1 from 0,0
      .#.
      ...
    point "moveto-1" 2.5,0.5
    point "reconbuilding-2" 0,0
    point "reconbuilding-2-left" 0,1
    point "reconbuilding-2-right" 1,1
    point "contingency" 1,0
    "#);
}

#[test]
fn folders_line_ends_and_end_marks_change_nothing() {
    let plain = check(PLAN);
    for text in [
        PLAN.replace("yard.map", "C:\\maps\\yard.map"),
        PLAN.replace("yard.map", "/home/somebody/maps/yard.map"),
        PLAN.replace('\n', "\r\n"),
        format!("{PLAN}END_PLAN\n"),
    ] {
        assert!(recognises(&text));
        assert_eq!(check(&text), plain);
    }
}

#[test]
fn an_unavailable_map_is_reported() {
    assert_snapshot!(check_among(&[], PLAN), @"
      × there is no file yard.map
       ╭─[a.pcf:7:1]
     6 │ #Map File Name
     7 │ yard.map
       · ────┬───
       ·     ╰── the map of this plan
     8 │ #Element Ordering
       ╰────
      help: put the map that the plan is for beside it, under this name

    no map
    ");
    assert_snapshot!(check_among(&[("yrad.map", YARD)], PLAN), @"
      × there is no file yard.map
       ╭─[a.pcf:7:1]
     6 │ #Map File Name
     7 │ yard.map
       · ────┬───
       ·     ╰── the map of this plan
     8 │ #Element Ordering
       ╰────
      help: did you mean yrad.map, which lies beside the plan?

    no map
    ");
    assert_snapshot!(check_among(&[("yard.map", PLAN)], PLAN), @"
      × yard.map is also a plan, not a map
       ╭─[a.pcf:7:1]
     6 │ #Map File Name
     7 │ yard.map
       · ────┬───
       ·     ╰── the map of this plan
     8 │ #Element Ordering
       ╰────
      help: name the map that the plan is for

    no map
    ");
    assert_snapshot!(check_among(&[("yard.map", "Dear reader,\n")], PLAN), @"
      × `Dear` is not part of the header
       ╭─[yard.map:1:1]
     1 │ Dear reader,
       · ──────┬─────
       ·       ╰── expected type, height, width or map
       ╰────
      help: the header is: type octile, height N, width N, map; a line each

    no map
    ");
    // A plan that names itself, and a plan by name only.
    assert_snapshot!(check_among(&[("a.pcf", "nothing")], &PLAN.replace("yard.map", "a.pcf")), @"
      × a.pcf is also a plan, not a map
       ╭─[a.pcf:7:1]
     6 │ #Map File Name
     7 │ a.pcf
       · ──┬──
       ·   ╰── the map of this plan
     8 │ #Element Ordering
       ╰────
      help: name the map that the plan is for

    no map
    ");
}

#[test]
fn every_mistake_is_reported() {
    let text = PLAN.replace("ORDERED", "SORTED").replace("<1,0>\n#N", "1,0\n#N");
    let text = text.replace("Elements\n2", "Elements\n3").replace("<2.5, 0.5>", "<2.5>");
    assert_snapshot!(check(&text), @r#"
      × the ordering is `SORTED`
        ╭─[a.pcf:9:1]
      8 │ #Element Ordering
      9 │ SORTED
        · ───┬──
        ·    ╰── unknown word
     10 │ #Tethered
        ╰────
      help: write ORDERED or LEAST-COMMITMENT

      × the contingency location is `1,0`
        ╭─[a.pcf:13:1]
     12 │ #Plan contingency location
     13 │ 1,0
        · ─┬─
        ·  ╰── expected a position
     14 │ #Number of Elements
        ╰────
      help: write <x,y> in metres

      × goal moveto-1 is `<2.5>`
        ╭─[a.pcf:18:1]
     17 │ 1
     18 │ <2.5>
        · ──┬──
        ·   ╰── expected a position
     19 │ RECONBUILDING
        ╰────
      help: write <x,y> in metres

      × the number of elements is 3, but the file has 2
        ╭─[a.pcf:15:1]
     14 │ #Number of Elements
     15 │ 3
        · ┬
        · ╰── this number
     16 │ MOVETO
        ╰────
      help: correct it, or add what was cut off

    extent 0,0 + 3,2
    resolution 1
    cells 3 x 2 of 1 from 0,0
      .#.
      ...
    point "reconbuilding-2" 0,0
    point "reconbuilding-2-left" 0,1
    point "reconbuilding-2-right" 1,1
    "#);
    assert_snapshot!(check("BEGIN_PLAN\nPlan\n"), @"
      × the name of the map file is missing
       ╭─[a.pcf:2:5]
     1 │ BEGIN_PLAN
     2 │ Plan
       ·     ▲
       ·     ╰── expected before this
       ╰────
      help: add a line for it

      × the ordering is missing
       ╭─[a.pcf:2:5]
     1 │ BEGIN_PLAN
     2 │ Plan
       ·     ▲
       ·     ╰── expected before this
       ╰────
      help: add a line for it

      × whether the robots are tethered is missing
       ╭─[a.pcf:2:5]
     1 │ BEGIN_PLAN
     2 │ Plan
       ·     ▲
       ·     ╰── expected before this
       ╰────
      help: add a line for it

      × the contingency location is missing
       ╭─[a.pcf:2:5]
     1 │ BEGIN_PLAN
     2 │ Plan
       ·     ▲
       ·     ╰── expected before this
       ╰────
      help: add a line for it

      × the number of elements is missing
       ╭─[a.pcf:2:5]
     1 │ BEGIN_PLAN
     2 │ Plan
       ·     ▲
       ·     ╰── expected before this
       ╰────
      help: add a line for it

    no map
    ");
    assert_snapshot!(check(&PLAN.replace("MOVETO\n1", "FLYTO\n1").replace("NG\n2", "NG\ntwo")), @r#"
      × `FLYTO` is not an element of a plan
        ╭─[a.pcf:16:1]
     15 │ 2
     16 │ FLYTO
        · ──┬──
        ·   ╰── here
     17 │ 1
        ╰────
      help: an element begins with MOVETO or RECONBUILDING

      × the number of the element is `two`
        ╭─[a.pcf:20:1]
     19 │ RECONBUILDING
     20 │ two
        · ─┬─
        ·  ╰── expected a whole number
     21 │ <0,0>
        ╰────
      help: write 1, 2 and so on

      × the number of elements is 2, but the file has 1
        ╭─[a.pcf:15:1]
     14 │ #Number of Elements
     15 │ 2
        · ┬
        · ╰── this number
     16 │ FLYTO
        ╰────
      help: correct it, or add what was cut off

    extent 0,0 + 3,2
    resolution 1
    cells 3 x 2 of 1 from 0,0
      .#.
      ...
    point "contingency" 1,0
    "#);
    assert_snapshot!(check_among(&[("yard.map", &YARD.replace(".@.", ".x."))], PLAN), @r#"
      × `x` is not a valid cell
       ╭─[yard.map:5:2]
     4 │ map
     5 │ .x.
       ·  ┬
       ·  ╰── row 1 from the north
     6 │ ...
       ╰────
      help: cells are . G S (free) and @ O T W (blocked)

    extent 0,0 + 3,2
    resolution 1
    cells 3 x 2 of 1 from 0,0
      .#.
      ...
    point "moveto-1" 2.5,0.5
    point "reconbuilding-2" 0,0
    point "reconbuilding-2-left" 0,1
    point "reconbuilding-2-right" 1,1
    point "contingency" 1,0
    "#);
}

proptest! {
    #[test]
    fn no_text_makes_it_panic(
        text in "(BEGIN_PLAN|MOVETO|RECONBUILDING|<[0-9]{1,3},[0-9]{1,3}>|#|[0-9]|\n|\\PC){0,40}"
    ) {
        recognises(&text);
        check_among(&[], &text);
        check_among(&[], &PLAN.replacen("MOVETO\n", &text, 1));
    }
}
