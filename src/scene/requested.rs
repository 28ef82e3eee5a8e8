//! The scenes that requests produce from models and from other scenes.

use super::error::SceneError;
use super::find::begin_everywhere;
use super::first_start::begin;
use super::problem::Problem;
use super::request::{Request, Swept};
use super::simulate::Simulated;
use super::statement::{Range, Run, Scene, Start, Sweep};
use crate::core::continuation::Settings;
use crate::core::problem::{distinct, position};
use crate::core::sweep::Order;
use crate::language::xpp::Options;
use crate::output::Plot;
use std::collections::HashSet;

impl Scene {
    /// Builds the scene for a model and a request. The scene contains one branch, which starts from
    /// the initial state or from the attractor to which a simulation converges, and the requested
    /// curves of special points.
    ///
    /// ```
    /// use std::path::Path;
    /// use tangency::core::system::Kind;
    /// use tangency::scene::{Problem, Range, Request, Scene, explore};
    /// let lorenz = Problem::from_file(Path::new("examples/lorenz.ron"), &[])?;
    /// let rho = Range { name: "rho".into(), low: Some(0.0), high: Some(30.0) };
    /// let scene = Scene::of_model(lorenz, "Lorenz", &Request { along: vec![rho], ..Request::default() })?;
    /// let (scene, outcome) = explore(&scene, 1, &mut ());
    /// assert_eq!(scene.runs[1].name, "branch-BP");
    /// let branch = &outcome.document.branches[1];
    /// let hopf = branch.of_kind(Kind::HB).next().expect("a Hopf point");
    /// let rho = hopf.value(branch.column("rho").unwrap()).unwrap();
    /// assert!((rho - 470.0 / 19.0).abs() < 1e-11);
    /// # Ok::<(), tangency::scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError`] if no parameter is varied, or if the motion does not converge to an
    /// attractor.
    pub fn of_model(problem: Problem, title: &str, request: &Request) -> Result<Scene, SceneError> {
        let first = continuation_parameter(request)?;
        let mut scene = Scene::of_problem(problem, title, request);
        begin_in_ranges(&mut scene, &request.along)?;
        let mut run = Run::along("branch", vec![first.clone()]);
        // The request takes precedence over the options of a model's file.
        run.bounds = apply_options(&mut scene);
        scene.set_all(&request.set)?;
        run.bounds.extend(request.bounds.iter().cloned());
        run.marks.clone_from(&request.marks);
        scene.runs.push(run);
        match &request.within {
            Some(within) => begin_everywhere(&mut scene, within)?,
            None => begin(&mut scene, request, true)?,
        }
        scene.runs.extend(curve(request, &scene.runs));
        scene.check()?;
        Ok(scene)
    }

    /// Returns the scene with additional runs, for example the runs of
    /// [`FollowUp`](super::FollowUp)s.
    ///
    /// # Errors
    /// [`SceneError`] if runs have duplicate or unknown names.
    pub fn with_runs(mut self, runs: impl IntoIterator<Item = Run>) -> Result<Scene, SceneError> {
        self.runs.extend(runs);
        self.check()?;
        Ok(self)
    }

    /// Builds a scene that contains a problem but no runs and sweeps; the token of the request
    /// cancels its computations.
    pub fn of_problem(problem: Problem, title: &str, request: &Request) -> Scene {
        Scene {
            title: title.into(),
            summary: None,
            problem,
            model: None,
            parameters: Vec::new(),
            accuracy: None,
            settings: Settings { cancel: request.cancel.clone(), ..Settings::default() },
            plot: Plot::default(),
            runs: Vec::new(),
            sweeps: Vec::new(),
        }
    }

    /// Returns the scene with a single simulated history instead of its runs and sweeps.
    ///
    /// ```
    /// use tangency::scene::{BUILT_IN, Request, Scene, Simulated, execute};
    /// let scene = Scene::parse(BUILT_IN.iter().find(|scene| scene.name == "dry-friction").unwrap().text)?;
    /// let simulated = Simulated { transient: 50.0, duration: 2.0, ..Simulated::default() };
    /// let scene = scene.simulating(&Request::default(), simulated)?;
    /// let history = &execute(&scene, None, &mut ()).document.branches[0].special[0];
    /// let times = &history.profiles[0].points;
    /// assert_eq!((history.profiles[0].along.as_str(), times[0][0]), ("time", 0.0));
    /// # Ok::<(), tangency::scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// As [`set`](Self::set).
    pub fn simulating(
        mut self,
        request: &Request,
        simulated: Simulated,
    ) -> Result<Scene, SceneError> {
        self.settings.cancel = request.cancel.clone();
        (self.sweeps, self.plot, self.accuracy) = (Vec::new(), Plot::default(), None);
        // Values set by other runs can be changed in a simulation.
        self.runs =
            vec![Run { start: Start::Simulated(simulated), ..Run::along("history", Vec::new()) }];
        self.set_all(&request.set)?;
        Ok(self)
    }

    /// Returns the scene with the given sweeps instead of its own sweeps.
    ///
    /// ```
    /// use tangency::core::sweep::Order;
    /// use tangency::scene::{BUILT_IN, Grid, Request, Scene, Swept};
    /// let scene = Scene::parse(BUILT_IN.iter().find(|scene| scene.name == "dry-friction").unwrap().text)?;
    /// let over = vec![Grid { name: "F".into(), low: 0.1, high: 0.3, count: 11 }];
    /// let scene = scene.sweeping(&Request::default(), Swept { over, both: true, ..Swept::default() })?;
    /// let orders: Vec<Order> = scene.sweeps.iter().map(|sweep| sweep.order).collect();
    /// assert_eq!(orders, [Order::Up, Order::Down]);
    /// # Ok::<(), tangency::scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// The errors of [`set`](Self::set); [`SceneError::BothWays`] if `both` is true and the number
    /// of varied parameters is not one; [`SceneError::Twice`] for a duplicate name. Unknown names
    /// in `swept` are reported only when the scene is resolved.
    pub fn sweeping(mut self, request: &Request, swept: Swept) -> Result<Scene, SceneError> {
        let measure = swept.measures.first().cloned();
        self.sweeps = swept.sweeps(&self.problem.parameter_names())?;
        self.plot.y = self.plot.y.or(measure);
        self.settings.cancel = request.cancel.clone();
        self.set_all(&request.set)?;
        Ok(self)
    }

    /// Returns the scene with the values, ranges, bounds and starts of the request.
    ///
    /// # Errors
    /// The errors of [`set`](Self::set); [`SceneError`] for names that do not occur in any run.
    pub fn requested(mut self, request: &Request) -> Result<Scene, SceneError> {
        self.settings.cancel = request.cancel.clone();
        if !request.set.is_empty() {
            self.set_all(&request.set)?;
        }
        replace_ranges(&mut self.runs, request)?;
        for run in &mut self.runs {
            for wanted in &request.bounds {
                run.bounds.retain(|range| range.name != wanted.name);
                run.bounds.push(wanted.clone());
            }
            run.marks.extend_from_slice(&request.marks);
        }
        if let Some(within) = &request.within {
            begin_everywhere(&mut self, within)?;
        } else if request.settle.is_some() || !request.state.is_empty() {
            begin(&mut self, request, false)?;
        }
        self.runs.extend(curve(request, &self.runs));
        self.check()?;
        Ok(self)
    }
}

impl Swept {
    /// Returns the sweeps for a problem with the given parameters.
    fn sweeps(mut self, parameters: &[String]) -> Result<Vec<Sweep>, SceneError> {
        let mut seen = HashSet::new();
        let over = self.over.iter().map(|grid| &grid.name);
        let mut names = over.chain(self.start.iter().map(|(name, _)| name));
        if let Some(name) = names.find(|name| !seen.insert(*name)) {
            return Err(SceneError::Twice(name.clone()));
        }
        let follows = self.over.len() == 1 && parameters.contains(&self.over[0].name);
        if self.both && !follows {
            return Err(SceneError::BothWays);
        }
        if let ([grid], true) = (&mut self.over[..], follows) {
            // Both orders need increasing values.
            (grid.low, grid.high) = (grid.low.min(grid.high), grid.low.max(grid.high));
        }
        let sweep = |(name, order): (&str, Order)| Sweep {
            at: self.at.clone(),
            measures: self.measures.clone(),
            order,
            starts: if self.start.is_empty() { Vec::new() } else { vec![self.start.clone()] },
            ..Sweep::over(name, self.over.clone())
        };
        Ok(match (follows, self.both) {
            (false, _) => vec![sweep(("sweep", Order::Anew))],
            (true, false) => vec![sweep(("up", Order::Up))],
            (true, true) => [("up", Order::Up), ("down", Order::Down)].map(sweep).into(),
        })
    }
}

/// Returns the continuation parameter of a request for a model, with its range.
fn continuation_parameter(request: &Request) -> Result<&Range, SceneError> {
    let Some(first) = request.along.first() else {
        return Err(SceneError::invalid("no continuation parameter is given for the branch")
            .with_help("name a continuation parameter and its range, as in `--along rho=0..30`"));
    };
    if let (Some(second), None) = (request.along.get(1), request.hold) {
        let message = format!(
            "`--along` is given twice, the second time for `{}`, but a branch varies only one \
             parameter",
            second.name
        );
        return Err(SceneError::invalid(message).with_help(
            "omit the second `--along`, or name the kind of special points whose curve is traced, \
             as in `--hold HB`",
        ));
    }
    if let (Some(kind), 1) = (request.hold, request.along.len()) {
        let message = format!(
            "`--along` is given once, but a curve of special points (`--hold {kind}`) varies two \
             parameters"
        );
        return Err(SceneError::invalid(message).with_help("give a second `--along`"));
    }
    Ok(first)
}

/// Sets the initial values of varied parameters: a parameter outside its range starts at the nearer
/// end of the range. A parameter without a value starts at the upper end of its range if all values
/// in the range are negative; otherwise at the lower end, or at zero if the range has no lower end.
fn begin_in_ranges(scene: &mut Scene, along: &[Range]) -> Result<(), SceneError> {
    for range in along {
        let value = range.low.filter(|low| *low > 0.0).or(range.high.filter(|high| *high < 0.0));
        let begin = match scene.value(&range.name) {
            Some(value) => range.nearest(value),
            None => {
                scene.problem.require_parameter(&range.name)?;
                value.or(range.low).unwrap_or(0.0)
            }
        };
        if scene.value(&range.name) != Some(begin) {
            scene.parameters.push((range.name.clone(), begin));
        }
    }
    Ok(())
}

/// Applies the numerical options in a model's file to a scene, and returns the bounds that the file
/// states.
fn apply_options(scene: &mut Scene) -> Vec<Range> {
    let Options { bounds, ntst, npr, .. } = scene.problem.options();
    if let Some(intervals) = ntst {
        scene.problem.take_intervals(intervals);
    }
    scene.settings.save_every = npr.unwrap_or(scene.settings.save_every);
    let (Some(bound), Some(model)) = (bounds, scene.problem.text()) else { return Vec::new() };
    let within = |name| Range { name, low: Some(-bound), high: Some(bound) };
    model.states().into_iter().map(within).collect()
}

/// Replaces the ranges of runs by the ranges of a request.
fn replace_ranges(runs: &mut [Run], request: &Request) -> Result<(), SceneError> {
    let ranges = runs.iter().flat_map(|run| &run.along);
    let names = distinct(ranges.map(|range| &range.name));
    let names: Vec<String> = names.into_iter().map(String::from).collect();
    for wanted in &request.along {
        if request.hold.is_none() {
            position("released parameter", &wanted.name, &names)?;
        }
        let ranges = runs.iter_mut().flat_map(|run| &mut run.along);
        ranges.filter(|range| range.name == wanted.name).for_each(|range| *range = wanted.clone());
    }
    Ok(())
}

/// Returns a run that traces the requested curve of special points, which starts on the first run;
/// `None` if no curve is requested.
fn curve(request: &Request, runs: &[Run]) -> Option<Run> {
    let (kind, first) = (request.hold?, runs.first()?);
    Some(Run {
        bounds: request.bounds.clone(),
        marks: request.marks.clone(),
        hold: Some(kind),
        set: first.set.clone(),
        start: Start::From {
            run: first.name.clone(),
            kind,
            nth: 0,
            switch: false,
            which: 0,
            unconverged: false,
        },
        ..Run::along(&format!("{}-{kind}-curve", first.name), request.along.clone())
    })
}
