//! The linker arguments from a board's build script.

use std::path::PathBuf;
use std::{env, fs};

use crate::{Board, MACHINES, Memory, Region};

/// Links a board by the row with its package's name: writes `memory.x`, with `sections` at its
/// end, and passes the arguments that every board needs. Does nothing on a host.
///
/// # Panics
/// If the table has no such row, or if the row is for another target. The build then fails.
pub fn link(sections: &str) {
    if !is_bare_metal() {
        return;
    }
    let name = variable("CARGO_PKG_NAME");
    let board = Board::find(&name).unwrap_or_else(|| panic!("boards.toml has no [board.{name}]"));
    let target = variable("TARGET");
    assert_eq!(board.target, target, "boards.toml has {name} for another target");
    write(&board.memory, &(chip_section(&board.chip) + sections));
    println!("cargo::rustc-link-arg-bins=-Tdefmt.x");
}

/// Links for the QEMU machine of the target and returns its name; `None` on a host.
///
/// # Panics
/// If the table has no machine for the target. The build then fails.
pub fn link_machine() -> Option<&'static str> {
    if !is_bare_metal() {
        return None;
    }
    let target = variable("TARGET");
    let machine = MACHINES.iter().find(|machine| machine.target == target);
    let machine =
        machine.unwrap_or_else(|| panic!("boards.toml has no [machine.NAME] for {target}"));
    write(&machine.memory, "");
    Some(&machine.name)
}

fn write(memory: &Memory, sections: &str) {
    let folder = PathBuf::from(env::var_os("OUT_DIR").expect("cargo names the output folder"));
    let script = memory_x(memory) + sections;
    fs::write(folder.join("memory.x"), script).expect("the output folder is writable");
    println!("cargo::rustc-link-search={}", folder.display());
    // Not in rustflags: RUSTFLAGS in the environment would replace those of a configuration file.
    for argument in ["--nmagic", "-Tlink.x"] {
        println!("cargo::rustc-link-arg-bins={argument}");
    }
}

/// The linker's memory map.
fn memory_x(memory: &Memory) -> String {
    let Memory { program, plans, ram, stack_bytes } = *memory;
    let stack = Region { bytes: stack_bytes, ..ram };
    let data = Region { address: ram.address + stack_bytes as u32, bytes: ram.bytes - stack_bytes };
    let line = |name: &str, region: Region| {
        let Region { address, bytes } = region;
        format!("  {name} : ORIGIN = {address:#010x}, LENGTH = {}K\n", bytes >> 10)
    };
    format!(
        "/* Written from boards.toml. */\n\
         MEMORY\n\
         {{\n\
         {}\
         {}  /* The stack is lowest, so that an overflow leaves the RAM and faults instead of\n     \
         overwriting data. */\n\
         {}{}}}\n\
         _stack_start = ORIGIN(STACK) + LENGTH(STACK);\n\
         _stack_end = ORIGIN(STACK);\n\
         /* The plans are flashed separately, never as part of the program's image. */\n\
         _plan_start = ORIGIN(PLAN);\n\
         _plan_end = ORIGIN(PLAN) + LENGTH(PLAN);\n",
        line("FLASH", program),
        line("PLAN ", plans),
        line("STACK", stack),
        line("RAM  ", data),
    )
}

/// A section that names the chip for probe-rs. It occupies no memory on the chip.
fn chip_section(chip: &str) -> String {
    let bytes: String = chip.bytes().map(|byte| format!(" BYTE({byte:#04x})")).collect();
    format!("SECTIONS\n{{\n  .probe-rs.chip 0 (INFO) : {{{bytes} }}\n}}\n")
}

fn is_bare_metal() -> bool {
    variable("CARGO_CFG_TARGET_OS") == "none"
}

fn variable(name: &str) -> String {
    env::var(name).unwrap_or_else(|_| panic!("cargo sets {name} for build scripts"))
}
