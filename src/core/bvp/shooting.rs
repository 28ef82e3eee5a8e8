//! Shooting: the trajectory of an interval is flowed from its left end.

use super::method::{Block, Method, Span};
use super::problem::{BoundaryProblem, OnSegment};
use crate::core::flow::{Extrema, Flow, Scheme, Settings, SettingsError};
use crate::core::scalar::Scalar;
use crate::core::zero::LeftDomain;
use num_dual::DualSVec64;
use std::ops::ControlFlow;

/// Tolerances are not made smaller than this: rounding errors of a flow are of this size.
const SMALLEST_TOLERANCE: f64 = 1e-14;

/// Shooting: the residual of an interval is `φ(x_left) − x_right`, with the flow `φ` from its start to its
/// end. Several intervals make it multiple shooting, for trajectories along which errors grow.
///
/// Derivatives by the left states and all active numbers come from one flow of dual numbers that takes the same
/// steps as that of real numbers, so that residual and Jacobian belong together.
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
    two: Variation<2>,
    three: Variation<3>,
    four: Variation<4>,
    six: Variation<6>,
    eight: Variation<8>,
    plain: Flow<f64>,
    extrema: Extrema<f64>,
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
}

impl Default for Shooting {
    /// The method of order 8 with a tolerance of 1e-12.
    fn default() -> Self {
        Shooting {
            settings: Settings::default(),
            two: Variation::default(),
            three: Variation::default(),
            four: Variation::default(),
            six: Variation::default(),
            eight: Variation::default(),
            plain: Flow::default(),
            extrema: Extrema::of(0),
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

/// A flow from the start of a span to a place in it, `x` being the states there.
fn flow_to<P: BoundaryProblem, T: Scalar>(
    flow: &mut Flow<T>,
    problem: &P,
    span: Span,
    place: f64,
    q: &[T],
    x: &mut [T],
) -> Result<(), LeftDomain> {
    let field = OnSegment { problem, segment: span.segment };
    let duration = problem.duration(span.segment, q);
    let length = duration * ((span.end - span.start) * place);
    flow.advance(&field, duration * span.start, length, x, q)?;
    Ok(())
}

/// A flow with derivatives in `N` directions.
struct Variation<const N: usize> {
    flow: Flow<DualSVec64<N>>,
    x: Vec<DualSVec64<N>>,
    q: Vec<DualSVec64<N>>,
}

impl<const N: usize> Default for Variation<N> {
    fn default() -> Self {
        Variation { flow: Flow::default(), x: Vec::new(), q: Vec::new() }
    }
}

/// An interval to be linearised: where it is, and in which directions.
struct Interval<'a, P> {
    problem: &'a P,
    span: Span,
    nodes: &'a [f64],
    q: &'a [f64],
    active: &'a [usize],
}

impl<const N: usize> Variation<N> {
    /// Writes the end of the flow, and its derivatives by the directions from `first` on: the left states,
    /// then the active numbers.
    fn linearise<P: BoundaryProblem>(
        &mut self,
        settings: Settings,
        interval: &Interval<P>,
        first: usize,
        block: &mut Block,
    ) -> Result<(), LeftDomain> {
        let Interval { problem, span, nodes, q, active } = interval;
        let n = nodes.len() / 2;
        let seeded = |value: f64, direction: usize| {
            let number = DualSVec64::<N>::from(value);
            let inside = (first..first + N).contains(&direction);
            if inside { number.derivative(direction - first) } else { number }
        };
        self.x.clear();
        self.x.extend(nodes[..n].iter().enumerate().map(|(i, x)| seeded(*x, i)));
        self.q.clear();
        self.q.extend(q.iter().map(|q| DualSVec64::from(*q)));
        for (k, number) in active.iter().enumerate() {
            self.q[*number] = seeded(q[*number], n + k);
        }
        self.flow.settings = settings;
        flow_to(&mut self.flow, *problem, *span, 1.0, &self.q, &mut self.x)?;
        for (i, x) in self.x.iter().enumerate() {
            block.residual[i] = x.re - nodes[n + i];
            for direction in first..(first + N).min(n + active.len()) {
                let part = x.eps.0.map_or(0.0, |eps| eps[direction - first]);
                match direction.checked_sub(n) {
                    None => block.nodes[i * 2 * n + direction] = part,
                    Some(k) => block.numbers[i * active.len() + k] = part,
                }
            }
        }
        Ok(())
    }
}

impl Method for Shooting {
    type Work<T: Scalar> = Flow<T>;

    fn places(&self) -> &[f64] {
        &[0.0, 1.0]
    }

    fn residual<P: BoundaryProblem, T: Scalar>(
        &self,
        problem: &P,
        span: Span,
        nodes: &[T],
        q: &[T],
        work: &mut Flow<T>,
        r: &mut [T],
    ) -> Result<(), LeftDomain> {
        let (left, right) = nodes.split_at(nodes.len() / 2);
        r.copy_from_slice(left);
        work.settings = self.settings;
        flow_to(work, problem, span, 1.0, q, r)?;
        r.iter_mut().zip(right).for_each(|(r, right)| *r -= *right);
        Ok(())
    }

    fn value<P: BoundaryProblem, T: Scalar>(
        &self,
        problem: &P,
        span: Span,
        nodes: &[T],
        q: &[T],
        place: f64,
        work: &mut Flow<T>,
        x: &mut [T],
    ) -> Result<(), LeftDomain> {
        x.copy_from_slice(&nodes[..x.len()]);
        work.settings = self.settings;
        if place == 0.0 { Ok(()) } else { flow_to(work, problem, span, place, q, x) }
    }

    fn linearise<P: BoundaryProblem>(
        &mut self,
        problem: &P,
        span: Span,
        nodes: &[f64],
        q: &[f64],
        active: &[usize],
        mut block: Block,
    ) -> Result<(), LeftDomain> {
        let n = nodes.len() / 2;
        let (settings, block) = (self.settings, &mut block);
        for (i, row) in block.nodes.chunks_exact_mut(2 * n).enumerate() {
            row[n..].fill(0.0);
            row[n + i] = -1.0;
        }
        let interval = Interval { problem, span, nodes, q, active };
        match n + active.len() {
            0..=2 => self.two.linearise(settings, &interval, 0, block),
            3 => self.three.linearise(settings, &interval, 0, block),
            4 => self.four.linearise(settings, &interval, 0, block),
            5..=6 => self.six.linearise(settings, &interval, 0, block),
            directions => (0..directions)
                .step_by(8)
                .try_for_each(|first| self.eight.linearise(settings, &interval, first, block)),
        }
    }

    fn extrema<P: BoundaryProblem>(
        &mut self,
        problem: &P,
        span: Span,
        nodes: &[f64],
        q: &[f64],
        state: usize,
        visit: &mut dyn FnMut(f64, f64),
    ) -> Result<(), LeftDomain> {
        let Shooting { plain, extrema, x, .. } = self;
        plain.settings = self.settings;
        extrema.restart(state);
        x.clear();
        x.extend_from_slice(&nodes[..nodes.len() / 2]);
        visit(0.0, x[state]);
        let field = OnSegment { problem, segment: span.segment };
        let duration = problem.duration(span.segment, q);
        let length = duration * (span.end - span.start);
        plain.observe(&field, duration * span.start, length, x, q, |step| {
            extrema.search(step, |extremum| visit(extremum.place, extremum.value));
            ControlFlow::Continue(())
        })?;
        visit(1.0, x[state]);
        Ok(())
    }

    fn finer(&self) -> Option<(Self, usize)> {
        let tolerance = (self.settings.relative / 100.0).max(SMALLEST_TOLERANCE);
        let ratio = tolerance / self.settings.relative;
        let absolute = self.settings.absolute * ratio;
        let settings = Settings { relative: tolerance, absolute, ..self.settings };
        (ratio < 1.0).then(|| (Shooting { settings, ..Shooting::default() }, 1))
    }
}
