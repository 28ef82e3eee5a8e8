//! Converts XPPAUT's `.ode` files to statements of equations, as in `tangency trace model.ode`.
//!
//! [`read`] converts a file into a [`Statement`] with the semantics of XPPAUT (B. Ermentrout,
//! *Simulating, Analyzing, and Animating Dynamical Systems*, SIAM 2002): letter case is ignored,
//! comparisons bind as strongly as powers, all operators associate to the left, quantities are
//! computed in their order in the file, and each reset affects the resets after it. Arrays are
//! expanded into their elements, as in XPPAUT. Constructs that have no counterpart in this library
//! are rejected with their line and column; lines that have no effect are listed.
//!
//! ```
//! use tangency::core::problem::VectorField;
//! use tangency::language::{Model, Source, xpp};
//! let text = "x'=y\ny'=-w^2*x-c*y\npar w=2,c=.5\ninit x=1\naux energy=(y^2+(w*x)^2)/2\ndone\n";
//! let source = Source::new("pendulum.ode", text);
//! let model = xpp::read(&source)?.statement.model(&source, &[])?;
//! let Model::Field(field) = model else { panic!("a vector field") };
//! let (x, p, mut rates) = ([1.0, 2.0], [2.0, 0.5], [0.0; 2]);
//! field.field(0.0, &x, &p, &mut rates);
//! assert_eq!((rates, field.monitor(0, 0.0, &x, &p)), ([2.0, -5.0], 4.0));
//! # Ok::<(), tangency::language::ModelError>(())
//! ```

mod command;
mod common;
mod crossing;
mod depend;
mod event;
mod formula;
mod function;
mod global;
mod lines;
mod model;
mod names;
mod option;
mod origin;
mod parts;
mod phrase;
mod tree;
mod trial;

pub use option::Options;

use super::Statement;
use super::source::{ModelError, Source};

/// A parsed `.ode` file.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Ode {
    /// The equations: `Equations`, a `Map`, or `HybridEquations` for a file with events.
    pub statement: Statement,
    /// The numerical options of the file, such as the duration of a simulation.
    pub options: Options,
    /// Descriptions of the lines of the file that have no effect, with their line numbers.
    pub ignored: Vec<String>,
    /// The names in the file that had to be changed during the conversion, with their new names.
    pub renamed: Vec<(String, String)>,
    /// Descriptions of the `global` conditions for which random trials decided whether the motion
    /// crosses the surface of the condition, because the formulas are not affine.
    pub tried: Vec<String>,
    /// For a map that uses `t`, the name of the additional last state, which counts the iterates.
    pub clock: Option<String>,
}

impl Ode {
    /// Returns the options that only simulations use, and that continuation does not need.
    ///
    /// ```
    /// use tangency::language::{Source, xpp};
    /// let read = xpp::read(&Source::new("", "x'=-x\n@ total=50,ntst=20,t0=0\n"))?;
    /// assert_eq!(read.of_simulations(), ["option `total=50`"]);
    /// # Ok::<(), tangency::language::ModelError>(())
    /// ```
    pub fn of_simulations(&self) -> Vec<String> {
        let Options { start, total, transient, .. } = self.options;
        // The count of iterates starts there.
        let start = Some(start).filter(|start| *start != 0.0 && self.clock.is_none());
        let all = [("t0", start), ("total", total), ("trans", transient)];
        let stated = all.into_iter().filter_map(|(name, value)| Some((name, value?)));
        stated.map(|(name, value)| format!("option `{name}={value}`")).collect()
    }
}

/// Parses an XPPAUT `.ode` file.
///
/// ```
/// use tangency::core::problem::VectorField;
/// use tangency::language::{Model, Source, xpp};
/// let text = "x'=y\nY'=-w^2*X-f(y)\nf(u)=c*u\npar w=2,c=.5\ninit x=1\naux e=(y^2+(w*x)^2)/2\ndone\n";
/// let source = Source::new("pendulum.ode", text);
/// let Model::Field(field) = xpp::read(&source)?.statement.model(&source, &[])? else { panic!() };
/// let mut rates = [0.0; 2];
/// field.field(0.0, &[1.0, 2.0], &[2.0, 0.5], &mut rates);
/// assert_eq!((rates, field.monitor(0, 0.0, &[1.0, 2.0], &[2.0, 0.5])), ([2.0, -5.0], 4.0));
/// let source = Source::new("late.ode", "# a delay\nx'=-delay(x,2)\n");
/// assert_eq!(xpp::read(&source).unwrap_err().to_string(), "\
/// late.ode, line 2, column 5: a delay (`delay`) is not supported: the equations of a model cannot contain delays
///   |
/// 2 | x'=-delay(x,2)
///   |     ^^^^^");
/// # Ok::<(), tangency::language::ModelError>(())
/// ```
///
/// # Errors
/// [`ModelError`] with its place in the file, for an error or an unsupported construct in the file.
pub fn read(source: &Source) -> Result<Ode, ModelError> {
    let parts = parts::Parts::read(source)?;
    model::understood(source, parts)
}
