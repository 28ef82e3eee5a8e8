//! Statements of equations as parsed from RON: the names in their formulas are not yet resolved.

use super::source::Phrase;
use crate::core::problem::Dynamics;
use serde::{Deserialize, Serialize};

/// Names with formulas.
pub type Formulas = Vec<(Phrase, Phrase)>;

/// Declares the statement of each kind of equations, together with the fields that all kinds have
/// in common.
macro_rules! statements {
    ($(
        $(#[$docs:meta])*
        $name:ident { $($(#[$field_docs:meta])* $field:ident: $type:ty,)* }
    )*) => {$(
        $(#[$docs])*
        #[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
        #[serde(default)]
        pub struct $name {
            $($(#[$field_docs])* #[serde(skip_serializing_if = "is_default")] pub $field: $type,)*
            /// The names and default values of parameters. A parameter to which a scene gives a
            /// value may be omitted.
            #[serde(skip_serializing_if = "is_default")]
            pub parameters: Formulas,
            /// Definitions: names for formulas; each formula may use the definitions that precede
            /// it.
            #[serde(skip_serializing_if = "is_default")]
            pub definitions: Formulas,
            /// The functions of the model, each with its name, its arguments and its formula.
            #[serde(skip_serializing_if = "is_default")]
            pub functions: Vec<(Phrase, Vec<Phrase>, Phrase)>,
            /// Additional columns.
            #[serde(skip_serializing_if = "is_default")]
            pub monitors: Formulas,
            /// The initial values of states, used at the start of motions and branches.
            #[serde(skip_serializing_if = "is_default")]
            pub initial: Formulas,
            /// The typical sizes of states whose sizes are far from 1; for systems with events,
            /// also the typical size of time, under the name `t`.
            #[serde(skip_serializing_if = "is_default")]
            pub scales: Formulas,
            /// Labels of axes, shown instead of the names of states, parameters, monitors or time
            /// (`t`).
            #[serde(skip_serializing_if = "is_default")]
            pub labels: Formulas,
            /// The units of states, parameters, monitors or time (`t`), which are shown on axes.
            #[serde(skip_serializing_if = "is_default")]
            pub units: Formulas,
        }

        impl $name {
            /// The names of the fields of this statement.
            pub const FIELDS: &[&str] = &[
                $(stringify!($field),)* "parameters", "definitions", "functions", "monitors", "initial", "scales",
                "labels", "units",
            ];

            pub(super) fn common(&self) -> Common<'_> {
                let $name {
                    parameters, definitions, functions, monitors, initial, scales, labels, units, ..
                } = self;
                Common { parameters, definitions, functions, monitors, initial, scales, labels, units }
            }
        }

        impl From<Shared> for $name {
            fn from(Shared { parameters, definitions, functions, monitors, initial }: Shared) -> Self {
                $name { parameters, definitions, functions, monitors, initial, ..$name::default() }
            }
        }
    )*};
}

statements! {
    /// A vector field, given by the rates of its states.
    Equations {
        /// The states with their rates; `u[i=1..n]` denotes an array.
        states: Formulas,
        /// The period of the forcing, for equations that depend on time.
        period: Option<Phrase>,
    }

    /// A zero problem, that is, equations `F = 0`.
    Residual {
        /// The unknowns, each with an expression that is zero at a solution.
        unknowns: Formulas,
        /// The kind of dynamics whose equilibria the equations describe.
        dynamics: Static,
    }

    /// A map.
    Map {
        /// The states of the map, each with the formula of its next value.
        states: Formulas,
    }

    /// A boundary-value problem.
    Boundary {
        /// The states with their rates on the interval.
        states: Formulas,
        /// The boundary conditions: expressions that are zero at a solution and that depend on the
        /// states at the ends, such as `u(0)` and `u(1)`.
        conditions: Vec<Phrase>,
        /// Formulas whose integrals over the interval must be zero.
        integrals: Vec<Phrase>,
        /// Additional unknown numbers.
        unknowns: Vec<Phrase>,
        /// The length of the interval; its default is 1.
        length: Option<Phrase>,
    }

    /// A hybrid system.
    HybridEquations {
        /// The states that all modes have in common, with their rates; these states precede the
        /// states of the individual modes.
        states: Formulas,
        /// The modes.
        modes: Vec<Mode>,
        /// The modes of each part of the system, given instead of `modes`: the modes of the system
        /// are all combinations that contain one mode of each part.
        product: Vec<Vec<Mode>>,
        /// The guards.
        guards: Vec<Guard>,
        /// The period of the forcing, for equations that depend on time.
        period: Option<Phrase>,
    }

    /// A Filippov system: two vector fields, and a surface that separates them.
    FilippovEquations {
        /// The states with their rates above the surface.
        above: Formulas,
        /// The same states with their rates below the surface.
        below: Formulas,
        /// The function that is zero on the surface, positive above it, and negative below it.
        surface: Option<Phrase>,
        /// The states with their rates on the surface; by default, the rates are the convex
        /// combination of the two vector fields that is tangent to the surface.
        sliding: Formulas,
        /// Functions for the sides `above` and `below`: a sliding motion does not leave the surface
        /// to a side while the function of this side is positive. By default, the function is the
        /// speed at which the vector field on this side approaches the surface.
        holds: Formulas,
        /// Names that replace the mode names `above`, `below` and `sliding`, and the event name
        /// `surface`.
        names: Formulas,
        /// The period of the forcing, for equations that depend on time.
        period: Option<Phrase>,
    }
}

/// References to the fields that statements of all kinds have.
#[derive(Clone, Copy)]
pub(super) struct Common<'a> {
    pub parameters: &'a Formulas,
    pub definitions: &'a Formulas,
    pub functions: &'a [(Phrase, Vec<Phrase>, Phrase)],
    pub monitors: &'a Formulas,
    pub initial: &'a Formulas,
    pub scales: &'a Formulas,
    pub labels: &'a Formulas,
    pub units: &'a Formulas,
}

/// The values of the fields that statements of all kinds have, from which a statement is built.
pub(super) struct Shared {
    pub parameters: Formulas,
    pub definitions: Formulas,
    pub functions: Vec<(Phrase, Vec<Phrase>, Phrase)>,
    pub monitors: Formulas,
    pub initial: Formulas,
}

/// Returns whether a field has its default value, so that it is omitted in a serialized statement.
fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// A mode of a hybrid system, or a mode of one part of the system.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mode {
    /// The name of the mode of the system or of the part.
    pub name: Phrase,
    /// The states of the mode, with their rates.
    #[serde(default, skip_serializing_if = "is_default")]
    pub states: Formulas,
    /// Definitions that are valid in this mode only; they precede the definitions that are common
    /// to all modes, and the common definitions may use them.
    #[serde(default, skip_serializing_if = "is_default")]
    pub definitions: Formulas,
}

/// A guard.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Guard {
    /// The name of the guard's event. Guards with the same name in different modes define one
    /// event.
    pub name: Phrase,
    /// The names of the modes that the guard ends; may be omitted if the system has only one mode.
    #[serde(default, skip_serializing_if = "is_default")]
    pub modes: Vec<Phrase>,
    /// The guard's function, which is positive while the mode lasts; omitted if `at` is given.
    #[serde(default, skip_serializing_if = "is_default")]
    pub function: Option<Phrase>,
    /// The formula of the time of event number `n`, for events at given times.
    #[serde(default, skip_serializing_if = "is_default")]
    pub at: Option<Phrase>,
    /// The mode after the event; by default the mode does not change.
    #[serde(default, skip_serializing_if = "is_default")]
    pub next: Next,
    /// The reset: states with their values after the event; all other states keep their values.
    #[serde(default, skip_serializing_if = "is_default")]
    pub reset: Formulas,
    /// The mode that follows if infinitely many events of the guard accumulate in a finite time.
    #[serde(default, skip_serializing_if = "is_default")]
    pub accumulates_to: Next,
    /// The shortest time within which the guard's function changes; needed if this time is shorter
    /// than the rates of the states suggest.
    #[serde(default, skip_serializing_if = "is_default")]
    pub changes_in: Option<Phrase>,
}

/// The mode after an event: the first mode whose function is positive, or the last mode if no
/// function is positive.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "Following", into = "Following")]
pub struct Next(pub Vec<(Phrase, Option<Phrase>)>);

/// The possible modes after the event as written in the text, each with or without a function that
/// selects it.
#[derive(Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "expected the name of a mode, or a list of modes with functions, as in `[(\"stick\", \"F - abs(f)\"), \"slip\"]`"
)]
enum Following {
    One(Phrase),
    Several(Vec<Choice>),
}

/// A possible mode after the event, with or without a function that selects it.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Choice {
    Else(Phrase),
    If(Phrase, Phrase),
}

impl From<Following> for Next {
    fn from(following: Following) -> Self {
        let choice = |choice| match choice {
            Choice::Else(mode) => (mode, None),
            Choice::If(mode, function) => (mode, Some(function)),
        };
        Next(match following {
            Following::One(mode) => vec![(mode, None)],
            Following::Several(choices) => choices.into_iter().map(choice).collect(),
        })
    }
}

impl From<Next> for Following {
    fn from(Next(mut choices): Next) -> Self {
        let choice = |(mode, function)| match function {
            Some(function) => Choice::If(mode, function),
            None => Choice::Else(mode),
        };
        match &choices[..] {
            [(_, None)] => Following::One(choices.remove(0).0),
            _ => Following::Several(choices.into_iter().map(choice).collect()),
        }
    }
}

/// The kind of dynamics whose equilibria the equations describe; none by default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Static {
    /// No dynamics: the stability of solutions is not reported.
    #[default]
    None,
    /// First-order dynamics `z' = F(z, p)`.
    Flow,
    /// A potential whose gradient is `F`.
    Potential,
    /// Second-order dynamics `M z'' = −F(z, p)` with a positive definite mass matrix `M`.
    SecondOrder,
}

impl From<Static> for Dynamics {
    fn from(stated: Static) -> Self {
        match stated {
            Static::None => Dynamics::None,
            Static::Flow => Dynamics::Flow,
            Static::Potential => Dynamics::Potential,
            Static::SecondOrder => Dynamics::SecondOrder,
        }
    }
}
