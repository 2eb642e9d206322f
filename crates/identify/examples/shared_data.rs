//! Fits the published flow curves in `../shared/data` and prints what `docs/identification.md` quotes.
//!
//! `cargo run --release -p sphcut-identify --example shared_data -- ../shared/data`

use sphcut_identify::{
    Curve, LawChoice, LawFit, References, compare, fit, points_of, residual_map, sequence,
};
use std::path::{Path, PathBuf};

fn main() -> std::io::Result<()> {
    let folder: PathBuf =
        std::env::args_os().nth(1).unwrap_or_else(|| "../shared/data".into()).into();
    aluminium(&folder)?;
    steel(&folder)
}

/// Cells of a line; quotes keep commas.
fn cells(line: &str) -> Vec<String> {
    let (mut cells, mut quoted) = (vec![String::new()], false);
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(String::new()),
            c => cells.last_mut().expect("one at least").push(c),
        }
    }
    cells
}

fn number(cells: &[String], k: usize) -> f64 {
    cells.get(k).and_then(|cell| cell.parse().ok()).unwrap_or(f64::NAN)
}

fn grouped(rows: impl Iterator<Item = (String, f64, f64, f64, f64)>) -> Vec<Curve> {
    let mut curves: Vec<Curve> = Vec::new();
    for (name, rate, temperature, strain, stress) in rows {
        if curves.last().is_none_or(|c| c.name != name) {
            let plastic_strain_rate = rate;
            curves.push(Curve { name, plastic_strain_rate, temperature, ..Curve::default() });
        }
        let curve = curves.last_mut().expect("pushed above");
        curve.plastic_strain.push(strain);
        curve.stress.push(stress);
    }
    curves
}

/// 6061-T6: tests without superposed pressure, plastic strains from 1 %.
fn aluminium(folder: &Path) -> std::io::Result<()> {
    let text = std::fs::read_to_string(folder.join("al6061t6_flow_stress.csv"))?;
    let rows =
        text.lines().skip(1).map(cells).filter(|c| number(c, 2) == 0.0).map(|c| {
            (c[0].clone(), number(&c, 4), number(&c, 3), number(&c, 6), number(&c, 7) * 1e6)
        });
    let references = References { rate: 1e-3, temperature: 297.0, melting: 855.0 };
    report("6061-T6, 95 curves of ten laboratories", &grouped(rows), references, 0.01);
    Ok(())
}

/// Medium-carbon steel, hot: the total strain stands for the plastic one (elastic part taken off by the
/// authors); strains from 2 %.
fn steel(folder: &Path) -> std::io::Result<()> {
    let text =
        std::fs::read_to_string(folder.join("gleeble_medium_carbon_steel_hot_flow_stress.csv"))?;
    let mut rows: Vec<(String, f64, f64, f64, f64)> = text
        .lines()
        .skip(1)
        .map(cells)
        .map(|c| {
            let name = format!("{} 1/s, {} degC", c[1], c[2]);
            (name, number(&c, 1), number(&c, 2) + 273.15, number(&c, 0), number(&c, 3) * 1e6)
        })
        .collect();
    rows.sort_by(|a, b| a.0.cmp(&b.0).then(a.3.total_cmp(&b.3)));
    // The coldest test at the lowest rate is the reference, as in the law's use for hot work.
    let references = References { rate: 1e-3, temperature: 1323.15, melting: 1760.0 };
    report("medium-carbon steel, hot", &grouped(rows.into_iter()), references, 0.02);
    Ok(())
}

fn report(title: &str, curves: &[Curve], references: References, smallest: f64) {
    let points = points_of(curves, smallest).expect("enough curves");
    println!("\n{title}: {} curves, {} points", curves.len(), points.len());
    let by_sequence = sequence(&points, references);
    println!("sequence: {by_sequence:?}");
    let start = by_sequence.map_or([200e6, 200e6, 0.3, 0.02, 1.0], |s| s.parameters);
    let base = fit(LawChoice::JohnsonCook, references, &points, &start).expect("a fit");
    show(&base);
    let tanh = [[0.5, 1.0, 1.0, 1.0, 1.0], [2.0, 5.0, 2.0, 1.0, 0.05]]
        .into_iter()
        .filter_map(|extra| {
            let start: Vec<f64> = base.parameters.iter().map(|p| p.value).chain(extra).collect();
            fit(LawChoice::Tanh, references, &points, &start)
        })
        .min_by(|a, b| a.deviation.total_cmp(&b.deviation))
        .expect("a fit");
    show(&tanh);
    let mut map = residual_map(&points, &base.residuals);
    map.sort_by(|a, b| b.mean.abs().total_cmp(&a.mean.abs()));
    for bin in map.iter().filter(|bin| bin.curves >= 2).take(6) {
        println!("{bin:?}");
    }
    if let Some(compared) = compare(&points, references, &base, &tanh) {
        println!("{compared:#?}");
    }
}

fn show(fit: &LawFit) {
    println!("{}: rms {:.4}", fit.law.key(), fit.deviation);
    for p in &fit.parameters {
        println!(
            "  {} {:.5e} +- {:.2e}{}",
            p.key,
            p.value,
            p.half_width,
            if p.at_limit { " at its limit" } else { "" }
        );
    }
    for row in &fit.correlation {
        println!("  {:5.2?}", row);
    }
}
