//! One binary for all targets; `FUZZ` names the target to run. See README.md.
#![cfg_attr(fuzzing, no_main)]

#[cfg(fuzzing)]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    static CHOSEN: std::sync::OnceLock<&'static fuzz::Target> = std::sync::OnceLock::new();
    let chosen = CHOSEN.get_or_init(|| {
        let name = std::env::var("FUZZ").expect("FUZZ names a target");
        fuzz::Target::find(&name).expect("FUZZ names an existing target")
    });
    chosen.run(bytes);
});

/// Without a fuzzer: lists the targets, writes their seeds, or runs a target on files.
#[cfg(not(fuzzing))]
fn main() -> std::process::ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let done = match words[..] {
        ["list"] => {
            fuzz::TARGETS.iter().for_each(|target| println!("{}", target.name));
            Ok(())
        }
        ["seeds", name, folder] => write_seeds(name, folder.as_ref()),
        ["run", name, ref files @ ..] => run(name, files),
        _ => Err("usage: target list | seeds TARGET FOLDER | run TARGET FILE...".into()),
    };
    match done {
        Ok(()) => std::process::ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            std::process::ExitCode::FAILURE
        }
    }
}

#[cfg(not(fuzzing))]
type Done = Result<(), Box<dyn std::error::Error>>;

#[cfg(not(fuzzing))]
fn write_seeds(name: &str, folder: &std::path::Path) -> Done {
    let target = fuzz::Target::find(name).ok_or("no such target; `target list` names them")?;
    std::fs::create_dir_all(folder)?;
    for (number, seed) in target.seeds().iter().enumerate() {
        std::fs::write(folder.join(format!("seed-{number}")), seed)?;
    }
    Ok(())
}

#[cfg(not(fuzzing))]
fn run(name: &str, files: &[&str]) -> Done {
    let target = fuzz::Target::find(name).ok_or("no such target; `target list` names them")?;
    for file in files {
        target.run(&std::fs::read(file)?);
    }
    Ok(())
}
