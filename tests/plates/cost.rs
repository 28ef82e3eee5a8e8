//! A trace costs a few residuals, Jacobians, factorisations and spectra for each point, however
//! many unknowns there are.

use crate::common::counted::{Counted, Counts};
use crate::plates::models::{plate, system, through_pull_in};
use tangency::core::continuation::Settings;
use tangency::core::system::Kind;
use tangency::problems::plate::{InPlane, Orders};

/// The points of a trace of the clamped plate, and how often its system was evaluated.
fn trace(orders: Option<Orders>, settings: &Settings) -> (usize, Counts) {
    let mut settings_of_plate = plate("CCCC", InPlane::Immovable);
    settings_of_plate.orders = orders;
    let (mut counted, counts) = Counted::new(system(&settings_of_plate, 1.0));
    let curve = through_pull_in(&mut counted, &[]).settings(settings.clone());
    let branch = curve.mark("frequency_ratio", 0.1).trace().unwrap();
    assert_eq!(branch.of_kind(Kind::LP).count(), 1);
    let counts = *counts.lock().unwrap();
    (branch.points.len(), counts)
}

/// Special points, finer plates for their errors, and derivatives with respect to all parameters
/// are included.
#[test]
fn a_point_costs_few_evaluations_however_many_unknowns_there_are() {
    // So short steps that points count, and not the special ones.
    let short = Settings { max_step: 0.03, ..Settings::default() };
    let unrefined = Settings { refinement: 0.0, ..short.clone() };
    for (orders, settings) in [
        (None, short),
        (None, unrefined.clone()),
        (Some(4), unrefined.clone()),
        (Some(8), unrefined.clone()),
        (Some(12), unrefined),
    ] {
        let orders =
            orders.map(|count| Orders { transverse: [count; 2], in_plane: [count + 2; 2] });
        let (points, counts) = trace(orders, &settings);
        let Counts { residuals, assemblies, factorisations, solves, derivatives, spectra } = counts;
        let most = |count: usize, of_a_point: usize| count <= of_a_point * points;
        let iterations = most(residuals, 6) && most(assemblies, 9) && most(factorisations, 5);
        let others = most(solves, 10) && most(derivatives, 9) && most(spectra, 2);
        println!("{points} points: {counts:?}");
        assert!(iterations && others, "{points} points: {counts:?}");
    }
}
