//! Simulated against measured values of one channel, before and after something was fitted.

use super::colours::{BLUE, GREY, INK};
use super::plot::{Axis, Plot, extremes};
use super::text::attribute;
use sphcut_physics::Channel;

/// One measured value and what is simulated of it, all in the unit of the plot.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ComparedPoint {
    pub measured: f64,
    pub before: f64,
    pub after: f64,
    /// 95 % interval of `after`.
    pub interval: [f64; 2],
    /// Which cut it is.
    pub name: String,
}

/// Factor from SI units and the unit in which people read a channel.
pub(crate) fn channel_unit(channel: Channel) -> (f64, &'static str) {
    match channel.unit() {
        "m" => (1e3, "mm"),
        other => (1.0, other),
    }
}

/// The plot of a channel, `title` with its unit; `names` say what was before and what is after.
pub(crate) fn parity(title: &str, points: &[ComparedPoint], names: [&str; 2]) -> String {
    let all = || {
        let of = |p: &ComparedPoint| [p.measured, p.before, p.interval[0], p.interval[1]];
        points.iter().flat_map(of)
    };
    let all: Vec<f64> = all().collect();
    let axis = |name: &str| Axis::linear(name, all.iter().copied(), 0.06);
    let unit = title.rsplit_once(" in ").map_or("", |(_, unit)| unit);
    let mut plot = Plot::new(
        axis(&format!("measured {title}")),
        axis(&format!("simulated in {unit}")),
        16.0,
        title,
    );
    plot.axes("", true);
    let (low, high) = extremes(all.iter().copied());
    plot.line(&[[low, low], [high, high]], &format!(r#"stroke="{INK}" stroke-width="1""#));
    for point in points {
        let x = point.measured;
        let note = |name: &str| {
            format!(r#"data-note="{}""#, attribute(&format!("{name}, {}", point.name)))
        };
        plot.dot(x, point.before, 3.5, &format!(r#"fill="{GREY}" {}"#, note(names[0])));
        let [low, high] = point.interval;
        plot.line(&[[x, low], [x, high]], &format!(r#"stroke="{BLUE}" stroke-width="1.5""#));
        plot.dot(x, point.after, 4.0, &format!(r#"fill="{BLUE}" {}"#, note(names[1])));
    }
    plot.legend(&[(GREY, names[0]), (BLUE, names[1])]);
    plot.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cut_has_a_point_before_and_one_with_its_interval_after() {
        let point = |measured: f64| ComparedPoint {
            measured,
            before: 0.8 * measured,
            after: measured,
            interval: [0.9 * measured, 1.1 * measured],
            name: format!("cut at {measured} <N>"),
        };
        let svg = parity("F_c in N", &[point(100.0), point(200.0)], ["as it is", "corrected"]);
        assert_eq!(svg.matches("class=\"dot\"").count(), 4);
        assert!(svg.contains("data-note=\"corrected, cut at 200 &lt;N&gt;\""), "{svg}");
        assert!(svg.contains("data-y-unit=\"N\"") && svg.contains("data-x-name=\"measured F_c\""));
    }
}
