//! The force over time on the page of a diagnosis: lines, what they follow, how it was tested.

use super::time;
use crate::kit::chart::{Chart, ChartLine, Mark};
use crate::kit::colours::{BLUE, GREEN, RED, SLATE};
use crate::kit::numbers::{
    M_PER_MIN, MM, percent_whole, plain, three_digits, with_ends, with_interval,
};
use crate::kit::shell::{Shell, figure, tab, verdict};
use crate::kit::table::{ColumnHead, or_dash, table};
use crate::kit::text::with_symbols;
use maud::{Markup, html};
use sphcut_diagnose::series::{
    Comb, CutLine, Explanation, LineLaw, Named, OverTime, SeriesDiagnosis, Track, comb_words,
    law_title, series_words, time_words, track_words,
};

/// Spectra that are drawn.
const MOST_SPECTRA: usize = 6;
/// What the page of series without means shows.
#[derive(Clone, Copy)]
pub struct SeriesPage<'a> {
    /// What was measured.
    pub title: &'a str,
    /// Where it comes from.
    pub source: &'a str,
    /// Version of the program.
    pub version: &'a str,
    /// What was found.
    pub series: &'a SeriesDiagnosis,
}

/// The text of `diagnosis.html` where there are series alone; nothing is loaded.
#[must_use]
pub fn render_series(page: &SeriesPage<'_>) -> String {
    let lead = html! { (page.series.cuts.len()) @if page.series.cuts.len() == 1 { " recording" } @else { " recordings" } " of the force over time; " (page.source) "." };
    let changes = |of: &OverTime| of.trending.contains(&true) || of.running_in.contains(&true);
    let alarm = page.series.tracks.iter().any(|track| track.lines.len() > 2)
        || !page.series.combs.is_empty()
        || page.series.time.iter().any(changes);
    let body = html! {
        (verdict(alarm, &series_summary(page.series), sentence))
        (sections(page.series))
    };
    let title = format!("Forces over time: {}", page.title);
    Shell { tab: tab(&title), title: &title, lead, version: page.version, body }.render()
}

/// What is found, in a few sentences.
#[must_use]
pub fn series_summary(found: &SeriesDiagnosis) -> Vec<String> {
    let mut words = series_words(found);
    let combs = found.stated_combs().map(|comb| comb_words(found, comb)[0].clone());
    let tracks = found.single_tracks().filter(|(_, track)| track.named != Named::TooFewCuts);
    let tracks = tracks.map(|(_, track)| track_words(found, track)[0].clone());
    let sentences: Vec<String> = combs.chain(tracks).collect();
    words.splice(1..1, sentences);
    words.extend(time_words(found));
    words
}

/// A sentence: what stands between back quotes is code, symbols of forces and speeds have their index below.
pub(super) fn sentence(text: &str) -> Markup {
    html! {
        @for (k, part) in text.split('`').enumerate() {
            @if k % 2 == 1 { code { (part) } } @else { (with_symbols(part)) }
        }
    }
}

/// What is found, as a list.
pub(super) fn list(found: &SeriesDiagnosis) -> Markup {
    html! { ul { @for words in series_summary(found) { li { (sentence(&words)) } } } }
}

/// The sections of the page.
pub(super) fn sections(found: &SeriesDiagnosis) -> Markup {
    html! {
        section {
            h2 { "Where in frequency" }
            p { "Lines that stand out of the broadband force, followed over the cuts. What a line follows says what makes it: the same frequency in all cuts is a structure or the mains, "
                "a fixed ratio to the rotation is run-out or a drive, a fixed ratio to v" sub { "c" } "/h is a chip that comes in segments." }
            @for comb in found.stated_combs() { (one_comb(found, comb)) }
            @for (number, track) in found.single_tracks().filter(|(_, t)| t.named != Named::TooFewCuts) {
                (one_track(found, number + 1, track))
            }
            (others(found))
            (spectra(found))
        }
        (time::section(found))
    }
}

fn one_track(found: &SeriesDiagnosis, number: usize, track: &Track) -> Markup {
    let words = track_words(found, track);
    let columns = [
        ColumnHead::Text("It follows"),
        ColumnHead::Number("Probability"),
        ColumnHead::Text("Constant (95 % interval)"),
    ];
    let laws = html! { @for explanation in &track.explanations { tr {
        th scope="row" { (law_title(explanation.law)) }
        td.n { @if explanation.log_evidence.is_some() { (percent_whole(explanation.probability)) } @else { "impossible here" } }
        td { (constant(explanation)) }
    } } };
    html! {
        h3 { "Line " (number) ": " (heading(found, track)) }
        ul { @for sentence in &words { li { (self::sentence(sentence)) } } }
        (table("What it may follow. Named above 90 %, and only if these cuts can tell it from the other laws.", columns, &laws))
        (lines_table(found, track))
    }
}

/// Lowest and highest frequency.
fn heading(found: &SeriesDiagnosis, track: &Track) -> String {
    let all = || track.lines.iter().map(|&k| found.lines[k].frequency);
    let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max));
    if high < 1.01 * low {
        format!("{} Hz", three_digits(0.5 * (low + high)))
    } else {
        format!("{} to {} Hz", three_digits(low), three_digits(high))
    }
}

fn constant(explanation: &Explanation) -> String {
    // What is not believed needs no size.
    let Some([value, low, high]) = explanation.constant.filter(|_| explanation.probability > 0.01)
    else {
        return String::new();
    };
    let with = |name: &str, unit: &str| {
        let value = if low == high { three_digits(value) } else { with_ends([value, low, high]) };
        match value.split_once(' ') {
            Some((value, ends)) => format!("{name}{value}{unit} {ends}"),
            None => format!("{name}{value}{unit}"),
        }
    };
    match explanation.law {
        LineLaw::Mains | LineLaw::Constant => with("", " Hz"),
        LineLaw::Rotation | LineLaw::Ratio => with("", " per revolution"),
        LineLaw::Chip => with("pitch / h = ", ""),
        LineLaw::Chatter | LineLaw::Other => String::new(),
    }
}

fn lines_table(found: &SeriesDiagnosis, track: &Track) -> Markup {
    let air = !found.air.is_empty();
    let forces: Vec<String> =
        found.cuts[0].channels.iter().map(|c| format!("{} in N", c.component.symbol())).collect();
    let columns = [
        ColumnHead::Text("Cut"),
        ColumnHead::Number("v_c in m/min"),
        ColumnHead::Number("h in mm"),
        ColumnHead::Number("Frequency in Hz"),
    ];
    let columns = columns.into_iter().chain(forces.iter().map(|force| ColumnHead::Number(force)));
    let columns = columns.chain(air.then_some(ColumnHead::Text("In the air")));
    let rows = html! { @for line in track.lines.iter().map(|&k| &found.lines[k]) { (row(found, line, air)) } };
    table("Its lines. Amplitude: of the sine with the same power.", columns, &rows)
}

fn row(found: &SeriesDiagnosis, line: &CutLine, air: bool) -> Markup {
    let cut = &found.cuts[line.cut];
    html! { tr {
        th scope="row" { (cut.name) } td.n { (plain(cut.cutting_speed * M_PER_MIN)) } td.n { (plain(cut.uncut_chip_thickness * MM)) }
        td.n { (with_interval(line.frequency, 1.96 * line.error)) }
        @for own in &line.channels {
            td.n { (or_dash(own.as_ref(), |own| with_interval(own.amplitude, 1.96 * own.amplitude_error))) }
        }
        @if air { td { @if line.in_air { "yes" } @else { "no" } } }
    } }
}

/// Lines at multiples of a stated frequency.
fn one_comb(found: &SeriesDiagnosis, comb: &Comb) -> Markup {
    let words = comb_words(found, comb);
    let columns = [
        ColumnHead::Number("Multiple"),
        ColumnHead::Text("Cut"),
        ColumnHead::Number("Frequency in Hz"),
        ColumnHead::Number("Amplitude in N"),
    ];
    let rows = html! { @for (track, multiple) in &comb.members {
        @for line in found.tracks[*track].lines.iter().map(|&k| &found.lines[k]) { tr {
            td.n { (multiple) }
            th scope="row" { (found.cuts[line.cut].name) }
            td.n { (with_interval(line.frequency, 1.96 * line.error)) }
            td.n { (three_digits(line.amplitude())) }
        } }
    } };
    html! {
        h3 { (sentence(words[0].split(" in ").next().unwrap_or_default())) }
        ul { @for words in &words { li { (sentence(words)) } } }
        (table("Its lines. Amplitude: of the sine with the same power, of the larger force.", columns, &rows))
    }
}

/// Lines that belong to no track.
fn others(found: &SeriesDiagnosis) -> Markup {
    let few: Vec<&Track> =
        found.single_tracks().map(|(_, t)| t).filter(|t| t.named == Named::TooFewCuts).collect();
    let columns = [
        ColumnHead::Text("Cut"),
        ColumnHead::Number("Frequency in Hz"),
        ColumnHead::Number("Amplitude in N"),
    ];
    let rows = html! { @for line in few.iter().flat_map(|t| &t.lines).map(|&k| &found.lines[k]) { tr {
        th scope="row" { (found.cuts[line.cut].name) }
        td.n { (with_interval(line.frequency, 1.96 * line.error)) }
        td.n { (three_digits(line.amplitude())) }
    } } };
    html! { @if !few.is_empty() {
        h3 { "Lines in fewer than three cuts" }
        p { "They follow no law that could be named. Of all lines one in twenty is expected to be false: most of those are here." }
        (table("", columns, &rows))
    } }
}

fn spectra(found: &SeriesDiagnosis) -> Markup {
    let shown: Vec<usize> =
        (0..found.cuts.len()).filter(|&c| !found.spectra[c].is_empty()).collect();
    let step = shown.len().div_ceil(MOST_SPECTRA).max(1);
    let drawn: Vec<usize> = shown.iter().copied().step_by(step).collect();
    html! {
        h3 { "Spectra" }
        @if drawn.len() < shown.len() { p { "Of " (shown.len()) " cuts every " (step) ". is drawn." } }
        @for &c in &drawn {
            (figure(spectrum(found, c).svg(), format!("{}: power density (Welch, Hann windows, half overlap) and the smooth background, \
                in decibels above 1 N\u{b2}/Hz. Dashed: lines.", found.cuts[c].name)))
        }
    }
}

fn spectrum(found: &SeriesDiagnosis, cut: usize) -> Chart<'static> {
    let decibels = |density: &f64| 10.0 * density.max(1e-12).log10();
    let spectra = &found.spectra[cut];
    let first = sphcut_diagnose::series::LOWEST_BIN;
    let colours = [BLUE, RED, GREEN];
    let mut lines = Vec::new();
    for ((channel, own), colour) in found.cuts[cut].channels.iter().zip(spectra).zip(colours) {
        let range = first..own.density.len() - first;
        let values = |of: &[f64]| of[range.clone()].iter().map(decibels).collect();
        lines.push(ChartLine::new(channel.component.symbol(), colour, 1.0, values(&own.density)));
        lines.push(ChartLine::new("", SLATE, 1.6, values(&own.background)));
    }
    let width = spectra[0].resolution;
    let bins = spectra[0].density.len();
    let marks = found
        .lines
        .iter()
        .filter(|line| line.cut == cut)
        .map(|line| Mark {
            at: line.frequency,
            colour: SLATE,
            label: format!("{} Hz", three_digits(line.frequency)),
        })
        .collect();
    Chart {
        description: "Power density of the forces and its background.".to_owned(),
        x_title: "Frequency in Hz",
        y_title: "Density in dB re 1 N\u{b2}/Hz",
        height: 280.0,
        x: (first..bins - first).map(|k| k as f64 * width).collect(),
        lines,
        marks,
        ..Chart::default()
    }
}
