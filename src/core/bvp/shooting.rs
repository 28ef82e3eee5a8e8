//! Shooting: the trajectory of an interval is flowed from its left end.

mod lookout;
mod variation;

use super::method::{Block, Interval, Method, Watchlist};
use super::problem::BoundaryProblem;
use crate::core::flow::{Flow, Scheme, Settings, SettingsError};
use crate::core::scalar::Scalar;
use crate::core::zero::LeftDomain;
use lookout::{Lookout, Search};
use std::ops::ControlFlow;
use variation::Variation;

/// What is drawn need not be more accurate than this.
const DRAWN: f64 = 1e-8;

/// Tolerances are not made smaller than this: rounding errors of a flow are of this size.
const SMALLEST_TOLERANCE: f64 = 1e-14;

/// Shooting: the residual of an interval is `φ(x_left) − x_right`, with the flow `φ` from its start to its
/// end. Several intervals make it multiple shooting, for trajectories along which errors grow.
///
/// Derivatives by the left states and all active numbers come from one flow of dual numbers that takes the
/// same steps as that of real numbers, so that residual and Jacobian belong together. So do the extrema that
/// monitors ask for. On the way to a solution the flow may err more than its settings say, by as much as
/// Newton's iteration allows.
///
/// ```
/// use tangency::core::bvp::Shooting;
/// use tangency::core::flow::Scheme;
/// let shooting = Shooting::new(Scheme::DormandPrince8, 1e-10).unwrap();
/// assert_eq!(shooting.settings().relative, 1e-10);
/// assert!(Shooting::new(Scheme::DormandPrince8, 0.0).is_err());
/// ```
pub struct Shooting {
    settings: Settings,
    /// The error that is allowed on the way to a solution.
    allowed: f64,
    two: Variation<2>,
    three: Variation<3>,
    four: Variation<4>,
    six: Variation<6>,
    eight: Variation<8>,
    plain: Flow<f64>,
    search: Search,
    x: Vec<f64>,
}

impl Shooting {
    /// Shooting by a scheme, with a tolerance of its steps (absolute and relative).
    ///
    /// # Errors
    /// [`SettingsError`] if the tolerance has no meaning.
    pub fn new(scheme: Scheme, tolerance: f64) -> Result<Self, SettingsError> {
        Shooting::with(Settings::new(scheme, tolerance))
    }

    /// Shooting with settings of the flow.
    ///
    /// # Errors
    /// [`SettingsError`] if a setting has no meaning.
    pub fn with(settings: Settings) -> Result<Self, SettingsError> {
        settings.check()?;
        Ok(Shooting { settings, ..Shooting::default() })
    }

    /// The settings of the flow.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The settings with the error that is allowed at present.
    fn present(&self) -> Settings {
        let Settings { relative, absolute, .. } = self.settings;
        let (relative, absolute) = (relative.max(self.allowed), absolute.max(self.allowed));
        Settings { relative, absolute, ..self.settings }
    }
}

impl Default for Shooting {
    /// The method of order 8 with a tolerance of 1e-12.
    fn default() -> Self {
        Shooting {
            settings: Settings::default(),
            allowed: 0.0,
            two: Variation::default(),
            three: Variation::default(),
            four: Variation::default(),
            six: Variation::default(),
            eight: Variation::default(),
            plain: Flow::default(),
            search: Search::default(),
            x: Vec::new(),
        }
    }
}

impl Clone for Shooting {
    /// The same settings; buffers are made anew.
    fn clone(&self) -> Self {
        Shooting { settings: self.settings, ..Shooting::default() }
    }
}

/// A flow from the start of an interval to a place in it, `x` being the states there.
fn flow_to<P: BoundaryProblem, T: Scalar>(
    flow: &mut Flow<T>,
    interval: Interval<P, T>,
    place: f64,
    x: &mut [T],
) -> Result<(), LeftDomain> {
    let (start, length) = times(&interval);
    flow.advance(&interval.field(), start, length * place, x, interval.q)?;
    Ok(())
}

/// A segment over which a deviation grows by more leaves but one or two digits: rounding grows alike.
const LARGEST_GROWTH: f64 = 1e14;

/// Refuses a linearisation that nothing can be concluded from; by the derivatives of states by themselves, which have no unit.
fn growth(nodes: &[f64], n: usize) -> Result<(), LeftDomain> {
    let own = nodes.chunks_exact(2 * n).enumerate().map(|(i, row)| row[i].abs());
    let value = own.fold(0.0, f64::max);
    if value <= LARGEST_GROWTH {
        return Ok(());
    }
    Err(LeftDomain {
        quantity: "growth of deviations over a segment".into(),
        value,
        verdict: "leaves no digit of its end",
        remedy: "take more segments, or collocation".into(),
    })
}

/// The time at which an interval starts, and its length in time.
fn times<P: BoundaryProblem, T: Scalar>(interval: &Interval<P, T>) -> (T, T) {
    let duration = interval.duration();
    (duration * interval.span.start, duration * interval.length())
}

impl Method for Shooting {
    type Work<T: Scalar> = Flow<T>;

    fn places(&self) -> &[f64] {
        &[0.0, 1.0]
    }

    const EXTREMA_WITH_RESIDUAL: bool = true;

    fn residual<P: BoundaryProblem, T: Scalar>(
        &self,
        interval: Interval<P, T>,
        work: &mut Flow<T>,
        r: &mut [T],
    ) -> Result<(), LeftDomain> {
        let (left, right) = interval.nodes.split_at(interval.nodes.len() / 2);
        r.copy_from_slice(left);
        work.settings = self.present();
        flow_to(work, interval, 1.0, r)?;
        r.iter_mut().zip(right).for_each(|(r, right)| *r -= *right);
        Ok(())
    }

    fn value<P: BoundaryProblem, T: Scalar>(
        &self,
        interval: Interval<P, T>,
        place: f64,
        work: &mut Flow<T>,
        x: &mut [T],
    ) -> Result<(), LeftDomain> {
        x.copy_from_slice(&interval.nodes[..x.len()]);
        work.settings = self.present();
        if place == 0.0 { Ok(()) } else { flow_to(work, interval, place, x) }
    }

    /// From the dense output of one flow.
    fn trajectory<P: BoundaryProblem>(
        &self,
        interval: Interval<P, f64>,
        count: usize,
        work: &mut Flow<f64>,
        visit: &mut dyn FnMut(f64, &[f64]),
    ) -> Result<(), LeftDomain> {
        let mut x = interval.nodes[..interval.nodes.len() / 2].to_vec();
        let (mut next, mut between) = (0, x.clone());
        let Settings { relative, absolute, .. } = self.settings;
        let (relative, absolute) = (relative.max(DRAWN), absolute.max(DRAWN));
        work.settings = Settings { relative, absolute, ..self.settings };
        let (start, length) = times(&interval);
        work.observe(&interval.field(), start, length, &mut x, interval.q, |step| {
            let (start, end) = step.span();
            while next < count && (next as f64) < end * count as f64 {
                let place = next as f64 / count as f64;
                step.interpolate((place - start) / (end - start), &mut between);
                visit(place, &between);
                next += 1;
            }
            ControlFlow::Continue(())
        })?;
        Ok(())
    }

    fn linearise<P: BoundaryProblem>(
        &mut self,
        interval: Interval<P, f64>,
        active: &[usize],
        block: Block,
    ) -> Result<(), LeftDomain> {
        self.linearise_watching(interval, active, block, Watchlist::default(), &mut |_, _, _| {})
    }

    fn linearise_watching<P: BoundaryProblem>(
        &mut self,
        interval: Interval<P, f64>,
        active: &[usize],
        mut block: Block,
        watched: Watchlist,
        visit: &mut dyn FnMut(usize, f64, f64),
    ) -> Result<(), LeftDomain> {
        if !(watched.is_empty() || self.settings.scheme.is_explicit()) {
            self.linearise(interval, active, block)?;
            return self.extrema(interval, watched, None, visit);
        }
        let n = interval.nodes.len() / 2;
        let (settings, interval, block) = (self.present(), &interval, &mut block);
        for (i, row) in block.nodes.chunks_exact_mut(2 * n).enumerate() {
            row[n..].fill(0.0);
            row[n + i] = -1.0;
        }
        let (all, search) = ((active, 0), &mut self.search);
        let lookout = &mut Lookout { watched, search, visit };
        let flowed = match n + active.len() {
            0..=2 => self.two.linearise(settings, interval, all, block, lookout),
            3 => self.three.linearise(settings, interval, all, block, lookout),
            4 => self.four.linearise(settings, interval, all, block, lookout),
            5..=6 => self.six.linearise(settings, interval, all, block, lookout),
            directions => (0..directions).step_by(8).try_for_each(|first| {
                // Trajectories in further directions are the same one.
                if first > 0 {
                    lookout.watched = Watchlist::default();
                }
                self.eight.linearise(settings, interval, (active, first), block, lookout)
            }),
        };
        flowed.and_then(|()| growth(block.nodes, n))
    }

    fn allow(&mut self, error: f64) -> bool {
        self.allowed = error;
        error > 0.0
    }

    fn extrema<P: BoundaryProblem>(
        &mut self,
        interval: Interval<P, f64>,
        watched: Watchlist,
        residual: Option<&mut [f64]>,
        visit: &mut dyn FnMut(usize, f64, f64),
    ) -> Result<(), LeftDomain> {
        let settings = self.present();
        let Shooting { plain, search, x, .. } = self;
        plain.settings = settings;
        let (left, right) = interval.nodes.split_at(interval.nodes.len() / 2);
        let mut lookout = Lookout { watched, search, visit };
        lookout.begin();
        lookout.end(&interval, 0.0, left);
        x.clear();
        x.extend_from_slice(left);
        let (start, length) = times(&interval);
        plain.observe(&interval.field(), start, length, x, interval.q, |step| {
            lookout.real(&interval, step)
        })?;
        lookout.end(&interval, 1.0, x);
        if let Some(r) = residual {
            r.iter_mut().zip(x.iter().zip(right)).for_each(|(r, (x, right))| *r = x - right);
        }
        Ok(())
    }

    fn finer(&self) -> Option<(Self, usize)> {
        // A power of ten remains one.
        let digits = (1.0 / self.settings.relative).round();
        let tolerance = (1.0 / (100.0 * digits)).max(SMALLEST_TOLERANCE);
        let ratio = tolerance / self.settings.relative;
        let absolute = self.settings.absolute * ratio;
        let settings = Settings { relative: tolerance, absolute, ..self.settings };
        (ratio < 1.0).then(|| (Shooting { settings, ..Shooting::default() }, 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::bvp::{Ends, Observable, Span};
    use num_dual::Dual64;

    /// `x'' + c x' + ω² x = a cos t` over a period, as two segments with `k` further parameters of no effect.
    struct Oscillator(usize);

    impl BoundaryProblem for Oscillator {
        fn segments(&self) -> Vec<Vec<String>> {
            vec![vec!["x".into(), "v".into()]; 2]
        }
        fn parameters(&self) -> Vec<String> {
            (0..4 + self.0).map(|k| format!("p{k}")).collect()
        }
        fn field<T: Scalar>(&self, _segment: usize, t: T, x: &[T], q: &[T], f: &mut [T]) {
            f[0] = x[1];
            f[1] = q[2] * t.cos() - q[0] * q[0] * x[0] - q[1] * x[1];
        }
        fn duration<T: Scalar>(&self, segment: usize, q: &[T]) -> T {
            q[3] * (1.0 + segment as f64)
        }
        fn boundary<T: Scalar>(&self, _ends: Ends<T>, _q: &[T], _b: &mut [T]) {}
        fn domain(&self, _segment: usize, x: &[f64], _q: &[f64]) -> Result<(), LeftDomain> {
            if x[0] < 10.0 { Ok(()) } else { Err(LeftDomain::new("x", x[0], "keep it below 10")) }
        }
    }

    const SPAN: Span = Span { segment: 1, start: 0.25, end: 0.75 };
    const NODES: [f64; 4] = [0.3, -0.2, 0.5, 0.1];

    /// Derivatives of the residual by nodes and numbers, in any number of directions, are those of dual
    /// residuals, one direction at a time.
    #[test]
    fn linearisations_of_all_widths_are_derivatives_of_the_residual() {
        for extra in [0, 2, 5, 12] {
            let problem = Oscillator(extra);
            let mut q = vec![1.3, 0.1, 0.4, 2.0];
            q.resize(4 + extra, 0.0);
            for count in 0..=q.len() {
                let active: Vec<usize> = (0..count).rev().collect();
                let mut shooting = Shooting::new(Scheme::DormandPrince8, 1e-10).unwrap();
                let (mut residual, mut nodes) = ([0.0; 2], [f64::NAN; 8]);
                let mut numbers = vec![f64::NAN; 2 * count];
                let block =
                    Block { residual: &mut residual, nodes: &mut nodes, numbers: &mut numbers };
                let interval = Interval { problem: &problem, span: SPAN, nodes: &NODES, q: &q };
                shooting.linearise(interval, &active, block).unwrap();
                for direction in 0..4 + count {
                    let mut dual: Vec<Dual64> = NODES.map(Dual64::from).to_vec();
                    dual.extend(q.iter().map(|q| Dual64::from(*q)));
                    let place = direction.checked_sub(4).map_or(direction, |k| 4 + active[k]);
                    dual[place] = dual[place].derivative();
                    let mut r = [Dual64::from(0.0); 2];
                    let mut work = Flow::default();
                    let (states, q) = dual.split_at(4);
                    let interval = Interval { problem: &problem, span: SPAN, nodes: states, q };
                    shooting.residual(interval, &mut work, &mut r).unwrap();
                    for (i, r) in r.iter().enumerate() {
                        let part = match direction.checked_sub(4) {
                            None => nodes[i * 4 + direction],
                            Some(k) => numbers[i * count + k],
                        };
                        assert!((r.re - residual[i]).abs() < 1e-14);
                        assert!((r.eps - part).abs() < 1e-12, "{direction}: {} {part}", r.eps);
                    }
                }
            }
        }
    }

    /// `x = cos t` (ω = 1, no damping, no force) from the middle of a segment of duration 8: its value within
    /// an interval, its extrema at π and 2π between `t = 2` and `t = 7`, and its rise at 3π/2.
    #[test]
    fn values_and_extrema_are_those_of_the_trajectory() {
        let (problem, q) = (Oscillator(0), [1.0, 0.0, 0.0, 4.0]);
        let span = Span { segment: 1, start: 0.25, end: 0.875 };
        let nodes = [2f64.cos(), -2f64.sin(), 7f64.cos(), -7f64.sin()];
        let mut shooting = Shooting::default();
        let (mut x, mut work) = ([0.0; 2], Flow::default());
        let interval = Interval { problem: &problem, span, nodes: &nodes, q: &q };
        shooting.residual(interval, &mut work, &mut x).unwrap();
        assert!(x[0].abs().max(x[1].abs()) < 2e-12, "{x:?}");
        for place in [0.0, 0.3, 1.0] {
            shooting.value(interval, place, &mut work, &mut x).unwrap();
            let t = 2.0 + 5.0 * place;
            assert!((x[0] - t.cos()).abs() < 2e-12 && (x[1] + t.sin()).abs() < 2e-12);
        }
        let mut all = [Vec::new(), Vec::new()];
        let mut visit = |k: usize, place, value| all[k].push((2.0 + 5.0 * place, value));
        let through = [[Observable::State(0), Observable::State(1)]];
        let watched = Watchlist { extrema: &[Observable::State(0)], rises: &through };
        shooting.extrema(interval, watched, None, &mut visit).unwrap();
        let [found, risen] = all;
        let (time, speed) = risen[0];
        assert!((time - 1.5 * std::f64::consts::PI).abs() < 1e-11 && (speed - 1.0).abs() < 2e-12);
        let exact = [2.0, std::f64::consts::PI, std::f64::consts::TAU, 7.0];
        assert_eq!(found.len(), exact.len(), "{found:?}");
        for ((t, x), exact) in found.iter().zip(exact) {
            // An error of the place moves the value by its square.
            assert!((t - exact).abs() < 1e-10 && (x - exact.cos()).abs() < 2e-12, "{t} {x}");
        }
    }

    #[test]
    fn finer_shooting_ends_where_rounding_begins() {
        let mut shooting = Shooting::new(Scheme::DormandPrince8, 1e-9).unwrap();
        let mut tolerances = Vec::new();
        while let Some((finer, 1)) = shooting.finer() {
            tolerances.push(finer.settings.relative);
            shooting = finer;
        }
        let expected = [1e-11, 1e-13, 1e-14];
        assert_eq!(tolerances.len(), 3);
        assert!(tolerances.iter().zip(expected).all(|(a, b)| (a / b - 1.0).abs() < 1e-12));
    }

    #[test]
    fn leaving_the_domain_is_an_error_of_every_evaluation() {
        let (problem, q, nodes) = (Oscillator(0), [1.0, 0.0, 1e3, 2.0], [9.0, 9.0, 0.0, 0.0]);
        let mut shooting = Shooting::default();
        let (mut x, mut work) = ([0.0; 2], Flow::default());
        let interval = Interval { problem: &problem, span: SPAN, nodes: &nodes, q: &q };
        let error = shooting.residual(interval, &mut work, &mut x).unwrap_err();
        assert!(error.quantity.starts_with("x at t = "), "{error}");
        let (mut nodes_part, mut r) = ([0.0; 8], [0.0; 2]);
        let block = Block { residual: &mut r, nodes: &mut nodes_part, numbers: &mut [] };
        let linear = shooting.linearise(interval, &[], block).unwrap_err();
        assert_eq!(error, linear);
    }
}
