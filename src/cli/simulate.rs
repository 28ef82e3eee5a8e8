//! `tangency simulate MODEL`: simulates a model and saves the time history.

use super::error::CommandError;
use super::request::value;
use super::results::Results;
use super::scene_at::{OutFolder, SceneAt};
use super::signals;
use super::sources::Sources;
use super::trace::states;
use super::warning::warn;
use super::watch::{Quiet, Telling, Watch};
use crate::output::Format;
use crate::scene::{Purpose, Request, Simulated};
use clap::Args;
use std::io::Write;
use std::path::Path;

/// The examples shown in the help of `simulate`.
const EXAMPLES: &str = "Examples:
  tangency simulate lorenz --from x=1 --time 40
  tangency simulate model.ron --set r=28 --transient 100 --time 20";

/// Simulate a model and save its history: curves in time, a phase portrait, and a table
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Simulate {
    #[command(flatten)]
    scene: SceneAt,
    #[command(flatten)]
    folder: OutFolder,
    /// The initial values of some states, by name; every other state starts at the initial value in
    /// the model, or at 0
    #[arg(long, value_name = "NAME=VALUE,…", value_parser = states)]
    from: Option<States>,
    /// The duration of the history; if there is a forcing, the unit of this duration is the forcing
    /// period
    #[arg(long, value_name = "TIME", default_value = "100", value_parser = value)]
    time: f64,
    /// The duration of the transient motion, which is simulated before the history begins
    #[arg(long, value_name = "TIME", default_value = "0", value_parser = value)]
    transient: f64,
    #[command(flatten)]
    quiet: Quiet,
}

/// The file formats in which a history is saved.
const FORMATS: [Format; 4] = [Format::Ron, Format::Svg, Format::Csv, Format::Npz];

/// Initial states, given by name. (The type is not a plain `Vec`, because Clap treats a `Vec` as a
/// repeated option.)
pub type States = Vec<(String, f64)>;

impl Simulate {
    /// Simulates the model, and saves and draws the history.
    pub fn run(&self, from: Sources, out: &mut impl Write) -> Result<(), CommandError> {
        let mut nowhere = std::io::sink();
        let mut out = self.quiet.stream(out, &mut nowhere);
        let state = self.from.clone().unwrap_or_default();
        let (transient, duration) = (self.transient, self.time);
        let simulated = Simulated { state, transient, duration, ..Simulated::default() };
        let (set, cancel) = (self.scene.settings.clone(), signals::token());
        let request = Request { set, cancel, ..Request::default() };
        let (name, scene) = self.scene.statement(from, &request)?;
        let at_fault = |cause| self.scene.at_fault(cause);
        let scene = scene.simulating(&request, simulated).map_err(at_fault)?;
        let changed = request.set.iter().map(|(name, _)| name.as_str());
        scene.check_effects(changed, Purpose::Runs, None).map_err(at_fault)?;
        let resolution = scene.resolve(None).map_err(at_fault)?;
        let inputs: Vec<&Path> = self.scene.inputs(&scene).collect();
        // The file names differ from those written by `trace`.
        let name = format!("{name}-history");
        signals::handle();
        let results = Results::claim(&self.folder.out, &name, &FORMATS, &inputs)?;
        resolution.warnings().iter().for_each(|warning| warn(warning));
        let mut watch = Watch::new(&mut out, Telling::USUAL);
        let outcome = resolution.trace(&mut watch);
        watch.finish()?;
        outcome.error.map_or(Ok(()), |cause| Err(self.scene.stopped(cause)))?;
        let files = results.save(Some(&outcome.document), None)?;
        Ok(files.iter().try_for_each(|path| writeln!(out, "{}", path.display()))?)
    }
}
