//! `cover`: strips over an area.

use super::progress::with_patience;
use super::{Failure, file_name, print_json, print_text, project, tell};
use crate::cli::Cover as Args;
use maps::numbers::metres;
use maps::problem::{Problem, has_errors};
use maps::terminal::quoted;
use maps::{Bitmap, Source};
use plan_compiler::cover::{
    Area, Asked, Cover, Settings, Site, Strip, Writing, check_asked, check_settings, corners,
    cover, covered, csv, geojson, mission, other_behaviours, site,
};
use plan_compiler::input::Input;
use plan_compiler::project::{Project, is_mission};
use plan_compiler::render::{Strips, png, strips};
use plan_compiler::search::Corners;
use plan_compiler::{compile, mission as missions, output};
use serde::Serialize;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toml_edit::Value;

/// The kind of file to write.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Mission,
    Csv,
    Geojson,
    Svg,
    Png,
}

pub(super) fn run(args: &Args, quiet: bool) -> Result<(), Failure> {
    let kind = args.output.as_deref().map(kind).transpose()?;
    if args.plan_each && kind != Some(Kind::Mission) {
        let message = "--plan-each is about missions: end the output's name in .toml";
        return Err(Failure::Usage(message.into()));
    }
    let mut problems = Vec::new();
    let project = read(args, quiet, &mut problems)?;
    let input = project.input();
    let area = match args.area.as_deref() {
        Some(name) => Area::named(&project.map, name),
        None => corners(&args.polygon).map_err(|problem| vec![problem]),
    };
    let area = area.map_err(|found| problems.extend(found)).ok();
    let grid = compile::grid(&input, &mut problems);
    let settings = Settings {
        width_m: args.width,
        overlap_m: args.overlap,
        angle_deg: args.angle,
        leave_m2: args.leave,
        start: [0.0, 0.0],
    };
    if let (Some(area), Some(grid)) = (&area, &grid) {
        problems.extend(check_settings(area, grid, &settings));
    }
    if let (Some(output), Some(kind)) = (&args.output, kind) {
        // The mission that is added to may be replaced: that is what adding means.
        let inputs =
            project.inputs.iter().filter(|path| kind != Kind::Mission || !is_mission(path));
        problems.extend(output::check_against(output, &inputs.collect::<Vec<_>>()));
    }
    let asked = Asked { layer: args.layer.as_deref(), edge_m: args.edge, start: args.start };
    let area = area.filter(|_| !has_errors(&problems));
    if let (None, Some(grid)) = (&area, &grid) {
        check_asked(&input, grid, asked, &mut problems);
    }
    let site = area.and_then(|area| site(&input, area, asked, &mut problems));
    let Some(site) = site.filter(|_| !has_errors(&problems)) else {
        return Err(Failure::Wrong(problems));
    };
    let settings = Settings { start: site.start, ..settings };
    let laying = || cover(&site.ground, site.passable(), &site.area.edges_deg(), &settings);
    let laid = with_patience(quiet, "laying strips", laying);
    let found = Found::of(args, &site, laid, settings);
    problems.extend(found.warnings(&input));
    if let (Some(output), Some(kind)) = (&args.output, kind) {
        let bytes = match kind {
            Kind::Mission => found.mission(args, &project, output, &mut problems)?.into_bytes(),
            Kind::Csv => csv(&found.cover).into_bytes(),
            Kind::Geojson => {
                let frame = compile::map_frame(&input).ok_or_else(no_place)?;
                geojson(&found.cover, &frame).into_bytes()
            }
            Kind::Svg | Kind::Png => found.picture(args, &input, kind)?,
        };
        output::write_file(output, |out| out.write_all(&bytes))?;
    }
    tell(&problems, quiet);
    if args.json {
        return print_json(&found.summary());
    }
    if quiet { Ok(()) } else { print_text(&found.text()) }
}

fn kind(output: &Path) -> Result<Kind, Failure> {
    let extension = output.extension().and_then(|extension| extension.to_str());
    match extension.map(str::to_ascii_lowercase).as_deref() {
        Some("toml") => Ok(Kind::Mission),
        Some("csv") => Ok(Kind::Csv),
        Some("geojson") => Ok(Kind::Geojson),
        Some("svg") => Ok(Kind::Svg),
        Some("png") => Ok(Kind::Png),
        _ => Err(Failure::Usage(
            "the output's name must end in .toml, .csv, .geojson, .svg or .png".into(),
        )),
    }
}

fn read(args: &Args, quiet: bool, problems: &mut Vec<Problem>) -> Result<Project, Failure> {
    let mut options = project::options(&[], &args.map);
    // In maps with tags, an area may be all objects of a kind.
    options.reading.tags.keep.extend(args.area.as_deref().and_then(missions::kind));
    options.reading.tags.used.extend(args.area.clone());
    let reading =
        || project::read_with(&args.input, options, args.map.mission.as_deref(), problems);
    match with_patience(quiet, "reading", reading)? {
        Some(project) => Ok(project),
        None => Err(Failure::Wrong(std::mem::take(problems))),
    }
}

fn no_place() -> Problem {
    Problem::error("the map has no place on the globe, which GeoJSON needs")
        .help("write .csv instead, or give the map a reference: GLOBAL_REF_POINT in an overlay")
}

/// Everything that was computed.
struct Found<'s> {
    /// The map or the mission, as it was named.
    name: String,
    site: &'s Site,
    settings: Settings,
    cover: Cover,
    /// Cells within half the width and half a cell of a strip.
    covered: Bitmap,
    /// Cells that are wanted and not covered: beside obstacles and edges, out of reach, in gaps.
    uncovered: [usize; 3],
}

impl<'s> Found<'s> {
    fn of(args: &Args, site: &'s Site, cover: Cover, settings: Settings) -> Self {
        let grid = &site.ground.grid;
        let within_m = settings.width_m / 2.0 + grid.resolution_m / 2.0;
        let covered = covered(grid, &cover.strips, within_m);
        let mut uncovered = [0; 3];
        for cell in site.wanted.iter().filter(|cell| !covered.get(*cell)) {
            let kind = match (site.ground.cells.get(cell), site.cut_off.get(cell)) {
                (true, _) => 2,
                (_, true) => 1,
                _ => 0,
            };
            uncovered[kind] += 1;
        }
        let name = file_name(&args.input);
        Self { name, site, settings, cover, covered, uncovered }
    }

    fn m2(&self, cells: usize) -> f64 {
        let side = self.site.ground.grid.resolution_m;
        rounded(cells as f64 * side * side)
    }

    /// Share of the wanted cells that is covered.
    fn share(&self) -> f64 {
        let wanted = self.site.wanted.count();
        1.0 - self.uncovered.iter().sum::<usize>() as f64 / wanted.max(1) as f64
    }

    /// Share of the wanted cells whose centres are within half the width of a strip.
    fn strict_share(&self) -> f64 {
        let wanted = &self.site.wanted;
        let within =
            covered(&self.site.ground.grid, &self.cover.strips, self.settings.width_m / 2.0);
        let count = wanted.iter().filter(|cell| within.get(*cell)).count();
        count as f64 / wanted.count().max(1) as f64
    }

    fn plans(&self) -> usize {
        self.cover.transitions.iter().filter(|transition| transition.leaves).count()
    }

    /// What stays uncovered, and vehicles that cannot turn from strip to strip.
    fn warnings(&self, input: &Input<'_>) -> Vec<Problem> {
        let mut warnings = Vec::new();
        let [beside, cut_off, gaps] = self.uncovered.map(|cells| self.m2(cells));
        let Site { radius_m, edge_m, .. } = *self.site;
        let off_map = rounded(self.site.off_map_m2);
        let mut warn = |area_m2: f64, message: String, help: &str| {
            if area_m2 > 0.0 {
                warnings.push(Problem::warning(message).help(help));
            }
        };
        warn(
            off_map,
            format!("{off_map} m2 of the area lie off the map"),
            "they are not covered and do not count; use a map that contains the whole area",
        );
        warn(
            beside,
            format!(
                "{beside} m2 stay uncovered beside obstacles and edges: strips keep {} m from \
                 obstacles and {} m from the edge of the area, and the tool reaches {} m",
                metres(radius_m),
                metres(edge_m),
                metres(self.settings.width_m / 2.0)
            ),
            match edge_m > 0.0 {
                true => "make --edge smaller, or let the tool reach beyond the body",
                false => "use a finer --resolution: strips keep to whole cells inside the area",
            },
        );
        warn(
            cut_off,
            format!("{cut_off} m2 stay uncovered: the robot cannot reach them from its start"),
            "give another --start, or cover them in a mission of their own",
        );
        warn(
            gaps,
            format!("{gaps} m2 stay uncovered in gaps between strips"),
            "make --leave smaller",
        );
        let transitions = self.plans();
        warn(
            transitions as f64,
            format!("{transitions} of the transitions between strips leave the area"),
            "no route inside leads there; cover the parts of the area one by one to keep inside",
        );
        let turn = f64::from(input.mission.parameters.vehicle.min_turn_radius_m);
        let apart = self.settings.width_m - self.settings.overlap_m;
        warn(
            if 2.0 * turn > apart { 1.0 } else { 0.0 },
            format!(
                "the vehicle's smallest turning circle is {} m wide, and neighbouring strips are \
                 {} m apart: it cannot turn from one to the next at once",
                metres(2.0 * turn),
                metres(apart)
            ),
            "it manoeuvres between them; leave room for that with --edge",
        );
        warnings
    }

    /// The text of the mission, which is built before it is written.
    fn mission(
        &self,
        args: &Args,
        project: &Project,
        output: &Path,
        problems: &mut Vec<Problem>,
    ) -> Result<String, Failure> {
        let base = project.inputs.iter().find(|path| is_mission(path));
        let base_text = base.map(fs::read_to_string).transpose();
        let base_text = base_text.map_err(|error| {
            Problem::error(format!("the mission cannot be read again: {error}"))
        })?;
        if let Some(base) = base.filter(|base| folder(base) != folder(output)) {
            let message = "the mission must lie beside the one that it adds to, since it names \
                           files relative to itself";
            let help = format!("write it to the folder of {}", quoted(base));
            return Err(Problem::error(message).help(help).into());
        }
        let others = other_behaviours(base_text.as_deref().unwrap_or_default());
        if !others.is_empty() && !args.plan_each {
            let message = format!(
                "after another behaviour ({}), the robot returns to its strip without a plan, and \
                 may be caught behind an obstacle",
                others.join(", ")
            );
            problems.push(Problem::warning(message).help("--plan-each leads it back by a plan"));
        }
        let map = project.mission.map.as_ref().filter(|_| is_mission(&args.input));
        let map = relative(map.unwrap_or(&project.inputs[0]), &folder(output));
        let title = self.title(args);
        let set = set(args);
        let writing = Writing {
            base: base_text.as_deref(),
            map: &map,
            points: &project.map.points,
            set: &set,
            width_m: self.settings.width_m,
            plan_each: args.plan_each,
            speed_mps: project.mission.parameters.vehicle.base_speed_mps.into(),
            title: &title,
        };
        let text = mission(&self.cover, &writing)?;
        keep(output, base.map(PathBuf::as_path), &text)?;
        let source = Source { name: output.display().to_string(), text: text.clone() };
        let (written, mut found) = missions::parse(&Arc::new(source));
        let input = Input { mission: &written, ..project.input() };
        // Warnings about the map have been given.
        let _ = compile::prepare(&input, &mut found);
        if has_errors(&found) {
            problems.extend(found);
            return Err(Failure::Wrong(std::mem::take(problems)));
        }
        Ok(text)
    }

    fn title(&self, args: &Args) -> String {
        let area = &self.site.area.name;
        let angle = metres(self.cover.angle_deg);
        let width = metres(args.width);
        format!(
            "{area}, {} strips for a width of {width} m at {angle} degrees",
            self.cover.strips.len()
        )
    }

    fn picture(&self, args: &Args, input: &Input<'_>, kind: Kind) -> Result<Vec<u8>, Failure> {
        let grid = &self.site.ground.grid;
        let free = &self.site.anywhere.cells;
        let blocked = Bitmap::from_fn(grid.columns, grid.rows, |cell| !free.get(cell));
        let lines: Vec<_> =
            self.cover.strips.iter().map(|Strip { from, to }| [*from, *to]).collect();
        let svg = strips(
            &Strips {
                title: &format!("{}: {}", self.name, self.title(args)),
                grid,
                heading_rad: compile::origin(input).map(|origin| origin.heading_rad),
                blocked: &blocked,
                wanted: &self.site.wanted,
                covered: &self.covered,
                features: &input.map.features,
                outlines: &self.site.area.outlines(),
                strips: &lines,
                transitions: &self.cover.transition_lines(),
            },
            args.size,
        );
        let failed = |reason| Problem::error(format!("cannot draw the PNG: {reason}"));
        Ok(if kind == Kind::Svg { svg.into_bytes() } else { png(&svg).map_err(failed)? })
    }

    fn summary(&self) -> Summary<'_> {
        let [beside_m2, cut_off_m2, gaps_m2] = self.uncovered.map(|cells| self.m2(cells));
        Summary {
            map: &self.name,
            area: &self.site.area.name,
            width_m: self.settings.width_m,
            angle_deg: rounded(self.cover.angle_deg),
            area_m2: rounded(self.site.area.size_m2()),
            off_map_m2: rounded(self.site.off_map_m2),
            wanted_m2: self.m2(self.site.wanted.count()),
            covered_share: self.share(),
            covered_share_of_half_width: self.strict_share(),
            uncovered: Uncovered { beside_m2, cut_off_m2, gaps_m2 },
            strips: self.cover.strips.len(),
            strips_m: rounded(self.cover.strips_m()),
            transitions_m: rounded(self.cover.transitions_m()),
            turns: self.cover.turns(),
        }
    }

    fn text(&self) -> String {
        let cover = &self.cover;
        let area = &self.site.area;
        let mut text = String::new();
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "{}: area `{}`, {} m2; {} m2 are free of obstacles",
            self.name,
            area.name,
            rounded(area.size_m2()),
            self.m2(self.site.wanted.count())
        );
        let _ = writeln!(
            text,
            "  {} strips at {} degrees, {} m; transitions between them {} m; {} turns",
            cover.strips.len(),
            rounded(cover.angle_deg),
            rounded(cover.strips_m()),
            rounded(cover.transitions_m()),
            cover.turns()
        );
        let _ = writeln!(
            text,
            "  covered: {:.1} % within half the width and half a cell of a strip, {:.1} % within \
             half the width",
            100.0 * self.share(),
            100.0 * self.strict_share()
        );
        text
    }
}

/// To the tenth.
fn rounded(value: f64) -> f64 {
    (value * 10.0).round() / 10.0
}

/// The keys that the command line sets.
fn set(args: &Args) -> Vec<(&'static str, Value)> {
    let map = &args.map;
    let texts = |rules: &[maps::formats::TagRule]| {
        (!rules.is_empty()).then(|| rules.iter().map(ToString::to_string).collect::<Value>())
    };
    let corners = map.corners.map(|_| super::project::options(&[], map).corners);
    let corners = corners.flatten().map(|corners| match corners {
        Corners::Forbid => "forbid".into(),
        Corners::Allow => "allow".into(),
    });
    let origin = map.reading.origin.map(|at| [at.lat_deg(), at.lon_deg()].into_iter().collect());
    let keys = [
        ("resolution", map.resolution.map(Value::from)),
        ("robot_radius", map.robot_radius.map(Value::from)),
        ("corners", corners),
        ("fill_walls", map.fill_walls.then(|| true.into())),
        ("block", texts(&map.reading.block)),
        ("free", texts(&map.reading.free)),
        ("open_gates", map.reading.open_gates.then(|| true.into())),
        ("origin", origin),
    ];
    keys.into_iter().filter_map(|(key, value)| value.map(|value| (key, value))).collect()
}

/// Refuses to replace a mission that is not the one that is added to: what a user wrote there would be
/// lost.
fn keep(output: &Path, base: Option<&Path>, text: &str) -> Result<(), Problem> {
    if base.is_some_and(|base| output::is_same(base, output)) || !output.is_file() {
        return Ok(());
    }
    if fs::read(output).is_ok_and(|there| there == text.as_bytes()) {
        return Ok(());
    }
    let name = quoted(output);
    let message = format!("{} exists and would be replaced", output.display());
    Err(Problem::error(message).help(format!(
        "`plan-compiler cover {name} ... -o {name}` adds to it and replaces the strips of an earlier \
         run; or choose another output"
    )))
}

/// The folder of a file, without links.
fn folder(path: &Path) -> PathBuf {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned())
}

/// A file seen from a folder.
fn relative(path: &Path, from: &Path) -> String {
    let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let (path, from): (Vec<_>, Vec<_>) = (path.components().collect(), from.components().collect());
    let common = path.iter().zip(&from).take_while(|(a, b)| a == b).count();
    let up = std::iter::repeat_n(PathBuf::from(".."), from.len() - common);
    let down = path[common..].iter().map(PathBuf::from);
    // TOML files are the same on every system.
    up.chain(down).collect::<PathBuf>().display().to_string().replace('\\', "/")
}

/// The output of `--json`.
#[derive(Serialize)]
struct Summary<'f> {
    map: &'f str,
    area: &'f str,
    width_m: f64,
    angle_deg: f64,
    area_m2: f64,
    off_map_m2: f64,
    wanted_m2: f64,
    /// Within half the width and half a cell of a strip.
    covered_share: f64,
    /// Within half the width.
    covered_share_of_half_width: f64,
    uncovered: Uncovered,
    strips: usize,
    strips_m: f64,
    transitions_m: f64,
    turns: usize,
}

#[derive(Serialize)]
struct Uncovered {
    beside_m2: f64,
    cut_off_m2: f64,
    gaps_m2: f64,
}
