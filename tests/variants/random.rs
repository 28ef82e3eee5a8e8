//! Scenes at random parameters.

use super::compare::{Comparison, compare};
use super::numbers::Random;
use super::table::Table;
use super::traced;
use super::variant::{Change, VARIANTS, Variant};
use std::time::Instant;
use tangency::Catalogue;
use tangency::scene::Scene;

/// Scenes that are traced at random parameters.
const SCENES: [&str; 12] = [
    "impact-oscillator",
    "mita-type-1",
    "lure",
    "plate-device",
    "mita-type-2",
    "mita-nonimpacting",
    "mita-grazing-curve",
    "mita-type-3",
    "plate-frequency",
    "mita-s-curve",
    "plate-supported",
    "mita-voltage",
];

/// The variants that take turns.
const TURNS: [&str; 6] = [
    "max_step × 0.5",
    "the other method",
    "max_step × 2",
    "flow_tolerance 1e-9",
    "intervals 30",
    "curve_error 1e-6",
];

/// Parameters go this far from those of the scene, as a part of them.
const FAR: f64 = 0.2;

/// A scene with all its parameters changed, those that it does not vary by itself; and what was
/// changed, in words.
fn drawn(scene: &Scene, random: &mut Random) -> (Scene, String) {
    let mut drawn = scene.clone();
    let mut words = Vec::new();
    for (name, _) in scene.problem.parameters() {
        let part = random.number() as f64 / u64::MAX as f64;
        let factor = 1.0 + FAR * (2.0 * part - 1.0);
        let along = scene.runs.iter().flat_map(|run| &run.along);
        let varies = along.into_iter().any(|range| range.name == name);
        let Some(value) = scene.value(&name).filter(|value| *value != 0.0 && !varies) else {
            continue;
        };
        let text = format!("{:.4e}", value * factor);
        // What runs set by themselves stays.
        if drawn.set(&name, &text).is_ok() {
            words.push(format!("{name}={text}"));
        }
    }
    (drawn, words.join(" "))
}

/// Traces scenes at as many sets of parameters, each under its own settings and under a variant.
pub fn sweep(catalogue: &Catalogue, sets: usize, table: &mut Table) {
    for count in 0..sets {
        // A new parameter of one scene does not change the values of the others.
        let mut random = Random::new(16 + count as u64);
        let (name, round) = (SCENES[count % SCENES.len()], count / SCENES.len());
        let named = catalogue.scenes().iter().find(|scene| scene.name == name);
        let text = &named.expect("it is built in").text;
        let scene = catalogue.parse(text).expect("built-in scenes can be read");
        let (scene, words) = drawn(&scene, &mut random);
        let began = Instant::now();
        let turn = |k: usize| {
            let name = TURNS[(round + k) % TURNS.len()];
            VARIANTS.iter().find(|variant| variant.name == name)
        };
        let applies = |variant: &&Variant| !matches!((variant.change)(&scene), Change::None);
        let variant = (0..TURNS.len()).filter_map(turn).find(applies);
        let variant = variant.expect("steps can always be changed");
        let mut found = Comparison::default();
        match (variant.change)(&scene) {
            Change::Scene(other, claim) => {
                compare(&scene, &traced(&scene), &traced(&other), &claim, &mut found);
            }
            _ => found.wrong.push("the variant cannot be set".into()),
        }
        let what = format!("{}; {words}", variant.name);
        table.row(&format!("random {name}"), &what, began.elapsed(), found);
    }
    table.sum("random");
}
