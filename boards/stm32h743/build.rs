//! Links for the chip; does nothing on a host.

fn main() {
    board_table::link("");
}
