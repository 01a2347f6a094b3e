//! `plan-compiler graph` as a user runs it.

use std::fs;
use std::path::Path;
use std::process::Command;

/// Runs `plan-compiler` in a folder, and returns its exit status and messages.
fn run(folder: &Path, arguments: &[&str]) -> (i32, String) {
    let compiler = harness::setup::plan_compiler().expect("the compiler builds");
    let output = Command::new(compiler).args(arguments).current_dir(folder).output();
    let output = output.expect("the compiler starts");
    let said = String::from_utf8(output.stderr).expect("UTF-8");
    (output.status.code().expect("it ended by itself"), said)
}

/// H41: a mission file and the blob that is built from it give the same graphs.
#[test]
fn h41_missions_and_blobs_are_drawn_alike() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["plough.ovl", "plough.mission.toml"] {
        fs::copy(it::own_map(name), folder.path().join(name)).expect("copied");
    }
    let read = |name: &str| fs::read(folder.path().join(name)).expect("it was written");
    let done = |arguments: &[&str]| {
        let (status, said) = run(folder.path(), arguments);
        assert_eq!(status, 0, "{arguments:?}\n{said}");
    };
    done(&["-q", "build", "plough.mission.toml", "-o", "plans.bin"]);
    for (of, ending) in [("plough.mission.toml", "mission"), ("plans.bin", "blob")] {
        for kind in ["dot", "svg", "png"] {
            done(&["-q", "graph", of, "-o", &format!("{ending}.{kind}")]);
        }
    }
    // Only a blob has the names of the plans that actions follow.
    let text = |name: &str| String::from_utf8(read(name)).expect("UTF-8");
    for kind in ["dot", "svg"] {
        let from_mission = text(&format!("mission.{kind}"));
        let named = from_mission.replace("follow 0 at", "follow gallon at");
        assert_eq!(named.replace("follow 1 at", "follow field at"), text(&format!("blob.{kind}")));
    }
    assert_eq!(read("mission.png"), read("blob.png"), "plans are named in tool tips only");
    assert!(read("mission.png").starts_with(b"\x89PNG"));
}

/// Directions and distances come back as they were written.
#[test]
fn actions_are_drawn_as_they_were_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let all = [
        "move-ahead 90 for 8 s",
        "move-ahead 0 for 1.5 s",
        "dock 6.25, -18 facing 225.5 from 3.5 m",
    ];
    let actions = all.iter().zip(["a", "b", "c"]);
    let actions = actions.map(|(does, name)| format!("{name} = {{ do = \"{does}\" }}\n"));
    let text = "[inputs.clock]\nsource = \"time\"\nuniverse = [0, 900]\n[behaviours.work]\n\
         criticality = { clock = \"PS PS PS PS PS PS NB\" }\n[frames.work]\n\
         productions = [\"entry -> a -> b -> c -> exit\"]\n[actions]\n";
    let text = actions.fold(text.to_owned(), |text, action| text + &action);
    fs::write(folder.path().join("m.mission.toml"), text).expect("written");
    let (status, said) = run(folder.path(), &["graph", "m.mission.toml", "-o", "a.dot"]);
    assert_eq!(status, 0, "{said}");
    let drawn = fs::read_to_string(folder.path().join("a.dot")).expect("it was written");
    for action in all {
        assert!(drawn.contains(action), "{action}:\n{drawn}");
    }
}

#[test]
fn what_cannot_be_drawn_is_said() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("m.mission.toml"), "resolution = 1\n").expect("written");
    let (status, said) = run(folder.path(), &["graph", "m.mission.toml", "-o", "a.svg"]);
    assert_eq!(status, 1, "{said}");
    assert!(said.contains("has no behaviours"), "{said}");
    let (status, said) = run(folder.path(), &["graph", "m.mission.toml", "-o", "a.pdf"]);
    assert_eq!(status, 2, "{said}");
    assert!(said.contains("must end in .dot, .svg or .png"), "{said}");
    assert!(!folder.path().join("a.svg").exists());
}
