//! Temperature of the workpiece where it touches the tool.

use crate::evidence::Evidence;
use crate::observable::{Observable, ObservableArguments, argument};

/// Mean temperature of the touching particles over the last part of the run.
pub(crate) const CONTACT_TEMPERATURE: Observable = Observable {
    name: "contact_temperature",
    unit: "K",
    meaning: "mean temperature of the particles that touch the tool, weighted with the contact \
              force, over the last part of the run",
    arguments: &[argument("share", Some(0.5), "share of the run that counts, from its end")],
    evaluate: contact_temperature,
};

fn contact_temperature(
    evidence: &Evidence,
    arguments: &ObservableArguments,
) -> Result<f64, String> {
    let start = (1.0 - arguments.get("share")) * evidence.last()?.time;
    let (mut weight, mut sum) = (0.0, 0.0);
    for snapshot in evidence.snapshots().filter(|snapshot| snapshot.time >= start) {
        for (force, temperature) in snapshot.contact_force.iter().zip(&snapshot.temperature) {
            let force = force[0].hypot(force[1]).hypot(force[2]);
            weight += force;
            sum += force * temperature;
        }
    }
    if weight > 0.0 { Ok(sum / weight) } else { Err("nothing touches the tool".to_owned()) }
}
