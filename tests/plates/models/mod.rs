//! Plates and their branches, as several tests ask for them.

use tangency::core::continuation::{Branch, Continuation, Settings, SpecialPoint};
use tangency::core::system::{Kind, System};
use tangency::problems::plate::{InPlane, PlateSettings, Theory, Units};

/// Positions of the dimensionless parameters.
pub const LOAD: usize = 0;
pub const GAP_RATIO: usize = 1;
pub const ASPECT: usize = 2;
pub const NU: usize = 3;
pub const FORCE: usize = 4;
pub const FORCE_X: usize = 5;
pub const FORCE_Y: usize = 6;
pub const SHEAR: usize = 7;
pub const PRESSURE: usize = 8;

/// The positions of all parameters.
pub fn all_parameters(system: &dyn System) -> Vec<usize> {
    (0..system.names().parameters.len()).collect()
}

/// The four in-plane models of the edges.
pub const IN_PLANE: [InPlane; 4] =
    [InPlane::Slide, InPlane::Straight, InPlane::Immovable, InPlane::Free];

/// The usual model of a plate with these edges.
pub fn plate(supports: &str, in_plane: InPlane) -> PlateSettings {
    let supports = supports.into();
    PlateSettings { supports, in_plane: Some(in_plane), ..PlateSettings::default() }
}

/// A plate in which bending alone counts.
pub fn linear(supports: &str) -> PlateSettings {
    let supports = supports.into();
    PlateSettings { supports, theory: Theory::Linear, ..PlateSettings::default() }
}

/// The system of a plate fit for aspect ratios up to this one.
pub fn system(settings: &PlateSettings, aspect: f64) -> Box<dyn System> {
    let mut reach = Units::Dimensionless.defaults().to_vec();
    reach[ASPECT] = aspect;
    settings.system(Units::Dimensionless.defaults(), &reach).expect("a plate")
}

/// Settings with another refinement.
pub fn refined_to(refinement: f64) -> Settings {
    // Deflections converge more slowly than loads, which are stationary at folds.
    Settings { refinement, refine: vec!["deflection".into()], ..Settings::default() }
}

/// A curve that starts at rest, with the usual parameters but for these.
pub fn at_rest<'a>(system: &'a mut dyn System, values: &[(&str, f64)]) -> Continuation<'a> {
    let names = Units::Dimensionless.names().iter().copied();
    let usual = names.zip(Units::Dimensionless.defaults().iter().copied());
    let known: Vec<_> =
        usual.filter(|(name, _)| system.names().parameter(name).is_some()).collect();
    let start = Continuation::new(system);
    known.iter().chain(values).fold(start, |curve, (name, value)| curve.at(name, *value))
}

/// Through pull-in, as the scenes of plates are traced: from rest to a largest deflection of 0.9.
pub fn through_pull_in<'a>(system: &'a mut dyn System, values: &[(&str, f64)]) -> Continuation<'a> {
    let open = f64::NEG_INFINITY;
    at_rest(system, values).along("load", 0.0..=f64::INFINITY).bound("max_deflection", open..=0.9)
}

/// The curve of folds through the pull-in of a branch, in another parameter that grows.
pub fn folds_from<'a>(
    system: &'a mut dyn System,
    branch: &Branch,
    parameter: &str,
    range: std::ops::RangeInclusive<f64>,
) -> Continuation<'a> {
    Continuation::new(system)
        .restart(branch, pull_in(branch).label)
        .hold(Kind::LP)
        .along("load", 0.0..=f64::INFINITY)
        .along(parameter, range)
        .forward()
}

/// The pull-in of a branch: its first fold, where the equilibria that begin at rest lose stability.
/// (A long plate may fold again far beyond.)
pub fn pull_in(branch: &Branch) -> &SpecialPoint {
    let fold = branch.of_kind(Kind::LP).next();
    fold.unwrap_or_else(|| panic!("no fold on {}: {:?}", branch.name, branch.ends))
}

/// A column of a special point by name.
pub fn value(branch: &Branch, point: &SpecialPoint, name: &str) -> f64 {
    let column = branch.column(name).unwrap_or_else(|| panic!("no column {name}"));
    point.value(column).expect("a value in each column")
}

/// The first special point (a mark or an end) at which a parameter or monitor has a value.
pub fn at<'a>(branch: &'a Branch, name: &str, level: f64) -> &'a SpecialPoint {
    let mut points = branch.special.iter();
    points
        .find(|point| (value(branch, point, name) - level).abs() < 1e-9)
        .unwrap_or_else(|| panic!("no point at {name} = {level}: {:?}", branch.ends))
}

/// One unit of the last of so many decimals.
pub fn decimals(count: i32) -> f64 {
    0.1_f64.powi(count)
}

/// Two numbers agree to an absolute tolerance.
#[track_caller]
pub fn assert_within(what: &str, found: f64, expected: f64, tolerance: f64) {
    let error = (found - expected).abs();
    assert!(error <= tolerance, "{what}: {found:.14}, not {expected:.14} (off by {error:.1e})");
}

/// Two numbers agree to a relative tolerance; says what they are if not.
#[track_caller]
pub fn assert_close(what: &str, found: f64, expected: f64, tolerance: f64) {
    let error = (found / expected - 1.0).abs();
    assert!(error <= tolerance, "{what}: {found:.14}, not {expected:.14} (relative {error:.1e})");
}
