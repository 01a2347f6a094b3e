//! The grid: its resolution, its extent, and where it lies on the globe.

use crate::input::Input;
use maps::numbers::{metres, pair};
use maps::problem::Problem;
use math::scalar::wide;
use plan_format::{Grid, Origin, limits};

/// A quotient this close to a whole number of cells counts as that number: in doubles 0.3 / 0.1 is
/// 2.999... and 0.7 / 0.1 is 6.999....
const WHOLE: f64 = 1e-9;
/// Largest robot radius, metres; the same limit as in the parameters.
const MAX_RADIUS_M: f64 = 100.0;

/// The grid; `None` after an error.
pub(super) fn grid(input: &Input<'_>, problems: &mut Vec<Problem>) -> Option<Grid> {
    let resolution_m = resolution(input, problems)?;
    let extent = &input.map.extent;
    let [width, height] = extent.size;
    if !(width > 0.0 && height > 0.0 && width.is_finite() && height.is_finite()) {
        problems.push(
            Problem::error(format!(
                "the map has no area: it is {} m x {} m",
                metres(width),
                metres(height)
            ))
            .help("give the map an area: MISSION-AREA in an overlay, the first polygon in OPAR"),
        );
        return None;
    }
    let (columns, rows) = (whole_cells(width / resolution_m), whole_cells(height / resolution_m));
    let limit = f64::from(limits::MAX_SIDE_CELLS);
    if columns > limit || rows > limit {
        problems.push(too_many_cells([width, height], [columns, rows], resolution_m));
        return None;
    }
    let (columns, rows) = (columns as u32, rows as u32);
    let grid = Grid { columns, rows, resolution_m, corner_m: extent.corner };
    if !grid.is_valid() {
        let ([x, y], limit) = (extent.corner, metres(limits::MAX_COORDINATE_M));
        problems.push(
            Problem::error(format!(
                "the map extends farther than {limit} m from its origin: its south-west corner \
                 is ({}, {})",
                metres(x),
                metres(y)
            ))
            .help("shift the coordinates, so that the origin lies in or near the area"),
        );
        return None;
    }
    Some(grid)
}

/// Side of a cell, metres: from the option, else the mission, else the map, else 1 m.
fn resolution(input: &Input<'_>, problems: &mut Vec<Problem>) -> Option<f64> {
    let (low, high) = limits::RESOLUTION_RANGE_M;
    let asked = [
        (input.options.resolution_m, "--resolution"),
        (input.mission.resolution_m, "the mission's resolution"),
        (input.map.resolution_m, "the map's own resolution"),
    ];
    let given = asked.into_iter().find_map(|(value, whose)| value.map(|value| (value, whose)));
    let (value, whose) = given.unwrap_or((1.0, "the resolution"));
    if (low..=high).contains(&value) {
        return Some(value);
    }
    problems.push(
        Problem::error(format!("{whose} is {} m", metres(value)))
            .help(format!("choose the side of a cell from {low} to {high} m, for example 1")),
    );
    None
}

/// How far obstacles are grown, metres: from the option, else the mission, else the vehicle's radius
/// (0 for formats whose robots are points). `None` after an error.
pub(super) fn robot_radius(input: &Input<'_>, problems: &mut Vec<Problem>) -> Option<f64> {
    let of_vehicle = match input.map.is_for_points && !input.mission.body_radius_given {
        true => 0.0,
        // Through decimal digits: 0.3 in single precision is slightly more than 0.3 m.
        false => decimal(input.mission.parameters.vehicle.radius_m),
    };
    let asked = input.options.robot_radius_m.or(input.mission.robot_radius_m);
    let radius = asked.unwrap_or(of_vehicle);
    if (0.0..=MAX_RADIUS_M).contains(&radius) {
        return Some(radius);
    }
    problems.push(
        Problem::error(format!("the robot's radius is {} m", metres(radius)))
            .help(format!("choose a --robot-radius from 0 to {MAX_RADIUS_M} m")),
    );
    None
}

/// Where the map lies on the globe, as the blob carries it.
pub(super) fn origin(input: &Input<'_>, problems: &mut Vec<Problem>) -> Option<Origin> {
    let reference = input.map.reference?;
    let origin = Origin {
        place: reference.place,
        at_m: reference.at,
        heading_rad: reference.heading_rad % std::f64::consts::TAU,
    };
    if origin.is_valid() {
        return Some(origin);
    }
    problems.push(
        Problem::warning("the map's reference point is too far from the map to be useful")
            .help("a robot with GPS needs a reference point in or near the area"),
    );
    None
}

/// The number as a person wrote it.
fn decimal(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(f64::from(value))
}

/// Rounds an extent up to whole cells.
fn whole_cells(cells: f64) -> f64 {
    let nearest = cells.round();
    let whole = (cells - nearest).abs() <= WHOLE * nearest.max(1.0);
    (if whole { nearest } else { cells.ceil() }).max(1.0)
}

fn too_many_cells(size: [f64; 2], cells: [f64; 2], resolution_m: f64) -> Problem {
    let limit = limits::MAX_SIDE_CELLS;
    let message = format!(
        "the area is too large: {} m x {} m are {} x {} cells of {} m, and a side holds \
         at most {limit}",
        metres(size[0]),
        metres(size[1]),
        metres(cells[0]),
        metres(cells[1]),
        metres(resolution_m),
    );
    let fitting = two_digits_up(size[0].max(size[1]) / f64::from(limit));
    Problem::error(message).help(if fitting <= limits::RESOLUTION_RANGE_M.1 {
        format!("--resolution {} would fit, or plan for a smaller area", metres(fitting))
    } else {
        "no resolution fits this; check the units, and plan for a smaller area".into()
    })
}

/// The next number not below `x` with two significant digits.
pub(super) fn two_digits_up(x: f64) -> f64 {
    let unit = wide::pow(10.0, wide::floor(wide::log10(x)) - 1.0);
    wide::ceil(x / unit) * unit
}

/// Where a grid lies, as a sentence for help.
pub(super) fn reach(grid: &Grid) -> String {
    let [x, y] = grid.corner_m;
    let far = |from: f64, cells: u32| from + f64::from(cells) * grid.resolution_m;
    let corner = [far(x, grid.columns), far(y, grid.rows)];
    format!("the map extends from {} to {}, metres east and north", pair([x, y]), pair(corner))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extents_round_up_but_not_by_rounding_errors() {
        for (cells, whole) in
            [(0.3 / 0.1, 3.0), (0.7 / 0.1, 7.0), (2.5, 3.0), (250.0, 250.0), (1e-6, 1.0)]
        {
            assert_eq!(whole_cells(cells), whole, "{cells}");
        }
    }

    #[test]
    fn the_resolution_offered_fits() {
        for size in [16_385.0, 20_000.0, 99_999.0, 163_840.0, 1_234_567.0] {
            let fitting = two_digits_up(size / f64::from(limits::MAX_SIDE_CELLS));
            assert!(whole_cells(size / fitting) <= f64::from(limits::MAX_SIDE_CELLS), "{size}");
        }
    }
}
