//! Factors of a sparse matrix that serve both Newton's method and the computation of eigenvalues.

use super::{Elimination, Pencil, SparseLu};
use crate::core::failure::Failure;
use crate::core::linalg::{Border, Factorisation};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

/// Factors of a bordered sparse matrix, and the number of matrices factored so far.
#[derive(Default)]
struct Counted {
    lu: SparseLu,
    count: u64,
}

/// Factors of a bordered sparse matrix that can be [remembered](KnownFactors).
#[derive(Default)]
pub(in crate::core) struct SharedLu(Arc<Mutex<Counted>>);

/// A reference to the factors of a matrix, which is valid until the factors are dropped, or replaced by
/// the factors of another matrix.
#[derive(Default)]
pub(in crate::core) struct KnownFactors {
    factors: Weak<Mutex<Counted>>,
    count: u64,
}

fn lock(factors: &Mutex<Counted>) -> MutexGuard<'_, Counted> {
    factors.lock().unwrap_or_else(PoisonError::into_inner)
}

impl SharedLu {
    /// Factors a bordered matrix.
    ///
    /// # Errors
    /// The same errors as [`SparseLu::factor`].
    pub fn factor(
        &mut self,
        elimination: &Arc<Elimination>,
        pencil: Pencil,
        border: Border,
    ) -> Result<KnownFactors, Failure> {
        let mut counted = lock(&self.0);
        counted.count += 1;
        counted.lu.factor(elimination, (pencil, 0.0), border)?;
        Ok(KnownFactors { factors: Arc::downgrade(&self.0), count: counted.count })
    }
}

impl KnownFactors {
    /// Calls a function with the factors, or with `None` if the factors no longer exist.
    pub fn with<R>(&self, call: impl FnOnce(Option<&mut SparseLu>) -> R) -> R {
        let factors = self.factors.upgrade();
        let mut locked = factors.as_deref().map(lock);
        let known = locked.as_mut().filter(|counted| counted.count == self.count);
        call(known.map(|counted| &mut counted.lu))
    }
}

impl Factorisation for SharedLu {
    fn solve(&mut self, right: &mut [f64]) {
        lock(&self.0).lu.solve(right);
    }

    fn solve_transposed(&mut self, right: &mut [f64]) {
        lock(&self.0).lu.solve_transposed(right);
    }

    fn determinant_sign(&self) -> f64 {
        lock(&self.0).lu.determinant_sign()
    }
}
