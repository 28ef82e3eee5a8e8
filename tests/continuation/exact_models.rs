//! Promise: models with known special points have these, and no others, in any coordinates.
//!
//! A normal form of independent parts is stated in other coordinates: a polynomial change, a mixing
//! of all states by a matrix of integers with determinant 1, and units from 1e-6 to 1e6 for each
//! state. Special points, their errors and the counts of unstable eigenvalues are known exactly.

use crate::common::random::Random;
use tangency::core::continuation::{Branch, Continuation, TraceError};
use tangency::core::orbit::MapCycle;
use tangency::core::problem::{DiscreteMap, Names, ZeroProblem};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Dense, Kind};

/// How many models of each family are tried.
const MODELS: u64 = 500;

/// The range of the parameter.
const RANGE: f64 = 3.0;

/// Errors are estimates: points are at most this many times theirs away from the exact place,
const ESTIMATE: f64 = 3.0;
/// and the rounding of the change of coordinates.
const ROUNDING: f64 = 3e-11;

/// A part that loses or gains stability where the parameter passes a value.
#[derive(Clone, Copy, Debug)]
struct Loss {
    at: f64,
    /// 1 if it is unstable above, −1 if below.
    sign: f64,
}

/// A normal form in other coordinates.
#[derive(Clone, Debug)]
struct Model {
    /// `u' = p − (u³ − 3 a² u)`: folds at `u = ±a`, `p = ∓2 a³`.
    a: f64,
    /// `w' = s (p − p₁) w − w³`.
    pitchfork: Option<Loss>,
    /// A doubling `w ↦ −(1 + s (p − p₃)) w + w³`, of maps only.
    doubling: Option<Loss>,
    /// `z' = (s (p − p₂) + iω) z − |z|² z`.
    pair: Option<Loss>,
    omega: f64,
    /// The change of coordinates: `vᵢ = uᵢ + Σ_{j<i} cᵢⱼ uⱼ²`, then `x = D A v`.
    bend: f64,
    mixing: Vec<Vec<f64>>,
    inverse: Vec<Vec<f64>>,
    units: Vec<f64>,
    /// Whether the units are stated as scales.
    stated: bool,
    map: bool,
}

/// A number from `low` to `high`.
fn between(random: &mut Random, low: f64, high: f64) -> f64 {
    low + (high - low) * (random.number() >> 11) as f64 / (1u64 << 53) as f64
}

/// The identity, changed by adding rows to others: its inverse is made the same way backwards.
fn mixing(random: &mut Random, n: usize) -> [Vec<Vec<f64>>; 2] {
    let unit = |i: usize| (0..n).map(|j| if i == j { 1.0 } else { 0.0 }).collect::<Vec<f64>>();
    let mut forward: Vec<Vec<f64>> = (0..n).map(unit).collect();
    let mut inverse = forward.clone();
    for _ in 0..2 * n {
        let (i, j) = ((random.number() % n as u64) as usize, (random.number() % n as u64) as usize);
        let factor = if random.number().is_multiple_of(2) { 1.0 } else { -1.0 };
        if i == j {
            continue;
        }
        for k in 0..n {
            forward[i][k] += factor * forward[j][k];
            inverse[k][j] -= factor * inverse[k][i];
        }
    }
    [forward, inverse]
}

impl Model {
    /// A random model; values at which parts lose stability are apart from each other and from the
    /// folds.
    fn random(random: &mut Random, map: bool, powers: f64) -> Self {
        let a = between(random, 0.3, 0.9);
        let mut taken = vec![-2.0 * a * a * a, 2.0 * a * a * a];
        let mut loss = |random: &mut Random| {
            if random.number().is_multiple_of(4) {
                return None;
            }
            loop {
                let at = between(random, -2.5, 2.5);
                if taken.iter().all(|other| (at - other).abs() > 0.05) {
                    taken.push(at);
                    let sign = if random.number().is_multiple_of(2) { 1.0 } else { -1.0 };
                    return Some(Loss { at, sign });
                }
            }
        };
        let (pitchfork, pair) = (loss(random), loss(random));
        let doubling = loss(random).filter(|_| map);
        let n = 1
            + usize::from(pitchfork.is_some())
            + usize::from(doubling.is_some())
            + 2 * usize::from(pair.is_some());
        let [mixing, inverse] = mixing(random, n);
        let units = (0..n).map(|_| 10.0_f64.powf(between(random, -powers, powers).round()));
        let units = units.collect();
        let omega = if map { between(random, 0.7, 1.4) } else { between(random, 0.5, 3.0) };
        let bend = between(random, -0.3, 0.3);
        let stated = false;
        Model { a, pitchfork, doubling, pair, omega, bend, mixing, inverse, units, stated, map }
    }

    fn dimension(&self) -> usize {
        self.units.len()
    }

    fn scales(&self) -> Vec<f64> {
        if self.stated { self.units.clone() } else { Vec::new() }
    }

    /// Whether a state vanishes all along the branch: only the first two parts of a normal form
    /// change there, the second one by the change of coordinates.
    fn has_zeros(&self) -> bool {
        self.mixing.iter().any(|row| row.iter().take(2).all(|entry| *entry == 0.0))
    }

    /// The states of the normal form.
    fn own<T: Scalar>(&self, x: &[T]) -> Vec<T> {
        let n = self.dimension();
        let scaled: Vec<T> = x.iter().zip(&self.units).map(|(x, unit)| *x / *unit).collect();
        let row = |i: usize| (0..n).fold(T::zero(), |sum, j| sum + scaled[j] * self.inverse[i][j]);
        let mut u: Vec<T> = (0..n).map(row).collect();
        for i in 1..n {
            let square = u[i - 1] * u[i - 1];
            u[i] -= square * self.bend;
        }
        u
    }

    /// The states from those of the normal form.
    fn outer<T: Scalar>(&self, u: &[T]) -> Vec<T> {
        let n = self.dimension();
        let bent = |i: usize| {
            if i == 0 { u[0] } else { u[i] + u[i - 1] * u[i - 1] * self.bend }
        };
        let v: Vec<T> = (0..n).map(bent).collect();
        let row = |i: usize| (0..n).fold(T::zero(), |sum, j| sum + v[j] * self.mixing[i][j]);
        (0..n).map(|i| row(i) * self.units[i]).collect()
    }

    /// The rates of the states, of those of the normal form.
    fn rates<T: Scalar>(&self, u: &[T], rates: &[T]) -> Vec<T> {
        let n = self.dimension();
        let bent = |i: usize| match i {
            0 => rates[0],
            _ => rates[i] + u[i - 1] * rates[i - 1] * (2.0 * self.bend),
        };
        let v: Vec<T> = (0..n).map(bent).collect();
        let row = |i: usize| (0..n).fold(T::zero(), |sum, j| sum + v[j] * self.mixing[i][j]);
        (0..n).map(|i| row(i) * self.units[i]).collect()
    }

    /// The rates of the normal form, or its next states.
    fn normal_form<T: Scalar>(&self, u: &[T], p: T) -> Vec<T> {
        let first = p - (u[0].powi(3) - u[0] * (3.0 * self.a * self.a));
        let mut out = vec![if self.map { u[0] + first * 0.1 } else { first }];
        let mut rest = &u[1..];
        if let Some(Loss { at, sign }) = self.pitchfork {
            let w = rest[0];
            rest = &rest[1..];
            let rate = (p - at) * sign * w - w.powi(3);
            out.push(if self.map { w + rate * 0.2 } else { rate });
        }
        if let Some(Loss { at, sign }) = self.doubling {
            let w = rest[0];
            rest = &rest[1..];
            out.push(-w - (p - at) * sign * w * 0.2 + w.powi(3));
        }
        if let (Some(Loss { at, sign }), [x, y]) = (self.pair, rest) {
            let (growth, square) = ((p - at) * sign, *x * *x + *y * *y);
            if self.map {
                let factor = growth * 0.2 - square + 1.0;
                let (sine, cosine) = self.omega.sin_cos();
                out.push(factor * (*x * cosine - *y * sine));
                out.push(factor * (*x * sine + *y * cosine));
            } else {
                out.push(growth * *x - *y * self.omega - square * *x);
                out.push(growth * *y + *x * self.omega - square * *y);
            }
        }
        out
    }

    /// The special points of the branch on which only the first state moves: kinds, values of the
    /// parameter and counts of unstable eigenvalues, the critical ones left out.
    fn expected(&self) -> Vec<(Kind, f64, usize)> {
        let (a, p) = (self.a, |u: f64| u.powi(3) - 3.0 * self.a * self.a * u);
        let of = |kind, loss: Option<Loss>, count| loss.map(|loss| (kind, loss, count));
        let pair = if self.map { Kind::TR } else { Kind::HB };
        let parts = [
            of(Kind::BP, self.pitchfork, 1),
            of(Kind::PD, self.doubling, 1),
            of(pair, self.pair, 2),
        ];
        let unstable = |u: f64, without: Option<Kind>| {
            let middle = usize::from(u.abs() < a * (1.0 - 1e-9));
            let lost = |(kind, Loss { at, sign }, count): &(Kind, Loss, usize)| {
                if Some(*kind) == without || (p(u) - at) * sign <= 0.0 { 0 } else { *count }
            };
            middle + parts.iter().flatten().map(lost).sum::<usize>()
        };
        let mut all =
            vec![(Kind::LP, p(a), unstable(a, None)), (Kind::LP, p(-a), unstable(-a, None))];
        for (kind, Loss { at, .. }, _) in parts.iter().flatten() {
            // Where the curve passes this value of the parameter: roots of a cubic.
            for third in 0..3 {
                let place = place(a, *at, third);
                let Some(u) = place else { continue };
                all.push((*kind, *at, unstable(u, Some(*kind))));
            }
        }
        all
    }
}

/// The `k`-th root `u` of `u³ − 3 a² u = p`.
fn place(a: f64, p: f64, k: usize) -> Option<f64> {
    let ratio = p / (2.0 * a * a * a);
    if ratio.abs() < 1.0 {
        let angle = (ratio.acos() + std::f64::consts::TAU * k as f64) / 3.0;
        return Some(2.0 * a * angle.cos());
    }
    let angle = ratio.abs().acosh() / 3.0;
    (k == 0).then(|| 2.0 * a * angle.cosh() * ratio.signum())
}

struct Flow(Model);

fn names(n: usize) -> Names {
    let states: Vec<String> = (0..n).map(|k| format!("x{k}")).collect();
    Names::new(states.iter().map(String::as_str), ["p"])
}

impl ZeroProblem for Flow {
    fn names(&self) -> Names {
        names(self.0.dimension())
    }
    fn scales(&self, _p: &[f64]) -> Vec<f64> {
        self.0.scales()
    }
    fn residual<T: Scalar>(&self, z: &[T], p: &[T], r: &mut [T]) {
        let u = self.0.own(z);
        r.copy_from_slice(&self.0.rates(&u, &self.0.normal_form(&u, p[0])));
    }
}

struct Iteration(Model);

impl DiscreteMap for Iteration {
    fn names(&self) -> Names {
        names(self.0.dimension())
    }
    fn scales(&self, _p: &[f64]) -> Vec<f64> {
        self.0.scales()
    }
    fn next<T: Scalar>(&self, x: &[T], p: &[T], next: &mut [T]) {
        let u = self.0.own(x);
        next.copy_from_slice(&self.0.outer(&self.0.normal_form(&u, p[0])));
    }
}

fn traced(model: &Model) -> Result<Branch, TraceError> {
    // From where the only state that moves has p = −RANGE.
    let u = place(model.a, -RANGE, 0).expect("one root");
    let mut start = vec![0.0; model.dimension()];
    start[0] = u;
    let x = model.outer(&start);
    if model.map {
        let mut system = MapCycle::of(Iteration(model.clone()), 1);
        let curve = Continuation::new(&mut system).from(&x).at("p", -RANGE);
        curve.along("p", -RANGE..=RANGE).trace()
    } else {
        let mut system = Dense::new(Flow(model.clone()));
        let curve = Continuation::new(&mut system).from(&x).at("p", -RANGE);
        curve.along("p", -RANGE..=RANGE).trace()
    }
}

/// What is wrong with the special points of a branch, in words.
fn wrong(model: &Model, branch: &Branch) -> Vec<String> {
    let mut wrong = Vec::new();
    let mut found: Vec<_> = branch.special.iter().filter(|s| s.kind != Kind::EP).collect();
    for (kind, p, unstable) in model.expected() {
        let nearest = (0..found.len())
            .filter(|k| found[*k].kind == kind && found[*k].unstable == Some(unstable))
            .min_by(|a, b| {
                let away = |k: &usize| (found[*k].parameters[0] - p).abs();
                away(a).total_cmp(&away(b))
            });
        let Some(point) = nearest.map(|k| found.swap_remove(k)) else {
            wrong.push(format!("missing {kind} at {p}, unstable {unstable}"));
            continue;
        };
        let (away, error) = ((point.parameters[0] - p).abs(), point.error);
        if !point.converged || away > ESTIMATE * error + ROUNDING {
            wrong.push(format!("{kind} at {p} is {away:.1e} away, error {error:.1e}"));
        }
    }
    for extra in found {
        let (kind, p, unstable) = (extra.kind, extra.parameters[0], extra.unstable);
        wrong.push(format!("extra {kind} at {p}, unstable {unstable:?}"));
    }
    wrong
}

/// Units are stated as scales, or found at the start: of states that do not vanish all along.
fn check(map: bool, powers: f64, stated: bool) {
    let mut all = Vec::new();
    for seed in 0..MODELS {
        let mut model = Model::random(&mut Random::new(seed), map, powers);
        if powers > 0.0 && !stated && model.has_zeros() {
            continue;
        }
        model.stated = stated;
        match traced(&model) {
            Ok(branch) => {
                let wrong = wrong(&model, &branch);
                if !wrong.is_empty() {
                    let ends = format!("{}; {}", branch.ends[0], branch.ends[1]);
                    all.push(format!("{seed}: {} ({ends}) {model:?}", wrong.join(", ")));
                }
            }
            Err(error) => all.push(format!("{seed}: {error} {model:?}")),
        }
    }
    assert!(all.is_empty(), "{} of {MODELS} models:\n{}", all.len(), all.join("\n"));
}

#[test]
fn equilibria_in_units_near_one() {
    check(false, 0.0, false);
}

#[test]
fn equilibria_in_units_that_are_stated() {
    check(false, 6.0, true);
}

#[test]
fn equilibria_in_units_that_are_found() {
    check(false, 6.0, false);
}

#[test]
fn fixed_points_of_maps_in_units_near_one() {
    check(true, 0.0, false);
}

#[test]
fn fixed_points_of_maps_in_units_that_are_stated() {
    check(true, 6.0, true);
}

#[test]
fn fixed_points_of_maps_in_units_that_are_found() {
    check(true, 6.0, false);
}
