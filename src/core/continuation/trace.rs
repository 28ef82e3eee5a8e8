//! Computation of the branch of a specified curve.

use super::branch::Branch;
use super::builder::Continuation;
use super::error::TraceError;
use super::resolve::resolve;
use super::start::begin;
use super::steps::Steps;

impl<'a> Continuation<'a> {
    /// Traces the curve.
    ///
    /// # Errors
    /// [`TraceError`] if the continuation cannot start. An error after the start ends the branch
    /// with a reason ([`Branch::ends`]), and the computed points are kept.
    pub fn trace(self) -> Result<Branch, TraceError> {
        Ok(self.steps()?.run(&mut ()))
    }

    /// Starts to trace the curve. The returned [`Steps`] computes the branch point by point, or as
    /// a whole with an observer ([`Steps::run`]).
    ///
    /// # Errors
    /// The same errors as for [`trace`](Continuation::trace).
    pub fn steps(mut self) -> Result<Steps<'a>, TraceError> {
        self.errors.extend(self.settings.check().err().map(TraceError::from));
        match self.errors.len() {
            0 => prepare(self),
            1 => Err(self.errors.remove(0)),
            _ => Err(TraceError::Several(self.errors)),
        }
    }
}

/// Prepares the continuation of a curve up to its first step.
fn prepare(mut curve: Continuation) -> Result<Steps, TraceError> {
    let end = std::mem::take(&mut curve.end);
    let (resolved, start) = resolve(&mut curve)?;
    let (branch, names) = (curve.name.clone(), curve.system.names());
    let values = &curve.x[names.dimension()..];
    let at = |&p: &usize| format!("{} = {}", names.parameters[p], values[p]);
    let place: Vec<String> = resolved.released.iter().map(at).collect();
    let mut steps = begin(curve, resolved, &start).map_err(|cause| {
        let (place, cause) = (place.join(", "), Box::new(cause));
        TraceError::Start { branch, place, cause }
    })?;
    let Steps { bounds, curve, start, settings, .. } = &mut steps;
    bounds.return_to((&end, settings.max_step), curve, start);
    steps.bounds.check(&steps.start, &steps.curve.detector.events)?;
    Ok(steps)
}
