//! Force coefficients for planning, from the cuts of a sweep.
//!
//! Over the uncut chip thickness h, at one cutting speed and everything else fixed, per width b of cut and for cutting and feed force
//! each:
//!
//! ```text
//! F / b = K_e + K_c h                                       Altintas, Manufacturing Automation, 2nd edition, 2012, chapter 2
//! F / b = k_c1.1 h_1 (h / h_1)^(1 - m_c),   h_1 = 1 mm      Kienzle, VDI-Z 94 (1952) 299
//! ```
//!
//! Both by least squares, of F/b and of its logarithm, with Student's intervals from the scatter about the fit. They hold within the
//! thicknesses of the fit; k_c1.1 lies outside them by its definition.

use crate::table::SweepTable;
use crate::trends::{ForcePoint, TrendEstimate, line_over_thickness, power_law};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// h_1 in m.
const UNIT_THICKNESS: f64 = 1e-3;
/// Keys that move a cut along the fit or repeat it, by their ends.
const POOLED: [&str; 2] = ["uncut_chip_thickness", "seed"];

/// The coefficients of one force at one cutting speed.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceCoefficients {
    /// What else was varied: keys and values.
    pub settings: Vec<(String, String)>,
    /// v_c in m/s.
    pub cutting_speed: f64,
    /// `F_c` or `F_f`.
    pub force: &'static str,
    /// Number of cuts.
    pub cuts: usize,
    /// Least and largest h in m.
    pub thicknesses: [f64; 2],
    /// K_c in Pa.
    pub cutting: TrendEstimate,
    /// K_e in N/m.
    pub edge: TrendEstimate,
    /// `None` where a force is not positive.
    pub kienzle: Option<Kienzle>,
}

/// Kienzle's constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kienzle {
    /// k_c1.1 in Pa with the ends of its interval.
    pub specific_force: [f64; 3],
    /// m_c.
    pub exponent: TrendEstimate,
}

/// v_c, h and forces per width of a cut.
type CutPoint = (f64, f64, [f64; 2]);

/// The coefficients of all groups of cuts with three thicknesses or more.
#[must_use]
pub fn force_coefficients(table: &SweepTable) -> Vec<ForceCoefficients> {
    let is_setting = |axis: &usize| {
        let key = &table.axes[*axis].0;
        table.own[*axis]
            && !key.ends_with("cutting_speed")
            && !POOLED.iter().any(|end| key.ends_with(end))
    };
    let settings: Vec<usize> = (0..table.axes.len()).filter(is_setting).collect();
    let mut groups: BTreeMap<Vec<&str>, Vec<CutPoint>> = BTreeMap::new();
    for row in &table.rows {
        let (Some(cut), [Some(cutting), Some(feed), _]) = (row.condition, row.forces) else {
            continue;
        };
        let key = settings.iter().map(|axis| row.values[*axis].as_str()).collect();
        let forces = [cutting[0], feed[0]].map(|force| force / cut.width_of_cut);
        groups.entry(key).or_default().push((cut.cutting_speed, cut.uncut_chip_thickness, forces));
    }
    let mut found = Vec::new();
    for (key, cuts) in &groups {
        let mut speeds: Vec<f64> = cuts.iter().map(|cut| cut.0).collect();
        speeds.sort_by(f64::total_cmp);
        speeds.dedup_by(|a, b| (*a - *b).abs() <= 1e-6 * *b);
        let named: Vec<(String, String)> = settings
            .iter()
            .zip(key)
            .map(|(axis, value)| (table.axes[*axis].0.clone(), (*value).to_owned()))
            .collect();
        for speed in speeds {
            for (index, force) in ["F_c", "F_f"].into_iter().enumerate() {
                let one = of_one(cuts, speed, index);
                found.extend(one.map(|one| ForceCoefficients {
                    settings: named.clone(),
                    force,
                    ..one
                }));
            }
        }
    }
    found
}

fn of_one(cuts: &[CutPoint], cutting_speed: f64, force: usize) -> Option<ForceCoefficients> {
    let there: Vec<ForcePoint> = cuts
        .iter()
        .filter(|cut| (cut.0 - cutting_speed).abs() <= 1e-6 * cutting_speed)
        .map(|cut| ForcePoint { at: [cutting_speed, cut.1], force: cut.2[force] })
        .collect();
    let mut levels: Vec<f64> = there.iter().map(|point| point.at[1]).collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup_by(|a, b| (*a - *b).abs() <= 1e-6 * *b);
    let thicknesses = [*levels.first()?, *levels.last()?];
    let line = (levels.len() > 2).then(|| line_over_thickness(&there, cutting_speed)).flatten()?;
    let in_units: Vec<ForcePoint> = there
        .iter()
        .map(|point| ForcePoint { at: [cutting_speed, point.at[1] / UNIT_THICKNESS], ..*point })
        .collect();
    let kienzle = power_law(&in_units).and_then(|law| {
        let TrendEstimate { value, half_width } = law.constant;
        let exponent = law.thickness?;
        Some(Kienzle {
            specific_force: [0.0, -half_width, half_width]
                .map(|off| (value + off).exp() / UNIT_THICKNESS),
            exponent: TrendEstimate { value: 1.0 - exponent.value, ..exponent },
        })
    });
    Some(ForceCoefficients {
        settings: Vec::new(),
        cutting_speed,
        force: "",
        cuts: there.len(),
        thicknesses,
        cutting: line.slope,
        edge: line.offset,
        kienzle,
    })
}

/// `coefficients.csv`: a line per force and cutting speed; intervals are half widths of 95 %, those of k_c1.1 its ends.
#[must_use]
pub fn coefficients_csv(all: &[ForceCoefficients]) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let number = |value: f64| if value.is_finite() { format!("{value:.6}") } else { String::new() };
    let keys: Vec<&str> = all
        .first()
        .map_or_else(Vec::new, |one| one.settings.iter().map(|(key, _)| key.as_str()).collect());
    let heads = [
        "v_c [m/min]",
        "force",
        "cuts",
        "h from [mm]",
        "h to [mm]",
        "K_c [N/mm^2]",
        "K_c_ci95 [N/mm^2]",
        "K_e [N/mm]",
        "K_e_ci95 [N/mm]",
        "k_c1.1 [N/mm^2]",
        "k_c1.1 low [N/mm^2]",
        "k_c1.1 high [N/mm^2]",
        "m_c",
        "m_c_ci95",
    ];
    let lines = all.iter().map(|one| {
        let settings = one.settings.iter().map(|(_, value)| sphcut_physics::csv::shown(value));
        let mut cells: Vec<String> = settings.collect();
        cells.extend([
            number(one.cutting_speed * 60.0),
            one.force.to_owned(),
            one.cuts.to_string(),
        ]);
        let line = [
            one.cutting.value / 1e6,
            one.cutting.half_width / 1e6,
            one.edge.value / 1e3,
            one.edge.half_width / 1e3,
        ];
        cells.extend(one.thicknesses.map(|h| h * 1e3).into_iter().chain(line).map(number));
        let [value, low, high] =
            one.kienzle.map_or([f64::NAN; 3], |found| found.specific_force.map(|k| k / 1e6));
        let exponent = one
            .kienzle
            .map_or([f64::NAN; 2], |found| [found.exponent.value, found.exponent.half_width]);
        cells.extend([value, low, high].into_iter().chain(exponent).map(number));
        cells
    });
    let all_lines =
        std::iter::once(keys.into_iter().chain(heads).map(str::to_owned).collect()).chain(lines);
    // Writing to memory cannot fail.
    all_lines.for_each(|cells: Vec<String>| drop(writer.write_record(cells)));
    writer
        .into_inner()
        .map_or_else(|_| String::new(), |bytes| String::from_utf8_lossy(&bytes).into_owned())
}

/// `coefficients.json`, in SI units; half widths of 95 %, `null` where no degree of freedom is left.
#[must_use]
pub fn coefficients_json(all: &[ForceCoefficients]) -> String {
    let estimate = |one: TrendEstimate| json!({ "value": one.value, "ci95": one.half_width });
    let rows: Vec<Value> = all
        .iter()
        .map(|one| {
            json!({
                "settings": one.settings.iter().cloned().collect::<BTreeMap<String, String>>(),
                "cutting_speed": one.cutting_speed,
                "force": one.force,
                "cuts": one.cuts,
                "uncut_chip_thickness": one.thicknesses,
                "K_c": estimate(one.cutting),
                "K_e": estimate(one.edge),
                "k_c1.1": one.kienzle.map(|found| {
                    let [value, low, high] = found.specific_force;
                    json!({ "value": value, "low": low, "high": high })
                }),
                "m_c": one.kienzle.map(|found| estimate(found.exponent)),
            })
        })
        .collect();
    format!("{:#}\n", json!({ "schema_version": "1.0", "coefficients": rows }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cuts(force: impl Fn(f64) -> f64) -> Vec<CutPoint> {
        [0.05e-3, 0.1e-3, 0.15e-3, 0.2e-3].map(|h| (2.5, h, [force(h), -1.0])).to_vec()
    }

    #[test]
    fn the_constants_of_a_line_and_of_kienzle_come_back() {
        let line = of_one(&cuts(|h| 40e3 + 2100e6 * h), 2.5, 0).unwrap();
        assert!((line.cutting.value / 2100e6 - 1.0).abs() < 1e-10, "{line:?}");
        assert!((line.edge.value / 40e3 - 1.0).abs() < 1e-10, "{line:?}");
        assert_eq!((line.cuts, line.thicknesses), (4, [0.05e-3, 0.2e-3]));
        // C45: k_c1.1 = 1680 N/mm^2, m_c = 0.26: 0.1 mm need 1680 * 0.1^0.74 N per mm of width.
        let steel = |h: f64| 1e3 * 1680.0 * (h / 1e-3).powf(0.74);
        let found = of_one(&cuts(steel), 2.5, 0).unwrap().kienzle.unwrap();
        assert!((found.specific_force[0] / 1680e6 - 1.0).abs() < 1e-10, "{found:?}");
        assert!((found.exponent.value - 0.26).abs() < 1e-10, "{found:?}");
        assert!(
            of_one(&cuts(steel), 2.5, 1).unwrap().kienzle.is_none(),
            "a force that is not positive"
        );
        assert!(of_one(&cuts(steel)[..2], 2.5, 0).is_none(), "two thicknesses leave no scatter");
        assert!(of_one(&cuts(steel), 3.0, 0).is_none());
    }

    #[test]
    fn the_tables_have_a_line_each() {
        let one = of_one(&cuts(|h| 40e3 + 2100e6 * h), 2.5, 0).unwrap();
        let named = ForceCoefficients {
            settings: vec![("tool.rake_angle".to_owned(), "-5 deg".to_owned())],
            force: "F_c",
            ..one
        };
        let text = coefficients_csv(std::slice::from_ref(&named));
        let mut lines = text.lines();
        assert!(
            lines.next().unwrap().starts_with("tool.rake_angle,v_c [m/min],force,cuts,"),
            "{text}"
        );
        assert!(
            lines
                .next()
                .unwrap()
                .starts_with("'-5 deg,150.000000,F_c,4,0.050000,0.200000,2100.000000,"),
            "{text}"
        );
        let json: Value = serde_json::from_str(&coefficients_json(&[named])).unwrap();
        let edge = json["coefficients"][0]["K_e"]["value"].as_f64().unwrap();
        assert!((edge / 40e3 - 1.0).abs() < 1e-9, "{json}");
    }
}
