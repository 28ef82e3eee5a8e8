//! Execution of the runs of a sweep.

use super::part::Part;
use super::plan::{Order, Plan, PlanError};
use crate::core::attractor::{Attractor, StroboscopicError, StroboscopicMap};
use crate::core::hybrid::{HybridState, Member};
use rayon::prelude::*;
use std::sync::mpsc::{Sender, channel};

/// The result of a run of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The number of the run in its sweep.
    pub run: usize,
    /// The values of the varied quantities in this run, one for each axis.
    pub values: Vec<f64>,
    /// The attractor of the run, or the reason why no attractor was found; in a search for a
    /// crisis, the last attractor before the crisis.
    pub attractor: Result<Attractor, StroboscopicError>,
    /// The location of a crisis, if one was searched for and found: two parameter values between
    /// which the attractor is destroyed; the motion stays on the attractor at the first value, and
    /// leaves it at the second value.
    pub crisis: Option<[f64; 2]>,
}

/// A function that is called for each finished run.
pub type Visit<'a> = dyn FnMut(Found) + 'a;

/// A function that creates a stroboscopic map.
pub type Make<'a> =
    dyn Fn() -> Result<Box<dyn StroboscopicMap + 'a>, StroboscopicError> + Sync + 'a;

/// Executes all unfinished runs of a part of a plan. The function `done(run)` returns `None` for an
/// unfinished run, `Some(None)` for a failed run, and otherwise the state in which the run ended.
/// `make` creates the map, once for each batch of strands (chains of dependent runs); `p` contains
/// the parameters that do not vary. If the cancel token of the search is cancelled, the runs on all
/// threads stop, each between two of its periods; unfinished runs are discarded.
///
/// ```
/// use tangency::core::attractor::{AttractorSearch, StroboscopicError, StroboscopicMap, PeriodMap};
/// use tangency::core::hybrid::{HybridSettings, HybridState};
/// use tangency::core::sweep::{Axis, Found, Order, Part, Plan, Quantity, execute};
/// use tangency::problems::classic::ImpactOscillator;
/// // The oscillator with a stop under increasing forcing: without impacts, and with one per period.
/// let start = HybridState { mode: ImpactOscillator::FLIGHT, time: 0.0, x: vec![0.0, 0.0] };
/// let axis = Axis { quantity: Quantity::Parameter(0), low: 1.0, high: 5.0, count: 3 };
/// let plan = Plan { axes: vec![axis], starts: vec![start], order: Order::Anew, strands: 1, search: AttractorSearch::default(), crisis: None };
/// let make = || -> Result<Box<dyn StroboscopicMap>, StroboscopicError> {
///     Ok(Box::new(PeriodMap::of(&ImpactOscillator, HybridSettings::default(), &[])?))
/// };
/// let mut impacts = vec![0.0; 3];
/// execute(&plan, Part::WHOLE, &[1.0, 2.2, 0.8, 0.1, 1.0], &make, &|_| None, &mut |found: Found| {
///     impacts[found.run] = found.attractor.map_or(f64::NAN, |attractor| attractor.count("impact"));
/// })?;
/// assert_eq!(impacts, [0.0, 0.0, 1.0]);
/// # Ok::<(), tangency::core::sweep::PlanError>(())
/// ```
///
/// # Errors
/// [`PlanError`] if the plan or the part is invalid, or threads cannot be started. Failed runs are
/// reported like successful runs.
pub fn execute(
    plan: &Plan,
    part: Part,
    p: &[f64],
    make: &Make,
    done: &(dyn Fn(usize) -> Option<Option<HybridState<f64>>> + Sync),
    visit: &mut Visit,
) -> Result<(), PlanError> {
    plan.check(p.len())?;
    part.check()?;
    let all = plan.strand_list();
    // Depends on the plan alone: the result of a run must not depend on the division into parts.
    let abreast = plan.crisis.is_none() && all.len() >= LEAST_ABREAST;
    let mine = all.into_iter().enumerate().filter(|(k, _)| k % part.of == part.number - 1);
    let unfinished = |strand: &Vec<usize>| strand.iter().any(|run| done(*run).is_none());
    let strands: Vec<Vec<usize>> =
        mine.map(|(_, strand)| strand).filter(|strand| unfinished(strand)).collect();
    let pool = part.pool(strands.len())?;
    let threads =
        pool.as_ref().map_or_else(rayon::current_num_threads, |p| p.current_num_threads());
    let size = if abreast { batch_size(strands.len(), threads) } else { 1 };
    let (sender, receiver) = channel();
    std::thread::scope(|scope| {
        scope.spawn(move || {
            let follow = |sender: &mut Sender<Found>, strands: &[Vec<usize>]| {
                Batch { plan, p, make, done, abreast }.follow(strands, sender);
            };
            // Each batch is a separate task, because some take much longer than others.
            let batches = || strands.par_chunks(size).with_max_len(1);
            let work = || batches().for_each_with(sender, follow);
            match pool {
                Some(pool) => pool.install(work),
                None => work(),
            }
        });
        for found in receiver {
            visit(found);
        }
    });
    Ok(())
}

/// Heuristic: the minimal number of strands (chains of dependent runs) whose runs are simulated in
/// parallel lanes: fewer strands leave too many lanes empty.
const LEAST_ABREAST: usize = 4;
/// Heuristic: the maximum number of strands (chains of dependent runs) in a batch; if the sweep is
/// interrupted, the unfinished runs of a batch are lost.
const MOST_ABREAST: usize = 64;

/// Returns the number of strands (chains of dependent runs) in a batch, such that the number of
/// batches is the number of threads or a multiple of this number.
fn batch_size(strands: usize, threads: usize) -> usize {
    let rounds = strands.div_ceil(threads * MOST_ABREAST).max(1);
    strands.div_ceil(threads * rounds).max(LEAST_ABREAST)
}

/// The outcome of a run: an attractor, and the location of its crisis if a crisis was searched for
/// and found.
type Outcome = (Result<Attractor, StroboscopicError>, Option<[f64; 2]>);

/// The data shared by all batches of runs.
struct Batch<'a, 'm> {
    plan: &'a Plan,
    p: &'a [f64],
    make: &'a Make<'m>,
    done: &'a (dyn Fn(usize) -> Option<Option<HybridState<f64>>> + Sync),
    abreast: bool,
}

impl<'m> Batch<'_, 'm> {
    /// Executes the runs of strands (chains of dependent runs): the first runs of all strands, then
    /// the second runs, and so on.
    fn follow(&self, strands: &[Vec<usize>], sender: &Sender<Found>) {
        let longest = strands.iter().map(Vec::len).max().unwrap_or(0);
        let mut before: Vec<Option<HybridState<f64>>> = vec![None; strands.len()];
        let mut map = (self.make)();
        for position in 0..longest {
            let mut runs = Vec::new();
            for (strand, before) in strands.iter().zip(&mut before) {
                let Some(run) = strand.get(position) else { continue };
                match (self.done)(*run) {
                    Some(end) => *before = end,
                    None => runs.push((*run, before)),
                }
            }
            let starts = runs.iter_mut().map(|(run, before)| self.start(*run, before.take()));
            let starts = starts.collect();
            let outcomes = self.outcomes(&mut map, starts);
            if self.plan.search.cancel.is_cancelled() {
                return;
            }
            for ((run, before), (attractor, crisis)) in runs.into_iter().zip(outcomes) {
                let found = Found { run, values: self.plan.values(run), attractor, crisis };
                *before = found.attractor.as_ref().ok().map(|found| found.end.clone());
                if sender.send(found).is_err() {
                    return;
                }
            }
        }
    }

    /// Returns the starting state and the parameters of a run, given the final state of the
    /// preceding run of its strand.
    fn start(&self, run: usize, before: Option<HybridState<f64>>) -> Member<f64> {
        let (p, start) = self.plan.setting(run, self.p);
        let followed = self.plan.order != Order::Anew;
        Member { state: before.filter(|_| followed).unwrap_or(start), p }
    }

    /// Returns the outcomes of runs that are simulated together.
    fn outcomes(
        &self,
        map: &mut Result<Box<dyn StroboscopicMap + 'm>, StroboscopicError>,
        starts: Vec<Member<f64>>,
    ) -> Vec<Outcome> {
        let map = match map {
            Ok(map) => &mut **map,
            Err(error) => return starts.iter().map(|_| (Err(error.clone()), None)).collect(),
        };
        let Plan { search, crisis, .. } = self.plan;
        if self.abreast {
            let found = search.follow_all(map, starts);
            return found.into_iter().map(|found| (found, None)).collect();
        }
        let follow = |Member { state, p }: Member<f64>| match crisis {
            None => (search.follow(map, state, &p), None),
            Some(sought) => match search.crisis(map, state, &p, sought) {
                Ok(found) => (Ok(found.attractor), Some(found.between)),
                Err(cause) => (Err(cause), None),
            },
        };
        starts.into_iter().map(follow).collect()
    }
}
