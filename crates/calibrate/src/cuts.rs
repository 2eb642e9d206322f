//! Measured cuts: one entry for each condition, with the noise of each value; mistakes of single lines.

use crate::Channels;
use crate::emulator::PriorModel;
use sphcut_diagnose::wrong_unit_of_thickness;
use sphcut_input::CutTableRow;
use sphcut_physics::{Channel, CuttingCondition, ToolGeometry};

/// Noise of the logarithm of a single value where neither the table nor repeats tell it, by [`Channel::RECORDED`].
const NOISE: Channels<f64> = [0.03, 0.03, 0.05, 0.03, 0.05, 0.10, 0.3];
/// No measured mean is better: material, width and edge differ from place to place.
const LEAST_NOISE: f64 = 0.01;
/// Degrees of freedom from which on repeats tell the noise.
const FREEDOM: f64 = 3.0;
/// Conditions that differ by less are the same.
const SAME: f64 = 1e-6;
/// A value of another unit misses a factor of a thousand by less than this logarithm; no model is wrong by so much.
const UNIT_MARGIN: f64 = 1.5;
/// As in the checks of a diagnosis: above this a prediction is wrong, below it right when exchanged, with this ratio of mean squares.
const WRONG: f64 = 0.35;
const EXCHANGED: f64 = 4.0;

/// A condition that was cut. SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredCut {
    /// Its condition.
    pub condition: CuttingCondition,
    /// Lines of the table, from 1, that are its repeats.
    pub lines: Vec<usize>,
    /// Mean logarithm of each channel and its variance.
    pub values: Channels<Option<(f64, f64)>>,
}

impl MeasuredCut {
    /// The measured value of a channel.
    #[must_use]
    pub fn value(&self, channel: Channel) -> Option<f64> {
        self.values[channel.index()].map(|(log, _)| log.exp())
    }

    /// `150 m/min, 0.1 mm`.
    #[must_use]
    pub fn name(&self) -> String {
        cut_name(&self.condition)
    }
}

/// As many digits as a machine can be set to.
pub(crate) fn short(x: f64) -> String {
    format!("{x:.4}").trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// `150 m/min, 0.1 mm`, with the tool where it is stated.
#[must_use]
pub fn cut_name(condition: &CuttingCondition) -> String {
    let CuttingCondition { cutting_speed, uncut_chip_thickness, tool, .. } = *condition;
    let (speed, thickness) = (short(cutting_speed * 60.0), short(uncut_chip_thickness * 1e3));
    let name = format!("{speed} m/min, {thickness} mm");
    if tool.parts() == [None, None] { name } else { format!("{name}, {}", tool_name(&tool)) }
}

/// `rake 5 deg, edge 20 um`, as far as it is stated.
#[must_use]
pub fn tool_name(tool: &ToolGeometry) -> String {
    let rake = tool.rake_angle.map(|rake| format!("rake {} deg", short(rake.to_degrees())));
    let edge = tool.edge_radius.map(|radius| format!("edge {} um", short(radius * 1e6)));
    let parts: Vec<String> = rake.into_iter().chain(edge).collect();
    parts.join(", ")
}

/// The rows as cuts: repeats of a condition become one, forces those of the width `width` of the scenario.
///
/// The noise of a value is that of its `_sd` column (over the root of `n`), else the scatter of repeats where they have
/// [`FREEDOM`] degrees of freedom, else `noise` or [`NOISE`]; never below [`LEAST_NOISE`].
#[must_use]
pub fn measured_cuts(rows: &[CutTableRow], width: f64, noise: Option<f64>) -> Vec<MeasuredCut> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (line, row) in rows.iter().enumerate() {
        match groups.iter_mut().find(|g| same(&rows[g[0]].condition(), &row.condition())) {
            Some(group) => group.push(line),
            None => groups.push(vec![line]),
        }
    }
    let log = |line: usize, channel: Channel| {
        let row = &rows[line];
        let share = row.width_of_cut.filter(|_| channel.is_force()).map_or(1.0, |b| width / b);
        row.values[channel.index()].map(|value| (value * share).ln())
    };
    let scatter = Channel::RECORDED.map(|channel| {
        let (mut squares, mut freedom) = (0.0, 0.0);
        for group in &groups {
            let logs: Vec<f64> = group.iter().filter_map(|&line| log(line, channel)).collect();
            let mean = logs.iter().sum::<f64>() / logs.len().max(1) as f64;
            squares += logs.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
            freedom += logs.len().saturating_sub(1) as f64;
        }
        (freedom >= FREEDOM).then(|| squares / freedom)
    });
    let cut = |group: &Vec<usize>| {
        let values = Channel::RECORDED.map(|channel| {
            let k = channel.index();
            let own: Vec<(f64, f64)> = group
                .iter()
                .filter_map(|&line| {
                    let (row, value) = (&rows[line], log(line, channel)?);
                    let count = row.count.unwrap_or(1.0).max(1.0);
                    let stated = row.deviations[k].zip(row.values[k]).map(|(s, y)| (s / y).powi(2));
                    let usual = noise.unwrap_or(NOISE[k]).powi(2);
                    let one = stated.or(scatter[k]).unwrap_or(usual);
                    Some((value, one / count))
                })
                .collect();
            let count = own.len() as f64;
            (count > 0.0).then(|| {
                let mean = own.iter().map(|(x, _)| x).sum::<f64>() / count;
                let variance = own.iter().map(|(_, v)| v).sum::<f64>() / count.powi(2);
                (mean, variance.max(LEAST_NOISE.powi(2)))
            })
        });
        let lines = group.iter().map(|line| line + 1).collect();
        let condition = rows[group[0]].condition();
        // One cut is another only by what it was cut with.
        let condition = CuttingCondition { cut_length: 0.0, run_order: 0.0, ..condition };
        MeasuredCut { condition, lines, values }
    };
    groups.iter().map(cut).collect()
}

/// Variance of the logarithm of a channel at a further cut: the mean of those measured, else `noise` or [`NOISE`].
pub(crate) fn noise_of(cuts: &[MeasuredCut], channel: usize, noise: Option<f64>) -> f64 {
    let known: Vec<f64> = cuts.iter().filter_map(|cut| Some(cut.values[channel]?.1)).collect();
    if known.is_empty() {
        return noise.unwrap_or(NOISE[channel]).powi(2);
    }
    known.iter().sum::<f64>() / known.len() as f64
}

/// Whether two cuts are made alike.
pub(crate) fn same(a: &CuttingCondition, b: &CuttingCondition) -> bool {
    let close = |a: f64, b: f64| (a - b).abs() <= SAME * a.abs().max(b.abs());
    let tools = a.tool.parts().into_iter().zip(b.tool.parts());
    close(a.cutting_speed, b.cutting_speed)
        && close(a.uncut_chip_thickness, b.uncut_chip_thickness)
        && tools.into_iter().all(|(a, b)| a.zip(b).is_none_or(|(a, b)| close(a, b)))
}

/// Mistakes of single cuts that no constants make: a unit wrong by a thousand, two forces exchanged. In words, with the lines.
#[must_use]
pub fn mistakes(cuts: &[MeasuredCut], model: &dyn PriorModel, start: &[f64]) -> Vec<String> {
    // What is wrong, with the cuts where it is: a column is one mistake and not one for each of its lines.
    let mut found: Vec<(String, Vec<&MeasuredCut>)> = Vec::new();
    let mut tell = |cut, what: String| match found.iter_mut().find(|(known, _)| *known == what) {
        Some((_, cuts)) => cuts.push(cut),
        None => found.push((what, vec![cut])),
    };
    for cut in cuts {
        if let Some([meant, written]) = wrong_unit_of_thickness(cut.condition.uncut_chip_thickness)
        {
            tell(cut, format!("nobody cuts such h, probably {meant} under a head in {written}"));
            continue;
        }
        let predicted = model.logs(&cut.condition, start);
        let ratio = |channel: Channel, of: Channel| {
            let measured = cut.values[channel.index()]?.0;
            let expected = predicted[of.index()];
            expected.is_finite().then_some(measured - expected)
        };
        let own = |channel| ratio(channel, channel);
        let mut wrong_unit = false;
        for channel in Channel::RECORDED {
            let Some(x) = own(channel).filter(|_| channel != Channel::InterfaceTemperature) else {
                continue;
            };
            if (x.abs() - 1000.0_f64.ln()).abs() < UNIT_MARGIN {
                wrong_unit = true;
                let (size, units) = match (x < 0.0, channel.is_force()) {
                    (true, true) => ("small", "kN under a head in N"),
                    (false, true) => ("large", "N under a head in kN"),
                    (true, false) => ("small", "mm under a head in um"),
                    (false, false) => ("large", "um under a head in mm"),
                };
                let symbol = channel.short_name();
                tell(
                    cut,
                    format!("{symbol} is about a thousand times too {size}, probably {units}"),
                );
            }
        }
        let (c, f) = (Channel::CuttingForce, Channel::FeedForce);
        if let (Some(a), Some(b), Some(x), Some(y), false) =
            (own(c), own(f), ratio(c, f), ratio(f, c), wrong_unit)
        {
            let (as_it_is, crossed) = ((a * a + b * b) / 2.0, (x * x + y * y) / 2.0);
            let forces = cut.value(c).zip(cut.value(f));
            // Where the feed force may exceed the cutting force, no order is the right one.
            if as_it_is > EXCHANGED * crossed
                && as_it_is.sqrt() > WRONG
                && crossed.sqrt() < WRONG
                && forces.is_some_and(|(c, f)| f > c)
            {
                tell(cut, "F_c and F_f are probably exchanged".to_owned());
            }
        }
    }
    let told = |(what, cuts): (String, Vec<&MeasuredCut>)| {
        let lines: Vec<String> =
            cuts.iter().flat_map(|cut| &cut.lines).map(ToString::to_string).collect();
        let name = if let [cut] = cuts[..] { format!(" ({})", cut.name()) } else { String::new() };
        let line = if lines.len() > 1 { "lines" } else { "line" };
        format!("{line} {} of the table{name}: {what}", lines.join(", "))
    };
    found.into_iter().map(told).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(speed: f64, force: f64) -> CutTableRow {
        let mut values = [None; Channel::RECORDED.len()];
        values[0] = Some(force);
        CutTableRow {
            cutting_speed: speed,
            uncut_chip_thickness: 1e-4,
            cut_length: None,
            order: None,
            count: None,
            width_of_cut: Some(2e-3),
            rake_angle: None,
            edge_radius: None,
            values,
            deviations: [None; Channel::RECORDED.len()],
            half_widths: [None; Channel::RECORDED.len()],
        }
    }

    #[test]
    fn repeats_become_one_cut_with_their_own_noise() {
        let rows: Vec<CutTableRow> =
            [(1.0, 200.0), (2.0, 180.0), (1.0, 220.0), (2.0, 184.0), (1.0, 210.0)]
                .map(|(v, f)| row(v, f))
                .to_vec();
        let cuts = measured_cuts(&rows, 3e-3, None);
        assert_eq!((cuts.len(), cuts[0].lines.clone()), (2, vec![1, 3, 5]));
        // ln 200, 220, 210: deviations -0.048790, 0.046520 and 0 but for 0.000757; sum of squares 0.004546. ln 180, 184: 0.000242.
        // Variance (0.004546 + 0.000242)/3 = 0.001596; of the mean of three a third.
        let (log, variance) = cuts[0].values[0].unwrap();
        assert!((variance - 0.001_596 / 3.0).abs() < 2e-6, "{variance}");
        // The geometric mean, for 3 mm instead of 2 mm.
        assert!((log.exp() - 1.5 * (200.0_f64 * 220.0 * 210.0).cbrt()).abs() < 1e-9);
    }
}
