//! The team of a mission: its robots, and what each of them does otherwise.
//!
//! `[team]` names the robots; `[robots.NAME]` has tables like the mission's own, which replace or
//! complete those for that robot. So robots share maps, plans and most of their behaviours, and one
//! file gives a blob for each.

use crate::toml::{Report, Spanned, Text, key_span};
use plan_format::limits::{MAX_NAME_BYTES, MAX_ROBOTS};
use toml_edit::{Item, Table, TableLike, Value};

/// Time between two packets of a mate, seconds: `runtime::link` sends them.
const NEWS_PERIOD_S: f64 = 0.2;

/// The robots of a mission, and the one that it is read for.
#[derive(Clone, Debug, Default)]
pub struct Team {
    /// Their names, by their numbers; empty without a team.
    pub robots: Vec<Text>,
    /// The number of the robot that the mission was read for.
    pub robot: usize,
}

impl Team {
    /// The number of a robot.
    pub fn number(&self, name: &str) -> Option<usize> {
        self.robots.iter().position(|robot| robot.value == name)
    }

    /// Names of the robots other than the one that the mission was read for.
    pub fn mates(&self) -> impl Iterator<Item = &str> + Clone {
        let robots = self.robots.iter().enumerate();
        robots.filter(|(index, _)| *index != self.robot).map(|(_, name)| name.as_str())
    }

    /// The numbers of those robots, one bit each.
    pub fn mate_bits(&self) -> u8 {
        let robots = (0..self.robots.len()).filter(|index| *index != self.robot);
        robots.fold(0, |bits, index| bits | 1 << index)
    }
}

/// The file for one robot of its team, and the team.
///
/// Mistakes: a robot that the team does not have, or none where there is a team; names that cannot
/// be those of robots; parts for robots that do not exist.
pub(crate) fn part(file: &Table, robot: Option<&str>, report: &mut Report<'_>) -> (Table, Team) {
    let mut part = file.clone();
    let parts = part.remove("robots");
    let robots = names(file, report);
    let mut team = Team { robots, robot: 0 };
    if team.robots.is_empty() {
        // A team whose names have mistakes has been reported.
        let is_alone = file.get("team").is_none();
        if let Some(robot) = robot.filter(|_| is_alone) {
            let message = format!("there is no robot `{robot}`: the mission has no team");
            let help = "leave --robot out, or add [team] with robots = [\"NAME\", \"NAME\"]";
            report.error(message, &(0..0), "this mission", help);
        }
        if parts.is_some() && is_alone {
            let help = "add [team] with robots = [\"NAME\", \"NAME\"]";
            let span = key_span(file, "robots");
            report.error("[robots] has parts for a team that is not named", &span, "here", help);
        }
        return (part, team);
    }
    let place = file.get("team").and_then(Item::as_table_like);
    let place = place.map_or(0..0, |team| key_span(team, "robots"));
    match robot.map(|name| (name, team.number(name))) {
        Some((name, Some(number))) => {
            team.robot = number;
            untie(&mut part, name);
        }
        Some((name, None)) => {
            let known = team.robots.iter().map(Text::as_str);
            let name = Spanned { value: name.to_owned(), span: place };
            report.unknown("robot", &name, known, &one_of(&team));
        }
        None => {
            let message = format!(
                "the mission is for a team of {} robots, and each needs a blob of its own",
                team.robots.len()
            );
            report.error(message, &place, "this team", &one_of(&team));
        }
    }
    if let Some(parts) = &parts {
        add_part(&mut part, parts, &team, report);
    }
    check_silence(&part, report);
    (part, team)
}

/// Removes a tether of the whole team that leads to the robot itself: it is for its mates.
fn untie(part: &mut Table, robot: &str) {
    let Some(team) = part.get_mut("team").and_then(Item::as_table_like_mut) else { return };
    let mate = team.get("tether").and_then(Item::as_str).map(str::trim);
    if mate == Some(robot) {
        team.remove("tether");
    }
}

/// How to choose a robot.
fn one_of(team: &Team) -> String {
    let options: Vec<String> =
        team.robots.iter().map(|name| format!("--robot '{}'", name.as_str())).collect();
    format!("add {}", options.join(" or "))
}

/// The names in `team.robots`.
fn names(file: &Table, report: &mut Report<'_>) -> Vec<Text> {
    let Some(team) = file.get("team").and_then(Item::as_table_like) else { return Vec::new() };
    let example = "robots = [\"left\", \"right\"]";
    let Some(item) = team.get("robots") else {
        let span = key_span(file, "team");
        report.error("[team] does not name its robots", &span, "here", &format!("add {example}"));
        return Vec::new();
    };
    let span = item.span().unwrap_or_else(|| key_span(team, "robots"));
    let values = item.as_array().map(|array| array.iter().collect::<Vec<&Value>>());
    let texts = values.as_deref().unwrap_or_default().iter().filter_map(|value| {
        let name = value.as_str()?.trim().to_owned();
        Some(Spanned { value: name, span: value.span().unwrap_or_else(|| span.clone()) })
    });
    let texts: Vec<Text> = texts.collect();
    let expected = "a list of two robots or more, by their names";
    let Some(values) = values else {
        report.wrong_type("team.robots", item, &span, expected, example);
        return Vec::new();
    };
    if let Some(value) = values.iter().find(|value| value.as_str().is_none()) {
        let (span, item) = (value.span().unwrap_or(span), Item::Value((*value).clone()));
        report.wrong_type("team.robots", &item, &span, expected, example);
        return Vec::new();
    }
    if texts.len() < 2 {
        let message = format!("`team.robots` must be {expected}");
        let help = "add the others, or remove [team] from the mission of a single robot";
        report.error(message, &span, "too few", help);
        return Vec::new();
    }
    if let Some(text) = texts.get(MAX_ROBOTS) {
        let message = format!("a team has at most {MAX_ROBOTS} robots, not {}", texts.len());
        report.error(message, &text.span, "one too many", "make two teams of them");
    }
    let mut good: Vec<Text> = Vec::new();
    for text in texts.into_iter().take(MAX_ROBOTS) {
        let is_word = matches!(text.as_str(), "all" | "any" | "nearest" | "");
        if is_word || text.value.len() > MAX_NAME_BYTES {
            let message = format!("`{}` cannot be the name of a robot", text.as_str());
            let label = if is_word { "a word of the language" } else { "too long" };
            report.error(message, &text.span, label, "choose another name");
        } else if good.iter().any(|other| other.value == text.value) {
            let message = format!("two robots are called `{}`", text.as_str());
            report.error(message, &text.span, "the second one", "choose another name");
        } else {
            good.push(text);
        }
    }
    good
}

/// Adds the part of the team's robot.
fn add_part(part: &mut Table, parts: &Item, team: &Team, report: &mut Report<'_>) {
    let Some(parts) = parts.as_table_like() else {
        let span = parts.span().unwrap_or(0..0);
        report.wrong_type("robots", parts, &span, "a section", "[robots.NAME]");
        return;
    };
    for (name, item) in parts.iter() {
        let span = key_span(parts, name);
        let Some(own) = item.as_table_like() else {
            let path = format!("robots.{name}");
            report.wrong_type(&path, item, &span, "a section", &format!("[{path}]"));
            continue;
        };
        if let Some(team) = own.get("team").and_then(Item::as_table_like)
            && team.contains_key("robots")
        {
            let message = "the robots of a team are the same for all of them";
            let help = "name them in [team] only, and remove this line";
            report.error(message, &key_span(team, "robots"), "in one robot's part", help);
        }
        let dotted = format!("{name}.");
        let dotted = team.robots.iter().find(|robot| robot.value.starts_with(&dotted));
        if team.number(name).is_some() {
            if team.robots.get(team.robot).is_some_and(|robot| robot.value == name) {
                merge(part, own);
            }
        } else if let Some(robot) = dotted {
            let message = format!("there is no robot `{name}`: a name with a dot needs quotes");
            let help = format!("write [robots.{:?}]", robot.as_str());
            report.error(message, &span, "not a robot", &help);
        } else {
            let known = team.robots.iter().map(Text::as_str);
            let name = Spanned { value: name.to_owned(), span };
            report.unknown("robot", &name, known, "add it to team.robots, or remove this part");
        }
    }
}

/// Warns of a link that is lost between two packets of a mate.
fn check_silence(part: &Table, report: &mut Report<'_>) {
    let Some(team) = part.get("team").and_then(Item::as_table_like) else { return };
    let Some(item) = team.get("lost_after") else { return };
    let number = item.as_float().or_else(|| item.as_integer().map(|whole| whole as f64));
    if number.is_some_and(|seconds| 0.0 < seconds && seconds <= NEWS_PERIOD_S) {
        let span = item.span().unwrap_or_else(|| key_span(team, "lost_after"));
        let message = format!(
            "the link to a mate is lost between two packets: mates send every {NEWS_PERIOD_S} s"
        );
        let help = "give at least 0.4, which bridges one lost packet; the default is 0.75";
        report.warning(message, &span, "too short", help);
    }
}

/// Puts the items of a robot's part over those of the mission: tables are merged, other values
/// replaced. Keys and values keep their places in the file.
fn merge(base: &mut dyn TableLike, part: &dyn TableLike) {
    for (name, item) in part.iter() {
        let inner = base.get_mut(name).and_then(Item::as_table_like_mut);
        match (inner, item.as_table_like()) {
            (Some(inner), Some(item)) => merge(inner, item),
            _ => {
                base.remove(name);
                if let Some(key) = part.key(name) {
                    base.entry_format(key).or_insert(item.clone());
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::mission::{GoalAt, parse_for};
    use maps::problem::Source;
    use std::sync::Arc;

    const TEAM: &str = r#"
[team]
robots = ["left", "right"]
[goals]
meet = [30, 10]
[vehicle]
radius = 0.4
max_speed = 2.0
[robots.left.goals]
home = [1, 2]
[robots.right]
vehicle.radius = 0.6
goals = { meet = [31, 10], home = [50, 2] }
[robots.right.team]
tether = "left"
"#;

    fn read(text: &str, robot: Option<&str>) -> (crate::mission::Mission, Vec<String>) {
        let source = Arc::new(Source { name: "m".into(), text: text.into() });
        let (mission, problems) = parse_for(&source, robot);
        let text = |problem: &maps::problem::Problem| {
            let line = problem
                .place
                .as_ref()
                .map_or(0, |place| 1 + source.text[..place.span.start].matches('\n').count());
            format!("{line}: {problem}")
        };
        (mission, problems.iter().map(text).collect())
    }

    /// W49: robots of one team differ in goals, bodies and parameters.
    #[test]
    fn w49_each_robot_has_what_is_shared_and_its_own_part() {
        let of = |robot| {
            let (mission, problems) = read(TEAM, Some(robot));
            assert_eq!(problems, [""; 0], "{robot}");
            let goals = mission.goals.unwrap_or_default();
            let at = |name: &str| {
                goals.iter().find(|goal| goal.name == name).map(|goal| goal.at[0].clone())
            };
            let team = mission.parameters.team;
            (at("meet"), at("home"), mission.parameters.vehicle, team)
        };
        let at = |x, y| Some(GoalAt::Position([x, y]));
        let (meet, home, vehicle, team) = of("left");
        assert_eq!((meet, home), (at(30.0, 10.0), at(1.0, 2.0)));
        assert_eq!((vehicle.radius_m, vehicle.max_speed_mps), (0.4, 2.0));
        assert_eq!((team.robot, team.robots, team.tether_to), (0, 2, None));
        let (meet, home, vehicle, team) = of("right");
        assert_eq!((meet, home), (at(31.0, 10.0), at(50.0, 2.0)));
        assert_eq!((vehicle.radius_m, vehicle.max_speed_mps), (0.6, 2.0));
        assert_eq!((team.robot, team.robots, team.tether_to), (1, 2, Some(0)));
    }

    /// A tether of the whole team is for the mates of the robot that it names; a part overrides it.
    #[test]
    fn a_robot_is_not_tethered_to_itself() {
        let text = "[team]\nrobots = [\"a\", \"b\", \"c\"]\ntether = \"a\"\n\
            [robots.c.team]\ntether = \"b\"\n";
        for (robot, mate) in [("a", None), ("b", Some(0)), ("c", Some(1))] {
            let (mission, problems) = read(text, Some(robot));
            assert_eq!((mission.parameters.team.tether_to, problems), (mate, vec![]), "{robot}");
        }
    }

    #[test]
    fn mistakes_in_a_team_have_their_lines() {
        let table: [(&str, Option<&str>, &[&str]); 16] = [
            (
                TEAM,
                None,
                &["3: the mission is for a team of 2 robots, and each needs a blob of its own"],
            ),
            (TEAM, Some("lefd"), &["3: there is no robot `lefd`"]),
            ("seed = 3\n", Some("a"), &["1: there is no robot `a`: the mission has no team"]),
            ("[robots.a]\n", None, &["1: [robots] has parts for a team that is not named"]),
            (
                "[team]\nrobots = [\"a\"]\n",
                None,
                &["2: `team.robots` must be a list of two robots or more, by their names"],
            ),
            (
                "[team]\nrobots = [\"a\", \"a\", \"all\", \"b\"]\n",
                Some("a"),
                &["2: two robots are called `a`", "2: `all` cannot be the name of a robot"],
            ),
            (
                "[team]\nrobots = [\"a\", \"b\"]\n[robots.c]\nseed = 4\n[robots.a]\nsede = 4\n",
                Some("a"),
                &["3: there is no robot `c`", "6: `sede` is not a key of a mission"],
            ),
            ("[team]\nrobots = [\"a\", \"b\"]\ntether = \"a\"\n", Some("a"), &[]),
            (
                "[team]\nrobots = [\"a\", \"b\"]\n[robots.a.team]\ntether = \"a\"\n",
                Some("a"),
                &["4: `a` is the robot itself, not a mate"],
            ),
            (
                "[team]\nrobots = [\"a\", \"b\"]\n[robots.b.team]\nrobots = [\"b\", \"a\"]\n",
                Some("a"),
                &["4: the robots of a team are the same for all of them"],
            ),
            (
                "[team]\nrobots = [\"a\", \"b\"]\n[robots.b]\ntether = \"a\"\n",
                Some("b"),
                &["4: `tether` is not a key of a mission"],
            ),
            (
                "[team]\nrobots = [3]\n",
                Some("a"),
                &["2: `team.robots` must be a list of two robots or more, by their names"],
            ),
            (
                "[team]\nrobots = [\"a\", \"rover.1\"]\n[robots.rover.1]\nseed = 4\n",
                Some("a"),
                &["3: there is no robot `rover`: a name with a dot needs quotes"],
            ),
            (
                "[team]\nrobots = [\"a\", \"b\"]\nlost_after = 0.2\n",
                Some("a"),
                &["3: the link to a mate is lost between two packets: mates send every 0.2 s"],
            ),
            (
                "[team]\nrobots = [\"a\", \"b\"]\n[robots.b.team]\nlost_after = 0.1\n",
                Some("a"),
                &[],
            ),
            ("[team]\nlost_after = 3\n", None, &["1: [team] does not name its robots"]),
        ];
        for (text, robot, expected) in table {
            assert_eq!(read(text, robot).1, expected, "{text} {robot:?}");
        }
    }

    /// What a user of one file for all robots writes first.
    #[test]
    fn what_belongs_elsewhere_is_told_where() {
        let team = "[team]\nrobots = [\"a\", \"b\"]\n";
        for (part, message, help) in [
            ("[robots.b]\ntether = \"a\"\n", "`tether` is not a key of a mission", "in [team]"),
            (
                "[facts]\nx = { linked = \"b\" }\n",
                "`b` is the robot itself, not a mate",
                "[robots.NAME.facts]",
            ),
            (
                "[inputs]\nx = { source = \"mate-distance b\", universe = [0, 9], missing = { then = 9 } }\n",
                "`b` is the robot itself, not a mate",
                "[robots.NAME.inputs]",
            ),
        ] {
            let source = Arc::new(Source { name: "m".into(), text: format!("{team}{part}") });
            let (_, problems) = parse_for(&source, Some("b"));
            assert_eq!(problems[0].to_string(), message);
            assert!(problems[0].help.as_deref().unwrap_or_default().contains(help), "{problems:?}");
        }
    }
}
