//! Promise: all solutions in a box are found, each once, with their stability.

use proptest::prelude::*;
use tangency::core::continuation::{RootSearch, Roots};
use tangency::core::problem::{Names, ZeroProblem};
use tangency::core::scalar::Scalar;
use tangency::core::system::Dense;
use tangency::zero_problem;

/// `n` cubic polynomials with known zeros, coupled by a rotation of the equations, which has no effect on
/// zeros.
struct Cubics {
    zeros: Vec<[f64; 3]>,
    unit: f64,
}

impl ZeroProblem for Cubics {
    fn names(&self) -> Names {
        let names: Vec<String> = (0..self.zeros.len()).map(|k| format!("x{k}")).collect();
        Names::new(names.iter().map(String::as_str), ["p"])
    }

    fn residual<T: Scalar>(&self, z: &[T], _p: &[T], r: &mut [T]) {
        let cubic = |k: usize| {
            let [a, b, c] = self.zeros[k];
            let x = z[k] * (1.0 / self.unit);
            (x - a) * (x - b) * (x - c)
        };
        let n = z.len();
        for (k, r) in r.iter_mut().enumerate() {
            *r = cubic(k) + cubic((k + 1) % n) * 0.5;
        }
    }
}

fn found(zeros: Vec<[f64; 3]>, unit: f64) -> Roots {
    let n = zeros.len();
    let mut system = Dense::new(Cubics { zeros, unit });
    let within = vec![[-2.0 * unit, 2.0 * unit]; n];
    // 100 starts miss one of 27 zeros now and then.
    let search = RootSearch { starts: 100 * n * n, ..RootSearch::default() };
    search.find(&mut system, &[0.0], &within).expect("a search")
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 30, failure_persistence: None, ..ProptestConfig::default() })]

    /// Three zeros in each of one, two or three directions, in any units.
    #[test]
    fn all_zeros_of_polynomials_are_found(
        n in 1_usize..4,
        shifts in prop::collection::vec(0.3..0.9_f64, 9),
        power in -9_i32..9,
    ) {
        let zeros: Vec<[f64; 3]> =
            (0..n).map(|k| [-2.0 + shifts[3 * k], -0.3 + 0.3 * shifts[3 * k + 1], 2.0 - shifts[3 * k + 2]]).collect();
        let unit = 10_f64.powi(power);
        let roots = found(zeros.clone(), unit).roots;
        prop_assert_eq!(roots.len(), 3_usize.pow(n as u32));
        for root in &roots {
            for (x, zeros) in root.unknowns.iter().zip(&zeros) {
                prop_assert!(zeros.iter().any(|zero| (x / unit - zero).abs() < 1e-10), "{:?}", root.unknowns);
            }
        }
    }
}

zero_problem! {
    /// Himmelblau's function has nine critical points: four minima, four saddles, a maximum.
    struct Himmelblau [x, y; p] {
        let (a, b) = (x * x + y - 11.0, x + y * y - 7.0);
        // Motion down the gradient: minima are stable.
        0 = -(x * a * 4.0 + b * 2.0);
        0 = -(a * 2.0 + y * b * 4.0);
    }
}

#[test]
fn critical_points_of_himmelblaus_function() {
    let mut system = Dense::new(Himmelblau);
    let search = RootSearch::default();
    let all = search.find(&mut system, &[0.0], &[[-5.0, 5.0]; 2]).expect("a search");
    let with = |count| all.roots.iter().filter(|root| root.unstable == Some(count)).count();
    assert_eq!([0, 1, 2].map(with), [4, 4, 1]);
    assert!(
        all.roots
            .iter()
            .any(|root| (root.unknowns[0] - 3.0).abs() + (root.unknowns[1] - 2.0).abs() < 1e-12)
    );
    // In half of the box are those of that half; others are counted.
    let half = search.find(&mut system, &[0.0], &[[0.0, 5.0], [-5.0, 5.0]]).expect("a search");
    let right = all.roots.iter().filter(|root| root.unknowns[0] > 0.0);
    assert!(
        right
            .map(|root| &root.unknowns)
            .zip(&half.roots)
            .all(|(a, b)| { a.iter().zip(&b.unknowns).all(|(a, b)| (a - b).abs() < 1e-10) })
    );
    assert!(half.outside > 0);
}

/// `x² + 1` has no zeros, and a search says so; an empty box is refused.
#[test]
fn searches_that_find_nothing_say_so() {
    zero_problem! {
        struct None [x; p] {
            0 = x * x + 1.0;
        }
    }
    let mut system = Dense::new(None);
    let nothing =
        RootSearch::default().find(&mut system, &[0.0], &[[-5.0, 5.0]]).expect("a search");
    assert_eq!((nothing.roots.len(), nothing.lost, nothing.outside), (0, 100, 0));
    for within in [&[[1.0, 1.0]][..], &[[0.0, f64::INFINITY]], &[]] {
        assert!(RootSearch::default().find(&mut system, &[0.0], within).is_err(), "{within:?}");
    }
}
