//! `tangency sweep SCENE`, `tangency merge FILE…`: brute force, saved as it goes on.

use super::error::CommandError;
use super::trace::{SceneAt, picture};
use super::watch::{Watch, interrupted};
use crate::core::sweep::{Division, Found, Part};
use crate::output::{Document, FileError, SweepTable, Sweeps, merge};
use crate::scene::{Catalogue, Scene, SweepWatch, execute, sweep};
use clap::Args;
use indicatif::ProgressBar;
use std::io::Write;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Find what motions settle on, over parameters and starts, on all cores
///
/// What is done is saved from time to time, and the same command goes on from there.
#[derive(Debug, Args)]
pub struct Sweep {
    #[command(flatten)]
    scene: SceneAt,
    /// Do part K of N only; `tangency merge` puts parts together
    #[arg(long, value_name = "K/N", value_parser = share)]
    part: Option<Part>,
    /// How many threads work [default: as many as there are cores]
    #[arg(long, value_name = "N")]
    threads: Option<NonZeroUsize>,
    /// After how many seconds what is done is saved
    #[arg(long, value_name = "SECONDS", default_value_t = 5.0)]
    save_every: f64,
    /// Forget the runs that are done
    #[arg(long)]
    afresh: bool,
}

/// Put the parts of a sweep together
#[derive(Debug, Args)]
pub struct Merge {
    /// The files of all parts (.npz)
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// The folder for the whole
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
}

/// `K/N`.
fn share(text: &str) -> Result<Part, String> {
    let part = text.split_once('/').and_then(|(number, of)| {
        let (number, of) = (number.parse().ok()?, of.parse().ok()?);
        (number >= 1 && number <= of).then_some(Part { number, of, ..Part::WHOLE })
    });
    part.ok_or_else(|| format!("`{text}` is not of the form K/N, for example 2/8"))
}

impl Sweep {
    /// Does the sweeps, saves and draws them. Whatever was done is saved, also after an error or Ctrl-C.
    pub fn run(&self, catalogue: &Catalogue, out: &mut impl Write) -> Result<(), CommandError> {
        let (name, scene) = self.scene.read(catalogue, None)?;
        if scene.sweeps.is_empty() {
            return Err(CommandError::NoSweep { scene: name });
        }
        let path = self.scene.out.join(match self.part {
            None => format!("{name}.npz"),
            Some(Part { number, of, .. }) => format!("{name}.part-{number}-of-{of}.npz"),
        });
        let known = if path.exists() && !self.afresh { Some(Sweeps::load(&path)?) } else { None };
        if let Some(part) = self.part {
            divided(&scene, part, out)?;
        }
        let document = self.trace(&name, &scene, out)?;
        let part = Part { threads: self.threads, ..self.part.unwrap_or(Part::WHOLE) };
        let every = Duration::try_from_secs_f64(self.save_every).unwrap_or(Duration::MAX);
        let (bar, saved) = (super::watch::bar(), Instant::now());
        let mut keeper = Keeper { path: &path, bar, saved, every, pause: every, failure: None };
        let swept = sweep(&scene, &name, part, known, &mut keeper);
        keeper.bar.finish_and_clear();
        let sweeps = swept.map_err(|cause| self.scene.at_fault(cause))?;
        sweeps.save(&path)?;
        report(&sweeps, out)?;
        writeln!(out, "{}", path.display())?;
        if self.part.is_none() {
            let document = document.as_ref().map(|document| (&*name, document));
            let svg = picture(document, std::slice::from_ref(&sweeps), &path)?;
            writeln!(out, "{}", svg.display())?;
        }
        keeper.failure.map_or(Ok(()), Err)?;
        if interrupted() { Err(CommandError::Interrupted) } else { Ok(()) }
    }

    /// Traces the scene's branches, if it has some: they are drawn with the sweeps.
    fn trace(
        &self,
        name: &str,
        scene: &Scene,
        out: &mut impl Write,
    ) -> Result<Option<Document>, CommandError> {
        let mut watch = Watch::new(out);
        if scene.runs.is_empty() || self.part.is_some() {
            watch.finish()?;
            return Ok(None);
        }
        let outcome = execute(scene, None, &mut watch);
        watch.finish()?;
        let document = Some(outcome.document).filter(|document| !document.branches.is_empty());
        if let Some(document) = &document {
            document.save(self.scene.out.join(format!("{name}.ron")))?;
        }
        match outcome.error {
            Some(cause) => Err(self.scene.at_fault(cause)),
            None => Ok(document),
        }
    }
}

impl Merge {
    /// Puts the parts together, saves and draws the whole.
    pub fn run(&self, out: &mut impl Write) -> Result<(), CommandError> {
        let parts = self.files.iter().map(Sweeps::load).collect::<Result<Vec<_>, FileError>>()?;
        let whole = merge(parts)?;
        let path = self.out.join(format!("{}.npz", whole.name));
        whole.save(&path)?;
        report(&whole, out)?;
        let svg = picture(None, std::slice::from_ref(&whole), &path)?;
        Ok(writeln!(out, "{}\n{}", path.display(), svg.display())?)
    }
}

/// Says if strands do not divide evenly into parts, and how many do.
fn divided(scene: &Scene, part: Part, out: &mut impl Write) -> Result<(), CommandError> {
    let division = scene.division(part.of);
    if division.is_even() {
        return Ok(());
    }
    let Division { parts, strands, runs, largest } = division;
    let even = division.even();
    writeln!(
        out,
        "{strands} strands do not divide evenly into {parts} parts: the largest has {largest} of {runs} runs, an even one would have {even}"
    )?;
    if let Some((strands, largest)) = scene.better_strands(part.of) {
        writeln!(
            out,
            "`--set strands={strands}`, for all parts, makes the largest {largest}; each strand begins at the start, so results may differ"
        )?;
    }
    Ok(())
}

/// A line for each sweep.
fn report(sweeps: &Sweeps, out: &mut impl Write) -> Result<(), CommandError> {
    for SweepTable { name, rows, total, .. } in &sweeps.sweeps {
        let failed = rows.values().filter(|row| row.failure.is_some()).count();
        write!(out, "{name}: {} of {total} runs", rows.len())?;
        match rows.iter().find_map(|(run, row)| Some((run, row.failure.as_ref()?))) {
            Some((run, why)) => writeln!(out, "; {failed} failed, the first, run {run}: {why}")?,
            None => writeln!(out)?,
        }
    }
    Ok(())
}

/// Saves what is done from time to time, and shows how much that is.
struct Keeper<'a> {
    path: &'a Path,
    bar: ProgressBar,
    saved: Instant,
    /// How long to wait at least until it is saved again …
    every: Duration,
    /// … and how long it is: saving must not take a notable part of the time.
    pause: Duration,
    failure: Option<CommandError>,
}

impl SweepWatch for Keeper<'_> {
    fn begin(&mut self, sweep: &SweepTable) {
        self.bar.set_length(sweep.total as u64);
        self.bar.set_position(sweep.rows.len() as u64);
        let SweepTable { name, rows, total, .. } = sweep;
        self.bar.set_message(format!("{} of {total} runs of {name}", rows.len()));
    }

    fn goes_on(&self) -> fn() -> bool {
        || !interrupted()
    }

    fn found(&mut self, known: &Sweeps, _found: &Found) -> ControlFlow<()> {
        self.bar.inc(1);
        let done: usize = known.sweeps.iter().map(|sweep| sweep.rows.len()).sum();
        let total: usize = known.sweeps.iter().map(|sweep| sweep.total).sum();
        self.bar.set_message(format!("{done} of {total} runs"));
        if self.saved.elapsed() >= self.pause {
            let begin = Instant::now();
            if let Err(error) = known.save(self.path) {
                self.failure = Some(error.into());
                return ControlFlow::Break(());
            }
            self.pause = self.every.max(20 * begin.elapsed());
            self.saved = Instant::now();
        }
        if interrupted() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}
