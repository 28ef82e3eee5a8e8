//! `tangency manifolds MODEL`: computes the stable and unstable manifolds of a saddle of a map.

use super::error::CommandError;
use super::request::RequestArgs;
use super::request::{range, value};
use super::results::Results;
use super::scene_at::{OutFolder, SceneAt};
use super::signals;
use super::sources::Sources;
use super::trace::{Begin, start};
use super::warning::warn;
use crate::core::continuation::Branch;
use crate::core::manifold::ManifoldSettings;
use crate::output::{Format, significant};
use crate::scene::{self, DEVIATION, Purpose, Range, Request};
use clap::Args;
use std::io::Write;
use std::path::Path;

/// The examples shown in the help of `manifolds`.
const EXAMPLES: &str = "Examples:
  tangency manifolds henon.ron --start x=0.6,y=0.2
  tangency manifolds henon.ron --start out/henon.ron:1 --length 40
  tangency manifolds henon.ron --set iterates=2 --start x=1,y=-0.1 --bound x=-2..2";

/// Draw the stable and unstable manifolds of a saddle of a map with two states
///
/// The saddle is a fixed point, or a cycle of `iterates` iterates. Each half of a manifold is
/// computed outward from the saddle. For each half, the command prints the reason why the half
/// ends, and the largest distance (`deviation`) between the curve and the images of the points on
/// the curve.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Manifolds {
    #[command(flatten)]
    scene: SceneAt,
    #[command(flatten)]
    folder: OutFolder,
    /// The start of the search for the saddle: given states, or a special point of an earlier
    /// result [default: the initial state of the model]
    #[arg(long, value_name = "NAME=VALUE,… or FILE:LABEL or FILE:BRANCH/LABEL", value_parser = start)]
    start: Option<Begin>,
    /// The maximum arclength of a manifold on each side of the saddle, in units of the states'
    /// scales
    #[arg(long, value_name = "LENGTH", default_value = "20", value_parser = value)]
    length: f64,
    /// The maximum distance between the manifold and the chords between its computed points, in
    /// units of the states' scales
    #[arg(long, value_name = "DISTANCE", default_value = "1e-4", value_parser = value)]
    resolution: f64,
    /// The maximum number of points of a manifold on each side of the saddle
    #[arg(long, value_name = "COUNT", default_value_t = 20_000)]
    max_points: usize,
    /// End a manifold where a state leaves the given range
    #[arg(long, value_name = "NAME=LOW..HIGH", value_parser = range)]
    bound: Vec<Range>,
}

/// The file formats in which manifolds are saved.
const FORMATS: [Format; 3] = [Format::Ron, Format::Svg, Format::Csv];

impl Manifolds {
    /// Computes the manifolds, saves them, and draws them.
    pub fn run(&self, from: Sources, out: &mut impl Write) -> Result<(), CommandError> {
        let (state, point) = match &self.start {
            None => (Vec::new(), None),
            Some(Begin::In(state)) => (state.clone(), None),
            Some(Begin::At(point)) => (Vec::new(), Some(point)),
            Some(Begin::Everywhere) => return Err(CommandError::OneSaddle),
        };
        let (set, bounds, cancel) =
            (self.scene.settings.clone(), self.bound.clone(), signals::token());
        let request = Request { set, bounds, state, cancel, ..Request::default() };
        let (name, scene) = self.scene.statement(from, &request)?;
        let at_fault = |cause| self.scene.at_fault(cause);
        let changed = request.set.iter().map(|(name, _)| name.as_str());
        scene.check_effects(changed, Purpose::Runs, None).map_err(at_fault)?;
        let start = point
            .map(|point| point.point(from.limit, &self.scene.settings, &RequestArgs::default()));
        let &Manifolds { length, resolution, max_points, .. } = self;
        let settings =
            ManifoldSettings { length, resolution, max_points, ..ManifoldSettings::default() };
        let wanted = scene::Manifolds { start: start.transpose()?, settings };
        let inputs: Vec<&Path> =
            self.scene.inputs(&scene).chain(point.map(|point| point.file.as_path())).collect();
        signals::handle();
        let name = format!("{name}-manifolds");
        let results = Results::claim(&self.folder.out, &name, &FORMATS, &inputs)?;
        let document = scene.clone().manifolds(&request, &wanted).map_err(at_fault)?;
        let mut warned = document.branches.iter().flat_map(|branch| &branch.warnings);
        warned.next().into_iter().for_each(|warning| warn(warning));
        document.branches.iter().try_for_each(|branch| describe(branch, out))?;
        let files = results.save(Some(&document), None)?;
        files.iter().try_for_each(|path| writeln!(out, "{}", path.display()))?;
        if signals::interrupted() { Err(CommandError::Interrupted) } else { Ok(()) }
    }
}

/// Describes a manifold in three lines: its multiplier, and for each half the reason why the half
/// ends.
fn describe(branch: &Branch, out: &mut impl Write) -> std::io::Result<()> {
    let [back, saddle, forth] = &branch.special[..] else { return Ok(()) };
    let multiplier = saddle.eigenvalues.first().map_or(f64::NAN, |multiplier| multiplier.0);
    let at: Vec<String> = saddle.monitors.iter().take(2).map(|x| significant(*x, 12)).collect();
    let multiplier = significant(multiplier, 12);
    writeln!(
        out,
        "{}: {} ({}), multiplier {multiplier}",
        branch.name,
        saddle.event,
        at.join(", ")
    )?;
    let points = [saddle.after, forth.after - saddle.after];
    for ((end, reason), points) in [back, forth].into_iter().zip(&branch.ends).zip(points) {
        let length = end.monitors.last().map_or(0.0, |length| length.abs());
        let number = end.number(DEVIATION).map(|number| significant(number.value, 2));
        let deviation = number.map_or(String::new(), |number| format!(", deviation {number}"));
        let length = significant(length, 6);
        writeln!(out, "  arclength {length}, {points} points{deviation}; {reason}")?;
    }
    Ok(())
}
