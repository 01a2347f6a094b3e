//! The boards that the compiler knows: whether a blob fits into their flash, and whether they have
//! what its mission needs.
//!
//! The table is `boards/table/boards.toml`, from which each board's linker script is generated too.
//! The compiler needs it to refuse a blob that no flashing tool could write, and to put the
//! address into files that carry one.

pub use board_table::{BOARDS, Board, Equipment};

use controller::sense::COURSE_SPEED_MPS;
use maps::problem::Problem;
use plan_format::Blob;
use plan_format::mission::{ActionKind, Source};
use plan_format::parameters::Steering;

/// What speaks against this blob on the board.
pub fn check(board: &Board, blob: &[u8]) -> Vec<Problem> {
    let mut problems: Vec<Problem> = fits(board, blob.len()).into_iter().collect();
    // The compiler reads back what it writes.
    if let Ok(blob) = Blob::parse_exact(blob) {
        let lacking =
            needs(&blob).into_iter().filter(|(equipment, _)| !board.has.contains(equipment));
        problems.extend(lacking.map(|(equipment, need)| {
            let name = equipment.name();
            let without = match equipment {
                Equipment::Compass | Equipment::Ranges | Equipment::Inputs => {
                    format!("reads no {name}")
                }
                Equipment::Outputs => "sets no outputs".into(),
                Equipment::Steering => "drives two wheels only".into(),
            };
            Problem::warning(format!("the firmware of {} {without}: {need}", board.name)).help(
                format!(
                    "add it to the board's code and \"{name}\" to its row in \
                     boards/table/boards.toml, or change the mission"
                ),
            )
        }));
    }
    problems
}

/// What the mission needs besides GPS, link, arm button and two wheels, and what happens without.
fn needs(blob: &Blob<'_>) -> Vec<(Equipment, String)> {
    let (parameters, mission) = (blob.parameters(), blob.mission());
    let vehicle = &parameters.vehicle;
    let mut needs = Vec::new();
    if !vehicle.may_creep || vehicle.max_speed_mps <= COURSE_SPEED_MPS {
        let need = format!(
            "the heading comes from the course of the fixes; without `vehicle.may_creep`, or at \
             {COURSE_SPEED_MPS} m/s or less, the robot never finds it"
        );
        needs.push((Equipment::Compass, need));
    } else if vehicle.base_speed_mps <= COURSE_SPEED_MPS {
        let need = format!(
            "the heading comes from the course of the fixes, which counts above \
             {COURSE_SPEED_MPS} m/s; at `vehicle.base_speed` = {} the robot loses it after a few seconds and \
             creeps faster to find it again",
            vehicle.base_speed_mps
        );
        needs.push((Equipment::Compass, need));
    }
    if parameters.ranges.is_required {
        let need = "`ranges.required` keeps the robot from being armed".to_owned();
        needs.push((Equipment::Ranges, need));
    }
    if parameters.safety.battery_low > 0.0 {
        let need = "`battery.low` keeps the robot from being armed".to_owned();
        needs.push((Equipment::Inputs, need));
    }
    let channels =
        mission.inputs().iter().filter(|input| matches!(input.source, Source::Channel(_)));
    let channels: Vec<_> =
        channels.map(|input| format!("`{}`", mission.name(input.name))).collect();
    if !channels.is_empty() {
        let need = format!("nothing gives {} a value", channels.join(", "));
        needs.push((Equipment::Inputs, need));
    }
    let sets = |kind| matches!(kind, ActionKind::SetOutput { .. });
    let outputs = mission.actions().iter().filter(|action| sets(action.kind)).count();
    if outputs > 0 {
        let need = format!("actions of the mission that set one have no effect ({outputs})");
        needs.push((Equipment::Outputs, need));
    }
    if vehicle.steering != Steering::Differential {
        let need = "`vehicle.steering` needs more".to_owned();
        needs.push((Equipment::Steering, need));
    }
    needs
}

/// The error or note about putting a blob of `blob_bytes` into the board's plan region, if any.
fn fits(board: &Board, blob_bytes: usize) -> Option<Problem> {
    let (name, room, slot) = (&board.name, board.memory.plans.bytes, board.slot_bytes());
    if blob_bytes > room {
        let message = format!(
            "the plans take {blob_bytes} bytes, {} more than {name}'s plan region of {room} bytes",
            blob_bytes - room
        );
        return Some(Problem::error(message).help(help(blob_bytes)));
    }
    (blob_bytes > slot).then(|| {
        Problem::note(format!(
            "the plans take {blob_bytes} bytes, more than one of the two {slot}-byte slots in \
             {name}'s plan region: there is no room for a second blob"
        ))
    })
}

fn help(blob_bytes: usize) -> String {
    let shrink = "use a coarser --resolution, a smaller area, or fewer goals and layers";
    let larger = BOARDS.iter().filter(|board| board.memory.plans.bytes >= blob_bytes);
    let larger: Vec<String> =
        larger.map(|board| format!("{} ({})", board.name, board.memory.plans.bytes)).collect();
    if larger.is_empty() {
        format!("{shrink}; they do not fit on any known board")
    } else {
        format!("{shrink}; they fit unchanged on: {}", larger.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use maps::problem::Severity;

    #[test]
    fn the_last_byte_of_a_region_may_be_used_and_no_more() {
        let board = Board::find("nrf52840-dk").unwrap();
        let severity = |bytes| fits(board, bytes).map(|problem| problem.severity);
        assert_eq!(severity(98_304), None);
        assert_eq!(severity(98_305), Some(Severity::Note));
        assert_eq!(severity(196_608), Some(Severity::Note));
        assert_eq!(severity(196_609), Some(Severity::Error));
        let help = |bytes| fits(board, bytes).unwrap().help.unwrap();
        assert!(help(196_609).contains("stm32f405 (262144), pico2"), "{}", help(196_609));
        assert!(help(2 << 20).contains("not fit on any known board"), "{}", help(2 << 20));
    }
}
