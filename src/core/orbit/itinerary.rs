//! Itineraries: the sequences of modes and events of hybrid orbits.

use crate::core::hybrid::{Guard, HybridEquations, Mode};
use crate::core::problem::{UnknownName, position};

/// A leg of an itinerary: motion in a mode until a guard vanishes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Leg {
    /// The mode of the leg.
    pub mode: usize,
    /// The guard at which the leg ends; `None` if the orbit has no events.
    pub exit: Option<usize>,
    /// Whether the leg represents infinitely many events: it begins just after an event of the
    /// guard `exit`, and ends where the subsequent events of this guard accumulate.
    pub accumulates: bool,
}

impl Leg {
    /// Creates a leg: motion in a mode until a guard vanishes.
    pub fn new(mode: usize, exit: Option<usize>) -> Self {
        Leg { mode, exit, accumulates: false }
    }
}

/// The itinerary of a hybrid orbit in one cycle: its legs, each ended by an event, and the number
/// of forcing periods in the cycle. The last event of the cycle leads to the first leg.
///
/// An itinerary is written as one word for each leg, `mode:event`; the number of periods precedes
/// the words if it is not 1: `2* slip:rest stick:impact`. The itinerary of an orbit without events
/// is the name of its mode. `flight:impact+` denotes infinitely many impacts after an earlier
/// impact, up to their accumulation.
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
    /// The number of forcing periods in a cycle of the orbit.
    pub periods: usize,
}

/// The suffix that, after the name of an event, denotes infinitely many of these events.
const ALL: &str = "+";

/// Reasons why an itinerary is invalid.
#[derive(Clone, Debug, PartialEq, Eq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum ItineraryError {
    /// The itinerary does not contain any legs.
    #[error("the itinerary `{0}` has no legs")]
    #[diagnostic(help("write each leg as `mode:event`"))]
    Empty(String),
    /// The number of forcing periods of the itinerary is 0.
    #[error("the itinerary `{0}` has 0 forcing periods")]
    #[diagnostic(help("give the itinerary at least one forcing period"))]
    Periods(String),
    /// A mode or event that the itinerary names does not exist.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Unknown(#[from] UnknownName),
    /// The number of a mode or guard in the itinerary is out of range.
    #[error(
        "leg {leg} of the itinerary refers to the {what} with number {number}, but the system has \
         only {count}, numbered from 0"
    )]
    Number {
        /// The leg.
        leg: usize,
        /// The kind of number that is out of range: `mode` or `guard`.
        what: &'static str,
        /// The number of the mode or guard that is out of range.
        number: usize,
        /// The number of modes or guards of the system.
        count: usize,
    },
    /// A leg has no event, although the itinerary has several legs.
    #[error(
        "the leg `{0}` has no event, but every leg of an itinerary with several legs needs an event"
    )]
    Endless(String),
}

impl Itinerary {
    /// Creates the itinerary of an orbit that stays in one mode without events.
    pub fn smooth(mode: usize, periods: usize) -> Self {
        Itinerary { legs: vec![Leg::new(mode, None)], periods }
    }

    /// Whether the itinerary has no events.
    pub(super) fn is_smooth(&self) -> bool {
        self.legs.iter().any(|leg| leg.exit.is_none())
    }

    /// Checks that the itinerary contains legs, and that their modes and guards exist.
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

    /// Returns the itinerary of the cycle repeated several times.
    pub(super) fn repeated(&self, times: usize) -> Self {
        Itinerary { legs: self.legs.repeat(times), periods: self.periods * times }
    }

    /// Returns the first half of a cycle that consists of two equal halves; `None` for other
    /// cycles. If `forcing` is true, the number of forcing periods is also halved.
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

    /// Parses the text of an itinerary of a system.
    ///
    /// # Errors
    /// [`ItineraryError`] if the text is not a valid itinerary of the system.
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

    /// Writes the itinerary with the names of the system's modes and events, in the format that
    /// [`read`](Self::read) parses.
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
        // The last of infinitely many events may end another mode.
        let own = |k: &usize| all.is_some() || guards[*k].ends(mode);
        let own: Vec<usize> = (0..guards.len()).filter(own).collect();
        let names = own.iter().map(|k| &guards[*k].name);
        position(&format!("event of mode `{name}`"), event, names).map(|k| own[k])
    });
    Ok(Leg { mode, exit: exit.transpose()?, accumulates: all.is_some() })
}
