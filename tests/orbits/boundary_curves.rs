//! Promise: branches of boundary-value problems without a period end for the same reasons as
//! others, where they close and where their mesh is too coarse, and their branch points are found
//! though no eigenvalues are known.

use crate::common::close;
use crate::orbits::boundary::{Layer, collocated, strings};
use std::f64::consts::{PI, TAU};
use tangency::core::bvp::{
    BoundaryProblem, BoundarySystem, Collocation, Ends, Mesh, Method, Shooting,
};
use tangency::core::continuation::{Continuation, End, Settings};
use tangency::core::scalar::Scalar;
use tangency::core::system::Kind;

/// `u' = 3 cos(12 t) u` with `u(0)² + p² = 1`: a circle of solutions.
struct Ring;

impl BoundaryProblem for Ring {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![strings(&["u"])]
    }
    fn parameters(&self) -> Vec<String> {
        strings(&["p"])
    }
    fn field<T: Scalar>(&self, _segment: usize, t: T, x: &[T], _q: &[T], f: &mut [T]) {
        f[0] = x[0] * (t * 12.0).cos() * 3.0;
    }
    fn boundary<T: Scalar>(&self, ends: Ends<T>, q: &[T], b: &mut [T]) {
        b[0] = ends.start[0] * ends.start[0] + q[0] * q[0] - 1.0;
    }
}

/// The circle closes after one round with one fold on either side, by both methods, wherever it is
/// entered and with any steps.
#[test]
fn closed_curves_of_boundary_values_close() {
    let collocation = || Method::from(Collocation::new(4).unwrap());
    for method in [collocation(), Method::from(Shooting::default())] {
        let mut system = BoundarySystem::new(Ring, method, vec![Mesh::uniform(12)]).unwrap();
        for (p, max_step) in [(0.0, 0.1), (0.6, 0.02), (-0.95, 0.5)] {
            let begins = f64::sqrt(1.0 - p * p);
            let z =
                system.sampled(&[], |_, tau, x| x[0] = begins * (0.25 * (12.0 * tau).sin()).exp());
            let branch = Continuation::new(&mut system)
                .from(&z)
                .at("p", p)
                .along("p", -2.0..=2.0)
                .settings(Settings { max_step, ..Settings::default() })
                .trace()
                .unwrap();
            assert!(
                branch.ends.iter().all(|end| matches!(end, End::Closed { .. })),
                "{:?}",
                branch.ends
            );
            let mut folds: Vec<f64> =
                branch.of_kind(Kind::LP).map(|fold| fold.parameters[0]).collect();
            folds.sort_by(f64::total_cmp);
            assert_eq!(folds.len(), 2);
            close(folds[0], -1.0, 1e-10);
            close(folds[1], 1.0, 1e-10);
        }
    }
}

/// A layer that becomes too thin for the mesh ends the branch before its numbers lie, and a mesh
/// with more intervals follows it.
#[test]
fn layers_end_branches_on_coarse_meshes() {
    for intervals in [2, 30] {
        let mut system = collocated(Layer, 4, intervals);
        // v(0) = 1/(1 − e^{−1/ε}).
        let slope = |epsilon: f64| -1.0 / (-1.0 / epsilon).exp_m1();
        let z = system.sampled(&[], |_, tau, x| {
            x[1] = slope(1.0) * (-tau).exp();
            x[0] = slope(1.0) - x[1];
        });
        let branch = Continuation::new(&mut system)
            .from(&z)
            .at("epsilon", 1.0)
            .along("epsilon", 1e-3..=1.0)
            .settings(Settings { target_mesh_error: f64::MAX, ..Settings::default() })
            .trace()
            .unwrap();
        let end = branch.special.iter().find(|it| it.parameters[0] < 0.9).unwrap();
        let (epsilon, found) = (end.parameters[0], end.state[4 * intervals + 1]);
        match branch.ends[0] {
            End::MeshTooCoarse { error, limit } if intervals == 2 => {
                assert!(error > limit && epsilon > 0.02 && end.error >= error * epsilon, "{end:?}");
                close(found / slope(epsilon), 1.0, error);
            }
            End::ParameterBound { .. } if intervals == 30 => {
                assert_eq!(epsilon, 1e-3);
                close(found / slope(epsilon), 1.0, 1e-8);
            }
            _ => panic!("{intervals}: {:?}", branch.ends),
        }
    }
}

/// `u'' + a g(u) = 0`, `v'' + s a g(v) = 0` with `g(u) = u + c u² − u³`, all zero at both ends:
/// branch points on `u = v = 0` at `a = (kπ)²` and `(kπ)²/s`.
struct Copies {
    s: f64,
    c: f64,
}

impl BoundaryProblem for Copies {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![strings(&["u", "u_t", "v", "v_t"])]
    }
    fn parameters(&self) -> Vec<String> {
        strings(&["a"])
    }
    fn field<T: Scalar>(&self, _segment: usize, _t: T, x: &[T], q: &[T], f: &mut [T]) {
        let g = |u: T| u + u * u * self.c - u.powi(3);
        f[0] = x[1];
        f[1] = -q[0] * g(x[0]);
        f[2] = x[3];
        f[3] = -q[0] * g(x[2]) * self.s;
    }
    fn boundary<T: Scalar>(&self, ends: Ends<T>, _q: &[T], b: &mut [T]) {
        b.copy_from_slice(&[ends.start[0], ends.end[0], ends.start[2], ends.end[2]]);
    }
}

/// `u'' + a (u − u³) = 0` on a ring: pairs of sines and cosines branch off `u = 0` at `a = (2πk)²`.
struct OnRing;

impl BoundaryProblem for OnRing {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![strings(&["u", "v"])]
    }
    fn parameters(&self) -> Vec<String> {
        strings(&["a"])
    }
    fn field<T: Scalar>(&self, _segment: usize, _t: T, x: &[T], q: &[T], f: &mut [T]) {
        f[0] = x[1];
        f[1] = -q[0] * (x[0] - x[0].powi(3));
    }
    fn boundary<T: Scalar>(&self, ends: Ends<T>, _q: &[T], b: &mut [T]) {
        b[0] = ends.start[0] - ends.end[0];
        b[1] = ends.start[1] - ends.end[1];
    }
}

/// Branch points of a trivial branch up to a bound: each with its multiplicity and within its
/// error, none else.
fn branch_points_are(mut system: BoundarySystem, bound: f64, expected: &[(f64, usize)]) {
    let z = system.sampled(&[], |_, _, x| x.fill(0.0));
    for max_step in [0.02, 0.1, 0.5] {
        let branch = Continuation::new(&mut system)
            .from(&z)
            .at("a", 1.0)
            .along("a", 1.0..=bound)
            .settings(Settings { max_step, ..Settings::default() })
            .trace()
            .unwrap();
        let found: Vec<_> = branch.special.iter().filter(|it| it.kind != Kind::EP).collect();
        assert_eq!(found.len(), expected.len(), "{max_step}: {found:?}");
        for (point, (a, multiplicity)) in found.into_iter().zip(expected) {
            let miss = (point.parameters[0] - a).abs();
            assert!(point.kind == Kind::BP && point.converged, "{max_step}: {point:?}");
            assert_eq!(point.multiplicity, *multiplicity, "{max_step}: {a}");
            assert!(miss <= point.error && point.error < 1e-7 * a, "{max_step}: {a} {miss:e}");
        }
    }
}

/// A system by shooting over two segments.
fn shot(problem: impl BoundaryProblem + 'static) -> BoundarySystem {
    BoundarySystem::new(problem, Shooting::default(), vec![Mesh::uniform(2)]).unwrap()
}

/// Points at which the determinant keeps its sign, or changes it twice in a step, are found and
/// counted by singular matrices: also those with odd null vectors, of which generic vectors have a
/// small share.
#[test]
fn even_branch_points_of_boundary_values_are_found() {
    let squares = |unit: f64, most: usize| (1..=most).map(move |k| (unit * k as f64).powi(2));
    let double: Vec<(f64, usize)> = squares(PI, 4).map(|a| (a, 2)).collect();
    let split: Vec<(f64, usize)> = squares(PI, 4).flat_map(|a| [(a / 1.02, 1), (a, 1)]).collect();
    for (s, expected) in [(1.0, double), (1.02, split)] {
        branch_points_are(collocated(Copies { s, c: 0.0 }, 4, 20), 200.0, &expected);
        branch_points_are(shot(Copies { s, c: 0.0 }), 200.0, &expected);
    }
    let ring: Vec<(f64, usize)> = squares(TAU, 3).map(|a| (a, 2)).collect();
    branch_points_are(collocated(OnRing, 4, 20), 500.0, &ring);
}

/// Three branches leave `u = v = 0` at `a = π²`, along `u`, `v` and both: each can be followed.
#[test]
fn branches_leave_even_points_of_boundary_values() {
    let mut system = collocated(Copies { s: 1.0, c: 1.0 }, 4, 20);
    let z = system.sampled(&[], |_, _, x| x.fill(0.0));
    let trace = Continuation::new(&mut system).from(&z).at("a", 1.0).along("a", 1.0..=30.0);
    let trivial = trace.trace().unwrap();
    let point = trivial.of_kind(Kind::BP).next().unwrap();
    close(point.parameters[0], PI * PI, point.error);
    assert_eq!(point.multiplicity, 2);
    let mut moved: Vec<[bool; 2]> = (0..3)
        .map(|k| {
            let leaving =
                Continuation::new(&mut system).restart(&trivial, point.label).switch_to(k);
            let branch = leaving.along("a", 5.0..=30.0).trace().unwrap();
            // u and v in the middle, at the upper bound.
            let end = &branch.special.last().unwrap().state;
            [end[40].abs() > 0.1, end[2 * 81 + 40].abs() > 0.1]
        })
        .collect();
    moved.sort();
    assert_eq!(moved, [[false, true], [true, false], [true, true]]);
}
