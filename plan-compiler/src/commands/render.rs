//! `render`: a layer as a picture.

use super::{Failure, find, open, read_blob, tell};
use crate::cli::Render;
use plan_compiler::compile::has_errors;
use plan_compiler::map::Feature;
use plan_compiler::problem::Problem;
use plan_compiler::render::{Overlay, picture, png};
use plan_compiler::{formats, output};

pub(super) fn run(args: &Render, quiet: bool) -> Result<(), Failure> {
    let extension = args.output.extension().and_then(|extension| extension.to_str());
    let as_png = match extension.map(str::to_ascii_lowercase).as_deref() {
        Some("svg") => false,
        Some("png") => true,
        _ => return Err(Failure::Usage("the output's name must end in .svg or .png".into())),
    };
    let bytes = read_blob(&args.plans)?;
    let plan = open(&args.plans, &bytes)?;
    let (parallel, layer) = find(&plan, &args.layer)?;
    let features = features(args, quiet)?;
    let overlay = Overlay { features: &features, ..Overlay::default() };
    let svg = picture(&plan, &parallel, &layer, &overlay);
    let bytes = if as_png {
        png(&svg).map_err(|reason| Problem::error(format!("cannot draw the PNG: {reason}")))?
    } else {
        svg.into_bytes()
    };
    Ok(output::write_file(&args.output, |out| out.write_all(&bytes))?)
}

/// The exact shapes of the map, if one is given.
fn features(args: &Render, quiet: bool) -> Result<Vec<Feature>, Failure> {
    let Some(path) = &args.map else { return Ok(Vec::new()) };
    let (map, problems) = formats::read(path, &args.reading.options());
    match map {
        Some(map) if !has_errors(&problems) => {
            tell(&problems, quiet);
            Ok(map.features)
        }
        _ => Err(Failure::Wrong(problems)),
    }
}
