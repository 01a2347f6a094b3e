//! Links for the chip; does nothing on a host.

fn main() {
    println!("cargo::rerun-if-changed=blocks.x");
    board_table::link(include_str!("blocks.x"));
}
