//! The rightmost eigenvalues of a sparse matrix, from a Krylov space of the inverse matrix, and a
//! certificate of the number of unstable eigenvalues.

use super::block::LANES;
use super::inverse::{Inverse, Matrix};
use super::krylov::{Krylov, Locked, is_zero};
use super::{Elimination, Pencil, SparseLu};
use crate::core::failure::Failure;
use crate::core::linalg::Spectrum;
use faer::c64;
use std::mem::{swap, take};
use std::sync::Arc;

/// Heuristic: the largest number of eigenvalues that are computed to certify the number of unstable
/// eigenvalues.
const MOST: usize = 48;

/// Heuristic: the number of vectors from the previous point of the branch with which a Krylov space
/// begins, in addition to random vectors.
const WARM: usize = 5;
const SEEDS: usize = 3;

/// Rounding: two eigenvalues count as one repeated eigenvalue if their relative distance is smaller
/// than this.
const REPEATED: f64 = 1e-6;

/// Rounding: the relative error at which eigenvalues of the inverse matrix count as converged.
const CONVERGED: f64 = 1e-11;

/// Rounding: the rounding error of eigenvalues of the inverse matrix, relative to the largest
/// eigenvalue.
const ROUNDING: f64 = 1e-14;

/// Rounding: with a mass matrix, an eigenvalue of the inverse counts as zero, and the eigenvalue
/// as infinite, if it is smaller than this, relative to the largest eigenvalue of the inverse.
const INFINITE: f64 = 1e-7;

/// Heuristic: an eigenvalue near the shift hides the digits of the other eigenvalues if its
/// distance from the shift is smaller than the next eigenvalue's distance by this factor.
const ALONE: f64 = 1e-6;

/// Heuristic: with a mass matrix, the bound is larger if requested eigenvalues would count as infinite.
const ALONE_OF_PENCIL: f64 = 1e-3;

/// Heuristic: if an eigenvalue near the shift hides the digits of the others, the shift is changed
/// by this fraction of the next eigenvalue's distance.
const BESIDE: f64 = 0.11;

/// Heuristic: the search for the largest eigenvalues starts at this multiple of the largest
/// eigenvalue of the previous matrix.
const FARTHER: f64 = 1.25;

/// Heuristic: the largest number of changes of the shift.
const MOVES: usize = 3;

/// Heuristic: the eigenvalues of a Krylov space are computed for the first time when the space is as
/// large as the converged Krylov space of the previous matrix. If the errors of the previous
/// eigenvalues were smaller than this fraction of the allowed errors, the space is smaller by one part
/// of the number `EARLIER`, and at least by one block.
const SLACK: f64 = 1e-2;
const EARLIER: usize = 8;

/// The description of the requested eigenvalues in error messages.
const NEAREST: &str = "eigenvalues nearest to zero";

/// Rounding: the sign of an eigenvalue is uncertain if the eigenvalue is smaller than this,
/// relative to the other computed eigenvalues.
const NEUTRAL: f64 = 1e-8;

/// The rightmost eigenvalues of matrices with the same sparsity pattern, along a branch.
///
/// Arnoldi's method with the inverse matrix finds the eigenvalues nearest to zero (Y. Saad,
/// *Numerical Methods for Large Eigenvalue Problems*, SIAM 2011, ch. 8). Arnoldi's method starts
/// from the eigenvectors of the previous matrix and from random vectors. The random vectors find
/// new eigenvalues; a repeated eigenvalue is found at most as many times as there are random
/// vectors. If an eigenvalue is found as many times as there are random vectors, another run,
/// orthogonal to the known eigenvectors, searches for more copies of the eigenvalue. The number of
/// unstable eigenvalues is certified in two cases:
/// - If a diagonal scaling makes the matrix symmetric, the signs of the pivots give the number of
///   unstable eigenvalues (Sylvester's law of inertia). Positive eigenvalues far beyond the circle
///   in which all eigenvalues are known are then computed as the largest eigenvalues.
/// - For other matrices, the number of unstable eigenvalues is certified if the rectangle that must
///   contain all eigenvalues with a positive real part (I. Bendixson, Acta Math. 25 (1902) 359)
///   lies inside the circle in which all eigenvalues are known.
#[derive(Default)]
pub(in crate::core) struct Leading {
    lu: SparseLu,
    /// The results for the previous matrix.
    previous: Previous,
    /// The results for the largest eigenvalues of the previous matrix, and the largest eigenvalue.
    farthest: Previous,
    largest: f64,
}

/// The results for the previous matrix, from which the next search starts.
#[derive(Default)]
struct Previous {
    vectors: Vec<Vec<f64>>,
    /// The number of products with the inverse after which the eigenvalues of the first Krylov space
    /// are computed for the first time.
    products: usize,
}

/// The rightmost eigenvalues.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::core) struct Rightmost {
    /// The eigenvalues, starting with the rightmost.
    pub spectrum: Spectrum,
    /// Whether the list of eigenvalues is certain to contain all eigenvalues with a positive real
    /// part.
    pub certain: bool,
}

impl Leading {
    /// Computes the eigenvalues of a pencil: all unstable eigenvalues (at most [`MOST`]), and the
    /// `least` other eigenvalues nearest to zero. The number of unstable eigenvalues is certified
    /// only without a mass matrix. The argument `known` contains the factors of the matrix in a
    /// border, if these factors are known.
    pub fn rightmost(
        &mut self,
        (elimination, pencil): (&Arc<Elimination>, Pencil),
        least: usize,
        known: Option<&mut SparseLu>,
    ) -> Result<Rightmost, Failure> {
        let pattern = &elimination.pattern;
        if let Some(d) = pattern.balancing(pencil.entries) {
            let [entries, mass] = [Some(pencil.entries), pencil.mass]
                .map(|entries| entries.map(|entries| pattern.scaled(entries, &d)));
            let entries = entries.unwrap_or_default();
            let pencil = Pencil { entries: &entries, mass: mass.as_deref() };
            return self.rightmost_of((elimination, pencil), least, None);
        }
        self.rightmost_of((elimination, pencil), least, known)
    }

    /// Computes the eigenvalues of a pencil whose unknowns have similar units.
    fn rightmost_of(
        &mut self,
        (elimination, pencil): (&Arc<Elimination>, Pencil),
        least: usize,
        known: Option<&mut SparseLu>,
    ) -> Result<Rightmost, Failure> {
        let of_matrix = || elimination.pattern.symmetrising(pencil.entries);
        let scales = if pencil.mass.is_some() { None } else { of_matrix() };
        let matrix = Matrix { elimination, pencil, scales: scales.as_deref() };
        let mut lu = take(&mut self.lu);
        let inverse = Inverse::near_zero(matrix, &mut lu, known);
        let found = inverse.and_then(|mut inverse| self.rightmost_with(&mut inverse, least));
        self.lu = lu;
        found
    }

    fn rightmost_with(
        &mut self,
        inverse: &mut Inverse,
        least: usize,
    ) -> Result<Rightmost, Failure> {
        let Matrix { elimination, pencil, .. } = inverse.matrix;
        let n = inverse.matrix.size();
        let positive = inverse.count_below().map(|negative| n - negative);
        let least = least.min(MOST);
        let mut count = least + positive.unwrap_or(0).min(MOST);
        let mut moves = 0;
        loop {
            count = count.min(n);
            let shift = inverse.shift();
            let mut circle = match self.nearest(inverse, count)? {
                Found::Alone(distance) if moves < MOVES => {
                    inverse.move_to(shift + BESIDE * distance)?;
                    moves += 1;
                    continue;
                }
                Found::Alone(_) => return Err(Failure::Eigenvalues(NEAREST)),
                Found::All(circle) => circle,
            };
            let pattern = &elimination.pattern;
            let certain = match positive {
                Some(positive) => self.is_counted(inverse, positive, &mut circle)?,
                None if pencil.mass.is_some() => false,
                None => count == n || circle.contains(pattern.unstable_corner(pencil.entries)),
            };
            let enough = if certain { (least + circle.unstable()).min(n) } else { MOST };
            if count >= enough.min(MOST).min(n) {
                return Ok(Rightmost { spectrum: circle.spectrum, certain });
            }
            inverse.move_to(shift)?;
            count = if certain { enough } else { 2 * count };
        }
    }

    /// Whether all positive eigenvalues of the matrix are known; `positive` is the number of
    /// positive eigenvalues that the matrix has. Positive eigenvalues far beyond the circle of
    /// known eigenvalues are computed and added.
    fn is_counted(
        &mut self,
        inverse: &mut Inverse,
        positive: usize,
        circle: &mut Circle,
    ) -> Result<bool, Failure> {
        let neutral = NEUTRAL * circle.radius;
        let neutral = circle.spectrum.iter().filter(|l| l.0.abs() < neutral).count();
        let missing = positive.saturating_sub(circle.unstable()).min(MOST);
        let edge = circle.center + circle.radius;
        // The pivots may have counted neutral eigenvalues as positive.
        if missing > neutral || missing > 0 && may_have_values_above(inverse, edge) {
            circle.spectrum.splice(0..0, self.beyond(inverse, edge, missing)?);
        }
        Ok(positive.abs_diff(circle.unstable()) <= neutral)
    }

    /// Computes the `missing` largest eigenvalues above `edge` of a matrix that a diagonal scaling
    /// makes symmetric. Returns an empty list if these eigenvalues are not found, for example
    /// because many of them lie close together.
    fn beyond(
        &mut self,
        inverse: &mut Inverse,
        edge: f64,
        missing: usize,
    ) -> Result<Spectrum, Failure> {
        let mut top = (2.0 * edge).max(FARTHER * self.largest);
        loop {
            inverse.move_to(top)?;
            match inverse.count_below() {
                Some(negative) if negative < inverse.matrix.size() => top *= 2.0,
                Some(_) => break,
                None => return Ok(Spectrum::new()),
            }
        }
        swap(&mut self.previous, &mut self.farthest);
        let found = self.nearest(inverse, missing);
        swap(&mut self.previous, &mut self.farthest);
        let found = match found {
            Ok(Found::All(far)) => far.spectrum,
            Ok(Found::Alone(_)) | Err(Failure::Eigenvalues(_)) => Spectrum::new(),
            Err(cause) => return Err(cause),
        };
        let found: Spectrum = found.into_iter().filter(|l| l.0 > edge).take(missing).collect();
        self.largest = found.first().map_or(0.0, |l| l.0);
        Ok(found)
    }

    /// Computes the `count` eigenvalues nearest to the shift.
    fn nearest(&mut self, inverse: &mut Inverse, count: usize) -> Result<Found, Failure> {
        let (n, shift) = (inverse.matrix.size(), inverse.shift());
        let mut locked = Locked::default();
        let mut starts = self.starts(n);
        for number in 0.. {
            let (before, mut seeds) = (locked.values.len(), SEEDS);
            let unknown = count.saturating_sub(before).max(1);
            // Values smaller than the known ones need no digits.
            let least = if before < count { 0.0 } else { locked.least(count) };
            let mut run = self.run(&starts, (unknown, least, inverse), &mut locked);
            if run.is_err() {
                // The space of a single vector contains higher powers.
                seeds = 1;
                run = self.run(&starts[..1], (unknown, least, inverse), &mut locked);
            }
            if let Some(distance) = run? {
                return Ok(Found::Alone(distance));
            }
            // A value repeated as often as there are random vectors can have a further copy.
            let found = &locked.values[before..];
            if locked.values.len() >= count && most_repeated(found) < seeds
                || found.is_empty()
                || locked.basis.len() >= n
            {
                break;
            }
            starts = (0..LANES).map(|k| random(n, (number + 2) * LANES + k)).collect();
        }
        let mut least = locked.least(count);
        if inverse.matrix.pencil.mass.is_some() {
            least = least.max(INFINITE * locked.least(1));
        }
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
        let Locked { basis, others, .. } = locked;
        let missing = WARM.saturating_sub(basis.len());
        self.previous.vectors = basis;
        self.previous.vectors.extend(others.into_iter().take(missing));
        Ok(Found::All(Circle { spectrum, center: shift, radius }))
    }

    /// Creates the initial vectors of the first Krylov space: sums of the previous eigenvectors,
    /// and random vectors, which find eigenvectors that the sums lack.
    fn starts(&self, n: usize) -> Vec<Vec<f64>> {
        let previous = &self.previous.vectors;
        let is_known = previous.first().is_some_and(|it| it.len() == n);
        let known = if is_known { previous.len().min(WARM) } else { 0 };
        let mut starts = vec![vec![0.0; n]; known];
        for (k, vector) in previous.iter().enumerate().filter(|_| is_known) {
            starts[k % WARM].iter_mut().zip(vector).for_each(|(sum, v)| *sum += v);
        }
        starts.extend((known..WARM + SEEDS).map(|k| random(n, k)));
        starts
    }

    /// Grows a Krylov space, orthogonal to the locked vectors, until all eigenvalues that can be
    /// among the `wanted` largest, or at least as large as `least`, have converged, and locks these
    /// eigenvalues. If one eigenvalue is close enough to the shift to hide the digits of the
    /// others, returns the distance of the next eigenvalue from the shift.
    fn run(
        &mut self,
        starts: &[Vec<f64>],
        (wanted, least, inverse): (usize, f64, &mut Inverse),
        locked: &mut Locked,
    ) -> Result<Option<f64>, Failure> {
        let n = starts.first().map_or(0, Vec::len);
        let mut space = Krylov::new(starts, (&locked.basis, inverse.matrix.scales), n);
        let has_mass = inverse.matrix.pencil.mass.is_some();
        let (is_first, mut next_look) = (least == 0.0 && locked.values.is_empty(), wanted + 2);
        if is_first {
            next_look = next_look.max(self.previous.products);
        }
        // The first images of the previous eigenvectors reveal an eigenvalue that hides the others.
        let is_warm = is_first && starts.len() > LANES && !self.previous.vectors.is_empty();
        while !space.vectors.is_empty() {
            space.grow(&mut |block| inverse.apply(block));
            let is_due = space.is_complete() || space.images >= next_look;
            let is_early = is_warm && space.images <= LANES;
            if !is_due && !is_early {
                continue;
            }
            let mut ritz = space.ritz()?;
            let open = ritz.candidates(wanted, least);
            if open.is_empty() {
                return Ok(None);
            }
            let first = ritz.size(ritz.order[0]);
            let next = ritz.order.get(1).map_or(first, |k| ritz.size(*k));
            if wanted > 1 && next < ALONE * first {
                return Ok(Some(next.recip()));
            }
            if !is_due {
                continue;
            }
            next_look = space.images + (space.images / 8).max(LANES);
            let allowed = |size: f64| (ROUNDING * first).max(CONVERGED * size);
            let is_within =
                |share: f64| open.iter().all(|k| ritz.errors[*k] <= share * allowed(ritz.size(*k)));
            if is_within(1.0) {
                let last = ritz.order[wanted.min(ritz.order.len()) - 1];
                let is_lost = has_mass && ritz.size(last) < INFINITE * first;
                if is_first && is_lost && next < ALONE_OF_PENCIL * first {
                    return Ok(Some(next.recip()));
                }
                let Krylov { vectors, images, .. } = space;
                if is_first {
                    let spare = if is_within(SLACK) { LANES.max(images / EARLIER) } else { 0 };
                    self.previous.products = images.saturating_sub(spare);
                }
                if has_mass {
                    ritz.clear_zeros();
                }
                let others = ritz.order.iter().filter(|k| !open.contains(k));
                let others = others.take(WARM.saturating_sub(open.len()));
                ritz.lock(&open, others, (&vectors, locked));
                return Ok(None);
            }
            if space.is_complete() {
                return Err(Failure::Eigenvalues(NEAREST));
            }
        }
        Ok(None)
    }
}

/// Returns the largest multiplicity among the given eigenvalues that are not zero.
fn most_repeated(values: &[c64]) -> usize {
    let same = |a: &c64, b: &c64| (*a - *b).norm() <= REPEATED * a.norm();
    let count = |value: &c64| values.iter().filter(|other| same(value, other)).count();
    values.iter().filter(|value| !is_zero(**value)).map(count).max().unwrap_or(0)
}

/// Returns a vector of pseudo-random numbers from −1 to 1, which is the same in every run (G. L. Steele,
/// D. Lea and C. H. Flood, OOPSLA 2014). The vectors of
/// [`generic`](crate::core::linalg::vector::generic) are not used here, because their components are
/// sines and contain only a few eigenvectors of a Laplacian.
fn random(n: usize, seed: usize) -> Vec<f64> {
    let mut state = (seed as u64 + 1).wrapping_mul(0xD1B5_4A32_D192_ED03);
    let mut next = || {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (state ^ (state >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (mixed ^ (mixed >> 31)) as i64 as f64 / 2.0_f64.powi(63)
    };
    (0..n).map(|_| next()).collect()
}

/// Returns false only if the pivots show that a matrix, which a diagonal scaling makes symmetric, has
/// no eigenvalue above `edge`.
fn may_have_values_above(inverse: &mut Inverse, edge: f64) -> bool {
    let below = inverse.move_to(edge).ok().and_then(|()| inverse.count_below());
    below != Some(inverse.matrix.size())
}

/// All eigenvalues inside a circle about the shift.
struct Circle {
    /// The eigenvalues, starting with the rightmost.
    spectrum: Spectrum,
    center: f64,
    radius: f64,
}

impl Circle {
    /// Returns the number of eigenvalues with a positive real part.
    fn unstable(&self) -> usize {
        self.spectrum.iter().filter(|l| l.0 > 0.0).count()
    }

    /// Whether the rectangle with the given corner lies inside the circle.
    fn contains(&self, corner: (f64, f64)) -> bool {
        (corner.0 - self.center).hypot(corner.1) < self.radius
    }
}

/// The result of a search for the eigenvalues nearest to a shift.
enum Found {
    All(Circle),
    /// An eigenvalue lies at the shift and hides the others; the next eigenvalue has this distance
    /// from the shift.
    Alone(f64),
}
