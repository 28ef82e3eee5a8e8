//! A boundary-value problem, discretised, as a [`System`].

mod adaptation;
mod carry;
mod closed;
mod derivatives;
mod discretisation;
mod events;
mod extremes;
mod face;
mod factorisation;
mod factors;
mod joined;
mod joints;
mod layout;
mod linearisation;
mod liouville;
mod local;
mod mesh_error;
mod monitors;
mod periodic;
mod phase;
mod profiles;
mod residual;
mod start;
mod work;

use super::{BoundaryError, Equations, IntoEquations, Itineraries, Mesh, Method};
use crate::core::chunk::Chunk;
use crate::core::failure::Failure;
use crate::core::linear::{Condensed, CondensedLu};
use crate::core::zero::{Border, Group, Names};
use derivatives::Derivatives;
use discretisation::Discretisation;
use events::Beside;
use factorisation::Condensation;
use layout::Layout;
use linearisation::{Bordered, Form, Linearisation};
use local::{Numbers, Passes};
use monitors::Monitors;
use phase::Phase;
use std::convert::Infallible;
use std::sync::Arc;
use work::Work;

/// No segment is refined beyond this number of intervals: rounding would take over.
const MOST_INTERVALS: usize = 4096;
/// Nor is it refined more often than this: with every rung of a ladder of high order come many
/// digits, so that what has not settled by then is rounding.
const MOST_REFINEMENTS: usize = 5;

/// A boundary-value problem, discretised by a method on one mesh for each segment.
///
/// Unknowns `z`: for each segment and each state a group of values at the segment's nodes
/// (`N·m + 1` of them for `N` intervals with `m` nodes beyond the first), then one scalar group for
/// each extra. Equations: those of all intervals, boundary conditions, integral conditions, the
/// phase condition. The Jacobian is never formed: chains of intervals are condensed to their ends
/// at a cost linear in the number of intervals.
///
/// Monitors are those of the problem and, where the mesh causes an error, its estimate
/// `mesh_error`.
///
/// ```
/// use tangency::core::bvp::{BoundarySystem, Collocation, Mesh};
/// use tangency::core::continuation::{Continuation, Kind};
/// use tangency::problems::classic::Bratu;
/// let mut bratu = BoundarySystem::new(Bratu, Collocation::new(4)?, vec![Mesh::uniform(10)])?;
/// let branch = Continuation::of(&mut bratu)
///     .at("lambda", 0.5)
///     .along("lambda", 0.0..=4.0)
///     .bound("max_u", 0.0..=3.0)
///     .trace()?;
/// let fold = branch.of_kind(Kind::LP).next().unwrap();
/// assert!((fold.parameters[0] - 3.51383071912516).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct BoundarySystem {
    equations: Discretisation,
    phase: Phase,
    monitors: Monitors,
    names: Names,
    linearisation: Linearisation,
    /// For multipliers.
    condensed: CondensedLu<Condensation>,
    pencil: [Vec<f64>; 2],
    /// The count of the assembly that the pencil was reduced from; 0 for none.
    pencil_of: usize,
    /// How the returns depend on each other, one row after the other, and the right side of a
    /// solution.
    returned: Vec<f64>,
    right: Vec<f64>,
    /// The sign of the leading coefficient of the multipliers' polynomial.
    orientation: f64,
    plain: Work<f64>,
    /// Where `plain` holds the accurate residual; empty if it is none.
    evaluated: Vec<f64>,
    chunk: Passes<Chunk>,
    derivatives: Derivatives,
    /// Monitors that are positive on admissible solutions.
    limits: Vec<usize>,
    /// What a gradient is taken by.
    numbers: Numbers,
    /// The solution that grazes as one of the others that do.
    beside: Option<Beside>,
    /// Whether the problem has taken its reference.
    referred: bool,
    /// How many points of a branch were followed.
    followed: usize,
    /// How often the system was refined to become this one.
    refinements: usize,
}

impl BoundarySystem {
    /// The system of a problem on one mesh for each segment.
    ///
    /// # Errors
    /// [`BoundaryError`] if numbers of segments, states, conditions and unknowns do not fit
    /// together.
    pub fn new(
        problem: impl IntoEquations,
        method: impl Into<Method>,
        meshes: Vec<Mesh>,
    ) -> Result<Self, BoundaryError> {
        let mut method = method.into();
        let cancel = method.cancel().clone();
        let equations = Discretisation::new(problem.into_equations(), method, meshes)?;
        let Discretisation { problem, method, layout, .. } = &equations;
        let active = (layout.parameters..layout.parameters + layout.own()).collect();
        let names = names_of(&**problem, method, layout);
        Ok(BoundarySystem {
            names,
            linearisation: Linearisation { active, cancel, ..Default::default() },
            condensed: CondensedLu::new(Condensation::new(layout)),
            pencil: Default::default(),
            pencil_of: 0,
            returned: Vec::new(),
            right: Vec::new(),
            orientation: 1.0,
            plain: Work::new(layout),
            evaluated: Vec::new(),
            chunk: Passes::new(layout),
            derivatives: Derivatives::new(layout),
            phase: Phase::default(),
            monitors: Monitors::new(&equations),
            limits: equations.problem.itineraries().map_or_else(Vec::new, Itineraries::grazings),
            numbers: Numbers::default(),
            beside: None,
            referred: false,
            followed: 0,
            refinements: 0,
            equations,
        })
    }

    /// The problem itself.
    pub fn problem(&self) -> &Arc<dyn Equations> {
        &self.equations.problem
    }

    /// The mesh of each segment.
    pub fn meshes(&self) -> &[Mesh] {
        &self.equations.meshes
    }

    /// The unknowns `z` of trajectories that are given: `states` writes the states of a segment at
    /// a time in units of the segment's duration.
    ///
    /// ```
    /// # use tangency::core::{bvp::*, zero::System};
    /// # use tangency::problems::classic::Decay;
    /// // x' = −rate·x, x(0) = 1.
    /// let mut system = BoundarySystem::new(Decay, Collocation::new(3)?, vec![Mesh::uniform(4)])?;
    /// let z = system.sampled(&[], |_, tau, x| x[0] = tau * tau);
    /// // Four intervals of three nodes, and the last one.
    /// assert_eq!((z.len(), z[0], z[12]), (13, 0.0, 1.0));
    /// let x = [&z[..], &[1.0]].concat();
    /// assert!((system.states(&x, 0, 0.3)?[0] - 0.09).abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn sampled(
        &self,
        extras: &[f64],
        mut states: impl FnMut(usize, f64, &mut [f64]),
    ) -> Vec<f64> {
        let Ok(mut z) = self.equations.sampled(extras, |segment, tau, x| {
            states(segment, tau, x);
            Ok::<(), Infallible>(())
        });
        z.resize(self.equations.layout.dimension, 0.0);
        z
    }

    /// The states of a segment at a time in units of the segment's duration.
    ///
    /// # Errors
    /// [`Failure::OutOfDomain`] where the trajectory leaves the domain of the field, or if there is
    /// no such segment.
    pub fn states(&mut self, x: &[f64], segment: usize, tau: f64) -> Result<Vec<f64>, Failure> {
        let layout = &self.equations.layout;
        let Some(s) = layout.segments.get(segment) else {
            let count = layout.segments.len();
            return Err(Failure::Mismatch(format!(
                "there is no segment {segment}, counted from 0, of {count}"
            )));
        };
        let mut out = vec![0.0; s.states];
        self.plain.load(layout, |i| x[i]);
        self.equations.value(&mut self.plain, segment, tau, &mut out)?;
        Ok(out)
    }

    /// The same problem by the same method on other meshes.
    fn on(&self, meshes: Vec<Mesh>) -> Result<Self, BoundaryError> {
        BoundarySystem::new(self.problem().clone(), self.equations.method.clone(), meshes)
    }

    /// Makes a solution the reference of the phase condition. Without one, it is the first point at
    /// which the equations are evaluated.
    ///
    /// # Errors
    /// [`Failure::OutOfDomain`] where the field has no meaning at the nodes.
    pub fn set_reference(&mut self, x: &[f64]) -> Result<(), Failure> {
        self.forget();
        self.phase.refer_to(&self.equations, x, &mut self.plain)
    }

    /// The equations of the first segment, assembled last, condensed to its ends:
    /// `P δx(0) + Q δx(1) = 0` with `n × n` matrices `P` and `Q`, one row after the other. The
    /// multipliers of a periodic solution are those of this pencil.
    ///
    /// # Errors
    /// [`Failure::Singular`] if the equations of some interval do not determine what is inside it,
    /// [`Failure::Mismatch`] if nothing is assembled.
    ///
    /// ```
    /// # use tangency::core::{bvp::*, zero::System};
    /// # use tangency::problems::classic::Decay;
    /// // x' = −rate·x, x(0) = 1.
    /// let mut system = BoundarySystem::new(Decay, Collocation::new(3)?, vec![Mesh::uniform(4)])?;
    /// let mut x = system.sampled(&[], |_, tau, x| x[0] = (-tau).exp());
    /// x.push(1.0);
    /// system.assemble(&x)?;
    /// let (p, q) = system.reduced_pencil()?;
    /// assert!((-p[0] / q[0] - (-1.0_f64).exp()).abs() < 1e-8);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn reduced_pencil(&mut self) -> Result<(&[f64], &[f64]), Failure> {
        let (layout, assembled): (&Layout, _) = (&self.equations.layout, &self.linearisation);
        if assembled.at.is_empty() {
            return Err(Failure::Mismatch(
                "nothing is assembled that multipliers could be of".into(),
            ));
        }
        if self.pencil_of != assembled.count {
            let (form, border) = (Form::Jacobian, Border::NONE);
            let condensation = &mut self.condensed.condensed;
            condensation.condense(Bordered { layout, assembled, form, border })?;
            condensation.pencil(assembled, &mut self.pencil);
            self.pencil_of = assembled.count;
        }
        let [p, q] = &self.pencil;
        Ok((p, q))
    }
}

/// Names of unknowns, parameters and monitors. States of several segments that share a name are
/// told apart by the segment's number.
fn names_of(problem: &dyn Equations, method: &Method, layout: &Layout) -> Names {
    let segments = problem.segments();
    let mut unknowns = Vec::new();
    for (s, states) in segments.iter().enumerate() {
        for state in states {
            let shared = segments.iter().flatten().filter(|other| *other == state).count() > 1;
            let name = if shared { format!("{state}[{s}]") } else { state.clone() };
            unknowns.push(Group { name, length: layout.segments[s].nodes });
        }
    }
    unknowns.extend(problem.extras().into_iter().map(|name| Group { name, length: 1 }));
    let monitors = problem.monitors().into_iter().map(|(name, _)| name);
    let mesh_error = method.error_constant().map(|_| monitors::MESH_ERROR.to_string());
    Names::new(unknowns, problem.parameters()).with_monitors(monitors.chain(mesh_error))
}
