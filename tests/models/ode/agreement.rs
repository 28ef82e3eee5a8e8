//! Files and the same models in RON: names, values where motion begins, and values of everything at
//! random points.

use super::files;
use crate::common::random::Random;
use tangency::core::hybrid::HybridSystem;
use tangency::core::problem::DiscreteMap;
use tangency::core::problem::VectorField;
use tangency::language::{Field, Hybrid, Iteration, Model, xpp};

/// How many points everything is compared at.
const POINTS: usize = 40;

#[test]
fn files_mean_what_they_mean_in_ron() {
    let files = files();
    assert!(files.len() >= 25, "{} files", files.len());
    for (name, file, ron) in files {
        let read = xpp::read(&file).unwrap_or_else(|error| panic!("{error}"));
        let own = read.statement.model(&file, &[]).unwrap_or_else(|error| panic!("{error}"));
        let stated = Model::read(&ron, &[]).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(
            own.initial(own.defaults()).len(),
            stated.initial(stated.defaults()).len(),
            "{name}"
        );
        for (found, expected) in
            own.initial(own.defaults()).iter().zip(&stated.initial(stated.defaults()))
        {
            assert_eq!(found.0, expected.0, "{name}");
            same(&name, found.1, expected.1);
        }
        assert_eq!(own.is_aperiodic(), stated.is_aperiodic(), "{name}");
        match (own, stated) {
            (Model::Field(a), Model::Field(b)) => fields(&name, &a, &b),
            (Model::Map(a), Model::Map(b)) => maps(&name, &a, &b),
            (Model::Hybrid(a), Model::Hybrid(b)) => hybrids(&name, &a, &b),
            _ => panic!("{name}: models of different kinds"),
        }
    }
}

#[track_caller]
fn same(what: &str, found: f64, expected: f64) {
    let close = (found - expected).abs() <= 1e-12 * (1.0 + expected.abs());
    assert!(
        close || found == expected || (found.is_nan() && expected.is_nan()),
        "{what}: {found:e} instead of {expected:e}"
    );
}

#[track_caller]
fn all_same(what: &str, found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len(), "{what}");
    found.iter().zip(expected).for_each(|(found, expected)| same(what, *found, *expected));
}

/// A time, states and parameters.
fn point(random: &mut Random, states: usize, defaults: &[f64]) -> (f64, Vec<f64>, Vec<f64>) {
    let t = 5.0 * random.signed();
    let x = (0..states).map(|_| 2.0 * random.signed()).collect();
    (t, x, defaults.iter().map(|p| p + 0.2 * random.signed()).collect())
}

fn fields(name: &str, a: &Field, b: &Field) {
    let names = VectorField::names(a);
    assert_eq!(names, VectorField::names(b), "{name}");
    all_same(name, &a.defaults(), &b.defaults());
    let mut random = Random::new(1);
    for _ in 0..POINTS {
        let (t, x, p) = point(&mut random, names.dimension(), &a.defaults());
        let (mut found, mut expected) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        a.field(t, &x, &p, &mut found);
        b.field(t, &x, &p, &mut expected);
        all_same(name, &found, &expected);
        for monitor in 0..names.monitors.len() {
            same(name, a.monitor(monitor, t, &x, &p), b.monitor(monitor, t, &x, &p));
        }
    }
}

fn maps(name: &str, a: &Iteration, b: &Iteration) {
    let names = DiscreteMap::names(a);
    assert_eq!(names, DiscreteMap::names(b), "{name}");
    all_same(name, &a.defaults(), &b.defaults());
    let mut random = Random::new(2);
    for _ in 0..POINTS {
        let (_, x, p) = point(&mut random, names.dimension(), &a.defaults());
        let (mut found, mut expected) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        a.next(&x, &p, &mut found);
        b.next(&x, &p, &mut expected);
        all_same(name, &found, &expected);
        for monitor in 0..names.monitors.len() {
            same(name, a.monitor(monitor, &x, &p), b.monitor(monitor, &x, &p));
        }
    }
}

fn hybrids(name: &str, a: &Hybrid, b: &Hybrid) {
    let (modes, guards) = (a.modes(), a.guards());
    assert_eq!(modes, b.modes(), "{name}");
    assert_eq!(guards, b.guards(), "{name}");
    assert_eq!(HybridSystem::parameters(a), HybridSystem::parameters(b), "{name}");
    let defaults = HybridSystem::defaults(a);
    let mut random = Random::new(3);
    for _ in 0..POINTS {
        let size = modes[0].states.len();
        let (t, x, p) = point(&mut random, size, &defaults);
        let (mut found, mut expected) = (vec![0.0; size], vec![0.0; size]);
        for mode in 0..modes.len() {
            HybridSystem::field(a, mode, t, &x, &p, &mut found);
            HybridSystem::field(b, mode, t, &x, &p, &mut expected);
            all_same(name, &found, &expected);
            for (guard, stated) in
                guards.iter().enumerate().filter(|(_, g)| g.modes.contains(&mode))
            {
                let what = format!("{name}, {}", stated.name);
                same(&what, a.guard(guard, mode, t, &x, &p), b.guard(guard, mode, t, &x, &p));
                let next = a.next_mode(guard, mode, t, &x, &p);
                assert_eq!(next, b.next_mode(guard, mode, t, &x, &p), "{what}");
                a.reset(guard, (mode, next), t, &x, &p, &mut found);
                b.reset(guard, (mode, next), t, &x, &p, &mut expected);
                all_same(&what, &found, &expected);
            }
        }
    }
}
