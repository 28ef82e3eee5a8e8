//! The rightmost eigenvalues of a sparse matrix: a Krylov space of the inverse, and how far their
//! count is certain.

use super::{Elimination, Pattern, SparseLu};
use crate::core::failure::Failure;
use crate::core::linalg::{Border, Spectrum, dot, generic, norm};
use faer::{MatRef, Side, c64};
use std::sync::Arc;

/// (H) The most eigenvalues that are computed to make the count of unstable ones certain.
const MOST: usize = 48;

/// (H) The largest dimension of a Krylov space.
const DIMENSION: usize = 240;

/// (R) Eigenvalues of the inverse have converged to this relative error.
const CONVERGED: f64 = 1e-11;

/// (R) A shift that is an eigenvalue is moved by this part of the largest entry.
const ASIDE: f64 = 1e-10;

/// (R) What is left of the digits of eigenvalues of the inverse, compared with the largest one.
const ROUNDING: f64 = 1e-14;

/// (H) An eigenvalue at the shift, nearer than the next one by this factor, hides the digits of the
/// others.
const ALONE: f64 = 1e-6;

/// (H) The shift is then moved by this part of the next one's distance.
const BESIDE: f64 = 0.11;

/// (H) The largest number of moves of the shift.
const MOVES: usize = 3;

/// What is computed.
const NEAREST: &str = "eigenvalues nearest to zero";

/// (R) An eigenvalue this small, compared with the others that are found, may have either sign.
const NEUTRAL: f64 = 1e-8;

/// The rightmost eigenvalues of matrices of one pattern along a branch.
///
/// Arnoldi's method with the inverse finds the eigenvalues nearest to zero (Y. Saad, *Numerical
/// Methods for Large Eigenvalue Problems*, SIAM 2011, ch. 8). A second run, orthogonal to the
/// eigenvectors found, finds repeated eigenvalues. The unstable ones are counted with certainty
/// - of a symmetric matrix by the signs of its pivots (Sylvester's law of inertia),
/// - of others if all eigenvalues with a positive real part must lie in a rectangle (I. Bendixson,
///   Acta Math. 25 (1902) 359) inside the circle in which all eigenvalues are known.
#[derive(Default)]
pub(in crate::core) struct Leading {
    lu: SparseLu,
    /// The sum of the eigenvectors found last.
    start: Vec<f64>,
}

/// The rightmost eigenvalues.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::core) struct Rightmost {
    /// The rightmost first.
    pub spectrum: Spectrum,
    /// Whether no other eigenvalue has a positive real part.
    pub certain: bool,
}

/// Eigenvalues of the inverse, with an orthonormal basis of the space of their eigenvectors.
#[derive(Default)]
struct Locked {
    values: Vec<c64>,
    basis: Vec<Vec<f64>>,
}

impl Locked {
    /// The size that a value must exceed to be among the `count` largest.
    fn least(&self, count: usize) -> f64 {
        let mut sizes: Vec<f64> = self.values.iter().map(|it| it.norm()).collect();
        sizes.sort_by(|a, b| b.total_cmp(a));
        count.checked_sub(1).and_then(|last| sizes.get(last)).copied().unwrap_or(0.0)
    }
}

impl Leading {
    /// All unstable eigenvalues of the matrix with these entries, and at least `least` of all, if that is
    /// no more than [`MOST`].
    ///
    /// # Errors
    /// [`Failure`] if the matrix cannot be factored, or the eigenvalues do not converge.
    pub fn rightmost(
        &mut self,
        elimination: &Arc<Elimination>,
        entries: &[f64],
        least: usize,
    ) -> Result<Rightmost, Failure> {
        let pattern = &elimination.pattern;
        let n = pattern.size();
        let symmetric = pattern.is_symmetric(entries);
        let mut shift = 0.0;
        if self.lu.factor(elimination, (entries, shift), Border::NONE).is_err() {
            shift = ASIDE * entries.iter().fold(0.0, |most: f64, a| most.max(a.abs()));
            self.lu.factor(elimination, (entries, shift), Border::NONE)?;
        }
        let positive = self.lu.negative_pivots().filter(|_| symmetric).map(|negative| n - negative);
        let corner = pattern.unstable_corner(entries);
        let least = least.min(MOST);
        let mut count = least + positive.unwrap_or(0).min(MOST);
        let mut moves = 0;
        loop {
            count = count.min(n);
            let (spectrum, radius) = match self.nearest(n, (shift, count), symmetric)? {
                Found::Alone(distance) if moves < MOVES => {
                    shift += BESIDE * distance;
                    self.lu.factor(elimination, (entries, shift), Border::NONE)?;
                    moves += 1;
                    continue;
                }
                Found::Alone(_) => return Err(Failure::Eigenvalues(NEAREST)),
                Found::All { spectrum, radius } => (spectrum, radius),
            };
            let neutral = |l: &&(f64, f64)| l.0.abs() < NEUTRAL * radius;
            let open = spectrum.iter().filter(neutral).count();
            let unstable = spectrum.iter().filter(|l| l.0 > 0.0).count();
            let certain = count == n
                || match positive {
                    Some(positive) => positive.abs_diff(unstable) <= open,
                    None => (corner.0 - shift).hypot(corner.1) < radius,
                };
            if certain || count >= MOST {
                return Ok(Rightmost { spectrum, certain });
            }
            count *= 2;
        }
    }

    /// The `count` eigenvalues nearest to the shift.
    fn nearest(
        &mut self,
        n: usize,
        (shift, count): (f64, usize),
        symmetric: bool,
    ) -> Result<Found, Failure> {
        let mut locked = Locked::default();
        let mut sum = vec![0.0; n];
        if self.start.len() != n {
            self.start = generic(n, 0);
        }
        let mut start = self.start.clone();
        for run in 1.. {
            let wanted = count.saturating_sub(locked.values.len()).max(1);
            let (before, vectors) = (locked.values.len(), locked.basis.len());
            // Values smaller than those that are known already need no digits.
            let least = if before < count { 0.0 } else { locked.least(count) };
            if let Some(distance) = self.run(start, (wanted, least, symmetric), &mut locked)? {
                return Ok(Found::Alone(distance));
            }
            for vector in &locked.basis[vectors..] {
                sum.iter_mut().zip(vector).for_each(|(sum, v)| *sum += v);
            }
            if locked.values.len() == before || locked.basis.len() >= n {
                break;
            }
            start = generic(n, run);
        }
        self.start = sum;
        let least = locked.least(count);
        let radius = 1.0 / least.max(f64::MIN_POSITIVE);
        let value = |value: &c64| match value.im {
            0.0 => (shift + value.re.recip(), 0.0),
            _ => {
                let inverse = c64::new(1.0, 0.0) / *value;
                (shift + inverse.re, inverse.im)
            }
        };
        let mut spectrum: Spectrum =
            locked.values.iter().filter(|it| it.norm() >= least).map(value).collect();
        spectrum.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.1.total_cmp(&a.1)));
        Ok(Found::All { spectrum, radius })
    }

    /// Arnoldi's method orthogonal to the locked vectors, until the `wanted` largest values have
    /// converged, which are then locked, or are certainly smaller than `least`. Returns the distance
    /// of the next eigenvalue if one is so near to the shift that it hides the digits of the others.
    fn run(
        &mut self,
        start: Vec<f64>,
        (wanted, least, symmetric): (usize, f64, bool),
        locked: &mut Locked,
    ) -> Result<Option<f64>, Failure> {
        let Some(mut space) = Krylov::new(start, locked) else { return Ok(None) };
        loop {
            space.grow(&mut self.lu, locked);
            let m = space.vectors.len();
            if !space.is_complete() && (m < wanted + 2 || !m.is_multiple_of(3)) {
                continue;
            }
            let ritz = space.ritz(symmetric)?;
            let chosen = ritz.largest(wanted);
            let size = |k: usize| ritz.values[k].norm();
            let error = |k: usize| ritz.last_component(k) * space.rest;
            let first = chosen[0];
            if size(first) + error(first) < least {
                return Ok(None);
            }
            if let Some(next) = chosen.get(1).filter(|next| size(**next) < ALONE * size(first)) {
                return Ok(Some(size(*next).recip()));
            }
            let rounding = ROUNDING * size(first);
            if chosen.iter().all(|k| error(*k) <= rounding.max(CONVERGED * size(*k))) {
                ritz.lock(&chosen, &space.vectors, locked);
                return Ok(None);
            }
            if space.is_complete() {
                return Err(Failure::Eigenvalues(NEAREST));
            }
        }
    }
}

/// A Krylov space of the inverse, orthogonal to locked vectors.
struct Krylov {
    vectors: Vec<Vec<f64>>,
    next: Vec<f64>,
    /// The length of the last image's part outside of the space; 0 of an invariant space.
    rest: f64,
    /// The projected inverse, one column after the other, with room for the largest dimension.
    projected: Vec<f64>,
    most: usize,
}

impl Krylov {
    /// The space that begins with a vector; `None` if that lies in the space of the locked ones.
    fn new(mut next: Vec<f64>, locked: &Locked) -> Option<Self> {
        let most = DIMENSION.min(next.len() - locked.basis.len());
        let (_, rest) = orthonormalise(&mut next, &[&locked.basis]);
        let projected = vec![0.0; most * most];
        (rest > 0.0).then(|| Krylov { vectors: Vec::new(), next, rest, projected, most })
    }

    /// Whether no other dimension helps, or has room.
    fn is_complete(&self) -> bool {
        self.rest == 0.0 || self.vectors.len() == self.most
    }

    /// Adds a dimension.
    fn grow(&mut self, lu: &mut SparseLu, locked: &Locked) {
        let mut image = self.next.clone();
        self.vectors.push(std::mem::take(&mut self.next));
        lu.solve(&mut image);
        let (parts, rest) = orthonormalise(&mut image, &[&locked.basis, &self.vectors]);
        let (m, most) = (self.vectors.len(), self.most);
        for (i, part) in parts[locked.basis.len()..].iter().enumerate() {
            self.projected[(m - 1) * most + i] = *part;
        }
        let size = parts.iter().fold(rest, |most: f64, part| most.max(part.abs()));
        let whole = m + locked.basis.len() == image.len();
        self.rest = if whole || rest <= f64::EPSILON * size { 0.0 } else { rest };
        if m < most {
            self.projected[(m - 1) * most + m] = self.rest;
        }
        self.next = image;
    }

    /// The eigenvalues of the projected inverse.
    fn ritz(&self, symmetric: bool) -> Result<Ritz, Failure> {
        let m = self.vectors.len();
        let square = MatRef::from_column_major_slice_with_stride(&self.projected, m, m, self.most);
        Ritz::of(square, symmetric)
    }
}

/// The eigenvalues nearest to a shift.
enum Found {
    /// The rightmost first.
    All {
        spectrum: Spectrum,
        /// The radius of the circle about the shift in which there are no others.
        radius: f64,
    },
    /// One is at the shift, and the next one at this distance.
    Alone(f64),
}

/// Eigenvalues of a projected matrix.
struct Ritz {
    values: Vec<c64>,
    /// The eigenvectors, of length 1.
    vectors: Vec<Vec<c64>>,
}

impl Ritz {
    fn of(matrix: MatRef<f64>, symmetric: bool) -> Result<Self, Failure> {
        let unknown = Failure::Eigenvalues("eigenvalues");
        let m = matrix.nrows();
        if symmetric {
            let mean = (matrix + matrix.transpose()) * faer::Scale(0.5);
            let found = mean.self_adjoint_eigen(Side::Lower).map_err(|_| unknown)?;
            let vector = |k| (0..m).map(|i| c64::new(found.U()[(i, k)], 0.0)).collect();
            let values = (0..m).map(|k| c64::new(found.S()[k], 0.0)).collect();
            return Ok(Ritz { values, vectors: (0..m).map(vector).collect() });
        }
        let found = matrix.eigen().map_err(|_| unknown)?;
        let vector = |k| {
            let vector: Vec<c64> = (0..m).map(|i| found.U()[(i, k)]).collect();
            let length = vector.iter().map(|it| it.norm_sqr()).sum::<f64>().sqrt();
            vector.into_iter().map(|it| it / length).collect()
        };
        let values = (0..m).map(|k| found.S()[k]).collect();
        Ok(Ritz { values, vectors: (0..m).map(vector).collect() })
    }

    /// The positions of the `count` largest values, with the conjugates of complex ones.
    fn largest(&self, count: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.values.len()).collect();
        let size = |k: &usize| self.values[*k].norm();
        let by = |a: &usize, b: &usize| {
            size(b).total_cmp(&size(a)).then(self.values[*b].im.total_cmp(&self.values[*a].im))
        };
        order.sort_by(by);
        let mut chosen = order[..count.min(order.len())].to_vec();
        let pairs = chosen.iter().map(|k| self.values[*k].im).sum::<f64>();
        if pairs.abs() > 1e-12 * chosen.last().map_or(0.0, size)
            && let Some(conjugate) = order.get(count)
        {
            chosen.push(*conjugate);
        }
        chosen
    }

    /// The last component of an eigenvector, times which what is left of a Krylov space is the error.
    fn last_component(&self, k: usize) -> f64 {
        self.vectors[k].last().map_or(0.0, |it| it.norm())
    }

    /// Locks values, with an orthonormal basis of their eigenvectors in the space.
    fn lock(&self, chosen: &[usize], space: &[Vec<f64>], locked: &mut Locked) {
        for &k in chosen {
            let value = self.values[k];
            locked.values.push(value);
            let part = match value.im {
                im if im < 0.0 => |it: &c64| it.im,
                _ => |it: &c64| it.re,
            };
            let mut vector = vec![0.0; space[0].len()];
            for (basis, factor) in space.iter().zip(&self.vectors[k]) {
                let factor = part(factor);
                vector.iter_mut().zip(basis).for_each(|(v, b)| *v += factor * b);
            }
            if orthonormalise(&mut vector, &[&locked.basis]).1 > 1e-8 {
                locked.basis.push(vector);
            }
        }
    }
}

/// Makes a vector orthogonal to the vectors of some orthonormal lists, twice for the digits that
/// cancel, and scales it to length 1. Returns its components along them, and the length of the rest.
fn orthonormalise(vector: &mut [f64], to: &[&Vec<Vec<f64>>]) -> (Vec<f64>, f64) {
    let all = || to.iter().flat_map(|list| list.iter());
    let mut parts = vec![0.0; all().count()];
    for _ in 0..2 {
        for (part, basis) in parts.iter_mut().zip(all()) {
            let along = dot(basis, vector);
            *part += along;
            vector.iter_mut().zip(basis).for_each(|(v, b)| *v -= along * b);
        }
    }
    let rest = norm(vector);
    if rest > 0.0 {
        vector.iter_mut().for_each(|v| *v /= rest);
    }
    (parts, rest)
}

impl Pattern {
    /// Each entry with the position of the entry across the diagonal, where there is one.
    fn transposed(&self) -> impl Iterator<Item = (usize, [usize; 2], Option<usize>)> + '_ {
        (0..self.size()).flat_map(move |j| {
            (self.start(j)..).zip(self.column(j)).map(move |(k, &i)| {
                let across = self.column(i).binary_search(&j).ok().map(|at| self.start(i) + at);
                (k, [i, j], across)
            })
        })
    }

    /// Whether the matrix with these entries is exactly symmetric.
    pub fn is_symmetric(&self, entries: &[f64]) -> bool {
        self.transposed()
            .all(|(k, _, across)| entries[k] == across.map_or(0.0, |across| entries[across]))
    }

    /// The corner of the rectangle `0 ≤ Re λ ≤ a`, `|Im λ| ≤ b` in which all eigenvalues with a
    /// positive real part lie: `a` is a bound of the symmetric part's eigenvalues by Gershgorin's
    /// circles, `b` of the skew part's.
    fn unstable_corner(&self, entries: &[f64]) -> (f64, f64) {
        let n = self.size();
        let (mut symmetric, mut skew) = (vec![0.0; n], vec![0.0; n]);
        for (k, [i, j], across) in self.transposed() {
            let (a, other) = (entries[k], across.map_or(0.0, |across| entries[across]));
            if i == j {
                symmetric[i] += a;
                continue;
            }
            // Without a partner the entry counts on both sides.
            let rows: &[usize] = if across.is_some() { &[i] } else { &[i, j] };
            for &row in rows {
                symmetric[row] += 0.5 * (a + other).abs();
                skew[row] += 0.5 * (a - other).abs();
            }
        }
        let most = |all: Vec<f64>| all.into_iter().fold(0.0, f64::max);
        (most(symmetric), most(skew))
    }
}
