//! `tangency trace SCENE`: traces a scene, saves its branches, draws them.

use super::asked::{Asking, Switch, value};
use super::error::CommandError;
use super::results::Results;
use super::signals;
use super::sources::Sources;
use super::watch::Watch;
use crate::core::continuation::Branch;
use crate::core::ode::{Work, work};
use crate::core::problem::UnknownName;
use crate::output::{Document, FileError, SizeLimit, printable, read};
use crate::scene::{Asked, Catalogue, Problem, Scene, SceneError, StartPoint, execute, explore};
use clap::Args;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Trace a scene or a model, and save its branches
#[derive(Debug, Args)]
pub struct Trace {
    #[command(flatten)]
    pub scene: SceneAt,
    /// Start in given states, or from a special point of an earlier result
    #[arg(long, value_name = "NAME=VALUE,… or FILE:LABEL or FILE:BRANCH/LABEL", value_parser = start)]
    pub start: Option<Begin>,
    #[command(flatten)]
    pub asking: Asking,
}

/// Print the scene that a command amounts to, to be edited
#[derive(Debug, Args)]
pub struct Written {
    #[command(flatten)]
    pub trace: Trace,
}

/// Where `--start` begins.
#[derive(Clone, Debug, PartialEq)]
pub enum Begin {
    /// In states by name.
    In(Vec<(String, f64)>),
    /// At a special point.
    At(Start),
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

impl SceneAt {
    /// The name of the scene's results, and the scene with what was changed and asked for.
    pub fn read(
        &self,
        from: Sources,
        asked: Option<&Asked>,
    ) -> Result<(String, Scene), CommandError> {
        let (name, text) = self.text(from)?;
        let path = Path::new(&self.scene);
        let scene = match (asked, Problem::is_file_of_equations(path, &text)) {
            (Some(asked), true) => {
                let problem = Problem::from_file(path, &[]);
                problem.and_then(|problem| Scene::of_model(problem, &name, &self.settings, asked))
            }
            _ => self.changed(from.catalogue, path, &text, asked),
        };
        let scene = scene.and_then(|scene| {
            scene.check_effects(self.settings.iter().map(|(name, _)| name.as_str()))?;
            Ok(scene)
        });
        Ok((name, scene.map_err(|cause| self.at_fault(cause))?))
    }

    /// What was read: the scene, and the file of its equations.
    pub fn inputs<'a>(&'a self, scene: &'a Scene) -> impl Iterator<Item = &'a Path> {
        [Path::new(&self.scene)].into_iter().chain(scene.problem.file())
    }

    /// A scene with what was changed and asked for.
    fn changed(
        &self,
        catalogue: &Catalogue,
        path: &Path,
        text: &str,
        asked: Option<&Asked>,
    ) -> Result<Scene, SceneError> {
        let mut scene = catalogue.parse_in(path.parent().unwrap_or(Path::new("")), text)?;
        for (name, value) in &self.settings {
            scene.set(name, value)?;
        }
        scene.asked(asked.unwrap_or(&Asked::default()))
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
            false => String::from_utf8(bytes).map_err(|cause| {
                FileError::read(path, std::io::Error::new(std::io::ErrorKind::InvalidData, cause))
            })?,
        };
        Ok((path.file_stem().unwrap_or_default().to_string_lossy().into_owned(), text))
    }
}

impl Trace {
    /// Traces the scene. Whatever was traced is saved and drawn, also after an error or Ctrl-C.
    pub fn run(&self, from: Sources, out: &mut impl Write) -> Result<(), CommandError> {
        if let (Some(Begin::At(_)), Some(_)) = (&self.start, &self.asking.switch) {
            return Err(CommandError::NotTogether("--switch"));
        }
        let (name, mut scene) = self.read(from)?;
        if !scene.runs.iter().any(|run| run.shown) {
            return Err(CommandError::NoRun { scene: self.scene.scene.clone() });
        }
        scene.check_plot().map_err(|cause| self.scene.at_fault(cause))?;
        let start = self.point(from.limit)?;
        let results =
            Results::claim(&self.scene.out, &name, &["ron", "svg"], &self.inputs(&scene))?;
        let told = scene.warnings();
        for warning in &told {
            writeln!(std::io::stderr(), "warning: {}", printable(warning))?;
        }
        scene.settings.cancel = signals::token();
        let mut watch = Watch::new(out);
        let outcome = match (&self.asking.switch, &start) {
            (Some(Switch::All), None) => explore(&scene, self.asking.depth.into(), &mut watch).1,
            _ => execute(&scene, start.as_ref(), &mut watch),
        };
        let watched = watch.finish();
        let saved = match outcome.document.branches.is_empty() {
            true => Ok(()),
            false => save(&results, &outcome.document, &told, out),
        };
        // What stopped the scene explains what cannot be saved or drawn, not the other way round.
        match outcome.error {
            Some(SceneError::GivenUp { .. }) => Err(CommandError::Interrupted),
            Some(cause) => Err(self.scene.at_fault(cause)),
            None => saved.and(if watched? { Err(CommandError::Interrupted) } else { Ok(()) }),
        }
    }

    /// The name of the results, and the scene.
    fn read(&self, from: Sources) -> Result<(String, Scene), CommandError> {
        let state = match &self.start {
            Some(Begin::In(state)) => &state[..],
            _ => &[],
        };
        self.scene.read(from, Some(&self.asking.asked(state)))
    }

    /// The special point to start from.
    fn point(&self, limit: SizeLimit) -> Result<Option<StartPoint>, CommandError> {
        match &self.start {
            Some(Begin::At(start)) => start.point(limit).map(Some),
            _ => Ok(None),
        }
    }

    /// The results must not replace the scene's file or the document that is started from.
    fn inputs<'a>(&'a self, scene: &'a Scene) -> Vec<&'a Path> {
        let start = match &self.start {
            Some(Begin::At(start)) => Some(start.file.as_path()),
            _ => None,
        };
        self.scene.inputs(scene).chain(start).collect()
    }
}

/// Saves and draws what was traced, and says how each branch ended. Warnings that were told on reading
/// are not told again.
fn save(
    results: &Results,
    document: &Document,
    told: &[String],
    out: &mut impl Write,
) -> Result<(), CommandError> {
    let files = results.save(Some(document), None)?;
    for Branch { name, points, ends: [start, end], warnings, .. } in &document.branches {
        writeln!(out, "{name}: {} points; ends: {start}; {end}", points.len())?;
        let new = warnings.iter().filter(|warning| !told.contains(warning));
        new.into_iter().try_for_each(|warning| writeln!(out, "warning: {name}: {warning}"))?;
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

impl Written {
    /// Writes the scene; with `--switch`, after tracing it.
    pub fn run(&self, from: Sources, out: &mut impl Write) -> Result<(), CommandError> {
        if let Some(Begin::At(_)) = &self.trace.start {
            return Err(CommandError::NotTogether("`tangency scene`"));
        }
        let (_, scene) = self.trace.read(from)?;
        let scene = match self.trace.asking.switch {
            Some(Switch::All) => explore(&scene, self.trace.asking.depth.into(), &mut ()).0,
            None => scene,
        };
        Ok(writeln!(out, "{}", scene.to_ron())?)
    }
}

impl Start {
    fn point(&self, limit: SizeLimit) -> Result<StartPoint, CommandError> {
        let document = Document::load_within(limit, &self.file)?;
        let (branch, special) = document
            .special_point(self.branch.as_deref(), self.label)
            .map_err(|cause| CommandError::Start { file: self.file.clone(), cause })?;
        Ok(StartPoint { branch: branch.clone(), label: special.label })
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

/// `FILE:LABEL` or `FILE:BRANCH/LABEL`: where `--start` begins. The colon is the last one, the
/// slash the last one behind it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Start {
    /// The document.
    pub file: PathBuf,
    /// The branch; not needed where only one has the label.
    pub branch: Option<String>,
    /// The label of the special point.
    pub label: usize,
}

/// `NAME=VALUE,…`, or a special point.
fn start(text: &str) -> Result<Begin, String> {
    if !text.contains('=') {
        return point(text).map(Begin::At);
    }
    let one = |part: &str| {
        let (name, number) = setting(part)?;
        Ok((name, value(&number)?))
    };
    text.split(',').map(one).collect::<Result<_, _>>().map(Begin::In)
}

fn point(text: &str) -> Result<Start, String> {
    let parts = || {
        let (file, point) = text.rsplit_once(':')?;
        let (branch, label) = match point.rsplit_once('/') {
            Some((branch, label)) => (Some(branch), label),
            None => (None, point),
        };
        let label = label.parse().ok().filter(|label| *label > 0)?;
        let named = !file.is_empty() && branch != Some("");
        named.then(|| Start { file: file.into(), branch: branch.map(String::from), label })
    };
    parts().ok_or_else(|| {
        format!(
            "`{text}` is not of the form NAME=VALUE,… or FILE:LABEL or FILE:BRANCH/LABEL, for example x=1,y=2 or \
             pull-in.ron:3; labels are counted from 1"
        )
    })
}
