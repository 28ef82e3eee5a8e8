//! Problems whose equations are given as text: in a scene, or in a file that the scene names.

use super::discretisation::{
    BoundarySettings, FieldSettings, HybridOrbitSettings, MapSettings, ProblemSettings,
    ZeroSettings,
};
use super::error::SceneError;
use super::kinds::{Boundary, Hybrid};
use super::problem::{Configured, Model, Problem, Stated, names_of};
use super::source::{Files, SceneText, file_of};
use crate::core::bvp::{BoundaryProblem, IntoEquations};
use crate::core::spelling::shown;
use crate::language::{self, KINDS, Source, Statement, fields_of, misread, options, xpp};
use crate::misread::reason;
use ron::error::SpannedError;
use std::ops::Range;
use std::path::Path;

/// Returns the kind of equations with a given name, and the names of its fields.
pub(super) fn kind_of(name: &str) -> Option<(&'static str, &'static [&'static str])> {
    KINDS.iter().copied().find(|(kind, _)| *kind == name)
}

/// The name of the field of a scene that names a file of equations.
const FILE: &str = "model";

/// Parses the problem whose equations and settings are between the brackets of `part`, which begins
/// at the offset `at` of the scene's text.
pub(super) fn stated(
    scene: SceneText,
    (kind, fields): (&'static str, &[&'static str]),
    (part, at): (&str, usize),
    given: &[String],
) -> Result<Problem, SceneError> {
    let source = Source::new("", scene.text);
    let brackets = at..at + part.len();
    let known = settings_of(kind);
    let others: Vec<&str> = known.iter().map(String::as_str).chain([FILE]).collect();
    let statement = Statement::read(&source, kind, brackets.clone(), &others)?;
    let all = fields_of(&source, brackets)?;
    let stated = match all.iter().find(|field| field.name == FILE) {
        Some(field) => {
            if let Some(other) = all.iter().find(|field| fields.contains(&field.name.as_str())) {
                let message = format!(
                    "`{}` cannot be given together with `model`, which names a file with the complete \
                     equations",
                    other.name
                );
                let help = format!("move `{}` to that file", other.name);
                return Err(SceneError::invalid(message).with_help(help));
            }
            of_file(scene, &file_name(&scene.text[field.value.clone()])?, given)?
        }
        None => Stated::new(statement, &source, given)?,
    };
    if kind != stated.model.name() {
        let contained = stated.model.name();
        let message = format!(
            "the problem of the scene is `{}`, but its file of equations contains \
                     `{contained}`",
            shown(kind)
        );
        return Err(SceneError::invalid(message).with_help(format!("write `{contained}`")));
    }
    let not_settings = all.iter().filter(|field| !known.contains(&field.name));
    let parts = not_settings.map(|field| field.part.start - at..field.part.end - at);
    let settings = blanked(part, &parts.collect::<Vec<_>>());
    problem(stated, &settings).map_err(|error| misread(&source, at, error).into())
}

/// Replaces some parts of a text by blanks; line ends are kept, so that the positions of all other
/// parts do not change.
fn blanked(text: &str, parts: &[Range<usize>]) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for part in parts {
        bytes[part.clone()].iter_mut().filter(|byte| **byte != b'\n').for_each(|byte| *byte = b' ');
    }
    String::from_utf8(bytes).unwrap_or_default()
}

/// Parses the name of a file of equations in a scene.
fn file_name(value: &str) -> Result<String, SceneError> {
    let read = options().from_str(value);
    read.map_err(|error| SceneError::value(FILE, value, reason(&error.code)))
}

/// Returns the model in a file that a scene names, together with the text of its equations.
pub(super) fn of_file(
    scene: SceneText,
    file: &str,
    given: &[String],
) -> Result<Stated, SceneError> {
    let (path, bytes) = file_of(scene, FILE, file)?;
    // Old XPPAUT files may use an encoding other than UTF-8.
    of_text(&path, &String::from_utf8_lossy(&bytes), given)
}

/// Parses the model in the text of a file of equations.
fn of_text(path: &Path, text: &str, given: &[String]) -> Result<Stated, SceneError> {
    let source = Source::new(path.display().to_string(), text);
    let file = Some(path.to_path_buf());
    let is_ron = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("ron"));
    if !is_ode(path) && !is_ron && kind_of(language::statement_in(text).0).is_none() {
        // Scenes may come from untrusted sources, so error messages quote nothing from files of
        // other kinds.
        let kinds: Vec<&str> = KINDS.iter().map(|(kind, _)| *kind).collect();
        let message = format!("the file {} is not a file of equations", path.display());
        let help = format!("such a file begins with {}", kinds.join(", or with "));
        return Err(SceneError::invalid(message).with_help(help));
    }
    if !is_ode(path) {
        return Ok(Stated { file, ..Stated::new(Statement::of(&source)?, &source, given)? });
    }
    let read = xpp::read(&source)?;
    let mut stated = Stated::new(read.statement.clone(), &source, given)?;
    stated.file = file;
    let without = [&read.ignored[..], &read.of_simulations()].concat();
    if !without.is_empty() {
        stated.notes.push(of_options(&without));
    }
    let renamed = read.renamed.iter().map(|(old, new)| format!("`{old}` is called `{new}` here"));
    stated.notes.extend(renamed);
    stated.notes.extend(read.tried.iter().cloned());
    stated.options = read.options;
    Ok(stated)
}

/// The number of options and lines without effect that a note names.
const NAMED: usize = 3;

/// Returns the note about the XPPAUT options and lines that have no effect: their number, the first
/// of them, and the settings to use instead.
fn of_options(without: &[String]) -> String {
    let (count, more) = (without.len(), if without.len() > NAMED { ", …" } else { "" });
    let named = without.iter().take(NAMED).cloned().collect::<Vec<_>>().join(", ");
    let instead = match &substitutes(without)[..] {
        [] => String::new(),
        instead => format!("; use {} instead", instead.join(", ")),
    };
    let s = if count == 1 { "" } else { "s" };
    format!("the file has {count} option{s} or line{s} without effect: {named}{more}{instead}")
}

/// Returns the settings by which the XPPAUT options that have no effect can be replaced.
fn substitutes(options: &[String]) -> Vec<&'static str> {
    let begins = |option: &String, names: &[&str]| {
        let name = option.split_once("option `").map(|(_, option)| option.to_lowercase());
        name.is_some_and(|option| names.iter().any(|name| option.starts_with(name)))
    };
    let known = [
        (&["dt", "meth", "tol", "atol"][..], "`flow_tolerance`"),
        (&["t0", "total", "trans"], "`--time`, `--transient`"),
        (&["xlo", "xhi", "ylo", "yhi"], "`plot --x-range`, `plot --y-range`"),
        (&["ds"], "`initial_step`, `min_step`, `max_step`"),
        (&["nmx"], "`max_points`"),
        (&["parmin", "parmax"], "`--along NAME=LOW..HIGH`"),
    ];
    let used = known.into_iter().filter(|(names, _)| options.iter().any(|it| begins(it, names)));
    used.map(|(_, instead)| instead).collect()
}

/// Returns whether the name of a file is the name of an XPPAUT model.
pub(super) fn is_ode(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("ode"))
}

/// Returns the problem that a file of equations states, with default settings.
pub(super) fn with_default_settings(
    scene: SceneText,
    file: &str,
    given: &[String],
) -> Result<Problem, SceneError> {
    with_defaults(of_file(scene, file, given)?)
}

fn with_defaults(stated: Stated) -> Result<Problem, SceneError> {
    problem(stated, "()").map_err(|error| misread(&Source::new("", ""), 0, error).into())
}

fn problem(stated: Stated, settings: &str) -> Result<Problem, SpannedError> {
    let model = with_settings(stated.model.clone(), settings)?;
    Ok(Problem::stated(stated.model.name(), model, stated))
}

/// Returns a model with settings parsed from RON.
fn with_settings(model: language::Model, settings: &str) -> Result<Box<dyn Model>, SpannedError> {
    match model {
        language::Model::Field(field) => configured::<_, FieldSettings>(field, settings),
        language::Model::Zero(zero) => configured::<_, ZeroSettings>(zero, settings),
        language::Model::Map(map) => configured::<_, MapSettings>(map, settings),
        language::Model::Boundary(conditions) => {
            let defaults = conditions.defaults();
            let problem: Boundary = ((*conditions).clone().into_equations(), defaults);
            configured::<_, BoundarySettings>(problem, settings)
        }
        language::Model::Hybrid(hybrid) => {
            let hybrid: Hybrid = hybrid;
            configured::<_, HybridOrbitSettings>(hybrid, settings)
        }
        language::Model::Filippov(system) => {
            let hybrid: Hybrid = system;
            configured::<_, HybridOrbitSettings>(hybrid, settings)
        }
    }
}

fn configured<P, S: ProblemSettings>(
    problem: P,
    settings: &str,
) -> Result<Box<dyn Model>, SpannedError>
where
    Configured<P, S>: Model + 'static,
{
    Ok(Box::new(Configured { problem, settings: options().from_str::<S>(settings)? }))
}

/// Returns the names of the settings of a kind of problem.
fn settings_of(kind: &str) -> Vec<String> {
    match kind {
        "Equations" => names_of::<FieldSettings>(),
        "Residual" => names_of::<ZeroSettings>(),
        "Map" => names_of::<MapSettings>(),
        "Boundary" => names_of::<BoundarySettings>(),
        _ => names_of::<HybridOrbitSettings>(),
    }
}

impl Problem {
    /// Reads the problem in a file, which contains RON or an XPPAUT model, with default settings.
    ///
    /// # Errors
    /// [`SceneError::File`] if the file cannot be read, [`SceneError::Model`] if the file cannot be
    /// parsed.
    pub fn from_file(path: &Path, given: &[String]) -> Result<Self, SceneError> {
        let scene = SceneText { text: "", files: Some(Files::of(Path::new(""))) };
        with_default_settings(scene, &path.to_string_lossy(), given)
    }

    /// Parses the problem in the text of a file, as [`from_file`](Self::from_file) does.
    ///
    /// # Errors
    /// [`SceneError::Model`] if the text cannot be parsed.
    pub fn from_text(path: &Path, text: &str, given: &[String]) -> Result<Self, SceneError> {
        with_defaults(of_text(path, text, given)?)
    }

    /// Gives the problem the scales of its motion from the given states if the text of its equations
    /// states no scales; states that are not given have the problem's initial values.
    pub(super) fn observe_scales(&mut self, start: &[(String, f64)], p: &[f64]) {
        let Some(text) = self.text() else { return };
        let start = [start, &self.initial(p)].concat();
        let scaled = text.with_observed_scales(&start, p);
        if scaled.is_none() && self.observed_scales().is_empty() {
            return;
        }
        let observed = scaled.as_ref().map_or(Vec::new(), language::Model::scales);
        let model = scaled.unwrap_or_else(|| text.clone());
        if let Ok(model) = with_settings(model, &self.model().written()) {
            self.take_scales(model, observed);
        }
    }

    /// Returns whether a file with this text contains equations instead of a scene.
    pub fn is_file_of_equations(path: &Path, text: &str) -> bool {
        is_ode(path) || kind_of(language::statement_in(text).0).is_some()
    }
}
