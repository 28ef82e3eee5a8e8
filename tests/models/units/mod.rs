//! Promise: models have the same special points in whatever units they are stated.
//!
//! Each model is traced in its own units and in variants: states (with `scales`), parameters and
//! time are multiplied by powers of ten, states are reordered, and a decoupled state is added. Each
//! special point must have a partner of the same kind, with the same count of unstable eigenvalues,
//! at the same parameters within both errors. No other points may appear.

mod library;
mod observed;
mod shrinking;
mod stated;
mod variant;

use stated::{MODELS, Stated};
use tangency::core::continuation::Branch;
use tangency::core::system::Kind;
use tangency::scene::{Scene, execute};
use variant::{Other, Variant};

/// Errors are estimates: points differ by no more than this many times the sum of both.
const ESTIMATE: f64 = 3.0;

/// What a point of a branch is compared by, with parameters in the model's own units.
#[derive(Debug)]
struct Found {
    kind: Kind,
    parameters: Vec<f64>,
    error: f64,
    unstable: Option<usize>,
    converged: bool,
}

/// The special points of all runs.
fn traced(model: &Stated, variant: &Variant) -> Result<Vec<Vec<Found>>, String> {
    let text = model.text(variant);
    let scene = Scene::parse(&text).map_err(|error| format!("{error}\n{text}"))?;
    let outcome = execute(&scene, None, &mut ());
    if let Some(error) = outcome.error {
        return Err(error.to_string());
    }
    Ok(outcome.document.branches.iter().map(|branch| points(branch, variant)).collect())
}

fn points(branch: &Branch, variant: &Variant) -> Vec<Found> {
    let released: Vec<usize> = branch
        .released
        .iter()
        .filter_map(|name| branch.parameters.iter().position(|known| known == name))
        .collect();
    let own = |point: &tangency::core::continuation::SpecialPoint| Found {
        kind: point.kind,
        parameters: released.iter().map(|&p| point.parameters[p] / variant.parameter).collect(),
        error: point.error / variant.parameter,
        unstable: point.unstable,
        converged: point.converged,
    };
    branch.special.iter().filter(|point| point.kind != Kind::RG).map(own).collect()
}

/// The differences between the points of a model, whose parameters have this range, and of its
/// variant, in words.
fn differences(range: f64, here: &[Vec<Found>], there: &[Vec<Found>]) -> Vec<String> {
    let mut wrong = Vec::new();
    if here.len() != there.len() {
        return vec![format!("{} branches in place of {}", there.len(), here.len())];
    }
    for (run, (here, there)) in here.iter().zip(there).enumerate() {
        let mut left: Vec<&Found> = there.iter().collect();
        for point in here {
            let distance = |other: &Found| {
                let parts = point.parameters.iter().zip(&other.parameters);
                parts.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
            };
            // Of a point that has not converged, as at a pole of the field, neither kind nor count is claimed.
            let is_alike =
                |k: &usize| left[*k].kind == point.kind || !(left[*k].converged || point.converged);
            let partners = (0..left.len()).filter(is_alike);
            let partner = partners.min_by(|a, b| distance(left[*a]).total_cmp(&distance(left[*b])));
            let Some(partner) = partner.map(|k| left.swap_remove(k)) else {
                wrong.push(format!("run {run}: missing {point:?}"));
                continue;
            };
            let rounding = 1e-12 * range;
            let allowed = ESTIMATE * (point.error + partner.error) + rounding;
            if distance(partner) > allowed {
                wrong.push(format!("run {run}: beyond its error {point:?} {partner:?}"));
            }
            let unknown = point.unstable.is_none() || partner.unstable.is_none();
            let same = point.converged == partner.converged
                && (!point.converged || unknown || point.unstable == partner.unstable);
            if !same {
                wrong.push(format!("run {run}: another count {point:?} {partner:?}"));
            }
        }
        wrong.extend(left.iter().map(|point| format!("run {run}: extra {point:?}")));
    }
    wrong
}

/// Traces all models under variants, and fails with a list of all differences.
fn check(variants: impl Fn(&Stated) -> Vec<Variant>) {
    let mut wrong = Vec::new();
    for model in MODELS.iter().filter(|model| chosen(model.name)) {
        let here = traced(model, &Variant::default())
            .unwrap_or_else(|error| panic!("{}: {error}", model.name));
        assert!(here.iter().flatten().count() > 1, "{} has special points", model.name);
        for variant in variants(model) {
            let found = match traced(model, &variant) {
                Ok(there) => differences(model.range, &here, &there),
                Err(error) => vec![error],
            };
            let named = |difference: String| format!("{}, {variant}: {difference}", model.name);
            wrong.extend(found.into_iter().map(named));
        }
    }
    assert!(wrong.is_empty(), "{} differences:\n{}", wrong.len(), wrong.join("\n"));
}

/// Whether a model is tested: `TANGENCY_MODEL` selects one by name.
fn chosen(name: &str) -> bool {
    std::env::var("TANGENCY_MODEL").map_or(true, |chosen| chosen == name)
}

/// Powers of ten by which units change. Where branches cross on a mesh, rounding errors decide the
/// directions in units beyond 1e±6.
fn powers(model: &Stated) -> &'static [i32] {
    if model.crosses_on_mesh() { &[-6, -3, 3, 6] } else { &[-9, -6, -3, 3, 6, 9] }
}

/// Powers by which the units of the states of a model change, each by another one.
fn mixed(model: &Stated) -> impl Iterator<Item = Vec<i32>> {
    let (all, states) = ([[-6, 4, 6, -3], [3, -9, 0, 6]], model.states.len());
    all.into_iter().map(move |powers| powers.iter().cycle().take(states).copied().collect())
}

/// All states by the same power, then each by another.
fn states_by_powers(model: &Stated) -> impl Iterator<Item = Vec<i32>> {
    let states = model.states.len();
    powers(model).iter().map(move |power| vec![*power; states]).chain(mixed(model))
}

#[test]
fn states_in_other_units() {
    check(|model| states_by_powers(model).map(|powers| Variant::of_states(&powers)).collect());
}

#[test]
fn states_whose_sizes_are_found() {
    let unstated = |powers: Vec<i32>| Variant::of_unscaled_states(&powers);
    check(|model| states_by_powers(model).map(unstated).collect());
}

#[test]
fn parameters_in_other_units() {
    check(|model| powers(model).iter().map(|power| Variant::of_parameters(*power)).collect());
}

#[test]
fn time_in_other_units() {
    check(|model| {
        let powers = if model.has_time() { powers(model) } else { &[] };
        powers.iter().map(|power| Variant::of_time(*power)).collect()
    });
}

#[test]
fn states_in_another_order_and_beside_others() {
    check(|model| {
        let others = if model.takes_others() { &[Other::First, Other::Last][..] } else { &[] };
        let beside = others.iter().map(|other| Variant::beside(*other));
        [Variant::reversed()].into_iter().chain(beside).collect()
    });
}

/// At α = 1 the eigenvalues are −1 and ±i in any units, so none is unstable.
#[test]
fn counts_at_special_points_do_not_depend_on_units() {
    let text = "Scene(title: \"t\", problem: Equations(states: [(\"x\", \"1e10*y\"), (\"y\", \"1e2*z\"),
            (\"z\", \"-alpha*z - 1e-2*y - 1e-12*x\")], solution: equilibrium), parameters: [(\"alpha\", 1.2)],
        runs: [(name: \"b\", along: [(name: \"alpha\", low: -1, high: 1.5)])])";
    let outcome = execute(&Scene::parse(text).unwrap(), None, &mut ());
    let hopf = outcome.document.branches[0].of_kind(Kind::HB).next().expect("a Hopf point");
    assert!((hopf.parameters[0] - 1.0).abs() < 1e-13 && hopf.unstable == Some(0), "{hopf:?}");
}
