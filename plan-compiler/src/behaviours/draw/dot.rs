//! DOT, for Graphviz and similar tools.

use super::{Drawn, LABELS};
use plan_format::mission::{Production, Symbol};
use std::fmt::Write;

/// The mission as a DOT digraph: a cluster per frame, and inside it a cluster per production. Edges
/// are the components of a production; dashed edges are protection intervals.
pub fn dot(drawn: &Drawn<'_>) -> String {
    let mission = &drawn.mission;
    let mut out = String::new();
    // Writing to a string does not fail.
    let _ = writeln!(out, "digraph mission {{");
    let _ = writeln!(out, "  rankdir=LR; compound=true; fontname=\"Helvetica\";");
    let _ = writeln!(out, "  node [fontname=\"Helvetica\", shape=circle, width=0.25];");
    let _ = writeln!(out, "  edge [fontname=\"Helvetica\"];");
    for (index, behaviour) in mission.behaviours().iter().enumerate() {
        let name = mission.name(behaviour.name);
        let mut lines = vec![format!("behaviour {name}")];
        lines.extend(drawn.policy(&behaviour));
        lines.extend(table(drawn, behaviour.rules));
        let label = quoted(&lines.join("\n"), "\\l");
        let _ = writeln!(out, "  b{index} [shape=box, style=bold, label={label}];");
    }
    for (index, (name, rules)) in drawn.derived_inputs().enumerate() {
        let mut lines = vec![format!("input {name}")];
        lines.extend(table(drawn, rules));
        let label = quoted(&lines.join("\n"), "\\l");
        let _ = writeln!(out, "  i{index} [shape=note, label={label}];");
    }
    for (index, frame) in mission.plan_frames().iter().enumerate() {
        let _ = writeln!(out, "  subgraph cluster_f{index} {{");
        let _ = writeln!(out, "    label={};", quoted(&drawn.frame_title(&frame), "\\n"));
        for (number, production) in mission.productions_of(&frame).enumerate() {
            let title = drawn.production_title(&frame, &production);
            write_production(
                &mut out,
                drawn,
                usize::from(frame.first) + number,
                title,
                &production,
            );
        }
        let _ = writeln!(out, "  }}");
    }
    for (index, behaviour) in mission.behaviours().iter().enumerate() {
        let roots = [
            (Some(behaviour.root), ""),
            (behaviour.start_up, "start-up"),
            (behaviour.shut_down, "shut-down"),
        ];
        for (root, what) in roots {
            let Some(root) = root else { continue };
            let Some(frame) = mission.plan_frames().get(usize::from(root)) else { continue };
            let _ = writeln!(
                out,
                "  b{index} -> p{}_0 [lhead=cluster_f{root}, style=dotted, label={}];",
                frame.first,
                quoted(what, "\\n")
            );
        }
    }
    out.push_str("}\n");
    out
}

fn write_production(
    out: &mut String,
    drawn: &Drawn<'_>,
    index: usize,
    title: &str,
    production: &Production,
) {
    let mut lines: Vec<String> =
        Some(title.to_owned()).filter(|t| !t.is_empty()).into_iter().collect();
    lines.extend(production.rules.map(|rules| table(drawn, rules)).unwrap_or_default());
    let _ = writeln!(out, "    subgraph cluster_p{index} {{");
    let _ = writeln!(out, "      label={}; labeljust=l;", quoted(&lines.join("\n"), "\\l"));
    for vertex in 0..production.vertices {
        let (shape, label) = match vertex {
            0 => ("doublecircle", "entry".to_owned()),
            last if last + 1 == production.vertices => ("doublecircle", "exit".to_owned()),
            inner => ("circle", inner.to_string()),
        };
        let _ = writeln!(out, "      p{index}_{vertex} [shape={shape}, label=\"{label}\"];");
    }
    for edge in drawn.mission.edges_of(production) {
        let style = if matches!(edge.symbol, Symbol::PlanFrame(_)) { "bold" } else { "solid" };
        let name = drawn.symbol(edge.symbol);
        let text = if edge.work > 0 { format!("{name} ({})", edge.work) } else { name.to_owned() };
        let _ = writeln!(
            out,
            "      p{index}_{} -> p{index}_{} [style={style}, label={}, tooltip={}];",
            edge.from,
            edge.to,
            quoted(&text, "\\n"),
            quoted(&drawn.details(edge.symbol), "\\n")
        );
    }
    for interval in drawn.mission.intervals_of(production) {
        let colour = if interval.is_derived { "gray40" } else { "firebrick" };
        let _ = writeln!(
            out,
            "      p{index}_{} -> p{index}_{} [style=dashed, constraint=false, color={colour}, \
             fontcolor={colour}, label={}];",
            interval.from,
            interval.to,
            quoted(&drawn.condition(interval.condition), "\\n")
        );
    }
    let _ = writeln!(out, "    }}");
}

/// A rule base, one line per row.
fn table(drawn: &Drawn<'_>, rules: u16) -> Vec<String> {
    drawn
        .rows(rules)
        .iter()
        .map(|(input, labels)| {
            let labels = labels.map(|label| LABELS[label as usize]);
            format!("{input}: {}", labels.join(" "))
        })
        .collect()
}

/// A text in quotes; `line_end` is DOT's mark for a line break with an alignment.
fn quoted(text: &str, line_end: &str) -> String {
    if text.is_empty() {
        return "\"\"".into();
    }
    let escaped = text.replace('\\', "\\\\").replace('"', "\\\"");
    let mut lines = escaped.replace('\n', line_end);
    if line_end == "\\l" {
        lines.push_str(line_end);
    }
    format!("\"{lines}\"")
}
