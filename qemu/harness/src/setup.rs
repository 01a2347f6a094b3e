//! Installs missing tools: Rust's bare-metal targets and QEMU. Also builds the project's images.
//!
//! Each step runs at most once in a process, and several processes take turns. A step that needs
//! the user's password ends in an error that names the command to run.

use std::collections::HashMap;
use std::fs::{self, File};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::{Mutex, OnceLock, PoisonError};

/// The program that emulates the boards.
pub const QEMU: &str = "qemu-system-arm";

/// A tool is missing or failed.
#[derive(Clone, Debug, thiserror::Error)]
pub enum SetupError {
    /// The user has to act.
    #[error("{what}. Run: {command}")]
    Missing {
        /// What is missing.
        what: String,
        /// The command that installs it.
        command: String,
    },
    /// A program failed.
    #[error("`{command}` failed: {why}")]
    Failed {
        /// The command line.
        command: String,
        /// The program's error output, or its exit status.
        why: String,
    },
}

/// The project's root.
pub fn root() -> &'static Path {
    static ROOT: OnceLock<PathBuf> = OnceLock::new();
    ROOT.get_or_init(|| {
        let written = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
        written.canonicalize().unwrap_or_else(|_| written.to_owned())
    })
}

/// Cargo's target folder; pictures and other outputs go there too.
pub fn target_folder() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from)
}

/// Makes sure that QEMU runs: installs it with apt-get if that needs no password.
pub fn qemu() -> Result<(), SetupError> {
    static DONE: OnceLock<Result<(), SetupError>> = OnceLock::new();
    DONE.get_or_init(|| in_turn(install_qemu)).clone()
}

/// Builds a program of the project and returns its path. `target` is a bare-metal triple, or `None`
/// for the host. Cargo rebuilds nothing that is up to date.
pub fn built(
    package: &str,
    bin: &str,
    profile: &str,
    target: Option<&str>,
) -> Result<PathBuf, SetupError> {
    type Built = Mutex<HashMap<Vec<String>, Result<PathBuf, SetupError>>>;
    static DONE: OnceLock<Built> = OnceLock::new();
    let mut arguments: Vec<String> =
        ["build", "--quiet", "--locked", "--message-format=json-render-diagnostics"]
            .map(str::to_owned)
            .into();
    arguments.extend(["--package", package, "--bin", bin, "--profile", profile].map(str::to_owned));
    if let Some(triple) = target {
        rust_target(triple)?;
        arguments.extend(["--target".to_owned(), triple.to_owned()]);
    }
    // Held while cargo runs, so that a second caller of the same image waits.
    let mut done = DONE.get_or_init(Mutex::default).lock().unwrap_or_else(PoisonError::into_inner);
    done.entry(arguments).or_insert_with_key(|arguments| executable(arguments)).clone()
}

/// The `plan-compiler` binary, built with the profile of the tests.
pub fn plan_compiler() -> Result<PathBuf, SetupError> {
    built("wayfield-plan-compiler", "plan-compiler", "dev", None)
}

/// Makes sure that code for `triple` can be built.
pub fn rust_target(triple: &str) -> Result<(), SetupError> {
    static DONE: Mutex<Vec<(String, Result<(), SetupError>)>> = Mutex::new(Vec::new());
    let mut done = DONE.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, result)) = done.iter().find(|(known, _)| known == triple) {
        return result.clone();
    }
    let result = in_turn(|| install_rust_target(triple));
    done.push((triple.to_owned(), result.clone()));
    result
}

fn install_rust_target(triple: &str) -> Result<(), SetupError> {
    let mut rustc = clean_command("rustc");
    let folder = run(rustc.args(["--print", "target-libdir", "--target", triple]))?;
    if Path::new(folder.trim()).is_dir() {
        return Ok(());
    }
    let command = format!("rustup target add {triple}");
    // In the project's folder, rustup uses the toolchain that the project pins.
    run(clean_command("rustup").args(["target", "add", triple])).map(drop).map_err(|error| {
        let what = format!("the Rust target {triple} is not installed ({error})");
        SetupError::Missing { what, command }
    })
}

fn install_qemu() -> Result<(), SetupError> {
    if runs(QEMU, &["--version"]) {
        return Ok(());
    }
    let missing = |why: &str| SetupError::Missing {
        what: format!("{QEMU} is not installed{why}"),
        command: installation_command().to_owned(),
    };
    let sudo: &[&str] = if !runs("apt-get", &["--version"]) {
        return Err(missing(""));
    } else if is_root() {
        &[]
    } else if runs("sudo", &["-n", "true"]) {
        &["sudo", "-n"]
    } else {
        return Err(missing(" and installing it needs your password"));
    };
    eprintln!("installing {QEMU} with apt-get");
    let apt = |arguments: &[&str]| {
        // Waits if another program holds the lock of the package manager.
        let words = [sudo, &["apt-get", "-o", "DPkg::Lock::Timeout=120", "-qq", "-y"], arguments];
        let words = words.concat();
        let (program, rest) = words.split_first().expect("apt-get at least");
        run(Command::new(program).args(rest).env("DEBIAN_FRONTEND", "noninteractive"))
    };
    let install = || apt(&["install", "--no-install-recommends", QEMU]);
    // Updates the package lists only if the first attempt fails, which saves a minute.
    let installed = install().or_else(|_| apt(&["update"]).and_then(|_| install()));
    installed.map(drop).map_err(|error| missing(&format!(" ({error})")))
}

/// The command that installs QEMU on this machine.
fn installation_command() -> &'static str {
    const COMMANDS: &[(&str, &str)] = &[
        ("apt-get", "sudo apt-get install --no-install-recommends qemu-system-arm"),
        ("dnf", "sudo dnf install qemu-system-arm"),
        ("pacman", "sudo pacman -S qemu-system-arm"),
        ("zypper", "sudo zypper install qemu-arm"),
        ("apk", "sudo apk add qemu-system-arm"),
        ("brew", "brew install qemu"),
    ];
    let known = COMMANDS.iter().find(|(program, _)| runs(program, &["--version"]));
    known.map_or("the installer from https://www.qemu.org/download/", |(_, command)| command)
}

fn is_root() -> bool {
    output(Command::new("id").arg("-u")).is_ok_and(|id| id.stdout.trim_ascii() == b"0")
}

/// Runs cargo and returns the path of the program from its messages.
fn executable(arguments: &[String]) -> Result<PathBuf, SetupError> {
    let report = run(clean_command("cargo").args(arguments))?;
    report
        .lines()
        .filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok())
        .filter_map(|message| message["executable"].as_str().map(PathBuf::from))
        .next_back()
        .ok_or_else(|| SetupError::Failed {
            command: format!("cargo {}", arguments.join(" ")),
            why: "its messages name no executable".to_owned(),
        })
}

/// A command of the toolchain that the project pins. It does not inherit the environment variables
/// of a surrounding cargo, coverage run or wrapper: those flags are for the host's code.
fn clean_command(program: &str) -> Command {
    let mut command = Command::new(program);
    command.current_dir(root());
    for (name, _) in std::env::vars_os() {
        if name.to_str().is_some_and(is_for_the_host) {
            command.env_remove(&name);
        }
    }
    command
}

fn is_for_the_host(name: &str) -> bool {
    const NAMES: &[&str] = &["CARGO", "RUSTFLAGS", "RUSTDOCFLAGS", "RUSTUP_TOOLCHAIN"];
    const BEGINNINGS: &[&str] = &[
        "CARGO_BUILD_",
        "CARGO_CFG_",
        "CARGO_ENCODED_",
        "CARGO_FEATURE_",
        "CARGO_LLVM_COV",
        "CARGO_PROFILE_",
        "CARGO_TARGET_",
        "LLVM_",
        "RUSTC",
        "__CARGO_",
    ];
    let begins = |beginning: &&str| name.starts_with(*beginning);
    name != "CARGO_TARGET_DIR" && (NAMES.contains(&name) || BEGINNINGS.iter().any(begins))
}

/// Runs `work` under a lock that all processes of the project share.
fn in_turn<T>(work: impl FnOnce() -> T) -> T {
    let folder = target_folder();
    let lock = fs::create_dir_all(&folder)
        .and_then(|()| File::create(folder.join(".setup.lock")))
        .and_then(|file| file.lock().map(|()| file));
    let result = work();
    // `work` runs even if the lock could not be taken: a clash is unlikely.
    drop(lock);
    result
}

fn runs(program: &str, arguments: &[&str]) -> bool {
    output(Command::new(program).args(arguments)).is_ok_and(|output| output.status.success())
}

fn output(command: &mut Command) -> io::Result<Output> {
    command.stdin(Stdio::null()).output()
}

/// Runs a command to its end and returns its standard output.
fn run(command: &mut Command) -> Result<String, SetupError> {
    let name = |command: &Command| {
        let words = std::iter::once(command.get_program()).chain(command.get_args());
        words.map(|word| word.to_string_lossy()).collect::<Vec<_>>().join(" ")
    };
    let failed = |command: &Command, why| SetupError::Failed { command: name(command), why };
    match output(command) {
        Ok(output) if output.status.success() => {
            Ok(String::from_utf8_lossy(&output.stdout).into_owned())
        }
        Ok(output) => {
            let errors = String::from_utf8_lossy(&output.stderr).trim().to_owned();
            let why = if errors.is_empty() { output.status.to_string() } else { errors };
            Err(failed(command, why))
        }
        Err(error) if error.kind() == ErrorKind::NotFound => {
            Err(failed(command, "it is not installed".to_owned()))
        }
        Err(error) => Err(failed(command, error.to_string())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_for_the_host_do_not_reach_bare_metal_builds() {
        for name in [
            "RUSTFLAGS",
            "CARGO_ENCODED_RUSTFLAGS",
            "RUSTC_WRAPPER",
            "RUSTC_WORKSPACE_WRAPPER",
            "LLVM_PROFILE_FILE",
            "CARGO_TARGET_X86_64_UNKNOWN_LINUX_GNU_RUNNER",
            "CARGO_PROFILE_RELEASE_LTO",
        ] {
            assert!(is_for_the_host(name), "{name}");
        }
        for name in ["PATH", "HOME", "CARGO_HOME", "CARGO_TARGET_DIR", "RUSTUP_HOME"] {
            assert!(!is_for_the_host(name), "{name}");
        }
    }

    #[test]
    fn a_missing_program_is_named() {
        let error = run(&mut Command::new("no-such-program-of-ours")).unwrap_err();
        assert_eq!(error.to_string(), "`no-such-program-of-ours` failed: it is not installed");
    }
}
