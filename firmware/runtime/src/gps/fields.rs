//! Parses GGA and RMC, field by field, in integers.
//!
//! Any two letters are a talker. The parser skips the fields that the robot does not use, so
//! their content cannot spoil the rest: date, magnetic variation, number of satellites, heights,
//! reference station, nav status (always V on receivers that are not made for ships).
//!
//! In doubt a field does not count: a coordinate with digits in the wrong positions is invalid,
//! and an RMC that is not clearly valid is void.

use math::{GeoPoint, scalar};

/// One of the two sentences.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sentence {
    Gga(Gga),
    Rmc(Rmc),
}

/// The two letters that name the sender of a sentence.
pub(super) type Talker = [u8; 2];

/// Place and accuracy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Gga {
    pub(super) talker: Talker,
    /// Milliseconds of the day.
    pub(super) time_ms: Option<u32>,
    /// Whether the place is measured and its accuracy known.
    pub(super) has_fix: bool,
    pub(super) place: GeoPoint,
    pub(super) accuracy_mm: u32,
}

/// Validity and velocity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Rmc {
    pub(super) talker: Talker,
    /// Milliseconds of the day.
    pub(super) time_ms: Option<u32>,
    /// Whether the sentence reports place and velocity as measured and valid.
    pub(super) is_valid: bool,
    pub(super) velocity_mmps: Option<[i32; 2]>,
}

/// Number of fields that are read: up to the mode of RMC.
const FIELDS: usize = 12;

/// Stands for a missing place.
const NOWHERE: GeoPoint = GeoPoint { lat_e7: 0, lon_e7: 0 };

/// Units of 1e-7 in one degree or minute.
const E7: u32 = 10_000_000;

/// Highest plausible speed, thousandths of a knot.
const MAX_SPEED_MILLIKNOTS: u32 = 1_900_000;

/// The sentence in a body; `None` for other sentences and for a GGA that claims a fix without a
/// readable time or place.
pub(super) fn parse(body: &[u8]) -> Option<Sentence> {
    let (&[a, b, ref kind @ ..], rest) = body.split_first_chunk::<5>()?;
    let talker = [a, b];
    let rest = rest.strip_prefix(b",")?;
    let mut fields: [&[u8]; FIELDS] = [&[]; FIELDS];
    for (slot, field) in fields.iter_mut().zip(rest.split(|&byte| byte == b',')) {
        *slot = field.trim_ascii();
    }
    // Garmin's PGRMC is a set-up command for its sensors.
    let is_talker = talker.iter().all(u8::is_ascii_uppercase) && talker != *b"PG";
    match kind {
        b"GGA" if is_talker => gga(talker, &fields).map(Sentence::Gga),
        b"RMC" if is_talker => Some(Sentence::Rmc(rmc(talker, &fields))),
        _ => None,
    }
}

fn gga(talker: Talker, fields: &[&[u8]; FIELDS]) -> Option<Gga> {
    let &[time, lat, north, lon, east, quality, _, hdop, ..] = fields;
    let (time_ms, place) = (milliseconds(time), place(lat, north, lon, east));
    let Some(mm_per_hdop) = mm_per_hdop(quality) else {
        let place = place.unwrap_or(NOWHERE);
        return Some(Gga { talker, time_ms, has_fix: false, place, accuracy_mm: u32::MAX });
    };
    // A DOP is positive; receivers without one print 0 or 99.99.
    let hdop = thousandths(hdop).filter(|hdop| (1..99_000).contains(hdop));
    let accuracy_mm = hdop.map_or(u32::MAX, |hdop| hdop * mm_per_hdop / 1_000);
    let has_fix = hdop.is_some();
    Some(Gga { talker, time_ms: Some(time_ms?), has_fix, place: place?, accuracy_mm })
}

/// User range error, one sigma, millimetres: times HDOP it is the horizontal error. `None` for
/// qualities that are not measured: no fix, estimated, entered by hand, simulated, unknown.
///
/// The GPS standard positioning service promises 7.8 m in 95 % of cases (its performance
/// standard of 2008, user range error), a sigma of 4 m. Corrections by satellite or radio halve
/// that. The two kinds of carrier phase solution are good to decimetres and centimetres; the
/// values here are cautious. Quality 9 is in no standard: some makers use it for corrections by
/// satellite. Without a promised accuracy it counts as plain GPS.
fn mm_per_hdop(quality: &[u8]) -> Option<u32> {
    // A number, since some makers pad it with zeros. No digit at all gives 0: no fix.
    match number(quality)? {
        1 | 3 | 9 => Some(4_000),
        2 => Some(2_000),
        4 => Some(50),
        5 => Some(500),
        _ => None,
    }
}

fn rmc(talker: Talker, fields: &[&[u8]; FIELDS]) -> Rmc {
    let &[time, status, lat, north, lon, east, speed, course, _, _, _, mode] = fields;
    // Some makers mark a valid fix with corrections by D.
    let is_valid = matches!(status, b"A" | b"D")
        // Autonomous, differential, precise, fixed and float; empty before NMEA 2.3. The others
        // are not valid, estimated, entered by hand, simulated, or unknown.
        && matches!(mode, b"" | b"A" | b"D" | b"P" | b"R" | b"F")
        && place(lat, north, lon, east).is_some();
    let velocity_mmps = if is_valid { velocity_mmps(speed, course) } else { None };
    Rmc { talker, time_ms: milliseconds(time), is_valid, velocity_mmps }
}

/// Velocity east and north, from knots and degrees clockwise from north.
fn velocity_mmps(speed: &[u8], course: &[u8]) -> Option<[i32; 2]> {
    let speed = thousandths(speed).filter(|&speed| speed <= MAX_SPEED_MILLIKNOTS)?;
    if course.is_empty() {
        // Receivers that stand still omit the course.
        return (speed == 0).then_some([0, 0]);
    }
    let course = thousandths(course).filter(|&course| course <= 360_000)?;
    // A knot is 1,852 m an hour.
    let mmps = (speed * 1_852 / 3_600) as f32;
    let course_rad = scalar::wrap_angle((course as f32 * 1e-3).to_radians());
    Some([(mmps * scalar::sin(course_rad)) as i32, (mmps * scalar::cos(course_rad)) as i32])
}

fn place(lat: &[u8], north: &[u8], lon: &[u8], east: &[u8]) -> Option<GeoPoint> {
    let lat_e7 = signed(angle_e7(lat, 2, 90)?, north, b"N", b"S")?;
    let lon_e7 = signed(angle_e7(lon, 3, 180)?, east, b"E", b"W")?;
    Some(GeoPoint { lat_e7, lon_e7 }).filter(|place| place.is_valid())
}

fn signed(angle_e7: i32, half: &[u8], positive: &[u8], negative: &[u8]) -> Option<i32> {
    match half {
        half if half == positive => Some(angle_e7),
        half if half == negative => Some(-angle_e7),
        _ => None,
    }
}

/// An angle: degrees of exactly `degree_digits` digits, minutes of two digits and any number of
/// decimals, rounded to nearest. A missing leading zero would shift every digit.
fn angle_e7(field: &[u8], degree_digits: usize, most_degrees: u32) -> Option<i32> {
    let (whole, decimals) = split_at_point(field);
    let (degrees, minutes) = whole.split_at_checked(degree_digits)?;
    let degrees = number(degrees).filter(|&degrees| degrees <= most_degrees)?;
    let minutes = number(minutes).filter(|_| minutes.len() == 2)?;
    // Receivers that round print 60.0 minutes before the next degree.
    let minutes_e7 = (minutes * E7).checked_add(fraction(decimals, E7)?)?;
    let minutes_e7 = Some(minutes_e7).filter(|&minutes| minutes <= 60 * E7)?;
    i32::try_from(degrees * E7 + (minutes_e7 + 30) / 60).ok()
}

/// Milliseconds of the day. A minute with a leap second has a second 60.
fn milliseconds(field: &[u8]) -> Option<u32> {
    let (whole, decimals) = split_at_point(field);
    let &[a, b, c, d, e, f] = whole else { return None };
    let (hours, minutes, seconds) = (number(&[a, b])?, number(&[c, d])?, number(&[e, f])?);
    let is_time = hours < 24 && minutes < 60 && seconds <= 60;
    let ms = ((hours * 60 + minutes) * 60 + seconds) * 1_000 + fraction(decimals, 1_000)?;
    is_time.then_some(ms)
}

/// A decimal number below a million, in thousandths; further digits are truncated.
fn thousandths(field: &[u8]) -> Option<u32> {
    let (whole, decimals) = split_at_point(field);
    if whole.is_empty() && decimals.is_empty() {
        return None;
    }
    Some(number(whole)? * 1_000 + fraction(decimals, 1_000)?)
}

/// The digits before and after the decimal point; without a point, none after it.
fn split_at_point(field: &[u8]) -> (&[u8], &[u8]) {
    let mut parts = field.splitn(2, |&byte| byte == b'.');
    (parts.next().unwrap_or_default(), parts.next().unwrap_or_default())
}

/// A number of at most six digits; 0 for no digits.
fn number(digits: &[u8]) -> Option<u32> {
    if digits.len() > 6 {
        return None;
    }
    digits.iter().try_fold(0, |sum, &digit| {
        digit.is_ascii_digit().then(|| sum * 10 + u32::from(digit - b'0'))
    })
}

/// Any number of decimals, in parts of `unit`, a power of ten; smaller parts are truncated.
fn fraction(decimals: &[u8], unit: u32) -> Option<u32> {
    let mut weight = unit;
    decimals.iter().try_fold(0, |sum, &digit| {
        weight /= 10;
        digit.is_ascii_digit().then(|| sum + weight * u32::from(digit - b'0'))
    })
}

#[cfg(test)]
mod tests;
