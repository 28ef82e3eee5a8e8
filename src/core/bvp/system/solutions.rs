//! Solutions of a discretised problem, without their linearisation.

use super::discretisation::DiscretisedProblem;
use super::monitors::Monitors;
use super::phase::Phase;
use super::profiles::profiles;
use super::work::{Work, gather_ends};
use crate::core::bvp::terms::Ends;
use crate::core::failure::Failure;
use crate::core::problem::Profile;
use crate::core::system::System;

/// A solution at a limit of admissible solutions, converted to the system of the solutions on the
/// other side of the limit.
pub(super) struct Beside {
    /// The solution of the current system, at the limit of admissible solutions.
    pub at: Vec<f64>,
    pub system: Box<dyn System>,
    pub x: Vec<f64>,
    /// Whether the solution passes an event that does not occur in the solutions on the other side
    /// of the limit.
    pub passes: bool,
}

/// A discretised problem with its reference solutions and its monitors.
pub(super) struct Solutions {
    pub equations: DiscretisedProblem,
    pub phase: Phase,
    pub monitors: Monitors,
    /// The solution that was loaded last.
    pub plain: Work<f64>,
    /// The point whose accurate residual is stored in `plain`; empty if `plain` does not contain an
    /// accurate residual.
    evaluated: Vec<f64>,
    /// Whether the problem has already determined the properties that stay fixed along the whole
    /// branch.
    referred: bool,
    /// The last computed solution on the other side of a limit of admissible solutions.
    pub beside: Option<Beside>,
}

impl Solutions {
    pub fn new(equations: DiscretisedProblem) -> Self {
        Solutions {
            phase: Phase::default(),
            monitors: Monitors::new(&equations),
            plain: Work::new(&equations.layout),
            evaluated: Vec::new(),
            referred: false,
            beside: None,
            equations,
        }
    }

    /// Copies, from solutions on another mesh, the flag whether the problem has already determined
    /// the properties that stay fixed along the whole branch.
    pub fn refers_to_problem_of(&mut self, other: &Solutions) {
        self.referred = other.referred;
    }

    /// Uses the first point at which the equations are evaluated as the reference of the problem
    /// and of the phase condition, unless a reference is already set.
    pub fn refer(&mut self, x: &[f64]) -> Result<(), Failure> {
        let Solutions { equations, plain, .. } = self;
        if !self.referred {
            plain.load(&equations.layout, |i| x[i]);
            gather_ends(&equations.layout, &plain.nodes, &mut plain.ends);
            let (start, end) = plain.ends.split_at(equations.layout.states);
            self.referred = equations.problem.refer(Ends { start, end }, &plain.q);
        }
        if equations.layout.phase && self.phase.reference.is_empty() {
            self.set_reference(x)?;
        }
        Ok(())
    }

    /// Makes a solution the reference of the phase condition.
    pub fn set_reference(&mut self, x: &[f64]) -> Result<(), Failure> {
        self.forget();
        self.phase.refer_to(&self.equations, x, &mut self.plain)
    }

    /// Discards cached evaluations, which belong to the equations before a change.
    pub fn forget(&mut self) {
        self.evaluated.clear();
        self.monitors.mesh_error.forget();
    }

    /// Computes all left-hand sides of the equations.
    pub fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<(), Failure> {
        let Solutions { equations, phase, monitors, plain, evaluated, .. } = self;
        if evaluated != x {
            evaluated.clear();
            plain.load(&equations.layout, |i| x[i]);
            monitors.residual(equations, phase, plain)?;
            equations.check(&plain.r, &plain.q)?;
            if !equations.rough {
                evaluated.extend_from_slice(x);
            }
        }
        r.copy_from_slice(&plain.r);
        Ok(())
    }

    /// Loads a solution.
    pub fn load(&mut self, x: &[f64]) {
        self.plain.load(&self.equations.layout, |i| x[i]);
    }

    /// Computes the value of a monitor for the solution that was loaded last.
    pub fn monitor(&mut self, monitor: usize) -> Result<f64, Failure> {
        self.monitors.evaluate(&mut self.equations, monitor, &mut self.plain)
    }

    /// Estimates the mesh error of a solution.
    pub fn mesh_error(&mut self, x: &[f64]) -> f64 {
        self.load(x);
        self.monitors.mesh_error.of(&self.equations, &self.plain)
    }

    /// Returns time histories and phase portraits; empty if the solution leaves the domain of its
    /// vector field.
    pub fn profiles(&mut self, x: &[f64]) -> Vec<Profile> {
        self.load(x);
        profiles(&self.equations, &mut self.plain).unwrap_or_default()
    }
}
