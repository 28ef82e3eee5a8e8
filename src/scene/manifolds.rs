//! Stable and unstable manifolds of a saddle of a scene's map, as branches, for `tangency
//! manifolds`.

use super::error::SceneError;
use super::plane::PlaneMap;
use super::request::Request;
use super::resolve::StartPoint;
use super::statement::Scene;
use crate::core::continuation::{Branch, Number, Point, Settings, SpecialPoint};
use crate::core::failure::one_line;
use crate::core::manifold::{
    ARCLENGTH, Half, Manifold, ManifoldError, ManifoldPoint, ManifoldSettings, Side,
};
use crate::core::problem::{Group, position};
use crate::core::spelling::listed;
use crate::core::system::Kind;
use crate::output::{Document, Plot};

/// The request that specifies which manifolds to compute, and how.
#[derive(Clone, Debug, Default)]
pub struct Manifolds {
    /// The point of an earlier result at which the saddle lies; `None` if the saddle should be
    /// searched near the states of the request.
    pub start: Option<StartPoint>,
    /// The settings of the computation, such as the maximum length and the resolution.
    pub settings: ManifoldSettings,
}

/// The name of the number that measures the accuracy of one half of a manifold: the largest
/// distance between the image of a computed point and the computed curve.
pub const DEVIATION: &str = "deviation";

/// The name of the number that contains the error of the local expansion of the manifold at the
/// saddle.
const LOCAL_ERROR: &str = "local_error";

/// The name of the computation of manifolds in error messages.
const RUN: &str = "manifolds";

impl Scene {
    /// Computes the unstable and the stable manifold of a saddle of the scene's map, as branches.
    /// The columns of these branches are the states and the arclength from the saddle, which is
    /// negative on one half of the manifold. The saddle has the label 2, the ends of the manifold
    /// have the labels 1 and 3, and each end has the number `deviation`, which measures the
    /// accuracy of its half.
    ///
    /// ```
    /// use std::path::Path;
    /// use tangency::core::manifold::ManifoldSettings;
    /// use tangency::scene::{Manifolds, Problem, Request, Scene};
    /// let henon = "Map(states: [(\"x\", \"1 - a*x^2 + y\"), (\"y\", \"b*x\")], parameters: [(\"a\", 1.4), (\"b\", 0.3)])";
    /// let henon = Problem::from_text(Path::new("henon.ron"), henon, &[])?;
    /// let scene = Scene::of_problem(henon, "Hénon", &Request::default());
    /// let request = Request { state: vec![("x".into(), 0.6), ("y".into(), 0.2)], ..Request::default() };
    /// let settings = ManifoldSettings { length: 2.0, ..ManifoldSettings::default() };
    /// let document = scene.manifolds(&request, &Manifolds { settings, ..Manifolds::default() })?;
    /// let names: Vec<&str> = document.branches.iter().map(|branch| branch.name.as_str()).collect();
    /// assert_eq!(names, ["unstable manifold", "stable manifold"]);
    /// assert!((document.branches[0].special[1].monitors[0] - 0.6313544770895).abs() < 1e-12);
    /// # Ok::<(), tangency::scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// The errors of [`set`](Self::set); [`SceneError`] if the problem is not a map, if a bound
    /// names an unknown state, if the start point belongs to another problem, or if the map has no
    /// saddle.
    pub fn manifolds(
        mut self,
        request: &Request,
        wanted: &Manifolds,
    ) -> Result<Document, SceneError> {
        if let Some(start) = &wanted.start {
            self.parameters.splice(..0, parameters_of(start)?);
        }
        let scene = self.with(&request.set)?;
        let p = scene.values()?;
        let map = scene.problem.model().plane()?;
        let states = map.states();
        let given = match &wanted.start {
            Some(start) => states_of(start, &states)?,
            None => begun(&states, &request.state, &scene.problem.initial(&p))?,
        };
        let mut settings = wanted.settings.clone();
        settings.cancel = request.cancel.clone();
        for range in &request.bounds {
            let axis = position("state", &range.name, &states)?;
            if let Some(bound) = settings.bounds.get_mut(axis) {
                *bound = [*range.interval().start(), *range.interval().end()];
            }
        }
        let (manifolds, warning) = both(map, &given, &p, &settings)?;
        let names = scene.problem.parameter_names();
        let of_side = |all: &Vec<Manifold>| -> Vec<Branch> {
            let numbered = all.iter().enumerate();
            numbered.map(|(k, it)| branch(it, &states, (&names, &p), (k, all.len()))).collect()
        };
        let mut branches: Vec<Branch> = manifolds.iter().flat_map(of_side).collect();
        branches.iter_mut().for_each(|branch| branch.warnings.extend(warning.clone()));
        let [x, y] = [states.first(), states.get(1)].map(|name| name.cloned());
        let scene = Scene { plot: Plot { x, y, ..Plot::default() }, ..scene };
        Ok(scene.resolve(None)?.document(std::iter::empty(), branches))
    }
}

/// Computes both manifolds of the saddle; if no stable manifold exists, returns the reason.
fn both(
    map: &dyn PlaneMap,
    states: &[f64],
    p: &[f64],
    settings: &ManifoldSettings,
) -> Result<([Vec<Manifold>; 2], Option<String>), SceneError> {
    let failed = |cause| SceneError::of_run(RUN, cause);
    let unstable = map.manifold(states, p, Side::Unstable, settings).map_err(failed)?;
    Ok(match map.manifold(states, p, Side::Stable, settings) {
        Err(cause @ ManifoldError::NoInverse { .. }) => {
            ([unstable, Vec::new()], Some(format!("no stable manifold: {}", one_line(&cause))))
        }
        stable => ([unstable, stable.map_err(failed)?], None),
    })
}

/// Returns the parameter values at the start point, except the values of parameters that are
/// changed at the start.
fn parameters_of(start: &StartPoint) -> Result<Vec<(String, f64)>, SceneError> {
    let values = labelled(start)?.parameters.iter().copied();
    let all = start.branch.parameters.iter().cloned().zip(values);
    Ok(all.filter(|(name, _)| !start.changed.contains(name)).collect())
}

fn labelled(start: &StartPoint) -> Result<&SpecialPoint, SceneError> {
    start.branch.labelled(start.label).ok_or_else(|| {
        let (branch, label) = (&start.branch.name, start.label);
        SceneError::invalid(format!(
            "the branch `{branch}` has no special point with the label {label}"
        ))
    })
}

/// Returns the states of the cycle at a special point, one iterate after another.
fn states_of(start: &StartPoint, states: &[String]) -> Result<Vec<f64>, SceneError> {
    let z = &labelled(start)?.state;
    let groups = start.branch.unknowns.iter();
    let iterates = groups.clone().map(|group| group.length / group.count()).min().unwrap_or(0);
    let names: Vec<String> = groups.clone().flat_map(Group::elements).collect();
    let same = names == states
        && groups.clone().all(|group| group.length == iterates * group.count())
        && z.len() == iterates * states.len();
    if !same {
        let (point, map) = (listed(&names), listed(states));
        return Err(SceneError::invalid(format!(
            "the start point has the unknowns {point}, but the map has the states {map}"
        )));
    }
    let state = |k: usize, i: usize| z[i * iterates + k];
    Ok((0..iterates).flat_map(|k| (0..states.len()).map(move |i| state(k, i))).collect())
}

/// Returns the given states, or the initial states of the problem if no states are given.
fn begun(
    states: &[String],
    given: &[(String, f64)],
    initial: &[(String, f64)],
) -> Result<Vec<f64>, SceneError> {
    for (name, _) in given {
        position("state", name, states)?;
    }
    let value = |state: &String| {
        let mut all = given.iter().chain(initial);
        all.find(|(name, _)| name == state).map_or(0.0, |(_, value)| *value)
    };
    Ok(states.iter().map(value).collect())
}

/// Converts a manifold of a saddle into a branch that leads from the end of one half through the
/// saddle to the end of the other half.
fn branch(
    manifold: &Manifold,
    states: &[String],
    (parameters, p): (&[String], &[f64]),
    (k, iterates): (usize, usize),
) -> Branch {
    let which = match manifold.side {
        Side::Unstable => "unstable manifold",
        Side::Stable => "stable manifold",
    };
    let several = iterates > 1;
    let name = if several { format!("{which} {}", k + 1) } else { which.into() };
    let [back, forth] = &manifold.halves;
    let at = |sign: f64| move |it: &ManifoldPoint| vec![it.at[0], it.at[1], sign * it.arclength];
    let saddle = vec![manifold.saddle[0], manifold.saddle[1], 0.0];
    let rows = back.points.iter().rev().map(at(-1.0)).chain([saddle]);
    let rows: Vec<Vec<f64>> = rows.chain(forth.points.iter().map(at(1.0))).collect();
    let special = special(manifold, &rows, p, several.then_some(k + 1));
    let points = rows.into_iter().map(|row| Point::new(p.to_vec(), row, None)).collect();
    Branch {
        name,
        condition: None,
        itinerary: String::new(),
        method: String::new(),
        unknowns: Vec::new(),
        released: Vec::new(),
        parameters: parameters.to_vec(),
        monitors: states.iter().cloned().chain([ARCLENGTH.into()]).collect(),
        points,
        special,
        stretches: Vec::new(),
        ends: [back.end.clone(), forth.end.clone()],
        warnings: Vec::new(),
        settings: Settings::default(),
    }
}

/// Returns the special points of a manifold's branch: both ends, and the saddle between the ends.
fn special(
    manifold: &Manifold,
    rows: &[Vec<f64>],
    p: &[f64],
    number: Option<usize>,
) -> Vec<SpecialPoint> {
    let [back, forth] = &manifold.halves;
    let saddle = number.map_or("saddle".into(), |number| format!("saddle {number}"));
    let at = |label: usize, index: usize, special: SpecialPoint| SpecialPoint {
        label,
        after: index,
        parameters: p.to_vec(),
        monitors: rows[index].clone(),
        bracket: [p.first().copied().unwrap_or_default(); 2],
        ..special
    };
    let end = |half: &Half| {
        let deviation = |value| Number { name: DEVIATION.into(), value, error: 0.0 };
        let numbers = half.deviation.map(deviation).into_iter().collect();
        SpecialPoint { numbers, ..SpecialPoint::new(Kind::EP, "end of the manifold") }
    };
    let local = Number { name: LOCAL_ERROR.into(), value: manifold.local_error, error: 0.0 };
    let middle = SpecialPoint {
        unstable: Some(1),
        eigenvalues: [manifold.multiplier, manifold.other].map(|value| (value, 0.0)).into(),
        numbers: vec![local],
        ..SpecialPoint::new(Kind::UZ, saddle)
    };
    vec![at(1, 0, end(back)), at(2, back.points.len(), middle), at(3, rows.len() - 1, end(forth))]
}
