//! What was claimed against what is so.

use super::files::Answer;
use sphcut_analytic::find;
use statrs::distribution::{Beta, ContinuousCDF};
use std::fmt::Write;

/// What a diagnosis says of one case.
#[derive(Debug, Clone, PartialEq)]
pub struct BlindClaim {
    pub case: String,
    pub verdict: BlindVerdict,
    pub named: Vec<String>,
    /// Effects by probability, the most probable first.
    pub ranking: Vec<String>,
    /// The 95 % set; `none` stands for none of these.
    pub set: Vec<String>,
    pub family: String,
    /// Value, low and high of the first parameter of what is named.
    pub estimate: Option<[f64; 3]>,
}

/// The four verdicts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BlindVerdict {
    Nothing,
    Named,
    OneOf,
    NoneOfThese,
}

impl BlindVerdict {
    const ALL: [Self; 4] = [Self::Nothing, Self::Named, Self::OneOf, Self::NoneOfThese];

    /// Name in the table of claims.
    const fn key(self) -> &'static str {
        match self {
            Self::Nothing => "nothing",
            Self::Named => "named",
            Self::OneOf => "one_of",
            Self::NoneOfThese => "none_of_these",
        }
    }

    /// The verdict of a name.
    pub fn from_key(key: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|verdict| verdict.key() == key)
    }
}

impl BlindClaim {
    /// Its line in the table.
    pub fn line(&self) -> String {
        let estimate = self.estimate.map_or_else(
            || ",,".to_owned(),
            |[value, low, high]| format!("{value:.6e},{low:.6e},{high:.6e}"),
        );
        format!(
            "{},{},{},{},{},{},{estimate}",
            self.case,
            self.verdict.key(),
            self.named.join(";"),
            self.ranking.join(";"),
            self.set.join(";"),
            self.family
        )
    }
}

pub const HEAD: &str = "case,verdict,named,ranking,set,family,value,low,high";

/// Reads the claims.
pub fn claims(text: &str) -> Result<Vec<BlindClaim>, String> {
    let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    match lines.next() {
        Some((_, head)) if head.trim() == HEAD => {}
        _ => return Err(format!("claims begin with the line `{HEAD}`")),
    }
    lines.map(|(index, line)| claim(line).map_err(|e| format!("line {}: {e}", index + 1))).collect()
}

fn claim(line: &str) -> Result<BlindClaim, String> {
    let cells: Vec<&str> = line.split(',').map(str::trim).collect();
    let [case, verdict, named, ranking, set, family, estimate @ ..] = cells.as_slice() else {
        return Err("9 cells are needed".to_owned());
    };
    let verdict =
        BlindVerdict::from_key(verdict).ok_or_else(|| format!("`{verdict}` is no verdict"))?;
    let list = |cell: &str| -> Result<Vec<String>, String> {
        let items = cell.split(';').map(str::trim).filter(|item| !item.is_empty());
        items
            .map(|item| match find(item) {
                None if item != "none" => Err(format!("`{item}` is no effect")),
                _ => Ok(item.to_owned()),
            })
            .collect()
    };
    let numbers: Option<Vec<f64>> = match estimate {
        ["", "", ""] => None,
        [_, _, _] => {
            let parsed: Result<Vec<f64>, _> = estimate.iter().map(|cell| cell.parse()).collect();
            Some(parsed.map_err(|_| "value, low and high are numbers".to_owned())?)
        }
        _ => return Err("9 cells are needed".to_owned()),
    };
    let named = list(named)?;
    if (verdict == BlindVerdict::Named) == named.is_empty() {
        return Err("effects are named where, and only where, the verdict is `named`".to_owned());
    }
    Ok(BlindClaim {
        case: (*case).to_owned(),
        verdict,
        named,
        ranking: list(ranking)?,
        set: list(set)?,
        family: (*family).to_owned(),
        estimate: numbers.and_then(|three| three.try_into().ok()),
    })
}

/// k of n.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Count {
    hits: usize,
    of: usize,
}

impl Count {
    fn add(&mut self, hit: bool) {
        self.hits += usize::from(hit);
        self.of += 1;
    }

    /// Clopper and Pearson, Biometrika 26 (1934) 404-413: 95 %.
    fn interval(self) -> (f64, f64) {
        let quantile = |a: usize, b: usize, p: f64| {
            Beta::new(a as f64, b as f64).map_or(f64::NAN, |beta| beta.inverse_cdf(p))
        };
        let (k, n) = (self.hits, self.of);
        let low = if k == 0 { 0.0 } else { quantile(k, n - k + 1, 0.025) };
        let high = if k == n { 1.0 } else { quantile(k + 1, n - k, 0.975) };
        (low, high)
    }

    fn text(self) -> String {
        if self.of == 0 {
            return "-".to_owned();
        }
        let (low, high) = self.interval();
        let share = self.hits as f64 / self.of as f64;
        format!("{}/{} = {share:.2} ({low:.2}-{high:.2})", self.hits, self.of)
    }
}

/// The figures of one group of cases.
#[derive(Debug, Clone, Default)]
struct Score {
    false_alarms: Count,
    alarms: Count,
    named: Count,
    named_right: Count,
    top_1: Count,
    top_3: Count,
    family: Count,
    covered: Count,
    set_size: Vec<f64>,
    none: Count,
    parameter_error: Vec<f64>,
    parameter_covered: Count,
}

impl Score {
    fn of<'a>(pairs: impl Iterator<Item = (&'a Answer, &'a BlindClaim)>) -> Self {
        let mut score = Self::default();
        for (answer, claim) in pairs {
            score.add(answer, claim);
        }
        score
    }

    fn add(&mut self, answer: &Answer, claim: &BlindClaim) {
        let is_alarm = claim.verdict != BlindVerdict::Nothing;
        let is_true = |key: &String| answer.effects.iter().any(|(own, _, _)| own == key);
        if claim.verdict == BlindVerdict::Named {
            self.named_right.add(claim.named.iter().all(is_true));
        }
        if answer.kind == "null" {
            self.false_alarms.add(is_alarm);
            return;
        }
        self.alarms.add(is_alarm);
        self.named.add(claim.verdict == BlindVerdict::Named);
        if answer.kind == "outside" {
            self.none.add(claim.verdict == BlindVerdict::NoneOfThese);
        }
        if is_alarm {
            let in_set = claim
                .set
                .iter()
                .any(|key| is_true(key) || (answer.kind == "outside" && key == "none"));
            self.covered.add(in_set);
            self.set_size.push(claim.set.len() as f64);
        }
        let [(_, family, value)] = answer.effects.as_slice() else { return };
        self.top_1.add(claim.ranking.iter().take(1).any(is_true));
        self.top_3.add(claim.ranking.iter().take(3).any(is_true));
        self.family.add(claim.family == *family);
        let is_right = claim.named.len() == 1 && claim.named.iter().all(is_true);
        if let (true, Some([estimate, low, high])) = (is_right, claim.estimate) {
            self.parameter_error.push((estimate / value - 1.0).abs());
            self.parameter_covered.add((low..=high).contains(value));
        }
    }

    fn row(&self, name: &str) -> String {
        let median = median(&self.parameter_error);
        let size = self.set_size.iter().sum::<f64>() / self.set_size.len() as f64;
        let number =
            |value: f64| if value.is_nan() { "-".to_owned() } else { format!("{value:.2}") };
        format!(
            "| {name} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n",
            self.false_alarms.text(),
            self.alarms.text(),
            self.named.text(),
            self.named_right.text(),
            self.top_1.text(),
            self.top_3.text(),
            self.family.text(),
            self.covered.text(),
            number(size),
            self.none.text(),
            number(median),
            self.parameter_covered.text(),
        )
    }
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    match sorted.len() {
        0 => f64::NAN,
        n if n % 2 == 1 => sorted[n / 2],
        n => 0.5 * (sorted[n / 2 - 1] + sorted[n / 2]),
    }
}

/// Groups of cases that are scored on their own; null cases belong to all of them that their plan allows.
type Group = (&'static str, fn(&Answer) -> bool);

const GROUPS: [Group; 13] = [
    ("all", |_| true),
    ("raw change above 5 %", |a| a.kind == "null" || a.strength > 0.05),
    ("above 5 %, commissioning sets", |a| {
        a.has_commissioning && (a.kind == "null" || a.strength > 0.05)
    }),
    ("above 5 %, no commissioning sets", |a| {
        !a.has_commissioning && (a.kind == "null" || a.strength > 0.05)
    }),
    ("above 5 %, narrow, forces, 3 % noise", |a| {
        !a.is_wide
            && a.forces_only
            && near(a.noise, 0.03)
            && (a.kind == "null" || a.strength > 0.05)
    }),
    ("above 5 %, wide, all channels", |a| {
        a.is_wide && !a.forces_only && (a.kind == "null" || a.strength > 0.05)
    }),
    ("2 to 5 %", |a| a.kind != "null" && a.strength <= 0.05),
    ("5 to 10 %", |a| a.strength > 0.05 && a.strength <= 0.10),
    ("above 10 %", |a| a.strength > 0.10),
    ("noise 1 %", |a| near(a.noise, 0.01)),
    ("opponent: other heat and friction", |a| a.physics == "opponent_heat"),
    ("opponent: all relations other", |a| a.physics == "opponent_all"),
    ("opponent: another model", |a| a.physics == "independent"),
];

fn near(one: f64, other: f64) -> bool {
    (one - other).abs() < 1e-9
}

/// The score as a table in Markdown.
pub fn report(answers: &[Answer], claims: &[BlindClaim]) -> Result<String, String> {
    let mut pairs = Vec::new();
    for answer in answers {
        let mut found = claims.iter().filter(|claim| claim.case == answer.case);
        match (found.next(), found.next()) {
            (Some(claim), None) => pairs.push((answer, claim)),
            (None, _) => return Err(format!("no claim for {}: every case counts", answer.case)),
            (Some(_), Some(_)) => return Err(format!("two claims for {}", answer.case)),
        }
    }
    if let Some(claim) = claims.iter().find(|claim| !answers.iter().any(|a| a.case == claim.case)) {
        return Err(format!("{} is no case", claim.case));
    }
    let mut text = "| cases | false alarms | alarms | named | named right | top 1 | top 3 | family | 95 % set covers | its size | \
                    none of these | parameter error | interval covers |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n"
        .to_owned();
    for (name, belongs) in GROUPS {
        let group = pairs.iter().copied().filter(|(answer, _)| belongs(answer));
        text += &Score::of(group).row(name);
    }
    let _ = write!(
        text,
        "\nAlarms and shares named: of cases in which something is hidden. Named right: of all claims that name effects, those on nulls \
         included. Top 1, top 3, family, parameter: of cases with one effect. Set: of alarms on cases in which something is hidden. Parameter \
         error: median. Intervals: Clopper and Pearson, 95 %.\n"
    );
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    fn answer(case: &str, kind: &str, key: Option<&str>) -> Answer {
        let effects = key
            .map(|key| (key.to_owned(), find(key).unwrap().candidate.family.key().to_owned(), 0.2));
        Answer {
            case: case.to_owned(),
            kind: kind.to_owned(),
            effects: effects.into_iter().collect(),
            strength: if kind == "null" { 0.0 } else { 0.08 },
            noise: 0.03,
            is_wide: true,
            forces_only: false,
            has_commissioning: true,
            physics: "opponent_all".to_owned(),
            noise_drawn: BTreeMap::new(),
        }
    }

    fn score(answers: &[Answer], text: &str) -> Score {
        let claims = claims(&format!("{HEAD}\n{text}")).unwrap();
        report(answers, &claims).unwrap();
        Score::of(answers.iter().zip(&claims))
    }

    #[test]
    fn right_and_wrong_claims_are_counted() {
        let answers = [
            answer("a", "null", None),
            answer("b", "null", None),
            answer("c", "single", Some("viscous_drag")),
            answer("d", "single", Some("flank_wear")),
            answer("e", "outside", None),
        ];
        let found = score(
            &answers,
            "a,nothing,,,,,,,\n\
             b,named,gain,gain,gain,instrument,,,\n\
             c,named,viscous_drag,viscous_drag;size_effect,viscous_drag,rate_size,0.22,0.1,0.3\n\
             d,one_of,,drift;edge_radius;flank_wear,drift;edge_radius,time,,,\n\
             e,none_of_these,,size_effect,none;size_effect,,,,\n",
        );
        let count = |hits, of| Count { hits, of };
        assert_eq!(found.false_alarms, count(1, 2));
        assert_eq!(found.alarms, count(3, 3));
        assert_eq!(found.named, count(1, 3));
        assert_eq!(found.named_right, count(1, 2));
        assert_eq!((found.top_1, found.top_3), (count(1, 2), count(2, 2)));
        assert_eq!(found.family, count(2, 2));
        assert_eq!(found.covered, count(2, 3));
        assert_eq!(found.none, count(1, 1));
        assert!((median(&found.parameter_error) - 0.1).abs() < 1e-12);
        assert_eq!(found.parameter_covered, count(1, 1));
    }

    #[test]
    fn the_interval_is_that_of_clopper_and_pearson() {
        // 0 of 60: 1 - 0.025^(1/60) = 0.0596; 10 of 20: 0.2720 to 0.7280.
        let (low, high) = Count { hits: 0, of: 60 }.interval();
        assert!(low == 0.0 && (high - 0.0596).abs() < 1e-4, "{high}");
        let (low, high) = Count { hits: 10, of: 20 }.interval();
        assert!((low - 0.2720).abs() < 1e-4 && (high - 0.7280).abs() < 1e-4, "{low} {high}");
    }

    #[test]
    fn claims_that_say_too_little_or_too_much_are_refused() {
        for line in [
            "a,named,,,,,,,",
            "a,nothing,gain,,,,,,",
            "a,perhaps,,,,,,,",
            "a,one_of,,rust,,,,,",
            "a,nothing,,",
            "a,named,gain,,,,x,1,2",
        ] {
            assert!(claims(&format!("{HEAD}\n{line}\n")).is_err(), "{line}");
        }
        assert!(claims("case,verdict\n").is_err());
        let answers = [answer("a", "null", None)];
        assert!(report(&answers, &[]).is_err());
        let one = claims(&format!("{HEAD}\na,nothing,,,,,,,\n")).unwrap();
        let twice = [one.clone(), one.clone()].concat();
        assert!(report(&answers, &twice).is_err());
        assert!(report(&[], &one).is_err());
        assert!(report(&answers, &one).is_ok());
    }
}
