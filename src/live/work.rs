//! Traces the branches of a setup for a page: sends a description of the scene, pictures of
//! unfinished branches, and the result.

use super::command::command;
use super::describe::describe;
use super::library::Library;
use super::opened::Opened;
use super::pages::{Kept, Message, Pages};
use super::plane::{NumberedBar, bars};
use super::preview::Preview;
use super::setup::Setup;
use super::trouble::Trouble;
use crate::core::cancel::CancelToken;
use crate::core::continuation::{Branch, SpecialPoint};
use crate::core::failure::one_line;
use crate::output::{
    Document, Figure, FigureError, Panel, Summary, diagram, figures, hexadecimal, significant,
};
use crate::scene::{Correctable, Resolution, Scene, SceneError};
use serde::Serialize;
use serde_json::json;
use std::sync::Arc;
use std::sync::mpsc::Sender;
use std::time::{Duration, Instant};

/// The number of significant digits with which tables show values.
const DIGITS: usize = 10;
/// The number of significant digits with which tables show errors.
const ERROR_DIGITS: usize = 2;

/// While a control is dragged, the last branches are corrected before they are traced again if their
/// trace took longer than this time; a shorter trace follows the hand without corrected branches.
const SLOW: Duration = Duration::from_millis(100);
/// The correction of branches is given up after this fraction of the duration of their last trace,
/// and after the time `LONGEST`.
const SHARE: f64 = 0.5;
const LONGEST: Duration = Duration::from_millis(200);

/// Traces the branches of a setup and sends messages to its page, whose last result is among the
/// given pages; returns the result that the server keeps.
pub(super) fn trace(
    setup: &Setup,
    (library, opened): (&Library, Option<&Opened>),
    page: (&Pages, &str),
    (cancel, out): (&CancelToken, &Sender<Message>),
) -> Option<Kept> {
    let begin = Instant::now();
    let fail = |cause: &SceneError| {
        let _ = out.send(Message::of(&json!({ "failed": Trouble::from(cause) })));
    };
    let (setup, left_out) = &setup.suited(library).inspect_err(fail).ok()?;
    let values = setup.values(library);
    let scene =
        values.as_ref().map_err(SceneError::clone).and_then(|_| setup.scene(library, cancel));
    if let Ok(values) = &values {
        let description = describe(setup, values, scene.as_ref().ok());
        let _ = out.send(Message::of(&json!({ "described": description })));
    }
    let traced = scene.and_then(|scene| {
        let resolution = scene.resolve(None)?;
        let corrected = corrected(setup, &resolution, page);
        Ok(branches(setup, &resolution, corrected, (out, cancel)))
    });
    let (scene, mut document, failed) = traced.inspect_err(fail).ok()?;
    if cancel.is_cancelled() && document.branches.is_empty() {
        let trouble = Trouble::plain("the trace was stopped before its first branch was computed");
        let _ = out.send(Message::of(&json!({ "failed": trouble })));
        return None;
    }
    let axes = [setup.x.clone(), setup.y.clone()];
    let scene = Arc::new(scene);
    let correctable = Arc::new(Correctable::of(&scene, &mut document.branches));
    let duration = begin.elapsed();
    let kept = Kept {
        name: setup.file_name(),
        scene,
        document: Arc::new(document),
        duration,
        correctable,
        axes,
        histories: Vec::new(),
    };
    let stopped = cancel.is_cancelled();
    let done = Done {
        millis: duration.as_secs_f64() * 1e3,
        stopped,
        command: command(setup, library, opened),
        failed: failed.iter().map(|(run, cause)| Trouble::of_run(run, cause)).collect(),
        warnings: [left_out.warnings(), kept.scene.warnings()].concat(),
        drawing: Drawing::of(&kept),
        branches: kept.document.branches.iter().map(BranchRow::new).collect(),
    };
    let _ = out.send(Message::of(&json!({ "done": done })));
    Some(kept)
}

/// A scene with all its runs, the results of the runs, and the errors of the runs that failed.
type Traced = (Scene, Document, Vec<(String, SceneError)>);

/// Returns the last branches of a page, corrected for the values of a setup whose control is being
/// dragged; empty if the branches are traced quickly, or cannot be corrected quickly.
fn corrected(setup: &Setup, resolution: &Resolution, (pages, id): (&Pages, &str)) -> Vec<Branch> {
    let last = pages.kept(id).filter(|last| setup.draft && last.duration > SLOW);
    let Some(last) = last else { return Vec::new() };
    let until = Instant::now() + last.duration.mul_f64(SHARE).min(LONGEST);
    let Some(corrected) = last.correctable.corrected(resolution, until) else { return Vec::new() };
    let branches = corrected.branches().to_vec();
    pages.keep_corrected(id, &last, corrected);
    branches
}

/// Traces the branches; until a branch is complete, its picture shows its corrected points.
fn branches(
    setup: &Setup,
    resolution: &Resolution,
    corrected: Vec<Branch>,
    at: (&Sender<Message>, &CancelToken),
) -> Traced {
    let axes = [setup.x.as_deref(), setup.y.as_deref()];
    let mut preview = Preview::new((resolution.scene().plot.clone(), axes), corrected, at);
    if let Some(following) = setup.following() {
        let (scene, outcome) = resolution.explore(&following, &mut preview);
        let failed = outcome.error.into_iter().map(|cause| (String::new(), cause));
        return (scene, outcome.document, failed.collect());
    }
    let (outcome, failed) = resolution.trace_each(&mut preview);
    (resolution.scene().clone(), outcome.document, failed)
}

/// The result of tracing branches, as it is sent to the page.
#[derive(Serialize)]
struct Done<'a> {
    /// The duration of the computation in milliseconds.
    millis: f64,
    /// Whether the computation was stopped before all branches were complete.
    stopped: bool,
    /// The equivalent command.
    command: String,
    failed: Vec<Trouble>,
    warnings: Vec<String>,
    drawing: Drawing,
    branches: Vec<BranchRow<'a>>,
}

/// The diagrams in which a result is shown.
#[derive(Serialize)]
pub(super) struct Drawing {
    colours: Vec<String>,
    /// The names of the columns that the axes can show.
    columns: Vec<String>,
    panels: Vec<serde_json::Value>,
    /// The names of the two parameters on the axes of each panel; `None` for panels that do not
    /// show curves of special points in two parameters.
    planes: Vec<Option<[String; 2]>>,
    /// The reason why the diagram cannot be drawn; `None` if the diagram can be drawn.
    trouble: Option<String>,
    /// The ranges of simulated histories over the first diagram.
    bars: Vec<NumberedBar>,
}

impl Drawing {
    /// Draws the diagrams of a result with the chosen columns on the axes.
    pub fn of(kept: &Kept) -> Self {
        let (panels, trouble) = match diagrams(kept) {
            Ok(figures) => (figures, None),
            Err(cause) => (Vec::new(), Some(one_line(&cause))),
        };
        let planes = panels.iter().map(|figure| plane(kept, figure)).collect();
        let panels = panels.iter().map(|figure| json!(Panel::new(figure)));
        let mut columns: Vec<String> = Vec::new();
        for name in kept.document.branches.iter().flat_map(Branch::columns) {
            // Largest and smallest values are drawn together, by the name of their state.
            let state = name.strip_prefix("max_").or_else(|| name.strip_prefix("min_"));
            for name in state.into_iter().chain([name]) {
                if !columns.iter().any(|known| known == name) {
                    columns.push(name.into());
                }
            }
        }
        let (colours, panels) = (hexadecimal(), panels.collect());
        Drawing { colours, columns, panels, planes, trouble, bars: bars(kept) }
    }
}

/// Returns the names of the two parameters on the axes of a figure that shows a curve of special
/// points.
fn plane(kept: &Kept, figure: &Figure) -> Option<[String; 2]> {
    let plot = &kept.document.plot;
    let is_plain = |name: &str| plot.deviations.iter().all(|it| it.column != name);
    kept.document.branches.iter().filter(|branch| branch.condition.is_some()).find_map(|branch| {
        let [first, second] = &branch.released[..] else { return None };
        let labels = [figure.x_label.as_str(), figure.y_label.as_str()];
        let is_plane = |[x, y]: &[&String; 2]| [plot.label(x), plot.label(y)] == labels;
        let names = [[first, second], [second, first]].into_iter().find(is_plane)?;
        let plain = names.iter().all(|name| is_plain(name));
        plain.then(|| names.map(String::clone))
    })
}

/// Returns the diagrams of a result, without the figures of profiles.
fn diagrams(kept: &Kept) -> Result<Vec<Figure>, FigureError> {
    let documents = [("", &*kept.document)];
    let [x, y] = [kept.axes[0].as_deref(), kept.axes[1].as_deref()];
    let chosen = (x.is_some() || y.is_some()).then(|| diagram(&documents, x, y.as_slice()));
    let mut all = figures(&documents, &[], None, &[])?;
    all.retain(|figure| figure.series.iter().any(|series| !series.origins.is_empty()));
    if let (Some(chosen), Some(first)) = (chosen.transpose()?, all.first_mut()) {
        *first = chosen;
    }
    all.iter().try_for_each(|figure| figure.extent().map(|_| ()))?;
    Ok(all)
}

/// A branch in the table of results, with its special points.
#[derive(Serialize)]
struct BranchRow<'a> {
    name: &'a str,
    summary: String,
    warnings: &'a [String],
    special: Vec<PointRow<'a>>,
}

impl<'a> BranchRow<'a> {
    fn new(branch: &'a Branch) -> Self {
        BranchRow {
            name: &branch.name,
            summary: Summary(branch).to_string(),
            warnings: &branch.warnings,
            special: branch.special.iter().map(|point| PointRow::new(branch, point)).collect(),
        }
    }
}

/// A special point in the table of results.
#[derive(Serialize)]
struct PointRow<'a> {
    label: usize,
    kind: &'a str,
    meaning: &'a str,
    event: &'a str,
    converged: bool,
    /// The values of the varied parameters at the special point.
    at: Vec<String>,
    error: String,
    unstable: Option<usize>,
    numbers: Vec<String>,
}

impl<'a> PointRow<'a> {
    fn new(branch: &Branch, point: &'a SpecialPoint) -> Self {
        let value = |name: &String| {
            let value = branch.column(name).and_then(|column| point.value(column))?;
            Some(format!("{name} = {}", significant(value, DIGITS)))
        };
        let numbers = point.numbers.iter().filter(|number| !number.is_detail());
        PointRow {
            label: point.label,
            kind: point.kind.letters(),
            meaning: point.kind.meaning(),
            event: &point.event,
            converged: point.converged,
            at: branch.released.iter().filter_map(value).collect(),
            error: significant(point.error, ERROR_DIGITS),
            unstable: point.unstable,
            numbers: numbers
                .map(|number| format!("{} = {}", number.name, significant(number.value, 6)))
                .collect(),
        }
    }
}
