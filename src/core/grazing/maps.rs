//! The two maps as Taylor polynomials.

use super::chart::{Chart, Place};
use super::error::GrazingError;
use super::map::MapSettings;
use super::point::GrazingPoint;
use super::section::Section;
use super::surface::Surface;
use crate::core::hybrid::{EventNumber, FieldNumber, GuardNumber, HybridEquations, guard_scale};
use crate::core::jet::{Jet, Polynomial, Space};
use num_dual::Dual;

/// What a map is computed of: the system at a grazing point with its section, and positions of the parameters
/// that deviate.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub system: &'a dyn HybridEquations,
    pub point: &'a GrazingPoint,
    pub section: &'a Section,
    pub parameters: &'a [usize],
    pub settings: MapSettings,
}

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

/// Calls a function with room for the jets of a space.
macro_rules! with_room {
    ($space:expr, $self:ident . $method:ident) => {
        match $space.len() {
            ..=16 => $self.$method::<16>($space),
            ..=64 => $self.$method::<64>($space),
            ..=256 => $self.$method::<256>($space),
            _ => $self.$method::<1024>($space),
        }
    };
}

impl<'a> Source<'a> {
    /// The space of the polynomials: coordinates, then parameters.
    fn space(&self, order: usize) -> Result<&'static Space, GrazingError> {
        Ok(Space::of(self.section.coordinates.len() + self.parameters.len(), order)?)
    }

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
        let space = self.space(self.settings.order)?;
        with_room!(space, self.smooth_in)
    }

    pub fn discontinuity(&self) -> Result<Discontinuity, GrazingError> {
        // Dividing by y costs an order.
        let space = self.space(self.settings.order + 1)?;
        with_room!(space, self.discontinuity_in)
    }

    /// The section with parameters that are jets, and the deviations of the coordinates.
    fn chart<const C: usize>(
        &self,
        space: &'static Space,
    ) -> Result<(Chart<'a, C>, Vec<Jet<C>>), GrazingError>
    where
        Jet<C>: EventNumber,
        Dual<Jet<C>>: FieldNumber + GuardNumber,
        Dual<Dual<Jet<C>>>: GuardNumber,
    {
        let Source { system, point, section, parameters, settings } = *self;
        let count = section.coordinates.len();
        let mut p: Vec<Jet<C>> = point.p.iter().map(|p| Jet::from(*p)).collect();
        for (k, parameter) in parameters.iter().enumerate() {
            p[*parameter] = Jet::variable(space, count + k, point.p[*parameter])?;
        }
        // In units of their scales: terms of all orders are of one size then.
        let deviation = |k: usize| Ok(Jet::variable(space, k, 0.0)? * section.scales[k]);
        let deviations: Result<Vec<_>, GrazingError> = (0..count).map(deviation).collect();
        Ok((Chart::new((system, point, section), p, settings)?, deviations?))
    }

    fn smooth_in<const C: usize>(&self, space: &'static Space) -> Result<Smooth, GrazingError>
    where
        Jet<C>: EventNumber,
        Dual<Jet<C>>: FieldNumber + GuardNumber,
        Dual<Dual<Jet<C>>>: GuardNumber,
    {
        let (mut chart, deviations) = self.chart::<C>(space)?;
        let mut place = chart.on_section(&deviations);
        let penetration = -chart.value(Surface::Guard(self.point.guard), &place);
        let legs = &self.point.legs;
        for (k, (leg, duration)) in legs.iter().enumerate() {
            chart.follow(&mut place, *duration)?;
            match (legs.get(k + 1), leg.exit) {
                (Some((next, _)), Some(guard)) => {
                    chart.land(&mut place, Surface::Guard(guard))?;
                    chart.pass(&mut place, guard, next.mode);
                }
                _ => chart.land(&mut place, Surface::Turning(self.point.guard))?,
            }
        }
        let images = chart.deviations(&place, self.point.periods);
        let sizes = self.sizes();
        let polynomial = |jet: &Jet<C>| Polynomial::of(space, jet).in_sizes(&sizes);
        let images = images.iter().map(polynomial).collect();
        Ok(Smooth { images, penetration: polynomial(&penetration) })
    }

    fn discontinuity_in<const C: usize>(
        &self,
        space: &'static Space,
    ) -> Result<Discontinuity, GrazingError>
    where
        Jet<C>: EventNumber,
        Dual<Jet<C>>: FieldNumber + GuardNumber,
        Dual<Dual<Jet<C>>>: GuardNumber,
    {
        let (mut chart, mut deviations) = self.chart::<C>(space)?;
        let (point, normal) = (self.point, self.section.normal_coordinate());
        let (mut sizes, depth) = (self.sizes(), self.depth());
        let y = std::mem::replace(&mut deviations[normal], Jet::from(0.0));
        let y = y * (depth / sizes[normal]);
        sizes[normal] = depth;
        let start = chart.at_depth(&deviations, -(y * y));
        let entry = chart.deviations(&start, 0)[normal];
        let time = y * self.time_from_surface(&mut chart, normal, &start, y)?;
        let mut place = start;
        chart.shift(&mut place, -time)?;
        let mut guard = point.guard;
        for leg in &point.following {
            chart.pass(&mut place, guard, leg.mode);
            if let Some(exit) = leg.exit {
                chart.land(&mut place, Surface::Guard(exit))?;
                guard = exit;
            }
        }
        chart.pass(&mut place, guard, point.mode);
        chart.land(&mut place, Surface::Turning(point.guard))?;
        let space = self.space(self.settings.order)?;
        let polynomial = |jet: &Jet<C>| Polynomial::of(space, jet).in_sizes(&sizes);
        let images = chart.deviations(&place, 0).iter().map(polynomial).collect();
        Ok(Discontinuity { images, entry: polynomial(&entry) })
    }

    /// The time from the surface to the virtual point in units of `y`, by Newton's iteration for `G(σ) = 0`,
    /// where `G = h/y²` and `dG/dσ = −(dh/dt)/y`.
    fn time_from_surface<const C: usize>(
        &self,
        chart: &mut Chart<'a, C>,
        normal: usize,
        start: &Place<Jet<C>>,
        y: Jet<C>,
    ) -> Result<Jet<C>, GrazingError>
    where
        Jet<C>: EventNumber,
        Dual<Jet<C>>: FieldNumber + GuardNumber,
        Dual<Dual<Jet<C>>>: GuardNumber,
    {
        let surface = Surface::Guard(self.point.guard);
        let mut sigma = Jet::from((2.0 / self.section.curvature).sqrt());
        // Each iteration doubles the degree that is right.
        for _ in 0..=self.settings.order.ilog2() + 2 {
            let mut place = start.clone();
            chart.shift(&mut place, -y * sigma)?;
            let h = surface.moving(self.system, place.mode, place.t, &place.x, &chart.p);
            let (g, slope) = (h.re.divided_by(normal).divided_by(normal), h.eps.divided_by(normal));
            sigma += g / slope / self.depth();
        }
        Ok(sigma)
    }
}
