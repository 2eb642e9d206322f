//! The series in `diagnosis.json`, `lines.csv` and `trends.csv`.

use super::{Comb, CombBase, CutLine, Named, OverTime, SeriesDiagnosis, Track};
use crate::check::self_test::Rate;
use serde_json::{Value, json};
use sphcut_physics::csv;
use std::fmt::Write;

/// All figures; SI units.
#[must_use]
pub fn series_json(found: &SeriesDiagnosis) -> Value {
    json!({
        "resolution": found.resolution,
        "tested_bins": found.tests,
        "false_share": super::FALSE_SHARE,
        "cuts": found.cuts.iter().zip(&found.spectra).map(|(cut, spectra)| json!({
            "name": cut.name,
            "cutting_speed": cut.cutting_speed,
            "uncut_chip_thickness": cut.uncut_chip_thickness,
            "revolution": cut.revolution,
            "sampling_rate": cut.rate,
            "duration": cut.duration(),
            "segments": spectra.first().map(|s| s.segments),
            "degrees_of_freedom": spectra.first().map(|s| s.freedom),
        })).collect::<Vec<_>>(),
        "too_short": found.too_short.iter().map(|(name, length)| json!({ "name": name, "duration": length })).collect::<Vec<_>>(),
        "tracks": found.tracks.iter().map(|track| self::track(found, track)).collect::<Vec<_>>(),
        "combs": found.combs.iter().map(|comb| self::comb(found, comb)).collect::<Vec<_>>(),
        "air_lines": found.air.iter().map(|(_, lines)| lines.iter().map(|line| json!({
            "frequency": line.frequency, "amplitude": line.amplitude,
        })).collect::<Vec<_>>()).collect::<Vec<_>>(),
        "visible_pitch_over_thickness": found.visible_pitch,
        "false_alarms": found.false_alarms.map(rate),
        "time": found.time.iter().map(|of| over_time(found, of)).collect::<Vec<_>>(),
        "from_cut_to_cut": found.growth.iter().map(|growth| json!({
            "channel": growth.component.symbol(),
            "change_per_cut": growth.per_cut[0],
            "interval": [growth.per_cut[1], growth.per_cut[2]],
            "chance": growth.chance,
        })).collect::<Vec<_>>(),
        "time_false_alarms": found.time_false_alarms.map(rate),
    })
}

fn rate(rate: Rate) -> Value {
    json!({ "hits": rate.hits, "trials": rate.trials, "share": rate.share(), "interval": rate.interval() })
}

fn over_time(found: &SeriesDiagnosis, of: &OverTime) -> Value {
    json!({
        "channel": of.component.symbol(),
        "run_in_laws": of.laws.iter().map(|(law, p)| json!({ "law": law.key(), "probability": p })).collect::<Vec<_>>(),
        "run_in_law": of.law.map(super::RunInLaw::key),
        "run_in_constant": of.constant,
        "cuts": of.trends.iter().enumerate().map(|(k, trend)| {
            let [change, low, high] = of.change(k);
            json!({
                "name": found.cuts[trend.cut].name,
                "mean": trend.mean,
                "correlation_time": trend.correlation,
                "independent_samples": trend.independent,
                "blocks": trend.blocks,
                "relative_change": change,
                "interval": [low, high],
                "chance": if of.running_in[k] { trend.chance } else { trend.line.1 },
                "is_trend": of.trending[k],
                "last_third_less_first": trend.thirds[0],
                "half_width": trend.thirds[1],
                "zero_drift": trend.zero.map(|z| z[0]),
                "zero_drifts": of.drifting[k],
                "run_in": trend.run_in.filter(|_| of.running_in[k]).map(|run_in| json!({
                    "amplitude": run_in.amplitude,
                    "time": run_in.time[0],
                    "interval": [run_in.time[1], run_in.time[2]],
                    "chance": run_in.chance,
                })),
            })
        }).collect::<Vec<_>>(),
    })
}

/// `diagnosis.json` of the means with the series as a further member.
///
/// # Panics
/// If `numbers` is no JSON object.
#[must_use]
pub fn with_series(numbers: &str, found: &SeriesDiagnosis) -> String {
    let mut whole: Value = serde_json::from_str(numbers).expect("the program has written it");
    whole["series"] = series_json(found);
    whole.to_string() + "\n"
}

fn track(found: &SeriesDiagnosis, track: &Track) -> Value {
    let (verdict, laws) = match &track.named {
        Named::Law(law) => ("named", vec![law.key()]),
        Named::NotToldApart(laws) => ("not_told_apart", laws.iter().map(|l| l.key()).collect()),
        Named::Unsure => ("unsure", Vec::new()),
        Named::TooFewCuts => ("too_few_cuts", Vec::new()),
    };
    json!({
        "verdict": verdict,
        "laws": laws,
        "explanations": track.explanations.iter().map(|e| json!({
            "law": e.law.key(),
            "log_evidence": e.log_evidence.filter(|z| z.is_finite()),
            "probability": e.probability,
            "constant": e.constant.map(|c| c[0]),
            "interval": e.constant.map(|c| [c[1], c[2]]),
        })).collect::<Vec<_>>(),
        "jump": track.jump,
        "in_air": track.in_air,
        "advice": track.advice.as_ref().map(|advice| json!({
            "cutting_speed": advice.cutting_speed,
            "uncut_chip_thickness": advice.uncut_chip_thickness,
            "revolution": advice.revolution,
            "expected": advice.expected.iter().map(|(law, f)| json!({ "law": law.key(), "frequency": f })).collect::<Vec<_>>(),
        })),
        "lines": track.lines.iter().map(|&k| line(found, &found.lines[k])).collect::<Vec<_>>(),
    })
}

fn base(of: CombBase) -> Value {
    let (name, frequency) = match of {
        CombBase::Rotation => ("rotation", None),
        CombBase::Mains(f) => ("mains", Some(f)),
        CombBase::Natural(f) => ("natural_frequency", Some(f)),
        CombBase::Track(track) => return json!({ "of": "track", "track": track + 1 }),
    };
    json!({ "of": name, "frequency": frequency })
}

fn comb(found: &SeriesDiagnosis, comb: &Comb) -> Value {
    json!({
        "base": base(comb.base),
        "chance": comb.chance,
        "not_told_apart_from": comb.rival.map(base),
        "multiples": comb.members.iter().map(|(track, multiple)| json!({
            "track": track + 1,
            "multiple": multiple,
            "cuts": found.tracks[*track].lines.len(),
        })).collect::<Vec<_>>(),
    })
}

fn line(found: &SeriesDiagnosis, line: &CutLine) -> Value {
    let channels = found.cuts[line.cut].channels.iter().zip(&line.channels);
    json!({
        "cut": found.cuts[line.cut].name,
        "frequency": line.frequency,
        "frequency_error": line.error,
        "in_air": found.air.first().map(|_| line.in_air),
        "channels": channels.filter_map(|(channel, own)| own.as_ref().map(|own| json!({
            "channel": channel.component.symbol(),
            "amplitude": own.amplitude,
            "amplitude_error": own.amplitude_error,
            "ratio_to_background": own.ratio,
            "width": own.width,
            "chance": own.chance,
        }))).collect::<Vec<_>>(),
    })
}

/// `lines.csv`: every line of every channel of every cut.
#[must_use]
pub fn series_csv(found: &SeriesDiagnosis) -> String {
    let mut text = "line,cut,v_c [m/min],h [mm],rotation [1/min],channel,frequency [Hz],frequency_sd [Hz],amplitude [N],amplitude_sd [N],\
                    width [Hz],density over background,chance,follows\n"
        .to_owned();
    for (number, track) in found.tracks.iter().enumerate() {
        let follows = match &track.named {
            Named::Law(law) => law.key().to_owned(),
            Named::NotToldApart(laws) => {
                laws.iter().map(|l| l.key()).collect::<Vec<_>>().join(" or ")
            }
            Named::Unsure => "unsure".to_owned(),
            Named::TooFewCuts => "too few cuts".to_owned(),
        };
        let in_comb = |comb: &&Comb| comb.members.iter().any(|(k, _)| *k == number);
        let follows = match found.combs.iter().find(in_comb).map(|comb| comb.base) {
            Some(CombBase::Track(base)) => format!("multiple of line {}", base + 1),
            Some(base) => base.law().map_or(follows, |law| law.key().to_owned()),
            None => follows,
        };
        for line in track.lines.iter().map(|&k| &found.lines[k]) {
            let cut = &found.cuts[line.cut];
            let rotation = cut.revolution.map_or_else(String::new, |n| format!("{:.6}", n * 60.0));
            for (channel, own) in cut.channels.iter().zip(&line.channels) {
                let Some(own) = own else { continue };
                let name = csv::shown(&cut.name).replace([',', '"', '\n'], " ");
                let _ = writeln!(
                    text,
                    "{},{name},{:.6},{:.6},{rotation},{},{:.6},{:.6},{:.6},{:.6},{:.6},{:.4},{:.3e},{follows}",
                    number + 1,
                    cut.cutting_speed * 60.0,
                    cut.uncut_chip_thickness * 1e3,
                    channel.component.symbol(),
                    own.frequency,
                    own.error,
                    own.amplitude,
                    own.amplitude_error,
                    own.width,
                    own.ratio,
                    own.chance,
                );
            }
        }
    }
    text
}

/// `trends.csv`: what every force does within every cut.
#[must_use]
pub fn trends_csv(found: &SeriesDiagnosis) -> String {
    let mut text = "cut,v_c [m/min],h [mm],channel,mean [N],correlation_time [ms],independent,change,change_low,change_high,trend,\
                    last third less first [N],half width [N],zero_drift [N],zero drifts,run_in [N],run_in_time [s]\n"
        .to_owned();
    let yes = |flag: bool| if flag { "yes" } else { "no" };
    for of in &found.time {
        for (k, trend) in of.trends.iter().enumerate() {
            let cut = &found.cuts[trend.cut];
            let [change, low, high] = of.change(k);
            let zero = trend.zero.map_or_else(String::new, |z| format!("{:.6}", z[0]));
            let run_in = trend
                .run_in
                .filter(|_| of.running_in[k])
                .map_or_else(|| ",".to_owned(), |r| format!("{:.6},{:.6}", r.amplitude, r.time[0]));
            let _ = writeln!(
                text,
                "{},{:.6},{:.6},{},{:.6},{:.6},{:.1},{change:.6},{low:.6},{high:.6},{},{:.6},{:.6},{zero},{},{run_in}",
                csv::shown(&cut.name).replace([',', '"', '\n'], " "),
                cut.cutting_speed * 60.0,
                cut.uncut_chip_thickness * 1e3,
                of.component.symbol(),
                trend.mean,
                trend.correlation * 1e3,
                trend.independent,
                yes(of.trending[k]),
                trend.thirds[0],
                trend.thirds[1],
                yes(of.drifting[k]),
            );
        }
    }
    text
}
