//! Cycles of maps as a boundary-value problem on segments without motion.

use crate::core::bvp::{
    BoundaryError, BoundaryProblem, BoundarySystem, Ends, Equations, Guess, IntoEquations,
    Itineraries, Mesh, Monitor, Shape, Shooting, Trajectory, Watched,
};
use crate::core::condition::Failure;
use crate::core::forward::forward;
use crate::core::scalar::Scalar;
use crate::core::zero::Names;
use std::ops::Deref;
use std::sync::Arc;

/// A map `x ↦ f(x, p)` with named states and parameters.
pub trait DiscreteMap: Send + Sync {
    /// The names of states, parameters and monitors.
    fn names(&self) -> Names;

    /// The default values of all parameters, in order; empty if there are none.
    fn defaults(&self) -> Vec<f64> {
        Vec::new()
    }

    /// The next state, written into `next` (as long as `x`).
    fn next<T: Scalar>(&self, x: &[T], p: &[T], next: &mut [T]);

    /// A further scalar of a state, by its position among the names of monitors.
    fn monitor<T: Scalar>(&self, _monitor: usize, _x: &[T], _p: &[T]) -> T {
        T::from(f64::NAN)
    }
}

/// A cycle repeats to this tolerance, relative to states above 1.
const REPEATS: f64 = 1e-6;

/// A map that is shared or referred to.
impl<M: Deref<Target: DiscreteMap> + Send + Sync> DiscreteMap for M {
    forward! { |self| (**self);
        fn names() -> Names;
        fn defaults() -> Vec<f64>;
        fn next<T>(x: &[T], p: &[T], next: &mut [T]) -> ();
        fn monitor<T>(monitor: usize, x: &[T], p: &[T]) -> T;
    }
}

/// The cycles of a map: `x_{k+1} = f(x_k, p)`, `k = 0 … K − 1`, `x_K = x_0`; with `K = 1` its fixed
/// points.
///
/// As a boundary-value problem on segments without motion they have everything that periodic orbits
/// have: multipliers, folds, period doublings, torus (Neimark–Sacker) points, and the curves of
/// them; from a period doubling a branch of cycles with twice as many iterates can be
/// [left](crate::core::continuation::Continuation::switch) along.
///
/// ```
/// use tangency::prelude::*;
/// use tangency::core::orbit::{DiscreteMap, MapCycle};
/// /// Hénon's map `x ↦ 1 − a x² + y`, `y ↦ b x`.
/// struct Henon;
/// impl DiscreteMap for Henon {
///     fn names(&self) -> Names {
///         Names::new(["x", "y"], ["a", "b"])
///     }
///     fn next<T: Scalar>(&self, x: &[T], p: &[T], next: &mut [T]) {
///         next[0] = x[1] + 1.0 - p[0] * x[0] * x[0];
///         next[1] = p[1] * x[0];
///     }
/// }
/// let mut points = MapCycle::of(Henon, 1).system()?;
/// let branch = Continuation::of(&mut points).at("b", 0.3).along("a", 0.0..=1.0).trace()?;
/// // Its fixed points double their period at a = 3 (1 − b)²/4.
/// let doubling = branch.of_kind(Kind::PD).next().expect("a period doubling");
/// assert!((doubling.parameters[0] - 0.75 * 0.49).abs() < 1e-13);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct MapCycle<M> {
    map: Arc<M>,
    names: Names,
    iterates: usize,
}

impl<M: DiscreteMap + 'static> MapCycle<M> {
    /// The longest cycle that is looked for.
    pub const LONGEST: usize = 64;

    /// The cycles of so many iterates.
    pub fn of(map: M, iterates: usize) -> Self {
        Self::shared(Arc::new(map), iterates)
    }

    /// The cycles of a map that is shared.
    pub fn shared(map: Arc<M>, iterates: usize) -> Self {
        MapCycle { names: map.names(), map, iterates }
    }

    /// The stable cycle on which iterates of a state settle after a transient, of at most
    /// [`LONGEST`](Self::LONGEST) iterates, with its states one after the other.
    ///
    /// # Errors
    /// [`Failure::Mismatch`] where they do not repeat.
    pub fn settled(
        map: Arc<M>,
        start: &[f64],
        transient: usize,
        p: &[f64],
    ) -> Result<(Self, Vec<f64>), Failure> {
        let (n, mut x) = (start.len(), start.to_vec());
        let mut next = x.clone();
        let mut step = |x: &mut Vec<f64>| {
            map.next(x, p, &mut next);
            std::mem::swap(x, &mut next);
        };
        (0..transient).for_each(|_| step(&mut x));
        let mut states = x.clone();
        let mut nearest = f64::INFINITY;
        for iterates in 1..=Self::LONGEST {
            step(&mut x);
            let away = x
                .iter()
                .zip(&states[..n])
                .map(|(x, first)| (x - first).abs() / (1.0 + first.abs()));
            let away = away.fold(0.0, f64::max);
            if !x.iter().all(|x| x.is_finite()) {
                return Err(Failure::Mismatch(format!(
                    "iterates grow without bound after {transient}"
                )));
            }
            if away <= REPEATS {
                return Ok((Self::shared(map.clone(), iterates), states));
            }
            nearest = nearest.min(away);
            states.extend_from_slice(&x);
        }
        Err(Failure::Mismatch(format!(
            "no cycle of up to {} iterates repeats after {transient}: the nearest is {nearest:.1e} away, above the tolerance \
             {REPEATS:.1e}; simulate longer (`transient`), or elsewhere if it is not periodic",
            Self::LONGEST
        )))
    }

    /// The problem as a system, whose unknowns are the states of all iterates.
    ///
    /// # Errors
    /// [`BoundaryError`] if there is no iterate.
    pub fn system(self) -> Result<BoundarySystem, BoundaryError> {
        let meshes = (0..self.iterates).map(|_| Mesh::uniform(1)).collect();
        // Any method is exact where nothing moves.
        BoundarySystem::new(self, Shooting::default(), meshes)
    }

    fn times(&self, factor: usize) -> Self {
        let MapCycle { map, names, iterates } = self;
        MapCycle { map: map.clone(), names: names.clone(), iterates: iterates * factor }
    }
}

impl<M: DiscreteMap + 'static> BoundaryProblem for MapCycle<M> {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![self.names.unknowns.iter().map(|state| state.name.clone()).collect(); self.iterates]
    }

    fn parameters(&self) -> Vec<String> {
        self.names.parameters.clone()
    }

    fn defaults(&self) -> Vec<f64> {
        self.map.defaults()
    }

    fn field<T: Scalar>(&self, _segment: usize, _t: T, _x: &[T], _q: &[T], f: &mut [T]) {
        f.fill(T::zero());
    }

    fn duration<T: Scalar>(&self, _segment: usize, _q: &[T]) -> T {
        T::one()
    }

    fn boundary<T: Scalar>(&self, ends: Ends<T>, q: &[T], b: &mut [T]) {
        let n = self.names.dimension();
        for (k, x) in ends.end.chunks_exact(n).enumerate() {
            let next = (k + 1) % self.iterates;
            let rows = n * next..n * (next + 1);
            self.map.next(x, q, &mut b[rows.clone()]);
            for i in rows {
                b[i] = ends.start[i] - b[i];
            }
        }
    }

    fn shape(&self) -> Shape {
        Shape::MapCycle
    }

    fn watch<T: Scalar>(&self, function: usize, _segment: usize, _t: T, x: &[T], q: &[T]) -> T {
        self.map.monitor(function, x, q)
    }

    /// Extremes of states and of the map's monitors over all iterates.
    fn monitors(&self) -> Vec<(String, Monitor)> {
        let extremes = |name: &String, watched: &dyn Fn(usize) -> Watched| {
            let all = || (0..self.iterates).map(watched).collect();
            [
                (format!("max_{name}"), Monitor::Maximum(all())),
                (format!("min_{name}"), Monitor::Minimum(all())),
            ]
        };
        let states = self.names.unknowns.iter().enumerate();
        let states = states.flat_map(|(i, state)| extremes(&state.name, &|k| Watched::state(k, i)));
        let further = self.names.monitors.iter().enumerate();
        let further = further.flat_map(|(i, name)| extremes(name, &|k| Watched::function(k, i)));
        states.chain(further).collect()
    }

    fn itineraries(&self) -> Option<&dyn Itineraries> {
        Some(self)
    }
}

/// What cycles go through is the number of their iterates.
impl<M: DiscreteMap + 'static> Itineraries for MapCycle<M> {
    fn words(&self) -> String {
        self.iterates.to_string()
    }

    fn with_words(&self, words: &str) -> Result<Arc<dyn Equations>, Failure> {
        match words.parse() {
            Ok(iterates) if iterates > 0 => {
                Ok(MapCycle { iterates, ..self.times(1) }.into_equations())
            }
            _ => Err(Failure::Mismatch(format!("`{words}` is no number of iterates"))),
        }
    }

    fn doubled(&self) -> Option<Arc<dyn Equations>> {
        Some(self.times(2).into_equations())
    }

    fn emanating(
        &self,
        _known: &[Trajectory],
        _q: &[f64],
        _which: usize,
    ) -> Result<Guess, Failure> {
        Err(Failure::Unsupported("no branches emanate where cycles of a map graze".into()))
    }

    fn across(
        &self,
        _known: &[Trajectory],
        _q: &[f64],
        _passes: bool,
        _wanted: bool,
    ) -> Result<Option<Guess>, Failure> {
        Ok(None)
    }
}
