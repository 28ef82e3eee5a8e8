//! Itineraries: what a hybrid orbit goes through.

use crate::core::hybrid::{Guard, HybridEquations, Mode};
use crate::core::problem::{UnknownName, position};

/// A leg of an itinerary: motion in a mode until a guard vanishes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Leg {
    /// The mode, in which the leg begins.
    pub mode: usize,
    /// The guard at which the leg ends; `None` if nothing happens on the whole orbit.
    pub exit: Option<usize>,
    /// Whether it begins just behind an event of this guard, and lasts for the infinitely many that
    /// follow, up to their accumulation.
    pub accumulates: bool,
}

impl Leg {
    /// Motion in a mode until a guard vanishes.
    pub fn new(mode: usize, exit: Option<usize>) -> Self {
        Leg { mode, exit, accumulates: false }
    }
}

/// What a hybrid orbit goes through in one cycle: legs, each ended by an event, the last of which
/// leads to the first; and, under forcing, how many of its periods that takes.
///
/// It is written as one word for each leg, `mode:event`, and a number of periods if there are
/// several: `2* slip:rest stick:impact`. An orbit without events is its mode alone.
/// `flight:impact+` stands for the infinitely many impacts that follow one before, up to their
/// accumulation.
///
/// ```
/// use tangency::core::orbit::Itinerary;
/// use tangency::problems::classic::ImpactOscillator;
/// let itinerary = Itinerary::read("2* flight:impact flight:impact", &ImpactOscillator)?;
/// assert_eq!((itinerary.periods, itinerary.legs.len()), (2, 2));
/// assert_eq!(itinerary.written(&ImpactOscillator), "2* flight:impact flight:impact");
/// assert!(Itinerary::read("flight:landing", &ImpactOscillator).is_err());
/// # Ok::<(), tangency::core::orbit::ItineraryError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Itinerary {
    /// The legs of one cycle.
    pub legs: Vec<Leg>,
    /// The periods of the forcing that a cycle takes.
    pub periods: usize,
}

/// Behind the name of an event: infinitely many of them.
const ALL: &str = "+";

/// Why an itinerary has no meaning.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ItineraryError {
    /// There is no leg.
    #[error("the itinerary `{0}` has no legs: write each as `mode:event`")]
    Empty(String),
    /// A cycle takes no period.
    #[error("the itinerary `{0}` takes no period of the forcing: give at least 1")]
    Periods(String),
    /// A mode that there is not, or an event that there is not in a mode.
    #[error("{0}")]
    Unknown(#[from] UnknownName),
    /// A leg refers to a mode or an event by a number that does not exist.
    #[error(
        "leg {leg} of the itinerary has {what} {number}, but there are {count} of them; all are counted from 0"
    )]
    Number {
        /// The leg.
        leg: usize,
        /// Either `mode` or `guard`.
        what: &'static str,
        /// The number of the mode or guard.
        number: usize,
        /// How many modes or guards the system has.
        count: usize,
    },
    /// A leg that does not end, among others.
    #[error("the leg `{0}` does not end: an itinerary of several legs names the event of each")]
    Endless(String),
}

impl Itinerary {
    /// An orbit in one mode without events.
    pub fn smooth(mode: usize, periods: usize) -> Self {
        Itinerary { legs: vec![Leg::new(mode, None)], periods }
    }

    /// Whether there are no events.
    pub(super) fn is_smooth(&self) -> bool {
        self.legs.iter().any(|leg| leg.exit.is_none())
    }

    /// Checks the numbers of modes and guards, and that there are legs.
    pub(super) fn check(&self, modes: &[Mode], guards: &[Guard]) -> Result<(), ItineraryError> {
        if self.legs.is_empty() {
            return Err(ItineraryError::Empty(String::new()));
        }
        if self.periods == 0 {
            return Err(ItineraryError::Periods(String::new()));
        }
        for (leg, of) in self.legs.iter().enumerate() {
            let numbers = [("mode", Some(of.mode), modes.len()), ("guard", of.exit, guards.len())];
            for (what, number, count) in numbers {
                if let Some(number) = number.filter(|number| *number >= count) {
                    return Err(ItineraryError::Number { leg, what, number, count });
                }
            }
        }
        Ok(())
    }

    /// The same cycle, gone through several times.
    pub(super) fn repeated(&self, times: usize) -> Self {
        Itinerary { legs: self.legs.repeat(times), periods: self.periods * times }
    }

    /// Half of a cycle that is gone through twice, perhaps one without events; `None` for others.
    /// Only under `forcing` it takes a number of periods.
    pub(super) fn halved(&self, forcing: bool) -> Option<Self> {
        let (first, second) = self.legs.split_at(self.legs.len() / 2);
        let (legs, twice) = match first.is_empty() {
            true => (second, forcing),
            false => (first, first == second),
        };
        let even = self.periods.is_multiple_of(2);
        let periods = if even { self.periods / 2 } else { self.periods };
        (twice && (even || !forcing)).then(|| Itinerary { legs: legs.to_vec(), periods })
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
        match legs.iter().find(|leg| leg.exit.is_none()) {
            _ if legs.is_empty() => Err(ItineraryError::Empty(text.into())),
            Some(leg) if legs.len() > 1 => {
                Err(ItineraryError::Endless(modes[leg.mode].name.clone()))
            }
            _ => Ok(Itinerary { legs, periods }),
        }
    }

    /// The itinerary in the words of a system, as [`read`](Self::read) understands it.
    pub fn written(&self, system: &dyn HybridEquations) -> String {
        let (modes, guards) = (system.modes(), system.guards());
        let periods = (self.periods != 1).then(|| format!("{}*", self.periods));
        let word = |leg: &Leg| {
            let all = if leg.accumulates { ALL } else { "" };
            let exit = leg.exit.map(|guard| format!(":{}{all}", guards[guard].name));
            modes[leg.mode].name.clone() + &exit.unwrap_or_default()
        };
        periods.into_iter().chain(self.legs.iter().map(word)).collect::<Vec<_>>().join(" ")
    }
}

fn read_leg(word: &str, modes: &[Mode], guards: &[Guard]) -> Result<Leg, ItineraryError> {
    let (name, event) = match word.split_once(':') {
        Some((name, event)) => (name, Some(event)),
        None => (word, None),
    };
    let mode = position("mode", name, modes.iter().map(|mode| &mode.name))?;
    let known = |event: &str| guards.iter().any(|guard| guard.name == event);
    let all = event.and_then(|event| event.strip_suffix(ALL)).filter(|_| !event.is_some_and(known));
    let exit = all.or(event).map(|event| {
        // Where infinitely many accumulate the last ones may be in another mode.
        let own = |k: &usize| all.is_some() || guards[*k].ends(mode);
        let own: Vec<usize> = (0..guards.len()).filter(own).collect();
        let names = own.iter().map(|k| &guards[*k].name);
        position(&format!("event of mode `{name}`"), event, names).map(|k| own[k])
    });
    Ok(Leg { mode, exit: exit.transpose()?, accumulates: all.is_some() })
}
