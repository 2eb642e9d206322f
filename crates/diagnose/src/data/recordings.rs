//! Recordings, and what they say of their own noise.

use crate::data::noise::{NoiseLaw, Scatter};
use crate::error::DiagnoseError;
use sphcut_physics::{Channel, CuttingCondition, ToolGeometry};

/// Different conditions that a diagnosis needs: as many as a quadratic in v_c and h has coefficients.
const FEWEST_CONDITIONS: usize = 6;
/// And where the noise of every channel is stated, so that no value has to teach it: two steps of two quantities, which show what either
/// changes and what both change together.
const FEWEST_CONDITIONS_STATED: usize = 4;
/// Values for each condition that make up for the others, on average. With three, four conditions have as many values as six with both
/// forces, and twice as many as a pair of effects can have parameters (six). And no effect can follow a third channel as it likes: it
/// changes F_c, F_f and temperature together.
const VALUES_STATED: usize = 3;
/// Degrees of freedom below which repeats say nothing useful of a noise.
const FEWEST_FREEDOM: f64 = 3.0;
/// Relative difference below which two conditions are the same.
const SAME: f64 = 1e-6;

/// One recorded cut, or the mean of some. SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// The cut.
    pub condition: CuttingCondition,
    /// Number of cuts of which it is the mean.
    pub count: Option<f64>,
    /// What was measured, by channel.
    pub values: [Option<f64>; Channel::RECORDED.len()],
    /// Standard deviation of a single cut, by channel; with no `count`, that of the value.
    pub deviations: [Option<f64>; Channel::RECORDED.len()],
}

/// Where a noise comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoiseSource {
    /// Scatter of the recordings of one condition.
    Repeats,
    /// The standard deviations of the table.
    Stated,
}

/// Noise of a channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChannelNoise {
    /// The channel.
    pub channel: Channel,
    /// Root mean square of the standard deviation of a single cut, as a share of the value.
    pub deviation: f64,
    /// The part that does not depend on the value, in its unit, and the part that is a share of it.
    pub parts: [f64; 2],
    /// Degrees of freedom; infinite if stated.
    pub freedom: f64,
    /// Where it comes from.
    pub source: NoiseSource,
}

/// Recordings with their noise.
#[derive(Debug, Clone, PartialEq)]
pub struct Recordings {
    recordings: Vec<Recording>,
    noise: Vec<ChannelNoise>,
    /// Variance of log y of each value.
    variances: Vec<[Option<f64>; Channel::RECORDED.len()]>,
}

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * a.abs().max(b.abs())
}

/// Whether two cuts have the same speed and thickness, and tools of the same shape.
#[must_use]
pub fn same_cut(a: &CuttingCondition, b: &CuttingCondition) -> bool {
    same(a.cutting_speed, b.cutting_speed)
        && same(a.uncut_chip_thickness, b.uncut_chip_thickness)
        && same_tool(&a.tool, &b.tool)
}

/// Whether two tools have the same shape.
pub(crate) fn same_tool(a: &ToolGeometry, b: &ToolGeometry) -> bool {
    a.parts().into_iter().zip(b.parts()).all(|pair| match pair {
        (Some(a), Some(b)) => same(a, b),
        (a, b) => a == b,
    })
}

impl Recordings {
    /// Takes those of `predicted` channels that were measured, and finds the noise of each.
    ///
    /// # Errors
    /// Too few conditions, a noise that cannot be told, a value without logarithm.
    pub fn new(recordings: Vec<Recording>, predicted: &[Channel]) -> Result<Self, DiagnoseError> {
        for (number, recording) in recordings.iter().enumerate() {
            for channel in Channel::RECORDED {
                let value = recording.values[channel.index()].unwrap_or(1.0);
                if value.is_nan() || value <= 0.0 || value.is_infinite() {
                    return Err(DiagnoseError::NotPositive {
                        channel,
                        recording: number + 1,
                        value,
                    });
                }
            }
        }
        let groups = groups(&recordings);
        check_number(&recordings, &groups, predicted)?;
        let mut found = Self {
            variances: vec![[None; Channel::RECORDED.len()]; recordings.len()],
            recordings,
            noise: Vec::new(),
        };
        for &channel in predicted {
            found.read_noise(channel, &groups)?;
        }
        if found.noise.is_empty() { Err(DiagnoseError::NothingPredicted) } else { Ok(found) }
    }

    /// The recordings.
    #[must_use]
    pub fn all(&self) -> &[Recording] {
        &self.recordings
    }

    /// Noise of each channel that is used.
    #[must_use]
    pub fn noise(&self) -> &[ChannelNoise] {
        &self.noise
    }

    /// Channels that are used.
    pub fn channels(&self) -> impl Iterator<Item = Channel> + '_ {
        self.noise.iter().map(|noise| noise.channel)
    }

    /// Variance of log y.
    pub(crate) fn variance(&self, recording: usize, channel: Channel) -> Option<f64> {
        self.variances[recording][channel.index()]
    }

    /// The recordings for which `keep` holds, with the noise of all.
    #[must_use]
    pub fn filtered(&self, keep: impl Fn(usize) -> bool) -> Self {
        let kept: Vec<usize> = (0..self.recordings.len()).filter(|&k| keep(k)).collect();
        Self {
            recordings: kept.iter().map(|&k| self.recordings[k].clone()).collect(),
            noise: self.noise.clone(),
            variances: kept.iter().map(|&k| self.variances[k]).collect(),
        }
    }

    /// The same design and noise with other values, given as their logarithms.
    #[must_use]
    pub fn with_logarithms(&self, mut value: impl FnMut(usize, Channel) -> f64) -> Self {
        let mut other = self.clone();
        for (k, recording) in other.recordings.iter_mut().enumerate() {
            for channel in Channel::RECORDED {
                if let Some(y) = recording.values[channel.index()].as_mut() {
                    *y = value(k, channel).exp();
                }
            }
        }
        other
    }

    /// The noise of a channel is a share of the value, with a part of it constant where the repeats say so ([`NoiseLaw`]), unless it
    /// is stated value by value.
    ///
    /// With repeats in n recordings of one condition, sorted by cut length and run order, s^2 = sum (y_(j+1) - y_j)^2 / 2
    /// over the logarithms (von Neumann, Ann. Math. Stat. 12 (1941) 367-395): a slow drift between repeats does not
    /// count as noise. Its degrees of freedom are 2 (n - 1)^2 / (3 n - 4). The variance used is s^2 nu / (nu - 2), the
    /// expectation of sigma^2 when s^2 has been seen (Jeffreys' prior); few repeats therefore mean caution.
    ///
    /// A line that is the mean of n cuts and states their standard deviation is a group of repeats in one line, with n - 1 degrees
    /// of freedom: three cuts that agree by chance do not make their mean exact. A deviation without n is taken as it stands.
    fn read_noise(&mut self, channel: Channel, groups: &[Vec<usize>]) -> Result<(), DiagnoseError> {
        let c = channel.index();
        let rows: Vec<usize> = (0..self.recordings.len())
            .filter(|&k| self.recordings[k].values[c].is_some())
            .collect();
        if rows.is_empty() {
            return Ok(());
        }
        let count = |k: usize| self.recordings[k].count.unwrap_or(1.0).max(1.0);
        let relative =
            |k: usize| Some(self.recordings[k].deviations[c]? / self.recordings[k].values[c]?);
        let mut scatter = self.repeats(c, groups);
        scatter.extend(self.condensed(c));
        let freedom = scatter.iter().map(|s| s.freedom).sum();
        let law = NoiseLaw::most_likely(&scatter, FEWEST_FREEDOM);
        let stated: Vec<Option<f64>> = rows.iter().map(|&k| relative(k).map(|s| s * s)).collect();
        let all_stated = stated.iter().all(|s| s.is_some_and(|variance| variance > 0.0));
        if !all_stated && law.is_none() {
            if freedom >= FEWEST_FREEDOM {
                return Err(DiagnoseError::NoScatter { channel });
            }
            return Err(DiagnoseError::UnknownNoise { channel, freedom, needed: FEWEST_FREEDOM });
        }
        let mut squares = 0.0;
        for (&k, stated) in rows.iter().zip(&stated) {
            // The scatter within a cut leaves out that between cuts: the larger of both counts.
            let exact = stated
                .filter(|_| all_stated && (law.is_none() || self.recordings[k].count.is_none()));
            let value = self.recordings[k].values[c].unwrap_or(f64::NAN);
            let single = exact.unwrap_or(0.0).max(law.map_or(0.0, |law| law.variance(value)));
            squares += single;
            self.variances[k][c] = Some(single / count(k));
        }
        let deviation = (squares / rows.len() as f64).sqrt();
        self.noise.push(match law {
            Some(NoiseLaw { constant, share, freedom }) => ChannelNoise {
                channel,
                deviation,
                parts: [constant.sqrt(), share.sqrt()],
                freedom,
                source: NoiseSource::Repeats,
            },
            None => ChannelNoise {
                channel,
                deviation,
                parts: [0.0, deviation],
                freedom: f64::INFINITY,
                source: NoiseSource::Stated,
            },
        });
        Ok(())
    }

    /// The scatter within the lines that are means of several cuts.
    fn condensed(&self, c: usize) -> Vec<Scatter> {
        let of = |recording: &Recording| {
            let value = recording.values[c]?;
            let share = recording.deviations[c]? / value;
            let freedom = (recording.count? - 1.0).max(0.0);
            Some(Scatter { variance: share * share, freedom, value })
        };
        self.recordings.iter().filter_map(of).collect()
    }

    /// The scatter between the lines of each condition.
    fn repeats(&self, c: usize, groups: &[Vec<usize>]) -> Vec<Scatter> {
        let of = |group: &Vec<usize>| {
            let mut seen: Vec<(f64, f64, f64, f64)> = group
                .iter()
                .filter_map(|&k| {
                    let r = &self.recordings[k];
                    let count = r.count.unwrap_or(1.0).max(1.0);
                    Some((r.condition.cut_length, r.condition.run_order, r.values[c]?.ln(), count))
                })
                .collect();
            if seen.len() < 2 {
                return None;
            }
            seen.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
            // Of two means of n and m cuts the difference has the variance sigma^2 (1 / n + 1 / m).
            let squares: f64 = seen
                .windows(2)
                .map(|p| (p[1].2 - p[0].2).powi(2) / (1.0 / p[0].3 + 1.0 / p[1].3))
                .sum();
            let pairs = (seen.len() - 1) as f64;
            let value = (seen.iter().map(|cut| cut.2).sum::<f64>() / seen.len() as f64).exp();
            let freedom = 2.0 * pairs * pairs / (3.0 * pairs - 1.0);
            Some(Scatter { variance: squares / pairs, freedom, value })
        };
        groups.iter().filter_map(of).collect()
    }
}

/// Refuses conditions that are too few to tell anything: see the constants.
fn check_number(
    recordings: &[Recording],
    groups: &[Vec<usize>],
    predicted: &[Channel],
) -> Result<(), DiagnoseError> {
    let found = groups.len();
    let is_stated = recordings.iter().all(|r| {
        let known =
            |c: &Channel| r.values[c.index()].is_none() || r.deviations[c.index()].is_some();
        r.count.is_none() && predicted.iter().all(known)
    });
    let has = |group: &[usize], c: &Channel| {
        group.iter().any(|&k| recordings[k].values[c.index()].is_some())
    };
    let own = |group: &Vec<usize>| predicted.iter().filter(|c| has(group, c)).count();
    let values: usize = groups.iter().map(own).sum();
    let few = is_stated && found >= FEWEST_CONDITIONS_STATED && values >= VALUES_STATED * found;
    if found >= FEWEST_CONDITIONS || few {
        Ok(())
    } else {
        Err(DiagnoseError::TooFewConditions { found, needed: FEWEST_CONDITIONS })
    }
}

/// The tools of different shape.
pub(crate) fn tools(recordings: &[Recording]) -> Vec<ToolGeometry> {
    let mut found: Vec<ToolGeometry> = Vec::new();
    for recording in recordings {
        if !found.iter().any(|tool| same_tool(tool, &recording.condition.tool)) {
            found.push(recording.condition.tool);
        }
    }
    found
}

/// The recordings of each condition.
pub(crate) fn groups(recordings: &[Recording]) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (k, recording) in recordings.iter().enumerate() {
        let found = groups
            .iter_mut()
            .find(|group| same_cut(&recordings[group[0]].condition, &recording.condition));
        match found {
            Some(group) => group.push(k),
            None => groups.push(vec![k]),
        }
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;
    use sphcut_greybox::Random;

    fn recording(speed: f64, force: f64) -> Recording {
        let condition = CuttingCondition::new(speed, 1e-4);
        let mut values = [None; Channel::RECORDED.len()];
        values[0] = Some(force);
        Recording { condition, count: None, values, deviations: [None; Channel::RECORDED.len()] }
    }

    fn repeated(scatter: f64, drift: f64) -> Vec<Recording> {
        let mut random = Random::new(4, &[]);
        (0..400)
            .map(|k| {
                let speed = 1.0 + f64::from(k % 40);
                let force =
                    (6.0 + 0.01 * speed + scatter * random.normal() + drift * f64::from(k)).exp();
                let mut one = recording(speed, force);
                one.condition.run_order = f64::from(k);
                one
            })
            .collect()
    }

    const FORCE: [Channel; 1] = [Channel::CuttingForce];

    #[test]
    fn repeats_give_back_the_noise_they_were_made_with() {
        let found = Recordings::new(repeated(0.03, 0.0), &FORCE).unwrap();
        let noise = found.noise()[0];
        // 40 conditions of 10: 40 2 9^2 / 26 = 249 degrees of freedom, a standard deviation to 4.5 %.
        assert!((noise.freedom - 249.2).abs() < 0.1, "{noise:?}");
        assert!((noise.deviation / 0.03 - 1.0).abs() < 0.1, "{noise:?}");
        assert_eq!(noise.source, NoiseSource::Repeats);
    }

    #[test]
    fn a_drift_between_repeats_is_no_noise() {
        // 40 % over the whole series: the plain deviation from the mean of ten repeats would be 0.12.
        let found = Recordings::new(repeated(0.03, 0.001), &FORCE).unwrap();
        // Successive repeats are 0.04 apart: sqrt(0.03^2 + 0.04^2 / 2) = 0.041.
        assert!((found.noise()[0].deviation / 0.041 - 1.0).abs() < 0.1, "{:?}", found.noise());
    }

    #[test]
    fn two_repeats_by_hand() {
        // Four conditions with two repeats each a factor exp(0.02) apart: s^2 = 0.02^2 / 2, nu = 4, doubled for caution.
        let mut all: Vec<Recording> = (1..=6).map(|v| recording(f64::from(v), 100.0)).collect();
        all.extend((1..=4).map(|v| recording(f64::from(v), 100.0 * 0.02_f64.exp())));
        let found = Recordings::new(all, &FORCE).unwrap();
        assert!((found.noise()[0].freedom - 4.0).abs() < 1e-12);
        assert!((found.variance(0, Channel::CuttingForce).unwrap() - 4e-4).abs() < 1e-12);
    }

    #[test]
    fn stated_deviations_of_means_are_divided_by_the_root_of_their_number() {
        let all: Vec<Recording> = (1..=6)
            .map(|v| {
                let mut one = recording(f64::from(v), 200.0);
                one.deviations[0] = Some(8.0);
                Recording { count: Some(4.0), ..one }
            })
            .collect();
        let found = Recordings::new(all, &FORCE).unwrap();
        // 8 / 200 over the root of 4; six groups of four repeats leave 18 degrees of freedom: the variance times 18 / 16.
        let variance = found.variance(2, Channel::CuttingForce).unwrap();
        assert!((variance - 0.02 * 0.02 * 18.0 / 16.0).abs() < 1e-15);
        assert_eq!(found.noise()[0].source, NoiseSource::Repeats);
        assert!((found.noise()[0].freedom - 18.0).abs() < 1e-12);
    }

    /// Two speeds and two rakes with F_c, F_f and temperature whose noise is stated: twelve values.
    #[test]
    fn four_conditions_are_enough_with_three_channels_of_stated_noise() {
        let channels = [Channel::CuttingForce, Channel::FeedForce, Channel::InterfaceTemperature];
        let four = || -> Vec<Recording> {
            (0..4)
                .map(|k| {
                    let mut one = recording(f64::from(1 + k % 2), 500.0);
                    one.condition.tool.rake_angle = Some(f64::from(k / 2) * 0.1);
                    for channel in channels {
                        one.values[channel.index()] = Some(500.0);
                        one.deviations[channel.index()] = Some(5.0);
                    }
                    one
                })
                .collect()
        };
        let found = Recordings::new(four(), &channels).unwrap();
        assert_eq!(found.noise().len(), 3);
        let refused = |recordings: Vec<Recording>| {
            let error = Recordings::new(recordings, &channels).unwrap_err();
            assert!(matches!(error, DiagnoseError::TooFewConditions { .. }), "{error}");
        };
        // Eleven values; a value without a deviation; means of some cuts; three conditions; a channel that is not predicted.
        let changed = |change: fn(&mut Recording)| {
            let mut all = four();
            change(&mut all[2]);
            all
        };
        refused(changed(|one| one.values[0] = None));
        refused(changed(|one| one.deviations[1] = None));
        refused(changed(|one| one.count = Some(4.0)));
        refused(four()[..3].to_vec());
        refused(changed(|one| {
            one.values[2] = one.values[3];
            one.values[3] = None;
        }));
        // The same rake twice is no other condition.
        refused(changed(|one| one.condition.tool.rake_angle = Some(0.0)));
    }

    #[test]
    fn what_cannot_be_diagnosed_is_refused() {
        let few: Vec<Recording> = (1..=5).map(|v| recording(f64::from(v), 1.0)).collect();
        let error = Recordings::new(few, &FORCE).unwrap_err();
        assert_eq!(error, DiagnoseError::TooFewConditions { found: 5, needed: 6 });
        assert!(error.to_string().contains("four are enough"), "{error}");
        let single: Vec<Recording> = (1..=9).map(|v| recording(f64::from(v), 1.0)).collect();
        let error = Recordings::new(single.clone(), &FORCE).unwrap_err();
        assert!(error.to_string().contains("the noise of F_c is unknown"), "{error}");
        let error = Recordings::new(single.clone(), &[Channel::Springback]).unwrap_err();
        assert_eq!(error, DiagnoseError::NothingPredicted);
        // Without the number of cuts a deviation is taken as it stands.
        let mut stated = single.clone();
        stated.iter_mut().for_each(|one| one.deviations[0] = Some(0.04));
        let found = Recordings::new(stated, &FORCE).unwrap();
        assert_eq!(
            (found.noise()[0].source, found.noise()[0].deviation),
            (NoiseSource::Stated, 0.04)
        );
        let mut zero = single;
        zero[3].values[0] = Some(0.0);
        let error = Recordings::new(zero, &FORCE).unwrap_err();
        assert!(error.to_string().starts_with("recording 4: F_c = 0 has no logarithm"), "{error}");
    }
}
