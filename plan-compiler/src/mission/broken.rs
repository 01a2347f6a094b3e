//! Names whose definitions have a mistake. A reference to them is not another mistake.

use super::{KEYS, Mission, SECTIONS, tidy_name};
use crate::behaviours::TABLES;
use maps::names::nearest;
use toml_edit::TableLike;

/// Keeps the names that a file defines, but wrongly: goals, layers, and all names in a table whose
/// own name is misspelt.
pub(super) fn keep(file: &dyn TableLike, mission: &mut Mission) {
    for (table, item) in file.iter() {
        let meant = section_meant(table).unwrap_or(table);
        let is_misspelt = meant != table;
        let names = item.as_table_like().into_iter().flat_map(|table| table.iter());
        for (name, _) in names {
            match meant {
                "goals" | "layers" => {
                    let name = tidy_name(name).unwrap_or(name.trim()).to_owned();
                    mission.behaviours.of_map.push(name);
                }
                _ if is_misspelt && TABLES.contains(&meant) => {
                    mission.behaviours.keep_broken(name);
                }
                _ => {}
            }
        }
    }
    // The plan to follow, if it stands in the file but could not be understood.
    if let Some(plan) = &mission.plan {
        let is_written = mission.behaviours.of_map.contains(&plan.name);
        let goals = mission.goals.iter().flatten();
        if is_written && !goals.into_iter().any(|goal| goal.name == plan.name) {
            mission.plan = None;
        }
    }
}

/// The section that a misspelt one is reported to mean.
fn section_meant(table: &str) -> Option<&'static str> {
    let keys = || KEYS.iter().filter(|key| key.section.is_empty()).map(|key| key.name);
    let sections = || SECTIONS.iter().chain(&TABLES).copied();
    let known = || keys().chain(sections());
    if known().any(|known| known == table) {
        return None;
    }
    nearest(table, known()).filter(|meant| sections().any(|section| section == *meant))
}

#[cfg(test)]
mod tests {
    use crate::behaviours::{PlanNames, Plans, compile};
    use crate::mission::parse;
    use maps::problem::Source;
    use std::sync::Arc;

    /// The mistakes in a mission for a map with the plan `base`, one a line.
    fn mistakes(text: &str) -> Vec<String> {
        let text = format!(
            "{text}\n[inputs]\nbattery = {{ source = 'battery', missing = {{ then = 0 }} }}\n\
             [behaviours.rest]\ncriticality = {{ battery = 'PB PM PM NB NB NB NB' }}\n\
             [frames]\nrest = {{ productions = ['entry -> go home -> exit'] }}\n"
        );
        let source = Arc::new(Source { name: "m.mission.toml".into(), text });
        let (mission, mut problems) = parse(&source);
        let plans = vec![PlanNames { name: "base".into(), layers: vec!["physical".into()] }];
        compile(&mission.behaviours, &Plans::Known(plans), &mut problems);
        problems.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn a_mistake_in_a_goal_is_not_another_one_where_the_goal_is_named() {
        let home = "[actions]\n'go home' = { do = 'follow home' }\n[goals]\nbase = [1, 2]\n";
        assert_eq!(mistakes(home), ["there is no parallel plan `home`"]);
        let wrong = [
            ("home = [12, 12, 3]", "goal `home` is not a position"),
            ("home = 'geo:95,3'", "goal `home` is not a place on the globe"),
            ("home = { at = [1, 2], lat = 3 }", "goal `home` has its position twice"),
        ];
        for (line, message) in wrong {
            let all = mistakes(&format!("{home}{line}\n"));
            assert_eq!(all.len(), 1, "{line} {all:?}");
            assert!(all[0] == message || line.contains("lat ="), "{all:?}");
        }
    }

    #[test]
    fn a_misspelt_table_is_one_mistake() {
        let rest = "'go home' = { do = 'hold 1 s', until = ['full'], delete = ['at(1, 2)'] }\n";
        let facts = "full = { input = 'battery', at_least = 0.9 }\n\
                     'at(x, y)' = { near = ['{x}', '{y}'], within = 1 }\n";
        let all = mistakes(&format!("[fact]\n{facts}[actions]\n{rest}"));
        assert_eq!(all, ["`fact` is not a key of a mission"]);
        let all = mistakes(&format!("[action]\n{rest}[facts]\n{facts}"));
        assert_eq!(all, ["`action` is not a key of a mission"]);
        let all = mistakes("[goal]\nhome = [1, 2]\n[actions]\n'go home' = { do = 'follow home' }");
        assert_eq!(all, ["`goal` is not a key of a mission"]);
    }

    #[test]
    fn a_plan_to_follow_with_a_mistake_in_its_goal_is_one_mistake() {
        let text = "plan = 'home'\n[goals]\nhome = [1]\nbase = [1, 2]\n";
        let source = Arc::new(Source { name: "m.mission.toml".into(), text: text.into() });
        let (mission, problems) = parse(&source);
        assert_eq!(problems.len(), 1);
        assert!(mission.plan.is_none());
    }
}
