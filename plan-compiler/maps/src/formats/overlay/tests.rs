//! Overlay text in, map out; mistakes are in `mistakes`.

mod mistakes;

use super::*;
use crate::formats::dump::{dump, outcome};
use insta::assert_snapshot;
use proptest::prelude::*;

fn check(text: &str) -> String {
    let source = Arc::new(Source { name: "a.ovl".into(), text: text.into() });
    outcome(&read(&source))
}

/// Measures on an otherwise empty map of 100 m by 100 m.
fn measures(text: &str) -> String {
    check(&format!("MISSION-AREA 100 100\nCONTROL MEASURES:\n{text}\n"))
}

/// Every statement of the language.
const EVERYTHING: &str = r#"
SCENARIO "every statement"
SITE nowhere
--RESOLUTION 0.5
MISSION-AREA 200 100.5
ORIGIN 1 -2
HEADING 90
GLOBAL_REF_POINT 33.7756 -84.399
LOAD-MAP "some.mapinfo"
HEIGHTMAP some.hm 256 256 50 1e0
SET ZOOM-FACTOR 150
SCALE 2
CONTROL MEASURES:
OBSTACLE 10 10 2
OBSTACLE 20 10 2 5
OBJECT 30 10 2 FIXED blue
OBJECT 40 10 2 MOVABLE "light blue"
OBJECT 40 10 2 CONTAINER green
WALL w1* 0 0 10 0 10 20
WALL "w 2" 0 5 10 5 3.5
WALL w3 7 8
BOUNDARY b 0 0 10 10
BOUNDARY "myNoCommZone1" 0 0 10 0 10 10
BOUNDARY NoFlyZone 0 0 10 0 10 10
BOUNDARY WeatherZone-2* 0 0 10 0 10 10
PP StartPlace* 5 5 0.2
PP Goal 50 50
PP "Far Away *" 500 -50 3
PP Goal* 51 51
PP "" 1 1
GAP g 0 0 1 1
GAP "g" 0 0 1 1 40
AA a 0 0 1 0 1 1
ATK a 0 0 50
BP a 0 0
OBJ a 0 0 1 0 1 1 50
AXIS a 0 0 1 1 100
LDLC l 0 0 1 1
LD/LC l 0 0 1 1
PL l 0 0 1 1
ROOM r 0 0 1 0 1 1
DOOR d 0 0 1 1
HALLWAY h CENTERLINE 0 0 9 0 WIDTH 2 EXTENTS 0 1 9 1 9 -1 0 -1
BASKET 1 1
ATTRACTOR 1 1 0.2
WAYPOINT-FILE "way.points"
"#;

#[test]
fn every_statement_is_understood() {
    assert_snapshot!(check(EVERYTHING), @r#"
    extent 0,0 + 200,100.5
    title "every statement"
    resolution 0.5
    reference 33.7756 -84.399 at 100,50.25 heading 90
    remark site nowhere
    remark background some.mapinfo
    remark heightmap some.hm
    Obstacle "" circle 11,8 radius 2
    Obstacle "" circle 21,8 radius 2 high 5
    Obstacle "" circle 31,8 radius 1
    Obstacle "w1" line 1,-2 11,-2 11,18
    Obstacle "w 2" line 1,3 11,3 high 3.5
    Obstacle "w3" line 8,6 8,6
    Attenuating "myNoCommZone1" polygon 1,-2 11,-2 11,8
    Zone "NoFlyZone" polygon 1,-2 11,-2 11,8
    Zone "WeatherZone-2" polygon 1,-2 11,-2 11,8
    start "StartPlace" 6,3
    point "Goal" 51,48
    point "Far Away" 501,-52
    point "Goal" 52,49
    point "" 2,-1
    "#);
}

#[test]
fn a_small_file_needs_little() {
    assert_snapshot!(check("ORIGIN 0 0 CONTROL MEASURES: PP a 1 2 PP b 3 4"), @r#"
      ☞ there is no MISSION-AREA; 1000 m by 1000 m are assumed
      help: write MISSION-AREA width height above CONTROL MEASURES:

    extent 0,0 + 1000,1000
    point "a" 1,2
    point "b" 3,4
    "#);
}

#[test]
fn utm_coordinates_are_relative_to_the_origin() {
    assert_snapshot!(check(
        "MISSION-AREA 20 20 ORIGIN UTM LAT 34.9999 LON 85.9999 CONTROL MEASURES:
        PP StartPlace* UTM LAT 35.0 LON 86.0 0.01
        PP here UTM LON 85.9999 LAT 34.9999
        WALL w UTM LAT 34.9999 LON 85.9999 UTM LAT 35 LON 85.9999 3"
    ), @r#"
      ☞ UTM coordinates are read as WGS-84; MissionLab itself used Clarke 1866

    extent 0,0 + 20,20
    reference 34.9999 85.9999 at 0,0 heading -0.574
    Obstacle "w" line 0,0 0.111,11.09 high 3
    start "StartPlace" 9.237,10.999
    point "here" 0,0
    "#);
}

#[test]
fn the_neighbouring_zone_continues_that_of_the_origin() {
    // One hundred-thousandth of a degree of longitude at 50 degrees north is 0.716 m.
    assert_snapshot!(check(
        "MISSION-AREA 20 20 ORIGIN UTM LAT 50 LON 5.999995 CONTROL MEASURES:
        PP next UTM LAT 50 LON 6.000005"
    ), @r#"
      ☞ UTM coordinates are read as WGS-84; MissionLab itself used Clarke 1866

    extent 0,0 + 20,20
    reference 50 5.999995 at 0,0 heading 2.299
    point "next" 0.717,0.029
    "#);
}

#[test]
fn a_plain_origin_is_subtracted_from_utm_coordinates() {
    assert_snapshot!(check(
        "MISSION-AREA 20 20 ORIGIN 444140 3684706 CONTROL MEASURES:
        PP here UTM LAT 33.3 LON 44.4"
    ), @r#"
      ☞ UTM coordinates are read as WGS-84; MissionLab itself used Clarke 1866

    extent 0,0 + 20,20
    reference 33.3 44.4 at 0.545,0.356 heading -0.329
    point "here" 0.545,0.356
    "#);
}

#[test]
fn plain_coordinates_under_a_utm_origin_are_warned_about_once() {
    assert_snapshot!(check(
        "MISSION-AREA 20 20
ORIGIN UTM LAT 33.3 LON 44.4
CONTROL MEASURES:
PP here 1 2
PP there 3 4"
    ), @r#"
      ⚠ plain coordinates under a UTM ORIGIN lie hundreds of kilometres away
       ╭─[a.ovl:4:9]
     3 │ CONTROL MEASURES:
     4 │ PP here 1 2
       ·         ─┬─
       ·          ╰── the origin's easting and northing are added to this
     5 │ PP there 3 4
       ╰────
      help: write these coordinates as UTM too, or the ORIGIN as plain numbers

      ☞ UTM coordinates are read as WGS-84; MissionLab itself used Clarke 1866

    extent 0,0 + 20,20
    reference 33.3 44.4 at 0,0 heading -0.329
    point "here" 444141.545,3684708.356
    point "there" 444143.545,3684710.356
    "#);
}

#[test]
fn an_odd_number_at_the_end_is_height_or_width() {
    assert_snapshot!(measures("WALL a 1 2 3 4 5 WALL b 1 2 3\n4\nPP c 1 2 3"), @r#"
    extent 0,0 + 100,100
    Obstacle "a" line 1,2 3,4 high 5
    Obstacle "b" line 1,2 3,4
    point "c" 1,2
    "#);
}

proptest! {
    #[test]
    fn any_text_gives_a_map_or_mistakes(text in "\\PC{0,200}") {
        check(&text);
    }

    #[test]
    fn any_soup_of_tokens_gives_a_map_or_mistakes(
        soup in prop::collection::vec(
            prop::sample::select(vec![
                "CONTROL", "MEASURES:", "MEASURES", ":", "WALL", "PP", "OBSTACLE", "OBJECT", "FIXED",
                "BOUNDARY", "HALLWAY", "CENTERLINE", "WIDTH", "EXTENTS", "ORIGIN", "UTM", "LAT",
                "LON", "HEADING", "GLOBAL_REF_POINT", "MISSION-AREA", "SET", "ZOOM-FACTOR", "GAP",
                "\"", "\"a\"", "a*", "*", "--", "\n", "1", "-2.5", "1e308", ".", "#", "StartPlace",
                "NoFlyZone", "--RESOLUTION 1\n", "\u{e9}",
            ]),
            0..60,
        ),
        glue in prop::sample::select(vec![" ", "", "\n"]),
    ) {
        check(&soup.join(glue));
    }

    #[test]
    fn case_white_space_and_comments_change_nothing(
        seed in prop::collection::vec((any::<bool>(), 0usize..6), 1..50),
    ) {
        let mut text = String::from("--RESOLUTION 0.5\n");
        let mut choices = seed.iter().cycle();
        let mut rest = EVERYTHING;
        // Token by token: keywords in either case, any separator between tokens.
        while let Some(token) = next_token(&mut rest) {
            let &(lower, gap) = choices.next().unwrap();
            let is_keyword = grammar::form_of(token).is_some()
                || ["CONTROL", "MEASURES:", "FIXED", "CENTERLINE", "WIDTH", "EXTENTS"].contains(&token);
            text.push_str(&if lower && is_keyword { token.to_lowercase() } else { token.into() });
            text.push_str([" ", "\n", "\t \r\n", " -- a \"comment\n", "\n\n--PP x 1 2\n ", "\u{c} "][gap]);
        }
        let map = |text: &str| {
            let source = Arc::new(Source { name: "a.ovl".into(), text: text.into() });
            let (map, problems) = read(&source);
            prop_assert!(problems.is_empty(), "{problems:?}\n{text}");
            Ok(dump(&map.unwrap()))
        };
        prop_assert_eq!(map(&text)?, map(EVERYTHING)?);
    }
}

/// Cuts the first token off, comments left out.
fn next_token<'a>(rest: &mut &'a str) -> Option<&'a str> {
    *rest = rest.trim_start();
    while rest.starts_with("--") {
        *rest = rest.split_once('\n').map_or("", |(_, after)| after).trim_start();
    }
    let length = match rest.strip_prefix('"') {
        Some(quoted) => quoted.find('"')? + 2,
        None => rest.find(char::is_whitespace).unwrap_or(rest.len()),
    };
    let (token, after) = rest.split_at(length);
    *rest = after;
    (!token.is_empty()).then_some(token)
}

#[test]
fn obstacles_outside_the_map_are_reported() {
    let yard = |head: &str, statements: &str| {
        let text = format!("{head}\nMISSION-AREA 50 40\nCONTROL MEASURES:\n{statements}\n");
        check(&text).replace('\u{2502}', " ").split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let inside = "WALL a 10 10 20 10\nOBSTACLE 30 20 3\n";
    let all = yard("ORIGIN 100 100", inside);
    let message = "\u{26a0} nothing blocks: every obstacle lies outside the map, 50 m by 40 m from (0, \
                   0); outside: WALL 1, OBSTACLE 1";
    for words in [message, "a.ovl:4:1", "ORIGIN 100 100 is added to every coordinate"] {
        assert!(all.contains(words), "{words} missing in\n{all}");
    }
    let far = "WALL b 110 10 120 10\nWALL c 110 10 120 10\nOBJECT 60 20 8 FIXED red\n\
               BOUNDARY NoFlyZone 0 41 9 41 9 50\n";
    let some = yard("", &format!("{inside}{far}"));
    for words in [
        "WALL outside the map, 50 m by 40 m from (0, 0): 2",
        "a.ovl:6:1",
        "OBJECT outside",
        "BOUNDARY outside",
    ] {
        assert!(some.contains(words), "{words} missing in\n{some}");
    }
    assert!(!some.contains("nothing blocks") && !some.contains("OBSTACLE outside"), "{some}");
    // What reaches into the map, or touches its edge, counts.
    let edge =
        "WALL d -5 20 55 20\nWALL e 50 0 60 0\nOBSTACLE 52 20 2\nOBJECT 80 80 2 MOVABLE red\n";
    for text in [yard("", inside), yard("", edge), yard("", "")] {
        assert!(!text.contains('\u{26a0}'), "{text}");
    }
}
