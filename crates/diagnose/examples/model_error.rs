//! How wrong the closed form is by itself, by its comparisons with measured cuts: the table of `model/closed_form.rs`, and what it would be
//! without each data set. The constants are known up to the scatter of a batch: with the spread of published sets four cuts say
//! nothing of the model. `cargo run --release -p sphcut-diagnose --example model_error`

use sphcut_diagnose::{
    AmplitudeWeights, ClosedForm, InstrumentPriors, Predictor, Recording, Recordings,
    RegressionProblem, closed_form_cut, load_diagnosis,
};
use sphcut_physics::{BATCH_SCATTER, Channel};
use sphcut_scenario::LoadOptions;
use std::path::Path;

/// Measured cuts and the scenario with all that was measured of the tool: nothing is known to be missing.
const SETS: [&str; 2] = ["diagnosis_nist/as_simulated.toml", "diagnosis_klippel/blunt.toml"];
const QUANTILES: [f64; 4] = [0.125, 0.375, 0.625, 0.875];

type Weights = Vec<AmplitudeWeights>;

fn weights(file: &str) -> Result<Weights, Box<dyn std::error::Error>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation").join(file);
    let case = load_diagnosis(&path, &LoadOptions::default()).map_err(|e| format!("{e:?}"))?;
    let model = ClosedForm::new(closed_form_cut(&case.base)?, &BATCH_SCATTER);
    let rows = case.measured.iter().map(|row| Recording {
        condition: row.condition(),
        count: row.count,
        values: row.values,
        deviations: row.deviations,
    });
    let recordings = Recordings::new(rows.collect(), model.channels())?;
    let [gain, offset, drift] = case.instruments;
    let priors = InstrumentPriors { gain, offset, drift };
    let problem = RegressionProblem::new(&recordings, &model, &priors)?;
    Ok(problem.amplitudes_of_model_error(&model)?)
}

/// The quantiles of a channel by the mean of the sets that have it; without one, of all channels. Each amplitude stands for those up to
/// a factor of sqrt(2) away, even in the logarithm.
fn quantiles(sets: &[&Weights], channel: Channel) -> [f64; 4] {
    let all = || sets.iter().flat_map(|set| set.iter());
    let has = all().any(|(c, _)| *c == channel);
    let own: Vec<_> = all().filter(|(c, _)| !has || *c == channel).map(|(_, w)| w).collect();
    let mean = |k: usize| own.iter().map(|w| w[k][1]).sum::<f64>() / own.len() as f64;
    QUANTILES.map(|quantile| {
        let mut below = 0.0;
        for k in 0..own[0].len() {
            if below + mean(k) >= quantile {
                return own[0][k][0] * 2.0_f64.powf((quantile - below) / mean(k) - 0.5);
            }
            below += mean(k);
        }
        f64::NAN
    })
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let sets: Vec<Weights> = SETS.iter().map(|file| weights(file)).collect::<Result<_, _>>()?;
    for (file, set) in SETS.iter().zip(&sets) {
        println!("{file}: amplitude and probability");
        for (channel, all) in set {
            let text: Vec<String> =
                all.iter().map(|[a, p]| format!("{:.2} %: {p:.3}", 100.0 * a)).collect();
            println!("  {}: {}", channel.symbol(), text.join(", "));
        }
    }
    for left in 0..=SETS.len() {
        let kept: Vec<&Weights> =
            sets.iter().enumerate().filter(|(k, _)| *k != left).map(|(_, set)| set).collect();
        println!("{}", SETS.get(left).map_or("all".to_owned(), |file| format!("without {file}")));
        for channel in Channel::RECORDED {
            let shown = quantiles(&kept, channel).map(|a| format!("{a:.3}"));
            println!("  {}: {}", channel.symbol(), shown.join(", "));
        }
    }
    Ok(())
}
