//! Residual map and flow curves.

use super::IdentificationPage;
use crate::kit::chart::{Chart, ChartLine};
use crate::kit::colours::DISTINCT;
use crate::kit::numbers::{MPA, plain, signed};
use crate::kit::shell::figure;
use crate::kit::table::{ColumnHead, table};
use maud::{Markup, html};
use sphcut_identify::{Bin, Curve, LawFit, residual_map};

/// ln(model / measured) at which the colour is full.
const FULL: f64 = 0.3;
/// Blue where the model is too soft, orange where it is too hard.
fn tint(mean: f64) -> String {
    let share = (mean.abs() / FULL).min(1.0);
    let full = if mean > 0.0 { [213.0, 94.0, 0.0] } else { [0.0, 114.0, 178.0] };
    let part = full.map(|c: f64| (255.0 + 0.75 * share * (c - 255.0)).round());
    format!("background: rgb({}, {}, {})", part[0], part[1], part[2])
}

/// A range of the map in words.
fn range([from, to]: [f64; 2]) -> String {
    match (from > 0.0, to.is_finite()) {
        (true, true) => format!("{} to {}", plain(from), plain(to)),
        (false, _) => format!("below {}", plain(to)),
        (true, false) => format!("above {}", plain(from)),
    }
}

/// `+3 %`, `\u{2212}0.4 %`, `0 %`: a tenth of a per cent below two.
fn deviation(mean: f64) -> String {
    let per_cent = mean.exp_m1() * 100.0;
    if per_cent.abs() < 0.05 {
        return "0 %".to_owned();
    }
    let decimals = usize::from(per_cent.abs() < 1.95);
    signed(per_cent, decimals) + " %"
}

/// The residuals of Johnson-Cook over strain, rate and temperature.
pub(super) fn residuals(page: &IdentificationPage<'_>) -> Markup {
    let map = residual_map(page.points, &page.johnson_cook.residuals);
    let distinct = |value: fn(&Bin) -> [f64; 2]| {
        let mut all: Vec<[f64; 2]> = map.iter().map(value).collect();
        all.sort_by(|a, b| a[0].total_cmp(&b[0]));
        all.dedup();
        all
    };
    let (strains, rates) = (distinct(|b| b.strain), distinct(|b| b.rate));
    let temperatures = distinct(|b| b.temperature);
    let find = |strain: [f64; 2], rate: [f64; 2], temperature: [f64; 2]| {
        map.iter().find(|b| b.strain == strain && b.rate == rate && b.temperature == temperature)
    };
    let rate_names: Vec<String> = rates.iter().map(|rate| range(*rate)).collect();
    let columns = || {
        [ColumnHead::Text("")]
            .into_iter()
            .chain(rate_names.iter().map(|name| ColumnHead::Number(name)))
    };
    let caption = |strain| {
        let strain = range(strain);
        format!("Plastic strain {strain}; down: temperature in K, across: strain rate in 1/s")
    };
    let rows = |strain| {
        html! { @for temperature in &temperatures { tr {
            th scope="row" { (range(*temperature)) }
            @for rate in &rates {
                @if let Some(bin) = find(strain, *rate, *temperature) {
                    td.n style=(tint(bin.mean)) { (deviation(bin.mean)) " (" (bin.curves) ")" }
                } @else { td.n { } }
            }
        } } }
    };
    html! {
        section {
            h2 { "Where Johnson-Cook cannot follow" }
            p { "Model over measured in per cent, mean of the curves in each cell, and their number. Orange: the law is too \
                hard; blue: too soft." }
            @for strain in &strains {
                (table(caption(*strain), columns(), &rows(*strain)))
            }
        }
    }
}

/// Some curves beside the law: as different as they come.
pub(super) fn curves(page: &IdentificationPage<'_>) -> Markup {
    let usable: Vec<&Curve> = page.curves.iter().filter(|c| c.stress.len() > 2).collect();
    let mut order = usable.clone();
    order.sort_by(|a, b| {
        let key = |c: &Curve| (c.temperature / 20.0).round();
        key(a).total_cmp(&key(b)).then(a.plastic_strain_rate.total_cmp(&b.plastic_strain_rate))
    });
    let count = order.len().min(DISTINCT.len());
    let chosen: Vec<&Curve> =
        (0..count).map(|k| order[k * (order.len() - 1) / (count - 1).max(1)]).collect();
    let largest = chosen.iter().flat_map(|c| c.plastic_strain.iter().copied()).fold(0.0, f64::max);
    let x: Vec<f64> = (0..=200).map(|k| largest * f64::from(k) / 200.0).collect();
    let names: Vec<String> = chosen
        .iter()
        .map(|c| {
            let (rate, temperature) = (plain(c.plastic_strain_rate), plain(c.temperature.round()));
            format!("{rate} 1/s, {temperature} K")
        })
        .collect();
    let mut lines = Vec::new();
    for (k, curve) in chosen.iter().enumerate() {
        let measured = x.iter().map(|strain| measured(curve, *strain) * MPA).collect();
        lines.push(ChartLine::new(&names[k], DISTINCT[k], 3.0, measured));
        let model = x.iter().map(|strain| modelled(page.johnson_cook, curve, *strain) * MPA);
        lines.push(ChartLine::new("", DISTINCT[k], 1.0, model.collect()));
    }
    let chart = Chart {
        description: "Flow curves beside the law.".to_owned(),
        x_title: "Plastic strain",
        y_title: "True stress in MPa",
        height: 420.0,
        x,
        lines,
        y_includes: vec![0.0],
        ..Chart::default()
    };
    let figure =
        figure(chart.svg(), "Some of the curves (thick) and Johnson-Cook, jointly fitted (thin).");
    html! { section { h2 { "Flow curves" } (figure) } }
}

/// Stress of a curve at a strain; not a number beyond it.
fn measured(curve: &Curve, strain: f64) -> f64 {
    let after = curve.plastic_strain.partition_point(|e| *e < strain);
    if after == 0 || after == curve.plastic_strain.len() {
        return f64::NAN;
    }
    let (e0, e1) = (curve.plastic_strain[after - 1], curve.plastic_strain[after]);
    let share = if e1 > e0 { (strain - e0) / (e1 - e0) } else { 0.0 };
    curve.stress[after - 1] + share * (curve.stress[after] - curve.stress[after - 1])
}

/// The law along a curve.
fn modelled(fit: &LawFit, curve: &Curve, strain: f64) -> f64 {
    if measured(curve, strain).is_nan() {
        return f64::NAN;
    }
    fit.stress(strain, curve.plastic_strain_rate, curve.temperature)
}
