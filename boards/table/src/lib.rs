//! Reads the table of boards and emulated machines, `boards/table/boards.toml`.
//!
//! Decides where program, plans and RAM of a board are. Runs on the host only: in the compiler, in
//! the QEMU harness, in tests, and in the build scripts of the boards and of the QEMU guest, for
//! which [`link()`] writes `memory.x`.
//!
//! ```
//! let board = board_table::Board::find("pico2").unwrap();
//! assert_eq!(board.memory.plans.address, 0x1020_0000);
//! assert_eq!(board.slot_bytes(), 512 << 10);
//! ```
//!
//! Invariants: a missing, unknown or ill-typed key is an error, never a default; the regions of a
//! row neither overlap nor leave the 32-bit address space.
//!
//! Source: the datasheets of the chips, and QEMU's documentation of its machines.
//!
//! Deliberately absent: pins and clocks, which are in each board's code.

pub mod elf;
mod link;
mod read;

use std::ops::Range;
use std::sync::LazyLock;

pub use link::{link, link_machine};

/// Every board, in the order of the file.
pub static BOARDS: LazyLock<Vec<Board>> = LazyLock::new(|| TABLE.boards.clone());
/// Every emulated machine, in the order of the file.
pub static MACHINES: LazyLock<Vec<Machine>> = LazyLock::new(|| TABLE.machines.clone());

// The file is compiled in and a test reads it, so this fails only in a build with a broken table.
static TABLE: LazyLock<Table> =
    LazyLock::new(|| read::table(include_str!("../boards.toml")).unwrap_or_else(|e| panic!("{e}")));

/// The contents of the file.
#[derive(Debug)]
struct Table {
    boards: Vec<Board>,
    machines: Vec<Machine>,
}

/// A board, built or planned.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Board {
    /// The board's folder in `boards/`, and the argument of `--board`.
    pub name: String,
    /// The chip, as probe-rs calls it.
    pub chip: String,
    /// Rust's name for the processor.
    pub target: String,
    /// Flash and RAM.
    pub memory: Memory,
    /// Erase unit of the chip in the plan region, bytes.
    pub erase_bytes: usize,
    /// The UF2 family that the chip's boot loader accepts; `None` if it does not accept UF2.
    pub uf2_family: Option<u32>,
    /// What the firmware reads and drives besides GPS, link, arm button and two wheels.
    pub has: Vec<Equipment>,
    /// State of its firmware.
    pub state: State,
}

/// A part that the firmware of a board may read or drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Equipment {
    /// Compass or IMU.
    Compass,
    /// Range finder.
    Ranges,
    /// Values of input channels, such as the battery's charge.
    Inputs,
    /// Digital outputs.
    Outputs,
    /// Steered wheels or a rudder.
    Steering,
}

impl Equipment {
    /// Its name in the table.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Compass => "compass",
            Self::Ranges => "ranges",
            Self::Inputs => "inputs",
            Self::Outputs => "outputs",
            Self::Steering => "steering",
        }
    }

    /// All of them.
    pub const ALL: [Self; 5] =
        [Self::Compass, Self::Ranges, Self::Inputs, Self::Outputs, Self::Steering];
}

/// A machine that QEMU emulates.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Machine {
    /// The argument of `qemu-system-arm -machine`.
    pub name: String,
    /// Rust's name for the processor.
    pub target: String,
    /// Flash and RAM.
    pub memory: Memory,
}

/// State of a board's firmware.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Plans can be compiled for it; it has no firmware.
    Planned,
    /// CI builds and links its firmware; it has not been tried on hardware.
    Built,
    /// Its firmware drove a robot.
    Tried,
}

impl State {
    /// Whether `boards/` has its firmware.
    pub const fn has_firmware(self) -> bool {
        !matches!(self, Self::Planned)
    }
}

/// The memory of a board or machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Memory {
    /// Flash for the program.
    pub program: Region,
    /// Flash for the plans, which are flashed separately.
    pub plans: Region,
    /// RAM, the stack included.
    pub ram: Region,
    /// Size of the stack, the lowest part of `ram`.
    pub stack_bytes: usize,
}

/// A range of addresses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// Address of the first byte.
    pub address: u32,
    /// Number of bytes.
    pub bytes: usize,
}

impl Region {
    /// The addresses; the end is one past the last.
    pub const fn range(&self) -> Range<u64> {
        self.address as u64..self.address as u64 + self.bytes as u64
    }
}

impl Memory {
    /// Every region.
    fn regions(&self) -> [(&'static str, Region); 3] {
        [("program", self.program), ("plans", self.plans), ("ram", self.ram)]
    }
}

impl Board {
    /// The board with a name.
    pub fn find(name: &str) -> Option<&'static Self> {
        BOARDS.iter().find(|board| board.name == name)
    }

    /// Bytes of one of the two slots of the plan region.
    pub const fn slot_bytes(&self) -> usize {
        self.memory.plans.bytes / 2
    }
}

impl Machine {
    /// The machine with a name.
    pub fn find(name: &str) -> Option<&'static Self> {
        MACHINES.iter().find(|machine| machine.name == name)
    }
}
