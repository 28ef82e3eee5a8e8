//! The generalised minimal residual method for linear systems without a matrix.

use super::vector::{dot, norm, orthogonalise};

/// The generalised minimal residual method (Y. Saad and M. H. Schultz, SIAM J. Sci. Stat. Comput. 7
/// (1986) 856): the approximate solution of `A x = b` is the vector of the Krylov space
/// `span{b, A b, A² b, …}` whose residual is smallest.
///
/// With the orthonormal basis `V` of the space, `A V_k = V_{k+1} H_k`; rotations `Q` transform the
/// Hessenberg matrix `H_k` to the triangular matrix `R`, so that `R y = Q ‖b‖ e₁` and `x = V_k y`.
#[derive(Default)]
pub(in crate::core) struct Gmres {
    /// The basis `V`; vectors of earlier runs are overwritten.
    basis: Vec<Vec<f64>>,
    /// The columns of `R`.
    triangle: Vec<Vec<f64>>,
    /// The cosines and sines of the rotations.
    rotations: Vec<[f64; 2]>,
    /// The vector `Q ‖b‖ e₁`; the absolute value of its last entry is the norm of the residual.
    rotated: Vec<f64>,
}

impl Gmres {
    /// Writes the approximate solution of `A x = b` into `x` as soon as the residual is smaller than
    /// `reduction · ‖b‖`, or after `most` products with `A`; `product` computes products of `A` with
    /// vectors. Returns the number of products.
    pub fn run(
        &mut self,
        product: impl Fn(&[f64], &mut [f64]),
        b: &[f64],
        x: &mut [f64],
        (reduction, most): (f64, usize),
    ) -> usize {
        let Gmres { basis, triangle, rotations, rotated } = self;
        let size = norm(b);
        triangle.clear();
        rotations.clear();
        rotated.clear();
        rotated.push(size);
        let mut length = size;
        vector(basis, 0, b.len()).copy_from_slice(b);
        for k in 0..most {
            if length == 0.0 || length.is_nan() || rotated[k].abs() <= reduction * size {
                break;
            }
            basis[k].iter_mut().for_each(|v| *v /= length);
            vector(basis, k + 1, b.len());
            let (space, rest) = basis.split_at_mut(k + 1);
            let next = &mut rest[0];
            product(&space[k], next);
            let mut column = orthogonalise(next, space, dot);
            length = norm(next);
            for (j, [cosine, sine]) in rotations.iter().enumerate() {
                let [upper, lower] = [column[j], column[j + 1]];
                column[j] = cosine * upper + sine * lower;
                column[j + 1] = cosine * lower - sine * upper;
            }
            let diagonal = column[k].hypot(length);
            // The matrix is singular, or a product is not finite: the space does not grow further.
            if diagonal.is_nan() || diagonal == 0.0 {
                break;
            }
            let [cosine, sine] = [column[k] / diagonal, length / diagonal];
            column[k] = diagonal;
            triangle.push(column);
            rotations.push([cosine, sine]);
            let before = rotated[k];
            rotated[k] = cosine * before;
            rotated.push(-sine * before);
        }
        self.combine(x);
        self.triangle.len()
    }

    /// Solves `R y = Q ‖b‖ e₁`, and computes `x = V y`.
    fn combine(&mut self, x: &mut [f64]) {
        let Gmres { basis, triangle, rotated, .. } = self;
        x.fill(0.0);
        for (k, (column, v)) in triangle.iter().zip(basis).enumerate().rev() {
            let y = rotated[k] / column[k];
            rotated.iter_mut().zip(&column[..k]).for_each(|(right, entry)| *right -= y * entry);
            x.iter_mut().zip(v).for_each(|(x, v)| *x += y * *v);
        }
    }
}

/// Returns the basis vector number `k`, with room for `n` components; `k` is at most the number of
/// vectors.
fn vector(basis: &mut Vec<Vec<f64>>, k: usize, n: usize) -> &mut [f64] {
    if k == basis.len() {
        basis.push(Vec::new());
    }
    basis[k].resize(n, 0.0);
    &mut basis[k]
}
