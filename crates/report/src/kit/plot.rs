//! A small plot: two axes, linear or logarithmic, for maps and scatter plots.

use super::chart::axis_attributes;
use super::text::{attribute, name_and_unit, svg_description, svg_text};
use super::ticks::Ticks;
use std::fmt::Write;

/// Width and height of a plot for half of the page.
const HALF: [f64; 2] = [520.0, 390.0];
/// And for a third of it.
const THIRD: [f64; 2] = [346.0, 236.0];
const LEFT: f64 = 62.0;
const TOP: f64 = 30.0;
const BOTTOM: f64 = 46.0;

/// One axis.
#[derive(Debug, Clone)]
pub(crate) struct Axis {
    pub title: String,
    low: f64,
    high: f64,
    logarithmic: bool,
}

/// Axes that span more are logarithmic.
const DECADES: f64 = 12.0;

impl Axis {
    /// An axis of cutting conditions: all values with a margin; logarithmic if they span decades.
    pub(crate) fn of_conditions(title: &str, values: impl Iterator<Item = f64> + Clone) -> Self {
        let (low, high) = extremes(values);
        if low > 0.0 && high / low > DECADES {
            let margin = (high / low).powf(0.04);
            let (low, high) = (low / margin, high * margin);
            return Self { title: title.to_owned(), low, high, logarithmic: true };
        }
        Self::linear(title, [low, high].into_iter(), 0.06)
    }

    /// A linear axis with a margin of a share of its extent.
    pub(crate) fn linear(
        title: &str,
        values: impl Iterator<Item = f64> + Clone,
        share: f64,
    ) -> Self {
        let (low, high) = extremes(values);
        let extent = if high > low { high - low } else { high.abs().max(1e-9) };
        let (low, high) = (low - share * extent, high + share * extent);
        Self { title: title.to_owned(), low, high, logarithmic: false }
    }

    /// A logarithmic axis with a margin; all values above 0.
    pub(crate) fn logarithmic(title: &str, values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = extremes(values.filter(|value| *value > 0.0));
        let (low, high) = (low.max(1e-12) / 1.25, high.max(1e-12) * 1.25);
        Self { title: title.to_owned(), low, high, logarithmic: true }
    }

    /// Place of a value, 0 at the low end and 1 at the high end.
    pub(crate) fn share(&self, value: f64) -> f64 {
        let map = |v: f64| if self.logarithmic { v.max(1e-300).ln() } else { v };
        (map(value) - map(self.low)) / (map(self.high) - map(self.low))
    }

    /// The value at a place.
    pub(crate) fn value(&self, share: f64) -> f64 {
        if self.logarithmic {
            return (self.low.ln() + share * (self.high / self.low).ln()).exp();
        }
        self.low + share * (self.high - self.low)
    }

    fn attributes(&self, axis: char, ends: [f64; 2]) -> String {
        let (name, unit) = name_and_unit(&self.title);
        axis_attributes(axis, (self.low, self.high), ends, [name, unit], self.logarithmic)
    }

    fn ticks(&self, wanted: usize) -> Vec<(f64, String)> {
        if !self.logarithmic {
            let ticks = Ticks::new(self.low, self.high, wanted);
            return ticks.values.iter().map(|&value| (value, ticks.label(value))).collect();
        }
        let first = self.low.log10().floor() as i32;
        let last = self.high.log10().ceil() as i32;
        (first..=last)
            .flat_map(|power| [1.0, 2.0, 5.0].map(|factor| factor * 10_f64.powi(power)))
            .filter(|value| (self.low..=self.high).contains(value))
            .map(|value| {
                let decimals = (-value.log10() - 1e-9).ceil().max(0.0) as usize;
                (value, format!("{value:.decimals$}"))
            })
            .collect()
    }
}

pub(crate) fn extremes(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values
        .filter(|value| value.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
    if low > high { (0.0, 1.0) } else { (low, high) }
}

/// Two axes and the drawing.
pub(crate) struct Plot {
    pub x: Axis,
    pub y: Axis,
    /// Room for a colour bar.
    pub right: f64,
    pub svg: String,
    /// Width and height.
    size: [f64; 2],
}

impl Plot {
    pub(crate) fn new(x: Axis, y: Axis, right: f64, description: &str) -> Self {
        Self::sized(x, y, right, description, HALF)
    }

    /// One of several side by side that share their axes.
    pub(crate) fn small(x: Axis, y: Axis, description: &str) -> Self {
        Self::sized(x, y, 10.0, description, THIRD)
    }

    fn sized(x: Axis, y: Axis, right: f64, description: &str, size: [f64; 2]) -> Self {
        let mut plot = Self { x, y, right, svg: String::new(), size };
        let [width, height] = size;
        let [left, top, right, bottom] = plot.inner();
        plot.svg = format!(
            r#"<svg class="chart" viewBox="0 0 {width} {height}" role="img" xmlns="http://www.w3.org/2000/svg" {} {}><title>{}</title>"#,
            plot.x.attributes('x', [left, right]),
            plot.y.attributes('y', [bottom, top]),
            svg_description(description)
        );
        plot
    }

    /// Left, top, right and bottom of the inner part.
    pub(crate) fn inner(&self) -> [f64; 4] {
        [LEFT, TOP, self.size[0] - self.right, self.size[1] - BOTTOM]
    }

    pub(crate) fn at(&self, x: f64, y: f64) -> [f64; 2] {
        let [left, top, right, bottom] = self.inner();
        [
            left + self.x.share(x).clamp(-5.0, 6.0) * (right - left),
            bottom - self.y.share(y).clamp(-5.0, 6.0) * (bottom - top),
        ]
    }

    pub(crate) fn put(&mut self, text: std::fmt::Arguments<'_>) {
        self.svg.write_fmt(text).expect("writing to a string cannot fail");
    }

    pub(crate) fn line(&mut self, points: &[[f64; 2]], style: &str) {
        let path: Vec<String> = points
            .iter()
            .map(|&[x, y]| self.at(x, y))
            .map(|[x, y]| format!("{x:.1} {y:.1}"))
            .collect();
        self.put(format_args!(r#"<path d="M{}" fill="none" {style}/>"#, path.join("L")));
    }

    /// A point of the data; `data-note` in its style says what its axes do not.
    pub(crate) fn dot(&mut self, x: f64, y: f64, radius: f64, style: &str) {
        let [x, y] = self.at(x, y);
        self.put(format_args!(
            r#"<circle class="dot" cx="{x:.1}" cy="{y:.1}" r="{radius}" {style}/>"#
        ));
    }

    /// What `draw` draws, as a link.
    pub(crate) fn linked(&mut self, target: Option<&str>, draw: impl FnOnce(&mut Self)) {
        let Some(target) = target else { return draw(self) };
        self.put(format_args!(r#"<a href="{}">"#, attribute(target)));
        draw(self);
        self.put(format_args!("</a>"));
    }

    /// Names of colours in the row above, to the right.
    pub(crate) fn legend(&mut self, entries: &[(&str, &str)]) {
        let width = |name: &str| 7.0 * name.chars().count() as f64 + 24.0;
        let mut x =
            self.size[0] - self.right - entries.iter().map(|(_, name)| width(name)).sum::<f64>();
        for (colour, name) in entries {
            self.put(format_args!(
                r#"<circle cx="{:.1}" cy="12" r="4.5" fill="{colour}"/><text class="legend" x="{:.1}" y="16">{}</text>"#,
                x + 8.0,
                x + 16.0,
                svg_text(name)
            ));
            x += width(name);
        }
    }

    /// A line that ends at the border of the inner part.
    pub(crate) fn clipped(&mut self, from: [f64; 2], to: [f64; 2], style: &str) {
        let inside = |value: f64, axis: &Axis| (-1e-9..=1.0 + 1e-9).contains(&axis.share(value));
        let steps = 400;
        let points: Vec<[f64; 2]> = (0..=steps)
            .map(|k| {
                let share = f64::from(k) / f64::from(steps);
                [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])]
            })
            .filter(|&[x, y]| inside(x, &self.x) && inside(y, &self.y))
            .collect();
        if let [first, .., last] = points[..] {
            self.line(&[first, last], style);
        }
    }

    /// Grid, axes and titles.
    pub(crate) fn axes(&mut self, title: &str, grid: bool) {
        let [left, top, right, bottom] = self.inner();
        let wanted = |length: f64, each: f64| (length / each) as usize;
        for (value, label) in self.y.ticks(wanted(bottom - top, 52.0)) {
            let [_, y] = self.at(self.x.low, value);
            let line = if grid {
                format!(r#"<line class="grid" x1="{left}" x2="{right}" y1="{y:.1}" y2="{y:.1}"/>"#)
            } else {
                String::new()
            };
            self.put(format_args!(
                r#"{line}<line class="axis" x1="{:.1}" x2="{left}" y1="{y:.1}" y2="{y:.1}"/><text class="tick" x="{:.1}" y="{:.1}" text-anchor="end">{label}</text>"#,
                left - 4.0,
                left - 8.0,
                y + 4.0
            ));
        }
        for (value, label) in self.x.ticks(wanted(right - left, 60.0)) {
            let [x, _] = self.at(value, self.y.low);
            self.put(format_args!(
                r#"<line class="axis" x1="{x:.1}" x2="{x:.1}" y1="{bottom}" y2="{:.1}"/><text class="tick" x="{x:.1}" y="{:.1}" text-anchor="middle">{label}</text>"#,
                bottom + 4.0,
                bottom + 18.0
            ));
        }
        let (x_title, y_title) = (svg_text(&self.x.title), svg_text(&self.y.title));
        self.put(format_args!(
            r#"<rect x="{left}" y="{top}" width="{:.1}" height="{:.1}" fill="none" class="axis"/><text class="label" x="{:.1}" y="{:.1}" text-anchor="middle">{x_title}</text><text class="label" x="4" y="16">{y_title}</text><text class="label" x="{:.1}" y="16" text-anchor="end" font-weight="600">{}</text>"#,
            right - left,
            bottom - top,
            (left + right) / 2.0,
            self.size[1] - 8.0,
            self.size[0] - 4.0,
            svg_text(title)
        ));
    }

    pub(crate) fn finish(mut self) -> String {
        self.svg.push_str("</svg>");
        self.svg
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_that_span_decades_are_logarithmic() {
        let axis = Axis::of_conditions("v", [10.0, 500.0].into_iter());
        assert!(axis.logarithmic && (axis.value(axis.share(70.0)) - 70.0).abs() < 1e-9);
        let labels: Vec<String> = axis.ticks(5).into_iter().map(|(_, label)| label).collect();
        assert_eq!(labels, ["10", "20", "50", "100", "200", "500"]);
        let axis = Axis::of_conditions("h", [0.01, 2.0].into_iter());
        let labels: Vec<String> = axis.ticks(5).into_iter().map(|(_, label)| label).collect();
        assert_eq!(labels, ["0.01", "0.02", "0.05", "0.1", "0.2", "0.5", "1", "2"]);
        let axis = Axis::of_conditions("h", [0.06, 0.15].into_iter());
        assert!(!axis.logarithmic && (axis.share(0.105) - 0.5).abs() < 1e-12);
    }
}
