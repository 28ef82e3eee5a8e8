//! The builder of a curve to be traced.

use super::branch::Branch;
use super::error::TraceError;
use super::event::{Event, MakeCondition};
use super::function::{Attached, TestPoint};
use super::quantities::Quantities;
use super::settings::Settings;
use crate::core::bifurcation::DefiningSystem;
use crate::core::problem::position;
use crate::core::scalar::Chunk;
use crate::core::system::{Initial, Kind, Solution, System, SystemRef};
use std::cmp::Ordering;
use std::ops::{Bound, RangeBounds};
use std::sync::Arc;

/// A curve to be traced, as a builder.
///
/// ```
/// use tangency::core::continuation::Continuation;
/// use tangency::core::system::{Dense, Kind};
/// use tangency::problems::classic::ParallelPlate;
/// let mut plate = Dense::new(ParallelPlate);
/// let branch = Continuation::new(&mut plate).along("load", 0.0..=1.0).trace()?;
/// let fold = branch.of_kind(Kind::LP).next().unwrap();
/// assert!((fold.parameters[0] - 4.0 / 27.0).abs() < 1e-14);
/// assert!((fold.state[0] - 1.0 / 3.0).abs() < 1e-12);
/// # Ok::<(), tangency::core::continuation::TraceError>(())
/// ```
pub struct Continuation<'a> {
    pub(super) system: SystemRef<'a>,
    pub(super) name: String,
    pub(super) x: Vec<f64>,
    pub(super) released: Vec<(String, [f64; 2])>,
    pub(super) bounds: Vec<(String, [f64; 2])>,
    pub(super) marks: Vec<(String, f64, Kind)>,
    pub(super) scales: Vec<(String, f64)>,
    pub(super) events: Vec<Event>,
    pub(super) attached: Vec<Attached>,
    pub(super) held: Vec<(Kind, Option<MakeCondition>)>,
    pub(super) settings: Settings,
    /// The saved solution at which the curve starts; `None` if it starts at a guess.
    pub(super) origin: Option<Solution>,
    /// The monitors at the saved end at which the curve starts, by name.
    pub(super) end: Vec<(String, f64)>,
    /// The number of the other branch to follow, counted from 0.
    pub(super) switch: Option<usize>,
    /// Whether to continue beyond grazings.
    pub(super) beyond: bool,
    pub(super) forward: bool,
    pub(super) backward: bool,
    pub(super) errors: Vec<TraceError>,
}

impl<'a> Continuation<'a> {
    /// Creates a curve of zeros of this system, starting at `z = 0` and at the default values of the
    /// parameters (`p = 0` without default values), unless [`from`](Self::from) and [`at`](Self::at)
    /// state others.
    ///
    /// If tracing would change the system (its mesh, period or itinerary), a copy is used, and the
    /// caller's system is unchanged.
    pub fn new(system: &'a mut dyn System) -> Self {
        let system = SystemRef::Borrowed(system).duplicated();
        let names = system.names();
        let mut x = vec![0.0; names.length()];
        x[names.dimension()..].iter_mut().zip(&names.defaults).for_each(|(p, own)| *p = *own);
        Continuation {
            system,
            name: "branch".into(),
            x,
            released: Vec::new(),
            bounds: Vec::new(),
            marks: Vec::new(),
            scales: Vec::new(),
            events: Vec::new(),
            attached: Vec::new(),
            held: Vec::new(),
            settings: Settings::default(),
            origin: None,
            end: Vec::new(),
            switch: None,
            beyond: false,
            forward: true,
            backward: true,
            errors: Vec::new(),
        }
    }

    /// Sets the name of the branch.
    pub fn named(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
    }

    /// Sets the settings of steps and of Newton's method.
    pub fn settings(mut self, settings: Settings) -> Self {
        self.settings = settings;
        self
    }

    /// Sets the start: the unknowns `z` (a guess, corrected with the given parameters), or a
    /// solution with its parameters. Points of a branch contain solutions if
    /// [`keep_solutions`](Settings::keep_solutions) is set; special points always do
    /// ([`Branch::solution`]).
    ///
    /// ```
    /// use tangency::core::continuation::{Continuation, Settings};
    /// use tangency::core::system::Dense;
    /// use tangency::problems::classic::Hyperbola;
    /// // x² = μ² + ε², continued in ε from its last point in μ.
    /// let mut hyperbola = Dense::new(Hyperbola);
    /// let keep = Settings { keep_solutions: true, ..Settings::default() };
    /// let curve = Continuation::new(&mut hyperbola).from(&[3.0]).at("epsilon", 3.0);
    /// let branch = curve.along("mu", 0.0..=4.0).settings(keep).trace()?;
    /// let last = branch.points.last().and_then(|point| point.solution.clone()).unwrap();
    /// assert!((last.state[0] - 5.0).abs() < 1e-10);
    /// let other = Continuation::new(&mut hyperbola).from(&*last).along("epsilon", 0.0..=3.0).trace()?;
    /// let end = other.special.iter().find(|point| point.parameters[1] == 0.0).unwrap();
    /// assert!((end.state[0] - 4.0).abs() < 1e-10);
    /// # Ok::<(), tangency::core::continuation::TraceError>(())
    /// ```
    pub fn from<'s>(mut self, start: impl Into<Initial<'s>>) -> Self {
        let names = self.system.names();
        let (n, parameters) = (names.dimension(), names.parameters.len());
        match start.into() {
            Initial::Unknowns(z) if z.len() == n => self.x[..n].copy_from_slice(z),
            Initial::Unknowns(z) => {
                self.errors.push(TraceError::StateLength { found: z.len(), expected: n });
            }
            Initial::Solution(solution) if solution.parameters.len() == parameters => {
                self.x[n..].copy_from_slice(&solution.parameters);
                self.origin = Some(solution.clone());
            }
            Initial::Solution(solution) => {
                let found = solution.parameters.len();
                self.errors.push(TraceError::ParameterCount { found, expected: parameters });
            }
        }
        self
    }

    /// Sets a parameter's value at the start.
    pub fn at(mut self, parameter: &str, value: f64) -> Self {
        let names = self.system.names();
        match position("parameter", parameter, &names.parameters) {
            Ok(p) => {
                let n = names.dimension();
                self.x[n + p] = value;
            }
            Err(error) => self.errors.push(error.into()),
        }
        self
    }

    /// Starts at a special point of a branch: its state, parameters and direction.
    ///
    /// ```
    /// use tangency::core::continuation::Continuation;
    /// use tangency::core::system::{Dense, Kind};
    /// use tangency::problems::classic::Hyperbola;
    /// // x² = μ²: the branches x = −μ and x = μ cross at 0.
    /// let mut system = Dense::new(Hyperbola);
    /// let curve = Continuation::new(&mut system).from(&[1.0]).at("mu", -1.0);
    /// let branch = curve.along("mu", -1.0..=1.0).trace()?;
    /// let crossing = branch.of_kind(Kind::BP).next().unwrap().label;
    /// let other = Continuation::new(&mut system).restart(&branch, crossing).switch();
    /// let other = other.along("mu", -1.0..=1.0).trace()?;
    /// let end = other.special.last().unwrap();
    /// assert!((end.state[0] - 1.0).abs() < 1e-10 && (end.parameters[0] - 1.0).abs() < 1e-10);
    /// # Ok::<(), tangency::core::continuation::TraceError>(())
    /// ```
    pub fn restart(mut self, branch: &Branch, label: usize) -> Self {
        if let Some(special) = branch.labelled(label).filter(|special| !special.converged) {
            let (branch, kind, bracket) = (branch.name.clone(), special.kind, special.bracket);
            self.errors.push(TraceError::NotConverged { branch, label, kind, bracket });
        }
        self.restart_anyway(branch, label)
    }

    /// Starts at a special point as [`restart`](Self::restart) does, even if the point has not
    /// converged.
    pub fn restart_anyway(mut self, branch: &Branch, label: usize) -> Self {
        let Some(special) = branch.labelled(label) else {
            let (branch, last) = (branch.name.clone(), branch.special.len());
            self.errors.push(TraceError::Label { branch, label, last });
            return self;
        };
        let solution = branch.solution(special);
        for (name, value) in branch.parameters.iter().zip(&special.parameters) {
            self = self.at(name, *value);
        }
        // This system may have other parameters than the branch, in another order.
        let names = self.system.names();
        let own = |slopes: &[f64]| {
            let slope = |name| branch.parameters.iter().position(|own| own == name);
            let slopes = |name| slope(name).map_or(0.0, |p| slopes[p]);
            names.parameters.iter().map(slopes).collect()
        };
        let tangent = solution.tangent.map(|(z, slopes)| (z, own(&slopes)));
        if special.kind == Kind::EP {
            let monitors = branch.monitors.iter().cloned().zip(special.monitors.iter().copied());
            self.end = monitors.collect();
        }
        let mesh_shift = solution.mesh_shift.map(|shift| own(&shift));
        let parameters = self.x[names.dimension()..].to_vec();
        self.from(&Solution { parameters, tangent, mesh_shift, ..solution })
    }

    /// Releases a parameter within a range, such as `0.0..=1.0` or `0.0..`; the continued parameter
    /// comes first. The length of the range is the parameter's scale.
    pub fn along(mut self, parameter: &str, range: impl RangeBounds<f64>) -> Self {
        self.released.push(named_range(parameter, range, &mut self.errors));
        self
    }

    /// Bounds a parameter or a monitor: the branch ends at the bound. If the state `x` moves, a bound of
    /// `x` applies to `max_x` and `min_x`.
    pub fn bound(mut self, name: &str, range: impl RangeBounds<f64>) -> Self {
        self.bounds.push(named_range(name, range, &mut self.errors));
        self
    }

    /// Marks points at which a parameter or a monitor takes a value, as `UZ`. If the state `x` moves, a
    /// mark of `x` applies to `max_x` and `min_x`.
    ///
    /// ```
    /// use tangency::core::continuation::Continuation;
    /// use tangency::core::system::{Dense, Kind};
    /// use tangency::problems::classic::ParallelPlate;
    /// let mut plate = Dense::new(ParallelPlate);
    /// let branch = Continuation::new(&mut plate).along("load", 0.0..=1.0).mark("load", 0.125).trace()?;
    /// // u (1 − u)² = 1/8, before pull-in and after.
    /// let [before, after]: [f64; 2] = [0, 1].map(|k| branch.of_kind(Kind::UZ).nth(k).unwrap().state[0]);
    /// assert!((before - (3.0 - 5.0_f64.sqrt()) / 4.0).abs() < 1e-13 && (after - 0.5).abs() < 1e-13);
    /// # Ok::<(), tangency::core::continuation::TraceError>(())
    /// ```
    pub fn mark(mut self, name: &str, level: f64) -> Self {
        if !level.is_finite() {
            let (what, name, range) = ("the mark", name.into(), "finite");
            self.errors.push(TraceError::Value { what, name, value: level, range });
        }
        self.marks.push((name.into(), level, Kind::UZ));
        self
    }

    /// Marks points at which a monitor takes a value and the solution touches a surface, as `G`.
    ///
    /// ```
    /// # use tangency::core::continuation::Continuation;
    /// # use tangency::core::system::Kind;
    /// # use tangency::core::orbit::periodic_orbits;
    /// # use tangency::core::bvp::Shooting;
    /// # use tangency::problems::mita::Block;
    /// let mut orbits = periodic_orbits(Block, 1, Shooting::default()).unwrap();
    /// let branch = Continuation::new(&mut orbits)
    ///     .at("voltage", 0.01).at("frequency", 0.5).at("damping", 0.04)
    ///     .along("voltage", 0.01..=0.3)
    ///     .graze("max_displacement", 0.5)
    ///     .trace()?;
    /// let grazing = branch.of_kind(Kind::G).next().unwrap();
    /// assert!((grazing.parameters[0] - 0.227177583102).abs() < 1e-11);
    /// # Ok::<(), tangency::core::continuation::TraceError>(())
    /// ```
    pub fn graze(self, name: &str, level: f64) -> Self {
        let mut curve = self.mark(name, level);
        curve.marks.last_mut().into_iter().for_each(|mark| mark.2 = Kind::G);
        curve
    }

    /// Continues beyond grazings, where solutions cross surfaces without their events: such points
    /// are virtual ([`Point::admissible`](super::branch::Point::admissible)).
    pub fn beyond_grazings(mut self) -> Self {
        self.beyond = true;
        self
    }

    /// Sets the scale of a group of unknowns, or of a released parameter. Default: the largest norm
    /// of the group so far (or the length of the parameter's range).
    pub fn scale(mut self, name: &str, size: f64) -> Self {
        if !(size.is_finite() && size > 0.0) {
            let (what, name, range) = ("the scale", name.into(), "finite and more than 0");
            self.errors.push(TraceError::Value { what, name, value: size, range });
        }
        self.scales.push((name.into(), size));
        self
    }

    /// Records a function of points as a further monitor, which can be marked and bounded by its
    /// name. It has no gradient, so it cannot be held, and its levels are located by bracketing.
    ///
    /// ```
    /// use tangency::core::continuation::Continuation;
    /// use tangency::core::system::{Dense, Kind};
    /// use tangency::problems::classic::ParallelPlate;
    /// let mut plate = Dense::new(ParallelPlate);
    /// let curve = Continuation::new(&mut plate).along("load", 0.0..=1.0);
    /// let curve = curve.monitor("gap", |at| 1.0 - at.state[0]).mark("gap", 0.5);
    /// let branch = curve.trace()?;
    /// // u (1 − u)² at u = 1/2.
    /// let half = branch.of_kind(Kind::UZ).next().unwrap();
    /// assert!((half.parameters[0] - 0.125).abs() < 1e-9 && (half.monitors[0] - 0.5).abs() < 1e-9);
    /// # Ok::<(), tangency::core::continuation::TraceError>(())
    /// ```
    pub fn monitor(
        mut self,
        name: impl Into<String>,
        function: impl Fn(&TestPoint) -> f64 + Send + Sync + 'static,
    ) -> Self {
        let (name, function) = (name.into(), Arc::new(function));
        self.attached.push(Attached { name, function, dual: None });
        self
    }

    /// Records a function `f(z, p)` of the unknowns and all parameters on dual numbers as a further
    /// monitor. It has a gradient, so its levels are ordinary special points and can be held along
    /// a curve.
    ///
    /// ```
    /// use tangency::core::continuation::Continuation;
    /// use tangency::core::system::Dense;
    /// use tangency::problems::classic::Hyperbola;
    /// // x² = μ² + ε² with x μ = 20, along ε to 3: x = 5, μ = 4.
    /// let mut hyperbola = Dense::new(Hyperbola);
    /// let curve = Continuation::new(&mut hyperbola).from(&[4.5]).at("mu", 4.5).at("epsilon", 0.25);
    /// let curve = curve.smooth_monitor("product", |x, p| x[0] * p[0]).hold_level("product", 20.0);
    /// let branch = curve.along("mu", 0.0..=9.0).along("epsilon", 0.0..=3.0).trace()?;
    /// let end = branch.special.iter().find(|point| (point.parameters[1] - 3.0).abs() < 1e-9).unwrap();
    /// assert!((end.state[0] - 5.0).abs() < 1e-9 && (end.parameters[0] - 4.0).abs() < 1e-9);
    /// # Ok::<(), tangency::core::continuation::TraceError>(())
    /// ```
    pub fn smooth_monitor(
        mut self,
        name: impl Into<String>,
        function: impl Fn(&[Chunk], &[Chunk]) -> Chunk + Send + Sync + 'static,
    ) -> Self {
        self.attached.push(Attached::dual(name.into(), Arc::new(function)));
        self
    }

    /// Holds the defining system of a kind of special point along the curve; one more parameter
    /// must be released. A codimension-two point can be held together with the kind on whose curves
    /// it lies.
    ///
    /// A system of cycles also starts curves at codimension-two points of equilibria: folds at a
    /// generalised Hopf point, torus points at a fold–Hopf or double Hopf point. At a double Hopf
    /// point, [`switch_to(1)`](Self::switch_to) selects the cycles of the pair with the smaller
    /// frequency.
    ///
    /// Curves of torus points also start at resonances 1:1 and 1:2, and curves of folds of doubled
    /// orbits at a generalised period doubling. At a 1:2 resonance with a negative coefficient
    /// `r2_a`, [`switch_to(1)`](Self::switch_to) selects the torus points of doubled orbits, which
    /// are also selected, without this call, if the resonance lies on a curve of torus points.
    pub fn hold(mut self, kind: Kind) -> Self {
        self.held.push((kind, None));
        self
    }

    /// Holds a parameter or a monitor at a level along the curve; one more parameter must be
    /// released.
    pub fn hold_level(mut self, name: &str, level: f64) -> Self {
        let quantities = Quantities::new(self.system.names(), &self.attached);
        let held = quantities.find(name).and_then(|quantity| {
            let condition = quantities.condition((quantity, level), Kind::UZ);
            condition.ok_or_else(|| TraceError::NoGradient(name.into()))
        });
        match held {
            Ok(make) => self.held.push((Kind::UZ, Some(make))),
            Err(error) => self.errors.push(error),
        }
        self
    }

    /// Holds a user-defined defining system.
    pub fn hold_condition<C: DefiningSystem + 'static>(
        mut self,
        condition: impl Fn() -> C + Send + Sync + 'static,
    ) -> Self {
        let kind = condition().kind();
        self.held.push((kind, Some(Arc::new(move || Box::new(condition())))));
        self
    }

    /// Adds an event.
    pub fn event(mut self, event: Event) -> Self {
        self.events.push(event);
        self
    }

    /// Follows the *other* branch at the branch point where the curve starts.
    pub fn switch(self) -> Self {
        self.switch_to(0)
    }

    /// Selects the branch to follow, counted from 0. At a branch point where several branches cross
    /// (`multiplicity` above 1), the parent branch is not counted. At a grazing with several
    /// grazed guards, branch 0 has the events of all guards; the next branches have the event of
    /// one guard each, in the order of the grazing points, then of each pair, and so on.
    pub fn switch_to(mut self, which: usize) -> Self {
        self.switch = Some(which);
        self
    }

    /// Traces only in the direction of increasing values of the (last released) parameter.
    pub fn forward(mut self) -> Self {
        self.backward = false;
        self
    }

    /// Traces only in the direction of decreasing values of the (last released) parameter.
    pub fn backward(mut self) -> Self {
        self.forward = false;
        self
    }
}

/// Returns a range with its name, or an error if the range is empty or NaN.
fn named_range(
    name: &str,
    range: impl RangeBounds<f64>,
    errors: &mut Vec<TraceError>,
) -> (String, [f64; 2]) {
    let end = |bound: Bound<&f64>, infinite: f64| match bound {
        Bound::Included(end) | Bound::Excluded(end) => *end,
        Bound::Unbounded => infinite,
    };
    let low = end(range.start_bound(), f64::NEG_INFINITY);
    let (name, high) = (name.to_string(), end(range.end_bound(), f64::INFINITY));
    if low.partial_cmp(&high) != Some(Ordering::Less) {
        errors.push(TraceError::EmptyRange { name: name.clone(), low, high });
    }
    (name, [low, high])
}
