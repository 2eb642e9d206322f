//! The cut as it was simulated beside the corrected one, drawn from the runs that confirm the correction.

use super::DiagnosisPage;
use crate::ReportError;
use crate::kit::numbers::{M_PER_MIN, MM, three_digits};
use crate::kit::parity::channel_unit;
use crate::kit::text::indexed;
use crate::picture::{thumbnail, thumbnail_range, thumbnail_view};
use maud::{Markup, html};
use sphcut_diagnose::{PairedRun, same_cut};
use sphcut_physics::{Channel, CuttingCondition};
use sphcut_record::{Run, RunFiles};
use std::path::Path;

/// The ends of two runs of one cut, in one view and one scale of colours.
#[derive(Debug, Clone)]
pub struct SimulatedPair {
    condition: CuttingCondition,
    /// As the scenario is, and corrected.
    states: [Drawn; 2],
}

/// A run as it ended.
#[derive(Debug, Clone)]
struct Drawn {
    /// A data URI.
    picture: String,
    means: [Option<f64>; Channel::RECORDED.len()],
}

impl SimulatedPair {
    /// From the records in two folders; `None` where one has no picture (no snapshot, or a cut in space).
    ///
    /// # Errors
    /// A record that cannot be read.
    pub fn draw(states: [(&PairedRun, &Path); 2]) -> Result<Option<Self>, ReportError> {
        let load = |folder: &Path| Run::load(&RunFiles::in_dir(folder).record());
        let records = [load(states[0].1)?, load(states[1].1)?];
        let [Some(first), Some(second)] =
            [thumbnail_range(&records[0])?, thumbnail_range(&records[1])?]
        else {
            return Ok(None);
        };
        let range = (first.0.min(second.0), first.1.max(second.1));
        // They go equally far, so that the edge is at one place.
        let [one, other] = [thumbnail_view(&records[0])?, thumbnail_view(&records[1])?];
        let view = one.zip(other).map(|(one, other)| one.union(other));
        let mut drawn = Vec::new();
        for ((run, _), record) in states.iter().zip(&records) {
            let Some(picture) = thumbnail(record, range, view)? else { return Ok(None) };
            let means = run.means.map(|mean| mean.map(|(mean, _)| mean));
            drawn.push(Drawn { picture, means });
        }
        let condition = states[0].0.condition;
        Ok(drawn.try_into().ok().map(|states| Self { condition, states }))
    }

    fn place(&self) -> String {
        format!(
            "{} m/min, {} mm",
            three_digits(self.condition.cutting_speed * M_PER_MIN),
            three_digits(self.condition.uncut_chip_thickness * MM)
        )
    }
}

/// What was recorded at a condition, each channel's mean.
fn measured(
    page: &DiagnosisPage<'_>,
    condition: &CuttingCondition,
) -> [Option<f64>; Channel::RECORDED.len()] {
    let there = || page.recordings.all().iter().filter(|r| same_cut(&r.condition, condition));
    Channel::RECORDED.map(|channel| {
        let values: Vec<f64> = there().filter_map(|r| r.values[channel.index()]).collect();
        (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
    })
}

/// `F_c 312 N, F_f 120 N`: of the channels that were recorded.
fn values(
    means: &[Option<f64>; Channel::RECORDED.len()],
    recorded: &[Option<f64>; Channel::RECORDED.len()],
) -> String {
    let of = |channel: Channel| {
        let (scale, unit) = channel_unit(channel);
        let mean = recorded[channel.index()].and(means[channel.index()])?;
        Some(format!("{} {} {unit}", channel.short_name(), three_digits(mean * scale)))
    };
    Channel::RECORDED.into_iter().filter_map(of).collect::<Vec<_>>().join(", ")
}

/// Pictures in pairs; nothing where no run confirms.
pub(super) fn section(page: &DiagnosisPage<'_>) -> Markup {
    if page.pairs.is_empty() {
        return html! {};
    }
    html! {
        section {
            h2 { "The cut as simulated and corrected" }
            p { "Temperature at the end of runs that go equally far, each pair in one scale of colours. The recordings at these conditions were held out of the fits." }
            @for pair in page.pairs {
                @let recorded = measured(page, &pair.condition);
                h3 { (pair.place()) ", measured: " (indexed(&values(&recorded, &recorded))) }
                div.pair { @for (name, state) in ["As simulated", "Corrected"].iter().zip(&pair.states) {
                    @let caption = format!("{name}: {}", values(&state.means, &recorded));
                    figure {
                        img src=(state.picture) alt=(format!("{}: {caption}", pair.place()));
                        figcaption { (indexed(&caption)) }
                    }
                } }
            }
        }
    }
}
