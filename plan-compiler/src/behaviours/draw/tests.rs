//! Layout: what must never overlap.

use super::*;
use crate::behaviours::{Plans, compile, read};
use crate::team::Team;
use maps::problem::Source as File;
use std::sync::Arc;

fn section(text: &str) -> Vec<u8> {
    let source = Arc::new(File { name: "m.mission.toml".into(), text: text.into() });
    let document = toml_edit::Document::parse(text).unwrap();
    let mut problems = Vec::new();
    let syntax = read(&source, document.as_table(), &Team::default(), &mut problems);
    let draft = compile(&syntax, &Plans::Any, &mut problems);
    draft.unwrap_or_else(|| panic!("{problems:?}")).write().unwrap()
}

const SIDE_BY_SIDE: &str = r#"
[inputs.haste]
rules = { fuel = "NB NM NS ZO PS PM PB" }
[inputs.fuel]
source = "fuel"
missing = { then = 0 }
[facts]
warm = false
[actions.drive]
do = "follow gate at 66:34"
transient = ["warm"]
[actions."heat \"up\""]
do = "signal 7"
[actions.heat]
do = "signal 7"
add = ["warm"]
[actions.blink]
do = "set-output 3 on"
[frames.go]
productions = [{ graph = "entry -heat-> 1 -drive-> exit; entry -blink-> exit; entry -report-> 1", work = { drive = 4 } }]
[frames.report]
productions = ["entry -> blink2 -> exit"]
[actions.blink2]
do = "set-output 4 on"
[behaviours.go]
criticality = { haste = "PB PM PS ZO NS NM NB" }
"#;

#[test]
fn a_name_with_quotes_cannot_be_one() {
    let source = Arc::new(File { name: "m".into(), text: SIDE_BY_SIDE.into() });
    let document = toml_edit::Document::parse(SIDE_BY_SIDE).unwrap();
    let mut problems = Vec::new();
    let _ = read(&source, document.as_table(), &Team::default(), &mut problems);
    assert_eq!(problems.len(), 1, "{problems:?}");
    assert!(problems[0].message.contains("cannot be a name"));
}

#[test]
fn the_same_mission_as_dot() {
    let text = SIDE_BY_SIDE.replace("[actions.\"heat \\\"up\\\"\"]\ndo = \"signal 7\"\n", "");
    let section = section(&text);
    let mission = Mission::parse(&section).unwrap();
    let plans = ["gate".to_owned()];
    insta::assert_snapshot!(dot(&Drawn { mission, plans: &plans }), @r#"
    digraph mission {
      rankdir=LR; compound=true; fontname="Helvetica";
      node [fontname="Helvetica", shape=circle, width=0.25];
      edge [fontname="Helvetica"];
      b0 [shape=box, style=bold, label="behaviour go\lplan go\ldormant to 0.083, at once from 0.900\lhysteresis 0.02, dwell 1 s\lhaste: PB PM PS ZO NS NM NB\l"];
      i0 [shape=note, label="input haste\lfuel: NB NM NS ZO PS PM PB\l"];
      subgraph cluster_f0 {
        label="go";
        subgraph cluster_p0 {
          label=""; labeljust=l;
          p0_0 [shape=doublecircle, label="entry"];
          p0_1 [shape=circle, label="1"];
          p0_2 [shape=doublecircle, label="exit"];
          p0_0 -> p0_1 [style=solid, label="heat", tooltip="signal 7\nadd warm"];
          p0_1 -> p0_2 [style=solid, label="drive (4)", tooltip="follow gate at 66:34\ntransient warm"];
          p0_0 -> p0_2 [style=solid, label="blink", tooltip="set-output 3 on"];
          p0_0 -> p0_1 [style=bold, label="report", tooltip=""];
          p0_1 -> p0_2 [style=dashed, constraint=false, color=gray40, fontcolor=gray40, label="warm"];
        }
      }
      subgraph cluster_f1 {
        label="report";
        subgraph cluster_p1 {
          label=""; labeljust=l;
          p1_0 [shape=doublecircle, label="entry"];
          p1_1 [shape=doublecircle, label="exit"];
          p1_0 -> p1_1 [style=solid, label="blink2", tooltip="set-output 4 on"];
        }
      }
      b0 -> p0_0 [lhead=cluster_f0, style=dotted, label=""];
    }
    "#);
}

#[test]
fn the_picture_holds_every_component() {
    let text = SIDE_BY_SIDE.replace("[actions.\"heat \\\"up\\\"\"]\ndo = \"signal 7\"\n", "");
    let section = section(&text);
    let mission = Mission::parse(&section).unwrap();
    let plans = ["gate".to_owned()];
    let svg = picture(&Drawn { mission, plans: &plans });
    // Each component's box has its details as a tool tip.
    for part in ["follow gate at 66:34", "transient warm", "signal 7", "set-output 4 on"] {
        assert!(svg.contains(part), "{part} is missing");
    }
    assert!(crate::render::png(&svg).is_ok_and(|png| png.starts_with(b"\x89PNG")));
}
