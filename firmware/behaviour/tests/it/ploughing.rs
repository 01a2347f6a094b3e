//! The paper's example at the level of percepts: tables 4 to 6, figures 3 and 4.

use crate::bench::{check, log};

const FIELD: &str = "
    input fuel
    input ready
    fact on-field inside 0 0 60 40
    fact far-side inside 45 0 60 40
    action forward goto 50 0; needs on-field
    action turn goto 50 10; needs far-side
    action back goto 0 10; needs far-side
    action drive-to-gallon goto 0 -20; deletes on-field
    action fill hold 200
    action drive-to-field goto 0 0; deletes on-field
    frame plough-field
    = forward turn back plough-field; when ready PS PS PS PS PS NB NB; protect on-field 0 2
    frame refuel
    = drive-to-gallon fill drive-to-field
    behaviour ploughing plough-field; when ready PS PS PS PS PS PS NB
    behaviour refuelling refuel; when fuel PB PB PM PM NB NB NB
";

/// H26, figure 4: fuel becomes ZO during `forward`. At point 1, its end, the protection interval is
/// in force; the switch is at point 2, and no strip is repeated.
#[test]
fn at_fuel_zo_the_switch_is_at_point_2() {
    check(
        FIELD,
        "fuel=1 ready=0 at=0,0 x3
         fuel=0.5 at=20,0 x3
         at=50,0 x2
         at=50,10
         at=0,-20 x3
         fuel=1 at=0,0 x2
         at=0,10 x2",
        "1: ploughing engaged, [forward turn back plough-field], forward
         2: forward
         4: refuelling waits: ploughing is at no point, forward
         7: refuelling waits: ploughing is at no point, turn
         9: ploughing interrupted by refuelling, refuelling engaged, [drive-to-gallon fill drive-to-fi], drive-to-gallon
         10: fill
         12: drive-to-field
         13: refuelling finished, ploughing resumed, cannot start: far-side, [forward turn back plough-field], forward
         14: forward",
    );
}

/// H28: fuel NM or NB during `forward` switches at once, and the strip is ploughed again.
#[test]
fn at_fuel_nm_or_nb_the_switch_is_at_once() {
    for fuel in ["0.1667", "0"] {
        let script = format!(
            "fuel=1 ready=0 at=0,0 x2
             fuel={fuel} at=20,0
             at=0,-20 x3
             fuel=1 at=0,0
             at=20,0 x2
             at=50,0",
        );
        check(FIELD, &script, "1: ploughing engaged, [forward turn back plough-field], forward
         2: forward
         3: ploughing stopped by refuelling, refuelling engaged, [drive-to-gallon fill drive-to-fi], drive-to-gallon
         4: fill
         6: drive-to-field
         7: refuelling finished, ploughing resumed, forward
         8: forward
         10: turn");
    }
}

/// H28 during `back`: the action cannot resume from the near side, so the strip starts again.
#[test]
fn an_interrupted_back_means_the_strip_again() {
    check(
        FIELD,
        "fuel=1 ready=0 at=0,0 x2
         at=50,0
         at=50,10
         fuel=0 at=30,10
         at=0,-20 x3
         fuel=1 at=0,0
         at=50,0",
        "1: ploughing engaged, [forward turn back plough-field], forward
         2: forward
         3: turn
         4: back
         5: ploughing stopped by refuelling, refuelling engaged, [drive-to-gallon fill drive-to-fi], drive-to-gallon
         6: fill
         8: drive-to-field
         9: refuelling finished, ploughing resumed, cannot start: far-side, [forward turn back plough-field], forward
         10: turn",
    );
}

/// Without a deviation, the interrupted action resumes.
#[test]
fn without_a_deviation_an_interrupted_action_is_taken_up_again() {
    check(
        &FIELD.replace("goto 0 0; deletes", "goto 50 10; deletes"),
        "fuel=1 ready=0 at=0,0 x2
         at=50,0
         at=50,10
         fuel=0 at=30,10
         at=0,-20 x3
         fuel=1 at=50,10
         at=0,10",
        "1: ploughing engaged, [forward turn back plough-field], forward
         2: forward
         3: turn
         4: back
         5: ploughing stopped by refuelling, refuelling engaged, [drive-to-gallon fill drive-to-fi], drive-to-gallon
         6: fill
         8: drive-to-field
         9: refuelling finished, ploughing resumed, back
         10: [forward turn back plough-field], forward",
    );
}

/// A deviation that persists is a failure: beside the field no strip can start. The behaviour
/// rests, and tries again.
#[test]
fn beside_the_field_nothing_is_ploughed() {
    check(
        &FIELD.replace("goto 0 0; deletes", "goto 0 -9; deletes"),
        "fuel=1 ready=0 at=0,0 x2
         fuel=0 at=20,0
         at=0,-20 x3
         fuel=1 at=0,-9 x3
         at=0,0 x12",
        "1: ploughing engaged, [forward turn back plough-field], forward
         2: forward
         3: ploughing stopped by refuelling, refuelling engaged, [drive-to-gallon fill drive-to-fi], drive-to-gallon
         4: fill
         6: drive-to-field
         7: refuelling finished, ploughing resumed, lost its protection: on-field, [forward turn back plough-field], cannot start: on-field, plough-field NothingApplicable, ploughing failed, -
         8: -
         17: ploughing engaged, [forward turn back plough-field], forward
         18: forward",
    );
}

/// Table 6: from PM on the production is not applicable, so the loop and the behaviour end. Still
/// critical, the behaviour starts again, finds no applicable production and fails. At PB it is
/// dormant.
#[test]
fn the_loop_ends_when_the_field_is_ready() {
    check(
        FIELD,
        "fuel=1 ready=0 at=0,0
         at=50,0
         ready=0.8333 at=50,10
         at=0,10
         ready=0.9 x3
         ready=1 x12",
        "1: ploughing engaged, [forward turn back plough-field], forward
         2: turn
         3: back
         4: ploughing finished, -
         5: ploughing engaged, plough-field NothingApplicable, ploughing failed, -
         6: -",
    );
}

/// The paper's values: ZO is not urgent, and PM exceeds PS. Between two labels the criticality
/// decides.
#[test]
fn the_order_of_the_two_behaviours_follows_the_golden_values() {
    let first = |fuel: &str| log(FIELD, &format!("ready=0 at=0,0 fuel={fuel}"));
    assert!(first("0.551").contains("ploughing engaged"));
    assert!(first("0.547").contains("refuelling engaged"));
    let at = |fuel: &str| log(FIELD, &format!("ready=0 at=0,0 fuel=1\nfuel={fuel}"));
    assert!(at("0.194").contains("refuelling waits: ploughing is at no point"));
    assert!(at("0.190").contains("ploughing stopped by refuelling"));
}
