//! The image of a map's cells.

mod pnm;

use crate::problem::{Problem, Source};
use crate::source::read_bytes;
use image::{DynamicImage, ImageError, ImageFormat, ImageReader, Limits};
use math::grid;
use std::io::{Cursor, ErrorKind};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Most bytes that decoding may allocate: several times the largest image at 8 bits per pixel.
const MAX_DECODED_BYTES: u64 = 1 << 30;
/// Most images of a folder that are listed if the named one is missing.
const LISTED: usize = 8;

/// Help for a file that cannot be read.
pub(super) const HELP: &str = "save it as a PGM, PNG or BMP of at most 16384 pixels a side";

/// An image as lightness per pixel.
pub(super) struct Grey {
    /// Its file.
    pub(super) path: PathBuf,
    pub(super) columns: u32,
    pub(super) rows: u32,
    pixels: DynamicImage,
}

impl Grey {
    /// Lightness of a pixel, 0 to 1, and whether the pixel is transparent; row 0 is the image's
    /// first. The lightness of a colour is the mean of red, green and blue.
    pub(super) fn pixel(&self, column: u32, row: u32) -> (f64, bool) {
        let eight = |values: &[u8], alpha: u8| (mean(values, 255.0), alpha < u8::MAX);
        let sixteen = |values: &[u16], alpha: u16| (mean(values, 65_535.0), alpha < u16::MAX);
        match &self.pixels {
            DynamicImage::ImageLuma8(image) => eight(&image.get_pixel(column, row).0, u8::MAX),
            DynamicImage::ImageRgb8(image) => eight(&image.get_pixel(column, row).0, u8::MAX),
            DynamicImage::ImageLuma16(image) => sixteen(&image.get_pixel(column, row).0, u16::MAX),
            DynamicImage::ImageRgb16(image) => sixteen(&image.get_pixel(column, row).0, u16::MAX),
            DynamicImage::ImageLumaA8(image) => {
                let [grey, alpha] = image.get_pixel(column, row).0;
                eight(&[grey], alpha)
            }
            DynamicImage::ImageRgba8(image) => {
                let [red, green, blue, alpha] = image.get_pixel(column, row).0;
                eight(&[red, green, blue], alpha)
            }
            DynamicImage::ImageLumaA16(image) => {
                let [grey, alpha] = image.get_pixel(column, row).0;
                sixteen(&[grey], alpha)
            }
            DynamicImage::ImageRgba16(image) => {
                let [red, green, blue, alpha] = image.get_pixel(column, row).0;
                sixteen(&[red, green, blue], alpha)
            }
            // The enabled decoders make no other kind; treat its pixels as unknown.
            _ => (0.0, true),
        }
    }
}

/// The mean of values as a fraction of the largest possible value.
fn mean<T: Copy + Into<f64>>(values: &[T], largest: f64) -> f64 {
    let sum: f64 = values.iter().map(|&value| value.into()).sum();
    sum / (values.len() as f64 * largest)
}

/// Reads the image that a YAML file names.
pub(super) fn read(
    yaml: &Path,
    source: &Arc<Source>,
    (name, span): &(String, Range<usize>),
) -> Result<Grey, Problem> {
    let path = path_of(yaml, name);
    let wrong = |message: String, help: String| {
        Problem::error(message).at(source, span.clone(), "this image").help(help)
    };
    let bytes = read_bytes(&path).map_err(|problem| {
        let help = moved(yaml, &path).or_else(|| others(yaml)).or(problem.help);
        wrong(problem.message, help.unwrap_or_default())
    })?;
    decode(&path, &bytes).map_err(|reason| {
        let message = format!("{} cannot be read as an image: {reason}", path.display());
        wrong(message, HELP.into())
    })
}

/// Path of an image, relative to the YAML file. Backslashes separate folders on Windows and are
/// letters of a name elsewhere.
fn path_of(yaml: &Path, name: &str) -> PathBuf {
    let path = yaml.with_file_name(name);
    let slashes = yaml.with_file_name(name.replace('\\', "/"));
    if !path.exists() && slashes.exists() { slashes } else { path }
}

/// Help if an image of that name lies beside the YAML file.
fn moved(yaml: &Path, path: &Path) -> Option<String> {
    let name = path.to_str()?.rsplit(['/', '\\']).next()?;
    let is_there = yaml.with_file_name(name).is_file();
    is_there.then(|| format!("it lies beside the YAML file: write `image: {name}`"))
}

pub(super) fn decode(path: &Path, bytes: &[u8]) -> Result<Grey, String> {
    let mut reader = ImageReader::new(Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|error| error.to_string())?;
    if !matches!(reader.format(), Some(ImageFormat::Pnm | ImageFormat::Png | ImageFormat::Bmp)) {
        return Err("it is neither PGM, PNG nor BMP".into());
    }
    let mut bounds = Limits::default();
    bounds.max_image_width = Some(grid::MAX_SIDE_CELLS);
    bounds.max_image_height = Some(grid::MAX_SIDE_CELLS);
    bounds.max_alloc = Some(MAX_DECODED_BYTES);
    reader.limits(bounds);
    let is_pnm = reader.format() == Some(ImageFormat::Pnm);
    let pixels = reader.decode().map_err(reason)?;
    if is_pnm {
        pnm::check(bytes)?;
    }
    let (columns, rows) = (pixels.width(), pixels.height());
    if columns == 0 || rows == 0 {
        return Err("it has no pixels".into());
    }
    Ok(Grey { path: path.to_owned(), columns, rows, pixels })
}

/// Why an image cannot be read; for a truncated file the library mentions only its buffers.
fn reason(error: ImageError) -> String {
    match error {
        ImageError::IoError(error) if error.kind() == ErrorKind::UnexpectedEof => {
            "it is cut off".into()
        }
        ImageError::Limits(_) => "it is too large".into(),
        other => other.to_string(),
    }
}

/// The images beside a YAML file.
fn others(yaml: &Path) -> Option<String> {
    let folder = yaml.parent().filter(|folder| !folder.as_os_str().is_empty());
    let entries = std::fs::read_dir(folder.unwrap_or(Path::new("."))).ok()?;
    let mut names: Vec<String> = entries
        .flatten()
        .filter_map(|entry| entry.file_name().into_string().ok())
        .filter(|name| is_image_name(name))
        .collect();
    names.sort_unstable();
    let more = if names.len() > LISTED { ", ..." } else { "" };
    names.truncate(LISTED);
    Some(match names.is_empty() {
        true => "there is no image in that folder; put it beside the YAML file".into(),
        false => format!("the folder holds: {}{more}", names.join(", ")),
    })
}

fn is_image_name(name: &str) -> bool {
    let extension = Path::new(name).extension().and_then(|extension| extension.to_str());
    extension.is_some_and(|extension| {
        ["pgm", "pnm", "ppm", "pbm", "png", "bmp"]
            .iter()
            .any(|known| extension.eq_ignore_ascii_case(known))
    })
}

/// Whether bytes begin like a PGM, PNG or BMP.
pub(super) fn is_image(bytes: &[u8]) -> bool {
    // The header of a BMP has four reserved bytes, which are 0.
    let is_bmp = matches!(bytes, [b'B', b'M', _, _, _, _, 0, 0, 0, 0, ..]);
    is_bmp || is_pnm_or_png(bytes)
}

fn is_pnm_or_png(bytes: &[u8]) -> bool {
    matches!(bytes, [b'P', b'1'..=b'7', b' ' | b'\t' | b'\r' | b'\n', ..])
        || bytes.starts_with(b"\x89PNG\r\n")
}

/// An error if the file is an image, which is not a map without its YAML file.
pub(crate) fn refuse_alone(path: &Path, bytes: &[u8]) -> Option<Problem> {
    if !is_pnm_or_png(bytes) {
        return None;
    }
    let problem = Problem::error(format!("{} is an image without a scale", path.display()));
    let yaml = path.with_extension("yaml");
    Some(problem.help(if yaml.exists() {
        format!("name the file that describes it: {}", yaml.display())
    } else {
        "name the YAML file that goes with it: image, resolution, origin, thresholds".into()
    }))
}
