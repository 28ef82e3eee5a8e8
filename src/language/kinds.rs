//! The kinds of equations that can be given as text.

use super::basis::Kind;
use super::boundary::{self, Conditions};
use super::filippov::{self, TwoFields};
use super::hybrid::{self, Hybrid};
use super::map::{self, Iteration};
use super::observed::with_observed_scales;
use super::residual::{self, Zero};
use super::smooth;
use super::source::{Fault, ModelError, Source, misread};
use super::statement::{Boundary, Equations, FilippovEquations, HybridEquations, Map, Residual};
use super::text::{Field, fields_of, options, statement_in};
use crate::core::hybrid::Scales;
use crate::core::hybrid::filippov::Filippov;
use crate::core::orbit::Smooth;
use crate::core::problem::{Forcing, UnknownName, VectorField};
use crate::misread::unknown;
use ron::ser::PrettyConfig;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::ops::Range;
use std::sync::Arc;

/// Declares the kinds of equations: the name of each kind in a text, and the problem that is
/// assembled from its statement.
macro_rules! kinds {
    ($($(#[$docs:meta])* $kind:ident => $model:ident($problem:ty), $module:ident;)*) => {
        /// A statement of equations of any kind.
        #[derive(Clone, Debug, PartialEq, Serialize)]
        #[non_exhaustive]
        pub enum Statement {
            $($(#[$docs])* $kind($kind),)*
        }

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
            $($(#[$docs])* $model(Arc<$problem>),)*
        }

        /// The names of all kinds of statements, each with the names of its fields.
        pub const KINDS: &[(&str, &[&str])] = &[$((stringify!($kind), $kind::FIELDS)),*];

        impl Statement {
            /// Parses the bracketed part of a statement, including the brackets, at its position in
            /// the source. Fields whose names are in the list `others` are also allowed.
            ///
            /// # Errors
            /// [`ModelError`] with its place in the text, if the statement has an invalid form.
            pub(crate) fn read(
                source: &Source,
                kind: &str,
                brackets: Range<usize>,
                others: &[&str],
            ) -> Result<Self, ModelError> {
                match kind {
                    $(stringify!($kind) => {
                        check_fields(source, kind, brackets.clone(), &[$kind::FIELDS, others].concat())?;
                        read(source, brackets).map(Statement::$kind)
                    })*
                    _ => {
                        let kinds = KINDS.iter().map(|(name, _)| *name);
                        let unknown = UnknownName::new("kind of equations", kind, kinds);
                        Err(source.fault_of(&kind.into(), Fault::Unknown(unknown)))
                    }
                }
            }

            /// Assembles the statement into a model; `given` contains the names of the parameters
            /// to which a scene gives values.
            ///
            /// # Errors
            /// [`ModelError`] with its place in the text, if the equations are invalid.
            pub fn model(&self, source: &Source, given: &[String]) -> Result<Model, ModelError> {
                Ok(match self {
                    $(Statement::$kind(stated) => {
                        Model::$model(Arc::new($module::understood(source, stated, given)?))
                    })*
                })
            }
        }

        impl Model {
            /// Returns the name of the kind of equations in texts, such as `Equations` or `Map`.
            pub fn name(&self) -> &'static str {
                match self {
                    $(Model::$model(_) => stringify!($kind),)*
                }
            }

            fn kind(&self) -> &dyn Kind {
                match self {
                    $(Model::$model(model) => &**model,)*
                }
            }
        }
    };
}

kinds! {
    /// A vector field.
    Equations => Field(smooth::Field), smooth;
    /// A zero problem, that is, equations `F = 0`.
    Residual => Zero(Zero), residual;
    /// A map.
    Map => Map(Iteration), map;
    /// A boundary-value problem.
    Boundary => Boundary(Conditions), boundary;
    /// A hybrid system.
    HybridEquations => Hybrid(Hybrid), hybrid;
    /// A Filippov system.
    FilippovEquations => Filippov(Filippov<TwoFields>), filippov;
}

impl Statement {
    /// Parses a text that consists of one statement, which may follow attributes (`#![enable(…)]`)
    /// and comments.
    ///
    /// # Errors
    /// [`ModelError`] with its place in the text, if the statement has an invalid form.
    pub fn of(source: &Source) -> Result<Self, ModelError> {
        let (kind, brackets) = statement_in(&source.text);
        let begin = source.text.len() - brackets.len();
        let header = &source.text[..begin - kind.len()];
        let attributes = options().from_str::<()>(&format!("{header}()"));
        attributes.map_err(|error| misread(source, 0, error))?;
        Statement::read(source, kind, begin..source.text.len(), &[])
    }

    /// Serializes the statement as RON; parsing the RON text gives an equal statement.
    ///
    /// ```
    /// use tangency::language::{Model, Source, Statement, xpp};
    /// let read = xpp::read(&Source::new("decay.ode", "x'=-(k)*X\npar k=2\ninit x=1\n"))?;
    /// let ron = read.statement.ron();
    /// assert_eq!(ron, "\
    /// Equations(
    ///     states: [
    ///         (\"x\", \"-k*x\"),
    ///     ],
    ///     parameters: [
    ///         (\"k\", 2),
    ///     ],
    ///     initial: [
    ///         (\"x\", 1),
    ///     ],
    /// )
    /// ");
    /// assert_eq!(Statement::of(&Source::new("decay.ron", ron))?, read.statement);
    /// # Ok::<(), tangency::language::ModelError>(())
    /// ```
    pub fn ron(&self) -> String {
        // The lists within modes and guards are short.
        let pretty = PrettyConfig::new().depth_limit(3);
        let text = options().to_string_pretty(self, pretty);
        text.map_or(String::new(), |text| text + "\n")
    }
}

/// Returns an error if a field has an unknown name.
fn check_fields(
    source: &Source,
    kind: &str,
    brackets: Range<usize>,
    known: &[&str],
) -> Result<(), ModelError> {
    for Field { name, part, .. } in fields_of(source, brackets)? {
        if !known.contains(&&*name) {
            let reason = unknown("field", &name, &Some(kind.into()));
            let part = part.start..part.start + name.len();
            let error = source.fault_at(part, Fault::Form { reason });
            let unknown = UnknownName::new("field", name, known.iter().copied());
            return Err(error.with_help_of(&unknown));
        }
    }
    Ok(())
}

/// Parses a part of a source text as RON.
fn read<S: DeserializeOwned>(source: &Source, part: Range<usize>) -> Result<S, ModelError> {
    let read = source.lend(part.clone(), |text| options().from_str(text));
    read.map_err(|error| misread(source, part.start, error))
}

impl Model {
    /// Parses and assembles a text that consists of one statement; `given` contains the names of
    /// the parameters to which a scene gives values.
    ///
    /// # Errors
    /// [`ModelError`] with its place in the text, if the equations are invalid.
    pub fn read(source: &Source, given: &[String]) -> Result<Model, ModelError> {
        Statement::of(source)?.model(source, given)
    }

    /// Returns the initial states of motions and branches, for given parameters.
    pub fn initial(&self, p: &[f64]) -> Vec<(String, f64)> {
        self.kind().basis().initial_at(0.0, p)
    }

    /// Returns the initial profiles of branches of a boundary-value problem, at a position in units
    /// of the interval's length; for equations of other kinds, returns the initial states of
    /// motions.
    pub fn initial_along(&self, tau: f64, p: &[f64]) -> Vec<(String, f64)> {
        self.kind().initial_along(tau, p)
    }

    /// Returns the model with scales that are estimated from its motion, which starts in the given
    /// states of the first mode (all other states are zero). Returns `None` if the motion has usual
    /// sizes, if the text states scales, and for models without events and forcing, whose branches
    /// begin at equilibria and find scales of their own.
    pub(crate) fn with_observed_scales(&self, start: &[(String, f64)], p: &[f64]) -> Option<Self> {
        Some(match self {
            Model::Hybrid(system) => {
                Model::Hybrid(Arc::new(with_observed_scales(&**system, start, p)?))
            }
            Model::Filippov(system) => {
                Model::Filippov(Arc::new(with_observed_scales(&**system, start, p)?))
            }
            Model::Field(field) if field.forcing() != Forcing::None => {
                let forced = with_observed_scales(&Smooth((**field).clone()), start, p)?;
                Model::Field(Arc::new(forced.0))
            }
            _ => return None,
        })
    }

    /// Returns the scales of the states and of time that differ from the default, by name.
    pub(crate) fn scales(&self) -> Vec<(String, f64)> {
        let Scales { time, states } = &self.kind().basis().scales;
        let time = time.map(|time| ("t".to_string(), time));
        states.iter().cloned().chain(time).collect()
    }

    /// Returns the default values of the first parameters; the remaining parameters do not have
    /// default values.
    pub fn defaults(&self) -> &[f64] {
        &self.kind().basis().defaults
    }

    /// Returns the names of columns, each with the label of the axis that shows the column.
    pub fn labels(&self) -> &[(String, String)] {
        &self.kind().basis().labels
    }

    /// Returns the names of the parameters that no formula uses.
    pub fn unused(&self) -> &[String] {
        &self.kind().basis().unused
    }

    /// Returns the names of the guards whose functions are discontinuous, for instance because of
    /// `mod`, `floor` or `sign`: an event is detected where a function decreases continuously
    /// through zero, but not where it jumps over zero.
    ///
    /// ```
    /// use tangency::language::{Model, Source};
    /// let text = "HybridEquations(modes: [(name: \"m\", states: [(\"S\", \"-S\")])], period: \"1\",
    ///     guards: [(name: \"pulse\", modes: [\"m\"], function: \"1 - mod(t, 1)\", reset: [(\"S\", \"S + 1\")])])";
    /// assert_eq!(Model::read(&Source::new("", text), &[])?.jumping_guards(), ["pulse"]);
    /// # Ok::<(), tangency::language::ModelError>(())
    /// ```
    pub fn jumping_guards(&self) -> Vec<&str> {
        self.kind().jumping_guards()
    }

    /// Returns whether an equation of motion may jump: it contains `if` or a discontinuous function,
    /// such as `mod`, `floor` or `sign`. Where an equation jumps within an interval of a mesh, the errors
    /// of collocation are larger than stated.
    ///
    /// ```
    /// use tangency::language::{Model, Source};
    /// let text = "Equations(states: [(\"x\", \"if(mod(t, 1) < 0.3, 1, -1) - x\")], period: \"1\")";
    /// assert!(Model::read(&Source::new("", text), &[])?.may_jump());
    /// # Ok::<(), tangency::language::ModelError>(())
    /// ```
    pub fn may_jump(&self) -> bool {
        self.kind().may_jump()
    }

    /// Returns the line of a definition, as `equations.ron:7` or `line 7`; `None` if the name is
    /// unknown.
    pub fn line_of_definition(&self, name: &str) -> Option<&str> {
        let mut definitions = self.kind().basis().definitions.iter();
        definitions.find(|(known, _)| known == name).map(|(_, line)| line.as_str())
    }

    /// Returns whether the equations depend on time without a stated period: such equations can be
    /// simulated, but do not have equilibria or periodic orbits.
    pub fn is_aperiodic(&self) -> bool {
        self.kind().basis().aperiodic
    }

    /// Returns an error if a value in the equations is not finite at the start of a motion or a
    /// branch, at time 0, for example because of a division by zero or the logarithm of a negative
    /// number.
    ///
    /// ```
    /// use tangency::language::{Model, Source};
    /// let text = "Residual(unknowns: [(\"u\", \"1/u - a\")], parameters: [(\"a\", 1)])";
    /// let error = Model::read(&Source::new("", text), &[])?.undefined_at(&[0.0], &[1.0]).expect("a division by zero");
    /// assert!(error.to_string().contains("a division by zero at the start"), "{error}");
    /// # Ok::<(), tangency::language::ModelError>(())
    /// ```
    pub fn undefined_at(&self, x: &[f64], p: &[f64]) -> Option<ModelError> {
        self.kind().undefined(x, p)
    }

    /// Returns an error if the period of the forcing or the length of the interval is not positive
    /// for the given parameters.
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
        let basis = self.kind().basis();
        basis.duration.refused(&basis.source, p)
    }

    /// Returns the names of the states in the initial mode; for a zero problem, returns the names
    /// of the unknowns.
    pub fn states(&self) -> Vec<String> {
        self.kind().basis().states.clone()
    }
}
