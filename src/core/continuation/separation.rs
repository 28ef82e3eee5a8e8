//! Separation of several events in one step, which may be close together: the step is divided into
//! parts until the events found in each part explain the change of stability over this part.

use super::admissible::{self, AT_LIMIT};
use super::bounds::Bounds;
use super::branch::{Number, SpecialPoint};
use super::cluster::{Cluster, Group, rate};
use super::curve::Curve;
use super::curve_point::{CurvePoint, Interval};
use super::defining_system::solve;
use super::describe::describe;
use super::event::Event;
use super::events_between::{AtStart, events_between};
use super::located::Located;
use super::locator::Locator;
use super::log::Log;
use super::recorder::{Recorded, special_point};
use super::step_control::Step;
use super::unexplained::{
    LEAST_UNEXPLAINED, is_doubtful_pair, uncounted, unexplained, without_doubtful_counts,
};
use crate::core::bifurcation::{
    Critical, Hopf, Stability, catalogue, parameter_in_range, without_critical,
};
use crate::core::linalg::{difference, dot};
use crate::core::problem::Dynamics;
use crate::core::system::Kind;
use std::sync::Arc;

/// Rounding: Parts of a step shorter than this threshold, in scaled arclength, count as points. The
/// threshold below which a part of a step counts as a point is the tolerance of Newton's method.
const SHORTEST: f64 = 1e-10;

/// Heuristic: the maximal number of cuts by which a step is divided. The search separates two
/// neighbouring events by five subdivisions of the step, however close together the events are.
const CUTS: usize = 60;

/// The division of a step into parts, which are searched for events.
pub(super) struct Parts<'s, 'a> {
    pub curve: &'s mut Curve<'a>,
    pub log: &'s mut Log,
    pub bounds: &'s Bounds,
    pub backward: bool,
    pub start: AtStart<'s>,
    /// The kind of the special point at which the step starts, and the kind of the curve on which
    /// the point lies.
    pub origin: &'s [Kind],
    /// The number of cuts by which the step has been divided so far.
    pub cuts: usize,
}

impl Parts<'_, '_> {
    /// Returns the events in a part of the step. Also returns the change of the number of unstable
    /// eigenvalues over this part, if the events do not explain the change.
    pub fn events(
        &mut self,
        from: &CurvePoint,
        step: &Step,
        at_start: bool,
    ) -> (Vec<Located>, Option<isize>) {
        let interval = step.since(from);
        let places = (&mut *self.curve, &mut *self.log, self.bounds);
        let start = at_start.then_some(self.start);
        let found = events_between(places, interval, self.backward, start);
        let (detector, origin) = (&self.curve.detector, self.origin(at_start));
        let found = without_doubtful_counts(detector, from, step, found, origin);
        let change = unexplained(detector, from, step, &found, origin);
        (found, change)
    }

    /// Returns the events up to a limit of the admissible solutions, if an event of the step, such as an
    /// end at a bound, lies beyond a limit that was not found. A monitor that vanishes at a limit may
    /// jump, so that it has the same sign at both ends of the step.
    pub fn up_to_limit(
        &mut self,
        from: &CurvePoint,
        step: &Step,
        found: Vec<Located>,
        at_start: bool,
    ) -> Vec<Located> {
        let system = self.curve.corrector.equations.system();
        let mut is_within = |it: &Located| {
            admissible::is_within(system, &it.special.parameters, &it.special.monitors)
        };
        let beyond = found.iter().find(|it| it.special.kind == AT_LIMIT || !is_within(it));
        let beyond = beyond.filter(|it| it.special.kind != AT_LIMIT && from.point.admissible);
        let Some(along) = beyond.map(|it| it.along) else { return found };
        let Some([first, _]) = self.halves(from, step, along) else { return found };
        let (before, _) = self.events(from, &first, at_start);
        let has_limit = before.iter().any(|it| it.special.kind == AT_LIMIT);
        if has_limit { before } else { found }
    }

    pub(super) fn origin(&self, at_start: bool) -> &[Kind] {
        if at_start { self.origin } else { &[] }
    }

    /// Returns the events in a part of the step over which stability changes by more than the
    /// events `found` explain. The part is divided into two parts that are searched separately,
    /// unless the unexplained events coincide at one point.
    pub fn separated(
        &mut self,
        from: &CurvePoint,
        step: &Step,
        (found, change): (Vec<Located>, isize),
        at_start: bool,
    ) -> Vec<Located> {
        let interval = step.since(from);
        let cluster = match change {
            // Events are uncertain, but stability does not change.
            0 => return found,
            _ => Cluster::of(&mut Locator::new(self.curve, interval), change.unsigned_abs()),
        };
        let corrector = &mut self.curve.corrector;
        let is_one = |it: &Cluster| it.coincides(corrector) && it.is_certain(corrector);
        let one = cluster.as_ref().is_some_and(is_one);
        let cut = cluster.as_ref().map_or(0.5 * step.length, Cluster::cut);
        if !one && let Some(apart) = self.cut(from, step, cut, at_start) {
            return apart;
        }
        let mut found = match &cluster {
            Some(cluster) => self.together(interval, cluster, found),
            None => found,
        };
        let origin = self.origin(at_start);
        let several = found.iter().any(|it| it.special.multiplicity > 1);
        if !several && uncounted(&self.curve.detector, from, step, &found, origin).is_some() {
            found.extend(self.nameless(interval, cluster.as_ref()));
        }
        found.sort_by(|a, b| a.along.total_cmp(&b.along));
        found
    }

    /// Returns the events in the two parts of an interval that is divided at the distance `along`
    /// from its first point; `None` if these events do not explain more of the change of stability
    /// than the events found without division.
    fn cut(
        &mut self,
        from: &CurvePoint,
        step: &Step,
        along: f64,
        at_start: bool,
    ) -> Option<Vec<Located>> {
        if step.length <= SHORTEST || self.cuts >= CUTS {
            return None;
        }
        self.cuts += 1;
        let [first, second] = self.halves(from, step, along)?;
        let mut all = Vec::new();
        for (from, step, at_start, offset) in
            [(from, &first, at_start, 0.0), (&first.place, &second, false, along)]
        {
            let found = match self.events(from, step, at_start) {
                (found, None) => found,
                (found, Some(change)) => self.separated(from, step, (found, change), at_start),
            };
            all.extend(found.into_iter().map(|it| it.farther(offset)));
        }
        let nameless = all.iter().any(|it| it.special.kind == Kind::ND);
        let detector = &self.curve.detector;
        let explained =
            nameless || uncounted(detector, from, step, &all, self.origin(at_start)).is_none();
        explained.then_some(all)
    }

    /// Returns the two parts of an interval that is divided at the distance `along` from its first
    /// point.
    pub(super) fn halves(
        &mut self,
        from: &CurvePoint,
        step: &Step,
        along: f64,
    ) -> Option<[Step; 2]> {
        let interval = step.since(from);
        let mut locator = Locator::new(self.curve, interval);
        let stability = locator.curve.recorder.wants_stability();
        let guess = interval.cubic(&locator.row, along);
        let (unknowns, _) = locator.corrected(guess, along).ok()?;
        let mut middle = locator.arrive((unknowns, f64::INFINITY), stability).ok()?;
        let crossings = locator.curve.crossings(from, &locator.row, along, &mut middle);
        let row = locator.curve.corrector.norm.covector(&middle.tangent);
        let mut place = step.place.clone();
        let length = dot(&row, &difference(&place.unknowns, &middle.unknowns));
        let first = Step { place: middle, length: along, next: length, crossings, miss: 0.0 };
        if place.spectrum.is_none() {
            self.curve.corrector.equations.assemble(&place.unknowns).ok()?;
            self.curve.corrector.factor_at(&place.unknowns, &row).ok()?;
        }
        let crossings = self.curve.crossings(&first.place, &row, length, &mut place);
        let second = Step { place, length, next: step.next, crossings, miss: 0.0 };
        (length > 0.0).then_some([first, second])
    }

    /// Returns the events of an interval in which several eigenvalues pass zero, and which is not
    /// divided further: one event for each type of eigenvalue.
    fn together(
        &mut self,
        interval: Interval,
        cluster: &Cluster,
        mut found: Vec<Located>,
    ) -> Vec<Located> {
        let dynamics = self.curve.corrector.equations.system().dynamics();
        let groups = cluster.groups(dynamics);
        let several = |group: &Group| {
            let alike = groups.iter().filter(|it| it.critical == group.critical).count();
            group.count > 1 || alike > 1
        };
        let mut several: Vec<Group> = groups.iter().filter(|it| several(it)).copied().collect();
        found.retain(|it| {
            let critical =
                catalogue::row_of(it.special.kind).map_or(Critical::None, |row| row.critical);
            let is_of = |group: &Group| group.critical == critical;
            let is_no_pair = critical == Critical::Pair && !groups.iter().any(is_of);
            !(several.iter().any(is_of) || is_no_pair && is_doubtful_pair(&self.curve.detector, it))
        });
        several.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
        for group in several {
            let pair = group.critical == Critical::Pair && group.count == 1;
            let alone = if pair { self.pair(interval, cluster, group) } else { None };
            found.extend(alone.or_else(|| self.multiple(interval, cluster, group)));
        }
        found
    }

    /// Returns the index of the event that detects special points of a kind.
    fn event(&self, kind: Kind) -> Option<usize> {
        let mut events = self.curve.detector.events.iter();
        events.position(|event| event.kind == kind && event.condition.is_some())
    }

    /// Locates the point at which one of several pairs of eigenvalues is critical, with a defining
    /// system for the frequency of this pair.
    fn pair(&mut self, interval: Interval, cluster: &Cluster, group: Group) -> Option<Located> {
        let dynamics = self.curve.corrector.equations.system().dynamics();
        let index = self.event(kinds(group.critical, dynamics)[0])?;
        let (row, frequency) =
            (self.curve.corrector.norm.covector(&interval.from.tangent), group.frequency);
        let periodic = dynamics == Dynamics::Periodic;
        let event = &self.curve.detector.events[index];
        let own = Event {
            condition: Some(Arc::new(move || Box::new(Hopf::near(frequency, periodic)))),
            ..event.clone()
        };
        let at = (&row[..], &interval.from.unknowns[..]);
        let located = solve(&mut self.curve.corrector, &own, cluster.unknowns(), at).ok()?;
        let inside = (located.along - cluster.along).abs() <= interval.length;
        inside.then(|| describe(self.curve, index, interval, located).ok()).flatten()
    }

    /// Returns the special point at which several equal eigenvalues are critical together. If the
    /// eigenvalues pass zero at different points, the special point has converged only if the
    /// discretisation explains the distance of these points.
    fn multiple(&mut self, interval: Interval, cluster: &Cluster, group: Group) -> Option<Located> {
        let Group { critical, frequency, count } = group;
        let unknowns = cluster.unknowns();
        let equations = &mut self.curve.corrector.equations;
        let beside = equations.load(&cluster.places[0].unknowns).to_vec();
        equations.load(&unknowns);
        let (parameter, dynamics) = (equations.released[0], equations.system().dynamics());
        let parameter_at = equations.parameters_at();
        let crosses = critical != Critical::One
            || parameter_in_range(equations.at(), &beside, (parameter, count)).unwrap_or(true);
        let kind = kinds(critical, dynamics)[usize::from(!crosses)];
        let event = match critical {
            Critical::Pair => {
                format!(
                    "{}: {count} complex pairs of eigenvalues with the same frequency are \
                     critical at the same point",
                    kind.meaning()
                )
            }
            Critical::MinusOne => format!("{}: {count} multipliers are −1", kind.meaning()),
            _ => format!("{}: {count} eigenvalues vanish", kind.meaning()),
        };
        let mut located = self.at_mean((kind, &event), interval, cluster)?;
        let Curve { refiner, corrector, .. } = &mut *self.curve;
        let on_mesh = corrector.equations.system().representation().is_on_mesh();
        let near = on_mesh && cluster.spread() <= LEAST_UNEXPLAINED;
        let special = &mut located.special;
        special.multiplicity = count;
        special.converged = near || cluster.coincides(corrector);
        if on_mesh && special.converged {
            located.shortfall = refiner.shortfall(corrector, special);
        }
        if critical == Critical::Pair {
            let name = if kind == Kind::HB { "hopf_frequency" } else { "torus_angle" };
            let [value, error] =
                cluster.frequency((frequency, dynamics), (special.error, parameter_at));
            special.numbers = vec![Number { name: name.into(), value, error }];
        }
        Some(located)
    }

    /// Returns a special point of the kind `ND` for a passage of eigenvalues through zero that
    /// cannot be classified.
    fn nameless(&mut self, interval: Interval, cluster: Option<&Cluster>) -> Option<Located> {
        if let Some(cluster) = cluster {
            let event = format!(
                "{} eigenvalues pass zero, and no event explains the crossing",
                cluster.count
            );
            if let Some(located) = self.at_mean((Kind::ND, &event), interval, cluster) {
                return Some(located);
            }
        }
        let event = (Kind::ND, "eigenvalues pass zero, and no event explains the crossing");
        let Located { along, unknowns, special, .. } =
            Locator::new(self.curve, interval).middle(event);
        let error = special.error + self.curve.corrector.mesh_share(&unknowns);
        let special = self.record(event, &unknowns, interval, 0)?;
        let special = SpecialPoint { error, converged: false, ..special };
        Some(Located { event: None, along, unknowns, special, shortfall: None })
    }

    /// Returns the special point at which the mean of the eigenvalues that pass zero vanishes.
    fn at_mean(
        &mut self,
        event: (Kind, &str),
        interval: Interval,
        cluster: &Cluster,
    ) -> Option<Located> {
        let (along, unknowns) = (cluster.along, cluster.unknowns());
        let corrector = &self.curve.corrector;
        let [start, end] = interval.ends(corrector.equations.parameters_at());
        let slope = (end - start).abs() / interval.length;
        let place = slope * (4.0 * cluster.uncertainty + cluster.spread());
        let rounding = corrector.parameter_error();
        let error = place + rounding + cluster.mesh_share(self.curve, &unknowns, slope)?;
        let special = self.record(event, &unknowns, interval, cluster.count)?;
        let special = SpecialPoint { error, converged: false, ..special };
        Some(Located { event: None, along, unknowns, special, shortfall: None })
    }

    /// Records the special point at which `count` eigenvalues pass zero. The eigenvalues that pass
    /// zero are not counted in the stability of the special point; if their number is unknown (0),
    /// stability is undefined.
    fn record(
        &mut self,
        event: (Kind, &str),
        unknowns: &[f64],
        interval: Interval,
        count: usize,
    ) -> Option<SpecialPoint> {
        let Curve { corrector, recorder, .. } = &mut *self.curve;
        let equations = &mut corrector.equations;
        equations.assemble(unknowns).ok()?;
        let stability = count > 0 && recorder.wants_stability();
        let Recorded { mut point, spectrum, .. } = recorder.record(equations, stability).ok()?;
        let dynamics = equations.system().dynamics();
        if let Some(spectrum) = &spectrum {
            let others = without_critical(spectrum, count, |l| rate(l, dynamics).abs());
            let own = Stability::of(dynamics, &others).unstable;
            let sides = [interval.from, interval.to].map(|place| place.point.unstable);
            // Rounding moves the vanishing eigenvalues to either side.
            let least = match sides {
                [Some(a), Some(b)] if a.abs_diff(b) == count => Some(a.min(b)),
                _ => None,
            };
            point.unstable = Some(least.unwrap_or(own));
        }
        let spectrum = spectrum.unwrap_or_default();
        let tangents = interval.from.tangent.iter().zip(&interval.to.tangent);
        let tangent: Vec<f64> = tangents.map(|(a, b)| 0.5 * (a + b)).collect();
        let bracket = interval.ends(equations.parameters_at());
        let special = special_point(corrector, event, point, &spectrum, [unknowns, &tangent]);
        Some(SpecialPoint { bracket, ..special })
    }
}

/// Returns two kinds of special points at which eigenvalues of the given type are critical; the
/// second kind applies if the parameter has an extremum at the point.
fn kinds(critical: Critical, dynamics: Dynamics) -> [Kind; 2] {
    match (critical, dynamics) {
        (Critical::MinusOne, _) => [Kind::PD; 2],
        (Critical::Pair, Dynamics::Periodic) => [Kind::TR; 2],
        (Critical::Pair, _) => [Kind::HB; 2],
        _ => [Kind::BP, Kind::LP],
    }
}
