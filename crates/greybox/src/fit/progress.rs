//! How much of a fit is done.

use super::Report;
use crate::regressor::Method;
use std::sync::atomic::{AtomicU64, Ordering};

/// Rough cost of a task.
pub(super) fn weight(method: Method) -> u64 {
    match method {
        Method::Linear | Method::Quadratic | Method::Quartic => 1,
        Method::Forest | Method::Boosting => 40,
        Method::GaussianProcess => 60,
        Method::SupportVector => 60,
        Method::Network => 150,
    }
}

/// Counts what is done.
pub(super) struct FitProgress<'a> {
    total: u64,
    done: AtomicU64,
    report: &'a Report<'a>,
}

impl<'a> FitProgress<'a> {
    pub(super) fn new(total: u64, report: &'a Report<'a>) -> Self {
        Self { total, done: AtomicU64::new(0), report }
    }

    pub(super) fn advance(&self, method: Method) {
        let done = self.done.fetch_add(weight(method), Ordering::Relaxed) + weight(method);
        (self.report)((done as f64 / self.total.max(1) as f64).min(1.0), method.name());
    }
}
