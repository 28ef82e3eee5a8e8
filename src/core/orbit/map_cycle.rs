//! Cycles of maps as zero problems.

use crate::core::cancel::CancelToken;
use crate::core::failure::{DIFFERENTIABLE, Failure, finite, finite_gradient, unknown_order};
use crate::core::linalg::{
    Blocks, Border, CondensedLu, Cycle, Factors, Form, RotatedLu, Spectrum, SpectrumRequest,
    differ, difference, largest, refill,
};
use crate::core::problem::{DiscreteMap, Dynamics, Group, Names, ROOM};
use crate::core::scalar::{CHUNK, Chunk, Directional, Jet, Scalar, Space, seeded};
use crate::core::system::{
    Deviation, Discretised, Effort, Expansion, Functional, Kind, Refinement, Site, Solution, Start,
    System, mixed, moving, third,
};
use num_dual::{Dual, Dual2, Dual64};
use std::sync::Arc;

/// The cycles of a map: `x_{k+1} = f(x_k, p)`, `k = 0 … K − 1`, `x_K = x_0`; with `K = 1` its fixed
/// points.
///
/// The unknowns are the states of all iterates, `K` values for each state; the elements of an array
/// of states form one group of unknowns. The Jacobian is block-cyclic: a point on a branch costs
/// O(K n³) in time and O(K n²) in memory.
///
/// Cycles of maps support the same computations as periodic orbits: multipliers, folds, period
/// doublings, torus (Neimark–Sacker) bifurcations, and the curves of these bifurcations. A branch
/// of cycles with twice as many iterates
/// [emanates](crate::core::continuation::Continuation::switch) from a period doubling. The monitors
/// are the extremes of each state, and of each monitor of the map, over all iterates of the cycle.
///
/// ```
/// use tangency::prelude::*;
/// use tangency::core::{orbit::MapCycle, problem::DiscreteMap};
/// /// Hénon's map `x ↦ 1 − a x² + y`, `y ↦ b x`.
/// struct Henon;
/// impl DiscreteMap for Henon {
///     fn names(&self) -> Names {
///         Names::new(["x", "y"], ["a", "b"])
///     }
///     fn next<T: Scalar>(&self, x: &[T], p: &[T], next: &mut [T]) {
///         next[0] = x[1] + 1.0 - p[0] * x[0] * x[0];
///         next[1] = p[1] * x[0];
///     }
/// }
/// let mut points = MapCycle::of(Henon, 1);
/// let branch = Continuation::new(&mut points).at("b", 0.3).along("a", 0.0..=1.0).trace()?;
/// // Its fixed points double their period at a = 3 (1 − b)²/4.
/// let doubling = branch.of_kind(Kind::PD).next().expect("a period doubling");
/// assert!((doubling.parameters[0] - 0.75 * 0.49).abs() < 1e-13);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct MapCycle<M> {
    equations: Iterates<M>,
    names: Names,
    /// For each iterate, `n` rows of the `2n` derivatives with respect to `x_k` and `x_{k+1}`,
    /// evaluated at the point `assembled`.
    blocks: Vec<f64>,
    /// The point at which the blocks were last assembled; empty if the assembly failed.
    assembled: Vec<f64>,
    cycle: Cycle,
    /// The typical sizes of the states at both ends of the condensed chain; empty if unknown.
    end_units: Vec<f64>,
    cancel: CancelToken,
    plain: Iterate<f64>,
    chunk: Iterate<Chunk>,
    first: Iterate<Dual64>,
    /// The workspace for jets, allocated at the first use.
    jets: Option<Iterate<Jet<ROOM>>>,
    nested: Iterate<Dual<Chunk>>,
    nested_twice: Iterate<Dual2<Chunk>>,
}

/// The equations of a cycle of a map.
struct Iterates<M> {
    map: Arc<M>,
    /// The number `n` of states and the number `K` of iterates.
    states: usize,
    count: usize,
}

/// Heuristic: the iterates of a map count as repeating if they differ by less than this fraction of
/// the largest state; Newton's method then converges to the cycle.
const REPEATS: f64 = 1e-6;

/// Heuristic: the halves of a cycle count as equal, up to the error of a special point, if their
/// difference is less than this fraction of the difference at the previous point of the branch. The
/// sizes of the states cannot serve as the unit of the difference between the halves, since cycles
/// may shrink to a fixed point at 0.
const SHRUNK: f64 = 1e-3;

/// Heuristic: the halves of a converged cycle count as equal if they differ by less than this
/// fraction of their size.
const TWICE: f64 = 1e-6;

/// Buffers for the arguments and values of a map in one scalar type.
#[derive(Clone)]
struct Iterate<T> {
    x: Vec<T>,
    p: Vec<T>,
    next: Vec<T>,
}

impl<T: Scalar> Iterate<T> {
    fn new(names: &Names) -> Self {
        let zeros = |length: usize| vec![T::zero(); length];
        let n = names.unknowns.iter().map(Group::count).sum();
        Iterate { x: zeros(n), p: zeros(names.parameters.len()), next: zeros(n) }
    }

    fn take_parameters(&mut self, parameter: impl Fn(usize) -> T) {
        self.p.iter_mut().enumerate().for_each(|(j, p)| *p = parameter(j));
    }

    /// Computes the image of a state whose components are given by a function.
    fn next<M: DiscreteMap>(&mut self, map: &M, state: impl Fn(usize) -> T) -> &[T] {
        self.x.iter_mut().enumerate().for_each(|(i, x)| *x = state(i));
        map.next(&self.x, &self.p, &mut self.next);
        &self.next
    }
}

impl<M: DiscreteMap> MapCycle<M> {
    /// The maximal number of iterates of a cycle that [`settled`](Self::settled) searches for.
    pub const LONGEST: usize = 64;

    /// Creates the problem of cycles of a map with a given number of iterates, at least 1.
    pub fn of(map: M, iterates: usize) -> Self {
        Self::shared(Arc::new(map), iterates)
    }

    /// Creates the problem of cycles of a map that is shared with other problems.
    pub fn shared(map: Arc<M>, iterates: usize) -> Self {
        let (own, iterates) = (map.names(), iterates.max(1));
        let n = own.dimension();
        let scalars = own.elements().chain(own.monitors.iter().cloned());
        let monitors = scalars.flat_map(|name| match iterates {
            1 => vec![name.clone()],
            _ => vec![format!("max_{name}"), format!("min_{name}")],
        });
        let group = |state: &Group| state.clone().on_mesh(iterates);
        let names = Names::new(own.unknowns.iter().map(group), own.parameters.clone())
            .with_defaults(map.defaults())
            .with_monitors(monitors);
        let order = (0..iterates * n).map(|e| e % n * iterates + e / n).collect();
        MapCycle {
            blocks: vec![0.0; 2 * n * n * iterates],
            assembled: Vec::with_capacity(names.length()),
            cycle: Cycle::new(n, order),
            end_units: Vec::with_capacity(2 * n),
            cancel: CancelToken::default(),
            plain: Iterate::new(&names),
            chunk: Iterate::new(&names),
            first: Iterate::new(&names),
            jets: None,
            nested: Iterate::new(&names),
            nested_twice: Iterate::new(&names),
            equations: Iterates { map, states: n, count: iterates },
            names,
        }
    }

    /// Iterates the map from a state until the iterates repeat with a period of at most
    /// [`LONGEST`](Self::LONGEST), after a transient, and returns the problem and the unknowns of
    /// the stable cycle.
    ///
    /// # Errors
    /// [`Failure::Mismatch`] if the iterates do not repeat after at most [`LONGEST`](Self::LONGEST)
    /// iterates.
    pub fn settled(
        map: Arc<M>,
        start: &[f64],
        transient: usize,
        p: &[f64],
    ) -> Result<(Self, Vec<f64>), Failure> {
        let (n, mut x) = (start.len(), start.to_vec());
        let mut next = x.clone();
        let mut step = |x: &mut Vec<f64>| {
            map.next(x, p, &mut next);
            std::mem::swap(x, &mut next);
        };
        (0..transient).for_each(|_| step(&mut x));
        let mut states = x.clone();
        let mut nearest = f64::INFINITY;
        // States without a scale that tend to zero are compared with the smallest positive number.
        let mut sizes = map.scales(p);
        sizes.resize(n, f64::MIN_POSITIVE);
        for iterates in 1..=Self::LONGEST {
            step(&mut x);
            sizes.iter_mut().zip(&x).for_each(|(size, x)| *size = size.max(x.abs()));
            let pairs = x.iter().zip(&states[..n]).zip(&sizes);
            let away = pairs.map(|((x, first), size)| (x - first).abs() / size);
            let away = away.fold(0.0, f64::max);
            if !x.iter().all(|x| x.is_finite()) {
                return Err(Failure::Mismatch(format!(
                    "iterates grow without bound after {transient}"
                )));
            }
            if away <= REPEATS {
                let cycles = Self::shared(map.clone(), iterates);
                let z = cycles.unknowns(&states);
                return Ok((cycles, z));
            }
            nearest = nearest.min(away);
            states.extend_from_slice(&x);
        }
        Err(Failure::Mismatch(format!(
            "no cycle of up to {} iterates was found after {transient}: the smallest distance \
             between iterates is {nearest:.1e}, above the tolerance {REPEATS:.1e}; simulate longer \
             (`transient`), or start at another state if the motion is not periodic",
            Self::LONGEST
        )))
    }

    /// Converts the states of a cycle, given iterate by iterate, to the vector of unknowns.
    ///
    /// # Panics
    /// Panics if the length of `states` is not the number of iterates times the number `n` of
    /// states.
    pub fn unknowns(&self, states: &[f64]) -> Vec<f64> {
        let n = self.equations.states;
        let of_state = |i: usize| states.iter().skip(i).step_by(n);
        assert_eq!(states.len(), self.names.dimension(), "the states of all iterates");
        (0..n).flat_map(of_state).copied().collect()
    }
}

impl<M: DiscreteMap> Iterates<M> {
    /// Returns the index, in the vector of unknowns, of a state after `k` iterates.
    fn at(&self, k: usize, state: usize) -> usize {
        state * self.count + k % self.count
    }

    /// Evaluates one part (the real part or a derivative, as selected by `part`) of the residuals
    /// `x_{k+1} − f(x_k, p)`, iterate by iterate; the function `argument` returns the components of
    /// `x = (z, p)`.
    fn evaluate<T: Scalar>(
        &self,
        work: &mut Iterate<T>,
        argument: impl Fn(usize) -> T,
        part: fn(&T) -> f64,
        out: &mut [f64],
    ) {
        let n = self.states;
        work.take_parameters(|j| argument(n * self.count + j));
        for (k, out) in out.chunks_exact_mut(n).enumerate() {
            let next = work.next(&*self.map, |i| argument(self.at(k, i)));
            for (i, (out, next)) in out.iter_mut().zip(next).enumerate() {
                *out = part(&argument(self.at(k + 1, i))) - part(next);
            }
        }
    }

    /// Evaluates the residuals with jets.
    fn on_jets(&self, work: &mut Iterate<Jet<ROOM>>, at: &Expansion) -> Vec<Jet<ROOM>> {
        let n = self.states;
        work.take_parameters(|j| at.argument(n * self.count + j));
        let mut left = Vec::new();
        for k in 0..self.count {
            let next = work.next(&*self.map, |i| at.argument(self.at(k, i)));
            let next = next.iter().enumerate();
            left.extend(next.map(|(i, next)| at.argument(self.at(k + 1, i)) - *next));
        }
        left
    }

    /// Adds to `out` the gradient of the directional derivative of `wᵀ F` along `v`; the gradient
    /// is taken with respect to the unknowns and the released parameters. Only the nonlinear part
    /// of `wᵀ F`, which is `−wᵀ f`, contributes to the gradient.
    fn add_gradient<T: Directional>(
        &self,
        work: &mut Iterate<T>,
        x: &[f64],
        (w, v): (&[f64], &[f64]),
        released: &[usize],
        out: &mut [f64],
    ) {
        let (n, parameters) = (self.states, self.states * self.count);
        for start in (0..n + released.len()).step_by(CHUNK) {
            let seed = |z: usize, direction: usize| T::along(seeded(x[z], direction, start), v[z]);
            let direction = |j: usize| released.iter().position(|p| *p == j);
            work.take_parameters(|j| {
                seed(parameters + j, direction(j).map_or(usize::MAX, |d| n + d))
            });
            for (k, w) in w.chunks_exact(n).enumerate() {
                let next = work.next(&*self.map, |i| seed(self.at(k, i), i));
                let mut slopes = [0.0; CHUNK];
                for (next, w) in next.iter().zip(w) {
                    let parts = slopes.iter_mut().zip(next.derivative().eps);
                    parts.for_each(|(slope, part)| *slope -= w * part);
                }
                for (d, slope) in (start..n + released.len()).zip(slopes) {
                    let z = d.checked_sub(n).map_or(self.at(k, d), |d| parameters + released[d]);
                    out[z] += slope;
                }
            }
        }
    }

    /// Returns the index of the scalar that a monitor refers to, and 1 if the monitor is the maximum
    /// of the scalar, −1 if it is the minimum. A fixed point has one monitor per scalar, the maximum.
    fn scalar(&self, monitor: usize) -> (usize, f64) {
        match self.count {
            1 => (monitor, 1.0),
            _ => (monitor / 2, if monitor.is_multiple_of(2) { 1.0 } else { -1.0 }),
        }
    }

    /// Returns the iterate at which a monitor attains its value, and this value. The argument
    /// `state` is scratch space.
    fn extreme(&self, monitor: usize, x: &[f64], state: &mut [f64]) -> (usize, f64) {
        let (scalar, sign) = self.scalar(monitor);
        let (z, p) = x.split_at(self.states * self.count);
        let value = |k: usize| {
            if scalar < self.states {
                return z[self.at(k, scalar)];
            }
            state.iter_mut().enumerate().for_each(|(i, x)| *x = z[self.at(k, i)]);
            self.map.monitor(scalar - self.states, state, p)
        };
        // NaN values are propagated.
        let larger = |a: (usize, f64), b: (usize, f64)| {
            if sign * b.1 > sign * a.1 || b.1.is_nan() { b } else { a }
        };
        (0..self.count).map(value).enumerate().reduce(larger).unwrap_or((0, f64::NAN))
    }
}

impl<M: DiscreteMap> MapCycle<M> {
    /// Computes the gradient of a monitor into `out`, which must be zero on entry.
    fn monitor_gradient(&mut self, monitor: usize, x: &[f64], out: &mut [f64]) {
        let (equations, work, dimension) =
            (&self.equations, &mut self.chunk, self.names.dimension());
        let (k, _) = equations.extreme(monitor, x, &mut self.plain.x);
        let (n, (scalar, _)) = (equations.states, equations.scalar(monitor));
        let Some(scalar) = scalar.checked_sub(n) else {
            out[equations.at(k, scalar)] = 1.0;
            return;
        };
        let directions = n + self.names.parameters.len();
        for start in (0..directions).step_by(CHUNK) {
            work.take_parameters(|j| seeded(x[dimension + j], n + j, start));
            let states = work.x.iter_mut().enumerate();
            states.for_each(|(i, state)| *state = seeded(x[equations.at(k, i)], i, start));
            let slopes = equations.map.monitor(scalar, &work.x, &work.p).eps;
            for (d, slope) in (start..directions).zip(slopes) {
                out[d.checked_sub(n).map_or(equations.at(k, d), |j| dimension + j)] = slope;
            }
        }
    }
}

impl<M: DiscreteMap + 'static> System for MapCycle<M> {
    fn names(&self) -> &Names {
        &self.names
    }

    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<(), Failure> {
        self.cancel.check()?;
        self.equations.evaluate(&mut self.plain, |i| x[i], |r| *r, r);
        let states = self.equations.states;
        finite(
            r,
            |e| format!("component {} of the map at iterate {}", e % states, e / states),
            "the values of the map must be finite: bound the branch to the domain of the map",
        )
    }

    fn assemble(&mut self, x: &[f64]) -> Result<(), Failure> {
        if self.assembled == x {
            return Ok(());
        }
        self.cancel.check()?;
        self.assembled.clear();
        let (equations, work, n) = (&self.equations, &mut self.chunk, self.equations.states);
        let parameters = &x[self.names.dimension()..];
        work.take_parameters(|j| Chunk::from(parameters[j]));
        for (k, block) in self.blocks.chunks_exact_mut(2 * n * n).enumerate() {
            for start in (0..n).step_by(CHUNK) {
                let next = work.next(&*equations.map, |i| seeded(x[equations.at(k, i)], i, start));
                for (row, next) in block.chunks_exact_mut(2 * n).zip(next) {
                    let entries = row[start..n].iter_mut().zip(next.eps);
                    entries.for_each(|(entry, slope)| *entry = -slope);
                }
            }
            (0..n).for_each(|i| block[(2 * i + 1) * n + i] = 1.0);
        }
        let name = |e: usize| {
            let (row, column) = (e / (2 * n), e % (2 * n));
            format!(
                "the derivative of component {} of the map with respect to {column} at iterate {}",
                row % n,
                row / n
            )
        };
        finite(&self.blocks, name, DIFFERENTIABLE)?;
        self.assembled.extend_from_slice(x);
        Ok(())
    }

    fn factor(&mut self, form: Form, border: Border, into: &mut Factors) -> Result<(), Failure> {
        // The states at both ends of the condensed chain. If the units differ little, pivots are
        // chosen by the entries alone.
        let known = if differ(border.units) { border.units } else { &[] };
        let of_states = known.iter().step_by(self.equations.count);
        refill(&mut self.end_units, of_states.clone().chain(of_states).copied());
        let (size, blocks, cancel) = (self.names.dimension(), &self.blocks, &self.cancel);
        let units = &self.end_units;
        let mu = match form {
            Form::Jacobian => 1.0,
            Form::Antiperiodic => -1.0,
            Form::Oscillation(_) if border.width != 1 => {
                let reason = "the complex linearisation of cycles supports only borders of width 1";
                return Err(Failure::Unsupported(reason.into()));
            }
            Form::Oscillation(omega) => {
                let fits = |known: &RotatedLu<Cycle>| known.condensed.fits(size);
                let lu = into.reuse(fits, || RotatedLu::new(self.cycle.another()));
                let of = Blocks { blocks, border: RotatedLu::<Cycle>::border(border), cancel };
                return lu.factor(of, omega, units);
            }
        };
        let fits = |known: &CondensedLu<Cycle>| known.condensed.fits(size);
        let lu = into.reuse(fits, || CondensedLu::new(self.cycle.another()));
        let of = Blocks { blocks, border, cancel };
        lu.factor(of, mu, units)
    }

    fn derivative(
        &mut self,
        x: &[f64],
        directions: &[&[f64]],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        match *directions {
            [d] => {
                self.equations.evaluate(
                    &mut self.first,
                    |i| Dual64::new(x[i], d[i]),
                    |r| r.eps,
                    out,
                );
            }
            [d, e] => {
                let argument = |i: usize| moving(x[i], d[i], e[i]);
                self.equations.evaluate(&mut self.nested, argument, mixed, out);
            }
            [d, e, f] => third([d, e, f], out, |v, w, out| {
                let argument = |i: usize| moving(x[i], v[i], w[i]);
                self.equations.evaluate(&mut self.nested_twice, argument, mixed, out);
                Ok(())
            })?,
            _ => return Err(unknown_order(directions.len())),
        }
        finite(out, |e| format!("a derivative of component {e} of the residual"), DIFFERENTIABLE)
    }

    fn gradient(
        &mut self,
        x: &[f64],
        of: Functional,
        released: &[usize],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        out.fill(0.0);
        match of {
            Functional::First(w, v) => {
                self.equations.add_gradient(&mut self.nested, x, (w, v), released, out);
            }
            Functional::Second(w, v) => {
                self.equations.add_gradient(&mut self.nested_twice, x, (w, v), released, out);
            }
            Functional::Monitor(monitor) => self.monitor_gradient(monitor, x, out),
        }
        finite_gradient(out, self.names.dimension(), released)
    }

    fn dynamics(&self) -> Dynamics {
        Dynamics::Periodic
    }

    fn expand(
        &mut self,
        x: &[f64],
        space: &'static Space,
        terms: &[Vec<f64>],
    ) -> Result<Vec<Vec<f64>>, Failure> {
        let names = &self.names;
        let work = self.jets.get_or_insert_with(|| Iterate::new(names));
        let expansion = Expansion::new(x, space, terms)?;
        expansion.images(&self.equations.on_jets(work, &expansion))
    }

    fn spectrum(&mut self, _: &[f64], _: SpectrumRequest) -> Result<Option<Spectrum>, Failure> {
        let MapCycle { blocks, cancel, .. } = self;
        let of = Blocks { blocks, border: Border::NONE, cancel };
        self.cycle.multipliers(of).map(Some)
    }

    fn deviation(&mut self, _x: &[f64], d: &[f64]) -> Result<Deviation, Failure> {
        let square: f64 = d[..self.names.dimension()].iter().map(|d| d * d).sum();
        let square = square / self.equations.count as f64;
        Ok(Deviation { square, ..Deviation::default() })
    }

    fn unknown_scales(&self, p: &[f64]) -> Vec<f64> {
        self.names.sizes_of_groups(&self.equations.map.scales(p))
    }

    fn monitors(&mut self, x: &[f64], first: usize, values: &mut [f64]) -> Result<(), Failure> {
        for (monitor, value) in (first..).zip(&mut *values) {
            *value = self.equations.extreme(monitor, x, &mut self.plain.x).1;
        }
        let name = |k: usize| format!("monitor {}", self.names.monitors[first + k]);
        finite(values, name, "a monitor must be finite wherever the map is finite")
    }

    /// Resumes from a cycle with any number of iterates. At a period doubling, branch switching
    /// repeats the cycle twice; at the end of a branch of doubled cycles, branch switching halves
    /// the cycle.
    fn resume_from(&mut self, solution: &Solution) -> Result<Start, Failure> {
        let (n, length) = (self.equations.states, solution.state.len());
        if length == 0 || !length.is_multiple_of(n) {
            return Err(Failure::Mismatch(format!(
                "the start has {length} unknowns, but their number must be a multiple of {n}, the \
                 number of states of the map: was the start computed with another problem?"
            )));
        }
        let (once, at_doubling) = (length / n, solution.kind == Kind::PD);
        let reach = solution.tangent.as_ref().map_or(0.0, |(z, _)| largest(z));
        let halves = |state: &[f64]| {
            let (first, second) = state.split_at(once / 2);
            largest(&difference(first, second)) <= TWICE * largest(first).max(reach)
        };
        let repeats =
            at_doubling && once.is_multiple_of(2) && solution.state.chunks_exact(once).all(halves);
        let doubled = solution.beside.is_some() || at_doubling && solution.switch.is_some();
        if at_doubling && doubled && repeats {
            *self = MapCycle::shared(self.equations.map.clone(), once / 2);
            let first = solution.state.chunks_exact(once).flat_map(|state| &state[..once / 2]);
            let start = Start::point(first.copied().collect(), None);
            return Ok(Start { site: Site::OtherBranch, ..start });
        }
        let times = if doubled { 2 } else { 1 };
        if once * times != self.equations.count {
            *self = MapCycle::shared(self.equations.map.clone(), once * times);
        }
        let repeated = |z: &[f64]| -> Vec<f64> {
            z.chunks_exact(once).flat_map(|state| state.repeat(times)).collect()
        };
        let tangent = solution.tangent.as_ref().map(|(z, p)| [&repeated(z)[..], p].concat());
        // A branch of doubled cycles ends where it meets the branch of cycles from which it
        // emanates.
        let one_sided = doubled || repeats;
        let site = if one_sided { Site::BranchPoint } else { Site::Point };
        let start = Start::point(repeated(&solution.state), tangent);
        Ok(Start { site, one_sided, ..start })
    }

    fn discretised(&mut self) -> Option<&mut dyn Discretised> {
        Some(self)
    }
}

impl<M: DiscreteMap + 'static> Discretised for MapCycle<M> {
    fn refined(&mut self, _x: &[f64]) -> Option<Refinement> {
        None
    }

    fn is_refinable(&self) -> bool {
        false
    }

    fn set_effort(&mut self, effort: Effort) {
        self.cancel.clone_from(effort.cancel);
    }

    fn duplicate(&self) -> Option<Box<dyn System>> {
        Some(Box::new(MapCycle::shared(self.equations.map.clone(), self.equations.count)))
    }

    fn difference_of_halves(&mut self, x: &[f64]) -> Option<Vec<f64>> {
        let (count, n) = (self.equations.count, self.names.dimension());
        let halves = x[..n].chunks_exact(count).map(|state| state.split_at(count / 2));
        count.is_multiple_of(2).then(|| halves.flat_map(|(a, b)| difference(a, b)).collect())
    }

    fn repeats(&mut self, x: &[f64], beside: &[f64]) -> bool {
        let (count, n) = (self.equations.count, self.names.dimension());
        let differences = |x: &[f64]| -> Vec<f64> {
            let halves = x[..n].chunks_exact(count).map(|state| state.split_at(count / 2));
            halves.map(|(a, b)| largest(&difference(a, b))).collect()
        };
        if !count.is_multiple_of(2) {
            return false;
        }
        let (here, there) = (differences(x), differences(beside));
        let differs = there.iter().any(|there| *there > 0.0);
        differs && here.iter().zip(&there).all(|(here, there)| *here <= SHRUNK * there)
    }
}
