//! Requests to trace a model that is given without a scene, and requests that change the contents
//! of a scene.

use super::discretisation::{SOLUTION, Solution};
use super::error::SceneError;
use super::problem::{LUMPED, Problem};
use super::resolve::StartPoint;
use super::simulate::{Simulated, moved, search, searched, stated};
use super::statement::{Grid, Range, Run, Scene, Start, Sweep};
use crate::core::attractor::CycleSearchError;
use crate::core::cancel::CancelToken;
use crate::core::continuation::Settings;
use crate::core::hybrid::{HybridEquations, HybridFlow, HybridState};
use crate::core::problem::{Forcing, distinct, position};
use crate::core::sweep::Order;
use crate::core::system::Kind;
use crate::language::xpp::Options;
use crate::output::Plot;

/// A request to trace a model that is given without a scene, or a request that changes the contents
/// of a scene; it corresponds to the options of `tangency trace`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Request {
    /// The changed values, by the names of parameters and settings.
    pub set: Vec<(String, String)>,
    /// The varied parameters with their ranges, the continuation parameter first.
    pub along: Vec<Range>,
    /// The bounds of parameters and monitors.
    pub bounds: Vec<Range>,
    /// The values of parameters and columns at which points of branches are marked.
    pub marks: Vec<(String, f64)>,
    /// The initial states of the first run.
    pub state: Vec<(String, f64)>,
    /// The point of an earlier result at which the branch starts; no start of the branch is then
    /// searched, and changed settings must have an effect on the run that continues from the point.
    pub start: Option<Box<StartPoint>>,
    /// The duration of the simulation that precedes the first run: in periods of the forcing, or in
    /// units of time for a system without forcing.
    pub settle: Option<f64>,
    /// The kind of special point whose curve is traced in all varied parameters of the request; the
    /// curve starts at the first special point of this kind on the first run.
    pub hold: Option<Kind>,
    /// The box in which solutions are searched; the solutions are either the result of the request
    /// or the starts of branches.
    pub within: Option<SearchBox>,
    /// The token that cancels all computations for the request.
    pub cancel: CancelToken,
}

/// A box in the space of unknowns in which solutions are searched.
#[derive(Clone, Debug, PartialEq)]
pub struct SearchBox {
    /// The range of each unknown in the box.
    pub ranges: Vec<Range>,
    /// The number of points from which Newton's method starts.
    pub starts: usize,
}

/// The default duration of the simulation with which a start of a branch is searched, if no
/// equilibrium is found near the given states.
const SETTLE: f64 = 500.0;

/// The maximum duration of a simulation that precedes a branch.
const LONGEST: f64 = 1e9;

/// A state counts as an equilibrium if its rate of change, relative to the size of the states, is
/// at most this value.
const AT_REST: f64 = 1e-6;

/// The sweeps that a request computes instead of the scene's own sweeps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Swept {
    /// The parameters or initial states that the sweep varies. If a single parameter is varied,
    /// each run starts at the end of the previous run and the parameter increases from run to run;
    /// otherwise all runs start from the initial states.
    pub over: Vec<Grid>,
    /// Whether to add a second sweep in which the parameter decreases.
    pub both: bool,
    /// The initial states of the first run of the sweep, by name.
    pub start: Vec<(String, f64)>,
    /// The event just after which a motion without forcing is sampled.
    pub at: Option<String>,
    /// The monitors that the sweep records in every period, such as `max_x`. Pictures show the
    /// first of these monitors, unless the scene's picture names another column.
    pub measures: Vec<String>,
}

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
        let Some(first) = request.along.first() else {
            return Err(SceneError::invalid("no continuation parameter is given for the branch")
                .with_help(
                    "name a continuation parameter and its range, as in `--along rho=0..30`",
                ));
        };
        if let (Some(second), None) = (request.along.get(1), request.hold) {
            let message = format!(
                "`--along` is given twice, the second time for `{}`, but a branch varies only one \
                 parameter",
                second.name
            );
            return Err(SceneError::invalid(message).with_help(
                "omit the second `--along`, or name the kind of special points whose curve is \
                 traced, as in `--hold HB`",
            ));
        }
        if let (Some(kind), 1) = (request.hold, request.along.len()) {
            let message = format!(
                "`--along` is given once, but a curve of special points (`--hold {kind}`) varies \
                 two parameters"
            );
            return Err(SceneError::invalid(message).with_help("give a second `--along`"));
        }
        let mut scene = Scene::of_problem(problem, title, request);
        // A parameter without a value starts at the start of its range, and one outside its range
        // at the nearer end.
        for range in &request.along {
            let value =
                range.low.filter(|low| *low > 0.0).or(range.high.filter(|high| *high < 0.0));
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
        let mut run = Run::along("branch", vec![first.clone()]);
        // The request takes precedence over the options of a model's file.
        run.bounds = scene.followed()?;
        scene.set_all(&request.set)?;
        run.bounds.extend(request.bounds.iter().cloned());
        run.marks.clone_from(&request.marks);
        scene.runs.push(run);
        match &request.within {
            Some(within) => scene.begin_everywhere(within)?,
            None => scene.begin(request, true)?,
        }
        scene.hold(request);
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
        let Swept { mut over, both, start, at, measures } = swept;
        let names = || over.iter().map(|grid| &grid.name).chain(start.iter().map(|(name, _)| name));
        if let Some(name) =
            names().enumerate().find_map(|(k, name)| names().take(k).find(|it| *it == name))
        {
            return Err(SceneError::Twice(name.clone()));
        }
        let parameters = self.problem.parameter_names();
        let follows = over.len() == 1 && parameters.contains(&over[0].name);
        if both && !follows {
            return Err(SceneError::BothWays);
        }
        if let ([grid], true) = (&mut over[..], follows) {
            // Both orders need increasing values.
            (grid.low, grid.high) = (grid.low.min(grid.high), grid.low.max(grid.high));
        }
        let sweep = |(name, order): (&str, Order)| Sweep {
            at: at.clone(),
            measures: measures.clone(),
            order,
            starts: if start.is_empty() { Vec::new() } else { vec![start.clone()] },
            ..Sweep::over(name, over.clone())
        };
        self.sweeps = match (follows, both) {
            (false, _) => vec![sweep(("sweep", Order::Anew))],
            (true, false) => vec![sweep(("up", Order::Up))],
            (true, true) => [("up", Order::Up), ("down", Order::Down)].map(sweep).into(),
        };
        if let Some(first) = measures.into_iter().next() {
            self.plot.y.get_or_insert(first);
        }
        self.settings.cancel = request.cancel.clone();
        self.set_all(&request.set)?;
        Ok(self)
    }

    /// Applies the numerical options in a model's file to the scene, and returns the bounds that
    /// the file states.
    fn followed(&mut self) -> Result<Vec<Range>, SceneError> {
        let Options { bounds, ntst, npr, .. } = self.problem.options();
        if let Some(intervals) = ntst {
            self.problem.take_intervals(intervals);
        }
        self.settings.save_every = npr.unwrap_or(self.settings.save_every);
        let (Some(bound), Some(model)) = (bounds, self.problem.text()) else {
            return Ok(Vec::new());
        };
        let within = |name| Range { name, low: Some(-bound), high: Some(bound) };
        Ok(model.states().into_iter().map(within).collect())
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
        let ranges = self.runs.iter().flat_map(|run| &run.along);
        let names = distinct(ranges.map(|range| &range.name));
        let names: Vec<String> = names.into_iter().map(String::from).collect();
        for wanted in &request.along {
            if request.hold.is_none() {
                position("released parameter", &wanted.name, &names)?;
            }
            let ranges = self.runs.iter_mut().flat_map(|run| &mut run.along);
            ranges
                .filter(|range| range.name == wanted.name)
                .for_each(|range| *range = wanted.clone());
        }
        for wanted in &request.bounds {
            for run in &mut self.runs {
                run.bounds.retain(|range| range.name != wanted.name);
                run.bounds.push(wanted.clone());
            }
        }
        for run in &mut self.runs {
            run.marks.extend_from_slice(&request.marks);
        }
        if let Some(within) = &request.within {
            self.begin_everywhere(within)?;
        } else if request.settle.is_some() || !request.state.is_empty() {
            self.begin(request, false)?;
        }
        self.hold(request);
        self.check()?;
        Ok(self)
    }

    /// Adds runs that trace the requested curves of special points.
    fn hold(&mut self, request: &Request) {
        let (Some(kind), Some(first)) = (request.hold, self.runs.first()) else { return };
        let mut run = Run::along(&format!("{}-{kind}-curve", first.name), request.along.clone());
        run.bounds = request.bounds.clone();
        run.marks = request.marks.clone();
        run.hold = Some(kind);
        run.set = first.set.clone();
        run.start = Start::From {
            run: first.name.clone(),
            kind,
            nth: 0,
            switch: false,
            which: 0,
            unconverged: false,
        };
        self.runs.push(run);
    }

    /// Sets the start of the first run: if the request demands a simulation, the attractor to which
    /// the simulation converges; otherwise the given states. If `free` is true, the kind of
    /// solution found at the start decides whether equilibria or orbits are traced.
    fn begin(&mut self, request: &Request, free: bool) -> Result<(), SceneError> {
        let start = self.start(request, free)?;
        let [run, ..] = &mut self.runs[..] else { return Ok(()) };
        run.start = start;
        Ok(())
    }

    fn start(&mut self, request: &Request, free: bool) -> Result<Start, SceneError> {
        let simulated = |transient| {
            let state = request.state.clone();
            Start::Simulated(Simulated { state, transient, ..Simulated::default() })
        };
        let guess = || match request.state.is_empty() {
            true => Start::Rest,
            false => Start::Guess(request.state.clone()),
        };
        if let Some(time) = request.settle.filter(|time| !(0.0..=LONGEST).contains(time)) {
            let message = format!(
                "the time of the simulation before the start (`settle`) is {time}, but \
                         must be between 0 and {LONGEST}"
            );
            return Err(SceneError::invalid(message));
        }
        let Ok(motion) = self.problem.model().motion() else {
            let moves = self.problem.model().kind() == "a map";
            return match request.settle {
                Some(time) if moves => Ok(simulated(time)),
                Some(_) => Err(self
                    .problem
                    .model()
                    .lacks("only systems with dynamics can be simulated to an attractor", LUMPED)),
                None => Ok(guess()),
            };
        };
        let smooth = motion.guards().is_empty() && motion.forcing() == Forcing::None;
        if request.start.is_some() {
            let states = request.set.iter().any(|(name, _)| name == SOLUTION);
            if free && smooth && !states {
                self.problem.follow(Solution::Equilibrium);
            }
            return Ok(guess());
        }
        let follows = |solution| self.first_solution() == Some(solution);
        let transient = request.settle.unwrap_or(Simulated::default().transient);
        if !smooth && (request.settle.is_some() || !follows(Solution::Equilibrium)) {
            return Ok(simulated(transient));
        }
        if !smooth {
            return self.given_or_settled(guess(), simulated(transient));
        }
        // The scene already states which kind of solutions it traces.
        if !free && follows(Solution::Orbit) {
            return Ok(simulated(transient));
        }
        self.problem.follow(Solution::Equilibrium);
        let Some(settle) = request.settle else {
            return match self.refused(&guess())? {
                None => Ok(guess()),
                // The first error explains possible later ones.
                Some(near) => self.settled(request, SETTLE, &*motion).map_err(|cause| {
                    SceneError::NoStart { near: Box::new(near), cause: Box::new(cause) }
                }),
            };
        };
        self.settled(request, settle, &*motion)
    }

    /// Returns the kind of solutions that the first run traces.
    fn first_solution(&self) -> Option<Solution> {
        let set = self.runs.first().map_or(&[][..], |run| &run.set);
        let of_run = set.iter().rfind(|(name, _)| name == SOLUTION);
        let stated = of_run.and_then(|(_, value)| ron::from_str(value).ok());
        stated.or(self.problem.solution())
    }

    /// Returns the equilibrium to which the motion converges; if the motion does not converge to an
    /// equilibrium, returns a start on the orbit to which a simulation will converge.
    fn settled(
        &mut self,
        request: &Request,
        settle: f64,
        motion: &dyn HybridEquations,
    ) -> Result<Start, SceneError> {
        let p = self.values()?;
        let began = Simulated { state: request.state.clone(), ..Simulated::default() };
        let state = stated(&motion.modes()[0], &began.from(&self.problem.initial(&p)).state)?;
        let failed = |cause| SceneError::of_run("the start", cause);
        let settle_down = |settings| {
            let mut flow = HybridFlow::new(motion, settings)?;
            let mut state = flow.initial(state.clone(), &p);
            flow.advance(&mut state, settle, &p, &mut ()).map(|_| state)
        };
        let state = moved(&self.settings.cancel, settle_down).map_err(failed)?;
        let mut rates = vec![0.0; state.x.len()];
        motion.field(0, state.time, &state.x, &p, &mut rates);
        let rests = |(rate, x): (&f64, &f64)| rate.abs() <= AT_REST * (1.0 + x.abs());
        if rates.iter().zip(&state.x).all(rests) {
            let names = motion.modes().swap_remove(0).states;
            return Ok(Start::Guess(names.into_iter().zip(state.x).collect()));
        }
        // The motion may approach an equilibrium slowly.
        let begun = HybridState { mode: 0, time: state.time, x: state.x };
        let search = search(motion, &Simulated { transient: 0.0, ..Simulated::default() }, &p);
        let found = searched(motion, &begun, &search, (&p, &self.settings.cancel));
        if let Err(CycleSearchError::Equilibrium { states, .. }) = found {
            let names = motion.modes().swap_remove(0).states;
            return Ok(Start::Guess(names.into_iter().zip(states).collect()));
        }
        self.problem.follow(Solution::Orbit);
        let state = request.state.clone();
        Ok(Start::Simulated(Simulated { state, transient: settle, ..Simulated::default() }))
    }

    /// Returns the given states if a branch of equilibria starts at these states; otherwise returns
    /// the equilibrium to which the motion converges.
    fn given_or_settled(&self, given: Start, settled: Start) -> Result<Start, SceneError> {
        let Some(near) = self.refused(&given)? else { return Ok(given) };
        match self.refused(&settled) {
            Ok(None) => Ok(settled),
            Ok(Some(cause)) | Err(cause) => {
                Err(SceneError::NoStart { near: Box::new(near), cause: Box::new(cause) })
            }
        }
    }

    /// Returns the reason why no branch starts from a guess of the unknowns, or `None` if a branch
    /// starts from the guess.
    ///
    /// # Errors
    /// [`SceneError`] for an error that would also occur with every other start.
    fn refused(&self, start: &Start) -> Result<Option<SceneError>, SceneError> {
        let Some(run) = self.runs.first() else { return Ok(None) };
        let run = Run { start: start.clone(), ..run.clone() };
        match self.resolved(&run)?.begins() {
            Err(cause) if cause.is_of_start(|name| run.along.iter().any(|it| it.name == name)) => {
                Ok(Some(cause))
            }
            begins => begins.map(|()| None),
        }
    }
}
