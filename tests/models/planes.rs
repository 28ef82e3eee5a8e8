//! Arrays of two indices: discretised equations in the plane, in three lines.

use super::{scene, traced};
use crate::common::close;
use std::f64::consts::PI;
use tangency::core::hybrid::HybridSystem;
use tangency::core::problem::{DiscreteMap, Group, PlaneField, VectorField, ZeroProblem};
use tangency::language::{Model, Source, Zero};
use tangency::output::{COLUMN, Document, draw, figures};
use tangency::scene::execute;

/// The residual of a model at some unknowns.
fn residual(zero: &Zero, z: &[f64], p: &[f64]) -> Vec<f64> {
    let mut r = vec![0.0; z.len()];
    zero.residual(z, p, &mut r);
    r
}

fn zero(text: &str) -> std::sync::Arc<Zero> {
    match Model::read(&Source::new("", text), &[]) {
        Ok(Model::Zero(zero)) => zero,
        Ok(_) => panic!("a zero problem"),
        Err(error) => panic!("{error}"),
    }
}

/// Bratu's problem in the plane, with the elements beyond the edges as `beyond` defines them.
fn bratu(rows: usize, columns: usize, beyond: &str) -> std::sync::Arc<Zero> {
    zero(&format!(
        "Residual(
            unknowns: [(\"u[i=1..m, j=1..n]\", \"u[i-1,j] + u[i+1, j] + u[i,j-1] + u[i,j+1] - 4*u[i,j] + lambda*exp(u[i,j])\")],
            definitions: [(\"m\", {rows}), (\"n\", {columns}), {beyond}], parameters: [(\"lambda\", 0)])"
    ))
}

/// The five-point formula, written as loops; `beyond` is the value beyond an edge beside a value.
fn five_points(rows: usize, columns: usize, z: &[f64], beyond: impl Fn(f64) -> f64) -> Vec<f64> {
    let at = |i: i64, j: i64, own: f64| match (0..rows as i64).contains(&i)
        && (0..columns as i64).contains(&j)
    {
        true => z[i as usize * columns + j as usize],
        false => beyond(own),
    };
    let all = (0..rows as i64).flat_map(|i| (0..columns as i64).map(move |j| (i, j)));
    all.map(|(i, j)| {
        let own = at(i, j, 0.0);
        let around = [(i - 1, j), (i + 1, j), (i, j - 1), (i, j + 1)];
        around.iter().map(|(i, j)| at(*i, *j, own)).sum::<f64>() - 4.0 * own + 0.7 * own.exp()
    })
    .collect()
}

#[test]
fn edges_in_three_ways() {
    let z: Vec<f64> = (0..20).map(|k| (k as f64).sin()).collect();
    let one_by_one = "(\"u[0, j=1..n]\", 0), (\"u[m+1, j=1..n]\", 0), (\"u[i=1..m, 0]\", 0), (\"u[i=1..m, n+1]\", 0)";
    for beyond in [one_by_one, "(\"u[i=0..m+1, j=0..n+1]\", 0)"] {
        let r = residual(&bratu(4, 5, beyond), &z, &[0.7]);
        for (r, expected) in r.iter().zip(five_points(4, 5, &z, |_| 0.0)) {
            close(*r, expected, 1e-14);
        }
    }
    // No flux: the value beyond an edge is the one beside it.
    let no_flux = "(\"u[i=0..m+1, j=0..n+1]\", \"u[min(max(i, 1), m), min(max(j, 1), n)]\")";
    let r = residual(&bratu(4, 5, no_flux), &z, &[0.7]);
    for (r, expected) in r.iter().zip(five_points(4, 5, &z, |own| own)) {
        close(*r, expected, 1e-14);
    }
}

/// `Δu + λ(u + u³) = 0` in a rectangle of five by four cells: the first branch point is where λ is
/// the least eigenvalue of the five-point formula, `Σ 4 (n+1)² sin²(π/2(n+1))`.
const RECTANGLE: &str = "Scene(title: \"t\", problem: Residual(
    unknowns: [(\"u[i=1..m, j=1..n]\", \"(u[i-1,j] - 2*u[i,j] + u[i+1,j])*(m+1)^2 + (u[i,j-1] - 2*u[i,j] + u[i,j+1])*(n+1)^2 + l*(u[i,j] + u[i,j]^3)\")],
    definitions: [(\"m\", 4), (\"n\", 3), (\"u[i=0..m+1, j=0..n+1]\", 0)], parameters: [(\"l\", 0)],
    monitors: [(\"middle\", \"u[2,2]\")]),
    runs: [
        Run(name: \"zero\", along: [(name: \"l\", low: 0, high: 20)]),
        Run(name: \"crossing\", start: From(run: \"zero\", kind: BP, switch: true), along: [(name: \"l\", low: 0, high: 20)], bounds: [(name: \"middle\", low: -1, high: 1)]),
    ])";

#[test]
fn a_branch_point_in_the_plane() {
    let branches = traced(RECTANGLE);
    let first = branches[0].special.iter().find(|it| it.kind.to_string() == "BP").expect("a BP");
    let part = |n: f64| 4.0 * (n + 1.0).powi(2) * (PI / (2.0 * (n + 1.0))).sin().powi(2);
    close(first.parameters[0], part(4.0) + part(3.0), 1e-10);
    // The array is one group, and a map beside the points of the branch that crosses.
    assert_eq!(
        branches[1].unknowns,
        [Group { indices: vec![[1, 4], [1, 3]], ..Group::new("u", 12) }]
    );
    let end = branches[1].special.last().expect("an end");
    assert_eq!(end.fields[0].along, [vec![1, 2, 3, 4], vec![1, 2, 3]]);
    assert_eq!(end.fields[0].values, end.state);
}

#[test]
fn fields_are_drawn_as_maps() {
    let outcome = execute(&scene(RECTANGLE), None, &mut ());
    let documents = [("plane", &outcome.document)];
    let all = figures(&documents, &[], None, &[]).expect("figures");
    let maps: Vec<_> = all.iter().filter(|figure| figure.title.starts_with("u at ")).collect();
    assert!(!maps.is_empty() && maps.len() <= 3, "{}", maps.len());
    // The cells cover the rectangle once.
    for map in &maps {
        let area: f64 = map.tiles.iter().map(|tile| tile.size[0] * tile.size[1]).sum();
        close(area, 12.0, 1e-12);
    }
    assert!(draw(&all, COLUMN).expect("a picture").contains("u from "));
}

/// A document with fields is read back as it is written; fields keep 64 values of an index at most,
/// among them the first and the last.
#[test]
fn fields_in_documents() {
    let outcome = execute(&scene(RECTANGLE), None, &mut ());
    let text = outcome.document.to_ron().expect("a text");
    assert_eq!(Document::parse(&text).expect("a document").branches, outcome.document.branches);
    let group = Group { indices: vec![[1, 316], [0, 64]], ..Group::new("u", 316 * 65) };
    let z: Vec<f64> = (0..316 * 65).map(f64::from).collect();
    let field = &PlaneField::of_arrays(&[group], &z)[0];
    let [rows, columns] = &field.along;
    assert!(
        rows.len() <= 65 && columns.len() <= 65 && field.values.len() == rows.len() * columns.len()
    );
    assert_eq!(
        [rows[0], rows[rows.len() - 1], columns[0], columns[columns.len() - 1]],
        [1, 316, 0, 64]
    );
    assert_eq!(field.values.last(), z.last());
}

/// Initial values, scales, resets and ends of boundary-value problems name elements by two indices.
#[test]
fn elements_by_two_indices() {
    let text = "HybridEquations(
        modes: [(name: \"m\", states: [(\"u[i=1..2, j=1..3]\", \"-i*j\")])],
        guards: [(name: \"g\", function: \"u[1,1]\", reset: [(\"u[2, k=2..3]\", \"k*u[1, k-1]\")])],
        initial: [(\"u[i=1..2, j=2..3]\", \"10*i + j\"), (\"u[1,1]\", 5)], scales: [(\"u[1, j=1..3]\", 2)],
    )";
    let Ok(Model::Hybrid(system)) = Model::read(&Source::new("", text), &[]) else {
        panic!("a model")
    };
    let (z, mut after) = ([1.0, 2.0, 3.0, 4.0, 5.0, 6.0], [0.0; 6]);
    system.reset(0, (0, 0), 0.0, &z, &[], &mut after);
    assert_eq!(after, [1.0, 2.0, 3.0, 4.0, 2.0, 6.0]);
    assert_eq!(system.scales(&[]).states.len(), 3);
    let Ok(model) = Model::read(&Source::new("", text), &[]) else { panic!("a model") };
    let initial =
        [("u[1,2]", 12.0), ("u[1,3]", 13.0), ("u[2,2]", 22.0), ("u[2,3]", 23.0), ("u[1,1]", 5.0)];
    assert_eq!(model.initial(&[]), initial.map(|(name, value)| (name.to_string(), value)));
    let text = "Boundary(states: [(\"u[i=1..1, j=1..2]\", \"u[1, 3-j]\")], conditions: [\"u[1,1](0) - 1\", \"u[1, 2](1)\"])";
    assert!(Model::read(&Source::new("", text), &[]).is_ok());
}

/// Arrays of the other kinds are groups as well, and short ones have a column for each element.
#[test]
fn groups_of_all_kinds() {
    let model = |text: &str| Model::read(&Source::new("", text), &[]).expect("a model");
    let group = |length| Group { indices: vec![[1, length]], ..Group::new("u", length as usize) };
    let Model::Field(field) =
        model("Equations(states: [(\"v\", \"1\"), (\"u[i=1..3]\", \"-u[i]\")])")
    else {
        panic!()
    };
    assert_eq!(VectorField::names(&*field).unknowns, [Group::from("v"), group(3)]);
    let Model::Map(map) = model("Map(states: [(\"u[1]\", \"u[1]\"), (\"u[2]\", \"0.5*u[2]\")])")
    else {
        panic!()
    };
    assert_eq!(DiscreteMap::names(&*map).unknowns, [group(2)]);
    let cycles = "Scene(title: \"t\", problem: Equations(states: [(\"u[i=1..2]\", \"if(i == 1, u[2], -u[1] + a*(1 - u[1]^2)*u[2])\")]), parameters: [(\"a\", 1)],
        runs: [Run(name: \"r\", start: Simulated(transient: 50, state: [(\"u[1]\", 1)]), along: [(name: \"a\", low: 1, high: 1.2)])])";
    let branch = &traced(cycles)[0];
    let [u, period] = &branch.unknowns[..] else { panic!("{:?}", branch.unknowns) };
    assert!(u.indices == [[1, 2]] && u.length.is_multiple_of(2) && period.name == "period");
    assert!(["max_u[1]", "min_u[2]"].iter().all(|name| branch.column(name).is_some()));
}

/// Arclength measures an array as one: a branch has as many points with many elements as with few.
#[test]
fn the_number_of_points_is_that_of_the_curve() {
    let points = |n: usize| {
        let text = format!(
            "Scene(title: \"t\", problem: Residual(
                unknowns: [(\"u[i=1..n]\", \"(u[i-1] - 2*u[i] + u[i+1])*(n+1)^2 + lambda*exp(u[i])\")],
                definitions: [(\"n\", {n}), (\"u[i=0..n+1]\", 0)], parameters: [(\"lambda\", 0)],
                monitors: [(\"rms\", \"sqrt(sum(i, 1, n, u[i]^2)/n)\")]),
                runs: [Run(name: \"r\", along: [(name: \"lambda\", low: 0, high: 4)], bounds: [(name: \"rms\", high: 5)])])"
        );
        traced(&text)[0].points.len() as f64
    };
    let (few, many) = (points(50), points(200));
    assert!((many / few - 1.0).abs() < 0.1, "{few} and {many}");
}

/// Bratu's problem in the unit square folds at λ = 6.808124423, by Richardson's extrapolation. Its
/// matrices are sparse, and the four rightmost eigenvalues are there, the second of them twice.
#[test]
fn the_fold_of_a_plane_is_the_one_of_the_equations() {
    let fold = |m: usize| {
        let text = format!(
            "Scene(title: \"t\", problem: Residual(
                unknowns: [(\"u[i=1..m, j=1..m]\", \"(u[i-1,j] + u[i+1,j] + u[i,j-1] + u[i,j+1] - 4*u[i,j])*(m+1)^2 + lambda*exp(u[i,j])\")],
                definitions: [(\"m\", {m}), (\"u[i=0..m+1, j=0..m+1]\", 0)], parameters: [(\"lambda\", 0)], dynamics: flow),
                settings: (max_points: 24, eigenvalues: 4),
                runs: [Run(name: \"r\", along: [(name: \"lambda\", low: 0, high: 8)])])"
        );
        let branch = traced(&text).remove(0);
        assert_eq!(branch.method, "sparse matrices");
        let start = &branch.points[0];
        let h = 1.0 / (m + 1) as f64;
        let mode = |k: f64| -(2.0 / h * (k * PI * h / 2.0).sin()).powi(2);
        let modes = [(1.0, 1.0), (1.0, 2.0), (2.0, 1.0), (2.0, 2.0)];
        for ((k, l), found) in modes.iter().zip(&start.eigenvalues) {
            // At u = 0 and λ = 0 or beside it, where eᵘ adds λ.
            close(found.0, mode(*k) + mode(*l) + start.parameters[0], 1e-7);
        }
        branch.special.iter().find(|it| it.kind.to_string() == "LP").expect("LP").parameters[0]
    };
    // The errors are h² and h⁴ times constants.
    let folds = [15, 31, 63].map(fold);
    let twice = |coarse: f64, fine: f64| (4.0 * fine - coarse) / 3.0;
    let once = [twice(folds[0], folds[1]), twice(folds[1], folds[2])];
    close((16.0 * once[1] - once[0]) / 15.0, 6.808124423, 1e-8);
}

/// A model of 10⁴ unknowns takes memory in proportion to them, but for a factor of two by which
/// lists grow, and is evaluated with one allocation at most.
#[test]
fn large_planes() {
    let beyond = "(\"u[i=0..m+1, j=0..n+1]\", 0)";
    let memory =
        |m: usize| allocation_counter::measure(|| drop(bratu(m, m, beyond))).bytes_max as f64;
    let (small, large) = (memory(32), memory(100));
    assert!(large < 20.0 * small, "{small} and {large} bytes");
    let zero = bratu(100, 100, beyond);
    let z: Vec<f64> = (0..10_000).map(|k| (k as f64 * 0.01).sin()).collect();
    let mut r = vec![0.0; z.len()];
    let used = allocation_counter::measure(|| zero.residual(&z, &[0.7], &mut r));
    assert!(used.count_total <= 1, "{}", used.count_total);
    for (r, expected) in r.iter().zip(five_points(100, 100, &z, |_| 0.0)) {
        close(*r, expected, 1e-13);
    }
}
