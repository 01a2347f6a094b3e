//! Small files of every format, truncated after every byte and with every byte changed. Each result
//! is read, compiled and checked, or it is refused; nothing panics.

use maps::formats::{self, ReadOptions};
use maps::problem::{Source, draw};
use plan_compiler::compile::compile;
use plan_compiler::input::{Input, Options};
use plan_compiler::mission::{self, Goal, GoalAt, Mission};
use plan_format::Blob;
use std::path::Path;
use std::sync::Arc;

const OVERLAY: &str = "SITE yard\nMISSION-AREA 12 9\nORIGIN 1 2\nGLOBAL_REF_POINT 51 7\n\
    CONTROL MEASURES:\nPP gate 3 5\nWALL \"h\u{fc}tte\" 4 4  6 4  6 6\nOBSTACLE 9 8 1\n\
    BOUNDARY NoCommZone 2 2  5 2  5 5\n";
const OPAR: &str = "Farm\n51.0\n7.0\n4\n0\n0\n12\n0\n12\n9\n0\n9\n0.9\n1.1\n14\n0.45\n0.284\n1\n\
    1.33\n0.284\n0.588\n1\n6\n51.00003\n7.00003\n3\n0\n0\n3\n0\n0\n3\n";
const MOVINGAI: &str = "type octile\nheight 4\nwidth 5\nmap\n.....\n.@@..\n.T.WS\n.....\n";
const IPLAN: &str = "p\nyard.ovl\nORDERED\nTRUE\nTEXT\n1\nBEGIN_MAP\nhome\n2\n2\n1.0\n0\n0\n\
    #Data\n0\n1\n1\n9998\nEND_MAP\nSTART_ELEMENT\nMOVETO\nBEGIN_MAP\nm\n2\n2\n1.0\n1\n0\n#Data\n1\n\
    2\n0\n9998\nEND_MAP\nEND_FILE\n";
const YAML: &str = "image: yard.pgm\nresolution: 0.5\norigin: [-1.0, 2, 0]\nnegate: 0\n\
    occupied_thresh: 0.65\nfree_thresh: 0.196\n";
const PGM: &[u8] = b"P5\n4 3\n255\n\x00\xfe\xfe\xcd\xfe\x00\xfe\xfe\xfe\xfe\xfe\x00";
const PCF: &str = "BEGIN_PLAN\np\nyard.ovl\nORDERED\nTRUE\n<1,1>\n1\nMOVETO\n1\n<3,4>\nEND_PLAN\n";
const MISSION: &str = "resolution = 0.5\nplan = 'g\u{fc}'\n[goals]\n'g\u{fc}' = [1, 2]\nb = { at = \
    'gate', layers = ['physical'] }\n[layers]\nnight = ['NoFlyZone1']\n[masks]\nspeed = 'a'\n[vehicle]\n\
    max_speed = 2\n";

/// Every truncation, and a few changes of every byte.
fn damaged(good: &[u8]) -> impl Iterator<Item = Vec<u8>> + '_ {
    let cut = (0..=good.len()).map(|end| good[..end].to_vec());
    let changed = (0..good.len()).flat_map(|at| {
        [good[at] ^ 0x01, good[at] ^ 0x80, b'9', b'\n', 0x1b].map(|byte| {
            let mut bytes = good.to_vec();
            bytes[at] = byte;
            bytes
        })
    });
    cut.chain(changed)
}

/// Reads and compiles a map, draws the problems, and checks the blob if there is one.
fn build(path: &Path, bytes: Vec<u8>, mission: &Mission, at: [f64; 2]) -> bool {
    let loaded = formats::load_bytes(path, bytes, &ReadOptions::default());
    let mut problems = loaded.problems;
    let mut is_built = false;
    if let Some(map) = &loaded.map {
        let at = vec![GoalAt::Position(at)];
        let goal = Goal { name: "a".into(), at, layers: None, place: None };
        // Little memory: a changed digit makes a map large.
        let options = Options {
            goals: vec![goal],
            robot_radius_m: Some(0.0),
            max_memory_bytes: Some(70 << 20),
            ..Options::default()
        };
        let source = loaded.source.as_ref();
        let input = Input { map, source, mission, options: &options };
        if let Some(blob) = compile(&input, &|_, _| (), &mut problems) {
            is_built = Blob::parse_exact(&blob).is_ok();
            assert!(is_built, "{}", path.display());
        }
    }
    let drawn = draw(&problems, false);
    let is_control = |c: char| c.is_control() && !matches!(c, '\n' | '\t');
    assert!(!drawn.contains(is_control), "{drawn:?}");
    is_built
}

#[test]
fn maps_that_are_damaged_are_read_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("yard.ovl"), OVERLAY).unwrap();
    std::fs::write(path("yard.pgm"), PGM).unwrap();
    let turned = YAML.replace("2, 0]", "2, 1.5708]");
    let askew = YAML.replace("2, 0]", "2, 0.1]");
    for (name, text, goal) in [
        ("a.ovl", OVERLAY, [1.5, 3.5]),
        ("a.opar", OPAR, [8.5, 6.5]),
        ("a.map", MOVINGAI, [0.5, 0.5]),
        ("a.dat", IPLAN, [0.0, 0.0]),
        ("a.yaml", YAML, [-0.75, 2.25]),
        ("a.yaml", &turned, [-1.25, 2.25]),
        ("a.yaml", &askew, [0.1, 2.4]),
        ("a.pcf", PCF, [1.5, 3.5]),
    ] {
        let mission = Mission::default();
        let mut built = 0;
        for bytes in damaged(text.as_bytes()) {
            built += usize::from(build(&path(name), bytes, &mission, goal));
        }
        assert!(built > 0 || text == askew, "{name}");
    }
}

#[test]
fn images_that_are_damaged_are_read_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let yaml = folder.path().join("yard.yaml");
    // With an alpha channel, which a PGM does not have.
    let mut pam =
        b"P7\nWIDTH 2\nHEIGHT 2\nDEPTH 2\nMAXVAL 255\nTUPLTYPE GRAYSCALE_ALPHA\nENDHDR\n".to_vec();
    pam.extend_from_slice(&[0, 255, 254, 255, 254, 0, 254, 255]);
    let mut built = 0;
    for good in [PGM, &pam] {
        for bytes in damaged(good) {
            std::fs::write(folder.path().join("yard.pgm"), bytes).unwrap();
            let mission = Mission::default();
            built += usize::from(build(&yaml, YAML.as_bytes().to_vec(), &mission, [-0.75, 2.25]));
        }
    }
    assert!(built > 0);
}

#[test]
fn missions_that_are_damaged_are_read_or_refused() {
    for bytes in damaged(MISSION.as_bytes()) {
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let source = Arc::new(Source { name: "no/such/m.mission.toml".into(), text });
        let (mission, problems) = mission::parse(&source);
        draw(&problems, false);
        build(Path::new("yard.ovl"), OVERLAY.as_bytes().to_vec(), &mission, [1.5, 3.5]);
    }
}
