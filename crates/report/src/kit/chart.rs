//! Line and area charts as SVG, drawn for a page: text stays text, print stays sharp. What the script of the page (`script.js`)
//! needs to read values under the pointer are the axes, as attributes, and the paths.

use super::plot::extremes;
use super::text::{attribute, name_and_unit, svg_description, svg_text};
use super::ticks::Ticks;
use std::fmt::Write;

const WIDTH: f64 = 960.0;
const LEFT: f64 = 74.0;
const RIGHT: f64 = 18.0;
/// Height of a row of the legend, which stands above the chart.
const LEGEND_ROW: f64 = 19.0;
/// Base line of its first row.
const FIRST_ROW: f64 = 15.0;
const BOTTOM: f64 = 46.0;
/// Room of the name of a band: width, and height of a line.
const NAME: f64 = 150.0;
const LINE: f64 = 15.0;
/// Width of one letter of the legend, generously.
const LETTER: f64 = 7.4;
/// Most points of a line; a longer series keeps the extremes of each column.
const MOST_POINTS: usize = 1600;

/// A chart.
#[derive(Debug, Clone, Default)]
pub(crate) struct Chart<'a> {
    /// For people who cannot see it.
    pub description: String,
    pub x_title: &'a str,
    pub y_title: &'a str,
    pub height: f64,
    pub x: Vec<f64>,
    /// Lines over `x`.
    pub lines: Vec<ChartLine<'a>>,
    /// Areas over `x`, stacked: positive values upwards, negative ones downwards.
    pub areas: Vec<Area<'a>>,
    /// A part of the x axis to shade, with its name.
    pub window: Option<(f64, f64, &'a str)>,
    /// Horizontal bands: a mean and its interval.
    pub bands: Vec<Band<'a>>,
    /// Values the y axis must show beside the data.
    pub y_includes: Vec<f64>,
    /// Vertical lines with a name at the top.
    pub marks: Vec<Mark<'a>>,
    /// Whether `x` is that of the animation of the page: a mark at the time of its picture, and a click shows the nearest one.
    pub follows_animation: bool,
}

/// A place on the x axis.
#[derive(Debug, Clone)]
pub(crate) struct Mark<'a> {
    pub at: f64,
    pub colour: &'a str,
    pub label: String,
}

#[derive(Debug, Clone)]
pub(crate) struct ChartLine<'a> {
    pub name: &'a str,
    pub colour: &'a str,
    pub width: f64,
    pub values: Vec<f64>,
}

impl<'a> ChartLine<'a> {
    pub fn new(name: &'a str, colour: &'a str, width: f64, values: Vec<f64>) -> Self {
        Self { name, colour, width, values }
    }
}

#[derive(Debug, Clone)]
pub(crate) struct Area<'a> {
    pub name: &'a str,
    pub colour: &'a str,
    pub values: Vec<f64>,
}

/// A level with its interval over a part of the x axis.
#[derive(Debug, Clone)]
pub(crate) struct Band<'a> {
    pub from: f64,
    pub to: f64,
    pub mean: f64,
    pub half_width: f64,
    pub colour: &'a str,
    pub label: String,
}

/// The mapping of values to the drawing.
struct Axes {
    x: (f64, f64),
    y: (f64, f64),
    top: f64,
    bottom: f64,
}

impl Axes {
    fn x(&self, value: f64) -> f64 {
        LEFT + (value - self.x.0) / (self.x.1 - self.x.0) * (WIDTH - LEFT - RIGHT)
    }

    fn y(&self, value: f64) -> f64 {
        let share = (value - self.y.0) / (self.y.1 - self.y.0);
        // Far outside values would only make the numbers long.
        self.top + (1.0 - share.clamp(-10.0, 11.0)) * (self.bottom - self.top)
    }
}

impl Chart<'_> {
    /// The chart as an SVG element; `None` without at least two points.
    pub fn svg(&self) -> Option<String> {
        let (first, last) = (*self.x.first()?, *self.x.last()?);
        if self.x.len() < 2 || last.partial_cmp(&first) != Some(std::cmp::Ordering::Greater) {
            return None;
        }
        let stacks = stack(&self.areas, self.x.len());
        let legend = self.legend();
        let rows = legend.iter().map(|entry| entry.row + 1).max().unwrap_or(1);
        let axes = Axes {
            x: (first.min(0.0), last),
            y: self.y_range(&stacks),
            top: LEGEND_ROW * rows as f64 + 16.0,
            bottom: self.height - BOTTOM,
        };
        let ((x_name, x_unit), (y_name, y_unit)) =
            (name_and_unit(self.x_title), name_and_unit(self.y_title));
        let mut svg = format!(
            r#"<svg class="chart wide{}" viewBox="0 0 {WIDTH} {}" role="img" xmlns="http://www.w3.org/2000/svg" {} {}><title>{}</title>"#,
            if self.follows_animation { " follows" } else { "" },
            self.height,
            axis_attributes('x', axes.x, [LEFT, WIDTH - RIGHT], [x_name, x_unit], false),
            axis_attributes('y', axes.y, [axes.bottom, axes.top], [y_name, y_unit], false),
            svg_description(&self.description)
        );
        self.shade(&mut svg, &axes);
        self.grid(&mut svg, &axes);
        self.draw_areas(&mut svg, &axes, &stacks);
        self.draw_lines(&mut svg, &axes);
        self.draw_bands(&mut svg, &axes);
        self.draw_marks(&mut svg, &axes);
        legend.iter().for_each(|entry| entry.draw(&mut svg));
        svg.push_str("</svg>");
        Some(svg)
    }

    fn y_range(&self, stacks: &[Stack]) -> (f64, f64) {
        let lines = self.lines.iter().flat_map(|line| line.values.iter().copied());
        let areas = stacks.iter().flat_map(|s| s.low.iter().chain(&s.high).copied());
        let all = lines.chain(areas).chain(self.y_includes.iter().copied());
        let (low, high) = extremes(all);
        let margin = 0.05 * (high - low).max(1e-12 * high.abs()).max(f64::MIN_POSITIVE);
        (if low == 0.0 { 0.0 } else { low - margin }, high + margin)
    }

    fn shade(&self, svg: &mut String, axes: &Axes) {
        let Some((from, to, name)) = self.window else { return };
        let (x0, x1) = (axes.x(from.max(axes.x.0)), axes.x(to.min(axes.x.1)));
        // A name that would leave the chart on the right ends there.
        let leaves = x0 + 6.0 + LETTER * name.chars().count() as f64 > WIDTH - RIGHT;
        let (at, anchor) = if leaves { (x1 - 6.0, "end") } else { (x0 + 6.0, "start") };
        put(
            svg,
            format_args!(
                r##"<rect x="{x0:.1}" y="{}" width="{:.1}" height="{:.1}" fill="#eef3f7"/><text class="note" x="{at:.1}" y="{:.1}" text-anchor="{anchor}">{}</text>"##,
                axes.top,
                (x1 - x0).max(0.0),
                axes.bottom - axes.top,
                axes.top + 15.0,
                svg_text(name)
            ),
        );
    }

    fn grid(&self, svg: &mut String, axes: &Axes) {
        let bottom = axes.bottom;
        let ticks = Ticks::new(axes.y.0, axes.y.1, ((bottom - axes.top) / 45.0) as usize);
        for &value in &ticks.values {
            let y = axes.y(value);
            put(
                svg,
                format_args!(
                    r#"<line class="grid" x1="{LEFT}" x2="{:.1}" y1="{y:.1}" y2="{y:.1}"/><text class="tick" x="{:.1}" y="{:.1}" text-anchor="end">{}</text>"#,
                    WIDTH - RIGHT,
                    LEFT - 8.0,
                    y + 4.0,
                    ticks.label(value)
                ),
            );
        }
        let ticks = Ticks::new(axes.x.0, axes.x.1, 10);
        for &value in &ticks.values {
            let x = axes.x(value);
            put(
                svg,
                format_args!(
                    r#"<line class="axis" x1="{x:.1}" x2="{x:.1}" y1="{bottom}" y2="{}"/><text class="tick" x="{x:.1}" y="{}" text-anchor="middle">{}</text>"#,
                    bottom + 5.0,
                    bottom + 19.0,
                    ticks.label(value)
                ),
            );
        }
        let base = axes.y(0.0_f64.clamp(axes.y.0, axes.y.1));
        put(
            svg,
            format_args!(
                r#"<line class="axis" x1="{LEFT}" x2="{:.1}" y1="{base:.1}" y2="{base:.1}"/><text class="label" x="{:.1}" y="{}" text-anchor="middle">{}</text><text class="label" x="4" y="{}">{}</text>"#,
                WIDTH - RIGHT,
                (LEFT + WIDTH - RIGHT) / 2.0,
                self.height - 6.0,
                svg_text(self.x_title),
                FIRST_ROW,
                svg_text(self.y_title)
            ),
        );
    }

    /// The attribute by which the value of a line or area is read: its name, which may be empty where none has one.
    fn named(&self, name: &str) -> String {
        let mut names = self.lines.iter().map(|line| line.name);
        if name.is_empty() && names.any(|other| !other.is_empty()) {
            return String::new();
        }
        format!(r#" data-name="{}""#, attribute(name))
    }

    fn draw_lines(&self, svg: &mut String, axes: &Axes) {
        for line in &self.lines {
            let kept = thin_out(&line.values);
            let mut path = String::new();
            let mut pen_down = false;
            for k in kept {
                let value = line.values[k];
                if !value.is_finite() {
                    pen_down = false;
                    continue;
                }
                let command = if pen_down { 'L' } else { 'M' };
                put(
                    &mut path,
                    format_args!("{command}{:.1} {:.1}", axes.x(self.x[k]), axes.y(value)),
                );
                pen_down = true;
            }
            put(
                svg,
                format_args!(
                    r#"<path class="line"{} d="{path}" fill="none" stroke="{}" stroke-width="{}" stroke-linejoin="round"/>"#,
                    self.named(line.name),
                    line.colour,
                    line.width
                ),
            );
        }
    }

    fn draw_areas(&self, svg: &mut String, axes: &Axes, stacks: &[Stack]) {
        let step = self.x.len().div_ceil(MOST_POINTS / 4).max(1);
        let mut kept: Vec<usize> = (0..self.x.len()).step_by(step).collect();
        kept.extend((!(self.x.len() - 1).is_multiple_of(step)).then_some(self.x.len() - 1));
        for (area, stack) in self.areas.iter().zip(stacks) {
            let point = |k: &usize, values: &[f64]| {
                format!("{:.1} {:.1}", axes.x(self.x[*k]), axes.y(values[*k]))
            };
            let upper = kept.iter().map(|k| point(k, &stack.high));
            let lower = kept.iter().rev().map(|k| point(k, &stack.low));
            let path = upper.chain(lower).collect::<Vec<_>>().join("L");
            put(
                svg,
                format_args!(
                    r#"<path class="area"{} d="M{path}Z" fill="{}"/>"#,
                    self.named(area.name),
                    area.colour
                ),
            );
        }
    }

    /// Names above the bands, below where another name is.
    fn draw_bands(&self, svg: &mut String, axes: &Axes) {
        let mut named: Vec<[f64; 2]> = Vec::new();
        for band in &self.bands {
            // A window may end beyond the last point of the lines.
            let [x0, x1] = [band.from, band.to].map(|end| axes.x(end).clamp(LEFT, WIDTH - RIGHT));
            let y = axes.y(band.mean);
            let half = if band.half_width.is_finite() { band.half_width } else { 0.0 };
            let (top, bottom) = (axes.y(band.mean + half), axes.y(band.mean - half));
            let is_taken = |y: f64| {
                named.iter().any(|at| (at[0] - x1).abs() < NAME && (at[1] - y).abs() < LINE)
            };
            let name = Some(top - 6.0).filter(|y| !is_taken(*y)).unwrap_or(bottom + LINE);
            named.extend((!band.label.is_empty()).then_some([x1, name]));
            put(
                svg,
                format_args!(
                    r#"<rect x="{x0:.1}" y="{top:.1}" width="{:.1}" height="{:.1}" fill="{}" opacity="0.25"/><line x1="{x0:.1}" x2="{x1:.1}" y1="{y:.1}" y2="{y:.1}" stroke="{}" stroke-width="2"/><text class="value" x="{:.1}" y="{:.1}" text-anchor="end">{}</text>"#,
                    x1 - x0,
                    bottom - top,
                    band.colour,
                    band.colour,
                    x1 - 6.0,
                    name,
                    svg_text(&band.label)
                ),
            );
        }
    }

    /// Names one below the other, so that close marks stay readable.
    fn draw_marks(&self, svg: &mut String, axes: &Axes) {
        let inside = |mark: &&Mark<'_>| (axes.x.0..=axes.x.1).contains(&mark.at);
        for (row, mark) in self.marks.iter().filter(inside).enumerate() {
            let x = axes.x(mark.at);
            // On the side with more room.
            let (anchor, shift) = if x > 0.7 * WIDTH { ("end", -5.0) } else { ("start", 5.0) };
            put(
                svg,
                format_args!(
                    r#"<line x1="{x:.1}" x2="{x:.1}" y1="{:.1}" y2="{:.1}" stroke="{}" stroke-dasharray="5 4"/><text class="note" x="{:.1}" y="{:.1}" text-anchor="{anchor}">{}</text>"#,
                    axes.top,
                    axes.bottom,
                    mark.colour,
                    x + shift,
                    axes.top + 14.0 + 15.0 * (row % 6) as f64,
                    svg_text(&mark.label)
                ),
            );
        }
    }

    /// Names to the right of the y title, in as many rows as they need.
    fn legend(&self) -> Vec<LegendEntry<'_>> {
        let lines = self.lines.iter().map(|line| (line.name, line.colour));
        let areas = self.areas.iter().map(|area| (area.name, area.colour));
        let start = LEFT + LETTER * self.y_title.chars().count() as f64;
        let (mut x, mut row) = (start, 0);
        let mut entries = Vec::new();
        for (name, colour) in lines.chain(areas).filter(|(name, _)| !name.is_empty()) {
            let width = name.chars().count() as f64 * LETTER + 34.0;
            if x + width > WIDTH && x > start {
                (x, row) = (start, row + 1);
            }
            entries.push(LegendEntry { name, colour, x, row });
            x += width;
        }
        entries
    }
}

/// What the script of the page needs to read values at an axis: its ends in values and in the drawing, name and unit.
pub(super) fn axis_attributes(
    axis: char,
    (low, high): (f64, f64),
    [from, to]: [f64; 2],
    [name, unit]: [&str; 2],
    logarithmic: bool,
) -> String {
    format!(
        r#"data-{axis}="{low} {high} {from:.1} {to:.1}{}" data-{axis}-name="{}" data-{axis}-unit="{}""#,
        if logarithmic { " log" } else { "" },
        attribute(name),
        attribute(unit)
    )
}

/// One name of the legend and its place.
struct LegendEntry<'a> {
    name: &'a str,
    colour: &'a str,
    x: f64,
    row: usize,
}

impl LegendEntry<'_> {
    fn draw(&self, svg: &mut String) {
        let base = FIRST_ROW + LEGEND_ROW * self.row as f64;
        put(
            svg,
            format_args!(
                r#"<rect x="{:.1}" y="{:.1}" width="14" height="10" rx="2" fill="{}"/><text class="legend" x="{:.1}" y="{base:.1}">{}</text>"#,
                self.x,
                base - 9.0,
                self.colour,
                self.x + 19.0,
                svg_text(self.name)
            ),
        );
    }
}

/// Lower and upper edge of one area.
struct Stack {
    low: Vec<f64>,
    high: Vec<f64>,
}

fn stack(areas: &[Area<'_>], count: usize) -> Vec<Stack> {
    let (mut above, mut below) = (vec![0.0; count], vec![0.0; count]);
    areas
        .iter()
        .map(|area| {
            let mut edges = Stack { low: vec![0.0; count], high: vec![0.0; count] };
            for (k, &value) in area.values.iter().enumerate().take(count) {
                let level = if value >= 0.0 { &mut above[k] } else { &mut below[k] };
                let next = *level + if value.is_finite() { value } else { 0.0 };
                edges.low[k] = level.min(next);
                edges.high[k] = level.max(next);
                *level = next;
            }
            edges
        })
        .collect()
}

/// Indices worth drawing: all, or the smallest and largest value of each of many columns.
fn thin_out(values: &[f64]) -> Vec<usize> {
    let column = (2 * values.len()).div_ceil(MOST_POINTS);
    if column <= 2 {
        return (0..values.len()).collect();
    }
    let mut kept = Vec::with_capacity(MOST_POINTS);
    for start in (0..values.len()).step_by(column) {
        let range = start..(start + column).min(values.len());
        let low = range.clone().min_by(|&a, &b| values[a].total_cmp(&values[b]));
        let high = range.max_by(|&a, &b| values[a].total_cmp(&values[b]));
        let mut pair: Vec<usize> = low.into_iter().chain(high).collect();
        pair.sort_unstable();
        pair.dedup();
        kept.extend(pair);
    }
    kept
}

fn put(target: &mut String, text: std::fmt::Arguments<'_>) {
    target.write_fmt(text).expect("writing to a string cannot fail");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_stack_away_from_zero_on_both_sides() {
        let area = |value: f64| Area { name: "", colour: "red", values: vec![value] };
        let stacks = stack(&[area(2.0), area(-1.0), area(3.0), area(-0.5)], 1);
        let edges: Vec<(f64, f64)> = stacks.iter().map(|s| (s.low[0], s.high[0])).collect();
        assert_eq!(edges, [(0.0, 2.0), (-1.0, 0.0), (2.0, 5.0), (-1.5, -1.0)]);
    }

    #[test]
    fn thinning_keeps_the_extremes() {
        let mut values = vec![0.0; 100_000];
        values[54_321] = 7.0;
        values[777] = -3.0;
        let kept = thin_out(&values);
        assert!(kept.len() <= MOST_POINTS + 2, "{}", kept.len());
        assert!(kept.contains(&54_321) && kept.contains(&777));
        assert!(kept.is_sorted());
        assert_eq!(thin_out(&values[..10]).len(), 10);
    }

    #[test]
    fn the_name_of_a_window_at_the_right_end_stays_in_the_chart() {
        let mut chart = Chart {
            x: vec![0.0, 1.0],
            height: 300.0,
            lines: vec![ChartLine::new("a", "red", 1.0, vec![1.0, 2.0])],
            window: Some((0.1, 1.0, "window of the means (not steady)")),
            ..Chart::default()
        };
        let anchored = |chart: &Chart<'_>, end: &str| {
            let svg = chart.svg().unwrap();
            svg.contains(&format!("text-anchor=\"{end}\">window of the means"))
        };
        assert!(anchored(&chart, "start"));
        chart.window = Some((0.9, 1.0, "window of the means (not steady)"));
        assert!(anchored(&chart, "end"));
    }

    #[test]
    fn a_chart_needs_two_points_and_escapes_its_names() {
        let mut chart = Chart {
            x: vec![0.0],
            height: 300.0,
            lines: vec![ChartLine { name: "a<b", colour: "red", width: 1.0, values: vec![1.0] }],
            ..Chart::default()
        };
        assert_eq!(chart.svg(), None);
        chart.x = vec![0.0, 1.0];
        chart.lines[0].values = vec![1.0, f64::NAN];
        let svg = chart.svg().unwrap();
        assert!(svg.contains("a&lt;b") && !svg.contains("NaN"), "{svg}");
        // A line without a name beside one with it has no value to read.
        chart.lines.push(ChartLine { name: "", ..chart.lines[0].clone() });
        let svg = chart.svg().unwrap();
        assert_eq!(svg.matches("data-name=").count(), 1, "{svg}");
        chart.lines.remove(0);
        assert!(chart.svg().unwrap().contains(r#"data-name="""#));
    }
}
