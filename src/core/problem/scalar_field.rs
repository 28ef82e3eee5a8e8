//! Vector fields in one scalar type, as flows evaluate them.
//!
//! A [`VectorField`] is generic over scalars and cannot be a trait object. Where fields must share a
//! type, they are used in one scalar at a time: [`FieldIn`] is the interface for a flow of numbers
//! `T`, and [`FieldRef`] refers to one field of a collection through a pointer.

use super::field::VectorField;
use crate::core::failure::OutOfDomain;
use crate::core::scalar::{DualChunk, Scalar};

/// (H) The number of directions that implicit schemes differentiate in one pass: the width of a
/// vector register. The number affects only the run time.
pub(in crate::core) const WIDTH: usize = 4;
/// Numbers with derivatives in [`WIDTH`] directions.
pub(in crate::core) type Wide<T> = DualChunk<T, WIDTH>;

/// A vector field in one scalar type, as a flow of such numbers evaluates it. Implemented by every
/// [`VectorField`].
pub trait FieldIn<T: Scalar> {
    /// The same field in real numbers.
    type Real<'a>: FieldIn<f64>
    where
        Self: 'a;

    /// The same field in real numbers.
    fn real(&self) -> Self::Real<'_>;

    /// Computes the field `f(t, x, p)` and writes it into `f`.
    fn slope(&self, t: T, x: &[T], p: &[T], f: &mut [T]);

    /// Computes the field with four derivatives, for the Jacobians of implicit schemes.
    fn wide_slope(&self, t: Wide<T>, x: &[Wide<T>], p: &[Wide<T>], f: &mut [Wide<T>]);

    /// Rejects states outside the domain of the field.
    fn domain(&self, x: &[f64], p: &[f64]) -> Result<(), OutOfDomain>;

    /// Typical sizes of the states, used as units of the absolute tolerance; empty if all are 1.
    fn state_scales(&self, p: &[f64]) -> Vec<f64>;

    /// The name of a state.
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

/// The domains of numbered fields, and the names and sizes of their states.
pub trait Domains {
    /// Rejects states outside the domain of a field.
    fn domain_of(&self, index: usize, x: &[f64], p: &[f64]) -> Result<(), OutOfDomain>;

    /// Typical sizes of a field's states; empty if all are 1.
    fn scales_of(&self, index: usize, p: &[f64]) -> Vec<f64>;

    /// The names of a field's states.
    fn states_of(&self, index: usize) -> Vec<String>;
}

/// Numbered vector fields in one scalar type: the fields of a boundary-value problem's segments, or
/// of a hybrid system's modes.
pub trait Fields<T>: Domains {
    /// Computes one of the fields at `(t, x, p)` and writes it into `f`.
    fn field_of(&self, index: usize, t: T, x: &[T], p: &[T], f: &mut [T]);

    /// Projects a state onto the surface that is invariant under one of the fields; by default motion
    /// is free, and the state is unchanged.
    fn constrain_of(&self, _index: usize, _t: T, _x: &mut [T], _p: &[T]) {}
}

/// Adds to a field the attraction, at a given rate, to its invariant surface.
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

/// Numbered vector fields in one scalar type and with derivatives, for explicit and implicit schemes.
pub trait WideFields<T>: Fields<T> + Fields<Wide<T>> {}

impl<T, F: Fields<T> + Fields<Wide<T>>> WideFields<T> for F {}

/// A change of time for motions of a duration `T`: the time that has passed is `T θ(s)` at the changed time
/// `T s`, with `θ(s) = φ s/((1 − φ)(1 − s) + φ s)`. The share `φ` of the duration has passed at `s = 1/2`.
#[derive(Clone, Copy, Debug)]
pub struct Pace<T> {
    /// The duration `T`.
    pub duration: T,
    /// The share `φ`, between 0 and 1.
    pub share: T,
}

impl<T: Scalar> Pace<T> {
    /// Returns `θ(s)`.
    pub(in crate::core) fn passed(self, s: T) -> T {
        self.share * s / self.divisor(s)
    }

    /// Returns the `s` at which `θ(s)` is a given part of the duration.
    pub(in crate::core) fn place(self, passed: T) -> T {
        Pace { share: T::one() - self.share, ..self }.passed(passed)
    }

    /// Returns `θ'(s)` at the changed time `T s`.
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

/// Multiplies an autonomous field by the rate of a change of time.
fn at_pace<T: Scalar>(pace: Pace<T>, t: T, f: &mut [T]) {
    let rate = pace.rate(t);
    f.iter_mut().for_each(|f| *f *= rate);
}

/// One field of a collection, with the time at which its own time is zero.
#[derive(Clone, Copy)]
pub struct FieldRef<'a, T: Scalar> {
    /// The collection.
    pub fields: &'a dyn Fields<T>,
    /// The same collection with derivatives, if implicit schemes are supported.
    pub wide: Option<&'a dyn Fields<Wide<T>>>,
    /// The same collection in real numbers.
    pub real: &'a dyn WideFields<f64>,
    /// The index of the field.
    pub index: usize,
    /// The time of the collection at which the field's own time is zero.
    pub start: T,
    /// The number of leading parameters on which the field depends.
    pub numbers: usize,
    /// The rate of attraction to the field's invariant surface; `None` for the field alone, which
    /// preserves the distance from the surface.
    pub attraction: Option<T>,
    /// The change of time in which an autonomous field is stated.
    pub pace: Option<Pace<T>>,
}

impl<'a, T: Scalar> FieldRef<'a, T> {
    /// Creates a reference to a field that exists in all scalar types.
    pub(in crate::core) fn of<F: WideFields<T> + WideFields<f64>>(field: &'a F) -> Self {
        let start = T::zero();
        let (wide, attraction, pace) = (Some(field as _), None, None);
        FieldRef { fields: field, wide, real: field, index: 0, start, numbers: 0, attraction, pace }
    }

    /// The parameters on which the field depends.
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
