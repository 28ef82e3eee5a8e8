//! Plans of measurements: problems, references and methods.

use crate::{Clock, Drawn, Line, Measured, Measurement};
use cpu_time::ProcessTime;
use std::time::Instant;

/// The effort of a measurement: the number of runs of each method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// Every method runs once: errors equal the errors at full effort, times are rough.
    Quick,
    /// Times are medians of several runs.
    Full,
}

impl Effort {
    /// Returns the number of runs of each method.
    pub fn runs(self) -> usize {
        match self {
            Effort::Quick => 1,
            Effort::Full => 7,
        }
    }
}

/// The result of a method.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// The numbers to compare; NaN for missing ones.
    pub numbers: Vec<f64>,
    /// The amount of work, such as evaluations or unknowns.
    pub work: f64,
}

/// The function of a method, which returns its result, or the reason for a failure in words.
type Run = Box<dyn FnMut() -> Result<Answer, String>>;

/// A method with a setting.
pub struct Method {
    line: String,
    setting: String,
    run: Run,
}

impl Method {
    /// Creates a method with its name and a setting, in words.
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
    /// The name of the method.
    pub method: String,
    /// The setting of the method.
    pub setting: String,
    /// The reason for the failure.
    pub cause: String,
}

/// A problem, its reference, and the methods that solve it.
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
    /// Whether errors are divided by the reference.
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

    /// Sets the unit of work.
    pub fn counting(mut self, work: &str) -> Self {
        self.measured.work = work.into();
        self
    }

    /// Labels every point of the figure with its work.
    pub fn marked(mut self) -> Self {
        self.measured.marked = true;
        self
    }

    /// Sets the axes of the figure.
    pub fn drawing(mut self, drawn: Drawn) -> Self {
        self.measured.drawn = drawn;
        self
    }

    /// Sets the clock; by default the processor's clock.
    pub fn by(mut self, clock: Clock) -> Self {
        self.measured.clock = clock;
        self
    }

    /// Divides errors by the reference.
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

    /// Recommends one of the methods with its setting.
    pub fn recommending(mut self, line: &str, setting: &str) -> Self {
        self.measured.recommended = Some((line.into(), setting.into()));
        self
    }

    /// Runs all methods; a failure counts as a measurement.
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

/// Returns the larger error; NaN is the largest.
fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

/// The time in seconds below which a method is run repeatedly for one measurement.
const SHORTEST: f64 = 5e-3;

/// Returns an answer and its time: the median of several runs, after a first one.
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

/// Returns the result of a function, and its time in seconds.
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
