//! What rounding does to Newton's iteration and to meshes.

use crate::common::close;
use tangency::core::bvp::Collocation;
use tangency::core::continuation::{Continuation, End};
use tangency::core::orbit::periodic_orbits;
use tangency::core::problem::{Forcing, Names, VectorField, ZeroProblem};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Dense, Kind, System};

/// A clamped beam on a hardening foundation, `w'''' + w³ = λ`, in differences on `n` inner nodes:
/// rounding of the residual, multiplied by a condition of `n⁴`, is larger than the tolerances by
/// far.
struct Beam(usize);

impl ZeroProblem for Beam {
    fn names(&self) -> Names {
        Names::new([("w", self.0)], ["lambda"])
    }
    fn residual<T: Scalar>(&self, w: &[T], p: &[T], r: &mut [T]) {
        let n = self.0 as isize;
        let h = 1.0 / (n as f64 + 1.0);
        // Outside: w = w' = 0 at both ends.
        let at = |i: isize| match i {
            -2 => w[0],
            -1 => T::zero(),
            i if i == n => T::zero(),
            i if i == n + 1 => w[self.0 - 1],
            i => w[i as usize],
        };
        for (i, r) in (0..n).zip(r) {
            let fourth = at(i - 2) - at(i - 1) * 4.0 + at(i) * 6.0 - at(i + 1) * 4.0 + at(i + 2);
            *r = fourth * h.powi(-4) + at(i).powi(3) - p[0];
        }
    }
}

/// Where corrections are rounding above every tolerance, the branch goes on, and is as exact as
/// arithmetic allows.
#[test]
fn rounding_above_the_tolerance_does_not_end_a_branch() {
    let n = 319;
    let mut beam = Dense::new(Beam(n));
    let curve = Continuation::new(&mut beam).from(&vec![0.0; n]).along("lambda", 0.0..=1e4);
    let branch = curve.trace().unwrap();
    assert!(matches!(branch.ends[1], End::ParameterBound { .. }), "{:?}", branch.ends);
    // The difference scheme errs by h²: with half of the nodes, to be extrapolated.
    let middle = |n: usize| {
        let mut beam = Dense::new(Beam(n));
        let curve = Continuation::new(&mut beam).from(&vec![0.0; n]).along("lambda", 0.0..=1e4);
        let branch = curve.trace().unwrap();
        branch.of_kind(Kind::EP).last().unwrap().state[n / 2]
    };
    let (fine, half, quarter) =
        (branch.of_kind(Kind::EP).last().unwrap().state[n / 2], middle(159), middle(79));
    close((fine - half) / (half - quarter), 0.25, 0.01);
}

/// A forced state with a layer; a second one, if there is one, is at rest.
struct Layer(bool);

impl VectorField for Layer {
    fn names(&self) -> Names {
        Names::new(if self.0 { vec!["x", "y"] } else { vec!["x"] }, ["steepness"])
    }
    fn field<T: Scalar>(&self, t: T, x: &[T], p: &[T], f: &mut [T]) {
        f[0] = (t.sin() * p[0]).tanh() - x[0];
        if self.0 {
            f[1] = -x[1];
        }
    }
    fn forcing(&self) -> Forcing {
        Forcing::Periodic { phase: std::f64::consts::TAU }
    }
    fn period<T: Scalar>(&self, _p: &[T]) -> T {
        T::from(std::f64::consts::TAU)
    }
}

/// A state that vanishes but for rounding says nothing about the mesh.
#[test]
fn states_that_are_rounding_do_not_shape_meshes() {
    let mesh = |rest: bool| {
        let method = Collocation::new(4).unwrap();
        let mut orbits = periodic_orbits(Layer(rest), 20, method).unwrap();
        let nodes = 81;
        let mut x = vec![0.0; orbits.names().dimension()];
        for (k, x) in x.iter_mut().enumerate() {
            let t = std::f64::consts::TAU * (k % nodes) as f64 / 80.0;
            let noise = 1e-17 * (12.9898 * k as f64).sin();
            *x = if k < nodes { (40.0 * (t - 3.0)).tanh() } else { noise };
        }
        x.push(20.0);
        orbits.discretised().unwrap().on_accepted(&mut x, &mut []);
        orbits.representation().mesh
    };
    let (with, without) = (mesh(true), mesh(false));
    let inside = without.iter().filter(|t| (0.4..0.56).contains(*t)).count();
    assert!(inside > 8, "{without:?}");
    with.iter().zip(&without).for_each(|(a, b)| close(*a, *b, 1e-12));
}
