//! Promise: branches of boundary-value problems without a period end for the same reasons as others: where they close, and
//! where their mesh is too coarse.

use crate::common::close;
use crate::orbits::boundary::strings;
use tangency::core::bvp::{
    BoundaryProblem, BoundarySystem, Collocation, Ends, Mesh, Method, Shooting,
};
use tangency::core::continuation::{Continuation, End, Kind, Settings};
use tangency::core::scalar::Scalar;

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
    fn duration<T: Scalar>(&self, _segment: usize, _q: &[T]) -> T {
        T::one()
    }
    fn boundary<T: Scalar>(&self, ends: Ends<T>, q: &[T], b: &mut [T]) {
        b[0] = ends.start[0] * ends.start[0] + q[0] * q[0] - 1.0;
    }
}

/// The circle closes after one round with one fold on either side, by both methods, wherever it is entered and with any steps.
#[test]
fn closed_curves_of_boundary_values_close() {
    let collocation = || Method::from(Collocation::new(4).unwrap());
    for method in [collocation(), Method::from(Shooting::default())] {
        let mut system = BoundarySystem::new(Ring, method, vec![Mesh::uniform(12)]).unwrap();
        for (p, max_step) in [(0.0, 0.1), (0.6, 0.02), (-0.95, 0.5)] {
            let begins = f64::sqrt(1.0 - p * p);
            let z =
                system.sampled(&[], |_, tau, x| x[0] = begins * (0.25 * (12.0 * tau).sin()).exp());
            let branch = Continuation::of(&mut system)
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

/// `ε u'' + u' = 0`, `u(0) = 0`, `u(1) = 1`, as `(u, v) = (u, u')`: a layer at the left end, with `v(0) = 1 / ε (1 − e^{−1/ε})`.
struct Layer;

impl BoundaryProblem for Layer {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![strings(&["u", "v"])]
    }
    fn parameters(&self) -> Vec<String> {
        strings(&["epsilon"])
    }
    fn field<T: Scalar>(&self, _segment: usize, _t: T, x: &[T], q: &[T], f: &mut [T]) {
        f[0] = x[1];
        f[1] = -x[1] / q[0];
    }
    fn duration<T: Scalar>(&self, _segment: usize, _q: &[T]) -> T {
        T::one()
    }
    fn boundary<T: Scalar>(&self, ends: Ends<T>, _q: &[T], b: &mut [T]) {
        b[0] = ends.start[0];
        b[1] = ends.end[0] - 1.0;
    }
}

/// A layer that becomes too thin for the mesh ends the branch before its numbers lie, and a mesh with more intervals
/// follows it.
#[test]
fn layers_end_branches_on_coarse_meshes() {
    for intervals in [2, 30] {
        let meshes = vec![Mesh::uniform(intervals)];
        let mut system = BoundarySystem::new(Layer, Collocation::new(4).unwrap(), meshes).unwrap();
        let slope = |epsilon: f64| 1.0 / (epsilon * -(-1.0 / epsilon).exp_m1());
        let z = system.sampled(&[], |_, tau, x| {
            x[1] = slope(1.0) * (-tau).exp();
            x[0] = slope(1.0) - x[1];
        });
        let branch = Continuation::of(&mut system)
            .from(&z)
            .at("epsilon", 1.0)
            .along("epsilon", 1e-3..=1.0)
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
