//! The picture of a run: map, advice and the driven route, in one colour per behaviour.

use std::path::Path;

use math::scalar::wide;
use plan_compiler::output;
use plan_compiler::render::{self, Mark, NO_BEHAVIOUR, Overlay, Piece, Style};
use plan_compiler::trace::story::Story;
use plan_format::Blob;
use sim::{Disc, Outcome, PlannedFault, Point, Repeat, Scenario, Start};

/// Number of the line style of moving discs; the first 24 are those of behaviours.
const DISC_STYLE: usize = 24;

/// A part of the route that one behaviour drove without a break.
struct Stretch {
    behaviour: usize,
    points: Vec<Point>,
}

/// Draws the map and the route to `path` (.svg or .png). Each behaviour's part of the route has its
/// own colour and dashes; marks show the start, the end and each interruption. The error is a
/// message for the user.
pub fn draw(
    scenario: &Scenario,
    start: &Start,
    route: &[Point],
    story: &Story,
    outcome: &Outcome,
    path: &Path,
) -> Result<(), String> {
    let plan = scenario.plan();
    let stretches = stretches(route, &story.engaged);
    let names: Vec<String> =
        stretches.iter().map(|stretch| name(&plan, stretch.behaviour)).collect();
    let has_behaviours = !plan.mission().behaviours().is_empty();
    let pieces = stretches.iter().zip(&names).map(|(stretch, name)| Piece {
        name,
        style: if has_behaviours { stretch.behaviour } else { 0 },
        points: &stretch.points,
    });
    let paths: Vec<Vec<Point>> = scenario.conditions.discs.iter().flat_map(disc_lines).collect();
    let paths = paths.iter().map(|points| Piece {
        name: "way of a moving obstacle",
        style: DISC_STYLE,
        points,
    });
    let pieces: Vec<Piece<'_>> = paths.chain(pieces).collect();
    let interruptions = story.turns.iter().filter_map(|turn| {
        let at = *route.get(turn.tick)?;
        Some(match turn.interrupted_at_once? {
            false => (Mark::GaveWay, at, "gave way at a point of its plan"),
            true => (Mark::Interrupted, at, "interrupted at once"),
        })
    });
    let mut marks = vec![(Mark::Start, start.position, "start")];
    marks.extend(interruptions);
    let faults = fault_marks(&scenario.conditions.faults, route);
    marks.extend(faults.iter().map(|(at, text)| (Mark::Fault, *at, text.as_str())));
    marks.extend(end(outcome, route));
    let features = &scenario.map.features;
    let (unmapped, absent) = (&scenario.unmapped, &scenario.absent);
    let overlay = Overlay {
        features,
        unmapped,
        absent,
        routes: &pieces,
        marks: &marks,
        ..Overlay::default()
    };
    let parallel = scenario.parallel_plan();
    let layer = scenario.layer_from(start.position).or_else(|| parallel.layer(0));
    let layer = layer.ok_or("there is no layer to draw")?;
    let svg = render::picture(&plan, &parallel, &layer, &overlay, Style::default());
    match Kind::of(path)? {
        Kind::Svg => write(path, svg.as_bytes()),
        Kind::Png => write(path, &render::png(&svg)?),
    }
}

/// The kind of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Vectors.
    Svg,
    /// Pixels.
    Png,
}

impl Kind {
    /// The kind that a file's name asks for.
    ///
    /// # Errors
    /// Returns a message for the user.
    pub fn of(path: &Path) -> Result<Self, String> {
        let extension = path.extension().and_then(|extension| extension.to_str());
        match extension.map(str::to_ascii_lowercase).as_deref() {
            Some("svg") => Ok(Self::Svg),
            Some("png") => Ok(Self::Png),
            _ => Err("the picture's name must end in .svg or .png".to_owned()),
        }
    }
}

/// The lines of a moving disc: its path, and its edge at the start.
fn disc_lines(disc: &Disc) -> [Vec<Point>; 2] {
    const CORNERS: u32 = 24;
    let closing = (disc.repeat == Repeat::Around).then(|| disc.path.first()).flatten();
    let path = disc.path.iter().chain(closing).copied().collect();
    let [x, y] = disc.at(0.0);
    let corner = |index: u32| {
        let angle = std::f64::consts::TAU * f64::from(index) / f64::from(CORNERS);
        [x + disc.radius_m * wide::cos(angle), y + disc.radius_m * wide::sin(angle)]
    };
    [path, (0..=CORNERS).map(corner).collect()]
}

/// Where the robot was when a fault began or ended, with the entry in the legend.
fn fault_marks(faults: &[PlannedFault], route: &[Point]) -> Vec<(Point, String)> {
    let at = |seconds: f64| route.get((seconds * 1e6 / sim::TICK_US as f64) as usize).copied();
    let events = faults.iter().flat_map(|fault| {
        let name = fault.channel.name();
        [
            (fault.window_s.start, format!("{name} fails")),
            (fault.window_s.end, format!("{name} works")),
        ]
    });
    events.filter_map(|(seconds, text)| Some((at(seconds)?, text))).collect()
}

/// The mark at the end of a route: an end if the outcome is reached, otherwise a stop.
pub fn end(outcome: &Outcome, route: &[Point]) -> Option<(Mark, Point, &'static str)> {
    let last = *route.last()?;
    Some(match outcome.reached() {
        true => (Mark::End, last, "end"),
        false => (Mark::Stop, last, "stopped before the end"),
    })
}

/// Splits the route into parts of one behaviour each.
fn stretches(route: &[Point], engaged: &[u16]) -> Vec<Stretch> {
    let mut stretches: Vec<Stretch> = Vec::new();
    for (&at, &engaged) in route.iter().zip(engaged) {
        let behaviour = if engaged == 0 { NO_BEHAVIOUR } else { engaged.trailing_zeros() as usize };
        match stretches.last_mut() {
            Some(last) if last.behaviour == behaviour => last.points.push(at),
            // A part begins at the last point of the part before, so that they meet.
            last => {
                let before = last.and_then(|last| last.points.last().copied());
                stretches
                    .push(Stretch { behaviour, points: before.into_iter().chain([at]).collect() });
            }
        }
    }
    stretches
}

/// The legend of a behaviour's part of the route.
fn name(blob: &Blob<'_>, behaviour: usize) -> String {
    let mission = blob.mission();
    match mission.behaviours().get(behaviour) {
        Some(behaviour) => mission.name(behaviour.name).to_owned(),
        None if mission.behaviours().is_empty() => "driven route".to_owned(),
        None => "no behaviour".to_owned(),
    }
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), String> {
    output::write_file(path, |out| out.write_all(bytes)).map_err(|problem| problem.message)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_a_route_meet() {
        let route: Vec<Point> = (0..6).map(|x| [f64::from(x), 0.0]).collect();
        let parts = stretches(&route, &[0, 2, 2, 3, 4, 4]);
        let found: Vec<(usize, f64, f64)> = parts
            .iter()
            .map(|part| (part.behaviour, part.points[0][0], part.points[part.points.len() - 1][0]))
            .collect();
        let expected = [(NO_BEHAVIOUR, 0.0, 0.0), (1, 0.0, 2.0), (0, 2.0, 3.0), (2, 3.0, 5.0)];
        assert_eq!(found, expected);
    }

    #[test]
    fn faults_are_marked_where_they_begin_and_end() {
        let route: Vec<Point> = (0..100).map(|x| [f64::from(x), 0.0]).collect();
        let fault = |window_s| PlannedFault {
            channel: sim::Channel::Gps,
            fault: sim::Fault::Freeze,
            window_s,
        };
        // Twenty ticks a second; the second fault lasts to the end.
        let marks = fault_marks(&[fault(1.0..2.0), fault(3.0..f64::INFINITY)], &route);
        let expected =
            [([20.0, 0.0], "gps fails"), ([40.0, 0.0], "gps works"), ([60.0, 0.0], "gps fails")];
        assert_eq!(marks, expected.map(|(at, text)| (at, text.to_owned())));
    }

    #[test]
    fn a_route_that_does_not_arrive_ends_in_a_cross() {
        let route = [[0.0, 0.0], [3.0, 4.0]];
        let trapped = Outcome { ending: Some(sim::Ending::Trapped), ..Outcome::default() };
        assert_eq!(
            end(&trapped, &route).map(|(mark, at, _)| (mark, at)),
            Some((Mark::Stop, [3.0, 4.0]))
        );
        let reached = Outcome { ending: Some(sim::Ending::Reached), ..Outcome::default() };
        assert_eq!(end(&reached, &route).map(|(mark, ..)| mark), Some(Mark::End));
        assert_eq!(end(&reached, &[]), None);
    }
}
