//! Tags in, meaning out.

use super::*;

fn tags(text: &str) -> Tags {
    let pairs = text.split(", ").filter_map(|tag| tag.split_once('='));
    Tags(pairs.map(|(key, value)| (key.into(), value.into())).collect())
}

fn meaning_of(rules: &TagRules, text: &str, is_point: bool) -> String {
    let tags = tags(text);
    Judge::new(rules).meaning(&tags, is_point).map_or("nothing".into(), |meaning| {
        let line = if meaning.is_line { " line" } else { "" };
        let height = tags.height_m().map_or(String::new(), |height| format!(" {height} m"));
        let point = match is_point {
            true if meaning.wants_outline => " wants an outline".into(),
            true => format!(" radius {}", meaning.radius_m),
            false => String::new(),
        };
        format!("{:?}{line} {:?}{height}{point}", meaning.role, meaning.name)
    })
}

fn check(text: &str, meaning: &str) {
    assert_eq!(meaning_of(&TagRules::default(), text, false), meaning, "{text}");
}

fn check_point(text: &str, meaning: &str) {
    assert_eq!(meaning_of(&TagRules::default(), text, true), meaning, "{text}");
}

fn rules(block: &[&str], free: &[&str], open_gates: bool) -> TagRules {
    let all = |list: &[&str]| list.iter().map(|rule| rule.parse().expect("a rule")).collect();
    TagRules { block: all(block), free: all(free), open_gates, ..TagRules::default() }
}

#[test]
fn tags_have_a_known_meaning() {
    check("building=yes, name=Shed", "Obstacle \"Shed\"");
    check("building=no", "nothing");
    check("building=", "nothing");
    check("obstacle=true", "Obstacle \"\"");
    check("obstacle=False", "nothing");
    check("building=house, height=7.5", "Obstacle \"\" 7.5 m");
    check("building=house, height=7 m, building:levels=1", "Obstacle \"\" 7 m");
    check("building=house, height=tall, building:levels=2.5", "Obstacle \"\" 7.5 m");
    check("building=house, height=-3", "Obstacle \"\"");
    check("building=house, height=inf", "Obstacle \"\"");
    check("barrier=fence", "Obstacle line \"\"");
    check("barrier=hedge, area=yes", "Obstacle \"\"");
    check("natural=wood", "Attenuating \"wood\"");
    check("landuse=forest, name=Spinney", "Attenuating \"Spinney\"");
    check("layer=NoCommZone, name=north", "Attenuating \"north\"");
    check("layer=night", "Zone \"night\"");
    check("layer=-1", "nothing");
    check("building=yes, layer=1", "Obstacle \"\"");
    check("name=Gate", "nothing");
}

#[test]
fn what_would_stop_a_rover_blocks() {
    check("natural=water", "Obstacle \"\"");
    check("waterway=stream", "Obstacle line \"\"");
    check("waterway=stream, tunnel=culvert", "nothing");
    check("building=yes, location=underground", "nothing");
    check("leisure=swimming_pool", "Obstacle \"\"");
    check("barrier=guard_rail", "Obstacle line \"\"");
    check("barrier=of_a_kind_unheard_of", "Obstacle line \"\"");
    check("barrier=kerb", "nothing");
    check("highway=steps", "Obstacle line \"\"");
    check("highway=residential", "nothing");
    check_point("natural=tree", "Obstacle \"\" radius 0.5");
    check_point("natural=tree, radius=1.5 m", "Obstacle \"\" radius 1.5");
    check_point("barrier=bollard", "Obstacle line \"\" radius 0.3");
    check_point("power=tower", "Obstacle \"\" radius 2");
    check_point("building=yes", "Obstacle \"\" wants an outline");
    check_point("barrier=toll_booth", "nothing");
}

#[test]
fn letter_case_does_not_matter() {
    check("BUILDING=YES", "Obstacle \"\"");
    check(" Barrier = Fence", "Obstacle line \"\"");
    check("barrier=wall;fence", "Obstacle line \"\"");
    check("barrier=kerb; wall", "Obstacle line \"\"");
    check("barrier=no;none", "nothing");
    check("natural=wood;water", "Obstacle \"\"");
}

#[test]
fn a_rule_with_a_value_outranks_one_without_and_block_wins_among_alike() {
    let check = |block: &[&str], free: &[&str], text: &str, expected: &str| {
        assert_eq!(
            meaning_of(&rules(block, free, false), text, false),
            expected,
            "{block:?} {free:?}"
        );
    };
    check(&[], &["natural=water", "waterway"], "natural=water, water=lake", "nothing");
    check(&[], &["natural=water", "waterway"], "waterway=river", "nothing");
    check(&["waterway=dam"], &["waterway"], "waterway=dam", "Obstacle line \"\"");
    check(&["barrier"], &["barrier=hedge"], "barrier=hedge", "nothing");
    check(&["barrier=hedge"], &["barrier=hedge"], "barrier=hedge", "Obstacle line \"\"");
    check(&["highway=*"], &[], "highway=track", "Obstacle line \"\"");
    check(&["landuse=farmland"], &[], "landuse=farmland, name=F", "Obstacle \"F\"");
    check(&["natural=wood"], &[], "natural=wood", "Obstacle \"\"");
    check(&["layer=obstacles"], &[], "Layer=Obstacles", "Obstacle \"\"");
    // One tag freed leaves the others.
    check(&[], &["natural=water"], "natural=water, barrier=fence", "Obstacle line \"\"");
}

#[test]
fn gates_are_shut_by_default() {
    let opening = |rules: &TagRules, text: &str| Judge::new(rules).opening_m(&tags(text));
    let shut = TagRules::default();
    check("barrier=gate", "Obstacle line \"\"");
    check_point("barrier=gate", "nothing");
    assert_eq!(opening(&shut, "barrier=gate"), None);
    assert_eq!(opening(&shut, "barrier=entrance, width=1.5 m"), Some(1.5));
    let open = rules(&[], &[], true);
    assert_eq!(opening(&open, "barrier=gate"), Some(GATE_WIDTH_M));
    assert_eq!(opening(&open, "barrier=lift_gate, maxwidth=3"), Some(3.0));
    assert_eq!(opening(&open, "barrier=gate, locked=yes"), None);
    assert_eq!(opening(&open, "barrier=stile"), None);
    assert_eq!(meaning_of(&open, "barrier=gate", false), "nothing");
    let freed = rules(&[], &["barrier=gate"], false);
    assert_eq!(opening(&freed, "barrier=gate, locked=yes"), Some(GATE_WIDTH_M));
    assert_eq!(opening(&rules(&["barrier=gate"], &[], true), "barrier=gate"), None);
}

#[test]
fn rules_that_match_nothing_are_reported() {
    let rules = rules(&["natural=watter"], &["waterway"], true);
    let judge = Judge::new(&rules);
    assert_eq!(judge.meaning(&tags("waterway=river"), false), None);
    let mut problems = Vec::new();
    judge.report(&mut problems);
    let reports: Vec<String> = problems.iter().map(ToString::to_string).collect();
    assert_eq!(
        reports,
        [
            "`block` natural=watter matches nothing on the map",
            "`open_gates` has no effect: the map has no gates"
        ]
    );
    for wrong in ["", "=water", "natural=", "*", "nat*=water"] {
        assert!(wrong.parse::<TagRule>().is_err(), "{wrong}");
    }
}

#[test]
fn unused_objects_are_listed_by_kind() {
    let mut unused = Unused::default();
    for text in ["highway=track, name=a", "highway=track", "Layer=Walls, id=3", "name=x", ""] {
        unused.add(&tags(text));
    }
    assert_eq!(unused.list(), "highway=track 2, Layer=Walls 1, name=x 1, no tags 1");
    (0..100).for_each(|n| unused.add(&tags(&format!("shop={n:02}"))));
    assert!(unused.list().ends_with("shop=07 1 and others 92"), "{}", unused.list());
}

#[test]
fn what_lies_on_the_ground_has_no_height() {
    let check = |text: &str, block: &[&str], expected: Option<f64>| {
        let rules = rules(block, &[], false);
        let meaning = Judge::new(&rules).meaning(&tags(text), false).expect("an obstacle");
        let height_m = meaning.height_m.map(|height| (height * 1e6).round() / 1e6);
        assert_eq!(height_m, expected, "{text}");
    };
    check("natural=water", &[], Some(0.0));
    check("waterway=canal", &[], Some(0.0));
    check("railway=rail", &[], Some(0.0));
    check("landuse=farmland", &["landuse=farmland"], Some(0.0));
    check("waterway=dam", &[], None);
    check("building=yes", &[], None);
    check("barrier=wall", &[], None);
    check("natural=wood", &[], None);
    check("waterway=canal, height=2", &[], Some(2.0));
    check("building=yes, building:levels=3", &[], Some(9.0));
    check("building=yes, height=22 m, building:levels=3", &[], Some(22.0));
    check("building=yes, height=10 ft", &[], Some(3.048));
    check("building=yes, height=5'", &[], Some(1.524));
    check("building=yes, height=5'6\"", &[], Some(1.6764));
    check("building=yes, height=tall, building:levels=2", &[], Some(6.0));
}
