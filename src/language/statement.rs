//! What a text states about equations, as RON has it: names and formulas, not yet understood.

use super::source::Phrase;
use crate::core::problem::Dynamics;
use serde::{Deserialize, Serialize};

/// Names with formulas.
pub type Formulas = Vec<(Phrase, Phrase)>;

/// Declares the statements of kinds of problems, each with what all of them have.
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
            /// Parameters with default values. Those that a scene gives need not be among them.
            #[serde(skip_serializing_if = "is_default")]
            pub parameters: Formulas,
            /// Names for formulas; each may use those before it.
            #[serde(skip_serializing_if = "is_default")]
            pub definitions: Formulas,
            /// Functions: name, arguments, formula.
            #[serde(skip_serializing_if = "is_default")]
            pub functions: Vec<(Phrase, Vec<Phrase>, Phrase)>,
            /// Further columns.
            #[serde(skip_serializing_if = "is_default")]
            pub monitors: Formulas,
            /// Values of states, where motion and branches begin.
            #[serde(skip_serializing_if = "is_default")]
            pub initial: Formulas,
            /// Typical sizes of states, where they are far from 1; of systems with events that of
            /// time as well, under the name `t`.
            #[serde(skip_serializing_if = "is_default")]
            pub scales: Formulas,
            /// What axes say instead of names of states, parameters, monitors, or of time, `t`.
            #[serde(skip_serializing_if = "is_default")]
            pub labels: Formulas,
            /// The units of states, parameters, monitors, or of time, `t`, which axes show.
            #[serde(skip_serializing_if = "is_default")]
            pub units: Formulas,
        }

        impl $name {
            /// The names of what is stated.
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
        /// The period in which time enters, if it does.
        period: Option<Phrase>,
    }

    /// Equations `F = 0`.
    Residual {
        /// Unknowns with what vanishes.
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
        /// The boundary conditions: functions that vanish, of the states at the ends, as `u(0)` and
        /// `u(1)`.
        conditions: Vec<Phrase>,
        /// Formulas whose integrals vanish.
        integrals: Vec<Phrase>,
        /// Further unknown numbers.
        unknowns: Vec<Phrase>,
        /// How long the interval is; 1 by default.
        length: Option<Phrase>,
    }

    /// A hybrid system.
    HybridEquations {
        /// States with their rates that all modes have, before their own.
        states: Formulas,
        /// The modes.
        modes: Vec<Mode>,
        /// In place of modes, the alternatives of several parts: the modes are all combinations.
        product: Vec<Vec<Mode>>,
        /// The guards.
        guards: Vec<Guard>,
        /// The period in which time enters, if it does.
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
        /// States with their rates on the surface; if they are left out, the convex combination of
        /// both fields that is tangent to it.
        sliding: Formulas,
        /// What is positive where sliding is held against leaving to a side, `above` or `below`; if
        /// it is left out, the speed at which the field of the side approaches the surface.
        holds: Formulas,
        /// The names of the modes `above`, `below` and `sliding`, and of the event `surface`, if
        /// they are others.
        names: Formulas,
        /// The period in which time enters, if it does.
        period: Option<Phrase>,
    }
}

/// The parts that all statements have.
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

/// The same, to make a statement of them.
pub(super) struct Shared {
    pub parameters: Formulas,
    pub definitions: Formulas,
    pub functions: Vec<(Phrase, Vec<Phrase>, Phrase)>,
    pub monitors: Formulas,
    pub initial: Formulas,
}

/// Whether a field is left out where a statement is written.
fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// A mode of motion, or an alternative of one of its parts.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mode {
    /// Its name.
    pub name: Phrase,
    /// States with their rates.
    #[serde(default, skip_serializing_if = "is_default")]
    pub states: Formulas,
    /// Names for formulas in this mode, before those of all modes, which may use them.
    #[serde(default, skip_serializing_if = "is_default")]
    pub definitions: Formulas,
}

/// A guard.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Guard {
    /// The event's name. Guards of one name in different modes are one event, whichever mode it
    /// comes in.
    pub name: Phrase,
    /// The modes that end there; may be left out where there is one mode only.
    #[serde(default, skip_serializing_if = "is_default")]
    pub modes: Vec<Phrase>,
    /// The function that is positive while the mode lasts; left out where `at` is given.
    #[serde(default, skip_serializing_if = "is_default")]
    pub function: Option<Phrase>,
    /// The time of event number `n`, for an event that comes at given times.
    #[serde(default, skip_serializing_if = "is_default")]
    pub at: Option<Phrase>,
    /// The mode that follows; the same one if it is left out.
    #[serde(default, skip_serializing_if = "is_default")]
    pub next: Next,
    /// States with their values after the event; others keep theirs.
    #[serde(default, skip_serializing_if = "is_default")]
    pub reset: Formulas,
    /// The mode that follows where events accumulate.
    #[serde(default, skip_serializing_if = "is_default")]
    pub accumulates_to: Next,
    /// The shortest time in which it changes, where that is less than the rates of states tell.
    #[serde(default, skip_serializing_if = "is_default")]
    pub changes_in: Option<Phrase>,
}

/// A mode that follows: the first one whose function is positive, or else the last one.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "Following", into = "Following")]
pub struct Next(pub Vec<(Phrase, Option<Phrase>)>);

/// The modes that may follow, as they are written.
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

/// The dynamics that equations describe: none, unless it is stated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Static {
    /// They are no motion's: no stability is reported.
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
