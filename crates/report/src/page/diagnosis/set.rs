//! The 95 % set where the data do not distinguish its members: a short one in the sentence, a long one as a ranking below it.

use super::DiagnosisPage;
use super::words::{sizes, title};
use crate::kit::numbers::percent_whole;
use crate::kit::table::ColumnHead::{Number, Text};
use crate::kit::table::table;
use crate::kit::text::{counted, indexed, listed};
use maud::{Markup, html};
use sphcut_diagnose::{ClaimVerdict, RankedEffect};

/// Members that a sentence can list.
const MOST_IN_A_SENTENCE: usize = 3;
/// The second of a ranking is named in the sentence if it is at least this share as probable as the first.
const NEARLY_AS_PROBABLE: f64 = 0.5;
/// What the ranking of a set is.
pub(super) const SET: &str = "With 95 % probability at least one of these is missing. Posterior probability of each, alone or together with another; size if it \
    alone is missing, where it was fitted.";

/// The members of a short set; of a long one how many they are, and the most probable.
pub(super) fn named(page: &DiagnosisPage<'_>) -> String {
    let finding = &page.diagnosis.finding;
    let ranked = finding.ranked();
    if ranked.len() <= MOST_IN_A_SENTENCE {
        let effects = finding.set.iter().map(|&k| Some(k));
        let all = effects.chain(finding.set_has_none.then_some(None));
        let titles: Vec<String> = all.map(|effect| title(page, effect)).collect();
        return format!("with 95 % probability at least one of {}", listed(&titles));
    }
    let besides = if finding.set_has_none { " or an unmodelled effect" } else { "" };
    let near = ranked[0].1 * NEARLY_AS_PROBABLE;
    let first = ranked.iter().take(2).filter(|(_, probability)| *probability >= near);
    let first = first.map(|(effect, probability)| {
        format!("\u{201c}{}\u{201d} ({})", title(page, *effect), percent_whole(*probability))
    });
    let first: Vec<String> = first.collect();
    let verb = if first.len() > 1 { "are" } else { "is" };
    format!(
        "{} candidate effects{besides} can explain the difference; the most probable {verb} {}",
        counted(finding.set.len()),
        listed(&first)
    )
}

/// A member of a set that is too long for a sentence.
pub(super) struct RankedRow {
    pub title: String,
    pub probability: String,
    /// Empty if it was not fitted.
    pub size: String,
}

/// The set, the most probable first, where the verdict is one of more than a sentence can list.
pub(super) fn ranked(page: &DiagnosisPage<'_>) -> Vec<RankedRow> {
    if page.diagnosis.finding.verdict != ClaimVerdict::OneOf {
        return Vec::new();
    }
    let all = page.diagnosis.ranking(page.predictor);
    if all.len() <= MOST_IN_A_SENTENCE {
        return Vec::new();
    }
    let row = |ranked: &RankedEffect| RankedRow {
        title: title(page, ranked.effect),
        probability: percent_whole(ranked.probability),
        size: sizes(page, &ranked.estimates).join("; "),
    };
    all.iter().map(row).collect()
}

/// The set where it is too long for the sentence.
pub(super) fn ranking(page: &DiagnosisPage<'_>) -> Markup {
    let ranked = ranked(page);
    html! {
        @if !ranked.is_empty() {
            (table(SET, [Number("Rank"), Number("Probability"), Text("Effect: most probable size (95 % interval)")],
                &html! { @for (k, row) in ranked.iter().enumerate() { tr {
                    td.n { (k + 1) }
                    td.n { (row.probability) }
                    th scope="row" { (row.title) @if !row.size.is_empty() { ": " small { (indexed(&row.size)) } } }
                } } }))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::{diagnosis_text, render_diagnosis};
    use sphcut_diagnose::{
        Active, CandidateEffect, DiagnosisProvenance, DiagnosisRequest, EffectParameter,
        InstrumentPriors, Nuisance, Predictor, Prior, ProgressListener, Recording, Recordings,
        RelationError, diagnose, diagnosis_json,
    };
    use sphcut_physics::{Channel, CuttingCondition};

    /// Effects that change log F_c by an amount normal around 0 with a deviation of 10 %: in proportion to powers of v_c and h.
    struct Alike {
        effects: Vec<CandidateEffect>,
    }

    impl Alike {
        const TITLES: [&str; 6] = ["first", "second", "third", "fourth", "fifth", "sixth"];

        fn new() -> Self {
            let effect = |title| CandidateEffect {
                key: title,
                title,
                family: "friction",
                parameters: vec![EffectParameter {
                    key: "amplitude",
                    symbol: "a",
                    unit: "",
                    prior: Prior::Normal { mean: 0.0, deviation: 0.1 },
                }],
            };
            Self { effects: Self::TITLES.map(effect).to_vec() }
        }
    }

    impl Predictor for Alike {
        fn nuisances(&self) -> &[Nuisance] {
            &[]
        }

        fn effects(&self) -> &[CandidateEffect] {
            &self.effects
        }

        fn channels(&self) -> &[Channel] {
            &[Channel::CuttingForce]
        }

        fn model_errors(&self) -> &[[f64; Channel::RECORDED.len()]] {
            &[[0.01; Channel::RECORDED.len()]]
        }

        fn relations(&self) -> Vec<RelationError> {
            let reason = "two theories differ";
            let angle = RelationError {
                key: "angle",
                title: "shear angle",
                deviation: 0.12,
                unit: "rad",
                reason,
            };
            vec![
                angle,
                RelationError { key: "l", title: "contact", deviation: 0.3, unit: "", ..angle },
            ]
        }

        fn relation_errors(&self, _: &CuttingCondition) -> Vec<Vec<f64>> {
            vec![vec![0.01], vec![0.01]]
        }

        fn log_observables(
            &self,
            condition: &CuttingCondition,
            _: &[f64],
            active: &[Active],
        ) -> Vec<f64> {
            let x = condition.cutting_speed.ln();
            let y = (condition.uncut_chip_thickness / 1e-4).ln();
            let shape = |effect: usize| x + 0.1 * effect as f64 * y;
            vec![5.0 + active.iter().map(|one| one.values[0] * shape(one.effect)).sum::<f64>()]
        }
    }

    /// What the page and the terminal say of a set of so many, its probabilities falling from 40 %.
    fn said(members: &[usize], set_has_none: bool) -> (String, Vec<String>) {
        let model = Alike::new();
        let cuts = (0..12).map(|k| {
            let condition =
                CuttingCondition::new(0.5 * 2.0_f64.powi(k % 4), 5e-5 * 2.0_f64.powi(k / 4));
            let active = [Active { effect: 2, values: vec![-0.1] }];
            let value = model.log_observables(&condition, &[], &active)[0].exp();
            let (mut values, mut deviations) =
                ([None; Channel::RECORDED.len()], [None; Channel::RECORDED.len()]);
            values[Channel::CuttingForce.index()] = Some(value);
            deviations[Channel::CuttingForce.index()] = Some(0.02 * value);
            Recording { condition, count: None, values, deviations }
        });
        let recordings = Recordings::new(cuts.collect(), model.channels()).unwrap();
        let request = DiagnosisRequest {
            recordings: &recordings,
            reference: None,
            model_error: None,
            instruments: InstrumentPriors { gain: 0.01, offset: 0.0, drift: 0.01 },
            self_test: 0,
            control: 0,
            held_out: false,
            batch: 0,
            range: None,
            seed: 1,
            told: ProgressListener::NOBODY,
        };
        let mut found = diagnose(&request, &model).unwrap();
        assert!(found.fits.iter().any(|fit| fit.effects == [2]));
        found.finding.verdict = ClaimVerdict::OneOf;
        found.finding.leading = None;
        found.finding.families.clear();
        found.finding.set = members.to_vec();
        found.finding.set_has_none = set_has_none;
        found.finding.none_of_these = 0.12;
        // The sixth is not the least probable of them.
        found.finding.inclusion = vec![0.1, 0.19, 0.4, 0.05, 0.004, 0.15];
        let provenance = DiagnosisProvenance {
            title: "cuts",
            source: "made up",
            file: "case.toml",
            model: "a model",
            version: "1",
            seed: 1,
        };
        let page = DiagnosisPage {
            provenance,
            diagnosis: &found,
            recordings: &recordings,
            predictor: &model,
            series: None,
            pairs: &[],
        };
        let numbers = diagnosis_json(&provenance, &found, &recordings, &model);
        assert!(numbers.contains(r#""effect": "third""#) && numbers.contains(r#""rank": 1"#));
        assert!(numbers.contains(r#""relation": "angle""#));
        (render_diagnosis(&page), diagnosis_text(&page))
    }

    #[test]
    fn a_long_set_is_listed_by_probability_and_a_short_one_in_the_sentence() {
        let (page, text) = said(&[1, 2, 3, 4, 5], false);
        assert_eq!(
            text[0],
            "An effect is missing, but these data do not distinguish which: five candidate effects can explain the difference; the most probable \
             is \u{201c}third\u{201d} (40 %)."
        );
        assert_eq!(text[1], format!("  {SET}"));
        assert!(text[2].starts_with("   1    40 %  third: a = \u{2212}0."), "{}", text[2]);
        let rest = [
            "   2    19 %  second",
            "   3    15 %  sixth",
            "   4     5 %  fourth",
            "   5   < 1 %  fifth",
        ];
        for (line, start) in text[3..].iter().zip(rest) {
            assert!(line.starts_with(start), "{line}");
        }
        let at = |part: &str| page.find(part).unwrap_or_else(|| panic!("{part}"));
        assert!(page.contains(&format!("<h2>{}</h2>", text[0])));
        let places = ["third", "second", "sixth", "fourth", "fifth"]
            .map(|title| at(&format!("<th scope=\"row\">{title}")));
        assert!(places.is_sorted() && places[4] < at("Residual pattern"), "{places:?}");

        let (page, text) = said(&[2, 1, 5], false);
        assert_eq!(
            text[0],
            "An effect is missing, but these data do not distinguish which: with 95 % probability at least one of third, second and sixth."
        );
        assert!(!text[1].starts_with(' ') && !page.contains(SET));

        // An unmodelled effect is a member and has its place; a second that is half as probable as the first is named, too.
        let (_, text) = said(&[1, 0, 5], true);
        assert!(
            text[0].ends_with(
                "three candidate effects or an unmodelled effect can explain the difference; the most probable are \u{201c}second\u{201d} (19 %) \
                 and \u{201c}sixth\u{201d} (15 %)."
            ),
            "{}",
            text[0]
        );
        assert_eq!(text[4], "   3    12 %  an unmodelled effect");
    }

    #[test]
    fn errors_of_relations_stand_among_the_limits() {
        let (page, _) = said(&[2, 1, 5], false);
        let limits = &page[page.find("<h2>Limits</h2>").unwrap()..];
        for part in ["shear angle</th>", "0.12 rad (7\u{b0})", "30 %", "two theories differ"] {
            assert!(limits.contains(part), "{part}");
        }
    }
}
