//! The page of `sphcut check --preview`: a cut before it is run.

use super::run::drawings;
use crate::kit::numbers::{UM, grouped, plain, three_digits};
use crate::kit::shell::{Shell, data_uri, next, note, tab};
use crate::kit::text::indexed;
use crate::picture::draw_setup;
use maud::{Markup, html};
use sphcut_record::{Facts, Provenance};
use sphcut_sph::Snapshot;

/// What is shown of a scenario before it is run.
pub struct PreviewPage<'a> {
    /// Texts and settings.
    pub provenance: &'a Provenance,
    /// Numbers of the setup.
    pub facts: &'a Facts,
    /// The particles at time zero, or a part of them.
    pub first: &'a Snapshot,
    /// How many there will be.
    pub particles: usize,
    /// What the run takes, in words.
    pub cost: &'a [&'a str],
    /// The command that runs it.
    pub command: &'a str,
}

/// The text of the page.
#[must_use]
pub fn render_preview(page: &PreviewPage<'_>) -> String {
    let (facts, provenance) = (page.facts, page.provenance);
    let figure = |name: &str, value: String, unit: &str| {
        html! { div { dt { (indexed(name)) } dd { (value) " " small { (unit) } } } }
    };
    let um = |name: &str, length: f64| figure(name, three_digits(length * UM), "\u{b5}m");
    let drawn = drawings(facts, provenance, page.first);
    let pictures = match drawn.0.is_empty() {
        true => draw_setup(facts, page.first, provenance.temperature_unit()),
        false => Vec::new(),
    };
    let part = page.first.id.len() < page.particles;
    let body: Markup = html! {
        @if provenance.warnings.is_empty() { p.clean { "No warnings." } }
        @else { (note("Before you run it", provenance.warnings.iter().map(|text| html! { (text) }))) }
        dl.figures {
            @if facts.tool_velocity.is_some() {
                (figure("Cutting speed v_c", plain(facts.cutting_speed() * 60.0), "m/min"))
            }
            @if let Some(depth) = facts.uncut_chip_thickness { (um("Uncut chip thickness h", depth)) }
            @if let Some(radius) = facts.edge_radius { (um("Edge radius r_n", radius)) }
            (um("Particle spacing", facts.particle_spacing))
            (figure("Particles", grouped(page.particles as u64), ""))
        }
        (drawn)
        div.pair {
            @for picture in &pictures {
                figure {
                    img src=(data_uri(picture.media_type, &picture.bytes)) alt=(picture.description);
                    figcaption { (picture.title) @if part { ", a part of the particles" } "." }
                }
            }
        }
        section { h2 { "Cost" } ul { @for line in page.cost { li { (line) } } } }
        (next(&[(page.command, "cuts")]))
    };
    let title =
        if provenance.title.is_empty() { &provenance.scenario_name } else { &provenance.title };
    let lead = html! { "Setup of scenario " (provenance.scenario_name) ", not yet run." };
    Shell { tab: tab(title), title, lead, version: &provenance.version, body }.render()
}
