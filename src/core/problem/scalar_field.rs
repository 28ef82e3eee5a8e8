//! Vector fields in one scalar type, the form in which integrators evaluate them.
//!
//! A [`VectorField`] is generic over scalar types and cannot be a trait object. If different fields
//! must have a common type, they are used in one scalar type at a time: an integrator with numbers
//! `T` evaluates a field through the interface [`FieldIn`], and [`FieldRef`] refers to one field of
//! a collection through a pointer.

use super::field::VectorField;
use crate::core::failure::OutOfDomain;
use crate::core::scalar::{DualChunk, Scalar};

/// Heuristic: the number of directions in which implicit schemes differentiate in one pass; this
/// number is the width of a vector register. The number of directions affects only the run time.
pub(in crate::core) const WIDTH: usize = 4;
/// A number with derivatives in [`WIDTH`] directions.
pub(in crate::core) type Wide<T> = DualChunk<T, WIDTH>;

/// A vector field in one scalar type, the form in which an integrator with numbers of this type
/// evaluates the field. Every [`VectorField`] implements this trait.
pub trait FieldIn<T: Scalar> {
    /// The type of the same vector field, evaluated with real numbers.
    type Real<'a>: FieldIn<f64>
    where
        Self: 'a;

    /// Returns the same vector field, evaluated with real numbers.
    fn real(&self) -> Self::Real<'_>;

    /// Computes the vector field `f(t, x, p)` and writes it into `f`.
    fn slope(&self, t: T, x: &[T], p: &[T], f: &mut [T]);

    /// Computes the vector field with its derivatives in four directions, for the Jacobians of
    /// implicit schemes.
    fn wide_slope(&self, t: Wide<T>, x: &[Wide<T>], p: &[Wide<T>], f: &mut [Wide<T>]);

    /// Returns an error for states outside the domain of the field.
    fn domain(&self, x: &[f64], p: &[f64]) -> Result<(), OutOfDomain>;

    /// Returns the typical sizes of the states, which are the units of the absolute tolerance; an
    /// empty list if all sizes are 1.
    fn state_scales(&self, p: &[f64]) -> Vec<f64>;

    /// Returns the name of a state, given its index.
    fn state_name(&self, state: usize) -> String;
}

impl<F: VectorField, T: Scalar> FieldIn<T> for F {
    type Real<'a>
        = &'a F
    where
        F: 'a;

    fn real(&self) -> &F {
        self
    }

    #[inline]
    fn slope(&self, t: T, x: &[T], p: &[T], f: &mut [T]) {
        self.field(t, x, p, f);
    }

    #[inline]
    fn wide_slope(&self, t: Wide<T>, x: &[Wide<T>], p: &[Wide<T>], f: &mut [Wide<T>]) {
        self.field(t, x, p, f);
    }

    fn domain(&self, x: &[f64], p: &[f64]) -> Result<(), OutOfDomain> {
        VectorField::domain(self, x, p)
    }

    fn state_scales(&self, p: &[f64]) -> Vec<f64> {
        self.scales(p)
    }

    fn state_name(&self, state: usize) -> String {
        self.names().elements().nth(state).unwrap_or_default()
    }
}

/// The domains of the vector fields in a numbered collection, and the names and sizes of their
/// states.
pub trait Domains {
    /// Returns an error for states outside the domain of one of the fields.
    fn domain_of(&self, index: usize, x: &[f64], p: &[f64]) -> Result<(), OutOfDomain>;

    /// Returns the typical sizes of a field's states; an empty list if all sizes are 1.
    fn scales_of(&self, index: usize, p: &[f64]) -> Vec<f64>;

    /// Returns the names of a field's states.
    fn states_of(&self, index: usize) -> Vec<String>;
}

/// A numbered collection of vector fields in one scalar type: the fields on the segments of a
/// boundary-value problem, or in the modes of a hybrid system.
pub trait Fields<T>: Domains {
    /// Computes the vector field with the given index at `(t, x, p)` and writes it into `f`.
    fn field_of(&self, index: usize, t: T, x: &[T], p: &[T], f: &mut [T]);

    /// Projects a state onto the invariant surface of one of the fields; the default implementation
    /// is for fields without such a surface, and leaves the state unchanged.
    fn constrain_of(&self, _index: usize, _t: T, _x: &mut [T], _p: &[T]) {}
}

/// Adds a term to a field; the term attracts motion to the field's invariant surface at a given
/// rate.
fn attract<T: Scalar>(
    fields: &dyn Fields<T>,
    (index, rate): (usize, T),
    (t, x, p): (T, &[T], &[T]),
    f: &mut [T],
) {
    let mut on_surface = x.to_vec();
    fields.constrain_of(index, t, &mut on_surface, p);
    for ((f, x), on_surface) in f.iter_mut().zip(x).zip(&on_surface) {
        *f += (*on_surface - *x) * rate;
    }
}

/// A numbered collection of vector fields in one scalar type, and in the same type with derivatives,
/// for explicit and implicit schemes.
pub trait WideFields<T>: Fields<T> + Fields<Wide<T>> {}

impl<T, F: Fields<T> + Fields<Wide<T>>> WideFields<T> for F {}

/// A transformation of time for motions of duration `T`: the original time at the transformed time `T s` is
/// `T θ(s)`, with `θ(s) = φ s/((1 − φ)(1 − s) + φ s)`. At `s = 1/2`, the fraction `φ` of the duration has
/// passed.
#[derive(Clone, Copy, Debug)]
pub struct Pace<T> {
    /// The duration `T`.
    pub duration: T,
    /// The fraction `φ` of the duration that has passed at `s = 1/2`; between 0 and 1.
    pub share: T,
}

impl<T: Scalar> Pace<T> {
    /// Returns `θ(s)`.
    pub(in crate::core) fn passed(self, s: T) -> T {
        self.share * s / self.divisor(s)
    }

    /// Returns the value of `s` at which `θ(s)` equals a given fraction of the duration.
    pub(in crate::core) fn place(self, passed: T) -> T {
        Pace { share: T::one() - self.share, ..self }.passed(passed)
    }

    /// Returns `θ'(s)` at the transformed time `T s`.
    pub(in crate::core) fn rate(self, t: T) -> T {
        let divisor = self.divisor(t / self.duration);
        self.share * (T::one() - self.share) / (divisor * divisor)
    }

    fn divisor(self, s: T) -> T {
        (T::one() - self.share) * (T::one() - s) + self.share * s
    }

    fn map<S>(self, convert: impl Fn(T) -> S) -> Pace<S> {
        Pace { duration: convert(self.duration), share: convert(self.share) }
    }
}

/// Multiplies an autonomous vector field by the rate of a transformation of time.
fn at_pace<T: Scalar>(pace: Pace<T>, t: T, f: &mut [T]) {
    let rate = pace.rate(t);
    f.iter_mut().for_each(|f| *f *= rate);
}

/// One vector field of a collection, together with the value of the collection's time at which the
/// field's own time is zero.
#[derive(Clone, Copy)]
pub struct FieldRef<'a, T: Scalar> {
    /// The collection.
    pub fields: &'a dyn Fields<T>,
    /// The same collection of fields, evaluated with derivatives; `None` if implicit schemes are
    /// not supported.
    pub wide: Option<&'a dyn Fields<Wide<T>>>,
    /// The same collection of fields, evaluated with real numbers.
    pub real: &'a dyn WideFields<f64>,
    /// The index of the field in the collection.
    pub index: usize,
    /// The value of the collection's time at which the field's own time is zero.
    pub start: T,
    /// The number `k` such that the vector field depends only on the first `k` parameters.
    pub numbers: usize,
    /// The rate of attraction to the field's invariant surface; `None` if no attraction is added,
    /// in which case the field preserves the distance from the surface.
    pub attraction: Option<T>,
    /// The transformation of time that is applied to an autonomous field.
    pub pace: Option<Pace<T>>,
}

impl<'a, T: Scalar> FieldRef<'a, T> {
    /// Creates a reference to a vector field that can be evaluated in all scalar types.
    pub(in crate::core) fn of<F: WideFields<T> + WideFields<f64>>(field: &'a F) -> Self {
        let start = T::zero();
        let (wide, attraction, pace) = (Some(field as _), None, None);
        FieldRef { fields: field, wide, real: field, index: 0, start, numbers: 0, attraction, pace }
    }

    /// Returns the parameters on which the field depends.
    #[inline]
    fn own<'p, S>(&self, p: &'p [S]) -> &'p [S] {
        &p[..self.numbers.min(p.len())]
    }
}

impl<T: Scalar> FieldIn<T> for FieldRef<'_, T> {
    type Real<'a>
        = FieldRef<'a, f64>
    where
        Self: 'a;

    fn real(&self) -> FieldRef<'_, f64> {
        let FieldRef { real, index, numbers, .. } = *self;
        let (start, attraction) = (self.start.real(), self.attraction.map(|rate| rate.real()));
        let pace = self.pace.map(|pace| pace.map(|value| value.real()));
        FieldRef { fields: real, wide: Some(real), real, index, start, numbers, attraction, pace }
    }

    #[inline(always)]
    fn slope(&self, t: T, x: &[T], p: &[T], f: &mut [T]) {
        let (t, p) = (self.start + t, self.own(p));
        self.fields.field_of(self.index, t, x, p, f);
        if let Some(rate) = self.attraction {
            attract(self.fields, (self.index, rate), (t, x, p), f);
        }
        if let Some(pace) = self.pace {
            at_pace(pace, t, f);
        }
    }

    #[inline]
    fn wide_slope(&self, t: Wide<T>, x: &[Wide<T>], p: &[Wide<T>], f: &mut [Wide<T>]) {
        match self.wide {
            Some(wide) => {
                let (t, p) = (Wide::of(self.start) + t, self.own(p));
                wide.field_of(self.index, t, x, p, f);
                if let Some(rate) = self.attraction {
                    attract(wide, (self.index, Wide::of(rate)), (t, x, p), f);
                }
                if let Some(pace) = self.pace {
                    at_pace(pace.map(Wide::of), t, f);
                }
            }
            // NaN makes the implicit step fail.
            None => f.fill(Wide::of(T::constant(f64::NAN))),
        }
    }

    fn domain(&self, x: &[f64], p: &[f64]) -> Result<(), OutOfDomain> {
        self.fields.domain_of(self.index, x, self.own(p))
    }

    fn state_scales(&self, p: &[f64]) -> Vec<f64> {
        self.fields.scales_of(self.index, self.own(p))
    }

    fn state_name(&self, state: usize) -> String {
        self.fields.states_of(self.index).swap_remove(state)
    }
}
