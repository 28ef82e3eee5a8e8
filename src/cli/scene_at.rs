//! The scene named on the command line: reads the scene, applies the request to it, and reports
//! errors.

use super::error::CommandError;
use super::sources::Sources;
use crate::core::problem::UnknownName;
use crate::output::{read, text_of};
use crate::scene::{Files, Problem, Purpose, Request, Scene, SceneError, Stated};
use clap::Args;
use std::path::{Path, PathBuf};

/// The scene of a command, the settings to change in it, and the folder for its results.
#[derive(Debug, Args)]
pub struct SceneAt {
    /// The name of a built-in scene (see `tangency scenes`), or the path of a scene, of a file of
    /// equations (.ron), or of an XPPAUT model (.ode)
    pub scene: String,
    /// Change the value of a parameter or setting of the scene; the option may be repeated
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = setting)]
    pub settings: Vec<(String, String)>,
}

/// The folder in which a command saves its results.
#[derive(Debug, Args)]
pub struct OutFolder {
    /// The folder for the results of the command
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
}

impl SceneAt {
    /// Returns the name of the scene's results, and the scene after the request has been applied.
    pub fn read(
        &self,
        from: Sources,
        request: &Request,
        purpose: Purpose,
    ) -> Result<(String, Scene), CommandError> {
        let (name, stated) = self.stated(from)?;
        let stated = stated.map_err(|cause| self.at_fault(cause))?;
        let scene = self.requested(stated, &name, request, purpose)?;
        Ok((name, scene))
    }

    /// Applies a request to a parsed scene or model.
    pub fn requested(
        &self,
        stated: Stated,
        name: &str,
        request: &Request,
        purpose: Purpose,
    ) -> Result<Scene, CommandError> {
        if purpose == Purpose::Sweeps && matches!(stated, Stated::Model(_)) {
            return Err(CommandError::NoSweep { scene: self.scene.clone() });
        }
        let scene = stated.requested(name, request).and_then(|scene| {
            let changed = request.set.iter().map(|(name, _)| name.as_str());
            scene.check_effects(changed, purpose, request.start.as_deref())?;
            Ok(scene)
        });
        scene.map_err(|cause| self.at_fault(cause))
    }

    /// Returns the name of the scene's results, and the scene as written in its file. If the file
    /// contains a model instead of a scene, the returned scene has no runs.
    pub fn statement(
        &self,
        from: Sources,
        request: &Request,
    ) -> Result<(String, Scene), CommandError> {
        let (name, stated) = self.stated(from)?;
        let stated = stated.map_err(|cause| self.at_fault(cause))?;
        let scene = stated.as_written(&name, request);
        Ok((name, scene))
    }

    /// Returns the name of the scene's results, and the parsed scene.
    pub fn stated(
        &self,
        from: Sources,
    ) -> Result<(String, Result<Stated, SceneError>), CommandError> {
        let (name, text) = self.text(from)?;
        let path = Path::new(&self.scene);
        if Problem::is_file_of_equations(path, &text) {
            return Ok((name, Problem::from_text(path, &text, &[]).map(Stated::Model)));
        }
        let folder = path.parent().unwrap_or(Path::new(""));
        let files = Files { folder, limit: from.limit };
        Ok((name, from.catalogue.parse_in(files, &text).map(Stated::Scene)))
    }

    /// Rejects a scene without branches.
    pub fn check_runs(&self, scene: &Scene) -> Result<(), CommandError> {
        match scene.runs.iter().any(|run| run.shown) {
            true => Ok(()),
            false => Err(CommandError::NoRun { scene: self.scene.clone() }),
        }
    }

    /// Returns the input files: the scene and the file of its equations.
    pub fn inputs<'a>(&'a self, scene: &'a Scene) -> impl Iterator<Item = &'a Path> {
        [Path::new(&self.scene)].into_iter().chain(scene.problem.file())
    }

    /// Converts the error that ended a computation to an error of the command.
    pub fn stopped(&self, cause: SceneError) -> CommandError {
        match cause {
            SceneError::GivenUp { .. } => CommandError::Interrupted,
            cause => self.at_fault(cause),
        }
    }

    /// Converts an error of the scene to an error of the command, and adds the scene's name.
    pub fn at_fault(&self, cause: SceneError) -> CommandError {
        CommandError::Scene { place: self.scene.clone(), cause: Box::new(cause) }
    }

    /// Returns the name and the text of a built-in scene or of a scene file.
    pub(super) fn text(&self, from: Sources) -> Result<(String, String), CommandError> {
        let Sources { catalogue, limit } = from;
        if let Some(scene) = catalogue.scenes().iter().find(|scene| scene.name == self.scene) {
            return Ok((scene.name.clone(), scene.text.clone()));
        }
        let path = Path::new(&self.scene);
        let is_path = path.extension().is_some() || path.components().count() > 1;
        if !is_path && !path.exists() {
            let names = catalogue.scenes().iter().map(|scene| scene.name.as_str());
            let unknown = UnknownName::new("scene", &self.scene, names);
            return Err(CommandError::UnknownScene { unknown });
        }
        let bytes = read(path, limit)?;
        // Old XPPAUT files may use an encoding other than UTF-8.
        let text = match Problem::is_file_of_equations(path, "") {
            true => String::from_utf8_lossy(&bytes).into_owned(),
            false => text_of(path, bytes)?,
        };
        Ok((path.file_stem().unwrap_or_default().to_string_lossy().into_owned(), text))
    }
}

/// Parses `NAME=VALUE`, the argument of `--set`, and removes surrounding blanks. In the argument
/// `NAME=VALUE` of `--set`, the value may contain equals signs.
pub fn setting(text: &str) -> Result<(String, String), String> {
    match text.split_once('=').map(|(name, value)| (name.trim(), value.trim())) {
        Some((name, value)) if !name.is_empty() && !value.is_empty() => {
            Ok((name.into(), value.into()))
        }
        _ => Err(format!("`{text}` is not of the form NAME=VALUE, for example load=0.1")),
    }
}
