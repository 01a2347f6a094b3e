//! Overlay text in, mistakes as a user sees them out.

use super::{check, measures};
use insta::assert_snapshot;

#[test]
fn misspelt_keywords_are_named_with_the_one_meant() {
    assert_snapshot!(measures("WAL a 1 2 3 4\nOBSTICLE 1 2 3\nTREE 1 2\nPP b 5 6"), @r#"
      × WAL is not a keyword
       ╭─[a.ovl:3:1]
     2 │ CONTROL MEASURES:
     3 │ WAL a 1 2 3 4
       · ─┬─
       ·  ╰── expected a keyword such as WALL or PP
     4 │ OBSTICLE 1 2 3
       ╰────
      help: did you mean WALL?

      × OBSTICLE is not a keyword
       ╭─[a.ovl:4:1]
     3 │ WAL a 1 2 3 4
     4 │ OBSTICLE 1 2 3
       · ────┬───
       ·     ╰── expected a keyword such as WALL or PP
     5 │ TREE 1 2
       ╰────
      help: did you mean OBSTACLE?

      × TREE is not a keyword
       ╭─[a.ovl:5:1]
     4 │ OBSTICLE 1 2 3
     5 │ TREE 1 2
       · ──┬─
       ·   ╰── expected a keyword such as WALL or PP
     6 │ PP b 5 6
       ╰────
      help: remove it, or put -- in front to make it a comment

    extent 0,0 + 100,100
    point "b" 5,6
    "#);
}

#[test]
fn missing_parts_of_a_statement_are_named() {
    assert_snapshot!(measures(
        "WALL a\nOBSTACLE 1 2\nPP\nPP b 1\nBOUNDARY c 1 2 3\nOBJECT 1 2 3 LOOSE blue\nOBJECT 1 2 3 FIXED\nPP d 7 8"
    ), @r#"
      × WALL lacks its coordinates
       ╭─[a.ovl:3:6]
     2 │ CONTROL MEASURES:
     3 │ WALL a
       ·      ┬
       ·      ╰── expected the coordinates, found the end of the line
     4 │ OBSTACLE 1 2
       ╰────
      help: write WALL name x y x y ... [height]

      × OBSTACLE lacks its radius
       ╭─[a.ovl:4:12]
     3 │ WALL a
     4 │ OBSTACLE 1 2
       ·            ┬
       ·            ╰── expected the radius, found the end of the line
     5 │ PP
       ╰────
      help: write OBSTACLE x y radius [height]

      × PP lacks its name
       ╭─[a.ovl:5:1]
     4 │ OBSTACLE 1 2
     5 │ PP
       · ─┬
       ·  ╰── expected the name, found the end of the line
     6 │ PP b 1
       ╰────
      help: write PP name x y [diameter]

      × PP lacks its y coordinate
       ╭─[a.ovl:6:6]
     5 │ PP
     6 │ PP b 1
       ·      ┬
       ·      ╰── expected the y coordinate, found the end of the line
     7 │ BOUNDARY c 1 2 3
       ╰────
      help: write PP name x y [diameter]

      × BOUNDARY has an odd number of coordinates
       ╭─[a.ovl:7:16]
     6 │ PP b 1
     7 │ BOUNDARY c 1 2 3
       ·                ┬
       ·                ╰── this x has no y
     8 │ OBJECT 1 2 3 LOOSE blue
       ╰────
      help: write BOUNDARY name x y x y ...

      × OBJECT lacks its FIXED or MOVABLE or CONTAINER
       ╭─[a.ovl:8:14]
     7 │ BOUNDARY c 1 2 3
     8 │ OBJECT 1 2 3 LOOSE blue
       ·              ──┬──
       ·                ╰── expected the FIXED or MOVABLE or CONTAINER, found LOOSE
     9 │ OBJECT 1 2 3 FIXED
       ╰────
      help: write OBJECT x y diameter FIXED|MOVABLE|CONTAINER colour

      ⚠ OBJECT lacks its colour
        ╭─[a.ovl:9:14]
      8 │ OBJECT 1 2 3 LOOSE blue
      9 │ OBJECT 1 2 3 FIXED
        ·              ──┬──
        ·                ╰── expected the colour after this
     10 │ PP d 7 8
        ╰────
      help: add a colour; MissionLab requires it, planning does not use it

    extent 0,0 + 100,100
    Obstacle "" circle 1,2 radius 1.5
    point "d" 7,8
    "#);
}

#[test]
fn surplus_parts_of_a_statement_are_named() {
    assert_snapshot!(measures("PP b 1 2 3 4\nOBSTACLE 1 2 3 4 5\nPP d 7 8 \"m\""), @r#"
      × 4 is not part of a statement
       ╭─[a.ovl:3:12]
     2 │ CONTROL MEASURES:
     3 │ PP b 1 2 3 4
       ·            ┬
       ·            ╰── expected a keyword such as WALL or PP
     4 │ OBSTACLE 1 2 3 4 5
       ╰────
      help: the statement before it is complete: remove it, or add the keyword it lacks

      × 5 is not part of a statement
       ╭─[a.ovl:4:18]
     3 │ PP b 1 2 3 4
     4 │ OBSTACLE 1 2 3 4 5
       ·                  ┬
       ·                  ╰── expected a keyword such as WALL or PP
     5 │ PP d 7 8 "m"
       ╰────
      help: the statement before it is complete: remove it, or add the keyword it lacks

      × "m" is not part of a statement
       ╭─[a.ovl:5:10]
     4 │ OBSTACLE 1 2 3 4 5
     5 │ PP d 7 8 "m"
       ·          ─┬─
       ·           ╰── expected a keyword such as WALL or PP
       ╰────
      help: the statement before it is complete: remove it, or add the keyword it lacks

    extent 0,0 + 100,100
    Obstacle "" circle 1,2 radius 3 high 4
    point "b" 1,2
    point "d" 7,8
    "#);
}

#[test]
fn names_that_cannot_be_bare_are_explained() {
    assert_snapshot!(measures("GAP Door 1 2 3 4 5\nPP 3rdFloor 1 2\nPP 7 1 2\nPP d 7 8"), @r#"
      × Door is a keyword and cannot be a bare name
       ╭─[a.ovl:3:5]
     2 │ CONTROL MEASURES:
     3 │ GAP Door 1 2 3 4 5
       ·     ──┬─
       ·       ╰── the name of GAP
     4 │ PP 3rdFloor 1 2
       ╰────
      help: put it in quotes: "Door"

      × 3rdFloor is not a name
       ╭─[a.ovl:4:4]
     3 │ GAP Door 1 2 3 4 5
     4 │ PP 3rdFloor 1 2
       ·    ────┬───
       ·        ╰── a bare name begins with a letter
     5 │ PP 7 1 2
       ╰────
      help: put it in quotes: "3rdFloor"

      × PP lacks its name
       ╭─[a.ovl:5:4]
     4 │ PP 3rdFloor 1 2
     5 │ PP 7 1 2
       ·    ┬
       ·    ╰── expected the name, found the number 7
     6 │ PP d 7 8
       ╰────
      help: write PP name x y [diameter]

    extent 0,0 + 100,100
    point "d" 7,8
    "#);
}

#[test]
fn damaged_tokens_are_reported_once() {
    assert_snapshot!(measures("PP \"a 1 2\nPP b 1.2.3 4\nPP c, 5 6\nPP d 1e999 2\nPP e 7 8"), @r#"
      × a quoted name is not closed
       ╭─[a.ovl:3:4]
     2 │ CONTROL MEASURES:
     3 │ PP "a 1 2
       ·    ───┬──
       ·       ╰── no closing quote on this line
     4 │ PP b 1.2.3 4
       ╰────
      help: close the name with " on the same line

      × 1.2.3 is not a number
       ╭─[a.ovl:4:6]
     3 │ PP "a 1 2
     4 │ PP b 1.2.3 4
       ·      ──┬──
       ·        ╰── more than one point
     5 │ PP c, 5 6
       ╰────
      help: write a number as 12, -0.5 or 1.2e3

      ⚠ "," means nothing here
       ╭─[a.ovl:5:5]
     4 │ PP b 1.2.3 4
     5 │ PP c, 5 6
       ·     ┬
       ·     ╰── skipped
     6 │ PP d 1e999 2
       ╰────
      help: remove it, or put the name that it belongs to in quotes

      × 1e999 is not a number
       ╭─[a.ovl:6:6]
     5 │ PP c, 5 6
     6 │ PP d 1e999 2
       ·      ──┬──
       ·        ╰── too large
     7 │ PP e 7 8
       ╰────
      help: write a number as 12, -0.5 or 1.2e3

    extent 0,0 + 100,100
    point "c" 5,6
    point "e" 7,8
    "#);
}

#[test]
fn coordinates_must_be_on_the_globe_and_finite() {
    assert_snapshot!(check(
        "GLOBAL_REF_POINT 95 0\nORIGIN 1 0\nMISSION-AREA 0 10\nCONTROL MEASURES:\nPP a 1e10 0\nPP b UTM LAT 10 LON 190\nPP c UTM LAT 10 LON 20\nPP d UTM LAT 10 LON 120\nPP e UTM LAT 10 20"
    ), @r#"
      × this place is not on the globe
       ╭─[a.ovl:1:1]
     1 │ GLOBAL_REF_POINT 95 0
       · ──────────┬──────────
       ·           ╰── latitude is -90 to 90, longitude -180 to 180 degrees
     2 │ ORIGIN 1 0
       ╰────
      help: if the two are swapped, write GLOBAL_REF_POINT 0 95

      × MISSION-AREA is empty
       ╭─[a.ovl:3:1]
     2 │ ORIGIN 1 0
     3 │ MISSION-AREA 0 10
       · ────────┬────────
       ·         ╰── width and height must be above zero
     4 │ CONTROL MEASURES:
       ╰────
      help: write MISSION-AREA width height, in metres

      × this coordinate is too large
       ╭─[a.ovl:5:6]
     4 │ CONTROL MEASURES:
     5 │ PP a 1e10 0
       ·      ───┬──
       ·         ╰── with ORIGIN applied
     6 │ PP b UTM LAT 10 LON 190
       ╰────
      help: check both

      × this place is not on the globe
       ╭─[a.ovl:6:6]
     5 │ PP a 1e10 0
     6 │ PP b UTM LAT 10 LON 190
       ·      ─────────┬────────
       ·               ╰── latitude is -90 to 90, longitude -180 to 180 degrees
     7 │ PP c UTM LAT 10 LON 20
       ╰────
      help: check the numbers, and that the latitude comes first; west and south are negative

      × this place is too far from the map's UTM zone
       ╭─[a.ovl:8:6]
     7 │ PP c UTM LAT 10 LON 20
     8 │ PP d UTM LAT 10 LON 120
       ·      ─────────┬────────
       ·               ╰── more than 30 degrees away, or at a pole
     9 │ PP e UTM LAT 10 20
       ╰────
      help: check latitude, longitude and their signs against ORIGIN

      × UTM lacks its word LON
       ╭─[a.ovl:9:17]
     8 │ PP d UTM LAT 10 LON 120
     9 │ PP e UTM LAT 10 20
       ·                 ─┬
       ·                  ╰── expected the word LON, found the number 20
       ╰────
      help: write UTM LAT latitude LON longitude

      ☞ UTM coordinates are read as WGS-84; MissionLab itself used Clarke 1866

    extent 0,0 + 1000,1000
    reference 10 20 at 390398.227,1105578.589 heading -0.174
    point "c" 390398.227,1105578.589
    "#);
}

#[test]
fn impossible_shapes_are_refused() {
    assert_snapshot!(measures("OBSTACLE 1 2 -3\nOBSTACLE 1 2 1e300\nOBJECT 1 2 -3 FIXED blue\nBOUNDARY NoFlyZone 1 2 3 4"), @r#"
      × the circle's size is invalid
       ╭─[a.ovl:3:14]
     2 │ CONTROL MEASURES:
     3 │ OBSTACLE 1 2 -3
       ·              ─┬
       ·               ╰── below zero
     4 │ OBSTACLE 1 2 1e300
       ╰────
      help: write it in metres

      × the circle's size is invalid
       ╭─[a.ovl:4:14]
     3 │ OBSTACLE 1 2 -3
     4 │ OBSTACLE 1 2 1e300
       ·              ──┬──
       ·                ╰── too large
     5 │ OBJECT 1 2 -3 FIXED blue
       ╰────
      help: write it in metres

      × the circle's size is invalid
       ╭─[a.ovl:5:12]
     4 │ OBSTACLE 1 2 1e300
     5 │ OBJECT 1 2 -3 FIXED blue
       ·            ─┬
       ·             ╰── below zero
     6 │ BOUNDARY NoFlyZone 1 2 3 4
       ╰────
      help: write it in metres

      × a zone needs at least three points
       ╭─[a.ovl:6:1]
     5 │ OBJECT 1 2 -3 FIXED blue
     6 │ BOUNDARY NoFlyZone 1 2 3 4
       · ─────────────┬────────────
       ·              ╰── its name makes it a zone
       ╰────
      help: add points, or rename the line

    extent 0,0 + 100,100
    "#);
}

#[test]
fn the_two_sections_are_kept_apart() {
    assert_snapshot!(check("ORIGIN 0 0\nPP a 1 2\nMISSION-AREA 10 10\nPP b 3 4"), @r#"
      × PP stands before CONTROL MEASURES:
       ╭─[a.ovl:2:1]
     1 │ ORIGIN 0 0
     2 │ PP a 1 2
       · ─┬
       ·  ╰── the first control measure
     3 │ MISSION-AREA 10 10
       ╰────
      help: write CONTROL MEASURES: on the line above it

      × MISSION-AREA stands after CONTROL MEASURES:
       ╭─[a.ovl:3:1]
     2 │ PP a 1 2
     3 │ MISSION-AREA 10 10
       · ──────┬─────
       ·       ╰── describes the whole map
     4 │ PP b 3 4
       ╰────
      help: move MISSION-AREA above CONTROL MEASURES:

    extent 0,0 + 10,10
    point "a" 1,2
    point "b" 3,4
    "#);
    assert_snapshot!(check("MISSION-AREA 10 10\nCONTROL PP a 1 2"), @r#"
      × CONTROL lacks its word MEASURES:
       ╭─[a.ovl:2:9]
     1 │ MISSION-AREA 10 10
     2 │ CONTROL PP a 1 2
       ·         ─┬
       ·          ╰── expected the word MEASURES:, found the next statement, PP
       ╰────
      help: write CONTROL MEASURES:

    extent 0,0 + 10,10
    point "a" 1,2
    "#);
    assert_snapshot!(check("MISSION-AREA 10 10\nORIGIN 0 0"), @r#"
      × CONTROL MEASURES: is missing
       ╭─[a.ovl:2:10]
     1 │ MISSION-AREA 10 10
     2 │ ORIGIN 0 0
       ·          ┬
       ·          ╰── the file ends after this
       ╰────
      help: write CONTROL MEASURES: on a line of its own, then walls and points

    extent 0,0 + 10,10
    "#);
}

#[test]
fn facts_given_twice_and_obsolete_ones_are_warned_about() {
    assert_snapshot!(check(
        "ORIGIN 1 1 ORIGIN 1 1\nMISSION-AREA 10 10\nMISSION-AREA 20 20\nCONTROL MEASURES:\nPP StartPlace 1 2\nPP StartPlace* 3 4\nSP start 5 6"
    ), @r#"
      ⚠ MISSION-AREA is given twice with different values
       ╭─[a.ovl:3:1]
     2 │ MISSION-AREA 10 10
     3 │ MISSION-AREA 20 20
       · ─────────┬────────
       ·          ╰── this one counts
     4 │ CONTROL MEASURES:
       ╰────
      help: remove the other one

      ⚠ StartPlace is given twice
       ╭─[a.ovl:6:1]
     5 │ PP StartPlace 1 2
     6 │ PP StartPlace* 3 4
       · ─────────┬────────
       ·          ╰── ignored
     7 │ SP start 5 6
       ╰────
      help: keep one of them, or rename this one

      ⚠ SP is obsolete and ignored
       ╭─[a.ovl:7:1]
     6 │ PP StartPlace* 3 4
     7 │ SP start 5 6
       · ──────┬─────
       ·       ╰── no start place
       ╰────
      help: use PP StartPlace x y

    extent 0,0 + 20,20
    start "StartPlace" 2,3
    "#);
}
