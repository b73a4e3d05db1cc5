//! The entry point: fills the inputs, runs `main` and hands on the outputs.

use naga::{
    Binding, BuiltIn, EntryPoint, Expression, FunctionResult, GlobalVariable, Handle, ShaderStage, Statement,
    StructMember, TypeInner,
};

use super::function::{Fun, Val};
use super::io::{Incoming, Outgoing, kind_of};
use super::place::Lvalue;
use super::{Build, Result};
use crate::PortAt;
use base::text::Span;
use syntax::Stage;
use syntax::symbols::{FunctionId, SymbolId};
use syntax::types::Type;

impl Build<'_> {
    /// Makes the entry point around `main`.
    pub(super) fn entry(&mut self, main: FunctionId) -> Result<()> {
        let span = self.shader.function_info(main).name.span;
        let function = self.function(main, Vec::new(), span)?;
        if self.shader.stage() == Stage::Vertex && !self.ports.outgoing.iter().any(|o| o.name == "gl_Position") {
            // A vertex stage need not write a position (GLSL 4.60, 7.1); naga wants one.
            let ty = Type::VEC4;
            let handle = self.private("gl_Position", &ty, span)?;
            let built_in = BuiltIn::Position { invariant: false };
            self.built_in_output("gl_Position", &ty, handle, Vec::new(), built_in);
        }
        let invocations = self.shader.interface().geometry.invocations.map_or(1, |n| n.value);
        let counter = self.shader.builtin("gl_InvocationID");
        let initial = self.made.initial.clone();
        let mut f = Fun::new(self, Type::Void);
        f.at = span;
        for k in 0..invocations {
            if let Some(counter) = counter.filter(|_| invocations > 1) {
                let place = f.target_of(counter, span)?;
                let e = f.i32(i32::try_from(k).unwrap_or(0));
                f.store(&place, &Val { e, ty: Type::INT })?;
            }
            let begin = |f: &mut Fun<'_, '_>| -> Result<()> {
                for &(symbol, value) in &initial {
                    let place = f.target_of(symbol, span)?;
                    let value = f.initial(value, &place.ty)?;
                    f.store(&place, &value)?;
                }
                Ok(())
            };
            let sites = f.build.leaving.sites.get(&function).copied().unwrap_or(0);
            if sites > 0 {
                f.run_quads(sites, span, &mut |f, member| {
                    f.step_inputs(member)?;
                    begin(f)?;
                    f.not_discarded();
                    f.push(Statement::Call { function, arguments: Vec::new(), result: None });
                    Ok(())
                })?;
            } else {
                begin(&mut f)?;
                f.not_discarded();
                f.push(Statement::Call { function, arguments: Vec::new(), result: None });
            }
            if k + 1 < invocations {
                // Each invocation begins a strip of its own.
                let function = f.build.emission("EndPrimitive");
                f.push(Statement::Call { function, arguments: Vec::new(), result: None });
            }
        }
        let incoming = f.build.ports.incoming.clone();
        let mut more = f.build.shared_arguments(span)?;
        let (first, ()) = f.block(|f| {
            f.fill(&incoming)?;
            f.fill_shared(incoming.len())
        })?;
        f.prepend(first);
        f.at = span;
        f.clear_if_discarded()?;
        f.build.settle_sources();
        let outgoing = if f.build.takes_vertices() { Vec::new() } else { f.build.ports.outgoing.clone() };
        let result = f.hand_on(&outgoing)?;
        let mut arguments: Vec<_> = incoming.into_iter().map(|i| i.argument).collect();
        arguments.append(&mut more);
        let function = f.finish("main", arguments, result);
        let stage = match self.shader.stage() {
            Stage::Vertex => ShaderStage::Vertex,
            Stage::Fragment => ShaderStage::Fragment,
            Stage::Geometry | Stage::Compute | Stage::Library | Stage::TessControl | Stage::TessEvaluation => {
                ShaderStage::Compute
            }
        };
        let early = self
            .shader
            .interface()
            .stage_layouts
            .iter()
            .any(|l| l.qualifiers.layout_entry("early_fragment_tests").is_some());
        self.module.entry_points.push(EntryPoint {
            name: "main".to_owned(),
            stage,
            early_depth_test: early.then_some(naga::EarlyDepthTest::Force),
            workgroup_size: if stage == ShaderStage::Compute { self.workgroup } else { [0; 3] },
            workgroup_size_overrides: None,
            function,
            mesh_info: None,
            task_payload: None,
            incoming_ray_payload: None,
        });
        self.ports.inputs.append(&mut self.ports.drawn);
        self.settle_outputs();
        self.discard_output();
        Ok(())
    }

    /// Sources of blending are told apart where there are two of them. `index = 0` alone is what an output is without it.
    fn settle_sources(&mut self) {
        let sources = self.ports.outgoing.iter_mut().filter_map(|output| match &mut output.binding {
            Binding::Location { blend_src, .. } => Some(blend_src),
            Binding::BuiltIn(_) => None,
        });
        let sources: Vec<&mut Option<u32>> = sources.collect();
        let two = sources.iter().any(|source| **source == Some(1));
        for source in sources {
            *source = two.then(|| source.unwrap_or(0));
        }
    }

    /// Outputs of one member are read from what the entry point returns.
    fn settle_outputs(&mut self) {
        let mut all = std::mem::take(&mut self.ports.built_in_outputs);
        all.append(&mut self.ports.outputs);
        if !self.takes_vertices() {
            for port in &mut all {
                let (handle, path): (Handle<GlobalVariable>, Vec<u32>) = match &port.at {
                    PortAt::Global(handle) => (*handle, Vec::new()),
                    PortAt::Member(handle, k) => (*handle, vec![*k]),
                    PortAt::Part { global, path } => (*global, path.clone()),
                    _ => continue,
                };
                let same = |o: &&Outgoing| o.from == handle && o.path.starts_with(&path);
                let mut found = self.ports.outgoing.iter().enumerate().filter(|(_, o)| same(o));
                if let (Some((k, o)), None) = (found.next(), found.next())
                    && o.path == path
                    && path.is_empty()
                {
                    port.at = PortAt::ResultMember(u32::try_from(k).unwrap_or(0));
                    port.backing = Some(handle);
                }
            }
        }
        self.ports.outputs = all;
    }
}

impl Fun<'_, '_> {
    /// The place of a variable at file scope.
    fn target_of(&mut self, symbol: SymbolId, span: Span) -> Result<Lvalue> {
        match self.symbol(symbol, span)? {
            super::place::Var::Place(place) => Ok(place),
            super::place::Var::Value(_) | super::place::Var::Opaque(_) => {
                Err(self.build.unsupported(span, "a constant that is written", "declare a variable"))
            }
        }
    }

    fn reach(&mut self, handle: Handle<GlobalVariable>, path: &[u32]) -> naga::Handle<Expression> {
        let mut ptr = self.add(Expression::GlobalVariable(handle));
        for &index in path {
            ptr = self.add(Expression::AccessIndex { base: ptr, index });
        }
        ptr
    }

    fn fill(&mut self, incoming: &[Incoming]) -> Result<()> {
        for (k, input) in incoming.iter().enumerate() {
            let mut value = self.add(Expression::FunctionArgument(u32::try_from(k).unwrap_or(0)));
            let have = self.build.module.types[input.argument.ty].inner.scalar();
            if let (Some(have), Some(kind)) = (have, kind_of(&input.ty))
                && have.kind != kind
            {
                let width = if kind == naga::ScalarKind::Bool { naga::BOOL_WIDTH } else { 4 };
                value = self.add(Expression::As { expr: value, kind, convert: Some(width) });
            }
            let pointer = self.reach(input.to, &input.path);
            self.push(Statement::Store { pointer, value });
        }
        Ok(())
    }

    fn hand_on(&mut self, outgoing: &[Outgoing]) -> Result<Option<FunctionResult>> {
        let shared = self.shares_outputs() && !self.build.takes_vertices();
        if outgoing.is_empty() && !shared {
            self.push(Statement::Return { value: None });
            return Ok(None);
        }
        let mut components = Vec::new();
        let mut members = Vec::new();
        let mut offset = 0;
        for output in outgoing {
            let pointer = self.reach(output.from, &output.path);
            let mut value = self.add(Expression::Load { pointer });
            let mut ty = output.ty.clone();
            if output.binding == naga::Binding::BuiltIn(BuiltIn::SampleMask) {
                value = self.add(Expression::As { expr: value, kind: naga::ScalarKind::Uint, convert: Some(4) });
                ty = Type::UINT;
            }
            let ty = self.ty(&ty)?;
            components.push(value);
            members.push(StructMember {
                name: Some(output.name.clone()),
                ty,
                binding: Some(output.binding.clone()),
                offset,
            });
            // Larger than any member is aligned or long.
            let bytes = self.build.module.types[ty].inner.size(self.build.module.to_ctx());
            offset = (offset + bytes).next_multiple_of(32);
        }
        if shared {
            offset = self.hand_on_shared(&mut components, &mut members, offset)?;
        }
        let ty = self.build.insert(None, TypeInner::Struct { members, span: offset });
        let value = self.add(Expression::Compose { ty, components });
        self.push(Statement::Return { value: Some(value) });
        Ok(Some(FunctionResult { ty, binding: None }))
    }
}
