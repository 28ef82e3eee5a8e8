//! Fixed and periodic points of local maps, as a boundary-value problem.

use super::map::LocalMap;
use crate::core::bvp::{
    BoundaryError, BoundaryProblem, BoundarySystem, Ends, ErasedProblem, Guess, IntoEquations,
    Itineraries, Mesh, Monitor, Shape, Shooting, Trajectory, Watched,
};
use crate::core::failure::Failure;
use crate::core::scalar::Scalar;
use crate::core::system::Limit;

/// The periodic points of a [`LocalMap`], with a given sequence of iterates. Each iterate either
/// has an impact, in which motion passes through the surface, or does not have an impact:
///
/// ```text
///     ξ_{k+1} = P(ξ_k, p),    k = 0 … K − 1,    ξ_K = ξ_0
/// ```
///
/// Each point has an additional unknown: at an impact, the unknown is `y_k`, which determines the
/// normal coordinate of the virtual point `ξ_k`; without an impact, it is the distance `h` from the
/// surface. In these unknowns the equations are regular where an impact becomes a grazing, `y_k =
/// 0`. At a grazing, the generalised eigenvalue problem for the multipliers is also regular: no
/// entry of its matrices grows like `1/y`.
///
/// The problem is a boundary-value problem on segments without motion, so that all methods for
/// periodic orbits apply: multipliers, stability, folds, period doublings, torus bifurcations,
/// grazings, and the curves of these bifurcations. Coordinates and parameters are deviations from
/// the grazing orbit; after a call of [`in_place`](Self::in_place), parameters and monitors are
/// values of the system instead.
///
/// ```
/// use tangency::core::continuation::Continuation;
/// use tangency::core::system::Kind;
/// use tangency::core::local_map::{GrazingPoint, LocalMap, LocalOrbit, MapSettings};
/// use tangency::core::orbit::{HybridOrbit, Itinerary};
/// use tangency::problems::classic::ImpactOscillator;
/// // The oscillator at resonance: orbits with one impact fold at A = 0.0999707536, 2.9e-5 before they graze.
/// let orbit = HybridOrbit::of(ImpactOscillator, Itinerary::smooth(ImpactOscillator::FLIGHT, 1))?;
/// let point = GrazingPoint::of(&orbit, &[0.0, 1.0], &[0.1, 1.0, 0.8, 0.1, 1.0])?;
/// let settings = MapSettings { order: 3, ..MapSettings::default() };
/// let map = LocalMap::of(&ImpactOscillator, &point, &["amplitude"], settings)?;
/// let mut orbits = LocalOrbit::of(map.clone(), &[true]).system()?;
/// let start = orbits.flowed(&[0.0, 0.0], &[0.0], &[0.0])?;
/// let branch = Continuation::new(&mut orbits).from(&start).along("amplitude", -1e-4..=1e-4).trace()?;
/// let fold = branch.of_kind(Kind::LP).next().expect("a fold");
/// assert!((0.1 + fold.parameters[0] - 0.0999707536283).abs() < 1e-9);
/// // The same fold with the amplitude itself in place of deviations.
/// let mut orbits = LocalOrbit::of(map, &[true]).in_place().system()?;
/// let branch = Continuation::new(&mut orbits).at("amplitude", 0.1).along("amplitude", 0.0999..=0.1).trace()?;
/// let fold = branch.of_kind(Kind::LP).next().expect("a fold");
/// assert!((fold.parameters[0] - 0.0999707536283).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct LocalOrbit {
    map: LocalMap,
    impacts: Vec<bool>,
    order: usize,
    /// Whether parameters and monitors are in units of the system instead of deviations from the
    /// grazing orbit.
    in_place: bool,
}

/// The indices of three functions that depend on all points of an orbit: the smallest `y` at
/// impacts; the smallest distance from the surface at the points without an impact; and the
/// penetration of the impact with the smallest `y`, or the negative of the distance if there are no
/// impacts.
const DEPTH: usize = 0;
const DISTANCE: usize = 1;
const PENETRATION: usize = 2;

/// The names of the monitors that are functions of all points of an orbit.
const ENDS: [&str; 3] = ["penetration", "depth", "distance"];

/// Returns the name of the monitor for the largest value of a coordinate.
fn largest(coordinate: &String) -> String {
    format!("max_{coordinate}")
}

impl LocalOrbit {
    /// Returns the names of the monitors of orbits with the given coordinates.
    ///
    /// ```
    /// use tangency::core::local_map::LocalOrbit;
    /// let columns = LocalOrbit::columns(&["phase".into()]);
    /// assert_eq!(columns, ["max_phase", "penetration", "depth", "distance"]);
    /// ```
    pub fn columns(coordinates: &[String]) -> Vec<String> {
        coordinates.iter().map(largest).chain(ENDS.map(String::from)).collect()
    }

    /// Creates the problem of periodic points with one iterate for each entry of `impacts`, which
    /// is true for an impact.
    pub fn of(map: LocalMap, impacts: &[bool]) -> Self {
        let order = map.space().order();
        LocalOrbit { map, impacts: impacts.to_vec(), order, in_place: false }
    }

    /// Expresses parameters and monitors as values of the system instead of deviations, for
    /// comparison with branches of the flow. Coordinates in the vector of unknowns remain
    /// deviations, since deviations have more significant digits.
    pub fn in_place(mut self) -> Self {
        self.in_place = true;
        self
    }

    /// Evaluates the local map without its terms above a given order.
    pub fn to_order(mut self, order: usize) -> Self {
        self.order = order;
        self
    }

    /// Creates the system of equations for the periodic points. The unknowns of the system are
    /// computed by [`flowed`](crate::core::bvp::DiscretisedProblem::flowed) from the points and the
    /// additional unknown, `y` or distance, of each point.
    ///
    /// # Errors
    /// [`BoundaryError`] if the sequence of iterates is empty.
    pub fn system(self) -> Result<BoundarySystem, BoundaryError> {
        let meshes = self.impacts.iter().map(|_| Mesh::uniform(1)).collect();
        // Any method is exact on segments without motion.
        BoundarySystem::new(self, Shooting::default(), meshes)
    }

    /// Iterates over the points of the orbit; each item contains a point, a flag that is true if
    /// the point is an impact, and the additional unknown of the point.
    fn points<'a, T: Scalar>(
        &'a self,
        x: &'a [T],
        q: &'a [T],
    ) -> impl Iterator<Item = (&'a [T], bool, T)> + 'a {
        let extras = &q[self.map.parameters().len()..];
        let points = x.chunks_exact(self.map.coordinates().len()).zip(&self.impacts);
        points.zip(extras).map(|((x, impact), extra)| (x, *impact, *extra))
    }

    /// Returns the orbit that differs from this orbit at one point: if `impact` is true, the impact
    /// closest to the surface becomes a pass without impact; otherwise, the pass closest to the
    /// surface becomes an impact. Returns `None` if no such point exists.
    fn otherwise(
        &self,
        impact: bool,
        known: &[Trajectory],
        q: &[f64],
    ) -> Option<Guess<ErasedProblem>> {
        let starts = known.iter().flat_map(Trajectory::start).copied().collect::<Vec<_>>();
        let points = self.points(&starts, q).enumerate().filter(|(_, point)| point.1 == impact);
        let nearest = points.map(|(k, point)| (point.2.abs(), k));
        let (_, touched) = nearest.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let mut problem = self.clone();
        problem.impacts[touched] = !impact;
        let mut extras: Vec<f64> = self.points(&starts, q).map(|point| point.2).collect();
        extras[touched] = 0.0;
        let (problem, trajectories) = (problem.into_equations(), known.to_vec());
        Some(Guess { problem, trajectories, extras, beside: None })
    }
}

impl BoundaryProblem for LocalOrbit {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![self.map.coordinates().to_vec(); self.impacts.len()]
    }

    fn parameters(&self) -> Vec<String> {
        self.map.parameters().to_vec()
    }

    fn extras(&self) -> Vec<String> {
        let names = self.impacts.iter().map(|impact| if *impact { "y" } else { "distance" });
        match self.impacts.len() {
            1 => names.map(String::from).collect(),
            _ => names.enumerate().map(|(k, name)| format!("{name}[{k}]")).collect(),
        }
    }

    fn field<T: Scalar>(&self, _segment: usize, _t: T, _x: &[T], _q: &[T], f: &mut [T]) {
        f.fill(T::zero());
    }

    fn boundary<T: Scalar>(&self, ends: Ends<T>, q: &[T], b: &mut [T]) {
        let (n, count) = (self.map.coordinates().len(), self.impacts.len());
        let deviation = |(p, at): (&T, &f64)| if self.in_place { *p - *at } else { *p };
        let p = &q.iter().zip(self.map.origin().1).map(deviation).collect::<Vec<T>>();
        let mut iteration = self.map.iteration_to::<T>(self.order);
        for (k, (x, impact, extra)) in self.points(ends.end, q).enumerate() {
            let next = (k + 1) % count;
            let rows = n * next..n * (next + 1);
            b[n * count + k] = if impact {
                // The virtual point: `y` in place of the normal coordinate.
                let mut z = x.to_vec();
                z[self.map.normal()] = extra;
                let entry = iteration.entry(&z, p);
                iteration.apply_regular(&z, p, &mut b[rows.clone()]);
                x[self.map.normal()] - entry
            } else {
                b[rows.clone()].copy_from_slice(x);
                iteration.apply_smooth(&mut b[rows.clone()], p);
                iteration.penetration(x, p) + extra
            };
            for i in rows {
                b[i] = ends.start[i] - b[i];
            }
        }
    }

    fn shape(&self) -> Shape {
        Shape::MapCycle
    }

    fn of_ends<T: Scalar>(&self, function: usize, ends: Ends<T>, q: &[T]) -> T {
        let least = |least: T, next: T| if next.real() < least.real() { next } else { least };
        let of = |impact: bool| {
            let all = self.points(ends.start, q).filter(|point| point.1 == impact);
            all.map(|point| point.2).fold(T::from(f64::INFINITY), least)
        };
        match function {
            PENETRATION if self.impacts.contains(&true) => of(true).powi(2),
            PENETRATION => -of(false),
            _ => of(function == DEPTH),
        }
    }

    /// Returns the absolute value of a coordinate.
    fn watch<T: Scalar>(&self, i: usize, _segment: usize, _t: T, x: &[T], _q: &[T]) -> T {
        x[i] + self.map.origin().0[i]
    }

    fn monitors(&self) -> Vec<(String, Monitor)> {
        let watched = if self.in_place { Watched::function } else { Watched::state };
        let all = |i: usize| (0..self.impacts.len()).map(|k| watched(k, i)).collect();
        let names = self.map.coordinates().iter().enumerate();
        let mut monitors: Vec<(String, Monitor)> =
            names.map(|(i, name)| (largest(name), Monitor::Maximum(all(i)))).collect();
        let [penetration, depth, distance] = ENDS.map(String::from);
        monitors.push((penetration, Monitor::Ends(PENETRATION)));
        if self.impacts.contains(&true) {
            monitors.push((depth, Monitor::Ends(DEPTH)));
        }
        if self.impacts.contains(&false) {
            monitors.push((distance, Monitor::Ends(DISTANCE)));
        }
        monitors
    }

    fn itineraries(&self) -> Option<&dyn Itineraries<ErasedProblem>> {
        Some(self)
    }
}

impl Itineraries<ErasedProblem> for LocalOrbit {
    fn limits(&self, _p: &[f64]) -> Vec<Limit> {
        let monitors =
            self.monitors().into_iter().enumerate().skip(self.map.coordinates().len() + 1);
        let limit =
            |(monitor, (_, of))| Limit { monitor, scale: 1.0, passes: of == Monitor::Ends(DEPTH) };
        monitors.map(limit).collect()
    }

    fn words(&self) -> String {
        let word = |impact: &bool| if *impact { "impact" } else { "pass" };
        self.impacts.iter().map(word).collect::<Vec<_>>().join(" ")
    }

    fn with_words(&self, words: &str) -> Result<ErasedProblem, Failure> {
        let impact = |word: &str| match word {
            "impact" => Ok(true),
            "pass" => Ok(false),
            _ => Err(Failure::Mismatch(format!(
                "the word `{word}` in the itinerary `{words}` must be `impact` or `pass`"
            ))),
        };
        let impacts = words.split_whitespace().map(impact).collect::<Result<_, _>>()?;
        Ok(LocalOrbit { impacts, ..self.clone() }.into_equations())
    }

    fn doubled(&self) -> Option<ErasedProblem> {
        Some(LocalOrbit { impacts: self.impacts.repeat(2), ..self.clone() }.into_equations())
    }

    fn halved(&self) -> Option<ErasedProblem> {
        let (first, second) = self.impacts.split_at(self.impacts.len() / 2);
        let half = || LocalOrbit { impacts: first.to_vec(), ..self.clone() }.into_equations();
        (first == second).then(half)
    }

    /// Returns the orbit with an additional impact at the point where the present orbit passes
    /// closest to the surface.
    fn emanating(
        &self,
        known: &[Trajectory],
        q: &[f64],
        which: usize,
    ) -> Result<Guess<ErasedProblem>, Failure> {
        let reason = "no other branch emanates where these orbits graze";
        match which {
            0 => self.otherwise(false, known, q).ok_or_else(|| Failure::Unsupported(reason.into())),
            _ => Err(Failure::no_branch(which, 1)),
        }
    }

    /// Returns the orbit beyond the grazing: without this orbit's weakest impact, or with an impact
    /// at the point where this orbit passes closest to the surface.
    fn across(
        &self,
        known: &[Trajectory],
        q: &[f64],
        passes: bool,
        _wanted: bool,
    ) -> Result<Option<Guess<ErasedProblem>>, Failure> {
        Ok(self.otherwise(passes, known, q))
    }
}
