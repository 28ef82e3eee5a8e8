//! One half of a stable or unstable manifold, as a parametrised curve.

use super::local::Local;
use super::planar::{PlanarMap, Vector, determinant, is_finite, plus, solved, times};
use super::preimage::{Lost, preimage};

/// The kind of a saddle's manifold: unstable or stable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// `W^u`: the preimages of points on the unstable manifold converge to the saddle.
    Unstable,
    /// `W^s`: the images of points on the stable manifold converge to the saddle.
    Stable,
}

/// One half of a manifold, parametrised by `t` as `W(± e^t)`.
pub(super) struct Curve<'a> {
    pub map: &'a dyn PlanarMap,
    pub local: &'a Local,
    pub side: Side,
    /// The sign of the half in `W(± e^t)`: 1 or −1.
    pub sign: f64,
    /// The number of iterates of the map that map the half onto itself.
    pub iterates: usize,
    /// The logarithm of the factor, above 1, by which `iterates` iterates of the map multiply
    /// `e^t`; on a stable manifold, iterates of the inverse map are meant.
    pub rate: f64,
}

/// A point of the curve, with the derivative of the curve at this point.
#[derive(Clone, Debug)]
pub(super) struct Place {
    pub t: f64,
    /// The point, and the derivative of the curve with respect to `t`.
    pub at: Vector,
    pub slope: Vector,
    /// On a stable manifold, a point near the saddle and its successive preimages, up to the point
    /// itself; empty on an unstable manifold.
    chain: Vec<Vector>,
}

impl Curve<'_> {
    /// Computes the point of the curve at the parameter `t`. On a stable manifold, the point is
    /// computed from the point `before`, which is closer to the saddle; the first point must be
    /// within the radius of the Taylor polynomial.
    ///
    /// # Errors
    /// [`Lost`] if a point is not finite, or if it has no preimage near the chain of preimages of
    /// the point `before`.
    pub fn place(&self, t: f64, before: Option<&Place>) -> Result<Place, Lost> {
        let beyond = (t - self.local.radius.ln()) / self.rate;
        let depth = beyond.ceil().max(0.0);
        let s = self.sign * (t - depth * self.rate).exp();
        let (at, by_s) = self.local.at(s);
        let start = Place { t, at, slope: by_s.map(|part| part * s), chain: Vec::new() };
        let count = depth as usize * self.iterates;
        match self.side {
            Side::Unstable => self.forward(start, count),
            Side::Stable => self.backward(start, count, before.map_or(&[], |it| &it.chain)),
        }
    }

    /// Computes the image of a point under the iterates that map the half onto itself.
    pub fn image(&self, mut u: Vector) -> Vector {
        (0..self.iterates).for_each(|_| u = self.map.image(u));
        u
    }

    fn forward(&self, mut place: Place, count: usize) -> Result<Place, Lost> {
        for _ in 0..count {
            let (image, slope) = self.map.linear(place.at);
            let next = times(slope, place.slope);
            if !is_finite(image) || !is_finite(next) {
                return Err(Lost::NotFinite { at: place.at });
            }
            (place.at, place.slope) = (image, next);
        }
        Ok(place)
    }

    fn backward(&self, mut place: Place, count: usize, known: &[Vector]) -> Result<Place, Lost> {
        let mut chain = Vec::with_capacity(count + 1);
        chain.push(place.at);
        // An earlier chain may be shorter: the images of its first point are added in front.
        let missing = (count + 1).saturating_sub(known.len());
        let mut images: Vec<Vector> = known.first().copied().into_iter().collect();
        for _ in 0..missing {
            images.extend(images.last().map(|u| self.map.image(*u)));
        }
        for k in 1..=count {
            let guess = match k.checked_sub(missing) {
                Some(own) => known.get(own),
                None => images.get(missing - k),
            };
            let guess = guess.copied().unwrap_or(place.at);
            let (at, slope) = preimage(self.map, place.at, guess)?;
            let next = solved(slope, place.slope);
            if !is_finite(next) {
                return Err(Lost::Fold { of: place.at, at, determinant: determinant(slope) });
            }
            (place.at, place.slope) = (at, next);
            chain.push(at);
        }
        Ok(Place { chain, ..place })
    }
}

/// Evaluates the cubic through two points with given derivatives: its value and its derivative at
/// `t`.
pub(super) fn cubic(
    [t0, t1]: [f64; 2],
    [x0, x1]: [Vector; 2],
    [v0, v1]: [Vector; 2],
    t: f64,
) -> (Vector, Vector) {
    let h = t1 - t0;
    let u = (t - t0) / h;
    let (a, b) = (u * u * (3.0 - 2.0 * u), 6.0 * u * (1.0 - u) / h);
    let (c, d) = (u * (1.0 - u) * (1.0 - u) * h, u * u * (u - 1.0) * h);
    let (e, f) = ((1.0 - u) * (1.0 - 3.0 * u), u * (3.0 * u - 2.0));
    let way = plus(x1, -1.0, x0);
    let point = plus(plus(plus(x0, a, way), c, v0), d, v1);
    (point, [0, 1].map(|i| b * way[i] + e * v0[i] + f * v1[i]))
}
