//! Itineraries: what a hybrid orbit goes through.

use crate::core::hybrid::{Guard, HybridEquations, Mode};
use std::fmt::{Display, Formatter, Write};

/// A leg of an itinerary: motion in a mode until a guard vanishes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Leg {
    /// The mode.
    pub mode: usize,
    /// The guard at which the leg ends; `None` if nothing happens on the whole orbit.
    pub exit: Option<usize>,
}

/// What a hybrid orbit goes through in one cycle: legs, each ended by an event, the last of which leads to the
/// first; and, under forcing, how many of its periods that takes.
///
/// It is written as one word for each leg, `mode:event`, and a number of periods if there are several:
/// `2* slip:rest stick:impact`. An orbit without events is its mode alone.
///
/// ```
/// use tangency::core::orbit::Itinerary;
/// # use tangency::core::{hybrid::{Guard, HybridSystem, Mode}, scalar::Scalar};
/// # struct Ball;
/// # impl HybridSystem for Ball {
/// #     fn modes(&self) -> Vec<Mode> { vec![Mode::new("flight", ["height", "velocity"])] }
/// #     fn guards(&self) -> Vec<Guard> { vec![Guard::new("bounce", [0])] }
/// #     fn parameters(&self) -> Vec<String> { vec![] }
/// #     fn field<T: Scalar>(&self, _: usize, _: T, x: &[T], _: &[T], f: &mut [T]) { f[0] = x[1]; }
/// #     fn guard<T: Scalar>(&self, _: usize, _: usize, _: T, x: &[T], _: &[T]) -> T { x[0] }
/// #     fn reset<T: Scalar>(
/// #         &self, _: usize, _: (usize, usize), _: T, x: &[T], _: &[T], after: &mut [T],
/// #     ) {
/// #         after.copy_from_slice(x);
/// #     }
/// #     fn next_mode(&self, _: usize, _: usize, _: f64, _: &[f64], _: &[f64]) -> usize { 0 }
/// # }
/// let itinerary = Itinerary::read("2* flight:bounce flight:bounce", &Ball)?;
/// assert_eq!((itinerary.periods, itinerary.legs.len()), (2, 2));
/// assert_eq!(itinerary.written(&Ball), "2* flight:bounce flight:bounce");
/// assert!(Itinerary::read("flight:landing", &Ball).is_err());
/// # Ok::<(), tangency::core::orbit::ItineraryError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Itinerary {
    /// The legs of one cycle.
    pub legs: Vec<Leg>,
    /// The periods of the forcing that a cycle takes.
    pub periods: usize,
}

/// Why an itinerary has no meaning.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ItineraryError {
    /// There is no leg.
    #[error("the itinerary `{0}` has no legs: write each as `mode:event`")]
    Empty(String),
    /// A cycle takes no period.
    #[error("the itinerary `{0}` takes no period of the forcing: give at least 1")]
    Periods(String),
    /// A mode that there is not.
    #[error("there is no mode `{name}`: there are {known}")]
    Mode {
        /// The name.
        name: String,
        /// The modes.
        known: String,
    },
    /// An event that there is not in a mode.
    #[error("mode `{mode}` has no event `{name}`: it ends by {known}")]
    Event {
        /// The mode.
        mode: String,
        /// The name.
        name: String,
        /// The events of the mode.
        known: String,
    },
    /// A leg that does not end, among others.
    #[error("the leg `{mode}` does not end: an itinerary of several legs names the event of each")]
    Endless {
        /// The mode.
        mode: String,
    },
}

impl Itinerary {
    /// An orbit in one mode without events.
    pub fn smooth(mode: usize, periods: usize) -> Self {
        Itinerary { legs: vec![Leg { mode, exit: None }], periods }
    }

    /// Whether there are no events.
    pub fn is_smooth(&self) -> bool {
        self.legs.iter().any(|leg| leg.exit.is_none())
    }

    /// The same cycle, gone through several times.
    pub fn repeated(&self, times: usize) -> Self {
        Itinerary { legs: self.legs.repeat(times), periods: self.periods * times }
    }

    /// Reads an itinerary of a system.
    ///
    /// # Errors
    /// [`ItineraryError`] if it has no meaning for the system.
    pub fn read(text: &str, system: &dyn HybridEquations) -> Result<Self, ItineraryError> {
        let (periods, words) = match text.split_once('*') {
            Some((periods, words)) => (periods.trim().parse().unwrap_or(0), words),
            None => (1, text),
        };
        if periods == 0 {
            return Err(ItineraryError::Periods(text.into()));
        }
        let (modes, guards) = (system.modes(), system.guards());
        let legs: Vec<Leg> = words
            .split_whitespace()
            .map(|word| read_leg(word, &modes, &guards))
            .collect::<Result<_, _>>()?;
        let itinerary = Itinerary { legs, periods };
        itinerary.check(&modes, text)?;
        Ok(itinerary)
    }

    fn check(&self, modes: &[Mode], text: &str) -> Result<(), ItineraryError> {
        let endless = self.legs.iter().find(|leg| leg.exit.is_none());
        match endless {
            _ if self.legs.is_empty() => Err(ItineraryError::Empty(text.into())),
            Some(leg) if self.legs.len() > 1 => {
                Err(ItineraryError::Endless { mode: modes[leg.mode].name.clone() })
            }
            _ => Ok(()),
        }
    }

    /// The itinerary in the words of a system, as [`read`](Self::read) understands it.
    pub fn written(&self, system: &dyn HybridEquations) -> String {
        self.in_words(&system.modes(), &system.guards())
    }

    /// The itinerary in the names of modes and guards.
    pub(super) fn in_words(&self, modes: &[Mode], guards: &[Guard]) -> String {
        let mut text = String::new();
        if self.periods != 1 {
            // Writing to a string does not fail.
            let _ = write!(text, "{}*", self.periods);
        }
        for leg in &self.legs {
            let separator = if text.is_empty() { "" } else { " " };
            let _ = write!(text, "{separator}{}", Words { leg, modes, guards });
        }
        text
    }
}

/// One leg in words.
struct Words<'a> {
    leg: &'a Leg,
    modes: &'a [Mode],
    guards: &'a [Guard],
}

impl Display for Words<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.modes[self.leg.mode].name)?;
        match self.leg.exit {
            Some(guard) => write!(f, ":{}", self.guards[guard].name),
            None => Ok(()),
        }
    }
}

fn read_leg(word: &str, modes: &[Mode], guards: &[Guard]) -> Result<Leg, ItineraryError> {
    let (name, event) = match word.split_once(':') {
        Some((name, event)) => (name, Some(event)),
        None => (word, None),
    };
    let listed = |names: Vec<&str>| names.join(", ");
    let mode = modes.iter().position(|mode| mode.name == name).ok_or_else(|| {
        let known = listed(modes.iter().map(|mode| mode.name.as_str()).collect());
        ItineraryError::Mode { name: name.into(), known }
    })?;
    let of_mode = || guards.iter().enumerate().filter(|(_, guard)| guard.ends(mode));
    let exit = event.map(|event| {
        of_mode().find(|(_, guard)| guard.name == event).map(|(k, _)| k).ok_or_else(|| {
            let known = listed(of_mode().map(|(_, guard)| guard.name.as_str()).collect());
            ItineraryError::Event { mode: name.into(), name: event.into(), known }
        })
    });
    Ok(Leg { mode, exit: exit.transpose()? })
}
