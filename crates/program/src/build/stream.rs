//! Vertex streams of a geometry stage (GLSL 4.60, 4.4.2.2 and 8.15). All vertices come out in the order in
//! which they are emitted, each with the number of its stream.

use naga::{AddressSpace, Expression, GlobalVariable, Handle, Statement};

use super::function::Fun;
use super::global::Global;
use super::{Build, Result};
use crate::{Port, PortAt};
use base::text::Span;
use base::value::Field;
use syntax::BuiltinFunction as F;
use syntax::Const;
use syntax::ast::{Callee, ExprId, ExprKind, Qualifiers};
use syntax::interface::Storage;
use syntax::symbols::SymbolId;
use syntax::types::Type;

/// Name of the output that tells the stream of a vertex.
const STREAM: &str = "emit_stream";

impl Build<'_> {
    /// True when more than the first stream is used.
    fn has_streams(&self) -> bool {
        self.shader.arena().iter().any(|(_, e)| match &e.kind {
            ExprKind::Call { callee: Callee::Name(name), args } if name.name == "EmitStreamVertex" => {
                args.first().and_then(|&a| self.stream_number(a)) != Some(0)
            }
            _ => false,
        })
    }

    fn stream_number(&self, id: ExprId) -> Option<u32> {
        self.shader.fold(id).and_then(Const::as_integer).and_then(|n| u32::try_from(n).ok())
    }

    /// The stream of an output: its own layout, or the default at its place, or the first.
    fn stream_of(&self, qualifiers: &Qualifiers, item: usize) -> u32 {
        let written =
            |q: &Qualifiers| q.layout_entry("stream").and_then(|e| e.value).and_then(|v| self.stream_number(v));
        let layouts = &self.shader.interface().stage_layouts;
        let default = || {
            let before = layouts.iter().filter(|l| l.storage == Some(Storage::Out) && l.item < item);
            before.filter_map(|l| written(&l.qualifiers)).next_back()
        };
        written(qualifiers).or_else(default).unwrap_or(0)
    }

    /// Outputs of the author's that belong to another stream.
    fn outputs_beside(&self, stream: u32) -> Vec<SymbolId> {
        let interface = self.shader.interface();
        let mut found = Vec::new();
        for v in &interface.outputs {
            if self.stream_of(&v.qualifiers, v.item) != stream {
                found.push(v.symbol);
            }
        }
        for block in interface.blocks.iter().filter(|b| b.storage == Storage::Out) {
            if self.stream_of(&block.qualifiers, block.item) != stream {
                found.extend(block.symbol);
                found.extend(block.members.iter().filter_map(|m| m.symbol));
            }
        }
        if stream != 0 {
            // What the language declares belongs to the first stream.
            let names = ["gl_Position", "gl_PointSize", "gl_ClipDistance", "gl_CullDistance"];
            let more = ["gl_Layer", "gl_ViewportIndex", "gl_PrimitiveID"];
            found.extend(names.iter().chain(&more).filter_map(|name| self.shader.builtin(name)));
        }
        found
    }

    fn stream_variable(&mut self, span: Span) -> Result<Handle<GlobalVariable>> {
        if let Some(&handle) = self.made.unnamed.get(STREAM) {
            return Ok(handle);
        }
        let ty = self.value_type(&Type::INT, span)?;
        let handle = self.variable(STREAM, AddressSpace::Private, ty);
        if let Some(shape) = Type::INT.shape() {
            let field = Field { name: STREAM.to_owned(), shape };
            self.ports.built_in_outputs.push(Port { field, ty, at: PortAt::Global(handle), backing: None });
        }
        self.made.unnamed.insert(STREAM.to_owned(), handle);
        Ok(handle)
    }
}

impl Fun<'_, '_> {
    /// `EmitStreamVertex` and `EndStreamPrimitive`.
    pub(super) fn stream(&mut self, function: F, args: &[ExprId], span: Span) -> Result<()> {
        let Some(stream) = args.first().and_then(|&a| self.build.stream_number(a)) else {
            return Err(self.build.unsupported(span, format!("`{function}` of a computed stream"), "write a number"));
        };
        self.emit(function == F::EndStreamPrimitive, stream, span)
    }

    /// Emits a vertex to a stream, or ends its primitive.
    pub(super) fn emit(&mut self, ends: bool, stream: u32, span: Span) -> Result<()> {
        if !ends && self.build.has_streams() {
            // Each output is undefined behind the call (GLSL 4.60, 8.15), so that those of other streams,
            // which this vertex does not have, can be 0 in it.
            for symbol in self.build.outputs_beside(stream) {
                if let Some(Global::Whole { handle, .. }) = self.build.made.globals.get(&symbol).cloned() {
                    let ty = self.build.module.global_variables[handle].ty;
                    let pointer = self.add(Expression::GlobalVariable(handle));
                    let value = self.add(Expression::ZeroValue(ty));
                    self.push(Statement::Store { pointer, value });
                } else if let Some(Global::Member { handle, index, .. }) = self.build.made.globals.get(&symbol).cloned()
                {
                    let whole = self.build.module.global_variables[handle].ty;
                    let ty = self.build.members(whole)[index as usize];
                    let base = self.add(Expression::GlobalVariable(handle));
                    let pointer = self.add(Expression::AccessIndex { base, index });
                    let value = self.add(Expression::ZeroValue(ty));
                    self.push(Statement::Store { pointer, value });
                }
            }
            let handle = self.build.stream_variable(span)?;
            let pointer = self.add(Expression::GlobalVariable(handle));
            let value = self.i32(i32::try_from(stream).unwrap_or(i32::MAX));
            self.push(Statement::Store { pointer, value });
        }
        let function = self.build.emission(if ends { "EndPrimitive" } else { "EmitVertex" });
        self.push(Statement::Call { function, arguments: Vec::new(), result: None });
        Ok(())
    }
}
