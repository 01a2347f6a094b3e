//! The image of a map's cells.

use crate::problem::{Problem, Source};
use crate::source::read_bytes;
use image::{DynamicImage, ImageError, ImageFormat, ImageReader, Limits};
use plan_format::limits;
use std::io::{Cursor, ErrorKind};
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// Bytes that decoding may take: the largest image, eight bits a pixel, several times over.
const MAX_DECODED_BYTES: u64 = 1 << 30;
/// Images of a folder that are listed where the one that is named is not there.
const LISTED: usize = 8;

/// Lightness by pixel.
pub(super) struct Grey {
    pub(super) columns: u32,
    pub(super) rows: u32,
    pixels: DynamicImage,
}

impl Grey {
    /// Lightness of a pixel, 0 to 1, and whether it is transparent; row 0 is the image's first.
    pub(super) fn pixel(&self, column: u32, row: u32) -> (f64, bool) {
        let [red, green, blue, alpha] = match &self.pixels {
            DynamicImage::ImageLuma8(pixels) => {
                let grey = pixels.get_pixel(column, row).0[0];
                return (f64::from(grey) / 255.0, false);
            }
            DynamicImage::ImageRgba16(pixels) => pixels.get_pixel(column, row).0,
            // No other kind is kept.
            _ => [0; 4],
        };
        let sum = f64::from(red) + f64::from(green) + f64::from(blue);
        (sum / (3.0 * 65_535.0), alpha < u16::MAX)
    }
}

/// Reads the image that a YAML file names.
pub(super) fn read(
    yaml: &Path,
    source: &Arc<Source>,
    (name, span): &(String, Range<usize>),
) -> Result<Grey, Problem> {
    let path = yaml.with_file_name(name);
    let wrong = |message: String, mend: String| {
        Problem::error(message).at(source, span.clone(), "this image").mend(mend)
    };
    let bytes = read_bytes(&path).map_err(|problem| {
        let mend = others(yaml).or(problem.mend).unwrap_or_default();
        wrong(problem.message, mend)
    })?;
    decode(&bytes).map_err(|reason| {
        let message = format!("{} is no image that can be read: {reason}", path.display());
        wrong(message, "save it as a PGM or PNG of at most 16384 pixels a side".into())
    })
}

fn decode(bytes: &[u8]) -> Result<Grey, String> {
    let mut reader = ImageReader::new(Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|error| error.to_string())?;
    if !matches!(reader.format(), Some(ImageFormat::Pnm | ImageFormat::Png)) {
        return Err("it is neither PGM nor PNG".into());
    }
    let mut bounds = Limits::default();
    bounds.max_image_width = Some(limits::MAX_SIDE_CELLS);
    bounds.max_image_height = Some(limits::MAX_SIDE_CELLS);
    bounds.max_alloc = Some(MAX_DECODED_BYTES);
    reader.limits(bounds);
    let pixels = match reader.decode().map_err(reason)? {
        grey @ DynamicImage::ImageLuma8(_) => grey,
        // Wide enough for every other kind: a value of eight bits times 257 is the same share.
        other => DynamicImage::ImageRgba16(other.into_rgba16()),
    };
    let (columns, rows) = (pixels.width(), pixels.height());
    if columns == 0 || rows == 0 {
        return Err("it has no pixels".into());
    }
    Ok(Grey { columns, rows, pixels })
}

/// Why an image cannot be read; where it was cut off the library speaks of its buffers.
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
        ["pgm", "pnm", "png"].iter().any(|known| extension.eq_ignore_ascii_case(known))
    })
}

/// Says of an image that it is no map without its YAML file.
pub(crate) fn refuse_alone(path: &Path, bytes: &[u8]) -> Option<Problem> {
    let is_pnm = matches!(bytes, [b'P', b'1'..=b'7', b' ' | b'\t' | b'\r' | b'\n', ..]);
    if !is_pnm && !bytes.starts_with(b"\x89PNG\r\n") {
        return None;
    }
    let problem = Problem::error(format!("{} is an image without a scale", path.display()));
    let yaml = path.with_extension("yaml");
    Some(problem.mend(if yaml.exists() {
        format!("name the file that describes it: {}", yaml.display())
    } else {
        "name the YAML file that goes with it: image, resolution, origin, thresholds".into()
    }))
}
