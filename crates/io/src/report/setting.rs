//! The setting of a scenario in a picture.

use std::fmt::Write;

use super::html::{escape, number};
use crate::scenario::schema::{Background, FluidCondition, Obstacle, Scenario, Shape};
use crate::scenario::{GivenFluidCondition, PlainFluidCondition};

/// Longest side of the domain in the picture.
const LONGEST: f64 = 420.0;
/// Room around the domain for dimensions and conditions.
const LEFT: f64 = 74.0;
const RIGHT: f64 = 86.0;
const TOP: f64 = 44.0;
const BOTTOM: f64 = 66.0;

/// A side that the scenario says nothing about.
const OPEN: FluidCondition = FluidCondition::Plain(PlainFluidCondition::Free);

/// Where points of the plane go.
struct Frame {
    low: [f64; 2],
    high: [f64; 2],
    scale: f64,
    /// What the names of parts of this picture begin with: a page has many pictures.
    id: String,
}

impl Frame {
    fn x(&self, x: f64) -> f64 {
        LEFT + (x - self.low[0]) * self.scale
    }

    fn y(&self, y: f64) -> f64 {
        TOP + (self.high[1] - y) * self.scale
    }
}

/// The setting as SVG: domain, bodies, sizes, boundary conditions. Half domains are shown completed by their mirror
/// image, with the line of symmetry. Empty unless the scenario is planar.
pub(super) fn setting(scenario: &Scenario) -> String {
    let Background::GradedBox(domain) = &scenario.background;
    let (Ok(low), Ok(high)) = (<[f64; 2]>::try_from(domain.min.clone()), <[f64; 2]>::try_from(domain.max.clone()))
    else {
        return String::new();
    };
    let condition = |side: &str| domain.boundary.get(side).unwrap_or(&OPEN);
    let is_half = *condition("left") == FluidCondition::Plain(PlainFluidCondition::Symmetry) || domain.mirrored;
    let whole_low = if is_half { [2.0 * low[0] - high[0], low[1]] } else { low };
    let scale = LONGEST / (high[0] - whole_low[0]).max(high[1] - low[1]);
    let id: String = scenario.name.chars().map(|c| if c.is_alphanumeric() { c } else { '-' }).collect();
    let frame = Frame { low: whole_low, high, scale, id };
    let (left, right, top, bottom) = (frame.x(whole_low[0]), frame.x(high[0]), frame.y(high[1]), frame.y(low[1]));
    let (width, height) = (right + RIGHT, bottom + BOTTOM);
    let mut svg = format!(
        "<svg class=\"setting\" role=\"img\" viewBox=\"0 0 {width:.0} {height:.0}\" aria-label=\"{}\">",
        escape(&description(scenario))
    );
    let id = &frame.id;
    let _ = write!(
        svg,
        "<defs><marker id=\"tip-{id}\" viewBox=\"0 0 8 8\" refX=\"7\" refY=\"4\" markerWidth=\"7\" markerHeight=\"7\" \
         orient=\"auto-start-reverse\"><path d=\"M0 0L8 4L0 8z\" class=\"ink-fill\"/></marker>\
         <pattern id=\"wall-{id}\" width=\"7\" height=\"7\" patternUnits=\"userSpaceOnUse\" \
         patternTransform=\"rotate(45)\"><line x1=\"0\" y1=\"0\" x2=\"0\" y2=\"7\" class=\"thin\"/></pattern></defs>"
    );
    let _ = write!(
        svg,
        "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{:.1}\" height=\"{:.1}\" class=\"fluid\"/>",
        right - left,
        bottom - top
    );
    bodies(&mut svg, scenario, &frame, is_half.then_some(low[0]));
    barriers(&mut svg, scenario, &frame);
    if is_half {
        let x = frame.x(low[0]);
        let _ = write!(
            svg,
            "<line x1=\"{x:.1}\" y1=\"{:.1}\" x2=\"{x:.1}\" y2=\"{bottom:.1}\" class=\"axis\"/>",
            top - 8.0
        );
        label(&mut svg, x, top - 14.0, "middle", "symmetry: one half is computed");
    }
    let middle = 0.5 * (top + bottom);
    let hatch = format!("wall-{id}");
    side(&mut svg, condition("right"), &hatch, [right, top, right, bottom]);
    side(&mut svg, condition("top"), &hatch, [left, top, right, top]);
    side(&mut svg, condition("bottom"), &hatch, [left, bottom, right, bottom]);
    side(&mut svg, condition(if is_half { "right" } else { "left" }), &hatch, [left, top, left, bottom]);
    label(&mut svg, right - 6.0, top + 16.0, "end", &format!("top: {}", words(condition("top"))));
    label(&mut svg, 0.5 * (left + right), bottom + 24.0, "middle", &format!("bottom: {}", words(condition("bottom"))));
    let _ = write!(svg, "<g transform=\"translate({:.1} {middle:.1}) rotate(90)\">", right + 12.0);
    label(&mut svg, 0.0, 0.0, "middle", &format!("sides: {}", words(condition("right"))));
    svg += "</g>";
    dimension(
        &mut svg,
        id,
        [left, bottom + 38.0, right, bottom + 38.0],
        &format!("{} cm", number(high[0] - whole_low[0])),
    );
    dimension(&mut svg, id, [left - 26.0, top, left - 26.0, bottom], &format!("{} cm", number(high[1] - low[1])));
    svg + "</svg>"
}

/// Bodies with their sizes; the gap under the first one.
fn bodies(svg: &mut String, scenario: &Scenario, frame: &Frame, mirror: Option<f64>) {
    let id = &frame.id;
    for body in &scenario.bodies {
        match &body.shape {
            Shape::Ball { centre, radius, .. } | Shape::HalfBall { centre, radius, .. } => {
                let (x, y, r) = (frame.x(centre[0]), frame.y(centre[1]), radius * frame.scale);
                let _ = write!(svg, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{r:.1}\" class=\"solid\"/>");
                let (tip_x, tip_y) = (x + 0.8 * r, y - 0.6 * r);
                let _ = write!(
                    svg,
                    "<line x1=\"{x:.1}\" y1=\"{y:.1}\" x2=\"{tip_x:.1}\" y2=\"{tip_y:.1}\" class=\"line\" \
                     marker-end=\"url(#tip-{id})\"/><circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2\" class=\"ink-fill\"/>"
                );
                label(svg, x + 0.72 * r, y - 0.72 * r, "start", &format!("r = {} cm", number(*radius)));
                let centre_text = format!("({}, {})", number(centre[0]), number(centre[1]));
                label(svg, x + 6.0, y + 15.0, "start", &centre_text);
                label(svg, x - 0.45 * r, y + 5.0, "middle", &body.name);
                gravity(svg, id, body.gravity.as_deref().unwrap_or_default(), x - 1.2 * r - 44.0, y - 12.0);
                let bottom = frame.y(centre[1] - radius);
                let floor = floor_below(scenario, frame, centre[1] - radius);
                let gap = (floor - bottom) / frame.scale;
                dimension(svg, id, [x, bottom, x, floor], &format!("gap {} cm", number((1e6 * gap).round() / 1e6)));
            }
            Shape::Box { min, max, .. } => {
                let low = mirror.map_or(min[0], |plane| min[0].min(2.0 * plane - max[0]));
                let (x, y) = (frame.x(low), frame.y(max[1]));
                let (w, h) = ((max[0] - low) * frame.scale, ((max[1] - min[1]) * frame.scale).max(2.0));
                let _ =
                    write!(svg, "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{w:.1}\" height=\"{h:.1}\" class=\"solid\"/>");
                let size = format!("{}: {} cm × {} cm", body.name, number(max[0] - low), number(max[1] - min[1]));
                label(svg, x + 6.0, y - 6.0, "start", &size);
            }
        }
    }
}

/// The height on the picture of what lies under a point: the highest box below it, else the bottom.
fn floor_below(scenario: &Scenario, frame: &Frame, y: f64) -> f64 {
    let tops = scenario.bodies.iter().filter_map(|body| match &body.shape {
        Shape::Box { max, .. } if max[1] <= y => Some(max[1]),
        _ => None,
    });
    frame.y(tops.fold(frame.low[1], f64::max))
}

fn gravity(svg: &mut String, id: &str, gravity: &[f64], x: f64, y: f64) {
    let size = gravity.iter().map(|g| g * g).sum::<f64>().sqrt();
    if size > 0.0 {
        let _ = write!(
            svg,
            "<line x1=\"{x:.1}\" y1=\"{y:.1}\" x2=\"{x:.1}\" y2=\"{:.1}\" class=\"line\" marker-end=\"url(#tip-{id})\"/>",
            y + 24.0
        );
        label(svg, x, y + 40.0, "middle", &format!("g = {} cm/s²", number(size)));
    }
}

/// Heights at which contact with a horizontal plane begins, where they can be told from the plane.
fn barriers(svg: &mut String, scenario: &Scenario, frame: &Frame) {
    for contact in &scenario.contacts {
        let Obstacle::RigidPlane { point, normal } = &contact.obstacle else { continue };
        if contact.offset * frame.scale < 6.0 || normal[0] != 0.0 {
            continue;
        }
        let y = frame.y(point[1] - contact.offset * normal[1].signum());
        let (left, right) = (frame.x(frame.low[0]), frame.x(frame.high[0]));
        let _ = write!(svg, "<line x1=\"{left:.1}\" y1=\"{y:.1}\" x2=\"{right:.1}\" y2=\"{y:.1}\" class=\"barrier\"/>");
        let text = format!("barrier at {} cm", number(contact.offset));
        label(svg, left + 6.0, y - 6.0, "start", &text);
    }
}

/// A side of the domain: hatched if the fluid sticks to it, dashed if it is open.
fn side(svg: &mut String, condition: &FluidCondition, hatch: &str, [x1, y1, x2, y2]: [f64; 4]) {
    let class = if *condition == OPEN { "open" } else { "wall" };
    let _ = write!(svg, "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" class=\"{class}\"/>");
    if *condition == FluidCondition::Plain(PlainFluidCondition::NoSlip) && y1 == y2 {
        let _ = write!(
            svg,
            "<rect x=\"{x1:.1}\" y=\"{y1:.1}\" width=\"{:.1}\" height=\"8\" fill=\"url(#{hatch})\"/>",
            x2 - x1
        );
    }
}

fn label(svg: &mut String, x: f64, y: f64, anchor: &str, text: &str) {
    let _ = write!(svg, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{}</text>", escape(text));
}

/// A length between two points with arrows at both ends.
fn dimension(svg: &mut String, id: &str, [x1, y1, x2, y2]: [f64; 4], text: &str) {
    let _ = write!(
        svg,
        "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" class=\"line\" marker-start=\"url(#tip-{id})\" \
         marker-end=\"url(#tip-{id})\"/>"
    );
    if y1 == y2 {
        label(svg, 0.5 * (x1 + x2), y1 + 16.0, "middle", text);
    } else if (y2 - y1).abs() > 120.0 {
        let _ = write!(svg, "<g transform=\"translate({:.1} {:.1}) rotate(-90)\">", x1 - 7.0, 0.5 * (y1 + y2));
        label(svg, 0.0, 0.0, "middle", text);
        *svg += "</g>";
    } else {
        label(svg, x1 + 8.0, 0.5 * (y1 + y2) + 4.0, "start", text);
    }
}

/// A condition in words.
fn words(condition: &FluidCondition) -> String {
    match condition {
        FluidCondition::Plain(PlainFluidCondition::NoSlip) => "u = 0".to_owned(),
        FluidCondition::Plain(PlainFluidCondition::Symmetry) => "u·n = 0".to_owned(),
        FluidCondition::Plain(PlainFluidCondition::Free) => "no traction".to_owned(),
        FluidCondition::Given(GivenFluidCondition::Velocity { value }) => format!("u = {value:?}"),
        FluidCondition::Given(GivenFluidCondition::Inflow { maximum, .. }) => format!("inflow up to {maximum} cm/s"),
        FluidCondition::Given(GivenFluidCondition::Traction { value }) => format!("traction {value:?}"),
        FluidCondition::Given(GivenFluidCondition::Pressure { value }) => format!("pressure {value}"),
    }
}

/// The setting in words.
fn description(scenario: &Scenario) -> String {
    let Background::GradedBox(domain) = &scenario.background;
    let bodies: Vec<String> = scenario
        .bodies
        .iter()
        .map(|body| match &body.shape {
            Shape::Ball { centre, radius, .. } | Shape::HalfBall { centre, radius, .. } => {
                format!("{}: a disk of radius {radius} cm with centre {centre:?}", body.name)
            }
            Shape::Box { min, max, .. } => format!("{}: a box from {min:?} to {max:?}", body.name),
        })
        .collect();
    format!("Setting: a fluid domain from {:?} to {:?} cm; {}", domain.min, domain.max, bodies.join("; "))
}
