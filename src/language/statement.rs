//! What a text states about equations, as RON has it: names and formulas, not yet understood.

use super::source::Phrase;
use crate::core::problem::Dynamics;
use serde::de::{Deserialize, Deserializer, SeqAccess, Visitor};
use std::fmt;

/// Names with formulas.
pub type Formulas = Vec<(Phrase, Phrase)>;

/// Declares the statements of kinds of problems, each with what all of them have.
macro_rules! statements {
    ($(
        $(#[$docs:meta])*
        $name:ident { $($(#[$field_docs:meta])* $field:ident: $type:ty,)* }
    )*) => {$(
        $(#[$docs])*
        #[derive(Clone, Debug, Default, PartialEq, serde::Deserialize)]
        #[serde(default, deny_unknown_fields)]
        pub struct $name {
            $($(#[$field_docs])* pub $field: $type,)*
            /// Parameters with default values. Those that a scene gives need not be among them.
            pub parameters: Formulas,
            /// Names for formulas; each may use those before it.
            pub definitions: Formulas,
            /// Functions: name, arguments, formula.
            pub functions: Vec<(Phrase, Vec<Phrase>, Phrase)>,
            /// Further columns.
            pub monitors: Formulas,
            /// Values of states, where motion and branches begin.
            pub initial: Formulas,
        }

        impl $name {
            /// The names of what is stated.
            pub const FIELDS: &[&str] = &[
                $(stringify!($field),)* "parameters", "definitions", "functions", "monitors", "initial",
            ];

            pub(super) fn common(&self) -> Common<'_> {
                let $name { parameters, definitions, functions, initial, .. } = self;
                Common { parameters, definitions, functions, initial }
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
        /// Typical sizes of states, where they are far from 1.
        scales: Formulas,
    }

    /// Equations `F = 0`.
    Residual {
        /// Unknowns with what vanishes.
        unknowns: Formulas,
        /// The dynamics that the equations describe.
        dynamics: Static,
        /// Typical sizes of unknowns, where they are far from 1.
        scales: Formulas,
    }

    /// A map.
    Map {
        /// States with their next values.
        states: Formulas,
        /// Typical sizes of states, where they are far from 1.
        scales: Formulas,
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
        /// Typical sizes of states, where they are far from 1.
        scales: Formulas,
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
        /// Typical sizes of states, where they are far from 1; that of time under the name `t`.
        scales: Formulas,
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
        /// Typical sizes of states, where they are far from 1; that of time under the name `t`.
        scales: Formulas,
    }
}

/// The parts that all statements have.
#[derive(Clone, Copy)]
pub(super) struct Common<'a> {
    pub parameters: &'a Formulas,
    pub definitions: &'a Formulas,
    pub functions: &'a [(Phrase, Vec<Phrase>, Phrase)],
    pub initial: &'a Formulas,
}

/// A mode of motion, or an alternative of one of its parts.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mode {
    /// Its name.
    pub name: Phrase,
    /// States with their rates.
    #[serde(default)]
    pub states: Formulas,
    /// Names for formulas in this mode, before those of all modes, which may use them.
    #[serde(default)]
    pub definitions: Formulas,
}

/// A guard.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Guard {
    /// The event's name. Guards of one name in different modes are one event, whichever mode it
    /// comes in.
    pub name: Phrase,
    /// The modes that end there; may be left out where there is one mode only.
    #[serde(default)]
    pub modes: Vec<Phrase>,
    /// The function that is positive while the mode lasts; left out where `at` is given.
    #[serde(default)]
    pub function: Option<Phrase>,
    /// The time of event number `n`, for an event that comes at given times.
    #[serde(default)]
    pub at: Option<Phrase>,
    /// The mode that follows; the same one if it is left out.
    #[serde(default)]
    pub next: Next,
    /// States with their values after the event; others keep theirs.
    #[serde(default)]
    pub reset: Formulas,
    /// The mode that follows where events accumulate.
    #[serde(default)]
    pub accumulates_to: Next,
    /// The shortest time in which it changes, where that is less than the rates of states tell.
    #[serde(default)]
    pub changes_in: Option<Phrase>,
}

/// A mode that follows: the first one whose function is positive, or else the last one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Next(pub Vec<(Phrase, Option<Phrase>)>);

impl<'de> Deserialize<'de> for Next {
    /// A name; or names with functions, the last one with or without.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader;
        impl<'de> Visitor<'de> for Reader {
            type Value = Next;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("the name of a mode, or a list of names with functions")
            }

            fn visit_borrowed_str<E: serde::de::Error>(self, text: &'de str) -> Result<Next, E> {
                let name =
                    Phrase::deserialize(serde::de::value::BorrowedStrDeserializer::new(text))?;
                Ok(Next(vec![(name, None)]))
            }

            fn visit_str<E>(self, text: &str) -> Result<Next, E> {
                Ok(Next(vec![(text.into(), None)]))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Next, A::Error> {
                let mut next = Vec::new();
                while let Some(Choice(name, function)) = items.next_element()? {
                    next.push((name, function));
                }
                Ok(Next(next))
            }
        }
        deserializer.deserialize_any(Reader)
    }
}

/// A mode with its function, or without.
struct Choice(Phrase, Option<Phrase>);

impl<'de> Deserialize<'de> for Choice {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader;
        impl<'de> Visitor<'de> for Reader {
            type Value = Choice;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str(
                    "a mode with its function, as in `(\"stick\", \"F - abs(f)\")`, or its name",
                )
            }

            fn visit_borrowed_str<E: serde::de::Error>(self, text: &'de str) -> Result<Choice, E> {
                let name =
                    Phrase::deserialize(serde::de::value::BorrowedStrDeserializer::new(text))?;
                Ok(Choice(name, None))
            }

            fn visit_str<E>(self, text: &str) -> Result<Choice, E> {
                Ok(Choice(text.into(), None))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Choice, A::Error> {
                let missing = || serde::de::Error::custom("expected the name of a mode");
                let name = items.next_element()?.ok_or_else(missing)?;
                Ok(Choice(name, items.next_element()?))
            }
        }
        deserializer.deserialize_any(Reader)
    }
}

/// The dynamics that equations describe: none, unless it is stated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize)]
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
