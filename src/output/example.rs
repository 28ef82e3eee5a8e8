//! An example branch in closed form, for documentation and tests.

use crate::core::continuation::{Branch, End, Point, Settings, SpecialPoint};
use crate::core::system::Kind;

/// Returns the branch of the parallel-plate actuator, `load = u (1 − u)²` for `0 ≤ u ≤ 0.8`: it is
/// stable up to its fold at `u = 1/3`, `load = 4/27`, and unstable beyond the fold. The branch is
/// given by a formula and computed without a solver, so that examples of output do not depend on
/// the solver.
///
/// ```
/// let branch = tangency::output::example_branch();
/// assert_eq!((branch.points.len(), branch.special.len()), (41, 4));
/// assert_eq!(branch.labelled(3).map(|fold| fold.parameters[0]), Some(4.0 / 27.0));
/// ```
pub fn example_branch() -> Branch {
    let point = |u: f64| Point::new(vec![load(u), 1.2], vec![u], Some(usize::from(u > 1.0 / 3.0)));
    Branch {
        name: "plate".into(),
        condition: None,
        itinerary: String::new(),
        method: String::new(),
        unknowns: vec!["u".into()],
        parameters: vec!["load".into(), "aspect_ratio".into()],
        released: vec!["load".into()],
        monitors: vec!["deflection".into()],
        points: (0..=40).map(|i| point(f64::from(i) / 50.0)).collect(),
        special: vec![
            special(1, Kind::EP, "start of the branch", 0, 0.0),
            special(2, Kind::UZ, "deflection = 0.15", 7, 0.15),
            special(3, Kind::LP, "fold", 16, 1.0 / 3.0),
            special(4, Kind::EP, "end of the branch", 40, 0.8),
        ],
        stretches: Vec::new(),
        ends: [End::Start, End::MonitorBound { name: "deflection".into(), value: 0.8 }],
        warnings: Vec::new(),
        settings: Settings::default(),
    }
}

fn load(u: f64) -> f64 {
    u * (1.0 - u).powi(2)
}

fn special(label: usize, kind: Kind, event: &str, after: usize, u: f64) -> SpecialPoint {
    // Rounding would make the last digit of the fold's load arbitrary.
    let exact = if kind == Kind::LP { 4.0 / 27.0 } else { load(u) };
    let neighbour = |i: usize| load(i.min(40) as f64 / 50.0);
    SpecialPoint {
        label,
        kind,
        event: event.into(),
        after,
        parameters: vec![exact, 1.2],
        monitors: vec![u],
        unstable: Some(usize::from(u > 1.0 / 3.0)),
        undetermined: None,
        eigenvalues: Vec::new(),
        numbers: Vec::new(),
        sensitivities: Vec::new(),
        subkind: None,
        multiplicity: 1,
        error: if kind == Kind::EP { 0.0 } else { 2.5e-15 },
        bracket: [neighbour(after), neighbour(after + 1)],
        converged: true,
        state: vec![u],
        tangent: vec![1.0, 1.0],
        slopes: None,
        mesh: Vec::new(),
        mesh_shift: Vec::new(),
        profiles: Vec::new(),
        fields: Vec::new(),
        without_phase_response: None,
    }
}
