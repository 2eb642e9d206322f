//! Runs the runs of a plan on the cores of this machine.
//!
//! The costliest come first, each on one thread; when fewer are left than cores are free, a run gets several.
//! The bits are the same for any number of threads.

use crate::plan::{PlannedRun, SweepPlan};
use crate::store::{Claim, ResultEntry, RunFailure, Store, StoreError, Work};
use crate::{Address, Sweep};
use sphcut_scenario::Scenario;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard};
use std::time::{Duration, Instant};

/// How often runs that other processes compute are asked for.
const PATIENCE: Duration = Duration::from_millis(100);

/// Told how much of a run is done, as a share, and how many seconds are left, once that is known.
pub type Watch<'w> = dyn FnMut(f64, Option<f64>) + Send + 'w;

/// Computes one run in a folder.
pub trait Worker: Sync {
    /// Computes `scenario` in `folder` on `threads` threads, going on with what is there, and leaves the
    /// results in it. `watch` is told now and then how far it is and how many seconds are left.
    ///
    /// # Errors
    /// Why there is no result.
    fn compute(
        &self,
        scenario: &Scenario,
        folder: &Path,
        threads: usize,
        watch: &mut Watch<'_>,
    ) -> Result<Computed, Trouble>;

    /// Whether everything is to stop; runs are then interrupted with a checkpoint.
    fn stopping(&self) -> bool;
}

/// How a computation ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Computed {
    /// The results are there.
    Finished {
        /// Particles.
        particles: usize,
        /// Steps.
        steps: u64,
        /// Wall-clock time in s, earlier parts included.
        wall_seconds: f64,
    },
    /// A checkpoint is written.
    Interrupted,
}

/// Why a run has no result.
#[derive(Debug, Clone, PartialEq)]
pub enum Trouble {
    /// It would be the same again: noted in the store.
    Lasting(String),
    /// A full disk and the like: the next sweep goes on with it.
    Passing(String),
}

/// What becomes of a run.
#[derive(Debug, Clone, PartialEq)]
pub enum State {
    /// It waits for a core.
    Waiting,
    /// It is computed here, on so many threads.
    Running(usize),
    /// Another process computes it.
    Elsewhere,
    /// It was there, or another process has finished it.
    Reused,
    /// Computed by this sweep.
    Finished,
    /// It cannot finish, for this reason.
    Failed(String),
    /// Interrupted, or not begun when everything stopped.
    Stopped,
}

/// News of a run; `index` is its place in the plan.
#[derive(Debug, Clone, PartialEq)]
pub enum News {
    /// Its state has changed.
    State {
        /// Place in the plan.
        index: usize,
        /// The new state.
        state: State,
    },
    /// How far it is.
    Progress {
        /// Place in the plan.
        index: usize,
        /// Share that is done.
        share: f64,
        /// Seconds left, once they can be told.
        remaining: Option<f64>,
    },
}

/// How to run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Execution {
    /// Threads of all runs together.
    pub threads: usize,
    /// Whether runs that are known to fail are tried again.
    pub retry: Retry,
}

/// What to do with runs that are known to fail.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Retry {
    /// Leave them.
    Never,
    /// Run them again.
    Failed,
}

/// Runs what is missing of `plan` and says what became of every run, in its order.
///
/// # Errors
/// A store that cannot be read or written. Runs that fail are no error: see [`State::Failed`].
pub fn execute(
    sweep: &Sweep,
    plan: &SweepPlan,
    store: &Store,
    execution: Execution,
    worker: &dyn Worker,
    news: &(dyn Fn(News) + Sync),
) -> Result<Vec<State>, StoreError> {
    let desk = Desk {
        sweep,
        plan,
        store,
        execution,
        worker,
        news,
        board: Mutex::new(Board::new(plan, execution.threads)),
        change: Condvar::new(),
        broken: AtomicBool::new(false),
    };
    desk.look()?;
    std::thread::scope(|scope| {
        for _ in 0..execution.threads.min(plan.runs.len()).max(1) {
            scope.spawn(|| desk.work());
        }
    });
    let board = desk.board.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    match board.error {
        Some(error) => Err(error),
        None => Ok(board.states),
    }
}

/// What the threads share.
struct Board {
    states: Vec<State>,
    /// Places in the plan that nobody has taken, the costliest last.
    pending: Vec<usize>,
    /// Those that another process computes.
    elsewhere: Vec<usize>,
    free: usize,
    error: Option<StoreError>,
}

impl Board {
    fn new(plan: &SweepPlan, threads: usize) -> Self {
        let states = vec![State::Waiting; plan.runs.len()];
        Self { states, pending: Vec::new(), elsewhere: Vec::new(), free: threads, error: None }
    }
}

struct Desk<'a> {
    sweep: &'a Sweep,
    plan: &'a SweepPlan,
    store: &'a Store,
    execution: Execution,
    worker: &'a dyn Worker,
    news: &'a (dyn Fn(News) + Sync),
    board: Mutex<Board>,
    change: Condvar,
    broken: AtomicBool,
}

/// What there is to do next.
enum Next {
    Run(usize, usize),
    Ask(usize),
    Nothing,
}

impl Desk<'_> {
    fn lock(&self) -> MutexGuard<'_, Board> {
        // A thread that panicked did so outside: every change of the board is complete.
        self.board.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }

    /// Sorts out what is there already, and what is to be run once only although it is planned twice.
    fn look(&self) -> Result<(), StoreError> {
        let mut order: Vec<usize> = Vec::new();
        let mut first: BTreeMap<Address, usize> = BTreeMap::new();
        for (index, run) in self.plan.runs.iter().enumerate() {
            if self.store.has(&run.address) {
                self.tell(index, State::Reused);
            } else if self.execution.retry == Retry::Never
                && let Some(failure) = self.store.failure(&run.address)?
            {
                self.tell(index, State::Failed(failure.reason));
            } else if first.insert(run.address, index).is_none() {
                order.push(index);
            } else {
                // It is the same run as an earlier one: asked for when that is done.
                self.lock().elsewhere.push(index);
            }
        }
        let cost = |index: &usize| self.plan.runs[*index].cost.updates();
        order.sort_by(|a, b| cost(a).total_cmp(&cost(b)).then(b.cmp(a)));
        self.lock().pending = order;
        Ok(())
    }

    fn tell(&self, index: usize, state: State) {
        self.lock().states[index] = state.clone();
        (self.news)(News::State { index, state });
    }

    /// What one thread does until nothing is left.
    fn work(&self) {
        loop {
            match self.next() {
                Next::Nothing => return,
                Next::Run(index, threads) => {
                    self.attempt(index, threads);
                    self.lock().free += threads;
                    self.change.notify_all();
                }
                Next::Ask(index) => self.ask(index),
            }
        }
    }

    fn stops(&self) -> bool {
        self.worker.stopping() || self.broken.load(Ordering::Relaxed)
    }

    fn next(&self) -> Next {
        let mut board = self.lock();
        loop {
            if self.stops() {
                for index in
                    board.pending.split_off(0).into_iter().chain(board.elsewhere.split_off(0))
                {
                    board.states[index] = State::Stopped;
                }
                return Next::Nothing;
            }
            if !board.pending.is_empty() && board.free > 0 {
                // As many threads as leave one for each of the others.
                let threads = (board.free / board.pending.len()).max(1);
                let Some(index) = board.pending.pop() else { return Next::Nothing };
                board.free -= threads;
                return Next::Run(index, threads);
            }
            let idle = board.free == self.execution.threads;
            if board.pending.is_empty() && board.elsewhere.is_empty() {
                return Next::Nothing;
            }
            // Runs that others compute are asked for when nothing else is to be begun.
            if board.pending.is_empty() && (idle || board.free > 0) && !board.elsewhere.is_empty() {
                let index = board.elsewhere.remove(0);
                drop(board);
                std::thread::sleep(PATIENCE);
                return Next::Ask(index);
            }
            let waited = self.change.wait_timeout(board, PATIENCE);
            board = waited.unwrap_or_else(std::sync::PoisonError::into_inner).0;
        }
    }

    /// Asks for a run that another process, or this one under another number, computes.
    fn ask(&self, index: usize) {
        let address = &self.plan.runs[index].address;
        if self.store.has(address) {
            return self.tell(index, State::Reused);
        }
        match self.store.failure(address) {
            Ok(Some(failure)) if !self.is_to_be_retried(index) => {
                self.tell(index, State::Failed(failure.reason));
            }
            Ok(_) => self.lock().pending.push(index),
            Err(error) => self.give_up(error),
        }
        self.change.notify_all();
    }

    /// A failure that this sweep has seen itself is final.
    fn is_to_be_retried(&self, index: usize) -> bool {
        let address = self.plan.runs[index].address;
        let board = self.lock();
        let mut same =
            self.plan.runs.iter().zip(&board.states).filter(|(run, _)| run.address == address);
        self.execution.retry == Retry::Failed
            && !same.any(|(_, state)| matches!(state, State::Failed(_)))
    }

    fn give_up(&self, error: StoreError) {
        self.broken.store(true, Ordering::Relaxed);
        self.lock().error.get_or_insert(error);
        self.change.notify_all();
    }

    /// Claims a run and computes it.
    fn attempt(&self, index: usize, threads: usize) {
        let address = &self.plan.runs[index].address;
        let claim = if self.is_to_be_retried(index) {
            self.store.claim_again(address)
        } else {
            self.store.claim(address)
        };
        match claim {
            Ok(Claim::Done) => self.tell(index, State::Reused),
            Ok(Claim::Failed(failure)) => self.tell(index, State::Failed(failure.reason)),
            Ok(Claim::Busy) => {
                if self.lock().states[index] != State::Elsewhere {
                    self.tell(index, State::Elsewhere);
                }
                self.lock().elsewhere.push(index);
            }
            Ok(Claim::Mine(work)) => {
                self.tell(index, State::Running(threads));
                match self.compute(index, threads, work) {
                    Ok(state) => self.tell(index, state),
                    Err(error) => {
                        self.tell(index, State::Failed(error.to_string()));
                        self.give_up(error);
                    }
                }
            }
            Err(error) => {
                self.tell(index, State::Failed(error.to_string()));
                self.give_up(error);
            }
        }
    }

    fn compute(&self, index: usize, threads: usize, work: Work) -> Result<State, StoreError> {
        let run = &self.plan.runs[index];
        let values: Vec<&str> = run.values.iter().map(String::as_str).collect();
        let scenario = match self.sweep.scenario(&values) {
            Ok(scenario) => scenario,
            // It was read when the sweep was planned: a file it names has changed since.
            Err(unfit) => return Ok(State::Failed(unfit.problems[0].mistake.message())),
        };
        if crate::address(&scenario) != run.address {
            return Ok(State::Failed(
                "a file of the scenario has changed since the start".to_owned(),
            ));
        }
        let start = Instant::now();
        let mut watch = |share, remaining| (self.news)(News::Progress { index, share, remaining });
        let folder = work.folder().to_owned();
        let computed = catch_unwind(AssertUnwindSafe(|| {
            self.worker.compute(&scenario, &folder, threads, &mut watch)
        }));
        match computed {
            Ok(Ok(Computed::Finished { particles, steps, wall_seconds })) => {
                self.store.keep_scenario(&work, &scenario.text)?;
                let entry = entry(run, &scenario, (particles, steps), wall_seconds, threads);
                self.store.publish(work, entry).map(|_| State::Finished)
            }
            Ok(Ok(Computed::Interrupted)) => Ok(State::Stopped),
            Ok(Err(Trouble::Passing(reason))) => Ok(State::Failed(reason)),
            Ok(Err(Trouble::Lasting(reason))) => self.refused(work, &reason, start),
            Err(panic) => {
                let reason = format!("sphcut has a bug: {}", panic_text(panic.as_ref()));
                self.refused(work, &reason, start)
            }
        }
    }

    fn refused(&self, work: Work, reason: &str, start: Instant) -> Result<State, StoreError> {
        let failure: RunFailure = self.store.refuse(work, reason, start.elapsed().as_secs_f64())?;
        Ok(State::Failed(failure.reason))
    }
}

fn entry(
    run: &PlannedRun,
    scenario: &Scenario,
    (particles, steps): (usize, u64),
    wall_seconds: f64,
    threads: usize,
) -> ResultEntry {
    ResultEntry {
        address: run.address,
        title: scenario.title.clone(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        results_version: u64::from(sphcut_sph::RESULTS_VERSION),
        particles: particles as u64,
        steps,
        wall_seconds,
        threads: threads as u64,
        files: Vec::new(),
    }
}

fn panic_text(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "a panic".to_owned())
}
