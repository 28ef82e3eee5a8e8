//! The smooth map and the discontinuity map as Taylor polynomials.

use super::chart::{Chart, Place, REACHED, Source};
use super::error::GrazingError;
use super::point::{Surface, TOUCHES};
use crate::core::hybrid::{EventNumber, FieldNumber, GuardNumber};
use crate::core::scalar::{Jet, Polynomial, Scalar};
use num_dual::Dual;

/// The polynomials of `P_smooth` in the coordinates, and the penetration `−h` on the section.
#[derive(Clone, Debug)]
pub(super) struct Smooth {
    pub images: Vec<Polynomial>,
    pub penetration: Polynomial,
}

/// The polynomials of `D` in `y` and the other coordinates, and the normal coordinate of the
/// virtual point.
#[derive(Clone, Debug)]
pub(super) struct Discontinuity {
    pub images: Vec<Polynomial>,
    pub entry: Polynomial,
    /// The leading power of `y` in the difference between `D` and the identity; `None` if `D` is
    /// the identity up to the order of the polynomials.
    pub power: Option<usize>,
}

/// Discretisation: a coefficient counts as an error of the flow if its magnitude, relative to the
/// scale and the largest coefficient, is below this value: the default tolerance of 1e-13, divided
/// twice by `y`, results in 1e-10 or less.
const NEGLIGIBLE: f64 = 1e-9;

/// Computes one of the polynomial maps with jets that are large enough for the given order.
macro_rules! in_chart {
    ($source:expr, $order:expr, $map:ident) => {{
        let space = $source.space($order)?;
        match space.len() {
            ..=128 => Chart::<128>::of(*$source, space)?.$map(),
            _ => Chart::<1024>::of(*$source, space)?.$map(),
        }
    }};
}

impl Source<'_> {
    /// Returns the scales of all variables: coordinates, then parameters.
    fn sizes(&self) -> Vec<f64> {
        let parameters = self.parameters.iter().map(|_| 1.0);
        self.section.scales.iter().copied().chain(parameters).collect()
    }

    /// Returns the scale of the grazed guard.
    fn guard_scale(&self) -> f64 {
        self.point.guard_scale(self.system)
    }

    /// Returns the scale of `y`.
    fn depth(&self) -> f64 {
        self.guard_scale().sqrt()
    }

    pub fn smooth(&self) -> Result<Smooth, GrazingError> {
        in_chart!(self, self.settings.order, smooth)
    }

    pub fn discontinuity(&self) -> Result<Discontinuity, GrazingError> {
        // The division by y costs one order.
        in_chart!(self, self.settings.order + 1, discontinuity)
    }
}

impl<const C: usize> Chart<'_, C>
where
    Jet<C>: EventNumber,
    Dual<Jet<C>>: FieldNumber + GuardNumber,
    Dual<Dual<Jet<C>>>: GuardNumber,
{
    /// Converts jets whose variables are in units of the given sizes to polynomials.
    fn polynomial(&self, jet: &Jet<C>, sizes: &[f64]) -> Result<Polynomial, GrazingError> {
        let space = self.source.space(self.source.settings.order)?;
        Ok(Polynomial::of(space, jet).in_sizes(sizes))
    }

    fn smooth(mut self) -> Result<Smooth, GrazingError> {
        let point = self.source.point;
        let mut place = self.on_section(&self.deviations);
        let penetration = -Surface::Guard(point.guard).value(self.at(&place));
        let legs = &point.legs;
        for (k, (leg, duration)) in legs.iter().enumerate() {
            if *duration != 0.0 {
                self.advance(&mut place, (*duration).into(), true)?;
            }
            match (legs.get(k + 1), leg.exit) {
                (Some((next, _)), Some(guard)) => {
                    self.land(&mut place, Surface::Guard(guard))?;
                    self.pass(&mut place, guard, next.mode);
                }
                _ => self.land(&mut place, Surface::Turning(point.guard))?,
            }
        }
        let (images, sizes) = (self.deviations_of(&place, point.periods), self.source.sizes());
        let polynomial = |jet: &Jet<C>| self.polynomial(jet, &sizes);
        let images = images.iter().map(polynomial).collect::<Result<_, _>>()?;
        Ok(Smooth { images, penetration: polynomial(&penetration)? })
    }

    fn discontinuity(mut self) -> Result<Discontinuity, GrazingError> {
        let (point, normal) = (self.source.point, self.source.section.normal_coordinate());
        let (mut sizes, depth) = (self.source.sizes(), self.source.depth());
        let y = std::mem::replace(&mut self.deviations[normal], Jet::from(0.0));
        let y = y * (depth / sizes[normal]);
        sizes[normal] = depth;
        let mut place = self.at_depth(&self.deviations, -(y * y));
        let entry = self.deviations_of(&place, 0)[normal];
        let backwards = -(2.0 / self.source.section.curvature).sqrt();
        self.move_onto(&mut place, point.guard, y, backwards)?;
        let mut guard = point.guard;
        for leg in &point.following {
            self.pass(&mut place, guard, leg.mode);
            if let Some(exit) = leg.exit {
                match self.back_on(&place, exit) {
                    Some(time) => self.move_onto(&mut place, exit, y, time)?,
                    None => self.land(&mut place, Surface::Guard(exit))?,
                }
                guard = exit;
            }
        }
        self.pass(&mut place, guard, point.mode);
        self.land(&mut place, Surface::Turning(point.guard))?;
        let polynomial = |jet: &Jet<C>| self.polynomial(jet, &sizes);
        let images = self.deviations_of(&place, 0);
        let power = self.leading_power(&images, &entry)?;
        let images = images.iter().map(polynomial).collect::<Result<Vec<_>, _>>()?;
        let entry = polynomial(&entry)?;
        let unchanged = |powers: &[u8]| {
            powers[normal] > 0 && power.is_none_or(|power| usize::from(powers[normal]) < power)
        };
        // Rounding errors there would be divided by y.
        let exact = |(i, image): (usize, Polynomial)| {
            image.with(|powers, c| match unchanged(powers) {
                true if i == normal => entry.coefficient(powers),
                true => 0.0,
                false => c,
            })
        };
        let images = images.into_iter().enumerate().map(exact).collect();
        Ok(Discontinuity { images, entry, power })
    }

    /// Returns the lowest power of `y` in the difference between the images under `D` and the
    /// virtual points.
    fn leading_power(
        &self,
        images: &[Jet<C>],
        entry: &Jet<C>,
    ) -> Result<Option<usize>, GrazingError> {
        let Source { section, settings, .. } = self.source;
        let normal = section.normal_coordinate();
        let space = self.source.space(settings.order)?;
        let differs = |powers: &&[u8]| {
            images.iter().zip(&section.scales).enumerate().any(|(i, (image, scale))| {
                let virtual_point = if i == normal { entry.coefficient(powers) } else { 0.0 };
                let difference = image.coefficient(powers) - virtual_point;
                difference.abs() > NEGLIGIBLE * scale.max(image.size())
            })
        };
        let powers = (0..space.len()).map(|k| space.exponents(k));
        let of_y = powers.filter(|powers| powers[normal] > 0).filter(differs);
        Ok(of_y.map(|powers| usize::from(powers[normal])).min())
    }

    /// Returns the time `σ` in units of `y`, to leading order, after which motion returns to a
    /// surface that it has just left at a rate of order `y`: for example, the time during which a
    /// soft stop is compressed. Returns `None` for a surface that motion approaches at a rate of
    /// order 1.
    fn back_on(&self, place: &Place<Jet<C>>, guard: usize) -> Option<f64> {
        let slow = TOUCHES * self.source.guard_scale() / self.scale;
        let rate = Surface::Turning(guard).moving(self.at(place));
        let of_y = rate.re.divided_by(self.source.section.normal_coordinate()).real();
        let curvature = rate.eps.real();
        (rate.re.real().abs() <= slow).then(|| -2.0 * of_y / self.source.depth() / curvature)
    }

    /// Moves a point onto the surface of a guard along the motion. The time of the motion is `y σ`,
    /// where `σ` is given to leading order and corrected by Newton's method for `G(σ) = 0`, with `G
    /// = h/y²` and `dG/dσ = (dh/dt)/y`.
    fn move_onto(
        &mut self,
        place: &mut Place<Jet<C>>,
        guard: usize,
        y: Jet<C>,
        sigma: f64,
    ) -> Result<(), GrazingError> {
        let (normal, order) = (self.source.section.normal_coordinate(), self.source.settings.order);
        let (start, mut sigma) = (place.clone(), Jet::from(sigma));
        let mut largest = self.source.guard_scale();
        // Each iteration doubles the correct degree.
        for _ in 0..=order.ilog2() + 2 {
            place.clone_from(&start);
            self.advance(place, y * sigma, false)?;
            let h = Surface::Guard(guard).moving(self.at(place));
            let (g, slope) = (h.re.divided_by(normal).divided_by(normal), h.eps.divided_by(normal));
            sigma -= g / slope / self.source.depth();
            largest = largest.max(h.re.size());
        }
        place.clone_from(&start);
        self.advance(place, y * sigma, false)?;
        // Terms that are not a multiple of y² were ignored so far.
        let left = Surface::Guard(guard).value(self.at(place)).size();
        if left <= REACHED * largest {
            return Ok(());
        }
        let guards = self.source.system.guards();
        let [touched, back] = [self.source.point.guard, guard].map(|k| guards[k].name.clone());
        Err(GrazingError::Apart { touched, back, left })
    }
}
