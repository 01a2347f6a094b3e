//! Iplan texts in, map or mistakes out.

mod mistakes;

use super::*;
use crate::formats::dump::outcome;
use insta::assert_snapshot;
use proptest::prelude::*;

/// A file of two maps of 2 x 3 cells of half a metre.
const TWO: &str = "\
yard
yard.ovl
ORDERED
FALSE
TEXT
1
BEGIN_MAP
yard-CONTIN 
2 
3 
0.5 
0 
0 
#Data
0
0.5
1
9998
9999
9998
END_MAP
START_ELEMENT
MOVETO
BEGIN_MAP
temp 
2 
3 
0.5 
0 
1 
#Data
1
0.5
0
9998
9999
9998
END_MAP
END_FILE
";

fn check(text: &str) -> String {
    let source = Arc::new(Source { name: "Iplan.dat".into(), text: text.into() });
    outcome(&read(&source))
}

#[test]
fn columns_come_one_by_one_from_the_south() {
    assert!(recognises(TWO));
    assert_snapshot!(check(TWO), @r#"
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
fn line_ends_and_blank_lines_change_nothing() {
    let plain = check(TWO);
    for text in [TWO.replace('\n', "\r\n"), TWO.replace('\n', "\n\n"), TWO.trim_end().into()] {
        assert!(recognises(&text));
        assert_eq!(check(&text), plain);
    }
}

#[test]
fn goals_are_named_by_type_and_number() {
    let map = &TWO[TWO.rfind("BEGIN_MAP").unwrap()..TWO.find("END_FILE").unwrap()];
    let recon = format!("START_ELEMENT\nRECONBUILDING\n1 2 3 4\n{map}{map}5 6 7 8\nEND_FILE\n");
    let text = TWO.replace("TEXT\n1\n", "TEXT\n2\n").replace("END_FILE\n", &recon);
    assert_snapshot!(check(&text), @r#"
    extent -0.25,-0.25 + 1,1.5
    title "yard"
    resolution 0.5
    remark map-file yard.ovl
    cells 2 x 3 of 0.5 from -0.25,-0.25
      .#
      ..
      .#
    point "moveto-1" 0,1
    point "reconbuilding-2-1" 0,1
    point "reconbuilding-2-2" 0,1
    point "contingency" 0,0
    "#);
}

#[test]
fn a_flood_of_wrong_values_is_cut() {
    let (_, problems) = {
        let values = "x\n".repeat(100_000);
        let text = TWO.replacen("#Data\n", &format!("#Data\n{values}"), 1);
        read(&Arc::new(Source { name: "Iplan.dat".into(), text }))
    };
    assert_eq!(problems.len(), MAX_VALUES_REPORTED + 2);
    assert_eq!(
        problems[MAX_VALUES_REPORTED].message,
        "99980 more of its lines are not valid cell values"
    );
}

proptest! {
    #[test]
    fn no_text_makes_it_panic(
        text in "(BEGIN_MAP|#Data|END_MAP|START_ELEMENT|MOVETO|END_FILE|[0-9]{1,3}|\n|\\PC){0,40}"
    ) {
        recognises(&text);
        check(&text);
        check(&TWO.replacen("9998\n", &text, 1));
    }

    /// Losing any line is reported or changes nothing.
    #[test]
    fn a_lost_line_is_reported(lost in 2_usize..35) {
        let lines: Vec<&str> = TWO.lines().collect();
        let kept = lines.iter().enumerate().filter(|(index, _)| *index != lost);
        let text: Vec<&str> = kept.map(|(_, line)| *line).collect();
        let source = Source { name: "Iplan.dat".into(), text: text.join("\n") };
        let (_, problems) = read(&Arc::new(source));
        prop_assert!(!problems.is_empty(), "{}", lines[lost]);
    }
}
