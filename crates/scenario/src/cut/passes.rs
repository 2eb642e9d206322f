//! `[passes]`: several passes of the tool, each on the surface that the ones before have left.
//!
//! ```text
//! cut      along the cut from `clearance` before the start (the first pass: from the start)
//! draw     back and up by `clearance` and the depth: both faces leave the material at once
//! return   through the air to before the start, moved on along the feed
//! descend  to the depth of the next pass, before the workpiece
//! ```

use crate::sections;
use sphcut_input::findings::Findings;
use sphcut_input::problem::Mistake;
use sphcut_input::reader;
use sphcut_input::record::Record;
use sphcut_input::units::significant;
use sphcut_physics::Quantity;
use sphcut_sph::setup::{Pass, Vector, VelocityChange};

/// Default of `shortening` in depths.
const SHORTENING: f64 = 5.0;
/// Default of `clearance` in depths.
const CLEARANCE: f64 = 2.0;
/// Default of `return_speed` in cutting speeds.
const RETURN_SPEED: f64 = 10.0;

/// How often the tool cuts and how it returns. Lengths in m, speeds in m/s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Passes {
    pub(crate) count: u32,
    pub(crate) shortening: f64,
    pub(crate) clearance: f64,
    pub(crate) return_speed: f64,
}

impl Passes {
    /// One pass from start to end.
    pub(crate) const ONE: Self =
        Self { count: 1, shortening: 0.0, clearance: 0.0, return_speed: 0.0 };
}

/// What of the cut decides on the motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PassPlan {
    /// End of the first pass in m from the start.
    pub(crate) travel: f64,
    pub(crate) cutting_speed: f64,
    /// Depth of the first pass below the uncut surface in m.
    pub(crate) depth: f64,
    /// From one pass to the next, in the frame of the cut: downwards or along the feed.
    pub(crate) step: Vector,
}

/// The motion of the tool in the frame of the cut.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PassMotion {
    pub(crate) velocity_changes: Vec<VelocityChange>,
    /// Empty for one pass.
    pub(crate) passes: Vec<Pass>,
    pub(crate) end_time: f64,
}

/// `[passes]`; one pass without it.
pub(crate) fn passes(
    findings: &mut Findings,
    root: &Record<'_>,
    plan: Option<PassPlan>,
) -> Option<Passes> {
    let Some(table) = root.table("passes") else { return Some(Passes::ONE) };
    let record = reader::read(findings, &root.source, table, &sections::passes(), 2);
    refuse_steady(findings, root);
    let plan = plan?;
    let mut length = |key, quantity, default: f64| match record.is_written(key) {
        true => record.number(key),
        false => {
            findings.derived("passes", key, quantity, default);
            Some(default)
        }
    };
    let shortening = length("shortening", Quantity::Length, SHORTENING * plan.depth)?;
    let clearance = length("clearance", Quantity::Length, CLEARANCE * plan.depth)?;
    let speed = RETURN_SPEED * plan.cutting_speed;
    let return_speed = length("return_speed", Quantity::Speed, speed)?;
    let count = u32::try_from(record.count("count")?).ok()?;
    let last = plan.travel - f64::from(count - 1) * shortening;
    if last <= 0.0 {
        let mistake = Mistake::Contradiction {
            message: format!(
                "pass {count} would end {} mm before the tool's start: each is {} mm shorter than \
                 the one before",
                significant(-last * 1e3),
                significant(shortening * 1e3)
            ),
            help: "lengthen `travel` of [stop], or reduce `shortening` or `count`".to_owned(),
        };
        findings.problem(&record.source, record.heading.clone(), mistake);
        return None;
    }
    Some(Passes { count, shortening, clearance, return_speed })
}

/// The test for a steady state sees one pass.
fn refuse_steady(findings: &mut Findings, root: &Record<'_>) {
    let Some((stop, _)) = root.table("stop") else { return };
    if let Some(steady) = stop.get("steady") {
        let mistake = Mistake::Contradiction {
            message: "`steady` cannot end a cut of several passes".to_owned(),
            help: "remove it, or [passes]".to_owned(),
        };
        findings.problem(&root.source, steady.span(), mistake);
    }
}

impl Passes {
    /// The whole motion.
    pub(crate) fn motion(&self, plan: &PassPlan) -> PassMotion {
        let mut time = plan.travel / plan.cutting_speed;
        let mut motion =
            PassMotion { velocity_changes: Vec::new(), passes: Vec::new(), end_time: time };
        if self.count == 1 {
            return motion;
        }
        motion.passes.push(Pass { start: 0.0, end: time });
        for pass in 1..self.count {
            let (before, now) = (f64::from(pass - 1), f64::from(pass));
            let ahead = plan.travel - before * self.shortening;
            // Up to the clearance above the uncut surface, whatever the depth reached by now.
            let depth = plan.depth - before * plan.step[1];
            let up = depth + self.clearance;
            let down = up - plan.step[1];
            let run_up = self.clearance;
            for way in [[-up, up, 0.0], [up - ahead - run_up, 0.0, plan.step[2]], [0.0, -down, 0.0]]
            {
                let length = way[0].hypot(way[1]).hypot(way[2]);
                let velocity = way.map(|component| component / length * self.return_speed);
                motion.velocity_changes.push(VelocityChange { time, velocity });
                time += length / self.return_speed;
            }
            let velocity = [plan.cutting_speed, 0.0, 0.0];
            motion.velocity_changes.push(VelocityChange { time, velocity });
            let start = time;
            let end = plan.travel - now * self.shortening;
            time += (end + run_up) / plan.cutting_speed;
            motion.passes.push(Pass { start, end: time });
        }
        motion.end_time = time;
        motion
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    const PLAN: PassPlan =
        PassPlan { travel: 10.0, cutting_speed: 2.0, depth: 1.0, step: [0.0, 0.0, 0.5] };

    fn place(motion: &PassMotion, time: f64) -> Vector {
        let mut place = [0.0; 3];
        let mut velocity = [2.0, 0.0, 0.0];
        let mut from = 0.0;
        for change in motion.velocity_changes.iter().filter(|change| change.time <= time) {
            for k in 0..3 {
                place[k] += velocity[k] * (change.time - from);
            }
            (velocity, from) = (change.velocity, change.time);
        }
        std::array::from_fn(|k| place[k] + velocity[k] * (time - from))
    }

    fn is_at(found: Vector, expected: Vector) {
        for k in 0..3 {
            assert_relative_eq!(found[k], expected[k], epsilon = 1e-12);
        }
    }

    #[test]
    fn one_pass_is_a_straight_line() {
        let motion = Passes::ONE.motion(&PLAN);
        let straight = PassMotion { velocity_changes: vec![], passes: vec![], end_time: 5.0 };
        assert_eq!(motion, straight);
    }

    #[test]
    fn passes_in_turning_move_on_along_the_feed() {
        let passes = Passes { count: 3, shortening: 2.0, clearance: 3.0, return_speed: 20.0 };
        let motion = passes.motion(&PLAN);
        assert_eq!(motion.passes.len(), 3);
        // Each begins its clearance before the start at its own z and ends 2 before the one before.
        for (number, pass) in motion.passes.iter().enumerate() {
            let z = 0.5 * number as f64;
            let start = if number == 0 { 0.0 } else { -3.0 };
            is_at(place(&motion, pass.start), [start, 0.0, z]);
            is_at(place(&motion, pass.end), [10.0 - 2.0 * number as f64, 0.0, z]);
        }
        assert_eq!(motion.end_time, motion.passes[2].end);
        // Drawn back and up at 45 deg by depth and clearance: 4 of each.
        let up = motion.velocity_changes[1].time;
        is_at(place(&motion, up), [6.0, 4.0, 0.0]);
        let before = motion.velocity_changes[2].time;
        is_at(place(&motion, before), [-3.0, 4.0, 0.5]);
    }

    #[test]
    fn passes_in_the_plane_go_deeper() {
        let passes = Passes { count: 3, shortening: 2.0, clearance: 3.0, return_speed: 20.0 };
        let plan = PassPlan { step: [0.0, -1.0, 0.0], ..PLAN };
        let motion = passes.motion(&plan);
        for (number, pass) in motion.passes.iter().enumerate() {
            let y = -(number as f64);
            is_at(place(&motion, pass.end), [10.0 - 2.0 * number as f64, y, 0.0]);
        }
        // It returns at the same height above the uncut surface: tips at 3, started at -1.
        for change in [1, 5] {
            let height = place(&motion, motion.velocity_changes[change].time)[1];
            assert_relative_eq!(height - plan.depth, 3.0, max_relative = 1e-12);
        }
    }
}
