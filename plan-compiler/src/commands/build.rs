//! `build`: map in, blob out.

use super::description::{self, describe, goals_text};
use super::progress::{with_patience, with_progress};
use super::{Failure, print_json, project, tell};
use crate::cli::{Build, Compiling};
use maps::problem::{Problem, has_errors};
use maps::terminal::quoted;
use plan_compiler::boards::{self, Board};
use plan_compiler::compile::{Need, STEPS_A_LAYER, gib, prepare};
use plan_compiler::image::Image;
use plan_compiler::{mutual_waits, output, width};
use plan_format::Blob;
use serde::Serialize;
use std::borrow::Cow;
use std::fmt::Write as _;
use std::io;
use std::path::Path;
use std::time::{Duration, Instant};

pub(super) fn run(args: &Build, quiet: bool) -> Result<(), Failure> {
    build(&args.input, None, &args.output, &args.compiling, args.json, quiet)
}

/// Compiles a map, whose bytes may have been read already, and writes the blob.
pub(super) fn build(
    input: &Path,
    bytes: Option<Vec<u8>>,
    output: &Path,
    args: &Compiling,
    json: bool,
    quiet: bool,
) -> Result<(), Failure> {
    let started = Instant::now();
    let image = Image::of(output, args.board).map_err(Failure::Usage)?;
    let mut problems = Vec::new();
    let Some(blob) = compile(input, bytes, output, args, quiet, &mut problems)? else {
        return Err(Failure::Wrong(problems));
    };
    problems.extend(args.board.into_iter().flat_map(|board| boards::check(board, &blob)));
    if !has_errors(&problems) {
        let file = image.encode(&blob);
        problems.extend(output::write_file(output, |out| out.write_all(&file)).err());
    }
    if has_errors(&problems) {
        return Err(Failure::Wrong(problems));
    }
    tell(&problems, quiet);
    if json {
        return print_built(output, args.board, &blob, started.elapsed());
    }
    if !quiet {
        crate::say(&summary(output, args.board, image, &blob, started.elapsed()));
    }
    Ok(())
}

/// The blob of a map; `None` after an error.
pub(super) fn compile(
    input: &Path,
    bytes: Option<Vec<u8>>,
    output: &Path,
    args: &Compiling,
    quiet: bool,
    problems: &mut Vec<Problem>,
) -> Result<Option<Vec<u8>>, Failure> {
    let reading = || project::read(input, bytes, &args.goals, &args.map, problems);
    let Some(mut project) = with_patience(quiet, "reading", reading)? else {
        return Ok(None);
    };
    problems.extend(output::check_against(output, &project.inputs));
    project.options.max_memory_bytes = args.max_memory;
    if let Some(source) = &project.mission.behaviours.source {
        problems.extend(mutual_waits::check(source, &project.mission.team));
    }
    let preparing = || prepare(&project.input(), problems);
    let Some(prepared) = with_patience(quiet, "drawing the map into cells", preparing) else {
        return Ok(None);
    };
    announce(prepared.need(), quiet);
    Ok(with_progress(quiet, STEPS_A_LAYER, |progress| prepared.finish(progress, problems)))
}

/// Reports in advance how much memory a large build takes.
fn announce(need: Need, quiet: bool) {
    /// Every machine that runs the compiler has this much.
    const WORTH_SAYING_BYTES: u64 = 1 << 30;
    if need.bytes > WORTH_SAYING_BYTES {
        let message = format!("the search may take up to {} of memory", gib(need.bytes));
        tell(&[Problem::note(message)], quiet);
    }
}

/// The output of `--json`: the file, the description that `inspect` prints, and the time taken.
#[derive(Serialize)]
struct Built<'b> {
    /// Lossy, since file names need not be Unicode.
    output: Cow<'b, str>,
    board: Option<&'b str>,
    time_ms: f64,
    #[serde(flatten)]
    blob: description::Description<'b>,
}

fn print_built(
    output: &Path,
    board: Option<&Board>,
    bytes: &[u8],
    took: Duration,
) -> Result<(), Failure> {
    // The compiler has already read the blob back.
    let blob = Blob::parse_exact(bytes).map_err(io::Error::other)?;
    print_json(&Built {
        output: output.to_string_lossy(),
        board: board.map(|board| board.name.as_str()),
        time_ms: took.as_secs_f64() * 1e3,
        blob: describe(&blob, bytes, &width::of_blob(&blob, bytes)),
    })
}

fn summary(
    output: &Path,
    board: Option<&Board>,
    image: Image,
    bytes: &[u8],
    took: Duration,
) -> String {
    let mut text = String::new();
    // The compiler has already read the blob back; a summary must not fail the build.
    let Ok(blob) = Blob::parse_exact(bytes) else { return text };
    let grid = blob.grid();
    // Writing to a string does not fail.
    let _ = writeln!(
        text,
        "{}: {} bytes, {} x {} cells of {} m, {} ms",
        output.display(),
        bytes.len(),
        grid.columns,
        grid.rows,
        grid.resolution_m,
        took.as_millis()
    );
    for parallel in blob.parallel_plans() {
        let _ = writeln!(text, "  {} to {}", parallel.name(), goals_text(&blob, &parallel));
        for layer in parallel.layers() {
            let counts = layer.counts();
            let _ = writeln!(
                text,
                "    {}: {} cells with a route, {} without, {} blocked",
                layer.name(),
                counts.free,
                counts.unreachable,
                counts.blocked
            );
        }
    }
    if let Some(board) = board {
        let whole = board.memory.plans.bytes;
        let part = bytes.len() as f64 / whole as f64;
        let _ = writeln!(
            text,
            "  {}: {:.1} % of its plan region of {whole} bytes; {}",
            board.name,
            100.0 * part,
            flashing(output, image, board)
        );
    }
    text
}

/// How to get the file onto the board.
fn flashing(path: &Path, image: Image, board: &Board) -> String {
    let (chip, path) = (&board.chip, quoted(path));
    let download = format!("flash it with probe-rs download --chip {chip} --verify");
    match image {
        Image::Raw => {
            let address = board.memory.plans.address;
            format!("{download} --binary-format bin --base-address {address:#010x} {path}")
        }
        Image::Hex { .. } => format!("{download} --binary-format hex {path}"),
        Image::Uf2 { .. } => "copy it to the drive that the board shows in BOOTSEL mode".into(),
    }
}
