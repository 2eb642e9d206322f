//! Drawings in one scale for both directions.

use super::colours::INK;
use super::text::{svg_description, svg_text};
use std::fmt::Write;

const WIDTH: f64 = 520.0;

/// A part of the plane in one scale.
pub(crate) struct Drawing {
    left: f64,
    top: f64,
    /// Pixels per metre.
    scale: f64,
    svg: String,
}

impl Drawing {
    pub(crate) fn new(x: [f64; 2], y: [f64; 2], description: &str) -> Self {
        let scale = WIDTH / (x[1] - x[0]);
        let height = (y[1] - y[0]) * scale;
        let svg = format!(
            r#"<svg class="chart" viewBox="0 0 {WIDTH} {height:.0}" role="img" xmlns="http://www.w3.org/2000/svg"><title>{}</title>"#,
            svg_description(description)
        );
        Self { left: x[0], top: y[1], scale, svg }
    }

    fn at(&self, point: [f64; 2]) -> [f64; 2] {
        [(point[0] - self.left) * self.scale, (self.top - point[1]) * self.scale]
    }

    fn put(&mut self, text: std::fmt::Arguments<'_>) {
        self.svg.write_fmt(text).expect("writing to a string cannot fail");
    }

    pub(crate) fn polygon(&mut self, points: &[[f64; 2]], style: &str) {
        let points: Vec<String> = points
            .iter()
            .map(|point| self.at(*point))
            .map(|[x, y]| format!("{x:.1},{y:.1}"))
            .collect();
        self.put(format_args!(r#"<polygon points="{}" {style}/>"#, points.join(" ")));
    }

    pub(crate) fn block(&mut self, [x0, y0]: [f64; 2], [x1, y1]: [f64; 2], style: &str) {
        self.polygon(&[[x0, y0], [x1, y0], [x1, y1], [x0, y1]], style);
    }

    pub(crate) fn circle(&mut self, centre: [f64; 2], radius: f64, style: &str) {
        let ([x, y], r) = (self.at(centre), radius * self.scale);
        self.put(format_args!(r#"<circle cx="{x:.1}" cy="{y:.1}" r="{r:.1}" {style}/>"#));
    }

    pub(crate) fn dot(&mut self, centre: [f64; 2], radius: f64, colour: &str) {
        self.circle(centre, radius, &format!(r#"fill="{colour}""#));
    }

    pub(crate) fn line(&mut self, from: [f64; 2], to: [f64; 2], style: &str) {
        let ([x1, y1], [x2, y2]) = (self.at(from), self.at(to));
        self.put(format_args!(
            r#"<path d="M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}" fill="none" {style}/>"#
        ));
    }

    /// With its head at `to`.
    pub(crate) fn arrow(&mut self, from: [f64; 2], to: [f64; 2], colour: &str) {
        self.line(from, to, &format!(r#"stroke="{colour}" stroke-width="2""#));
        let ([x1, y1], [x2, y2]) = (self.at(from), self.at(to));
        let long = (x2 - x1).hypot(y2 - y1).max(1e-9);
        let (u, v) = (8.0 * (x2 - x1) / long, 8.0 * (y2 - y1) / long);
        let wing =
            |side: f64| format!("{:.1} {:.1}", x2 - u - side * 0.5 * v, y2 - v + side * 0.5 * u);
        self.put(format_args!(
            r#"<path d="M{x2:.1} {y2:.1}L{}L{}Z" fill="{colour}"/>"#,
            wing(1.0),
            wing(-1.0)
        ));
    }

    pub(crate) fn text(&mut self, at: [f64; 2], [right, down]: [f64; 2], anchor: &str, text: &str) {
        let [x, y] = self.at(at);
        self.put(format_args!(
            r#"<text class="value" x="{:.1}" y="{:.1}" text-anchor="{anchor}">{}</text>"#,
            x + right,
            y + down,
            svg_text(text)
        ));
    }

    /// The body of a tool.
    pub(crate) fn tool(&mut self, outline: &[[f64; 2]]) {
        self.polygon(outline, &format!(r##"fill="#c9ccd1" stroke="{INK}" stroke-width="1.5""##));
    }

    pub(crate) fn finish(mut self) -> String {
        self.svg.push_str("</svg>");
        self.svg
    }
}
