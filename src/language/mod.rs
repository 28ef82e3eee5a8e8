//! Problems whose equations are given as text, in scenes and in files of their own.
//!
//! A **statement** is RON: names with formulas, as in
//!
//! ```ron
//! Equations(
//!     states: [("x", "sigma*(y - x)"), ("y", "x*(rho - z) - y"), ("z", "x*y - beta*z")],
//!     parameters: [("sigma", 10), ("rho", 28), ("beta", "8/3")],
//! )
//! ```
//!
//! `docs/models.md` has the language. A formula is read into nodes in postfix order; what its names
//! mean is looked up in the scope of its mode, and all formulas that are evaluated together become
//! one tape of operations, in which common parts are computed once. A tape is evaluated over any
//! [`Scalar`](crate::core::scalar::Scalar) without allocation, so that a [`Model`] is a problem
//! like any other: derivatives of every order, orbits, local maps.

mod assembling;
mod assembly;
mod basis;
mod boundary;
mod calls;
mod duration;
mod elementary;
mod events;
mod filippov;
mod hybrid;
mod layout;
mod map;
mod misread;
mod operation;
mod period;
mod product;
mod residual;
mod scope;
mod smooth;
mod source;
pub mod statement;
mod syntax;
mod tape;
mod times;
mod written;
pub mod xpp;

pub use basis::number;
pub use boundary::Conditions;
pub use filippov::TwoFields;
pub use hybrid::Hybrid;
pub use map::Iteration;
pub(crate) use misread::misread;
pub use residual::Zero;
pub use smooth::Field;
pub use source::{Fault, ModelError, Phrase, Place, Source};
pub(crate) use source::{blanked, without_mark};

use crate::core::hybrid::filippov::Filippov;
use basis::Basis;
use ron::extensions::Extensions;
use serde::de::DeserializeOwned;
use statement::{Boundary, Equations, FilippovEquations, HybridEquations, Map, Residual};
use std::sync::Arc;

/// A problem whose equations are given as text.
///
/// ```
/// use tangency::core::problem::VectorField;
/// use tangency::language::{Model, Source};
/// let text = "Equations(states: [(\"x\", \"v\"), (\"v\", \"-sin(x) - c*v\")], parameters: [(\"c\", \"1/4\")])";
/// let Model::Field(pendulum) = Model::read(&Source::new("pendulum.ron", text), &[])? else { panic!() };
/// let mut rates = [0.0; 2];
/// pendulum.field(0.0, &[1.0, 2.0], &[0.25], &mut rates);
/// assert_eq!(rates, [2.0, -1.0_f64.sin() - 0.5]);
/// # Ok::<(), tangency::language::ModelError>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Model {
    /// A vector field: `Equations`.
    Field(Arc<Field>),
    /// Equations `F = 0`: `Residual`.
    Zero(Arc<Zero>),
    /// A map: `Map`.
    Map(Arc<Iteration>),
    /// A boundary-value problem: `Boundary`.
    Boundary(Arc<Conditions>),
    /// A hybrid system: `HybridEquations`.
    Hybrid(Arc<Hybrid>),
    /// A Filippov system: `FilippovEquations`.
    Filippov(Arc<Filippov<TwoFields>>),
}

/// A statement of any kind.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Statement {
    /// Of a vector field.
    Equations(Equations),
    /// Of equations `F = 0`.
    Residual(Residual),
    /// Of a map.
    Map(Map),
    /// Of a boundary-value problem.
    Boundary(Boundary),
    /// Of a hybrid system.
    HybridEquations(HybridEquations),
    /// Of a Filippov system.
    FilippovEquations(FilippovEquations),
}

/// The kinds of statements with the names of what they state.
pub const KINDS: [(&str, &[&str]); 6] = [
    ("Equations", Equations::FIELDS),
    ("Residual", Residual::FIELDS),
    ("Map", Map::FIELDS),
    ("Boundary", Boundary::FIELDS),
    ("HybridEquations", HybridEquations::FIELDS),
    ("FilippovEquations", FilippovEquations::FIELDS),
];

impl Statement {
    /// Reads what stands between the brackets of a statement, brackets included, and stands in the
    /// source at `part`.
    ///
    /// # Errors
    /// [`ModelError`] with the place, if it is not of the form.
    pub fn read(source: &Source, kind: &str, part: &str) -> Result<Self, ModelError> {
        Ok(match kind {
            "Equations" => Statement::Equations(read(source, part)?),
            "Residual" => Statement::Residual(read(source, part)?),
            "Map" => Statement::Map(read(source, part)?),
            "Boundary" => Statement::Boundary(read(source, part)?),
            "HybridEquations" => Statement::HybridEquations(read(source, part)?),
            "FilippovEquations" => Statement::FilippovEquations(read(source, part)?),
            _ => {
                let kinds = KINDS.map(|(name, _)| name);
                let unknown =
                    crate::core::problem::UnknownName::new("kind of equations", kind, kinds);
                return Err(source.fault_of(&kind.into(), Fault::Unknown(unknown)));
            }
        })
    }

    /// Reads the statement that is all of a text, behind attributes (`#![enable(…)]`) and comments.
    ///
    /// # Errors
    /// [`ModelError`] with the place, if it is not of the form.
    pub fn of(source: &Source) -> Result<Self, ModelError> {
        let (kind, part) = statement_in(&source.text);
        let header = &source.text[..source.text.len() - part.len() - kind.len()];
        let attributes = options().from_str::<()>(&format!("{header}()"));
        attributes.map_err(|error| misread(source, source.at(header), error))?;
        Statement::read(source, kind, part)
    }

    /// The statement as a model, with the names of parameters that a scene gives.
    ///
    /// # Errors
    /// [`ModelError`] with the place.
    pub fn model(self, source: &Source, given: &[String]) -> Result<Model, ModelError> {
        Ok(match self {
            Statement::Equations(stated) => {
                Model::Field(Arc::new(Field::new(source, stated, given)?))
            }
            Statement::Residual(stated) => Model::Zero(Arc::new(Zero::new(source, stated, given)?)),
            Statement::Map(stated) => Model::Map(Arc::new(Iteration::new(source, stated, given)?)),
            Statement::Boundary(stated) => {
                Model::Boundary(Arc::new(Conditions::new(source, stated, given)?))
            }
            Statement::HybridEquations(stated) => {
                Model::Hybrid(Arc::new(Hybrid::new(source, stated, given)?))
            }
            Statement::FilippovEquations(stated) => {
                Model::Filippov(Arc::new(Filippov(TwoFields::new(source, stated, given)?)))
            }
        })
    }
}

/// Reads a part of a source as RON.
fn read<S: DeserializeOwned>(source: &Source, part: &str) -> Result<S, ModelError> {
    options().from_str(part).map_err(|error| misread(source, source.at(part), error))
}

/// How RON is read: as in scenes.
fn options() -> ron::Options {
    ron::Options::default()
        .with_default_extension(Extensions::IMPLICIT_SOME)
        .with_default_extension(Extensions::UNWRAP_VARIANT_NEWTYPES)
}

impl Model {
    /// Reads and understands the statement that is all of a text; with the names of parameters that
    /// a scene gives.
    ///
    /// # Errors
    /// [`ModelError`] with the place.
    pub fn read(source: &Source, given: &[String]) -> Result<Model, ModelError> {
        Statement::of(source)?.model(source, given)
    }

    /// Values of states, where motion and branches begin, for values of the parameters.
    pub fn initial(&self, p: &[f64]) -> Vec<(String, f64)> {
        self.basis().initial_at(0.0, p)
    }

    /// Values of states, where branches of boundary-value problems begin, at a time in units of the
    /// length; of other equations where motion begins.
    pub fn initial_along(&self, tau: f64, p: &[f64]) -> Vec<(String, f64)> {
        match self {
            Model::Boundary(conditions) => conditions.initial_along(tau, p),
            _ => self.initial(p),
        }
    }

    /// Default values of the first parameters, which have them.
    pub fn defaults(&self) -> &[f64] {
        &self.basis().defaults
    }

    /// Parameters that no formula uses.
    pub fn unused(&self) -> &[String] {
        &self.basis().unused
    }

    /// The guards that jump, by `mod`, `floor` or `sign`: an event is seen where a guard falls
    /// through zero, not where it jumps away from it.
    ///
    /// ```
    /// use tangency::language::{Model, Source};
    /// let text = "HybridEquations(modes: [(name: \"m\", states: [(\"S\", \"-S\")])], period: \"1\",
    ///     guards: [(name: \"pulse\", modes: [\"m\"], function: \"1 - mod(t, 1)\", reset: [(\"S\", \"S + 1\")])])";
    /// assert_eq!(Model::read(&Source::new("", text), &[])?.jumping_guards(), ["pulse"]);
    /// # Ok::<(), tangency::language::ModelError>(())
    /// ```
    pub fn jumping_guards(&self) -> Vec<&str> {
        match self {
            Model::Hybrid(hybrid) => hybrid.jumping().collect(),
            _ => Vec::new(),
        }
    }

    /// The line in which a definition stands, `equations.ron:7` or `line 7`; `None` if there is
    /// none of this name.
    pub fn line_of_definition(&self, name: &str) -> Option<&str> {
        let mut definitions = self.basis().definitions.iter();
        definitions.find(|(known, _)| known == name).map(|(_, line)| line.as_str())
    }

    /// Whether time enters, but not with a period: such motion can be simulated, but has no
    /// equilibria and no periodic orbits.
    pub fn is_aperiodic(&self) -> bool {
        match self {
            Model::Field(field) => field.is_aperiodic(),
            Model::Hybrid(hybrid) => hybrid.is_aperiodic(),
            Model::Filippov(system) => system.0.is_aperiodic(),
            _ => false,
        }
    }

    /// The value that is not finite where motion or a branch begins, at time 0: a division by zero,
    /// a logarithm of a negative number.
    ///
    /// ```
    /// use tangency::language::{Model, Source};
    /// let text = "Residual(unknowns: [(\"u\", \"1/u - a\")], parameters: [(\"a\", 1)])";
    /// let error = Model::read(&Source::new("", text), &[])?.undefined_at(&[0.0], &[1.0]).expect("a division by zero");
    /// assert!(error.to_string().contains("a division by zero at the start"), "{error}");
    /// # Ok::<(), tangency::language::ModelError>(())
    /// ```
    pub fn undefined_at(&self, x: &[f64], p: &[f64]) -> Option<ModelError> {
        match self {
            Model::Field(field) => field.undefined(0.0, x, p),
            Model::Zero(zero) => zero.undefined(x, p),
            Model::Map(map) => map.undefined(x, p),
            Model::Hybrid(hybrid) => hybrid.undefined(0.0, x, p),
            Model::Filippov(system) => {
                use crate::core::hybrid::HybridSystem;
                let mode = system.initial_mode(Filippov::<TwoFields>::ABOVE, 0.0, x, p);
                system.0.undefined(mode, (0.0, x, p))
            }
            Model::Boundary(_) => None,
        }
    }

    /// The error of a period or a length that is not positive for some parameters.
    ///
    /// ```
    /// use tangency::language::{Model, Source};
    /// let text = "Equations(states: [(\"x\", \"cos(t) - x\")], parameters: [(\"w\", 1)], period: \"2/w\")";
    /// let model = Model::read(&Source::new("", text), &[])?;
    /// assert!(model.refused_duration(&[1.0]).is_none());
    /// let error = model.refused_duration(&[-2.0]).expect("a negative period");
    /// assert!(error.to_string().contains("the period `2/w` is -1 at w = -2"), "{error}");
    /// # Ok::<(), tangency::language::ModelError>(())
    /// ```
    pub fn refused_duration(&self, p: &[f64]) -> Option<ModelError> {
        match self {
            Model::Field(field) => field.refused_duration(p),
            Model::Boundary(conditions) => conditions.refused_duration(p),
            Model::Hybrid(hybrid) => hybrid.refused_duration(p),
            Model::Filippov(system) => system.0.refused_duration(p),
            Model::Zero(_) | Model::Map(_) => None,
        }
    }

    /// The names of states in which motion begins, or of unknowns.
    pub fn states(&self) -> Vec<String> {
        use crate::core::hybrid::HybridSystem;
        use crate::core::problem::DiscreteMap;
        use crate::core::problem::{VectorField, ZeroProblem};
        let names = match self {
            Model::Field(field) => VectorField::names(&**field),
            Model::Zero(zero) => ZeroProblem::names(&**zero),
            Model::Map(map) => DiscreteMap::names(&**map),
            Model::Hybrid(hybrid) => return hybrid.modes().swap_remove(0).states,
            Model::Filippov(system) => return system.modes().swap_remove(0).states,
            Model::Boundary(conditions) => {
                use crate::core::bvp::BoundaryProblem;
                return conditions.segments().swap_remove(0);
            }
        };
        names.unknowns.into_iter().map(|state| state.name).collect()
    }

    fn basis(&self) -> &Basis {
        match self {
            Model::Field(field) => &field.basis,
            Model::Zero(zero) => &zero.basis,
            Model::Map(map) => &map.basis,
            Model::Boundary(conditions) => &conditions.basis,
            Model::Hybrid(hybrid) => &hybrid.basis,
            Model::Filippov(system) => &system.0.basis,
        }
    }
}

/// The kind of the statement that is all of a text, and what stands behind it.
pub(crate) fn statement_in(text: &str) -> (&str, &str) {
    let text = skip_attributes(without_mark(text));
    text.split_at(text.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(text.len()))
}

/// A text from behind its first attributes, `#![…]`, blanks and comments.
fn skip_attributes(text: &str) -> &str {
    let mut text = skip_comments(text);
    while text.starts_with('#') {
        text = skip_comments(text.split_once(']').map_or("", |(_, rest)| rest));
    }
    text
}

/// A text from behind its first blanks and comments.
pub(crate) fn skip_comments(mut text: &str) -> &str {
    loop {
        text = text.trim_start();
        text = match text.as_bytes() {
            [b'/', b'/', ..] => text.split_once('\n').map_or("", |(_, rest)| rest),
            [b'/', b'*', ..] => behind_block(&text[2..]),
            _ => return text,
        };
    }
}

/// A text from behind a comment that has been opened. Comments may stand in comments.
fn behind_block(mut text: &str) -> &str {
    let mut depth = 1;
    while depth > 0 {
        let [open, close] = ["/*", "*/"].map(|mark| text.find(mark).unwrap_or(text.len()));
        depth = if open < close { depth + 1 } else { depth - 1 };
        text = text.get(open.min(close) + 2..).unwrap_or("");
    }
    text
}
