//! Methods that trace a scene with given settings; their answers are the coordinates of special
//! points on the traced branches.

use super::plan::{Answer, Method};
use tangency::core::failure::one_line;
use tangency::core::ode::work;
use tangency::core::system::Kind;
use tangency::scene::{Scene, SceneError, execute};

/// A special point to find in a traced scene: the first point of a kind on a branch, and the column
/// whose value is the answer.
#[derive(Clone, Copy)]
pub(super) struct Sought {
    pub branch: &'static str,
    pub kind: Kind,
    pub column: &'static str,
}

/// A scene of orbits without impacts, traced up to their grazing.
pub(super) const PASSING: &str = r#"Scene(
    title: "Orbits without impacts",
    problem: Mita(),
    parameters: [("voltage", 0.2), ("frequency", 0.5)],
    settings: (refinement: 0.0, target_mesh_error: 1.0),
    runs: [(name: "P(0,1)", along: [(name: "voltage", low: 0.2, high: 0.24)])],
)"#;

/// The grazing point of the orbits without impacts.
pub(super) const GRAZING: &[Sought] =
    &[Sought { branch: "P(0,1)", kind: Kind::G, column: "voltage" }];

/// The unit in which the work of tracing a scene is counted.
#[derive(Clone, Copy)]
pub(super) enum Counted {
    /// The number of unknowns of the branch.
    Unknowns,
    /// The number of evaluations of the vector field during time integration.
    Evaluations,
}

/// Formats a number followed by a noun in the singular or plural: `1 mode`, `2 modes`.
pub(super) fn number_of(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// Returns a scene with changed settings, or the error of the scene.
pub(super) fn scene(text: &str, settings: &[(&str, &str)]) -> Result<Scene, String> {
    let set = |mut scene: Scene| -> Result<Scene, SceneError> {
        settings.iter().try_for_each(|(name, value)| scene.set(name, value))?;
        Ok(scene)
    };
    Scene::parse(text).and_then(set).map_err(|cause| one_line(&cause))
}

/// The branches of a traced scene.
pub(super) struct Found {
    pub numbers: Vec<f64>,
    unknowns: usize,
    evaluations: u64,
}

/// Traces a scene, and returns the requested coordinate of each special point to find.
pub(super) fn found(scene: &Scene, sought: &[Sought]) -> Result<Found, String> {
    let before = work().evaluations;
    let outcome = execute(scene, None, &mut ());
    let branches = &outcome.document.branches;
    let lengths = branches.last().into_iter().flat_map(|branch| &branch.unknowns);
    let unknowns = lengths.map(|group| group.length).sum();
    let number = |Sought { branch, kind, column }: &Sought| {
        let none = || format!("no {kind} is found on {branch}");
        let branch = outcome.document.branch(branch).map_err(|_| none())?;
        let point = branch.of_kind(*kind).next().ok_or_else(none)?;
        branch.column(column).and_then(|column| point.value(column)).ok_or_else(none)
    };
    let numbers = sought.iter().map(number).collect::<Result<_, _>>();
    let evaluations = work().evaluations - before;
    match (outcome.error, numbers) {
        (Some(cause), _) => Err(one_line(&cause)),
        (None, numbers) => Ok(Found { numbers: numbers?, unknowns, evaluations }),
    }
}

/// Returns the method that traces a scene with given settings and finds its special points.
pub(super) fn tracing(
    (line, setting): (&str, String),
    text: &str,
    settings: &[(&str, &str)],
    sought: &'static [Sought],
    counted: Counted,
) -> Method {
    let scene = scene(text, settings);
    Method::new(line, setting, move || {
        let Found { numbers, unknowns, evaluations } = found(scene.as_ref()?, sought)?;
        let work = match counted {
            Counted::Unknowns => unknowns as f64,
            Counted::Evaluations => evaluations as f64,
        };
        Ok(Answer { numbers, work })
    })
}
