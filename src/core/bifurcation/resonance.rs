//! Resonances of periodic orbits: the defining system of torus points with a given angle.

use super::at::At;
use super::defining_system::DefiningSystem;
use super::null::NullVectors;
use crate::core::failure::Failure;
use crate::core::linalg::Form;
use crate::core::system::{Functional, Kind};

/// One of the two equations of a resonance, where an orbit has a multiplier `e^{iθ}` with a given
/// angle `θ`: the real or the imaginary part of `g = −w* L v = 0`, with the same `g` as for a torus
/// point ([`Hopf`](super::Hopf)). The real and the imaginary part together define the resonance.
pub(super) struct Resonance {
    angle: f64,
    /// The index of the part of the equation `g = 0`: 0 for the real part, 1 for the imaginary
    /// part.
    part: usize,
    form: Vec<f64>,
}

impl Resonance {
    pub fn real(angle: f64) -> Self {
        Resonance { angle, part: 0, form: Vec::new() }
    }

    pub fn imaginary(angle: f64) -> Self {
        Resonance { part: 1, ..Self::real(angle) }
    }
}

impl DefiningSystem for Resonance {
    fn kind(&self) -> Kind {
        Kind::TR
    }

    fn assembles(&self) -> bool {
        true
    }

    fn start(&mut self, At { system, x, null, .. }: At, _y: &mut [f64]) -> Result<(), Failure> {
        self.form = vec![0.0; x.len()];
        null.start(system, x, Form::Oscillation(self.angle), None)
    }

    fn values(
        &mut self,
        At { system, x, null, .. }: At,
        _y: &[f64],
        values: &mut [f64],
    ) -> Result<(), Failure> {
        values[0] = null.of(system, x, Form::Oscillation(self.angle), None)?.g[self.part];
        Ok(())
    }

    fn gradients(
        &mut self,
        At { system, x, released, null, .. }: At,
        rows: &mut [f64],
        _own: &mut [f64],
    ) -> Result<(), Failure> {
        let n = system.names().dimension();
        let NullVectors { left, right, .. } =
            null.of(system, x, Form::Oscillation(self.angle), None)?;
        let (real, imaginary) = left[0].split_at(n);
        rows.fill(0.0);
        // −w* δF v = −(wᵣ − i wᵢ)ᵀ δF (vᵣ + i vᵢ).
        let terms = match self.part {
            0 => [(real, 0, -1.0), (imaginary, 1, -1.0)],
            _ => [(real, 1, -1.0), (imaginary, 0, 1.0)],
        };
        for (w, v, sign) in terms {
            system.gradient(x, Functional::First(w, &right[v]), released, &mut self.form)?;
            rows.iter_mut().zip(&self.form).for_each(|(row, form)| *row += sign * form);
        }
        Ok(())
    }
}
