//! Points of codimension two on curves of grazings.

use super::fold::Fold;
use crate::core::condition::{At, Condition, Failure};
use crate::core::kind::Kind;
use crate::core::linear::Factors;
use crate::core::vector::{dot, generic};
use crate::core::zero::{Across, Border, Form, System};

impl Kind {
    /// `GD`: a degenerate grazing: orbits with the event begin there at a fold, `∂P/∂θ = 0`.
    pub const GD: Kind = Kind::new("GD", "degenerate grazing");
    /// `GF`: a degenerate grazing of flip type: a period doubling of the orbits with the event ends there.
    pub const GF: Kind = Kind::new("GF", "degenerate grazing of flip type");
    /// `GL`: a nonhyperbolic grazing of fold type: the orbit without the event has the multiplier 1.
    pub const GL: Kind = Kind::new("GL", "nonhyperbolic grazing of fold type");
    /// `GP`: a nonhyperbolic grazing of flip type: the orbit without the event has the multiplier −1.
    pub const GP: Kind = Kind::new("GP", "nonhyperbolic grazing of flip type");
}

/// A point of codimension two on a curve of grazings. The grazing orbit is one of two families, with the event that it
/// touches and without it, and of each the linearisation `F_z` is singular somewhere along the curve: of the orbits with the
/// event where the grazing is *degenerate*, of those without it where it is *nonhyperbolic*. The curve is one of either
/// family; where the singular orbits are the others ([`System::across`]), their fold (or period doubling) is stated for them.
pub struct GrazingBifurcation {
    kind: Kind,
    fold: Fold,
    /// Whether the orbits along the curve are those that are singular.
    own: bool,
    /// The number of unknowns of those that are.
    unknowns: usize,
    factors: Factors,
}

impl GrazingBifurcation {
    /// A degenerate grazing (`GD`).
    pub fn degenerate() -> Self {
        Self::new(Kind::GD, Fold::default())
    }

    /// A degenerate grazing of flip type (`GF`).
    pub fn degenerate_flip() -> Self {
        Self::new(Kind::GF, Fold::antiperiodic())
    }

    /// A nonhyperbolic grazing of fold type (`GL`).
    pub fn nonhyperbolic() -> Self {
        Self::new(Kind::GL, Fold::default())
    }

    /// A nonhyperbolic grazing of flip type (`GP`).
    pub fn nonhyperbolic_flip() -> Self {
        Self::new(Kind::GP, Fold::antiperiodic())
    }

    fn new(kind: Kind, fold: Fold) -> Self {
        GrazingBifurcation { kind, fold, own: true, unknowns: 0, factors: Factors::default() }
    }

    /// Refuses other orbits than those at the start: along the curve more than one surface may come to be touched.
    fn check_same(&self, system: &dyn System) -> Result<(), Failure> {
        match system.names().dimension() == self.unknowns {
            true => Ok(()),
            false => Err(Failure::Undetermined(
                "where these orbits graze, others begin than at the start of the curve".into(),
            )),
        }
    }

    /// The gradient by the released parameters of the fold's left side for the other orbits. These are determined by the
    /// parameters: `F_z δz + F_p δp = 0`, while the monitor that vanishes at a grazing stays zero.
    fn gradient_across(
        &mut self,
        Across { system, x }: Across,
        released: &[usize],
    ) -> Result<Vec<f64>, Failure> {
        self.check_same(system)?;
        let n = system.names().dimension();
        let Some(touched) = system.touched(x)? else { return Err(no_other()) };
        let (mut slope, mut rate) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        self.fold.gradients(At { system: &mut *system, x, released }, &mut slope, &mut [])?;
        system.monitor_gradient(touched, x, released, &mut rate)?;
        let columns = generic(n, 3);
        let border = Border { width: 1, columns: &columns, rows: &rate[..n], corner: &[0.0] };
        system.assemble(x)?;
        system.factor(Form::Jacobian, border, &mut self.factors)?;
        let mut adjoint = slope[..n].to_vec();
        adjoint.push(0.0);
        self.factors.solve_transposed(&mut adjoint);
        let (mut direction, mut column) = (vec![0.0; x.len()], vec![0.0; n]);
        let by = |p: &usize| {
            direction.fill(0.0);
            direction[n + p] = 1.0;
            system.derivative(x, &[&direction], &mut column)?;
            Ok(slope[n + p] - dot(&adjoint[..n], &column) - adjoint[n] * rate[n + p])
        };
        released.iter().map(by).collect()
    }
}

fn no_other() -> Failure {
    Failure::Undetermined("no other orbits are known where these graze".into())
}

/// The other orbits at a grazing.
fn across<'a>(system: &'a mut dyn System, x: &[f64]) -> Result<Across<'a>, Failure> {
    system.across(x)?.ok_or_else(no_other)
}

impl Condition for GrazingBifurcation {
    fn kind(&self) -> Kind {
        self.kind
    }

    fn assembles(&self) -> bool {
        self.own
    }

    fn start(&mut self, At { system, x, released }: At, y: &mut [f64]) -> Result<(), Failure> {
        let degenerate = [Kind::GD, Kind::GF].contains(&self.kind);
        self.own = system.passes_touched(x)? == degenerate;
        if self.own {
            return self.fold.start(At { system, x, released }, y);
        }
        let Across { system, x } = across(system, x)?;
        self.unknowns = system.names().dimension();
        self.fold.start(At { system, x, released }, y)
    }

    fn values(
        &mut self,
        At { system, x, released }: At,
        y: &[f64],
        values: &mut [f64],
    ) -> Result<(), Failure> {
        if self.own {
            return self.fold.values(At { system, x, released }, y, values);
        }
        let Across { system, x } = across(system, x)?;
        self.check_same(system)?;
        self.fold.values(At { system, x, released }, y, values)
    }

    fn gradients(&mut self, at: At, rows: &mut [f64], own: &mut [f64]) -> Result<(), Failure> {
        if self.own {
            return self.fold.gradients(at, rows, own);
        }
        let At { system, x, released } = at;
        let n = system.names().dimension();
        let slopes = self.gradient_across(across(system, x)?, released)?;
        rows.fill(0.0);
        released.iter().zip(slopes).for_each(|(p, slope)| rows[n + p] = slope);
        Ok(())
    }

    fn adapt(&mut self) {
        self.fold.adapt();
    }
}
