//! Statements of equations as parsed from RON: names and formulas that are not yet resolved.

use super::source::Phrase;
use crate::core::problem::Dynamics;
use serde::{Deserialize, Serialize};

/// Names with formulas.
pub type Formulas = Vec<(Phrase, Phrase)>;

/// Declares the statements of the kinds of problems, each with the common fields.
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
            /// Parameters with default values. Parameters that a scene gives may be omitted.
            #[serde(skip_serializing_if = "is_default")]
            pub parameters: Formulas,
            /// Names for formulas; each may use the definitions before it.
            #[serde(skip_serializing_if = "is_default")]
            pub definitions: Formulas,
            /// Functions: name, arguments, formula.
            #[serde(skip_serializing_if = "is_default")]
            pub functions: Vec<(Phrase, Vec<Phrase>, Phrase)>,
            /// Additional columns.
            #[serde(skip_serializing_if = "is_default")]
            pub monitors: Formulas,
            /// Initial values of states, for motion and branches.
            #[serde(skip_serializing_if = "is_default")]
            pub initial: Formulas,
            /// Typical sizes of states that are far from 1; for systems with events also of time,
            /// under the name `t`.
            #[serde(skip_serializing_if = "is_default")]
            pub scales: Formulas,
            /// Labels of axes that replace the names of states, parameters, monitors or time (`t`).
            #[serde(skip_serializing_if = "is_default")]
            pub labels: Formulas,
            /// The units of states, parameters, monitors or time (`t`), shown on axes.
            #[serde(skip_serializing_if = "is_default")]
            pub units: Formulas,
        }

        impl $name {
            /// The names of the fields.
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
    /// A vector field: the rates of states.
    Equations {
        /// States with their rates; `u[i=1..n]` is an array.
        states: Formulas,
        /// The period of the forcing, for equations that depend on time.
        period: Option<Phrase>,
    }

    /// Equations `F = 0`.
    Residual {
        /// Unknowns with the expressions that vanish.
        unknowns: Formulas,
        /// The dynamics that the equations describe.
        dynamics: Static,
    }

    /// A map.
    Map {
        /// States with their next values.
        states: Formulas,
    }

    /// A boundary-value problem.
    Boundary {
        /// States with their rates.
        states: Formulas,
        /// The boundary conditions: functions of the states at the ends, such as `u(0)` and `u(1)`,
        /// that vanish.
        conditions: Vec<Phrase>,
        /// Formulas whose integrals vanish.
        integrals: Vec<Phrase>,
        /// Additional unknown numbers.
        unknowns: Vec<Phrase>,
        /// The length of the interval; 1 by default.
        length: Option<Phrase>,
    }

    /// A hybrid system.
    HybridEquations {
        /// The states common to all modes with their rates, before the modes' own states.
        states: Formulas,
        /// The modes.
        modes: Vec<Mode>,
        /// Instead of modes, the alternatives of several parts: the modes are all combinations.
        product: Vec<Vec<Mode>>,
        /// The guards.
        guards: Vec<Guard>,
        /// The period of the forcing, for equations that depend on time.
        period: Option<Phrase>,
    }

    /// A Filippov system: two fields and a surface between them.
    FilippovEquations {
        /// States with their rates above the surface.
        above: Formulas,
        /// The same states with their rates below.
        below: Formulas,
        /// The function that vanishes on the surface, positive above and negative below.
        surface: Option<Phrase>,
        /// States with their rates on the surface; by default the convex combination of the two
        /// fields that is tangent to the surface.
        sliding: Formulas,
        /// Functions that are positive while sliding is held against leaving to a side, `above` or
        /// `below`; by default, the speed at which the field of that side approaches the surface.
        holds: Formulas,
        /// New names for the modes `above`, `below` and `sliding`, and for the event `surface`.
        names: Formulas,
        /// The period of the forcing, for equations that depend on time.
        period: Option<Phrase>,
    }
}

/// References to the fields that all statements have.
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

/// The fields that all statements have, to build a statement.
pub(super) struct Shared {
    pub parameters: Formulas,
    pub definitions: Formulas,
    pub functions: Vec<(Phrase, Vec<Phrase>, Phrase)>,
    pub monitors: Formulas,
    pub initial: Formulas,
}

/// Returns whether a field is omitted in a serialized statement.
fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// A mode of motion, or an alternative of one of its parts.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mode {
    /// The name of the mode or alternative.
    pub name: Phrase,
    /// States with their rates.
    #[serde(default, skip_serializing_if = "is_default")]
    pub states: Formulas,
    /// Names for formulas in this mode; they come before the definitions common to all modes, which
    /// may use them.
    #[serde(default, skip_serializing_if = "is_default")]
    pub definitions: Formulas,
}

/// A guard.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Guard {
    /// The name of the event. Guards with the same name in different modes define a single event.
    pub name: Phrase,
    /// The modes that the guard ends; may be omitted if there is only one mode.
    #[serde(default, skip_serializing_if = "is_default")]
    pub modes: Vec<Phrase>,
    /// The function that is positive while the mode lasts; omitted if `at` is given.
    #[serde(default, skip_serializing_if = "is_default")]
    pub function: Option<Phrase>,
    /// The time of event number `n`, for an event at given times.
    #[serde(default, skip_serializing_if = "is_default")]
    pub at: Option<Phrase>,
    /// The next mode; by default the same mode.
    #[serde(default, skip_serializing_if = "is_default")]
    pub next: Next,
    /// States with their values after the event; other states keep their values.
    #[serde(default, skip_serializing_if = "is_default")]
    pub reset: Formulas,
    /// The mode that follows if events accumulate.
    #[serde(default, skip_serializing_if = "is_default")]
    pub accumulates_to: Next,
    /// The shortest time in which the guard changes, if shorter than the rates of states suggest.
    #[serde(default, skip_serializing_if = "is_default")]
    pub changes_in: Option<Phrase>,
}

/// The next mode: the first one whose function is positive, or else the last one.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "Following", into = "Following")]
pub struct Next(pub Vec<(Phrase, Option<Phrase>)>);

/// The possible next modes, as written.
#[derive(Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "expected the name of a mode, or a list of modes with functions, as in `[(\"stick\", \"F - abs(f)\"), \"slip\"]`"
)]
enum Following {
    One(Phrase),
    Several(Vec<Choice>),
}

/// A mode without a function, or with one.
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

/// The dynamics that equations describe; none by default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Static {
    /// No dynamics: stability is not reported.
    #[default]
    None,
    /// `z' = F(z, p)`.
    Flow,
    /// `F` is the gradient of a potential.
    Potential,
    /// `M z'' = −F(z, p)` with a positive definite `M`.
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
