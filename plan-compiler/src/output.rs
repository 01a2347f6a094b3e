//! What leaves the compiler: complete files, and arrays.
//!
//! A file is written beside its destination and renamed onto it, so that no reader sees half of it
//! and a failure keeps the old file.

use crate::field::{eighths_of, exact_metres};
use crate::tolls::LEAST;
use maps::problem::Problem;
use plan_format::{Answer, Cell, Grid, Layer};
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Writes a file completely, or not at all.
pub fn write_file(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), Problem> {
    let failed = |error: io::Error| cannot_write(path, &error);
    let destination = destination(path)?;
    match fs::metadata(&destination) {
        Ok(existing) if existing.is_dir() => Err(is_a_directory(path)),
        // A terminal, a pipe or /dev/null is written to; a rename would replace it.
        Ok(existing) if !existing.is_file() => {
            let file = fs::OpenOptions::new().write(true).open(path).map_err(failed)?;
            let mut file = BufWriter::new(file);
            fill(&mut file).and_then(|()| file.flush()).map_err(failed)
        }
        _ => replace(&destination, fill).map_err(failed),
    }
}

/// Reports a destination that cannot be written, before the work starts.
pub fn check(path: &Path) -> Option<Problem> {
    if path.is_dir() {
        return Some(is_a_directory(path));
    }
    let destination = match destination(path) {
        Ok(destination) => destination,
        Err(problem) => return Some(problem),
    };
    match fs::metadata(&destination) {
        Ok(existing) if !existing.is_file() => None,
        _ => temporary(&destination).err().map(|error| cannot_write(path, &error)),
    }
}

/// As [`check`]; also reports a destination that would replace one of these files, through a symbolic
/// link for example.
pub fn check_against(path: &Path, inputs: &[impl AsRef<Path>]) -> Vec<Problem> {
    let mut problems: Vec<Problem> = check(path).into_iter().collect();
    if inputs.iter().any(|input| is_same(path, input.as_ref())) {
        let message = format!("the output {} is also the input", path.display());
        problems.push(Problem::error(message).help("choose another output"));
    }
    problems
}

/// Whether writing to two paths writes the same file.
pub fn is_same(a: &Path, b: &Path) -> bool {
    destination(a).is_ok_and(|a| destination(b).is_ok_and(|b| a == b))
}

/// The file that writing to a path writes. A symbolic link stays one, also if it leads to a file that
/// does not exist yet.
fn destination(path: &Path) -> Result<PathBuf, Problem> {
    /// As many links as Linux follows.
    const MAX_LINKS: usize = 40;
    let mut at = path.to_owned();
    for _ in 0..MAX_LINKS {
        if let Ok(existing) = fs::canonicalize(&at) {
            return Ok(existing);
        }
        let Ok(target) = fs::read_link(&at) else { break };
        at = folder(&at).join(target);
    }
    if at.is_symlink() {
        return Err(cannot_write(path, &io::Error::other("its symbolic links form a loop")));
    }
    let is_folder = at.as_os_str().as_encoded_bytes().ends_with(b"/");
    match (fs::canonicalize(folder(&at)), at.file_name()) {
        (Ok(folder), Some(name)) if !is_folder => Ok(folder.join(name)),
        (Err(error), _) => Err(cannot_write(path, &error)),
        _ => Err(cannot_write(path, &io::ErrorKind::NotFound.into())),
    }
}

fn folder(path: &Path) -> &Path {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    folder.unwrap_or(Path::new("."))
}

fn is_a_directory(path: &Path) -> Problem {
    Problem::error(format!("{} is a directory", path.display())).help("name a file inside it")
}

/// Writes beside `path` and renames onto it.
fn replace(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut file = BufWriter::new(temporary(path)?);
    fill(&mut file)?;
    let file = file.into_inner().map_err(io::IntoInnerError::into_error)?;
    // Not synced to the disk, which takes longer than many builds. If a power cut leaves half a
    // blob, its checksum refuses it.
    file.persist(path).map_err(|error| error.error)?;
    Ok(())
}

/// A new file beside a path, which is removed if it is not renamed.
fn temporary(path: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".plan-compiler-");
    // The library's default permissions are for secrets; a plan is an ordinary file.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder(path))
}

fn cannot_write(path: &Path, error: &io::Error) -> Problem {
    let problem = |what: &str| Problem::error(format!("cannot write {}: {what}", path.display()));
    match error.kind() {
        io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => {
            problem("the folder does not exist").help("create the folder, or choose another output")
        }
        io::ErrorKind::PermissionDenied => {
            problem("permission denied").help("choose an output in a folder that you may write to")
        }
        io::ErrorKind::StorageFull => problem("the disk is full"),
        _ => problem(&error.to_string()),
    }
}

/// What to export of a layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum What {
    /// Cost to the goal, metres, float32; infinite where blocked or without a route.
    Cost,
    /// int8: 0 to 7 for E NE N NW W SW S SE, -1 the goal, -2 blocked or without a route.
    Direction,
    /// uint8: 1 blocked, 0 free.
    Blocked,
    /// What a step out of the cell is multiplied by, float32; 0 where that is not known: blocked,
    /// without a route, or the goal.
    Toll,
    /// Speed limit, m/s, float32; infinite where there is none.
    Limit,
    /// int8: the number of the goal that the advice leads to, from 0; -2 blocked or without a route.
    Goal,
}

impl What {
    /// Whether it is written as float32.
    fn is_float(self) -> bool {
        matches!(self, Self::Cost | Self::Toll | Self::Limit)
    }
}

/// How an array is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArrayFormat {
    /// NumPy's own, version 1.0.
    Npy,
    /// One line per row, numbers separated by commas.
    Csv,
}

/// Writes an array \[row, column\], row 0 in the south.
pub fn write_array(
    out: &mut dyn Write,
    format: ArrayFormat,
    what: What,
    grid: &Grid,
    layer: &Layer<'_>,
) -> io::Result<()> {
    if format == ArrayFormat::Npy {
        let kind = match what {
            What::Cost | What::Toll | What::Limit => "<f4",
            What::Direction | What::Goal => "|i1",
            What::Blocked => "|u1",
        };
        out.write_all(&npy_header(kind, grid))?;
    }
    for row in 0..grid.rows {
        for column in 0..grid.columns {
            let cell = Cell::new(column, row);
            let answer = layer.look_up_exact(cell);
            let number = match what {
                What::Toll => eighths_of(grid, layer, cell).unwrap_or(0) as f32 / LEAST as f32,
                What::Limit => layer.speed_limit(cell).unwrap_or(f32::INFINITY),
                _ => cost(answer, grid, layer) as f32,
            };
            let code = || match code(answer, what) {
                0 if what == What::Goal => layer.goal_number(cell) as i8,
                code => code,
            };
            let comma = if column > 0 { "," } else { "" };
            match (format, what.is_float()) {
                (ArrayFormat::Npy, true) => out.write_all(&number.to_le_bytes())?,
                (ArrayFormat::Npy, false) => out.write_all(&code().to_le_bytes())?,
                (ArrayFormat::Csv, true) => write!(out, "{comma}{number}")?,
                (ArrayFormat::Csv, false) => write!(out, "{comma}{}", code())?,
            }
        }
        if format == ArrayFormat::Csv {
            writeln!(out)?;
        }
    }
    Ok(())
}

/// Cost to the goal, metres; infinite where there is no route.
fn cost(answer: Answer, grid: &Grid, layer: &Layer<'_>) -> f64 {
    match answer {
        Answer::Move { cost, .. } => exact_metres(grid, layer, cost),
        Answer::Goal => 0.0,
        Answer::NoRoute | Answer::Blocked { .. } | Answer::OffMap => f64::INFINITY,
    }
}

fn code(answer: Answer, what: What) -> i8 {
    match (what, answer) {
        (What::Blocked, answer) => i8::from(matches!(answer, Answer::Blocked { .. })),
        (What::Goal, Answer::Move { .. } | Answer::Goal) => 0,
        (_, Answer::Move { direction, .. }) => direction.code() as i8,
        (_, Answer::Goal) => -1,
        _ => -2,
    }
}

/// Writes numbers of a grid's cells, by rows from the south, in NumPy's format as float32.
pub fn write_numbers(out: &mut dyn Write, grid: &Grid, numbers: &[f32]) -> io::Result<()> {
    out.write_all(&npy_header("<f4", grid))?;
    numbers.iter().try_for_each(|number| out.write_all(&number.to_le_bytes()))
}

/// The header of an array in NumPy's format: magic, version, length and a Python literal.
fn npy_header(kind: &str, grid: &Grid) -> Vec<u8> {
    /// Length of the header; a multiple of 64 aligns the numbers after it for memory mapping.
    const BYTES: usize = 128;
    /// Magic, version and length.
    const PREFIX_BYTES: usize = 10;
    let (rows, columns) = (grid.rows, grid.columns);
    let literal =
        format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({rows}, {columns}), }}");
    let mut header = b"\x93NUMPY\x01\x00".to_vec();
    header.extend_from_slice(&((BYTES - PREFIX_BYTES) as u16).to_le_bytes());
    header.extend_from_slice(literal.as_bytes());
    header.resize(BYTES - 1, b' ');
    header.push(b'\n');
    header
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failure_leaves_what_was_there_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("plans.bin");
        fs::write(&path, "before").unwrap();
        let failed = write_file(&path, |out| {
            out.write_all(b"half")?;
            Err(io::Error::other("pulled the plug"))
        });
        assert!(failed.unwrap_err().message.ends_with("pulled the plug"));
        assert_eq!(fs::read_to_string(&path).unwrap(), "before");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        write_file(&path, |out| out.write_all(b"after")).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "after");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn folders_that_are_not_there_are_said_to_be_missing() {
        let folder = tempfile::tempdir().unwrap();
        let error = |path: &Path| write_file(path, |_| Ok(())).unwrap_err().message;
        assert!(error(&folder.path().join("no/plans.bin")).ends_with("the folder does not exist"));
        assert!(error(&folder.path().join("no/")).ends_with("the folder does not exist"));
        assert!(error(folder.path()).ends_with("is a directory"));
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_one_and_what_it_leads_to_is_written() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        symlink("second", path("first")).unwrap();
        symlink("plans.bin", path("second")).unwrap();
        for text in ["before", "after"] {
            assert!(check(&path("first")).is_none());
            write_file(&path("first"), |out| out.write_all(text.as_bytes())).unwrap();
            assert_eq!(fs::read_to_string(path("plans.bin")).unwrap(), text);
            assert!(path("first").is_symlink() && path("second").is_symlink());
        }
        assert!(is_same(&path("first"), &path("plans.bin")));
        assert!(!is_same(&path("new"), &path("plans.bin")));
        symlink("no/plans.bin", path("astray")).unwrap();
        symlink("around", path("around")).unwrap();
        for (name, reason) in [("astray", "the folder does not exist"), ("around", "form a loop")] {
            let found = check(&path(name)).expect(name);
            assert!(found.message.ends_with(reason), "{}", found.message);
            assert!(write_file(&path(name), |_| Ok(())).is_err());
            assert!(path(name).is_symlink());
        }
    }

    #[test]
    fn the_npy_header_is_aligned_and_holds_the_largest_grid() {
        let side = plan_format::limits::MAX_SIDE_CELLS;
        let grid = Grid { columns: side, rows: side, resolution_m: 1.0, corner_m: [0.0, 0.0] };
        let header = npy_header("|i1", &grid);
        assert_eq!(header.len(), 128);
        assert_eq!(&header[..10], b"\x93NUMPY\x01\x00\x76\x00");
        assert!(header.ends_with(b" \n"));
    }
}
