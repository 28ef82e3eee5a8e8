//! The two maps as Taylor polynomials.

use super::chart::{Chart, Place, Source};
use super::error::GrazingError;
use super::point::GrazingPoint;
use super::surface::Surface;
use crate::core::hybrid::{EventNumber, FieldNumber, GuardNumber, guard_scale};
use crate::core::jet::{Jet, Polynomial};
use num_dual::Dual;

/// `P_smooth` in the coordinates, and the penetration `−h` on the section.
#[derive(Clone, Debug)]
pub(super) struct Smooth {
    pub images: Vec<Polynomial>,
    pub penetration: Polynomial,
}

/// `D` in `y` and the other coordinates, and the normal coordinate of the virtual point.
#[derive(Clone, Debug)]
pub(super) struct Discontinuity {
    pub images: Vec<Polynomial>,
    pub entry: Polynomial,
}

/// Computes a map in a chart with room for the jets of an order.
macro_rules! in_chart {
    ($source:expr, $order:expr, $map:ident) => {{
        let space = $source.space($order)?;
        match space.len() {
            ..=16 => Chart::<16>::of(*$source, space)?.$map(),
            ..=128 => Chart::<128>::of(*$source, space)?.$map(),
            _ => Chart::<1024>::of(*$source, space)?.$map(),
        }
    }};
}

impl Source<'_> {
    /// The scales of all variables: coordinates, then parameters.
    fn sizes(&self) -> Vec<f64> {
        let parameters = self.parameters.iter().map(|_| 1.0);
        self.section.scales.iter().copied().chain(parameters).collect()
    }

    /// The scale of `y`.
    fn depth(&self) -> f64 {
        let GrazingPoint { guard, mode, time, x, p, .. } = self.point;
        guard_scale(self.system, (*guard, *mode), (*time, x), p).sqrt()
    }

    pub fn smooth(&self) -> Result<Smooth, GrazingError> {
        in_chart!(self, self.settings.order, smooth)
    }

    pub fn discontinuity(&self) -> Result<Discontinuity, GrazingError> {
        // Dividing by y costs an order.
        in_chart!(self, self.settings.order + 1, discontinuity)
    }
}

impl<const C: usize> Chart<'_, C>
where
    Jet<C>: EventNumber,
    Dual<Jet<C>>: FieldNumber + GuardNumber,
    Dual<Dual<Jet<C>>>: GuardNumber,
{
    /// The polynomials of jets whose variables were in units of these sizes.
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
            self.follow(&mut place, *duration)?;
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
        let start = self.at_depth(&self.deviations, -(y * y));
        let entry = self.deviations_of(&start, 0)[normal];
        let time = y * self.time_from_surface(normal, &start, y)?;
        let mut place = start;
        self.shift(&mut place, -time)?;
        let mut guard = point.guard;
        for leg in &point.following {
            self.pass(&mut place, guard, leg.mode);
            if let Some(exit) = leg.exit {
                self.land(&mut place, Surface::Guard(exit))?;
                guard = exit;
            }
        }
        self.pass(&mut place, guard, point.mode);
        self.land(&mut place, Surface::Turning(point.guard))?;
        let polynomial = |jet: &Jet<C>| self.polynomial(jet, &sizes);
        let images = self.deviations_of(&place, 0);
        let images = images.iter().map(polynomial).collect::<Result<_, _>>()?;
        Ok(Discontinuity { images, entry: polynomial(&entry)? })
    }

    /// The time from the surface to the virtual point in units of `y`, by Newton's iteration for `G(σ) = 0`,
    /// where `G = h/y²` and `dG/dσ = −(dh/dt)/y`.
    fn time_from_surface(
        &mut self,
        normal: usize,
        start: &Place<Jet<C>>,
        y: Jet<C>,
    ) -> Result<Jet<C>, GrazingError> {
        let Source { point, section, settings, .. } = self.source;
        let mut sigma = Jet::from((2.0 / section.curvature).sqrt());
        // Each iteration doubles the degree that is right.
        for _ in 0..=settings.order.ilog2() + 2 {
            let mut place = start.clone();
            self.shift(&mut place, -y * sigma)?;
            let h = Surface::Guard(point.guard).moving(self.at(&place));
            let (g, slope) = (h.re.divided_by(normal).divided_by(normal), h.eps.divided_by(normal));
            sigma += g / slope / self.source.depth();
        }
        Ok(sigma)
    }
}
