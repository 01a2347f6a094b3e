//! The boards whose flash the compiler knows, and whether a blob fits there.
//!
//! The table is `boards/table/boards.toml`, from which each board's linker script is generated too.
//! The compiler needs it to refuse a blob that no flashing tool could write, and to put the
//! address into files that carry one.

pub use board_table::{BOARDS, Board};

use maps::problem::Problem;

/// The error or note about putting a blob of `blob_bytes` into the board's plan region, if any.
pub fn check(board: &Board, blob_bytes: usize) -> Option<Problem> {
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
        let severity = |bytes| check(board, bytes).map(|problem| problem.severity);
        assert_eq!(severity(98_304), None);
        assert_eq!(severity(98_305), Some(Severity::Note));
        assert_eq!(severity(196_608), Some(Severity::Note));
        assert_eq!(severity(196_609), Some(Severity::Error));
        let help = |bytes| check(board, bytes).unwrap().help.unwrap();
        assert!(help(196_609).contains("stm32f405 (262144), pico2"), "{}", help(196_609));
        assert!(help(2 << 20).contains("not fit on any known board"), "{}", help(2 << 20));
    }
}
