//! The phase space at a point of a traced branch: the vector field at the point's parameters, and
//! simulations from other states.

use super::discretisation::Solution;
use super::error::SceneError;
use super::request::Request;
use super::resolve::{Resolution, Resolved};
use super::simulate::Simulated;
use super::statement::Scene;
use crate::core::cancel::CancelToken;
use crate::core::continuation::{Branch, Point, SpecialPoint};
use crate::core::hybrid::HybridEquations;
use crate::core::numerics::zero_set;
use crate::core::problem::{Forcing, Profile};
use std::f64::consts::TAU;
use std::sync::Arc;

/// The default duration of a simulation, for a point that has no time scale of its own.
const USUAL: f64 = 50.0;
/// The default duration of a simulation at an equilibrium, in time constants of the equilibrium.
const TIME_CONSTANTS: f64 = 8.0;
/// The default duration of a simulation at an orbit, in periods of the orbit.
const PERIODS: f64 = 5.0;
/// The default duration of a simulation with forcing, in periods of the forcing.
const FORCED_PERIODS: f64 = 20.0;
/// Heuristic: an eigenvalue gives no time scale if its size, relative to the largest eigenvalue, is
/// below this value; at a fold, one eigenvalue is zero to rounding error.
const ZERO: f64 = 1e-6;
/// The number of grid lines along an axis on which nullclines are located.
const FINE: usize = 121;
/// The number of arrows along an axis.
const COARSE: usize = 17;

/// The name of the abscissa of time histories.
const TIME: &str = "time";

/// A regular point or a special point of a branch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// The index of a regular point.
    Regular(usize),
    /// The label of a special point.
    Special(usize),
}

/// The phase space of a problem at the parameters of a point of a traced branch.
pub struct PhaseSpace {
    /// The states of the first mode, with their values at the point; for an orbit, with their values
    /// at the start of its time history.
    pub states: Vec<(String, f64)>,
    /// The values of all parameters at the point.
    pub parameters: Vec<(String, f64)>,
    /// A suitable duration of a simulation, in periods of the forcing, or in units of time for a
    /// problem without forcing: several periods of an orbit, or several time constants of the leading
    /// eigenvalue of an equilibrium.
    pub duration: f64,
    /// Whether the point is an equilibrium.
    pub is_equilibrium: bool,
    motion: Arc<dyn HybridEquations>,
    p: Vec<f64>,
}

/// A rectangle in the plane of two states, as a range along each axis.
pub type Ranges = [[f64; 2]; 2];

impl Resolution {
    /// Returns the phase space at a point of a traced branch; `None` if the problem has no motion, or
    /// if the states at the point are not known, as at regular points of orbits.
    ///
    /// ```
    /// use tangency::scene::{Place, Scene, execute};
    /// let scene = Scene::parse("Scene(
    ///     title: \"A focus\",
    ///     problem: Equations(states: [(\"x\", \"y\"), (\"y\", \"a - x - 0.5*y\")], solution: equilibrium),
    ///     parameters: [(\"a\", 0)],
    ///     runs: [(name: \"rest\", along: [(name: \"a\", low: 0, high: 2)])],
    /// )")?;
    /// let document = execute(&scene, None, &mut ()).document;
    /// let branch = &document.branches[0];
    /// let end = branch.special.last().expect("the end at a = 2");
    /// let space = scene.resolve(None)?.phase_space(branch, Place::Special(end.label)).expect("a motion");
    /// assert!((space.states[0].1 - 2.0).abs() < 1e-9 && space.is_plane());
    /// // The nullclines are y = 0 and y = 2 (2 − x).
    /// let [first, second] = space.nullclines([0, 1], [[-1.0, 4.0], [-3.0, 3.0]]);
    /// assert!(first.iter().flatten().all(|[_, y]| y.abs() < 1e-9));
    /// assert!(second.iter().flatten().all(|[x, y]| (y - 2.0 * (2.0 - x)).abs() < 1e-9));
    /// # Ok::<(), tangency::scene::SceneError>(())
    /// ```
    pub fn phase_space(&self, branch: &Branch, place: Place) -> Option<PhaseSpace> {
        let resolved = self.runs.iter().find(|resolved| resolved.run.name == branch.name)?;
        // Points of local maps have coordinates of their own.
        if resolved.run.local.is_some() {
            return None;
        }
        let at = match place {
            Place::Regular(index) => At::Regular(branch.points.get(index)?),
            Place::Special(label) => At::Special(branch.labelled(label)?),
        };
        let motion = resolved.motion().ok()?;
        let is_equilibrium = resolved.problem.solution() == Some(Solution::Equilibrium);
        let names = motion.modes().into_iter().next()?.states;
        let states = names.into_iter().enumerate().map(|(k, name)| {
            let value = match is_equilibrium {
                true => at.value(branch, &name).or_else(|| at.unknown(k)),
                false => at.start(&name),
            };
            Some((name, value?))
        });
        let states = states.collect::<Option<Vec<_>>>()?;
        let parameters = parameters(resolved, branch, at.parameters());
        let p: Vec<f64> = parameters.iter().map(|(_, value)| *value).collect();
        let duration = match motion.forcing() {
            Forcing::Periodic { .. } => FORCED_PERIODS,
            Forcing::None if is_equilibrium => at.time_constant().map_or(USUAL, rounded),
            Forcing::None => at.period().map_or(USUAL, |period| rounded(PERIODS * period)),
        };
        Some(PhaseSpace { states, parameters, duration, is_equilibrium, motion, p })
    }
}

/// Returns the values of all parameters of a problem at a point of a branch.
fn parameters(resolved: &Resolved, branch: &Branch, values: &[f64]) -> Vec<(String, f64)> {
    let at_point = |name: &String| {
        let k = branch.parameters.iter().position(|known| known == name)?;
        values.get(k).copied()
    };
    let all = resolved.parameters().map(|(name, value)| {
        let value = at_point(&name).unwrap_or(value);
        (name, value)
    });
    all.collect()
}

/// Rounds a duration to two significant digits.
fn rounded(duration: f64) -> f64 {
    let unit = 10f64.powf(duration.log10().floor() - 1.0);
    let digits = (duration / unit).round();
    // Division by an exact power of ten gives the nearest number to the decimal.
    if unit < 1.0 { digits / (1.0 / unit).round() } else { digits * unit.round() }
}

/// A point of a branch.
enum At<'a> {
    Regular(&'a Point),
    Special(&'a SpecialPoint),
}

impl At<'_> {
    fn parameters(&self) -> &[f64] {
        match self {
            At::Regular(point) => &point.parameters,
            At::Special(point) => &point.parameters,
        }
    }

    fn value(&self, branch: &Branch, name: &str) -> Option<f64> {
        let column = branch.column(name)?;
        match self {
            At::Regular(point) => point.value(column),
            At::Special(point) => point.value(column),
        }
    }

    /// Returns an unknown of an equilibrium.
    fn unknown(&self, k: usize) -> Option<f64> {
        match self {
            At::Regular(_) => None,
            At::Special(point) => point.state.get(k).copied(),
        }
    }

    fn histories(&self) -> impl Iterator<Item = &Profile> {
        let profiles = match self {
            At::Regular(_) => &[][..],
            At::Special(point) => &point.profiles,
        };
        profiles.iter().filter(|profile| profile.along == TIME)
    }

    /// Returns the value of a state at the start of its time history.
    fn start(&self, name: &str) -> Option<f64> {
        let own = self.histories().find(|profile| profile.name == name)?;
        own.points.first().map(|point| point[1])
    }

    /// Returns the duration of the time histories of an orbit.
    fn period(&self) -> Option<f64> {
        let points = &self.histories().next()?.points;
        let period = points.last()?[0] - points.first()?[0];
        (period > 0.0).then_some(period)
    }

    /// Returns several time constants of the leading eigenvalue of an equilibrium; `None` if the
    /// eigenvalue is not known, or is zero to rounding error.
    fn time_constant(&self) -> Option<f64> {
        let eigenvalues = match self {
            At::Regular(point) => &point.eigenvalues,
            At::Special(point) => &point.eigenvalues,
        };
        let (real, imaginary) = eigenvalues.first()?;
        let rate = real.abs().max(imaginary.abs() / TAU);
        let largest = eigenvalues.iter().map(|(a, b)| a.hypot(*b)).fold(0.0, f64::max);
        let time = TIME_CONSTANTS / rate;
        (rate > ZERO * largest && time.is_finite()).then_some(time)
    }
}

impl PhaseSpace {
    /// Returns whether the motion is periodically forced.
    pub fn is_forced(&self) -> bool {
        self.motion.forcing().is_periodic()
    }

    /// Returns the name of the mode in which simulations start, if the motion has several modes.
    pub fn first_mode(&self) -> Option<String> {
        let mut modes = self.motion.modes();
        (modes.len() > 1).then(|| modes.swap_remove(0).name)
    }

    /// Returns whether the phase space is the plane of a smooth autonomous vector field.
    pub fn is_plane(&self) -> bool {
        let is_smooth = self.motion.guards().is_empty() && self.motion.modes().len() == 1;
        self.states.len() == 2 && is_smooth && !self.is_forced()
    }

    /// Returns the vector field of the first mode at the time 0; the rates are not numbers outside
    /// the domain of the field.
    pub fn field(&self, x: &[f64]) -> Vec<f64> {
        let mut rates = vec![f64::NAN; x.len()];
        if self.motion.domain_of(0, x, &self.p).is_ok() {
            self.motion.field(0, 0.0, x, &self.p, &mut rates);
        }
        rates
    }

    /// Returns the vector field in the plane of two states, which are given by their indices; all
    /// other states have their values at the point.
    fn in_plane(&self, axes: [usize; 2], at: [f64; 2]) -> [f64; 2] {
        let mut x: Vec<f64> = self.states.iter().map(|(_, value)| *value).collect();
        axes.iter().zip(at).for_each(|(k, value)| x[*k] = value);
        let rates = self.field(&x);
        axes.map(|k| rates[k])
    }

    /// Returns the nullclines in a rectangle of the plane of two states: for each of the two states,
    /// the lines on which its rate is zero, computed with [`zero_set`]. The states are given by their
    /// indices.
    pub fn nullclines(&self, axes: [usize; 2], ranges: Ranges) -> [Vec<Vec<[f64; 2]>>; 2] {
        let [x, y] = ranges.map(|range| grid(range, FINE, 0.0));
        [0, 1].map(|k| zero_set([&x, &y], |at| self.in_plane(axes, at)[k]))
    }

    /// Returns the directions of the vector field at the points of a coarse grid in a rectangle of
    /// the plane of two states. Each point is returned with a unit vector, in coordinates in which
    /// the lengths of the two ranges are the units.
    pub fn directions(&self, axes: [usize; 2], ranges: Ranges) -> Vec<[[f64; 2]; 2]> {
        let [x, y] = ranges.map(|range| grid(range, COARSE, 0.5));
        let widths = ranges.map(|[low, high]| high - low);
        let places = y.iter().flat_map(|y| x.iter().map(|x| [*x, *y]));
        let directions = places.filter_map(|at| {
            let rates = self.in_plane(axes, at);
            let [u, v] = [0, 1].map(|k| rates[k] / widths[k]);
            let length = u.hypot(v);
            (length > 0.0 && length.is_finite()).then(|| [at, [u / length, v / length]])
        });
        directions.collect()
    }

    /// Returns the scene with one simulation from a state, at the parameters of the point, instead of
    /// its runs and sweeps; states that are not given are zero.
    ///
    /// # Errors
    /// The errors of [`Scene::simulating`].
    pub fn simulation(
        &self,
        scene: Scene,
        (state, duration): (Vec<(String, f64)>, f64),
        cancel: &CancelToken,
    ) -> Result<Scene, SceneError> {
        let parameters = self.parameters.iter();
        let set = parameters.map(|(name, value)| (name.clone(), value.to_string())).collect();
        let request = Request { set, cancel: cancel.clone(), ..Request::default() };
        let simulated = Simulated { state, transient: 0.0, duration, ..Simulated::default() };
        scene.simulating(&request, simulated)
    }
}

/// Returns values at equal distances in a range; `inset` is the distance of the first value from the
/// end of the range, in units of the distance between values.
fn grid([low, high]: [f64; 2], count: usize, inset: f64) -> Vec<f64> {
    let step = (high - low) / (count as f64 - 1.0 + 2.0 * inset);
    (0..count).map(|k| low + (k as f64 + inset) * step).collect()
}
