//! The builder that specifies the start, parameters, bounds and defining systems of a curve before
//! it is traced.

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

/// Builder of a curve: specifies its start, parameters, bounds and defining systems, and traces it.
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
    /// The saved solution at which the curve starts; `None` if the curve starts at a guess.
    pub(super) origin: Option<Solution>,
    /// The names and values of the monitors at the saved end at which the curve starts.
    pub(super) end: Vec<(String, f64)>,
    /// The index, counted from 0, of the emanating branch to follow.
    pub(super) switch: Option<usize>,
    /// Whether to continue the curve beyond grazings, along virtual orbits.
    pub(super) beyond: bool,
    pub(super) forward: bool,
    pub(super) backward: bool,
    pub(super) errors: Vec<TraceError>,
}

impl<'a> Continuation<'a> {
    /// Creates a curve of zeros of this system. The curve starts at `z = 0` and at the default
    /// values of the parameters (at `p = 0` if the parameters have no default values), unless
    /// [`from`](Self::from) and [`at`](Self::at) specify another start.
    ///
    /// If tracing changes the mesh, period or itinerary of the system, a copy of the system is
    /// traced, and the system of the caller is unchanged.
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

    /// Sets the settings of the continuation steps and of Newton's method.
    pub fn settings(mut self, settings: Settings) -> Self {
        self.settings = settings;
        self
    }

    /// Sets the start of the curve: a guess of the unknowns `z`, which is corrected with the given
    /// parameters, or a solution with its parameters. Special points of a branch always contain
    /// their solutions ([`Branch::solution`]); regular points contain their solutions if
    /// [`keep_solutions`](Settings::keep_solutions) is set.
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

    /// Sets the value of a parameter at the start of the curve.
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

    /// Starts the curve at a special point of a branch, with the state, parameters and direction of
    /// that point.
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

    /// Starts the curve at a special point as [`restart`](Self::restart) does, but also accepts a
    /// point at which Newton's method has not converged.
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

    /// Releases a parameter within a range, such as `0.0..=1.0` or `0.0..`. The parameter released
    /// first is the continued parameter. The length of the range is used as the scale of the
    /// parameter.
    pub fn along(mut self, parameter: &str, range: impl RangeBounds<f64>) -> Self {
        self.released.push(named_range(parameter, range, &mut self.errors));
        self
    }

    /// Sets bounds of a parameter or a monitor, at which the branch ends. If solutions are orbits,
    /// a bound of a state `x` applies to the monitors `max_x` and `min_x`.
    pub fn bound(mut self, name: &str, range: impl RangeBounds<f64>) -> Self {
        self.bounds.push(named_range(name, range, &mut self.errors));
        self
    }

    /// Marks the points at which a parameter or a monitor takes a given value, as special points of the
    /// kind `UZ`. If solutions are orbits, a mark of a state `x` applies to the monitors `max_x` and
    /// `min_x`.
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

    /// Marks the points at which a monitor reaches a given value because the solution grazes a
    /// surface there, as special points of the kind `G`.
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

    /// Continues the curve beyond grazings: the solutions there cross a surface without its event
    /// and are called virtual ([`Point::admissible`](super::branch::Point::admissible)).
    pub fn beyond_grazings(mut self) -> Self {
        self.beyond = true;
        self
    }

    /// Sets the scale of a group of unknowns, or of a released parameter. The default scale of a
    /// group is its largest norm so far along the curve; the default scale of a parameter is the
    /// length of its range.
    pub fn scale(mut self, name: &str, size: f64) -> Self {
        if !(size.is_finite() && size > 0.0) {
            let (what, name, range) = ("the scale", name.into(), "finite and more than 0");
            self.errors.push(TraceError::Value { what, name, value: size, range });
        }
        self.scales.push((name.into(), size));
        self
    }

    /// Records a function of points as a further monitor, which can be marked and bounded by its
    /// name. A monitor given by a function of points has no gradient. Therefore such a monitor
    /// cannot be held at a level along a curve, and its levels are located by bracketing.
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

    /// Records a function `f(z, p)` of the unknowns and all parameters, written for dual numbers,
    /// as a further monitor. The gradient of a monitor written for dual numbers is computed by
    /// automatic differentiation. Therefore the levels of such a monitor are located by Newton's
    /// method and can be held along a curve.
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
    /// must be released. The defining system of a codimension-two point can be held together with
    /// the defining system of a curve on which such points lie.
    ///
    /// For a system of cycles, curves also start at codimension-two points of equilibria: curves of
    /// folds of cycles at a generalised Hopf point, and curves of torus points at a fold–Hopf or
    /// double Hopf point. At a double Hopf point, [`switch_to(1)`](Self::switch_to) selects the
    /// cycles that belong to the eigenvalue pair with the smaller frequency.
    ///
    /// Curves of torus points also start at resonances 1:1 and 1:2, and curves of folds of
    /// period-doubled orbits start at a generalised period doubling. At a 1:2 resonance with a
    /// negative coefficient `r2_a`, [`switch_to(1)`](Self::switch_to) selects the torus points of
    /// period-doubled orbits. If a 1:2 resonance was found on a curve of torus points, the torus
    /// points of period-doubled orbits are selected by default.
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

    /// Holds a user-defined defining system along the curve.
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

    /// Starts at a branch point and follows the *other* branch, not the branch on which the branch
    /// point was found.
    pub fn switch(self) -> Self {
        self.switch_to(0)
    }

    /// Selects one of the branches that emanate at the start by its index, counted from 0. At a
    /// branch point where several branches cross (`multiplicity` above 1), the parent branch is not
    /// counted. At a Hopf point with several equal pairs of eigenvalues, branches of cycles emanate in
    /// the directions that terms of third order determine. If an orbit grazes several guards, the
    /// orbits of branch 0 include the events of all grazed guards. The orbits of the next branches
    /// include the event of a single guard, in the order of the grazing points along the orbit; the
    /// following branches include the events of two guards, and so on.
    pub fn switch_to(mut self, which: usize) -> Self {
        self.switch = Some(which);
        self
    }

    /// Traces only in the direction in which the parameter (if there are several, the parameter
    /// released last) increases at the start.
    pub fn forward(mut self) -> Self {
        self.backward = false;
        self
    }

    /// Traces only in the direction in which the parameter (if there are several, the parameter
    /// released last) decreases at the start.
    pub fn backward(mut self) -> Self {
        self.forward = false;
        self
    }
}

/// Returns the bounds of a range with its name, or an error if the range is empty or contains NaN.
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
