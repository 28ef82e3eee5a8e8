//! The local map as a stroboscopic map, whose attractors can be searched for.

use super::error::GrazingError;
use super::iteration::Iteration;
use super::map::LocalMap;
use crate::core::attractor::{EventRecord, Layout, Period, StroboscopicError, StroboscopicMap};
use crate::core::hybrid::{Member, Mode};
use crate::core::problem::{Measure, position};
use crate::core::scalar::Scalar;
use num_dual::Dual64;
use std::sync::Arc;

/// Heuristic: an iterate counts as escaped if its deviation, in units of the coordinates' scales,
/// is above this value: the polynomials are valid only for small deviations.
const MOST: f64 = 1.0;

/// The index of the map's only event, which occurs if the virtual point lies beyond the surface.
const IMPACT: usize = 0;

/// The iteration of a local map: it finds the attractors near a grazing in a fraction of the time
/// of a simulation.
///
/// The states of the iterated map are deviations of the local map's coordinates from the grazing
/// orbit. The parameters are the parameters of the system, in the order of the given names; only
/// the parameters of the local map affect the result. If the virtual point of an iterate lies
/// beyond the surface, the iterate counts as a period with the event `impact`; the only measure of
/// the map is `penetration`.
///
/// ```
/// use tangency::core::attractor::AttractorSearch;
/// use tangency::core::local_map::{GrazingPoint, Iterated, LocalMap, MapSettings};
/// use tangency::core::hybrid::HybridState;
/// # use tangency::core::orbit::{HybridOrbit, Itinerary};
/// # use tangency::problems::classic::ImpactOscillator;
/// # let orbit = HybridOrbit::of(ImpactOscillator, Itinerary::smooth(ImpactOscillator::FLIGHT, 1))?;
/// # let point = GrazingPoint::of(&orbit, &[0.0, 1.0], &[0.1, 1.0, 0.8, 0.1, 1.0])?;
/// // The oscillator of the example of `LocalMap` beyond its grazing at A = 0.1, with one impact per period:
/// // damping and restitution give |μ|² = e² exp(−0.1·2π).
/// let settings = MapSettings { order: 3, ..MapSettings::default() };
/// let map = LocalMap::of(&ImpactOscillator, &point, &["amplitude"], settings)?;
/// let mut iterated = Iterated::of(map, &["amplitude".into()], &[])?;
/// let start = HybridState { mode: 0, time: 0.0, x: vec![1e-4, 0.0] };
/// let settled = AttractorSearch::default().follow(&mut iterated, start, &[0.10001])?;
/// assert_eq!((settled.periods, settled.count("impact")), (Some(1), 1.0));
/// let exact = (0.8_f64.powi(2) * (-0.1 * std::f64::consts::TAU).exp()).ln() / 2.0;
/// assert!((settled.exponent.expect("an exponent").value - exact).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Iterated {
    /// The indices of the local map's parameters among all parameters.
    positions: Vec<usize>,
    layout: Layout,
    real: Moving<f64>,
    dual: Moving<Dual64>,
}

/// The local map in one scalar type, with the deviations of its parameters from their values on the
/// grazing orbit.
struct Moving<T> {
    iteration: Iteration<Arc<LocalMap>, T>,
    p: Vec<T>,
}

impl<T: Scalar> Moving<T> {
    fn of(map: Arc<LocalMap>) -> Self {
        let order = map.space().order();
        Moving { iteration: Iteration::new(map, order), p: Vec::new() }
    }

    /// Replaces a state by its image, and returns the penetration at the original state. Returns an
    /// error if the image is too far from the grazing.
    fn image(
        &mut self,
        positions: &[usize],
        Member { state, p }: &mut Member<T>,
    ) -> Result<T, StroboscopicError> {
        let deviations = positions.iter().zip(self.iteration.map.origin().1);
        self.p.clear();
        self.p.extend(deviations.map(|(k, at)| p[*k] - *at));
        let penetration = self.iteration.apply(&mut state.x, &self.p);
        let map = &self.iteration.map;
        let far = |(x, scale): (f64, &f64)| x.is_nan() || x.abs() > MOST * scale;
        let deviations = || state.x.iter().map(Scalar::real);
        match deviations().zip(&map.scales).position(far) {
            None => Ok(penetration),
            Some(k) => Err(StroboscopicError::Map(format!(
                "an iterate of the local map of order {} is too far from the grazing: the \
                 coordinate `{}` deviates by {:.1e}, but its scale is {:.1e}; start closer to the \
                 grazing",
                map.space().order(),
                map.coordinates()[k],
                state.x[k].real(),
                map.scales[k],
            ))),
        }
    }
}

impl Iterated {
    /// The name of the event in which an iterate passes through the surface.
    pub const EVENT: &str = "impact";

    /// Creates the iterated map of a local map. `parameters` are the names of all parameters of the
    /// iterated map; the only possible measure is `penetration`.
    ///
    /// # Errors
    /// [`GrazingError::Unknown`] if one of the local map's parameters is missing from `parameters`,
    /// or if a measure is not `penetration`.
    pub fn of(
        map: LocalMap,
        parameters: &[String],
        measures: &[String],
    ) -> Result<Self, GrazingError> {
        let among = |name: &String| position("parameter", name, parameters);
        let positions = map.parameters().iter().map(among).collect::<Result<_, _>>()?;
        for name in measures {
            position("measure", name, [Measure::PENETRATION])?;
        }
        let map = Arc::new(map);
        Ok(Iterated {
            positions,
            layout: Layout {
                modes: vec![Mode::new("map", map.coordinates().to_vec())],
                events: vec![Self::EVENT.into()],
                measures: measures.to_vec(),
            },
            real: Moving::of(map.clone()),
            dual: Moving::of(map),
        })
    }
}

impl StroboscopicMap for Iterated {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn advance(&mut self, member: &mut Member<f64>) -> Result<(), StroboscopicError> {
        self.real.image(&self.positions, member).map(|_| ())
    }

    fn record(&mut self, member: &mut Member<f64>) -> Result<Period, StroboscopicError> {
        let start = member.state.clone();
        let penetration = self.real.image(&self.positions, member)?;
        let impact = || {
            let before = start.clone();
            EventRecord { event: IMPACT, time: 0.0, before, accumulation: false }
        };
        let events = (penetration > 0.0).then(impact).into_iter().collect();
        let measures = self.layout.measures.iter().map(|_| penetration).collect();
        Ok(Period { start, events, measures })
    }

    fn push_forward(&mut self, member: &mut Member<Dual64>) -> Result<(), StroboscopicError> {
        self.dual.image(&self.positions, member).map(|_| ())
    }
}
