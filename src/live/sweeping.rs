//! Sweeps whose points are drawn under the branches of a page's diagram.

use super::pages::{Kept, Message};
use super::trouble::Trouble;
use crate::core::cancel::CancelToken;
use crate::core::continuation::Branch;
use crate::core::failure::one_line;
use crate::core::problem::columns_showing;
use crate::core::sweep::{Found, Part};
use crate::output::{SweepTable, Sweeps, specks, usual_axes};
use crate::scene::{Grid, Request, Sampling, Scene, SceneError, SweepWatch, Swept};
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::collections::BTreeMap;
use std::sync::mpsc::Sender;
use std::time::{Duration, Instant};

/// The maximum number of values of the parameter.
const MOST_VALUES: usize = 10_000;
/// The number of points after which a sweep is stopped.
const MOST_POINTS: usize = 200_000;
/// The time between two messages with finished runs.
const NEXT: Duration = Duration::from_millis(40);

/// A sweep over the range of the continuation parameter, as requested by a page.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Sweeping {
    /// The number of values of the parameter.
    count: usize,
    /// Whether the parameter also decreases.
    both: bool,
    /// The event at which a motion without forcing is sampled.
    at: Option<String>,
}

/// Sweeps the continuation parameter of a page's result, and sends the points of finished runs in
/// the axes of the page's diagram.
pub(super) fn sweep(
    kept: &Kept,
    sweeping: &Sweeping,
    (cancel, out): (&CancelToken, &Sender<Message>),
) {
    let fail = |trouble: Trouble| {
        let _ = out.send(Message::of(&json!({ "failed": trouble })));
    };
    let (scene, axes) = match planned(kept, sweeping, cancel) {
        Ok(planned) => planned,
        Err(trouble) => return fail(trouble),
    };
    let mut drawn = Drawn::new(kept, axes, (cancel, out));
    drawn.progress.total = sweeping.count * if sweeping.both { 2 } else { 1 };
    let outcome = crate::scene::sweep(&scene, &kept.name, Part::WHOLE, None, &mut drawn);
    drawn.send();
    match outcome {
        Ok(_) => {
            let progress = Progress { stopped: cancel.is_cancelled(), ..drawn.progress };
            let _ = out.send(Message::of(&json!({ "swept": progress })));
        }
        Err(cause) => fail(Trouble::from(&cause)),
    }
}

/// The columns on the axes: the swept parameter, and the columns that share the vertical axis.
type Axes = (String, Vec<String>);

/// Returns the scene with the sweep, and the columns on the axes.
fn planned(
    kept: &Kept,
    sweeping: &Sweeping,
    cancel: &CancelToken,
) -> Result<(Scene, Axes), Trouble> {
    let of_solutions = |branch: &&Branch| branch.condition.is_none();
    let branch = kept.document.branches.iter().find(of_solutions);
    let range = kept.scene.runs.iter().find_map(|run| run.along.first());
    let (Some(branch), Some(range)) = (branch, range) else {
        return Err(Trouble::plain("the result has no branch along which a parameter varies"));
    };
    let name = range.name.clone();
    let (Some(low), Some(high)) = (range.low, range.high) else {
        let message = format!("the range of `{name}` is open: give both of its ends");
        return Err(Trouble::plain(message));
    };
    if !(1..=MOST_VALUES).contains(&sweeping.count) {
        let message = format!("the number of values must be between 1 and {MOST_VALUES}");
        return Err(Trouble::plain(message));
    }
    let scene = kept.alone(branch, &[], cancel).map_err(|cause| Trouble::from(&cause))?;
    let sampling = scene.sampling().map_err(|cause| Trouble::from(&cause))?;
    let ys = recorded(kept, branch, &name, &sampling)?;
    let measures = ys.iter().filter(|y| !sampling.states.contains(y)).cloned().collect();
    let over = vec![Grid { name: name.clone(), low, high, count: sweeping.count }];
    let start = kept.scene.initial_states().unwrap_or_default();
    let (both, at) = (sweeping.both, sweeping.at.clone());
    let request = Request { cancel: cancel.clone(), ..Request::default() };
    let swept = scene.sweeping(&request, Swept { over, both, start, at, measures });
    let mut scene = swept.map_err(|cause: SceneError| Trouble::from(&cause))?;
    // The page does not show exponents.
    scene.sweeps.iter_mut().for_each(|sweep| sweep.search.lyapunov_periods = 0);
    Ok((scene, (name, ys)))
}

/// Returns the columns that a sweep records for the vertical axis of the diagram: the columns in
/// which the branch is drawn, such as the largest and the smallest value of a state.
fn recorded(
    kept: &Kept,
    branch: &Branch,
    name: &str,
    sampling: &Sampling,
) -> Result<Vec<String>, Trouble> {
    let usual = usual_axes(&[("", &*kept.document)]);
    let [x, y] = [0, 1].map(|k| {
        kept.axes[k].clone().or(usual.as_ref().map(|axes| axes[k].clone())).unwrap_or_default()
    });
    if x != name {
        let message = format!(
            "a sweep over `{name}` is drawn only if the horizontal axis shows `{name}`, not `{x}`"
        );
        return Err(Trouble::plain(message));
    }
    let known = |y: &String| sampling.states.contains(y) || sampling.measures.contains(y);
    let mut ys = columns_showing(&y, |name| branch.column(name).is_some());
    ys.retain(known);
    if ys.is_empty() {
        ys.extend(Some(y.clone()).filter(known));
    }
    match ys.is_empty() {
        true => Err(Trouble::plain(format!(
            "a sweep has no column `{y}`: choose a state or a measure such as `max_{}` for the vertical axis",
            sampling.states.first().map_or("x", String::as_str)
        ))),
        false => Ok(ys),
    }
}

/// The number of finished runs of a sweep.
#[derive(Clone, Default, Serialize)]
struct Progress {
    done: usize,
    total: usize,
    failed: usize,
    /// The reason why the first failed run failed.
    why: Option<String>,
    /// Whether the sweep was stopped before it was complete.
    stopped: bool,
}

/// The points of finished runs of one sweep.
#[derive(Serialize)]
struct Points {
    name: String,
    points: Vec<[f64; 2]>,
}

/// An observer that sends the points of finished runs to the page.
struct Drawn<'a> {
    kept: &'a Kept,
    axes: Axes,
    cancel: &'a CancelToken,
    out: &'a Sender<Message>,
    /// The table of the running sweep, without rows.
    table: Option<SweepTable>,
    progress: Progress,
    points: Vec<Points>,
    count: usize,
    next: Instant,
}

impl<'a> Drawn<'a> {
    fn new(
        kept: &'a Kept,
        axes: Axes,
        (cancel, out): (&'a CancelToken, &'a Sender<Message>),
    ) -> Self {
        let progress = Progress::default();
        let (table, points, count, next) = (None, Vec::new(), 0, Instant::now());
        Drawn { kept, axes, cancel, out, table, progress, points, count, next }
    }

    /// Sends the points of the runs that have finished since the last message.
    fn send(&mut self) {
        let specks = json!({ "specks": { "progress": self.progress, "curves": self.points } });
        let _ = self.out.send(Message::of(&specks));
        self.points.clear();
        self.next = Instant::now() + NEXT;
    }

    /// Adds the points of a run.
    fn add(&mut self, table: &SweepTable) {
        let (x, ys) = &self.axes;
        for y in ys {
            let points = specks(&self.kept.document, table, [x, y]);
            let points = points.unwrap_or_default();
            self.count += points.len();
            match self.points.iter_mut().find(|known| known.name == table.name) {
                Some(known) => known.points.extend(points),
                None => self.points.push(Points { name: table.name.clone(), points }),
            }
        }
        if self.count > MOST_POINTS {
            self.cancel.cancel();
        }
    }
}

impl SweepWatch for Drawn<'_> {
    fn begin(&mut self, sweep: &SweepTable) {
        self.table = Some(SweepTable { rows: BTreeMap::new(), ..sweep.clone() });
    }

    fn found(&mut self, known: &Sweeps, found: &Found) {
        self.progress.done += 1;
        if let Err(cause) = &found.attractor {
            self.progress.failed += 1;
            self.progress.why.get_or_insert_with(|| one_line(cause));
        }
        let Some(mut table) = self.table.clone() else { return };
        let all = known.sweeps.iter().find(|sweep| sweep.name == table.name);
        let row = all.and_then(|sweep| sweep.rows.get(&found.run));
        table.rows.extend(row.map(|row| (found.run, row.clone())));
        self.add(&table);
        if Instant::now() >= self.next {
            self.send();
        }
    }
}
