//! `tangency trace SCENE`: traces a scene, saves its branches, draws them.

use super::compare::check;
use super::error::CommandError;
use super::request::{RequestArgs, Within, value};
use super::results::Results;
use super::signals;
use super::sources::Sources;
use super::warning::warn;
use super::watch::Watch;
use crate::core::continuation::Branch;
use crate::core::ode::{Work, work};
use crate::core::problem::UnknownName;
use crate::output::{Document, Format, SizeLimit, Summary, read, text_of};
use crate::scene::{Files, Problem, Purpose, Request, Scene, SceneError, StartPoint};
use clap::Args;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Examples in the help.
const EXAMPLES: &str = "Examples:
  tangency trace lorenz
  tangency trace model.ron --along r=0..30 --switch all
  tangency trace model.ode --along I=0..4 --settle 500 --bound period=..200
  tangency trace model.ron --along r=0..30 --along s=5..20 --hold HB
  tangency trace lorenz --start out/lorenz.ron:3 --set s=12 --out s12
  tangency trace lorenz --check reference.ron --strict";

/// Trace a scene or a model, and save its branches
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Trace {
    #[command(flatten)]
    wanted: Wanted,
    /// Compare the result with an earlier one, as `tangency compare` does
    #[arg(long, value_name = "FILE")]
    check: Option<PathBuf>,
    /// End with exit code 3 if a special point has not converged, or a branch ends unexpectedly
    #[arg(long)]
    strict: bool,
}

/// Print the scene that a command amounts to, to be edited
#[derive(Debug, Args)]
pub struct Show {
    #[command(flatten)]
    wanted: Wanted,
}

/// A scene with a request to it.
#[derive(Debug, Args)]
struct Wanted {
    #[command(flatten)]
    scene: SceneAt,
    /// Start in given states, from a special point of an earlier result, or, with `all`, from each
    /// solution in a box
    #[arg(long, value_name = "NAME=VALUE,… or FILE:LABEL or FILE:BRANCH/LABEL or all", value_parser = start)]
    start: Option<Begin>,
    #[command(flatten)]
    within: Within,
    #[command(flatten)]
    request: RequestArgs,
}

/// Where `--start` begins.
#[derive(Clone, Debug, PartialEq)]
pub enum Begin {
    /// In states by name.
    In(Vec<(String, f64)>),
    /// At a special point.
    At(Start),
    /// At all solutions in a box.
    Everywhere,
}

/// Which scene, with what changed in it, and where its results go.
#[derive(Debug, Args)]
pub struct SceneAt {
    /// The name of a scene (see `tangency scenes`), or the path of a scene, of equations in RON, or
    /// of an .ode file
    pub scene: String,
    /// Change a value of the scene; may be repeated
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = setting)]
    pub settings: Vec<(String, String)>,
    /// The folder for the results
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
}

/// What a file or a name stands for.
#[expect(clippy::large_enum_variant, reason = "there is one, for a moment")]
enum Stated {
    Model(Problem),
    Scene(Scene),
}

impl SceneAt {
    /// The name of the scene's results, and the scene that a request amounts to.
    pub fn read(
        &self,
        from: Sources,
        request: &Request,
        purpose: Purpose,
    ) -> Result<(String, Scene), CommandError> {
        let (name, stated) = self.stated(from)?;
        let scene = match stated {
            Ok(Stated::Model(_)) if purpose == Purpose::Sweeps => {
                return Err(CommandError::NoSweep { scene: self.scene.clone() });
            }
            Ok(Stated::Model(problem)) => Scene::of_model(problem, &name, request),
            Ok(Stated::Scene(scene)) => scene.requested(request),
            Err(cause) => Err(cause),
        };
        let scene = scene.and_then(|scene| {
            scene.check_effects(request.set.iter().map(|(name, _)| name.as_str()), purpose)?;
            Ok(scene)
        });
        Ok((name, scene.map_err(|cause| self.at_fault(cause))?))
    }

    /// The name of the scene's results, and the scene as it is stated; of a model, one without runs.
    pub fn statement(
        &self,
        from: Sources,
        request: &Request,
    ) -> Result<(String, Scene), CommandError> {
        let (name, stated) = self.stated(from)?;
        match stated.map_err(|cause| self.at_fault(cause))? {
            Stated::Model(problem) => {
                let scene = Scene::of_problem(problem, &name, request);
                Ok((name, scene))
            }
            Stated::Scene(scene) => Ok((name, scene)),
        }
    }

    /// The name of the scene's results, and the statement.
    fn stated(&self, from: Sources) -> Result<(String, Result<Stated, SceneError>), CommandError> {
        let (name, text) = self.text(from)?;
        let path = Path::new(&self.scene);
        if Problem::is_file_of_equations(path, &text) {
            return Ok((name, Problem::from_text(path, &text, &[]).map(Stated::Model)));
        }
        let folder = path.parent().unwrap_or(Path::new(""));
        let files = Files { folder, limit: from.limit };
        Ok((name, from.catalogue.parse_in(files, &text).map(Stated::Scene)))
    }

    /// What was read: the scene, and the file of its equations.
    pub fn inputs<'a>(&'a self, scene: &'a Scene) -> impl Iterator<Item = &'a Path> {
        [Path::new(&self.scene)].into_iter().chain(scene.problem.file())
    }

    /// Why the work stopped.
    pub fn stopped(&self, cause: SceneError) -> CommandError {
        match cause {
            SceneError::GivenUp { .. } => CommandError::Interrupted,
            cause => self.at_fault(cause),
        }
    }

    /// What is wrong with the scene.
    pub fn at_fault(&self, cause: SceneError) -> CommandError {
        CommandError::Scene { place: self.scene.clone(), cause: Box::new(cause) }
    }

    /// The name of the scene and its text: one of the catalogue, or a file.
    fn text(&self, from: Sources) -> Result<(String, String), CommandError> {
        let Sources { catalogue, limit } = from;
        if let Some(scene) = catalogue.scenes().iter().find(|scene| scene.name == self.scene) {
            return Ok((scene.name.clone(), scene.text.clone()));
        }
        let path = Path::new(&self.scene);
        let is_path = path.extension().is_some() || path.components().count() > 1;
        if !is_path && !path.exists() {
            let names = catalogue.scenes().iter().map(|scene| scene.name.as_str());
            let unknown = UnknownName::new("scene", &self.scene, names);
            return Err(CommandError::UnknownScene(unknown));
        }
        let bytes = read(path, limit)?;
        // Files of XPPAUT's may be older than UTF-8.
        let text = match Problem::is_file_of_equations(path, "") {
            true => String::from_utf8_lossy(&bytes).into_owned(),
            false => text_of(path, bytes)?,
        };
        Ok((path.file_stem().unwrap_or_default().to_string_lossy().into_owned(), text))
    }
}

impl Trace {
    /// Traces the scene. Whatever was traced is saved and drawn, also after an error or Ctrl-C.
    pub fn run(&self, from: Sources, out: &mut impl Write) -> Result<(), CommandError> {
        let Wanted { scene: at, request, .. } = &self.wanted;
        if self.wanted.start_point().is_some() && request.switch.is_some() {
            return Err(CommandError::NotTogether("--switch"));
        }
        let (name, scene) = self.wanted.read(from)?;
        if !scene.runs.iter().any(|run| run.shown) {
            return Err(CommandError::NoRun { scene: at.scene.clone() });
        }
        let start = self.wanted.start_point();
        let start = start.map(|start| start.point(from.limit, &at.settings)).transpose()?;
        let reference = self.check.as_ref().map(|path| Document::load_within(from.limit, path));
        let reference = reference.transpose()?;
        if start.is_none() {
            scene.check_plot().map_err(|cause| at.at_fault(cause))?;
        }
        let resolution = scene.resolve(start.as_ref()).map_err(|cause| at.at_fault(cause))?;
        let inputs = self.inputs(&scene);
        signals::handle();
        let results = Results::claim(&at.out, &name, &[Format::Ron, Format::Svg], &inputs)?;
        let said = resolution.warnings();
        said.iter().for_each(|warning| warn(warning));
        let mut watch = Watch::new(out);
        let outcome = match &request.following(self.wanted.begins_everywhere()) {
            Some(following) => resolution.explore(following, &mut watch).1,
            None => resolution.trace(&mut watch),
        };
        let watched = watch.finish();
        let saved = match outcome.document.branches.is_empty() {
            true => Ok(()),
            false => save(&results, &outcome.document, &said, out),
        };
        // What stopped the scene explains what cannot be saved or drawn, not the other way round.
        match outcome.error {
            Some(cause) => return Err(at.stopped(cause)),
            None => match saved {
                // A figure of branches that were not reached cannot be drawn.
                Err(CommandError::Figure { .. }) if matches!(watched, Ok(true)) => {}
                saved => saved?,
            },
        }
        if watched? {
            return Err(CommandError::Interrupted);
        }
        if let (Some(place), Some(reference)) = (&self.check, reference) {
            check(place, &reference, &outcome.document, out)?;
        }
        let branches = outcome.document.branches.iter();
        let doubts: Vec<String> = branches.flat_map(|branch| Summary(branch).doubts()).collect();
        if self.strict && !doubts.is_empty() { Err(CommandError::Doubts(doubts)) } else { Ok(()) }
    }

    /// The results must not replace the scene's file, the document that is started from, or the
    /// reference.
    fn inputs<'a>(&'a self, scene: &'a Scene) -> Vec<&'a Path> {
        let start = self.wanted.start_point().map(|start| start.file.as_path());
        self.wanted.scene.inputs(scene).chain(start).chain(self.check.as_deref()).collect()
    }
}

impl Wanted {
    /// The name of the results, and the scene.
    fn read(&self, from: Sources) -> Result<(String, Scene), CommandError> {
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
        let request = self.request.request(&self.scene.settings, state);
        self.scene.read(from, &Request { within, ..request }, purpose)
    }

    /// Whether branches begin at all solutions in a box.
    fn begins_everywhere(&self) -> bool {
        self.start == Some(Begin::Everywhere)
    }

    /// The special point to start from.
    fn start_point(&self) -> Option<&Start> {
        match &self.start {
            Some(Begin::At(start)) => Some(start),
            _ => None,
        }
    }
}

/// Saves and draws what was traced, and says how each branch ended. Warnings that were given before
/// are not repeated.
fn save(
    results: &Results,
    document: &Document,
    said: &[String],
    out: &mut impl Write,
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
        writeln!(out, "flows: {evaluations} evaluations of the field, a time of {time:.1}")?;
    }
    Ok(files.iter().try_for_each(|path| writeln!(out, "{}", path.display()))?)
}

impl Show {
    /// Writes the scene; with `--switch` or `--start all`, after tracing it.
    pub fn run(&self, from: Sources, out: &mut impl Write) -> Result<(), CommandError> {
        let Wanted { scene: at, request, .. } = &self.wanted;
        let everywhere = self.wanted.begins_everywhere();
        if self.wanted.start_point().is_some() {
            return Err(CommandError::NotTogether("`tangency show`"));
        }
        let (_, scene) = self.wanted.read(from)?;
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
    /// The point, at which some values are changed.
    fn point(
        &self,
        limit: SizeLimit,
        set: &[(String, String)],
    ) -> Result<StartPoint, CommandError> {
        let document = Document::load_within(limit, &self.file)?;
        let (branch, special) = document
            .special_point(self.branch.as_deref(), self.label)
            .map_err(|cause| CommandError::Start { file: self.file.clone(), cause })?;
        let changed = set.iter().map(|(name, _)| name.clone()).collect();
        Ok(StartPoint { changed, ..StartPoint::of(&document, branch.clone(), special.label) })
    }
}

/// `NAME=VALUE`, without blanks around name and value: what `--set` changes. The value may hold
/// further equals signs.
fn setting(text: &str) -> Result<(String, String), String> {
    match text.split_once('=').map(|(name, value)| (name.trim(), value.trim())) {
        Some((name, value)) if !name.is_empty() && !value.is_empty() => {
            Ok((name.into(), value.into()))
        }
        _ => Err(format!("`{text}` is not of the form NAME=VALUE, for example load=0.1")),
    }
}

/// `FILE:LABEL` or `FILE:BRANCH/LABEL`: where `--start` begins.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Start {
    /// The document.
    pub file: PathBuf,
    /// The branch; not needed where only one has the label.
    pub branch: Option<String>,
    /// The label of the special point.
    pub label: usize,
}

/// `NAME=VALUE,…`, or a special point: names of branches may hold equals signs, too.
fn start(text: &str) -> Result<Begin, String> {
    let of_file = of_file(text).and_then(|(file, point)| at(file, point));
    match of_file {
        Some(start) => Ok(Begin::At(start)),
        None if text == "all" => Ok(Begin::Everywhere),
        None if !text.contains('=') => point(text).map(Begin::At),
        None => states(text).map(Begin::In),
    }
}

/// `NAME=VALUE,…`.
pub(super) fn states(text: &str) -> Result<Vec<(String, f64)>, String> {
    let mut depth = 0;
    // Commas within brackets are those of functions.
    let parts = text.split(|letter: char| {
        depth += i32::from(letter == '(') - i32::from(letter == ')');
        letter == ',' && depth == 0
    });
    let one = |part: &str| {
        let (name, number) = setting(part)?;
        Ok((name, value(&number)?))
    };
    parts.map(one).collect()
}

/// The file and the point in `FILE:POINT`, if the file exists: names of files and branches may hold
/// colons.
fn of_file(text: &str) -> Option<(&str, &str)> {
    let mut parts = text.match_indices(':').map(|(at, _)| (&text[..at], &text[at + 1..]));
    parts.find(|(file, _)| Path::new(file).is_file())
}

/// `LABEL` or `BRANCH/LABEL` of a file. The slash is the last one.
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
            "`{text}` is not of the form NAME=VALUE,… or FILE:LABEL or FILE:BRANCH/LABEL, for example x=1,y=2 or \
             pull-in.ron:3; labels are counted from 1"
        )
    })
}
