//! Passes the compiler's version and options to the program, for work-precision diagrams.

use std::process::Command;

fn main() {
    let told = |name: &str| std::env::var(name).unwrap_or_default();
    let version = Command::new(told("RUSTC")).arg("--version").output();
    let version = version.map(|output| String::from_utf8_lossy(&output.stdout).trim().to_string());
    println!("cargo::rustc-env=TANGENCY_COMPILER={}", version.unwrap_or_else(|_| "rustc".into()));
    println!("cargo::rustc-env=TANGENCY_PROFILE=opt-level {}", told("OPT_LEVEL"));
    println!("cargo::rerun-if-changed=build.rs");
}
