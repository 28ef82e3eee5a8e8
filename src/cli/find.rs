//! `tangency find MODEL --box …`: finds the equilibria, fixed points or zeros in a box.

use super::error::CommandError;
use super::request::Within;
use super::scene_at::SceneAt;
use super::signals;
use super::sources::Sources;
use crate::core::continuation::{Root, Roots};
use crate::output::significant;
use crate::scene::{Found, Request};
use clap::Args;
use std::io::Write;

/// The examples shown in the help of `find`.
const EXAMPLES: &str = "Examples:
  tangency find lorenz --box x=-20..20,y=-20..20,z=0..40 --set rho=28";

/// Find the equilibria, fixed points or zeros in a box, with their eigenvalues
///
/// Newton's method starts at many points of the box. Deflation removes known solutions from the
/// equations. The search for solutions in a box may miss some of them.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Find {
    #[command(flatten)]
    scene: SceneAt,
    #[command(flatten)]
    within: Within,
}

impl Find {
    /// Searches the box and writes a line for each solution.
    pub fn run(&self, from: Sources, out: &mut impl Write) -> Result<(), CommandError> {
        let (set, cancel) = (self.scene.settings.clone(), signals::token());
        let within = self.within.search();
        let request = Request { set, within, cancel, ..Request::default() };
        let (_, scene) = self.scene.statement(from, &request)?;
        signals::handle();
        let found = scene.find(&request);
        let Found { unknowns, roots } = found.map_err(|cause| self.scene.at_fault(cause))?;
        let Roots { roots, starts, lost, outside, inadmissible } = roots;
        let names: Vec<String> = unknowns.iter().map(|name| format!(" {name:>18}")).collect();
        writeln!(out, "{}  unstable  eigenvalues", names.concat())?;
        for Root { unknowns, eigenvalues, unstable } in &roots {
            let values = unknowns.iter().map(|value| format!(" {:>18}", significant(*value, 12)));
            let unstable = unstable.map_or(String::new(), |count| count.to_string());
            let eigenvalues: Vec<String> = eigenvalues.iter().map(in_words).collect();
            let values = values.collect::<String>();
            writeln!(out, "{values}  {unstable:>8}  {}", eigenvalues.join(", "))?;
        }
        let found = roots.len();
        writeln!(
            out,
            "solutions inside the box: {found}; solutions outside the box: {outside}; starting \
             points that led to no further solution: {lost} of {starts}"
        )?;
        if inadmissible > 0 {
            writeln!(
                out,
                "solutions inside the box that are not admissible, such as equilibria outside the region of \
                 their mode: {inadmissible}"
            )?;
        }
        if signals::interrupted() { Err(CommandError::Interrupted) } else { Ok(()) }
    }
}

/// Formats an eigenvalue.
fn in_words(&(re, im): &(f64, f64)) -> String {
    let [real, imaginary] = [re, im.abs()].map(|part| significant(part, 6));
    match im {
        0.0 => real,
        _ => format!("{real} {} {imaginary}i", if im > 0.0 { '+' } else { '−' }),
    }
}
