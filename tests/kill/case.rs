//! One folder, in which runs of one command are killed and resumed.

use super::random::Random;
use super::table::Counted;
use std::cell::Cell;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};
use tangency::output::{Document, PAGE, Sweeps, draw, figures};

const NAME: &str = "scene";

/// A trace of half a second.
const TRACE: &str = r#"Scene(
    title: "Lur'e", problem: Lure(), parameters: [("alpha", 1.2), ("beta", 1)],
    settings: (max_step: 0.005),
    runs: [(name: "rest", set: [("solution", "equilibrium")], along: [(name: "alpha", low: 0.5, high: 1.5)]),
        (name: "orbits", start: From(run: "rest", kind: HB), along: [(name: "alpha", low: 0.5, high: 1.5)]),
        (name: "doubled", start: From(run: "orbits", kind: PD, switch: true), along: [(name: "alpha", low: 0.5, high: 1.5)])],
)"#;

/// A branch, and a sweep of many runs.
const SWEEP: &str = r#"Scene(
    title: "Chaos", problem: Mita(), parameters: [("frequency", 0.5), ("voltage", 0.05)],
    plot: (x: "voltage", y: "displacement_range", swept: [("voltage", "exponent")]),
    runs: [(name: "P(0,1)", start: Simulated(transient: 100), along: [(name: "voltage", low: 0.05, high: 0.1)])],
    sweeps: [(name: "up", order: up, strands: 3, over: [(name: "voltage", low: 0.3, high: 0.7, count: 61)],
        search: (transient: 600, recorded_periods: 20, lyapunov_periods: 400), measures: ["displacement_range"])],
)"#;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Signal {
    Kill,
    Term,
}

/// Files by their names.
type Files = BTreeMap<String, Vec<u8>>;

/// A command, what it leaves where nobody kills it, and what another one with the same files
/// leaves.
pub struct Command {
    pub name: &'static str,
    scene: &'static str,
    more: &'static [&'static str],
    /// How long it takes, as the machine is just now: this follows from when runs are killed, and
    /// end before.
    takes: Cell<Duration>,
    whole: Files,
    old: Files,
}

impl Command {
    pub fn trace() -> Self {
        Command::new("trace", TRACE, &[], ["max_step=0.01"])
    }

    pub fn sweep() -> Self {
        Command::new("sweep", SWEEP, &["--checkpoint", "0.02"], ["count=2"])
    }

    fn new(
        name: &'static str,
        scene: &'static str,
        more: &'static [&'static str],
        other: [&str; 1],
    ) -> Self {
        let (whole, old) = (Files::new(), Files::new());
        let command = Command { name, scene, more, takes: Cell::default(), whole, old };
        let left_by = |settings: &[&str]| {
            let folder = command.folder();
            let begin = Instant::now();
            let mut child = command.spawn(folder.path(), settings);
            assert!(child.wait().unwrap().success(), "{name} fails");
            command.takes.set(begin.elapsed());
            files(&folder.path().join("out"))
        };
        let old = left_by(&other);
        let whole = left_by(&[]);
        assert!(old != whole);
        Command { whole, old, ..command }
    }

    fn folder(&self) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(format!("{NAME}.ron")), self.scene).unwrap();
        folder
    }

    fn spawn(&self, folder: &Path, settings: &[&str]) -> Child {
        std::process::Command::new(env!("CARGO_BIN_EXE_tangency"))
            .current_dir(folder)
            .args([self.name, &format!("{NAME}.ron")])
            .args(self.more)
            .args(settings.iter().flat_map(|setting| ["--set", setting]))
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap()
    }
}

/// The files of a folder; none if it is not there.
fn files(folder: &Path) -> Files {
    let entries = folder.read_dir().into_iter().flatten().map(Result::unwrap);
    let file = |entry: std::fs::DirEntry| {
        (entry.file_name().into_string().unwrap(), std::fs::read(entry.path()).unwrap())
    };
    entries.map(file).collect()
}

/// Whether the files of a result are whole, and the picture is that of the data.
fn belong_together(folder: &Path, files: &Files) -> bool {
    let path = |ending: &str| folder.join(format!("{NAME}.{ending}"));
    let has = |ending: &str| files.contains_key(&format!("{NAME}.{ending}"));
    let document = has("ron").then(|| Document::load(path("ron"))).transpose();
    let sweeps = has("npz").then(|| Sweeps::load(path("npz"))).transpose();
    let (Ok(document), Ok(sweeps)) = (document, sweeps) else { return false };
    if document.is_none() && sweeps.is_none() {
        return !has("svg");
    }
    let named: Vec<(&str, &Document)> = document.iter().map(|it| (NAME, it)).collect();
    let sweeps: Vec<Sweeps> = sweeps.into_iter().collect();
    let drawn = figures(&named, &sweeps, None, &[]).and_then(|figures| draw(&figures, PAGE));
    // What cannot be drawn as yet has no picture.
    files.get(&format!("{NAME}.svg")).map(Vec::as_slice)
        == drawn.ok().as_ref().map(|it| it.as_bytes())
}

/// Whether a kill fell between two renames: the files belong together once the temporary files, which
/// are written in full before the first rename, have their final names.
fn between_renames(files: &Files, temporary: &Files) -> bool {
    let folder = tempfile::tempdir().unwrap();
    let mut renamed = files.clone();
    for (name, content) in temporary {
        // `.NAME.PROCESS.tmp`
        let name = name.trim_start_matches('.').rsplitn(3, '.').nth(2).unwrap();
        renamed.insert(name.into(), content.clone());
    }
    for (name, content) in &renamed {
        std::fs::write(folder.path().join(name), content).unwrap();
    }
    !temporary.is_empty() && belong_together(folder.path(), &renamed)
}

/// A folder in which runs are killed.
pub struct Case<'a> {
    command: &'a Command,
    signal: Signal,
    folder: tempfile::TempDir,
    counted: Counted,
}

impl<'a> Case<'a> {
    /// A new folder, with or without an old result. (What a sweep leaves is gone on from: its old
    /// results are its own.)
    pub fn new(command: &'a Command, signal: Signal, random: &mut Random) -> Self {
        let folder = command.folder();
        let out = folder.path().join("out");
        if command.name == "trace" && random.number().is_multiple_of(2) {
            std::fs::create_dir(&out).unwrap();
            for (name, content) in &command.old {
                std::fs::write(out.join(name), content).unwrap();
            }
        }
        Case { command, signal, folder, counted: Counted::new(command.name, signal) }
    }

    /// Kills a run, and looks at what it leaves; false if it had ended before.
    pub fn kill(&mut self, random: &mut Random) -> bool {
        let out = self.folder.path().join("out");
        let mut child = self.command.spawn(self.folder.path(), &[]);
        let takes = &self.command.takes;
        let delay = takes.get().mul_f64(random.number() as f64 / u64::MAX as f64);
        // Some kills are aimed at the writing that is the next one then.
        let aimed = random.number().is_multiple_of(3);
        let writing = || {
            let mut entries = out.read_dir().into_iter().flatten().flatten();
            entries.any(|entry| entry.file_name().to_string_lossy().ends_with(".tmp"))
        };
        let begin = Instant::now();
        while child.try_wait().unwrap().is_none() {
            let late = begin.elapsed() >= delay;
            if late && (!aimed || writing()) {
                break;
            }
            if !late {
                std::thread::sleep(Duration::from_micros(500));
            }
        }
        match self.signal {
            Signal::Kill => drop(child.kill()),
            Signal::Term => {
                let id = child.id().to_string();
                let mut kill = std::process::Command::new("kill");
                let _ = kill.args(["-TERM", &id]).stderr(Stdio::null()).status();
            }
        }
        let killed = !child.wait().unwrap().success();
        takes.set(takes.get().mul_f64(if killed { 1.05 } else { 0.8 }));
        self.look(&out, killed);
        killed
    }

    /// Counts what a killed run has left.
    fn look(&mut self, out: &Path, killed: bool) {
        let Command { whole, old, .. } = self.command;
        let (hidden, files): (Files, Files) =
            files(out).into_iter().partition(|(name, _)| name.starts_with('.'));
        let temporary: Files =
            hidden.into_iter().filter(|(name, _)| name.ends_with(".tmp")).collect();
        let counted = &mut self.counted;
        if !belong_together(out, &files) {
            match killed && between_renames(&files, &temporary) {
                true => counted.between += 1,
                false => counted
                    .wrong
                    .push(format!("files that do not belong together: {:?}", files.keys())),
            }
        }
        if !killed {
            counted.too_late += 1;
            return;
        }
        counted.kills += 1;
        counted.leftovers += usize::from(!temporary.is_empty());
        match &files {
            files if files.is_empty() => counted.nothing += 1,
            files if files == old => counted.old += 1,
            files if files == whole => counted.whole += 1,
            _ => counted.partly += 1,
        }
    }

    /// Lets the command end, and compares.
    pub fn end(mut self) -> Counted {
        let status = self.command.spawn(self.folder.path(), &[]).wait().unwrap();
        let left = files(&self.folder.path().join("out"));
        if !status.success() || left != self.command.whole {
            let names: Vec<&String> = left.keys().collect();
            self.counted
                .wrong
                .push(format!("{status}, other files or bytes at the end: {names:?}"));
        }
        self.counted
    }
}
