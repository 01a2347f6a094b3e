//! Chooses the machine by the target and links for it; does nothing on a host.

fn main() {
    println!("cargo::rustc-check-cfg=cfg(machine, values(\"mps2-an386\", \"lm3s6965evb\"))");
    if let Some(machine) = board_table::link_machine() {
        println!("cargo::rustc-cfg=machine=\"{machine}\"");
    }
}
