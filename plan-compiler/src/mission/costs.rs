//! Cost maps: a factor for each cell of the plan's grid, as an array in NumPy's format.
//!
//! The array is \[row, column\] with row 0 in the south, as `plan-compiler export` writes them, of
//! float32, float64 or uint8. Factors are rounded to eighths.

use crate::tolls::{LEAST, MOST};
use maps::problem::Place;
use plan_format::limits::MAX_SIDE_CELLS;
use std::path::PathBuf;

/// Factors by cell.
#[derive(Clone, Debug)]
pub struct CostMap {
    /// Its file, relative to the current folder.
    pub path: PathBuf,
    /// Its place in the mission file.
    pub place: Place,
    /// Its factors.
    pub factors: Factors,
}

/// An array of factors.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Factors {
    /// Columns from west to east.
    pub columns: u32,
    /// Rows from south to north.
    pub rows: u32,
    /// Eighths, row by row from the south.
    pub eighths: Vec<u16>,
}

/// The most bytes of a file: the largest grid in float64, with its header.
pub(super) const MAX_BYTES: u64 = 8 * (MAX_SIDE_CELLS as u64).pow(2) + (1 << 16);
const MAGIC: &[u8] = b"\x93NUMPY";

/// The factors in the bytes of a file; otherwise what is wrong with it.
pub(super) fn factors(bytes: &[u8]) -> Result<Factors, String> {
    let rest = bytes.strip_prefix(MAGIC).ok_or("this is not a file of NumPy (.npy)")?;
    let (&version, rest) = rest.split_first().ok_or("the file ends in its header")?;
    let rest = rest.get(1..).ok_or("the file ends in its header")?;
    let (length, rest) = match (version, rest) {
        (1, [a, b, rest @ ..]) => (usize::from(u16::from_le_bytes([*a, *b])), rest),
        (2 | 3, [a, b, c, d, rest @ ..]) => (u32::from_le_bytes([*a, *b, *c, *d]) as usize, rest),
        _ => return Err("the file ends in its header".into()),
    };
    let (header, data) = rest.split_at_checked(length).ok_or("the file ends in its header")?;
    let header = String::from_utf8_lossy(header);
    let (rows, columns) = shape(&header).ok_or("the array does not have two dimensions")?;
    if header.contains("'fortran_order': True") {
        return Err("the array is in Fortran's order: save numpy.ascontiguousarray(array)".into());
    }
    let numbers: Vec<f64> = match text_after(&header, "'descr': '") {
        Some("<f4") => chunks(data, |bytes| f64::from(f32::from_le_bytes(bytes))),
        Some("<f8") => chunks(data, f64::from_le_bytes),
        Some("|u1") => data.iter().map(|&number| f64::from(number)).collect(),
        _ => return Err("the numbers must be float32, float64 or uint8, little-endian".into()),
    };
    let cells = rows as usize * columns as usize;
    if numbers.len() != cells {
        return Err(format!("the file has {} numbers, not {rows} x {columns}", numbers.len()));
    }
    let range = 1.0..=f64::from(MOST / LEAST);
    if let Some(at) = numbers.iter().position(|number| !range.contains(number)) {
        let count = numbers.iter().filter(|number| !range.contains(number)).count();
        let (row, column) = (at / columns as usize, at % columns as usize);
        return Err(format!(
            "{count} numbers are not factors from 1 to 32; the first is {} in row {row}, column {column}",
            numbers[at]
        ));
    }
    let eighths = numbers.iter().map(|number| (number * f64::from(LEAST) + 0.5) as u16).collect();
    Ok(Factors { columns, rows, eighths })
}

fn chunks<const N: usize>(data: &[u8], number: impl Fn([u8; N]) -> f64) -> Vec<f64> {
    data.as_chunks().0.iter().map(|bytes| number(*bytes)).collect()
}

/// The text between a key and the next quote.
fn text_after<'h>(header: &'h str, key: &str) -> Option<&'h str> {
    header.split_once(key)?.1.split('\'').next()
}

/// Rows and columns, each within the limits of a grid.
fn shape(header: &str) -> Option<(u32, u32)> {
    let inside = header.split_once("'shape': (")?.1.split(')').next()?;
    let sides: Option<Vec<u32>> = inside
        .split(',')
        .map(str::trim)
        .filter(|side| !side.is_empty())
        .map(|side| side.parse().ok().filter(|side| (1..=MAX_SIDE_CELLS).contains(side)))
        .collect();
    match sides?[..] {
        [rows, columns] => Some((rows, columns)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn file(literal: &str, data: &[u8]) -> Vec<u8> {
        let mut bytes = [MAGIC, b"\x01\x00", &(literal.len() as u16).to_le_bytes()].concat();
        bytes.extend_from_slice(literal.as_bytes());
        bytes.extend_from_slice(data);
        bytes
    }

    const U1: &str = "{'descr': '|u1', 'fortran_order': False, 'shape': (2, 3), }";

    #[test]
    fn arrays_of_each_kind_are_read() {
        let expected = Factors { columns: 3, rows: 2, eighths: vec![8, 16, 24, 32, 40, 256] };
        let numbers = [1u8, 2, 3, 4, 5, 32];
        assert_eq!(factors(&file(U1, &numbers)), Ok(expected.clone()));
        let singles: Vec<u8> = numbers.iter().flat_map(|&n| f32::from(n).to_le_bytes()).collect();
        assert_eq!(factors(&file(&U1.replace("|u1", "<f4"), &singles)), Ok(expected.clone()));
        let doubles: Vec<u8> = numbers.iter().flat_map(|&n| f64::from(n).to_le_bytes()).collect();
        assert_eq!(factors(&file(&U1.replace("|u1", "<f8"), &doubles)), Ok(expected));
    }

    #[test]
    fn other_files_are_refused_with_the_reason() {
        let reason = |bytes: &[u8]| factors(bytes).unwrap_err();
        assert!(reason(b"P5 3 2 255").contains("not a file of NumPy"));
        assert!(reason(&file(&U1.replace("(2, 3)", "(6,)"), &[1; 6])).contains("two dimensions"));
        assert!(reason(&file(&U1.replace("False", "True"), &[1; 6])).contains("Fortran"));
        assert!(reason(&file(&U1.replace("|u1", "<i8"), &[1; 48])).contains("float32"));
        assert!(reason(&file(U1, &[1; 5])).contains("5 numbers, not 2 x 3"));
        let zero = reason(&file(U1, &[1, 1, 1, 1, 0, 40]));
        assert!(zero.starts_with("2 numbers") && zero.ends_with("0 in row 1, column 1"), "{zero}");
        let nan: Vec<u8> = [1.0f32, f32::NAN].iter().flat_map(|n| n.to_le_bytes()).collect();
        let nan = file("{'descr': '<f4', 'fortran_order': False, 'shape': (1, 2), }", &nan);
        assert!(reason(&nan).contains("NaN in row 0, column 1"));
    }

    proptest! {
        #[test]
        fn no_bytes_make_the_reader_panic(
            bytes in prop::collection::vec(any::<u8>(), 0..200), at in 0usize..100,
        ) {
            let _ = factors(&bytes);
            let mut changed = file(U1, &[1, 2, 3, 4, 5, 32]);
            let at = at % changed.len();
            let end = (at + bytes.len()).min(changed.len());
            changed[at..end].copy_from_slice(&bytes[..end - at]);
            let _ = factors(&changed);
        }
    }
}
