//! `tangency live`: opens a page in the browser whose diagrams are recomputed when the scene
//! changes.

use super::error::CommandError;
use super::request::RequestArgs;
use super::scene_at::{SceneAt, setting};
use super::sources::Sources;
use crate::live::{Library, Opened, Server, Setup};
use crate::scene::Request;
use clap::Args;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The examples shown in the help of `live`.
const EXAMPLES: &str = "Examples:
  tangency live
  tangency live lorenz
  tangency live model.ron --along r=0..30 --no-open";

/// Open a page on which diagrams follow changes of equations and parameters
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Live {
    /// The name of a built-in scene (see `tangency scenes`), or the path of a scene, of a file of
    /// equations (.ron), or of an XPPAUT model (.ode)
    scene: Option<String>,
    /// Change the value of a parameter or setting of the scene; the option may be repeated
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = setting)]
    settings: Vec<(String, String)>,
    #[command(flatten)]
    request: RequestArgs,
    /// The port of the server; for port 0, the program chooses a free port
    #[arg(long, value_name = "PORT", default_value_t = 0)]
    port: u16,
    /// Print the address of the page without opening a browser
    #[arg(long)]
    no_open: bool,
}

impl Live {
    /// Serves the page until the user ends the program.
    pub fn run(&self, from: Sources, out: &mut impl Write) -> Result<(), CommandError> {
        let opened = self.scene.as_ref().map(|scene| self.opened(scene, from)).transpose()?;
        let folder = self.scene.as_ref().and_then(|scene| folder(scene, from));
        let library = Library { catalogue: from.catalogue.clone(), folder, limit: from.limit };
        if let Some(Opened { place, setup }) = &opened {
            let at = |cause| CommandError::Scene { place: place.clone(), cause: Box::new(cause) };
            setup.check_names(&library).map_err(at)?;
        }
        let server = Server::new(library, opened, self.port).map_err(CommandError::Server)?;
        let address = server.address();
        writeln!(
            out,
            "{address}\nThe page at this address works until the program is ended with Ctrl-C."
        )?;
        out.flush()?;
        if !self.no_open {
            open(&address);
        }
        server.serve()
    }

    /// Returns the scene that a newly opened page shows.
    fn opened(&self, scene: &str, from: Sources) -> Result<Opened, CommandError> {
        let at = SceneAt { scene: scene.into(), settings: Vec::new() };
        let (name, text) = at.text(from)?;
        let (depth, kinds) = match self.request.following(false) {
            Some(following) => (following.depth, following.kinds),
            None => (0, Vec::new()),
        };
        let Request { set, along, bounds, marks, settle, hold, .. } =
            self.request.request(&self.settings, &[]);
        let setup = Setup {
            name,
            text,
            set,
            along,
            bounds,
            marks,
            settle,
            hold,
            depth,
            kinds,
            ..Setup::default()
        };
        Ok(Opened { place: scene.into(), setup })
    }
}

/// Returns the folder that contains the file of a scene; `None` for a built-in scene.
fn folder(scene: &str, from: Sources) -> Option<PathBuf> {
    let is_built_in = from.catalogue.scenes().iter().any(|known| known.name == scene);
    Path::new(scene).parent().filter(|_| !is_built_in).map(Path::to_path_buf)
}

/// Opens an address in the browser, if the operating system supports it.
fn open(address: &str) {
    let (program, before): (&str, &[&str]) = match std::env::consts::OS {
        "macos" => ("open", &[]),
        "windows" => ("cmd", &["/c", "start", ""]),
        _ => ("xdg-open", &[]),
    };
    let mut command = Command::new(program);
    command.args(before).arg(address);
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    if let Ok(mut child) = command.spawn() {
        std::thread::spawn(move || child.wait());
    }
}
