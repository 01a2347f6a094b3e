//! Why a receiver gives no solution: from its bytes to telemetry and the robot's reason, through
//! the tasks that a board runs and a packet of the link.

use std::cell::RefCell;

use math::{GeoPoint, Vec2};
use plan_format::parameters::Gains;
use plan_format::{Blob, Origin, Parameters};
use robot_io::packet::{self, Downlink};
use robot_io::{Operator, Reason, Receiver, SensorRecord};
use runtime::lockstep::{Transport, run_blocking};
use sim::receiver::{self, ubx};

const HOME: GeoPoint = GeoPoint { lat_e7: 337_756_180, lon_e7: -843_963_300 };
const TICKS_A_SECOND: usize = 20;

/// Reactive driving to a point 100 m east of home; no map, and no compass.
fn eastward() -> Blob<'static> {
    let parameters = Parameters { gains: Gains::REACTIVE_ONLY, ..Parameters::default() };
    let origin = Origin { place: HOME, at_m: [0.0, 0.0], heading_rad: 0.0 };
    Blob::without_map(parameters, Some(origin), Some(Vec2::new(100.0, 0.0)))
}

/// Feeds a receiver's bytes into the robot and reads its packets of telemetry.
struct Wire<'a> {
    /// The receiver's bytes, by second.
    seconds: std::vec::IntoIter<Vec<u8>>,
    /// The rest of this second's bytes, by tick.
    pieces: std::vec::IntoIter<Vec<u8>>,
    heard: &'a RefCell<Vec<(Receiver, Reason)>>,
}

impl Transport for Wire<'_> {
    fn receive(&mut self) -> Option<SensorRecord> {
        let piece = match self.pieces.next() {
            Some(piece) => piece,
            None => {
                let bytes = self.seconds.next()?;
                let size = bytes.len().div_ceil(TICKS_A_SECOND).max(1);
                let mut pieces: Vec<Vec<u8>> = bytes.chunks(size).map(<[u8]>::to_vec).collect();
                pieces.resize(TICKS_A_SECOND, Vec::new());
                self.pieces = pieces.into_iter();
                self.pieces.next()?
            }
        };
        let operator = Operator { is_armed: true, ..Operator::default() };
        Some(SensorRecord { gps: piece.into_iter().collect(), operator, ..SensorRecord::default() })
    }

    fn send(&mut self, record: &robot_io::CommandRecord) {
        let bytes =
            packet::encode(&Downlink::Telemetry(*record)).expect("a record is not too long");
        let mut decoder = packet::Decoder::default();
        let read = bytes.iter().find_map(|&byte| decoder.push(byte));
        let Some(Downlink::Telemetry(record)) = read else { panic!("a packet of telemetry") };
        self.heard.borrow_mut().push((record.receiver, record.commands.reason));
    }
}

/// The telemetry at the end of each second.
fn listen(seconds: Vec<Vec<u8>>) -> Vec<(Receiver, Reason)> {
    let heard = RefCell::new(Vec::new());
    let pieces = Vec::new().into_iter();
    run_blocking(eastward(), Wire { seconds: seconds.into_iter(), pieces, heard: &heard }, ());
    heard.into_inner().into_iter().skip(TICKS_A_SECOND - 1).step_by(TICKS_A_SECOND).collect()
}

/// Checks ten seconds of one kind; `second` makes the bytes of one second.
fn check(name: &str, second: impl Fn(usize) -> Vec<u8>, receiver: Receiver, reason: Reason) {
    let heard = listen((0..10).map(second).collect());
    assert_eq!(heard.last(), Some(&(receiver, reason)), "{name}: {heard:?}");
    // The state may change once, after the first seconds.
    let changes = heard.windows(2).filter(|pair| pair[0] != pair[1]).count();
    assert!(changes <= 1, "{name}: {heard:?}");
}

/// A sentence with its `$`, checksum and line end; `@` stands for the time.
fn sentence(body: &str, second: usize) -> String {
    receiver::sentence(&body.replace('@', &format!("1010{second:02}.00")))
}

/// Makes the bytes of one second.
type Second<'a> = dyn Fn(usize) -> Vec<u8> + 'a;

/// Sentences once a second.
fn nmea<'a>(bodies: &'a [&'a str]) -> impl Fn(usize) -> Vec<u8> + Copy + 'a {
    move |second| bodies.iter().map(|body| sentence(body, second)).collect::<String>().into_bytes()
}

const RMC: &str = "GNRMC,@,A,3346.53708,N,08423.77980,W,0.000,,010125,,,A";
/// Nearly standing still.
const SLOW_RMC: &str = "GNRMC,@,A,3346.53708,N,08423.77980,W,0.057,,010125,,,A,V";
const VOID_RMC: &str = "GNRMC,@,V,,,,,,,010125,,,N";
const GGA: &str = "GNGGA,@,3346.53708,N,08423.77980,W,1,12,0.9,45.0,M,46.9,M,,";
const NO_GGA: &str = "GNGGA,@,,,,,0,00,99.99,,,,,,";
const GSV: &str = "GPGSV,1,1,02,05,,,28,15,75,020,31";

#[test]
fn a_silent_receiver_is_silent() {
    check("no bytes", |_| Vec::new(), Receiver::Silent, Reason::NoFix);
}

#[test]
fn bytes_that_form_no_message_are_unreadable() {
    use Reason::UnreadableReceiver;
    let sentences = nmea(&[RMC, GGA, GSV]);
    // A wrong baud rate changes every byte, and most then have their highest bit set.
    let garbled =
        |second| sentences(second).iter().map(|byte| byte.rotate_left(3) | 0x80).collect();
    check("baud rate", garbled, Receiver::Unreadable, UnreadableReceiver);
    let zeros = |_| vec![0; 30];
    check("a line held low", zeros, Receiver::Unreadable, UnreadableReceiver);
    let sirf = |_| {
        let message = [0xa0, 0xa2, 0, 41, 2, 0xff, 0xd6, 0xf7, 0x8c, 0xff, 0xb0, 0xb3];
        [&message.repeat(4)[..], &[0xb0, 0xb3]].concat()
    };
    check("SiRF", sirf, Receiver::Unreadable, UnreadableReceiver);
}

#[test]
fn sentences_without_a_right_checksum_are_unchecked() {
    use Reason::UncheckedReceiver;
    let sentences = nmea(&[RMC, GGA]);
    let text = move |second| String::from_utf8(sentences(second)).expect("ASCII");
    let bare = move |second| {
        let lines = text(second);
        let lines = lines.lines().map(|line| line[..line.len() - 3].to_owned() + "\r\n");
        lines.collect::<String>().into_bytes()
    };
    check("none", bare, Receiver::Unchecked, UncheckedReceiver);
    let wrong = move |second| text(second).replace("3346", "3347").into_bytes();
    check("a wrong one", wrong, Receiver::Unchecked, UncheckedReceiver);
}

#[test]
fn messages_without_a_position_are_not_noise() {
    use Reason::NoPositionMessage;
    let unpadded = GGA.replace("08423", "8423");
    for (name, bodies) in [
        ("RMC alone", &[RMC][..]),
        ("neither", &[GSV, "GPVTG,,,,,0.0,N,0.0,K,A"]),
        ("GGA that cannot be read", &[RMC, &unpadded]),
    ] {
        check(name, nmea(bodies), Receiver::NoPosition, NoPositionMessage);
    }
    let nav_sol = |_| ubx(1, 6, &[0; 52]);
    check("u-blox 6", nav_sol, Receiver::NoPosition, NoPositionMessage);
    let long = |_| ubx(2, 0x15, &[0xb5; 800]);
    check("raw measurements", long, Receiver::NoPosition, NoPositionMessage);
}

#[test]
fn solutions_none_of_which_is_valid_are_no_fix() {
    use Reason::PoorFix;
    for (name, bodies) in [
        ("a cold start", &["GNRMC,,V,,,,,,,,,,N", "GNGGA,,,,,,0,00,99.99,,,,,,"][..]),
        ("no fix", &[VOID_RMC, NO_GGA]),
        ("void with a place", &[VOID_RMC, GGA]),
        ("GGA first", &[GGA, VOID_RMC]),
    ] {
        check(name, nmea(bodies), Receiver::NoFix, PoorFix);
    }
    check("NAV-PVT", |_| ubx(1, 7, &[0; 92]), Receiver::NoFix, PoorFix);
    check("NAV-PVT of u-blox 7", |_| ubx(1, 7, &[0; 84]), Receiver::NoFix, PoorFix);
}

#[test]
fn gga_without_rmc_counts_and_has_no_velocity() {
    check("GGA alone", nmea(&[GGA]), Receiver::NoVelocity, Reason::NoHeading);
    check("with others", nmea(&[GGA, GSV]), Receiver::NoVelocity, Reason::NoHeading);
}

#[test]
fn a_sound_receiver_is_sound() {
    check("NMEA", nmea(&[RMC, GGA]), Receiver::Sound, Reason::NoHeading);
    check("slow", nmea(&[SLOW_RMC, GGA]), Receiver::Sound, Reason::NoHeading);
    let mut pvt = [0; 92];
    (pvt[20], pvt[21]) = (3, 1);
    pvt[24..28].copy_from_slice(&HOME.lon_e7.to_le_bytes());
    pvt[28..32].copy_from_slice(&HOME.lat_e7.to_le_bytes());
    let second = move |second: usize| {
        let mut pvt = pvt;
        pvt[..4].copy_from_slice(&(second as u32 * 1_000).to_le_bytes());
        ubx(1, 7, &pvt)
    };
    check("NAV-PVT", second, Receiver::Sound, Reason::NoHeading);
}

#[test]
fn the_state_follows_the_receiver() {
    let good = nmea(&[RMC, GGA]);
    let (void, alone, foreign) = (nmea(&[VOID_RMC, GGA]), nmea(&[GGA]), nmea(&[GSV]));
    let noise = |_| vec![0x80; 200];
    let silence = |_| Vec::new();
    let phases: [(&Second<'_>, Receiver); 7] = [
        (&good, Receiver::Sound),
        (&void, Receiver::NoFix),
        (&good, Receiver::Sound),
        (&alone, Receiver::NoVelocity),
        (&noise, Receiver::Unreadable),
        (&silence, Receiver::Silent),
        (&foreign, Receiver::NoPosition),
    ];
    let seconds = (0..)
        .zip(phases)
        .flat_map(|(phase, (second, _))| (0..8).map(move |index| second(phase * 8 + index)));
    let heard = listen(seconds.collect());
    for ((_, expected), heard) in phases.iter().zip(heard.chunks(8)) {
        assert_eq!(heard.last().map(|last| last.0), Some(*expected), "{heard:?}");
    }
    // A receiver that once had fixes has fallen silent: its last fix is stale.
    assert_eq!(heard[47], (Receiver::Silent, Reason::StaleFix));
}
