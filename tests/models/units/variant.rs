//! Units in which a model is stated.

use std::fmt;

/// The position of a decoupled state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Other {
    First,
    Last,
}

/// The units, the order and the neighbours of a model's states.
#[derive(Clone, Debug)]
pub struct Variant {
    /// The power of ten of each state; empty if states keep their units.
    pub states: Vec<i32>,
    pub parameter: f64,
    pub time: f64,
    /// Whether the states come in the reversed order.
    pub reversed: bool,
    pub other: Option<Other>,
    /// Whether the units of states are stated as scales.
    pub stated: bool,
}

impl Default for Variant {
    fn default() -> Self {
        let (states, parameter, time) = (Vec::new(), 1.0, 1.0);
        Variant { states, parameter, time, reversed: false, other: None, stated: true }
    }
}

impl Variant {
    /// A decoupled state in front of the others or after them.
    pub fn beside(other: Other) -> Variant {
        Variant { other: Some(other), ..Variant::default() }
    }

    pub fn of_states(powers: &[i32]) -> Self {
        Variant { states: powers.to_vec(), ..Variant::default() }
    }

    /// States in units that are not stated as scales.
    pub fn of_unscaled_states(powers: &[i32]) -> Self {
        Variant { stated: false, ..Variant::of_states(powers) }
    }

    pub fn of_parameters(power: i32) -> Self {
        Variant { parameter: ten_to(power), ..Variant::default() }
    }

    pub fn of_time(power: i32) -> Self {
        Variant { time: ten_to(power), ..Variant::default() }
    }

    pub fn reversed() -> Self {
        Variant { reversed: true, ..Variant::default() }
    }

    /// The factor by which a state is multiplied.
    pub fn state(&self, index: usize) -> f64 {
        self.states.get(index).map_or(1.0, |power| ten_to(*power))
    }
}

/// The power of ten that is nearest to the exact one.
fn ten_to(power: i32) -> f64 {
    format!("1e{power}").parse().expect("a number")
}

impl fmt::Display for Variant {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Variant { states, parameter, time, reversed, other, stated } = self;
        write!(f, "states {states:?} parameters {parameter:e} time {time:e}")?;
        if !*stated {
            write!(f, " without scales")?;
        }
        if *reversed {
            write!(f, " reversed")?;
        }
        other.map_or(Ok(()), |other| write!(f, " other {other:?}"))
    }
}
