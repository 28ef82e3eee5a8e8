//! Homoclinic orbits of a vector field, as boundary-value problems with projection conditions (W.-J.
//! Beyn, *IMA J. Numer. Anal.* 10, 1990).

mod guess;
mod leading;
mod saddle;

pub(super) use guess::{Cycle, from_cycle, from_saved};

use super::erased::{
    EndFunctions, Equations, ErasedProblem, Number, Residual, WatchNumber, Watches,
};
use super::terms::{Ends, Monitor, Shape, Watched};
use crate::core::problem::{FieldIn, FieldRef, Pace};
use crate::core::scalar::{Chunk, Scalar};
use crate::core::system::{HOMOCLINIC_GAP, HOMOCLINIC_RATES, HOMOCLINIC_TESTS};
use leading::Side;
use saddle::{Saddle, jacobian};

/// A quantity that is recorded for a homoclinic orbit, in addition to the extrema of its states.
#[derive(Clone, Copy)]
enum Recorded {
    /// The gap: the distance of the orbit's end from the stable manifold.
    Gap,
    /// The real part of the leading eigenvalue in the stable or unstable subspace.
    Rate(Side),
    /// The saddle quantity: the sum of the real parts of the leading stable and the leading
    /// unstable eigenvalue.
    Quantity,
    /// The squared difference of the two leading eigenvalues in the stable or unstable subspace.
    Discriminant(Side),
    /// The component of the deviation at the orbit's end along the leading eigenvector, divided by
    /// the distance from the equilibrium.
    Share(Side),
}

/// The number of extra unknowns that precede the coordinates of the equilibrium: the time `T`, the
/// share `φ` of `T` that has elapsed in the middle of the mesh, and the gap `g`.
const BEFORE_PLACE: usize = 3;

/// A homoclinic problem: orbits that leave an equilibrium `x₀` along its unstable manifold and return
/// near the equilibrium,
///
/// ```text
///     x' = f(x, p),  0 ≤ t ≤ T,    f(x₀, p) = 0
///     L_s (x(0) − x₀) = 0,         |R_u (x(0) − x₀)| = ε₀
///     L_u (x(T) − x₀) = ε₁ g e₁,   |R_s (x(T) − x₀)| = ε₁
/// ```
///
/// The rows of `L_s` and `L_u` span the left invariant subspaces of `f_x(x₀, p)` for the stable and the
/// unstable eigenvalues, respectively, so that the orbit begins on the linearised unstable manifold. If
/// the *gap* `g` vanishes, the orbit ends on the linearised stable manifold and is homoclinic (W.-J.
/// Beyn, *IMA J. Numer. Anal.* 10 (1990)). The invariant subspaces are graphs over initial frames `C,
/// B`, continued by Riccati equations (J. W. Demmel, L. Dieci and M. J. Friedman, *SIAM J. Sci.
/// Comput.* 22 (2000)):
///
/// ```text
///     L = Cᵀ + Z Bᵀ,    N = B − C Z,    L f_x(x₀, p) N = 0
/// ```
///
/// Deviations are in units of the extents of the orbit (the ranges of its states), and `R_u` and
/// `R_s` give the components of a deviation along the eigenvectors. The parameter value that the
/// condition `g = 0` determines has truncation errors of order `ε₀^(2+r)` and `ε₁^(2+1/r)`, where
/// `r` is the absolute value of the ratio of the leading stable and unstable eigenvalues `λ_s` and
/// `λ_u`.
///
/// The excursion is often short compared with `T`, and the times that the orbit spends near the
/// equilibrium before and after the excursion change along a branch. On a mesh with breakpoints at
/// fixed fractions of `T`, the excursion would move by more than the width of its fronts. A change of
/// time [`Pace`] keeps the excursion in the middle of the mesh: in the middle of the mesh, the share
/// `φ` of `T` has elapsed; the middle is the centre of the squared speed,
///
/// ```text
///     ∫ (s − ½) |x'|² dt = 0,    t = T θ(s),    0 ≤ s ≤ 1
/// ```
///
/// The unknowns are the states, the time `T`, the share `φ` of `T` that has elapsed in the middle
/// of the mesh, the gap `g`, the equilibrium `x₀`, and the matrices `Z` of both subspaces.
pub(in crate::core) struct HomoclinicOrbit {
    /// The problem of the cycles near the homoclinic orbit.
    cycles: ErasedProblem,
    parameters: usize,
    saddle: Saddle,
    /// The distances of both ends of the orbit from the equilibrium
    /// ([`Frame::distance`](saddle::Frame::distance)).
    radii: [f64; 2],
}

/// The parameters and extra unknowns `q` of a homoclinic orbit, grouped by meaning.
struct Parts<'q, T> {
    /// The entries of `q` that the problem of cycles also uses: the parameters and the time.
    of_cycles: &'q [T],
    pace: Pace<T>,
    gap: T,
    place: &'q [T],
    /// The matrices `Z` of the two subspaces.
    outgoing: &'q [T],
    incoming: &'q [T],
}

impl HomoclinicOrbit {
    fn parts<'q, T: Copy>(&self, q: &'q [T]) -> Parts<'q, T> {
        let (of_cycles, rest) = q.split_at(self.parameters + 1);
        let pace = Pace { duration: of_cycles[self.parameters], share: rest[0] };
        let (place, subspaces) = rest[2..].split_at(self.saddle.dimension());
        let (outgoing, incoming) = subspaces.split_at(self.saddle.outgoing.coordinates());
        Parts { of_cycles, pace, gap: rest[1], place, outgoing, incoming }
    }

    /// Returns the recorded quantities, with their names; their positions are the indices of the
    /// [`of_ends_in`](EndFunctions::of_ends_in) functions.
    fn recorded(&self) -> Vec<(&'static str, Recorded)> {
        let [unstable, stable, quantity] = HOMOCLINIC_RATES;
        let mut all = vec![
            (HOMOCLINIC_GAP, Recorded::Gap),
            (unstable, Recorded::Rate(Side::Outgoing)),
            (stable, Recorded::Rate(Side::Incoming)),
            (quantity, Recorded::Quantity),
        ];
        let Saddle { outgoing, incoming, .. } = &self.saddle;
        let [_, stable, unstable, stable_share, unstable_share] = HOMOCLINIC_TESTS.map(|it| it.0);
        if incoming.basis.len() > 1 {
            all.push((stable, Recorded::Discriminant(Side::Incoming)));
            all.push((stable_share, Recorded::Share(Side::Incoming)));
        }
        if outgoing.basis.len() > 1 {
            all.push((unstable, Recorded::Discriminant(Side::Outgoing)));
            all.push((unstable_share, Recorded::Share(Side::Outgoing)));
        }
        all
    }

    /// Returns the deviation of a state from the equilibrium, in units of the extents (the ranges
    /// of the states).
    fn deviation<T: Scalar>(&self, x: &[T], place: &[T]) -> Vec<T> {
        let both = x.iter().zip(place).zip(&self.saddle.sizes);
        both.map(|((x, place), size)| (*x - *place) / *size).collect()
    }

    fn conditions<T: Number>(&self, ends: Ends<T>, q: &[T], b: &mut [T]) {
        let Parts { of_cycles, gap, place, outgoing, incoming, .. } = self.parts(q);
        let (n, saddle) = (place.len(), &self.saddle);
        let field = T::residual(&*self.cycles).on_segment(0, of_cycles);
        let (f, matrix) = jacobian(&field, place, of_cycles, saddle);
        b[..n].copy_from_slice(&f);
        let (mut at, deviations) = (n, [ends.start, ends.end].map(|x| self.deviation(x, place)));
        let subspaces = [(&saddle.outgoing, outgoing), (&saddle.incoming, incoming)];
        for (k, (frame, z)) in subspaces.into_iter().enumerate() {
            let (deviation, radius) = (&deviations[k], self.radii[k]);
            b[at] = frame.distance(deviation) / radius - 1.0;
            let projected = frame.project(z, deviation);
            let (on, rest) = b[at + 1..].split_at_mut(projected.len());
            on.iter_mut().zip(projected).for_each(|(b, value)| *b = value / radius.abs());
            if k == 1 {
                on[0] -= gap;
            }
            frame.invariance(z, &matrix, rest);
            at += 1 + on.len() + frame.coordinates();
        }
    }
}

impl<T: Number> Residual<T> for HomoclinicOrbit {
    fn on_segment<'a>(&'a self, segment: usize, q: &'a [T]) -> FieldRef<'a, T> {
        let Parts { of_cycles, pace, .. } = self.parts(q);
        let field = T::residual(&*self.cycles).on_segment(segment, of_cycles);
        FieldRef { numbers: field.numbers.min(of_cycles.len()), pace: Some(pace), ..field }
    }

    fn duration_in(&self, _segment: usize, q: &[T]) -> T {
        q[self.parameters]
    }

    fn boundary_in(&self, ends: Ends<T>, q: &[T], b: &mut [T]) {
        self.conditions(ends, q, b);
    }

    /// Computes the distance of a mesh point from the middle of the mesh, weighted by the squared
    /// speed.
    fn integrand_in(&self, segment: usize, t: T, x: &[T], q: &[T], g: &mut [T]) {
        let Parts { of_cycles, pace, .. } = self.parts(q);
        let Saddle { sizes, rate, .. } = &self.saddle;
        let mut f = vec![T::zero(); x.len()];
        T::residual(&*self.cycles).on_segment(segment, of_cycles).slope(t, x, of_cycles, &mut f);
        let parts = f.iter().zip(sizes).map(|(f, size)| *f / (size * rate));
        let square = parts.fold(T::zero(), |sum, part| sum + part * part);
        g[0] = (t / pace.duration - 0.5) * square * pace.rate(t) * *rate;
    }
}

impl<T: WatchNumber> Watches<T> for HomoclinicOrbit {
    fn watch_in(&self, watched: Watched, t: T, x: &[T], q: &[T]) -> T {
        T::watches(&*self.cycles).watch_in(watched, t, x, &q[..=self.parameters])
    }
}

/// Computes a recorded quantity; `None` if the eigenvalue iteration fails.
fn number_of<T: Number>(
    orbit: &HomoclinicOrbit,
    recorded: Recorded,
    ends: Ends<T>,
    q: &[T],
) -> Option<T> {
    let Parts { of_cycles, gap, place, .. } = orbit.parts(q);
    let field = T::residual(&*orbit.cycles).on_segment(0, of_cycles);
    let (_, matrix) = jacobian(&field, place, of_cycles, &orbit.saddle);
    let leading = orbit.saddle.leading(&matrix)?;
    let rate = orbit.saddle.rate;
    Some(match recorded {
        Recorded::Gap => gap,
        Recorded::Rate(side) => leading.rate(side)? * rate,
        Recorded::Quantity => {
            (leading.rate(Side::Outgoing)? + leading.rate(Side::Incoming)?) * rate
        }
        Recorded::Discriminant(side) => leading.discriminant(side)? * (rate * rate),
        Recorded::Share(side) => {
            let end = usize::from(side == Side::Incoming);
            let deviation = orbit.deviation([ends.start, ends.end][end], place);
            let reference = &orbit.saddle.directions[end];
            leading.component(side, reference, &deviation)? / orbit.radii[end].abs()
        }
    })
}

/// Computes a recorded quantity, given by its index; NaN if the eigenvalue iteration fails.
fn of_ends<T: Number>(orbit: &HomoclinicOrbit, function: usize, ends: Ends<T>, q: &[T]) -> T {
    let recorded = orbit.recorded().into_iter().nth(function);
    let value = recorded.and_then(|(_, recorded)| number_of(orbit, recorded, ends, q));
    value.unwrap_or_else(|| T::constant(f64::NAN))
}

impl EndFunctions<f64> for HomoclinicOrbit {
    fn of_ends_in(&self, function: usize, ends: Ends<f64>, q: &[f64]) -> f64 {
        of_ends(self, function, ends, q)
    }
}

impl EndFunctions<Chunk> for HomoclinicOrbit {
    fn of_ends_in(&self, function: usize, ends: Ends<Chunk>, q: &[Chunk]) -> Chunk {
        of_ends(self, function, ends, q)
    }
}

impl Equations for HomoclinicOrbit {
    fn segments(&self) -> Vec<Vec<String>> {
        self.cycles.segments()
    }

    fn parameters(&self) -> Vec<String> {
        self.cycles.parameters()
    }

    fn shape(&self) -> Shape {
        Shape::BoundaryValues
    }

    /// Returns the names of the extra unknowns, which contain spaces and therefore differ from all
    /// names of states.
    fn extras(&self) -> Vec<String> {
        let states = self.cycles.segments().swap_remove(0);
        let place = states.iter().map(|state| format!("{state} at rest"));
        let count = self.saddle.outgoing.coordinates() + self.saddle.incoming.coordinates();
        let subspaces = (1..=count).map(|k| format!("subspace {k}"));
        ["excursion time", "share of time", "homoclinic gap"]
            .map(String::from)
            .into_iter()
            .chain(place)
            .chain(subspaces)
            .collect()
    }

    fn integrals(&self) -> usize {
        1
    }

    /// Returns the monitors: the time from one end of the orbit to the other, the recorded
    /// quantities, and the extrema that are also monitored on cycles.
    fn monitors(&self) -> Vec<(String, Monitor)> {
        let own = std::iter::once(("excursion_time".to_string(), Monitor::Duration));
        let recorded = self.recorded().into_iter().enumerate();
        let numbers = recorded.map(|(k, (name, _))| (name.to_string(), Monitor::Ends(k)));
        let extreme = |monitor: &Monitor| {
            matches!(monitor, Monitor::Maximum(_) | Monitor::Minimum(_) | Monitor::Range(_))
        };
        let of_cycles = self.cycles.monitors().into_iter().filter(|(_, it)| extreme(it));
        own.chain(numbers).chain(of_cycles).collect()
    }

    fn scales(&self, _segment: usize, _q: &[f64]) -> Vec<f64> {
        self.saddle.sizes.clone()
    }

    fn extra_scales(&self, _p: &[f64]) -> Vec<f64> {
        let Saddle { sizes, rate, .. } = &self.saddle;
        [&[rate.recip(), 1.0, 1.0], &sizes[..]].concat()
    }

    fn function_scale(&self, segment: usize, function: usize, q: &[f64]) -> f64 {
        self.cycles.function_scale(segment, function, &q[..=self.parameters])
    }

    /// Returns the distance of a state from the equilibrium. Near a focus, the end conditions of
    /// homoclinic orbits need full relative accuracy, although the ends are closer to the equilibrium
    /// than the mesh error, which is relative to the largest states.
    fn size_near(&self, _segment: usize, x: &[f64], q: &[f64]) -> Option<f64> {
        let deviation = self.deviation(x, self.parts(q).place);
        Some(deviation.iter().map(|y| y * y).sum::<f64>().sqrt())
    }

    fn passed(&self, _segment: usize, place: f64, q: &[f64]) -> f64 {
        self.parts(q).pace.passed(place)
    }

    fn longest_step(&self, segment: usize) -> f64 {
        self.cycles.longest_step(segment)
    }
}
