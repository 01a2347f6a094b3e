//! Layer `comms` as the mission's radio makes it, and the places that it must reach.

use super::area::reach;
use super::goals;
use crate::comms::Margins;
use crate::input::Input;
use crate::mission::{Goal, RadioRule};
use maps::numbers::{metres, pair};
use maps::problem::Problem;
use maps::radio::Model;
use maps::{Bitmap, Point};
use plan_format::Grid;
use std::collections::HashSet;

/// Range of frequencies in which Weissberger's model of foliage holds, GHz.
const FOLIAGE_GHZ: std::ops::RangeInclusive<f64> = 0.23..=95.0;

/// The cells where the links that the mission needs are too weak.
pub(super) fn out_of_reach(
    input: &Input<'_>,
    rule: &RadioRule,
    grid: &Grid,
    problems: &mut Vec<Problem>,
) -> Bitmap {
    let model = Model::of(input.map, &rule.settings);
    let places = places(input, rule, &model, grid, problems);
    let none = Bitmap::new(grid.columns, grid.rows);
    if places.is_empty() {
        // The reason has been reported.
        return none;
    }
    let positions: Vec<Point> = places.iter().map(|(_, at)| *at).collect();
    Margins::of(&model, grid, &positions, rule.need, rule.threshold_db, &none)
        .below(rule.threshold_db)
}

/// The positions of the mission's places, without reports: they have been reported before.
pub(super) fn known_places(input: &Input<'_>) -> Vec<(String, Point)> {
    let rule = input.mission.radio.as_ref();
    rule.map_or(Vec::new(), |rule| goals::places(input, &rule.places, &mut Vec::new()))
}

/// The positions of a rule's places. Reports unknown and equal names; warns about places off the map
/// or under a roof, and about a frequency that the model of foliage does not cover.
pub(super) fn places(
    input: &Input<'_>,
    rule: &RadioRule,
    model: &Model,
    grid: &Grid,
    problems: &mut Vec<Problem>,
) -> Vec<(String, Point)> {
    let places = goals::places(input, &rule.places, problems);
    let mut seen = HashSet::new();
    for place in rule.places.iter().filter(|place| !seen.insert(&place.name)) {
        let message = format!("place `{}` is named twice", place.name);
        problems.push(Problem::error(message).help("give each place a name of its own"));
    }
    for (name, at) in &places {
        let given = rule.places.iter().find(|place| place.name == *name);
        problems
            .extend(unusual(name, *at, rule, model, grid).map(|problem| located(problem, given)));
    }
    let ghz = rule.settings.frequency_ghz;
    if input.map.has_attenuating_areas() && !FOLIAGE_GHZ.contains(&ghz) {
        let message = format!("the loss in foliage at {ghz} GHz is an extrapolation");
        let (low, high) = (FOLIAGE_GHZ.start(), FOLIAGE_GHZ.end());
        let help = format!("Weissberger's model holds from {low} to {high} GHz");
        problems.push(Problem::warning(message).help(help));
    }
    places
}

/// A warning about a place where an antenna is of little use.
fn unusual(name: &str, at: Point, rule: &RadioRule, model: &Model, grid: &Grid) -> Option<Problem> {
    if grid.cell_at(at[0], at[1]).is_none() {
        let message = format!("place `{name}` at {} is outside the map", pair(at));
        let help = format!("obstacles outside the map are not known; {}", reach(grid));
        return Some(Problem::warning(message).help(help));
    }
    let antenna_m = rule.settings.antenna_heights_m[0];
    let roof_m = model.roof_m(at).filter(|roof_m| *roof_m > antenna_m)?;
    let message = format!(
        "place `{name}` at {} is inside an obstacle of {} m, and its antenna only {} m high",
        pair(at),
        metres(roof_m),
        metres(antenna_m)
    );
    Some(Problem::warning(message).help("move it outside, or put its antenna on the roof"))
}

fn located(problem: Problem, place: Option<&Goal>) -> Problem {
    match place.and_then(|place| place.place.as_ref()) {
        Some(at) => problem.at(&at.source, at.span.clone(), "this place"),
        None => problem,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compile::{compile, grid, layers};
    use crate::input::Options;
    use crate::mission::{self, Mission};
    use crate::recipe;
    use crate::verify::compare;
    use maps::{Extent, Feature, Map, NamedPoint, Role, Shape, Source};
    use plan_format::{Blob, Cell};
    use std::sync::Arc;

    /// A yard of 60 x 40 m, a house in the middle and a wood in the east.
    fn yard() -> Map {
        let rectangle = |x0: f64, y0: f64, x1: f64, y1: f64| {
            Shape::Polygon(vec![vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]]])
        };
        let feature = |shape, role, name: &str| Feature {
            shape,
            role,
            name: name.into(),
            height_m: Some(9.0),
            span: 0..0,
        };
        let features = vec![
            feature(rectangle(20.0, 15.0, 30.0, 25.0), Role::Obstacle, ""),
            feature(rectangle(45.0, 0.0, 55.0, 40.0), Role::Attenuating, ""),
            feature(rectangle(0.0, 30.0, 4.0, 34.0), Role::Zone, "pond"),
        ];
        let point = |name: &str, at| NamedPoint { name: name.into(), at, span: 0..0 };
        let points = vec![point("west", [5.5, 20.5]), point("behind", [35.5, 20.5])];
        let extent = Extent { corner: [0.0, 0.0], size: [60.0, 40.0] };
        Map { features, points, ..Map::empty(extent) }
    }

    fn mission_of(text: &str) -> Mission {
        let source = Arc::new(Source { name: "m".into(), text: text.into() });
        let (mission, problems) = mission::parse(&source);
        assert!(problems.is_empty(), "{problems:?}");
        mission
    }

    const RADIO: &str = "[layers]\ncomms = ['pond']\n\
                         [radio]\nplaces = { base = 'west' }\nthreshold = 40\nantenna = 0.5\n";

    #[test]
    fn a_radio_makes_the_layer_that_comms_draws() {
        let (map, mission, options) = (yard(), mission_of(RADIO), Options::default());
        let input = Input { map: &map, source: None, mission: &mission, options: &options };
        let mut problems = Vec::new();
        let grid = grid(&input, &mut problems).unwrap();
        let stack = layers(&input, &grid, &mut problems).unwrap();
        assert!(problems.is_empty(), "{problems:?}");
        let [physical, comms] = stack.layers() else { panic!("two layers") };
        assert!(comms.terrain.nests_in(&physical.terrain));
        let rule = mission.radio.as_ref().unwrap();
        assert_eq!(rule.settings.antenna_heights_m, [1.0, 0.5]);
        let model = Model::of(&map, &rule.settings);
        let (mut weak, mut wooded) = (0, 0);
        for cell in (0..40).flat_map(|row| (0..60).map(move |column| Cell::new(column, row))) {
            let centre = grid.centre(cell);
            let is_weak = model.margin_db([5.5, 20.5], centre) < 40.0;
            // Robots have a radius of 0.3 m, so the pond blocks the cells beside it.
            let is_pond = cell.column < 5 && (29..35).contains(&cell.row);
            let expected = is_weak || is_pond || physical.terrain.blocked.get(cell);
            assert_eq!(comms.terrain.blocked.get(cell), expected, "{cell:?}");
            weak += usize::from(is_weak);
            wooded += usize::from(!expected && (46..54).contains(&cell.column));
        }
        assert!(weak > 100 && wooded > 20, "{weak} {wooded}: the wood itself is free");
    }

    #[test]
    fn a_goal_out_of_reach_has_no_layer_and_the_blob_knows_its_radio() {
        let (map, mission, options) = (yard(), mission_of(RADIO), Options::default());
        let input = Input { map: &map, source: None, mission: &mission, options: &options };
        let mut problems = Vec::new();
        let bytes = compile(&input, &|_, _| {}, &mut problems).unwrap();
        assert_eq!(problems.len(), 1, "{problems:?}");
        assert!(problems[0].message.contains("behind"), "{problems:?}");
        let blob = Blob::parse(&bytes).unwrap();
        let names = |plan: &str| -> Vec<&str> {
            blob.find(plan).unwrap().layers().map(|layer| layer.name()).collect()
        };
        assert_eq!((names("west"), names("behind")), (vec!["physical", "comms"], vec!["physical"]));
        // Without its mission, a map is compared by the recipe in the blob.
        let (mut again, mut found) = (Mission::of_no_file(), Options::default());
        recipe::of_blob(&bytes).unwrap().complete(&mut found, &mut again, false);
        let differs = |mission: &Mission| {
            let input = Input { mission, ..input };
            let expected = layers(&input, blob.grid(), &mut Vec::new()).unwrap();
            compare(&blob, &expected).count
        };
        assert_eq!(differs(&again), 0);
        again.radio.as_mut().unwrap().threshold_db = 60.0;
        assert!(differs(&again) > 0);
    }

    #[test]
    fn places_are_checked_together() {
        let text = "[radio]\nfrequency = 0.1\n\
                    places = { a = [25, 20], b = [900, 1], c = 'wset', d = 'west' }\n";
        let (map, mission, options) = (yard(), mission_of(text), Options::default());
        let input = Input { map: &map, source: None, mission: &mission, options: &options };
        let mut problems = Vec::new();
        assert!(compile(&input, &|_, _| {}, &mut problems).is_none());
        let expected = [
            "the map has no point named `wset`",
            "place `a` at (25, 20) is inside an obstacle of 9 m, and its antenna only 1 m high",
            "place `b` at (900, 1) is outside the map",
            "the loss in foliage at 0.1 GHz is an extrapolation",
        ];
        for text in expected {
            assert!(problems.iter().any(|p| p.message == text), "{text}: {problems:?}");
        }
    }
}
