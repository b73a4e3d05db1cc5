//! Built-in variables (GLSL 4.60, chapter 7; GLSL 1.20, chapter 7), made when they are first named.

use std::sync::Arc;

use naga::{BuiltIn, Expression, GlobalVariable, Handle, Literal};

use super::global::Global;
use super::image::ImageLayout;
use super::{Build, Result};
use crate::PortAt;
use base::text::Span;
use syntax::Stage;
use syntax::ast::ExprKind;
use syntax::symbols::SymbolId;
use syntax::types::{ArraySize, ScalarType, StructType, Type};

/// An input of a stage that is no variable of the author: what naga calls it, and its type there.
fn input(name: &str, stage: Stage) -> Option<(BuiltIn, Type)> {
    let uvec3 = || Type::Vector(ScalarType::Uint, 3);
    Some(match (stage, name) {
        (Stage::Vertex, "gl_VertexID" | "gl_VertexIndex") => (BuiltIn::VertexIndex, Type::UINT),
        (Stage::Vertex, "gl_InstanceID" | "gl_InstanceIndex") => (BuiltIn::InstanceIndex, Type::UINT),
        (Stage::Vertex, "gl_BaseVertex" | "gl_BaseVertexARB") => (BuiltIn::BaseVertex, Type::UINT),
        (Stage::Vertex, "gl_BaseInstance" | "gl_BaseInstanceARB") => (BuiltIn::BaseInstance, Type::UINT),
        (Stage::Vertex, "gl_DrawID" | "gl_DrawIDARB") => (BuiltIn::DrawIndex, Type::UINT),
        (Stage::Fragment, "gl_FragCoord") => (BuiltIn::Position { invariant: false }, Type::VEC4),
        (Stage::Fragment, "gl_FrontFacing") => (BuiltIn::FrontFacing, Type::BOOL),
        (Stage::Fragment, "gl_PointCoord") => (BuiltIn::PointCoord, Type::VEC2),
        (Stage::Fragment, "gl_PrimitiveID") => (BuiltIn::PrimitiveIndex, Type::UINT),
        (Stage::Fragment, "gl_SampleID") => (BuiltIn::SampleIndex, Type::UINT),
        (Stage::Fragment, "gl_SampleMaskIn") => (BuiltIn::SampleMask, Type::UINT),
        (Stage::Compute, "gl_NumWorkGroups") => (BuiltIn::NumWorkGroups, uvec3()),
        (Stage::Compute, "gl_WorkGroupID") => (BuiltIn::WorkGroupId, uvec3()),
        (Stage::Compute, "gl_LocalInvocationID") => (BuiltIn::LocalInvocationId, uvec3()),
        (Stage::Compute, "gl_GlobalInvocationID") => (BuiltIn::GlobalInvocationId, uvec3()),
        (Stage::Compute, "gl_LocalInvocationIndex") => (BuiltIn::LocalInvocationIndex, Type::UINT),
        (Stage::Compute, "gl_SubgroupSize") => (BuiltIn::SubgroupSize, Type::UINT),
        (Stage::Compute, "gl_SubgroupInvocationID") => (BuiltIn::SubgroupInvocationId, Type::UINT),
        (Stage::Compute, "gl_SubgroupID") => (BuiltIn::SubgroupId, Type::UINT),
        (Stage::Compute, "gl_NumSubgroups") => (BuiltIn::NumSubgroups, Type::UINT),
        _ => return None,
    })
}

/// How a built-in output leaves its stage.
enum BuiltinOutput {
    /// naga has it under this name.
    BuiltIn(BuiltIn),
    /// naga has none: it is a varying like others, at this location or the next one that is free.
    Varying(Option<u32>),
    /// The stage is none that naga has: only the harness reads it.
    Harness,
}

/// An output of a stage that is no variable of the author.
fn output(name: &str, stage: Stage) -> Option<BuiltinOutput> {
    Some(match (stage, name) {
        (Stage::Vertex, "gl_Position") => BuiltinOutput::BuiltIn(BuiltIn::Position { invariant: false }),
        (Stage::Vertex, "gl_PointSize") => BuiltinOutput::BuiltIn(BuiltIn::PointSize),
        (Stage::Vertex, "gl_ClipDistance") => BuiltinOutput::BuiltIn(BuiltIn::ClipDistances),
        (Stage::Vertex, "gl_CullDistance") => BuiltinOutput::BuiltIn(BuiltIn::CullDistance),
        (Stage::Vertex, "gl_Layer" | "gl_ViewportIndex") => BuiltinOutput::Varying(None),
        (Stage::Vertex, _) if is_old_varying(name) && !is_old_attribute(name) => BuiltinOutput::Varying(None),
        (Stage::Fragment, "gl_FragDepth" | "gl_FragDepthEXT") => BuiltinOutput::BuiltIn(BuiltIn::FragDepth),
        (Stage::Fragment, "gl_SampleMask") => BuiltinOutput::BuiltIn(BuiltIn::SampleMask),
        (Stage::Fragment, "gl_FragColor" | "gl_FragData") => BuiltinOutput::Varying(Some(0)),
        (
            Stage::Geometry | Stage::TessEvaluation,
            "gl_Position" | "gl_PointSize" | "gl_ClipDistance" | "gl_CullDistance" | "gl_Layer" | "gl_ViewportIndex",
        )
        | (Stage::Geometry, "gl_PrimitiveID")
        | (Stage::TessControl, "gl_out" | "gl_TessLevelOuter" | "gl_TessLevelInner") => BuiltinOutput::Harness,
        (Stage::Geometry, _) if is_old_varying(name) => BuiltinOutput::Harness,
        _ => return None,
    })
}

/// Those of the old pipeline that the host gives to each vertex.
fn is_old_attribute(name: &str) -> bool {
    matches!(name, "gl_Vertex" | "gl_Normal" | "gl_Color" | "gl_SecondaryColor" | "gl_FogCoord")
        || name.starts_with("gl_MultiTexCoord")
}

/// Variables of the old pipeline that go from the host to the vertex stage, or from stage to stage.
fn is_old_varying(name: &str) -> bool {
    let names = [
        "gl_FrontColor",
        "gl_BackColor",
        "gl_FrontSecondaryColor",
        "gl_BackSecondaryColor",
        "gl_TexCoord",
        "gl_FogFragCoord",
        "gl_ClipVertex",
    ];
    names.contains(&name) || is_old_attribute(name)
}

impl Build<'_> {
    /// Makes a built-in variable.
    pub(super) fn builtin(&mut self, symbol: SymbolId, span: Span) -> Result<()> {
        let info = self.shader.symbol(symbol);
        let name = info.name.clone();
        if let Some(n) = self.limit(&name) {
            self.made.globals.insert(symbol, Global::Number(n));
            return Ok(());
        }
        if let Some(op) = super::subgroup::mask(&name) {
            self.made.globals.insert(symbol, Global::SubgroupMask(op));
            return Ok(());
        }
        if self.numbers_by_index(&name) {
            self.made.globals.insert(symbol, Global::ByIndex(name));
            return Ok(());
        }
        let ty = match name.as_str() {
            "gl_in" => self.per_vertex(&info.ty, self.vertices_taken())?,
            "gl_out" => self.per_vertex(&info.ty, self.vertices_given())?,
            _ => self.with_size(symbol, &info.ty),
        };
        if ty.contains_opaque() {
            let global = Global::Opaque { key: name, ty, data: None, image: ImageLayout::default() };
            self.made.globals.insert(symbol, global);
            return Ok(());
        }
        let written = self.shader.is_written(symbol);
        let handle = self.make_builtin(&name, &ty, written, span)?;
        if info.read_only && !is_state(&name) {
            self.ports.stage_inputs.push((name, handle, span));
        }
        self.made.globals.insert(symbol, Global::Whole { handle, ty });
        Ok(())
    }

    /// A built-in variable that the text does not name, such as the matrix of `ftransform`.
    pub(super) fn named_builtin(&mut self, name: &str, span: Span) -> Result<(Handle<GlobalVariable>, Type)> {
        let ty = match name {
            "gl_Vertex" | "gl_FragCoord" => Type::VEC4,
            "gl_LocalInvocationIndex" => Type::UINT,
            _ if name.starts_with("gl_Subgroup") => Type::UINT,
            _ => Type::MAT4,
        };
        if let Some(symbol) = self.shader.builtin(name) {
            if !self.made.globals.contains_key(&symbol) {
                self.builtin(symbol, span)?;
            }
            if let Some(Global::Whole { handle, .. }) = self.made.globals.get(&symbol) {
                return Ok((*handle, ty));
            }
        }
        if let Some(&handle) = self.made.unnamed.get(name) {
            return Ok((handle, ty));
        }
        let handle = self.make_builtin(name, &ty, false, span)?;
        if ty == Type::UINT {
            self.ports.stage_inputs.push((name.to_owned(), handle, span));
        }
        self.made.unnamed.insert(name.to_owned(), handle);
        Ok((handle, ty))
    }

    fn make_builtin(&mut self, name: &str, ty: &Type, written: bool, span: Span) -> Result<Handle<GlobalVariable>> {
        let stage = self.shader.stage();
        if let Some((built_in, given)) = input(name, stage) {
            let handle = self.private(name, ty, span)?;
            // The mask is an array of words, of which there is one.
            let (path, kept) = match ty {
                Type::Array(element, _) => (vec![0], element.as_ref().clone()),
                _ => (Vec::new(), ty.clone()),
            };
            self.built_in_input(name, &given, &kept, (handle, path), built_in, span)?;
            return Ok(handle);
        }
        if let Some(output) = output(name, stage) {
            return self.make_output(name, ty, output, written, span);
        }
        match (stage, name) {
            (
                Stage::Fragment,
                "gl_Layer" | "gl_ViewportIndex" | "gl_SamplePosition" | "gl_ClipDistance" | "gl_CullDistance",
            ) => self.varying_in(name, ty, ty, span),
            (Stage::Fragment, "gl_HelperInvocation") => {
                let start = self.ports.incoming.len();
                let handle = self.varying_in(name, ty, &Type::UINT, span)?;
                // The argument is a number, which is turned where it is kept.
                for incoming in self.ports.incoming.iter_mut().skip(start) {
                    incoming.ty = Type::BOOL;
                }
                Ok(handle)
            }
            (Stage::Fragment, "gl_NumSamples") => self.uniform(name, ty, span),
            (Stage::Geometry, "gl_InvocationID") => self.private(name, ty, span),
            (Stage::Geometry, "gl_PrimitiveIDIn")
            | (Stage::TessControl | Stage::TessEvaluation, "gl_PatchVerticesIn" | "gl_PrimitiveID")
            | (Stage::TessControl, "gl_InvocationID")
            | (Stage::TessEvaluation, "gl_TessCoord" | "gl_TessLevelOuter" | "gl_TessLevelInner") => {
                let handle = self.private(name, ty, span)?;
                self.port_in(name, ty, PortAt::Global(handle), span)?;
                Ok(handle)
            }
            (Stage::Geometry | Stage::TessControl | Stage::TessEvaluation, "gl_in") => {
                let handle = self.private(name, ty, span)?;
                let others = std::mem::take(&mut self.ports.inputs);
                self.vertices(name, ty, handle, span)?;
                self.ports.inputs.extend(others);
                Ok(handle)
            }
            (Stage::Compute, "gl_WorkGroupSize") => self.workgroup_size(name, ty, span),
            (Stage::Vertex | Stage::Fragment, _) if is_old_varying(name) => self.varying_in(name, ty, ty, span),
            (_, _) if is_state(name) => self.uniform(name, ty, span),
            (Stage::Library, _) => self.private(name, ty, span),
            (_, _) => {
                let message = format!("the built-in variable `{name}`");
                Err(self.unsupported(span, message, "pass the value as a variable of your own"))
            }
        }
    }

    fn make_output(
        &mut self,
        name: &str,
        ty: &Type,
        output: BuiltinOutput,
        written: bool,
        span: Span,
    ) -> Result<Handle<GlobalVariable>> {
        let handle = self.private(name, ty, span)?;
        match output {
            // The mask is an array of words, of which there is one.
            BuiltinOutput::BuiltIn(BuiltIn::SampleMask) => {
                self.built_in_output(name, &Type::INT, handle, vec![0], BuiltIn::SampleMask);
            }
            BuiltinOutput::BuiltIn(built_in) => self.built_in_output(name, ty, handle, Vec::new(), built_in),
            BuiltinOutput::Varying(first) => self.located_output(name, ty, (handle, &[]), first, &[], span)?,
            BuiltinOutput::Harness => {}
        }
        // What a vertex always has is an output only if the text writes it.
        let of_vertex = matches!(name, "gl_Position" | "gl_PointSize" | "gl_ClipDistance" | "gl_CullDistance");
        if written || !of_vertex {
            let ports = self.port_out(name, ty, handle, span)?;
            self.ports.built_in_outputs.extend(ports);
        }
        Ok(handle)
    }

    /// An input that naga has no name for, as a varying of the type that naga takes for it.
    fn varying_in(&mut self, name: &str, ty: &Type, given: &Type, span: Span) -> Result<Handle<GlobalVariable>> {
        let handle = self.private(name, ty, span)?;
        self.located_input(name, given, (handle, &[]), None, &[], span)?;
        Ok(handle)
    }

    fn workgroup_size(&mut self, name: &str, ty: &Type, span: Span) -> Result<Handle<GlobalVariable>> {
        let handle = self.private(name, ty, span)?;
        let ty = self.value_type(ty, span)?;
        let expressions = &mut self.module.global_expressions;
        let mut add = |expression| expressions.append(expression, naga::Span::UNDEFINED);
        let components = self.workgroup.map(|n| add(Expression::Literal(Literal::U32(n)))).to_vec();
        let init = add(Expression::Compose { ty, components });
        self.module.global_variables[handle].init = Some(init);
        Ok(handle)
    }

    /// `gl_in` or `gl_out` with the members that the text names, so that only these are fed and read.
    fn per_vertex(&self, ty: &Type, count: u32) -> Result<Type> {
        let element = match ty {
            Type::Array(element, _) => element.as_ref(),
            other => other,
        };
        let Type::Struct(s) = element else { return Ok(ty.clone()) };
        let uses = |name: &str| {
            self.shader
                .arena()
                .iter()
                .filter_map(|(id, e)| match &e.kind {
                    ExprKind::Field { base, field } if field.name == name => Some((id, *base)),
                    _ => None,
                })
                .any(|(_, base)| matches!(self.shader.expr(base).kind, ExprKind::Index { .. }))
        };
        let mut fields = Vec::new();
        for field in s.fields.iter().filter(|f| f.name == "gl_Position" || uses(&f.name)) {
            let mut field = field.clone();
            if let Type::Array(element, ArraySize::Unsized | ArraySize::Unknown) = &field.ty {
                let whole = self.taken_whole(&field.name);
                field.ty = element.as_ref().clone().array(if whole { 8 } else { self.greatest_index(&field.name) });
            }
            fields.push(field);
        }
        let element = Type::Struct(Arc::new(StructType { name: "gl_PerVertex".to_owned(), fields, span: s.span }));
        Ok(Type::Array(Arc::new(element), ArraySize::Known(count)))
    }

    pub(super) fn greatest_index(&self, field: &str) -> u32 {
        let mut most = 1;
        for (_, expr) in self.shader.arena().iter() {
            let ExprKind::Index { base, index } = expr.kind else { continue };
            let ExprKind::Field { field: name, .. } = &self.shader.expr(base).kind else { continue };
            if name.name == field {
                let known = self.shader.fold(index).and_then(|c| c.as_integer()).and_then(|n| u32::try_from(n).ok());
                most = most.max(known.map_or(8, |n| n + 1));
            }
        }
        most
    }
}

/// True for what the host sets once for many vertices.
fn is_state(name: &str) -> bool {
    let starts = [
        "gl_ModelView",
        "gl_Projection",
        "gl_TextureMatrix",
        "gl_TextureEnv",
        "gl_EyePlane",
        "gl_ObjectPlane",
        "gl_LightModel",
        "gl_FrontLight",
        "gl_BackLight",
        "gl_Fog",
    ];
    let names = [
        "gl_NormalMatrix",
        "gl_NormalScale",
        "gl_ClipPlane",
        "gl_DepthRange",
        "gl_LightSource",
        "gl_FrontMaterial",
        "gl_BackMaterial",
        "gl_Point",
    ];
    names.contains(&name) || starts.iter().any(|s| name.starts_with(s))
}
