//! Charts of errors: drawn once by `plotters`, as SVG for the page and as pixels for files.

use maud::html;
use plotters::coord::Shift;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::curve::Over;
use super::raster::Raster;
use engine::compare::Curve;
use engine::suite::run::{Errors, LARGEST, SMALLEST, Scene, State};

/// Colours of the light page. In the page each becomes a variable of the style sheet.
pub(super) const INK: RGBColor = RGBColor(0x1d, 0x23, 0x2b);
pub(super) const QUIET: RGBColor = RGBColor(0x5b, 0x66, 0x74);
pub(super) const LINE: RGBColor = RGBColor(0xdd, 0xe2, 0xe8);
pub(super) const GOOD: RGBColor = RGBColor(0x2f, 0x6d, 0xb5);
const OPEN: RGBColor = RGBColor(0x9a, 0xa4, 0xb0);
pub(super) const BAD: RGBColor = RGBColor(0xc6, 0x2f, 0x2f);

/// The same colours with their names in the style sheet.
const NAMES: [(RGBColor, &str); 6] =
    [(INK, "ink"), (QUIET, "quiet"), (LINE, "line"), (GOOD, "good"), (OPEN, "open"), (BAD, "bad")];

/// A chart that can be drawn anywhere.
#[derive(Clone, Copy)]
pub(super) enum Chart<'a> {
    /// How many words have which error.
    Errors(&'a Errors),
    /// Errors beside their bounds.
    Bounds(&'a Errors),
    /// Errors beside their bounds over the places of a frame.
    Map(&'a Scene, usize),
    /// Two functions over an input.
    Curve(&'a Curve, Over),
}

impl Chart<'_> {
    /// As SVG with the colours of the page: variables, and the light colour where there is none.
    pub fn svg(&self, title: &str) -> String {
        let mut text = String::new();
        let (width, height) = self.size();
        // Writing to a text does not fail; what cannot be drawn leaves an empty chart.
        let _ = self.draw(&SVGBackend::with_string(&mut text, (width, height)).into_drawing_area(), 1.0);
        for (color, name) in NAMES {
            let hex = format!("#{:02X}{:02X}{:02X}", color.0, color.1, color.2);
            text = text.replace(&format!("\"{hex}\""), &format!("\"var(--{name},{})\"", hex.to_lowercase()));
        }
        let title = html! { (title) }.into_string();
        text.replacen("<svg ", &format!("<svg role=\"img\" aria-label=\"{title}\" "), 1)
    }

    /// As pixels.
    ///
    /// # Errors
    /// What the encoder says.
    pub fn png(&self) -> Result<Vec<u8>, String> {
        const SCALE: f64 = 1.5;
        let (width, height) = self.size();
        let size = (f64::from(width) * SCALE) as u32;
        let mut raster = Raster::new(size, (f64::from(height) * SCALE) as u32);
        let _ = self.draw(&(&mut raster).into_drawing_area(), SCALE);
        raster.encode().map_err(|error| error.to_string())
    }

    fn size(&self) -> (u32, u32) {
        match self {
            Self::Errors(_) => (560, 250),
            Self::Bounds(_) => (420, 330),
            Self::Map(..) => (560, 420),
            Self::Curve(..) => (560, 300),
        }
    }

    fn draw<B: DrawingBackend>(&self, root: &Area<'_, B>, scale: f64) -> Drawn<B> {
        match self {
            Self::Errors(errors) => draw_errors(root, errors, scale),
            Self::Bounds(errors) => draw_bounds(root, errors, scale),
            Self::Map(scene, frame) => draw_map(root, scene, *frame, scale),
            Self::Curve(curve, over) => super::curve::draw(root, curve, *over, scale),
        }
    }
}

pub(super) type Area<'a, B> = DrawingArea<B, Shift>;
pub(super) type Drawn<B> = Result<(), DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>>;

/// Steps of whole numbers, with a label for every so many.
struct Steps {
    from: f64,
    to: f64,
}

impl Ranged for Steps {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        let part = (value - self.from) / (self.to - self.from);
        limit.0 + (part * f64::from(limit.1 - limit.0)).round() as i32
    }

    fn key_points<H: KeyPointHint>(&self, hint: H) -> Vec<f64> {
        let count = (self.to - self.from).max(1.0);
        let step = (count / hint.max_num_points().max(1) as f64).ceil().max(1.0);
        let first = (self.from / step).ceil() as i64;
        (first..).map(|k| k as f64 * step).take_while(|at| *at <= self.to).collect()
    }

    fn range(&self) -> std::ops::Range<f64> {
        self.from..self.to
    }
}

impl ValueFormatter<f64> for Steps {
    fn format(value: &f64) -> String {
        power(*value as i32)
    }
}

/// A power of two as people read it.
pub(super) fn power(exponent: i32) -> String {
    match exponent {
        0..=10 => (1_u32 << exponent).to_string(),
        -6..0 => format!("1/{}", 1_u32 << -exponent),
        _ => format!("2^{exponent}"),
    }
}

pub(super) fn text(scale: f64, color: RGBColor) -> TextStyle<'static> {
    ("sans-serif", 12.0 * scale).into_font().color(&color)
}

fn draw_errors<B: DrawingBackend>(root: &Area<'_, B>, errors: &Errors, scale: f64) -> Drawn<B> {
    let px = |n: f64| (n * scale) as u32;
    let first = errors.by_error.keys().next().copied().unwrap_or(0).min(-3);
    let last = errors.by_error.keys().last().copied().unwrap_or(0).max(2);
    let [exact, lost] = [f64::from(first) - 1.6, f64::from(last) + 1.6];
    // Words by part, on their place.
    let mut bars: Vec<(f64, [u64; 3])> = vec![(exact, errors.exact)];
    bars.extend(errors.by_error.iter().map(|(exponent, counts)| (f64::from(*exponent), *counts)));
    bars.push((lost, [0, 0, errors.lost]));
    let most = bars.iter().flat_map(|(_, counts)| counts).copied().max().unwrap_or(0).max(10);
    let steps = Steps { from: exact - 0.4, to: if errors.lost > 0 { lost + 1.2 } else { f64::from(last) + 1.2 } };
    let mut chart = ChartBuilder::on(root)
        .margin(px(10.0))
        .x_label_area_size(px(40.0))
        .y_label_area_size(px(58.0))
        .build_cartesian_2d(steps, (0.6..most as f64 * 1.6).log_scale())?;
    let shown = move |at: &f64| {
        if *at < f64::from(first) - 0.5 || *at > f64::from(last) + 1.0 { String::new() } else { power(*at as i32) }
    };
    chart
        .configure_mesh()
        .disable_x_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(LINE)
        .axis_style(QUIET)
        .x_labels(14)
        .y_labels(6)
        .x_label_formatter(&shown)
        .y_label_formatter(&|count| if *count < 1.0 { String::new() } else { format!("{count:.0}") })
        .label_style(text(scale, QUIET))
        .axis_desc_style(text(scale, INK))
        .x_desc("error, in ULP of the variable")
        .y_desc("output words")
        .draw()?;
    let kinds: Vec<usize> = (0..3).filter(|&k| bars.iter().any(|(_, counts)| counts[k] > 0)).collect();
    let wide = 0.9 / kinds.len().max(1) as f64;
    for (at, counts) in &bars {
        for (place, &kind) in kinds.iter().enumerate() {
            if counts[kind] > 0 {
                let left = at + 0.05 + place as f64 * wide;
                let color = [GOOD, OPEN, BAD][kind];
                let bar = [(left, 0.6), (left + wide, counts[kind] as f64)];
                chart.draw_series(std::iter::once(Rectangle::new(bar, color.filled())))?;
            }
        }
    }
    // Below the axis, beside the numbers.
    let (width, height) = root.dim_in_pixel();
    let left = 10.0 * scale + 58.0 * scale;
    let room = f64::from(width) - left - 10.0 * scale;
    let range = if errors.lost > 0 { lost + 1.2 } else { f64::from(last) + 1.2 } - (exact - 0.4);
    let x = |at: f64| (left + (at + 0.5 - (exact - 0.4)) / range * room) as i32;
    let style = text(scale, QUIET).pos(Pos::new(HPos::Center, VPos::Top));
    let y = f64::from(height) - 46.0 * scale;
    root.draw_text("exact", &style, (x(exact), y as i32))?;
    if errors.lost > 0 {
        root.draw_text("NaN", &style.color(&BAD), (x(lost), y as i32))?;
    }
    Ok(())
}

fn draw_bounds<B: DrawingBackend>(root: &Area<'_, B>, errors: &Errors, scale: f64) -> Drawn<B> {
    let px = |n: f64| (n * scale) as u32;
    let ends = |of: &dyn Fn(&(i32, i32)) -> i32, usual: (i32, i32)| {
        let all = errors.by_bound.keys().map(of);
        let (lo, hi) = (all.clone().min().unwrap_or(usual.0), all.max().unwrap_or(usual.1));
        (lo.min(usual.0).max(SMALLEST), hi.max(usual.1).min(LARGEST))
    };
    let (x, y) = (ends(&|key| key.0, (-1, 3)), ends(&|key| key.1, (-4, 3)));
    let steps = |(lo, hi): (i32, i32)| Steps { from: f64::from(lo), to: f64::from(hi + 1) };
    let mut chart = ChartBuilder::on(root)
        .margin(px(10.0))
        .margin_right(px(22.0))
        .x_label_area_size(px(40.0))
        .y_label_area_size(px(58.0))
        .build_cartesian_2d(steps(x), steps(y))?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(LINE)
        .axis_style(QUIET)
        .x_labels(8)
        .y_labels(10)
        .label_style(text(scale, QUIET))
        .axis_desc_style(text(scale, INK))
        .x_desc("allowed error, in ULP")
        .y_desc("error, in ULP")
        .draw()?;
    let most = errors.by_bound.values().copied().max().unwrap_or(1) as f64;
    for (&(bound, error), &count) in &errors.by_bound {
        let strength = 0.18 + 0.82 * (count as f64).ln_1p() / most.ln_1p();
        let color = if error > bound { BAD } else { GOOD };
        let [left, low] = [bound, error].map(f64::from);
        let cell = [(left + 0.03, low + 0.03), (left + 0.97, low + 0.97)];
        chart.draw_series(std::iter::once(Rectangle::new(cell, color.mix(strength).filled())))?;
    }
    let (from, to) = (f64::from(x.0.max(y.0)), f64::from((x.1 + 1).min(y.1 + 1)));
    if from < to {
        let line = PathElement::new(vec![(from, from), (to, to)], INK.stroke_width(px(1.5).max(1)));
        chart.draw_series(std::iter::once(line))?;
        let style = text(scale, INK).pos(Pos::new(HPos::Right, VPos::Bottom));
        let label = EmptyElement::at((to - 0.1, to - 0.2)) + Text::new("bound ", (-(6.0 * scale) as i32, 0), style);
        chart.draw_series(std::iter::once(label))?;
    }
    Ok(())
}

/// Colour of a place by the error as a part of its bound: from nothing to all of it in ten halvings.
fn heat(ratio: f64) -> RGBColor {
    if ratio > 1.0 {
        return BAD;
    }
    let part = if ratio > 0.0 { (1.0 + ratio.log2() / 10.0).clamp(0.0, 1.0) } else { 0.0 };
    let mix = |from: u8, to: u8| (f64::from(from) + (f64::from(to) - f64::from(from)) * part).round() as u8;
    RGBColor(mix(0xea, 0x1f), mix(0xf0, 0x4f), mix(0xf6, 0x93))
}

fn draw_map<B: DrawingBackend>(root: &Area<'_, B>, scene: &Scene, frame: usize, scale: f64) -> Drawn<B> {
    let px = |n: f64| (n * scale) as u32;
    let [across, up] = &scene.axes;
    let (columns, rows) = (across.count, up.count);
    let range = |axis: &engine::suite::run::Axis| axis.range[0]..axis.range[1];
    let mut chart = ChartBuilder::on(root)
        .margin(px(10.0))
        .x_label_area_size(px(40.0))
        .y_label_area_size(px(58.0))
        .build_cartesian_2d(range(across), range(up))?;
    chart
        .configure_mesh()
        .disable_mesh()
        .axis_style(QUIET)
        .x_label_formatter(&|x| tick(*x, across.range[1] - across.range[0]))
        .y_label_formatter(&|y| tick(*y, up.range[1] - up.range[0]))
        .label_style(text(scale, QUIET))
        .axis_desc_style(text(scale, INK))
        .x_desc(across.name.as_str())
        .y_desc(up.name.as_str())
        .draw()?;
    let [wide, high] = [across, up].map(|axis| (axis.range[1] - axis.range[0]) / axis.count as f64);
    for row in 0..rows {
        for column in 0..columns {
            let Some(cell) = scene.cells.get((frame * rows + row) * columns + column) else { continue };
            let color = match cell.state {
                State::Nothing => continue,
                State::Deviates(_) => BAD,
                State::Undetermined(_) => OPEN,
                State::Agrees => heat(cell.ratio),
            };
            let (x, y) = (across.range[0] + wide * column as f64, up.range[0] + high * row as f64);
            chart.draw_series(std::iter::once(Rectangle::new([(x, y), (x + wide, y + high)], color.filled())))?;
        }
    }
    Ok(())
}

/// A number on an axis of this length. Places of ticks are sums of steps: what is left of one where the others cancel is 0.
pub(super) fn tick(value: f64, length: f64) -> String {
    let value = if value.abs() < length.abs() * 1e-9 { 0.0 } else { value };
    if value == 0.0 || (1e-3..1e5).contains(&value.abs()) {
        let text = format!("{value:.4}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        format!("{value:.1e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_on_axes_are_short_and_zero_is_zero() {
        assert_eq!([0.25, 0.0, 3.0, 1e7].map(|value| tick(value, 1.0)), ["0.25", "0", "3", "1.0e7"]);
        assert_eq!(tick(0.6 - 0.2 * 3.0, 2.0), "0");
        assert_eq!(tick(-5.6e-17, 1.6), "0");
        // On an axis of such numbers it is one of them.
        assert_eq!(tick(-5.6e-17, 1e-15), "-5.6e-17");
    }

    fn errors() -> Errors {
        let mut errors = Errors { samples: 10, words: 40, exact: [20, 3, 0], lost: 1, ..Errors::default() };
        errors.by_error.extend([(-2, [12, 0, 0]), (1, [3, 2, 1])]);
        errors.by_bound.extend([((1, -2), 12), ((2, 1), 3), ((0, 4), 1)]);
        errors
    }

    #[test]
    fn charts_have_axes_with_units_and_the_colours_of_the_page() {
        let errors = errors();
        let svg = Chart::Errors(&errors).svg("errors of <b>");
        for part in [
            "error, in ULP of the variable",
            "output words",
            "exact",
            "NaN",
            "var(--bad,#c62f2f)",
            "errors of &lt;b&gt;",
        ] {
            assert!(svg.contains(part), "{part}\n{svg}");
        }
        let svg = Chart::Bounds(&errors).svg("bounds");
        assert_eq!(svg.matches("var(--bad,").count(), 1, "one cell lies beyond its bound\n{svg}");
        assert!(svg.contains("allowed error, in ULP"));
    }

    #[test]
    fn pictures_in_pixels_are_not_empty() {
        let errors = errors();
        let bytes = Chart::Errors(&errors).png().unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        let has = |color: RGBColor| pixels.chunks(3).filter(|p| **p == [color.0, color.1, color.2]).count();
        assert!(has(GOOD) > 500 && has(BAD) > 20 && has(QUIET) > 100, "{} {} {}", has(GOOD), has(BAD), has(QUIET));
    }

    #[test]
    fn powers_are_read_without_a_calculator() {
        assert_eq!([-9, -3, 0, 10, 20].map(power), ["2^-9", "1/8", "1", "1024", "2^20"]);
    }
}
