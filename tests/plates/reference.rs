//! Every reference value of the plate as a special point of a curve that is continued: pull-in as
//! curves of folds, frequencies and deflections as marks, buckling as branch points that are
//! switched at.

use crate::plates::models::{
    assert_close, assert_within, at, at_rest, decimals, folds_from, linear, plate, pull_in,
    refined_to, system, through_pull_in, value,
};
use std::f64::consts::PI;
use tangency::core::continuation::{Branch, Continuation, End, Settings};
use tangency::core::system::{Dense, Kind, System};
use tangency::problems::plate::strip::{Ends, Strip, StripSettings};
use tangency::problems::plate::{InPlane, Model, Orders, PlateSettings};

/// `(α₁, kind of the point, λ, w, decimals of w)` at pull-in.
type Fold = (f64, Kind, f64, f64, i32);

fn table(flat: (f64, f64), rest: [(f64, f64, i32); 3]) -> [Fold; 4] {
    let [half, one, two] = rest;
    [
        (0.0, Kind::EP, flat.0, flat.1, 10),
        (0.5, Kind::UZ, half.0, half.1, half.2),
        (1.0, Kind::UZ, one.0, one.1, one.2),
        (2.0, Kind::EP, two.0, two.1, two.2),
    ]
}

/// The curve of folds from `α₁ = 0` to 2 of a square plate, with marks at ½ and 1.
fn folds_in_gap_ratio(settings: &PlateSettings) -> Branch {
    let mut system = system(settings, 1.0);
    let branch =
        through_pull_in(&mut *system, &[("gap_ratio", 0.0)]).settings(refined_to(0.0)).trace();
    let curve = folds_from(&mut *system, &branch.unwrap(), "gap_ratio", 0.0..=2.0);
    curve.settings(refined_to(1e-10)).mark("gap_ratio", 0.5).mark("gap_ratio", 1.0).trace().unwrap()
}

fn passes_through(what: &str, curve: &Branch, folds: [Fold; 4]) {
    let bound = |value| End::ParameterBound { name: "gap_ratio".into(), value };
    assert_eq!(curve.ends[1], bound(2.0), "{what}");
    assert_eq!(curve.condition, Some(Kind::LP));
    for (gap_ratio, kind, load, deflection, digits) in folds {
        let point = at(curve, "gap_ratio", gap_ratio);
        let what = format!("{what}, gap ratio {gap_ratio}");
        assert_eq!(point.kind, kind, "{what}");
        assert_close(&what, value(curve, point, "load"), load, 1e-9);
        assert_within(&what, value(curve, point, "deflection"), deflection, decimals(digits));
        assert!(point.error <= 1e-9 * load, "{what}: error {:e}", point.error);
    }
}

/// One curve of folds for each in-plane model passes through the tabulated points of the supported
/// plate: the load to a relative 1e-9, the deflection to a unit of its last digit.
#[test]
fn folds_of_supported_plates_in_gap_ratio() {
    let flat = (52.633290209, 0.4554324767);
    for (in_plane, rest) in [
        (
            InPlane::Slide,
            [
                (56.549468343, 0.4909666590, 10),
                (71.252716501, 0.577513077, 9),
                (144.467913425, 0.66999236, 7),
            ],
        ),
        (
            InPlane::Straight,
            [
                (53.594250295, 0.4646376967, 10),
                (56.705057715, 0.4923202689, 10),
                (72.090268748, 0.5809940633, 10),
            ],
        ),
        (
            InPlane::Immovable,
            [
                (56.570505258, 0.4911554227, 10),
                (71.368061983, 0.578041387, 9),
                (145.074752057, 0.670472884, 9),
            ],
        ),
        (
            InPlane::Free,
            [
                (53.125401310, 0.4601926196, 10),
                (54.646105722, 0.4742576904, 10),
                (61.243306692, 0.5230221162, 10),
            ],
        ),
    ] {
        let curve = folds_in_gap_ratio(&plate("SSSS", in_plane));
        passes_through(in_plane.name(), &curve, table(flat, rest));
    }
}

/// The same for the clamped plate.
#[test]
fn folds_of_clamped_plates_in_gap_ratio() {
    let flat = (171.824440665, 0.4637295069);
    for (in_plane, rest) in [
        (
            InPlane::Immovable,
            [
                (176.476184448, 0.4773454427, 10),
                (191.915137112, 0.5170906363, 10),
                (268.61404177, 0.6160513076, 10),
            ],
        ),
        (
            InPlane::Slide,
            [
                (176.390987643, 0.4770978414, 10),
                (191.525300600, 0.516179861, 9),
                (266.71357784, 0.61476278, 8),
            ],
        ),
        (
            InPlane::Straight,
            [
                (173.591508095, 0.4690156596, 10),
                (179.083764635, 0.4846853057, 10),
                (203.429473577, 0.5394034989, 10),
            ],
        ),
        (
            InPlane::Free,
            [
                (173.291796590, 0.4681619220, 10),
                (177.799999776, 0.4811899261, 10),
                (196.985891023, 0.5259880977, 10),
            ],
        ),
    ] {
        let curve = folds_in_gap_ratio(&plate("CCCC", in_plane));
        passes_through(in_plane.name(), &curve, table(flat, rest));
    }
}

/// Without stretching the curve of folds is level: the gap ratio enters by stretching alone.
#[test]
fn folds_of_linear_plates_do_not_depend_on_the_gap_ratio() {
    for (supports, load, deflection) in
        [("SSSS", 52.633290209, 0.4554324767), ("CCCC", 171.824440665, 0.4637295069)]
    {
        let same = (load, deflection, 10);
        let curve = folds_in_gap_ratio(&linear(supports));
        passes_through(supports, &curve, table((load, deflection), [same; 3]));
    }
}

/// The fold curves in aspect ratio of figures 3.8 and 3.9 pass through the table, to a unit of the
/// last digit.
#[test]
fn folds_of_supported_plates_in_aspect_ratio() {
    for (gap_ratio, folds) in [
        (0.0, [(27.4708175, 0.454336, 6), (20.6023851, 0.451844, 6), (15.0297110, 0.436707, 6)]),
        (0.5, [(29.7298644, 0.493245, 6), (22.5318181, 0.495496, 6), (16.7876148, 0.488879, 6)]),
        (1.0, [(38.3259452, 0.584083, 6), (30.0071894, 0.590974, 6), (23.8894035, 0.587289, 6)]),
        (2.0, [(80.851635, 0.67048, 5), (66.764280, 0.66735, 5), (58.769799, 0.64312, 5)]),
    ] {
        let mut system = system(&plate("SSSS", InPlane::Slide), 4.0);
        let branch = through_pull_in(&mut *system, &[("gap_ratio", gap_ratio)])
            .settings(refined_to(0.0))
            .trace()
            .unwrap();
        let curve = folds_from(&mut *system, &branch, "aspect", 1.0..=4.0);
        let curve = curve.mark("aspect", 1.5).mark("aspect", 2.0).trace().unwrap();
        let digits = if gap_ratio == 2.0 { 6 } else { 7 };
        for (aspect, (load, deflection, shown)) in [1.5, 2.0, 4.0].into_iter().zip(folds) {
            let point = at(&curve, "aspect", aspect);
            let what = format!("aspect {aspect}, gap ratio {gap_ratio}");
            assert_within(&what, value(&curve, point, "load"), load, decimals(digits));
            assert_within(&what, value(&curve, point, "deflection"), deflection, decimals(shown));
        }
    }
}

fn strip_folds(ends: Ends) -> Branch {
    let settings = StripSettings { ends, ..StripSettings::default() };
    let mut strip = Dense::new(Strip::new(settings).unwrap());
    let branch = through_pull_in(&mut strip, &[("gap_ratio", 0.0)]).trace().unwrap();
    let curve = folds_from(&mut strip, &branch, "gap_ratio", 0.0..=2.0);
    curve.mark("gap_ratio", 0.5).mark("gap_ratio", 1.0).trace().unwrap()
}

/// The eight folds of strips lie on two curves.
#[test]
fn folds_of_strips_in_gap_ratio() {
    for (ends, loads) in [
        (Ends::Supported, [13.79038251, 15.60665437, 23.13855200, 58.73790180]),
        (Ends::Clamped, [70.09504829, 72.14917636, 79.12113763, 115.34601976]),
    ] {
        let curve = strip_folds(ends);
        for (gap_ratio, load) in [0.0, 0.5, 1.0, 2.0].into_iter().zip(loads) {
            let found = value(&curve, at(&curve, "gap_ratio", gap_ratio), "load");
            assert_within(&format!("{ends:?}, {gap_ratio}"), found, load, decimals(8));
        }
    }
}

/// A plate four times as long as wide still needs a larger load than the strip, by the printed
/// shares; one eight times as long, with a large gap, a smaller one.
#[test]
fn long_plates_approach_strips_from_both_sides() {
    let strip = strip_folds(Ends::Supported);
    let mut system = system(&plate("SSSS", InPlane::Slide), 8.0);
    // A hundredth of the shares' last digit.
    let coarse = Settings { refinement: 1e-6, ..Settings::default() };
    for (gap_ratio, percent, decimal) in
        [(0.0, 9.0, 1), (0.5, 7.6, 1), (1.0, 3.2, 1), (2.0, 0.05, 2)]
    {
        let start = [("gap_ratio", gap_ratio), ("aspect", 4.0)];
        let branch =
            through_pull_in(&mut *system, &start).settings(coarse.clone()).trace().unwrap();
        let load = pull_in(&branch).parameters[0];
        let of_strip = value(&strip, at(&strip, "gap_ratio", gap_ratio), "load");
        let excess = 100.0 * (load / of_strip - 1.0);
        assert_within(&format!("gap ratio {gap_ratio}"), excess, percent, decimals(decimal));
    }
    let start = [("gap_ratio", 2.0), ("aspect", 8.0)];
    let branch = through_pull_in(&mut *system, &start).settings(coarse).trace().unwrap();
    assert_within("aspect 8", pull_in(&branch).parameters[0], 58.326, decimals(3));
}

/// The plate of Français and Dufour (figure 3.14), on both scales of the load.
#[test]
fn the_plate_that_was_measured_pulls_in_within_the_figure() {
    let mut system = system(&plate("CCCC", InPlane::Immovable), 1.0);
    let branch = through_pull_in(&mut *system, &[("gap_ratio", 0.25)]).trace().unwrap();
    let load = pull_in(&branch).parameters[0];
    assert_within("load", load, 172.9636, decimals(4));
    assert_within("load of section 3.3", load / 16.0, 10.81, decimals(2));
}

/// Frequencies about deflected plates, at marks of the load on the stable branch, to a relative
/// 1e-9: the clamped plate's converge to 34.511800959 and 23.542309663, a little below the digits
/// of the tables.
#[test]
fn frequencies_about_deflected_plates() {
    for (supports, in_plane, gap_ratio, load, deflection, frequency) in [
        ("CCCC", InPlane::Immovable, 2.0, 200.0, (0.344322989, 9), 34.51180097),
        ("CCCC", InPlane::Immovable, 1.0, 180.0, (0.386336034, 9), 23.54230968),
        ("SSSS", InPlane::Slide, 2.0, 100.0, (0.4089395821, 10), 28.7671077501),
        ("SSSS", InPlane::Slide, 0.5, 50.0, (0.3186584076, 10), 14.1319768491),
    ] {
        let mut settings = plate(supports, in_plane);
        let usual = through_pull_in(&mut *system(&settings, 1.0), &[("gap_ratio", gap_ratio)])
            .settings(refined_to(0.0))
            .mark("load", load)
            .trace()
            .unwrap();
        // A mark's parameter is exact, and its monitors are those of the rung that settles it.
        settings.orders = Some(Orders { transverse: [12; 2], in_plane: [16; 2] });
        let branch = at_rest(&mut *system(&settings, 1.0), &[("gap_ratio", gap_ratio)])
            .settings(refined_to(1e-11))
            .along("load", 0.0..=1.02 * load)
            .mark("load", load)
            .trace()
            .unwrap();
        let stable = at(&branch, "load", load);
        let what = format!("{supports}, gap ratio {gap_ratio}");
        assert_eq!((stable.kind, stable.unstable), (Kind::UZ, Some(0)), "{what}");
        let found = ["deflection", "frequency"].map(|name| value(&branch, stable, name));
        assert_within(&what, found[0], deflection.0, decimals(deflection.1));
        assert_close(&what, found[1], frequency, 1e-9);
        // Beyond pull-in the same load is met once more, at an unstable equilibrium.
        let unstable = usual.of_kind(Kind::UZ).nth(1).unwrap();
        assert_eq!(unstable.unstable, Some(1), "{what}");
        assert!(value(&usual, unstable, "frequency") < 0.0, "{what}");
    }
}

/// `d(ω²)/dλ = −2` at no load, to 1e-8, for every in-plane model: a central difference of order six
/// between marks of the branch on both sides of rest, where the load pushes the plate away.
#[test]
fn the_squared_frequency_falls_with_slope_minus_two_along_the_branch() {
    for supports in ["SSSS", "CCCC"] {
        for in_plane in crate::plates::models::IN_PLANE {
            for gap_ratio in [0.0, 0.5, 1.0, 2.0] {
                let mut system = system(&plate(supports, in_plane), 1.0);
                let mut curve = at_rest(&mut *system, &[("gap_ratio", gap_ratio)])
                    .settings(refined_to(0.0))
                    .along("load", -4.0..=4.0);
                for load in 1..=3 {
                    curve = curve.mark("load", f64::from(load)).mark("load", -f64::from(load));
                }
                let branch = curve.trace().unwrap();
                let square =
                    |load: f64| value(&branch, at(&branch, "load", load), "frequency").powi(2);
                let rise = |load: f64| square(load) - square(-load);
                let slope = (45.0 * rise(1.0) - 9.0 * rise(2.0) + rise(3.0)) / 60.0;
                let what = format!("{supports}, {}, {gap_ratio}", in_plane.name());
                assert_close(&what, slope, -2.0, 1e-8);
            }
        }
    }
}

/// Near pull-in the first mode along the centre line differs from the flat plate's by as much as
/// figures 3.12, 3.13, 3.22 and 3.23 show.
#[test]
fn mode_shapes_near_pull_in() {
    for (supports, in_plane, ratio, gap_ratio, difference) in [
        ("SSSS", InPlane::Slide, 0.12, 0.5, 0.021),
        ("SSSS", InPlane::Slide, 0.12, 2.0, 0.120),
        ("CCCC", InPlane::Immovable, 0.1, 0.5, 0.028),
        ("CCCC", InPlane::Immovable, 0.1, 2.0, 0.027),
    ] {
        let mut system = system(&plate(supports, in_plane), 1.0);
        let branch = through_pull_in(&mut *system, &[("gap_ratio", gap_ratio)])
            .mark("frequency_ratio", ratio)
            .trace()
            .unwrap();
        let [flat, near] =
            [at(&branch, "load", 0.0), at(&branch, "frequency_ratio", ratio)].map(|point| {
                let profiles = &point.profiles;
                &profiles.iter().find(|p| p.name == "first mode shape").unwrap().points
            });
        assert_eq!((near.len(), near[25], flat[25]), (51, [0.5, 1.0], [0.5, 1.0]));
        let differences = near.iter().zip(flat).map(|(near, flat)| (near[1] - flat[1]).abs());
        let found = differences.fold(0.0, f64::max);
        assert_within(&format!("{supports}, {gap_ratio}"), found, difference, decimals(3));
    }
}

/// Clamped plates under uniform pressure (`ν = 0.316`, `d = 4h`): `P = pa⁴/(Eh⁴)` against `w/h`, as
/// marks of a branch continued in the pressure, and within 2.5 % of what Levy printed.
#[test]
fn clamped_plates_under_pressure() {
    let levy = [0.237, 0.912, 1.902];
    for (in_plane, deflections) in [
        (InPlane::Slide, [0.236283, 0.904787, 1.864116]),
        (InPlane::Immovable, [0.236170, 0.901823, 1.855964]),
    ] {
        let scale = 12.0 * (1.0 - 0.316 * 0.316) / 4.0;
        let mut system = system(&plate("CCCC", in_plane), 1.0);
        let pressures = [17.79, 95.0, 402.0].map(|pressure| pressure * scale);
        let mut curve = at_rest(&mut *system, &[("nu", 0.316), ("gap_ratio", 4.0)])
            .along("pressure", 0.0..=410.0 * scale);
        for pressure in pressures {
            curve = curve.mark("pressure", pressure);
        }
        let branch = curve.trace().unwrap();
        for ((pressure, expected), levy) in pressures.into_iter().zip(deflections).zip(levy) {
            let found = 4.0 * value(&branch, at(&branch, "pressure", pressure), "deflection");
            let what = format!("{}, pressure {}", in_plane.name(), pressure / scale);
            assert_within(&what, found, expected, decimals(6));
            assert_close(&what, found, levy, 0.025);
        }
    }
}

/// The linear coefficients `w/(qa⁴/D)` of uniform pressure, to the twelve digits printed.
#[test]
fn linear_plates_under_pressure() {
    for (supports, coefficient, digits) in
        [("SSSS", 0.00406235266068, 14), ("CCCC", 0.0012653190875, 13)]
    {
        let mut settings = linear(supports);
        settings.orders = Some(Orders { transverse: [16; 2], in_plane: [4; 2] });
        let mut system = system(&settings, 1.0);
        let branch = at_rest(&mut *system, &[])
            .settings(refined_to(1e-13))
            .along("pressure", 0.0..=2.0)
            .mark("pressure", 1.0)
            .trace()
            .unwrap();
        let found = value(&branch, at(&branch, "pressure", 1.0), "deflection");
        assert_within(supports, found, coefficient, decimals(digits));
    }
}

/// A flat plate under edge forces from none to `120 D/a²`.
fn compressed(system: &mut dyn System, force: &str, asked: f64) -> Branch {
    at_rest(system, &[]).settings(refined_to(asked)).along(force, 0.0..=120.0).trace().unwrap()
}

fn buckling_load(branch: &Branch) -> f64 {
    let first = branch.of_kind(Kind::BP).next().unwrap();
    value(branch, first, &branch.released[0]) / (PI * PI)
}

/// Buckling loads are branch points of the flat branch; where a branch point is switched at, the
/// plate buckles both ways, alike.
#[test]
fn flat_plates_buckle_at_branch_points() {
    for (supports, force, symmetric, expected, tolerance) in [
        ("SSSS", "edge_force_x", true, 4.0, 1e-12),
        ("SSSS", "edge_force", true, 2.0, 1e-12),
        // The printed digits end in a value that is too high; see below.
        ("CCCC", "edge_force_x", true, 10.0739480615, 1e-8),
        ("CCCC", "edge_force", true, 5.3036260808, 1e-8),
        // Two half waves along x, of which symmetry knows nothing.
        ("SCSC", "edge_force_x", false, 7.6912836, 1e-7 / 7.69),
    ] {
        let mut settings = plate(supports, InPlane::Slide);
        settings.symmetric = Some(symmetric);
        let mut system = system(&settings, 1.0);
        let flat = compressed(&mut *system, force, 1e-10);
        let what = format!("{supports}, {force}");
        assert_close(&what, buckling_load(&flat), expected, tolerance);
        let start = flat.of_kind(Kind::BP).next().unwrap();
        let load = value(&flat, start, force);
        let buckled = Continuation::new(&mut *system)
            .restart(&flat, start.label)
            .settings(refined_to(0.0))
            .switch()
            .along(force, 0.0..=120.0)
            .bound("deflection", -0.9..=0.9)
            .mark(force, 1.1 * load)
            .trace()
            .unwrap();
        let sides: Vec<_> = buckled.of_kind(Kind::UZ).collect();
        assert_eq!(sides.len(), 2, "{what}: {:?}", buckled.ends);
        let states = [&sides[0].state, &sides[1].state];
        let largest = states[0].iter().fold(0.0_f64, |most, q| most.max(q.abs()));
        assert!(largest > 1e-3, "{what}");
        // Of two half waves one turns into the other if the plate is turned round.
        for (one, other) in states[0].iter().zip(states[1]) {
            assert_within(&what, *one, -other, 1e-8 * largest);
        }
        for side in &sides {
            assert_eq!(side.unstable, Some(0), "{what}: the buckled plate is stable");
            let deflection = value(&buckled, side, "deflection");
            assert_eq!(deflection.abs() > 0.1, symmetric, "{what}: {deflection}");
        }
        // Along both halves the load grows from the branch point on.
        let column = buckled.column(force).unwrap();
        let loads: Vec<f64> = buckled.points.iter().filter_map(|p| p.value(column)).collect();
        let lowest = loads.iter().copied().fold(f64::INFINITY, f64::min);
        assert_close(&what, lowest, load, 1e-6);
        assert!(loads[0] > lowest && loads[loads.len() - 1] > lowest, "{what}");
    }
}

/// Ritz's method bounds buckling loads from above. With ever more functions the clamped plate's
/// fall below the digits printed in the tables, 10.0739480615 and 5.3036260808, and settle there.
#[test]
fn buckling_loads_of_clamped_plates_are_bounded_below_the_printed_digits() {
    for (force, printed, limit) in
        [("edge_force_x", 10.0739480615, 10.0739479973), ("edge_force", 5.3036260808, 5.3036260666)]
    {
        let loads = [6, 8, 10, 12, 14, 16].map(|count| {
            let mut settings = linear("CCCC");
            settings.orders = Some(Orders { transverse: [count; 2], in_plane: [2; 2] });
            buckling_load(&compressed(&mut *system(&settings, 1.0), force, 0.0))
        });
        for pair in loads.windows(2) {
            assert!(pair[1] <= pair[0] + 1e-11, "{force}: not falling: {loads:?}");
        }
        // The digits printed are those of six functions each way.
        assert_within(force, loads[0], printed, decimals(10));
        assert!(loads[1] < printed - 1e-9, "{force}: {loads:?}");
        assert_within(force, loads[5], limit, decimals(10));
    }
}

/// The buckled plate against the series of sines and stress functions, an independent method.
#[test]
fn buckled_plates_deflect_as_the_sine_model_says() {
    let deflections = [Model::Ritz, Model::Sine].map(|model| {
        let settings = PlateSettings { model, modes: 30, ..plate("SSSS", InPlane::Slide) };
        let mut system = system(&settings, 1.0);
        let flat = compressed(&mut *system, "edge_force_x", 0.0);
        let start = flat.of_kind(Kind::BP).next().unwrap();
        let buckled = Continuation::new(&mut *system)
            .restart(&flat, start.label)
            .settings(refined_to(1e-7))
            .switch()
            .along("edge_force_x", 0.0..=80.0)
            .bound("deflection", -0.9..=0.9)
            .mark("edge_force_x", 60.0)
            .trace()
            .unwrap();
        value(&buckled, at(&buckled, "edge_force_x", 60.0), "deflection").abs()
    });
    assert_close("deflection at 60 D/a²", deflections[0], deflections[1], 1e-5);
}

/// The exact buckling loads of supported plates, `N_x/π² = (1 + 1/α²)²` and `N/π² = 1 + 1/α²` for
/// one half wave each way, along curves on which the branch point is held while the aspect ratio
/// varies.
#[test]
fn curves_of_branch_points_follow_the_exact_buckling_loads() {
    type Load = fn(f64) -> f64;
    let exact: [(&str, Load); 2] = [
        ("edge_force_x", |aspect| (1.0 + aspect.powi(-2)).powi(2)),
        ("edge_force", |aspect| 1.0 + aspect.powi(-2)),
    ];
    for (force, exact) in exact {
        let mut system = system(&plate("SSSS", InPlane::Slide), 1.0);
        let flat = compressed(&mut *system, force, 0.0);
        let curve = Continuation::new(&mut *system)
            .settings(refined_to(0.0))
            .restart(&flat, flat.of_kind(Kind::BP).next().unwrap().label)
            .hold(Kind::BP)
            .along(force, 0.0..=400.0)
            .along("aspect", 0.5..=2.0)
            .trace()
            .unwrap();
        let columns = [force, "aspect"].map(|name| curve.column(name).unwrap());
        let [low, high] = [0.5, 2.0].map(|aspect| at(&curve, "aspect", aspect).kind);
        assert_eq!((low, high, curve.condition), (Kind::EP, Kind::EP, Some(Kind::BP)));
        assert!(curve.points.len() > 10);
        for point in &curve.points {
            let [load, aspect] = columns.map(|column| point.value(column).unwrap());
            assert_close(&format!("{force}, {aspect}"), load / (PI * PI), exact(aspect), 1e-10);
        }
    }
}

/// Plates with other edges: a plate pulls in earlier the less its edges are held, and with symmetry
/// given up at the same load.
#[test]
fn plates_with_other_edges_pull_in_in_order() {
    let load = |supports: &str, symmetric: bool, settings: Settings| {
        let plate = PlateSettings {
            supports: supports.into(),
            symmetric: Some(symmetric),
            ..PlateSettings::default()
        };
        let mut system = system(&plate, 1.0);
        let branch = through_pull_in(&mut *system, &[]).settings(settings).trace().unwrap();
        let fold = pull_in(&branch);
        (fold.parameters[0], fold.error)
    };
    let order = ["CFFF", "SFSF", "SCSF", "CCCF", "SSSC", "SCSC", "CCCC"];
    let coarse = Settings { refinement: 1e-3, ..Settings::default() };
    let loads = order.map(|supports| load(supports, true, coarse.clone()).0);
    assert!(loads.windows(2).all(|pair| pair[0] < pair[1]), "{order:?}: {loads:?}");
    for supports in ["SFSF", "SCSC"] {
        let [with, without] =
            [true, false].map(|symmetric| load(supports, symmetric, refined_to(1e-6)));
        assert_within(supports, with.0, without.0, with.1 + without.1);
    }
}
