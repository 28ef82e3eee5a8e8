//! Extremes of a scalar along a motion, from its possible turning points.

use super::measure::Measure;

/// A place on a motion, and the value of a scalar there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::core) struct Sighting<P> {
    pub place: P,
    pub value: f64,
}

/// The extremes of one scalar on one leg of a motion. The scalar is monotone between visited places;
/// places are visited in order, from the beginning of the leg to its end.
#[derive(Clone, Copy, Debug)]
pub(in crate::core) struct Extremes<P> {
    largest: Sighting<P>,
    smallest: Sighting<P>,
    /// The value at the beginning of the leg.
    first: Option<f64>,
    /// The place visited last; finally, the end of the leg.
    last: Option<Sighting<P>>,
    /// The local minima inside the leg: the one to which the scalar falls from the beginning, the
    /// least one between two maxima, and the one from which the scalar rises to the end.
    leading: Option<Sighting<P>>,
    between: Option<Sighting<P>>,
    trailing: Option<Sighting<P>>,
    falling: bool,
    /// The typical size of the scalar.
    scale: f64,
    /// The threshold for a fall or rise of the scalar.
    depth: f64,
    /// The size of errors at the beginning.
    error: f64,
    /// Whether the scalar has been within `error` of zero since the beginning.
    begins: bool,
    /// Whether the scalar has risen before the last visited minimum, and whether it has risen at all.
    risen: [bool; 2],
}

/// (R) A scalar falls or rises if it changes by more than this, in units of its scale: about four
/// thousand times the rounding error.
const DEPTH: f64 = 1e-12;

/// (R) A leg begins on a surface if the guard is no larger than this, in units of its scale: well
/// above the square root of the rounding error, the accuracy of a tangential contact.
const ON: f64 = 1e-6;

impl<P: Copy + Default> Extremes<P> {
    /// Creates empty extremes. Changes smaller than `error`, in units of the scalar's typical size,
    /// do not count.
    pub fn new(scale: f64, error: f64) -> Self {
        let nowhere = |value: f64| Sighting { place: P::default(), value };
        Extremes {
            largest: nowhere(f64::NEG_INFINITY),
            smallest: nowhere(f64::INFINITY),
            first: None,
            last: None,
            leading: None,
            between: None,
            trailing: None,
            falling: false,
            scale,
            depth: DEPTH.max(error) * scale,
            error: 0.0,
            begins: true,
            risen: [false; 2],
        }
    }

    /// Sets the error of values, in units of the scale: a scalar that vanishes at the beginning of
    /// the leg has no minima until it exceeds the error.
    pub fn known_to(self, error: f64) -> Self {
        Extremes { error: error * self.scale, ..self }
    }

    /// Adds the next place of the leg.
    pub fn visit(&mut self, place: P, value: f64) {
        let here = Sighting { place, value };
        self.first.get_or_insert(value);
        if value > self.largest.value {
            self.largest = here;
        }
        if value < self.smallest.value {
            self.smallest = here;
        }
        self.begins &= value.abs() <= self.error;
        let Some(last) = self.last.replace(here) else { return };
        if self.begins {
            return;
        }
        self.visit_minimum(last, value);
        if (value - last.value).abs() > self.depth {
            self.falling = value < last.value;
        }
    }

    /// When the scalar falls again, the stored minimum is confirmed as a minimum between two maxima.
    fn visit_minimum(&mut self, last: Sighting<P>, value: f64) {
        let ([before, now], depth) = (&mut self.risen, self.depth);
        if value < last.value - depth
            && let Some(dip) = self.trailing.take()
        {
            let place = if *before { &mut self.between } else { &mut self.leading };
            if place.is_none_or(|least| dip.value < least.value) {
                *place = Some(dip);
            }
        }
        if value > last.value + depth {
            if self.falling {
                (self.trailing, *before) = (Some(last), *now);
            }
            *now = true;
        }
    }

    /// The local minima that count as distances: those inside the leg, and the end of the leg.
    /// `vanishes` flags a scalar that vanishes in the event that begins or ends the leg. For such a
    /// scalar, neither the end nor a minimum reached monotonically from the beginning or before the
    /// end counts, since that minimum is the event itself. A reset away from the surface, as in a
    /// spiking neuron, begins a leg elsewhere.
    fn dips(&self, vanishes: [bool; 2]) -> impl Iterator<Item = Sighting<P>> {
        let [begins, ends] = vanishes;
        let begins = begins && self.first.is_none_or(|first| first.abs() <= ON * self.scale);
        let leading = self.leading.filter(|_| !begins);
        let trailing = self.trailing.filter(|_| !ends && (self.risen[0] || !begins));
        let last = self.last.filter(|_| vanishes == [false; 2]);
        leading.into_iter().chain(self.between).chain(trailing).chain(last)
    }
}

/// The extremes of a scalar over several legs.
#[derive(Clone, Copy, Debug)]
pub(in crate::core) struct Overall<P> {
    largest: Option<Sighting<P>>,
    smallest: Option<Sighting<P>>,
    /// The least local minimum.
    nearest: Option<Sighting<P>>,
}

impl<P> Default for Overall<P> {
    fn default() -> Self {
        Overall { largest: None, smallest: None, nearest: None }
    }
}

impl<P: Copy> Overall<P> {
    /// Adds a leg; `vanishes` flags a scalar that vanishes in the events that begin and end the leg.
    pub fn take<Q: Copy + Default>(
        &mut self,
        leg: &Extremes<Q>,
        vanishes: [bool; 2],
        place: impl Fn(Q) -> P,
    ) {
        let placed = |s: Sighting<Q>| Sighting { place: place(s.place), value: s.value };
        let Overall { largest, smallest, nearest } = self;
        if largest.is_none_or(|known| leg.largest.value >= known.value) {
            *largest = Some(placed(leg.largest));
        }
        if smallest.is_none_or(|known| leg.smallest.value <= known.value) {
            *smallest = Some(placed(leg.smallest));
        }
        for dip in leg.dips(vanishes) {
            if nearest.is_none_or(|known| dip.value < known.value) {
                *nearest = Some(placed(dip));
            }
        }
    }

    /// The values and factors whose weighted sum is a measure of extremes; empty for other measures.
    pub fn terms<S, D>(&self, measure: &Measure<S, D>) -> [Option<(Sighting<P>, f64)>; 2] {
        let times = |factor: f64| move |sighting| (sighting, factor);
        let (largest, smallest) = (self.largest.map(times(1.0)), self.smallest);
        let nearest = self.nearest.or(self.largest);
        match measure {
            Measure::Maximum(_) => [largest, None],
            Measure::Minimum(_) => [smallest.map(times(1.0)), None],
            Measure::Range(_) => [largest, smallest.map(times(-1.0))],
            Measure::Distance(_) => [nearest.map(times(1.0)), None],
            Measure::Penetration(_) => [nearest.map(times(-1.0)), None],
            _ => [None, None],
        }
    }

    /// The value of a measure of extremes; 0 if no leg has the scalar.
    pub fn value<S, D>(&self, measure: &Measure<S, D>) -> f64 {
        self.terms(measure).iter().flatten().map(|(s, factor)| factor * s.value).sum()
    }
}
