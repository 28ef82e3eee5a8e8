//! The local map as a motion that is looked at once in every period.

use super::error::GrazingError;
use super::iteration::Iteration;
use super::map::LocalMap;
use crate::core::attractor::{EventRecord, Layout, Period, StroboscopicError, StroboscopicMap};
use crate::core::hybrid::{HybridState, Mode};
use crate::core::measure::Measure;
use num_dual::Dual64;
use std::sync::Arc;

/// Beyond this deviation a polynomial in deviations means nothing.
const MOST: f64 = 1.0;

/// The number of the only event: that the virtual point lies beyond the surface.
const IMPACT: usize = 0;

/// The local map iterated: what motions near the grazing settle on, in a fraction of the time that simulation
/// takes.
///
/// States are deviations of the coordinates; parameters are those of the system, in the order of the names that are
/// given, of which those count in which the map is expanded. A period in which the virtual point lies beyond the
/// surface has the event `impact`, and `penetration` is measured.
///
/// ```
/// use tangency::core::attractor::AttractorSearch;
/// use tangency::core::grazing::{GrazingPoint, Iterated, LocalMap, MapSettings};
/// use tangency::core::hybrid::HybridState;
/// # use tangency::core::orbit::{HybridOrbit, Itinerary};
/// # use tangency::problems::classic::ImpactOscillator;
/// # let orbit = HybridOrbit::of(ImpactOscillator, Itinerary::smooth(ImpactOscillator::FLIGHT, 1));
/// # let point = GrazingPoint::of(&orbit, &[0.0, 1.0], &[0.1, 1.0, 0.8, 0.1, 1.0])?;
/// // The oscillator of the example of `LocalMap` beyond its grazing at A = 0.1, with an impact in every period:
/// // damping and restitution leave |μ|² = e² exp(−0.1·2π).
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
    map: Arc<LocalMap>,
    /// The positions of the map's parameters among all, and their deviations.
    positions: Vec<usize>,
    p: Vec<f64>,
    layout: Layout,
    real: Iteration<Arc<LocalMap>, f64>,
    dual: Iteration<Arc<LocalMap>, Dual64>,
    /// Parameters on dual numbers.
    fixed: Vec<Dual64>,
}

impl Iterated {
    /// The map, where `parameters` names those that are given to it; with measures, of which there is `penetration`.
    ///
    /// # Errors
    /// [`GrazingError::Parameter`] if one of the map's parameters is not among them, [`GrazingError::NoMeasure`] for
    /// another measure.
    pub fn of(
        map: LocalMap,
        parameters: &[String],
        measures: &[String],
    ) -> Result<Self, GrazingError> {
        let position = |name: &String| GrazingError::position(name, parameters);
        let positions = map.parameters().iter().map(position).collect::<Result<_, _>>()?;
        if let Some(name) = measures.iter().find(|name| *name != Measure::PENETRATION) {
            return Err(GrazingError::NoMeasure(name.clone()));
        }
        let order = map.space().order();
        let map = Arc::new(map);
        Ok(Iterated {
            positions,
            p: Vec::new(),
            layout: Layout {
                modes: vec![Mode { name: "map".into(), states: map.coordinates().to_vec() }],
                events: vec!["impact".into()],
                measures: measures.to_vec(),
            },
            real: Iteration::new(map.clone(), order),
            dual: Iteration::new(map.clone(), order),
            fixed: Vec::new(),
            map,
        })
    }

    /// The map.
    pub fn map(&self) -> &LocalMap {
        &self.map
    }

    /// Takes over parameters.
    fn load(&mut self, p: &[f64]) {
        let origin = self.map.origin().1;
        self.p.clear();
        self.p.extend(self.positions.iter().zip(origin).map(|(k, at)| p[*k] - at));
    }

    /// The image of a state in its place, and the penetration before.
    fn image(&mut self, state: &mut HybridState<f64>, p: &[f64]) -> Result<f64, StroboscopicError> {
        self.load(p);
        let penetration = self.real.apply(&mut state.x, &self.p);
        self.check(&state.x)?;
        Ok(penetration)
    }

    /// Refuses a point that is nowhere near the grazing.
    fn check(&self, x: &[f64]) -> Result<(), StroboscopicError> {
        let far = |(x, _): &(&f64, &String)| x.is_nan() || x.abs() > MOST;
        let Some((x, name)) = x.iter().zip(self.map.coordinates()).find(far) else { return Ok(()) };
        Err(StroboscopicError::Map(format!(
            "the local map of order {} has left its grazing: the deviation of `{name}` is {x:.1e}, and should stay small; \
             begin nearer",
            self.map.space().order()
        )))
    }
}

impl StroboscopicMap for Iterated {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn advance(
        &mut self,
        state: &mut HybridState<f64>,
        p: &[f64],
    ) -> Result<(), StroboscopicError> {
        self.image(state, p).map(|_| ())
    }

    fn record(
        &mut self,
        state: &mut HybridState<f64>,
        p: &[f64],
    ) -> Result<Period, StroboscopicError> {
        let start = state.clone();
        let penetration = self.image(state, p)?;
        let impact = || {
            let before = start.clone();
            EventRecord { event: IMPACT, time: 0.0, before, accumulation: false }
        };
        let events = (penetration > 0.0).then(impact).into_iter().collect();
        let measures = self.layout.measures.iter().map(|_| penetration).collect();
        Ok(Period { start, events, measures })
    }

    fn push_forward(
        &mut self,
        state: &mut HybridState<Dual64>,
        p: &[f64],
    ) -> Result<(), StroboscopicError> {
        self.load(p);
        let Iterated { dual, fixed, p, .. } = self;
        fixed.clear();
        fixed.extend(p.iter().map(|p| Dual64::from(*p)));
        dual.apply(&mut state.x, fixed);
        let real: Vec<f64> = state.x.iter().map(|x| x.re).collect();
        self.check(&real)
    }
}
