//! All equilibria, fixed points or zeros of a scene's problem in a box.

use super::discretisation::SOLUTION;
use super::error::{ProblemError, SceneError};
use super::request::Request;
use super::statement::{Range, Scene};
use crate::core::continuation::{RootSearch, Roots};
use crate::core::problem::position;

/// What was found, with the names of the unknowns.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The unknowns, in the order of the components of solutions.
    pub unknowns: Vec<String>,
    /// The solutions.
    pub roots: Roots,
}

impl Scene {
    /// All equilibria of a field or of a mode, all fixed points or cycles of a map, or all zeros in a
    /// box: those to which Newton's method leads from starts all over it, where the solutions found
    /// before are taken out of the equations ([`RootSearch`]).
    ///
    /// ```
    /// use tangency::scene::{Range, Request, Scene};
    /// let scene = Scene::parse("Scene(title: \"t\", problem: Equations(states: [(\"x\", \"y\"), (\"y\", \"x - x^3 - d*y\")]),
    ///     parameters: [(\"d\", 0.1)], runs: [(name: \"r\", along: [(name: \"d\", low: 0, high: 1)])])")?;
    /// let range = |name: &str| Range { name: name.into(), low: Some(-2.0), high: Some(2.0) };
    /// let found = scene.find(&Request::default(), &[range("x"), range("y")], 50)?;
    /// let at: Vec<f64> = found.roots.roots.iter().map(|root| root.unknowns[0].round()).collect();
    /// assert_eq!((found.unknowns, at), (vec!["x".to_string(), "y".into()], vec![-1.0, 0.0, 1.0]));
    /// # Ok::<(), tangency::scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// As [`set`](Self::set); [`SceneError`] for a problem that is discretised, and for a box that
    /// lacks a range.
    pub fn find(
        mut self,
        request: &Request,
        within: &[Range],
        starts: usize,
    ) -> Result<Found, SceneError> {
        self.set_all(&request.set)?;
        if self.problem.solution().is_some() {
            self.problem.set(SOLUTION, "equilibrium")?;
        }
        let p = self.values()?;
        let mut system = self.problem.model().system(&p, &p)?;
        let groups = &system.names().unknowns;
        if groups.iter().any(|group| group.length != 1) {
            return Err(self.problem.model().lacks("only single unknowns have a box"));
        }
        let unknowns: Vec<String> = groups.iter().map(|group| group.name.clone()).collect();
        for range in within {
            position("component", &range.name, &unknowns)?;
        }
        let interval = |name: &String| match within.iter().find(|range| range.name == *name) {
            Some(&Range { low: Some(low), high: Some(high), .. }) if low < high => Ok([low, high]),
            _ => {
                let rule = "needs a range for each unknown, its low end first, as in `--box x=-3..3,y=0..5`";
                Err(SceneError::invalid("the box", format!("without one for `{name}`"), rule))
            }
        };
        let within = unknowns.iter().map(interval).collect::<Result<Vec<_>, _>>()?;
        let search = RootSearch { starts, cancel: request.cancel.clone(), ..RootSearch::default() };
        let roots = search.find(&mut *system, &p, &within);
        let roots = roots.map_err(ProblemError::new)?;
        Ok(Found { unknowns, roots })
    }
}
