//! A plane shock that runs along x from the plane x = 0 where two plates met.

use crate::evidence::Evidence;
use crate::observable::{Observable, ObservableArguments, argument};
use sphcut_sph::Snapshot;

/// Speed of the shock through the undeformed material.
pub(crate) const SHOCK_SPEED: Observable = Observable {
    name: "shock_speed",
    unit: "m/s",
    meaning: "undeformed distance that the front, where half of the speed of approach is left, covers between two snapshots, over the time between them",
    arguments: &[
        argument("early", None, "time of the first snapshot in s"),
        argument("late", None, "time of the second snapshot in s"),
    ],
    evaluate: |evidence, arguments| {
        let front = |time: f64| {
            let snapshot = nearest(evidence, time)?;
            Ok::<_, String>((snapshot.time, front(evidence, snapshot)?))
        };
        let (early, late) = (front(arguments.get("early"))?, front(arguments.get("late"))?);
        if late.0 <= early.0 {
            return Err("the two times fall on the same snapshot".to_owned());
        }
        Ok((late.1 - early.1) / (late.0 - early.0))
    },
};

/// The slab behind the front over which the next observables average, in undeformed distances.
const FROM: crate::observable::Argument =
    argument("from", None, "undeformed x where the slab begins in m");
const TO: crate::observable::Argument =
    argument("to", None, "undeformed x where the slab ends in m");

/// Pressure behind the shock.
pub(crate) const SHOCKED_PRESSURE: Observable = Observable {
    name: "shocked_pressure",
    unit: "Pa",
    meaning: "mean pressure at the end of the particles that started between two places along x",
    arguments: &[FROM, TO],
    evaluate: |evidence, arguments| mean(evidence, arguments, |snapshot, i| snapshot.pressure[i]),
};

/// Temperature behind the shock.
pub(crate) const SHOCKED_TEMPERATURE: Observable = Observable {
    name: "shocked_temperature",
    unit: "K",
    meaning: "mean temperature at the end of the particles that started between two places along x",
    arguments: &[FROM, TO],
    evaluate: |evidence, arguments| {
        mean(evidence, arguments, |snapshot, i| snapshot.temperature[i])
    },
};

/// Density behind the shock.
pub(crate) const SHOCKED_DENSITY: Observable = Observable {
    name: "shocked_density",
    unit: "kg/m^3",
    meaning: "mean density at the end of the particles that started between two places along x",
    arguments: &[FROM, TO],
    evaluate: |evidence, arguments| mean(evidence, arguments, |snapshot, i| snapshot.density[i]),
};

fn nearest(evidence: &Evidence, time: f64) -> Result<&Snapshot, String> {
    let distance = |snapshot: &&Snapshot| (snapshot.time - time).abs();
    evidence
        .snapshots()
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
        .ok_or_else(|| "the run has no snapshots".to_owned())
}

/// Undeformed x and mean speed along x of the columns of particles ahead of x = 0, from the free
/// end on.
fn profile(evidence: &Evidence, snapshot: &Snapshot) -> Result<Vec<(f64, f64)>, String> {
    let mut particles: Vec<(f64, f64)> = origins(evidence, snapshot)?
        .into_iter()
        .zip(&snapshot.velocity)
        .filter(|(x, _)| *x > 0.0)
        .map(|(x, velocity)| (x, velocity[0].abs()))
        .collect();
    particles.sort_by(|a, b| b.0.total_cmp(&a.0));
    let half_a_spacing = 0.5 * evidence.setup.particle_spacing;
    let columns = particles.chunk_by(|a, b| a.0 - b.0 < half_a_spacing).map(|column| {
        let speed: f64 = column.iter().map(|particle| particle.1).sum();
        (column[0].0, speed / column.len() as f64)
    });
    Ok(columns.collect())
}

/// Undeformed x of the particles of a snapshot.
fn origins(evidence: &Evidence, snapshot: &Snapshot) -> Result<Vec<f64>, String> {
    let first = evidence.first()?;
    if first.id != snapshot.id {
        return Err("the snapshots do not hold the same particles".to_owned());
    }
    Ok(first.position.iter().map(|position| position[0]).collect())
}

/// Undeformed x where the speed falls through half of that at the free end.
fn front(evidence: &Evidence, snapshot: &Snapshot) -> Result<f64, String> {
    let profile = profile(evidence, snapshot)?;
    let half = 0.5 * profile.first().ok_or("no particles ahead of the plane of impact")?.1;
    let behind = profile.iter().position(|(_, speed)| *speed < half).filter(|place| *place > 0);
    let place = behind.ok_or("the front is not inside the plate")?;
    let (slow, fast) = (profile[place], profile[place - 1]);
    Ok(slow.0 + (fast.0 - slow.0) * (half - slow.1) / (fast.1 - slow.1))
}

fn mean(
    evidence: &Evidence,
    arguments: &ObservableArguments,
    value: fn(&Snapshot, usize) -> f64,
) -> Result<f64, String> {
    let snapshot = evidence.last()?;
    let slab = arguments.get("from")..=arguments.get("to");
    let origins = origins(evidence, snapshot)?;
    let inside: Vec<usize> = (0..origins.len()).filter(|i| slab.contains(&origins[*i])).collect();
    if inside.is_empty() {
        return Err("no particle started inside the slab".to_owned());
    }
    let sum: f64 = inside.iter().map(|i| value(snapshot, *i)).sum();
    Ok(sum / inside.len() as f64)
}
