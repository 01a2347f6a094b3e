//! Cost maps: a factor for each cell of the plan's grid, as an array in NumPy's format or as an image.
//!
//! The array is \[row, column\] with row 0 in the south, as `plan-compiler export` writes them, of
//! float32, float64 or integers, in either order. Factors are rounded to eighths. An image is read as
//! [`maps::formats::ros::Shades`]: white has one factor and black another, and greys lie between.

use crate::tolls::{LEAST, MOST, Tolls};
use maps::formats::ros::{DARKEST, Shades};
use maps::problem::Place;
use plan_format::limits::MAX_SIDE_CELLS;
use plan_format::{Cell, Grid};
use std::path::PathBuf;

/// Factors by cell.
#[derive(Clone, Debug)]
pub struct CostMap {
    /// Its file, relative to the current folder.
    pub path: PathBuf,
    /// Its place in the mission file.
    pub place: Place,
    /// Its factors.
    pub factors: CostSource,
}

/// Where the factors of a cost map come from.
#[derive(Clone, Debug)]
pub enum CostSource {
    /// An array.
    Array(Factors),
    /// An image.
    Image(CostImage),
}

/// An image whose shades are factors.
#[derive(Clone, Debug)]
pub struct CostImage {
    /// The shades.
    pub shades: Shades,
    /// Eighths of white and of black.
    pub ends: [u32; 2],
}

impl CostSource {
    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        match self {
            Self::Array(factors) => [factors.columns, factors.rows],
            Self::Image(CostImage { shades, .. }) => [shades.columns, shades.rows],
        }
    }

    /// The factors of the cells of a grid; `None` if it does not have these cells. A cell has the
    /// highest factor of the pixels that it overlaps, and 1 beside the image.
    pub fn on(&self, grid: &Grid) -> Option<Tolls> {
        let tolls =
            |eighths: &dyn Fn(Cell) -> u32| Some(Tolls::from_fn(grid.columns, grid.rows, eighths));
        match self {
            Self::Array(factors) if self.size() == [grid.columns, grid.rows] => {
                let index = |cell: Cell| (cell.row * grid.columns + cell.column) as usize;
                tolls(&|cell| factors.eighths[index(cell)].into())
            }
            Self::Image(image) if image.shades.fits(grid) => tolls(&|cell| {
                let numbers = image.shades.over(grid, cell);
                numbers.iter().map(|number| image.eighths(number)).max().unwrap_or(LEAST)
            }),
            _ => None,
        }
    }
}

impl CostImage {
    /// The factor of a shade, eighths, rounded.
    fn eighths(&self, number: u8) -> u32 {
        let ([white, black], darkest) = (self.ends, u32::from(DARKEST));
        let dark = u32::from(number);
        (white * (darkest - dark) + black * dark + darkest / 2) / darkest
    }
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
    // A literal of Python; its writers differ in spaces and quotes.
    let header: String = String::from_utf8_lossy(header)
        .chars()
        .filter(|character| !character.is_whitespace())
        .map(|character| if character == '"' { '\'' } else { character })
        .collect();
    let (rows, columns) = shape(&header)?;
    let kind = text_after(&header, "'descr':'").unwrap_or("a structure");
    let numbers = numbers(data, kind).ok_or_else(|| {
        format!("the numbers are {kind}: save array.astype('float32'), or integers")
    })?;
    let (height, width) = (rows as usize, columns as usize);
    if numbers.len() != height * width {
        return Err(format!("the file has {} numbers, not {rows} x {columns}", numbers.len()));
    }
    let is_by_column = header.contains("'fortran_order':True");
    let number = |index: usize| {
        let (row, column) = (index / width, index % width);
        numbers[if is_by_column { column * height + row } else { index }]
    };
    let range = 1.0..=f64::from(MOST / LEAST);
    let mut wrong = (0..numbers.len()).filter(|&index| !range.contains(&number(index)));
    if let Some(at) = wrong.next() {
        let (row, column) = (at / width, at % width);
        return Err(format!(
            "{} numbers are not factors from 1 to 32; the first is {} in row {row}, column {column}",
            wrong.count() + 1,
            number(at)
        ));
    }
    let eighths = (0..numbers.len()).map(|index| (number(index) * f64::from(LEAST) + 0.5) as u16);
    Ok(Factors { columns, rows, eighths: eighths.collect() })
}

/// The numbers in the data of a file; `None` for kinds that are not read. `kind` is NumPy's code: the
/// order of the bytes, `<` from the least, then the type, then its bytes.
fn numbers(data: &[u8], kind: &str) -> Option<Vec<f64>> {
    let (order, kind) = kind.split_at_checked(1)?;
    let is_reversed = order == ">";
    Some(match kind {
        "f4" => chunks(data, is_reversed, |bytes| f64::from(f32::from_le_bytes(bytes))),
        "f8" => chunks(data, is_reversed, f64::from_le_bytes),
        "b1" | "u1" => data.iter().map(|&number| f64::from(number)).collect(),
        "u2" => chunks(data, is_reversed, |bytes| f64::from(u16::from_le_bytes(bytes))),
        "u4" => chunks(data, is_reversed, |bytes| f64::from(u32::from_le_bytes(bytes))),
        "u8" => chunks(data, is_reversed, |bytes| u64::from_le_bytes(bytes) as f64),
        "i1" => chunks(data, is_reversed, |bytes| f64::from(i8::from_le_bytes(bytes))),
        "i2" => chunks(data, is_reversed, |bytes| f64::from(i16::from_le_bytes(bytes))),
        "i4" => chunks(data, is_reversed, |bytes| f64::from(i32::from_le_bytes(bytes))),
        "i8" => chunks(data, is_reversed, |bytes| i64::from_le_bytes(bytes) as f64),
        _ => return None,
    })
}

fn chunks<const N: usize>(
    data: &[u8],
    is_reversed: bool,
    number: impl Fn([u8; N]) -> f64,
) -> Vec<f64> {
    let from_least = |mut bytes: [u8; N]| {
        if is_reversed {
            bytes.reverse();
        }
        bytes
    };
    data.as_chunks().0.iter().map(|bytes| number(from_least(*bytes))).collect()
}

/// The text between a key and the next quote.
fn text_after<'h>(header: &'h str, key: &str) -> Option<&'h str> {
    header.split_once(key)?.1.split('\'').next()
}

/// Rows and columns, each within the limits of a grid.
fn shape(header: &str) -> Result<(u32, u32), String> {
    let inside = header.split_once("'shape':(").and_then(|(_, rest)| rest.split_once(')'));
    let (inside, _) = inside.ok_or("its header does not give a shape")?;
    let sides: Vec<&str> = inside.split(',').filter(|side| !side.is_empty()).collect();
    let [rows, columns] = sides[..] else {
        return Err(format!("the array has {} dimensions, not rows and columns", sides.len()));
    };
    // Python 2 wrote long integers as 97L.
    let side = |text: &str| {
        let side = text.trim_end_matches('L').parse().ok();
        side.filter(|side| (1..=MAX_SIDE_CELLS).contains(side))
    };
    side(rows).zip(side(columns)).ok_or_else(|| {
        format!(
            "the array is {rows} x {columns}; a grid has 1 to {MAX_SIDE_CELLS} rows and columns"
        )
    })
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

    #[test]
    fn the_factors_of_greys_lie_between_those_of_white_and_black() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.pgm");
        std::fs::write(&path, "P2 5 1 255 255 191 128 64 0").unwrap();
        let shades = maps::formats::ros::read_shades(&path).0.unwrap();
        let grid = Grid { columns: 5, rows: 1, resolution_m: 1.0, corner_m: [0.0; 2] };
        for (ends, expected) in [([8, 40], [8, 16, 24, 32, 40]), ([24, 8], [24, 20, 16, 12, 8])] {
            let image = CostSource::Image(CostImage { shades: shades.clone(), ends });
            let tolls = image.on(&grid).unwrap();
            let factors = [0, 1, 2, 3, 4].map(|column| tolls.eighths(Cell::new(column, 0)));
            assert_eq!(factors, expected);
            assert!(image.on(&Grid { columns: 4, ..grid }).is_none());
        }
    }

    const U1: &str = "{'descr': '|u1', 'fortran_order': False, 'shape': (2, 3), }";

    const NUMBERS: [u8; 6] = [1, 2, 3, 4, 5, 32];

    fn expected() -> Factors {
        Factors { columns: 3, rows: 2, eighths: vec![8, 16, 24, 32, 40, 256] }
    }

    #[test]
    fn arrays_of_each_kind_are_read() {
        fn check<const N: usize>(kind: &str, number: impl Fn(u8) -> [u8; N]) {
            let read = |order: &str, data: Vec<u8>| {
                factors(&file(&U1.replace("|u1", &format!("{order}{kind}")), &data))
            };
            let data: Vec<u8> = NUMBERS.iter().flat_map(|&n| number(n)).collect();
            assert_eq!(read(if N == 1 { "|" } else { "<" }, data), Ok(expected()), "{kind}");
            let reversed: Vec<u8> =
                NUMBERS.iter().flat_map(|&n| number(n).into_iter().rev()).collect();
            assert_eq!(read(">", reversed), Ok(expected()), "{kind}");
        }
        check("f4", |n| f32::from(n).to_le_bytes());
        check("f8", |n| f64::from(n).to_le_bytes());
        check("u1", u8::to_le_bytes);
        check("u2", |n| u16::from(n).to_le_bytes());
        check("u4", |n| u32::from(n).to_le_bytes());
        check("u8", |n| u64::from(n).to_le_bytes());
        check("i1", |n| (n as i8).to_le_bytes());
        check("i2", |n| i16::from(n).to_le_bytes());
        check("i4", |n| i32::from(n).to_le_bytes());
        check("i8", |n| i64::from(n).to_le_bytes());
        let ones = Factors { columns: 3, rows: 2, eighths: vec![8; 6] };
        assert_eq!(factors(&file(&U1.replace("u1", "b1"), &[1; 6])), Ok(ones));
    }

    /// As other libraries than NumPy write them, and older versions of it.
    #[test]
    fn headers_of_every_writer_are_read() {
        for header in [
            "{'descr':'|u1','fortran_order':False,'shape':(2,3)}",
            "{\"descr\": \"|u1\", \"fortran_order\": False, \"shape\": (2, 3)}",
            "{'shape': (2L, 3L), 'fortran_order': False, 'descr': '|u1'}     \n",
            "{ 'descr' : '|u1' , 'fortran_order' : False , 'shape' : ( 2 , 3, ) , }",
        ] {
            assert_eq!(factors(&file(header, &NUMBERS)), Ok(expected()), "{header}");
            let mut second = [MAGIC, b"\x02\x00", &(header.len() as u32).to_le_bytes()].concat();
            second.extend([header.as_bytes(), &NUMBERS].concat());
            assert_eq!(factors(&second), Ok(expected()), "{header}");
        }
        let by_column = U1.replace("False", "True");
        assert_eq!(factors(&file(&by_column, &[1, 4, 2, 5, 3, 32])), Ok(expected()));
    }

    #[test]
    fn other_files_are_refused_with_the_reason() {
        let reason = |bytes: &[u8]| factors(bytes).unwrap_err();
        assert!(reason(b"P5 3 2 255").contains("not a file of NumPy"));
        let shape = |shape: &str| reason(&file(&U1.replace("(2, 3)", shape), &[1; 6]));
        assert!(shape("(6,)").contains("1 dimensions"));
        assert!(shape("(1, 2, 3)").contains("3 dimensions"));
        assert!(shape("(0, 6)").contains("0 x 6"));
        assert!(shape("(-2, 3)").contains("-2 x 3"));
        assert!(shape("2, 3").contains("does not give a shape"));
        assert!(reason(&file(&U1.replace("|u1", "<c8"), &[1; 48])).contains("are <c8: save"));
        let structure = U1.replace("'|u1'", "[('cost', '<f4')]");
        assert!(reason(&file(&structure, &[1; 24])).contains("structure"));
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
            let mut changed = file(U1, &NUMBERS);
            let at = at % changed.len();
            let end = (at + bytes.len()).min(changed.len());
            changed[at..end].copy_from_slice(&bytes[..end - at]);
            let _ = factors(&changed);
        }
    }
}
