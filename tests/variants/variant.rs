//! Other settings of a scene, and what they claim.

use tangency::core::continuation::{Branch, End};
use tangency::core::system::Kind;
use tangency::scene::{Scene, SceneError, Start, Way};

/// What a variant claims, where that is less than the scene with its own settings claims.
#[derive(Clone, Debug, Default)]
pub struct Claim {
    /// The kinds of bifurcations that are looked for, where not all are.
    pub detect: Option<Vec<Kind>>,
    /// Whether stated errors leave the discretisation out.
    pub on_mesh: bool,
    /// Whether stability is not computed.
    pub unstable_unknown: bool,
    /// The scene that it is to agree with, where that is not the one with its own settings.
    pub with: Option<Box<Scene>>,
}

/// A scene with a variant of its settings.
pub enum Change {
    /// It means nothing to the scene.
    None,
    /// The setting was refused.
    Refused(SceneError),
    /// The scene, and what it claims.
    Scene(Box<Scene>, Claim),
    /// For each branch traced both ways its scene backward and forward.
    Halves(Vec<(String, [Scene; 2])>),
}

/// A variant of settings.
pub struct Variant {
    pub name: &'static str,
    /// Whether it is among the few by default.
    pub quick: bool,
    pub change: fn(&Scene) -> Change,
}

const fn variant(name: &'static str, quick: bool, change: fn(&Scene) -> Change) -> Variant {
    Variant { name, quick, change }
}

/// All variants. Where steps become smaller, more of them are allowed.
pub const VARIANTS: &[Variant] = &[
    variant("max_step × 0.2", false, |s| steps(s, 0.2)),
    variant("max_step × 0.5", true, |s| steps(s, 0.5)),
    variant("max_step × 2", true, |s| steps(s, 2.0)),
    variant("max_step × 5", false, |s| steps(s, 5.0)),
    variant("initial_step × 0.1", false, |s| {
        set(s, &[("initial_step", s.settings.initial_step * 0.1)])
    }),
    variant("initial_step × 10", false, |s| {
        set(s, &[("initial_step", s.settings.initial_step * 10.0)])
    }),
    variant("tolerance 1e-8", false, |s| set(s, &[("tolerance", 1e-8)])),
    variant("tolerance 1e-13", false, |s| set(s, &[("tolerance", 1e-13)])),
    variant("event_tolerance 1e-9", false, |s| set(s, &[("event_tolerance", 1e-9)])),
    variant("event_tolerance 1e-14", false, |s| set(s, &[("event_tolerance", 1e-14)])),
    variant("curve_error 1e-6", false, |s| {
        set(s, &[("curve_error", 1e-6), ("max_points", 6.0 * s.settings.max_points as f64)])
    }),
    variant("curve_error 0.1", false, |s| set(s, &[("curve_error", 0.1)])),
    variant("max_iterations 7", false, |s| set(s, &[("max_iterations", 7.0)])),
    variant("max_iterations 50", false, |s| set(s, &[("max_iterations", 50.0)])),
    variant("eigenvalues 16", false, |s| set(s, &[("eigenvalues", 16.0)])),
    variant("refinement changed", true, refinement),
    variant("unrefined, max_step × 0.5", true, unrefined),
    variant("few kinds", false, few_kinds),
    variant("without stability", false, without_stability),
    variant("each way alone", true, each_way),
    variant("the other method", true, the_other_method),
    variant("intervals 30", false, |s| on(s, "collocation", &[("intervals", "30")])),
    variant("degree 6", false, |s| on(s, "collocation", &[("degree", "6")])),
    variant("degree 3, intervals 40", false, |s| {
        on(s, "collocation", &[("degree", "3"), ("intervals", "40")])
    }),
    variant("segments 3", false, |s| on(s, "shooting", &[("segments", "3")])),
    variant("flow_tolerance 1e-9", true, |s| on(s, "shooting", &[("flow_tolerance", "1e-9")])),
    variant("flow_tolerance 1e-13", false, |s| on(s, "shooting", &[("flow_tolerance", "1e-13")])),
    variant("DormandPrince5", false, |s| on(s, "shooting", &[("scheme", "DormandPrince5")])),
];

/// The scene with numbers set.
fn set(scene: &Scene, values: &[(&str, f64)]) -> Change {
    let texts: Vec<(&str, String)> =
        values.iter().map(|(name, value)| (*name, value.to_string())).collect();
    let pairs: Vec<(&str, &str)> = texts.iter().map(|(name, text)| (*name, &**text)).collect();
    assigned(scene, &pairs, Claim::default())
}

fn assigned(scene: &Scene, values: &[(&str, &str)], claim: Claim) -> Change {
    let mut scene = scene.clone();
    for (name, value) in values {
        if let Err(error) = scene.set(name, value) {
            return Change::Refused(error);
        }
    }
    Change::Scene(Box::new(scene), claim)
}

/// Other step lengths, and as many points as they need.
fn steps(scene: &Scene, factor: f64) -> Change {
    let points = (scene.settings.max_points as f64 / factor.min(1.0)).ceil();
    set(scene, &[("max_step", scene.settings.max_step * factor), ("max_points", points)])
}

/// With refinement, where there is none; otherwise without.
fn refinement(scene: &Scene) -> Change {
    let none = scene.settings.refinement == 0.0;
    let claim = Claim { on_mesh: !none, ..Claim::default() };
    assigned(scene, &[("refinement", if none { "1e-8" } else { "0" })], claim)
}

/// Without refinement, at two lengths of steps: errors on the mesh hold there.
fn unrefined(scene: &Scene) -> Change {
    let mut scene = scene.clone();
    scene.settings.refinement = 0.0;
    match steps(&scene, 0.5) {
        Change::Scene(other, claim) => {
            let on_mesh = method(&scene).is_some();
            Change::Scene(other, Claim { with: Some(Box::new(scene)), on_mesh, ..claim })
        }
        other => other,
    }
}

/// The kinds that runs of the scene start from.
fn needed(scene: &Scene) -> Vec<Kind> {
    let mut kinds: Vec<Kind> = Vec::new();
    for run in &scene.runs {
        let local = run.local.iter().map(|local| local.kind);
        let from = match &run.start {
            Start::From { kind, .. } => Some(*kind),
            _ => None,
        };
        kinds.extend(local.chain(from));
    }
    kinds
}

/// Only branch points, and the kinds that the scene needs.
fn few_kinds(scene: &Scene) -> Change {
    let kinds = [needed(scene), vec![Kind::BP]].concat();
    let mut scene = scene.clone();
    scene.settings.detect = kinds.clone();
    let claim = Claim { detect: Some(kinds), ..Claim::default() };
    Change::Scene(Box::new(scene), claim)
}

/// Without eigenvalues: folds and branch points are found all the same.
fn without_stability(scene: &Scene) -> Change {
    let lost = [Kind::HB, Kind::PD, Kind::TR];
    if needed(scene).iter().any(|kind| lost.contains(kind)) {
        return Change::None;
    }
    let kept = [Kind::BP, Kind::LP, Kind::CP, Kind::BT, Kind::GH, Kind::R1, Kind::R2];
    let claim = Claim { detect: Some(kept.to_vec()), unstable_unknown: true, ..Claim::default() };
    assigned(scene, &[("stability", "false")], claim)
}

/// The method by which the scene discretises trajectories, if it does.
pub fn method(scene: &Scene) -> Option<&'static str> {
    let settings = scene.problem.settings();
    let value = |name: &str| settings.iter().find(|(known, _)| *known == name).map(|(_, v)| &**v);
    let stated = value("method")?;
    ["shooting", "collocation"].into_iter().find(|name| *name == stated)
}

/// The other method.
pub fn the_other_method(scene: &Scene) -> Change {
    match method(scene) {
        None => Change::None,
        Some("shooting") => assigned(scene, &[("method", "collocation")], Claim::default()),
        Some(_) => assigned(scene, &[("method", "shooting")], Claim::default()),
    }
}

/// Other settings of a method: the scene's own, or else the one that it could have.
fn on(scene: &Scene, by: &str, values: &[(&str, &str)]) -> Change {
    match method(scene) {
        Some(own) if own == by => assigned(scene, values, Claim::default()),
        _ => Change::None,
    }
}

/// Each branch that is traced both ways, backward alone and forward alone, after all runs before
/// it.
fn each_way(scene: &Scene) -> Change {
    let mut halves = Vec::new();
    for (index, run) in scene.runs.iter().enumerate() {
        if run.direction == Way::Both && !run.along.is_empty() {
            let half = |way: Way| {
                let mut scene = scene.clone();
                scene.runs.truncate(index + 1);
                scene.runs[index].direction = way;
                scene
            };
            halves.push((run.name.clone(), [half(Way::Backward), half(Way::Forward)]));
        }
    }
    Change::Halves(halves)
}

/// The branch of which these are the halves. Where it is closed, or starts one way only, each is
/// the whole of it.
pub fn joined(name: &str, back: &[Branch], ahead: &[Branch]) -> Vec<Vec<Branch>> {
    let named = |all: &[Branch]| all.iter().find(|branch| branch.name == name).cloned();
    let (Some(mut whole), Some(ahead)) = (named(back), named(ahead)) else {
        return vec![Vec::new()];
    };
    if whole.ends[1] != End::Start || ahead.ends[0] != End::Start {
        return vec![vec![whole], vec![ahead]];
    }
    // The start is an end of both halves, and the last or first special point of each.
    let before = whole.points.len() - 1;
    whole.special.pop();
    for mut special in ahead.special.into_iter().skip(1) {
        special.after += before;
        whole.special.push(special);
    }
    whole.points.extend(ahead.points.into_iter().skip(1));
    whole.ends[1] = ahead.ends[1].clone();
    vec![vec![whole]]
}
