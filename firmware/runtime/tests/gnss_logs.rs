//! Logs of real receivers, good and damaged, compared with the results of independent decoders.
//!
//! The files come from third parties and are not part of the project: without them these tests
//! print a note and return. `gps_streams.rs` has generated streams.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use runtime::gps::{Decoder, Solution};

#[test]
fn nav_pvt_is_read_as_pyubx2_reads_it() {
    let Some(folder) = logs() else { return };
    let rows = rows(&folder.join("nav_pvt_expected.csv"));
    let mut expected: BTreeMap<&str, Vec<Solution>> = BTreeMap::new();
    for row in &rows {
        let number = |column: &str| row[column].parse::<i64>().expect("a number");
        let fix_type = number("fixType");
        expected.entry(&row["file"]).or_default().push(Solution {
            is_valid: number("gnssFixOK") == 1 && (2..=4).contains(&fix_type),
            place: math::GeoPoint {
                lat_e7: number("lat_1e7") as i32,
                lon_e7: number("lon_1e7") as i32,
            },
            accuracy_mm: number("hAcc_mm") as u32,
            velocity_mmps: Some([number("velE_mm_s") as i32, number("velN_mm_s") as i32]),
            receiver_ms: None,
        });
    }
    assert_eq!(expected.len(), 6, "files with NAV-PVT");
    for (file, expected) in expected {
        // The table has no time of the week.
        let read = decode(&folder.join(file)).into_iter();
        let read: Vec<Solution> =
            read.map(|solution| Solution { receiver_ms: None, ..solution }).collect();
        assert_eq!(read, expected, "{file}");
    }
}

#[test]
fn nmea_is_read_as_pynmea2_reads_it() {
    let Some(folder) = logs() else { return };
    let rows = rows(&folder.join("nmea_fix_expected.csv"));
    for (file, valid_count) in [
        ("nmea_with_sat_info.log", 36),
        ("mt3339.log", 30),
        // One epoch has both sentences; the epochs before it lack RMC.
        ("gp-320fw-2019-04-07-coldboot.log", 1),
    ] {
        let rows: Vec<&Row> = rows.iter().filter(|row| row["file"] == file).collect();
        let expected = merged(&rows);
        let solutions: Vec<Solution> =
            decode(&folder.join(file)).into_iter().filter(|solution| solution.is_valid).collect();
        assert_eq!(solutions.len(), expected.len(), "{file}");
        assert_eq!(solutions.len(), valid_count, "{file}");
        for (solution, expected) in solutions.iter().zip(&expected) {
            expected.check(solution, file);
        }
    }
}

#[test]
fn logs_without_a_fix_give_none() {
    let Some(folder) = logs() else { return };
    // Cut sentences and sentences without a position; SiRF binary; a u-blox too old for NAV-PVT.
    for file in ["NMEABADEND.log", "bu303-nofix.log", "ublox-aek-4t.log"] {
        assert_eq!(decode(&folder.join(file)), [], "{file}");
    }
}

/// Damaged logs of real receivers never give a place that the receivers did not send.
#[test]
fn flipped_bytes_give_no_wrong_fix() {
    let Some(folder) = logs() else { return };
    for file in ["ublox-neo-m8n.log", "mt3339.log", "MIXED3.log"] {
        let bytes = std::fs::read(folder.join(file)).expect("a log is readable");
        let undamaged = decode_bytes(&bytes);
        assert!(!undamaged.is_empty());
        for (stride, mask) in [(97, 0x01), (61, 0x80), (41, 0xff), (13, 0x10)] {
            let mut damaged = bytes.clone();
            damaged.iter_mut().step_by(stride).for_each(|byte| *byte ^= mask);
            let places: Vec<_> = undamaged.iter().map(|solution| solution.place).collect();
            for solution in decode_bytes(&damaged) {
                assert!(places.contains(&solution.place), "{file} {stride} {solution:?}");
            }
        }
    }
}

/// An epoch with a fix according to both RMC and GGA.
struct Epoch {
    lat_deg: f64,
    lon_deg: f64,
    hdop: f64,
    quality: u8,
    speed_kn: f64,
    course_deg: Option<f64>,
}

impl Epoch {
    fn check(&self, solution: &Solution, file: &str) {
        let Solution { place, accuracy_mm, velocity_mmps, .. } = *solution;
        // The table has 1e-8 degrees, so the last digit may round either way.
        let error = |e7: i32, degrees: f64| (f64::from(e7) - degrees * 1e7).abs();
        assert!(error(place.lat_e7, self.lat_deg) <= 1.0, "{file} {place:?} {}", self.lat_deg);
        assert!(error(place.lon_e7, self.lon_deg) <= 1.0, "{file} {place:?} {}", self.lon_deg);
        let metres_per_hdop = if self.quality == 2 { 2.0 } else { 4.0 };
        let accuracy = self.hdop * metres_per_hdop * 1e3;
        assert!((f64::from(accuracy_mm) - accuracy).abs() <= 1.0, "{file} {accuracy_mm}");
        let speed = self.speed_kn * 1852.0 / 3.6;
        match (velocity_mmps, self.course_deg) {
            (Some([east, north]), Some(course)) => {
                // Sine and cosine are accurate to about 1e-3.
                let course = course.to_radians();
                let bound = 2.0 + speed * 3e-3;
                let wide_sin = math::scalar::wide::sin(course);
                let wide_cos = math::scalar::wide::cos(course);
                assert!((f64::from(east) - speed * wide_sin).abs() < bound, "{file} {east}");
                assert!((f64::from(north) - speed * wide_cos).abs() < bound, "{file} {north}");
            }
            (Some(velocity), None) => assert!(velocity == [0, 0] && speed == 0.0, "{file}"),
            (None, course) => assert!(course.is_none() && speed > 0.0, "{file}: no velocity"),
        }
    }
}

/// Epochs of a log in which both sentences have a fix.
fn merged(rows: &[&Row]) -> Vec<Epoch> {
    let of = |row: &Row, kind: &str| row["type"] == kind;
    let mut epochs = Vec::new();
    for pair in rows.windows(2) {
        let (gga, rmc) = match pair {
            [a, b] if of(a, "GGA") && of(b, "RMC") => (a, b),
            [a, b] if of(a, "RMC") && of(b, "GGA") => (b, a),
            _ => continue,
        };
        let quality = gga["status_or_quality"].parse().expect("a quality");
        if gga["time"] != rmc["time"] || rmc["status_or_quality"] != "A" || quality == 0 {
            continue;
        }
        let number = |row: &Row, column: &str| row[column].parse::<f64>().expect("a number");
        epochs.push(Epoch {
            lat_deg: number(gga, "lat_deg"),
            lon_deg: number(gga, "lon_deg"),
            hdop: number(gga, "hdop"),
            quality,
            speed_kn: number(rmc, "speed_kn"),
            course_deg: rmc["course_deg"].parse().ok(),
        });
    }
    epochs
}

fn decode(path: &Path) -> Vec<Solution> {
    decode_bytes(&std::fs::read(path).expect("a log is readable"))
}

fn decode_bytes(bytes: &[u8]) -> Vec<Solution> {
    let mut decoder = Decoder::default();
    bytes.iter().filter_map(|&byte| decoder.push(byte)).collect()
}

type Row = BTreeMap<String, String>;

/// The rows of a table without quotes, by column name.
fn rows(path: &Path) -> Vec<Row> {
    let text = std::fs::read_to_string(path).expect("a table is readable");
    let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned));
    let names: Vec<String> = lines.next().expect("a header").collect();
    lines.map(|cells| names.iter().cloned().zip(cells).collect()).collect()
}

fn logs() -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/gnss");
    if path.is_dir() {
        return Some(path);
    }
    eprintln!(
        "skipped: {} is missing (logs from third parties, not part of the project)",
        path.display()
    );
    None
}
