//! Hybrid orbits as boundary-value problems.

use super::itinerary::{Itinerary, Leg};
use crate::core::bvp::{Birth, BoundaryProblem, Ends, Equations, Monitor, Return, Unknown};
use crate::core::condition::EvaluationError;
use crate::core::field::VectorField;
use crate::core::hybrid::{Guard, HybridSystem, InMode, Mode};
use crate::core::scalar::Scalar;
use crate::core::zero::LeftDomain;
use std::sync::Arc;

/// The periodic orbits of a hybrid system with a given itinerary, as a boundary-value problem with one segment
/// for each leg:
///
/// ```text
///     x_s' = f_s(T_s + t, x_s, p),  0 ≤ t ≤ L_s,    T_s = T_0 + L_0 + … + L_{s−1}
///     x_{s+1}(0) = r_s(T_{s+1}, x_s(L_s), p),       the last leg leading to the first
///     h_s(T_{s+1}, x_s(L_s), p) = 0
///     L_0 + … + L_{S−1} = q T(p)                    under forcing of period T
/// ```
///
/// Unknown are the states, the time `T_0` of the start (under forcing), and the durations `L_s`. These
/// equations are regular where an event becomes tangent: a leg may last no time, and an impact may have no
/// speed. So an impacting branch begins at a grazing point itself.
///
/// An orbit without events is one segment that closes after `q` periods (or after a period that is unknown,
/// with a phase condition).
#[derive(Clone, Debug)]
pub struct HybridOrbit<H> {
    system: H,
    itinerary: Itinerary,
    modes: Vec<Mode>,
    guards: Vec<Guard>,
    parameters: Vec<String>,
    forced: bool,
    /// Where the states of each leg begin among those of all legs, and their number at the end.
    places: Vec<usize>,
    /// Whether the penetration is recorded.
    penetration: bool,
}

impl<H: HybridSystem> HybridOrbit<H> {
    /// The orbits of a system with an itinerary.
    pub fn of(system: H, itinerary: Itinerary) -> Self {
        let (modes, guards, parameters) = (system.modes(), system.guards(), system.parameters());
        let forced = system.forcing().is_periodic();
        let mut places = vec![0];
        for leg in &itinerary.legs {
            places.push(places[places.len() - 1] + modes[leg.mode].states.len());
        }
        HybridOrbit {
            system,
            itinerary,
            modes,
            guards,
            parameters,
            forced,
            places,
            penetration: false,
        }
    }

    /// Records [`Measure::Penetration`](crate::core::hybrid::Measure::Penetration) as a monitor, 0 if motion would
    /// not turn within a period.
    pub fn with_penetration(mut self) -> Self {
        self.penetration = true;
        self
    }

    /// Whether the penetration is recorded.
    pub(super) fn records_penetration(&self) -> bool {
        self.penetration
    }

    /// Orbits of the same system with another itinerary.
    pub(super) fn like(&self, itinerary: Itinerary) -> Self
    where
        H: Clone,
    {
        let orbit = HybridOrbit::of(self.system.clone(), itinerary);
        HybridOrbit { penetration: self.penetration, ..orbit }
    }

    /// The system itself.
    pub fn system(&self) -> &H {
        &self.system
    }

    /// What the orbits go through.
    pub fn itinerary(&self) -> &Itinerary {
        &self.itinerary
    }

    /// The guards of a mode.
    pub(super) fn guards_in(&self, mode: usize) -> impl Iterator<Item = usize> + '_ {
        let guards = self.guards.iter().enumerate();
        guards.filter(move |(_, guard)| guard.ends(mode)).map(|(k, _)| k)
    }

    /// The name of a guard.
    pub(super) fn guard_name(&self, guard: usize) -> &str {
        &self.guards[guard].name
    }

    /// The position of a state among those of a leg, by name.
    pub(super) fn state_on(&self, leg: usize, state: &str) -> Option<usize> {
        self.modes[self.legs()[leg].mode].states.iter().position(|known| known == state)
    }

    /// The name of a mode.
    pub(super) fn mode_name(&self, mode: usize) -> &str {
        &self.modes[mode].name
    }

    /// The number of states of a mode.
    pub(super) fn states_of(&self, mode: usize) -> usize {
        self.modes[mode].states.len()
    }

    /// A guard at a time since the beginning of a leg.
    pub(super) fn guard_on<T: Scalar>(
        &self,
        leg: usize,
        guard: usize,
        t: T,
        x: &[T],
        q: &[T],
    ) -> T {
        let mode = self.legs()[leg].mode;
        self.system.guard(guard, mode, self.time(leg, q) + t, x, self.split(q).0)
    }

    fn legs(&self) -> &[Leg] {
        &self.itinerary.legs
    }

    fn smooth(&self) -> bool {
        self.itinerary.is_smooth()
    }

    /// The states of a leg among those of all legs.
    pub(super) fn of_leg(&self, leg: usize) -> std::ops::Range<usize> {
        self.places[leg]..self.places[leg + 1]
    }

    /// Parameters and further unknowns.
    pub(super) fn split<'q, T>(&self, q: &'q [T]) -> (&'q [T], &'q [T]) {
        q.split_at(self.parameters.len())
    }

    /// The durations among the further unknowns.
    pub(super) fn durations<'q, T>(&self, extras: &'q [T]) -> &'q [T] {
        &extras[usize::from(self.forced && !self.smooth())..]
    }

    /// When a leg begins.
    pub(super) fn time<T: Scalar>(&self, leg: usize, q: &[T]) -> T {
        let (_, extras) = self.split(q);
        match self.smooth() {
            true => T::zero(),
            false => extras[..leg + usize::from(self.forced)]
                .iter()
                .fold(T::zero(), |time, extra| time + *extra),
        }
    }

    /// The time that a cycle takes under forcing.
    fn cycle<T: Scalar>(&self, p: &[T]) -> T {
        self.system.period(p) * self.itinerary.periods as f64
    }

    /// Conditions of a cycle with events.
    fn events<T: Scalar>(&self, ends: Ends<T>, q: &[T], b: &mut [T]) {
        let (p, extras) = self.split(q);
        let (count, all) = (self.legs().len(), self.places[self.legs().len()]);
        for (s, leg) in self.legs().iter().enumerate() {
            let Some(exit) = leg.exit else { continue };
            let (next, x) = ((s + 1) % count, &ends.end[self.of_leg(s)]);
            let time = self.time(s, q) + self.durations(extras)[s];
            let after = &mut b[self.of_leg(next)];
            self.system.reset(exit, (leg.mode, self.legs()[next].mode), time, x, p, after);
            for (b, start) in after.iter_mut().zip(&ends.start[self.of_leg(next)]) {
                *b = *start - *b;
            }
            b[all + s] = self.system.guard(exit, leg.mode, time, x, p);
        }
        if self.forced {
            let cycle = self.cycle(p);
            b[all + count] = self.durations(extras).iter().fold(cycle, |rest, l| rest - *l);
        }
    }
}

impl<H: HybridSystem + Clone + 'static> BoundaryProblem for HybridOrbit<H> {
    fn segments(&self) -> Vec<Vec<String>> {
        self.legs().iter().map(|leg| self.modes[leg.mode].states.clone()).collect()
    }

    fn parameters(&self) -> Vec<String> {
        self.parameters.clone()
    }

    fn extras(&self) -> Vec<String> {
        match (self.smooth(), self.forced) {
            (true, true) => Vec::new(),
            (true, false) => vec!["period".into()],
            (false, forced) => {
                let start = forced.then(|| "start".to_string());
                let durations = (0..self.legs().len()).map(|s| format!("duration[{s}]"));
                start.into_iter().chain(durations).collect()
            }
        }
    }

    fn field<T: Scalar>(&self, segment: usize, t: T, x: &[T], q: &[T], f: &mut [T]) {
        let (p, mode) = (self.split(q).0, self.legs()[segment].mode);
        self.system.field(mode, self.time(segment, q) + t, x, p, f);
    }

    fn duration<T: Scalar>(&self, segment: usize, q: &[T]) -> T {
        let (p, extras) = self.split(q);
        match (self.smooth(), self.forced) {
            (true, true) => self.cycle(p),
            _ => self.durations(extras)[segment],
        }
    }

    fn boundary<T: Scalar>(&self, ends: Ends<T>, q: &[T], b: &mut [T]) {
        match self.smooth() {
            true => {
                let ends = ends.start.iter().zip(ends.end);
                b.iter_mut().zip(ends).for_each(|(b, (start, end))| *b = *start - *end);
            }
            false => self.events(ends, q, b),
        }
    }

    fn phase(&self) -> bool {
        self.smooth() && !self.forced
    }

    /// The first leg's states return, and under forcing the time of the start, modulo the forcing's periods.
    fn returns(&self) -> Vec<Return> {
        let mut returns = Return::of_states(self.places[1]);
        if self.forced && !self.smooth() {
            let condition = self.places[self.legs().len()] + self.legs().len();
            returns.push(Return { condition, unknown: Unknown::Extra(0) });
        }
        returns
    }

    fn check_ends(&self, ends: Ends<f64>, q: &[f64]) -> Result<(), LeftDomain> {
        self.check_events(ends, q)
    }

    fn watch<T: Scalar>(&self, function: usize, segment: usize, t: T, x: &[T], q: &[T]) -> T {
        self.guard_on(segment, function, t, x, q)
    }

    fn of_ends<T: Scalar>(&self, function: usize, ends: Ends<T>, q: &[T]) -> T {
        self.number(function, ends, q)
    }

    fn monitors(&self) -> Vec<(String, Monitor)> {
        self.all_monitors()
    }

    fn grazings(&self) -> Vec<usize> {
        self.grazing_monitors()
    }

    fn grazing_scale(&self, monitor: usize, p: &[f64]) -> f64 {
        self.scale_of_grazing(monitor, p)
    }

    fn itinerary(&self) -> String {
        self.itinerary.in_words(&self.modes, &self.guards)
    }

    fn with_itinerary(&self, words: &str) -> Result<Arc<dyn Equations>, EvaluationError> {
        let itinerary = Itinerary::read(words, &self.system)
            .map_err(|cause| EvaluationError::NotApplicable(cause.to_string()))?;
        Ok(Arc::new(self.like(itinerary)))
    }

    fn doubled(&self) -> Option<Arc<dyn Equations>> {
        let doubled = || Arc::new(self.like(self.itinerary.repeated(2)));
        (!self.smooth()).then(|| doubled() as Arc<dyn Equations>)
    }

    fn born_at_grazing(&self, starts: &[f64], q: &[f64]) -> Result<Option<Birth>, EvaluationError> {
        Ok(Some(self.born(starts, q)?.erased()))
    }

    fn scales(&self, segment: usize, q: &[f64]) -> Vec<f64> {
        let (system, mode) = (&self.system, self.legs()[segment].mode);
        VectorField::scales(&InMode { system, mode }, self.split(q).0)
    }

    fn domain(&self, segment: usize, x: &[f64], q: &[f64]) -> Result<(), LeftDomain> {
        self.system.domain(self.legs()[segment].mode, x, self.split(q).0)
    }
}
