//! Correction of earlier branches for changed parameter values, at a few points of each branch: a
//! quick picture of branches that are then traced again.

use super::error::SceneError;
use super::resolve::{Resolution, Resolved};
use super::statement::{Run, Scene};
use super::trace::conditions;
use crate::core::continuation::{Branch, Continuation, Point, Settings, Slopes, Traced};
use crate::core::system::System;
use std::sync::Arc;
use std::time::Instant;

/// The number of points of each branch that are corrected.
const POINTS: usize = 30;

/// Branches of a scene whose points contain their solutions, so that the branches can be corrected
/// for other parameter values.
#[derive(Clone, Debug)]
pub struct Correctable {
    /// The scene, with the runs that trace the branches.
    scene: Arc<Scene>,
    /// The branches, with at most 30 regular points each and without special points.
    branches: Vec<Branch>,
}

impl Correctable {
    /// Selects points of the branches of a scene, and removes the solutions from all other points.
    /// A branch can be corrected if it was traced with
    /// [`keep_solutions`](Settings::keep_solutions).
    pub fn of(scene: &Arc<Scene>, branches: &mut [Branch]) -> Self {
        let selected = branches.iter_mut().map(|branch| {
            let points = std::mem::take(&mut branch.points);
            let last = points.len().saturating_sub(1);
            let count = points.len().min(POINTS);
            let chosen = (0..count).map(|k| points[k * last / (count - 1).max(1)].clone());
            let few = bare(branch, chosen.filter(|point| point.solution.is_some()).collect());
            branch.points = points;
            branch.points.iter_mut().for_each(|point| point.solution = None);
            few
        });
        Correctable { branches: selected.collect(), scene: scene.clone() }
    }

    /// Returns the branches at the selected points.
    pub fn branches(&self) -> &[Branch] {
        &self.branches
    }

    /// Corrects the selected points of all branches for the parameter values of another resolution
    /// of the scene, each in the hyperplane across its branch. Omits points for which Newton's
    /// method does not converge, branches that the resolved scene cannot have, and branches whose
    /// correction is cancelled or not complete at the time `until`. Returns `None` if no branch
    /// remains.
    ///
    /// The corrected points are solutions, but nothing ensures that they lie on the branches that
    /// the scene's runs trace, and their stability is the stability of the earlier points: use
    /// corrected branches only for pictures that are soon replaced.
    ///
    /// ```
    /// use std::{sync::Arc, time::{Duration, Instant}};
    /// use tangency::scene::{Correctable, Scene};
    /// let scene = |b: f64| {
    ///     let mut scene = Scene::parse(&format!("Scene(
    ///         title: \"Fold\",
    ///         problem: Equations(states: [(\"x\", \"a + b*x - x^3\")], initial: [(\"x\", -2)],
    ///             solution: equilibrium),
    ///         parameters: [(\"a\", -2), (\"b\", {b})],
    ///         runs: [Run(name: \"rest\", along: [(name: \"a\", low: -2, high: 2)])],
    ///     )"))?;
    ///     scene.settings.keep_solutions = true;
    ///     Ok::<_, tangency::scene::SceneError>(scene)
    /// };
    /// let first = Arc::new(scene(1.0)?);
    /// let (mut outcome, _) = first.resolve(None)?.trace_each(&mut ());
    /// let few = Correctable::of(&first, &mut outcome.document.branches);
    /// let until = Instant::now() + Duration::from_secs(60);
    /// let corrected = few.corrected(&scene(1.2)?.resolve(None)?, until).unwrap();
    /// for point in &corrected.branches()[0].points {
    ///     let [a, x] = [point.parameters[0], point.monitors[0]];
    ///     assert!((a + 1.2 * x - x.powi(3)).abs() < 1e-9);
    /// }
    /// assert!(corrected.branches()[0].points.len() > 5);
    /// # Ok::<(), tangency::scene::SceneError>(())
    /// ```
    pub fn corrected(&self, resolution: &Resolution, until: Instant) -> Option<Self> {
        let mut branches = Vec::new();
        for earlier in &self.branches {
            let Some(run) = self.scene.runs.iter().find(|run| run.name == earlier.name) else {
                continue;
            };
            match self.corrected_branch(resolution, (earlier, run), until) {
                Ok(Some(branch)) => branches.push(branch),
                Ok(None) => break,
                Err(_) => {}
            }
        }
        let scene = Scene { runs: self.scene.runs.clone(), ..resolution.scene().clone() };
        (!branches.is_empty()).then(|| Correctable { scene: Arc::new(scene), branches })
    }

    /// Corrects the points of a branch; returns `None` if the correction is cancelled or not
    /// complete at the time `until`, and an error if the resolved scene cannot have the branch.
    fn corrected_branch(
        &self,
        resolution: &Resolution,
        (earlier, run): (&Branch, &Run),
        until: Instant,
    ) -> Result<Option<Branch>, SceneError> {
        let own = resolution.runs().iter().find(|own| own.name() == run.name);
        let now = own.map_or_else(|| resolution.further(run), |own| Ok(own.clone()))?;
        let released = now.run.along.iter().map(|range| &range.name);
        if now.run.local.is_some() || !released.eq(&earlier.released) {
            return Err(SceneError::invalid(format!("run `{}` traces another branch", run.name)));
        }
        let changed = changed(&self.scene.resolved(run)?, &now);
        let mut system = now.system()?;
        let (mut points, extents) = (Vec::new(), extents(earlier));
        for point in &earlier.points {
            if Instant::now() > until || now.settings.cancel.is_cancelled() {
                return Ok(None);
            }
            points.extend(corrected((point, &extents), &now, &mut *system, &changed));
        }
        Ok(Some(bare(earlier, points)))
    }
}

/// Returns a branch with the names of another branch, the given points, and no special points.
fn bare(branch: &Branch, points: Vec<Point>) -> Branch {
    let (special, stretches, warnings) = (Vec::new(), Vec::new(), Vec::new());
    Branch { points, special, stretches, warnings, ..branch.clone() }
}

/// Returns the parameters whose values at the start of a run differ between two resolutions, with
/// their later values, except for the parameters that the run varies.
fn changed(before: &Resolved, now: &Resolved) -> Vec<(String, f64)> {
    let both = before.values.iter().zip(now.parameters());
    let changed = both.filter(|(before, (name, value))| {
        *before != value && now.run.along.iter().all(|range| range.name != *name)
    });
    changed.map(|(_, changed)| changed).collect()
}

/// Returns the lengths of the ranges of all columns along a branch.
fn extents(branch: &Branch) -> Vec<f64> {
    let columns = branch.parameters.len() + branch.monitors.len();
    let extent = |column: usize| {
        let values = branch.points.iter().filter_map(|point| point.value(column));
        let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
            [low.min(value), high.max(value)]
        });
        high - low
    };
    (0..columns).map(extent).collect()
}

/// Corrects a point of a branch for changed parameter values; returns `None` if Newton's method
/// does not converge. `extents` are the lengths of the ranges of all columns along the branch.
fn corrected(
    (point, extents): (&Point, &[f64]),
    run: &Resolved,
    system: &mut dyn System,
    changed: &[(String, f64)],
) -> Option<Point> {
    let solution = point.solution.as_deref()?;
    // Eigenvalues would take most of the time.
    let settings = Settings {
        stability: false,
        keep_solutions: true,
        refinement: 0.0,
        ..run.settings.clone()
    };
    let curve = Continuation::new(system).settings(settings).from(solution);
    let curve = changed.iter().fold(curve, |curve, (name, value)| curve.at(name, *value));
    let Traced::Point(mut corrected) = conditions(curve, &run.run).steps().ok()?.next()? else {
        return None;
    };
    if let (Some(slopes), Some(earlier)) = (&mut corrected.slopes, &point.slopes) {
        align(slopes, earlier, extents);
    }
    let Point { unstable, undetermined, .. } = point.clone();
    Some(Point { unstable, undetermined, ..corrected })
}

/// Converts slopes to the direction and the unit of arclength of an earlier branch; `earlier` are the
/// slopes at the same point of the earlier branch, and `extents` the lengths of the ranges of all
/// columns along the branch, by which slopes in different units are compared.
fn align(slopes: &mut Slopes, earlier: &Slopes, extents: &[f64]) {
    let both = slopes.columns.iter().zip(&earlier.columns).zip(extents);
    let varied = both.filter(|(_, extent)| **extent > 0.0 && extent.is_finite());
    let scaled = varied.filter_map(|((now, then), extent)| {
        let (now, then) = now.zip(*then)?;
        Some((now / extent, then / extent))
    });
    let [product, now, then] = scaled.fold([0.0; 3], |[product, now, then], (a, b)| {
        [product + a * b, now + a * a, then + b * b]
    });
    let factor = if now > 0.0 { (then / now).sqrt().copysign(product) } else { 1.0 };
    slopes.position = earlier.position;
    slopes.columns.iter_mut().flatten().for_each(|slope| *slope *= factor);
}
