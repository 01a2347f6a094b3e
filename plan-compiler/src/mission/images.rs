//! Images whose shades mean something: costs or speeds.

use crate::toml::{Report, Text};
use maps::formats::ros::{Shades, read_shades};
use maps::problem::Severity;
use std::path::{Path, PathBuf};

/// Whether a file's name is that of an image or of a ROS map.
pub(super) fn is_image_name(name: &str) -> bool {
    let extension = Path::new(name).extension().and_then(|extension| extension.to_str());
    extension.is_some_and(|extension| {
        ["png", "pgm", "ppm", "pbm", "pnm", "bmp", "jpg", "jpeg", "yaml", "yml"]
            .iter()
            .any(|known| extension.eq_ignore_ascii_case(known))
    })
}

/// Reads the image that a mission names; reports what is wrong with it.
pub(super) fn shades(report: &mut Report<'_>, name: &Text) -> Option<(PathBuf, Shades)> {
    let path = report.beside(name.as_str());
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("npy")) {
        let help = format!("an array has factors, not shades: write costs = \"{}\"", name.as_str());
        report.error(format!("{} is not an image", path.display()), &name.span, "an array", &help);
        return None;
    }
    let (shades, found) = read_shades(&path);
    let source = report.source;
    let worth_saying = found.into_iter().filter(|problem| problem.severity > Severity::Note);
    report.problems.extend(worth_saying.map(|problem| match problem.place {
        None => problem.at(source, name.span.clone(), "named here"),
        Some(_) => problem,
    }));
    Some((path, shades?))
}
