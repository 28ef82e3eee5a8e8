//! The machine, the compiler and the date of a measurement.

use crate::Circumstances;
use std::time::SystemTime;

/// Returns the current machine, the compiler of this program, and today's date.
pub(super) fn now(runs: usize) -> Circumstances {
    let date = humantime::format_rfc3339_seconds(SystemTime::now()).to_string();
    Circumstances {
        processor: processor(),
        compiler: format!("{}, {}", env!("COMPILER"), env!("PROFILE")),
        cores: std::thread::available_parallelism().map_or(1, usize::from),
        date: date.chars().take_while(|c| *c != 'T').collect(),
        runs,
    }
}

/// Returns the model name of the processor, or its architecture if the name is unknown.
fn processor() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let named =
        |line: &str| Some(line.strip_prefix("model name")?.split_once(':')?.1.trim().to_string());
    info.lines().find_map(named).unwrap_or_else(|| std::env::consts::ARCH.to_string())
}
