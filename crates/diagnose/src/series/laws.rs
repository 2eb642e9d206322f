//! What a line follows over the cuts, as explanations with probabilities.
//!
//! With the frequencies f_c of one line in the cuts c, a law says
//!
//! ```text
//! ln f_c = g(c) + kappa + e_c,   e_c normal with variance s_c^2 + tau^2
//! ```
//!
//! | law | g | kappa | tau |
//! |---|---|---|---|
//! | mains | 0 | ln of a multiple of 50 or 60 Hz | to 0.1 % |
//! | constant | 0 | even over the band | to 2 % |
//! | multiple of the rotation | ln n | ln m, m = 1, 2, ..., chance as 1/m | to 1 % |
//! | fixed ratio to the rotation | ln n | even over the band | to 1 % |
//! | chip | ln(v_c/h) | -ln(pitch/h), pitch/h from 0.1 to 20 | to 10 % |
//! | chatter | a natural frequency | even from 0 to +15 % in every cut by itself | |
//! | none of these | a ln v_c + b ln h | even over the band; a, b normal around 0 with deviation 1.5 | to 20 % |
//!
//! s_c is the error of the measured frequency. kappa, a and b are integrated out exactly, tau and m are summed over. Evidence after
//! MacKay, Neural Computation 4 (1992) 415-447: a law with a free number pays for it. Two laws whose g differ by a constant over
//! the cuts at hand predict the same, and what their evidences differ by is prior alone: such laws are **not told apart**
//! ([`distance`]), whatever the probabilities say.

use nalgebra::{DMatrix, DVector};

/// A law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum LineLaw {
    /// A multiple of the frequency of the mains.
    Mains,
    /// One frequency in all cuts.
    Constant,
    /// A whole multiple of the rotation.
    Rotation,
    /// A fixed ratio to the rotation that is no whole number.
    Ratio,
    /// The chip comes in pieces of a length that goes with h.
    Chip,
    /// Between a natural frequency and 15 % above it, in each cut by itself.
    Chatter,
    /// A power of v_c and h, or no law at all.
    Other,
}

impl LineLaw {
    /// All.
    pub const ALL: [Self; 7] = [
        Self::Mains,
        Self::Constant,
        Self::Rotation,
        Self::Ratio,
        Self::Chip,
        Self::Chatter,
        Self::Other,
    ];

    /// Its name in files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Mains => "mains",
            Self::Constant => "constant_frequency",
            Self::Rotation => "multiple_of_rotation",
            Self::Ratio => "fixed_ratio_to_rotation",
            Self::Chip => "segmented_chip",
            Self::Chatter => "chatter",
            Self::Other => "none_of_these",
        }
    }

    /// Before any data.
    const fn prior(self) -> f64 {
        match self {
            Self::Mains => 0.1,
            Self::Constant => 0.25,
            Self::Rotation => 0.2,
            Self::Ratio => 0.05,
            Self::Chip => 0.2,
            Self::Chatter => 0.05,
            Self::Other => 0.15,
        }
    }

    /// Standard deviations of ln f about the law that are tried.
    const fn scatter(self) -> &'static [f64] {
        match self {
            Self::Mains => &[2e-4, 1e-3],
            Self::Constant => &[5e-4, 2e-3, 5e-3, 1e-2, 2e-2],
            Self::Rotation | Self::Ratio => &[2e-4, 1e-3, 3e-3, 1e-2],
            Self::Chip => &[5e-3, 1e-2, 2e-2, 5e-2, 0.1],
            Self::Chatter => &[1e-3],
            Self::Other => &[5e-3, 1e-2, 2e-2, 5e-2, 0.1, 0.2],
        }
    }
}

/// Highest multiple of the rotation or of the mains that counts as one.
const MOST_MULTIPLES: usize = 40;
/// Least and largest pitch of a chip's segments over h.
pub const PITCH: [f64; 2] = [0.1, 20.0];
/// How far above a natural frequency chatter lies.
pub const CHATTER: f64 = 0.15;
/// Laws closer than this in standard deviations over the cuts are not told apart.
pub const TOLD_APART: f64 = 3.0;

/// A line in a cut. SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// Cutting speed.
    pub cutting_speed: f64,
    /// Uncut chip thickness.
    pub uncut_chip_thickness: f64,
    /// Revolutions per second.
    pub revolution: Option<f64>,
    /// Frequency in Hz.
    pub frequency: f64,
    /// Its standard error in Hz.
    pub error: f64,
}

/// What is known beside the cuts.
#[derive(Debug, Clone, PartialEq)]
pub struct Known {
    /// Lowest and highest frequency that could be seen, in Hz.
    pub band: [f64; 2],
    /// Frequencies of the mains in Hz.
    pub mains: Vec<f64>,
    /// Natural frequencies in Hz: stated, or found as constant lines.
    pub natural: Vec<f64>,
}

/// g of a law that has one and a free constant.
#[must_use]
pub fn place(law: LineLaw, seen: &Seen) -> Option<f64> {
    match law {
        LineLaw::Mains | LineLaw::Constant => Some(0.0),
        LineLaw::Rotation | LineLaw::Ratio => seen.revolution.map(f64::ln),
        LineLaw::Chip => Some((seen.cutting_speed / seen.uncut_chip_thickness).ln()),
        LineLaw::Chatter | LineLaw::Other => None,
    }
}

/// How far apart two laws are over the cuts: root of the sum of squares of g_a - g_b about its mean, over the variance of a frequency
/// under both. `None` where one of them has no g.
#[must_use]
pub fn distance(a: LineLaw, b: LineLaw, seen: &[Seen]) -> Option<f64> {
    let difference: Vec<f64> =
        seen.iter().map(|s| Some(place(a, s)? - place(b, s)?)).collect::<Option<_>>()?;
    let weights: Vec<f64> =
        seen.iter().map(|s| 1.0 / ((s.error / s.frequency).powi(2) + 0.01_f64.powi(2))).collect();
    let total: f64 = weights.iter().sum();
    let mean = difference.iter().zip(&weights).map(|(d, w)| d * w).sum::<f64>() / total;
    Some(difference.iter().zip(&weights).map(|(d, w)| w * (d - mean).powi(2)).sum::<f64>().sqrt())
}

/// A law with its probability.
#[derive(Debug, Clone, PartialEq)]
pub struct Explanation {
    /// Which.
    pub law: LineLaw,
    /// Logarithm of its evidence; `None` where it cannot be asked of these cuts.
    pub log_evidence: Option<f64>,
    /// Probability.
    pub probability: f64,
    /// Most probable constant: the frequency, the multiple, the ratio or pitch/h; with its 95 % interval.
    pub constant: Option<[f64; 3]>,
}

/// The laws, the most probable first.
#[must_use]
pub fn weigh(seen: &[Seen], known: &Known) -> Vec<Explanation> {
    let mut all: Vec<Explanation> = LineLaw::ALL
        .into_iter()
        .map(|law| {
            let found = evidence(law, seen, known);
            Explanation {
                law,
                log_evidence: found.map(|(z, _)| z),
                probability: 0.0,
                constant: found.and_then(|(_, constant)| constant),
            }
        })
        .collect();
    let score =
        |e: &Explanation| e.log_evidence.map_or(f64::NEG_INFINITY, |z| z + e.law.prior().ln());
    let most = all.iter().map(score).fold(f64::NEG_INFINITY, f64::max);
    let shares: Vec<f64> = all.iter().map(|e| (score(e) - most).exp()).collect();
    let total: f64 = shares.iter().sum();
    all.iter_mut().zip(shares).for_each(|(e, share)| e.probability = share / total);
    all.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    all
}

type Constant = Option<[f64; 3]>;

fn evidence(law: LineLaw, seen: &[Seen], known: &Known) -> Option<(f64, Constant)> {
    let logs: Vec<f64> = seen.iter().map(|s| s.frequency.ln()).collect();
    let errors: Vec<f64> = seen.iter().map(|s| s.error / s.frequency).collect();
    let data = Data { logs: &logs, errors: &errors };
    let [low, high] = known.band.map(f64::ln);
    match law {
        LineLaw::Mains => {
            let multiples = known.mains.iter().flat_map(|base| {
                (1..=MOST_MULTIPLES).map(move |m| (base * m as f64, 1.0 / m as f64))
            });
            let places = vec![0.0; seen.len()];
            let found = data.multiples(law, &places, multiples.collect())?;
            Some((found.0, Some([found.1; 3])))
        }
        LineLaw::Rotation => {
            let places: Vec<f64> = seen.iter().map(|s| place(law, s)).collect::<Option<_>>()?;
            let multiples = (1..=MOST_MULTIPLES).map(|m| (m as f64, 1.0 / m as f64));
            let found = data.multiples(law, &places, multiples.collect())?;
            Some((found.0, Some([found.1; 3])))
        }
        LineLaw::Constant | LineLaw::Ratio | LineLaw::Chip => {
            let places: Vec<f64> = seen.iter().map(|s| place(law, s)).collect::<Option<_>>()?;
            let middle = places.iter().sum::<f64>() / places.len() as f64;
            let range = match law {
                LineLaw::Chip => [-PITCH[1].ln(), -PITCH[0].ln()],
                _ => [low - middle, high - middle],
            };
            let (z, mean, error, freedom) = data.free(law, &places, range)?;
            let half = crate::series::t_quantile(freedom) * error;
            let ends = [mean, mean - half, mean + half].map(f64::exp);
            let constant = if law == LineLaw::Chip {
                [1.0 / ends[0], 1.0 / ends[2], 1.0 / ends[1]]
            } else {
                ends
            };
            Some((z, Some(constant)))
        }
        LineLaw::Chatter => Some((data.chatter(known, [low, high], seen)?, None)),
        LineLaw::Other => Some((data.power_law(seen, [low, high]), None)),
    }
}

struct Data<'a> {
    logs: &'a [f64],
    errors: &'a [f64],
}

impl Data<'_> {
    /// ln N(logs; places + constant, errors^2 + scatter^2).
    fn likelihood(&self, places: &[f64], constant: f64, scatter: f64) -> f64 {
        let terms = self.logs.iter().zip(places).zip(self.errors);
        terms
            .map(|((y, g), s)| {
                let variance = s * s + scatter * scatter;
                -0.5 * ((y - g - constant).powi(2) / variance
                    + (std::f64::consts::TAU * variance).ln())
            })
            .sum()
    }

    /// Sum over constants with their weights and the scatter of the law; the most probable constant.
    fn multiples(
        &self,
        law: LineLaw,
        places: &[f64],
        constants: Vec<(f64, f64)>,
    ) -> Option<(f64, f64)> {
        let total: f64 = constants.iter().map(|(_, w)| w).sum();
        let share = 1.0 / law.scatter().len() as f64;
        let terms: Vec<(f64, f64)> = constants
            .iter()
            .flat_map(|&(value, weight)| {
                law.scatter().iter().map(move |&scatter| (value, weight, scatter))
            })
            .map(|(value, weight, scatter)| {
                let own = (weight / total * share).ln();
                (own + self.likelihood(places, value.ln(), scatter), value)
            })
            .collect();
        let best = terms.iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
        Some((log_sum(terms.iter().map(|t| t.0)), best.1))
    }

    /// With a constant that is even over `range`: evidence, and the constant with its standard error and degrees of freedom.
    fn free(&self, law: LineLaw, places: &[f64], range: [f64; 2]) -> Option<(f64, f64, f64, f64)> {
        let width = range[1] - range[0];
        let mut terms = Vec::new();
        for &scatter in law.scatter() {
            let weights: Vec<f64> =
                self.errors.iter().map(|s| 1.0 / (s * s + scatter * scatter)).collect();
            let total: f64 = weights.iter().sum();
            let mean = self
                .logs
                .iter()
                .zip(places)
                .zip(&weights)
                .map(|((y, g), w)| w * (y - g))
                .sum::<f64>()
                / total;
            // Gauss's integral over the constant; none of it counts where the mean is out of range.
            let inside = (range[0]..=range[1]).contains(&mean);
            let integral = 0.5 * (std::f64::consts::TAU / total).ln() - width.ln();
            let z = if inside {
                self.likelihood(places, mean, scatter) + integral
            } else {
                f64::NEG_INFINITY
            };
            terms.push((z, mean, total.sqrt().recip()));
        }
        let best = terms.iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
        if best.0 == f64::NEG_INFINITY {
            return None;
        }
        let z = log_sum(terms.iter().map(|t| t.0)) - (terms.len() as f64).ln();
        Some((z, best.1, best.2, (self.logs.len() as f64 - 1.0).max(1.0)))
    }

    /// In every cut even from a natural frequency to [`CHATTER`] above it; the natural frequency even over those known, or
    /// over the band. A whole multiple of the rotation that could be told from it is no chatter.
    fn chatter(&self, known: &Known, [low, high]: [f64; 2], seen: &[Seen]) -> Option<f64> {
        let reach = (1.0 + CHATTER).ln();
        let least = self.logs.iter().copied().fold(f64::INFINITY, f64::min);
        let most = self.logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let forced = |s: &Seen| {
            s.revolution.is_some_and(|n| {
                let order = (s.frequency / n).round();
                s.error < 0.05 * n && (s.frequency - order * n).abs() < 3.0 * s.error.max(1e-3 * n)
            })
        };
        if seen.iter().all(forced) {
            return None;
        }
        let own = -(self.logs.len() as f64) * reach.ln();
        let free = (reach - (most - least)).max(0.0) / (high - low);
        let near: Vec<f64> = known.natural.iter().map(|f| f.ln()).collect();
        let fits =
            near.iter().filter(|f| (0.003..=reach).contains(&(least - **f)) && most - **f <= reach);
        let share = if near.is_empty() {
            free
        } else {
            0.5 * free + 0.5 * fits.count() as f64 / near.len() as f64
        };
        (share > 0.0).then(|| own + share.ln())
    }

    /// ln f = kappa + a ln v + b ln h with normal priors: y is normal with covariance D + X P X'.
    fn power_law(&self, seen: &[Seen], [low, high]: [f64; 2]) -> f64 {
        let count = seen.len();
        let mean =
            |of: fn(&Seen) -> f64| seen.iter().map(|s| of(s).ln()).sum::<f64>() / count as f64;
        let (v, h) = (mean(|s| s.cutting_speed), mean(|s| s.uncut_chip_thickness));
        let rows: Vec<[f64; 3]> = seen
            .iter()
            .map(|s| [1.0, s.cutting_speed.ln() - v, s.uncut_chip_thickness.ln() - h])
            .collect();
        // The deviation of a number that is even over the band.
        let priors = [(high - low) / 12_f64.sqrt(), 1.5, 1.5];
        let deviation =
            DVector::from_iterator(count, self.logs.iter().map(|y| y - 0.5 * (low + high)));
        let terms = LineLaw::Other.scatter().iter().map(|scatter| {
            let mut covariance = DMatrix::from_fn(count, count, |i, j| {
                (0..3).map(|k| priors[k] * priors[k] * rows[i][k] * rows[j][k]).sum()
            });
            for i in 0..count {
                covariance[(i, i)] += self.errors[i].powi(2) + scatter * scatter;
            }
            let Some(factor) = covariance.cholesky() else { return f64::NEG_INFINITY };
            let logs: f64 = factor.l_dirty().diagonal().iter().map(|d: &f64| d.ln()).sum();
            let squares = deviation.dot(&factor.solve(&deviation));
            -0.5 * squares - logs - 0.5 * count as f64 * std::f64::consts::TAU.ln()
        });
        log_sum(terms) - (LineLaw::Other.scatter().len() as f64).ln()
    }
}

fn log_sum(terms: impl Iterator<Item = f64> + Clone) -> f64 {
    let most = terms.clone().fold(f64::NEG_INFINITY, f64::max);
    if most == f64::NEG_INFINITY {
        most
    } else {
        most + terms.map(|t| (t - most).exp()).sum::<f64>().ln()
    }
}
