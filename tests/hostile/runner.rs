//! Runs the program on a case: under a limit of memory, with a limit of time.

use super::cases::Case;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// The limit of memory, in kilobytes.
const MEMORY: &str = "2000000";

/// When a case that still runs is interrupted, as by Ctrl-C.
const INTERRUPTED: Duration = Duration::from_secs(2);

/// When a case that still runs hangs.
const HANGS: Duration = Duration::from_secs(5);

/// The program under test.
pub struct Program {
    pub path: PathBuf,
}

/// How a run ended.
#[derive(Clone, Debug, Default)]
pub struct Ended {
    /// The exit code; none if a signal ended it.
    pub code: Option<i32>,
    /// The signal.
    pub signal: Option<i32>,
    /// Whether it was interrupted, since it took long.
    pub interrupted: bool,
    /// Whether it had to be killed.
    pub hung: bool,
    /// The error stream.
    pub message: String,
}

impl Program {
    /// The command in a folder, under the limit of memory where there is a shell that knows one.
    fn command(&self, arguments: &[String], folder: &Path) -> Command {
        let mut command = if cfg!(unix) {
            let mut shell = Command::new("sh");
            let limited = format!("ulimit -v {MEMORY}; exec \"$@\"");
            shell.args(["-c", &limited, "sh"]).arg(&self.path);
            shell
        } else {
            Command::new(&self.path)
        };
        command.args(arguments).current_dir(folder).env("RAYON_NUM_THREADS", "1");
        command.stdin(Stdio::null()).env("RUST_BACKTRACE", "0");
        command
    }

    /// Runs what must succeed.
    pub fn make(&self, arguments: &[&str], folder: &Path) -> Result<(), String> {
        let arguments: Vec<String> = arguments.iter().map(|text| text.to_string()).collect();
        let output = self.command(&arguments, folder).output();
        let output = output.map_err(|error| format!("{}: {error}", self.path.display()))?;
        match output.status.success() {
            true => Ok(()),
            false => Err(format!("{arguments:?}: {}", String::from_utf8_lossy(&output.stderr))),
        }
    }

    /// Runs a case; its streams go into files beside its folder.
    pub fn run(&self, case: &Case) -> std::io::Result<Ended> {
        let [out, err] = ["stdout", "stderr"].map(|name| case.root.join(name));
        let mut command = self.command(&case.arguments, &case.folder);
        command.stdout(File::create(out)?).stderr(File::create(&err)?);
        // An argument that no system passes on is no fault of the program.
        let Ok(mut child) = command.spawn() else { return Ok(Ended::default()) };
        let (status, interrupted) = wait(&mut child)?;
        let bytes = std::fs::read(&err)?;
        let message = String::from_utf8_lossy(&bytes[..bytes.len().min(1 << 20)]).into_owned();
        let code = status.and_then(|status| status.code());
        let signal = status.and_then(signal);
        Ok(Ended { code, signal, interrupted, hung: status.is_none(), message })
    }
}

/// Waits for the end, interrupts what takes long, and kills what hangs: then there is no status.
fn wait(child: &mut Child) -> std::io::Result<(Option<ExitStatus>, bool)> {
    let (began, mut interrupted) = (Instant::now(), false);
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok((Some(status), interrupted));
        }
        let taken = began.elapsed();
        if taken > INTERRUPTED && !interrupted {
            interrupted = true;
            let _ = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
        }
        if taken > HANGS {
            child.kill()?;
            child.wait()?;
            return Ok((None, true));
        }
        std::thread::sleep(
            (taken / 8).clamp(Duration::from_micros(500), Duration::from_millis(20)),
        );
    }
}

#[cfg(unix)]
fn signal(status: ExitStatus) -> Option<i32> {
    std::os::unix::process::ExitStatusExt::signal(&status)
}

#[cfg(not(unix))]
fn signal(_status: ExitStatus) -> Option<i32> {
    None
}
