//! Algebraic problems with known answers: folds, branch points, Hopf points, cusps.

use std::f64::consts::PI;
use tangency::core::continuation::{Branch, Continuation, End, Kind, Settings};
use tangency::core::dense::Dense;
use tangency::core::scalar::Scalar;
use tangency::core::zero::{Names, ZeroProblem};

fn close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "found {found:.15}, expected {expected:.15}");
}

fn show(branch: &Branch) {
    println!("{} {:?} {} points", branch.name, branch.ends, branch.points.len());
    for s in &branch.special {
        println!(
            "{} {} {:?} {:?} err {:.1e} {:?} {:?} {}",
            s.label,
            s.kind,
            s.parameters,
            s.unstable,
            s.error,
            s.state.iter().take(3).collect::<Vec<_>>(),
            s.bracket,
            s.converged
        );
    }
}

fn parameters(branch: &Branch, kind: Kind, name: &str) -> Vec<f64> {
    let column = branch.column(name).unwrap();
    branch.of_kind(kind).map(|point| point.value(column).unwrap()).collect()
}

/// `μ + x − x³/3 = 0`.
struct CuspSlice;

impl ZeroProblem for CuspSlice {
    fn names(&self) -> Names {
        Names::new(["x"], ["mu"])
    }
    fn residual<T: Scalar>(&self, x: &[T], p: &[T], r: &mut [T]) {
        r[0] = p[0] + x[0] - x[0].powi(3) / 3.0;
    }
}

#[test]
fn cusp_slice() {
    let mut system = Dense::new(CuspSlice);
    let branch = Continuation::of(&mut system)
        .from(&[-2.0])
        .at("mu", -1.0)
        .along("mu", -1.0..=1.0)
        .trace()
        .unwrap();
    show(&branch);
    let folds = parameters(&branch, Kind::LP, "mu");
    assert_eq!(folds.len(), 2);
    close(folds[0], 2.0 / 3.0, 1e-14);
    close(folds[1], -2.0 / 3.0, 1e-14);
    for fold in branch.of_kind(Kind::LP) {
        assert!(fold.error < 1e-13 && fold.converged);
        let outer = fold.parameters[0].abs();
        assert!(fold.bracket.iter().all(|mu| mu.abs() <= outer && mu.abs() > 0.9 * outer));
    }
    assert_eq!(branch.ends[1], End::ParameterBound { name: "mu".into(), value: 1.0 });
}

/// AUTO's demo pp2.
struct PredatorPrey;

impl ZeroProblem for PredatorPrey {
    fn names(&self) -> Names {
        Names::new(["x", "y"], ["p"])
    }
    fn residual<T: Scalar>(&self, z: &[T], p: &[T], r: &mut [T]) {
        let (x, y) = (z[0], z[1]);
        r[0] = x * 3.0 * (T::one() - x) - x * y - p[0] * (T::one() - (x * -5.0).exp());
        r[1] = x * y * 3.0 - y;
    }
}

#[test]
fn predator_prey() {
    let mut system = Dense::new(PredatorPrey);
    let trivial =
        Continuation::of(&mut system).named("trivial").along("p", 0.0..=1.0).trace().unwrap();
    let points = parameters(&trivial, Kind::BP, "p");
    assert_eq!(points.len(), 1);
    close(points[0], 0.6, 1e-13);
    let label = trivial.of_kind(Kind::BP).next().unwrap().label;
    let prey = Continuation::of(&mut system)
        .named("prey")
        .restart(&trivial, label)
        .switch()
        .along("p", 0.0..=1.0)
        .bound("p", 0.0..=1.0)
        .trace()
        .unwrap();
    show(&prey);
    close(parameters(&prey, Kind::LP, "p")[0], 0.832929322, 5e-10);
    close(parameters(&prey, Kind::BP, "p")[0], 0.821904345, 5e-10);
    let label = prey.of_kind(Kind::BP).next().unwrap().label;
    let both = Continuation::of(&mut system)
        .named("both")
        .restart(&prey, label)
        .switch()
        .along("p", 0.0..=1.0)
        .trace()
        .unwrap();
    show(&both);
    let hopf = both.of_kind(Kind::HB).next().unwrap();
    close(hopf.parameters[0], 0.671593847, 5e-10);
    close(hopf.state[1], 0.3657615360, 5e-11);
}

/// CO oxidation (Bykov), k and q₂ free.
struct Oxidation;

impl ZeroProblem for Oxidation {
    fn names(&self) -> Names {
        Names::new(["x", "y", "s"], ["q2", "k"])
    }
    fn residual<T: Scalar>(&self, u: &[T], p: &[T], r: &mut [T]) {
        let (x, y, s, q2, k) = (u[0], u[1], u[2], p[0], p[1]);
        let z = T::one() - x - y - s;
        r[0] = z * z * 5.0 - x * x * 2.0 - x * y * 10.0;
        r[1] = q2 * z - y * 0.1 - x * y * 10.0;
        r[2] = (z - k * s) * 0.0675;
    }
}

#[test]
fn oxidation() {
    let mut system = Dense::new(Oxidation);
    let branch = Continuation::of(&mut system)
        .from(&[0.001137, 0.891483, 0.062345])
        .at("q2", 2.0)
        .at("k", 0.4)
        .along("q2", 0.5..=2.0)
        .trace()
        .unwrap();
    show(&branch);
    let folds = parameters(&branch, Kind::LP, "q2");
    let mut sorted = folds.clone();
    sorted.sort_by(f64::total_cmp);
    close(sorted[0], 1.0420485053785, 1e-12);
    close(sorted[1], 1.0522002878700, 1e-12);
    let mut hopf = parameters(&branch, Kind::HB, "q2");
    hopf.sort_by(f64::total_cmp);
    close(hopf[0], 1.040_991_569_532_616_3, 1e-13);
    close(hopf[1], 1.051_557_462_457_730_4, 1e-13);
    let label = branch.of_kind(Kind::LP).next().unwrap().label;
    let curve = Continuation::of(&mut system)
        .named("folds")
        .restart(&branch, label)
        .hold(Kind::LP)
        .along("q2", 0.5..=2.0)
        .along("k", 0.1..=2.0)
        .trace()
        .unwrap();
    show(&curve);
    let cusp = curve.of_kind(Kind::CP).next().unwrap();
    close(cusp.parameters[0], 1.0064083296783, 1e-12);
    close(cusp.parameters[1], 0.3559912732087, 1e-12);
    let mut takens: Vec<_> =
        curve.of_kind(Kind::BT).map(|p| (p.parameters[0], p.parameters[1])).collect();
    takens.sort_by(|a, b| a.0.total_cmp(&b.0));
    close(takens[0].0, 1.1611987, 1e-7);
    close(takens[0].1, 0.7223391, 1e-7);
    close(takens[1].0, 1.4176276, 1e-7);
    close(takens[1].1, 0.9713976, 1e-7);
    let label = branch.of_kind(Kind::HB).next().unwrap().label;
    let hopfs = Continuation::of(&mut system)
        .named("Hopf")
        .restart(&branch, label)
        .hold(Kind::HB)
        .along("q2", 0.5..=2.0)
        .along("k", 0.2..=2.0)
        .trace()
        .unwrap();
    show(&hopfs);
}

/// Central differences of `u'' + λeᵘ = 0`, `u(0) = u(1) = 0`.
struct Bratu(usize);

impl ZeroProblem for Bratu {
    fn names(&self) -> Names {
        Names::new([("u", self.0)], ["lambda"]).with_monitors(["middle"])
    }
    fn residual<T: Scalar>(&self, u: &[T], p: &[T], r: &mut [T]) {
        let n = self.0;
        let inverse = ((n + 1) * (n + 1)) as f64;
        let at = |i: usize| if i == 0 || i > n { T::zero() } else { u[i - 1] };
        for i in 1..=n {
            r[i - 1] = (at(i - 1) - at(i) * 2.0 + at(i + 1)) * inverse + p[0] * at(i).exp();
        }
    }
    fn monitors<T: Scalar>(&self, u: &[T], _p: &[T], values: &mut [T]) {
        values[0] = u[self.0 / 2];
    }
}

#[test]
fn bratu() {
    let mut system = Dense::new(Bratu(99));
    let branch = Continuation::of(&mut system)
        .along("lambda", 0.0..=10.0)
        .bound("middle", 0.0..=5.0)
        .trace()
        .unwrap();
    let fold = parameters(&branch, Kind::LP, "lambda");
    println!("{} points {:?}", branch.points.len(), branch.ends);
    close(fold[0], 3.513647903969, 1e-11);
}

/// `u'' + 10 a (eᵘ − 1 − b u²/2) = 0`: branch points on `u = 0` at `a = (kπ)²/10` (continuum).
struct TrivialBranch(usize);

impl ZeroProblem for TrivialBranch {
    fn names(&self) -> Names {
        Names::new([("u", self.0)], ["a", "b"])
    }
    fn residual<T: Scalar>(&self, u: &[T], p: &[T], r: &mut [T]) {
        let n = self.0;
        let inverse = ((n + 1) * (n + 1)) as f64;
        let at = |i: usize| if i == 0 || i > n { T::zero() } else { u[i - 1] };
        for i in 1..=n {
            let source = at(i).exp() - 1.0 - p[1] * at(i) * at(i) * 0.5;
            r[i - 1] = (at(i - 1) - at(i) * 2.0 + at(i + 1)) * inverse + p[0] * source * 10.0;
        }
    }
}

#[test]
fn trivial_branch() {
    let n = 29;
    let mut system = Dense::new(TrivialBranch(n));
    let branch = Continuation::of(&mut system)
        .along("a", 0.0..=10.0)
        .settings(Settings::default())
        .trace()
        .unwrap();
    let h = 1.0 / (n as f64 + 1.0);
    let exact: Vec<f64> =
        (1..=3).map(|k| (2.0 / h * (k as f64 * PI * h / 2.0).sin()).powi(2) / 10.0).collect();
    let found = parameters(&branch, Kind::BP, "a");
    println!("{found:?} {exact:?}");
    for (found, exact) in found.iter().zip(&exact) {
        close(*found, *exact, 1e-11);
    }
    assert_eq!(found.len(), 3);
}
