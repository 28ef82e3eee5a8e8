//! Running along a curve: step after step, event after event, to an end with a reason.

use super::locate::Located;
use super::stepper::{Place, Stepper};
use super::trace::Observer;
use super::{Branch, End, Kind, SpecialPoint};
use crate::core::condition::Quantity;
use crate::core::continuation::event::Test;
use crate::core::newton::scaled_norm;
use std::ops::ControlFlow;

/// A trace under way.
pub(super) struct Tracer<'a> {
    pub stepper: Stepper<'a>,
    pub branch: Branch,
    pub start: Place,
    /// Events in the first step are those of the special point where the curve starts.
    pub skip_first: bool,
    /// Whether to trace backward, forward.
    pub directions: [bool; 2],
    /// How many labels have been given.
    pub labels: usize,
}

/// One of the two halves of a branch, from the start outward. `after` of its special points counts
/// points from the start, which is 0.
struct Half {
    places: Vec<super::Point>,
    special: Vec<SpecialPoint>,
    end: End,
}

/// Whether and how a run ends with a step.
struct Ending {
    end: End,
    /// The last point lies within the step.
    at: Option<Located>,
}

impl Tracer<'_> {
    /// Traces both halves and joins them.
    pub fn run(mut self, observer: &mut dyn Observer) -> Branch {
        observer.begin(&self.branch);
        let start = self.start.clone();
        let mut turned = start.clone();
        self.stepper.turn(&mut turned);
        let _ = observer.point(&start.point);
        let [backward, forward] = self.directions;
        // The start is the first point that is labelled, if it is an end.
        let behind = match self.outward(&turned) {
            Some(end) => Some(self.no_half(end, observer)),
            None if backward => None,
            None => Some(self.no_half(End::Start, observer)),
        };
        let ahead = match forward {
            true => self.half(start.clone(), observer),
            false => self.no_half(End::Start, observer),
        };
        let closed = matches!(ahead.end, End::Closed { .. });
        let interrupted = ahead.end == End::Interrupted;
        let behind: Half = if closed {
            Half { places: Vec::new(), special: Vec::new(), end: ahead.end.clone() }
        } else {
            match behind {
                Some(behind) => behind,
                None if interrupted => self.no_half(End::Interrupted, observer),
                None => self.half(turned, observer),
            }
        };
        self.join(behind, start, ahead);
        self.branch
    }

    /// Nothing but the start, as an end of the branch.
    fn no_half(&mut self, end: End, observer: &mut dyn Observer) -> Half {
        let start = self.start.clone();
        let special = self.end_point(&start, &end, 0);
        let mut half = Half { places: Vec::new(), special: Vec::new(), end };
        self.announce(&mut half, special, observer);
        half
    }

    /// Labels a special point and shows it.
    fn announce(
        &mut self,
        half: &mut Half,
        mut special: SpecialPoint,
        observer: &mut dyn Observer,
    ) {
        self.labels += 1;
        special.label = self.labels;
        observer.special(&self.branch, &special);
        half.special.push(special);
    }

    fn half(&mut self, start: Place, observer: &mut dyn Observer) -> Half {
        let mut half = Half { places: Vec::new(), special: Vec::new(), end: End::Start };
        let settings = self.stepper.settings.clone();
        let mut length = settings.initial_step.min(settings.max_step);
        let mut place = start.clone();
        half.end = match self.outward(&place) {
            Some(end) => end,
            None => loop {
                if half.places.len() >= settings.max_points {
                    break End::PointLimit { points: half.places.len() };
                }
                let step = match self.stepper.step(&place, length) {
                    Ok(step) => step,
                    Err((step, cause)) => {
                        break End::StepTooSmall { step, cause: cause.to_string() };
                    }
                };
                length = step.next;
                let skip = self.skip_first && half.places.is_empty();
                let mut found = self.events_between(&place, &step.place, step.length, skip);
                let ending = self.ending(&mut found, &place, &step, &start, half.places.len());
                let after = half.places.len();
                for Located { mut special, .. } in found {
                    special.after = after;
                    self.announce(&mut half, special, observer);
                }
                match ending {
                    Some(Ending { end, at }) => {
                        if let Some(Located { mut special, .. }) = at {
                            half.places.push(point_of(&special));
                            special.after = half.places.len();
                            self.announce(&mut half, special, observer);
                        }
                        break end;
                    }
                    None => {
                        place = step.place;
                        self.stepper.settle(&mut place);
                        half.places.push(place.point.clone());
                        if let ControlFlow::Break(()) = observer.point(&place.point) {
                            break End::Interrupted;
                        }
                    }
                }
            },
        };
        let ended =
            half.special.last().is_some_and(|s| s.after == half.places.len() && s.after > 0);
        if !ended && !matches!(half.end, End::Closed { .. }) {
            let special = self.end_point(&place, &half.end, half.places.len());
            self.announce(&mut half, special, observer);
        }
        half
    }

    /// The end of a branch that starts on a bound and would leave at once.
    fn outward(&self, start: &Place) -> Option<End> {
        let released = self.stepper.equations.released();
        let first = self.stepper.equations.parameters_at();
        self.stepper.events.iter().find_map(|event| {
            let Test::Level(Quantity::Parameter(p), value) = event.test else { return None };
            let slope = start.tangent[first + released.iter().position(|&r| r == p)?];
            let range = self.range(p)?;
            let low = value == range[0];
            let leaves = if low { slope < 0.0 } else { slope > 0.0 };
            let at = start.point.parameters[p] == value;
            (event.terminal && at && leaves)
                .then(|| End::ParameterBound { name: event.name.clone(), value })
        })
    }

    /// The levels at which a parameter ends the branch, ascending.
    fn range(&self, parameter: usize) -> Option<[f64; 2]> {
        let mut levels = self.stepper.events.iter().filter_map(|event| match event.test {
            Test::Level(Quantity::Parameter(p), value) if p == parameter && event.terminal => {
                Some(value)
            }
            _ => None,
        });
        let first = levels.next()?;
        let last = levels.last().unwrap_or(f64::INFINITY);
        Some([first.min(last), first.max(last)])
    }

    /// All events between two places, in the order in which the branch meets them.
    fn events_between(
        &mut self,
        from: &Place,
        to: &Place,
        length: f64,
        skip: bool,
    ) -> Vec<Located> {
        let mut found: Vec<Located> = Vec::new();
        for index in 0..self.stepper.events.len() {
            let event = &self.stepper.events[index];
            let passed = event.passed(from.tests[index], to.tests[index]);
            if !passed || (skip && !event.terminal) {
                continue;
            }
            let kind = event.kind;
            let Some(located) = self.stepper.locate(index, from, to, length) else { continue };
            // Where a pitchfork is crossed on its curved branch the parameter turns, too: that is one
            // branch point, and no fold, whose defining system is singular there.
            let same = |other: &Located| {
                other.special.kind == Kind::BP
                    && (!located.special.converged
                        || (other.along - located.along).abs() < 1e-3 * length)
            };
            if !(kind == Kind::LP && found.iter().any(same)) {
                found.push(located);
            }
        }
        found.sort_by(|a, b| a.along.total_cmp(&b.along));
        found
    }

    /// Whether the branch ends in this step: at a terminal event, or because the curve has closed.
    /// What was found beyond the end is dropped.
    fn ending(
        &mut self,
        found: &mut Vec<Located>,
        from: &Place,
        step: &super::stepper::Step,
        start: &Place,
        points: usize,
    ) -> Option<Ending> {
        if points >= 2 && self.passes(start, from, step) {
            return Some(Ending { end: End::Closed { points: points + 1 }, at: None });
        }
        let events = &self.stepper.events;
        let index = found.iter().position(|located| events[located.event].terminal)?;
        let event = events[found[index].event].clone();
        found.truncate(index + 1);
        let at = found.pop();
        let name = event.name.clone();
        let end = match (event.kind, event.test) {
            (Kind::EP, Test::Level(Quantity::Parameter(_), value)) => {
                End::ParameterBound { name, value }
            }
            (Kind::EP, Test::Level(Quantity::Monitor(_), value)) => {
                End::MonitorBound { name, value }
            }
            _ => End::Event { event: name },
        };
        Some(Ending { end, at })
    }

    /// Whether a step passes through the start, in the start's direction: a Newton correction at the
    /// start's own distance along the step decides.
    fn passes(&mut self, start: &Place, from: &Place, step: &super::stepper::Step) -> bool {
        let stepper = &mut self.stepper;
        let row = stepper.covector(&from.tangent);
        let offset: Vec<f64> =
            start.unknowns.iter().zip(&from.unknowns).map(|(s, x)| s - x).collect();
        let along: f64 = row.iter().zip(&offset).map(|(r, d)| r * d).sum();
        let alignment: f64 = row.iter().zip(&start.tangent).map(|(r, t)| r * t).sum();
        let distance = scaled_norm(&offset, &stepper.weights);
        if !(0.0..=step.length).contains(&along) || distance > 1.5 * step.length || alignment < 0.0
        {
            return false;
        }
        let fraction = along / step.length;
        let mut unknowns: Vec<f64> = from
            .unknowns
            .iter()
            .zip(&step.place.unknowns)
            .map(|(a, b)| a + fraction * (b - a))
            .collect();
        let closing =
            crate::core::extended::Closing { row: &row, base: &from.unknowns, length: along };
        if stepper.correct(&mut unknowns, closing).is_err() {
            return false;
        }
        unknowns.iter_mut().zip(&start.unknowns).for_each(|(x, s)| *x -= s);
        scaled_norm(&unknowns, &stepper.weights) < 1e3 * stepper.settings.tolerance.max(1e-12)
    }

    fn end_point(&mut self, place: &Place, end: &End, after: usize) -> SpecialPoint {
        let equations = &mut self.stepper.equations;
        equations.load(&place.unknowns);
        let at = equations.at();
        let profiles = match at.system.assemble(at.x) {
            Ok(()) => at.system.profiles(at.x),
            Err(_) => Vec::new(),
        };
        let (n, first) = (equations.dimension(), equations.parameters_at());
        let failed = matches!(end, End::StepTooSmall { .. });
        let parameter = place.unknowns[first];
        let mut tangent = place.tangent[..n].to_vec();
        tangent.extend(&place.tangent[first..]);
        SpecialPoint {
            label: 0,
            kind: if failed { Kind::MX } else { Kind::EP },
            event: end.to_string(),
            after,
            parameters: place.point.parameters.clone(),
            monitors: place.point.monitors.clone(),
            unstable: place.point.unstable,
            error: self.stepper.settings.tolerance * parameter.abs(),
            bracket: [parameter; 2],
            converged: true,
            state: place.unknowns[..n].to_vec(),
            tangent,
            profiles,
        }
    }

    /// Joins the halves into one list from end to end.
    fn join(&mut self, mut behind: Half, start: Place, ahead: Half) {
        let before = behind.places.len();
        behind.places.reverse();
        behind.special.reverse();
        for special in &mut behind.special {
            // Behind point k from the start means before it from the end; an end stays on its point.
            let on_point = special.after == before && matches!(special.kind, Kind::EP | Kind::MX);
            special.after = before - special.after - usize::from(!on_point);
        }
        let mut special = behind.special;
        special.extend(ahead.special.into_iter().map(|mut special| {
            special.after += before;
            special
        }));
        self.branch.points = behind.places;
        self.branch.points.push(start.point);
        self.branch.points.extend(ahead.places);
        self.branch.special = special;
        self.branch.ends = [behind.end, ahead.end];
    }
}

fn point_of(special: &SpecialPoint) -> super::Point {
    super::Point {
        parameters: special.parameters.clone(),
        monitors: special.monitors.clone(),
        unstable: special.unstable,
    }
}
