//! `convert`: between maps, blobs and MissionLab's Iplan.dat.

use super::build::{build, compile};
use super::{Failure, file_name, open, read_blob, tell};
use crate::cli::{Compiling, Convert};
use maps::formats::{ReadOptions, foreign};
use maps::problem::{Problem, has_errors};
use plan_compiler::boards;
use plan_compiler::image::Image;
use plan_compiler::{iplan, output};
use plan_format::MAGIC;

pub(super) fn run(args: &Convert, quiet: bool) -> Result<(), Failure> {
    let extension = args.output.extension().and_then(|extension| extension.to_str());
    let to_iplan = match extension.map(str::to_ascii_lowercase).as_deref() {
        Some("dat") => true,
        Some("bin" | "hex" | "uf2") => false,
        _ => {
            let message = "the output's name must end in .dat, .bin, .hex or .uf2";
            return Err(Failure::Usage(message.into()));
        }
    };
    let bytes = read_blob(&args.input)?;
    let is_blob = bytes.starts_with(&MAGIC) || foreign::wrapped(&bytes).is_some();
    let mut problems = Vec::new();
    let blob = match (is_blob, to_iplan) {
        (false, false) => {
            return build(&args.input, Some(bytes), &args.output, &args.compiling, false, quiet);
        }
        (false, true) => {
            compile(&args.input, Some(bytes), &args.output, &args.compiling, quiet, &mut problems)?
        }
        (true, _) if is_about_maps(&args.compiling) => {
            let message = "a blob is converted as it is; choose goals and cells with `build`";
            return Err(Failure::Usage(message.into()));
        }
        (true, _) => {
            open(&args.input, &bytes)?;
            problems.extend(output::check_against(&args.output, std::slice::from_ref(&args.input)));
            Some(bytes)
        }
    };
    let Some(blob) = blob.filter(|_| !has_errors(&problems)) else {
        return Err(Failure::Wrong(problems));
    };
    let board = args.compiling.board.into_iter();
    problems.extend(board.flat_map(|board| boards::check(board, &blob)));
    if to_iplan {
        write_iplan(args, &blob, &mut problems)?;
    } else if !has_errors(&problems) {
        let image = Image::of(&args.output, args.compiling.board).map_err(Failure::Usage)?;
        let file = image.encode(&blob);
        problems.extend(output::write_file(&args.output, |out| out.write_all(&file)).err());
    }
    if has_errors(&problems) {
        return Err(Failure::Wrong(problems));
    }
    tell(&problems, quiet);
    Ok(())
}

fn write_iplan(args: &Convert, blob: &[u8], problems: &mut Vec<Problem>) -> Result<(), Failure> {
    let plan = open(&args.input, blob)?;
    problems.extend(iplan::check(&plan));
    if !has_errors(problems) {
        let name = file_name(&args.input);
        let written = output::write_file(&args.output, |out| iplan::write(out, &plan, &name));
        problems.extend(written.err());
    }
    Ok(())
}

/// Whether any option concerns the compilation of a map.
fn is_about_maps(args: &Compiling) -> bool {
    let (map, reading) = (&args.map, args.map.reading.options());
    !args.goals.is_empty()
        || args.max_memory.is_some()
        || reading != ReadOptions::default()
        || map.mission.is_some()
        || map.robot.is_some()
        || map.resolution.is_some()
        || map.robot_radius.is_some()
        || map.corners.is_some()
        || map.fill_walls
}
