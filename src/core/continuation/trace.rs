//! A curve to be traced, put together piece by piece.

use super::event::{Event, MakeCondition};
use super::steps::Steps;
use super::{Branch, Kind, Settings, TraceError};
use crate::core::function::Attached;
use crate::core::solution::Solution;
use crate::core::system_ref::SystemRef;
use crate::core::zero::System;
use std::cmp::Ordering;
use std::ops::RangeInclusive;

/// A curve to be traced: a builder.
///
/// ```
/// use tangency::core::continuation::{Continuation, Kind};
/// use tangency::core::dense::Dense;
/// use tangency::problems::classic::ParallelPlate;
/// let mut plate = Dense::new(ParallelPlate);
/// let branch = Continuation::of(&mut plate).along("load", 0.0..=1.0).trace()?;
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
    /// The point that the curve starts from.
    pub(super) origin: Origin,
    /// Whether to go on beyond grazings.
    pub(super) beyond: bool,
    /// The monitors that vanish along the curve of grazings: the first one is held.
    pub(super) grazing: Vec<usize>,
    pub(super) forward: bool,
    pub(super) backward: bool,
    pub(super) errors: Vec<TraceError>,
}

/// The point that a curve starts from.
#[derive(Default)]
pub(super) struct Origin {
    /// The saved solution that the branch starts from, at a restart.
    pub solution: Option<Solution>,
    /// What the curve one restarts from is made of: its direction means nothing on another curve.
    pub condition: Option<Kind>,
    /// The kind of the special point one restarts from.
    pub kind: Option<Kind>,
    /// The error of its parameter.
    pub error: f64,
    /// How many eigenvalues vanish at the branch point; 0 where that is not known.
    pub multiplicity: usize,
    /// Which of the branches that cross there is taken, if the branch point is left along another
    /// one.
    pub switch: Option<usize>,
}

impl<'a> Continuation<'a> {
    /// A curve of zeros of this system, from `z = 0` and `p = 0` unless told otherwise.
    ///
    /// A system that a branch would change (its mesh, its period, its itinerary) is duplicated: the
    /// caller's stays as it is.
    pub fn of(system: &'a mut dyn System) -> Self {
        let system = SystemRef::Borrowed(system).duplicated();
        let x = vec![0.0; system.names().length()];
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
            origin: Origin::default(),
            beyond: false,
            grazing: Vec::new(),
            forward: true,
            backward: true,
            errors: Vec::new(),
        }
    }

    /// The branch's name.
    pub fn named(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
    }

    /// Settings of the stepper and of Newton's iteration.
    pub fn settings(mut self, settings: Settings) -> Self {
        self.settings = settings;
        self
    }

    /// The unknowns `z` at the start (a guess, corrected with the parameters as given).
    pub fn from(mut self, z: &[f64]) -> Self {
        let n = self.system.names().dimension();
        if z.len() == n {
            self.x[..n].copy_from_slice(z);
        } else {
            self.errors.push(TraceError::StateLength { found: z.len(), expected: n });
        }
        self
    }

    /// A parameter's value at the start.
    pub fn at(mut self, parameter: &str, value: f64) -> Self {
        let n = self.system.names().dimension();
        match self.parameter(parameter) {
            Ok(p) => self.x[n + p] = value,
            Err(error) => self.errors.push(error),
        }
        self
    }

    /// Starts at a special point of a branch: its state, parameters and direction.
    ///
    /// ```
    /// use tangency::core::continuation::{Continuation, Kind};
    /// use tangency::core::dense::Dense;
    /// use tangency::problems::classic::Hyperbola;
    /// // x² = μ²: the branches x = −μ and x = μ cross at 0.
    /// let mut system = Dense::new(Hyperbola);
    /// let curve = Continuation::of(&mut system).from(&[1.0]).at("mu", -1.0);
    /// let branch = curve.along("mu", -1.0..=1.0).trace()?;
    /// let crossing = branch.of_kind(Kind::BP).next().unwrap().label;
    /// let other = Continuation::of(&mut system).restart(&branch, crossing).switch();
    /// let other = other.along("mu", -1.0..=1.0).trace()?;
    /// let end = other.special.last().unwrap();
    /// assert!((end.state[0] - 1.0).abs() < 1e-10 && (end.parameters[0] - 1.0).abs() < 1e-10);
    /// # Ok::<(), tangency::core::continuation::TraceError>(())
    /// ```
    pub fn restart(mut self, branch: &Branch, label: usize) -> Self {
        if let Some(special) = branch.labelled(label).filter(|special| !special.converged) {
            let (branch, kind, error) = (branch.name.clone(), special.kind, special.error);
            self.errors.push(TraceError::NotConverged { branch, label, kind, error });
        }
        self.restart_anyway(branch, label)
    }

    /// As [`restart`](Self::restart), also at a special point that has not converged.
    pub fn restart_anyway(mut self, branch: &Branch, label: usize) -> Self {
        let Some(special) = branch.labelled(label) else {
            let (branch, last) = (branch.name.clone(), branch.special.len());
            self.errors.push(TraceError::Label { branch, label, last });
            return self;
        };
        for (name, value) in branch.parameters.iter().zip(&special.parameters) {
            self = self.at(name, *value);
        }
        self.origin.condition = branch.condition;
        self.origin.kind = Some(special.kind);
        self.origin.multiplicity = special.multiplicity;
        self.origin.error = special.error;
        let n = special.state.len();
        let mut slopes = vec![0.0; self.system.names().parameters.len()];
        let known = special.tangent.len() == n + branch.released.len();
        if known {
            for (name, value) in branch.released.iter().zip(&special.tangent[n..]) {
                if let Some(p) = self.system.names().parameter(name) {
                    slopes[p] = *value;
                }
            }
        }
        let tangent = known.then(|| (special.tangent[..n].to_vec(), slopes));
        self.origin.solution = Some(Solution { tangent, ..branch.solution(special) });
        self
    }

    /// Releases a parameter within a range: the continued one first. The range's length is the
    /// parameter's scale; an end may be infinite.
    pub fn along(mut self, parameter: &str, range: RangeInclusive<f64>) -> Self {
        let range = self.range(parameter, range);
        self.released.push(range);
        self
    }

    /// Bounds a parameter or a monitor: the branch ends there.
    pub fn bound(mut self, name: &str, range: RangeInclusive<f64>) -> Self {
        let range = self.range(name, range);
        self.bounds.push(range);
        self
    }

    /// A range with its name, unless it is empty or not a number.
    fn range(&mut self, name: &str, range: RangeInclusive<f64>) -> (String, [f64; 2]) {
        let (name, (low, high)) = (name.to_string(), range.into_inner());
        if low.partial_cmp(&high) != Some(Ordering::Less) {
            self.errors.push(TraceError::EmptyRange { name: name.clone(), low, high });
        }
        (name, [low, high])
    }

    /// Marks where a parameter or a monitor takes a value, as `UZ`.
    ///
    /// ```
    /// use tangency::core::continuation::{Continuation, Kind};
    /// use tangency::core::dense::Dense;
    /// use tangency::problems::classic::ParallelPlate;
    /// let mut plate = Dense::new(ParallelPlate);
    /// let branch = Continuation::of(&mut plate).along("load", 0.0..=1.0).mark("load", 0.125).trace()?;
    /// // u (1 − u)² = 1/8, before pull-in and after.
    /// let [before, after]: [f64; 2] = [0, 1].map(|k| branch.of_kind(Kind::UZ).nth(k).unwrap().state[0]);
    /// assert!((before - (3.0 - 5.0_f64.sqrt()) / 4.0).abs() < 1e-13 && (after - 0.5).abs() < 1e-13);
    /// # Ok::<(), tangency::core::continuation::TraceError>(())
    /// ```
    pub fn mark(self, name: &str, level: f64) -> Self {
        self.marked(name, level, Kind::UZ)
    }

    fn marked(mut self, name: &str, value: f64, kind: Kind) -> Self {
        if !value.is_finite() {
            let (what, name, range) = ("the mark", name.into(), "finite");
            self.errors.push(TraceError::Value { what, name, value, range });
        }
        self.marks.push((name.into(), value, kind));
        self
    }

    /// Marks where a monitor takes a value at which the solution touches a surface, as `G`.
    ///
    /// ```
    /// # use tangency::core::continuation::{Continuation, Kind};
    /// # use tangency::core::orbit::periodic_orbits;
    /// # use tangency::core::bvp::Shooting;
    /// # use tangency::problems::mita::Block;
    /// let mut orbits = periodic_orbits(Block, 1, Shooting::default()).unwrap();
    /// let branch = Continuation::of(&mut orbits)
    ///     .at("voltage", 0.01).at("frequency", 0.5).at("damping", 0.04)
    ///     .along("voltage", 0.01..=0.3)
    ///     .graze("max_displacement", 0.5)
    ///     .trace()?;
    /// let grazing = branch.of_kind(Kind::G).next().unwrap();
    /// assert!((grazing.parameters[0] - 0.227177583102).abs() < 1e-11);
    /// # Ok::<(), tangency::core::continuation::TraceError>(())
    /// ```
    pub fn graze(self, name: &str, level: f64) -> Self {
        self.marked(name, level, Kind::G)
    }

    /// Goes on beyond grazings, where solutions pass through surfaces: points there are virtual
    /// ([`Point::admissible`](super::Point::admissible)).
    pub fn beyond_grazings(mut self) -> Self {
        self.beyond = true;
        self
    }

    /// Measures a group of unknowns, or a released parameter, by this size instead of the largest
    /// norm that the group has had (or the length of the parameter's range).
    pub fn scale(mut self, name: &str, size: f64) -> Self {
        if !(size.is_finite() && size > 0.0) {
            let (what, name, range) = ("the scale", name.into(), "finite and more than 0");
            self.errors.push(TraceError::Value { what, name, value: size, range });
        }
        self.scales.push((name.into(), size));
        self
    }

    /// Looks for a further event.
    pub fn event(mut self, event: Event) -> Self {
        self.events.push(event);
        self
    }

    /// Leaves the branch point where the curve starts along the *other* branch.
    pub fn switch(self) -> Self {
        self.switch_to(0)
    }

    /// Leaves a branch point where several branches cross (`multiplicity` above 1) along one of
    /// them, counted from 0 and without the one that leads to it; or a grazing at which several
    /// guards are touched along the branch whose orbits pass all of them (0), or each by itself, in
    /// the order of the touches, then each pair, and so on.
    pub fn switch_to(mut self, which: usize) -> Self {
        self.origin.switch = Some(which);
        self
    }

    /// Traces only in the direction in which the (last released) parameter grows.
    pub fn forward(mut self) -> Self {
        self.backward = false;
        self
    }

    /// Traces only in the direction in which the (last released) parameter falls.
    pub fn backward(mut self) -> Self {
        self.forward = false;
        self
    }

    /// Traces the curve.
    ///
    /// # Errors
    /// [`TraceError`] if it cannot begin. Whatever happens later ends the branch with a reason
    /// ([`Branch::ends`]) and keeps what there is.
    pub fn trace(self) -> Result<Branch, TraceError> {
        Ok(self.steps()?.run(&mut ()))
    }

    /// Begins to trace the curve, point by point, or at once with an observer ([`Steps::run`]).
    ///
    /// # Errors
    /// As [`trace`](Continuation::trace).
    pub fn steps(mut self) -> Result<Steps<'a>, TraceError> {
        self.settings.check()?;
        if !self.errors.is_empty() {
            return Err(self.errors.swap_remove(0));
        }
        self.prepare()
    }
}
