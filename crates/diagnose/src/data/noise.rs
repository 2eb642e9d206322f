//! The law of the noise of a channel, from repeats.

/// Steps of the search for the constant part.
const STEPS: u32 = 100;
/// By how much a constant part has to raise the logarithm of the likelihood: beyond what one more parameter does by chance once
/// in twenty times (half of the 95 % quantile of chi^2 with one degree of freedom).
const CONVINCING: f64 = 1.92;

/// The scatter between some repeats of one cut.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scatter {
    /// Variance of a single cut over the square of the value.
    pub variance: f64,
    /// Its degrees of freedom.
    pub freedom: f64,
    /// The value.
    pub value: f64,
}

/// The variance of a single cut: sigma^2 = a^2 + b^2 y^2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct NoiseLaw {
    /// a^2 in the square of the channel's unit.
    pub constant: f64,
    /// b^2.
    pub share: f64,
    /// Degrees of freedom of both together.
    pub freedom: f64,
}

impl NoiseLaw {
    /// The variance of the logarithm of a single cut of the value `y`.
    pub fn variance(&self, y: f64) -> f64 {
        self.share + self.constant / (y * y)
    }

    /// The most likely law. Variances s_i^2 with nu_i degrees of freedom follow sigma_i^2 chi^2 / nu_i:
    ///
    /// ```text
    /// log L = -1/2 sum nu_i [log sigma_i^2 + s_i^2 / sigma_i^2],   sigma_i^2 = c [(1 - w) + w m^2 / y_i^2]
    /// ```
    ///
    /// over the squares of the values, with m^2 the mean of y^2; c follows from w, and w is searched from 0 to 1. Edges that
    /// differ from insert to insert or a zero that wanders scatter by newtons, material and width by shares: a noise of newtons taken for a
    /// share would make large values too uncertain and small ones too certain. Without a convincing difference it is a
    /// share (w = 0), and sigma^2 is the mean of s_i^2 with weights nu_i.
    ///
    /// The variances given are larger by nu / (nu - 2) (see [`crate::Recordings`]). `None` with fewer than `fewest` degrees of freedom or
    /// without scatter.
    pub fn most_likely(repeats: &[Scatter], fewest: f64) -> Option<Self> {
        let freedom: f64 = repeats.iter().map(|s| s.freedom).sum();
        if freedom < fewest || repeats.iter().all(|s| s.freedom * s.variance <= 0.0) {
            return None;
        }
        let square = repeats.iter().map(|s| s.freedom * s.value * s.value).sum::<f64>() / freedom;
        let shape = |w: f64, y: f64| (1.0 - w) + w * square / (y * y);
        let scale = |w: f64| {
            let sum: f64 = repeats.iter().map(|s| s.freedom * s.variance / shape(w, s.value)).sum();
            sum / freedom
        };
        let likelihood = |w: f64| {
            let scale = scale(w);
            let term = |s: &Scatter| s.freedom * (scale * shape(w, s.value)).ln();
            -0.5 * (repeats.iter().map(term).sum::<f64>() + freedom)
        };
        let plain = likelihood(0.0);
        let best = (1..=STEPS)
            .map(|k| f64::from(k) / f64::from(STEPS))
            .map(|w| (w, likelihood(w)))
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .filter(|(_, log)| *log > plain + CONVINCING);
        let w = best.map_or(0.0, |(w, _)| w);
        let scale = scale(w) * freedom / (freedom - 2.0);
        Some(Self { constant: scale * w * square, share: scale * (1.0 - w), freedom })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sphcut_greybox::Random;

    /// 200 conditions from 50 to 500 N, each with a variance of 4 degrees of freedom of the law a, b.
    fn repeats(a: f64, b: f64) -> Vec<Scatter> {
        let mut random = Random::new(11, &[]);
        (0..200)
            .map(|k| {
                let value = 50.0 * 10.0_f64.powf(f64::from(k) / 199.0);
                let chi: f64 = (0..4).map(|_| random.normal().powi(2)).sum();
                let variance = (b * b + a * a / (value * value)) * chi / 4.0;
                Scatter { variance, freedom: 4.0, value }
            })
            .collect()
    }

    #[test]
    fn constant_and_share_are_given_back() {
        // 800 degrees of freedom: a variance to 5 %, a deviation to 2.5 %; two parts share that.
        let both = NoiseLaw::most_likely(&repeats(2.0, 0.02), 3.0).unwrap();
        assert!((both.constant.sqrt() / 2.0 - 1.0).abs() < 0.1, "{both:?}");
        assert!((both.share.sqrt() / 0.02 - 1.0).abs() < 0.1, "{both:?}");
        let newtons = NoiseLaw::most_likely(&repeats(3.0, 0.0), 3.0).unwrap();
        assert!((newtons.constant.sqrt() / 3.0 - 1.0).abs() < 0.06, "{newtons:?}");
        assert!(newtons.share.sqrt() < 0.003, "{newtons:?}");
    }

    #[test]
    fn a_share_stays_a_share() {
        let law = NoiseLaw::most_likely(&repeats(0.0, 0.03), 3.0).unwrap();
        assert_eq!(law.constant, 0.0);
        assert!((law.share.sqrt() / 0.03 - 1.0).abs() < 0.06, "{law:?}");
    }

    /// Two repeats of two cuts by hand: s^2 = (4e-4 + 8e-4) / 2, nu = 4.
    #[test]
    fn the_mean_variance_by_hand() {
        let one = |variance| Scatter { variance, freedom: 2.0, value: 100.0 };
        let law = NoiseLaw::most_likely(&[one(4e-4), one(8e-4)], 3.0).unwrap();
        assert!((law.share - 6e-4 * 4.0 / 2.0).abs() < 1e-15);
        assert!(NoiseLaw::most_likely(&[one(4e-4)], 3.0).is_none());
        assert!(NoiseLaw::most_likely(&[one(0.0), one(0.0)], 3.0).is_none());
    }
}
