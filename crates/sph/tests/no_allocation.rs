//! Once a cut is under way, a step asks the allocator for nothing.

#[allow(dead_code, reason = "other tests use the rest")]
mod support;

use sphcut_sph::setup::{Lattice, Setup};
use sphcut_sph::{Simulation, Stage};
use support::cut;

/// Requests to the allocator in the second half of a run.
#[derive(Debug, Default)]
struct Requests {
    renewals: u64,
    /// In steps without a renewal, besides the one for the values of a sample.
    between: u64,
    /// In steps with a renewal: a list that has outgrown its room.
    at_renewals: u64,
}

fn requests(setup: Setup) -> Requests {
    let mut simulation = Simulation::new(setup).unwrap();
    let half = 0.5 * simulation.setup().end_time;
    let mut requests = Requests::default();
    // The counts are those of the thread that asks, which does all the work.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| {
        while !simulation.is_finished() {
            let (mut updated, mut sampled) = (false, false);
            let counts = allocation_counter::measure(|| {
                let mut passed = |stage| updated |= stage == Stage::ReferenceUpdate;
                sampled = simulation.step_observed(&mut passed).unwrap().sample.is_some();
            });
            if simulation.time() < half {
                continue;
            }
            let asked = counts.count_total - u64::from(sampled);
            if updated {
                requests.renewals += 1;
                requests.at_renewals += asked;
            } else {
                requests.between += asked;
            }
        }
    });
    requests
}

#[test]
fn a_step_allocates_nothing() {
    let mut setup = cut(0.0, Lattice::Square);
    setup.end_time *= 4.0;
    let found = requests(setup);
    assert!(found.renewals >= 20, "{found:?}");
    assert_eq!(found.between, 0, "{found:?}");
    // Twice as much room each time: a few times in a run, not in every renewal.
    assert!(found.at_renewals <= found.renewals / 2, "{found:?}");
}
