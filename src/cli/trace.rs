//! `tangency trace SCENE`: traces the branches of a scene, and saves and draws them.

use super::compare::{check, fraction};
use super::error::CommandError;
use super::grid::{Design, GridArgs, Traced};
use super::request::{RequestArgs, Within, value};
use super::results::Results;
use super::scene_at::{OutFolder, SceneAt, setting};
use super::signals;
use super::sources::Sources;
use super::warning::warn;
use super::watch::{Telling, Watch};
use crate::core::continuation::Branch;
use crate::core::ode::{Work, work};
use crate::output::{Document, Format, SizeLimit, Summary};
use crate::scene::{Following, Purpose, Request, Scene, StartPoint, Stated};
use clap::Args;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The examples shown in the help of `trace`.
const EXAMPLES: &str = "Examples:
  tangency trace lorenz
  tangency trace model.ron --along r=0..30 --switch all
  tangency trace model.ode --along I=0..4 --settle 500 --bound period=..200 --mark I=2
  tangency trace model.ron --along r=0..30 --along s=5..20 --hold HB
  tangency trace model.ron --along r=0..30 --along s=5..20 --hold HB --switch all --depth 2 --regions
  tangency trace lorenz --start out/lorenz.ron:3 --set s=12 --out s12
  tangency trace lorenz --check reference.ron --strict
  tangency trace plate-device --grid gap=1e-6..4e-6:20 --grid thickness=1e-6..4e-6:10";

/// Trace a scene or a model, and save its branches
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Trace {
    #[command(flatten)]
    wanted: Wanted,
    #[command(flatten)]
    folder: OutFolder,
    /// Compare the result with an earlier document, as the command `tangency compare` does
    #[arg(long, value_name = "FILE")]
    check: Option<PathBuf>,
    /// Allow values to differ from the earlier document by this fraction of the largest value in
    /// their column, in addition to their errors
    #[arg(long, value_name = "FRACTION", default_value = "0", value_parser = fraction,
        requires = "check")]
    allow: f64,
    /// In the picture, label the two sides of each curve in two parameters with the numbers of
    /// unstable directions
    #[arg(long)]
    regions: bool,
    /// Exit with the code 3 if a special point has not converged, or if a branch ends unexpectedly
    #[arg(long)]
    strict: bool,
    #[command(flatten)]
    grid: GridArgs,
    #[command(flatten)]
    telling: Telling,
}

/// Print the scene file equivalent to a `trace` command, ready to edit
#[derive(Debug, Args)]
pub struct Show {
    #[command(flatten)]
    wanted: Wanted,
}

/// A scene and the request that is applied to it.
#[derive(Debug, Args)]
struct Wanted {
    #[command(flatten)]
    scene: SceneAt,
    /// The start of the branch: given states, a special point of an earlier result, or `all` to
    /// start a branch at each solution in the box of --box
    #[arg(long, value_name = "NAME=VALUE,… or FILE:LABEL or FILE:BRANCH/LABEL or all", value_parser = start)]
    start: Option<Begin>,
    #[command(flatten)]
    within: Within,
    #[command(flatten)]
    request: RequestArgs,
}

/// The argument of the option `--start`.
#[derive(Clone, Debug, PartialEq)]
pub enum Begin {
    /// Branches start at states given by name.
    In(Vec<(String, f64)>),
    /// Branches start at a special point of a document.
    At(Start),
    /// Branches start at all solutions in a box.
    Everywhere,
}

impl Trace {
    /// Traces the scene. Finished parts of branches are saved and drawn even after an error or
    /// Ctrl-C.
    pub fn run(&self, from: Sources, out: &mut impl Write) -> Result<(), CommandError> {
        let Wanted { scene: at, request, .. } = &self.wanted;
        if self.wanted.start_point().is_some() && request.settle.is_some() {
            return Err(CommandError::NotTogether("--settle"));
        }
        if !self.grid.grid.is_empty() {
            return self.run_grid(from, out);
        }
        let (asked, purpose) = self.wanted.request(from.limit, &[])?;
        let (name, scene) = at.read(from, &asked, purpose)?;
        at.check_runs(&scene)?;
        let start = asked.start.as_deref();
        let reference = self.check.as_ref().map(|path| Document::load_within(from.limit, path));
        let reference = reference.transpose()?;
        if start.is_none() {
            scene.check_plot().map_err(|cause| at.at_fault(cause))?;
        }
        let resolution = scene.resolve(start).map_err(|cause| at.at_fault(cause))?;
        let inputs = self.inputs(&scene);
        signals::handle();
        let results =
            Results::claim(&self.folder.out, &name, &[Format::Ron, Format::Svg], &inputs)?;
        let said = resolution.warnings();
        said.iter().for_each(|warning| warn(warning));
        let mut nowhere = std::io::sink();
        let told = self.telling.quiet.stream(&mut *out, &mut nowhere);
        let mut watch = Watch::new(&mut *told, self.telling);
        let switches = start.is_some_and(|start| start.switch);
        let following = request.following(self.wanted.begins_everywhere());
        // The first branch switched at a saved point belongs to the first generation.
        let following =
            following.and_then(|it| if switches { it.next_generation() } else { Some(it) });
        let mut outcome = match &following {
            Some(following) => resolution.explore(following, &mut watch).1,
            None => resolution.trace(&mut watch),
        };
        let watched = watch.finish();
        outcome.document.plot.regions |= self.regions;
        let saved = match outcome.document.branches.is_empty() {
            true => Ok(()),
            false => save(&results, &outcome.document, &said, told),
        };
        // The error of the scene takes precedence over errors in saving or drawing.
        match outcome.error {
            Some(cause) => return Err(at.stopped(scene.blame_on(&at.settings, cause))),
            None => match saved {
                // After an interruption, the figure may refer to branches that were not computed.
                Err(CommandError::Figure { .. }) if matches!(watched, Ok(true)) => {}
                saved => saved?,
            },
        }
        if watched? {
            return Err(CommandError::Interrupted);
        }
        if let (Some(place), Some(reference)) = (&self.check, reference) {
            check((place, &reference), &outcome.document, self.allow, out)?;
        }
        let branches = outcome.document.branches.iter();
        self.doubt(branches.flat_map(|branch| Summary(branch).doubts()).collect())
    }

    /// Traces the scene at every point of a grid of settings.
    fn run_grid(&self, from: Sources, out: &mut dyn Write) -> Result<(), CommandError> {
        let Wanted { scene: at, request, .. } = &self.wanted;
        let of_grid =
            |(name, _): &(String, String)| self.grid.grid.iter().any(|it| it.name == *name);
        let options = [
            ("--start FILE:LABEL", self.wanted.start_point().is_some()),
            ("--check", self.check.is_some()),
            ("--regions", self.regions),
            ("--verbose", self.telling.verbose),
            ("--wide", self.telling.wide),
        ];
        if let Some((name, _)) = at.settings.iter().find(|it| of_grid(it)) {
            return Err(CommandError::SetInGrid(name.clone()));
        }
        if let Some((option, _)) = options.into_iter().find(|(_, given)| *given) {
            return Err(CommandError::NotInGrid(option));
        }
        // Files are read once: all designs share the same statement.
        let (name, stated) = at.stated(from)?;
        let stated = stated.map_err(|cause| at.at_fault(cause))?;
        let read = |design: &Design| {
            let (request, purpose) = self.wanted.request(from.limit, design)?;
            let scene = at.requested(stated.clone(), &name, &request, purpose)?;
            at.check_runs(&scene)?;
            scene.resolve(None).map_err(|cause| at.at_fault(cause))
        };
        let following = request.following(self.wanted.begins_everywhere());
        let trace = |design: &Design| {
            let resolution = read(design)?;
            Ok(match &following {
                Some(following) => resolution.explore(following, &mut ()).1,
                None => resolution.trace(&mut ()),
            })
        };
        let designs = self.grid.designs()?;
        // Most errors of a single design occur in all designs, so the first design is checked
        // early.
        let first = read(&designs[0])?;
        let statement = match &stated {
            Stated::Model(problem) => problem.equations(),
            Stated::Scene(scene) => scene.to_ron(),
        };
        let (stated_request, _) = self.wanted.request(from.limit, &[])?;
        let options = stated_request.options().into_iter();
        let options = options.chain(following.iter().flat_map(Following::options));
        let asked: String =
            options.map(|(option, value)| format!("// {option} {value}\n")).collect();
        let traced = Traced {
            designs,
            folder: self.folder.out.join(&name),
            made_of: format!("// tangency {}\n{asked}{statement}\n", env!("CARGO_PKG_VERSION")),
            inputs: &self.inputs(first.scene()),
            warnings: first.warnings(),
            limit: from.limit,
        };
        let mut nowhere = std::io::sink();
        let told = self.telling.quiet.stream(out, &mut nowhere);
        self.doubt(self.grid.run(traced, trace, told)?)
    }

    /// Returns an error if some results are doubtful and `--strict` is given.
    fn doubt(&self, doubts: Vec<String>) -> Result<(), CommandError> {
        if self.strict && !doubts.is_empty() { Err(CommandError::Doubts(doubts)) } else { Ok(()) }
    }

    /// Returns the input files, which results must not replace: the scene, the document of
    /// `--start` and the reference document.
    fn inputs<'a>(&'a self, scene: &'a Scene) -> Vec<&'a Path> {
        let start = self.wanted.start_point().map(|start| start.file.as_path());
        self.wanted.scene.inputs(scene).chain(start).chain(self.check.as_deref()).collect()
    }
}

impl Wanted {
    /// Returns the request, extended by the settings of a design of the grid.
    fn request(
        &self,
        limit: SizeLimit,
        design: &[(String, String)],
    ) -> Result<(Request, Purpose), CommandError> {
        let state = match &self.start {
            Some(Begin::In(state)) => &state[..],
            _ => &[],
        };
        let purpose = match self.request.switch {
            Some(_) => Purpose::Exploration,
            None => Purpose::Runs,
        };
        let within = self.within.search();
        if within.is_some() != self.begins_everywhere() {
            return Err(CommandError::Everywhere);
        }
        let settings = [&self.scene.settings, design].concat();
        let request = self.request.request(&settings, state);
        let point = |start: &Start| start.point(limit, &settings, &self.request).map(Box::new);
        let start = self.start_point().map(point).transpose()?;
        Ok((Request { within, start, ..request }, purpose))
    }

    /// Returns whether branches start at all solutions in a box.
    fn begins_everywhere(&self) -> bool {
        self.start == Some(Begin::Everywhere)
    }

    /// Returns the special point at which branches start, if one is given.
    fn start_point(&self) -> Option<&Start> {
        match &self.start {
            Some(Begin::At(start)) => Some(start),
            _ => None,
        }
    }
}

/// Saves and draws the branches, and prints the reason why each branch ended. Warnings that were
/// printed during the computation are not repeated.
fn save(
    results: &Results,
    document: &Document,
    said: &[String],
    out: &mut dyn Write,
) -> Result<(), CommandError> {
    let files = results.save(Some(document), None)?;
    for branch @ Branch { name, warnings, .. } in &document.branches {
        writeln!(out, "{}", Summary(branch))?;
        let new = warnings.iter().filter(|warning| !said.contains(warning));
        new.for_each(|warning| warn(&format!("{name}: {warning}")));
    }
    if let Some(chosen) = &document.chosen {
        writeln!(out, "{chosen}")?;
    }
    let Work { evaluations, time } = work();
    if evaluations > 0 {
        writeln!(
            out,
            "flows: {evaluations} evaluations of the vector field, {time:.1} time units integrated"
        )?;
    }
    Ok(files.iter().try_for_each(|path| writeln!(out, "{}", path.display()))?)
}

impl Show {
    /// Prints the scene; with `--switch` or `--start all`, the scene is traced first.
    pub fn run(&self, from: Sources, out: &mut impl Write) -> Result<(), CommandError> {
        let Wanted { scene: at, request, .. } = &self.wanted;
        let everywhere = self.wanted.begins_everywhere();
        if self.wanted.start_point().is_some() {
            return Err(CommandError::NotTogether("`tangency show`"));
        }
        let (asked, purpose) = self.wanted.request(from.limit, &[])?;
        let (_, scene) = at.read(from, &asked, purpose)?;
        let Some(following) = request.following(everywhere) else {
            return Ok(writeln!(out, "{}", scene.to_ron())?);
        };
        let resolution = scene.resolve(None).map_err(|cause| at.at_fault(cause))?;
        let (scene, outcome) = resolution.explore(&following, &mut ());
        writeln!(out, "{}", scene.to_ron())?;
        for Branch { name, warnings, .. } in &outcome.document.branches {
            warnings.iter().for_each(|warning| warn(&format!("{name}: {warning}")));
        }
        outcome.error.map_or(Ok(()), |cause| Err(at.stopped(cause)))
    }
}

impl Start {
    /// Returns the start point with some values changed, and the kind of the curve that starts at
    /// this point.
    pub(super) fn point(
        &self,
        limit: SizeLimit,
        set: &[(String, String)],
        request: &RequestArgs,
    ) -> Result<StartPoint, CommandError> {
        let document = Document::load_within(limit, &self.file)?;
        let (branch, special) = document
            .special_point(self.branch.as_deref(), self.label)
            .map_err(|cause| CommandError::Start { file: self.file.clone(), cause })?;
        let changed = set.iter().map(|(name, _)| name.clone()).collect();
        // Along a curve of special points, branches are switched at the points of the curve.
        let switch = request.switch.is_some() && request.hold.is_none();
        if switch && !request.following(false).is_some_and(|it| it.kinds.contains(&special.kind)) {
            let (label, kind) = (self.label, special.kind);
            return Err(CommandError::OtherKind { file: self.file.clone(), label, kind });
        }
        let point = StartPoint::of(&document, branch.clone(), special.label);
        Ok(StartPoint { changed, hold: request.hold, switch, ..point })
    }
}

/// A special point of a document, `FILE:LABEL` or `FILE:BRANCH/LABEL`, at which a branch starts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Start {
    /// The path of the document.
    pub file: PathBuf,
    /// The name of the branch; may be omitted if the label is unique in the document.
    pub branch: Option<String>,
    /// The label of the special point.
    pub label: usize,
}

/// Parses `NAME=VALUE,…`, a special point of a document, or the word `all`. In a special point
/// `FILE:BRANCH/LABEL`, the name of the branch may contain equals signs.
pub(super) fn start(text: &str) -> Result<Begin, String> {
    let of_file = of_file(text).and_then(|(file, point)| at(file, point));
    match of_file {
        Some(start) => Ok(Begin::At(start)),
        None if text == "all" => Ok(Begin::Everywhere),
        None if !text.contains('=') => point(text).map(Begin::At),
        None => states(text).map(Begin::In),
    }
}

/// Parses `NAME=VALUE,…`.
pub(super) fn states(text: &str) -> Result<Vec<(String, f64)>, String> {
    let mut depth = 0;
    // Commas within brackets belong to functions and to elements of arrays.
    let parts = text.split(|letter: char| {
        depth += i32::from(['(', '['].contains(&letter)) - i32::from([')', ']'].contains(&letter));
        letter == ',' && depth == 0
    });
    let one = |part: &str| {
        let (name, number) = setting(part)?;
        Ok((name, value(&number)?))
    };
    parts.map(one).collect()
}

/// Splits `FILE:POINT` at the first colon that follows the name of an existing file; names of files
/// and branches may contain colons.
fn of_file(text: &str) -> Option<(&str, &str)> {
    let mut parts = text.match_indices(':').map(|(at, _)| (&text[..at], &text[at + 1..]));
    parts.find(|(file, _)| Path::new(file).is_file())
}

/// Parses `LABEL` or `BRANCH/LABEL`, a special point of a document. The last slash separates the
/// branch from the label.
fn at(file: &str, point: &str) -> Option<Start> {
    let (branch, label) = match point.rsplit_once('/') {
        Some((branch, label)) => (Some(branch), label),
        None => (None, point),
    };
    let label = label.parse().ok().filter(|label| *label > 0)?;
    let named = !file.is_empty() && branch != Some("");
    named.then(|| Start { file: file.into(), branch: branch.map(String::from), label })
}

fn point(text: &str) -> Result<Start, String> {
    let start = text.rsplit_once(':').and_then(|(file, point)| at(file, point));
    start.ok_or_else(|| {
        format!(
            "the start `{text}` is not of the form NAME=VALUE,… or FILE:LABEL or \
             FILE:BRANCH/LABEL, for example x=1,y=2 or pull-in.ron:3; labels are counted from 1"
        )
    })
}
