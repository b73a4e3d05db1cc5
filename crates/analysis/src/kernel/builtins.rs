//! Built-in values that tell an invocation its place.

use syntax::symbols::SymbolId;

use super::value::{Number, Origin, Value};
use super::walk::Walk;

impl Walk<'_> {
    /// Places of the invocations in the group, by direction.
    fn local(&self, direction: usize) -> Number {
        let [x, y, _] = self.size.map(|s| s as usize);
        let of = |lane: usize| match direction {
            0 => lane % x,
            1 => lane / x % y,
            _ => lane / x / y,
        };
        Number::of_lanes((0..self.lanes).map(|l| i64::try_from(of(l)).unwrap_or(0)).collect())
    }

    /// The number of the work group along an axis.
    fn group(&mut self, direction: usize) -> Number {
        self.group.map_or_else(|| self.uniform(&format!("gl_WorkGroupID.{direction}")), Number::constant)
    }

    fn uniform(&mut self, name: &str) -> Number {
        self.terms.named(name, Origin { uniform: true, data: false })
    }

    /// The value that a name of WGSL or GLSL stands for.
    pub(super) fn builtin(&mut self, name: &str) -> Option<Value> {
        use syntax::ast::BinaryOp::{Add, Mul};
        let vector = |all: Vec<Number>| Some(Value::Vector(all));
        match name {
            "local_invocation_id" | "gl_LocalInvocationID" => vector((0..3).map(|d| self.local(d)).collect()),
            "local_invocation_index" | "gl_LocalInvocationIndex" => {
                Some(Value::One(Number::of_lanes((0..self.lanes).map(|l| i64::try_from(l).unwrap_or(0)).collect())))
            }
            "workgroup_id" | "gl_WorkGroupID" => vector((0..3).map(|d| self.group(d)).collect()),
            "num_workgroups" | "gl_NumWorkGroups" => {
                vector((0..3).map(|d| self.uniform(&format!("gl_NumWorkGroups.{d}"))).collect())
            }
            "gl_WorkGroupSize" => vector(self.size.map(|s| Number::constant(i64::from(s))).to_vec()),
            "global_invocation_id" | "gl_GlobalInvocationID" => {
                let mut all = Vec::new();
                for (direction, size) in self.size.into_iter().enumerate() {
                    let group = self.group(direction);
                    let size = Number::constant(i64::from(size));
                    let first = self.terms.binary(Mul, &group, &size, None);
                    let local = self.local(direction);
                    all.push(self.terms.binary(Add, &first, &local, None));
                }
                vector(all)
            }
            "subgroup_size" | "gl_SubgroupSize" | "num_subgroups" | "gl_NumSubgroups" => {
                Some(Value::One(self.uniform(name)))
            }
            _ => None,
        }
    }

    /// The value of an input of an entry point in WGSL, or of its member.
    pub(super) fn input(&self, symbol: SymbolId, member: Option<&str>) -> Option<Value> {
        self.inputs.get(&(symbol, member.map(str::to_owned))).cloned()
    }
}
