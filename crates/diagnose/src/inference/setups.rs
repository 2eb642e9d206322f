//! Scatter between conditions that their repeats do not show.

use crate::data::recordings::same_cut;
use crate::error::DiagnoseError;
use crate::inference::commissioning::{Bias, BiasOrigin};
use crate::inference::law::{Covariance, Factor, GaussianLaw};
use crate::inference::places::{scaled_places, tool_axes};
use crate::inference::problem::RegressionProblem;
use crate::model::predictor::Predictor;
use nalgebra::{DMatrix, DVector};
use sphcut_physics::Channel;

/// Standard deviations of the scatter that are tried, as shares of the value.
const SCATTERS: [f64; 9] = [0.0, 0.003, 0.005, 0.0075, 0.01, 0.015, 0.02, 0.03, 0.05];
/// Amplitudes of the smooth part that are tried, and the lengths over which it changes, in shares of the ranges of log v_c and log h.
const AMPLITUDES: [f64; 5] = [0.0, 0.02, 0.04, 0.08, 0.16];
const LENGTHS: [f64; 3] = [0.2, 0.4, 0.8];
/// Standard deviation of each coefficient of the quadratic: as good as unknown.
const UNKNOWN: f64 = 1.0;
/// By how much the scatter has to raise the logarithm of the evidence.
const CONVINCING: f64 = 1.92;
/// Conditions without which roughness cannot be told from a bend.
const FEWEST: usize = 16;

/// What neighbouring conditions differ by, beyond what repeats of one condition do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SetupScatter {
    /// The channel.
    pub channel: Channel,
    /// Standard deviation, as a share of the value.
    pub deviation: f64,
}

impl RegressionProblem {
    /// The same problem with the scatter between conditions as noise that all repeats of a condition share.
    ///
    /// Repeats that were cut one after the other in one setup, with edges of one box, say nothing of what changes from setup to setup.
    /// No effect of the catalogue jumps between neighbouring conditions, so what does is no physics: with z = log y - log M at
    /// the means of all nuisances, channel by channel,
    ///
    /// ```text
    /// z_i = quadratic(log v, log h) + smooth(log v, log h) + setup(condition) + noise_i
    /// ```
    ///
    /// a quadratic with free coefficients (and slopes over rake and edge radius, with v and h, where tools differ), a normal process of amplitude a and length l, and an independent normal
    /// deviation s of each condition. s is that of greatest evidence over a, l and s, and 0 unless it is convincingly better than none.
    ///
    /// # Errors
    /// A covariance that cannot be inverted.
    pub fn with_setup_scatter(
        mut self,
        predictor: &dyn Predictor,
    ) -> Result<(Self, Vec<SetupScatter>), DiagnoseError> {
        let base = self.predict(predictor, &DVector::zeros(self.model_unknowns()), &[]);
        let mut found = Vec::new();
        for channel in self.channels() {
            let deviation = self.scatter(channel, &base)?;
            if deviation > 0.0 {
                found.push(SetupScatter { channel, deviation });
            }
        }
        let factors = found.iter().map(|s| self.bias_factor(s.channel, independent(s.deviation)));
        let factors = factors.collect();
        self = self.with_common(factors)?;
        Ok((self, found))
    }

    fn scatter(&self, channel: Channel, base: &DVector<f64>) -> Result<f64, DiagnoseError> {
        let rows: Vec<usize> =
            (0..self.rows.len()).filter(|&k| self.rows[k].channel == channel).collect();
        let mut conditions: Vec<usize> = Vec::new();
        for &row in &rows {
            if !conditions.iter().any(|&k| same_cut(self.condition(k), self.condition(row))) {
                conditions.push(row);
            }
        }
        if conditions.len() < FEWEST {
            return Ok(0.0);
        }
        let count = rows.len();
        let z = rows.iter().map(|&k| self.rows[k].log_value - base[k]);
        let z = DVector::from_iterator(count, z);
        let places = scaled_places(self);
        let of_tool = tool_axes(&places);
        let quadratic = DMatrix::from_fn(count, 6 + 3 * of_tool.len(), |i, term| {
            let place = places[rows[i]];
            let [x, y] = [place[0], place[1]];
            if term < 6 {
                return UNKNOWN * [1.0, x, y, x * x, x * y, y * y][term];
            }
            UNKNOWN * place[of_tool[(term - 6) / 3]] * [1.0, x, y][(term - 6) % 3]
        });
        let noise = Covariance { factors: Vec::new(), ..self.covariance.clone() };
        let plain = GaussianLaw::new(&noise.select(&rows))?.with(&Factor::of_all(quadratic))?;
        let own = |bias: Bias| Factor::of_all(self.bias_factor(channel, bias).columns);
        let mut best = [(f64::NEG_INFINITY, 0.0); 2];
        for length in LENGTHS {
            for amplitude in AMPLITUDES {
                let bias = Bias { length, ..independent(amplitude) };
                let smooth = plain.with(&own(bias))?;
                for scatter in SCATTERS {
                    let law = smooth.with(&own(independent(scatter)))?;
                    let white = law.whiten_vector(z.clone());
                    let evidence = -0.5 * (white.norm_squared() + law.log_determinant());
                    let place = &mut best[usize::from(scatter > 0.0)];
                    if evidence > place.0 {
                        *place = (evidence, scatter);
                    }
                }
            }
        }
        let [without, with] = best;
        Ok(if with.0 > without.0 + CONVINCING { with.1 } else { 0.0 })
    }
}

/// A deviation of each condition on its own.
fn independent(deviation: f64) -> Bias {
    Bias { amplitude: deviation, length: 0.0, origin: BiasOrigin::Stated }
}

#[cfg(test)]
mod tests {
    use crate::data::recordings::{Recording, Recordings};
    use crate::model::predictor::{Active, Predictor};
    use crate::tests::twin::Twin;
    use sphcut_greybox::Random;
    use sphcut_physics::CuttingCondition;

    const NOISE: f64 = 0.01;

    /// Cuts of 7 speeds and 6 thicknesses, each condition moved by a deviation of its own.
    fn recorded(active: &[Active], deviation: f64, seed: u64) -> Recordings {
        let twin = Twin::new();
        let mut random = Random::new(seed, &[5]);
        let cuts = (0..42).map(|k| {
            let condition =
                CuttingCondition::new(0.5 * 1.6_f64.powi(k % 7), 0.03e-3 * 1.5_f64.powi(k / 7));
            let logs = twin.log_observables(&condition, &[0.0, 0.0], active);
            let (mut values, mut deviations) = ([None; 7], [None; 7]);
            for (c, log) in logs.into_iter().enumerate() {
                let value = (log + NOISE * random.normal() + deviation * random.normal()).exp();
                values[c] = Some(value);
                deviations[c] = Some(NOISE * value);
            }
            Recording { condition, count: None, values, deviations }
        });
        Recordings::new(cuts.collect(), twin.channels()).unwrap()
    }

    #[test]
    fn scatter_between_conditions_is_found_where_there_is_some() {
        let twin = Twin::new();
        let (mut false_ones, mut squares) = (0, 0.0);
        for seed in 0..20 {
            let quiet = twin.problem(&recorded(&[], 0.0, seed));
            false_ones += quiet.with_setup_scatter(&twin).unwrap().1.len();
            let plain = twin.problem(&recorded(&[], 0.03, seed));
            let (problem, found) = plain.clone().with_setup_scatter(&twin).unwrap();
            squares += found.iter().map(|s| s.deviation.powi(2)).sum::<f64>() / 40.0;
            // Noise of its own and of its condition.
            let of_first = found.iter().find(|s| s.channel == problem.rows[0].channel);
            let own = of_first.map_or(0.0, |s| s.deviation.powi(2));
            let added = problem.covariance.dense()[(0, 0)] - plain.covariance.dense()[(0, 0)];
            assert!((added - own).abs() < 1e-9, "{added} {found:?}");
        }
        // 40 channels: 2.5 % of them are convincing by chance, 4 is the 98 % quantile.
        assert!(false_ones <= 4, "{false_ones}");
        // 42 conditions less some 10 of quadratic and smooth part: a variance to 25 % each, 40 of them to 4 %; the smooth part
        // takes its share where it can, and none found counts as none.
        let mean = squares.sqrt();
        assert!((0.024..=0.032).contains(&mean), "{mean}");
    }

    /// An effect is no scatter: it goes into the quadratic and the smooth part.
    #[test]
    fn an_effect_is_no_scatter() {
        let twin = Twin::new();
        let hidden = [Active { effect: 1, values: vec![0.15] }];
        let found: usize = (0..20)
            .map(|seed| twin.problem(&recorded(&hidden, 0.0, seed)))
            .map(|problem| problem.with_setup_scatter(&twin).unwrap().1.len())
            .sum();
        assert!(found <= 4, "{found}");
    }
}
