//! NMEA 0183: RMC and GGA of one epoch, merged.
//!
//! GGA has quality and HDOP, RMC status and velocity; a solution needs both. Receivers send
//! them in either order, with the same time. One that never sends RMC is recognised and
//! served without velocity; RMC alone says nothing about accuracy and is never a solution.

use math::{GeoPoint, scalar};
use nmea0183::coords::{Hemisphere, Latitude, Longitude};
use nmea0183::datetime::Time;
use nmea0183::{GGA, GPSQuality, ParseResult, Parser, RMC, Sentence};

use super::Solution;

/// Metres a second in a knot.
const MPS_PER_KNOT: f32 = 1_852.0 / 3_600.0;
/// No robot of ours is faster; such a speed is nonsense, and its square would overflow.
const MAX_SPEED_MPS: f32 = 1_000.0;
/// Epochs with GGA alone after which RMC is no longer waited for.
const LONE_EPOCHS: u8 = 2;

pub(super) struct Decoder {
    parser: Parser,
    epoch: Epoch,
    /// Epochs in a row that ended with GGA alone.
    lone_epochs: u8,
}

/// What has arrived of the current epoch.
#[derive(Clone, Copy, Default)]
struct Epoch {
    /// Milliseconds of the day.
    time_ms: Option<u32>,
    gga: Option<Position>,
    rmc: Option<Motion>,
}

/// What GGA says.
#[derive(Clone, Copy)]
struct Position {
    is_valid: bool,
    place: GeoPoint,
    accuracy_mm: u32,
}

/// What RMC says beyond GGA.
#[derive(Clone, Copy)]
struct Motion {
    is_valid: bool,
    velocity_mmps: Option<[i32; 2]>,
}

impl Default for Decoder {
    fn default() -> Self {
        Self { parser: parser(), epoch: Epoch::default(), lone_epochs: 0 }
    }
}

fn parser() -> Parser {
    Parser::new().sentence_filter(Sentence::RMC | Sentence::GGA)
}

impl Decoder {
    pub(super) fn push(&mut self, byte: u8) -> Option<Solution> {
        if byte == b'$' {
            // No sentence contains this sign, but the parser knows that only while it waits
            // for one: without a new start, a cut sentence would swallow the next.
            self.parser = parser();
        }
        match self.parser.parse_from_byte(byte)? {
            Ok(ParseResult::GGA(Some(gga))) => {
                let position = position(&gga)?;
                self.enter(&gga.time);
                self.epoch.gga = Some(position);
            }
            Ok(ParseResult::RMC(Some(rmc))) => {
                self.enter(&rmc.datetime.time);
                self.epoch.rmc = Some(motion(&rmc));
            }
            _ => return None,
        }
        self.solution()
    }

    /// Begins a new epoch if `time` is not the current one's.
    fn enter(&mut self, time: &Time) {
        let time_ms = Some(milliseconds(time));
        if self.epoch.time_ms == time_ms {
            return;
        }
        match self.epoch {
            Epoch { gga: Some(_), rmc: Some(_), .. } => self.lone_epochs = 0,
            Epoch { gga: Some(_), rmc: None, .. } => {
                self.lone_epochs = self.lone_epochs.saturating_add(1);
            }
            Epoch { gga: None, .. } => {}
        }
        self.epoch = Epoch { time_ms, ..Epoch::default() };
    }

    /// The solution that the latest sentence completes.
    fn solution(&self) -> Option<Solution> {
        let Position { is_valid, place, accuracy_mm } = self.epoch.gga?;
        match self.epoch.rmc {
            Some(motion) => Some(Solution {
                is_valid: is_valid && motion.is_valid,
                place,
                accuracy_mm,
                velocity_mmps: motion.velocity_mmps,
            }),
            None if self.lone_epochs >= LONE_EPOCHS => {
                Some(Solution { is_valid, place, accuracy_mm, velocity_mmps: None })
            }
            None => None,
        }
    }
}

fn position(gga: &GGA) -> Option<Position> {
    let place =
        GeoPoint { lat_e7: latitude_e7(&gga.latitude)?, lon_e7: longitude_e7(&gga.longitude)? };
    let metres_per_hdop = metres_per_hdop(&gga.gps_quality);
    // A DOP is positive; 0 and 99.99 are what receivers print when they have none.
    let has_hdop = gga.hdop > 0.0 && gga.hdop < 99.0;
    let accuracy_mm = match metres_per_hdop {
        Some(metres) if has_hdop => (gga.hdop * metres * 1_000.0) as u32,
        _ => u32::MAX,
    };
    let is_valid = metres_per_hdop.is_some() && has_hdop && place.is_valid();
    Some(Position { is_valid, place, accuracy_mm })
}

/// Error of one satellite's range that becomes, times HDOP, the horizontal error (one
/// sigma); `None` for qualities that are no measurement.
///
/// The GPS standard positioning service promises 7.8 m in 95 % of cases (its performance
/// standard of 2008, user range error), a sigma of 4 m. Corrections by satellite or radio
/// halve that; the two kinds of carrier phase solution are good to decimetres and
/// centimetres, of which the values here are cautious sizes.
fn metres_per_hdop(quality: &GPSQuality) -> Option<f32> {
    match quality {
        GPSQuality::GPS | GPSQuality::PPS => Some(4.0),
        GPSQuality::DGPS => Some(2.0),
        GPSQuality::FRTK => Some(0.5),
        GPSQuality::RTK => Some(0.05),
        GPSQuality::NoFix | GPSQuality::Estimated | GPSQuality::Manual | GPSQuality::Simulated => {
            None
        }
    }
}

fn motion(rmc: &RMC) -> Motion {
    let speed_mps = rmc.speed.as_knots() * MPS_PER_KNOT;
    let velocity_mmps = match rmc.course.as_ref().map(|course| course.degrees) {
        // Receivers that stand still leave the course out.
        None if speed_mps == 0.0 => Some([0, 0]),
        Some(degrees) if degrees.is_finite() && (0.0..=MAX_SPEED_MPS).contains(&speed_mps) => {
            // Clockwise from north.
            let course_rad = scalar::wrap_angle(degrees.to_radians());
            let mmps = speed_mps * 1_000.0;
            Some([(mmps * scalar::sin(course_rad)) as i32, (mmps * scalar::cos(course_rad)) as i32])
        }
        _ => None,
    };
    Motion { is_valid: rmc.mode.is_valid(), velocity_mmps }
}

/// The parser admits seconds up to 60 only, so this cannot overflow.
fn milliseconds(time: &Time) -> u32 {
    let minutes = u32::from(time.hours) * 60 + u32::from(time.minutes);
    minutes * 60_000 + (time.seconds * 1_000.0) as u32
}

fn latitude_e7(latitude: &Latitude) -> Option<i32> {
    let magnitude = angle_e7(latitude.degrees, latitude.minutes, latitude.seconds)?;
    Some(if latitude.hemisphere == Hemisphere::South { -magnitude } else { magnitude })
}

fn longitude_e7(longitude: &Longitude) -> Option<i32> {
    let magnitude = angle_e7(longitude.degrees, longitude.minutes, longitude.seconds)?;
    Some(if longitude.hemisphere == Hemisphere::West { -magnitude } else { magnitude })
}

/// Units of 1e-7 degrees, rounded to nearest; `None` for what is no angle on the globe.
fn angle_e7(degrees: u8, minutes: u8, seconds: f32) -> Option<i32> {
    // The parser takes whole minutes off what it prints as seconds, so a minute's worth of
    // them is the most that is left.
    if degrees > 180 || minutes >= 60 || !(0.0..=60.0).contains(&seconds) {
        return None;
    }
    let micro_arcseconds = i64::from(degrees) * 3_600_000_000
        + i64::from(minutes) * 60_000_000
        + (f64::from(seconds) * 1e6) as i64;
    // A unit is 360 micro-arcseconds.
    i32::try_from((micro_arcseconds + 180) / 360).ok()
}
