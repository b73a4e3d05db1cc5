//! Variables at file scope and built-in ones.

use std::sync::Arc;

use naga::{AddressSpace, Expression, GlobalVariable, Handle, Literal, StorageAccess, TypeInner};

use super::function::{Fun, Val};
use super::image::ImageLayout;
use super::place::{Lvalue, Var};
use super::statement::with_length;
use super::texture::{Data, Opaque};
use super::types::{TypeLayout, has_data};
use super::{Build, Result};
use base::text::Span;
use syntax::Const;
use syntax::ast::{BinaryOp, Callee, ExprId, ExprKind, Ident, UnaryOp};
use syntax::interface::{self, Storage};
use syntax::symbols::{SymbolId, SymbolKind};
use syntax::types::{ArraySize, ScalarType, Type};

/// A variable that functions of the module reach.
#[derive(Clone, Debug)]
pub(super) enum Global {
    /// A variable of its own.
    Whole { handle: Handle<GlobalVariable>, ty: Type },
    /// A member of a block.
    Member { handle: Handle<GlobalVariable>, index: u32, ty: Type },
    /// A constant, computed where it is used.
    Constant { value: ExprId, ty: Type },
    /// Samplers or images, with the rest of a structure around them.
    Opaque { key: String, ty: Type, data: Option<Handle<GlobalVariable>>, image: ImageLayout },
    /// A number that the language knows.
    Number(i32),
    /// A number in a subgroup that follows from the number in the workgroup.
    ByIndex(String),
    /// Bits of the invocations of a subgroup whose numbers compare so with the own one.
    SubgroupMask(BinaryOp),
}

impl<'s> Build<'s> {
    /// The symbols that a declared name makes. A macro that declares a name twice has one place for both.
    pub(super) fn declared(&self, name: &Ident) -> Vec<SymbolId> {
        self.made.by_place.get(&(name.span.start, name.name.clone())).cloned().unwrap_or_default()
    }

    /// The initialiser of a constant.
    pub(super) fn initializer(&self, symbol: SymbolId) -> Option<ExprId> {
        let interface = self.shader.interface();
        let global = interface.constants.iter().find(|v| v.symbol == symbol).and_then(|v| v.initializer);
        global.or_else(|| self.made.local_constants.get(&symbol).copied())
    }

    /// An array without a written size takes the one of its initialiser, or of its greatest index.
    pub(super) fn with_size(&self, symbol: SymbolId, ty: &Type) -> Type {
        let Type::Array(element, ArraySize::Unsized | ArraySize::Unknown) = ty else { return ty.clone() };
        let name = &self.shader.symbol(symbol).name;
        if let Some(n) = self.builtin_length(name) {
            return element.as_ref().clone().array(n);
        }
        let mut most = 0;
        for (_, expr) in self.shader.arena().iter() {
            let ExprKind::Index { base, index } = expr.kind else { continue };
            if self.shader.symbol_of(base) == Some(symbol)
                && matches!(self.shader.expr(base).kind, ExprKind::Name(_))
                && let Some(k) = self.shader.fold(index).and_then(Const::as_integer)
            {
                most = most.max(u32::try_from(k + 1).unwrap_or(0));
            }
        }
        match most {
            // A built-in array that is only used as a whole: the least that an implementation must have.
            0 if name.starts_with("gl_") => with_length(ty, 8),
            0 => ty.clone(),
            _ => with_length(ty, most),
        }
    }

    /// The dimensions of a variable as written, outermost first.
    pub(super) fn dims_of(&self, v: &'s interface::Variable) -> Vec<&'s syntax::ast::ArrayDim> {
        let of_type = match self.shader.unit().items.get(v.item).map(|i| &i.kind) {
            Some(syntax::ast::ItemKind::Declaration(d)) => d.ty.dims.as_slice(),
            _ => &[],
        };
        v.dims.iter().chain(of_type).collect()
    }

    fn builtin_length(&self, name: &str) -> Option<u32> {
        Some(match name {
            "gl_LightSource"
            | "gl_FrontLightProduct"
            | "gl_BackLightProduct"
            | "gl_ClipPlane"
            | "gl_TextureMatrix"
            | "gl_TextureMatrixInverse"
            | "gl_TextureMatrixTranspose"
            | "gl_TextureMatrixInverseTranspose"
            | "gl_TextureEnvColor"
            | "gl_EyePlaneS"
            | "gl_EyePlaneT"
            | "gl_EyePlaneR"
            | "gl_EyePlaneQ"
            | "gl_ObjectPlaneS"
            | "gl_ObjectPlaneT"
            | "gl_ObjectPlaneR"
            | "gl_ObjectPlaneQ" => 8,
            "gl_SampleMask" | "gl_SampleMaskIn" => 1,
            "gl_in" => self.vertices_taken(),
            "gl_TexCoord" | "gl_FragData" if self.indexed_freely(name) => 8,
            "gl_ClipDistance" | "gl_CullDistance" if self.indexed_freely(name) || self.taken_whole(name) => 8,
            _ => return None,
        })
    }

    /// True when an index into a built-in array is computed.
    fn indexed_freely(&self, name: &str) -> bool {
        self.shader.arena().iter().any(|(_, e)| match e.kind {
            ExprKind::Index { base, index } => {
                let named = match &self.shader.expr(base).kind {
                    ExprKind::Name(n) => n == name,
                    ExprKind::Field { field, .. } => field.name == name,
                    _ => false,
                };
                named && self.shader.fold(index).is_none()
            }
            _ => false,
        })
    }

    /// A type whose size is that of the memory.
    pub(super) fn sized(&self, ty: &Type, host: Handle<naga::Type>) -> Type {
        match (ty, &self.module.types[host].inner) {
            (
                Type::Array(element, ArraySize::Unsized | ArraySize::Unknown),
                TypeInner::Array { size: naga::ArraySize::Constant(n), .. },
            ) => Type::Array(element.clone(), ArraySize::Known(n.get())),
            _ => ty.clone(),
        }
    }

    /// Adds a variable without a binding.
    pub(super) fn variable(
        &mut self,
        name: &str,
        space: AddressSpace,
        ty: Handle<naga::Type>,
    ) -> Handle<GlobalVariable> {
        super::super::capture::add_global(&mut self.module, name, space, None, ty)
    }

    /// A variable of the module alone, all zero at the start.
    pub(super) fn private(&mut self, name: &str, ty: &Type, span: Span) -> Result<Handle<GlobalVariable>> {
        let host = self.value_type(ty, span)?;
        Ok(self.variable(name, AddressSpace::Private, host))
    }

    /// A uniform. It stands in a block of its own, so that its place can be laid out.
    pub(super) fn uniform(&mut self, name: &str, ty: &Type, span: Span) -> Result<Handle<GlobalVariable>> {
        let host = self.make(ty, TypeLayout::Uniform, span)?;
        let handle = self.with_binding(name, AddressSpace::Uniform, host);
        self.uniform_ports(handle, host, name, ty, span);
        Ok(handle)
    }

    /// Makes the variables of the interface, in the order of the text.
    pub(super) fn declare(&mut self) -> Result<()> {
        let interface = self.shader.interface();
        for symbol in self.shader.symbols().filter(|(_, s)| s.span.is_some()) {
            let (id, symbol) = symbol;
            let place = symbol.span.unwrap_or_default().start;
            self.made.by_place.entry((place, symbol.name.clone())).or_default().push(id);
        }
        let mut items: Vec<(usize, usize, Declared<'s>)> = Vec::new();
        for v in &interface.uniforms {
            items.push((v.item, v.position, Declared::Uniform(v)));
        }
        for v in interface.globals.iter().chain(&interface.constants) {
            items.push((v.item, v.position, Declared::Global(v)));
        }
        for (k, b) in interface.blocks.iter().enumerate() {
            items.push((b.item, 0, Declared::Block(k)));
        }
        for v in &interface.inputs {
            items.push((v.item, v.position, Declared::Input(v)));
        }
        for v in &interface.outputs {
            items.push((v.item, v.position, Declared::Output(v)));
        }
        items.sort_by_key(|(item, position, _)| (*item, *position));
        for (_, _, item) in items {
            match item {
                Declared::Uniform(v) => self.declare_uniform(v)?,
                Declared::Global(v) => self.declare_global(v)?,
                Declared::Block(k) => self.declare_block(k)?,
                Declared::Input(v) => self.declare_input(v)?,
                Declared::Output(v) => self.declare_output(v)?,
            }
        }
        Ok(())
    }

    fn declare_uniform(&mut self, v: &'s interface::Variable) -> Result<()> {
        if self.made.globals.contains_key(&v.symbol) {
            return Ok(());
        }
        if v.qualifiers.is_subroutine() {
            return Err(self.unsupported(v.name_span, "a subroutine uniform", "call one of its functions instead"));
        }
        let ty = self.with_size(v.symbol, &self.with_dims(&v.ty, &self.dims_of(v)));
        // A sampler without a texture: each lookup has one of its own. Any other use of it is refused where it stands.
        let vulkan = || self.shader.extensions().iter().any(|e| e.name == "GL_KHR_vulkan_glsl");
        if ty.is_error() && vulkan() {
            return Ok(());
        }
        let global = if ty.contains_opaque() {
            let data = if has_data(&ty) { Some(self.uniform(&v.name, &ty, v.name_span)?) } else { None };
            Global::Opaque { key: v.name.clone(), ty, data, image: ImageLayout::of(&v.qualifiers) }
        } else {
            if matches!(&ty, Type::Array(_, ArraySize::Unsized)) {
                // Never indexed with a number, so never read: nothing to make.
                return Ok(());
            }
            Global::Whole { handle: self.uniform(&v.name, &ty, v.name_span)?, ty }
        };
        self.made.globals.insert(v.symbol, global);
        Ok(())
    }

    fn declare_global(&mut self, v: &'s interface::Variable) -> Result<()> {
        if self.shader.uses_of(v.symbol).next().is_none() || self.made.globals.contains_key(&v.symbol) {
            return Ok(());
        }
        let shared = v.storage == Storage::Shared;
        let mut ty = self.with_size(v.symbol, &self.with_dims(&v.ty, &self.dims_of(v)));
        if let (Some(value), Type::Array(_, ArraySize::Unsized | ArraySize::Unknown)) = (v.initializer, &ty) {
            ty = self.shader.type_of(value).clone();
        }
        if v.storage == Storage::Const
            && matches!(ty, Type::Scalar(_) | Type::Vector(..))
            && let Some(value) = v.initializer
        {
            self.made.globals.insert(v.symbol, Global::Constant { value, ty });
            return Ok(());
        }
        let handle = if shared {
            let mut host = self.value_type(&ty, v.name_span)?;
            if self.has_atomics(&v.name) {
                host = self.atomic_type(host);
            }
            self.variable(&v.name, AddressSpace::WorkGroup, host)
        } else {
            self.private(&v.name, &ty, v.name_span)?
        };
        if let Some(value) = v.initializer {
            // Each invocation of a geometry stage starts anew.
            let again = self.shader.interface().geometry.invocations.is_some_and(|n| n.value > 1);
            let constant = if again && v.storage != Storage::Const { None } else { self.constant(value, &ty)? };
            match constant {
                Some(init) => self.module.global_variables[handle].init = Some(init),
                None => self.made.initial.push((v.symbol, value)),
            }
        }
        self.made.globals.insert(v.symbol, Global::Whole { handle, ty });
        Ok(())
    }

    /// A constant that is written out, as naga keeps it beside the functions.
    fn constant(&mut self, id: ExprId, want: &Type) -> Result<Option<Handle<Expression>>> {
        let expr = self.shader.expr(id);
        let add = |b: &mut Self, e| b.module.global_expressions.append(e, super::naga_span(expr.span));
        if let Type::Scalar(scalar) = want {
            let literal = match (self.number(id, 0), scalar) {
                #[expect(clippy::cast_possible_truncation, reason = "a literal of `float` is rounded so")]
                (Some(v), ScalarType::Float) if (v as f32).is_finite() => Literal::F32(v as f32),
                (Some(v), ScalarType::Double) => Literal::F64(v),
                _ => match (self.shader.fold(id), scalar) {
                    (Some(Const::Bool(v)), ScalarType::Bool) => Literal::Bool(v),
                    (Some(Const::Int(v)), ScalarType::Int) => Literal::I32(v),
                    (Some(Const::Int(v)), ScalarType::Uint) => Literal::U32(v.cast_unsigned()),
                    (Some(Const::Uint(v)), ScalarType::Uint) => Literal::U32(v),
                    _ => return Ok(None),
                },
            };
            return Ok(Some(add(self, Expression::Literal(literal))));
        }
        let (parts, args): (Vec<Type>, &[ExprId]) = match &expr.kind {
            ExprKind::Paren(inner) => return self.constant(*inner, want),
            ExprKind::List(items) => (self.parts(want), items),
            ExprKind::Call { callee: Callee::Type(_) | Callee::Name(_), args }
                if super::types::same(self.shader.type_of(id), want) && self.shader.constructor(id).is_some() =>
            {
                (self.parts(want), args)
            }
            _ => return Ok(None),
        };
        let splat = matches!(want, Type::Vector(..)) && args.len() == 1;
        if (args.len() != parts.len() && !splat) || matches!(want, Type::Matrix(..)) && args.len() != parts.len() {
            return Ok(None);
        }
        let mut components = Vec::new();
        for (k, part) in parts.iter().enumerate() {
            let arg = args[if splat { 0 } else { k }];
            if splat && !self.shader.type_of(arg).is_scalar() {
                return Ok(None);
            }
            let Some(part) = self.constant(arg, part)? else { return Ok(None) };
            components.push(part);
        }
        let ty = self.value_type(want, expr.span)?;
        Ok(Some(add(self, Expression::Compose { ty, components })))
    }

    fn parts(&self, ty: &Type) -> Vec<Type> {
        match ty {
            Type::Struct(s) => s.fields.iter().map(|f| f.ty.clone()).collect(),
            Type::Vector(..) | Type::Matrix(..) | Type::Array(..) => {
                vec![ty.indexed().unwrap_or(Type::Error); super::types::count(ty) as usize]
            }
            Type::Scalar(_) | Type::Void | Type::Error | Type::Opaque(_) => Vec::new(),
        }
    }

    /// A number as it is meant, not yet rounded.
    fn number(&self, id: ExprId, depth: u32) -> Option<f64> {
        use syntax::ast::Literal as L;
        let real = self.reals.get(id).filter(|real| *real.ty() == Type::FLOAT);
        if let Some(real) = real {
            return real.values().first().copied();
        }
        match &self.shader.expr(id).kind {
            ExprKind::Literal(L::Float(v) | L::Double(v)) => Some(*v),
            ExprKind::Literal(L::Int(v)) => Some(f64::from(*v)),
            ExprKind::Literal(L::Uint(v)) => Some(f64::from(*v)),
            ExprKind::Paren(inner) if depth < 32 => self.number(*inner, depth + 1),
            ExprKind::Unary { op: UnaryOp::Minus, operand, .. } if depth < 32 => {
                self.number(*operand, depth + 1).map(|v| -v)
            }
            _ => self.shader.fold(id).filter(|c| c.as_integer().is_some()).and_then(Const::as_f64),
        }
    }

    fn declare_block(&mut self, index: usize) -> Result<()> {
        let block = &self.shader.interface().blocks[index];
        let Some(ty) = self.block_type(index) else { return Ok(()) };
        let span = block.name.span;
        let name = block.instance.as_ref().map_or(&block.name.name, |i| &i.name).clone();
        let (handle, host) = match block.storage {
            Storage::Uniform => {
                let host = self.make(&ty, TypeLayout::Uniform, span)?;
                (self.with_binding(&name, AddressSpace::Uniform, host), host)
            }
            Storage::Buffer => {
                let mut host = self.storage(&ty, span)?;
                if self.has_atomics(&name) || block.members.iter().any(|m| self.has_atomics(&m.name.name)) {
                    host = self.atomic_type(host);
                }
                let access = StorageAccess::LOAD | StorageAccess::STORE;
                let handle = self.with_binding(&name, AddressSpace::Storage { access }, host);
                self.memory_of(index, handle, &ty);
                (handle, host)
            }
            _ => {
                let host = self.value_type(&ty, span)?;
                (self.variable(&name, AddressSpace::Private, host), host)
            }
        };
        let prefix = block.instance.as_ref().map_or(String::new(), |i| i.name.clone());
        match block.storage {
            Storage::Uniform => self.uniform_ports(handle, host, &prefix, &ty, span),
            Storage::In => self.block_input(index, handle, &prefix, &ty)?,
            Storage::Out => self.block_output(index, handle, &prefix, &ty)?,
            _ => {}
        }
        if let Some(symbol) = block.symbol {
            self.made.globals.insert(symbol, Global::Whole { handle, ty });
            return Ok(());
        }
        let Type::Struct(s) = &ty else { return Ok(()) };
        for member in &block.members {
            let (Some(symbol), Some(index)) = (member.symbol, Self::member_index(s, &member.name.name)) else {
                continue;
            };
            let field = s.fields.iter().find(|f| f.name == member.name.name);
            let ty = field.map_or(Type::Error, |f| f.ty.clone());
            self.made.globals.insert(symbol, Global::Member { handle, index, ty });
        }
        Ok(())
    }

    /// Type of a storage block, or of an array of them: these are bound one by one.
    fn storage(&mut self, ty: &Type, span: Span) -> Result<Handle<naga::Type>> {
        match ty {
            Type::Array(element, ArraySize::Known(n)) if matches!(**element, Type::Struct(_)) => {
                let base = self.make(element, TypeLayout::Storage, span)?;
                let size = std::num::NonZeroU32::new(*n).map_or(naga::ArraySize::Dynamic, naga::ArraySize::Constant);
                Ok(self.insert(None, TypeInner::BindingArray { base, size }))
            }
            _ => self.make(ty, TypeLayout::Storage, span),
        }
    }

    /// Type of a block, with the sizes that the text leaves open; `None` for `gl_PerVertex`.
    pub(super) fn block_type(&self, index: usize) -> Option<Type> {
        let block = &self.shader.interface().blocks[index];
        if block.name.name == "gl_PerVertex" || block.name.name.starts_with("gl_") {
            return None;
        }
        let ty = self.sized_members(index, &block.ty);
        Some(match (&ty, self.vertices_of(block.storage, &block.qualifiers)) {
            (Type::Array(..), Some(n)) => with_length(&ty, n),
            _ => match block.symbol {
                Some(symbol) => self.with_size(symbol, &ty),
                None => ty,
            },
        })
    }

    /// Members without a written size take it from the greatest index. The last one of a storage block
    /// is as long as the buffer.
    fn sized_members(&self, index: usize, ty: &Type) -> Type {
        let block = &self.shader.interface().blocks[index];
        match ty {
            Type::Array(element, size) => Type::Array(Arc::new(self.sized_members(index, element)), *size),
            Type::Struct(s) => {
                let mut s = s.as_ref().clone();
                let last = s.fields.len().saturating_sub(1);
                for (k, field) in s.fields.iter_mut().enumerate() {
                    let open = matches!(field.ty, Type::Array(_, ArraySize::Unsized | ArraySize::Unknown));
                    if !open || block.storage == Storage::Buffer && k == last {
                        continue;
                    }
                    let member = block.members.get(k);
                    field.ty = match member.and_then(|m| m.symbol) {
                        Some(symbol) => self.with_size(symbol, &field.ty),
                        None => with_length(&field.ty, self.greatest_index(&field.name)),
                    };
                    // One that is never indexed has one element that nobody reads.
                    field.ty = with_length(&field.ty, 1);
                }
                Type::Struct(Arc::new(s))
            }
            _ => ty.clone(),
        }
    }

    /// True when an atomic function is called on a variable or member of that name.
    fn has_atomics(&self, name: &str) -> bool {
        self.shader.arena().iter().any(|(id, e)| {
            let ExprKind::Call { callee: Callee::Name(callee), args } = &e.kind else { return false };
            let atomic = callee.name.starts_with("atomic") && self.shader.callee(id).is_some();
            atomic && args.first().is_some_and(|&a| self.mentions(a, name))
        })
    }

    fn mentions(&self, id: ExprId, name: &str) -> bool {
        match &self.shader.expr(id).kind {
            ExprKind::Name(n) => n == name,
            ExprKind::Field { base, field } => field.name == name || self.mentions(*base, name),
            ExprKind::Index { base, .. } | ExprKind::Paren(base) => self.mentions(*base, name),
            _ => false,
        }
    }

    /// The same type with atomic integers.
    fn atomic_type(&mut self, ty: Handle<naga::Type>) -> Handle<naga::Type> {
        let old = self.module.types[ty].clone();
        let inner = match old.inner {
            TypeInner::Scalar(s) if matches!(s.kind, naga::ScalarKind::Sint | naga::ScalarKind::Uint) => {
                TypeInner::Atomic(s)
            }
            TypeInner::Array { base, size, stride } => TypeInner::Array { base: self.atomic_type(base), size, stride },
            TypeInner::BindingArray { base, size } => TypeInner::BindingArray { base: self.atomic_type(base), size },
            TypeInner::Struct { mut members, span } => {
                for member in &mut members {
                    member.ty = self.atomic_type(member.ty);
                }
                return self.insert(old.name.map(|n| format!("{n}_atomic")), TypeInner::Struct { members, span });
            }
            _ => return ty,
        };
        self.insert(None, inner)
    }

    /// True for an atomic integer, and for what has one inside.
    pub(super) fn holds_atomics(&self, ty: Handle<naga::Type>) -> bool {
        match &self.module.types[ty].inner {
            TypeInner::Atomic(_) => true,
            TypeInner::Array { base, .. } => self.holds_atomics(*base),
            TypeInner::Struct { members, .. } => members.iter().any(|member| self.holds_atomics(member.ty)),
            _ => false,
        }
    }

    pub(super) fn is_atomic(&self, ty: Handle<naga::Type>) -> bool {
        matches!(self.module.types[ty].inner, TypeInner::Atomic(_))
    }
}

/// Something declared at file scope.
enum Declared<'s> {
    Uniform(&'s interface::Variable),
    Global(&'s interface::Variable),
    Block(usize),
    Input(&'s interface::Variable),
    Output(&'s interface::Variable),
}

impl Fun<'_, '_> {
    /// What a name at file scope means in this function.
    pub(super) fn global(&mut self, symbol: SymbolId, span: Span) -> Result<Option<Var>> {
        let info = self.shader.symbol(symbol);
        if !self.build.made.globals.contains_key(&symbol) {
            match info.kind {
                SymbolKind::Builtin => self.build.builtin(symbol, span)?,
                SymbolKind::Global(_) | SymbolKind::BlockMember(_) | SymbolKind::BlockInstance(_)
                    if info.name.starts_with("gl_") =>
                {
                    self.build.builtin(symbol, span)?;
                }
                SymbolKind::Global(_) | SymbolKind::BlockMember(_) | SymbolKind::BlockInstance(_) => {
                    let message = format!("`{}` of type `{}`", info.name, info.ty);
                    return Err(self.build.unsupported(span, message, "give it another type"));
                }
                SymbolKind::Param(_) | SymbolKind::Local => return Ok(None),
            }
        }
        let Some(global) = self.build.made.globals.get(&symbol).cloned() else { return Ok(None) };
        Ok(Some(match global {
            Global::Whole { handle, ty } => Var::Place(self.whole(handle, ty)),
            Global::Member { handle, index, ty } => {
                let host = self.build.module.global_variables[handle].ty;
                let host = self.build.members(host)[index as usize];
                let base = self.add(Expression::GlobalVariable(handle));
                let ptr = self.add(Expression::AccessIndex { base, index });
                let ty = self.build.sized(&ty, host);
                Var::Place(Lvalue { ptr, ty, host, swizzle: None })
            }
            Global::Constant { value, ty } => {
                // A constant means the same everywhere: names in it are at file scope.
                Var::Value(self.initial(value, &ty)?)
            }
            Global::Opaque { key, ty, data, image } => {
                let data = data.map(|variable| Data { variable, path: Vec::new() });
                Var::Opaque(Opaque { key, ty, data, image })
            }
            Global::Number(n) => Var::Value(Val { e: self.i32(n), ty: Type::INT }),
            Global::ByIndex(name) => Var::Value(Val { e: self.number_of(&name, span)?, ty: Type::UINT }),
            Global::SubgroupMask(op) => Var::Value(self.mask(op, span)?),
        }))
    }

    pub(super) fn whole(&mut self, handle: Handle<GlobalVariable>, ty: Type) -> Lvalue {
        let host = self.build.module.global_variables[handle].ty;
        let ptr = self.add(Expression::GlobalVariable(handle));
        Lvalue { ptr, ty, host, swizzle: None }
    }

    /// A built-in variable that the text does not name.
    pub(super) fn state(&mut self, name: &str, span: Span) -> Result<Val> {
        let handle = self.build.named_builtin(name, span)?;
        let (handle, ty) = handle;
        let place = self.whole(handle, ty);
        self.load(&place)
    }
}

impl Build<'_> {
    /// The value of a limit of the language.
    pub(super) fn limit(&self, name: &str) -> Option<i32> {
        super::limits::limit(name)
    }
}
