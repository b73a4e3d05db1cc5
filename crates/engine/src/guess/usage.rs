//! What a shader does with its inputs: built-in functions that they are given to, and arrays that they index.

use std::collections::HashMap;

use syntax::Shader;
use syntax::ast::{BinaryOp, Callee, ExprId, ExprKind};
use syntax::symbols::{CallTarget, SymbolId};
use syntax::types::{ArraySize, ScalarType, Type};
use syntax::walk::initial_values;

/// A way to use a value that says which values are meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Usage {
    /// Given to `sqrt`, `log` or as the base of `pow`: above 0.
    Positive,
    /// Given to `asin` or `acos`: between -1 and 1.
    Cosine,
    /// The exponent of `pow`.
    Exponent,
    /// The share of `mix`.
    Share,
    /// Where a texture is read, from 0 to 1.
    Coordinates,
    /// What something is divided by.
    Divisor,
    /// Converted to a whole number.
    Counted,
    /// In a shader that reads texels by their number.
    Texels,
    /// Taken apart into numbers: any bits.
    Packed,
    /// Read as the bits of a number.
    Bits,
    /// The index of an array with so many elements.
    IndexOf(u32),
}

/// All uses of one input.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Uses(Vec<Usage>);

impl Uses {
    /// True when it is used so.
    pub fn has(&self, usage: Usage) -> bool {
        self.0.contains(&usage)
    }

    /// Length of the shortest array that it is an index of.
    pub fn index_below(&self) -> Option<u32> {
        let lengths = self.0.iter().filter_map(|usage| if let Usage::IndexOf(n) = usage { Some(*n) } else { None });
        lengths.min()
    }

    fn add(&mut self, usage: Usage) -> bool {
        let new = !self.has(usage);
        if new {
            self.0.push(usage);
        }
        new
    }
}

/// A variable, and the members by which a part of it is reached, without indices: `.cutOff`.
type Part = (SymbolId, String);

/// The uses of all inputs of a shader.
#[derive(Debug, Default)]
pub struct Usages {
    parts: HashMap<Part, Uses>,
    /// It calls `texelFetch` or one of its kind.
    fetches: bool,
}

impl Usages {
    /// Looks through a shader. What a function does with its parameters counts for what it is given.
    pub fn of(shader: &Shader) -> Self {
        let mut found = Self::default();
        for (id, expr) in shader.arena().iter() {
            match &expr.kind {
                ExprKind::Call { callee: Callee::Name(name), args }
                    if matches!(shader.callee(id), Some(CallTarget::Builtin(_))) =>
                {
                    found.fetches |= name.name.starts_with("texelFetch") | (name.name == "textureLoad");
                    for (k, &arg) in args.iter().enumerate() {
                        if let (Some(usage), Some(part)) = (given_to(&name.name, k), part(shader, arg)) {
                            found.parts.entry(part).or_default().add(usage);
                        }
                    }
                }
                ExprKind::Call { callee: Callee::Type(_), args } => {
                    let whole = matches!(shader.type_of(id), Type::Scalar(ScalarType::Int | ScalarType::Uint));
                    if let Some(part) = args.first().filter(|_| whole).and_then(|&arg| part(shader, arg)) {
                        found.parts.entry(part).or_default().add(Usage::Counted);
                    }
                }
                ExprKind::Binary { op: BinaryOp::Div | BinaryOp::Rem, op_span: _, left: _, right } => {
                    if let Some(part) = part(shader, converted(shader, *right)) {
                        found.parts.entry(part).or_default().add(Usage::Divisor);
                    }
                }
                ExprKind::Index { base, index } => {
                    if let (Type::Array(_, ArraySize::Known(n)), Some(part)) =
                        (shader.type_of(*base), part(shader, *index))
                    {
                        found.parts.entry(part).or_default().add(Usage::IndexOf(*n));
                    }
                }
                _ => {}
            }
        }
        let initial = initial_values(shader);
        while found.pass_on(shader, &initial) {}
        found
    }

    /// Gives arguments the uses of their parameters, and what a variable was declared as the uses of the variable; true
    /// when that tells anything new.
    fn pass_on(&mut self, shader: &Shader, initial: &HashMap<SymbolId, ExprId>) -> bool {
        let mut new = false;
        for (&variable, &value) in initial {
            if let Some((given, path)) = part(shader, value) {
                new |= self.hand_on(variable, given, &path);
            }
        }
        for (id, expr) in shader.arena().iter() {
            let ExprKind::Call { args, .. } = &expr.kind else { continue };
            let Some(CallTarget::User(function)) = shader.callee(id) else { continue };
            for (param, &arg) in shader.function_info(*function).params.iter().zip(args) {
                let (Some(symbol), Some((given, path))) = (param.symbol, part(shader, arg)) else { continue };
                new |= self.hand_on(symbol, given, &path);
            }
        }
        new
    }

    /// Gives a part of `given` the uses of `symbol`, which has its value; true when that tells anything new.
    fn hand_on(&mut self, symbol: SymbolId, given: SymbolId, path: &str) -> bool {
        let inner: Vec<(String, Uses)> = self
            .parts
            .iter()
            .filter(|((of, _), _)| *of == symbol)
            .map(|((_, member), uses)| (format!("{path}{member}"), uses.clone()))
            .collect();
        let mut new = false;
        for (path, uses) in inner {
            let known = self.parts.entry((given, path)).or_default();
            uses.0.into_iter().for_each(|usage| new |= known.add(usage));
        }
        new
    }

    /// The uses of an input by its name in a record, such as `light[1].colour`, whose variable is `symbol`.
    pub fn of_input(&self, symbol: SymbolId, name: &str) -> Uses {
        let members = name.find(['.', '[']).map_or("", |at| &name[at..]);
        let mut path = String::new();
        let mut inside = false;
        for c in members.chars() {
            match c {
                '[' => inside = true,
                ']' => inside = false,
                _ if !inside => path.push(c),
                _ => {}
            }
        }
        let mut uses = self.parts.get(&(symbol, path)).cloned().unwrap_or_default();
        if self.fetches {
            uses.add(Usage::Texels);
        }
        uses
    }
}

/// What an argument of a built-in function is.
fn given_to(name: &str, argument: usize) -> Option<Usage> {
    Some(match (name, argument) {
        ("sqrt" | "inversesqrt" | "log" | "log2" | "pow", 0) => Usage::Positive,
        ("asin" | "acos", 0) => Usage::Cosine,
        ("pow", 1) => Usage::Exponent,
        ("mix", 2) => Usage::Share,
        ("uintBitsToFloat" | "intBitsToFloat" | "bitcast", 0) => Usage::Bits,
        (name, 0) if name.starts_with("unpack") => Usage::Packed,
        ("texture" | "texture2D" | "textureLod", 1) => Usage::Coordinates,
        // WGSL names the sampler as well.
        ("textureSample" | "textureSampleLevel" | "textureSampleBias" | "textureSampleGrad", 2) => Usage::Coordinates,
        _ => return None,
    })
}

/// What a conversion to a number converts.
fn converted(shader: &Shader, id: ExprId) -> ExprId {
    match &shader.expr(id).kind {
        ExprKind::Paren(inner) => converted(shader, *inner),
        ExprKind::Call { callee: Callee::Type(_), args } if args.len() == 1 && shader.type_of(id).is_scalar() => {
            converted(shader, args[0])
        }
        _ => id,
    }
}

/// The variable that an expression is, or a part of: a member, an element, components.
fn part(shader: &Shader, id: ExprId) -> Option<Part> {
    match &shader.expr(id).kind {
        ExprKind::Paren(inner) => part(shader, *inner),
        ExprKind::Index { base, .. } => part(shader, *base),
        ExprKind::Name(_) => Some((shader.symbol_of(id)?, String::new())),
        ExprKind::Field { base, field } => {
            let (symbol, path) = part(shader, *base)?;
            let swizzle = matches!(shader.type_of(*base), Type::Vector(..) | Type::Scalar(_));
            Some((symbol, if swizzle { path } else { format!("{path}.{}", field.name) }))
        }
        _ => None,
    }
}
