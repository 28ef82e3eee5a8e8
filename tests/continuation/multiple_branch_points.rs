//! Promise: branch points of any multiplicity are found and counted, with eigenvalues and without.

use tangency::core::continuation::{Continuation, Settings};
use tangency::core::problem::{Names, ZeroProblem};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Dense, Kind};

/// `(a − cₖ) xₖ − xₖ³ = 0`: branch points on `x = 0` at all `a = cₖ`.
struct Pitchforks(Vec<f64>);

impl ZeroProblem for Pitchforks {
    fn names(&self) -> Names {
        Names::new([("x", self.0.len())], ["a"])
    }
    fn residual<T: Scalar>(&self, x: &[T], p: &[T], r: &mut [T]) {
        for (k, c) in self.0.iter().enumerate() {
            r[k] = (p[0] - *c) * x[k] - x[k].powi(3);
        }
    }
}

/// One row for each point, also where a step begins or ends on it, and none for Newton's failure at
/// it.
#[test]
fn multiplicities_are_counted() {
    let cases = [
        (vec![1.0, 1.0], vec![(1.0, 2)]),
        (vec![1.0, 1.0, 1.0], vec![(1.0, 3)]),
        (vec![0.0, 0.0], vec![(0.0, 2)]),
        (vec![1.0, 1.01], vec![(1.0, 1), (1.01, 1)]),
    ];
    for (values, expected) in cases {
        for max_step in [0.02, 0.1, 0.5] {
            for stability in [true, false] {
                let mut system = Dense::new(Pitchforks(values.clone()));
                let branch = Continuation::new(&mut system)
                    .from(&vec![0.0; values.len()])
                    .at("a", -1.0)
                    .along("a", -1.0..=4.0)
                    .settings(Settings { max_step, stability, ..Settings::default() })
                    .trace()
                    .unwrap();
                let found: Vec<_> =
                    branch.special.iter().filter(|it| it.kind != Kind::EP).collect();
                assert_eq!(found.len(), expected.len(), "{values:?} {max_step}: {found:?}");
                for (point, (a, multiplicity)) in found.into_iter().zip(&expected) {
                    let miss = (point.parameters[0] - a).abs();
                    assert!(point.kind == Kind::BP && point.converged, "{values:?}: {point:?}");
                    assert!(miss <= point.error && point.error < 1e-9, "{values:?}: {miss:e}");
                    assert_eq!(point.multiplicity, *multiplicity, "{values:?} {max_step}");
                }
            }
        }
    }
}

/// Points that are near each other are found each; those that rounding does not tell apart are one,
/// with an error that covers all of them.
#[test]
fn points_near_each_other_are_found_each() {
    for distance in [1e-3, 1e-5, 1e-7, 1e-8] {
        for max_step in [0.02, 0.1, 0.5] {
            let mut system = Dense::new(Pitchforks(vec![3.0, 3.0 + distance]));
            let branch = Continuation::new(&mut system)
                .from(&[0.0; 2])
                .at("a", -1.0)
                .along("a", -1.0..=4.0)
                .settings(Settings { max_step, ..Settings::default() })
                .trace()
                .unwrap();
            let found: Vec<_> = branch.of_kind(Kind::BP).collect();
            assert_eq!(found.len(), 2, "{distance:e}, {max_step}: {found:?}");
            for (point, a) in found.into_iter().zip([3.0, 3.0 + distance]) {
                let miss = (point.parameters[0] - a).abs();
                assert!(point.multiplicity == 1 && point.converged, "{point:?}");
                assert!(miss <= point.error && point.error < 0.1 * distance, "{point:?}");
            }
        }
    }
    let mut system = Dense::new(Pitchforks(vec![3.0, 3.0 + 1e-12]));
    let branch = Continuation::new(&mut system)
        .from(&[0.0; 2])
        .at("a", -1.0)
        .along("a", -1.0..=4.0)
        .trace()
        .unwrap();
    let point = branch.of_kind(Kind::BP).next().unwrap();
    assert_eq!(point.multiplicity, 2);
    for a in [3.0, 3.0 + 1e-12] {
        assert!((point.parameters[0] - a).abs() <= point.error, "{point:?}");
    }
}
