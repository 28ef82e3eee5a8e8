//! Promise: folds, period doublings, torus points and branch points of periodic orbits are located
//! exactly, and held along curves in two parameters.

use crate::common::{close, ellipse, first, values};
use crate::orbits::cycles::{
    Bautin, ForcedSpiral, PitchforkOfCycles, collocated, equilibria, label, precisely_shot, shot,
};
use std::f64::consts::TAU;
use tangency::core::bvp::Shooting;
use tangency::core::continuation::{Branch, Continuation, End, Settings};
use tangency::core::ode::Scheme;
use tangency::core::orbit::periodic_orbits;
use tangency::core::problem::{Forcing, Names, VectorField};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Kind, System};
use tangency::problems::classic::Lure;

fn settings() -> Settings {
    Settings { max_step: 0.05, ..Settings::default() }
}

/// Period doublings of Lur'e's system in (α, β), and single ones at other β.
#[test]
fn period_doublings_in_two_parameters() {
    let doubling = |system: &mut dyn System, beta: f64| -> (Branch, usize) {
        let rest = equilibria(Lure, &[0.0; 3], &[1.5, beta], [0.4, 2.0]);
        let branch = Continuation::new(system)
            .restart(&rest, label(&rest, Kind::HB))
            .along("alpha", 0.4..=2.0)
            .settings(settings())
            .trace()
            .unwrap();
        let label = label(&branch, Kind::PD);
        (branch, label)
    };
    let expected: Vec<[f64; 2]> = [0.8, 1.2]
        .iter()
        .map(|beta| {
            let (branch, label) = doubling(&mut precisely_shot(Lure, 1), *beta);
            let point = branch.labelled(label).unwrap();
            [point.parameters[0], point.monitors[0]]
        })
        .collect();
    let (mut collocation, mut shooting) = (collocated(Lure, 25), shot(Lure, 2));
    for system in [&mut collocation as &mut dyn System, &mut shooting] {
        let (branch, label) = doubling(system, 1.0);
        let curve = Continuation::new(system)
            .restart(&branch, label)
            .hold(Kind::PD)
            .along("alpha", 0.3..=2.0)
            .along("beta", 0.75..=1.25)
            .mark("beta", 0.8)
            .mark("beta", 1.2)
            .settings(settings())
            .trace()
            .unwrap();
        for (point, expected) in curve.of_kind(Kind::UZ).zip(&expected) {
            close(point.parameters[0], expected[0], 1e-9);
            close(point.monitors[0], expected[1], 1e-8);
        }
        assert_eq!(curve.of_kind(Kind::UZ).count(), 2);
    }
}

#[test]
fn torus_points_in_two_parameters() {
    let kappa = 0.3;
    let (mut collocation, mut shooting) = (collocated(ForcedSpiral, 20), shot(ForcedSpiral, 3));
    let starts =
        [collocation.sampled(&[], ellipse(1.0, 1.0)), shooting.sampled(&[], ellipse(1.0, 1.0))];
    for (system, z) in [&mut collocation as &mut dyn System, &mut shooting].into_iter().zip(starts)
    {
        let branch = Continuation::new(system)
            .from(&z)
            .at("mu", -0.1)
            .at("kappa", kappa)
            .along("mu", -0.1..=0.3)
            .trace()
            .unwrap();
        let torus = first(&branch, Kind::TR);
        close(torus.parameters[0], kappa * kappa, 1e-11);
        assert_eq!(torus.unstable, Some(0));
        assert_eq!(branch.points.last().unwrap().unstable, Some(2));
        assert_eq!(branch.special.iter().filter(|s| s.kind != Kind::EP).count(), 1);
        let curve = Continuation::new(system)
            .restart(&branch, torus.label)
            .hold(Kind::TR)
            .along("mu", -0.1..=0.3)
            .along("kappa", -0.5..=0.5)
            .mark("kappa", 0.0)
            .trace()
            .unwrap();
        assert!(curve.points.len() > 5);
        for point in &curve.points {
            close(point.parameters[0], point.parameters[1].powi(2), 1e-9);
        }
        close(first(&curve, Kind::UZ).parameters[0], 0.0, 1e-11);
    }
    // The angle of the multipliers is ΩT.
    let mut system = shot(ForcedSpiral, 3);
    let z = system.sampled(&[], ellipse(1.0, 1.0));
    system.assemble(&[&z[..], &[kappa * kappa, kappa]].concat()).unwrap();
    let mu = system.multipliers().unwrap()[0];
    let period = TAU / ForcedSpiral::NU;
    close(mu.1.atan2(mu.0), ForcedSpiral::OMEGA * period, 1e-11);
    close(mu.0.hypot(mu.1), 1.0, 1e-11);
}

/// The forced spiral with scales of its states.
struct InUnits;

impl VectorField for InUnits {
    fn names(&self) -> Names {
        ForcedSpiral.names()
    }
    fn field<T: Scalar>(&self, t: T, z: &[T], p: &[T], f: &mut [T]) {
        ForcedSpiral.field(t, z, p, f);
    }
    fn forcing(&self) -> Forcing {
        ForcedSpiral.forcing()
    }
    fn period<T: Scalar>(&self, p: &[T]) -> T {
        ForcedSpiral.period(p)
    }
    fn scales(&self, _p: &[f64]) -> Vec<f64> {
        vec![2.0, 0.5]
    }
}

/// The curve μ = κ² is followed in any units.
#[test]
fn torus_points_in_units() {
    let (mut collocation, mut shooting) = (collocated(InUnits, 20), shot(InUnits, 3));
    let starts =
        [collocation.sampled(&[], ellipse(1.0, 1.0)), shooting.sampled(&[], ellipse(1.0, 1.0))];
    for (system, z) in [&mut collocation as &mut dyn System, &mut shooting].into_iter().zip(starts)
    {
        let start = Continuation::new(system).from(&z).at("mu", -0.1).at("kappa", 0.3);
        let branch = start.along("mu", -0.1..=0.3).trace().unwrap();
        let torus = first(&branch, Kind::TR);
        let curve = Continuation::new(system).restart(&branch, torus.label).hold(Kind::TR);
        let curve = curve.along("mu", -0.1..=0.3).along("kappa", -0.5..=0.5);
        let curve = curve.mark("kappa", 0.0).trace().unwrap();
        assert!(curve.points.len() > 5, "{} points; {:?}", curve.points.len(), curve.ends);
        close(first(&curve, Kind::UZ).parameters[0], 0.0, 1e-11);
    }
}

#[test]
fn branch_points_of_cycles() {
    let (mut collocation, mut shooting) =
        (collocated(PitchforkOfCycles, 20), shot(PitchforkOfCycles, 3));
    let starts = [
        collocation.sampled(&[TAU], ellipse(1.0, 1.0)),
        shooting.sampled(&[TAU], ellipse(1.0, 1.0)),
    ];
    for (system, z) in [&mut collocation as &mut dyn System, &mut shooting].into_iter().zip(starts)
    {
        let branch = Continuation::new(system)
            .from(&z)
            .at("mu", 0.5)
            .at("kappa", 0.2)
            .along("mu", 0.0..=2.0)
            .trace()
            .unwrap();
        let point = first(&branch, Kind::BP);
        close(point.parameters[0], 1.04, 1e-10);
        assert_eq!(branch.of_kind(Kind::BP).count(), 1);
        let other = Continuation::new(system)
            .restart(&branch, point.label)
            .switch()
            .along("mu", 0.0..=2.0)
            .mark("mu", 1.5)
            .trace()
            .unwrap();
        for p in other.points.iter().filter(|p| (p.parameters[0] - 1.04).abs() > 1e-9) {
            assert_eq!(p.unstable, Some(0), "{:?} of {:?}", p, other.points.len());
        }
        let half = first(&other, Kind::UZ);
        // 1/z² = y solves y' = 2 − 2(μ − 1.04 + cos t) y: linear, so that its periodic solution is
        // an integral.
        let names = &other.monitors;
        let largest = names.iter().position(|name| name == "max_z").unwrap();
        let smallest = names.iter().position(|name| name == "min_z").unwrap();
        let (mut low, mut high) = extremes_of_the_broken_branch(0.46);
        if half.monitors[largest] < 0.0 {
            (low, high) = (-high, -low);
        }
        close(half.monitors[largest], high, 1e-8);
        close(half.monitors[smallest], low, 1e-8);
        // The symmetry z → −z makes the branch point persist; without the symmetry, the branch point
        // breaks up.
        let mut curve = |other: &str| {
            let curve = Continuation::new(system).restart(&branch, point.label).hold(Kind::BP);
            curve.along("mu", 0.0..=2.0).along(other, -0.5..=0.5).trace()
        };
        let said = curve("delta").unwrap_err().to_string();
        assert!(said.contains("breaks up if `delta` changes"), "{said}");
        let curve = curve("kappa").unwrap();
        assert!(curve.points.len() > 5);
        for point in &curve.points {
            close(point.parameters[0], 1.0 + point.parameters[1].powi(2), 1e-9);
        }
    }
}

/// The extremes of `y^{−1/2}` with `y(t) = 2∫₀^∞ exp(−2(a s + sin t − sin(t − s))) ds`, by the
/// trapezoidal rule.
fn extremes_of_the_broken_branch(a: f64) -> (f64, f64) {
    let y = |t: f64| {
        let (step, end) = (1e-3, 45.0);
        let count = (end / step) as usize;
        let g = |s: f64| (-2.0 * (a * s + t.sin() - (t - s).sin())).exp();
        let dg = |s: f64| -2.0 * (a + (t - s).cos()) * g(s);
        let sum: f64 = (0..=count)
            .map(|k| g(k as f64 * step) * if k == 0 || k == count { 0.5 } else { 1.0 })
            .sum();
        // Euler and Maclaurin's first correction.
        2.0 * (sum * step - step * step / 12.0 * (dg(end) - dg(0.0)))
    };
    let z = |t: f64| y(t).powf(-0.5);
    let golden = |sign: f64, start: f64| {
        let (mut low, mut high) = (start - 0.1, start + 0.1);
        for _ in 0..40 {
            let (a, b) = (low + 0.382 * (high - low), low + 0.618 * (high - low));
            if sign * z(a) > sign * z(b) { high = b } else { low = a }
        }
        z(0.5 * (low + high))
    };
    let best = |sign: f64| {
        let samples = (0..63).map(|k| 0.1 * f64::from(k));
        samples.max_by(|a, b| (sign * z(*a)).total_cmp(&(sign * z(*b)))).unwrap()
    };
    (golden(-1.0, best(-1.0)), golden(1.0, best(1.0)))
}

#[test]
fn folds_of_cycles() {
    let rest = equilibria(Bautin, &[0.0; 2], &[0.5, 1.0], [-2.0, 1.0]);
    close(first(&rest, Kind::HB).parameters[0], 0.0, 1e-13);
    let (mut collocation, mut shooting) = (collocated(Bautin, 20), shot(Bautin, 1));
    for system in [&mut collocation as &mut dyn System, &mut shooting] {
        let branch = Continuation::new(system)
            .restart(&rest, label(&rest, Kind::HB))
            .along("mu", -2.0..=1.0)
            .settings(settings())
            .trace()
            .unwrap();
        let fold = first(&branch, Kind::LP);
        assert_eq!(branch.of_kind(Kind::BP).count(), 0);
        close(fold.parameters[0], -1.0, 1e-11);
        close(fold.monitors[1], 1.0, 1e-7);
        assert_eq!(values(&branch, Kind::LP, "mu").len(), 1);
        for point in &branch.points[1..] {
            // μ = r⁴ − 2r², unstable where r < 1.
            let square = point.monitors[1].powi(2);
            close(point.parameters[0], square * square - 2.0 * square, 1e-7);
            assert_eq!(point.unstable, Some(usize::from(square < 1.0)));
        }
        let curve = Continuation::new(system)
            .restart(&branch, fold.label)
            .hold(Kind::LP)
            .along("mu", -2.0..=1.0)
            .along("kappa", 0.2..=1.2)
            .mark("kappa", 0.5)
            .settings(settings())
            .trace()
            .unwrap();
        for point in &curve.points {
            close(point.parameters[0], -point.parameters[1].powi(2), 1e-8);
        }
        close(first(&curve, Kind::UZ).parameters[0], -0.25, 1e-10);
        assert!(curve.ends.iter().all(|end| matches!(end, End::ParameterBound { .. })));
    }
}

/// On curves of special points, the target for the error is 1e-6. A flow with a tolerance of 1e-5 has a
/// larger error, which shorter intervals do not reduce: the orbits keep their one interval.
#[test]
fn rough_flows_keep_their_intervals() {
    let rest = equilibria(Bautin, &[0.0; 2], &[0.5, 1.0], [-2.0, 1.0]);
    let method = Shooting::new(Scheme::DormandPrince8, 1e-5).unwrap();
    let mut system = periodic_orbits(Bautin, 1, method).unwrap();
    let settings = Settings { refinement: 0.0, ..settings() };
    let branch = Continuation::new(&mut system)
        .restart(&rest, label(&rest, Kind::HB))
        .along("mu", -2.0..=1.0)
        .settings(settings.clone())
        .trace()
        .unwrap();
    let curve = Continuation::new(&mut system)
        .restart(&branch, label(&branch, Kind::LP))
        .hold(Kind::LP)
        .along("mu", -2.0..=1.0)
        .along("kappa", 0.2..=1.2)
        .settings(settings)
        .trace()
        .unwrap();
    for point in &curve.points {
        close(point.parameters[0], -point.parameters[1].powi(2), 1e-4);
    }
    for special in &curve.special {
        assert_eq!(special.mesh, [0.0, 1.0]);
    }
}
