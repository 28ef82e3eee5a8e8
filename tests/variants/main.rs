//! Built-in scenes under other settings, and at other parameters: the same answers, whatever the
//! settings.
//!
//! `cargo test --release --test variants` traces the quick scenes under a few variants of their
//! settings, and some random sets of parameters. Arguments after `--` choose scenes by parts of
//! their names, and trace them under every variant; `random` the random sets; `all` takes
//! everything. With `TANGENCY_SHOW` every row is printed, not only sums.
//!
//! What must hold of two traces, `a` and `b`, of a scene (`compare.rs`):
//!
//! - Each branch is there in both. It ends for the same reasons, at the same bounds.
//! - Each special point of `a` has one partner in `b`: of the same kind, the nearest in all
//!   columns, each in units of its range on the branch; at most [`SAME_POINT`](compare::SAME_POINT)
//!   away. What has none is missing or extra.
//! - The continued parameter differs by no more than [`ESTIMATE`](compare::ESTIMATE) times the sum
//!   of both stated errors. Other columns, of which no error is stated, by no more than
//!   [`OTHER`](compare::OTHER) of their range.
//! - Points of a local map state their error on that map: they differ by no more than
//!   [`LOCAL_MAP`](compare::LOCAL_MAP) besides.
//! - The last special points before a homoclinic orbit, where they have not converged, need no
//!   partners, nor does the end there.
//! - A special point that has converged in one has converged in the other.
//! - `unstable` is the same at partners, and on ordinary points between the same two special
//!   points.
//!
//! Variants that change what is claimed say so in [`Claim`](variant::Claim): kinds that are not
//! looked for are not expected, and an error that leaves the discretisation out is compared with
//! the mesh error that the branch states. Nothing is skipped in silence: an error of a scene, an
//! interruption (after [`LONGEST`]) and a variant that cannot be set are failures.

mod branch;
mod compare;
#[path = "../common/random.rs"]
mod numbers;
mod random;
mod table;
mod variant;

use compare::{Comparison, compare};
use std::process::ExitCode;
use std::time::{Duration, Instant};
use table::Table;
use tangency::Catalogue;
use tangency::core::cancel::CancelToken;
use tangency::core::continuation::{Branch, Observer, Point};
use tangency::scene::{Scene, SceneObserver, execute};
use variant::{Change, VARIANTS, Variant};

/// No trace of a scene takes longer.
const LONGEST: Duration = Duration::from_secs(120);

/// Scenes that are traced by default: one of each kind of problem, and quick.
const QUICK: [&str; 7] = [
    "bratu",
    "impact-oscillator",
    "lure",
    "mita-nonimpacting",
    "mita-type-2",
    "plate-device",
    "plate-frequency",
];

/// Interrupts what takes too long.
struct Deadline(Instant, CancelToken);

impl Observer for Deadline {
    fn point(&mut self, _point: &Point) {
        if self.0.elapsed() > LONGEST {
            self.1.cancel();
        }
    }
}

impl SceneObserver for Deadline {}

/// The branches of a scene, and why it stopped, if it did.
type Traced = (Vec<Branch>, Option<String>);

/// Traces all runs of a scene, also those that are not shown.
fn traced(scene: &Scene) -> Traced {
    let mut scene = scene.clone();
    scene.runs.iter_mut().for_each(|run| run.shown = true);
    let cancel = CancelToken::default();
    scene.settings.cancel = cancel.clone();
    let outcome = execute(&scene, None, &mut Deadline(Instant::now(), cancel));
    (outcome.document.branches, outcome.error.map(|error| error.to_string()))
}

/// Traces a scene under a variant, and compares; `None` where the variant means nothing to the
/// scene.
fn under(scene: &Scene, reference: &Traced, variant: &Variant) -> Option<Comparison> {
    let mut total = Comparison::default();
    match (variant.change)(scene) {
        Change::None => return None,
        Change::Refused(error) => total.wrong.push(format!("it cannot be set: {error}")),
        Change::Scene(scene, claim) => {
            let own = claim.with.as_ref().map(|own| traced(own));
            let reference = own.as_ref().unwrap_or(reference);
            compare(&scene, reference, &traced(&scene), &claim, &mut total);
        }
        Change::Halves(scenes) => {
            for (name, halves) in scenes {
                let [(back, error), (ahead, other)] = halves.map(|half| traced(&half));
                let one = reference.0.iter().filter(|branch| branch.name == name).cloned();
                let (one, claim) = ((one.collect(), None), variant::Claim::default());
                for whole in variant::joined(&name, &back, &ahead) {
                    let found = (whole, error.clone().or(other.clone()));
                    compare(scene, &one, &found, &claim, &mut total);
                }
            }
        }
    }
    Some(total)
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let [all, random] = ["all", "random"].map(|word| arguments.iter().any(|a| a == word));
    let names: Vec<&String> = arguments.iter().filter(|a| *a != "all" && *a != "random").collect();
    let quick = arguments.is_empty();
    let catalogue = Catalogue::built_in();
    let mut table = Table::new();
    for named in catalogue.scenes() {
        let chosen = match names.is_empty() {
            true => all || quick && QUICK.contains(&&*named.name),
            false => names.iter().any(|part| named.name.contains(*part)),
        };
        let scene = catalogue.parse(&named.text).expect("built-in scenes can be read");
        if !chosen || !scene.runs.iter().any(|run| !run.along.is_empty()) {
            continue;
        }
        let reference = traced(&scene);
        for variant in VARIANTS.iter().filter(|variant| variant.quick || !quick) {
            let began = Instant::now();
            if let Some(comparison) = under(&scene, &reference, variant) {
                table.row(&named.name, variant.name, began.elapsed(), comparison);
            }
        }
        table.sum(&named.name);
    }
    if all || random || quick {
        random::sweep(&catalogue, if quick { 20 } else { 300 }, &mut table);
    }
    table.end()
}
