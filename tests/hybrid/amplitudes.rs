//! Promise: period doublings and torus points of orbits with impacts have the coefficients of the map
//! from impact to impact, which simulations give, and these tell how large the motion beyond the points
//! is.

use crate::common::close;
use crate::hybrid::systems::impact_map::{Fitted, ImpactMap};
use crate::hybrid::systems::impact_oscillator::ClosedForm;
use crate::hybrid::systems::orbits::{Start, by_both, impacting};
use crate::hybrid::systems::rebound::{self, Rebound};
use crate::hybrid::systems::reference::Reference;
use nalgebra::Complex;
use std::f64::consts::TAU;
use tangency::core::bifurcation::NullSpace;
use tangency::core::continuation::{Branch, Continuation, SpecialPoint};
use tangency::core::linalg::Form;
use tangency::core::problem::Group;
use tangency::core::system::{Kind, Solution};
use tangency::problems::classic::ImpactOscillator;
use tangency::problems::mita::Actuator;

/// Orbits with an impact in a period, by one method, and their map from impact to impact. The first
/// leg begins with the impact.
struct Orbits {
    start: Start,
    map: ImpactMap<Reference>,
    /// The unknown whose last value is the speed of the impact.
    speed: &'static str,
    /// The parameter that varies, the first one, and its range.
    along: (&'static str, [f64; 2]),
}

/// A special point.
struct Located {
    branch: Branch,
    point: SpecialPoint,
    /// The critical multiplier.
    multiplier: Complex<f64>,
    /// The impact's time and speed.
    at: [f64; 2],
    /// Their deviations along the critical direction `q`, `∫⟨q, q⟩ dt = 1`.
    q: [Complex<f64>; 2],
    /// The map there.
    fitted: Fitted,
}

/// The places of the first and the last value of an unknown.
fn places(unknowns: &[Group], name: &str) -> [usize; 2] {
    let k = unknowns.iter().position(|group| group.name == name).unwrap();
    let first: usize = unknowns[..k].iter().map(|group| group.length).sum();
    [first, first + unknowns[k].length - 1]
}

impl Orbits {
    fn new(
        start: Start,
        (system, impact, stop): (Reference, (usize, usize), f64),
        speed: &'static str,
        along: (&'static str, [f64; 2]),
    ) -> Self {
        let map = ImpactMap { system, impact, stop, p: start.p.clone() };
        Orbits { start, map, speed, along }
    }

    fn of_oscillator() -> [Self; 2] {
        let impact = (ImpactOscillator::IMPACT, ImpactOscillator::FLIGHT);
        let of = (Reference::ImpactOscillator, impact, 1.0);
        let starts = impacting(&ClosedForm::usual(2.2), 1.3);
        starts.map(|start| Orbits::new(start, of, "velocity", ("amplitude", [3.0, 6.0])))
    }

    /// Mita's actuator of type I.
    fn of_actuator() -> [Self; 2] {
        let system = Reference::Actuator;
        let mut p = Actuator::DEFAULTS;
        (p[0], p[1]) = (0.55, 0.5);
        let starts: [&[f64]; 2] = [&[0.5, -0.547, 0.2053, 0.0], &[0.4735, -0.305]];
        let extras = [3.7165, 0.06225, TAU - 0.06225];
        let starts = by_both(system, "forward:rest stick:front", &starts, &extras, &p);
        let of = (system, (Actuator::FRONT, Actuator::STICK), p[2]);
        starts.map(|start| Orbits::new(start, of, "velocity[1]", ("voltage", [0.5, 0.6])))
    }

    fn of_rebound() -> [Self; 2] {
        let (system, u) = (Reference::Rebound, 1.5);
        let critical = rebound::critical(u);
        let form = rebound::orbit(u, critical + 0.03);
        let p = [form.damping, form.amplitude(u)];
        let state = [1.0, -form.restitution * u];
        let extras = [form.time(u), TAU / form.frequency];
        let starts = by_both(system, "flight:impact", &[&state], &extras, &p);
        let (of, range) =
            ((system, (Rebound::IMPACT, Rebound::FLIGHT), 1.0), [critical - 0.03, critical + 0.04]);
        starts.map(|start| Orbits::new(start, of, "velocity", ("damping", range)))
    }

    fn located(&mut self, kind: Kind) -> Located {
        let (name, range) = self.along;
        let branch = self.start.along(name, range).trace().unwrap();
        let point = branch.of_kind(kind).next().unwrap().clone();
        let (form, multiplier) = match point.number("torus_angle") {
            Some(angle) => (Form::Oscillation(angle.value), Complex::cis(angle.value)),
            None => (Form::Antiperiodic, Complex::new(-1.0, 0.0)),
        };
        let [time, _] = places(&branch.unknowns, "start");
        let [_, speed] = places(&branch.unknowns, self.speed);
        let at = [point.state[time], point.state[speed]];
        let [t, u] = self.critical(&branch.solution(&point), form, [time, speed]);
        self.map.p.clone_from(&point.parameters);
        let fitted = self.map.fitted(at, 0.005);
        // The vector has the speed of the next impact.
        Located { branch, point, multiplier, at, q: [t, u / multiplier], fitted }
    }

    /// Unknowns along the critical direction.
    fn critical(&mut self, solution: &Solution, form: Form, at: [usize; 2]) -> [Complex<f64>; 2] {
        let system = self.start.system.as_mut();
        // The mesh has moved on along the branch.
        let z = system.resume_from(solution).unwrap().z;
        let x = [z, solution.parameters.clone()].concat();
        let mut null = NullSpace::default();
        null.start(system, &x, form, None).unwrap();
        let mut parts = null.of(system, &x, form, None).unwrap().right.clone();
        if form == Form::Antiperiodic {
            parts.truncate(1);
        }
        let square: f64 = parts.iter().map(|d| system.deviation(&x, d).unwrap().square).sum();
        let im = |k: usize| parts.get(1).map_or(0.0, |part| part[k]);
        at.map(|k| Complex::new(parts[0][k], im(k)) / square.sqrt())
    }
}

impl Located {
    fn value(&self, name: &str) -> f64 {
        self.point.number(name).unwrap().value
    }

    /// The map's multiplier is the orbit's, and its coefficient `T c = D |q_t|²`.
    fn agrees_with_map(&self, rate: Complex<f64>, period: f64) {
        let Located { multiplier, q, fitted, .. } = self;
        let slope = fitted.slope();
        let characteristic =
            multiplier * multiplier - multiplier * slope.trace() + slope.determinant();
        close(fitted.missed(), 0.0, 1e-8);
        close(characteristic.norm(), 0.0, 1e-6);
        let (cubic, _) = fitted.cubic(*multiplier);
        let expected = cubic * q[0].norm_sqr() / period;
        println!("{rate}, by the map {expected}");
        // Simulated images have some 11 digits: at nodes 5e-3 apart that leaves 1e-4 of the third
        // derivatives.
        close((rate - expected).norm(), 0.0, 3e-4 * expected.norm());
    }

    /// `ξ²` so far beyond the point.
    fn square(&self, rate: &str, away: f64) -> f64 {
        -self.value("growth_slope") / self.value(rate) * away
    }
}

/// Values `y` at `x`, `2x`, `3x` as `y = a x + b x² + c x³`: `a`, by Richardson's extrapolation.
fn slope(x: f64, [y1, y2, y3]: [f64; 3]) -> f64 {
    (3.0 * y1 - 1.5 * y2 + y3 / 3.0) / x
}

#[test]
fn doublings_have_the_coefficient_of_the_map_from_impact_to_impact() {
    for mut orbits in Orbits::of_oscillator().into_iter().chain(Orbits::of_actuator()) {
        let located = orbits.located(Kind::PD);
        let rate = Complex::new(located.value("doubling_c"), 0.0);
        located.agrees_with_map(rate, orbits.map.period());
        // Neither device has torus points with a coefficient: areas shrink, or all are kept.
        assert!(located.fitted.slope().determinant() < 1.0);
    }
}

#[test]
fn torus_points_have_the_coefficient_of_the_map_from_impact_to_impact() {
    for mut orbits in Orbits::of_rebound() {
        let located = orbits.located(Kind::TR);
        let [re, im] = ["torus_d_re", "torus_d_im"].map(|name| located.value(name));
        located.agrees_with_map(Complex::new(re, im), orbits.map.period());
    }
}

/// Beyond a doubling successive impacts come sooner and later by `ξ q_t`: as simulated motion that
/// returns after two periods, and on the doubled branch.
#[test]
fn doubled_orbits_have_the_amplitude_of_their_coefficient() {
    for mut orbits in Orbits::of_oscillator().into_iter().chain(Orbits::of_actuator()) {
        let located = orbits.located(Kind::PD);
        let at = located.point.parameters[0];
        let away = (1e-3 * at).copysign(located.square("doubling_c", 1.0));
        let expected = located.square("doubling_c", 1.0) * (2.0 * located.q[0].re).powi(2);
        let simulated = [1.0, 2.0, 3.0].map(|k| {
            let xi = located.square("doubling_c", k * away).sqrt();
            let near = [0, 1].map(|i| located.at[i] + xi * located.q[i].re);
            orbits.map.p[0] = at + k * away;
            let first = orbits.map.fixed(near, 2);
            (orbits.map.image(first, 1)[0] - first[0]).powi(2)
        });
        let found = slope(away, simulated);
        println!("{} {found} {expected} {simulated:?}", orbits.start.method);
        close(found, expected, 0.01 * expected.abs());
        for (by_branch, simulated) in orbits.doubled(&located, away).into_iter().zip(simulated) {
            close(by_branch, simulated, 1e-8 * simulated);
        }
    }
}

impl Orbits {
    /// The squares of the differences in time between successive impacts of doubled orbits, less a
    /// period, so far beyond the doubling and twice and three times as far.
    fn doubled(&mut self, located: &Located, away: f64) -> [f64; 3] {
        let (Located { branch, point, .. }, (name, _)) = (located, self.along);
        let period = self.map.period();
        let marks = [1.0, 2.0, 3.0].map(|k| point.parameters[0] + k * away);
        let [one, other] = [-0.5, 3.5].map(|k| point.parameters[0] + k * away);
        let run = Continuation::new(self.start.system.as_mut()).restart(branch, point.label);
        let run = marks.iter().fold(run.switch(), |run, at| run.mark(name, *at));
        let doubled = run.along(name, one.min(other)..=one.max(other)).trace().unwrap();
        let durations = doubled.unknowns.iter().filter(|group| group.name.starts_with("duration"));
        let half = durations.count() / 2;
        marks.map(|at| {
            let apart = |point: &SpecialPoint| (point.parameters[0] - at).abs();
            let nearest = doubled
                .of_kind(Kind::UZ)
                .min_by(|a, b| apart(a).total_cmp(&apart(b)))
                .unwrap_or_else(|| panic!("no doubled orbit at {at}"));
            let place = |k: usize| places(&doubled.unknowns, &format!("duration[{k}]"))[0];
            let first: f64 = (0..half).map(|k| nearest.state[place(k)]).sum();
            (first - period).powi(2)
        })
    }
}

/// Beyond a torus point simulated motion has the mean square `⟨|z|²⟩ = |ξ|² |q_t|²` of the component
/// along the critical direction.
#[test]
fn tori_have_the_size_of_their_coefficient() {
    let [_, mut orbits] = Orbits::of_rebound();
    let located = orbits.located(Kind::TR);
    let (_, left) = located.fitted.cubic(located.multiplier);
    let ratio = located.square("torus_d_re", 1.0);
    let away = 2e-3_f64.copysign(ratio);
    let at = located.point.parameters[0];
    let means = [1.0, 2.0, 3.0].map(|k| {
        orbits.map.p[0] = at + k * away;
        let center = orbits.map.fixed(located.at, 1);
        let xi = (ratio * k * away).sqrt();
        let begin = [0, 1].map(|i| center[i] + 2.0 * xi * located.q[i].re);
        let impacts = orbits.map.impacts(begin, 6000);
        let squares = impacts[2000..].iter().map(|x| {
            let z = left[0] * (x[0] - center[0]) + left[1] * (x[1] - center[1]);
            z.norm_sqr()
        });
        squares.sum::<f64>() / 4000.0
    });
    let (found, expected) = (slope(away, means), ratio * located.q[0].norm_sqr());
    println!("{found} {expected} {means:?}");
    close(found, expected, 0.01 * expected.abs());
}
