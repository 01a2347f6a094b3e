//! The boards whose flash the compiler knows, and whether a blob fits there.
//!
//! Each row says what the board's own `memory.x` says: where the plans lie. The compiler
//! needs it to refuse a blob that no flashing tool could write, and to put the address into
//! files that carry one.
//!
//! Deliberately absent: everything else about a board.

use maps::problem::Problem;

/// A board, as far as its plans are concerned.
#[derive(Debug, PartialEq, Eq)]
pub struct Board {
    /// As `--board` takes it, and as its folder in `boards/` is or would be called.
    pub name: &'static str,
    /// As probe-rs calls the chip.
    pub chip: &'static str,
    /// Where the plan region starts in flash.
    pub plan_address: u32,
    /// How much it holds, bytes.
    pub plan_bytes: usize,
    /// How much one of its two slots holds, bytes: whole erasable pages or sectors.
    pub slot_bytes: usize,
    /// Whether `boards/` has its firmware; for the others plans can be made already.
    pub has_firmware: bool,
    /// The UF2 family that the chip's boot loader accepts, where it has one.
    pub uf2_family: Option<u32>,
}

/// Every board. Addresses start 64 KiB segments, which keeps Intel HEX records whole.
pub const BOARDS: [Board; 4] = [
    Board {
        name: "nrf52840-dk",
        chip: "nRF52840_xxAA",
        plan_address: 0x000C_0000,
        plan_bytes: 192 << 10,
        slot_bytes: 96 << 10,
        has_firmware: true,
        uf2_family: None,
    },
    Board {
        name: "stm32f405",
        chip: "STM32F405RGTx",
        plan_address: 0x080C_0000,
        plan_bytes: 256 << 10,
        slot_bytes: 128 << 10,
        has_firmware: false,
        uf2_family: None,
    },
    Board {
        name: "pico2",
        chip: "RP235x",
        plan_address: 0x1020_0000,
        plan_bytes: 1 << 20,
        slot_bytes: 512 << 10,
        has_firmware: false,
        // rp2350-arm-s in Raspberry Pi's list of families.
        uf2_family: Some(0xE48B_FF59),
    },
    Board {
        name: "stm32h743",
        chip: "STM32H743VITx",
        plan_address: 0x0818_0000,
        plan_bytes: 512 << 10,
        slot_bytes: 256 << 10,
        has_firmware: false,
        uf2_family: None,
    },
];

impl Board {
    /// The board of a name.
    pub fn find(name: &str) -> Option<&'static Self> {
        BOARDS.iter().find(|board| board.name == name)
    }

    /// What is wrong with putting a blob of so many bytes into the plan region, or worth
    /// knowing about it.
    pub fn check(&self, blob_bytes: usize) -> Option<Problem> {
        let (name, room, slot) = (self.name, self.plan_bytes, self.slot_bytes);
        if blob_bytes > room {
            let message = format!(
                "the plans take {blob_bytes} bytes, {} more than the {room} of the plan region \
                 of {name}",
                blob_bytes - room
            );
            return Some(Problem::error(message).mend(self.mend(blob_bytes)));
        }
        (blob_bytes > slot).then(|| {
            Problem::note(format!(
                "the plans take {blob_bytes} bytes, more than one of the two slots of {slot} in \
                 the plan region of {name}: no second blob fits beside them"
            ))
        })
    }

    fn mend(&self, blob_bytes: usize) -> String {
        let shrink = "use a coarser --resolution, a smaller area, or fewer goals and layers";
        let larger = BOARDS.iter().filter(|board| board.plan_bytes >= blob_bytes);
        let larger: Vec<String> =
            larger.map(|board| format!("{} ({})", board.name, board.plan_bytes)).collect();
        if larger.is_empty() {
            format!("{shrink}; no board that is known has room for them")
        } else {
            format!("{shrink}; room for them as they are has {}", larger.join(", "))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use maps::problem::Severity;

    #[test]
    fn regions_are_two_slots_in_segments_of_their_own() {
        for board in &BOARDS {
            assert_eq!(board.plan_address % 0x1_0000, 0, "{}", board.name);
            assert_eq!(board.plan_bytes, 2 * board.slot_bytes, "{}", board.name);
            assert_eq!(Board::find(board.name), Some(board));
        }
    }

    #[test]
    fn the_last_byte_of_a_region_may_be_used_and_no_more() {
        let board = Board::find("nrf52840-dk").unwrap();
        let severity = |bytes| board.check(bytes).map(|problem| problem.severity);
        assert_eq!(severity(98_304), None);
        assert_eq!(severity(98_305), Some(Severity::Note));
        assert_eq!(severity(196_608), Some(Severity::Note));
        assert_eq!(severity(196_609), Some(Severity::Error));
        let mend = |bytes| board.check(bytes).unwrap().mend.unwrap();
        assert!(mend(196_609).contains("stm32f405 (262144), pico2"), "{}", mend(196_609));
        assert!(mend(2 << 20).contains("no board that is known"), "{}", mend(2 << 20));
    }
}
