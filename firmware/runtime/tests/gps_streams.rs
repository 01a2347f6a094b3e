//! Generated streams: what counts as a fix, and that cuts and garbage do not change it.

use std::cell::RefCell;

use embassy_futures::block_on;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use math::GeoPoint;
use proptest::prelude::*;
use robot_io::Fix;
use runtime::gps::{Decoder, FixSlot, Solution, gps_task};
use sim::receiver::{sentence, ubx};

/// A NAV-PVT message, built after the protocol specification.
#[derive(Clone, Copy)]
struct NavPvt {
    fix_type: u8,
    flags: u8,
    flags3: u8,
    lat_e7: i32,
    lon_e7: i32,
    accuracy_mm: u32,
    north_mmps: i32,
    east_mmps: i32,
}

/// The receiver's time of every NAV-PVT here, milliseconds of the week.
const WEEK_MS: u32 = 302_400_123;

const GOOD: NavPvt = NavPvt {
    fix_type: 3,
    flags: 1,
    flags3: 0,
    lat_e7: 337_756_180,
    lon_e7: -843_963_300,
    accuracy_mm: 1_500,
    north_mmps: 700,
    east_mmps: -300,
};

impl NavPvt {
    fn bytes(&self) -> Vec<u8> {
        let mut payload = [0; 92];
        payload[..4].copy_from_slice(&WEEK_MS.to_le_bytes());
        payload[20] = self.fix_type;
        payload[21] = self.flags;
        payload[24..28].copy_from_slice(&self.lon_e7.to_le_bytes());
        payload[28..32].copy_from_slice(&self.lat_e7.to_le_bytes());
        payload[40..44].copy_from_slice(&self.accuracy_mm.to_le_bytes());
        payload[48..52].copy_from_slice(&self.north_mmps.to_le_bytes());
        payload[52..56].copy_from_slice(&self.east_mmps.to_le_bytes());
        payload[78] = self.flags3;
        ubx(1, 7, &payload)
    }

    /// The message as u-blox 7 sends it: without the last eight bytes. The byte of the third flags
    /// has no meaning there.
    fn bytes_of_u_blox_7(&self) -> Vec<u8> {
        let long = Self { flags3: 0xff, ..*self }.bytes();
        ubx(1, 7, &long[6..6 + 84])
    }

    fn solution(&self, is_valid: bool) -> Solution {
        Solution {
            is_valid,
            place: GeoPoint { lat_e7: self.lat_e7, lon_e7: self.lon_e7 },
            accuracy_mm: self.accuracy_mm,
            velocity_mmps: Some([self.east_mmps, self.north_mmps]),
            receiver_ms: Some(WEEK_MS),
        }
    }
}

fn gga(time: &str, quality: u8, hdop: &str) -> String {
    sentence(&format!("GNGGA,{time},3346.53708,N,08423.77980,W,{quality},09,{hdop},300.1,M,,M,,"))
}

fn rmc(time: &str, mode: char) -> String {
    let status = if mode == 'N' { 'V' } else { 'A' };
    sentence(&format!(
        "GNRMC,{time},{status},3346.53708,N,08423.77980,W,1.944,90.0,010125,,,{mode}"
    ))
}

fn decode(bytes: impl AsRef<[u8]>) -> Vec<Solution> {
    let mut decoder = Decoder::default();
    bytes.as_ref().iter().filter_map(|&byte| decoder.push(byte)).collect()
}

fn both_lengths(pvt: &NavPvt) -> impl Iterator<Item = Vec<u8>> + use<> {
    [pvt.bytes(), pvt.bytes_of_u_blox_7()].into_iter()
}

#[test]
fn nav_pvt_becomes_a_solution_unchanged() {
    for bytes in both_lengths(&GOOD) {
        assert_eq!(decode(&bytes), [GOOD.solution(true)], "{} bytes", bytes.len());
    }
}

#[test]
fn nav_pvt_counts_only_where_its_flags_say_measured() {
    for fix_type in 0..=255 {
        let pvt = NavPvt { fix_type, ..GOOD };
        for bytes in both_lengths(&pvt) {
            assert_eq!(decode(bytes), [pvt.solution((2..=4).contains(&fix_type))], "{fix_type}");
        }
    }
    for bad in [
        NavPvt { flags: 0xfe, ..GOOD },
        NavPvt { flags3: 1, ..GOOD },
        NavPvt { lat_e7: 900_000_001, ..GOOD },
        NavPvt { lon_e7: i32::MIN, ..GOOD },
    ] {
        assert_eq!(decode(bad.bytes()), [bad.solution(false)]);
    }
    assert_eq!(decode(NavPvt { flags: 0xff, flags3: 0xfe, ..GOOD }.bytes()).len(), 1);
}

#[test]
fn other_messages_and_lengths_are_skipped() {
    let mut stream = ubx(5, 1, &[6, 1]);
    for length in (0..200).filter(|length| ![84, 92].contains(length)) {
        stream.extend(ubx(1, 7, &vec![0; length]));
    }
    stream.extend(ubx(1, 0x35, &[0xb5; 368]));
    stream.extend(GOOD.bytes());
    assert_eq!(decode(stream), [GOOD.solution(true)]);
}

#[test]
fn each_flipped_bit_of_nav_pvt_is_noticed() {
    for (bytes, bit) in both_lengths(&GOOD)
        .flat_map(|bytes| (0..bytes.len() * 8).map(move |bit| (bytes.clone(), bit)))
    {
        let mut damaged = bytes.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        assert_eq!(decode(damaged), [], "bit {bit}");
    }
}

#[test]
fn rmc_and_gga_of_one_epoch_make_one_fix_in_either_order() {
    let expected = Solution {
        is_valid: true,
        place: GeoPoint { lat_e7: 337_756_180, lon_e7: -843_963_300 },
        accuracy_mm: 3_600,
        velocity_mmps: Some([1_000, 0]),
        // 10:10:10 o'clock.
        receiver_ms: Some(36_610_000),
    };
    for text in [
        gga("101010.00", 1, "0.9") + &rmc("101010.00", 'A'),
        rmc("101010.00", 'A') + &gga("101010.00", 1, "0.9"),
    ] {
        let [solution] = decode(&text)[..] else { panic!("one fix from {text}") };
        let [east, north] = solution.velocity_mmps.expect("RMC gives a velocity");
        assert!((east - 1_000).abs() <= 3 && north.abs() <= 3, "{east} {north}");
        assert_eq!(Solution { velocity_mmps: expected.velocity_mmps, ..solution }, expected);
    }
    assert_eq!(decode(rmc("101010.00", 'A') + &gga("101011.00", 1, "0.9")), []);
}

#[test]
fn nmea_counts_only_where_both_sentences_are_valid() {
    let is_valid = |quality, hdop, mode| {
        let text = gga("101010.00", quality, hdop) + &rmc("101010.00", mode);
        let [solution] = decode(&text)[..] else { panic!("one fix from {text}") };
        solution.is_valid
    };
    for quality in 0..=12 {
        let expected = matches!(quality, 1..=5 | 9);
        assert_eq!(is_valid(quality, "1.0", 'A'), expected, "{quality}");
    }
    for mode in '\0'..='\x7f' {
        if mode.is_ascii_alphanumeric() {
            assert_eq!(is_valid(1, "1.0", mode), "ADPRF".contains(mode), "{mode}");
        }
    }
    for hdop in ["0.0", "99.99", "-1", "nan", "inf"] {
        assert!(!is_valid(1, hdop, 'A'), "{hdop}");
    }
}

#[test]
fn gga_alone_counts_without_velocity() {
    let text: String = (10..20).map(|second| gga(&format!("1010{second}.00"), 1, "1.0")).collect();
    let solutions = decode(text);
    assert_eq!(solutions.len(), 8, "after two epochs");
    assert!(solutions.iter().all(|solution| solution.is_valid && solution.velocity_mmps.is_none()));
    // One lost RMC does not change the mode.
    let text: String = (10..20)
        .map(|second| {
            let time = format!("1010{second}.00");
            gga(&time, 1, "1.0") + &if second == 15 { String::new() } else { rmc(&time, 'A') }
        })
        .collect();
    let solutions = decode(text);
    assert_eq!(solutions.len(), 9);
    assert!(solutions.iter().all(|solution| solution.velocity_mmps.is_some()));
}

#[test]
fn invalid_angles_give_no_place() {
    for (lat, lon) in [
        ("9060.00000", "08423.77980"),
        ("3361.00000", "08423.77980"),
        ("9100.00000", "08423.77980"),
        ("33nan", "08423.77980"),
        ("33inf", "08423.77980"),
        ("33-46.0", "08423.77980"),
        ("3346.53708", "18100.00000"),
        ("3346.53708", "25523.77980"),
    ] {
        let body = format!("GNGGA,101010.00,{lat},N,{lon},W,1,09,0.9,300.1,M,,M,,");
        let text = sentence(&body) + &rmc("101010.00", 'A');
        let valid = decode(text).into_iter().filter(|solution| solution.is_valid).count();
        assert_eq!(valid, 0, "{body}");
    }
}

#[test]
fn a_cut_sentence_does_not_swallow_the_next() {
    let whole = gga("101010.00", 1, "0.9") + &rmc("101010.00", 'A');
    for cut in 1..40 {
        let text = gga("101009.00", 1, "0.9")[..cut].to_owned() + &whole;
        assert_eq!(decode(text).len(), 1, "cut after {cut}");
    }
}

#[test]
fn nmea_is_ignored_while_ubx_arrives() {
    let nmea = |second| {
        let time = format!("1010{second}.00");
        (gga(&time, 1, "0.9") + &rmc(&time, 'A')).into_bytes()
    };
    let both: Vec<u8> = (10..20).flat_map(|second| [GOOD.bytes(), nmea(second)].concat()).collect();
    assert_eq!(decode(both), vec![GOOD.solution(true); 10]);
    // A few epochs after UBX is switched off, NMEA counts.
    let mut stream = GOOD.bytes();
    stream.extend((10..20).flat_map(nmea));
    let solutions = decode(stream);
    assert_eq!(solutions.len(), 1 + 6);
}

/// Reads a stream in pieces, cycling through the given sizes.
struct Pieces<'a> {
    rest: &'a [u8],
    sizes: std::iter::Cycle<std::slice::Iter<'a, usize>>,
}

impl embedded_io_async::ErrorType for Pieces<'_> {
    type Error = embedded_io_async::ErrorKind;
}

impl embedded_io_async::Read for Pieces<'_> {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Self::Error> {
        let size = self.sizes.next().copied().unwrap_or(1);
        if size == 0 {
            return Err(embedded_io_async::ErrorKind::Other);
        }
        let count = size.min(buffer.len()).min(self.rest.len());
        let (piece, rest) = self.rest.split_at(count);
        buffer[..count].copy_from_slice(piece);
        self.rest = rest;
        Ok(count)
    }
}

/// The different fixes that the task stores, without their times. The task reads its clock once
/// per piece, and the clock looks at the slot.
fn run_task(stream: &[u8], sizes: &[usize]) -> Vec<Option<Fix>> {
    let slot = FixSlot::<NoopRawMutex>::new();
    let seen = RefCell::new(Vec::new());
    let pieces = Pieces { rest: stream, sizes: sizes.iter().cycle() };
    let look = || {
        seen.borrow_mut().push(slot.latest().map(|fix| Fix { time_us: 0, ..fix }));
        seen.borrow().len() as u64
    };
    block_on(gps_task(pieces, &slot, look));
    look();
    let mut seen = seen.into_inner();
    seen.dedup();
    seen
}

fn stream() -> Vec<u8> {
    let mut stream = gga("101010.00", 1, "0.9").into_bytes();
    stream.extend(rmc("101010.00", 'A').into_bytes());
    stream.extend(NavPvt { east_mmps: 77, ..GOOD }.bytes());
    stream.extend(ubx(1, 0x35, &[7; 200]));
    stream.extend(GOOD.bytes());
    stream
}

proptest! {
    #[test]
    fn any_cut_of_the_stream_gives_the_same_fixes(
        // A size of 0 stands for a read error; a stream of errors only would never end.
        // No piece ends two messages, so every fix is seen.
        sizes in prop::collection::vec(0_usize..60, 1..20)
            .prop_filter("some progress", |sizes| sizes.iter().any(|&size| size > 0)),
    ) {
        let whole = run_task(&stream(), &[1]);
        prop_assert_eq!(whole.len(), 4, "nothing, and three fixes");
        prop_assert_eq!(run_task(&stream(), &sizes), whole);
    }

    #[test]
    fn garbage_between_messages_hides_none_and_invents_none(
        garbage in prop::collection::vec(
            prop::collection::vec(prop_oneof![any::<u8>(), Just(0xb5), Just(0x62), Just(b'$')], 0..300),
            4,
        ),
    ) {
        let mut ubx = Vec::new();
        let mut nmea = Vec::new();
        for (second, noise) in (10..).zip(&garbage) {
            let time = format!("1010{second}.00");
            ubx.extend(noise);
            ubx.extend(GOOD.bytes());
            nmea.extend(noise);
            nmea.extend(gga(&time, 1, "0.9").into_bytes());
            nmea.extend(rmc(&time, 'A').into_bytes());
        }
        // A false start in the garbage delays a message until its claimed length has arrived.
        ubx.extend([0; 200]);
        prop_assert_eq!(decode(&ubx), vec![GOOD.solution(true); 4]);
        let solutions = decode(&nmea);
        prop_assert_eq!(solutions.len(), 4);
        prop_assert!(solutions.iter().all(|s| s.is_valid && s.place == GOOD.solution(true).place));
    }

    #[test]
    fn no_bytes_make_a_panic_or_a_fix(
        bytes in prop::collection::vec(
            prop_oneof![any::<u8>(), Just(0xb5), Just(0x62), Just(1), Just(7), Just(92), Just(0),
                Just(b'$'), Just(b'G'), Just(b','), Just(b'*'), Just(b'\r'), Just(b'\n')],
            0..2_000,
        ),
    ) {
        prop_assert_eq!(decode(bytes), []);
    }
}
