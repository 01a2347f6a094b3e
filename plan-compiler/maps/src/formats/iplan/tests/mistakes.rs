//! Iplan texts in, mistakes as a user sees them out.

use super::*;

#[test]
fn every_mistake_of_the_header_is_reported() {
    let header = "yard\nyard.ovl\nSORTED\nMAYBE\nTEXT\nmany\n";
    let text = TWO.replace(&TWO[..TWO.find("BEGIN_MAP").unwrap()], header);
    assert_snapshot!(check(&text), @r#"
      × the ordering is `SORTED`
       ╭─[Iplan.dat:3:1]
     2 │ yard.ovl
     3 │ SORTED
       · ───┬──
       ·    ╰── unknown word
     4 │ MAYBE
       ╰────
      help: write ORDERED or LEAST-COMMITMENT

      × whether the robots are tethered is `MAYBE`
       ╭─[Iplan.dat:4:1]
     3 │ SORTED
     4 │ MAYBE
       · ──┬──
       ·   ╰── unknown word
     5 │ TEXT
       ╰────
      help: write TRUE or FALSE

      × the number of elements is `many`, but the file has 1
       ╭─[Iplan.dat:6:1]
     5 │ TEXT
     6 │ many
       · ──┬─
       ·   ╰── this number
     7 │ BEGIN_MAP
       ╰────
      help: correct it, or add what was cut off

    extent -0.25,-0.25 + 1,1.5
    title "yard"
    resolution 0.5
    remark map-file yard.ovl
    cells 2 x 3 of 0.5 from -0.25,-0.25
      .#
      ..
      .#
    point "moveto-1" 0,1
    point "contingency" 0,0
    "#);
    assert_snapshot!(check(&TWO.replace("TEXT", "FLOAT")), @"
      × the values of this file are written as FLOAT
       ╭─[Iplan.dat:5:1]
     4 │ FALSE
     5 │ FLOAT
       · ──┬──
       ·   ╰── binary values
     6 │ 1
       ╰────
      help: have MissionLab write the plan as TEXT; FLOAT cannot be read

    no map
    ");
    assert_snapshot!(check(&TWO.replace("TEXT\n1\n", "TEXT\n")), @r#"
      × the number of elements is missing
       ╭─[Iplan.dat:6:1]
     5 │ TEXT
     6 │ BEGIN_MAP
       · ────┬────
       ·     ╰── expected before this
     7 │ yard-CONTIN
       ╰────
      help: add a line with it

    extent -0.25,-0.25 + 1,1.5
    title "yard"
    resolution 0.5
    remark map-file yard.ovl
    cells 2 x 3 of 0.5 from -0.25,-0.25
      .#
      ..
      .#
    point "moveto-1" 0,1
    point "contingency" 0,0
    "#);
}

#[test]
fn every_mistake_of_a_map_is_reported() {
    let text = TWO.replacen("2 \n3 \n0.5 \n0 \n", "2.5 \n0 \n-1 \nleft \n", 1);
    assert_snapshot!(check(&text), @r#"
      × the size along x is `2.5`
        ╭─[Iplan.dat:9:1]
      8 │ yard-CONTIN
      9 │ 2.5
        · ─┬─
        ·  ╰── expected a number of cells
     10 │ 0
        ╰────
      help: write a whole number from 1 to 16384

      × the size along y is `0`
        ╭─[Iplan.dat:10:1]
      9 │ 2.5
     10 │ 0
        · ┬
        · ╰── expected a number of cells
     11 │ -1
        ╰────
      help: write a whole number from 1 to 16384

      × the resolution is `-1`
        ╭─[Iplan.dat:11:1]
     10 │ 0
     11 │ -1
        · ─┬
        ·  ╰── not a number in this range
     12 │ left
        ╰────
      help: write a number from 0.001 to 1000

      × the goal's x is `left`
        ╭─[Iplan.dat:12:1]
     11 │ -1
     12 │ left
        · ──┬─
        ·   ╰── not a number in this range
     13 │ 0
        ╰────
      help: write a number from -1000000000 to 1000000000

    extent -0.25,-0.25 + 1,1.5
    title "yard"
    resolution 0.5
    remark map-file yard.ovl
    cells 2 x 3 of 0.5 from -0.25,-0.25
      .#
      ..
      .#
    point "moveto-1" 0,1
    "#);
    assert_snapshot!(check(&TWO.replacen("#Data\n0\n0.5\n1\n", "#Data\nx\n-1\n", 1)), @r#"
      × `x` is not a valid cell value
        ╭─[Iplan.dat:15:1]
     14 │ #Data
     15 │ x
        · ┬
        · ╰── here
     16 │ -1
        ╰────
      help: write a cost in metres, 9998 (obstacle) or 9999 (unreached)

      × `-1` is not a valid cell value
        ╭─[Iplan.dat:16:1]
     15 │ x
     16 │ -1
        · ─┬
        ·  ╰── here
     17 │ 9998
        ╰────
      help: write a cost in metres, 9998 (obstacle) or 9999 (unreached)

      × map `yard-CONTIN` has 5 values, but its sizes make 6
        ╭─[Iplan.dat:19:1]
     18 │ 9999
     19 │ 9998
        · ──┬─
        ·   ╰── its last line
     20 │ END_MAP
        ╰────
      help: correct the sizes, or the values

    extent -0.25,-0.25 + 1,1.5
    title "yard"
    resolution 0.5
    remark map-file yard.ovl
    cells 2 x 3 of 0.5 from -0.25,-0.25
      .#
      ..
      .#
    point "moveto-1" 0,1
    point "contingency" 0,0
    "#);
    assert_snapshot!(check(&TWO.replacen("#Data\n0\n", "#Data\n3\n", 1)), @r#"
      ⚠ the goal of map `yard-CONTIN` costs `3`, not 0
        ╭─[Iplan.dat:15:1]
     14 │ #Data
     15 │ 3
        · ┬
        · ╰── its cell
     16 │ 0.5
        ╰────
      help: check that the goal is in metres; the costs are planned again

    extent -0.25,-0.25 + 1,1.5
    title "yard"
    resolution 0.5
    remark map-file yard.ovl
    cells 2 x 3 of 0.5 from -0.25,-0.25
      .#
      ..
      .#
    point "moveto-1" 0,1
    point "contingency" 0,0
    "#);
    assert_snapshot!(check(&TWO.replacen("0 \n0 \n#Data\n", "0 \n#Data\n", 1)), @r#"
      × the goal's y is missing
        ╭─[Iplan.dat:13:1]
     12 │ 0
     13 │ #Data
        · ──┬──
        ·   ╰── expected before this
     14 │ 0
        ╰────
      help: add a line with it

    extent -0.25,-0.25 + 1,1.5
    title "yard"
    resolution 0.5
    remark map-file yard.ovl
    cells 2 x 3 of 0.5 from -0.25,-0.25
      .#
      ..
      .#
    point "moveto-1" 0,1
    "#);
    assert_snapshot!(check(&TWO.replacen("#Data\n", "", 1)), @r#"
      × #Data is missing
        ╭─[Iplan.dat:14:1]
     13 │ 0
     14 │ 0
        · ┬
        · ╰── expected here
     15 │ 0.5
        ╰────
      help: a map begins with its name, two sizes, resolution and the goal's x and y

    extent -0.25,-0.25 + 1,1.5
    title "yard"
    resolution 0.5
    remark map-file yard.ovl
    cells 2 x 3 of 0.5 from -0.25,-0.25
      .#
      ..
      .#
    point "moveto-1" 0,1
    point "contingency" 0,0
    "#);
}

#[test]
fn maps_that_disagree_are_refused() {
    assert_snapshot!(check(&TWO.replacen("1\n0.5\n0\n9998", "9998\n0.5\n0\n1", 1)), @r#"
      × map `temp` and the first map differ in their obstacles: 2 of 6 cells
        ╭─[Iplan.dat:32:1]
     31 │ #Data
     32 │ 9998
        · ──┬─
        ·   ╰── the first such cell
     33 │ 0.5
        ╰────
      help: plan for all goals on one grid, or split the file: a blob has one grid

    extent -0.25,-0.25 + 1,1.5
    title "yard"
    resolution 0.5
    remark map-file yard.ovl
    cells 2 x 3 of 0.5 from -0.25,-0.25
      .#
      ..
      .#
    point "moveto-1" 0,1
    point "contingency" 0,0
    "#);
    assert_snapshot!(check(&TWO.replacen("0.5 \n0 \n1 \n", "1 \n0 \n2 \n", 1)), @r#"
      × map `temp` has 2 x 3 cells of 1 m, but the first map 2 x 3 cells of 0.5 m
        ╭─[Iplan.dat:25:1]
     24 │ BEGIN_MAP
     25 │ temp
        · ──┬─
        ·   ╰── this map
     26 │ 2
        ╰────
      help: plan for all goals on one grid, or split the file: a blob has one grid

    extent -0.25,-0.25 + 1,1.5
    title "yard"
    resolution 0.5
    remark map-file yard.ovl
    cells 2 x 3 of 0.5 from -0.25,-0.25
      .#
      ..
      .#
    point "moveto-1" 0,2
    point "contingency" 0,0
    "#);
}

#[test]
fn missing_and_foreign_parts_are_reported() {
    assert_snapshot!(check(TWO.strip_suffix("END_FILE\n").unwrap()), @r#"
      ⚠ the file does not end with END_FILE
        ╭─[Iplan.dat:38:8]
     37 │ 9998
     38 │ END_MAP
        ·        ▲
        ·        ╰── it ends here
        ╰────
      help: add a line END_FILE, if nothing else was cut off

    extent -0.25,-0.25 + 1,1.5
    title "yard"
    resolution 0.5
    remark map-file yard.ovl
    cells 2 x 3 of 0.5 from -0.25,-0.25
      .#
      ..
      .#
    point "moveto-1" 0,1
    point "contingency" 0,0
    "#);
    assert_snapshot!(check(TWO.strip_suffix("9998\nEND_MAP\nEND_FILE\n").unwrap()), @r#"
      × the file ends within map `temp`, after 5 of 6 values
        ╭─[Iplan.dat:36:1]
     35 │ 9998
     36 │ 9999
        · ──┬─
        ·   ╰── its last line
        ╰────
      help: copy the file again, or have MissionLab write it again: it was cut off

    extent -0.25,-0.25 + 1,1.5
    title "yard"
    resolution 0.5
    remark map-file yard.ovl
    cells 2 x 3 of 0.5 from -0.25,-0.25
      .#
      ..
      .#
    point "moveto-1" 0,1
    point "contingency" 0,0
    "#);
    assert_snapshot!(check(&TWO.replace("MOVETO", "FLYTO").replace("END_FILE", "Dear\nreader")), @r#"
      × the type of the element is `FLYTO`
        ╭─[Iplan.dat:23:1]
     22 │ START_ELEMENT
     23 │ FLYTO
        · ──┬──
        ·   ╰── unknown word
     24 │ BEGIN_MAP
        ╰────
      help: write MOVETO or RECONBUILDING

      × `Dear` is not part of a plan
        ╭─[Iplan.dat:39:1]
     38 │ END_MAP
     39 │ Dear
        · ──┬─
        ·   ╰── expected BEGIN_MAP, START_ELEMENT or END_FILE
     40 │ reader
        ╰────
      help: maps lie between BEGIN_MAP and END_MAP, elements after START_ELEMENT

      ⚠ the file does not end with END_FILE
        ╭─[Iplan.dat:40:7]
     39 │ Dear
     40 │ reader
        ·       ▲
        ·       ╰── it ends here
        ╰────
      help: add a line END_FILE, if nothing else was cut off

    extent -0.25,-0.25 + 1,1.5
    title "yard"
    resolution 0.5
    remark map-file yard.ovl
    cells 2 x 3 of 0.5 from -0.25,-0.25
      .#
      ..
      .#
    point "flyto-1" 0,1
    point "contingency" 0,0
    "#);
}
