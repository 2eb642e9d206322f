//! What moves as pictures to leaf through; `kit/script.js` turns them. Without it the last one of the first
//! field stands there.

use crate::kit::shell::data_uri;
use crate::kit::text::name_and_unit;
use crate::picture::{AnimatedField, Animation, ParticleField, Pictures, time_text};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use maud::{Markup, PreEscaped, html};
use sphcut_record::TemperatureUnit;

/// The pictures with a slider and a choice of fields, and what is to be known of them. `at` is the place of a time on
/// the axis of the charts, and `travel` says it in words.
pub(super) fn figure(
    animation: &Animation,
    pictures: &Pictures,
    is_cut: bool,
    at: impl Fn(f64) -> (f64, Option<String>),
) -> Markup {
    let last = animation.times.len().saturating_sub(1);
    let Some((shown, picture)) =
        animation.fields.first().and_then(|field| Some((field, field.frames.last()?)))
    else {
        return html! {};
    };
    let moments: String = animation
        .times
        .iter()
        .map(|&time| {
            let (place, words) = at(time);
            let words = words.map_or_else(String::new, |words| format!(", {words}"));
            format!("{place}\t{}{words}\n", time_text(time))
        })
        .collect();
    html! {
        figure.animation {
            img src=(data_uri("image/png", picture)) alt=(shown.description);
            div.controls hidden {
                div.time {
                    button type="button" { "Play" }
                    input type="range" min="0" max=(last) value=(last) aria-label="Snapshot";
                    output {}
                }
                fieldset.fields {
                    legend { "Colours" }
                    @for field in &animation.fields {
                        label {
                            input type="radio" name="field" value=(field.field.name()) checked[field == shown]
                                data-description=(field.description) data-span=(says(field, pictures));
                            " " (choice(field.field))
                        }
                    }
                }
            }
            figcaption {
                @if is_cut { "Chip formation. " } span.span { (says(shown, pictures)) }
                @if let Some(cut_off) = &pictures.cut_off { " " (cut_off) }
            }
            script.moments type="text/plain" { (PreEscaped(moments)) }
            @for field in &animation.fields {
                script type="text/plain" data-field=(field.field.name()) { (PreEscaped(lines(field))) }
            }
        }
    }
}

/// What the colours mean; of pressure also that it alternates.
fn says(field: &AnimatedField, pictures: &Pictures) -> String {
    let note = pictures.checkerboard.as_ref().filter(|_| field.field == ParticleField::Pressure);
    format!("{}.{}", field.span, note.map_or_else(String::new, |note| format!(" {note}")))
}

/// The name of a field without its unit.
fn choice(field: ParticleField) -> &'static str {
    name_and_unit(field.title(TemperatureUnit::Celsius)).0
}

/// One picture a line.
fn lines(field: &AnimatedField) -> String {
    let lines: Vec<String> = field.frames.iter().map(|png| BASE64_STANDARD.encode(png)).collect();
    lines.join("\n")
}
