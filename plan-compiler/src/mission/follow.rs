//! What a mission file leaves out follows from what it gives: see [`Derived`] for the formulas and
//! their reasons.

use super::Given;
use plan_format::Parameters;
use plan_format::parameters::Derived;

/// Fixes that imply at least this many times the top speed are refused, if the file does not set
/// `max_jump`: the fixes of a moving robot scatter.
const JUMP_BY_SPEED: f32 = 2.0;

/// Sets the parameters that the file does not give. With the paper's preset, its values are kept as
/// far as the given ones allow.
pub(crate) fn complete(parameters: &mut Parameters, given: &Given) {
    let is_paper = given.is_paper();
    let Parameters { vehicle, schemas, fixes, .. } = parameters;
    let derived = Derived::of(vehicle);
    let follows = |path: &str| !given.has(path);
    if follows("vehicle.base_speed") {
        let base = if is_paper { vehicle.base_speed_mps } else { derived.base_speed_mps };
        vehicle.base_speed_mps = base.min(vehicle.max_speed_mps);
    }
    if follows("vehicle.cautious_speed") {
        vehicle.cautious_speed_mps = derived.cautious_speed_mps.min(vehicle.base_speed_mps);
    }
    if follows("vehicle.max_turn_rate") && !is_paper {
        vehicle.max_turn_rate_radps = derived.max_turn_rate_radps;
    }
    if follows("vehicle.stop_distance") {
        let stop = if is_paper { vehicle.stop_distance_m } else { derived.stop_distance_m };
        let is_bounded = given.has("schemas.avoid_margin");
        vehicle.stop_distance_m = if is_bounded { stop.min(schemas.avoid_margin_m) } else { stop };
    }
    if follows("schemas.avoid_margin") {
        let margin = if is_paper { schemas.avoid_margin_m } else { derived.avoid_margin_m };
        schemas.avoid_margin_m = margin.max(vehicle.stop_distance_m);
    }
    if follows("schemas.avoid_sphere") {
        let sphere = if is_paper { schemas.avoid_sphere_m } else { derived.avoid_sphere_m };
        schemas.avoid_sphere_m = sphere.max(schemas.avoid_margin_m);
    }
    if follows("schemas.look_ahead") {
        schemas.look_ahead_m = derived.look_ahead_m;
    }
    if follows("fixes.max_jump") {
        fixes.max_jump_mps = fixes.max_jump_mps.max(JUMP_BY_SPEED * vehicle.max_speed_mps);
    }
}

#[cfg(test)]
mod tests {
    use crate::mission::tests::read;
    use plan_format::Parameters;

    #[test]
    fn an_empty_mission_has_the_default_parameters() {
        for file in ["", "[vehicle]\n", "preset = 'body'\n"] {
            let (mission, problems) = read(file);
            assert_eq!((mission.parameters, problems), (Parameters::default(), vec![]), "{file}");
        }
        let (mission, problems) = read("preset = 'paper'\n");
        assert_eq!((mission.parameters, problems), (Parameters::paper(), vec![]));
    }

    #[test]
    fn distances_and_speeds_follow_from_the_body() {
        // Base and cautious speed, turn rate; stop distance, margin, sphere, look-ahead.
        for (file, speeds, distances) in [
            ("[vehicle]\nradius = 0.25\nmax_speed = 2\n", [2.0, 0.3, 4.0], [0.02, 0.02, 1.2, 0.4]),
            ("[vehicle]\nradius = 3\nmax_speed = 2\n", [2.0, 0.3, 1.0 / 3.0], [0.2, 0.2, 1.2, 4.8]),
            // A vehicle that needs a circle looks farther ahead.
            (
                "[vehicle]\nradius = 0.25\nmax_speed = 2\nsteering = 'ackermann'\nmin_turn_radius = 0.5\n",
                [2.0, 0.3, 4.0],
                [0.02, 0.02, 1.2, 0.5],
            ),
            (
                "[vehicle]\nradius = 0.25\nmax_speed = 2\nsteering = 'boat'\n",
                [2.0, 0.3, 4.0],
                [0.02, 0.02, 1.2, 0.5],
            ),
            ("[vehicle]\nbraking = 0.5\n", [1.6, 0.3, 2.6666667], [0.02, 0.02, 2.72, 0.48]),
            (
                "[vehicle]\nmax_speed = 0.2\nlatency = 1\n",
                [0.2, 0.2, 0.33333334],
                [0.02, 0.02, 0.21, 0.48],
            ),
            // What is given bounds what follows.
            ("[vehicle]\nstop_distance = 1\n", [1.6, 0.3, 2.6666667], [1.0, 1.0, 1.0, 0.48]),
            ("[schemas]\navoid_margin = 0.01\n", [1.6, 0.3, 2.6666667], [0.01, 0.01, 0.8, 0.48]),
            ("[schemas]\navoid_margin = 0.2\n", [1.6, 0.3, 2.6666667], [0.02, 0.2, 0.8, 0.48]),
            (
                "[vehicle]\nmax_turn_rate = 2\nbase_speed = 0.2\n[schemas]\navoid_sphere = 3\n",
                [0.2, 0.2, 2.0],
                [0.02, 0.02, 3.0, 0.48],
            ),
            // A body is as wide as obstacles are grown, unless its radius is given.
            ("robot_radius = 0.6\n", [1.6, 0.3, 1.3333334], [0.04, 0.04, 0.8, 0.96]),
            (
                "preset = 'paper'\n[vehicle]\nmax_speed = 1\n",
                [1.0, 0.3, 1.0],
                [0.3, 0.5, 5.0, 0.48],
            ),
            (
                "[vehicle]\nstop_distance = 0.7\n[gains]\nblend = 'route'\n[schemas]\n\
                 detour_after = 2\n",
                [1.6, 0.3, 2.6666667],
                [0.7, 0.7, 0.8, 0.48],
            ),
        ] {
            let (mission, problems) = read(file);
            assert_eq!(problems, [""; 0], "{file}");
            let (vehicle, schemas) = (mission.parameters.vehicle, mission.parameters.schemas);
            let found = [
                vehicle.base_speed_mps,
                vehicle.cautious_speed_mps,
                vehicle.max_turn_rate_radps,
                vehicle.stop_distance_m,
                schemas.avoid_margin_m,
                schemas.avoid_sphere_m,
                schemas.look_ahead_m,
            ];
            for (found, expected) in found.into_iter().zip(speeds.into_iter().chain(distances)) {
                assert!((found - expected as f32).abs() < 1e-6, "{file}: {found} {expected}");
            }
        }
    }

    #[test]
    fn fixes_are_not_refused_for_the_robots_own_speed() {
        let jump = |file| read(file).0.parameters.fixes.max_jump_mps;
        assert_eq!(jump("[vehicle]\nmax_speed = 2\n"), 15.0);
        assert_eq!(jump("[vehicle]\nmax_speed = 20\nbraking = 50\n"), 40.0);
        assert_eq!(jump("[vehicle]\nmax_speed = 20\n[fixes]\nmax_jump = 25\n"), 25.0);
    }
}
