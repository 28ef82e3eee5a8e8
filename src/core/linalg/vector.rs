//! Vector operations on slices.

/// `aᵀ b`.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The Euclidean norm.
pub(crate) fn norm(v: &[f64]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// Returns the largest absolute value of the elements; 0 for an empty slice.
pub(crate) fn largest(v: &[f64]) -> f64 {
    v.iter().fold(0.0, |most: f64, v| most.max(v.abs()))
}

/// Scales a vector to length 1, unless it is zero.
pub(crate) fn normalise(v: &mut [f64]) {
    let norm = norm(v);
    if norm > 0.0 {
        v.iter_mut().for_each(|v| *v /= norm);
    }
}

/// Computes `⟨row, x − base⟩`: the signed distance of `x` from the hyperplane through `base` with
/// the normal vector `row`, times the length of `row`.
pub(crate) fn along(row: &[f64], x: &[f64], base: &[f64]) -> f64 {
    row.iter().zip(x.iter().zip(base)).map(|(r, (x, b))| r * (x - b)).sum()
}

/// `a − b`.
pub(crate) fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// Computes `a + s b`.
pub(crate) fn advanced(a: &[f64], s: f64, b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + s * b).collect()
}

/// Returns a fixed pseudo-random vector, used as an initial border: generically, it is not
/// orthogonal to a null vector.
pub(crate) fn generic(length: usize, seed: usize) -> Vec<f64> {
    (0..length).map(|i| (1.0 + (i + 1) as f64 * (0.618 + seed as f64)).sin() + 0.1).collect()
}

/// Makes a vector orthogonal to given orthonormal vectors, by two Gram–Schmidt passes, and returns
/// its components along the given vectors.
pub(crate) fn orthogonalise(
    v: &mut [f64],
    others: &[Vec<f64>],
    product: impl Fn(&[f64], &[f64]) -> f64,
) -> Vec<f64> {
    let mut overlaps = vec![0.0; others.len()];
    for _ in 0..2 {
        for (overlap, other) in overlaps.iter_mut().zip(others) {
            let part = product(other, v);
            *overlap += part;
            v.iter_mut().zip(other).for_each(|(v, o)| *v -= part * o);
        }
    }
    overlaps
}

/// Whether a vector is the concatenation of two others. Whole slices are compared, which takes less
/// time than a comparison with an iterator over both parts.
pub(crate) fn are_joined(whole: &[f64], first: &[f64], second: &[f64]) -> bool {
    whole.split_at_checked(first.len()).is_some_and(|parts| parts == (first, second))
}

/// Replaces the elements of a vector without reallocating memory if the capacity suffices.
#[inline]
pub(crate) fn refill<T>(vector: &mut Vec<T>, elements: impl IntoIterator<Item = T>) {
    vector.clear();
    vector.extend(elements);
}
