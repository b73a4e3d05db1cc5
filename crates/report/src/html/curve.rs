//! Charts of two functions over an input.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::charts::{Area, BAD, Drawn, GOOD, INK, LINE, QUIET, text, tick};
use engine::compare::{Curve, Point};

/// What is drawn of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Over {
    /// Both values.
    Values,
    /// First minus second.
    Difference,
    /// Both bounds in ULP.
    Bounds,
}

impl Over {
    pub const ALL: [Self; 3] = [Self::Values, Self::Difference, Self::Bounds];

    /// In the names of files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Values => "values",
            Self::Difference => "difference",
            Self::Bounds => "bounds",
        }
    }
}

/// A line of a chart: a name, a colour, how wide it is, and its points; NaN where there is none.
type Line<'a> = (&'a str, RGBColor, f64, Vec<(f64, f64)>);

/// Values beyond what so many parts of the points have are cut off: a pole would leave no room for the rest.
const SHOWN: f64 = 0.98;

pub(super) fn draw<B: DrawingBackend>(root: &Area<'_, B>, curve: &Curve, over: Over, scale: f64) -> Drawn<B> {
    let line = |of: &dyn Fn(&Point) -> f64| -> Vec<(f64, f64)> { curve.points.iter().map(|p| (p.at, of(p))).collect() };
    let bound = |side: usize| line(&|p| p.bounds[side].unwrap_or(f64::NAN).max(SMALLEST_BOUND).log2());
    let (lines, unit): (Vec<Line<'_>>, String) = match over {
        Over::Values => (
            vec![("first", GOOD, 4.0, line(&|p| p.values[0])), ("second", INK, 1.5, line(&|p| p.values[1]))],
            curve.output.clone(),
        ),
        Over::Difference => (
            vec![("first − second", BAD, 2.0, line(&|p| p.values[0] - p.values[1]))],
            format!("difference of {}", curve.output),
        ),
        Over::Bounds => {
            let known = |line: Vec<(f64, f64)>, side: usize| -> Vec<(f64, f64)> {
                let points = line.into_iter().zip(&curve.points);
                points.map(|((at, y), p)| (at, if p.bounds[side].is_some() { y } else { f64::NAN })).collect()
            };
            let (first, second) = (known(bound(0), 0), known(bound(1), 1));
            (vec![("first", GOOD, 4.0, first), ("second", INK, 1.5, second)], "allowed error, in ULP".to_owned())
        }
    };
    let px = |n: f64| (n * scale) as u32;
    let (left, right) = (curve.points.first().map_or(0.0, |p| p.at), curve.points.last().map_or(1.0, |p| p.at));
    let range = height(lines.iter().flat_map(|(.., points)| points.iter().map(|(_, y)| *y)));
    // Bounds that hardly differ are not drawn as if they did.
    let range =
        if over == Over::Bounds { range.start.min(range.end - 1.0)..range.end.max(range.start + 1.0) } else { range };
    let mut chart = ChartBuilder::on(root)
        .margin(px(10.0))
        .margin_right(px(22.0))
        .margin_top(px(24.0))
        .x_label_area_size(px(40.0))
        .y_label_area_size(px(74.0))
        .build_cartesian_2d(left..right, range.clone())?;
    let shown = |y: &f64| if over == Over::Bounds { of_power(*y) } else { tick(*y, range.end - range.start) };
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(LINE)
        .axis_style(QUIET)
        .x_labels(8)
        .y_labels(7)
        .x_label_formatter(&|x| tick(*x, right - left))
        .y_label_formatter(&shown)
        .label_style(text(scale, QUIET))
        .axis_desc_style(text(scale, INK))
        .x_desc(curve.input.as_str())
        .y_desc(unit)
        .draw()?;
    for (_, color, wide, points) in &lines {
        let inside = |(_, y): &(f64, f64)| y.is_finite() && range.contains(y);
        for part in points.split(|point| !inside(point)).filter(|part| !part.is_empty()) {
            let style = color.stroke_width(px(*wide).max(1));
            chart.draw_series(std::iter::once(PathElement::new(part.to_vec(), style)))?;
        }
    }
    let mut x = 10.0 * scale + 80.0 * scale;
    for (name, color, ..) in &lines {
        let style = text(scale, *color).pos(Pos::new(HPos::Left, VPos::Top));
        root.draw_text(name, &style, (x as i32, (6.0 * scale) as i32))?;
        x += (name.chars().count() as f64 * 8.0 + 20.0) * scale;
    }
    Ok(())
}

/// Exact results have a bound of 0, which has no place on a logarithmic axis.
const SMALLEST_BOUND: f64 = 1.0 / 64.0;

/// From where to where values go, with some room; without the few that are far away.
fn height(values: impl Iterator<Item = f64>) -> std::ops::Range<f64> {
    let mut all: Vec<f64> = values.filter(|y| y.is_finite()).collect();
    all.sort_by(f64::total_cmp);
    let (Some(&least), Some(&most)) = (all.first(), all.last()) else { return 0.0..1.0 };
    let cut = (all.len() as f64 * (1.0 - SHOWN)) as usize;
    let (low, high) = (all[cut], all[all.len() - 1 - cut]);
    let room = high - low;
    // What lies near to the rest is no pole.
    let low = if low - least > 2.0 * room { low } else { least };
    let high = if most - high > 2.0 * room { high } else { most };
    let room = if high > low { (high - low) * 0.06 } else { low.abs().max(1.0) * 0.5 };
    low - room..high + room
}

/// A power of two on an axis.
fn of_power(exponent: f64) -> String {
    tick(exponent.exp2(), 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pole_leaves_room_for_the_rest() {
        let values = (0..200).map(|k| 1.0 + f64::from(k % 10)).chain([1e9, f64::NAN]);
        assert!(height(values).end < 20.0);
        assert!(height((0..10).map(f64::from)).contains(&9.0));
        assert!(height(std::iter::repeat_n(3.0, 5)).contains(&3.0));
        assert_eq!(height(std::iter::empty()), 0.0..1.0);
    }
}
