//! Doing the runs.

use super::plan::{Order, Part, Plan, PlanError};
use crate::core::attractor::{Settled, StrobeError, Strobed};
use crate::core::hybrid::HybridState;
use rayon::prelude::*;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Sender, channel};

/// What a run has found.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The run.
    pub run: usize,
    /// The values on the axes.
    pub values: Vec<f64>,
    /// What it has settled on, or why it did not; where a crisis was sought, the last attractor before it.
    pub settled: Result<Settled, StrobeError>,
    /// Where a crisis was sought and found: on the attractor, and off it.
    pub crisis: Option<[f64; 2]>,
}

impl Found {
    /// The state from which the next run of its strand goes on.
    fn end(&self) -> Option<HybridState<f64>> {
        self.settled.as_ref().ok().map(|settled| settled.end.clone())
    }
}

/// Sees a run that is done; the sweep may be ended.
pub type Visit<'a> = dyn FnMut(Found) -> ControlFlow<()> + 'a;

/// Makes a motion.
pub type Make<'a> = dyn Fn() -> Result<Box<dyn Strobed + 'a>, StrobeError> + Sync + 'a;

/// Does all runs of a part of a plan but those that are done already: `done` gives the state in which a run ended
/// (`None` inside if it failed). `make` makes the motion, once for each strand; `p` are the parameters
/// that do not vary.
///
/// ```
/// use std::ops::ControlFlow;
/// use tangency::core::attractor::{Settling, StrobeError, Strobed, Stroboscope};
/// use tangency::core::hybrid::{HybridSettings, HybridState};
/// use tangency::core::sweep::{Axis, Found, Order, Part, Plan, Quantity, execute};
/// use tangency::problems::classic::ImpactOscillator;
/// // The oscillator with a stop under a growing forcing: without impacts, and with one in every period.
/// let start = HybridState { mode: ImpactOscillator::FLIGHT, time: 0.0, x: vec![0.0, 0.0] };
/// let axis = Axis { quantity: Quantity::Parameter(0), low: 1.0, high: 5.0, count: 3 };
/// let plan = Plan { axes: vec![axis], starts: vec![start], order: Order::Anew, strands: 1, settling: Settling::default(), crisis: None };
/// let make = || -> Result<Box<dyn Strobed>, StrobeError> {
///     Ok(Box::new(Stroboscope::of(&ImpactOscillator, HybridSettings::default(), &[])?))
/// };
/// let mut impacts = vec![0.0; 3];
/// execute(&plan, Part::WHOLE, &[1.0, 2.2, 0.8, 0.1, 1.0], &make, &|_| None, &mut |found: Found| {
///     impacts[found.run] = found.settled.map_or(f64::NAN, |settled| settled.count("impact"));
///     ControlFlow::Continue(())
/// })?;
/// assert_eq!(impacts, [0.0, 0.0, 1.0]);
/// # Ok::<(), tangency::core::sweep::PlanError>(())
/// ```
///
/// # Errors
/// [`PlanError`] if the plan or the part has no meaning, or threads are refused. Runs that fail are found like others.
pub fn execute(
    plan: &Plan,
    part: Part,
    p: &[f64],
    make: &Make,
    done: &(dyn Fn(usize) -> Option<Option<HybridState<f64>>> + Sync),
    visit: &mut Visit,
) -> Result<(), PlanError> {
    plan.check()?;
    let Part { number, of, .. } = part;
    if number == 0 || number > of {
        return Err(PlanError::Part { number, of });
    }
    let mine = plan.strand_list().into_iter().enumerate().filter(|(k, _)| k % of == number - 1);
    let strands: Vec<Vec<usize>> = mine.map(|(_, strand)| strand).collect();
    let pool = part.pool()?;
    let stop = AtomicBool::new(false);
    let (sender, receiver) = channel();
    std::thread::scope(|scope| {
        let stop = &stop;
        scope.spawn(move || {
            let follow = |sender: &mut Sender<Found>, strand: &Vec<usize>| {
                Strand { plan, p, make, done, stop }.follow(strand, sender);
            };
            // Each strand is a task of its own: some take much longer than others.
            let work = || strands.par_iter().with_max_len(1).for_each_with(sender, follow);
            match pool {
                Some(pool) => pool.install(work),
                None => work(),
            }
        });
        for found in receiver {
            if !stop.load(Ordering::Relaxed) && visit(found).is_break() {
                stop.store(true, Ordering::Relaxed);
            }
        }
    });
    Ok(())
}

/// What all strands share.
struct Strand<'a, 'm> {
    plan: &'a Plan,
    p: &'a [f64],
    make: &'a Make<'m>,
    done: &'a (dyn Fn(usize) -> Option<Option<HybridState<f64>>> + Sync),
    stop: &'a AtomicBool,
}

impl<'m> Strand<'_, 'm> {
    /// Does the runs of a strand, one after the other.
    fn follow(&self, strand: &[usize], sender: &Sender<Found>) {
        let mut motion = None;
        let mut before: Option<HybridState<f64>> = None;
        for &run in strand {
            if self.stop.load(Ordering::Relaxed) {
                return;
            }
            if let Some(end) = (self.done)(run) {
                before = end;
                continue;
            }
            let found = self.run(run, &mut motion, before.take());
            before = found.end();
            if sender.send(found).is_err() {
                return;
            }
        }
    }

    fn run(
        &self,
        run: usize,
        motion: &mut Option<Box<dyn Strobed + 'm>>,
        before: Option<HybridState<f64>>,
    ) -> Found {
        let (p, start) = self.plan.setting(run, self.p);
        let followed = self.plan.order != Order::Anew;
        let state = before.filter(|_| followed).unwrap_or(start);
        let made = match motion.take() {
            Some(motion) => Ok(motion),
            None => (self.make)(),
        };
        let Plan { settling, crisis: sought, .. } = self.plan;
        let settled = made.and_then(|made| {
            let motion = &mut **motion.insert(made);
            let Some(search) = sought else {
                return Ok((settling.follow(motion, state, &p)?, None));
            };
            let found = settling.crisis(motion, state, &p, search)?;
            Ok((found.attractor, Some(found.between)))
        });
        let crisis = settled.as_ref().ok().and_then(|(_, crisis)| *crisis);
        let settled = settled.map(|(settled, _)| settled);
        Found { run, values: self.plan.values(run), settled, crisis }
    }
}
