//! Mistakes of a table that no physics makes: wrong units, exchanged columns, a wrong decimal point, values in another order than
//! their conditions.

use crate::data::recordings::{Recordings, groups};
use crate::error::DiagnoseError;
use crate::model::predictor::Predictor;
use nalgebra::DVector;
use sphcut_physics::{Channel, CuttingCondition};
use sphcut_postprocess::statistics::median;
use sphcut_scenario::Scenario;

/// Thicknesses that are cut, in m: below, millimetres stand for micrometres; above, micrometres for millimetres.
const THICKNESSES: [f64; 2] = [1e-6, 10e-3];
/// Speeds that are a sixtieth of the scenario's, or sixty times as high, within this factor are in the other unit.
const SIXTIETH_MARGIN: f64 = 2.0;
/// The logarithm by which a whole column may miss a power of a thousand and still be of another unit. No model of a cut is wrong by thirty.
const UNIT_MARGIN: f64 = 1.5;
/// Factor by which values follow the prediction better with two columns exchanged, as mean squares of the logarithm.
const EXCHANGED: f64 = 4.0;
/// Above this root mean square the prediction is wrong as it is; below, right when exchanged.
const WRONG: f64 = 0.35;
/// Spread of the logarithm of a prediction from which on its order is that of the measured values, and the correlation of the two
/// below which it is not.
const SPREAD: f64 = 0.25;
const CORRELATED: f64 = 0.3;
/// Values that a correlation and a neighbourhood need.
const FEWEST: usize = 8;
/// Neighbours of a value.
const NEIGHBOURS: usize = 6;
/// A value is ten times another if the logarithm of the ratio misses that of ten by less than this, and stands out by so many times
/// the median of all such differences.
const TENFOLD_MARGIN: f64 = 0.4;
const STANDS_OUT: f64 = 6.0;

/// Values of a channel over those that the model has before anything is fitted.
struct Compared {
    channel: Channel,
    /// Number of the recording, ln of the measured and of the predicted value.
    values: Vec<(usize, f64, f64)>,
}

impl Compared {
    fn ratios(&self) -> impl Iterator<Item = f64> + '_ {
        self.values.iter().map(|(_, measured, predicted)| measured - predicted)
    }
}

/// Refuses a table with a mistake that shows, and says which it probably is.
///
/// The model is asked as it is. It may be wrong by a factor of a few, as an unmodelled edge or friction makes it, and its values
/// rise with the thickness as those of every cut do: more is not used.
pub(crate) fn refuse_mistakes(
    recordings: &Recordings,
    model: &dyn Predictor,
    scenario: &Scenario,
) -> Result<(), DiagnoseError> {
    let speeds = || recordings.all().iter().map(|r| r.condition.cutting_speed).collect::<Vec<_>>();
    let speed = || wrong_unit_of_speed(&speeds(), scenario);
    let found = thickness(recordings).or_else(speed).or_else(|| {
        let all = compared(recordings, model);
        let units = all.iter().find_map(unit);
        units
            .or_else(|| all.iter().find_map(|one| decimal_point(one, recordings)))
            .or_else(|| exchanged(&all))
            .or_else(|| order(&all, recordings))
    });
    found.map_or(Ok(()), |what| Err(DiagnoseError::Mistake { what }))
}

/// The unit that an uncut chip thickness in m, which nobody cuts, is probably in, and that of its head; `None` for one that is cut.
#[must_use]
pub fn wrong_unit_of_thickness(h: f64) -> Option<[&'static str; 2]> {
    let [low, high] = THICKNESSES;
    match h {
        _ if h < low => Some(["mm", "um"]),
        _ if h > high => Some(["um", "mm"]),
        _ => None,
    }
}

/// What is said of cutting speeds, in m/s, of which the median is about a sixtieth of the speed of `scenario` or sixty times it: m/s under
/// a head in m/min, or the reverse. Forces change so little over the speed that no value shows it. The speed of the scenario is not
/// cut where a table says the speeds, so that who does cut there can put it among them.
#[must_use]
pub fn wrong_unit_of_speed(speeds: &[f64], scenario: &Scenario) -> Option<String> {
    let entry =
        scenario.description.iter().find(|e| e.section == "process" && e.key == "cutting_speed");
    let stated = entry?.number?;
    let middle = median(speeds);
    let ratio = (middle / stated).ln();
    let is_wrong = (ratio.abs() - 60.0_f64.ln()).abs() < SIXTIETH_MARGIN.ln();
    let (times, meant, written) = if ratio < 0.0 {
        ("a sixtieth of", "m/s", "m/min")
    } else {
        ("sixty times", "m/min", "m/s")
    };
    is_wrong.then(|| {
        format!(
            "the cutting speeds, {:.1} m/min in the median, are about {times} the {:.1} m/min of the scenario: the column probably \
             holds {meant} and is headed `v_c [{written}]`; if they are right, give the scenario one of them",
            middle * 60.0,
            stated * 60.0
        )
    })
}

fn thickness(recordings: &Recordings) -> Option<String> {
    let all = recordings.all().iter().map(|r| r.condition.uncut_chip_thickness);
    let h = median(&all.collect::<Vec<f64>>());
    let [meant, written] = wrong_unit_of_thickness(h)?;
    Some(format!(
        "half of the uncut chip thicknesses are {} {:.3} mm, which nobody cuts: the column probably holds {meant} and is headed \
         `h [{written}]`",
        if written == "um" { "below" } else { "above" },
        h * 1e3
    ))
}

fn compared(recordings: &Recordings, model: &dyn Predictor) -> Vec<Compared> {
    let none = vec![0.0; model.nuisances().len()];
    let answers: Vec<Vec<f64>> = recordings
        .all()
        .iter()
        .map(|recording| model.log_observables(&recording.condition, &none, &[]))
        .collect();
    let of = |channel: Channel| {
        let place = model.channels().iter().position(|c| *c == channel)?;
        let values = recordings.all().iter().zip(&answers).enumerate();
        let values = values.filter_map(|(k, (recording, answer))| {
            let measured = recording.values[channel.index()]?.ln();
            answer[place].is_finite().then_some((k, measured, answer[place]))
        });
        Some(Compared { channel, values: values.collect() })
    };
    recordings.channels().filter_map(of).collect()
}

/// A channel that is wrong by a thousand throughout.
fn unit(one: &Compared) -> Option<String> {
    let ratio = median(&one.ratios().collect::<Vec<f64>>());
    let thousand = 1000.0_f64.ln();
    let is_wrong = one.channel != Channel::InterfaceTemperature
        && (ratio.abs() - thousand).abs() < UNIT_MARGIN;
    let symbol = one.channel.symbol();
    let (large, small, or) = if one.channel.is_force() {
        ("kN", "N", ", or the width of cut of the scenario is wrong by as much")
    } else {
        ("mm", "um", "")
    };
    let (word, meant, written) =
        if ratio < 0.0 { ("small", large, small) } else { ("large", small, large) };
    is_wrong.then(|| {
        format!(
            "{symbol} is about a thousand times too {word}: the column probably holds {meant} and is headed `{symbol} \
             [{written}]`{or}"
        )
    })
}

/// A value that is ten times those of its neighbours over speed and thickness, or a tenth, after what the model has of the difference.
fn decimal_point(one: &Compared, recordings: &Recordings) -> Option<String> {
    if one.values.len() < FEWEST {
        return None;
    }
    let place = |k: usize| {
        let CuttingCondition { cutting_speed, uncut_chip_thickness, .. } =
            recordings.all()[k].condition;
        [cutting_speed.ln(), uncut_chip_thickness.ln()]
    };
    let away: Vec<f64> = one
        .values
        .iter()
        .map(|&(k, measured, predicted)| {
            let mut others: Vec<(f64, f64)> = one
                .values
                .iter()
                .filter(|other| other.0 != k)
                .map(|&(j, measured, predicted)| {
                    let (a, b) = (place(k), place(j));
                    ((a[0] - b[0]).hypot(a[1] - b[1]), measured - predicted)
                })
                .collect();
            others.sort_by(|a, b| a.0.total_cmp(&b.0));
            others.truncate(NEIGHBOURS);
            let near: Vec<f64> = others.into_iter().map(|(_, ratio)| ratio).collect();
            measured - predicted - median(&near)
        })
        .collect();
    let typical = median(&away.iter().map(|x| x.abs()).collect::<Vec<f64>>());
    let is_tenfold =
        |x: f64| (x.abs() - 10.0_f64.ln()).abs() < TENFOLD_MARGIN && x.abs() > STANDS_OUT * typical;
    let (&(k, measured, _), &x) = one
        .values
        .iter()
        .zip(&away)
        .filter(|(_, x)| is_tenfold(**x))
        .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    Some(format!(
        "recording {}: {} = {:.3e} {} is {} of what its neighbours over speed and thickness have: probably a wrong decimal point; \
         correct it or leave the cell empty",
        k + 1,
        one.channel.symbol(),
        measured.exp(),
        one.channel.unit(),
        if x > 0.0 { "ten times" } else { "a tenth" }
    ))
}

/// Two channels of the same unit that each follow the prediction of the other.
fn exchanged(all: &[Compared]) -> Option<String> {
    let pairs = all.iter().enumerate().flat_map(|(k, a)| all[k + 1..].iter().map(move |b| (a, b)));
    let pair = pairs.filter(|(a, b)| a.channel.unit() == b.channel.unit()).find(|(a, b)| {
        let both: Vec<[f64; 4]> = a
            .values
            .iter()
            .filter_map(|&(k, measured, predicted)| {
                let other = b.values.iter().find(|other| other.0 == k)?;
                Some([measured, predicted, other.1, other.2])
            })
            .collect();
        let count = 2.0 * both.len() as f64;
        let as_it_is: f64 = both.iter().map(|[a, p, b, q]| (a - p).powi(2) + (b - q).powi(2)).sum();
        let crossed: f64 = both.iter().map(|[a, p, b, q]| (a - q).powi(2) + (b - p).powi(2)).sum();
        as_it_is > EXCHANGED * crossed
            && (as_it_is / count).sqrt() > WRONG
            && (crossed / count).sqrt() < WRONG
    });
    pair.map(|(a, b)| {
        format!(
            "{a} follows the prediction of {b} and {b} that of {a}: the two columns are probably exchanged",
            a = a.channel.symbol(),
            b = b.channel.symbol()
        )
    })
}

/// Values that belong to other lines: the cutting force does not rise with the thickness, or repeats of a condition differ as much as
/// conditions do.
fn order(all: &[Compared], recordings: &Recordings) -> Option<String> {
    let conditions = groups(recordings.all());
    let of = |one: &Compared| {
        if one.values.len() < FEWEST {
            return None;
        }
        let column = |of: fn(&(usize, f64, f64)) -> f64| {
            DVector::from_iterator(one.values.len(), one.values.iter().map(of))
        };
        let (measured, predicted) = (column(|value| value.1), column(|value| value.2));
        let spread = predicted.variance().sqrt();
        if spread < SPREAD {
            return None;
        }
        let symbol = one.channel.symbol();
        let common =
            measured.dot(&predicted) / measured.len() as f64 - measured.mean() * predicted.mean();
        let correlation = common / (spread * measured.variance().sqrt());
        if one.channel == Channel::CuttingForce && correlation < CORRELATED {
            return Some(format!(
                "{symbol} does not rise and fall with speed and thickness as that of a cut does (its logarithm correlates by \
                 {correlation:.2} with the prediction): its values are probably in another order than the conditions"
            ));
        }
        let (mut within, mut freedom) = (0.0, 0.0);
        for group in &conditions {
            let own = one.values.iter().filter(|v| group.contains(&v.0)).map(|v| v.1);
            let own = DVector::from_vec(own.collect());
            within += own.variance() * own.len() as f64;
            freedom += own.len().saturating_sub(1) as f64;
        }
        let share = within / freedom / measured.variance();
        (freedom >= FEWEST as f64 && share > 1.0 - CORRELATED).then(|| {
            format!(
                "repeats of a condition differ in {symbol} as much as conditions do: its values are probably in another order \
                 than the conditions"
            )
        })
    };
    all.iter().find_map(of)
}

#[cfg(test)]
mod tests {
    use crate::model::closed_form::ClosedForm;
    use crate::model::closed_form_cut::closed_form_cut;
    use crate::{DiagnosisCase, load_diagnosis};
    use sphcut_scenario::LoadOptions;
    use std::path::Path;

    /// What is said of the example, in which an effect is concealed, when `spoil` has been at its table.
    fn said(spoil: impl FnOnce(&mut DiagnosisCase)) -> Option<String> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/diagnosis");
        let mut case = load_diagnosis(&root.join("example.toml"), &LoadOptions::default()).unwrap();
        spoil(&mut case);
        let model = ClosedForm::new(closed_form_cut(&case.base).unwrap(), &case.scatter());
        let found = crate::case::recordings(&case.measured, &model, &case.base, "measured");
        found.err().map(|error| error.to_string())
    }

    fn expect(part: &str, spoil: impl FnOnce(&mut DiagnosisCase)) {
        let found = said(spoil).unwrap_or_default();
        assert!(found.contains(part), "`{part}` is not in `{found}`");
    }

    fn scale(case: &mut DiagnosisCase, channel: usize, by: f64) {
        for row in &mut case.measured {
            row.values[channel] = row.values[channel].map(|value| value * by);
        }
    }

    #[test]
    fn a_table_without_a_mistake_is_taken() {
        assert_eq!(said(|_| {}), None);
        // A dull edge may double or treble the feed force; that is physics.
        assert_eq!(said(|case| scale(case, 1, 3.0)), None);
    }

    #[test]
    fn exchanged_columns_are_said() {
        expect("the two columns are probably exchanged", |case| {
            case.measured.iter_mut().for_each(|row| row.values.swap(0, 1));
        });
    }

    #[test]
    fn wrong_units_are_said() {
        expect("F_c is about a thousand times too small: the column probably holds kN", |case| {
            scale(case, 0, 1e-3);
        });
        expect("the column probably holds mm and is headed `h [um]`", |case| {
            case.measured.iter_mut().for_each(|row| row.uncut_chip_thickness *= 1e-3);
        });
        // 1.1 to 5.3 m/s under a head in m/min.
        expect("the column probably holds m/s and is headed `v_c [m/min]`", |case| {
            case.measured.iter_mut().for_each(|row| row.cutting_speed /= 60.0);
        });
        expect("sixty times the", |case| {
            case.measured.iter_mut().for_each(|row| row.cutting_speed *= 60.0);
        });
        expect(
            "chip_thickness is about a thousand times too small: the column probably holds mm",
            |case| {
                scale(case, 4, 1e-3);
            },
        );
    }

    #[test]
    fn a_wrong_decimal_point_is_said() {
        for (channel, by) in [(0, 10.0), (1, 10.0), (0, 0.1)] {
            expect("probably a wrong decimal point", |case| {
                let value = case.measured[17].values[channel].as_mut().unwrap();
                *value *= by;
            });
        }
        expect("recording 18: F_f = ", |case| {
            *case.measured[17].values[1].as_mut().unwrap() *= 10.0;
        });
    }

    #[test]
    fn values_in_another_order_are_said() {
        expect("in another order than the conditions", |case| {
            let values: Vec<_> = case.measured.iter().map(|row| row.values).collect();
            let rows = case.measured.len();
            for (k, row) in case.measured.iter_mut().enumerate() {
                row.values = values[(k * 7 + 3) % rows];
            }
        });
    }

    #[test]
    fn repeats_without_scatter_have_a_message_of_their_own() {
        expect("all repeats of F_c agree to the last digit", |case| {
            let first = case.measured.clone();
            for row in &mut case.measured {
                let same = first.iter().find(|r| {
                    r.cutting_speed == row.cutting_speed
                        && r.uncut_chip_thickness == row.uncut_chip_thickness
                });
                row.values = same.unwrap().values;
            }
        });
    }
}
