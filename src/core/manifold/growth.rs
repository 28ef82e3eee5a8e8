//! Growth of one half of a manifold, step by step.

use super::curve::{Curve, Place, cubic};
use super::planar::{Vector, cross, is_finite, minus, norm, plus};
use super::preimage::Lost;
use super::settling::Settling;
use crate::core::cancel::CancelToken;
use crate::core::continuation::End;
use crate::core::numerics::{Limits as RootLimits, bracketed_zero, gauss_legendre};

/// The limits up to which one half of a manifold is computed, in units of the states' scales.
pub(super) struct Limits {
    /// The longest arclength.
    pub length: f64,
    /// The maximal number of points.
    pub points: usize,
    /// The resolution: the largest distance between the curve and a chord between two successive
    /// points.
    pub resolution: f64,
    /// The smallest and the largest allowed value of each state.
    pub bounds: [[f64; 2]; 2],
    /// The names of the states, and their scales.
    pub names: [String; 2],
    pub scales: Vector,
    pub cancel: CancelToken,
}

/// A stored point of the curve.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub t: f64,
    pub at: Vector,
    pub slope: Vector,
    pub arclength: f64,
}

/// A trial step along the curve: its middle point, its end point, and the arclengths of its two
/// halves.
struct Trial {
    middle: Place,
    end: Place,
    lengths: [f64; 2],
}

impl Trial {
    fn length(&self) -> f64 {
        self.lengths.iter().sum()
    }
}

/// A limit of the computed curve, at which a step can end: the maximal arclength, or a bound of a
/// state.
#[derive(Clone, Copy, Debug)]
enum Limit {
    Length,
    Bound { axis: usize, upper: bool },
}

const LIMITS: [Limit; 5] = [
    Limit::Length,
    Limit::Bound { axis: 0, upper: false },
    Limit::Bound { axis: 0, upper: true },
    Limit::Bound { axis: 1, upper: false },
    Limit::Bound { axis: 1, upper: true },
];

/// Heuristic: the longest step in the parameter `t`, where the distance from the saddle is
/// proportional to `e^t`.
const LONGEST: f64 = 0.5;

/// Heuristic: the largest angle between the tangents at the two ends of half a step.
const TURN: f64 = 0.4;

/// Heuristic: the largest distance between two successive points, as a fraction of the maximal
/// arclength.
const SPACING: f64 = 0.02;

/// Heuristic: the largest ratio of the arclength of half a step to its chord: if the ratio is
/// larger, the curve may turn back undetected.
const STRETCHED: f64 = 1.1;

/// Heuristic: the next step is made longer if the error of the present step, as a fraction of the
/// allowed error, is below this number.
const WELL: f64 = 0.25;
const LONGER: f64 = 1.5;

/// Heuristic: the shortest step, as a fraction of the resolution; shorter steps are abandoned.
const SHORTEST: f64 = 1e-3;

/// The reason that is reported for the failure of short steps, if the map can be evaluated
/// everywhere.
const SHARP: &str = "the curve turns too sharply";

/// The growth of one half of a manifold.
pub(super) struct Growth<'a> {
    curve: &'a Curve<'a>,
    limits: &'a Limits,
    nodes: Vec<Node>,
    last: Place,
    arclength: f64,
    step: f64,
    settling: Settling,
    /// The nodes and weights of Gauss quadrature.
    rule: (Vec<f64>, Vec<f64>),
}

/// Heuristic: the number of Gauss points in half a step; with this number, arclengths are much more
/// accurate than the curve.
const GAUSS: usize = 4;

impl<'a> Growth<'a> {
    /// Starts the growth of the curve at a distance from the saddle equal to the resolution, or
    /// closer.
    pub fn new(curve: &'a Curve<'a>, limits: &'a Limits) -> Result<Self, Lost> {
        let t = curve.local.radius.min(limits.resolution).min(0.1 * limits.length).ln();
        let last = curve.place(t, None)?;
        let arclength = norm(minus(last.at, curve.local.at(0.0).0));
        let nodes = vec![Node { t, at: last.at, slope: last.slope, arclength }];
        let settling = Settling::new(t, curve.rate);
        let step = 0.5 * LONGEST;
        let rule = gauss_legendre(GAUSS);
        Ok(Growth { curve, limits, nodes, last, arclength, step, settling, rule })
    }

    /// Grows the half of the manifold until it ends.
    pub fn run(mut self) -> (Vec<Node>, End) {
        loop {
            if self.limits.cancel.is_cancelled() {
                return (self.nodes, End::Interrupted);
            }
            if self.nodes.len() + 2 > self.limits.points {
                let points = self.nodes.len();
                return (self.nodes, End::PointLimit { points });
            }
            if let Some(end) = self.advance() {
                return (self.nodes, end);
            }
        }
    }

    /// Makes a step, whose length is limited by the bends of the curve; if the step is the last
    /// step, returns the reason why the half ends.
    fn advance(&mut self) -> Option<End> {
        loop {
            let way = self.step * norm(self.last.slope);
            let (cause, hopeless) = match self.trial(self.step) {
                Ok(trial) => match self.quality(&trial) {
                    Some(error) => return self.take(trial, error),
                    // At a cusp the slope vanishes, and the distance does not count.
                    None => (SHARP.to_string(), false),
                },
                Err(lost) => {
                    let cause = lost.in_units(self.limits.scales).to_string();
                    (cause, way <= SHORTEST * self.limits.resolution)
                }
            };
            if hopeless || self.step < f64::EPSILON {
                return Some(End::StepTooSmall { step: way, cause, failure: None });
            }
            self.step *= 0.5;
        }
    }

    /// Tries a step of a given length in the parameter `t`.
    fn trial(&self, step: f64) -> Result<Trial, Lost> {
        let t = self.last.t;
        let middle = self.curve.place(t + 0.5 * step, Some(&self.last))?;
        let end = self.curve.place(t + step, Some(&middle))?;
        let lengths = [[&self.last, &middle], [&middle, &end]].map(|pair| self.length(pair));
        Ok(Trial { middle, end, lengths })
    }

    /// Computes the arclength of the cubic curve between two points.
    fn length(&self, [a, b]: [&Place; 2]) -> f64 {
        let (middle, half) = (0.5 * (a.t + b.t), 0.5 * (b.t - a.t));
        let speed = |x: &f64| {
            norm(cubic([a.t, b.t], [a.at, b.at], [a.slope, b.slope], middle + half * x).1)
        };
        let (points, weights) = &self.rule;
        half * points.iter().zip(weights).map(|(x, weight)| weight * speed(x)).sum::<f64>()
    }

    /// Returns the error of a step, as a fraction of the allowed error; `None` if the step must be
    /// shortened.
    fn quality(&self, trial: &Trial) -> Option<f64> {
        let Trial { middle, end, .. } = trial;
        let resolution = self.limits.resolution;
        let step = end.t - self.last.t;
        let fastest = [&self.last, middle, end].map(|place| norm(place.slope));
        let fastest = fastest.into_iter().fold(0.0, f64::max);
        let inside = self.is_inside(middle) || !self.is_inside(end);
        if !(is_finite(end.at) && fastest.is_finite() && inside) {
            return None;
        }
        // A corner, or a bend below the resolution.
        if fastest * step <= resolution {
            return Some(WELL);
        }
        let halves = [[&self.last, middle], [middle, end]];
        let chords = halves.map(|[a, b]| norm(minus(b.at, a.at)));
        if trial.length() > STRETCHED * (chords[0] + chords[1])
            || chords.iter().any(|chord| *chord > SPACING * self.limits.length)
        {
            return None;
        }
        // The cubic through both ends.
        let expected = plus(
            plus(self.last.at, 0.5, minus(end.at, self.last.at)),
            step / 8.0,
            minus(self.last.slope, end.slope),
        );
        let missed = norm(minus(expected, middle.at)) / resolution;
        let worst = halves.into_iter().map(|pair| bent(pair, 0.5 * step, resolution));
        let worst = worst.fold(missed, f64::max);
        (worst <= 1.0).then_some(worst)
    }

    /// Accepts a step, or the part of the step that is within the limits.
    fn take(&mut self, trial: Trial, error: f64) -> Option<End> {
        let reached = LIMITS.iter().filter(|limit| self.left(**limit, &trial)[0] < 0.0);
        let steps = reached.map(|limit| (self.step_to(*limit), *limit));
        let first = steps.min_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((step, limit)) = first {
            match self.trial(step) {
                Ok(trial) => self.keep(&trial),
                Err(lost) => {
                    let cause = lost.in_units(self.limits.scales).to_string();
                    return Some(End::StepTooSmall { step, cause, failure: None });
                }
            }
            return Some(self.reached(limit));
        }
        self.keep(&trial);
        self.last = trial.end;
        if error <= WELL {
            self.step = (LONGER * self.step).min(LONGEST);
        }
        let settled =
            self.settling.has_settled(self.last.t, self.arclength, self.limits.resolution);
        settled.then(|| End::ConvergesTo { point: self.in_units(self.last.at).to_vec() })
    }

    /// Stores the middle point and the end point of a step.
    fn keep(&mut self, trial: &Trial) {
        for (place, length) in [&trial.middle, &trial.end].into_iter().zip(trial.lengths) {
            self.arclength += length;
            let Place { t, at, slope, .. } = *place;
            self.nodes.push(Node { t, at, slope, arclength: self.arclength });
        }
    }

    /// Returns the distance between the end of a step and a limit (an arclength or a bound of a
    /// state), which is negative beyond the limit, and the derivative of this distance with respect
    /// to the step length.
    fn left(&self, limit: Limit, trial: &Trial) -> [f64; 2] {
        let Place { at, slope, .. } = &trial.end;
        match limit {
            Limit::Length => [self.limits.length - self.arclength - trial.length(), -norm(*slope)],
            Limit::Bound { axis, upper: true } => {
                [self.limits.bounds[axis][1] - at[axis], -slope[axis]]
            }
            Limit::Bound { axis, upper: false } => {
                [at[axis] - self.limits.bounds[axis][0], slope[axis]]
            }
        }
    }

    /// Shortens a step that passes a limit (an arclength or a bound of a state), and returns the
    /// step that ends at the limit.
    fn step_to(&self, limit: Limit) -> f64 {
        let ends = RootLimits { rounds: 60, moved: 1e-15 };
        bracketed_zero([0.0, self.step], 1.0, 0.5 * self.step, ends, |step| {
            // A step that fails is too long.
            self.trial(step).map_or([-1.0, f64::NAN], |trial| self.left(limit, &trial))
        })
    }

    /// Returns the reason why the half of the manifold ends, given the limit (an arclength or a
    /// bound of a state) at which it ends.
    fn reached(&self, limit: Limit) -> End {
        match limit {
            Limit::Length => {
                End::MonitorBound { name: ARCLENGTH.into(), value: self.limits.length }
            }
            Limit::Bound { axis, upper } => {
                let value = self.limits.bounds[axis][usize::from(upper)];
                let value = value * self.limits.scales[axis];
                End::MonitorBound { name: self.limits.names[axis].clone(), value }
            }
        }
    }

    fn is_inside(&self, place: &Place) -> bool {
        self.limits.outside(place.at).is_none()
    }

    fn in_units(&self, at: Vector) -> Vector {
        [0, 1].map(|i| at[i] * self.limits.scales[i])
    }
}

impl Limits {
    /// Returns the state that is outside its bounds; `None` if all states are within their bounds.
    pub fn outside(&self, at: Vector) -> Option<usize> {
        (0..2).find(|axis| {
            let [low, high] = self.bounds[*axis];
            !(low..=high).contains(&at[*axis])
        })
    }
}

/// The name of the arclength in the reason why a half ends.
pub const ARCLENGTH: &str = "arclength";

/// Returns the bend of the curve between two points, as a fraction of the allowed bend; the bend is
/// measured by the distance from the chord and, unless the points are close, by the angle between
/// the tangents.
fn bent([a, b]: [&Place; 2], step: f64, resolution: f64) -> f64 {
    let chord = minus(b.at, a.at);
    let length = norm(chord);
    let rise = minus(a.slope, b.slope).map(|part| part * step / 8.0);
    let away = if length > 0.0 { cross(chord, rise).abs() / length } else { norm(rise) };
    let along = a.slope[0] * b.slope[0] + a.slope[1] * b.slope[1];
    let turn = cross(a.slope, b.slope).abs().atan2(along);
    let turn = if length <= resolution { 0.0 } else { turn / TURN };
    (away / resolution).max(turn)
}
