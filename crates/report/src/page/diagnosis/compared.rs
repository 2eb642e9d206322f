//! Measured against simulated, before and after the correction.

use super::DiagnosisPage;
use crate::kit::numbers::{M_PER_MIN, MM, three_digits};
use crate::kit::parity::{ComparedPoint, channel_unit, parity};
use crate::kit::shell::plotted;
use maud::{Markup, html};
use sphcut_diagnose::{Forecast, Recording, forecast};
use sphcut_physics::{Channel, CuttingCondition};

/// A plot for each channel; nothing where the model has no answer.
pub(super) fn section(page: &DiagnosisPage<'_>) -> Markup {
    let recordings = page.recordings.all();
    // Cuts of one condition have one answer.
    let mut conditions: Vec<CuttingCondition> = Vec::new();
    let places: Vec<usize> = recordings
        .iter()
        .map(|recording| {
            let same = conditions.iter().position(|known| *known == recording.condition);
            same.unwrap_or_else(|| {
                conditions.push(recording.condition);
                conditions.len() - 1
            })
        })
        .collect();
    let Ok(answers) = forecast(page.diagnosis, page.recordings, page.predictor, &conditions) else {
        return html! {};
    };
    let corrected = page.diagnosis.repair.is_some();
    let after = if corrected { "corrected" } else { "recalibrated" };
    let plots = page.diagnosis.problem.channels().into_iter().filter_map(|channel| {
        let of = |(recording, place): (&Recording, &usize)| {
            let answer = answers[*place].iter().find(|answer| answer.channel == channel)?;
            point(recording, answer, channel)
        };
        let points: Vec<ComparedPoint> = recordings.iter().zip(&places).filter_map(of).collect();
        let title = format!("{} in {}", channel.short_name(), channel_unit(channel).1);
        (!points.is_empty()).then(|| (channel, parity(&title, &points, ["as simulated", after])))
    });
    html! {
        section {
            h2 { @if corrected { "Before and after the correction" } @else { "Before and after recalibration" } }
            p { "Simulated over measured: grey as the scenario is, blue "
                @if corrected { "with the effect and with material and friction fitted together with it" }
                @else { "with material and friction fitted; no effect is put in" }
                ". Bars: the 95 % prediction interval of a single cut, its noise included. On the line both agree." }
            div.pair { @for (channel, svg) in plots { (plotted(&svg, &format!("Simulated over measured {}.", channel.title()))) } }
        }
    }
}

fn point(recording: &Recording, answer: &Forecast, channel: Channel) -> Option<ComparedPoint> {
    let (scale, _) = channel_unit(channel);
    let condition = &recording.condition;
    Some(ComparedPoint {
        measured: recording.values[channel.index()]? * scale,
        before: answer.as_simulated * scale,
        after: answer.value * scale,
        interval: answer.interval.map(|end| end * scale),
        name: format!(
            "{} m/min, {} mm",
            three_digits(condition.cutting_speed * M_PER_MIN),
            three_digits(condition.uncut_chip_thickness * MM)
        ),
    })
}
