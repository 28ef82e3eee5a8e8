//! Promise: boundary-value problems are discretised and continued like any other zero problem.

use tangency::core::bvp::{BoundaryProblem, BoundarySystem, Collocation, Ends, Mesh, Monitor};
use tangency::core::continuation::{Continuation, Kind};
use tangency::core::scalar::Scalar;

/// Bratu's problem `u'' + λeᵘ = 0`, `u(0) = u(1) = 0`.
#[derive(Clone)]
struct Bratu;

impl BoundaryProblem for Bratu {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![vec!["u".into(), "v".into()]]
    }
    fn parameters(&self) -> Vec<String> {
        vec!["lambda".into()]
    }
    fn field<T: Scalar>(&self, _s: usize, _t: T, x: &[T], q: &[T], f: &mut [T]) {
        f[0] = x[1];
        f[1] = -q[0] * x[0].exp();
    }
    fn duration<T: Scalar>(&self, _s: usize, _q: &[T]) -> T {
        T::one()
    }
    fn boundary<T: Scalar>(&self, ends: Ends<T>, _q: &[T], b: &mut [T]) {
        b[0] = ends.start[0];
        b[1] = ends.end[0];
    }
    fn monitors(&self) -> Vec<(String, Monitor)> {
        vec![("max".into(), Monitor::Maximum { segment: 0, state: 0 })]
    }
}

/// The exact fold: `λ* = 8θ²/cosh²θ` with `θ tanh θ = 1`.
const FOLD: f64 = 3.51383071912516;

#[test]
fn bratu_folds() {
    let mut system =
        BoundarySystem::new(Bratu, Collocation::new(4).unwrap(), vec![Mesh::uniform(10)]).unwrap();
    let branch = Continuation::of(&mut system)
        .at("lambda", 0.5)
        .along("lambda", 0.0..=10.0)
        .bound("max", 0.0..=5.0)
        .trace()
        .unwrap();
    let fold = branch.of_kind(Kind::LP).next().unwrap();
    println!("{:?} {:e} {:?}", fold.parameters, fold.error, fold.monitors);
    println!("{} points, error {:e}", branch.points.len(), fold.parameters[0] - FOLD);
    assert!((fold.parameters[0] - FOLD).abs() < 1e-12);
}
