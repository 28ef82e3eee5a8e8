//! Plans of work-precision measurements: problems, references and methods.

use crate::{Clock, Drawn, Line, Measured, Measurement};
use cpu_time::ProcessTime;
use std::time::Instant;

/// The effort of the measurements, which determines how many times each method runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// Every method runs once: the errors are the same as at full effort, but the measured times
    /// are inaccurate.
    Quick,
    /// Every method runs several times, and its time is the median.
    Full,
}

impl Effort {
    /// Returns how many times each method runs.
    pub fn runs(self) -> usize {
        match self {
            Effort::Quick => 1,
            Effort::Full => 7,
        }
    }
}

/// The answer of a method, with its amount of work.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// The numbers that are compared with the reference; missing numbers are NaN.
    pub numbers: Vec<f64>,
    /// The amount of work of the method, such as the number of evaluations or of unknowns.
    pub work: f64,
}

/// The function that runs a method and returns its answer, or the reason for its failure as text.
type Run = Box<dyn FnMut() -> Result<Answer, String>>;

/// A method with one of its settings.
pub struct Method {
    line: String,
    setting: String,
    run: Run,
}

impl Method {
    /// Creates a method with its name and a description of its setting.
    pub fn new(
        line: impl Into<String>,
        setting: impl Into<String>,
        run: impl FnMut() -> Result<Answer, String> + 'static,
    ) -> Self {
        Method { line: line.into(), setting: setting.into(), run: Box::new(run) }
    }
}

/// The error of a work-precision diagram whose reference method fails.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[error("the reference fails, {method}, {setting}: {cause}")]
pub struct WorkPrecisionError {
    /// The name of the reference method.
    pub method: String,
    /// The setting of the reference method.
    pub setting: String,
    /// The reason why the reference method failed.
    pub cause: String,
}

/// A problem, the method that computes its reference answer, and the methods that solve it.
///
/// ```
/// use tangency_reports::work_precision::{Answer, Effort, Method, Plan};
/// // π by polygons of 6, 12 and 24 sides.
/// let polygon = |sides: usize| {
///     let n = sides as f64;
///     Method::new("polygons", format!("{sides} sides"), move || {
///         Ok(Answer { numbers: vec![n * (std::f64::consts::PI / n).sin()], work: n })
///     })
/// };
/// let exact = Method::new("exact", "", || Ok(Answer { numbers: vec![std::f64::consts::PI], work: 0.0 }));
/// let plan = Plan::of("A circle", exact).with([6, 12, 24].map(polygon));
/// let measured = plan.measure(Effort::Quick)?;
/// let errors: Vec<f64> = measured.lines[0].points.iter().map(|point| point.error).collect();
/// assert!((errors[0] / errors[1]).log2() > 1.9 && (errors[1] / errors[2]).log2() < 2.1);
/// # Ok::<(), tangency_reports::work_precision::WorkPrecisionError>(())
/// ```
pub struct Plan {
    measured: Measured,
    reference: Method,
    methods: Vec<Method>,
    /// Whether errors are relative, that is, divided by the reference answer.
    relative: bool,
}

impl Plan {
    /// Creates a problem with its reference method.
    pub fn of(title: &str, reference: Method) -> Self {
        let mut measured = Measured::of(title);
        let Method { line, setting, .. } = &reference;
        let comma = if setting.is_empty() { "" } else { ", " };
        measured.reference = format!(
            "Each error in this table is the difference from a reference result \
             ({line}{comma}{setting})."
        );
        (measured.error, measured.work) = ("error".into(), "work".into());
        Plan { measured, reference, methods: Vec::new(), relative: false }
    }

    /// Sets the unit in which work is counted.
    pub fn counting(mut self, work: &str) -> Self {
        self.measured.work = work.into();
        self
    }

    /// Labels every point of the figure with its amount of work.
    pub fn marked(mut self) -> Self {
        self.measured.marked = true;
        self
    }

    /// Sets the quantities on the axes of the figure.
    pub fn drawing(mut self, drawn: Drawn) -> Self {
        self.measured.drawn = drawn;
        self
    }

    /// Sets the clock by which methods are timed; the default is CPU time.
    pub fn by(mut self, clock: Clock) -> Self {
        self.measured.clock = clock;
        self
    }

    /// Makes errors relative to the reference answer.
    pub fn relative(mut self) -> Self {
        self.relative = true;
        self.measured.error = "relative error".into();
        self
    }

    /// Adds methods.
    pub fn with(mut self, methods: impl IntoIterator<Item = Method>) -> Self {
        self.methods.extend(methods);
        self
    }

    /// Marks one of the methods, together with one of its settings, as recommended.
    pub fn recommending(mut self, line: &str, setting: &str) -> Self {
        self.measured.recommended = Some((line.into(), setting.into()));
        self
    }

    /// Runs all methods of the plan; the failure of a method counts as a measurement.
    ///
    /// # Errors
    /// [`WorkPrecisionError`] if the reference method fails.
    pub fn measure(mut self, effort: Effort) -> Result<Measured, WorkPrecisionError> {
        let Method { line, setting, run } = &mut self.reference;
        let exact = run().map_err(|cause| {
            let (method, setting) = (line.clone(), setting.clone());
            WorkPrecisionError { method, setting, cause }
        })?;
        let exact = exact.numbers;
        for mut method in self.methods {
            let (answer, seconds) = timed(&mut method, self.measured.clock, effort);
            let (answer, failure) = match answer {
                Ok(answer) => (answer, None),
                Err(cause) => (Answer { numbers: vec![f64::NAN], work: f64::NAN }, Some(cause)),
            };
            let miss = |(found, exact): (&f64, &f64)| {
                (found - exact).abs() / if self.relative { exact.abs() } else { 1.0 }
            };
            let error = answer.numbers.iter().zip(&exact).map(miss).fold(0.0, worse);
            let Answer { work, .. } = answer;
            let point = Measurement { setting: method.setting, work, seconds, error, failure };
            let lines = &mut self.measured.lines;
            match lines.iter_mut().find(|line| line.name == method.line) {
                Some(line) => line.points.push(point),
                None => lines.push(Line { name: method.line, points: vec![point] }),
            }
        }
        Ok(self.measured)
    }
}

/// Returns the larger of two errors; NaN counts as larger than every number.
fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

/// The running time, in seconds, below which a method is run repeatedly for one measurement.
const SHORTEST: f64 = 5e-3;

/// Returns the answer of a method and its running time: the median of several runs that follow a
/// first, untimed run.
fn timed(method: &mut Method, clock: Clock, effort: Effort) -> (Result<Answer, String>, f64) {
    let (answer, first) = clocked(clock, &mut method.run);
    if effort == Effort::Quick || answer.is_err() {
        return (answer, first);
    }
    let repeats = (SHORTEST / first.max(1e-9)).clamp(1.0, 1e5) as usize;
    let mut repeated = || {
        for _ in 0..repeats {
            // The method succeeded in an earlier run.
            let _ = std::hint::black_box((method.run)());
        }
    };
    let time = |_| clocked(clock, &mut repeated).1 / repeats as f64;
    let mut times: Vec<f64> = (0..effort.runs()).map(time).collect();
    times.sort_by(f64::total_cmp);
    (answer, times[times.len() / 2])
}

/// Returns the result of a function, and the time that the function took in seconds.
fn clocked<R>(clock: Clock, run: impl FnOnce() -> R) -> (R, f64) {
    match clock {
        Clock::Processor => {
            let start = ProcessTime::now();
            (run(), start.elapsed().as_secs_f64())
        }
        Clock::Wall => {
            let start = Instant::now();
            (run(), start.elapsed().as_secs_f64())
        }
    }
}
