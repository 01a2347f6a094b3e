//! Messages of GPS receivers as in the interface descriptions: u-blox UBX NAV-PVT, and NMEA 0183
//! RMC with GGA.

use math::GeoPoint;
use math::scalar::wide;

/// The protocol of a receiver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dialect {
    /// UBX NAV-PVT: binary, 100 bytes for each solution.
    Ubx,
    /// NMEA 0183: an RMC and a GGA sentence for each solution.
    Nmea,
}

/// One solution of a receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution {
    /// Microseconds since the start of the simulation, at noon of 1 June 2026, UTC.
    pub time_us: u64,
    /// Latitude and longitude.
    pub place: GeoPoint,
    /// Velocity east and north, m/s.
    pub velocity_mps: [f64; 2],
    /// The horizontal accuracy that the receiver reports, metres.
    pub accuracy_m: f64,
    /// The kind of solution.
    pub mode: Mode,
}

/// The kind of a solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// A fix by satellites alone.
    Autonomous,
    /// A fix by carrier phase and a reference station, to centimetres (RTK).
    Fixed,
    /// A position marked invalid in RMC but valid in GGA.
    Void,
    /// No position.
    NoFix,
}

impl Mode {
    /// The error relative to that of a fix by satellites alone.
    pub(super) fn share_of_error(self) -> f64 {
        if self == Self::Fixed { 0.02 } else { 1.0 }
    }

    fn is_valid(self) -> bool {
        matches!(self, Self::Autonomous | Self::Fixed)
    }

    /// The RMC status, and the RMC mode with the navigation status of version 4.1.
    fn of_rmc(self) -> (&'static str, &'static str) {
        match self {
            Self::Autonomous => ("A", "A"),
            Self::Fixed => ("A", "R,V"),
            Self::Void | Self::NoFix => ("V", "N"),
        }
    }

    /// The GGA quality, and the error at an HDOP of 1, metres, as the robot's driver assumes them.
    /// The error of a fix by satellites alone is that of the standard positioning service.
    fn of_gga(self) -> (u8, f64) {
        match self {
            Self::Autonomous | Self::Void => (1, 4.0),
            Self::Fixed => (4, 0.05),
            Self::NoFix => (0, 4.0),
        }
    }
}

impl Dialect {
    /// The bytes of a solution.
    pub fn message(self, solution: &Solution) -> Vec<u8> {
        match self {
            Self::Ubx => ubx_nav_pvt(solution),
            Self::Nmea => (rmc(solution) + &gga(solution)).into_bytes(),
        }
    }
}

/// Below this speed the receiver omits the course, knots.
const LEAST_SPEED_KN: f64 = 0.2;
/// Knots per m/s.
const KNOTS_PER_MPS: f64 = 3600.0 / 1852.0;
/// Length of the NAV-PVT payload, bytes.
const PAYLOAD: usize = 92;

fn ubx_nav_pvt(solution: &Solution) -> Vec<u8> {
    let mut payload = [0; PAYLOAD];
    let mut put = |at: usize, bytes: &[u8]| payload[at..at + bytes.len()].copy_from_slice(bytes);
    let (hour, minute, second) = clock(solution);
    // 1 June 2026 is a Monday, the second day of the GPS week.
    let week_ms = (86_400 + 43_200) * 1_000 + solution.time_us / 1_000;
    put(0, &((week_ms % 604_800_000) as u32).to_le_bytes());
    put(4, &2026_u16.to_le_bytes());
    put(6, &[6, 1, hour, minute, second, 0b111]);
    put(16, &((solution.time_us % 1_000_000 * 1_000) as i32).to_le_bytes());
    let is_valid = solution.mode.is_valid();
    let fix_type = if solution.mode == Mode::NoFix { 0 } else { 3 };
    put(20, &[fix_type, u8::from(is_valid), 0, 12]);
    put(24, &solution.place.lon_e7.to_le_bytes());
    put(28, &solution.place.lat_e7.to_le_bytes());
    put(40, &millimetres(solution.accuracy_m).to_le_bytes());
    put(44, &millimetres(solution.accuracy_m * 1.5).to_le_bytes());
    let [east, north] = solution.velocity_mps;
    put(48, &(millimetres(north)).to_le_bytes());
    put(52, &(millimetres(east)).to_le_bytes());
    put(60, &(millimetres(wide::hypot(east, north))).to_le_bytes());
    put(64, &((course_deg(solution) * 1e5).round() as i32).to_le_bytes());
    put(68, &100_u32.to_le_bytes());
    put(72, &500_000_u32.to_le_bytes());
    put(76, &120_u16.to_le_bytes());
    put(78, &[u8::from(!is_valid), 0]);
    ubx(0x01, 0x07, &payload)
}

/// A UBX message: sync characters, class, identity, length, payload, 8-bit Fletcher checksum.
pub fn ubx(class: u8, identity: u8, payload: &[u8]) -> Vec<u8> {
    let mut body = vec![class, identity];
    body.extend((payload.len() as u16).to_le_bytes());
    body.extend(payload);
    let (a, b) = body.iter().fold((0_u8, 0_u8), |(a, b), &byte| {
        let a = a.wrapping_add(byte);
        (a, b.wrapping_add(a))
    });
    [&[0xb5, 0x62], &body[..], &[a, b]].concat()
}

fn rmc(solution: &Solution) -> String {
    let (status, mode) = solution.mode.of_rmc();
    let speed = wide::hypot(solution.velocity_mps[0], solution.velocity_mps[1]) * KNOTS_PER_MPS;
    let course =
        if speed < LEAST_SPEED_KN { String::new() } else { format!("{:.2}", course_deg(solution)) };
    sentence(&format!(
        "GNRMC,{},{status},{},{speed:.3},{course},010626,,,{mode}",
        utc(solution),
        coordinates(solution.place),
    ))
}

fn gga(solution: &Solution) -> String {
    let (quality, metres_per_hdop) = solution.mode.of_gga();
    let hdop = (solution.accuracy_m / metres_per_hdop).max(0.01);
    sentence(&format!(
        "GNGGA,{},{},{quality},12,{hdop:.2},0.0,M,0.0,M,,",
        utc(solution),
        coordinates(solution.place),
    ))
}

/// An NMEA 0183 sentence: `$`, the body, its checksum and the line end.
pub fn sentence(body: &str) -> String {
    let checksum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{checksum:02X}\r\n")
}

/// Latitude and longitude as `ddmm.mmmmm,N,dddmm.mmmmm,E`; the last digit is worth 2 cm.
fn coordinates(place: GeoPoint) -> String {
    let parts = |degrees_e7: i32| {
        let minutes_e5 = (u64::from(degrees_e7.unsigned_abs()) * 60 + 50) / 100;
        let (degrees, minutes) = (minutes_e5 / 6_000_000, minutes_e5 % 6_000_000);
        (degrees, minutes / 100_000, minutes % 100_000)
    };
    let (degrees, minutes, fraction) = parts(place.lat_e7);
    let half = if place.lat_e7 < 0 { 'S' } else { 'N' };
    let lat = format!("{degrees:02}{minutes:02}.{fraction:05},{half}");
    let (degrees, minutes, fraction) = parts(place.lon_e7);
    let half = if place.lon_e7 < 0 { 'W' } else { 'E' };
    format!("{lat},{degrees:03}{minutes:02}.{fraction:05},{half}")
}

/// Time of day as `hhmmss.ss`.
fn utc(solution: &Solution) -> String {
    let (hour, minute, second) = clock(solution);
    format!("{hour:02}{minute:02}{second:02}.{:02}", solution.time_us / 10_000 % 100)
}

fn clock(solution: &Solution) -> (u8, u8, u8) {
    let seconds = solution.time_us / 1_000_000 + 43_200;
    ((seconds / 3_600 % 24) as u8, (seconds / 60 % 60) as u8, (seconds % 60) as u8)
}

/// Course clockwise from north, 0 to 360 degrees.
fn course_deg(solution: &Solution) -> f64 {
    let [east, north] = solution.velocity_mps;
    let degrees = wide::atan2(east, north).to_degrees();
    if degrees < 0.0 { degrees + 360.0 } else { degrees }
}

fn millimetres(metres: f64) -> i32 {
    (metres * 1e3).round() as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solution() -> Solution {
        Solution {
            time_us: 3_661_250_000,
            place: GeoPoint { lat_e7: 337_756_000, lon_e7: -843_990_001 },
            velocity_mps: [-1.0, 1.0],
            accuracy_m: 1.5,
            mode: Mode::Autonomous,
        }
    }

    #[test]
    fn sentences_are_as_in_the_standard() {
        let text = String::from_utf8(Dialect::Nmea.message(&solution())).expect("ASCII");
        assert_eq!(
            text,
            "$GNRMC,130101.25,A,3346.53600,N,08423.94001,W,2.749,315.00,010626,,,A*68\r\n\
             $GNGGA,130101.25,3346.53600,N,08423.94001,W,1,12,0.38,0.0,M,0.0,M,,*6E\r\n"
        );
    }

    #[test]
    fn a_receiver_that_stands_still_omits_the_course() {
        let solution = Solution { velocity_mps: [0.05, 0.05], ..solution() };
        let text = String::from_utf8(Dialect::Nmea.message(&solution)).expect("ASCII");
        assert!(text.contains(",W,0.137,,010626,,,A*"), "{text}");
    }

    #[test]
    fn each_mode_is_reported_in_both_sentences_and_in_nav_pvt() {
        for (mode, sentences, fix_type_and_flags) in [
            (Mode::Autonomous, [",A,3346.53600,", ",A*", ",W,1,12,0.38,"], [3, 1]),
            (Mode::Fixed, [",A,3346.53600,", ",R,V*", ",W,4,12,30.00,"], [3, 1]),
            (Mode::Void, [",V,3346.53600,", ",N*", ",W,1,12,0.38,"], [3, 0]),
            (Mode::NoFix, [",V,3346.53600,", ",N*", ",W,0,12,0.38,"], [0, 0]),
        ] {
            let solution = Solution { mode, ..solution() };
            let text = String::from_utf8(Dialect::Nmea.message(&solution)).expect("ASCII");
            assert!(sentences.iter().all(|part| text.contains(part)), "{mode:?}: {text}");
            let message = Dialect::Ubx.message(&solution);
            assert_eq!(message[6 + 20..6 + 22], fix_type_and_flags, "{mode:?}");
        }
    }

    #[test]
    fn nav_pvt_has_its_fields_at_the_offsets_of_the_protocol() {
        let bytes = Dialect::Ubx.message(&solution());
        assert_eq!(bytes.len(), 100);
        assert_eq!(bytes[..6], [0xb5, 0x62, 1, 7, 92, 0]);
        let field = |at: usize| i32::from_le_bytes(bytes[6 + at..10 + at].try_into().expect("4"));
        assert_eq!((field(24), field(28)), (-843_990_001, 337_756_000));
        assert_eq!((field(40), field(48), field(52), field(60)), (1_500, 1_000, -1_000, 1_414));
        assert_eq!(field(64), 31_500_000);
        assert_eq!(bytes[6 + 20..6 + 22], [3, 1]);
    }
}
