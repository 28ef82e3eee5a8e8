//! Work that is cancelled from another thread ends early, on all threads.

use std::num::NonZeroUsize;
use std::thread;
use std::time::Duration;
use tangency::core::attractor::{AttractorSearch, PeriodMap, StroboscopicError, StroboscopicMap};
use tangency::core::bvp::{BoundarySystem, Collocation, Mesh};
use tangency::core::cancel::CancelToken;
use tangency::core::continuation::{Continuation, End, Settings, TraceError};
use tangency::core::failure::{Failure, FlowError};
use tangency::core::hybrid::{HybridSettings, HybridState};
use tangency::core::linalg::Chain;
use tangency::core::local_map::{GrazingError, GrazingPoint, LocalMap, MapSettings};
use tangency::core::orbit::{HybridOrbit, Itinerary};
use tangency::core::sweep::{Axis, Order, Part, Plan, Quantity, execute};
use tangency::problems::classic::{Bratu, ImpactOscillator};

/// Runs `work` while another thread cancels a token.
fn cancelled_meanwhile<R>(cancel: &CancelToken, work: impl FnOnce() -> R) -> R {
    thread::scope(|scope| {
        scope.spawn(|| {
            thread::sleep(Duration::from_millis(20));
            cancel.cancel();
        });
        work()
    })
}

/// Runs that would take for ever end on both threads, and are not found.
#[test]
fn runs_end_on_all_threads() {
    let cancel = CancelToken::default();
    let transient = 1_000_000_000;
    let search =
        AttractorSearch { transient, cancel: cancel.clone(), ..AttractorSearch::default() };
    let start = HybridState { mode: ImpactOscillator::FLIGHT, time: 0.0, x: vec![0.0, 0.0] };
    let axis = Axis { quantity: Quantity::Parameter(0), low: 4.5, high: 5.0, count: 3 };
    let (axes, starts) = (vec![axis], vec![start]);
    let plan = Plan { axes, starts, order: Order::Anew, strands: 1, search, crisis: None };
    let make = || -> Result<Box<dyn StroboscopicMap>, StroboscopicError> {
        Ok(Box::new(PeriodMap::of(&ImpactOscillator, HybridSettings::default(), &[])?))
    };
    let part = Part { threads: NonZeroUsize::new(2), ..Part::WHOLE };
    let mut found = 0;
    cancelled_meanwhile(&cancel, || {
        execute(&plan, part, &[1.0, 2.2, 0.8, 0.1, 1.0], &make, &|_| None, &mut |_| found += 1)
    })
    .unwrap();
    assert_eq!(found, 0);
}

/// A chain of identical intervals, none of which is singular, long enough to be cancelled within
/// its factorisation.
#[test]
fn a_long_factorisation_ends_between_intervals() {
    let (n, intervals) = (24, 20_000);
    let row = |i: usize| (0..2 * n).map(move |j| if j == i { -1.0 } else { f64::from(j == n + i) });
    let block: Vec<f64> = (0..n).flat_map(row).collect();
    let blocks = block.repeat(intervals);
    let mut chain = Chain::new(intervals, 1, n);
    let cancel = CancelToken::default();
    chain.cancel = cancel.clone();
    let outcome = cancelled_meanwhile(&cancel, || chain.factor(&blocks, &[], 0, &[], 0));
    assert!(matches!(outcome, Err(Failure::Cancelled(_))), "{outcome:?}");
}

/// A branch that is cancelled before it begins does not start; cancelled after its fifth item, it
/// keeps its points.
#[test]
fn a_cancelled_branch_keeps_its_points() {
    let mesh = vec![Mesh::uniform(10)];
    let mut bratu = BoundarySystem::new(Bratu, Collocation::new(4).unwrap(), mesh).unwrap();
    let cancel = CancelToken::default();
    let settings = Settings { cancel: cancel.clone(), ..Settings::default() };
    let mut steps = Continuation::new(&mut bratu)
        .at("lambda", 0.5)
        .along("lambda", 0.0..=4.0)
        .settings(settings.clone())
        .steps()
        .unwrap();
    let items = steps.by_ref().take(5).count();
    cancel.cancel();
    let branch = steps.finish();
    assert!((items - 1..=items).contains(&branch.points.len()));
    assert_eq!(branch.ends[1], End::Interrupted);
    let again = Continuation::new(&mut bratu)
        .at("lambda", 0.5)
        .along("lambda", 0.0..=4.0)
        .settings(settings)
        .trace();
    assert!(matches!(again, Err(TraceError::Start { .. })), "{again:?}");
}

/// A local map that is cancelled is not computed.
#[test]
fn local_maps_are_cancelled() {
    let orbit =
        HybridOrbit::of(ImpactOscillator, Itinerary::smooth(ImpactOscillator::FLIGHT, 1)).unwrap();
    let point = GrazingPoint::of(&orbit, &[0.0, 1.0], &[0.1, 1.0, 0.8, 0.1, 1.0]).unwrap();
    let cancel = CancelToken::default();
    let map = || {
        let settings = MapSettings { cancel: cancel.clone(), ..MapSettings::default() };
        LocalMap::of(&ImpactOscillator, &point, &["amplitude"], settings)
    };
    assert!(map().is_ok());
    cancel.cancel();
    let cancelled = map().unwrap_err();
    assert!(
        matches!(cancelled, GrazingError::Flow { source: FlowError::Cancelled(_), .. }),
        "{cancelled}"
    );
}
