//! Tests of the reader: every mistake is named, and every key does what it says.

use super::*;

fn read(text: &str) -> Vec<String> {
    let source = Arc::new(Source { name: "yard.world.toml".into(), text: text.into() });
    let mut problems = Vec::new();
    let world = parse(&source, None, &mut problems);
    assert_eq!(world.is_none(), !problems.is_empty());
    for problem in &problems {
        assert!(problem.help.is_some() && problem.place.is_some(), "{problem:?}");
    }
    problems.iter().map(ToString::to_string).collect()
}

#[test]
fn all_mistakes_are_named_at_once() {
    let messages = read(
        "strat = [1, 2]\nheading = 'east'\ntime_limit = -5\ntruth = \"other.ovl\"\nsignal = 0\n\
         [tanks.fuel]\nchannel = 8\nlevel = 2\nwith_in = 2\nat = [1]\nfill_per_s = nan\n\
         [fields.a]\nchannel = 3\nwithin = 1\nstrips = [[[0, 0], [0, 0]], [[1, 2]]]\n\
         [fields.b]\nchannel = 3\nwithin = 1\nstrips = []\n",
    );
    let expected = [
        "`strat` is not a key of a world",
        "`start` is missing",
        "`heading` must be a number from -10 to 10",
        "`time_limit` must be a number from 0.05 to 604800",
        "`signal` must be a whole number from 1 to 65535",
        "`tanks.fuel.use_per_m` is missing",
        "`tanks.fuel.within` is missing",
        "`tanks.fuel.channel` must be a whole number from 0 to 7",
        "`tanks.fuel.level` must be a number from 0 to 1",
        "`tanks.fuel.with_in` is not a key of a world",
        "`tanks.fuel.at` must be a point",
        "`tanks.fuel.fill_per_s` must be a number from 0 to 100",
        "a strip of `fields.a.strips` is wrong",
        "a strip of `fields.a.strips` is wrong",
        "`fields.b` and `a` both use channel 3",
        "`fields.b.strips` must be a list of strips",
    ];
    assert_eq!(messages, expected, "{messages:#?}");
    assert_eq!(read("start = [1, 2\n"), ["this is not TOML"]);
    assert_eq!(read("start = [1, 2]\ntanks = 3\n"), ["`tanks` must be tables"]);
    assert_eq!(read("start = [1, 2]\n"), [""; 0]);
}

#[test]
fn a_world_lies_beside_its_map_or_its_mission() {
    for (path, world) in [
        ("a/yard.ovl", "a/yard.world.toml"),
        ("yard.mission.toml", "yard.world.toml"),
        ("my.yard.ovl", "my.yard.world.toml"),
        ("my.yard.mission.toml", "my.yard.world.toml"),
        ("yard.toml", "yard.world.toml"),
    ] {
        assert_eq!(path_beside(Path::new(path)), Path::new(world), "{path}");
    }
}

/// The mistakes of a world with a start and this text.
fn mistakes(text: &str) -> Vec<String> {
    read(&format!("start = [1, 2]\n{text}"))
}

#[test]
fn mistakes_of_the_truth_are_named() {
    for (text, expected) in [
        ("truth = 3", &["`truth` must be the name of a map"][..]),
        ("extra = 3", &["`extra` must be a list of tables"]),
        ("extra = [[1, 2]]", &["`extra` must be a list of tables"]),
        ("[[extra]]", &["`extra[0]` must be one shape"]),
        (
            "[[extra]]\ncircle = [1, 2, 3]\nline = [[1, 2], [3, 4]]",
            &["`extra[0]` must be one shape"],
        ),
        ("[[extra]]\ncircle = [1, 2, 0]", &["`extra[0].circle` must be a circle"]),
        ("[[extra]]\nline = [[1, 2]]", &["`extra[0].line` must be a list of 2 or more points"]),
        (
            "[[extra]]\npolygon = [[1, 2], [3, 4]]",
            &["`extra[0].polygon` must be a list of 3 or more points"],
        ),
        (
            "[[extra]]\ncircle = [1, 2, 1]\nname = \"a\"",
            &["`extra[0].name` is not a key of a world"],
        ),
        ("[[missing]]\nwithin = 2", &["`missing[0]` must be a name or a point"]),
        ("[[missing]]\nname = \"a\"\nat = [1, 2]", &["`missing[0]` must be a name or a point"]),
        ("[[missing]]\nat = [1]", &["`missing[0].at` must be a point"]),
        ("unmapped = 1.5", &["`unmapped` must be a number from 0 to 1"]),
        ("unmapped = 0.6\nremoved = 0.5", &["`unmapped` and `removed` are together more than 1"]),
        ("shift = 3", &["`shift` must be a point"]),
        ("scale = 0", &["`scale` must be a number from 0.01 to 100"]),
        ("turn = \"left\"", &["`turn` must be a number from -10 to 10"]),
    ] {
        assert_eq!(mistakes(text), expected, "{text}");
    }
}

#[test]
fn mistakes_of_conditions_are_named() {
    let disc = "[[discs]]\nradius = 0.3\nspeed = 1\npath = [[0, 0], [1, 0]]\n";
    let fault = "[[faults]]\nsensor = \"gps\"\n";
    for (text, expected) in [
        ("gps = 3", &["`gps` must be a table"][..]),
        ("[gps]\nsgima = 1", &["`gps.sgima` is not a key of a world"]),
        ("[gps]\nrate = 21", &["`gps.rate` must be a number from 0 to 20"]),
        ("[ranges]\nsectors = 17", &["`ranges.sectors` must be a whole number from 0 to 16"]),
        ("[ranges]\nbeams = 0", &["`ranges.beams` must be a whole number from 1 to 360"]),
        ("[compass]\noffset = 4", &["`compass.offset` must be a number from -3.2 to 3.2"]),
        ("[wheels]\nslip = 1", &["`wheels.slip` must be a number from 0 to 0.99"]),
        ("[body]\nbraking = 1", &["`body.braking` is not a key of a world"]),
        ("[pose]\nrate = 0", &["`pose.rate` must be a number from 0.1 to 20"]),
        ("[[discs]]\nspeed = 1", &["`discs[0].radius` is missing", "`discs[0].path` is missing"]),
        (&format!("{disc}loop = \"bakc\""), &["`discs[0].loop` is not known"]),
        (&format!("{disc}wait = 3"), &["`discs[0].wait` is not a key of a world"]),
        ("[[faults]]", &["`faults[0].sensor` is missing", "`faults[0].kind` is missing"]),
        (&format!("{fault}kind = \"broken\""), &["`faults[0].kind` is not known"]),
        (&format!("{fault}kind = \"lost\"\nvalue = 1"), &["`faults[0].value` has no meaning here"]),
        (&format!("{fault}kind = \"offset\""), &["`faults[0].value` is missing"]),
        (&format!("{fault}kind = \"delayed\""), &["`faults[0].value` is missing"]),
        (
            &format!("{fault}kind = \"offset\"\nvalue = \"far\""),
            &["`faults[0].value` must be two numbers, each from -1000000 to 1000000"],
        ),
        (
            &format!("{fault}kind = \"garbled\"\nvalue = 2"),
            &["`faults[0].value` must be a number from 0 to 1"],
        ),
        (
            &format!("{fault}kind = \"lost\"\nfrom = 9\nto = 3"),
            &["`faults[0]` ends before it begins"],
        ),
        ("[[faults]]\nsensor = \"link\"\nkind = \"offset\"\nvalue = 1", &["a link has no offset"]),
    ] {
        assert_eq!(mistakes(text), expected, "{text}");
    }
}

#[test]
fn every_condition_is_read() {
    use crate::conditions::{CompassChanges, GpsChanges, RangeChanges};
    use crate::sensors::PoseSettings;
    use crate::{Channel, Disc, Fault, PlannedFault, Repeat};
    let text = "start = [1, 2]\n\
        [gps]\nsigma = 0.5\nrate = 2\ndelay = 0.3\ncorrelation = 9\nmultipath = 4\n\
        [compass]\nsigma = 0.1\noffset = -0.2\n\
        [ranges]\nsectors = 8\nbeams = 3\nreach = 4\nsigma = 0.1\n\
        [pose]\nrate = 5\nsigma = 0.1\nheading_sigma = 0.2\n\
        [wheels]\nunequal = 0.03\nslip = 0.1\n\
        [body]\nacceleration = 0.5\nturn_acceleration = 2\n\
        [[discs]]\nradius = 0.3\nspeed = 1\npath = [[0, 0], [1, 0]]\nloop = \"around\"\nstart = 0.5\n\
        [[faults]]\nsensor = \"gps\"\nkind = \"offset\"\nvalue = [50, 1]\nfrom = 20\nto = 30\n\
        [[faults]]\nsensor = \"actuators\"\nkind = \"delayed\"\nvalue = 0.5\n";
    let file: WorldFile = text.parse().expect("it is sound");
    let disc = Disc {
        radius_m: 0.3,
        path: vec![[0.0, 0.0], [1.0, 0.0]],
        speed_mps: 1.0,
        repeat: Repeat::Around,
        start_m: 0.5,
    };
    let jump = PlannedFault {
        channel: Channel::Gps,
        fault: Fault::Jump { offset: [50.0, 1.0] },
        window_s: 20.0..30.0,
    };
    let late = PlannedFault {
        channel: Channel::Actuators,
        fault: Fault::Delay { ticks: 10 },
        window_s: 0.0..f64::INFINITY,
    };
    let expected = Conditions {
        gps: GpsChanges {
            sigma_m: Some(0.5),
            rate_hz: Some(2.0),
            delay_s: Some(0.3),
            correlation_s: Some(9.0),
            multipath_m: Some(4.0),
        },
        compass: CompassChanges { sigma_rad: Some(0.1), offset_rad: Some(-0.2) },
        ranges: RangeChanges {
            sectors: Some(8),
            beams: Some(3),
            reach_m: Some(4.0),
            sigma_m: Some(0.1),
        },
        pose: Some(PoseSettings { rate_hz: 5.0, sigma_m: 0.1, heading_sigma_rad: Some(0.2) }),
        unequal_radps: 0.03,
        slip: 0.1,
        acceleration_mps2: Some(0.5),
        turn_acceleration_radps2: Some(2.0),
        discs: vec![disc],
        faults: vec![jump, late],
    };
    assert_eq!(file.conditions, expected);
    assert!(file.difference.is_none());
}

#[test]
fn every_failure_of_every_sensor_is_read() {
    use crate::Fault;
    for sensor in
        ["gps", "compass", "odometry", "ranges", "pose", "link", "battery", "clock", "actuators"]
    {
        let has_two = matches!(sensor, "gps" | "pose" | "actuators");
        let offset = if has_two { "value = [3, 0]" } else { "value = 3" };
        for (kind, value, fault) in [
            ("lost", "", Fault::Drop { chance: 1.0 }),
            ("frozen", "", Fault::Freeze),
            ("offset", offset, Fault::Jump { offset: [3.0, 0.0] }),
            ("delayed", "value = 1", Fault::Delay { ticks: 20 }),
            ("garbled", "", Fault::Garble { chance: 1.0 }),
            ("garbled", "value = 0.2", Fault::Garble { chance: 0.2 }),
            ("intermittent", "", Fault::Drop { chance: 0.5 }),
        ] {
            let text = format!(
                "start = [0, 0]\n[[faults]]\nsensor = \"{sensor}\"\nkind = \"{kind}\"\n{value}\n"
            );
            match text.parse::<WorldFile>() {
                Ok(file) => assert_eq!(file.conditions.faults[0].fault, fault, "{text}"),
                Err(message) => assert!((sensor, kind) == ("link", "offset"), "{text}\n{message}"),
            }
        }
    }
}

#[test]
fn a_difference_is_read_and_inline_tables_are_tables() {
    use maps::Shape;
    let text = "start = [1, 2]\nextra = [{ circle = [5, 6, 0.5] }, { line = [[0, 0], [1, 1]] }]\n\
        missing = [{ name = \"kiosk\" }, { at = [3, 4], within = 2 }]\n\
        unmapped = 0.3\nremoved = 0.1\nshift = [0.5, 0]\nturn = 0.02\nscale = 1.01\n\
        [[discs]]\nradius = 1\nspeed = 0\npath = [[0, 0]]\n";
    let file: WorldFile = text.parse().expect("it is sound");
    let difference = &file.difference;
    let circle = Shape::Circle { centre: [5.0, 6.0], radius: 0.5 };
    let line = Shape::Polyline(vec![[0.0, 0.0], [1.0, 1.0]]);
    assert_eq!(difference.extra, [circle, line]);
    let near = Missing::Near { at: [3.0, 4.0], within_m: 2.0 };
    assert_eq!(difference.missing, [Missing::Named("kiosk".into()), near]);
    assert_eq!((difference.unmapped, difference.removed), (0.3, 0.1));
    let placement =
        crate::Placement { about: [1.0, 2.0], turn_rad: 0.02, scale: 1.01, shift: [0.5, 0.0] };
    assert_eq!(difference.placement, placement);
}

/// A map of one post called `kiosk` in a folder.
fn folder(name: &str, text: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("wayfield-world-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    std::fs::write(folder.join("built.ovl"), text).expect("a file");
    folder
}

#[test]
fn the_truth_is_a_map_beside_the_world_file() {
    let sound = "SITE a\nORIGIN 0 0\nMISSION-AREA 9 9\nCONTROL MEASURES:\nOBSTACLE 3 3 0.5\n";
    for (name, map, truth, expected) in [
        ("sound", sound, "built.ovl", &[][..]),
        ("no-file", sound, "other.ovl", &["there is no file"]),
        (
            "damaged",
            "SITE a\nORIGIN 0 0\nMISSION-AREA nine 9\n",
            "built.ovl",
            &["cannot be read", ""],
        ),
    ] {
        let folder = folder(name, map);
        std::fs::write(
            folder.join("yard.world.toml"),
            format!("start = [0, 0]\ntruth = \"{truth}\"\n"),
        )
        .expect("a file");
        let mut problems = Vec::new();
        let file = WorldFile::beside(&folder.join("yard.ovl"), &mut problems);
        assert_eq!(file.is_some(), expected.is_empty(), "{problems:?}");
        assert!(problems.len() >= expected.len(), "{problems:?}");
        for (problem, expected) in problems.iter().zip(expected) {
            assert!(problem.message.contains(expected), "{problem:?}");
            assert!(problem.place.is_some(), "{problem:?}");
        }
        if let Some(file) = file {
            let map = Map::empty(maps::Extent { corner: [0.0; 2], size: [9.0; 2] });
            assert!(file.difference.apply(&map, 1).truth.is_inside([3.0, 3.0]));
        }
        std::fs::remove_dir_all(folder).expect("it is there");
    }
}

#[test]
fn missing_obstacles_must_be_on_the_map() {
    let mut map = Map::empty(maps::Extent { corner: [0.0; 2], size: [9.0; 2] });
    map.features.push(maps::Feature {
        shape: maps::Shape::Circle { centre: [3.0, 3.0], radius: 0.5 },
        role: maps::Role::Obstacle,
        name: "kiosk".to_owned(),
        height_m: None,
        span: 0..0,
    });
    let text = "start = [0, 0]\nmissing = [{ name = \"kisok\" }, { name = \"kiosk\" }, \
                { at = [3, 4], within = 0.4 }, { at = [3, 4], within = 0.6 }]\n";
    let file: WorldFile = text.parse().expect("it is sound");
    let mut problems = Vec::new();
    file.check(&map, &mut problems);
    let messages: Vec<String> = problems.iter().map(ToString::to_string).collect();
    assert_eq!(
        messages,
        ["no obstacle is called `kisok`", "no obstacle is within 0.4 m of (3, 4)"]
    );
    assert_eq!(problems[0].help.as_deref(), Some("did you mean `kiosk`?"));

    // The truth decides, if there is one.
    let mut file = file;
    file.difference.truth =
        Some(Box::new(Map::empty(maps::Extent { corner: [0.0; 2], size: [9.0; 2] })));
    problems.clear();
    file.check(&map, &mut problems);
    assert_eq!(problems.len(), 4);
}

/// An offset has as many numbers as the reading: a wrong shape is not read as another fault.
#[test]
fn an_offset_has_the_shape_of_its_reading() {
    let fault = |sensor: &str, value: &str| {
        mistakes(&format!(
            "[[faults]]\nsensor = \"{sensor}\"\nkind = \"offset\"\nvalue = {value}\n"
        ))
    };
    for sensor in ["gps", "pose", "actuators"] {
        let expected = "`faults[0].value` must be two numbers, each from -1000000 to 1000000";
        assert_eq!(fault(sensor, "[1, 2]"), [""; 0], "{sensor}");
        assert_eq!(fault(sensor, "5"), [expected], "{sensor}");
        assert_eq!(fault(sensor, "[1e9, 0]"), [expected], "{sensor}");
    }
    for sensor in ["compass", "odometry", "ranges", "battery", "clock"] {
        let expected = "`faults[0].value` must be a number from -1000000 to 1000000";
        assert_eq!(fault(sensor, "0.5"), [""; 0], "{sensor}");
        assert_eq!(fault(sensor, "[1, 2]"), [expected], "{sensor}");
    }
}

#[test]
fn one_sigma_of_the_receiver_is_enough() {
    let expected = "`gps_sigma` and `gps.sigma` are the same";
    assert_eq!(mistakes("gps_sigma = 0.5\n[gps]\nsigma = 0.1\n"), [expected]);
    assert_eq!(mistakes("gps_sigma = 0.5\n[gps]\nrate = 1\n"), [""; 0]);
}

#[test]
fn a_folder_is_not_the_truth() {
    let source = Source { name: "w".into(), text: "start = [1, 2]\ntruth = '.'\n".into() };
    let mut problems = Vec::new();
    assert!(parse(&source.into(), Some(Path::new("src")), &mut problems).is_none());
    let message = problems[0].to_string();
    assert_eq!(message, "`truth` must be the name of a map, and \".\" is a folder");
}
