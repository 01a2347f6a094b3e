//! Prints the sizes of the boards' firmware images as rows of the table in `boards/README.md`,
//! and compares them with that table. Build the images first, each in its folder:
//! `cargo build --profile firmware`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::{env, fs};

use board_table::{BOARDS, Board, elf};

/// Largest difference between an image and the README, percent: paths in the image differ between
/// machines.
const TOLERANCE_PERCENT: u32 = 2;

fn main() -> ExitCode {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let target = env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
    let readme = fs::read_to_string(root.join("boards/README.md")).unwrap_or_default();
    let mut is_right = true;
    for board in BOARDS.iter().filter(|board| board.state.has_firmware()) {
        match measured(&target, board) {
            Ok(sizes) => {
                println!("{}", row(&board.name, sizes));
                if !readme.lines().any(|line| is_close(line, &board.name, sizes)) {
                    eprintln!("boards/README.md has no row close to this one");
                    is_right = false;
                }
            }
            Err(problem) => {
                eprintln!("{problem}");
                is_right = false;
            }
        }
    }
    if is_right { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn measured(target: &Path, board: &Board) -> Result<[u32; 3], String> {
    let path = target.join(&board.target).join("firmware").join(&board.name);
    let image = fs::read(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let sizes = elf::sizes(&image)
        .ok_or_else(|| format!("{}: not a complete ELF-32 image", path.display()))?;
    Ok([sizes.text, sizes.data, sizes.bss])
}

fn row(name: &str, [text, data, bss]: [u32; 3]) -> String {
    format!("| `{name}` | {} | {} | {} |", grouped(text), grouped(data), grouped(bss))
}

/// Whether a line is the board's row, with sizes close to these.
fn is_close(line: &str, name: &str, sizes: [u32; 3]) -> bool {
    let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
    let [first, written @ ..] = &cells[..] else { return false };
    *first == format!("`{name}`")
        && written.len() == sizes.len()
        && written.iter().zip(sizes).all(|(written, size)| {
            let written: Result<u32, _> = written.replace(',', "").parse();
            written.is_ok_and(|written| written.abs_diff(size) <= size * TOLERANCE_PERCENT / 100)
        })
}

/// The number with a comma before every three digits.
fn grouped(number: u32) -> String {
    let digits = number.to_string();
    let groups: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().filter_map(|group| str::from_utf8(group).ok()).collect();
    groups.join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_close_to_itself_and_to_little_else() {
        let sizes = [161_664, 1_000, 40];
        let line = row("rover", sizes);
        assert_eq!(line, "| `rover` | 161,664 | 1,000 | 40 |");
        assert!(is_close(&line, "rover", sizes));
        assert!(is_close(&line, "rover", [161_664 + 3_000, 1_000, 40]));
        assert!(!is_close(&line, "rover", [161_664 + 4_000, 1_000, 40]));
        assert!(!is_close(&line, "rover", [161_664, 1_000, 41]));
        assert!(!is_close(&line, "boat", sizes));
        assert!(!is_close("", "rover", sizes));
    }
}
