//! The commands `tangency sweep SCENE` and `tangency merge FILE…`: brute-force sweeps with
//! checkpoints.

use super::error::CommandError;
use super::grid::axis;
use super::results::Results;
use super::scene_at::{OutFolder, SceneAt};
use super::signals::{self, interrupted};
use super::simulate::States;
use super::sources::Sources;
use super::trace::states;
use super::warning::warn;
use super::watch::{Quiet, Telling, Watch, announce, bar};
use crate::core::sweep::{Found, Part};
use crate::output::{Document, FileError, Format, SweepTable, Sweeps, merge, printable};
use crate::scene::{
    Division, Grid, Purpose, Request, Scene, SweepForecast, SweepWatch, Swept, execute, sweep,
};
use clap::Args;
use indicatif::ProgressBar;
use std::io::Write;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The examples shown in the help of `sweep`.
const EXAMPLES: &str = "Examples:
  tangency sweep mita-chatter
  tangency sweep oscillator.ron --over f=8..14:121 --both --measure max_x
  tangency sweep model.ron --set max_step=0.01 --threads 4
  tangency sweep model.ron --part 2/8 --out parts && tangency merge parts/*.npz";

/// Find the attractors of a model over ranges of parameters and initial states, on all cores
///
/// Finished runs are saved at intervals; repeat the command to resume an interrupted sweep.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Sweep {
    #[command(flatten)]
    scene: SceneAt,
    #[command(flatten)]
    folder: OutFolder,
    /// Sweep over these values of a parameter or an initial state, instead of running the sweeps
    /// that the scene contains; repeat the option for a grid of values
    #[arg(long, value_name = "NAME=LOW..HIGH:COUNT", value_parser = axis)]
    over: Vec<Grid>,
    /// Run two sweeps over the values of one parameter: one sweep upward and one sweep downward
    #[arg(long, requires = "over")]
    both: bool,
    /// The initial values of some states, by name; all other states start at 0
    #[arg(long, value_name = "NAME=VALUE,…", value_parser = states, requires = "over")]
    from: Option<States>,
    /// The event just after which the motion of a model without forcing is sampled
    #[arg(long, value_name = "EVENT", requires = "over")]
    at: Option<String>,
    /// Record the named monitors, such as max_x, in every period, and draw the first of these
    /// monitors
    #[arg(long, value_name = "NAME,…", value_delimiter = ',', requires = "over")]
    measure: Vec<String>,
    /// Compute only part K of N parts of the sweep; `tangency merge` joins the parts
    #[arg(long, value_name = "K/N", value_parser = share)]
    part: Option<Part>,
    /// The number of threads [default: the number of cores]
    #[arg(long, value_name = "N", value_parser = threads)]
    threads: Option<NonZeroUsize>,
    /// The interval, in seconds, between two checkpoints at which finished runs are saved; the
    /// interval may be 0 to 1e6
    #[arg(long, value_name = "SECONDS", default_value = "5", value_parser = seconds)]
    checkpoint: Duration,
    /// Discard the saved results of earlier runs of the sweep, and start the sweep again
    #[arg(long)]
    afresh: bool,
    #[command(flatten)]
    quiet: Quiet,
}

/// Join the parts of a sweep
#[derive(Debug, Args)]
pub struct Merge {
    /// The files (.npz) of all parts of the sweep
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// The folder in which the joined sweep is saved
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
}

/// Parses `K/N`.
pub fn share(text: &str) -> Result<Part, String> {
    let part = text.split_once('/').and_then(|(number, of)| {
        let (number, of) = (number.parse().ok()?, of.parse().ok()?);
        (number >= 1 && number <= of).then_some(Part { number, of, ..Part::WHOLE })
    });
    part.ok_or_else(|| format!("the part `{text}` is not of the form K/N, for example 2/8"))
}

/// The maximum interval between checkpoints, in seconds.
const LONGEST: f64 = 1e6;

/// Parses a number of seconds between 0 and [`LONGEST`].
fn seconds(text: &str) -> Result<Duration, String> {
    let number = text.trim().parse().ok().filter(|seconds| (0.0..=LONGEST).contains(seconds));
    number.map(Duration::from_secs_f64).ok_or_else(|| {
        format!(
            "the interval between checkpoints must be a number of seconds between 0 and \
                 {LONGEST:e}, for example 5"
        )
    })
}

impl Sweep {
    /// Returns the name of the results, and the scene with its own sweeps, or with the sweep given
    /// by `--over` instead.
    fn read(&self, from: Sources, request: &Request) -> Result<(String, Scene), CommandError> {
        if self.over.is_empty() {
            return self.scene.read(from, request, Purpose::Sweeps);
        }
        let (name, scene) = self.scene.statement(from, request)?;
        let swept = Swept {
            over: self.over.clone(),
            both: self.both,
            start: self.from.clone().unwrap_or_default(),
            at: self.at.clone(),
            measures: self.measure.clone(),
        };
        let changed = request.set.iter().map(|(name, _)| name.as_str());
        let scene = scene.sweeping(request, swept).and_then(|scene| {
            scene.check_effects(changed, Purpose::Sweeps, None)?;
            Ok(scene)
        });
        // The file names differ from those written by `trace`.
        Ok((format!("{name}-sweep"), scene.map_err(|cause| self.scene.at_fault(cause))?))
    }

    /// Computes, saves and draws the sweeps of a scene. Finished runs of a sweep are saved even
    /// after an error or Ctrl-C.
    pub fn run(&self, from: Sources, out: &mut impl Write) -> Result<(), CommandError> {
        let mut nowhere = std::io::sink();
        let mut out = self.quiet.stream(out, &mut nowhere);
        let (set, cancel) = (self.scene.settings.clone(), signals::token());
        let request = Request { set, cancel, ..Request::default() };
        let (name, scene) = self.read(from, &request)?;
        if scene.sweeps.is_empty() {
            return Err(CommandError::NoSweep { scene: self.scene.scene.clone() });
        }
        scene.check_plot().map_err(|cause| self.scene.at_fault(cause))?;
        let (result, endings) = match self.part {
            None => (name.clone(), &WHOLE[..]),
            Some(Part { number, of, .. }) => {
                (format!("{name}.part-{number}-of-{of}"), &[Format::Npz][..])
            }
        };
        let inputs: Vec<&Path> = self.scene.inputs(&scene).collect();
        signals::handle();
        let results = Results::claim(&self.folder.out, &result, endings, &inputs)?;
        let path = results.path(Format::Npz);
        let known = path.exists() && !self.afresh;
        let known = known.then(|| Sweeps::load_within(from.limit, &path)).transpose()?;
        if let Some(known) = &known {
            scene.check_known(known).map_err(|cause| self.scene.at_fault(cause))?;
        }
        if let Some(part) = self.part {
            divided(&scene, part, &mut out)?;
        }
        let traced = self.part.is_none().then_some(&scene);
        let document = trace(traced, &self.scene.scene, &mut out)?;
        let kept = Kept { results: &results, document };
        let part = Part { threads: self.threads, ..self.part.unwrap_or(Part::WHOLE) };
        let (every, bar, saved) = (self.checkpoint, bar(), Instant::now());
        let mut keeper =
            Keeper { sweep: String::new(), kept, bar, saved, every, pause: every, failure: None };
        let swept = sweep(&scene, &name, part, known, &mut keeper);
        keeper.bar.finish_and_clear();
        let sweeps = swept.map_err(|cause| self.scene.at_fault(cause))?;
        let kept = keeper.kept.end(&sweeps, &mut out);
        if self.quiet.quiet {
            let failed = sweeps.sweeps.iter().filter(|table| failures(table) > 0);
            failed.for_each(|table| warn(&summary(table)));
        }
        keeper.failure.map_or(Ok(()), Err)?;
        match kept {
            // There may not be enough data to draw yet.
            Ok(()) | Err(CommandError::Figure { .. }) if interrupted() => {
                Err(CommandError::Interrupted)
            }
            kept => kept,
        }
    }
}

/// Traces the branches of a scene, if it has branches, to draw them together with the sweeps.
fn trace(
    scene: Option<&Scene>,
    place: &str,
    out: &mut impl Write,
) -> Result<Option<Document>, CommandError> {
    let mut watch = Watch::new(out, Telling::USUAL);
    let Some(scene) = scene.filter(|scene| !scene.runs.is_empty()) else {
        watch.finish()?;
        return Ok(None);
    };
    let outcome = execute(scene, None, &mut watch);
    watch.finish()?;
    match outcome.error {
        Some(cause) => Err(CommandError::Scene { place: place.into(), cause: Box::new(cause) }),
        None => Ok(Some(outcome.document).filter(|document| !document.branches.is_empty())),
    }
}

impl Merge {
    /// Joins the parts of a sweep, traces the branches of their scene, and saves and draws the
    /// result.
    pub fn run(&self, from: Sources, out: &mut impl Write) -> Result<(), CommandError> {
        let parts = self.files.iter().map(|file| Sweeps::load_within(from.limit, file));
        let whole = merge(parts.collect::<Result<Vec<_>, FileError>>()?).map_err(|cause| {
            let part = cause.part().and_then(|number| self.files.get(number - 1));
            let files = part.map_or(&self.files[..], std::slice::from_ref);
            CommandError::Merge { files: super::error::named(files), cause }
        })?;
        let inputs: Vec<&Path> = self.files.iter().map(PathBuf::as_path).collect();
        signals::handle();
        let results = Results::claim(&self.out, &whole.name, &WHOLE, &inputs)?;
        let place = format!("the scene of {}", self.files[0].display());
        let scene = from.catalogue.parse_alone(&whole.scene);
        let mut scene = scene.map_err(|cause| CommandError::Scene {
            place: place.clone(),
            cause: Box::new(cause),
        })?;
        scene.settings.cancel = signals::token();
        // The joined sweep is saved even if the branches cannot be traced.
        let (document, failure) = match trace(Some(&scene), &place, out) {
            Ok(document) => (document, None),
            Err(failure) => (None, Some(failure)),
        };
        if interrupted() {
            return Err(CommandError::Interrupted);
        }
        Kept { results: &results, document }.end(&whole, out)?;
        failure.map_or(Ok(()), Err)
    }
}

/// The file formats in which a complete sweep is saved.
const WHOLE: [Format; 3] = [Format::Ron, Format::Npz, Format::Svg];

/// The files of a sweep: its archive, and the branches and the picture that belong to the sweep.
struct Kept<'a> {
    results: &'a Results,
    document: Option<Document>,
}

impl Kept<'_> {
    /// Saves the sweeps, and prints a report and the paths of the saved files.
    fn end(&self, sweeps: &Sweeps, out: &mut impl Write) -> Result<(), CommandError> {
        let saved = self.results.save(self.document.as_ref(), Some(sweeps));
        // The report explains a missing picture if all runs failed.
        report(sweeps, out)?;
        let files = saved?;
        Ok(files.iter().try_for_each(|path| writeln!(out, "{}", path.display()))?)
    }
}

/// Parses a number of threads.
fn threads(text: &str) -> Result<NonZeroUsize, String> {
    let count = text.trim().parse().ok();
    count.ok_or_else(|| "the number of threads must be a whole number of at least 1".into())
}

/// Warns if the runs of a sweep cannot be divided evenly into parts, because a strand (a sequence
/// in which each run begins where the preceding run ended) cannot be divided; suggests another
/// number of strands.
fn divided(scene: &Scene, part: Part, out: &mut impl Write) -> Result<(), CommandError> {
    let division = scene.division(part.of);
    if division.is_even() {
        return Ok(());
    }
    let Division { parts, strands, runs, largest } = division;
    let even = division.even();
    writeln!(
        out,
        "{strands} strand{} (sequences of runs, each starting where the run before ended) cannot \
         be divided evenly into {parts} parts: the largest part has {largest} of {runs} runs \
         instead of {even}",
        if strands == 1 { "" } else { "s" }
    )?;
    if let Some((strands, largest)) = scene.better_strands(part.of) {
        writeln!(
            out,
            "to reduce the largest part to {largest} runs, add `--set strands={strands}` to the \
             commands of all parts; the results may change, because each strand begins at the \
             initial state"
        )?;
    }
    Ok(())
}

/// Prints a line of results for each sweep, and warns of runs that did not settle.
fn report(sweeps: &Sweeps, out: &mut impl Write) -> Result<(), CommandError> {
    for table in &sweeps.sweeps {
        writeln!(out, "{}", summary(table))?;
        let (unsettled, runs) = (table.unsettled(), table.rows.len());
        if unsettled > 0 {
            warn(&format!(
                "{}: {unsettled} of {runs} runs did not settle on a cycle: increase `transient` \
                 or `max_period`, unless the motions are chaotic or quasi-periodic",
                table.name
            ));
        }
    }
    Ok(())
}

/// Returns the number of failed runs of a sweep.
fn failures(table: &SweepTable) -> usize {
    table.rows.values().filter(|row| row.failure.is_some()).count()
}

/// Describes the results of a sweep in one line: the numbers of finished and failed runs.
fn summary(table: &SweepTable) -> String {
    let SweepTable { name, rows, total, .. } = table;
    let mut line = format!("{name}: {} of {total} runs", rows.len());
    if let Some((run, why)) = rows.iter().find_map(|(run, row)| Some((run, row.failure.as_ref()?)))
    {
        let (failed, why) = (failures(table), printable(why));
        line +=
            &format!("; number of failed runs: {failed}; the first failed run is run {run}: {why}");
    }
    line
}

/// Saves finished runs at intervals, and shows the progress of the sweep.
struct Keeper<'a> {
    /// The current sweep.
    sweep: String,
    kept: Kept<'a>,
    bar: ProgressBar,
    saved: Instant,
    /// The minimum interval between two checkpoints.
    every: Duration,
    /// The current interval between checkpoints: at least 20 times the time that saving takes.
    pause: Duration,
    failure: Option<CommandError>,
}

impl SweepWatch for Keeper<'_> {
    fn begin(&mut self, sweep: &SweepTable) {
        self.sweep = sweep.name.clone();
        self.bar.set_length(sweep.total as u64);
        self.bar.set_position(sweep.rows.len() as u64);
        let SweepTable { name, rows, total, .. } = sweep;
        self.bar.set_message(format!("{} of {total} runs of {name}", rows.len()));
    }

    fn work(&mut self, work: &SweepForecast) {
        let &SweepForecast { runs, periods, threads, time } = work;
        let threads = if threads == 1 { "1 thread".into() } else { format!("{threads} threads") };
        let what = format!("{runs} runs of up to {periods} periods, on {threads},");
        let remedy = "Ctrl-C keeps the finished runs; repeat the command to resume the sweep";
        announce(&self.bar, &self.sweep, &what, time, remedy);
    }

    fn found(&mut self, known: &Sweeps, _found: &Found) {
        self.bar.inc(1);
        let done: usize = known.sweeps.iter().map(|sweep| sweep.rows.len()).sum();
        let total: usize = known.sweeps.iter().map(|sweep| sweep.total).sum();
        self.bar.set_message(format!("{done} of {total} runs"));
        if self.saved.elapsed() >= self.pause {
            let begin = Instant::now();
            match self.kept.results.save(self.kept.document.as_ref(), Some(known)) {
                // There may not be enough data to draw yet.
                Ok(_) | Err(CommandError::Figure { .. }) => {}
                Err(error) => {
                    self.failure = Some(error);
                    signals::token().cancel();
                    return;
                }
            }
            self.pause = self.every.max(20 * begin.elapsed());
            self.saved = Instant::now();
        }
    }
}
