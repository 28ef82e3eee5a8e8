//! Taylor coefficients of equations, from jets or from multilinear derivatives.

use super::System;
use crate::core::failure::{DIFFERENTIABLE, Failure, finite, one_line};
use crate::core::problem::ROOM;
use crate::core::scalar::jet::jet_of;
use crate::core::scalar::{Jet, Space};

/// The arguments `z + W(ξ)` and the parameters `p` as jets.
pub(in crate::core) struct Expansion<'a> {
    space: &'static Space,
    x: &'a [f64],
    terms: &'a [Vec<f64>],
    /// The number of unknowns.
    unknowns: usize,
}

impl<'a> Expansion<'a> {
    /// Creates an expansion about `x`, for a polynomial `W` whose coefficients have the same length
    /// as `z`.
    ///
    /// # Errors
    /// [`Failure::Unsupported`] if the number of coefficients exceeds the capacity of jets.
    pub fn new(
        x: &'a [f64],
        space: &'static Space,
        terms: &'a [Vec<f64>],
    ) -> Result<Self, Failure> {
        jet_of::<ROOM>(space, |_| 0.0).map_err(|cause| Failure::Unsupported(one_line(&cause)))?;
        let unknowns = terms.first().map_or(0, Vec::len);
        Ok(Expansion { space, x, terms, unknowns })
    }

    /// Sets the number of unknowns. If the coefficients of the polynomial are longer than `z`, their
    /// further components are the coefficients of the rates `z'`.
    pub fn of_unknowns(self, unknowns: usize) -> Self {
        Expansion { unknowns, ..self }
    }

    /// Whether the arguments contain the rates of the unknowns.
    pub fn moves(&self) -> bool {
        self.terms.first().is_some_and(|term| term.len() > self.unknowns)
    }

    /// Returns component number `i` of the argument `x = (z, p)`, as a jet; the rates follow `x`.
    pub fn argument(&self, i: usize) -> Jet<ROOM> {
        let Expansion { space, x, terms, unknowns } = self;
        let place = match i.checked_sub(x.len()) {
            Some(rate) => unknowns + rate,
            None if i < *unknowns && !terms.is_empty() => i,
            None => return Jet::constant(x[i]),
        };
        let start = x.get(i).copied().unwrap_or(0.0);
        jet_of(space, |k| if k == 0 { start } else { terms[k][place] })
            .unwrap_or_else(|_| Jet::constant(f64::NAN))
    }

    /// Returns the Taylor coefficients of all equations, whose left-hand sides are given as jets,
    /// in the order of the monomials of the space.
    ///
    /// # Errors
    /// [`Failure`] if a Taylor coefficient is not finite.
    pub fn images(&self, left: &[Jet<ROOM>]) -> Result<Vec<Vec<f64>>, Failure> {
        let of = |k: usize| -> Vec<f64> {
            left.iter().map(|r| r.coefficients().get(k).copied().unwrap_or(0.0)).collect()
        };
        let images: Vec<Vec<f64>> = (0..self.space.len()).map(of).collect();
        let name = |e: usize| format!("a Taylor coefficient of component {e} of the residual");
        images.iter().try_for_each(|image| finite(image, name, DIFFERENTIABLE))?;
        Ok(images)
    }
}

/// The highest order of the directional derivatives that every system supports.
const MOST_ORDER: usize = 3;

/// Computes the Taylor coefficients of `F(z + W(ξ)) = F + F_z[W] + F_zz[W, W]/2 + F_zzz[W, W, W]/6`.
///
/// # Errors
/// [`Failure::Unsupported`] for an order above 3, or the errors of [`System::derivative`].
pub(super) fn by_derivatives<S: System + ?Sized>(
    system: &mut S,
    x: &[f64],
    space: &'static Space,
    terms: &[Vec<f64>],
) -> Result<Vec<Vec<f64>>, Failure> {
    if space.order() > MOST_ORDER {
        let reason = format!("this system supports Taylor coefficients up to order {MOST_ORDER}");
        return Err(Failure::Unsupported(reason));
    }
    let n = system.names().dimension();
    let mut images = vec![vec![0.0; n]; space.len()];
    system.residual(x, &mut images[0])?;
    let present = |(k, term): (usize, &Vec<f64>)| {
        let mut direction = term.clone();
        direction.resize(x.len(), 0.0);
        (k > 0 && term.iter().any(|c| *c != 0.0)).then_some((k, direction))
    };
    let terms: Vec<(usize, Vec<f64>)> = terms.iter().enumerate().filter_map(present).collect();
    let mut value = vec![0.0; n];
    for chosen in choices(terms.len()) {
        let mut exponents = vec![0; space.variables()];
        for &t in &chosen {
            let powers = space.exponents(terms[t].0);
            exponents.iter_mut().zip(powers).for_each(|(sum, power)| *sum += power);
        }
        let Some(monomial) = space.position(&exponents) else { continue };
        let directions: Vec<&[f64]> = chosen.iter().map(|&t| &terms[t].1[..]).collect();
        system.derivative(x, &directions, &mut value)?;
        let factor = repetitions(&chosen);
        images[monomial].iter_mut().zip(&value).for_each(|(sum, v)| *sum += v / factor);
    }
    Ok(images)
}

/// All selections of one to three of `count` terms, in ascending order, with repetitions.
fn choices(count: usize) -> Vec<Vec<usize>> {
    let mut all: Vec<Vec<usize>> = vec![Vec::new()];
    let mut start = 0;
    for _ in 0..MOST_ORDER {
        let end = all.len();
        for k in start..end {
            let last = all[k].last().copied().unwrap_or(0);
            let longer = |t: usize| [&all[k][..], &[t]].concat();
            let next: Vec<Vec<usize>> = (last..count).map(longer).collect();
            all.extend(next);
        }
        start = end;
    }
    all.split_off(1)
}

/// The number of permutations that leave a selection of terms unchanged: the product of the
/// factorials of the multiplicities.
fn repetitions(chosen: &[usize]) -> f64 {
    let (mut product, mut run) = (1.0, 0.0);
    for (k, t) in chosen.iter().enumerate() {
        run = if k > 0 && chosen[k - 1] == *t { run + 1.0 } else { 1.0 };
        product *= run;
    }
    product
}
