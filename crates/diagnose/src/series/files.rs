//! The series in `diagnosis.json`, and `lines.csv`.

use super::{CutLine, Named, SeriesDiagnosis, Track};
use serde_json::{Value, json};
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
        "air_lines": found.air.iter().map(|(_, lines)| lines.iter().map(|line| json!({
            "frequency": line.frequency, "amplitude": line.amplitude,
        })).collect::<Vec<_>>()).collect::<Vec<_>>(),
        "visible_pitch_over_thickness": found.visible_pitch,
        "false_alarms": found.false_alarms.map(|rate| json!({
            "hits": rate.hits, "trials": rate.trials, "share": rate.share(), "interval": rate.interval(),
        })),
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
        for line in track.lines.iter().map(|&k| &found.lines[k]) {
            let cut = &found.cuts[line.cut];
            let rotation = cut.revolution.map_or_else(String::new, |n| format!("{:.6}", n * 60.0));
            for (channel, own) in cut.channels.iter().zip(&line.channels) {
                let Some(own) = own else { continue };
                let name = cut.name.replace([',', '"', '\n'], " ");
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
