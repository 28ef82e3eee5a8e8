//! Passes the compiler's version and options on, which work-precision diagrams name.

use std::process::Command;

fn main() {
    let variable = |name: &str| std::env::var(name).unwrap_or_default();
    let version = Command::new(variable("RUSTC")).arg("--version").output();
    let version = version.map(|output| String::from_utf8_lossy(&output.stdout).trim().to_string());
    println!("cargo::rustc-env=COMPILER={}", version.unwrap_or_else(|_| "rustc".into()));
    println!("cargo::rustc-env=PROFILE=opt-level {}", variable("OPT_LEVEL"));
    println!("cargo::rerun-if-changed=build.rs");
}
