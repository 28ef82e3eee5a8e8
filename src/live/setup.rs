//! The state of a page: the text of a scene or a model, and the request applied to the text.

use super::library::Library;
use crate::core::cancel::CancelToken;
use crate::core::problem::{UnknownName, columns_showing};
use crate::core::system::Kind;
use crate::scene::{Following, Problem, Range, Request, Run, Scene, SceneError, Stated};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// The text of a scene or a model, with a request that corresponds to the options of `tangency
/// trace`. Equal setups lead to equal results.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Setup {
    /// The name of the files in which results are saved.
    pub name: String,
    /// The text of a scene, of equations in RON, or of an XPPAUT model.
    pub text: String,
    /// The changed values, by the names of parameters and settings.
    pub set: Vec<(String, String)>,
    /// The varied parameters of the first run, with their ranges. If no range is given for a model,
    /// the first parameter of the model is varied.
    pub along: Vec<Range>,
    /// The bounds of parameters and monitors.
    pub bounds: Vec<Range>,
    /// The values of parameters and monitors at which points of branches are marked.
    pub marks: Vec<(String, f64)>,
    /// The initial states of the first run.
    pub state: Vec<(String, f64)>,
    /// The duration of the simulation that precedes the first run.
    pub settle: Option<f64>,
    /// The kind of special point whose curve is traced in two varied parameters.
    pub hold: Option<Kind>,
    /// Further runs, which continue from special points of earlier runs.
    pub runs: Vec<Run>,
    /// The number of generations of emanating branches to trace.
    pub depth: usize,
    /// The kinds of special points from which further branches are traced; empty for all kinds.
    pub kinds: Vec<Kind>,
    /// The column of the results on the horizontal axis of the diagram; `None` for the default
    /// column.
    pub x: Option<String>,
    /// The column of the results on the vertical axis of the diagram; `None` for the default
    /// column.
    pub y: Option<String>,
    /// Whether the user is dragging a control of the page: sensitivities of special points, which
    /// the diagram does not show, are then not computed.
    #[serde(skip_serializing)]
    pub draft: bool,
}

/// The names in a setup that do not exist in its text, for example after a change of the text.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct LeftOut {
    /// The parameters and settings.
    parameters: Vec<String>,
    /// The columns.
    columns: Vec<String>,
}

impl LeftOut {
    /// Returns a warning for each name.
    pub fn warnings(&self) -> Vec<String> {
        let of_parameter = |name: &String| {
            format!(
                "the changed value or range of `{name}` is left out: the text has no such parameter"
            )
        };
        let of_column = |name: &String| {
            format!(
                "the bound, mark, start or axis of `{name}` is left out: branches have no such column"
            )
        };
        let parameters = self.parameters.iter().map(of_parameter);
        parameters.chain(self.columns.iter().map(of_column)).collect()
    }
}

/// The maximum number of generations of emanating branches.
const DEPTH: usize = 20;

impl Setup {
    /// Returns the kinds of special points at which branches are switched; `None` if no branches
    /// are switched.
    pub(super) fn following(&self) -> Option<Following> {
        let all = Following::all(self.depth.min(DEPTH));
        let kinds = if self.kinds.is_empty() { all.kinds } else { self.kinds.clone() };
        (self.depth > 0).then_some(Following { kinds, ..all })
    }

    /// Returns a name for the files of results, which contains only characters that are allowed in
    /// file names.
    pub(super) fn file_name(&self) -> String {
        let plain = |letter: char| match letter.is_alphanumeric() || "-_.".contains(letter) {
            true => letter,
            false => '-',
        };
        let name: String = self.name.chars().take(80).map(plain).collect();
        let name = name.trim_matches(['-', '.']);
        if name.is_empty() { "scene".into() } else { name.into() }
    }

    /// Parses the text of the setup. A text that does not have the form of RON is parsed as an
    /// XPPAUT model.
    pub(super) fn stated(&self, library: &Library) -> Result<Stated, SceneError> {
        let beginning = self.text.trim_start();
        let is_model = Problem::is_file_of_equations(&PathBuf::new(), &self.text);
        let is_scene = self.text.contains("Scene(") || beginning.starts_with('(');
        if is_model || !is_scene {
            let ending = if is_model { "ron" } else { "ode" };
            let path = PathBuf::from(format!("{}.{ending}", self.file_name()));
            return Problem::from_text(&path, &self.text, &[]).map(Stated::Model);
        }
        library.parse(&self.text).map(Stated::Scene)
    }

    /// Returns the request of the setup, whose computation is cancelled by the given token.
    pub(super) fn request(&self, cancel: &CancelToken) -> Request {
        Request {
            set: self.set.clone(),
            along: self.along.clone(),
            bounds: self.bounds.clone(),
            marks: self.marks.clone(),
            state: self.state.clone(),
            settle: self.settle,
            hold: self.hold,
            cancel: cancel.clone(),
            ..Request::default()
        }
    }

    /// Returns the scene with the changed values of the setup; a scene made from a model has no
    /// runs.
    pub(super) fn values(&self, library: &Library) -> Result<Scene, SceneError> {
        let mut scene = self.plain(library)?;
        scene.set_all(&self.set)?;
        Ok(scene)
    }

    /// Returns the scene as written in the text; a scene made from a model has no runs.
    fn plain(&self, library: &Library) -> Result<Scene, SceneError> {
        Ok(self.stated(library)?.as_written(&self.name, &Request::default()))
    }

    /// Returns a setup and a list of names. The setup lacks the values, ranges and runs of
    /// parameters, and the bounds, marks, initial states and axes of columns, that the changed text
    /// no longer contains; the list contains the names of these parameters and columns.
    pub(super) fn suited(&self, library: &Library) -> Result<(Setup, LeftOut), SceneError> {
        let scene = self.plain(library)?;
        let parameters: Vec<String> =
            scene.problem.parameters().into_iter().map(|(name, _)| name).collect();
        let known = [scene.setting_names(), parameters.clone()].concat();
        let mut left_out = LeftOut::default();
        let mut keeps = |name: &String, known: &[String]| {
            let keeps = known.contains(name);
            if !keeps && !left_out.parameters.contains(name) {
                left_out.parameters.push(name.clone());
            }
            keeps
        };
        let mut suited = self.clone();
        suited.set.retain(|(name, _)| keeps(name, &known));
        suited.along.retain(|range| keeps(&range.name, &parameters));
        suited.runs.retain(|run| run.along.iter().all(|range| keeps(&range.name, &parameters)));
        suited.leave_out_columns(scene, &mut left_out);
        Ok((suited, left_out))
    }

    /// Removes the bounds, marks, initial states and axes of columns that no branch can have.
    fn leave_out_columns(&mut self, mut scene: Scene, left_out: &mut LeftOut) {
        let chosen = self.x.is_some() || self.y.is_some();
        if self.bounds.is_empty() && self.marks.is_empty() && self.state.is_empty() && !chosen {
            return;
        }
        let states = scene.problem.text().map(|model| model.states());
        scene.runs.extend(self.runs.iter().cloned());
        let columns = scene.columns();
        let mut keeps = |name: &String, keeps: bool| {
            if !keeps && !left_out.columns.contains(name) {
                left_out.columns.push(name.clone());
            }
            keeps
        };
        let shown = |name: &String| {
            let known = |name: &str| columns.as_ref().is_none_or(|it| it.iter().any(|c| c == name));
            !columns_showing(name, known).is_empty()
        };
        self.bounds.retain(|bound| keeps(&bound.name, shown(&bound.name)));
        self.marks.retain(|(name, _)| keeps(name, shown(name)));
        self.state
            .retain(|(name, _)| keeps(name, states.as_ref().is_none_or(|it| it.contains(name))));
        for axis in [&mut self.x, &mut self.y] {
            axis.take_if(|name| !keeps(name, shown(name)));
        }
    }

    /// Checks that the text contains all parameters, settings and columns of the request; a text
    /// with syntax errors is not checked.
    ///
    /// # Errors
    /// [`SceneError::UnknownName`] with a suggestion, if a parameter, setting or column does not
    /// exist.
    pub fn check_names(&self, library: &Library) -> Result<(), SceneError> {
        let Ok((_, left_out)) = self.suited(library) else { return Ok(()) };
        let scene = self.plain(library)?;
        if let Some(unknown) = left_out.parameters.first() {
            let known = [scene.problem.names(), scene.setting_names()].concat();
            return Err(UnknownName::new("parameter or setting", unknown, known).into());
        }
        let Some(unknown) = left_out.columns.first() else { return Ok(()) };
        Err(UnknownName::new("column", unknown, scene.columns().unwrap_or_default()).into())
    }

    /// Returns the scene that the page traces.
    pub(super) fn scene(
        &self,
        library: &Library,
        cancel: &CancelToken,
    ) -> Result<Scene, SceneError> {
        let mut request = self.request(cancel);
        let stated = self.stated(library)?;
        if let (Stated::Model(problem), true) = (&stated, request.along.is_empty()) {
            request.along.extend(first_range(problem, &self.set));
        }
        let mut scene = stated.requested(&self.name, &request)?;
        scene.settings.draft = self.draft;
        // While a control is dragged, the last branches are corrected.
        scene.settings.keep_solutions = true;
        match self.runs.is_empty() {
            true => Ok(scene),
            false => scene.with_runs(self.runs.iter().cloned()),
        }
    }
}

/// Returns the range over which the first parameter of a model is varied by default.
fn first_range(problem: &Problem, set: &[(String, String)]) -> Option<Range> {
    let (name, value) = problem.parameters().into_iter().next()?;
    let own = set.iter().rev().find(|(key, _)| *key == name);
    let own = own.and_then(|(_, value)| value.parse().ok());
    Some(Range::usual(name, own.or(value).unwrap_or_default()))
}
