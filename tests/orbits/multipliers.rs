//! Promise: multipliers do not depend on the method, nor on the number of its segments, and telling
//! them apart is never needed.

use crate::common::{close, ellipse, solved};
use crate::orbits::cycles::{Saddle, collocated, label, precisely_shot, shot};
use proptest::prelude::*;
use std::f64::consts::TAU;
use tangency::core::continuation::{Branch, Continuation, Settings};
use tangency::core::problem::{Names, VectorField};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Kind, System};
use tangency::output::{Document, table};
use tangency::problems::classic::Lure;
use tangency::vector_field;

/// Orbits of period one at some values of α.
fn orbits(alphas: &[f64]) -> Branch {
    let rest = crate::orbits::cycles::equilibria(Lure, &[0.0; 3], &[1.2, 1.0], [0.5, 1.5]);
    let mut system = precisely_shot(Lure, 1);
    let marks = Continuation::new(&mut system).restart(&rest, label(&rest, Kind::HB));
    let marks = alphas.iter().fold(marks, |c, alpha| c.mark("alpha", *alpha));
    marks
        .along("alpha", 0.65..=1.5)
        .settings(Settings { max_step: 0.05, ..Settings::default() })
        .trace()
        .unwrap()
}

vector_field! {
    /// A forced motion beside a state that decays fast and is zero on periodic orbits: the
    /// multipliers are `exp(−2π)` and `exp(−2πλ)`.
    struct Beside [x, y; amplitude, rate; t] {
        d/dt x = amplitude * t.cos() - x;
        d/dt y = -rate * y;
        period = T::constant(TAU);
    }
}

/// The step control does not see a state that is zero; steps that are too long for stability would
/// amplify the derivatives of this state.
#[test]
fn multipliers_of_states_that_are_zero() {
    for rate in [1.0, 10.0, 40.0, 100.0, 400.0] {
        let mut system = shot(Beside, 1);
        let start = system.sampled(&[], |_, t, x| x.copy_from_slice(&[0.5 * (TAU * t).cos(), 0.0]));
        let branch = Continuation::new(&mut system)
            .from(&start)
            .at("amplitude", 1.0)
            .at("rate", rate)
            .along("amplitude", 1.0..=2.0)
            .trace()
            .unwrap();
        for point in &branch.points {
            assert_eq!(point.unstable, Some(0), "rate {rate}");
        }
        for special in &branch.special {
            let found: Vec<f64> = special.eigenvalues.iter().map(|(re, _)| *re).collect();
            close(found[0], (-TAU).exp(), 1e-9);
            close(found[1], (-TAU * rate).exp(), 1e-8);
        }
    }
}

#[test]
fn multipliers_of_lure() {
    let alphas = [0.9, 0.78, 0.77, 0.765, 0.76, 0.755, 0.75, 0.74, 0.7];
    let branch = orbits(&alphas);
    let found: Vec<_> = branch.of_kind(Kind::UZ).collect();
    assert_eq!(found.len(), alphas.len());
    let mut complex = 0;
    for special in found {
        let mut all = Vec::new();
        for segments in [1, 3, 5, 20] {
            let mut system = precisely_shot(Lure, segments);
            // Sampled by carrying the saved orbit over.
            let _ = restarted(&mut system, &branch, special.label);
            all.push(multipliers_at(&mut system, &branch, special.label));
        }
        let mut system = collocated(Lure, 60);
        let _ = restarted(&mut system, &branch, special.label);
        let x = restarted(&mut system, &branch, special.label);
        system.assemble(&x).unwrap();
        all.push(system.multipliers().unwrap());
        for other in &all {
            assert_eq!(other.len(), 3);
            for (a, b) in other.iter().zip(&all[0]) {
                close(a.0, b.0, 1e-8);
                close(a.1, b.1, 1e-8);
            }
        }
        complex += usize::from(all[0].iter().any(|mu| mu.1 != 0.0));
        if special.parameters[0] == 0.9 {
            for (found, expected) in all[0].iter().zip([1.0, 0.636333, 0.005388]) {
                close(found.0, expected, 5e-7);
            }
        }
    }
    assert!((1..alphas.len()).contains(&complex));
}

fn restarted(system: &mut dyn System, branch: &Branch, label: usize) -> Vec<f64> {
    let alpha = branch.labelled(label).unwrap().parameters[0];
    let again = Continuation::new(system)
        .restart(branch, label)
        .along("alpha", alpha..=alpha + 1e-3)
        .settings(Settings { max_points: 1, ..Settings::default() })
        .forward()
        .trace()
        .unwrap();
    let start = &again.special[0];
    solved(system, &start.state, &start.parameters).unwrap()
}

fn multipliers_at(
    system: &mut tangency::core::bvp::BoundarySystem,
    branch: &Branch,
    label: usize,
) -> Vec<(f64, f64)> {
    let x = restarted(system, branch, label);
    system.assemble(&x).unwrap();
    system.multipliers().unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// The forced saddle has the multipliers exp(±2πλ), over any number of segments that is enough:
    /// in each, the flow errs by its tolerance of 1e-12 in what grows and in what shrinks by as
    /// much. The motion may be so small that it is nearly at rest.
    #[test]
    fn multipliers_of_a_saddle(
        rate in 0.05..4.0_f64, amplitude in -2.0..2.0_f64, digits in 0..14_i32, more in 0..6_usize,
    ) {
        let amplitude = amplitude * 0.1_f64.powi(digits);
        let segments = 1 + more + (2.0 * rate) as usize;
        let mut system = shot(Saddle, segments);
        let z = system.sampled(&[], ellipse(amplitude, amplitude));
        system.assemble(&[&z[..], &[amplitude, rate]].concat()).unwrap();
        let mu = system.multipliers().unwrap();
        let each = 1e-12 * (2.0 * TAU * rate / segments as f64).exp();
        close(mu[0].0 / (TAU * rate).exp(), 1.0, 1e-9 + each * segments as f64);
        close(mu[1].0 * (TAU * rate).exp(), 1.0, 1e-9 + each * segments as f64);
        prop_assert_eq!((mu[0].1, mu[1].1), (0.0, 0.0));
    }
}

/// Lorenz' equations, and two states that decay on their own.
struct Lorenz {
    decays: usize,
}

impl VectorField for Lorenz {
    fn names(&self) -> Names {
        Names::new(["x", "y", "z", "u", "v"].into_iter().take(3 + self.decays), ["rho"])
    }

    fn field<T: Scalar>(&self, _t: T, x: &[T], p: &[T], f: &mut [T]) {
        f[0] = (x[1] - x[0]) * 10.0;
        f[1] = x[0] * (p[0] - x[2]) - x[1];
        f[2] = x[0] * x[1] - x[2] * (8.0 / 3.0);
        for k in 0..self.decays {
            f[3 + k] = -x[3 + k] * (20.0 + k as f64);
        }
    }
}

/// The orbits from the Hopf point at ρ = 470/19 to the homoclinic orbit at ρ = 13.93.
fn towards_homoclinic(decays: usize) -> Branch {
    let x = (24.0_f64 * 8.0 / 3.0).sqrt();
    let guess = [x, x, 24.0, 0.0, 0.0];
    let rest = crate::orbits::cycles::equilibria(
        Lorenz { decays },
        &guess[..3 + decays],
        &[25.0],
        [20.0, 30.0],
    );
    Continuation::new(&mut collocated(Lorenz { decays }, 20))
        .restart(&rest, label(&rest, Kind::HB))
        .along("rho", 0.0..=30.0)
        .settings(Settings { eigenvalues: 2, ..Settings::default() })
        .trace()
        .unwrap()
}

/// Towards the homoclinic orbit one multiplier grows to e^16, and the other one falls to e^−109, of
/// which no digit is left in any matrix. A rounding error in its place passed −1, which was called a
/// period doubling.
#[test]
fn liouvilles_formula_gives_the_multiplier_that_errors_hide() {
    let branch = towards_homoclinic(0);
    let kinds: Vec<Kind> = branch.special.iter().map(|special| special.kind).collect();
    assert_eq!(kinds, [Kind::EP, Kind::HOM], "{} points", branch.points.len());
    let period = branch.monitors.iter().position(|name| name == "period").unwrap();
    let mut smallest_known = 1.0_f64;
    for point in &branch.points[1..] {
        let Some(unstable) = point.unstable else {
            assert!(point.undetermined.as_ref().is_some_and(|reason| reason.contains("Liouville")));
            continue;
        };
        assert_eq!(unstable, 1);
        // A multiplier that is infinite in floating-point numbers is not saved.
        let [largest, smallest] = point.eigenvalues[..] else { continue };
        // ∫ tr = −(σ + 1 + β) T.
        let product = largest.0.ln() + smallest.0.ln();
        let exact = -41.0 / 3.0 * point.monitors[period];
        close(product, exact, 1e-2 * exact.abs());
        smallest_known = smallest_known.min(smallest.0);
    }
    assert!(smallest_known < 1e-20, "{smallest_known:e}");
}

/// Three multipliers that errors hide are not told apart by one formula: the points say so, and no
/// test function acts there.
#[test]
fn multipliers_that_are_not_determined_are_marked() {
    let branch = towards_homoclinic(2);
    let kinds: Vec<Kind> = branch.special.iter().map(|special| special.kind).collect();
    assert_eq!(kinds, [Kind::EP, Kind::HOM], "{} points", branch.points.len());
    assert_eq!(branch.points[1].unstable, Some(1));
    let last = branch.points.last().unwrap();
    assert_eq!(last.unstable, None);
    assert!(last.undetermined.as_ref().unwrap().contains("Liouville"), "{last:?}");
    let end = branch.special.last().unwrap();
    assert!(end.unstable.is_none() && end.undetermined.is_some());
    let document = Document::new("Lorenz", vec![branch]);
    let table = table(&[("lorenz", &document)]);
    assert!(table.lines().last().unwrap().ends_with(",?,true"), "{table}");
}
