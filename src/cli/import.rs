//! `tangency import MODEL.ode`: converts an XPPAUT model to a file of equations.

use super::error::CommandError;
use super::results::Results;
use super::warning::warn;
use crate::output::{SizeLimit, read, write_atomically};
use crate::scene::Problem;
use clap::Args;
use std::io::Write;
use std::path::PathBuf;

/// The examples shown in the help of `import`.
const EXAMPLES: &str = "Examples:
  tangency import model.ode --out model.ron";

/// Convert an XPPAUT model to a file of equations, ready to trace and edit
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Import {
    /// The model (.ode)
    model: PathBuf,
    /// The output file for the equations (.ron) [default: the standard output]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

impl Import {
    /// Writes the equations.
    pub fn run(&self, limit: SizeLimit, out: &mut impl Write) -> Result<(), CommandError> {
        let place = self.model.display().to_string();
        let text = read(&self.model, limit)?;
        let problem = Problem::from_text(&self.model, &String::from_utf8_lossy(&text), &[])
            .map_err(|cause| CommandError::Scene { place, cause: Box::new(cause) })?;
        problem.notes().iter().for_each(|note| warn(note));
        let text = format!("{}\n", problem.equations());
        let Some(path) = &self.out else { return Ok(out.write_all(text.as_bytes())?) };
        let _claimed = Results::claim_file(path, &[&self.model])?;
        write_atomically(path, text)?;
        Ok(writeln!(out, "{}", path.display())?)
    }
}
