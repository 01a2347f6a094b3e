//! The paper's example at the level of percepts: tables 4 to 6, figures 3 and 4.

use crate::bench::check;

const FIELD: &str = "
    input fuel
    input ready
    fact on-field inside 0 0 60 40
    action forward goto 50 0; needs on-field
    action turn goto 50 10
    action back goto 0 10
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

/// H26, figure 4: fuel ZO during `forward`; point 1, after it, lies on the protected field; the
/// switch is at point 2. H28 does not happen: no strip is repeated.
#[test]
fn little_fuel_is_fetched_at_point_2() {
    check(
        FIELD,
        "fuel=1 ready=0 at=0,0 x3
         fuel=0.5 x3
         at=50,0 x3
         at=50,10 x2
         at=0,-20 x4
         fuel=1 at=0,0 x2
         at=0,10 x2",
        "",
    );
}
