//! How far an output may be off: half a step of its format, half a pixel, or what is stated.

use serde::{Deserialize, Serialize};

use base::value::{Field, Record};
use program::DISCARD;
use syntax::Stage;

/// How far one output may be off.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Tolerance {
    /// By so much.
    Absolute(#[serde(with = "crate::bits")] f64),
    /// By so much, between 0 and 1: what is stored there cuts off the rest.
    Unit(#[serde(with = "crate::bits")] f64),
    /// By this part of its size.
    Relative(#[serde(with = "crate::bits")] f64),
    /// By half a pixel of a viewport of so many, within the clip volume.
    Pixels(#[serde(with = "crate::bits")] [f64; 2]),
}

/// Formats by name, each with half of its step.
const FORMATS: [(&str, Tolerance); 12] = [
    ("rgba8", Tolerance::Unit(0.5 / 255.0)),
    ("rgb8", Tolerance::Unit(0.5 / 255.0)),
    ("rg8", Tolerance::Unit(0.5 / 255.0)),
    ("r8", Tolerance::Unit(0.5 / 255.0)),
    ("rgba4", Tolerance::Unit(0.5 / 15.0)),
    ("rgb565", Tolerance::Unit(0.5 / 63.0)),
    ("rgb10_a2", Tolerance::Unit(0.5 / 1023.0)),
    ("rgba16", Tolerance::Unit(0.5 / 65535.0)),
    ("r11f_g11f_b10f", Tolerance::Relative(1.0 / 128.0)),
    ("rgba16f", Tolerance::Relative(1.0 / 2048.0)),
    ("rg16f", Tolerance::Relative(1.0 / 2048.0)),
    ("r16f", Tolerance::Relative(1.0 / 2048.0)),
];

impl Tolerance {
    /// Half a step of a format.
    ///
    /// # Errors
    /// For a name that is no format, with those that are.
    pub fn of_format(name: &str) -> Result<Self, String> {
        if name.ends_with("32f") {
            return Err(format!("`{name}` has the step of `highp` itself: state what may be lost with --error"));
        }
        FORMATS
            .iter()
            .find(|(known, _)| *known == name)
            .map(|(_, tolerance)| *tolerance)
            .ok_or_else(|| base::did_you_mean(name, FORMATS.iter().map(|(known, _)| *known), "there are:"))
    }

    /// The error of `found` in units of what is allowed; `size` is that of the output.
    pub fn ratio(self, wide: f32, found: f32) -> f64 {
        let (wide, found) = (f64::from(wide), f64::from(found));
        if !found.is_finite() {
            return f64::INFINITY;
        }
        match self {
            Self::Absolute(limit) => (wide - found).abs() / limit,
            Self::Unit(limit) => (wide.clamp(0.0, 1.0) - found.clamp(0.0, 1.0)).abs() / limit,
            // Smaller numbers have the step of the smallest normal one.
            Self::Relative(limit) => (wide - found).abs() / (limit * wide.abs().max(1.0 / 16384.0)),
            // A coordinate of a position counts beside the others.
            Self::Pixels(_) => 0.0,
        }
    }

    /// The error of a clip position in half pixels; none for one outside of the clip volume.
    pub fn of_position(viewport: [f64; 2], wide: [f32; 4], found: [f32; 4]) -> f64 {
        let [wide, found] = [wide, found].map(|p| p.map(f64::from));
        let inside = |p: f64| p.abs() <= wide[3];
        if wide[3] <= 0.0 || !inside(wide[0]) || !inside(wide[1]) {
            return 0.0;
        }
        if !found.iter().all(|x| x.is_finite()) || found[3] <= 0.0 {
            return f64::INFINITY;
        }
        let pixels = |k: usize| (wide[k] / wide[3] - found[k] / found[3]).abs() * viewport[k] / 2.0;
        2.0 * pixels(0).max(pixels(1))
    }
}

/// What is stated of outputs.
#[derive(Clone, Debug, Default)]
pub struct Stated {
    /// By the name of the output; for all others without one.
    pub named: Vec<(Option<String>, Tolerance)>,
    /// Width and height, in pixels.
    pub viewport: Option<[f64; 2]>,
}

impl Stated {
    /// The tolerance of each output field.
    ///
    /// # Errors
    /// For an output of which no format is known, with what to state.
    pub fn of(&self, record: &Record, stage: Stage) -> Result<Vec<Tolerance>, String> {
        let one = |field: &Field| {
            let named = |name: Option<&str>| {
                let found = self.named.iter().rev().find(|(known, _)| known.as_deref() == name);
                found.map(|(_, tolerance)| *tolerance)
            };
            let root = field.name.split(['.', '[']).next().unwrap_or(&field.name);
            let by_stage = || match (stage, root) {
                (_, DISCARD) => Some(Tolerance::Absolute(1.0)),
                (Stage::Vertex, "gl_Position") => self.viewport.map(Tolerance::Pixels),
                _ => None,
            };
            let colour = || match (stage, root) {
                (Stage::Fragment, "gl_FragDepth" | "gl_FragDepthEXT") => None,
                (Stage::Fragment, _) => Some(Tolerance::Unit(0.5 / 255.0)),
                _ => None,
            };
            let found = named(Some(&field.name)).or_else(|| named(Some(root))).or_else(by_stage);
            found.or_else(|| named(None)).or_else(colour).ok_or_else(|| {
                let name = &field.name;
                let position = root == "gl_Position";
                let first = if position { "its viewport with --viewport 1920x1080, or " } else { "" };
                format!("output `{name}` has no format that is known: state {first}what may be lost with --error {name}=0.001")
            })
        };
        let known = |name: &str| {
            record.fields().iter().any(|field| field.name.split(['.', '[']).next() == Some(name) || field.name == name)
        };
        for name in self.named.iter().filter_map(|(name, _)| name.as_deref()) {
            if !known(name) {
                let all = record.fields().iter().map(|field| field.name.as_str()).filter(|name| *name != DISCARD);
                return Err(format!("there is no output `{name}`; {}", base::did_you_mean(name, all, "there are:")));
            }
        }
        record.fields().iter().map(one).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_a_step_is_the_limit_and_what_is_cut_off_does_not_count() {
        let eight = Tolerance::of_format("rgba8").unwrap();
        assert!((eight.ratio(0.5, 0.5 + 0.5 / 255.0) - 1.0).abs() < 1e-4);
        assert_eq!((eight.ratio(5.0, 7.0), eight.ratio(0.0, f32::NAN)), (0.0, f64::INFINITY));
        assert!(Tolerance::of_format("rgba9").unwrap_err().contains("rgba8"));
        assert!(Tolerance::of_format("rgba32f").unwrap_err().contains("--error"));
    }

    #[test]
    fn positions_are_off_by_pixels_of_the_viewport() {
        let of = |x: f32| Tolerance::of_position([100.0, 100.0], [0.5, 0.0, 0.0, 1.0], [x, 0.0, 0.0, 1.0]);
        assert!((of(0.51) - 1.0).abs() < 1e-4, "half a pixel: {}", of(0.51));
        assert_eq!(Tolerance::of_position([100.0; 2], [2.0, 0.0, 0.0, 1.0], [9.0, 0.0, 0.0, 1.0]), 0.0);
        assert_eq!(of(f32::NAN), f64::INFINITY);
    }
}
