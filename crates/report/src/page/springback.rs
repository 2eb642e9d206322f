//! `springback.html`: springback of one or several cuts, beside measurements if there are any.

use super::{residual_stress, run};
use crate::kit::chart::{Band, Chart, ChartLine};
use crate::kit::colours::{BLUE, BLUE_LIGHT, GREEN, RED};
use crate::kit::drawing::Drawing;
use crate::kit::numbers::{M_PER_MIN, MM, UM, three_digits, with_interval};
use crate::kit::shell::{Shell, figure, next, note, tab};
use crate::kit::table::{ColumnHead, or_dash, table};
use maud::{Markup, PreEscaped, html};
use sphcut_postprocess::ProcessResult;
use sphcut_postprocess::springback::{
    Agreement, Measurement, MedianInterval, OVERLAP_SHARE, RESOLUTION_SHARE, Springback,
};
use sphcut_record::Run;

/// One run of the page.
#[derive(Debug, Clone, Copy)]
pub struct SpringbackRun<'a> {
    /// What the user calls it.
    pub name: &'a str,
    /// Its page, as a link from this one.
    pub page: Option<&'a str>,
    /// Its record.
    pub run: &'a Run,
    /// Its evaluation.
    pub result: &'a ProcessResult,
    /// Its springback.
    pub springback: &'a Springback,
}

/// The text of `springback.html`; nothing is loaded.
#[must_use]
pub fn render_springback(runs: &[SpringbackRun<'_>], measurements: &[Measurement]) -> String {
    let version = runs.first().map_or("", |run| run.run.provenance.version.as_str());
    let sentences = runs.iter().map(|run| html! { (sentence(run, measurements)) });
    let body = html! {
        (note("What these figures say", sentences))
        (overview(runs, measurements))
        (against_speed(runs, measurements))
        @for run in runs { (details(run)) }
        (definitions())
        (next(&[
            ("sphcut springback RUN... --measured FILE", "the same beside measured springback"),
            ("sphcut sweep SWEEP.toml", "cuts over speed and thickness; `sphcut springback` takes its folder"),
        ]))
    };
    let lead = html! { "Normal distance between the lowest point of the tool and the machined surface behind it; "
    (of_which(runs)) "." };
    Shell { tab: tab("Springback"), title: "Springback", lead, version, body }.render()
}

/// Where it was measured.
fn of_which(runs: &[SpringbackRun<'_>]) -> &'static str {
    let spatial = runs.iter().filter(|run| run.run.facts.dimension == 3).count();
    match spatial {
        0 => "plane strain",
        _ if spatial == runs.len() => {
            "in turning, in a slice through that point behind the first pass"
        }
        _ => "plane strain, or in turning a slice through that point behind the first pass",
    }
}

/// v_c in m/min as text.
fn speed(springback: &Springback) -> String {
    three_digits(springback.cutting_speed * M_PER_MIN)
}

/// One run in words: what is resolved, and whether it agrees.
fn sentence(run: &SpringbackRun<'_>, measurements: &[Measurement]) -> String {
    let found = run.springback;
    let start = format!("{} ({} m/min): ", run.name, speed(found));
    let Some(mean) = found.mean else {
        return format!(
            "{start}no snapshot shows a particle touching the lowest part of the tool; more \
             snapshots are needed ([output] snapshots)."
        );
    };
    let error = found.error;
    let spacing = three_digits(found.particle_spacing * UM);
    if !error.statistical.is_finite() {
        return format!(
            "{start}{} \u{b5}m from {} particles: too few for an interval, which needs twenty behind \
             the tool and two at its lowest point. A longer cut or more snapshots give more.",
            three_digits(mean.mean * UM),
            found.in_window()
        );
    }
    let total = three_digits(error.total() * UM);
    let resolved = if found.is_resolved() {
        format!("springback is resolved at a spacing of {spacing} \u{b5}m")
    } else {
        format!(
            "springback is not resolved at a spacing of {spacing} \u{b5}m: all that is known is that \
             it is smaller than about {} \u{b5}m",
            three_digits((mean.mean.abs() + error.total()) * UM)
        )
    };
    let compared = match found.compare(measurements) {
        None if measurements.is_empty() => String::new(),
        None => " There is no measurement at this cutting speed.".to_owned(),
        Some(comparison) => {
            let verdict = match comparison.agreement {
                Agreement::Within => "lies within the uncertainty of the measurement",
                Agreement::Undecided => {
                    "lies outside the uncertainty of the measurement, but not by more than the error \
                     bar of the simulation: this cannot be decided"
                }
                Agreement::Outside => "lies outside the uncertainty of the measurement",
            };
            let wide = error.total() > comparison.measured.uncertainty;
            format!(
                " The difference to the measurement, {} \u{b5}m, {verdict} (\u{b1} {} \u{b5}m){}.",
                three_digits(comparison.difference * UM),
                three_digits(comparison.measured.uncertainty * UM),
                if wide { "; the error bar of the simulation is wider than that" } else { "" }
            )
        }
    };
    let steady = if run.result.steady.reached { "" } else { " The cutting force was not steady." };
    format!(
        "{start}{} \u{b1} {total} \u{b5}m; {resolved}.{compared}{steady}",
        three_digits(mean.mean * UM)
    )
}

fn overview(runs: &[SpringbackRun<'_>], measurements: &[Measurement]) -> Markup {
    use ColumnHead::{Number, Text};
    let columns = [
        Text("Run"),
        Number("v_c in m/min"),
        Number("Springback in \u{b5}m"),
        Number("interval"),
        Number("median and its interval"),
        Number("overlap"),
        Number("resolution"),
        Number("Measured in \u{b5}m"),
        Number("F_c in N"),
        Number("F_n in N"),
    ];
    let rows = html! { @for run in runs {
        @let found = run.springback;
        @let error = found.error;
        @let forces = &run.result.forces;
        @let compared = found.compare(measurements);
        tr {
            th scope="row" { (run.name) }
            td.n { (speed(found)) }
            td.n { (or_dash(found.mean, |mean| with_interval(mean.mean * UM, error.total() * UM))) }
            td.n { (three_digits(error.statistical * UM)) }
            td.n { (or_dash(found.median, median)) }
            td.n { (three_digits(error.overlap * UM)) }
            td.n { (three_digits(error.resolution * UM)) }
            td.n { (or_dash(compared, |c| with_interval(c.measured.springback * UM, c.measured.uncertainty * UM))) }
            td.n { (with_interval(forces.cutting.mean, forces.cutting.ci95)) (measured_force(compared.and_then(|c| c.measured.cutting_force))) }
            td.n { (with_interval(found.normal_force.mean, found.normal_force.ci95)) (measured_force(compared.and_then(|c| c.measured.normal_force))) }
        }
    } };
    html! {
        section {
            h2 { "Springback and forces" }
            (table("Springback with its error bar: 95 % interval of the mean, plus a fifth of the overlap of \
                particles and tool that was taken off, plus what the spacing resolves. The median does not follow crumbs \
                that stand up from the surface. Forces with their 95 % interval; the last is that \
                into the machined surface: the feed force of a plane cut, the passive force in turning.", columns, &rows))
        }
    }
}

/// A median in um with the bounds of its interval, if it has one.
fn median(found: MedianInterval) -> String {
    let [low, high] = found.bounds.map(|bound| bound * UM);
    let median = three_digits(found.median * UM);
    if low.is_finite() && high.is_finite() {
        format!("{median} ({} to {})", three_digits(low), three_digits(high))
    } else {
        median
    }
}

/// A measured force beside the simulated one.
fn measured_force(force: Option<f64>) -> Markup {
    html! { @if let Some(force) = force { br; "measured " (three_digits(force)) } }
}

fn against_speed(runs: &[SpringbackRun<'_>], measurements: &[Measurement]) -> Markup {
    let simulated = runs.iter().filter_map(|run| {
        let found = run.springback;
        let half = if found.error.statistical.is_finite() { found.error.total() } else { 0.0 };
        found.mean.map(|mean| (found.cutting_speed, mean.mean, half, BLUE))
    });
    let measured = measurements.iter().map(|m| (m.cutting_speed, m.springback, m.uncertainty, RED));
    let points: Vec<(f64, f64, f64, &str)> = simulated.chain(measured).collect();
    let highest = points.iter().map(|point| point.0 * M_PER_MIN).fold(0.0, f64::max);
    let half_width = 0.015 * highest;
    let chart = Chart {
        description: "Springback against cutting speed with error bars.".to_owned(),
        x_title: "Cutting speed in m/min",
        y_title: "Springback in \u{b5}m",
        height: 340.0,
        x: vec![0.0, 1.15 * highest],
        lines: vec![
            ChartLine::new("Simulated", BLUE, 1.0, Vec::new()),
            ChartLine::new(
                if measurements.is_empty() { "" } else { "Measured" },
                RED,
                1.0,
                Vec::new(),
            ),
        ],
        bands: points
            .iter()
            .map(|&(v, mean, half, colour)| Band {
                // Measured bars stand to the right of simulated ones.
                from: v * M_PER_MIN + if colour == RED { half_width } else { -half_width },
                to: v * M_PER_MIN + if colour == RED { 3.0 * half_width } else { half_width },
                mean: mean * UM,
                half_width: half * UM,
                colour,
                label: String::new(),
            })
            .collect(),
        y_includes: points
            .iter()
            .flat_map(|(_, mean, half, _)| [(mean - half) * UM, (mean + half) * UM])
            .chain([0.0])
            .collect(),
        ..Chart::default()
    };
    html! {
        section {
            h2 { "Against the cutting speed" }
            (figure(chart.svg(), "Each bar is a mean (line) with its whole error bar (box): simulated in blue, \
                measured with its uncertainty in orange, drawn beside the speed."))
        }
    }
}

fn details(run: &SpringbackRun<'_>) -> Markup {
    let found = run.springback;
    html! {
        section {
            h2 { (run.name) ", " (speed(found)) " m/min" }
            @if let Some(page) = run.page { p { a href=(page) { "Page of the run" } } }
            (behind_the_tool(found))
            (figure(profile(found).svg(), "Springback against the cutting distance. Blue: particles that a \
                snapshot has seen touching the lowest part of the tool, followed until they lie clear \
                of it. Pale: outermost particles of strips two spacings wide, whose height says how rough \
                the surface is. Band: mean over the window with its whole error bar."))
            p {
                "The outermost particles have a roughness (standard deviation) of "
                (three_digits(found.strips.roughness * UM)) " \u{b5}m and a mean height of "
                (three_digits(found.strips.mean * UM)) " \u{b5}m, which depends on the width of the strips \
                and is no springback. " (found.touched.len()) " particles were followed; "
                (found.torn) " were torn out."
            }
            (figure(recovery(found).svg(), "The same particles against the distance behind the tool: mean and \
                standard deviation between particles. The surface up to the clear distance is not part of \
                the mean."))
            (run::force_figure(run.run, run.result))
            (figure(residual_stress::chart(&found.stress).svg(), "Residual stress against the depth below the plane of the \
                tool's lowest point, tension positive: layers of one spacing weighted 1, 2, 1 with their \
                neighbours, mean over the window of the machined surface (thick) and its 95 % interval \
                (thin). The stress normal to the surface has to vanish at it: what it is there is an \
                error of the other two. Pressure alternates between single rows, which mean nothing \
                alone."))
        }
    }
}

/// The surface behind the tool in its true scale.
fn behind_the_tool(found: &Springback) -> Markup {
    let (Some(mean), Some(last)) = (found.mean, found.recovery.last()) else { return html! {} };
    if found.tool.len() < 3 {
        return html! {};
    }
    let long = last.behind.min(2.0 * found.clear_distance);
    let x = [-1.1 * long, 0.5 * long];
    let y = [-0.18 * long, 0.42 * long];
    let mut drawing = Drawing::new(x, y, "The machined surface behind the tool, in its true scale");
    let mut surface: Vec<[f64; 2]> =
        found.recovery.iter().map(|bin| [-bin.behind, bin.height]).collect();
    surface.insert(0, [0.0, 0.0]);
    surface.retain(|point| point[0] > x[0]);
    surface.extend([
        [x[0], surface.last().map_or(0.0, |point| point[1])],
        [x[0], y[0]],
        [0.0, y[0]],
    ]);
    drawing.polygon(&surface, &format!(r#"fill="{BLUE_LIGHT}" stroke="{BLUE}""#));
    drawing.tool(&found.tool);
    drawing.line([x[0], 0.0], [x[1], 0.0], &format!(r#"stroke="{RED}" stroke-dasharray="6 4""#));
    let place = [-0.8 * long, mean.mean];
    drawing.arrow([place[0], 0.1 * long], place, RED);
    drawing.arrow([place[0], -0.1 * long], [place[0], 0.0], RED);
    let error = if found.error.statistical.is_finite() {
        with_interval(mean.mean * UM, found.error.total() * UM)
    } else {
        three_digits(mean.mean * UM)
    };
    drawing.text([place[0], 0.1 * long], [0.0, -6.0], "middle", &format!("s = {error} \u{b5}m"));
    html! {
        figure {
            (PreEscaped(drawing.finish()))
            figcaption {
                "The machined surface behind the tool in its true scale, " (three_digits((x[1] - x[0]) * UM))
                " \u{b5}m wide. Dashed: the height of the tool's lowest point, where the surface would lie without springback."
            }
        }
    }
}

/// Value of the polyline through `points` at `x`; not a number outside.
fn interpolate(points: &[(f64, f64)], x: f64) -> f64 {
    let after = points.partition_point(|point| point.0 < x);
    match (after.checked_sub(1).map(|k| points[k]), points.get(after)) {
        (_, Some(&(at, value))) if at == x => value,
        (Some((x0, y0)), Some(&(x1, y1))) => y0 + (y1 - y0) * (x - x0) / (x1 - x0),
        _ => f64::NAN,
    }
}

fn profile(found: &Springback) -> Chart<'static> {
    let touched: Vec<(f64, f64)> =
        found.touched.iter().map(|t| (t.distance * MM, t.springback * UM)).collect();
    let strips: Vec<(f64, f64)> = found
        .strips
        .distance
        .iter()
        .zip(&found.strips.height)
        .map(|(distance, height)| (distance * MM, height * UM))
        .collect();
    let mut x: Vec<f64> = touched.iter().chain(&strips).map(|point| point.0).collect();
    x.sort_by(f64::total_cmp);
    x.dedup();
    let values = |points: &[(f64, f64)]| x.iter().map(|&x| interpolate(points, x)).collect();
    let [from, to] = [found.averaged_from, found.window[1]].map(|distance| distance * MM);
    let half_width = found.error.total() * UM;
    let bands = found.mean.map(|mean| Band {
        from,
        to,
        mean: mean.mean * UM,
        half_width,
        colour: GREEN,
        label: format!("s = {} \u{b5}m", with_interval(mean.mean * UM, half_width)),
    });
    Chart {
        description: "Springback against the cutting distance.".to_owned(),
        x_title: "Cutting distance in mm",
        y_title: "Springback in \u{b5}m",
        height: 360.0,
        lines: vec![
            ChartLine::new("Outermost particles", BLUE_LIGHT, 1.0, values(&strips)),
            ChartLine::new("Touched particles", BLUE, 2.0, values(&touched)),
        ],
        window: Some((from, to, "window")),
        bands: bands.into_iter().collect(),
        y_includes: vec![0.0],
        x,
        ..Chart::default()
    }
}

fn recovery(found: &Springback) -> Chart<'static> {
    let of = |sign: f64| -> Vec<f64> {
        found.recovery.iter().map(|bin| (bin.height + sign * bin.deviation) * UM).collect()
    };
    let clear = found.clear_distance * UM;
    let last = found.recovery.last().map_or(clear, |bin| bin.behind * UM);
    Chart {
        description: "Height of the surface against the distance behind the tool.".to_owned(),
        x_title: "Distance behind the tool in \u{b5}m",
        y_title: "Height above the tool's lowest point in \u{b5}m",
        height: 300.0,
        x: found.recovery.iter().map(|bin| bin.behind * UM).collect(),
        lines: vec![
            ChartLine::new("", BLUE_LIGHT, 1.0, of(1.0)),
            ChartLine::new("", BLUE_LIGHT, 1.0, of(-1.0)),
            ChartLine::new("Touched particles", BLUE, 2.0, of(0.0)),
        ],
        window: Some((clear, last.max(clear), "clear of the tool")),
        y_includes: vec![0.0],
        ..Chart::default()
    }
}

fn definitions() -> Markup {
    html! {
        section {
            h2 { "Definitions and limits" }
            p { "A particle of the surface has touched the tool; its springback is the height of its outer side \
                above the tool's lowest point once it is clear of the tool, less the mean overlap of these particles with the tool at \
                that point: so far a contact with a penalty lifts the surface, and a hard one does not. Averaged are those after the \
                run-in of springback itself. The error bar adds the 95 % interval of the mean (correlation and overlap taken into \
                account), " (three_digits(OVERLAP_SHARE * 100.0)) " % of that overlap, and " (three_digits(RESOLUTION_SHARE * 100.0)) " % of a spacing, \
                the error of a released surface with a known answer (validation cases springback_resolution and springback_cylinder)." }
            p { "At a spacing of 10 \u{b5}m springback of 1 \u{b5}m is a tenth of a spacing. The smooth surface of a \
                released block is resolved far better than that; the surface of a cut is rough by a good part \
                of a spacing, so its mean needs many particles. Whether the spacing resolves the flow under \
                the edge at all (five spacings across the edge radius) is not part of the error bar: only \
                runs at several spacings can tell. Thermal expansion is not modelled." }
        }
    }
}
