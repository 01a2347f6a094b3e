//! Chooses the machine by the target and links for it; does nothing on a host.

use std::path::PathBuf;
use std::{env, fs};

/// Target triple and the QEMU machine that its image is for.
const MACHINES: &[(&str, &str)] =
    &[("thumbv7em-none-eabihf", "mps2-an386"), ("thumbv7m-none-eabi", "lm3s6965evb")];

fn main() {
    println!("cargo::rerun-if-changed=memory");
    println!("cargo::rustc-check-cfg=cfg(machine, values(\"mps2-an386\", \"lm3s6965evb\"))");
    let target = env::var("TARGET").expect("cargo names the target");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    let machine = MACHINES.iter().find(|(triple, _)| *triple == target);
    let (_, machine) = machine.unwrap_or_else(|| panic!("no QEMU machine for {target}"));
    let read = |name: &str| {
        fs::read_to_string(format!("memory/{name}.x")).expect("the memory map is in the folder")
    };
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo names the folder"));
    fs::write(out.join("memory.x"), read(machine) + &read("symbols"))
        .expect("the output folder is writable");
    println!("cargo::rustc-cfg=machine=\"{machine}\"");
    println!("cargo::rustc-link-search={}", out.display());
    println!("cargo::rustc-link-arg-bins=--nmagic");
    println!("cargo::rustc-link-arg-bins=-Tlink.x");
}
