//! How the true world of a world file differs from the map.

use super::reader::{FARTHEST_M, Reader, Section};
use crate::{Difference, Missing, Placement, Point};
use maps::problem::{Place, Problem, has_errors};
use maps::{Map, Shape, formats};
use std::path::Path;

impl Reader<'_> {
    /// The difference, and where the file names each of the missing obstacles. Mistakes of the map
    /// of the truth are added to `of_truth`.
    pub(super) fn difference(
        &mut self,
        top: &Section<'_>,
        start: Point,
        folder: Option<&Path>,
        of_truth: &mut Vec<Problem>,
    ) -> (Difference, Vec<Place>) {
        let truth = self.truth(top, folder, of_truth);
        let extra = self.list(top, "extra", Self::extra).concat();
        let missing = self.list(top, "missing", Self::missing_obstacle);
        let (missing, missing_at) = missing.into_iter().unzip();
        let unmapped = self.number(top, "unmapped", (0.0, 1.0), "0.3").unwrap_or(0.0);
        let removed = self.number(top, "removed", (0.0, 1.0), "0.1").unwrap_or(0.0);
        if unmapped + removed > 1.0 {
            let at = top.get("removed").map_or(0..0, |(_, at)| at);
            let help = "lower one of them: an unmapped obstacle is there, a removed one is not";
            let message = "`unmapped` and `removed` are together more than 1";
            self.error(message, at, "more than all obstacles", help);
        }
        let placement = Placement {
            about: start,
            turn_rad: self.number(top, "turn", (-10.0, 10.0), "0.02").unwrap_or(0.0),
            scale: self.number(top, "scale", (0.01, 100.0), "1.02").unwrap_or(1.0),
            shift: self.point(top, "shift").unwrap_or_default(),
        };
        // A placement that moves nothing is the exact one.
        let is_moved = Placement { about: [0.0; 2], ..placement } != Placement::HERE;
        let placement = if is_moved { placement } else { Placement::HERE };
        (Difference { truth, extra, missing, unmapped, removed, placement }, missing_at)
    }

    /// The map that `truth` names, relative to the world file.
    fn truth(
        &mut self,
        top: &Section<'_>,
        folder: Option<&Path>,
        of_truth: &mut Vec<Problem>,
    ) -> Option<Box<Map>> {
        const HELP: &str = "write truth = \"as-built.ovl\": a map in the folder of the world file, \
                            in any format that plan-compiler reads";
        let (item, at) = top.get("truth")?;
        let Some(name) = item.as_str().filter(|name| !name.is_empty()) else {
            self.error("`truth` must be the name of a map", at, "not a name", HELP);
            return None;
        };
        let path = folder?.join(name);
        if !path.is_file() {
            let message = if path.is_dir() {
                format!("`truth` must be the name of a map, and {name:?} is a folder")
            } else {
                format!("there is no file {}", path.display())
            };
            self.error(message, at, "the map of the truth", HELP);
            return None;
        }
        let (map, mut found) = formats::read(&path, &Default::default());
        if has_errors(&found) {
            let message = format!("{} cannot be read as a map", path.display());
            let help = "the mistakes of that file are listed too";
            self.error(message, at, "the map of the truth", help);
            of_truth.append(&mut found);
            return None;
        }
        map.map(Box::new)
    }

    /// An obstacle that the map does not show.
    fn extra(&mut self, extra: &Section<'_>) -> Option<Vec<Shape>> {
        const KINDS: [&str; 3] = ["circle", "line", "polygon"];
        self.unknown_keys(extra, &KINDS);
        let given = KINDS.iter().filter(|kind| extra.get(kind).is_some()).count();
        if given != 1 {
            let help = "write circle = [X, Y, RADIUS], line = [[X, Y], ...] or polygon = [[X, Y], \
                        ...]";
            let message = format!("`{}` must be one shape", extra.path);
            self.error(message, extra.at.clone(), "not one shape", help);
            return None;
        }
        let line = self.points(extra, "line", 2).map(Shape::Polyline);
        let polygon = self.points(extra, "polygon", 3).map(|ring| Shape::Polygon(vec![ring]));
        let circle = self.circle(extra);
        Some(vec![line.or(polygon).or(circle)?])
    }

    fn circle(&mut self, extra: &Section<'_>) -> Option<Shape> {
        let (item, at) = extra.get("circle")?;
        let number = |value: &toml_edit::Value| {
            super::reader::number_of(value).filter(|number| number.abs() <= FARTHEST_M)
        };
        let numbers: Option<Vec<f64>> =
            item.as_array().and_then(|list| list.iter().map(number).collect());
        match numbers.as_deref() {
            Some(&[x, y, radius]) if radius > 0.0 => Some(Shape::Circle { centre: [x, y], radius }),
            _ => {
                let message = format!("{} must be a circle", extra.key("circle"));
                let help = "write circle = [X, Y, RADIUS] in metres; the radius is more than 0";
                self.error(message, at, "not a circle", help);
                None
            }
        }
    }

    /// Obstacles that are not there, and where the file names them.
    fn missing_obstacle(&mut self, missing: &Section<'_>) -> Option<(Missing, Place)> {
        self.unknown_keys(missing, &["name", "at", "within"]);
        let place = Place {
            source: self.source.clone(),
            span: missing.at.clone(),
            label: "not on the map".to_owned(),
        };
        let named = missing.get("name").map(|(item, at)| (item.as_str().map(str::to_owned), at));
        let found = match named {
            Some((Some(name), _)) if missing.get("at").is_none() => Missing::Named(name),
            None if missing.get("at").is_some() => {
                let within_m = self.number(missing, "within", (0.0, FARTHEST_M), "1.0");
                Missing::Near { at: self.needed_point(missing, "at")?, within_m: within_m? }
            }
            _ => {
                let help = "write name = \"workshop\", or at = [X, Y] and within = 1.0";
                let message = format!("`{}` must be a name or a point", missing.path);
                self.error(message, missing.at.clone(), "neither or both", help);
                return None;
            }
        };
        Some((found, place))
    }
}
