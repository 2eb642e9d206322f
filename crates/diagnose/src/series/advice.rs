//! Which cut would tell laws apart that the cuts at hand cannot.

use super::laws::{Explanation, LineLaw, Seen, TOLD_APART, place};

/// A cut that would tell, and what each law expects of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Advice {
    /// v_c in m/s.
    pub cutting_speed: f64,
    /// h in m.
    pub uncut_chip_thickness: f64,
    /// Revolutions per second.
    pub revolution: Option<f64>,
    /// What is different from the cuts at hand.
    pub change: CutChange,
    /// Each law with the frequency in Hz that it expects.
    pub expected: Vec<(LineLaw, f64)>,
}

/// What is changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CutChange {
    /// The uncut chip thickness alone.
    Thickness,
    /// The rotation alone: another diameter at the same speed.
    Diameter,
    /// The cutting speed at the same diameter.
    Speed,
    /// Thickness and speed.
    ThicknessAndSpeed,
}

const CHANGES: [(CutChange, [f64; 3]); 6] = [
    (CutChange::Thickness, [1.0, 1.6, 1.0]),
    (CutChange::Thickness, [1.0, 1.0 / 1.6, 1.0]),
    (CutChange::Speed, [1.4, 1.0, 1.4]),
    (CutChange::Speed, [1.0 / 1.4, 1.0, 1.0 / 1.4]),
    (CutChange::Diameter, [1.0, 1.0, 1.4]),
    (CutChange::ThicknessAndSpeed, [1.4, 0.5, 1.4]),
];

/// The first change of the last cut that tells all `rivals` apart and keeps their lines in the band.
#[must_use]
pub fn advise(
    rivals: &[LineLaw],
    explanations: &[Explanation],
    seen: &[Seen],
    band: [f64; 2],
) -> Option<Advice> {
    let from = seen.last()?;
    CHANGES.iter().find_map(|(change, [speed, thickness, rotation])| {
        let cut = Seen {
            cutting_speed: from.cutting_speed * speed,
            uncut_chip_thickness: from.uncut_chip_thickness * thickness,
            revolution: from.revolution.map(|n| n * rotation),
            ..*from
        };
        let expected: Vec<(LineLaw, f64)> = rivals
            .iter()
            .filter(|law| explanations.iter().any(|e| e.law == **law))
            .filter_map(|&law| {
                let shift = place(law, &cut)? - place(law, from)?;
                Some((law, from.frequency * shift.exp()))
            })
            .collect();
        let error = (from.error / from.frequency).max(0.01);
        let apart = expected.iter().enumerate().all(|(k, (_, f))| {
            expected[..k].iter().all(|(_, g)| (f / g).ln().abs() > 2.0 * TOLD_APART * error)
        });
        let inside = expected.iter().all(|(_, f)| band[0] < *f && *f < band[1]);
        (expected.len() == rivals.len() && apart && inside).then_some(Advice {
            cutting_speed: cut.cutting_speed,
            uncut_chip_thickness: cut.uncut_chip_thickness,
            revolution: cut.revolution,
            change: *change,
            expected,
        })
    })
}
