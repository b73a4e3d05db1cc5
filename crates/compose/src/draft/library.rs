//! What drafts had with other types or in another form, and cannot be told by one token.

use std::collections::HashMap;

use base::text::{SourceFile, Span};
use syntax::Shader;

use super::Pass;

/// True for what a type begins with that can pass between stages.
fn is_type(word: &str) -> bool {
    matches!(word, "f32" | "i32" | "u32" | "vec2" | "vec3" | "vec4")
}

impl Pass<'_> {
    /// What has another type or form today and cannot be told from the text alone: done where something else shows
    /// that the text is a draft.
    pub(super) fn library(&mut self) {
        // `type` is younger than the sizes of textures in `u32`.
        if self.kinds.iter().all(|kind| *kind == "`type` is `alias`") {
            return;
        }
        self.entry_points();
        for at in 0..self.tokens.len() {
            if self.word(at + 1) != "(" || self.is_own(self.word(at)) {
                continue;
            }
            let close = self.behind[at + 1] - 1;
            let name = self.tokens[at].span;
            let integer = match self.word(at) {
                "textureDimensions" => self.dimensions(at + 2),
                "textureNumLayers" | "textureNumLevels" | "textureNumSamples" => Some("i32"),
                "arrayLength" if !matches!(self.word(at + 2), "&" | "(") && self.word(at + 3) != ")" => {
                    let to = Span::at(self.tokens[at + 2].span.start);
                    self.change(to, "&", "`arrayLength` takes a pointer");
                    None
                }
                // A buffer cannot be loaded as a whole, and nothing needs to be done with its name.
                "ignore" if matches!(self.word(at.wrapping_sub(1)), ";" | "{" | "}") => {
                    let (span, to) = if close == at + 3 { (self.span(at, close + 1), "") } else { (name, "_ = ") };
                    self.change(span, to, "`ignore(x)` is `_ = (x)`");
                    None
                }
                "location" => {
                    self.flat(at);
                    None
                }
                _ => None,
            };
            if let Some(integer) = integer.filter(|_| self.word(close) == ")") {
                let kind = "sizes of textures are signed";
                self.change(Span::at(name.start), format!("{integer}("), kind);
                self.change(Span::at(self.tokens[close].span.end), ")", kind);
            }
        }
    }

    /// Integers were never interpolated, and had not to say so.
    fn flat(&mut self, location: usize) {
        let mut at = self.behind[location + 1];
        // What else stands between the attribute and the type, in either notation.
        let between = |word: &str| matches!(word, "]" | "[" | "@" | "," | ":" | "(" | ")");
        let is_name = |at: usize| self.word(at + 1) == ":" || between(self.word(at.saturating_sub(1)));
        let within = at + 24;
        while at < within && (between(self.word(at)) || is_name(at)) && !is_type(self.word(at)) {
            if self.word(at) == "interpolate" {
                return;
            }
            at += 1;
        }
        let integer = |word: &str| matches!(word, "i32" | "u32");
        let is_integer = match self.word(at) {
            "vec2" | "vec3" | "vec4" => integer(self.word(at + 2)),
            word => integer(word),
        };
        if is_integer {
            let end = self.tokens[self.behind[location + 1] - 1].span.end;
            self.change(Span::at(end), " @interpolate(flat)", "integers between stages are `@interpolate(flat)`");
        }
    }

    /// Entry points of several stages could have one name.
    fn entry_points(&mut self) {
        let points: Vec<(usize, &str)> = (0..self.tokens.len())
            .filter(|&at| self.word(at) == "stage" && matches!(self.word(at + 1), "("))
            .filter_map(|at| {
                let name = (at..self.tokens.len()).find(|&k| self.word(k) == "fn")? + 1;
                Some((name, ["vertex", "fragment", "compute"].into_iter().find(|stage| *stage == self.word(at + 2))?))
            })
            .collect();
        for (k, &(at, stage)) in points.iter().enumerate() {
            let name = self.word(at);
            if points[..k].iter().any(|(other, _)| self.word(*other) == name) {
                let new = format!("{name}_{stage}");
                self.change(self.tokens[at].span, new, "a second entry point of one name bears its stage behind it");
            }
        }
    }

    /// The type that the size of a texture had; none where the text does not declare the texture.
    fn dimensions(&self, texture: usize) -> Option<&'static str> {
        let name = self.word(texture);
        // `t: [[access(read)]] texture_storage_2d<…>`
        let behind_access = |at: usize| if self.is_double_bracket(at) { self.behind[at] } else { at };
        let declared = |at: usize| (self.word(at) == name && self.word(at + 1) == ":").then(|| behind_access(at + 2));
        let mut types = (0..self.tokens.len()).filter_map(declared).map(|ty| self.word(ty));
        Some(match types.find(|ty| ty.starts_with("texture_"))? {
            ty if ty.contains("1d") => "i32",
            ty if ty.contains("3d") => "vec3<i32>",
            _ => "vec2<i32>",
        })
    }

    /// A stride that differs from the one of the language moves data, which no type of today expresses.
    pub(super) fn check_strides(&mut self, file: &SourceFile) {
        if self.strides.is_empty() {
            return;
        }
        // The language places the second of two members where it places the second of two elements.
        let mut text = file.text().to_owned();
        for (index, stride) in self.strides.iter().enumerate() {
            let element = self.file.slice(self.span(stride.element.start, stride.element.end));
            text.push_str(&format!("\nstruct draft_stride_{index} {{ first: array<{element}, 2>, }}"));
        }
        let parsed = Shader::parse_wgsl(&SourceFile::new(file.name(), text));
        let layouts: HashMap<usize, u64> = (0..self.strides.len())
            .filter_map(|index| {
                let layout = parsed.shader.wgsl()?.layouts.get(&format!("draft_stride_{index}"))?;
                Some((index, layout.members.first()?.extent.size / 2))
            })
            .collect();
        for (index, stride) in std::mem::take(&mut self.strides).into_iter().enumerate() {
            if let Some(natural) = layouts.get(&index).filter(|natural| **natural != stride.bytes) {
                let what =
                    format!("a stride of {} bytes where elements follow each other after {natural}", stride.bytes);
                self.refuse(
                    stride.span,
                    &what,
                    "make the elements as large as their stride, such as `vec4<f32>` for 16 bytes",
                );
            }
        }
    }
}
