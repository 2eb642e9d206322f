//! Maps over v_c and h: a surface as colours, the measured points on it, the hull around them.

use super::canvas::{Canvas, Rgb};
use super::numbers::{M_PER_MIN, MM, three_digits};
use super::plot::{Axis, Plot, extremes};
use super::shell::data_uri;
use super::text::{attribute, name_and_unit, svg_text};
use super::ticks::Ticks;
use colorous::{Gradient, RED_BLUE, VIRIDIS};
use sphcut_greybox::{Hull, Input};

/// Points of a surface.
const GRID: [usize; 2] = [96, 72];
/// Room for the colours at the right.
const BAR: f64 = 84.0;

/// The colours of a map.
#[derive(Debug, Clone, Copy)]
pub(crate) enum ColourScale {
    /// From a low to a high value.
    Range(f64, f64),
    /// As far below zero as above; red is above.
    Around(f64),
}

impl ColourScale {
    pub(crate) fn of_range(values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = extremes(values);
        Self::Range(low, if high > low { high } else { low + 1.0 })
    }

    pub(crate) fn around_zero(values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = extremes(values);
        Self::Around(low.abs().max(high.abs()).max(1e-9))
    }

    fn ends(self) -> (f64, f64) {
        match self {
            Self::Range(low, high) => (low, high),
            Self::Around(size) => (-size, size),
        }
    }

    fn rgb(self, value: f64) -> Rgb {
        let (low, high) = self.ends();
        let share = ((value - low) / (high - low)).clamp(0.0, 1.0);
        let (gradient, share): (Gradient, f64) = match self {
            Self::Range(..) => (VIRIDIS, share),
            Self::Around(_) => (RED_BLUE, 1.0 - share),
        };
        let colour = gradient.eval_continuous(share);
        [colour.r, colour.g, colour.b]
    }

    fn css(self, value: f64) -> String {
        let [r, g, b] = self.rgb(value);
        format!("rgb({r},{g},{b})")
    }
}

/// A point of a map.
#[derive(Debug, Clone)]
pub(crate) struct ValueAt {
    pub at: Input,
    pub value: f64,
    /// Where a click leads.
    pub link: Option<String>,
}

/// One map.
pub(crate) struct Map<'a> {
    pub title: String,
    pub description: String,
    /// Name and unit of what the colours show.
    pub quantity: String,
    pub colours: ColourScale,
    pub hull: &'a Hull,
    /// All conditions, for the axes.
    pub inputs: &'a [Input],
    /// The surface, if there is one.
    pub surface: Option<&'a dyn Fn(Input) -> f64>,
    /// Points with their values.
    pub points: Vec<ValueAt>,
}

/// `F_c 267 N`, or `12.1 N` where the quantity is a unit alone.
fn note(quantity: &str, value: f64) -> String {
    match name_and_unit(quantity) {
        (unit, "") => format!("{} {unit}", three_digits(value)),
        (name, unit) => format!("{name} {} {unit}", three_digits(value)),
    }
}

impl Map<'_> {
    pub(crate) fn svg(&self) -> String {
        let x = Axis::of_conditions("v_c in m/min", self.inputs.iter().map(|i| i[0] * M_PER_MIN));
        let y = Axis::of_conditions("h in mm", self.inputs.iter().map(|i| i[1] * MM));
        let mut plot = Plot::new(x, y, BAR, &self.description);
        if let Some(surface) = self.surface {
            let image = self.image(&plot, surface);
            let [left, top, right, bottom] = plot.inner();
            plot.put(format_args!(
                r#"<image x="{left}" y="{top}" width="{:.1}" height="{:.1}" preserveAspectRatio="none" href="{image}"/>"#,
                right - left,
                bottom - top
            ));
        }
        self.border(&mut plot);
        for point in &self.points {
            let [x, y] = [point.at[0] * M_PER_MIN, point.at[1] * MM];
            let style = format!(
                r##"fill="{}" stroke="#fff" stroke-width="1.2" data-note="{}""##,
                self.colours.css(point.value),
                attribute(&note(&self.quantity, point.value))
            );
            plot.linked(point.link.as_deref(), |plot| {
                plot.dot(x, y, 6.2, r##"fill="#22262b""##);
                plot.dot(x, y, 5.2, &style);
            });
        }
        plot.axes(&self.title, false);
        self.bar(&mut plot);
        plot.finish()
    }

    /// The surface as a picture; paler outside the hull.
    fn image(&self, plot: &Plot, surface: &dyn Fn(Input) -> f64) -> String {
        let [columns, rows] = GRID;
        let mut canvas = Canvas::new(columns, rows);
        for row in 0..rows {
            let h = plot.y.value(1.0 - (row as f64 + 0.5) / rows as f64) / MM;
            for column in 0..columns {
                let v = plot.x.value((column as f64 + 0.5) / columns as f64) / M_PER_MIN;
                let colour = self.colours.rgb(surface([v, h]));
                let inside = self.hull.contains([v, h]);
                let fade = |c: u8| if inside { c } else { 255 - (255 - c) / 5 };
                canvas.pixels[row * columns + column] = colour.map(fade);
            }
        }
        data_uri("image/png", &canvas.png())
    }

    /// The hull of the measured conditions; its straight sides bend where an axis is logarithmic.
    fn border(&self, plot: &mut Plot) {
        let corners = self.hull.corners();
        let mut points = Vec::new();
        for (k, a) in corners.iter().enumerate() {
            let b = corners[(k + 1) % corners.len()];
            points.extend((0..=20).map(|step| {
                let share = f64::from(step) / 20.0;
                let mix = |axis: usize| a[axis] + share * (b[axis] - a[axis]);
                [mix(0) * M_PER_MIN, mix(1) * MM]
            }));
        }
        plot.line(&points, r##"stroke="#22262b" stroke-width="1.4" stroke-dasharray="5 4""##);
    }

    fn bar(&self, plot: &mut Plot) {
        let [_, top, right, bottom] = plot.inner();
        let (low, high) = self.colours.ends();
        let steps = 60;
        for step in 0..steps {
            let value = low + (high - low) * (f64::from(step) + 0.5) / f64::from(steps);
            let height = (bottom - top) / f64::from(steps);
            plot.put(format_args!(
                r#"<rect x="{:.1}" y="{:.1}" width="14" height="{:.1}" fill="{}"/>"#,
                right + 14.0,
                bottom - height * f64::from(step + 1),
                height + 0.5,
                self.colours.css(value)
            ));
        }
        let ticks = Ticks::new(low, high, 6);
        for &value in &ticks.values {
            let y = bottom - (value - low) / (high - low) * (bottom - top);
            plot.put(format_args!(
                r#"<text class="tick" x="{:.1}" y="{:.1}">{}</text>"#,
                right + 33.0,
                y + 4.0,
                ticks.label(value)
            ));
        }
        plot.put(format_args!(
            r#"<text class="label" x="{:.1}" y="{:.1}" text-anchor="end">{}</text>"#,
            right + BAR - 2.0,
            bottom + 36.0,
            svg_text(&self.quantity)
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_says_its_value_with_name_and_unit() {
        assert_eq!(note("F_c in N", 267.0), "F_c 267 N");
        assert_eq!(note("N", 12.12), "12.1 N");
    }
}
