//! Implements [`System`] for [`Ritz`].

use super::discretisation::{Discretisation, RitzSettings};
use super::modes::signed_root;
use super::orders::Orders;
use super::plane::PlaneFactor;
use super::residual::Workspace;
use super::ritz::{Directional, FlatPlate, Ritz};
use super::{domain, monitors, profile, shape, tensor::dot};
use crate::core::failure::{Failure, unknown_order};
use crate::core::linalg::{Border, BorderedLu, Factors, Form, Spectrum, SpectrumRequest};
use crate::core::problem::{Dynamics, Names, Profile};
use crate::core::system::{Discretised, Functional, Refinement, System};
use faer::Mat;
use num_dual::Dual64;
use std::mem::take;

/// The maximum number of unknowns of a refined discretisation of a plate.
const LARGEST_RUNG: usize = 500;

/// Computes the mixed derivative of the residual `F` along the given `directions`, each of the
/// length of `x`, into `out`.
fn differentiate<T: Directional>(
    work: &mut Workspace<T>,
    model: &Discretisation,
    factor: &PlaneFactor,
    x: &[f64],
    directions: &[&[f64]],
    largest: f64,
    out: &mut [f64],
) {
    let n = model.unknowns();
    let parts = |i: usize| [0, 1, 2].map(|k| directions.get(k).map_or(0.0, |d| d[i]));
    let (q, p) = x.split_at(n);
    for (i, (out, q)) in work.q.iter_mut().zip(q).enumerate() {
        *out = T::seed(*q, parts(i));
    }
    for (i, (out, p)) in work.p.iter_mut().zip(p).enumerate() {
        *out = T::seed(*p, parts(n + i));
    }
    let plane = model.settings.units.of_the_plane();
    let fixed = directions.iter().all(|d| plane.iter().all(|i| d[n + i] == 0.0));
    work.evaluate(model, factor, largest, fixed);
    out.iter_mut().zip(&work.r).for_each(|(out, r)| *out = r.mixed());
}

/// Returns the unknowns of the same deflection in another polynomial space; in a smaller space, the
/// terms of high degree are omitted.
fn converted(from: &Discretisation, to: &Discretisation, z: &[f64]) -> Vec<f64> {
    // For one direction, expresses functions of the own basis by functions of the other basis,
    // `(own, other)`.
    let carry = |axis: usize| {
        let [own, other] = [from, to].map(|model| &model.transverse[axis]);
        let (n, m) = (own.len(), other.len());
        Mat::from_fn(n, m, |i, k| match (own.conversions(), other.conversions()) {
            (Some([to, _]), Some([_, back])) => {
                (0..n.min(m)).map(|j| to[i * n + j] * back[k * m + j]).sum()
            }
            _ => f64::from(u8::from(i == k)),
        })
    };
    let [ny, my] = [from, to].map(|model| model.transverse[1].len());
    let own = Mat::from_fn(z.len() / ny, ny, |i, j| z[i * ny + j] * from.scale[i * ny + j]);
    let other = carry(0).transpose() * own * carry(1);
    to.scale.iter().enumerate().map(|(k, scale)| other[(k / my, k % my)] / scale).collect()
}

impl Ritz {
    /// Returns the point `x = (z, p)` that describes the same plate and deflection with other
    /// numbers of basis functions; with smaller numbers, the terms of high degree are omitted.
    pub fn carry(&self, x: &[f64], other: &Ritz) -> Vec<f64> {
        let (z, p) = x.split_at(self.model.unknowns());
        let mut carried = converted(&self.model, &other.model, z);
        carried.extend_from_slice(p);
        carried
    }

    /// Returns the assembled `F_z` as a dense `n × n` matrix, stored column by column.
    pub fn jacobian(&self, out: &mut [f64]) {
        out.copy_from_slice(&self.assembly.matrix);
    }

    /// Returns the lowest squared frequency `ω²` of vibrations about `x`, and stores its mode in
    /// `self.mode`.
    fn lowest(&mut self, x: &[f64]) -> Result<f64, Failure> {
        self.ensure_modes(x)?;
        self.eigenproblem.shape(0, &mut self.mode[..self.model.unknowns()]);
        Ok(self.eigenproblem.square(0))
    }

    /// Returns the lowest frequency of the unloaded plate, and stores its mode in `self.flat`.
    fn flat_frequency(&mut self, p: &[f64]) -> Result<f64, Failure> {
        let parameters = self.model.settings.units.parameters(p);
        let at = (parameters.aspect, parameters.nu);
        if self.flat.as_ref().is_none_or(|flat| flat.at != at) {
            let mut modes = self.flat_modes(at.0, at.1, 1)?;
            let shape = modes.shapes.swap_remove(0);
            self.flat = Some(FlatPlate { at, square: modes.squares[0], shape });
        }
        Ok(self.flat.as_ref().map_or(f64::NAN, |flat| signed_root(flat.square)))
    }

    /// Computes the gradient of the squared frequency `ω²` of the unloaded plate with respect to
    /// the varied parameters, and stores it in the last components of `out`.
    fn flat_gradient(
        &mut self,
        x: &[f64],
        released: &[usize],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        let n = self.model.unknowns();
        let Some(flat) = &self.flat else { return Ok(()) };
        let (mut rest, mut along) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        along[..n].copy_from_slice(&flat.shape);
        let names = self.model.settings.units.names();
        let is_load = |name: &str| {
            matches!(name, "load" | "voltage" | "pressure") || name.starts_with("edge_")
        };
        let unloaded: Vec<usize> = (0..names.len()).filter(|i| !is_load(names[*i])).collect();
        unloaded.iter().for_each(|i| rest[n + i] = x[n + i]);
        let released: Vec<usize> =
            unloaded.into_iter().filter(|parameter| released.contains(parameter)).collect();
        out.fill(0.0);
        if !released.is_empty() {
            self.gradient(&rest, Functional::First(&along[..n], &along), &released, out)?;
            out[..n].fill(0.0);
        }
        Ok(())
    }

    /// Computes the gradient of the dimensionless frequency `ω` into `out`, and returns `ω`.
    fn frequency_gradient(
        &mut self,
        x: &[f64],
        released: &[usize],
        out: &mut [f64],
    ) -> Result<f64, Failure> {
        let n = self.model.unknowns();
        let omega = signed_root(self.lowest(x)?);
        // The mode is taken out to allow mutable use of the rest of the plate.
        let mode = take(&mut self.mode);
        let outcome = self.gradient(x, Functional::First(&mode[..n], &mode), released, out);
        self.mode = mode;
        outcome?;
        out.iter_mut().for_each(|g| *g /= 2.0 * omega.abs());
        Ok(omega)
    }

    /// Converts the gradient of a frequency to the unit of frequency of the problem: `out ← unit ·
    /// out + ω ∇unit`.
    fn apply_unit(&self, x: &[f64], omega: f64, out: &mut [f64]) {
        let n = self.model.unknowns();
        let units = self.model.settings.units;
        let p = &x[n..];
        let unit = units.frequency_unit(p);
        out.iter_mut().for_each(|g| *g *= unit);
        let mut seeded: Vec<Dual64> = p.iter().map(|p| Dual64::from(*p)).collect();
        for (i, slope) in out[n..].iter_mut().enumerate() {
            seeded[i].eps = 1.0;
            *slope += omega * units.frequency_unit(&seeded).eps;
            seeded[i].eps = 0.0;
        }
    }

    fn ratio_gradient(
        &mut self,
        x: &[f64],
        released: &[usize],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        let flat = self.flat_frequency(&x[self.model.unknowns()..])?;
        let omega = self.frequency_gradient(x, released, out)?;
        let mut of_flat = vec![0.0; x.len()];
        self.flat_gradient(x, released, &mut of_flat)?;
        for (out, of_flat) in out.iter_mut().zip(&of_flat) {
            *out = *out / flat - omega / (flat * flat) * of_flat / (2.0 * flat);
        }
        Ok(())
    }

    /// Computes the gradient of a monitor into `out`.
    fn monitor_gradient(
        &mut self,
        monitor: usize,
        x: &[f64],
        released: &[usize],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        let n = self.model.unknowns();
        out.fill(0.0);
        match monitor {
            0 => out[..n].copy_from_slice(&self.centre),
            1 => {
                // The place of the largest deflection moves, but the slope is zero there.
                let (_, xi, zeta) = self.search.largest(&self.model, &x[..n]);
                shape::products(&self.model, [xi, zeta], &mut self.search.point, &mut out[..n]);
            }
            2 => {
                let omega = self.frequency_gradient(x, released, out)?;
                self.apply_unit(x, omega, out);
            }
            3 => self.ratio_gradient(x, released, out)?,
            _ => {
                if let Some(gap) = self.model.settings.units.gap() {
                    let weighted = out.iter_mut().zip(&self.centre);
                    weighted.for_each(|(out, centre)| *out = x[n + gap] * centre);
                    out[n + gap] = dot(&x[..n], &self.centre);
                }
            }
        }
        Ok(())
    }
}

impl System for Ritz {
    fn names(&self) -> &Names {
        &self.names
    }

    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<(), Failure> {
        self.evaluate(x)?;
        r.copy_from_slice(&self.plain.r);
        domain::finite(r, |i| format!("component {i} of the residual"))
    }

    fn assemble(&mut self, x: &[f64]) -> Result<(), Failure> {
        if self.assembled_at != x {
            self.assembled_at.clear();
            self.assemble_at(x)?;
            self.assembled_at.extend_from_slice(x);
        }
        Ok(())
    }

    fn factor(&mut self, form: Form, border: Border, into: &mut Factors) -> Result<(), Failure> {
        if form != Form::Jacobian {
            return Err(Failure::Unsupported(
                "equilibria of a potential do not oscillate, so they \
                                             have no Hopf points"
                    .into(),
            ));
        }
        let lu = into.reuse(|_: &BorderedLu| true, BorderedLu::default);
        lu.factor(&self.assembly.matrix, border)
    }

    fn derivative(
        &mut self,
        x: &[f64],
        directions: &[&[f64]],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        let largest = self.prepare(x)?;
        let (model, factor) = (&self.model, &self.factor);
        match directions.len() {
            1 => differentiate(&mut self.first, model, factor, x, directions, largest, out),
            2 => differentiate(&mut self.second, model, factor, x, directions, largest, out),
            3 => differentiate(&mut self.third, model, factor, x, directions, largest, out),
            order => return Err(unknown_order(order)),
        }
        domain::finite(out, |i| format!("a derivative of component {i} of the residual"))
    }

    /// Computes the gradient of a directional derivative of the residual `F`; this gradient equals
    /// a derivative of `F` of one higher order, because `F` is itself the gradient of a potential.
    fn gradient(
        &mut self,
        x: &[f64],
        of: Functional,
        released: &[usize],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        let (w, v, order) = match of {
            Functional::First(w, v) => (w, v, 2),
            Functional::Second(w, v) => (w, v, 3),
            Functional::Monitor(monitor) => {
                return self.monitor_gradient(monitor, x, released, out);
            }
        };
        let mut memory = take(&mut self.potential);
        let along = |d: &[f64], out: &mut [f64]| self.derivative(x, &[d, v, v][..order], out);
        let outcome = memory.gradient(w, released, along, out);
        self.potential = memory;
        outcome
    }

    fn dynamics(&self) -> Dynamics {
        Dynamics::Potential
    }

    fn spectrum(
        &mut self,
        x: &[f64],
        request: SpectrumRequest,
    ) -> Result<Option<Spectrum>, Failure> {
        self.ensure_modes(x)?;
        let n = self.model.unknowns();
        let unstable = (0..n).take_while(|mode| self.eigenproblem.square(*mode) < 0.0).count();
        let reported = request.count.max(unstable).min(n);
        Ok(Some((0..reported).map(|mode| (-self.eigenproblem.square(mode), 0.0)).collect()))
    }

    fn monitors(&mut self, x: &[f64], first: usize, values: &mut [f64]) -> Result<(), Failure> {
        let (q, p) = x.split_at(self.model.unknowns());
        let flat = self.flat_frequency(p)?;
        let omega = signed_root(self.lowest(x)?);
        let deflections = [dot(q, &self.centre), self.search.largest(&self.model, q).0];
        let mut all = [0.0; 5];
        monitors::fill(self.model.settings.units, p, deflections, [omega, flat], &mut all);
        values.copy_from_slice(&all[first..][..values.len()]);
        Ok(())
    }

    /// Returns profiles of the deflection and of the first mode shape along the centre line.
    fn profiles(&mut self, x: &[f64]) -> Vec<Profile> {
        let modes = self.modes(x, 1).ok();
        let shape = modes.as_ref().and_then(|modes| modes.shapes.first());
        let q = &x[..self.model.unknowns()];
        profile::profiles(q, shape.map(Vec::as_slice), |q, x| self.deflection(q, x, 0.5))
    }

    fn discretised(&mut self) -> Option<&mut dyn Discretised> {
        Some(self)
    }
}

/// Returns the same plate and deflection with the given numbers of basis functions.
fn on_orders(plate: &Ritz, orders: Orders, x: &[f64]) -> Option<Refinement> {
    let other = Ritz::new(RitzSettings { orders: Some(orders), ..plate.model.settings }).ok()?;
    let x = plate.carry(x, &other);
    Some(Refinement { system: Box::new(other), x })
}

impl Discretised for Ritz {
    fn refined(&mut self, x: &[f64]) -> Option<Refinement> {
        if self.is_refinable() { on_orders(self, self.model.orders.finer(), x) } else { None }
    }

    fn is_refinable(&self) -> bool {
        let [along_x, along_y] = self.model.orders.finer().transverse;
        along_x * along_y <= LARGEST_RUNG
    }

    fn coarser(&mut self, x: &[f64]) -> Option<Refinement> {
        on_orders(self, self.model.orders.coarser()?, x)
    }
}
