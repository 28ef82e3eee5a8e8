//! Search for all equilibria, fixed points or zeros of a scene's problem in a box, for `tangency
//! find`.

use super::discretisation::{SOLUTION, Solution};
use super::error::{ProblemError, SceneError};
use super::notation::written;
use super::problem::Problem;
use super::request::{Request, SearchBox};
use super::statement::{Range, Run, Scene, Start};
use crate::core::continuation::{RootSearch, Roots};
use crate::core::problem::{Forcing, position};

/// The solutions that a search in a box found, with the names of the unknowns.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The names of the unknowns, in the order in which a solution lists its components.
    pub unknowns: Vec<String>,
    /// The solutions.
    pub roots: Roots,
}

impl Scene {
    /// Finds equilibria of a vector field or of a mode, fixed points or cycles of a map, or zeros
    /// in a box: Newton's method starts at many points of the box, and known solutions are removed
    /// by deflation ([`RootSearch`]).
    ///
    /// ```
    /// use tangency::scene::{Range, Request, Scene, SearchBox};
    /// let scene = Scene::parse("Scene(title: \"t\", problem: Equations(states: [(\"x\", \"y\"), (\"y\", \"x - x^3 - d*y\")]),
    ///     parameters: [(\"d\", 0.1)], runs: [(name: \"r\", along: [(name: \"d\", low: 0, high: 1)])])")?;
    /// let range = |name: &str| Range { name: name.into(), low: Some(-2.0), high: Some(2.0) };
    /// let within = Some(SearchBox { ranges: vec![range("x"), range("y")], starts: 50 });
    /// let found = scene.find(&Request { within, ..Request::default() })?;
    /// let at: Vec<f64> = found.roots.roots.iter().map(|root| root.unknowns[0].round()).collect();
    /// assert_eq!((found.unknowns, at), (vec!["x".to_string(), "y".into()], vec![-1.0, 0.0, 1.0]));
    /// # Ok::<(), tangency::scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// The errors of [`set`](Self::set); [`SceneError`] if the problem is discretised, or if the
    /// box does not state the range of an unknown.
    pub fn find(mut self, request: &Request) -> Result<Found, SceneError> {
        self.settings.cancel = request.cancel.clone();
        self.set_all(&request.set)?;
        match &request.within {
            Some(within) => within.search(self),
            None => Err(no_box("the box is missing".into())),
        }
    }
}

impl SearchBox {
    /// Finds the equilibria, fixed points or zeros of a scene's problem in the box.
    fn search(&self, mut scene: Scene) -> Result<Found, SceneError> {
        refuse_forced(&scene.problem)?;
        scene.problem.follow(Solution::Equilibrium);
        let p = scene.values()?;
        let mut system = scene.problem.model().system(&p, &p)?;
        let names = system.names();
        if names.unknowns.iter().any(|group| group.length != group.count()) {
            return Err(scene.problem.model().lacks(
                "a box can be searched only for problems whose unknowns are single numbers",
                "start a branch at a profile or at a given state instead",
            ));
        }
        let unknowns: Vec<String> = names.elements().collect();
        let within = self.intervals(&unknowns)?;
        let cancel = scene.settings.cancel.clone();
        let search = RootSearch { starts: self.starts, cancel, ..RootSearch::default() };
        let roots = search.find(&mut *system, &p, &within).map_err(ProblemError::new)?;
        Ok(Found { unknowns, roots })
    }

    /// Returns the interval of each unknown in the box.
    fn intervals(&self, unknowns: &[String]) -> Result<Vec<[f64; 2]>, SceneError> {
        for range in &self.ranges {
            position("component", &range.name, unknowns)?;
        }
        let interval = |name: &String| match self.ranges.iter().find(|range| range.name == *name) {
            Some(&Range { low: Some(low), high: Some(high), .. }) if low < high => Ok([low, high]),
            _ => {
                Err(no_box(format!("the box needs a range for `{name}` with the lower end first")))
            }
        };
        unknowns.iter().map(interval).collect()
    }
}

/// Returns an error if the motion of a problem has a forcing, and therefore no equilibria.
fn refuse_forced(problem: &Problem) -> Result<(), SceneError> {
    match problem.model().motion() {
        Ok(motion) if motion.forcing() != Forcing::None => Err(SceneError::invalid(
            "the search in a box finds equilibria, but forced systems have no equilibria",
        )
        .with_help(
            "find orbits by a sweep over initial states, as in `tangency sweep MODEL --over x=-1..1:11`",
        )),
        _ => Ok(()),
    }
}

/// Replaces the first run of a scene by one run for each solution found in a box. Solutions are
/// searched at several values of the continuation parameter in its range, because a branch need not
/// exist at the initial value of the parameter.
pub(super) fn begin_everywhere(scene: &mut Scene, within: &SearchBox) -> Result<(), SceneError> {
    let Some(first) = scene.runs.first() else { return Ok(()) };
    let Some(range) = first.along.first() else {
        return Err(SceneError::invalid(
            "the option `--start all` needs a branch, but the first run of the scene is a \
             simulated history",
        ));
    };
    let mut found: Vec<Run> = Vec::new();
    for value in searched(range, scene.value(&range.name)) {
        let mut set = first.set.clone();
        set.retain(|(name, _)| *name != range.name && name != SOLUTION);
        set.push((range.name.clone(), value.to_string()));
        let Found { unknowns, roots } = within.search(scene.with(&set)?)?;
        if scene.problem.solution().is_some_and(|it| it != Solution::Equilibrium) {
            set.push((SOLUTION.into(), written(&Solution::Equilibrium)));
        }
        for root in roots.roots {
            let name = match found.len() {
                0 => first.name.clone(),
                count => format!("{} {}", first.name, count + 1),
            };
            let start = Start::Guess(unknowns.iter().cloned().zip(root.unknowns).collect());
            found.push(Run { name, start, set: set.clone(), ..first.clone() });
        }
    }
    if found.is_empty() {
        return Err(SceneError::invalid(
            "no solution at which a branch starts was found in the box",
        )
        .with_help("give a larger box, or more starting points"));
    }
    // The solutions decide whether the branch passes through another start.
    scene.settings.keep_solutions = true;
    scene.runs.splice(..1, found);
    Ok(())
}

/// The number of parameter values at which solutions are searched, in addition to the parameter's
/// initial value.
const VALUES: usize = 8;

/// Returns the parameter values at which solutions are searched: several values in the parameter's
/// range if the range is finite, followed by the initial value of the parameter. The chosen values
/// in the range are not round numbers, because special points often have round parameter values and
/// no branch should start at a special point.
fn searched(range: &Range, own: Option<f64>) -> Vec<f64> {
    let place = |k: usize| (k as f64 + 0.618_033_988_749_895) / VALUES as f64;
    let mut values: Vec<f64> = range.low.zip(range.high).map_or(Vec::new(), |(low, high)| {
        (0..VALUES).map(|k| low + place(k) * (high - low)).collect()
    });
    values.extend(own.map(|own| range.nearest(own)).or(range.low).or(range.high));
    values
}

fn no_box(found: String) -> SceneError {
    SceneError::invalid(found).with_help(
        "give a range for each unknown, with the lower end first, as in `--box x=-3..3,y=0..5`",
    )
}
