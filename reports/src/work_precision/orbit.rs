//! Work-precision diagrams of three special points of Mita's actuator (a fold, a period doubling
//! and a grazing), computed by several methods with several numbers of shooting segments and mesh
//! intervals.

use super::plan::{Method, Plan};
use super::scenes::{Counted, Sought, tracing};
use tangency::core::system::Kind;

/// A scene of orbits with one impact per period at ω = 0.5, on meshes of fixed size; the branch
/// leads from the grazing point through the fold to the period doubling.
const ORBITS: &str = r#"Scene(
    title: "Orbits with an impact a period",
    problem: Mita(),
    parameters: [("voltage", 0.2), ("frequency", 0.5)],
    settings: (max_step: 0.1, refinement: 0.0, target_mesh_error: 1.0),
    runs: [
        (name: "P(0,1)", along: [(name: "voltage", low: 0.2, high: 0.24)]),
        (name: "P(1,1)", start: From(run: "P(0,1)", kind: G, switch: true), along: [(name: "voltage", low: 0.15, high: 0.6)]),
    ],
)"#;

const POINTS: [(&str, &[Sought]); 3] = [
    ("A grazing", &[Sought { branch: "P(0,1)", kind: Kind::G, column: "voltage" }]),
    ("A fold", &[Sought { branch: "P(1,1)", kind: Kind::LP, column: "voltage" }]),
    ("A period doubling", &[Sought { branch: "P(1,1)", kind: Kind::PD, column: "voltage" }]),
];

fn shooting(
    (scheme, name): (&str, &str),
    segments: usize,
    tolerance: &str,
    sought: &'static [Sought],
) -> Method {
    let count = segments.to_string();
    let line = match segments {
        1 => format!("shooting, {name}"),
        _ => format!("shooting, {name}, {segments} segments"),
    };
    let settings = [("scheme", scheme), ("segments", &*count), ("flow_tolerance", tolerance)];
    tracing((&line, tolerance.into()), ORBITS, &settings, sought, Counted::Evaluations)
}

fn collocation(degree: usize, intervals: usize, sought: &'static [Sought]) -> Method {
    let (points, count) = (degree.to_string(), intervals.to_string());
    let settings = [("method", "collocation"), ("degree", &*points), ("intervals", &*count)];
    let line = (&*format!("collocation, {degree} points"), format!("{intervals} intervals"));
    tracing(line, ORBITS, &settings, sought, Counted::Unknowns)
}

/// Returns the method that finds the fold on the branch of orbits.
pub(super) fn fold_on_a_branch() -> Method {
    let line = ("on the branch of orbits", "1e-12".into());
    let settings = [("flow_tolerance", "1e-12")];
    tracing(line, ORBITS, &settings, POINTS[1].1, Counted::Evaluations)
}

/// Plans a diagram for each kind of special point.
pub(super) fn plans() -> Vec<Plan> {
    let plan = |(title, sought): (&str, &'static [Sought])| {
        let reference = shooting(("DormandPrince8", "order 8"), 1, "1e-14", sought);
        let mut methods = Vec::new();
        for (scheme, segments) in [
            (("DormandPrince8", "order 8"), 1),
            (("DormandPrince8", "order 8"), 2),
            (("DormandPrince8", "order 8"), 4),
            (("DormandPrince5", "order 5"), 1),
            (("Rodas5P", "Rodas5P"), 1),
        ] {
            for tolerance in ["1e-4", "1e-6", "1e-8", "1e-10", "1e-12"] {
                if (scheme.0, tolerance) != ("Rodas5P", "1e-12") {
                    methods.push(shooting(scheme, segments, tolerance, sought));
                }
            }
        }
        for degree in [2, 3, 4, 5, 7] {
            let on = |intervals| collocation(degree, intervals, sought);
            methods.extend([5, 10, 20, 40].map(on));
        }
        let plan = Plan::of(title, reference).counting("evaluations or unknowns").with(methods);
        plan.recommending("shooting, order 8", "1e-12")
    };
    POINTS.map(plan).into()
}
