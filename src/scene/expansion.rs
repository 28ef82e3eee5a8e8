//! Taylor expansions of two curves that emanate from a grazing point of codimension two: a curve of
//! folds and a curve of period doublings.
//!
//! An orbit with one impact solves `F = P(D(z, p), p) − ξ(z, p) = 0`, where `ξ` is the virtual
//! point that corresponds to `z` (its `y` and its other coordinates). Such an orbit has the Floquet
//! multiplier `μ` if a vector `v` satisfies
//!
//! ```text
//!     (∂[P ∘ D]/∂z − μ ∂ξ/∂z) v = 0,    ⟨c, v⟩ = 1.
//! ```
//!
//! The equation of the orbit and the equation of its multiplier are both regular at `y = 0`.
//! Suppose that the derivative of the smooth map maps `β` to a vector without a component in the
//! normal direction (`∂P/∂θ = 0` in one phase). Then the point `y = 0` solves both equations for `μ
//! = 1` and for `μ = −1`, so that a curve of folds and a curve of period doublings emanate from
//! this point. If one parameter is a jet (a truncated Taylor series), Newton's iteration for `z`,
//! `v` and another parameter yields the Taylor series of the curve, one term per iteration.

use crate::core::failure::Failure;
use crate::core::linalg::{Border, BorderedLu};
use crate::core::local_map::LocalMap;
use crate::core::problem::{Dynamics, Names, UnknownName, ZeroProblem, position};
use crate::core::scalar::{Jet, JetError, Scalar, Space};
use crate::core::system::Kind;
use num_dual::{Dual, Dual64, DualNum};

/// The Taylor series `Δp₁ = Σ c_k Δp₂ᵏ` of a curve of special points that emanates from a grazing
/// of codimension two.
#[derive(Clone, Debug, PartialEq)]
pub struct Expansion {
    /// The kind of the special points: folds ([`Kind::LP`]) or period doublings ([`Kind::PD`]).
    pub kind: Kind,
    /// The coefficients `c_1, c_2, …` of the parameter `Δp₁` as a function of `Δp₂`, one for each
    /// order of the local map.
    pub parameter: Vec<f64>,
    /// The coefficients of the penetration depth `y` along the curve as a function of `Δp₂`; their
    /// number is one less than the number of coefficients of `Δp₁`. The curve exists on that side
    /// of `Δp₂ = 0` on which the penetration depth `y` is positive.
    pub depth: Vec<f64>,
}

/// The reason why no curve of special points emanates from a grazing.
#[derive(Clone, Debug, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum ExpansionError {
    /// No curve of special points emanates from the grazing, because the grazing is not degenerate.
    #[error(
        "no curve of folds or period doublings of orbits with one impact emanates from this \
         grazing: the test function of the degenerate grazing is {0:.1e}, but must vanish"
    )]
    #[diagnostic(help("locate the degenerate point on the curve of grazings first"))]
    NotDegenerate(f64),
    /// The Taylor expansion of curves of the requested kind is not known.
    #[error("curves of LP and PD emanate from a degenerate grazing, but none of {0}")]
    NoCurve(Kind),
    /// The requested parameter does not exist in the local map.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Unknown(#[from] UnknownName),
    /// The equations for the curve of special points cannot be solved.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Failure(#[from] Failure),
    /// The requested Taylor series has too many terms.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Jet(#[from] JetError),
}

/// A zero problem for the curve given by a Taylor series, `Δp₁ − Σ c_k Δp₂ᵏ = 0`, with the
/// penetration depth as a monitor; the curve of the series can thus be traced and drawn together
/// with the exact curve.
///
/// ```
/// use tangency::core::continuation::Continuation;
/// use tangency::core::system::{Dense, Kind};
/// use tangency::scene::{Expansion, ExpansionCurve};
/// // V = 1 + 2 Δω + 3 Δω² about ω = 5, on the side where y = Δω is positive.
/// let expansion = Expansion { kind: Kind::LP, parameter: vec![2.0, 3.0], depth: vec![1.0] };
/// let names = ["voltage", "frequency"].map(String::from);
/// let curve = ExpansionCurve { expansion, origin: [1.0, 5.0], names };
/// let mut system = Dense::new(curve);
/// let branch = Continuation::new(&mut system).at("frequency", 5.0).along("frequency", 5.0..=5.5).trace()?;
/// let last = branch.points.last().expect("a point");
/// assert!((last.monitors[0] - 2.75).abs() < 1e-12 && (last.monitors[1] - 0.5).abs() < 1e-12);
/// # Ok::<(), tangency::core::continuation::TraceError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ExpansionCurve {
    /// The series.
    pub expansion: Expansion,
    /// The values of `p₁` and `p₂` at the point of codimension two.
    pub origin: [f64; 2],
    /// The names of the parameters `p₁` and `p₂`.
    pub names: [String; 2],
}

/// The name of the monitor for the penetration depth `y` along the curve.
const DEPTH: &str = "depth";

/// Evaluates the series `Σ c_k xᵏ` without a constant term: its first index is k = 1.
fn power_series<T: Scalar>(coefficients: &[f64], x: T) -> T {
    coefficients.iter().rev().fold(T::zero(), |sum, c| (sum + *c) * x)
}

impl ZeroProblem for ExpansionCurve {
    fn names(&self) -> Names {
        let [solved, free] = &self.names;
        Names::new([solved.as_str(), DEPTH], [free.as_str()]).with_monitors([solved, DEPTH])
    }

    fn residual<T: Scalar>(&self, z: &[T], p: &[T], r: &mut [T]) {
        let ([first, second], Expansion { parameter, depth, .. }) = (self.origin, &self.expansion);
        let change = p[0] - second;
        r[0] = z[0] - first - power_series(parameter, change);
        r[1] = z[1] - power_series(depth, change);
    }

    fn monitors<T: Scalar>(&self, z: &[T], _p: &[T], values: &mut [T]) {
        values.copy_from_slice(z);
    }

    fn dynamics(&self) -> Dynamics {
        Dynamics::None
    }
}

/// The type of Taylor series, with enough terms for the highest order of local maps.
type Series = Jet<16>;

/// The bordered matrix counts as singular if the last unknown of the bordered system has at most
/// this absolute value.
const SINGULAR: f64 = 1e-6;

/// The equations that determine the curve of special points.
struct Curve<'a> {
    map: &'a LocalMap,
    /// The multiplier.
    mu: f64,
    /// The indices of two parameters of the local map: the dependent parameter and the independent
    /// parameter of the series.
    parameters: [usize; 2],
    /// The vector `c` in the normalisation `c·v = 1` of null vectors `v`.
    scale: Vec<f64>,
}

impl Curve<'_> {
    /// Evaluates the image of `z` under the local map and the virtual point of `z`, together with
    /// their derivatives along `v`.
    fn along<T: Scalar>(&self, z: &[T], v: &[T], p: &[T]) -> [Vec<Dual<T>>; 2] {
        let z: Vec<_> = z.iter().zip(v).map(|(z, v)| Dual::new(*z, *v)).collect();
        let p: Vec<_> = p.iter().map(|p| Dual::new(*p, T::zero())).collect();
        let mut iteration = self.map.iteration::<Dual<T>>();
        let (mut image, mut place) = (z.clone(), z.clone());
        iteration.apply_regular(&z, &p, &mut image);
        place[self.map.normal()] = iteration.entry(&z, &p);
        [image, place]
    }

    /// Evaluates the orbit equation `F`, the equation of the multiplier, and the normalisation of
    /// `v`, for the unknowns `(z, Δp₁, v)`.
    fn residual<T: Scalar>(&self, u: &[T], other: T, out: &mut [T]) {
        let n = self.scale.len();
        let (z, v) = (&u[..n], &u[n + 1..]);
        let mut p = vec![T::zero(); self.map.parameters().len()];
        (p[self.parameters[0]], p[self.parameters[1]]) = (u[n], other);
        let [image, place] = self.along(z, v, &p);
        for (i, (image, place)) in image.iter().zip(&place).enumerate() {
            out[i] = image.re - place.re;
            out[n + i] = image.eps - place.eps * self.mu;
        }
        let length = v.iter().zip(&self.scale).fold(T::zero(), |sum, (v, c)| sum + *v * *c);
        out[2 * n] = length - 1.0;
    }

    /// Computes the null vector of the multiplier equation at the grazing.
    fn null_vector(&self) -> Result<Vec<f64>, ExpansionError> {
        let n = self.scale.len();
        let (zero, p) = (vec![0.0; n], vec![0.0; self.map.parameters().len()]);
        let mut matrix = Vec::new();
        for k in 0..n {
            let mut v = zero.clone();
            v[k] = 1.0;
            let [image, place] = self.along(&zero, &v, &p);
            matrix.extend(image.iter().zip(&place).map(|(a, b)| a.eps - self.mu * b.eps));
        }
        // The adjoint null vector is the normal, because the derivative has no normal component.
        let mut column = zero;
        column[self.map.normal()] = 1.0;
        let border =
            Border { width: 1, columns: &column, rows: &self.scale, corner: &[0.0], units: &[] };
        let mut lu = BorderedLu::default();
        lu.factor(&matrix, border)?;
        let mut v = vec![0.0; n + 1];
        v[n] = 1.0;
        lu.solve(&mut v);
        match v.pop() {
            Some(g) if g.abs() > SINGULAR => Err(ExpansionError::NotDegenerate(g)),
            _ => Ok(v),
        }
    }

    /// Computes the Jacobian matrix of these equations with respect to their unknowns, stored by
    /// columns.
    fn jacobian(&self, u: &[f64]) -> Vec<f64> {
        let mut out = vec![Dual64::from(0.0); u.len()];
        let mut matrix = Vec::new();
        for k in 0..u.len() {
            let mut dual: Vec<Dual64> = u.iter().map(|u| Dual64::from(*u)).collect();
            dual[k] = dual[k].derivative();
            self.residual(&dual, Dual64::from(0.0), &mut out);
            matrix.extend(out.iter().map(|out| out.eps));
        }
        matrix
    }

    /// Computes the Taylor series of the unknowns by Newton's iteration; every step uses the
    /// Jacobian matrix at the grazing.
    fn solved(&self, order: usize) -> Result<Vec<Series>, ExpansionError> {
        let n = self.scale.len();
        let start = [vec![0.0; n + 1], self.null_vector()?].concat();
        let mut lu = BorderedLu::default();
        lu.factor(&self.jacobian(&start), Border::NONE)?;
        let space = Space::of(1, order)?;
        let other = Series::variable(space, 0, 0.0)?;
        let mut u: Vec<Series> = start.iter().map(|u| Series::from(*u)).collect();
        let mut out = u.clone();
        // A few extra iterations let the real parts converge.
        for _ in 0..order + 4 {
            self.residual(&u, other, &mut out);
            for k in 0..space.len() {
                let mut right: Vec<f64> =
                    out.iter().map(|out| out.coefficient(&[k as u8])).collect();
                lu.solve(&mut right);
                let power = other.powi(k as i32);
                u.iter_mut().zip(right).for_each(|(u, change)| *u -= power * change);
            }
        }
        Ok(u)
    }
}

/// Computes a Taylor series that gives one parameter as a function of another parameter along a
/// curve of folds ([`Kind::LP`]) or period doublings ([`Kind::PD`]) of orbits with one impact; the
/// curve emanates from a degenerate grazing of a local map.
///
/// ```
/// use tangency::scene::expanded;
/// use tangency::core::local_map::{GrazingPoint, LocalMap, MapSettings};
/// use tangency::core::system::Kind;
/// # use tangency::core::orbit::{HybridOrbit, Itinerary};
/// # use tangency::problems::classic::ImpactOscillator;
/// // The impact oscillator at twice its damped natural frequency, with grazing at the amplitude D(ω).
/// let (damping, e) = (0.1_f64, 0.8);
/// let frequency = 2.0 * (1.0 - damping * damping / 4.0).sqrt();
/// let amplitude = (1.0 - frequency * frequency).hypot(damping * frequency);
/// let lag = (damping * frequency).atan2(1.0 - frequency * frequency);
/// let start = [lag.cos(), frequency * lag.sin()];
/// # let orbit = HybridOrbit::of(ImpactOscillator, Itinerary::smooth(ImpactOscillator::FLIGHT, 1))?;
/// let point = GrazingPoint::of(&orbit, &start, &[amplitude, frequency, e, damping, 1.0])?;
/// let names = ["amplitude", "frequency"];
/// let map = LocalMap::of(&ImpactOscillator, &point, &names, MapSettings::default())?;
/// // Folds emanate along the curve of grazings, A = D(ω).
/// let folds = expanded(&map, Kind::LP, names)?;
/// let slope = frequency * (2.0 * (frequency * frequency - 1.0) + damping * damping) / amplitude;
/// assert!((folds.parameter[0] - slope).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ExpansionError::NotDegenerate`] if no curve emanates from this grazing,
/// [`ExpansionError::NoCurve`] for a kind other than LP and PD, and [`ExpansionError::Unknown`] for
/// a parameter that is not expanded in the local map.
pub fn expanded(
    map: &LocalMap,
    kind: Kind,
    parameters: [&str; 2],
) -> Result<Expansion, ExpansionError> {
    let mu = match kind {
        Kind::LP => 1.0,
        Kind::PD => -1.0,
        _ => return Err(ExpansionError::NoCurve(kind)),
    };
    let position = |name| position("parameter", name, map.parameters());
    let parameters = [position(parameters[0])?, position(parameters[1])?];
    // Null vectors have a component along y.
    let (n, order) = (map.coordinates().len(), map.space().order());
    let mut scale = vec![0.0; n];
    scale[map.normal()] = 1.0;
    let curve = Curve { map, mu, parameters, scale };
    let u = curve.solved(order)?;
    let terms = |series: &Series, count: usize| -> Vec<f64> {
        (1..=count).map(|k| series.coefficient(&[k as u8])).collect()
    };
    let (parameter, depth) = (terms(&u[n], order), terms(&u[map.normal()], order - 1));
    Ok(Expansion { kind, parameter, depth })
}
