//! An entry of the gallery as an interactive page and a thumbnail, traced by the library as the
//! command line traces it.

use super::SCRIPT;
use super::entries::{Entry, Wanted};
use std::num::NonZeroUsize;
use std::path::Path;
use tangency::core::attractor::AttractorSearch;
use tangency::core::sweep::Part;
use tangency::output::{COLUMN, Document, FileError, Format, Render, RenderError, Results, Sweeps};
use tangency::scene::{
    Outcome, Problem, Range, Request, Scene, SceneError, Sweep, execute, explore, sweep,
};

/// The largest number of periods that a sweep of the gallery simulates. A longer sweep is computed
/// on a coarser grid.
pub const PERIODS: usize = 60_000;
/// The largest number of periods over which a coarser sweep averages exponents.
const EXPONENT: usize = 300;
/// The cost of a period with a tangent vector, in units of the cost of a period without a tangent
/// vector.
const WITH_TANGENT: usize = 3;

/// The reason why an entry of the gallery could not be drawn.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// The scene is invalid, or a run of the scene failed.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The result cannot be drawn.
    #[error(transparent)]
    Drawing(#[from] RenderError),
    /// The page or the thumbnail cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
}

/// A traced entry of the gallery.
pub(super) struct Drawn {
    /// The title of the scene.
    pub title: String,
    /// The subject of the scene in one line, if the scene states a subject.
    pub summary: Option<String>,
    /// The scene, as `tangency show` prints it.
    pub scene: String,
    /// The commands that make the figure.
    pub commands: Vec<String>,
    /// The difference between the figure of the gallery and the figure that the commands make.
    pub notes: Vec<String>,
    /// The interactive page, and the thumbnail as SVG.
    pub files: [Vec<u8>; 2],
}

impl Entry {
    /// Traces the entry, and draws its page and its thumbnail.
    pub(super) fn draw(&self) -> Result<Drawn, Failure> {
        let (mut scene, outcome) = self.traced()?;
        let shown = scene.to_ron();
        if let Some(error) = outcome.error {
            return Err(error.into());
        }
        let document = outcome.document;
        let notes = reduce(&mut scene.sweeps);
        let sweeps = match scene.sweeps.is_empty() {
            true => None,
            false => Some(sweep(&scene, &self.name, ONE_THREAD, None, &mut ())?),
        };
        let sweeps = sweeps.as_slice();
        let traced = !document.branches.is_empty();
        let files = self.render(traced.then_some(&document), sweeps)?;
        let commands = self.commands(traced, !sweeps.is_empty());
        let Scene { title, summary, .. } = scene;
        Ok(Drawn { title, summary, scene: shown, commands, notes, files })
    }

    /// Returns the scene of the entry, and the branches of the scene.
    fn traced(&self) -> Result<(Scene, Outcome), SceneError> {
        let Some(Wanted { along: (name, low, high), depth }) = self.request else {
            let scene = Scene::parse(self.text)?;
            let outcome = match scene.runs.is_empty() {
                true => Outcome { document: Document::new(&*scene.title, Vec::new()), error: None },
                false => execute(&scene, None, &mut ()),
            };
            return Ok((scene, outcome));
        };
        let along = vec![Range { name: name.into(), low: Some(low), high: Some(high) }];
        let problem = Problem::from_text(Path::new(self.source()), self.text, &[])?;
        let request = Request { along, ..Request::default() };
        let scene = Scene::of_model(problem, self.stem(), &request)?;
        Ok(explore(&scene, depth, &mut ()))
    }

    /// Returns the interactive page, and the first panel as a thumbnail without a title.
    fn render(
        &self,
        document: Option<&Document>,
        sweeps: &[Sweeps],
    ) -> Result<[Vec<u8>; 2], RenderError> {
        let named = document.map(|document| (self.stem(), document));
        let documents = named.as_slice();
        let page = Results { documents, sweeps, plotly: Some(SCRIPT), ..Results::default() };
        let thumbnail = Results { width: Some(COLUMN), panel: Some("a"), title: Some(""), ..page };
        Ok([page.render(Format::Html)?, thumbnail.render(Format::Svg)?])
    }

    /// Returns the commands that make the figure of the entry.
    fn commands(&self, traced: bool, swept: bool) -> Vec<String> {
        let verb = if swept { "sweep" } else { "trace" };
        let of = |exists: bool, ending| exists.then(|| format!("out/{}.{ending} ", self.stem()));
        let files: String = [of(traced, "ron"), of(swept, "npz")].into_iter().flatten().collect();
        vec![
            format!("tangency {verb} {}", self.arguments),
            format!("tangency plot {files}--out {}.html", self.name),
        ]
    }
}

/// The whole sweep, computed on one thread because the gallery traces one entry on each core.
const ONE_THREAD: Part = Part { threads: Some(NonZeroUsize::MIN), ..Part::WHOLE };

/// Omits sweeps that search crises, and makes the grids of long sweeps coarser; returns a note on
/// each change.
fn reduce(sweeps: &mut Vec<Sweep>) -> Vec<String> {
    let mut notes = Vec::new();
    sweeps.retain(|Sweep { name, crisis, .. }| {
        if crisis.is_some() {
            notes.push(format!("The figure omits the sweep “{name}”, which searches crises."));
        }
        crisis.is_none()
    });
    notes.extend(sweeps.iter_mut().filter_map(coarsened));
    notes
}

/// Makes the grid of a sweep coarser, and averages exponents over fewer periods, if the sweep would
/// simulate more than [`PERIODS`] periods; returns a note on the changes.
fn coarsened(Sweep { name, over, search, starts, .. }: &mut Sweep) -> Option<String> {
    let runs = over.iter().map(|grid| grid.count).product::<usize>() * starts.len().max(1);
    let work = |search: &AttractorSearch| {
        let tangent = WITH_TANGENT * search.lyapunov_periods;
        (runs * (search.transient + search.recorded_periods + tangent)) as f64 / PERIODS as f64
    };
    if work(search) <= 1.0 {
        return None;
    }
    let exponents = match search.lyapunov_periods {
        periods if periods > EXPONENT => {
            search.lyapunov_periods = EXPONENT;
            format!(" Exponents are averages over {EXPONENT} periods, not {periods}.")
        }
        _ => String::new(),
    };
    let (whole, factor) = (counts(over), work(search).powf(1.0 / over.len() as f64).max(1.0));
    for grid in over.iter_mut() {
        grid.count = (grid.count as f64 / factor).ceil().max(2.0) as usize;
    }
    let coarse = counts(over);
    let runs = format!("The figure has {coarse} of the {whole} runs of the sweep “{name}”.");
    Some(runs + &exponents)
}

/// Returns the numbers of values along the axes of a sweep, as a product.
fn counts(over: &[tangency::scene::Grid]) -> String {
    over.iter().map(|grid| grid.count.to_string()).collect::<Vec<_>>().join(" × ")
}
