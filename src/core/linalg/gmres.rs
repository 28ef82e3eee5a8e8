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
        basis.clear();
        triangle.clear();
        rotations.clear();
        rotated.clear();
        rotated.push(size);
        let mut next: Vec<f64> = b.to_vec();
        let mut length = size;
        // False for NaN.
        while length > 0.0 && rotated[basis.len()].abs() > reduction * size && basis.len() < most {
            next.iter_mut().for_each(|v| *v /= length);
            basis.push(next);
            next = vec![0.0; b.len()];
            product(&basis[basis.len() - 1], &mut next);
            let mut column = orthogonalise(&mut next, basis, dot);
            length = norm(&next);
            for (k, [cosine, sine]) in rotations.iter().enumerate() {
                let [upper, lower] = [column[k], column[k + 1]];
                column[k] = cosine * upper + sine * lower;
                column[k + 1] = cosine * lower - sine * upper;
            }
            let last = column.len() - 1;
            let diagonal = column[last].hypot(length);
            // The matrix is singular, or a product is not finite: the space does not grow further.
            if diagonal.is_nan() || diagonal == 0.0 {
                break;
            }
            let [cosine, sine] = [column[last] / diagonal, length / diagonal];
            column[last] = diagonal;
            triangle.push(column);
            rotations.push([cosine, sine]);
            let before = rotated[last];
            rotated[last] = cosine * before;
            rotated.push(-sine * before);
        }
        self.combine(x);
        self.basis.len()
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
