//! Promise: equilibria whose states are far from 1 are found, though no scale is stated.

use super::traced;
use crate::common::close;
use tangency::core::continuation::End;
use tangency::core::system::Kind;

/// `x' = x − x³ + h` in units of `1/size`, from a start at 0: folds at `x = ±1/√3`, `h = ∓2/(3√3)`, and for
/// `h = −1` the root −1.3247….
#[test]
fn cusps_of_any_size() {
    for size in ["1e5", "1e9", "1e12"] {
        let text = format!(
            "Scene(title: \"t\", problem: Equations(states: [(\"x\", \"(({size}*x) - ({size}*x)^3 + h)/{size}\")], solution: equilibrium),
                parameters: [(\"h\", -1)], runs: [(name: \"r\", along: [(name: \"h\", low: -1, high: 1)])])"
        );
        let size: f64 = size.parse().unwrap();
        let branch = &traced(&text)[0];
        let found = |kind| -> Vec<[f64; 2]> {
            let of_kind = branch.of_kind(kind);
            of_kind.map(|s| [s.parameters[0], size * s.monitors[0]]).collect()
        };
        let [ends, folds] = [Kind::EP, Kind::LP].map(found);
        assert_eq!((branch.special.len(), ends.len(), folds.len()), (4, 2, 2), "{size:e}");
        assert!(branch.special.iter().all(|special| special.converged));
        let (root, h) = (1.324_717_957_244_746, 2.0 / 27.0_f64.sqrt());
        for (sign, k) in [(-1.0, 0), (1.0, 1)] {
            close(ends[k][1], sign * root, 1e-11);
            close(folds[k][0], -sign * h, 1e-11);
            close(folds[k][1], sign / 3.0_f64.sqrt(), 1e-11);
        }
    }
}

/// A fold at `p = 1`, beyond which there is no solution.
#[test]
fn no_branch_goes_on_beyond_its_fold() {
    for equation in ["p - 1 + (x/1e-9)^2", "(p - 1)*1e-12 + x^2*1e12"] {
        let size = if equation.contains("e-9") { 1e-9 } else { 1e-12 };
        let text = format!(
            "Scene(title: \"t\", problem: Equations(states: [(\"x\", \"{equation}\")], initial: [(\"x\", {:e})], solution: equilibrium),
                parameters: [(\"p\", 0)], runs: [(name: \"r\", along: [(name: \"p\", low: 0, high: 3)])])",
            -size
        );
        let branch = &traced(&text)[0];
        let kinds: Vec<Kind> = branch.special.iter().map(|special| special.kind).collect();
        assert_eq!(kinds, [Kind::EP, Kind::LP, Kind::EP], "{equation}");
        close(branch.special[1].parameters[0], 1.0, 1e-12);
        assert!(branch.ends.iter().all(|end| matches!(end, End::ParameterBound { .. })));
    }
}

/// A food chain without its last link (Rosenzweig, MacArthur): cycles are born where the prey at rest,
/// `0.4/3.8`, is at the top of its isocline, `(K − 1/3)/2`. The last state is zero all along. In the
/// second range a step ends where the critical eigenvalues are 0.0068 ± 0.388i.
#[test]
fn a_state_that_stays_at_zero_does_not_shift_a_hopf_point() {
    for (low, high) in [(0.1, 1.0), (0.05, 2.0)] {
        let text = format!("Scene(title: \"t\", problem: Equations(states: [(\"x\", \"x*(r*(1-x/K)-5*y/(1+3*x))\"),
                (\"y\", \"y*(5*x/(1+3*x)-0.4-0.1*z/(1+2*y))\"), (\"z\", \"z*(0.1*y/(1+2*y)-0.01)\")],
                initial: [(\"x\", 0.1), (\"y\", 0), (\"z\", 0)], solution: equilibrium),
            parameters: [(\"r\", 0.6), (\"K\", 0.1)], runs: [(name: \"prey\", along: [(name: \"K\", low: {low}, high: {high})]),
                (name: \"both\", start: From(run: \"prey\", kind: BP, switch: true), along: [(name: \"K\", low: {low}, high: {high})])])");
        let branches = traced(&text);
        let hopf: Vec<_> = branches[1].of_kind(Kind::HB).collect();
        assert!(hopf.len() == 1 && hopf[0].converged, "{}", hopf.len());
        let p = branches[1].parameters.iter().position(|name| name == "K").unwrap();
        close(hopf[0].parameters[p], 2.0 * (0.4 / 3.8) + 1.0 / 3.0, 1e-12);
    }
}

/// A capacitor on a spring, in SI units: `k x = ε A V²/(2 (g − x)²)` pulls in at `x = g/3`,
/// `V² = 8 k g³/(27 ε A)`. At `V = 0` both `x` and `dx/dV` are zero, and no scale is stated.
#[test]
fn a_state_that_begins_at_zero_with_a_slope_of_zero_has_a_scale() {
    for gap in [2e-3, 2e-6, 2e-9] {
        for problem in [
            "Residual(unknowns: [(\"x\", \"k*x - eps*A*V^2/(2*(g - x)^2)\")])",
            "Equations(states: [(\"x\", \"v\"), (\"v\", \"(eps*A*V^2/(2*(g - x)^2) - k*x - c*v)/m\")],
                solution: equilibrium)",
        ] {
            let (k, eps, area) = (10.0, 8.854e-12, 1e-8);
            let exact = (8.0 * k * f64::powi(gap, 3) / (27.0 * eps * area)).sqrt();
            let text = format!(
                "Scene(title: \"t\", problem: {problem}, parameters: [(\"k\", {k}), (\"eps\", {eps:e}), (\"A\", {area:e}),
                    (\"g\", {gap:e}), (\"V\", 0), (\"c\", 1e-6), (\"m\", 1e-10)],
                    runs: [(name: \"r\", along: [(name: \"V\", low: 0, high: {high:e})],
                        bounds: [(name: \"x\", low: 0, high: {bound:e})])])",
                high = 12.0 * exact,
                bound = 0.9 * gap
            );
            let text = match problem.starts_with("Residual") {
                true => text.replace(", (\"c\", 1e-6), (\"m\", 1e-10)", ""),
                false => text,
            };
            let branch = &traced(&text)[0];
            let folds: Vec<_> = branch.of_kind(Kind::LP).collect();
            assert!(folds.len() == 1 && branch.special.iter().all(|it| it.converged), "{gap:e}");
            let voltage = branch.parameters.iter().position(|name| name == "V").unwrap();
            close(folds[0].parameters[voltage] / exact, 1.0, 1e-10);
            close(folds[0].monitors[0] / (gap / 3.0), 1.0, 1e-7);
        }
    }
}

/// `u = c V²/(1 − u)²` from `V = 0`: without a stated scale the branch takes about as many points as with its scale.
#[test]
fn a_state_that_grows_as_a_square_needs_no_scale() {
    let count = |scales: &str| {
        let text = format!(
            "Scene(title: \"t\", problem: Residual(unknowns: [(\"u\", \"V^2/900/(1 - u)^2 - u\")]{scales}),
                parameters: [(\"V\", 0)], runs: [(name: \"r\", along: [(name: \"V\", low: 0, high: 15)],
                    bounds: [(name: \"u\", low: 0, high: 0.9)])])"
        );
        traced(&text)[0].points.len()
    };
    let [with, without] = [", scales: [(\"u\", 1)]", ""].map(count);
    assert!(without <= 2 * with, "{without} points, but {with} with a scale");
}
