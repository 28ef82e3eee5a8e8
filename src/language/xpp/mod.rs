//! XPPAUT's `.ode` files.
//!
//! [`read`] makes a [`Statement`] of a file, which means what XPPAUT takes the file for: letters of
//! both cases are the same, comparisons bind as strongly as powers and all operators go from left
//! to right, quantities are computed in their order, resets count for those behind them. Arrays are
//! written out, as XPPAUT does. What has no counterpart is refused with its line and column; what
//! has no effect is listed.

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

/// An `.ode` file that has been read.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Ode {
    /// The equations: `Equations`, a `Map`, or with events `HybridEquations`.
    pub statement: Statement,
    /// How far they are to be followed.
    pub options: Options,
    /// The lines without effect here, in words, with line numbers.
    pub ignored: Vec<String>,
    /// Names that had to be changed, with what they are called now.
    pub renamed: Vec<(String, String)>,
    /// The conditions with resets of which it was tried out, since the formulas do not tell, whether
    /// motion goes on beyond them.
    pub tried: Vec<String>,
    /// The last state of a map, if `t` occurs in it: it counts the iterates.
    pub clock: Option<String>,
}

impl Ode {
    /// The options that say how motion is simulated, which branches do not need.
    ///
    /// ```
    /// use tangency::language::{Source, xpp};
    /// let read = xpp::read(&Source::new("", "x'=-x\n@ total=50,ntst=20,t0=0\n"))?;
    /// assert_eq!(read.of_simulations(), ["option `total=50`"]);
    /// # Ok::<(), tangency::language::ModelError>(())
    /// ```
    pub fn of_simulations(&self) -> Vec<String> {
        let Options { start, total, transient, .. } = self.options;
        // The count of iterates begins there.
        let start = Some(start).filter(|start| *start != 0.0 && self.clock.is_none());
        let all = [("t0", start), ("total", total), ("trans", transient)];
        let stated = all.into_iter().filter_map(|(name, value)| Some((name, value?)));
        stated.map(|(name, value)| format!("option `{name}={value}`")).collect()
    }
}

/// Reads an `.ode` file.
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
/// late.ode, line 2, column 5: a delay (`delay`) is not supported: motion that depends on its past is not followed
///   |
/// 2 | x'=-delay(x,2)
///   |     ^^^^^");
/// # Ok::<(), tangency::language::ModelError>(())
/// ```
///
/// # Errors
/// [`ModelError`] with the place of what is wrong, or not supported.
pub fn read(source: &Source) -> Result<Ode, ModelError> {
    let parts = parts::Parts::read(source)?;
    model::understood(source, parts)
}
