//! Problems that strangers brought: each was once answered wrongly without a word.

use crate::common::{Columns, CuspSlice, close};
use tangency::core::attractor::CycleSearch;
use tangency::core::bvp::{Collocation, Shooting};
use tangency::core::continuation::{
    Branch, Continuation, End, Event, Settings, TestPoint, TraceError,
};
use tangency::core::failure::one_line;
use tangency::core::hybrid::{HybridFlow, HybridSettings, HybridState};
use tangency::core::orbit::{Smooth, from_cycle, periodic_orbits};
use tangency::core::problem::{Dynamics, Equilibria, Names, VectorField, ZeroProblem};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Dense, Kind, Solution, System};
use tangency::problems::classic::Lure;
use tangency::{vector_field, zero_problem};

fn step(max_step: f64) -> Settings {
    Settings { max_step, ..Settings::default() }
}

zero_problem! {
    /// One unknown grows like `e^{8p}`; in the other one `w (w − p − ½) = 0`, so that branches cross at
    /// `p = −½`.
    struct Grows [x, w; p] {
        0 = x - ((p * 8.0).exp() - 1.0);
        0 = w * (p + 0.5 - w);
    }
}

zero_problem! {
    /// `x' = 10⁹ p − x²`: along the branch `p` changes by less than what is rounding elsewhere.
    struct Flat [x; p] {
        0 = p * 1e9 - x * x;
        monitor height = x;
    }
}

/// A fold is one by its change of stability, however flat.
#[test]
fn a_flat_fold_is_found() {
    let mut system = Dense::new(Flat);
    let curve = Continuation::new(&mut system).at("p", 1e-9).from(&[1.0]);
    let curve = curve.bound("height", -1.0..=2.0).along("p", -1.0..=1.0).trace().unwrap();
    let kinds: Vec<Kind> = curve.special.iter().map(|special| special.kind).collect();
    assert_eq!(kinds, [Kind::EP, Kind::LP, Kind::EP]);
    close(curve.special[1].parameters[0], 0.0, 1e-18);
    close(curve.special[1].state[0], 0.0, 1e-9);
}

#[test]
fn switching_leaves_the_branch_one_comes_from() {
    for max_step in [0.02, 0.05, 0.1, 0.2, 0.5] {
        let mut system = Dense::new(Grows);
        let curve =
            Continuation::new(&mut system).at("p", -1.0).from(&[(-8.0_f64).exp() - 1.0, 0.0]);
        let branch = curve.settings(step(max_step)).along("p", -1.0..=1.0).trace().unwrap();
        let crossing = branch.of_kind(Kind::BP).next().unwrap();
        close(crossing.parameters[0], -0.5, 1e-12);
        close(crossing.tangent[1], 0.0, 1e-9);
        let other = Continuation::new(&mut system).settings(step(max_step));
        let other = other.restart(&branch, crossing.label).switch().along("p", -1.0..=1.0).trace();
        for end in other.unwrap().of_kind(Kind::EP) {
            close(end.state[1], end.parameters[0] + 0.5, 1e-9);
        }
    }
}

zero_problem! {
    /// `(x − p/3)(x² + p² − 1) = 0`: a circle that a line crosses twice.
    struct CrossedCircle [x; p] {
        0 = (x - p / 3.0) * (x * x + p * p - 1.0);
    }
}

/// The circle closes after one round, with two folds, from a branch point and from an ordinary
/// point.
#[test]
fn closed_curves_close_wherever_they_are_entered() {
    let check = |curve: &Branch, crossings: usize| {
        let case = format!("{}: {:?}", curve.settings.max_step, curve.ends);
        assert!(curve.ends.iter().all(|end| matches!(end, End::Closed { .. })), "{case}");
        let counts = [Kind::LP, Kind::BP].map(|kind| curve.of_kind(kind).count());
        assert_eq!(counts, [2, crossings], "{case}");
        curve.of_kind(Kind::LP).for_each(|fold| close(fold.parameters[0].abs(), 1.0, 1e-12));
    };
    for max_step in [0.01, 0.02, 0.03, 0.05, 0.1, 0.2, 0.5] {
        let mut system = Dense::new(CrossedCircle);
        let run =
            |curve: Continuation| curve.settings(step(max_step)).along("p", -2.0..=2.0).trace();
        let line = run(Continuation::new(&mut system).at("p", -2.0).from(&[-2.0 / 3.0])).unwrap();
        let crossings: Vec<usize> = line.of_kind(Kind::BP).map(|s| s.label).collect();
        assert_eq!(crossings.len(), 2, "step {max_step}");
        for label in crossings {
            let circle =
                run(Continuation::new(&mut system).restart(&line, label).switch()).unwrap();
            check(&circle, 1);
        }
        let circle = run(Continuation::new(&mut system).at("p", 0.6).from(&[0.8])).unwrap();
        check(&circle, 2);
    }
}

/// Three coupled pitchforks: two eigenvalues vanish at `λ = 0.3`.
#[derive(Clone, Copy)]
struct Ring;

impl VectorField for Ring {
    fn names(&self) -> Names {
        Names::new(["a", "b", "c"], ["lambda"])
    }
    fn field<T: Scalar>(&self, _t: T, x: &[T], p: &[T], f: &mut [T]) {
        for i in 0..3 {
            let others = x[(i + 1) % 3] + x[(i + 2) % 3];
            f[i] = p[0] * x[i] - x[i].powi(3) - x[i] * 0.2 + others * 0.1;
        }
    }
}

#[test]
fn branch_points_of_several_eigenvalues_are_reported() {
    for max_step in [0.02, 0.05, 0.1, 0.5] {
        let mut system = Dense::new(Equilibria::new(Ring));
        let curve = Continuation::new(&mut system).at("lambda", -0.5).settings(step(max_step));
        let branch = curve.along("lambda", -0.5..=1.0).trace().unwrap();
        let points: Vec<(f64, usize)> =
            branch.of_kind(Kind::BP).map(|s| (s.parameters[0], s.multiplicity)).collect();
        assert_eq!(points.len(), 2, "step {max_step}: {points:?}");
        for ((found, multiplicity), (expected, count)) in points.iter().zip([(0.0, 1), (0.3, 2)]) {
            close(*found, expected, 1e-9);
            assert_eq!(*multiplicity, count);
        }
        // Its quadratic terms vanish: no branch is determined by them.
        let label = branch.of_kind(Kind::BP).nth(1).unwrap().label;
        let other = Continuation::new(&mut system).restart(&branch, label).switch();
        let refused = one_line(&other.along("lambda", -0.5..=1.0).trace().unwrap_err());
        assert!(refused.contains("third-order terms"), "{refused}");
    }
}

vector_field! {
    /// `z' = λ z + z̄²`: three lines cross the branch 0 at `λ = 0`.
    struct Triangle [x, y; lambda] {
        d/dt x = lambda * x + x * x - y * y;
        d/dt y = lambda * y - x * y * 2.0;
    }
}

#[test]
fn every_branch_through_a_multiple_branch_point_can_be_left_along() {
    let mut system = Dense::new(Equilibria::new(Triangle));
    let curve = Continuation::new(&mut system).at("lambda", -1.0);
    let branch = curve.along("lambda", -1.0..=1.0).trace().unwrap();
    let point = branch.of_kind(Kind::BP).next().unwrap();
    assert_eq!(point.multiplicity, 2);
    let mut angles: Vec<f64> = (0..3)
        .map(|k| {
            let curve = Continuation::new(&mut system).restart(&branch, point.label).switch_to(k);
            let line = curve.along("lambda", -1.0..=1.0).trace().unwrap();
            let end = line.of_kind(Kind::EP).find(|end| end.parameters[0] > 0.0).unwrap();
            close(end.state[0].hypot(end.state[1]), 1.0, 1e-9);
            end.state[1].atan2(end.state[0]).abs()
        })
        .collect();
    angles.sort_by(f64::total_cmp);
    // At −1 and at angles ±60°.
    for (angle, expected) in angles.iter().zip([60.0_f64, 60.0, 180.0]) {
        close(angle.to_degrees(), expected, 1e-6);
    }
    let none = Continuation::new(&mut system).restart(&branch, point.label).switch_to(3);
    let refused = one_line(&none.along("lambda", -1.0..=1.0).trace().unwrap_err());
    assert!(refused.contains("the other branch with index 3 does not exist"), "{refused}");
}

zero_problem! {
    /// Two branch points on `w = 0`, `q` apart.
    struct Pair [x, w; p, q] {
        0 = x - p;
        0 = w * (p * (p - q) - w * w);
    }
}

#[test]
fn branch_points_near_each_other_are_found() {
    for apart in [0.2, 0.1, 0.05, 0.02, 0.01] {
        let mut system = Dense::new(Pair);
        let curve = Continuation::new(&mut system).at("p", -1.0).at("q", apart).from(&[-1.0, 0.0]);
        let branch = curve.along("p", -1.0..=1.0).trace().unwrap();
        let found: Vec<f64> = branch.of_kind(Kind::BP).map(|s| s.parameters[0]).collect();
        assert_eq!(found.len(), 2, "{apart}: {found:?}");
        close(found[0], 0.0, 1e-10);
        close(found[1], apart, 1e-10);
    }
}

/// Swift and Hohenberg's equation `u_t = −(1 + ∂²)² u + l u + ν u² − u³` on `(0, 8π)`, by
/// differences.
struct SwiftHohenberg;

const NODES: usize = 96;

impl ZeroProblem for SwiftHohenberg {
    fn names(&self) -> Names {
        Names::new([("u", NODES)], ["l", "nu"]).with_monitors(["norm"])
    }
    fn residual<T: Scalar>(&self, u: &[T], p: &[T], r: &mut [T]) {
        let h = 8.0 * std::f64::consts::PI / (NODES - 1) as f64;
        let mirrored = |i: isize| {
            let j = i.unsigned_abs();
            if j < NODES { j } else { 2 * (NODES - 1) - j }
        };
        let second = |v: &[T], i: isize| {
            (v[mirrored(i - 1)] - v[mirrored(i)] * 2.0 + v[mirrored(i + 1)]) / (h * h)
        };
        let w: Vec<T> = (0..NODES as isize).map(|i| u[i as usize] + second(u, i)).collect();
        for (j, r) in r.iter_mut().enumerate() {
            let u = u[j];
            *r = p[0] * u + p[1] * u * u - u.powi(3) - w[j] - second(&w, j as isize);
        }
    }
    fn monitors<T: Scalar>(&self, u: &[T], _p: &[T], values: &mut [T]) {
        values[0] = u.iter().fold(T::zero(), |sum, u| sum + *u * *u) / NODES as f64;
    }
}

/// Every change of the number of unstable eigenvalues has its special points.
#[test]
fn nothing_passes_unseen() {
    let mut system = Dense::new(SwiftHohenberg);
    let trivial = Continuation::new(&mut system).settings(step(0.02)).at("l", -0.1).at("nu", 2.0);
    let trivial = trivial.along("l", -0.1..=0.3).trace().unwrap();
    let label = trivial.of_kind(Kind::BP).next().unwrap().label;
    let settings = Settings { max_points: 200, ..Settings::default() };
    let branch = Continuation::new(&mut system).settings(settings);
    let branch = branch.restart(&trivial, label).switch();
    let branch = branch.forward().along("l", -1.0..=0.3).bound("norm", -1.0..=3.0).trace().unwrap();
    for expected in [-0.5209292, -0.5276991] {
        let found = branch.of_kind(Kind::BP).any(|s| (s.parameters[0] - expected).abs() < 1e-6);
        assert!(found, "no branch point at {expected}");
    }
    for (k, pair) in branch.points.windows(2).enumerate() {
        let [a, b] = [0, 1].map(|i| pair[i].unstable.unwrap());
        let between = branch.special.iter().filter(|s| s.after == k).count();
        assert!(a == b || between > 0, "{a} → {b} after point {k}");
    }
}

/// A trace changes nothing of the caller's: after a period doubling it has one period still.
#[test]
fn the_callers_system_stays_as_it_is() {
    let mut rest = Dense::new(Equilibria::new(Lure));
    let branch = Continuation::new(&mut rest).at("alpha", 1.2).at("beta", 1.0);
    let branch = branch.along("alpha", 0.5..=1.5).trace().unwrap();
    let hopf = branch.of_kind(Kind::HB).next().unwrap().label;
    let mut orbits = periodic_orbits(Lure, 20, Collocation::new(4).unwrap()).unwrap();
    let (unknowns, mesh) = (orbits.names().dimension(), orbits.representation().mesh);
    let family = Continuation::new(&mut orbits).restart(&branch, hopf);
    let family = family.along("alpha", 0.6..=1.5).trace().unwrap();
    let doubling = family.of_kind(Kind::PD).next().unwrap();
    let doubled = Continuation::new(&mut orbits).restart(&family, doubling.label).switch();
    doubled.along("alpha", 0.6..=0.7).trace().unwrap();
    assert_eq!((orbits.names().dimension(), orbits.representation().mesh), (unknowns, mesh));
    let curve = Continuation::new(&mut orbits).restart(&family, doubling.label).hold(Kind::PD);
    let curve = curve.along("alpha", 0.5..=0.8).along("beta", 0.9..=1.1).trace().unwrap();
    assert!(curve.points.len() > 3);
}

/// A branch starts from the solution of any point, on its mesh, and is the same from there.
#[test]
fn points_with_solutions_are_starts() {
    let mut rest = Dense::new(Equilibria::new(Lure));
    let branch = Continuation::new(&mut rest).at("alpha", 1.2).at("beta", 1.0);
    let branch = branch.along("alpha", 0.5..=1.5).trace().unwrap();
    let hopf = branch.of_kind(Kind::HB).next().unwrap().label;
    let mut orbits = periodic_orbits(Lure, 20, Collocation::new(4).unwrap()).unwrap();
    let keep = Settings { keep_solutions: true, ..Settings::default() };
    let family = Continuation::new(&mut orbits).restart(&branch, hopf).settings(keep);
    let family = family.along("alpha", 0.6..=1.5).trace().unwrap();
    assert!(family.points.iter().all(|point| point.solution.is_some()));
    let point = &family.points[family.points.len() / 2];
    let solution = point.solution.as_ref().unwrap();
    assert_eq!(solution.parameters, point.parameters);
    let again = Continuation::new(&mut orbits).from(&**solution).along("alpha", 0.6..=1.5);
    let again = again.trace().unwrap();
    let [first, second] = [&family, &again].map(|b| b.of_kind(Kind::PD).next().unwrap());
    close(first.parameters[0], second.parameters[0], 1e-8);
    assert!(again.points.iter().all(|point| point.solution.is_none()));
    let one = Solution { parameters: vec![1.0], ..(**solution).clone() };
    let refused = Continuation::new(&mut orbits).from(&one).along("alpha", 0.6..=1.5).trace();
    assert_eq!(refused.unwrap_err(), TraceError::ParameterCount { found: 1, expected: 2 });
}

/// Each half of a branch is what it is alone.
#[test]
fn halves_do_not_depend_on_each_other() {
    let trace = |backward_only: bool| {
        let mut system = Dense::new(Columns);
        let curve = Continuation::new(&mut system).at("p", 1.01).at("c", 0.0).from(&[0.1, 0.1]);
        let curve = curve.along("p", 1.0001..=50.0);
        if backward_only { curve.backward() } else { curve }.trace().unwrap()
    };
    let (both, alone) = (trace(false), trace(true));
    assert!(alone.points.len() > 3);
    assert_eq!(both.points[..alone.points.len()], alone.points[..]);
}

/// What is looked for can be chosen, and eigenvalues left out.
#[test]
fn events_and_stability_can_be_switched_off() {
    let trace = |settings: Settings| {
        let mut system = Dense::new(CuspSlice);
        let curve = Continuation::new(&mut system).from(&[-2.1]).at("mu", -1.0).settings(settings);
        curve.along("mu", -1.0..=1.0).trace().unwrap()
    };
    assert_eq!(trace(Settings::default()).of_kind(Kind::LP).count(), 2);
    let detect = vec![Kind::BP];
    assert_eq!(trace(Settings { detect, ..Settings::default() }).of_kind(Kind::LP).count(), 0);
    let branch = trace(Settings { stability: false, ..Settings::default() });
    assert!(branch.points.iter().all(|point| point.unstable.is_none()));
    assert_eq!(branch.of_kind(Kind::LP).count(), 2);
}

/// Nothing starts from a point that has not converged, unless it is told to.
#[test]
fn unconverged_points_are_no_starts() {
    let mut system = Dense::new(CuspSlice);
    let curve = Continuation::new(&mut system).from(&[-2.1]).at("mu", -1.0);
    let mut branch = curve.along("mu", -1.0..=1.0).trace().unwrap();
    let fold = branch.special.iter_mut().find(|s| s.kind == Kind::LP).unwrap();
    (fold.converged, fold.error) = (false, 0.5);
    let label = fold.label;
    assert_eq!(branch.converged_points(Kind::LP).count(), 1);
    let again = Continuation::new(&mut system).restart(&branch, label).along("mu", -1.0..=1.0);
    assert!(matches!(again.trace(), Err(TraceError::NotConverged { kind: Kind::LP, .. })));
    let anyway = Continuation::new(&mut system).restart_anyway(&branch, label);
    assert!(anyway.along("mu", -1.0..=1.0).trace().is_ok());
}

/// All errors of a statement are shown, not only the first.
#[test]
fn all_errors_of_a_statement_are_shown() {
    let mut system = Dense::new(CuspSlice);
    let curve =
        Continuation::new(&mut system).at("nu", 0.0).mark("mu", f64::NAN).along("mu", 1.0..=0.0);
    let error = curve.settings(step(-1.0)).trace().unwrap_err();
    let TraceError::Several(errors) = &error else { panic!("{error}") };
    assert!(
        matches!(
            errors[..],
            [
                TraceError::UnknownName(_),
                TraceError::Value { .. },
                TraceError::EmptyRange { .. },
                TraceError::Setting(_)
            ]
        ),
        "{errors:?}"
    );
    assert!(errors.iter().all(|each| one_line(&error).contains(&each.to_string())), "{error}");
}

/// A mark at the start's own value is a row.
#[test]
fn a_mark_at_the_start_is_a_row() {
    let mut system = Dense::new(CuspSlice);
    let curve = Continuation::new(&mut system).from(&[0.0]).at("mu", 0.0).mark("mu", 0.0);
    let branch = curve.along("mu", -1.0..=1.0).trace().unwrap();
    let states: Vec<f64> = branch.of_kind(Kind::UZ).map(|s| s.state[0]).collect();
    assert!(states.iter().any(|x| x.abs() < 1e-9), "{states:?}");
    assert_eq!(states.len(), 3, "μ = 0 at x = 0 and at ±√3: {states:?}");
}

zero_problem! {
    /// Declared periodic, though nothing says what a period is.
    struct NoOrbit [x; p] {
        0 = x - p;
        fn dynamics(&self) -> Dynamics {
            Dynamics::Periodic
        }
    }
}

/// Two states of one name, the second of which has no equation.
struct Unwritten(bool);

impl ZeroProblem for Unwritten {
    fn names(&self) -> Names {
        Names::new(["x", if self.0 { "x" } else { "y" }], ["p"])
    }
    fn residual<T: Scalar>(&self, x: &[T], p: &[T], r: &mut [T]) {
        r[0] = x[0] - p[0];
    }
}

/// Wrong requests say what is wrong.
#[test]
fn wrong_requests_are_refused_with_the_reason() {
    let refused = |system: &mut dyn System, kinds: &[Kind]| {
        let names = system.names().parameters.clone();
        let curve =
            names.iter().fold(Continuation::new(system), |c, name| c.along(name, 0.0..=1.0));
        let curve = kinds.iter().fold(curve, |curve, kind| curve.hold(*kind));
        one_line(&curve.trace().unwrap_err())
    };
    let cases = [
        (refused(&mut Dense::new(Columns), &[Kind::PD]), "branches of periodic orbits"),
        (refused(&mut Dense::new(Columns), &[Kind::CP]), "hold LP as well"),
        (refused(&mut Dense::new(NoOrbit), &[]), "periodic_orbits"),
        (refused(&mut Dense::new(Unwritten(true)), &[]), "two unknowns"),
        (refused(&mut Dense::new(Unwritten(false)), &[]), "every equation is written"),
    ];
    for (message, part) in cases {
        assert!(message.contains(part), "{message}");
    }
}

vector_field! {
    /// Forced Van der Pol oscillator, `x'' − ε (1 − x²) x' + x = γ cos ωt`.
    struct ForcedVanDerPol [x, v; gamma, omega, epsilon; t] {
        d/dt x = v;
        d/dt v = gamma * (omega * t).cos() + epsilon * (T::one() - x * x) * v - x;
        period = omega.recip() * std::f64::consts::TAU;
    }
}

/// A curve of torus points ends where its multipliers meet at 1, and is not traced back.
#[test]
fn curves_of_torus_points_end_at_resonances() {
    let p = [2.0, 1.5, 0.4];
    let motion = Smooth(ForcedVanDerPol);
    let mut flow = HybridFlow::new(&motion, HybridSettings::default()).unwrap();
    let start = HybridState { mode: 0, time: 0.0, x: vec![1.0, 0.0] };
    let cycle = CycleSearch::default().find(&mut flow, start, &p).unwrap();
    let (mut orbits, z) =
        from_cycle(Smooth(ForcedVanDerPol), &cycle, &p, Shooting::default(), 2).unwrap();
    let curve = ["gamma", "omega", "epsilon"].iter().zip(p);
    let curve = curve.fold(Continuation::new(&mut orbits).from(&z), |c, (name, p)| c.at(name, p));
    let branch = curve.along("gamma", 0.0..=3.0).trace().unwrap();
    let torus = branch.of_kind(Kind::TR).next().unwrap();
    close(torus.parameters[0], 1.8241451663, 1e-9);
    let curve = Continuation::new(&mut orbits).restart(&branch, torus.label).hold(Kind::TR);
    let curve = curve.along("gamma", 0.0..=5.0).along("omega", 0.3..=4.0).trace().unwrap();
    let resonance = curve.of_kind(Kind::R1).next().unwrap_or_else(|| panic!("{:?}", curve.ends));
    close(resonance.parameters[0], 0.4294, 1e-4);
    close(resonance.parameters[1], 1.0977, 1e-4);
    assert!(curve.of_kind(Kind::R1).count() == 1 && curve.points.len() < 300);
    // The angle of the multipliers is recorded along the curve, and vanishes there.
    let angle = curve.column("torus_angle").unwrap();
    let at = |k: usize| curve.points[k].value(angle).unwrap();
    assert!(
        (0..curve.points.len()).all(|k| at(k) > -1e-6) && resonance.value(angle).unwrap() < 1e-3
    );
}

/// Points are saved on request, and branches go on from them.
#[test]
fn regular_points_are_saved_and_are_starts() {
    let mut slice = Dense::new(CuspSlice);
    let curve = Continuation::new(&mut slice).from(&[0.0]).at("mu", 0.0);
    let settings = Settings { save_every: 5, ..Settings::default() };
    let branch = curve.settings(settings).along("mu", -1.0..=1.0).trace().unwrap();
    let saved: Vec<_> = branch.of_kind(Kind::RG).collect();
    assert!(saved.len() >= 4);
    for point in saved {
        assert_eq!(branch.points[point.after].parameters, point.parameters);
        let again = Continuation::new(&mut slice).restart(&branch, point.label);
        again.along("mu", -1.0..=1.0).trace().unwrap();
    }
    // The last point is the end of the branch, even if it is saved.
    let settings = Settings { save_every: 5, max_points: 5, ..Settings::default() };
    let curve = Continuation::new(&mut slice).from(&[0.0]).at("mu", 0.0).settings(settings);
    let branch = curve.along("mu", -9.0..=9.0).trace().unwrap();
    let kinds: Vec<Kind> = branch.special.iter().map(|special| special.kind).collect();
    assert_eq!((kinds.first(), kinds.last()), (Some(&Kind::EP), Some(&Kind::EP)), "{kinds:?}");
    assert_eq!(branch.of_kind(Kind::RG).count(), 2);
    assert!(branch.special.iter().all(|special| special.after <= 10));
}

/// Test functions without a gradient find the points that defining systems find, and end branches.
#[test]
fn events_of_closures_are_located_on_the_branch() {
    let mut slice = Dense::new(CuspSlice);
    let curve = Continuation::new(&mut slice).from(&[-2.5]).along("mu", -3.0..=3.0);
    let curve = curve.at("mu", -2.5 * 2.5 * 2.5 / 3.0 + 2.5);
    let steep = |at: &TestPoint| (at.state[0] - 1.5).powi(3) + at.monitors[0] - 2.25;
    let branch = curve
        .mark("square", 2.25)
        .event(Event::when("x = 3/2, steeply", steep))
        .event(Event::when("the end", |at| at.state[0] - 2.2).ending())
        .trace()
        .unwrap();
    let marks: Vec<_> =
        branch.of_kind(Kind::UZ).filter(|p| (p.state[0] - 1.5).abs() < 0.1).collect();
    assert_eq!(marks.len(), 2, "{:?}", branch.ends);
    for mark in marks {
        assert!(mark.converged && (mark.state[0] - 1.5).abs() < 1e-9 && mark.error < 1e-8);
    }
    let end = branch.special.last().unwrap();
    close(end.state[0], 2.2, 1e-9);
    assert!(end.converged && end.event == "the end");
}
