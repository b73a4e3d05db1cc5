//! Built-in inputs that are numbers of the draw: of the vertex, the instance, the primitive.
//!
//! They are inputs like others: each sample has a value for them, which is shown, shrunk and reproduced. Kernels that
//! feed a function take it from the record; a real vertex stage is drawn so that it sees that value, and a lane that
//! cannot draw so refuses the sample by the name of the variable.

use naga::{Binding, BuiltIn};

use super::{Entry, PortAt, Program};
use crate::lower::Role;
use syntax::Shader;
use syntax::ast::{BinaryOp, Callee, ExprId, ExprKind, UnaryOp};
use syntax::symbols::SymbolId;
use syntax::types::{ArraySize, Type};

/// What a number of the draw counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Count {
    /// Vertices, from the first one of the draw.
    Vertex,
    /// Instances, from the first one of the draw.
    Instance,
    /// The first vertex, or what the host adds to indices.
    BaseVertex,
    /// The first instance.
    BaseInstance,
    /// Draws of one call.
    Draw,
}

/// A number of the draw as an input of a vertex stage.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Drawn {
    /// Name, as the author writes it.
    pub name: String,
    /// What it counts.
    pub count: Count,
    /// Its word in the record of an invocation.
    pub word: u32,
}

impl Drawn {
    /// Its value for an invocation.
    ///
    /// # Errors
    /// A value that no draw has, in words for the user: it is below 0.
    pub fn of(&self, invocation: &[u32]) -> Result<u32, String> {
        let value = invocation.get(self.word as usize).copied().unwrap_or(0);
        match i32::try_from(value) {
            Ok(_) => Ok(value),
            Err(_) => Err(format!("`{}` = {}: no draw counts so", self.name, value.cast_signed())),
        }
    }

    /// Refuses every value but 0, for a lane whose draws count nothing else.
    ///
    /// # Errors
    /// The value, in words for the user.
    pub fn must_be_zero(&self, invocation: &[u32]) -> Result<(), String> {
        match self.of(invocation)? {
            0 => Ok(()),
            value => Err(format!("`{}` = {value} cannot be set on this lane, which draws it as 0", self.name)),
        }
    }

    /// What a lane says that cannot set it.
    pub fn refusal(&self) -> String {
        format!("`{}` cannot be set on this lane", self.name)
    }
}

/// Names of the numbers, and the largest value that is tried where nothing is stated. Each value comes up many times
/// in a run, so that a branch on a single one is taken; OpenGL draws an instance together with all before it.
const NUMBERS: [(&str, u32); 16] = [
    ("gl_VertexID", 1023),
    ("gl_VertexIndex", 1023),
    ("gl_InstanceID", 63),
    ("gl_InstanceIndex", 63),
    ("gl_BaseVertex", 1023),
    ("gl_BaseVertexARB", 1023),
    ("gl_BaseInstance", 1023),
    ("gl_BaseInstanceARB", 1023),
    ("gl_DrawID", 63),
    ("gl_DrawIDARB", 63),
    ("gl_PrimitiveID", 1023),
    ("gl_PrimitiveIDIn", 1023),
    ("gl_SampleID", 3),
    ("gl_SampleMaskIn", 15),
    ("gl_Layer", 7),
    ("gl_ViewportIndex", 15),
];

/// For each number of the draw that a shader reads, the largest value that is tried where nothing is stated: one for
/// which every array that is indexed by it has an element.
pub fn ranges(shader: &Shader) -> Vec<(String, u32)> {
    let range = |&(name, most): &(&str, u32)| {
        let symbol = shader.builtin(name)?;
        Some((name.to_owned(), reach(shader, symbol, most)))
    };
    NUMBERS.iter().filter_map(range).collect()
}

/// The largest number up to `most` that is no index outside of an array.
fn reach(shader: &Shader, symbol: SymbolId, most: u32) -> u32 {
    let mut reach = most;
    for (_, expr) in shader.arena().iter() {
        let ExprKind::Index { base, index } = expr.kind else { continue };
        let Some(length) = length(shader.type_of(base)).filter(|_| shader.fold(index).is_none()) else { continue };
        let inside = |n: u32| value(shader, index, (symbol, n)).is_some_and(|i| (0..i64::from(length)).contains(&i));
        reach = match value(shader, index, (symbol, 0)) {
            // What else the index comes from is not known here.
            None => reach.min(length.saturating_sub(1)),
            Some(_) => (0..=reach).take_while(|&n| inside(n)).last().unwrap_or(0),
        };
    }
    reach
}

/// Elements of what is indexed.
fn length(ty: &Type) -> Option<u32> {
    match ty {
        Type::Array(_, ArraySize::Known(n)) => Some(*n),
        Type::Vector(_, n) | Type::Matrix(_, n, _) => Some(u32::from(*n)),
        _ => None,
    }
}

/// A whole number that depends on nothing but a number of the draw.
fn value(shader: &Shader, id: ExprId, number: (SymbolId, u32)) -> Option<i64> {
    if let Some(known) = shader.fold(id).and_then(|c| c.as_integer()) {
        return Some(known);
    }
    let of = |id: ExprId| value(shader, id, number);
    match &shader.expr(id).kind {
        ExprKind::Name(_) => (shader.symbol_of(id) == Some(number.0)).then_some(i64::from(number.1)),
        ExprKind::Paren(inner) => of(*inner),
        // `int(n)` and `uint(n)`; a number that becomes binary32 on the way is not followed.
        ExprKind::Call { callee: Callee::Type(_), args } => match args[..] {
            [one] if shader.type_of(id).shape().is_some_and(is_whole) => of(one),
            _ => None,
        },
        ExprKind::Unary { op: UnaryOp::Plus, operand, .. } => of(*operand),
        ExprKind::Unary { op: UnaryOp::Minus, operand, .. } => of(*operand)?.checked_neg(),
        ExprKind::Binary { op, left, right, .. } => binary(*op, of(*left)?, of(*right)?),
        _ => None,
    }
}

fn is_whole(shape: base::value::Shape) -> bool {
    use base::value::Scalar;
    shape.words() == 1 && matches!(shape.scalar, Scalar::I32 | Scalar::U32)
}

fn binary(op: BinaryOp, a: i64, b: i64) -> Option<i64> {
    let bits = |n: i64| u32::try_from(n).ok().filter(|n| *n < 32);
    match op {
        BinaryOp::Add => a.checked_add(b),
        BinaryOp::Sub => a.checked_sub(b),
        BinaryOp::Mul => a.checked_mul(b),
        BinaryOp::Div => a.checked_div(b),
        BinaryOp::Rem => a.checked_rem(b),
        BinaryOp::Shl => a.checked_shl(bits(b)?),
        BinaryOp::Shr => a.checked_shr(bits(b)?),
        BinaryOp::BitAnd => Some(a & b),
        BinaryOp::BitOr => Some(a | b),
        BinaryOp::BitXor => Some(a ^ b),
        _ => None,
    }
}

impl Program {
    /// The numbers of the draw that a vertex stage takes. In the record of an invocation they stand behind all
    /// attributes.
    pub fn drawn(&self) -> Vec<Drawn> {
        let (Role::Vertex, Entry::Point(entry)) = (&self.role, self.entry) else { return Vec::new() };
        let arguments = &self.module.entry_points[entry].function.arguments;
        let mut word = 0;
        let mut all = Vec::new();
        for port in &self.inputs {
            let argument = match port.at {
                PortAt::Argument(k) => arguments.get(k as usize),
                _ => None,
            };
            if let Some(Binding::BuiltIn(built_in)) = argument.and_then(|argument| argument.binding.as_ref())
                && let Some(count) = count(*built_in)
            {
                all.push(Drawn { name: port.field.name.clone(), count, word });
            }
            word += port.field.shape.words() as u32;
        }
        all
    }

    /// Built-in values of a compute stage, by the author's names. They are no inputs but 0: it is run as the first
    /// invocation of a dispatch, alone.
    pub fn first_of_dispatch(&self) -> Vec<String> {
        let (Role::Compute, Entry::Point(entry)) = (&self.role, self.entry) else { return Vec::new() };
        let arguments = &self.module.entry_points[entry].function.arguments;
        let name = |&(k, _): &(u32, BuiltIn)| arguments.get(k as usize)?.name.clone();
        self.built_ins.iter().filter_map(name).collect()
    }

    /// The largest value of an input that is a number of the draw, where nothing is stated; none for other inputs.
    pub fn largest(&self, input: &str) -> Option<u32> {
        self.ranges.iter().find(|(name, _)| name == input).map(|(_, most)| *most)
    }
}

fn count(built_in: BuiltIn) -> Option<Count> {
    Some(match built_in {
        BuiltIn::VertexIndex => Count::Vertex,
        BuiltIn::InstanceIndex => Count::Instance,
        BuiltIn::BaseVertex => Count::BaseVertex,
        BuiltIn::BaseInstance => Count::BaseInstance,
        BuiltIn::DrawIndex => Count::Draw,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::text::SourceFile;
    use syntax::Stage;

    fn largest(body: &str) -> u32 {
        let text = format!(
            "#version 330\nconst vec2 at[3] = vec2[](vec2(0.0), vec2(1.0), vec2(2.0));\nuniform float w[8];\n\
             float of(int k) {{ return w[k]; }}\nvoid main() {{ gl_Position = vec4({body}); }}\n"
        );
        let shader = Shader::parse(&SourceFile::new("t.vert", text), Stage::Vertex).shader;
        let found = ranges(&shader);
        assert_eq!(found.len(), 1, "{found:?}");
        found[0].1
    }

    #[test]
    fn an_array_bounds_the_number_that_is_its_index() {
        // `of` has an index of its own, whose parameter may be any number.
        assert_eq!(largest("at[gl_VertexID], 0.0, 1.0"), 2);
        assert_eq!(largest("w[gl_VertexID * 2 + 1]"), 3);
        assert_eq!(largest("w[(gl_VertexID >> 2) & 7]"), 7);
        assert_eq!(largest("of(gl_VertexID)"), 7);
        assert_eq!(largest("w[7 - int(gl_InstanceID)]"), 7);
    }

    #[test]
    fn no_index_no_bound() {
        let text = "#version 330\nvoid main() { gl_Position = vec4(float(gl_VertexID)); }\n";
        let shader = Shader::parse(&SourceFile::new("t.vert", text), Stage::Vertex).shader;
        assert_eq!(ranges(&shader), [("gl_VertexID".to_owned(), 1023)]);
    }

    #[test]
    fn a_number_below_zero_is_refused() {
        let drawn = Drawn { name: "gl_VertexID".into(), count: Count::Vertex, word: 1 };
        assert_eq!(drawn.of(&[0, 5]), Ok(5));
        assert_eq!(drawn.of(&[0, u32::MAX]).unwrap_err(), "`gl_VertexID` = -1: no draw counts so");
        assert!(drawn.must_be_zero(&[0, 0]).is_ok() && drawn.must_be_zero(&[0, 5]).is_err());
    }
}
