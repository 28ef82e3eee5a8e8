//! What special points are: the coefficients of their normal forms, points of codimension two, and
//! sensitivities, of models that are typed as text.
//!
//! References: `reference/codim2.md` of the project's shared notes, computed with 45–50 digits by two
//! methods (multilinear forms, and power series without these), or closed forms.

mod curves_of_cycles;
mod curves_of_orbits;
mod cycles;
mod equilibria;
mod maps;
mod planted;
mod sensitivities;

pub use crate::common::coefficient;
use std::path::Path;
use tangency::core::continuation::{Branch, SpecialPoint};
use tangency::core::system::Kind;
use tangency::output::Document;
use tangency::scene::{Problem, Range, Request, Scene, execute};

/// A model of this folder.
pub fn model(name: &str) -> Problem {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models/normal_forms");
    let problem = Problem::from_file(&folder.join(format!("{name}.ron")), &[]);
    problem.unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// A parameter with its range.
pub fn range(name: &str, low: f64, high: f64) -> Range {
    Range { name: name.into(), low: Some(low), high: Some(high) }
}

/// Changed values: `mu=0.1 method=shooting`.
pub fn set(values: &str) -> Vec<(String, String)> {
    let pair = |text: &str| {
        let (name, value) = text.split_once('=').unwrap();
        (name.to_string(), value.to_string())
    };
    values.split_whitespace().map(pair).collect()
}

/// What is traced of a model for a request.
pub fn traced(problem: Problem, request: &Request) -> Document {
    let scene = Scene::of_model(problem, "test", request).unwrap_or_else(|error| panic!("{error}"));
    let outcome = execute(&scene, None, &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    outcome.document
}

/// The special point of a kind nearest to a value of a column, which it has up to `most`.
#[track_caller]
pub fn at<'b>(
    branch: &'b Branch,
    kind: Kind,
    name: &str,
    value: f64,
    most: f64,
) -> &'b SpecialPoint {
    let column = branch.column(name).unwrap();
    let distance = |point: &&SpecialPoint| (point.value(column).unwrap() - value).abs();
    let nearest = branch.of_kind(kind).min_by(|a, b| distance(a).total_cmp(&distance(b)));
    let nearest = nearest.unwrap_or_else(|| panic!("no {kind} on {}", branch.name));
    assert!(
        distance(&nearest) <= most,
        "{kind}: {name} is {} away from {value}",
        distance(&nearest)
    );
    assert!(nearest.converged, "{kind} at {name} = {value}");
    nearest
}
