//! Extremes of a scalar along a motion, found from its possible turning points.

use super::measure::Measure;

/// A point on a motion, and the value of a scalar at the point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::core) struct Sighting<P> {
    pub place: P,
    pub value: f64,
}

/// The extremes of one scalar on one leg (a part between two events) of a motion. The scalar is
/// monotone between visited points, and the points are visited in order, from the beginning of the
/// leg to its end.
#[derive(Clone, Copy, Debug)]
pub(in crate::core) struct Extremes<P> {
    largest: Sighting<P>,
    smallest: Sighting<P>,
    /// The value of the scalar at the beginning of the leg.
    first: Option<f64>,
    /// The point visited last, which is finally the end of the leg.
    last: Option<Sighting<P>>,
    /// The local minima inside the leg: the first minimum, to which the scalar falls from the
    /// beginning; the least minimum between two maxima; and the last minimum, from which the scalar
    /// rises to the end.
    leading: Option<Sighting<P>>,
    between: Option<Sighting<P>>,
    trailing: Option<Sighting<P>>,
    falling: bool,
    /// The typical size of the scalar.
    scale: f64,
    /// The smallest change of the scalar that counts as a fall or a rise.
    depth: f64,
    /// The size of the scalar's errors at the beginning of the leg.
    error: f64,
    /// Whether the scalar has stayed within `error` of zero since the beginning of the leg.
    begins: bool,
    /// Two flags: whether the scalar has risen before the last visited minimum, and whether the
    /// scalar has risen at all.
    risen: [bool; 2],
}

/// Rounding: the smallest change, in units of the scalar's scale, that counts as a fall or rise:
/// about four thousand times the rounding error.
const DEPTH: f64 = 1e-12;

/// Rounding: a leg counts as beginning on the surface of a guard if the magnitude of the guard, in
/// units of its scale, is at most this: well above the square root of the rounding error, which is
/// the accuracy of a tangential contact.
const ON: f64 = 1e-6;

impl<P: Copy + Default> Extremes<P> {
    /// Creates empty extremes. Changes of the scalar smaller than `error`, in units of its typical
    /// size, are ignored.
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

    /// Sets the error of the scalar's values, in units of its scale. A scalar that vanishes at the
    /// beginning of the leg has no minima until it exceeds the error.
    pub fn known_to(self, error: f64) -> Self {
        Extremes { error: error * self.scale, ..self }
    }

    /// Adds the next point of the leg.
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

    /// Updates the local minima with the next value: if the scalar falls again, the stored minimum
    /// lies between two maxima.
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

    /// Returns the local minima that count as distances from the surface: the minima inside the
    /// leg, and the ends of the leg. The flags `vanishes` state whether the scalar vanishes in the
    /// event that begins the leg, and in the event that ends the leg; the flags `free` state whether
    /// the scalar can have any value at these events. If the scalar is free at the beginning, the
    /// beginning counts. If the scalar vanishes in one of the events, the end of the leg does not
    /// count, unless the scalar is free there, and either falls after a rise or begins away from the
    /// surface. A minimum also does not count if the scalar is monotonic between the beginning of the
    /// leg and the minimum, or between the minimum and the end of the leg, since such a minimum is the
    /// event itself. If the reset of the event moves the state away from the surface, as in a spiking
    /// neuron, the scalar does not vanish at the beginning of the leg, and its minima there count.
    pub fn dips(
        &self,
        vanishes: [bool; 2],
        free: [bool; 2],
    ) -> impl Iterator<Item = Sighting<P>> + use<P> {
        let [begins, ends] = vanishes;
        let begins = begins && self.first.is_none_or(|first| first.abs() <= ON * self.scale);
        let leading = self.leading.filter(|_| !begins);
        let trailing = self.trailing.filter(|_| !ends && (self.risen[0] || !begins));
        let falls = self.risen[1] && self.falling;
        let counts = vanishes == [false; 2] || free[1] && !ends && (!begins || falls);
        let last = self.last.filter(|_| counts);
        let value = self.first.filter(|_| free[0]);
        let first = value.map(|value| Sighting { place: P::default(), value });
        first.into_iter().chain(leading).chain(self.between).chain(trailing).chain(last)
    }
}

/// The extremes of a scalar over several legs (parts between two events) of a motion.
#[derive(Clone, Copy, Debug)]
pub(in crate::core) struct Overall<P> {
    largest: Option<Sighting<P>>,
    smallest: Option<Sighting<P>>,
    /// The least local minimum over all legs.
    nearest: Option<Sighting<P>>,
}

impl<P> Default for Overall<P> {
    fn default() -> Self {
        Overall { largest: None, smallest: None, nearest: None }
    }
}

impl<P: Copy> Overall<P> {
    /// Adds the extremes of a leg, and those of its local minima that count as distances from a
    /// surface.
    pub fn take<Q: Copy + Default>(
        &mut self,
        leg: &Extremes<Q>,
        dips: impl Iterator<Item = Sighting<Q>>,
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
        for dip in dips {
            if nearest.is_none_or(|known| dip.value < known.value) {
                *nearest = Some(placed(dip));
            }
        }
    }

    /// Returns the extremes that a measure needs, at most two, each with a factor; the value of the
    /// measure is the sum of the products. For a measure that does not depend on extremes, the
    /// result is empty.
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

    /// Returns the value of a measure that depends on extremes; 0 if the scalar is not defined on
    /// any leg.
    pub fn value<S, D>(&self, measure: &Measure<S, D>) -> f64 {
        self.terms(measure).iter().flatten().map(|(s, factor)| factor * s.value).sum()
    }
}
