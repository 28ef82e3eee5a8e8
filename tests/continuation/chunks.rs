//! Promise: numbers with a chunk of derivatives are those that `num_dual` has.

use num_dual::{Dual64, DualNum, DualSVec64};
use tangency::core::scalar::{DualChunk, Scalar};

/// Every operation and elementary function, at places where they are smooth.
fn functions<T: Scalar>(x: T, y: T) -> Vec<T> {
    let small = x * 0.1;
    let mut all = vec![x + y, x - y, x * y, x / y, -x, x + 1.5, x - 0.5, x * 2.5, x / 3.0];
    all.extend([x.recip(), x.powi(5), x.powi(-2), x.powf(1.7), x.sqrt(), x.cbrt()]);
    all.extend([x.exp(), x.exp2(), x.exp_m1(), x.ln(), x.log(3.0), x.log2(), x.log10(), x.ln_1p()]);
    all.extend([x.sin(), x.cos(), x.tan(), small.asin(), small.acos(), x.atan(), y.atan2(x)]);
    all.extend([x.sin_cos().0, x.sin_cos().1, x.sinh(), x.cosh(), x.tanh(), x.asinh()]);
    all.extend([(x + 2.0).acosh(), small.atanh(), x.sph_j0(), x.sph_j1(), x.sph_j2()]);
    all.extend([(-x).abs(), x.signum(), [x, y].into_iter().sum(), [x, y].into_iter().product()]);
    all
}

#[track_caller]
fn close(position: usize, found: f64, expected: f64) {
    let error = (found - expected).abs();
    assert!(error <= 4e-15 * expected.abs().max(1.0), "{position}: {found} for {expected}");
}

#[test]
fn chunks_are_the_vector_duals_of_num_dual() {
    for [x, y] in [[0.7, 1.9], [3.2, -0.4], [1.0, 12.5]] {
        let chunks = functions(DualChunk::<f64, 2>::seeded(x, 0), DualChunk::seeded(y, 1));
        let vectors =
            functions(DualSVec64::<2>::from(x).derivative(0), DualSVec64::from(y).derivative(1));
        for (k, (chunk, vector)) in chunks.iter().zip(vectors).enumerate() {
            close(k, chunk.re, vector.re);
            let parts = vector.eps.0.map_or([0.0; 2], |eps| eps.into());
            chunk.eps.iter().zip(parts).for_each(|(found, part)| close(k, *found, part));
        }
    }
}

#[test]
fn nested_chunks_have_mixed_derivatives() {
    // ∂/∂y of the derivatives with respect to x and y, from dual numbers by y inside.
    let (x, y) = (0.7, 1.9);
    let inner = [Dual64::from(x), Dual64::from(y).derivative()];
    let nested = functions(
        DualChunk::<Dual64, 2>::seeded(inner[0], 0),
        DualChunk::<Dual64, 2>::seeded(inner[1], 1),
    );
    let h = 1e-6;
    let [below, above] = [-h, h].map(|h| {
        functions(DualChunk::<f64, 2>::seeded(x, 0), DualChunk::<f64, 2>::seeded(y + h, 1))
    });
    for (k, number) in nested.iter().enumerate() {
        for direction in 0..2 {
            let difference = (above[k].eps[direction] - below[k].eps[direction]) / (2.0 * h);
            let found = number.eps[direction].eps;
            assert!((found - difference).abs() < 1e-8, "{k}: {found} for {difference}");
        }
    }
}

/// A constant has no derivative, even where a function has no slope.
#[test]
fn constants_stay_constants() {
    let zero = DualChunk::<f64, 4>::from(0.0);
    assert_eq!((zero.sqrt().re, zero.sqrt().eps), (0.0, [0.0; 4]));
    assert!(!DualChunk::<f64, 4>::seeded(0.0, 2).sqrt().eps[2].is_finite());
}
