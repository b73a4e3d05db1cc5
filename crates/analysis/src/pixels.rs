//! Which numbers of a shader count pixels: those that are added to, compared with or divided by a size in pixels.
//!
//! Each number has a power of pixels: 1 for a place on the screen, 2 for a square of one, -1 for the step from one texel to
//! the next, 0 for a share. They follow from uniforms whose names say that they are sizes, from `gl_FragCoord`, and from an
//! edge of one pixel; nothing is known of the rest.

use std::collections::{BTreeMap, HashMap};

use syntax::ast::{BinaryOp, Expr, ExprId, ExprKind, UnaryOp};
use syntax::interface::Storage;
use syntax::symbols::{CallTarget, SymbolId, SymbolKind};
use syntax::types::{ScalarType, Type};
use syntax::{Shader, Stage};

use crate::forms::builtin;
use crate::names;
use crate::numeric::{bare, constant};
use crate::pixel_names::{is_along, said};
use syntax::walk::declarators;

/// Rounds in which what is known of one number is handed to others.
const ROUNDS: usize = 8;
/// Expressions beyond which nothing is sought.
const MOST: usize = 1 << 14;

/// What is known of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unit {
    /// A constant: it fits everything.
    Free,
    /// A power of pixels, and the number of what it follows from.
    Known(i32, usize),
    /// Nothing is known of it.
    Unknown,
}

use Unit::{Free, Known, Unknown};

/// What a power of pixels follows from.
#[derive(Clone, Debug)]
pub struct Seed {
    /// The name of a variable.
    pub name: String,
    /// It is a length along a line, in whatever it is measured.
    pub along: bool,
}

/// Powers of what one stage hands on to the next, and of uniforms, by name; true for lengths along a line.
pub type HandedOn = BTreeMap<String, (i32, bool)>;

/// Powers of pixels of the variables of a shader.
pub struct Pixels<'s> {
    pub(super) shader: &'s Shader,
    pub(super) of: HashMap<SymbolId, (i32, usize)>,
    /// What everything follows from.
    seeds: Vec<Seed>,
    /// Values that variables are declared with.
    initial: Vec<(SymbolId, ExprId)>,
    /// Variables of which two things are said.
    torn: Vec<SymbolId>,
}

impl<'s> Pixels<'s> {
    /// Works out what is known. `before` has powers that the stage before gives to inputs, by name.
    pub fn of(shader: &'s Shader, before: &HandedOn) -> Self {
        let mut this = Self { shader, of: HashMap::new(), seeds: Vec::new(), initial: Vec::new(), torn: Vec::new() };
        if shader.arena().len() > MOST {
            return this;
        }
        for (id, symbol) in shader.symbols() {
            let outside = match symbol.kind {
                SymbolKind::Global(Storage::Uniform) | SymbolKind::BlockMember(_) => {
                    said(&symbol.name).map(|power| (power, false)).or_else(|| before.get(&symbol.name).copied())
                }
                SymbolKind::Global(Storage::In) => {
                    let attribute = shader.stage() == Stage::Vertex;
                    let along = is_along(&symbol.name, attribute).then_some((1, true));
                    before.get(&symbol.name).copied().or(along)
                }
                SymbolKind::Builtin if symbol.name == "gl_FragCoord" => Some((1, false)),
                _ => None,
            };
            if let Some((power, along)) = outside.filter(|_| is_real(&symbol.ty)) {
                this.of.insert(id, (power, this.seeds.len()));
                this.seeds.push(Seed { name: symbol.name.clone(), along });
            }
        }
        let places: HashMap<usize, SymbolId> =
            shader.symbols().filter_map(|(id, symbol)| Some((symbol.span?.start, id))).collect();
        declarators(shader, |one| {
            if let (Some(symbol), Some(value)) = (places.get(&one.name.span.start), &one.initializer) {
                this.initial.push((*symbol, value.value));
            }
        });
        // What is left of a number of pixels is a part of one, whatever it is divided by later.
        let rests = this.initial.iter().filter(|(_, value)| this.is_left_over(*value, 0));
        this.torn = rests.map(|(symbol, _)| *symbol).collect();
        let (of, seeds) = (this.of.clone(), this.seeds.len());
        for _ in 0..ROUNDS {
            this.settle();
            let changed = this.changed();
            if changed.is_empty() {
                break;
            }
            // What followed from them follows from nothing.
            this.torn.extend(changed);
            this.of.clone_from(&of);
            this.seeds.truncate(seeds);
        }
        this
    }

    fn settle(&mut self) {
        for _ in 0..ROUNDS {
            let known = self.of.len();
            self.round();
            if self.of.len() == known {
                break;
            }
        }
    }

    /// Variables that get another unit on their way: `p /= size` and `p = p / size` make a share of a place.
    fn changed(&self) -> Vec<SymbolId> {
        let changes = |expr: &Expr| match expr.kind {
            ExprKind::Assign { op, op_span: _, target, value } => {
                let target = match self.shader.expr(bare(self.shader, target)).kind {
                    ExprKind::Field { base, .. } => base,
                    _ => target,
                };
                let symbol = self.shader.symbol_of(bare(self.shader, target))?;
                let (own, _) = *self.of.get(&symbol)?;
                let other = match (op, self.unit(value)) {
                    (Some(BinaryOp::Mul | BinaryOp::Div), Free) => false,
                    (Some(BinaryOp::Mul | BinaryOp::Div), _) => !matches!(self.shader.type_of(value), Type::Matrix(..)),
                    (None, Known(power, _)) => power != own,
                    _ => false,
                };
                other.then_some(symbol)
            }
            _ => None,
        };
        self.shader.arena().iter().filter_map(|(_, expr)| changes(expr)).collect()
    }

    /// What a value that is known follows from.
    pub fn seed(&self, number: usize) -> Option<&Seed> {
        self.seeds.get(number)
    }

    /// Powers of the variables that a stage hands on, and of uniforms, by name.
    pub fn handed_on(&self) -> HandedOn {
        let out = |symbol: &SymbolId| {
            matches!(self.shader.symbol(*symbol).kind, SymbolKind::Global(Storage::Out | Storage::Uniform))
        };
        let known = self.of.iter().filter(|(symbol, _)| out(symbol));
        known
            .map(|(symbol, (power, seed))| (self.shader.symbol(*symbol).name.clone(), (*power, self.is_along(*seed))))
            .collect()
    }

    pub(super) fn is_along(&self, seed: usize) -> bool {
        self.seed(seed).is_some_and(|seed| seed.along)
    }

    /// The values that a variable is given.
    pub fn initial(&self, symbol: SymbolId) -> impl Iterator<Item = ExprId> + '_ {
        self.initial.iter().filter(move |(of, _)| *of == symbol).map(|(_, value)| *value)
    }

    fn round(&mut self) {
        for k in 0..self.initial.len() {
            let (symbol, value) = self.initial[k];
            match (self.of.get(&symbol).copied(), self.unit(value)) {
                (None, Known(power, seed)) => self.set(symbol, power, seed),
                (Some((power, seed)), Unknown) => self.push(value, power, seed),
                _ => {}
            }
        }
        for (id, expr) in self.shader.arena().iter() {
            match &expr.kind {
                ExprKind::Assign { op: None | Some(BinaryOp::Add | BinaryOp::Sub), target, value, .. } => {
                    self.meet(*target, *value);
                }
                ExprKind::Assign { op: Some(op @ (BinaryOp::Mul | BinaryOp::Div)), target, value, .. } => {
                    let away = if *op == BinaryOp::Mul { -1 } else { 1 };
                    if let (Unknown, Known(power, seed)) = (self.unit(*target), self.unit(*value))
                        && power == away
                    {
                        self.push(*target, 1, seed);
                    }
                }
                ExprKind::Binary { op, left, right, .. } => match op {
                    BinaryOp::Add
                    | BinaryOp::Sub
                    | BinaryOp::Less
                    | BinaryOp::Greater
                    | BinaryOp::LessEqual
                    | BinaryOp::GreaterEqual => self.meet(*left, *right),
                    BinaryOp::Div => {
                        if let (Unknown, Known(1, seed)) = (self.unit(*left), self.unit(*right)) {
                            self.push(*left, 1, seed);
                        }
                    }
                    _ => {}
                },
                ExprKind::Ternary { yes, no, .. } => self.meet(*yes, *no),
                ExprKind::Call { args, .. } => {
                    if builtin(self.shader, id, &["min", "max", "clamp", "mix", "distance"]).is_some() {
                        args.windows(2).take(2).for_each(|pair| self.meet(pair[0], pair[1]));
                    }
                    self.edge(id);
                    self.parameters(id, args);
                }
                _ => {}
            }
        }
    }

    /// A coverage: half a width less a distance, between 0 and 1, is an edge of one pixel.
    fn edge(&mut self, id: ExprId) {
        let Some((name, far)) = self.edge_of(id) else { return };
        if self.unit(far) == Unknown {
            let seed = self.seeds.len();
            self.seeds.push(Seed { name, along: false });
            self.push(far, 1, seed);
        }
    }

    /// The distance at an edge of one pixel, and the name of the width that it is subtracted from.
    pub fn edge_of(&self, id: ExprId) -> Option<(String, ExprId)> {
        let shader = self.shader;
        let is = |id: ExprId, value: f64| constant(shader, id) == Some(value);
        let inner = match builtin(shader, id, &["clamp", "min", "max"]) {
            Some(("clamp", [value, low, high])) if is(*low, 0.0) && is(*high, 1.0) => *value,
            Some(("min", [value, high])) if is(*high, 1.0) => match builtin(shader, *value, &["max"]) {
                Some((_, [value, low])) if is(*low, 0.0) => *value,
                _ => return None,
            },
            Some(("max", [value, low])) if is(*low, 0.0) => *value,
            _ => return None,
        };
        let ExprKind::Binary { op: BinaryOp::Sub, left, right, .. } = shader.expr(bare(shader, inner)).kind else {
            return None;
        };
        let name = syntax::walk::expressions(shader, left).into_iter().find_map(|part| {
            let name = names::of(shader, part)?;
            (constant(shader, part).is_none() && names::has_word(name, &["width", "thickness", "radius", "half"]))
                .then(|| name.to_owned())
        })?;
        self.is_distance(right, 0).then_some((name, right))
    }

    /// True for a distance, the smallest of several, and a variable that is one.
    pub fn is_distance(&self, id: ExprId, depth: usize) -> bool {
        let shader = self.shader;
        if depth > 4 {
            return false;
        }
        let id = bare(shader, id);
        match builtin(shader, id, &["length", "distance", "min", "max"]) {
            Some(("length" | "distance", _)) => true,
            Some((_, args)) => args.iter().any(|arg| self.is_distance(*arg, depth + 1)),
            None if self.scaled_back(id).is_some() => true,
            None => shader
                .symbol_of(id)
                .is_some_and(|symbol| self.initial(symbol).any(|value| self.is_distance(value, depth + 1))),
        }
    }

    /// The distance of a product of one and a number of pixels, and that number: `length(p / size) * size`.
    pub fn scaled_back(&self, id: ExprId) -> Option<(ExprId, ExprId)> {
        let ExprKind::Binary { op: BinaryOp::Mul, left, right, .. } = self.shader.expr(bare(self.shader, id)).kind
        else {
            return None;
        };
        let is = |far: ExprId, size: ExprId| {
            let far_is_share =
                builtin(self.shader, far, &["length", "distance"]).is_some() && !matches!(self.unit(far), Known(1, _));
            (far_is_share && matches!(self.unit(size), Known(1, _))).then_some((far, size))
        };
        is(left, right).or_else(|| is(right, left))
    }

    /// Parameters of a function have what its calls give them, where all give the same.
    fn parameters(&mut self, id: ExprId, args: &[ExprId]) {
        let Some(CallTarget::User(function)) = self.shader.callee(id) else { return };
        let params = &self.shader.function_info(*function).params;
        for (arg, param) in args.iter().zip(params) {
            let Some(symbol) = param.symbol.filter(|_| is_real(&param.ty)) else { continue };
            match (self.unit(*arg), self.of.get(&symbol).copied()) {
                (Known(power, seed), None) if !self.torn.contains(&symbol) => self.set(symbol, power, seed),
                (Known(power, _), Some((other, _))) if power != other => {
                    self.torn.push(symbol);
                    self.of.remove(&symbol);
                }
                _ => {}
            }
        }
    }

    fn set(&mut self, symbol: SymbolId, power: i32, seed: usize) {
        let info = self.shader.symbol(symbol);
        if is_real(&info.ty) && info.value.is_none() && !self.torn.contains(&symbol) && power.abs() <= 4 {
            self.of.entry(symbol).or_insert((power, seed));
        }
    }

    /// Two values that are of one unit.
    fn meet(&mut self, a: ExprId, b: ExprId) {
        match (self.unit(a), self.unit(b)) {
            (Known(power, seed), Unknown) => self.push(b, power, seed),
            (Unknown, Known(power, seed)) => self.push(a, power, seed),
            _ => {}
        }
    }

    /// What a value of this power is computed from.
    fn push(&mut self, id: ExprId, power: i32, seed: usize) {
        let shader = self.shader;
        match &shader.expr(id).kind {
            ExprKind::Name(_) => {
                if let Some(symbol) = shader.symbol_of(id) {
                    self.set(symbol, power, seed);
                }
            }
            ExprKind::Paren(inner)
            | ExprKind::Index { base: inner, .. }
            | ExprKind::Unary { op: UnaryOp::Plus | UnaryOp::Minus, operand: inner, .. } => {
                self.push(*inner, power, seed);
            }
            ExprKind::Field { base, .. } if matches!(shader.type_of(*base), Type::Vector(..)) => {
                self.push(*base, power, seed);
            }
            ExprKind::Binary { op: BinaryOp::Add | BinaryOp::Sub, left, right, .. } => {
                for side in [*left, *right].into_iter().filter(|side| constant(shader, *side).is_none()) {
                    self.push(side, power, seed);
                }
            }
            ExprKind::Binary { op: BinaryOp::Mul, left, right, .. } => match (self.unit(*left), self.unit(*right)) {
                (Free, _) => self.push(*right, power, seed),
                (_, Free) => self.push(*left, power, seed),
                (Known(own, _), Unknown) => self.push(*right, power - own, seed),
                (Unknown, Known(own, _)) => self.push(*left, power - own, seed),
                _ => {}
            },
            ExprKind::Binary { op: BinaryOp::Div, left, right, .. } => match (self.unit(*left), self.unit(*right)) {
                (_, Free) => self.push(*left, power, seed),
                (_, Known(own, _)) => self.push(*left, power + own, seed),
                _ => {}
            },
            ExprKind::Ternary { yes, no, .. } => {
                self.push(*yes, power, seed);
                self.push(*no, power, seed);
            }
            ExprKind::Call { args, .. } => {
                let keeps = ["abs", "floor", "ceil", "min", "max", "clamp", "length", "distance", "mix"];
                let constructs = matches!(shader.callee(id), Some(CallTarget::Constructor(_)));
                let of_one = builtin(shader, id, &keeps).map(|(name, _)| if name == "mix" { 2 } else { 3 });
                let several = if constructs { Some(args.len()) } else { of_one };
                for arg in args.iter().take(several.unwrap_or(0)) {
                    if constant(shader, *arg).is_none() {
                        self.push(*arg, power, seed);
                    }
                }
            }
            _ => {}
        }
    }
}

fn is_real(ty: &Type) -> bool {
    let mut ty = ty;
    while let Type::Array(inner, _) = ty {
        ty = inner;
    }
    matches!(ty, Type::Scalar(_) | Type::Vector(..)) && ty.scalar() == Some(ScalarType::Float)
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::text::SourceFile;
    use syntax::Stage;

    /// The power of the expression that the variable `x` is declared with.
    fn power(body: &str) -> Option<i32> {
        let text = format!(
            "uniform vec2 u_resolution;\nuniform vec4 OutputSize;\nuniform vec2 u_texelSize;\nuniform float u_width;\n\
             uniform vec2 a, b;\nvarying vec2 uv;\nvoid main() {{ {body} gl_FragColor = vec4(x); }}\n"
        );
        let parsed = Shader::parse(&SourceFile::new("a.frag", text), Stage::Fragment);
        assert!(parsed.diagnostics.is_empty(), "{:?}", parsed.diagnostics);
        let pixels = Pixels::of(&parsed.shader, &HandedOn::new());
        let (symbol, _) = parsed.shader.symbols().find(|(_, symbol)| symbol.name == "x").unwrap();
        let value = pixels.initial(symbol).next().unwrap();
        match pixels.unit(value) {
            Known(power, _) => Some(power),
            _ => None,
        }
    }

    #[test]
    fn powers_of_pixels_follow_from_names_and_operations() {
        assert_eq!(power("float x = length(gl_FragCoord.xy - a);"), Some(1));
        assert_eq!(power("vec2 p = gl_FragCoord.xy / u_resolution; float x = dot(p, p);"), Some(0));
        assert_eq!(power("vec2 d = gl_FragCoord.xy - a; float x = dot(d, d);"), Some(2));
        assert_eq!(
            power("float s = 1.0 / max(1.0, abs(a.x)); vec2 d = (gl_FragCoord.xy - a) * s; float x = dot(d, d);"),
            Some(0)
        );
        assert_eq!(power("vec2 p = uv * OutputSize.xy; float x = p.x;"), Some(1));
        assert_eq!(power("vec2 p = uv * OutputSize.zw; float x = p.x;"), None);
        assert_eq!(power("vec2 p = uv / u_texelSize; float x = p.y;"), Some(1));
        assert_eq!(power("float x = distance(uv, a);"), None, "nothing says what these are");
        assert_eq!(power("float x = gl_FragCoord.z;"), None);
    }

    #[test]
    fn what_gets_another_unit_has_none() {
        let place = "vec2 p = gl_FragCoord.xy;";
        for change in ["p /= u_resolution.y;", "p = p / u_resolution.y;", "p = vec2(p.x * 2.0 / u_resolution.y, 0.5);"]
        {
            assert_eq!(power(&format!("{place} {change} float x = dot(p, p);")), None, "{change}");
        }
        for kept in ["p *= 2.0;", "p -= 0.5 * u_resolution;", "p = p - u_resolution;", "p *= mat2(0.0, 1.0, 1.0, 0.0);"]
        {
            assert_eq!(power(&format!("{place} {kept} float x = dot(p, p);")), Some(2), "{kept}");
        }
        assert_eq!(power("vec2 p = clamp(gl_FragCoord.xy - a, 0.0, 1.0); float x = dot(p, p);"), None, "at most 1");
    }

    #[test]
    fn what_is_compared_with_a_size_is_one() {
        assert_eq!(power("gl_FragColor.rg = a / u_resolution; float x = dot(a - b, a - b);"), Some(2));
        assert_eq!(power("float x = distance(uv, a); gl_FragColor.a = clamp(u_width * 0.5 - x, 0.0, 1.0);"), Some(1));
        assert_eq!(power("float x = gl_FragCoord.x - clamp(gl_FragCoord.x, 0.0, u_width);"), None, "a small rest");
        let rest =
            "vec2 p = uv * u_resolution; float line = floor(p.y) + 0.5; float dy = p.y - line; float x = dy * dy;";
        assert_eq!(power(rest), None, "a part of a pixel");
        let divided = "vec2 p = uv * u_resolution; float z = p.y - floor(p.y); z /= u_resolution.y; float x = z * z;";
        assert_eq!(power(divided), None, "the same in other units");
        let larger = "vec2 p = uv * u_resolution; vec2 c = floor(p) + vec2(0.5, 0.5); vec2 d = abs(c - p);\n\
                      float y = max(d.x, d.y); y /= u_resolution.x; float x = y * y;";
        assert_eq!(power(larger), None, "the larger of two parts");
    }
}
