//! Promise: local maps near grazing have the coefficients of the literature and of closed forms,
//! signs included, and can be reached from points that were located before, printed, iterated and
//! differentiated.

use crate::common::{agree, close};
use crate::grazing::points::{actuator, oscillator, settings, simulated};
use crate::hybrid::systems::impact_oscillator::{ClosedForm, flow};
use nalgebra::{Matrix3, Vector3};
use proptest::prelude::*;
use std::f64::consts::TAU;
use tangency::core::bvp::{BoundarySystem, Mesh, Shooting};
use tangency::core::continuation::{Continuation, Settings};
use tangency::core::hybrid::HybridSystem;
use tangency::core::local_map::{GrazingPoint, LocalMap};
use tangency::core::ode::Scheme;
use tangency::core::orbit::{HybridOrbit, Itinerary};
use tangency::core::scalar::{Jet, Scalar, Space};
use tangency::core::system::{Kind, System};
use tangency::problems::mita::Actuator;

/// Half a unit of the sixth decimal, with the rounding of what is printed.
const PRINTED: f64 = 0.51e-6;

/// Mita's map of an order in displacement, phase, voltage and frequency.
fn mita(point: &GrazingPoint, order: usize) -> LocalMap {
    LocalMap::of(&Actuator, point, &["voltage", "frequency"], settings(order)).unwrap()
}

/// What vanishes at a codimension-two point, with its derivatives with respect to phase, voltage
/// and frequency.
type Condition = fn(&LocalMap) -> (f64, [f64; 3]);

/// The derivatives, by phase, voltage and frequency, of a first derivative of the smooth map by a
/// coordinate.
fn slopes(map: &LocalMap, image: usize, coordinate: usize) -> [f64; 3] {
    [1, 2, 3].map(|variable| {
        let mut powers = [0; 4];
        powers[coordinate] += 1;
        powers[variable] += 1;
        let twice = if coordinate == variable { 2.0 } else { 1.0 };
        twice * map.smooth()[image].coefficient(&powers)
    })
}

fn slope(map: &LocalMap, image: usize, coordinate: usize) -> f64 {
    map.smooth()[image].coefficients()[1 + coordinate]
}

/// I/II: the displacement does not depend on the phase one turn before.
fn degenerate(map: &LocalMap) -> (f64, [f64; 3]) {
    (slope(map, 0, 1), slopes(map, 0, 1))
}

/// II/III: `det(N − I) = 0`, a multiplier of the smooth map is 1.
fn nonhyperbolic(map: &LocalMap) -> (f64, [f64; 3]) {
    let n = |i, j| slope(map, i, j) - if i == j { 1.0 } else { 0.0 };
    let d = |i, j| slopes(map, i, j);
    let rate = |k: usize| {
        d(0, 0)[k] * n(1, 1) + n(0, 0) * d(1, 1)[k] - d(0, 1)[k] * n(1, 0) - n(0, 1) * d(1, 0)[k]
    };
    (n(0, 0) * n(1, 1) - n(0, 1) * n(1, 0), [rate(0), rate(1), rate(2)])
}

/// The codimension-two point near a voltage, frequency and phase, by Newton's iteration on the
/// second-order map.
fn codimension_two(mut at: [f64; 3], condition: Condition) -> (GrazingPoint, [f64; 3]) {
    for _ in 0..8 {
        let [voltage, frequency, phase] = at;
        let map = mita(&actuator(voltage, frequency, phase), 2);
        let missed = [0, 1].map(|i| map.smooth()[i].coefficients()[0]);
        let (value, gradient) = condition(&map);
        let row = |i: usize| [slope(&map, i, 1) - i as f64, slope(&map, i, 2), slope(&map, i, 3)];
        let matrix = Matrix3::from_rows(&[
            Vector3::from(row(0)).transpose(),
            Vector3::from(row(1)).transpose(),
            Vector3::from(gradient).transpose(),
        ]);
        let change = matrix.lu().solve(&-Vector3::new(missed[0], missed[1], value)).unwrap();
        at = [voltage + change[1], frequency + change[2], phase + change[0]];
    }
    (actuator(at[0], at[1], at[2]), at)
}

/// I/II and II/III to the digits that another method (the curve of grazing orbits) gives.
#[test]
fn codimension_two_points_are_found() {
    for (start, expected, condition) in [
        (
            [0.171067, 0.487809, 5.496544],
            [0.171066688958, 0.487808700440, 5.496543861],
            degenerate as Condition,
        ),
        (
            [0.176796, 0.480271, 5.286519],
            [0.176795673315, 0.480271127402, 5.286519332],
            nonhyperbolic,
        ),
    ] {
        let (_, found) = codimension_two(start, condition);
        close(found[0], expected[0], 1e-12);
        close(found[1], expected[1], 1e-12);
        close(found[2], expected[2], 6e-10);
    }
}

/// The same points as special ones of the curve of grazings in voltage and frequency, followed as
/// one of orbits without impacts (II/III) and as one of orbits with an impact of no speed (I/II):
/// the maps there are the same.
#[test]
fn curves_of_grazings_lead_to_maps() {
    let orbit = HybridOrbit::of(Actuator, Itinerary::smooth(Actuator::STICK, 1)).unwrap();
    let method = Shooting::new(Scheme::DormandPrince8, 1e-13).unwrap();
    let mut orbits = BoundarySystem::new(orbit, method, vec![Mesh::uniform(1)]).unwrap();
    let names = orbits.names().parameters.clone();
    let run = Continuation::new(&mut orbits);
    let run = names.iter().zip(Actuator::DEFAULTS).fold(run, |run, (name, p)| run.at(name, p));
    let branch = run.at("voltage", 0.01).along("voltage", 0.01..=1.0).trace().unwrap();
    let label = branch.of_kind(Kind::G).next().unwrap().label;
    let nonhyperbolic = (Kind::GL, [0.176796, 0.480271, 5.286519], nonhyperbolic as Condition);
    let degenerate = (Kind::GD, [0.171067, 0.487809, 5.496544], degenerate as Condition);
    let points = [nonhyperbolic, degenerate];
    for (switch, (kind, start, condition)) in
        [false, true].iter().flat_map(|switch| points.map(|point| (*switch, point)))
    {
        let run = Continuation::new(&mut orbits).restart(&branch, label).hold(Kind::G);
        let run = if switch { run.switch() } else { run };
        let settings = Settings { max_step: 0.05, ..Settings::default() };
        let run = run.along("voltage", 0.0..=1.0).along("frequency", 0.44..=0.52);
        let curve = run.settings(settings).trace().unwrap();
        let special = curve.of_kind(kind).next().unwrap();
        let point = GrazingPoint::at(&mut orbits, &curve.solution(special)).unwrap();
        assert_eq!(point.following.len(), 1);
        let (expected, _) = codimension_two(start, condition);
        agree(&point.p, &expected.p, 1e-10);
        let (found, expected) = (mita(&point, 2), mita(&expected, 2));
        let images = |map: &LocalMap| -> Vec<f64> {
            let all = map.smooth().iter().chain(map.discontinuity());
            all.flat_map(|image| image.coefficients().to_vec()).collect()
        };
        agree(&images(&found), &images(&expected), 1e-8);
    }
}

/// X. Zhao (2004), the coefficients of sections 5.3 and 5.4, of Δq and of Δθ: those of first and
/// second order of the smooth map, then √-coefficients of the discontinuity map: y² of Δq, and y,
/// y², yΔθ, yΔV, yΔω of Δθ.
///
/// At II/III −0.204935 is printed for y²: that is the coefficient at the six digits of the point
/// that are printed, as the next test shows; at the point itself it is −0.20493449.
#[test]
fn coefficients_are_those_of_the_literature() {
    let smooth_one = [
        [
            0.936621, 0.0, 0.775788, -0.174538, 0.111825, -0.010300, 0.960382, -0.627897,
            -0.103166, -0.141530, -0.669646, 3.453545, -3.214745, -1.520772,
        ],
        [
            0.142633, 0.825198, 0.981760, 5.826231, 0.394304, -0.148787, 2.226556, -0.441188,
            0.013870, -2.259133, -0.532660, 4.232262, -7.413180, -1.824478,
        ],
    ];
    let smooth_two = [
        [
            0.942970, 0.051226, 0.809064, 0.007156, 0.138282, 0.054422, 1.242257, -0.431478,
            -0.105538, 0.426753, -0.888627, 4.245009, -1.163251, -2.288626,
        ],
        [
            0.192815, 0.826809, 1.587896, 6.003273, 0.724366, -0.136173, 3.299731, -0.342789,
            -0.056545, -2.327787, -1.151473, 7.230497, -6.147746, -3.611893,
        ],
    ];
    for (start, condition, smooth, leading, jump) in [
        (
            [0.171067, 0.487809, 5.496544],
            degenerate as Condition,
            smooth_one,
            0.237147,
            [-1.557671, -0.189248, 0.206574, -1.21057, -3.1932],
        ),
        (
            [0.176796, 0.480271, 5.286519],
            nonhyperbolic,
            smooth_two,
            0.238028,
            [-1.587532, -0.204934, 0.219773, -1.92188, -3.30549],
        ),
    ] {
        let map = mita(&codimension_two(start, condition).0, 2);
        for (image, expected) in map.smooth().iter().zip(smooth) {
            for (found, expected) in image.coefficients()[1..].iter().zip(expected) {
                close(*found, expected, PRINTED);
            }
        }
        let [displacement, phase] = map.discontinuity() else { panic!("two coordinates") };
        let rest = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1], [1, 1, 0, 0]];
        rest.iter().for_each(|powers| close(displacement.coefficient(powers), 0.0, 1e-12));
        close(displacement.coefficient(&[2, 0, 0, 0]), leading, PRINTED);
        let powers = [[1, 0, 0, 0], [2, 0, 0, 0], [1, 1, 0, 0], [1, 0, 1, 0], [1, 0, 0, 1]];
        for ((powers, expected), printed) in
            powers.iter().zip(jump).zip([PRINTED, PRINTED, PRINTED, 5.1e-6, 5.1e-5])
        {
            close(phase.coefficient(powers), expected, printed);
        }
        // Without an impact nothing happens: the part without y is the identity.
        close(phase.coefficient(&[0, 1, 0, 0]), 1.0, 1e-14);
        [[0, 0, 1, 0], [0, 0, 0, 1], [0, 2, 0, 0], [0, 1, 1, 0], [0, 0, 0, 2]]
            .iter()
            .for_each(|powers| close(phase.coefficient(powers), 0.0, 1e-12));
    }
}

/// The coefficient of y² at II/III, at the digits printed and at the point, against the time that
/// simulated motion needs: `Δθ/y` at points that are so deep, extrapolated to none.
#[test]
fn a_last_digit_depends_on_the_point() {
    let printed = actuator(0.176796, 0.480271, 5.286519);
    let exact = codimension_two([0.176796, 0.480271, 5.286519], nonhyperbolic).0;
    for (point, rounded) in [(printed, -0.204935), (exact, -0.204934)] {
        let map = mita(&point, 2);
        let found = map.discontinuity()[1].coefficient(&[2, 0, 0, 0]);
        let first = map.discontinuity()[1].coefficient(&[1, 0, 0, 0]);
        close(found, rounded, 0.5e-6);
        let slope = |y: f64| {
            let start = (point.time, vec![point.x[0] + y * y, 0.0]);
            let (t, _) = simulated(&Actuator, &start, 0.0, &point.p);
            ((t - point.time) * point.p[1] / y - first) / y
        };
        // Neville's scheme for y → 0.
        let depths = [0.08, 0.07, 0.06, 0.05, 0.04, 0.03, 0.02];
        let mut values = depths.map(slope);
        for k in 1..depths.len() {
            for i in 0..depths.len() - k {
                let (a, b) = (depths[i], depths[i + k]);
                values[i] = (a * values[i + 1] - b * values[i]) / (a - b);
            }
        }
        // Errors of 1e-14 are divided by the squares of depths, and grow by the extrapolation.
        close(values[0], found, 2e-8);
    }
}

/// Leading coefficients in closed form, and the one of third order that is printed.
#[test]
fn leading_coefficients_are_closed_forms() {
    let (point, [voltage, frequency, phase]) =
        codimension_two([0.171067, 0.487809, 5.496544], degenerate);
    let map = mita(&point, 3);
    let [_, _, clearance, e, _, _, friction, frame, gravity] = Actuator::DEFAULTS;
    // Decelerations a of the block in stick, b of the frame in slip.
    let force = (voltage * phase.sin() / (1.0 - clearance)).powi(2) - clearance;
    let (a, b) = (-force, (force + friction * (1.0 + frame) * gravity) / frame);
    let mu = 1.0 / (1.0 + frame);
    let square = e * e - 2.0 * e * (1.0 + e) * mu + ((1.0 + e) * mu).powi(2) * (1.0 - a / b);
    let root = -(1.0 + e) * (1.0 - mu) * frequency * (2.0 / a).sqrt();
    let [displacement, time] = map.discontinuity() else { panic!("two coordinates") };
    close(displacement.coefficient(&[2, 0, 0, 0]), square, 1e-12);
    close(time.coefficient(&[1, 0, 0, 0]), root, 1e-12);
    close(displacement.coefficient(&[3, 0, 0, 0]), 0.0569, 0.5e-4);
}

/// The smooth map of the linear oscillator from its solution `x = p(t) + Φ(t − t₀)(x₀ − p(t₀))`, to
/// the fifth order in displacement, phase and amplitude.
#[test]
fn the_linear_oscillator_has_its_closed_form() {
    let form = ClosedForm::usual(1.2);
    let map = oscillator(&form, &["amplitude"], 5);
    let space = Space::of(3, 5).unwrap();
    let jet = |k, value| Jet::<64>::variable(space, k, value).unwrap();
    let start = map.origin().0[1];
    let (displacement, phase) = (jet(0, form.clearance), jet(1, start));
    let amplitude = jet(2, form.grazing());
    let forced = |t: Jet<64>| form.motion(1.0, t).map(|p| p * amplitude);
    let begin = phase / form.frequency;
    let [p, v] = forced(begin);
    let free = [displacement - p, -v];
    let motion = |after: Jet<64>| {
        let ([[a, b], [c, d]], [p, v]) = (flow(after, form.damping), forced(begin + after));
        [p + a * free[0] + b * free[1], v + c * free[0] + d * free[1]]
    };
    // Newton's iteration for v = 0; each iteration gives a degree.
    let mut after = Jet::from(TAU / form.frequency);
    for _ in 0..8 {
        after += motion(after)[1] / form.clearance / form.frequency.powi(2);
    }
    let phase = (begin + after) * form.frequency - (start + TAU);
    let exact = [motion(after)[0] - form.clearance, phase];
    for (image, exact) in map.smooth().iter().zip(exact) {
        agree(&image.coefficients()[1..], &exact.coefficients()[1..], 1e-9);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// An impact that is followed by none costs the time `(1 + e) √(2/a) y` and leaves `e²` of the
    /// penetration, whatever the oscillator.
    #[test]
    fn impacts_without_slip_have_closed_forms(
        frequency in 0.6..1.9_f64,
        e in 0.0..1.0_f64,
        damping in 0.05..0.4_f64,
        clearance in 0.2..3.0_f64,
    ) {
        let form = ClosedForm::new(frequency, e, damping, clearance);
        let map = oscillator(&form, &["amplitude", "clearance"], 2);
        let [displacement, phase] = map.discontinuity() else { panic!("two coordinates") };
        let time = (2.0 / (clearance * frequency.powi(2))).sqrt();
        let root = -(1.0 + e) * frequency * time;
        prop_assert!((phase.coefficient(&[1, 0, 0, 0]) - root).abs() < 1e-9 * root.abs());
        prop_assert!((displacement.coefficient(&[2, 0, 0, 0]) - e * e).abs() < 1e-9);
        // The stop moves with the clearance, and a virtual point with it.
        prop_assert!((displacement.coefficient(&[0, 0, 0, 1]) - 1.0).abs() < 1e-12);
        prop_assert!((map.entry().coefficient(&[0, 0, 0, 1]) - 1.0).abs() < 1e-12);
        prop_assert!((map.entry().coefficient(&[2, 0, 0, 0]) - 1.0).abs() < 1e-12);
        prop_assert!((map.penetration().coefficient(&[0, 0, 0, 1]) + 1.0).abs() < 1e-12);
    }
}

/// Iterating allocates nothing after the first image.
#[test]
fn iterations_allocate_nothing() {
    let map = oscillator(&ClosedForm::usual(1.2), &["amplitude"], 4);
    let mut iteration = map.iteration::<f64>();
    let mut x = [1e-4, 0.0];
    iteration.apply(&mut x, &[1e-5]);
    let allocated = allocation_counter::measure(|| {
        for _ in 0..100 {
            iteration.apply(&mut x, &[1e-5]);
        }
    });
    assert_eq!(allocated.count_total, 0);
}

/// A printed map names its monomials.
#[test]
fn maps_are_printed() {
    let map = mita(&actuator(0.171066688958, 0.487808700440, 5.496543861), 2);
    let printed = map.to_string();
    assert!(printed.contains("Δvoltage²"), "{printed}");
    assert!(printed.contains("yΔphase"), "{printed}");
    assert_eq!(printed.lines().count(), 1 + 1 + 14 + 1 + 1 + 6, "{printed}");
    assert_eq!(map.parameters(), ["voltage", "frequency"]);
    assert_eq!(Actuator.modes()[Actuator::STICK].states[0], map.coordinates()[0]);
}

/// Dual numbers pass through the map: its Jacobian is that of differences.
#[test]
fn maps_are_differentiated() {
    use num_dual::Dual64;
    let map = mita(&actuator(0.171066688958, 0.487808700440, 5.496543861), 3);
    let (x, p) = ([2e-4, 1e-3], [1e-5, -1e-5]);
    for k in 0..2 {
        let mut dual = x.map(Dual64::from);
        dual[k] = dual[k].derivative();
        map.iteration().apply(&mut dual, &p.map(Dual64::from));
        let mut direction = [0.0; 2];
        direction[k] = 1.0;
        let differences = crate::common::difference(&x, &direction, 1e-6, |x| {
            let mut x = x.to_vec();
            map.iteration().apply(&mut x, &p);
            x
        });
        agree(&dual.map(|x| x.eps), &differences, 1e-8);
        assert!(dual[k].real().is_finite());
    }
}
