//! The setup of a plane cut as two drawings: all of it, and the edge.

use crate::kit::colours::{BLUE, BLUE_LIGHT, GREEN, GREY, RED, SLATE};
use crate::kit::drawing::Drawing;
use crate::kit::numbers::{UM, plain, three_digits};
use maud::{Markup, PreEscaped, html};
use sphcut_record::{Facts, Provenance};
use sphcut_sph::Snapshot;
use std::fmt::Write;

/// More particles than this are not drawn, those farthest from the edge first.
const MOST_PARTICLES: usize = 2500;

/// A cut before it begins, in m; the uncut surface is y = 0, the tool moves along x.
struct CutScene<'a> {
    facts: &'a Facts,
    /// Length and height of the workpiece.
    size: [f64; 2],
    depth: f64,
    tool: Vec<[f64; 2]>,
    particles: Vec<[f64; 2]>,
    /// Largest spacing in the uncut chip.
    chip_spacing: f64,
    /// Depth of the held layers, and which sides are held.
    held: (f64, [bool; 2]),
    /// How far the window reaches ahead of the edge and behind it.
    window: Option<[f64; 2]>,
}

/// The drawings with their captions; nothing of a cut in space or one that is turned in the plane.
pub(crate) fn drawings(facts: &Facts, provenance: &Provenance, first: &Snapshot) -> Markup {
    let Some(scene) = CutScene::new(facts, provenance, first) else { return html! {} };
    html! {
        div.pair {
            figure { (PreEscaped(scene.whole())) figcaption { (scene.caption()) } }
            figure { (PreEscaped(scene.edge())) figcaption { "The edge with its radius, the uncut chip thickness and the particles as they start." } }
        }
    }
}

impl<'a> CutScene<'a> {
    fn new(facts: &'a Facts, provenance: &Provenance, first: &Snapshot) -> Option<Self> {
        let is_plain = facts.dimension == 2
            && facts.frame.cutting == [1.0, 0.0, 0.0]
            && facts.frame.feed[1] < 0.0
            && first.time == 0.0;
        let held = |side: &str| {
            provenance.setting("boundaries", side).is_some_and(|set| set.text != "free")
        };
        let number = |section: &str, key: &str| provenance.number(section, key);
        let layers = number("boundaries", "layers").unwrap_or(0.0);
        let flat = |points: &[[f64; 3]]| points.iter().map(|p| [p[0], p[1]]).collect::<Vec<_>>();
        is_plain.then_some(())?;
        let depth = facts.uncut_chip_thickness?;
        let largest = |lowest: f64| {
            let spacing = |(i, place): (usize, &[f64; 3])| {
                if place[1] > lowest { first.spacing_at(i) } else { 0.0 }
            };
            first.position.iter().enumerate().map(spacing).fold(facts.particle_spacing, f64::max)
        };
        Some(Self {
            facts,
            size: [number("workpiece", "length")?, number("workpiece", "height")?],
            depth,
            chip_spacing: largest(-depth),
            tool: Some(flat(&first.tool)).filter(|tool| tool.len() > 2)?,
            particles: flat(&first.position),
            held: (layers * largest(f64::NEG_INFINITY), [held("bottom"), held("back")]),
            window: number("window", "ahead").zip(number("window", "behind")).map(<[f64; 2]>::from),
        })
    }

    fn travel(&self) -> f64 {
        self.facts.end_time * self.facts.cutting_speed()
    }

    /// The lowest point of the tool.
    fn tip(&self) -> [f64; 2] {
        self.tool.iter().copied().reduce(|a, b| if b[1] < a[1] { b } else { a }).unwrap_or_default()
    }

    fn caption(&self) -> String {
        let millimetres = |length: f64| plain(length * 1e3);
        let mut caption = format!(
            "Workpiece of {} x {} mm; the tool moves {} mm to the right.",
            millimetres(self.size[0]),
            millimetres(self.size[1]),
            millimetres(self.travel())
        );
        if let Some([ahead, behind]) = self.window {
            let _ = write!(
                caption,
                " Green: the window, {} mm ahead of the edge and {} mm behind it, outside which nothing is followed.",
                millimetres(ahead),
                millimetres(behind)
            );
        }
        if self.held.0 > 0.0 && self.held.1 != [false; 2] {
            caption.push_str(" Grey: held particles.");
        }
        caption
    }

    /// Workpiece, supports, window, tool and its path.
    fn whole(&self) -> String {
        let [length, height] = self.size;
        let tip = self.tip();
        let [left, right] = [-0.2 * length, length.max(self.travel()) + 0.06 * length];
        let top = (0.3 * (right - left)).max(3.0 * self.depth);
        let mut drawing =
            Drawing::new([left, right], [-1.25 * height, top], "The setup of the cut");
        drawing.block([0.0, -height], [length, 0.0], &format!(r#"fill="{BLUE_LIGHT}""#));
        let (layers, [bottom, back]) = self.held;
        let hold = format!(r#"fill="{SLATE}""#);
        if bottom {
            drawing.block([0.0, -height], [length, layers - height], &hold);
        }
        if back {
            drawing.block([length - layers, -height], [length, 0.0], &hold);
        }
        if let Some([ahead, behind]) = self.window {
            let style = format!(
                r#"fill="{GREEN}" fill-opacity="0.15" stroke="{GREEN}" stroke-width="1.5" stroke-dasharray="5 3""#
            );
            let [from, to] = [tip[0] - behind, tip[0] + ahead];
            drawing.block([from, -1.1 * height], [to, 3.0 * self.depth], &style);
        }
        let end: Vec<[f64; 2]> = self.tool.iter().map(|p| [p[0] + self.travel(), p[1]]).collect();
        drawing.polygon(&end, &format!(r#"fill="none" stroke="{GREY}" stroke-dasharray="4 3""#));
        drawing.tool(&self.tool);
        let path = 0.6 * top;
        drawing.arrow([tip[0], path], [tip[0] + self.travel(), path], RED);
        let speed = format!(
            "v_c = {} m/min, {} mm",
            plain(self.facts.cutting_speed() * 60.0),
            plain(self.travel() * 1e3)
        );
        drawing.text([tip[0] + 0.5 * self.travel(), path], [0.0, -7.0], "middle", &speed);
        drawing.finish()
    }

    /// The surroundings of the edge.
    fn edge(&self) -> String {
        let (depth, tip) = (self.depth, self.tip());
        let radius = self.facts.edge_radius.unwrap_or(0.0);
        let width = (4.6 * depth).max(7.0 * radius);
        let x = [tip[0] - 0.36 * width, tip[0] + 0.64 * width];
        let y = [-depth - 0.25 * width, -depth + 0.45 * width];
        let mut drawing = Drawing::new(x, y, "The edge of the tool");
        let spacing = self.facts.particle_spacing;
        let distance = |p: &[f64; 2]| (p[0] - tip[0]).hypot(p[1] - tip[1]);
        let seen = |p: &&[f64; 2]| (x[0]..x[1]).contains(&p[0]) && (y[0]..y[1]).contains(&p[1]);
        let mut particles: Vec<[f64; 2]> = self.particles.iter().filter(seen).copied().collect();
        particles.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        particles.truncate(MOST_PARTICLES);
        for particle in &particles {
            drawing.dot(*particle, 0.3 * spacing, BLUE);
        }
        drawing.tool(&self.tool);
        let right = x[0] + 0.86 * width;
        drawing.line(
            [x[0], -depth],
            [x[1], -depth],
            &format!(r#"stroke="{RED}" stroke-dasharray="6 4""#),
        );
        drawing.arrow([right, -0.5 * depth], [right, 0.0], RED);
        drawing.arrow([right, -0.5 * depth], [right, -depth], RED);
        let across = |length: f64, spacing: f64| {
            format!("{} particles across", plain((length / spacing * 10.0).round() / 10.0))
        };
        let um = |length: f64| format!("{} \u{b5}m", three_digits(length * UM));
        let room = [x[0] + 0.985 * width, 0.0];
        drawing.text(room, [0.0, -24.0], "end", &format!("h = {}", um(depth)));
        drawing.text(room, [0.0, -8.0], "end", &across(depth, self.chip_spacing));
        let name = |place: f64, line: &str, drawing: &mut Drawing| {
            drawing.text([x[0] + 0.02 * width, y[1]], [0.0, place], "start", line);
        };
        if radius > 0.0 {
            name(20.0, &format!("edge radius r_n = {}", um(radius)), &mut drawing);
            name(36.0, &across(radius, spacing), &mut drawing);
            let centre = [tip[0], tip[1] + radius];
            drawing.circle(
                centre,
                radius,
                &format!(r#"fill="none" stroke="{RED}" stroke-width="1.5""#),
            );
        } else {
            name(20.0, "sharp edge", &mut drawing);
        }
        name(52.0, &format!("spacing {}", um(spacing)), &mut drawing);
        drawing.finish()
    }
}
