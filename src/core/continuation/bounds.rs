//! Bounds of parameters and monitors, and the terminal events at which a branch ends.

use super::admissible::AT_LIMIT;
use super::branch::SpecialPoint;
use super::curve::Curve;
use super::curve_point::CurvePoint;
use super::defining_system::solve;
use super::end::End;
use super::error::TraceError;
use super::event::Event;
use super::located::Located;
use crate::core::bifurcation::Quantity;
use crate::core::system::Kind;

/// Heuristic: two events count as one point if their distance is less than this threshold, in
/// scaled arclength. An event counts as lying at the start of the branch if its distance from the
/// start, in scaled arclength, is less than this threshold. Located points are accurate to 1e-10 or
/// better.
pub(super) const AT_START: f64 = 1e-6;

/// Rounding: a saved end of a branch lies on a bound if the bounded monitor differs from the bound
/// by less than this fraction of the bound, or of the change of the monitor per unit of scaled
/// arclength.
const ON_BOUND: f64 = 1e-9;

/// A lower or upper bound of a parameter or monitor, at which a branch ends.
pub(super) struct Bound {
    /// The sign that distinguishes bounds: −1 for a lower bound, 1 for an upper bound.
    pub side: f64,
    /// The range of the bounded parameter or monitor.
    pub range: [f64; 2],
}

/// The bounds of a branch, which come first in the branch's list of events.
pub(super) struct Bounds {
    pub bounds: Vec<Bound>,
    /// The derivatives of the bounds' test functions at the start of the branch, with respect to
    /// arclength.
    pub slopes: Vec<f64>,
}

impl Bounds {
    /// Moves a start at the saved end of a branch back to the bound at which the branch had ended,
    /// by at most `reach` in scaled arclength. `saved` contains the monitors at the saved end. The
    /// start must be moved to the bound because an end located on a finer discretisation does not
    /// lie exactly on the bound on a coarser discretisation.
    pub fn return_to(
        &self,
        (saved, reach): (&[(String, f64)], f64),
        curve: &mut Curve,
        start: &mut CurvePoint,
    ) {
        let beyond = |i: &usize| start.tests[*i].is_some_and(|t| t * self.bounds[*i].side > 0.0);
        let events = &curve.detector.events;
        let of_monitor = |i: &usize| {
            let Some((Quantity::Monitor(_), level)) = events[*i].test.level() else { return false };
            let size = level.abs().max(self.slopes[*i].abs());
            let near = |value: f64| (value - level).abs() <= ON_BOUND * size;
            saved.iter().any(|(name, value)| *name == events[*i].name && near(*value))
        };
        let Some(index) = (0..self.bounds.len()).filter(beyond).find(of_monitor) else { return };
        let event = events[index].clone();
        let row = curve.corrector.norm.covector(&start.tangent);
        let guess = start.unknowns.clone();
        let solved = solve(&mut curve.corrector, &event, guess, (&row, &start.unknowns));
        let Some(end) = solved.ok().filter(|end| end.along.abs() <= reach) else { return };
        let stability = curve.recorder.wants_stability();
        curve.corrector.equations.load(&end.unknowns);
        if let Ok(mut place) = curve.arrive(end.unknowns, &row, f64::INFINITY, stability) {
            place.tests[index] = Some(0.0);
            *start = place;
        }
    }

    /// Returns an error if the start lies beyond a bound.
    pub fn check(&self, start: &CurvePoint, events: &[Event]) -> Result<(), TraceError> {
        let beyond = self.bounds.iter().enumerate().find_map(|(i, bound)| {
            let test = start.tests[i].filter(|test| test * bound.side > 0.0)?;
            Some((events[i].name.clone(), events[i].test.level()?.1 + test, bound.range))
        });
        match beyond {
            Some((name, value, [low, high])) => {
                Err(TraceError::OutOfRange { name, value, low, high })
            }
            None => Ok(()),
        }
    }

    /// Returns the bound at the start that the branch would cross immediately in the given
    /// direction; `None` if the branch would cross no bound.
    pub fn left_at_once(&self, start: &CurvePoint, backward: bool) -> Option<usize> {
        let way = if backward { -1.0 } else { 1.0 };
        self.left(start, |i| way * self.slopes[i])
    }

    /// Returns the bound at the start that the branch would cross if the test functions of the
    /// bounds changed by the given amounts; `None` if the branch would cross no bound.
    pub fn left(&self, start: &CurvePoint, change: impl Fn(usize) -> f64) -> Option<usize> {
        let leaves =
            |i: &usize| start.tests[*i] == Some(0.0) && change(*i) * self.bounds[*i].side > 0.0;
        (0..self.bounds.len()).find(leaves)
    }

    /// Whether the parameter or monitor with this name is bounded.
    pub fn are_on(&self, column: &str, events: &[Event]) -> bool {
        events[..self.bounds.len()].iter().any(|event| event.name == column)
    }

    /// Whether the event with this index is a bound.
    pub fn holds(&self, event: usize) -> bool {
        event < self.bounds.len()
    }

    /// Returns the first terminal event in `found`, which ends the branch, and removes this event
    /// and all later events from `found`.
    pub fn end(&self, events: &[Event], found: &mut Vec<Located>) -> Option<(End, Located)> {
        let terminal =
            |located: &Located| located.event.is_some_and(|event| events[event].terminal);
        let first = found.iter().position(terminal)?;
        // Several terminal events may coincide, for example where an impact vanishes with the
        // following segment. The first converged event names the end; if none converges, it is the
        // event of the itinerary, which causes the others.
        let reach = found[first].along + AT_START;
        let same = (first..found.len()).filter(|&k| terminal(&found[k]) && found[k].along <= reach);
        let rank = |k: &usize| {
            let Located { event, special, .. } = &found[*k];
            let follows = event.is_some_and(|event| !events[event].test.is_decision());
            (!special.converged, follows, *event)
        };
        let mut at = found.swap_remove(same.min_by_key(rank)?);
        found.truncate(first);
        // At a limit with singular equations, changes in the signs of determinants are meaningless.
        if at.special.kind == AT_LIMIT {
            let bifurcation = |it: &Located| {
                let test = it.event.map(|event| &events[event].test);
                it.special.kind != Kind::UZ && test.is_some_and(|test| test.level().is_none())
            };
            let is_at =
                |it: &Located| it.along >= at.along - AT_START || are_one(&it.special, &at.special);
            found.retain(|it| !bifurcation(it) || !is_at(it));
        }
        let bound = at.event.filter(|event| self.holds(*event));
        let end = bound.and_then(|event| end_at(&events[event], at.special.subkind.clone()));
        if let Some(end) = &end {
            at.special.event = end.to_string();
        }
        let event = at.special.event.clone();
        Some((end.unwrap_or(End::Event { event }), at))
    }
}

/// Rounding: two special points of one step have the same parameters if the differences are smaller than
/// this fraction of the parameters.
const EQUAL: f64 = 1e-12;

/// Whether two special points of one step have the same parameters, up to their errors. Where two parts of a
/// symmetric orbit vanish together, Newton's method converges slowly in the direction of their durations.
fn are_one(one: &SpecialPoint, other: &SpecialPoint) -> bool {
    let near = |(a, b): (&f64, &f64)| {
        (a - b).abs() <= one.error + other.error + EQUAL * a.abs().max(b.abs())
    };
    one.converged && other.converged && one.parameters.iter().zip(&other.parameters).all(near)
}

/// Returns the end of a branch at a bound, with the standard name of the solution at the end.
pub(super) fn end_at(bound: &Event, subkind: Option<String>) -> Option<End> {
    let name = bound.name.clone();
    Some(match bound.test.level()? {
        _ if bound.kind == AT_LIMIT => End::at_limit(name, subkind),
        (Quantity::Parameter(_), value) => End::ParameterBound { name, value },
        (Quantity::Monitor(_), value) => End::MonitorBound { name, value },
    })
}
