//! Calls: constructors, functions of the shader, built-in functions.

use super::super::ast::{Callee, ExprId, ExprKind, Ident, ItemKind};
use super::super::builtin::{self, BuiltinFunction, Signature};
use super::super::constructor::{Constructor, Fit};
use super::super::fold::{self, Const};
use super::super::language::Feature;
use super::super::symbols::{BuiltinCall, CallTarget, Direction, FunctionId};
use super::super::types::{ArraySize, Conversions, ScalarType, Type};
use super::super::{Lacks, errors};
use super::expression::{article, with_near};
use super::overload::{available, cost, to_other};
use super::{Checker, Entry};
use base::diagnostic::message;
use base::text::Span;

/// A function that may be meant.
struct Candidate {
    params: Vec<(Direction, Type)>,
    result: Type,
    user: Option<FunctionId>,
}

impl Checker<'_> {
    pub(super) fn call(&mut self, id: ExprId, callee: &Callee, args: &[ExprId]) -> (Type, Option<Const>) {
        match callee {
            Callee::Type(spec) => {
                let base = self.named_type(&spec.kind, spec.name_span);
                let mut ty = base;
                for dim in spec.dims.iter().rev() {
                    let size = dim.size.map_or(ArraySize::Unsized, |size| self.size_value(size));
                    ty = Type::Array(std::sync::Arc::new(ty), size);
                }
                self.constructor(id, ty, spec.span, args)
            }
            Callee::Name(name) => match self.lookup(&name.name) {
                Some(Entry::Structure(s)) => {
                    let ty = Type::Struct(std::sync::Arc::clone(s));
                    self.constructor(id, ty, name.span, args)
                }
                // Functions have names of their own in the first version.
                Some(Entry::Variable(_))
                    if self.language.number() == 110 && self.functions.contains_key(&name.name) =>
                {
                    self.function_call(id, name, args)
                }
                // A variable of a subroutine type, or of one that is not known.
                Some(Entry::Variable(v)) if self.out.symbols[v.index()].ty.is_error() => (Type::Error, None),
                Some(Entry::Variable(_)) => {
                    let message = format!("`{}` is a variable and cannot be called", name.name);
                    self.sink.error(errors::UNKNOWN_FUNCTION, name.span, message, "called here");
                    (Type::Error, None)
                }
                None => self.function_call(id, name, args),
            },
        }
    }

    fn constructor(&mut self, id: ExprId, ty: Type, span: Span, args: &[ExprId]) -> (Type, Option<Const>) {
        let types: Vec<Type> = args.iter().map(|a| self.type_of(*a).clone()).collect();
        let ty = match ty {
            // `float[](a, b)` has as many elements as arguments.
            Type::Array(element, ArraySize::Unsized) => {
                let n = u32::try_from(args.len()).unwrap_or(u32::MAX);
                let element = match (element.as_ref(), types.first()) {
                    // The same for inner dimensions.
                    (Type::Array(_, ArraySize::Unsized), Some(first @ Type::Array(..))) => first.clone().into(),
                    _ => element,
                };
                Type::Array(element, ArraySize::Known(n))
            }
            other => other,
        };
        self.out.calls[id.index()] = Some(CallTarget::Constructor(ty.clone()));
        if matches!(ty, Type::Array(..)) {
            self.need(Feature::StructArrayConstructors, span);
        }
        let good = match &ty {
            Type::Error => false,
            // Vulkan makes a sampler of a texture and a plain sampler.
            Type::Opaque(_) if self.language.is_open() => true,
            Type::Void | Type::Opaque(_) => {
                let message = format!("{} `{ty}` cannot be constructed", article(&ty));
                self.sink.error(errors::CONSTRUCTOR, span, message, "no constructor");
                false
            }
            Type::Scalar(_) | Type::Vector(..) | Type::Matrix(..) => {
                let mut good = true;
                for (arg, arg_ty) in args.iter().zip(&types) {
                    let handle = self.language.bindless() && matches!(arg_ty, Type::Opaque(_));
                    if arg_ty.components().is_none() && !arg_ty.is_error() && !handle {
                        let message = format!(
                            "{} `{arg_ty}` has no components to build {} `{ty}` from",
                            article(arg_ty),
                            article(&ty)
                        );
                        let label = format!("this is {} `{arg_ty}`", article(arg_ty));
                        self.sink.error(errors::CONSTRUCTOR, self.arena.get(*arg).span, message, label);
                        good = false;
                    }
                }
                good && self.matrix_rules(&ty, args, &types)
                    && match Constructor::new(&ty, &types).fit {
                        Fit::Fits | Fit::Unknown => true,
                        Fit::TooMany { first_extra } => {
                            self.too_many(&ty, span, first_extra, args, &types);
                            false
                        }
                        Fit::TooFew { given } => {
                            self.too_few(&ty, span, given);
                            false
                        }
                    }
            }
            Type::Struct(s) => {
                let fields: Vec<Type> = s.fields.iter().map(|f| f.ty.clone()).collect();
                self.elements(&ty, span, &fields, args, &types, "members")
            }
            Type::Array(element, size) => {
                let n = match size {
                    ArraySize::Known(n) => usize::try_from(*n).unwrap_or(usize::MAX),
                    ArraySize::Unsized | ArraySize::Unknown => args.len(),
                };
                if args.len() == n {
                    let wanted = vec![element.as_ref().clone(); n];
                    self.elements(&ty, span, &wanted, args, &types, "elements")
                } else {
                    self.count(&ty, span, n, (args, &types), "elements");
                    false
                }
            }
        };
        if !good {
            return (Type::Error, None);
        }
        let value = match args {
            [one] => self.value_of(*one).and_then(|v| fold::convert(v, &ty)),
            _ => None,
        };
        (ty, value)
    }

    /// The arguments of a constructor from `first` on give nothing.
    fn too_many(&mut self, ty: &Type, span: Span, first: usize, args: &[ExprId], types: &[Type]) {
        // What depends on something unknown stays silent.
        let given: Option<Vec<usize>> = types.iter().map(Type::components).collect();
        let (Some(given), [.., last]) = (given, args) else { return };
        let (needs, given) = (ty.components().unwrap_or_default(), given.iter().sum::<usize>());
        let surplus = self.arena.get(args[first]).span.to(self.arena.get(*last).span);
        let has = if needs == 1 { "1 component".to_owned() } else { format!("{needs} components") };
        let file = self.sink.file.clone();
        let d = self
            .sink
            .start(
                errors::TOO_MANY,
                span,
                message!(
                    "`{ty}` has {has}, but is given {given}",
                    "`{ty}` の成分は {needs} 個ですが、{given} 個与えられています"
                ),
            )
            .with_label(message!("makes a `{ty}`", "`{ty}` を作る"))
            .with_related(&file, surplus, message!("too many", "余分です"))
            .with_why(message!(
                "a constructor takes no argument behind the last component that it needs: the shader does not compile",
                "コンストラクタは、必要な最後の成分より後ろの引数を受け取りません。このシェーダはコンパイルできません",
            ))
            .with_help(message!(
                "give {has}, or construct a larger type",
                "成分を {needs} 個にするか、より大きい型にしてください"
            ));
        self.sink.push(d);
    }

    fn too_few(&mut self, ty: &Type, span: Span, given: usize) {
        let needs = ty.components().unwrap_or(0);
        let d = self
            .sink
            .start(
                errors::TOO_FEW,
                span,
                message!(
                    "`{ty}` needs {needs} components, but gets {given}",
                    "`{ty}` には {needs} 成分が必要ですが、{given} 成分しかありません"
                ),
            )
            .with_label(message!("components are missing", "成分が足りません"))
            .with_why(message!(
                "a constructor takes one scalar, or as many components as the type has",
                "コンストラクタの引数は、スカラ一つか、型の成分数ちょうどです"
            ))
            .with_help(message!("give all {needs} components", "{needs} 成分を全て書いてください"));
        self.sink.push(d);
    }

    /// Matrices among the arguments of a constructor.
    fn matrix_rules(&mut self, ty: &Type, args: &[ExprId], types: &[Type]) -> bool {
        if !matches!(ty, Type::Matrix(..)) {
            return true;
        }
        let Some(at) = types.iter().position(|t| matches!(t, Type::Matrix(..))) else { return true };
        let span = self.arena.get(args[at]).span;
        if types.len() > 1 {
            let message = message!(
                "a matrix made of a matrix takes no other argument",
                "行列から行列を作るときは引数を一つだけ書きます"
            );
            self.sink.error(errors::CONSTRUCTOR, span, message, message!("this is a matrix", "これは行列"));
            return false;
        }
        // GLSL ES 1.00 reserves it (section 5.4.2), and compilers for it take it.
        if !self.language.at_least(120, 100) {
            let since = (120, 100, [].as_slice());
            self.lacks(message!("a matrix made of a matrix", "行列から作る行列"), since, span);
        }
        true
    }

    fn count(&mut self, ty: &Type, span: Span, wanted: usize, (args, types): (&[ExprId], &[Type]), what: &str) {
        // A name in capitals that nothing declares may be a macro with several.
        let is_macro = |arg: &ExprId| matches!(&self.arena.get(*arg).kind, ExprKind::Name(n) if crate::is_macro(n));
        if args.iter().zip(types).any(|(arg, ty)| *ty == Type::Error && is_macro(arg)) {
            return;
        }
        let given = args.len();
        let message = format!("`{ty}` has {wanted} {what}, but {given} are given");
        self.sink.error(errors::CONSTRUCTOR, span, message, "this constructor");
    }

    /// Arguments of a structure's or array's constructor, one for each member or element.
    fn elements(
        &mut self,
        ty: &Type,
        span: Span,
        wanted: &[Type],
        args: &[ExprId],
        types: &[Type],
        what: &str,
    ) -> bool {
        if wanted.len() != args.len() {
            self.count(ty, span, wanted.len(), (args, types), what);
            return false;
        }
        for ((wanted, arg), given) in wanted.iter().zip(args).zip(types) {
            if !self.conversions.allow(given, wanted) {
                let message =
                    format!("{} `{given}` stands where `{ty}` needs {} `{wanted}`", article(given), article(wanted));
                let label = format!("this is {} `{given}`", article(given));
                self.sink.error(errors::CONSTRUCTOR, self.arena.get(*arg).span, message, label);
                return false;
            }
            self.implicit(*arg, given, wanted);
        }
        true
    }

    fn function_call(&mut self, id: ExprId, name: &Ident, args: &[ExprId]) -> (Type, Option<Const>) {
        self.meeting(name);
        let mut types: Vec<Type> = args.iter().map(|a| self.type_of(*a).clone()).collect();
        let user = self.functions.get(&name.name).cloned().unwrap_or_default();
        let mut candidates: Vec<Candidate> = user
            .iter()
            .map(|f| {
                let info = &self.out.functions[f.index()];
                let params = info.params.iter().map(|p| (p.direction, p.ty.clone())).collect();
                Candidate { params, result: info.return_type.clone(), user: Some(*f) }
            })
            .collect();
        // The shader's own functions come first: they may replace built-in ones.
        let mut best = best(&candidates, &types, self.conversions);
        if best.is_none() {
            let built_in = builtin::functions(&name.name);
            let absent = builtin::function_absent(&name.name, self.stage, &self.language);
            if let Some(why) = absent.filter(|_| candidates.is_empty() && !built_in.is_empty()) {
                self.absent(&name.name, name.span, why);
                return (Type::Error, None);
            }
            let language = self.language.clone();
            let fragment = matches!(self.stage, super::super::Stage::Fragment | super::super::Stage::Library);
            let built_in =
                built_in.iter().filter(|s| absent.is_none() && available(&name.name, s, &types, &language, fragment));
            candidates.extend(built_in.map(|Signature { params, result, bias: _ }| Candidate {
                params: params.clone(),
                result: result.clone(),
                user: None,
            }));
            best = self::best(&candidates, &types, self.conversions);
        }
        if best.is_none() && types.iter().any(|ty| *ty != sampled(ty)) {
            types = types.iter().map(sampled).collect();
            best = self::best(&candidates, &types, self.conversions);
        }
        if candidates.is_empty() {
            self.unknown_function(name);
            return (Type::Error, None);
        }
        let Some((index, certain)) = best else {
            // An extension may bring operations on other types of numbers.
            let more = match name.name.as_str() {
                n if n.starts_with("imageAtomic") || n.starts_with("atomic") => {
                    self.language.enabled_with("atomic_float")
                }
                n if n.starts_with("texture") => self.language.enabled("EXT_texture_shadow_lod"),
                _ => false,
            };
            if more && candidates.iter().all(|c| c.user.is_none()) {
                return (Type::Error, None);
            }
            self.no_overload(name, &candidates, &types);
            return (Type::Error, None);
        };
        if candidates[index].user.is_some() {
            self.chosen_rules(name, index, &candidates, &types, args);
        }
        let Candidate { params, result, user } = candidates.swap_remove(index);
        for ((direction, wanted), arg) in params.iter().zip(args) {
            if *direction == Direction::In {
                self.implicit(*arg, &self.type_of(*arg).clone(), wanted);
            } else {
                self.assignable(*arg);
            }
        }
        // With an argument of unknown type, another function of the name may be meant that is not seen.
        let known = types.iter().all(|t| !t.is_error());
        if let (Some(callee), Some((caller, _)), true) = (user, &self.current, known) {
            self.calls.push((*caller, callee, name.span));
        }
        if user.is_none() {
            self.texel_offset(name, &params, args);
            self.wide_atomic(name, &params);
        }
        let function = BuiltinFunction::from_name(&name.name);
        let value = match user {
            None => {
                let values: Option<Vec<Const>> = args.iter().map(|a| self.value_of(*a)).collect();
                values.and_then(|v| fold::call(function?, &v)).filter(|v| v.ty() == result)
            }
            Some(_) => None,
        };
        self.out.calls[id.index()] = match (user, function) {
            (Some(f), _) => Some(CallTarget::User(f)),
            (None, Some(function)) => {
                let directions = params.into_iter().map(|p| p.0).collect();
                Some(CallTarget::Builtin(BuiltinCall { function, directions }))
            }
            (None, None) => None,
        };
        (if certain { result } else { Type::Error }, value)
    }

    /// Rules of a call of the shader's own function: which one is meant must be certain, and an array that is passed has
    /// a size.
    fn chosen_rules(&mut self, name: &Ident, index: usize, candidates: &[Candidate], types: &[Type], args: &[ExprId]) {
        let text = &name.name;
        if candidates[index].user.is_some_and(|f| self.subroutines.contains(&self.out.functions[f.index()].name.name)) {
            let message = message!(
                "`{text}` is a subroutine type and cannot be called",
                "`{text}` はサブルーチン型で、呼び出せません"
            );
            self.sink.error(errors::UNKNOWN_FUNCTION, name.span, message, message!("called here", "ここで呼び出し"));
        }
        for (ty, arg) in types.iter().zip(args) {
            let builtin = |c: &Self| c.sink.file.slice(c.arena.get(*arg).span).contains("gl_");
            if matches!(ty, Type::Array(_, ArraySize::Unsized)) && !builtin(self) {
                let message = message!(
                    "an array without a size cannot be passed as a whole",
                    "大きさのない配列の全体は渡せません"
                );
                self.sink.error(
                    errors::ARRAY,
                    self.arena.get(*arg).span,
                    message,
                    message!("this argument", "この引数"),
                );
            }
        }
        let modern = self.conversions.int_to_uint;
        let fits = |c: &Candidate| best(std::slice::from_ref(c), types, self.conversions).is_some();
        if types.iter().any(Type::is_error) || best_cost(&candidates[index], types, self.conversions) == Some(0) {
            return;
        }
        let mut others = candidates.iter().enumerate().filter(|(k, c)| *k != index && c.user.is_some() && fits(c));
        let chosen = &candidates[index];
        let unclear = others.find(|(_, other)| !modern || !is_better(chosen, other, types));
        if let Some(other) = unclear.and_then(|(_, c)| c.user) {
            let first = self.out.functions[other.index()].name.span;
            let file = self.sink.file.clone();
            let message = message!("which `{text}` is meant is not certain", "どの `{text}` を呼ぶのか決まりません");
            let d = self.sink.start(errors::NO_OVERLOAD, name.span, message);
            let d = d.with_label(message!("several fit after conversions", "変換すると複数が当てはまります"));
            self.sink.push(d.with_related(&file, first, message!("this one fits as well", "これも当てはまります")));
        }
    }

    /// Atomic functions on 64 bits come with an extension of their own, beside that of the type.
    fn wide_atomic(&mut self, name: &Ident, params: &[(Direction, Type)]) {
        let wide = params.first().and_then(|p| p.1.scalar()).is_some_and(|of| of.bits() == 64);
        if wide && name.name.starts_with("atomic") && !self.language.since(builtin::WIDE_ATOMICS) {
            let text = &name.name;
            self.lacks(message!("`{text}` on 64 bits", "64 ビットの `{text}` "), builtin::WIDE_ATOMICS, name.span);
        }
    }

    /// Offsets of texels are part of the instruction: they have to be constant expressions (GLSL 4.60
    /// specification, section 8.9). Only `textureGatherOffset` takes others.
    fn texel_offset(&mut self, name: &Ident, params: &[(Direction, Type)], args: &[ExprId]) {
        let text = name.name.as_str();
        let fixed = text.ends_with("Offset") && !text.starts_with("textureGather") || text == "textureGatherOffsets";
        if !fixed || !text.starts_with("te") || self.language.enabled("EXT_texture_offset_non_const") {
            return;
        }
        // The offset is the last integer behind the coordinate.
        let integer = |ty: &Type| {
            let element = if ty.scalar().is_none() { ty.indexed() } else { None };
            element.as_ref().unwrap_or(ty).scalar().is_some_and(ScalarType::is_integer)
        };
        let Some(at) = (2..params.len()).rev().find(|&k| integer(&params[k].1)) else { return };
        let Some(&offset) = args.get(at).filter(|&&a| !self.is_constant(a) && !self.type_of(a).is_error()) else {
            return;
        };
        let message = format!("the offset of `{text}` must be a constant expression");
        let d = self
            .sink
            .start(errors::CONSTANT_ARGUMENT, self.arena.get(offset).span, message)
            .with_label("this is no constant expression")
            .with_help("add the offset to the coordinate instead, or write one call for each offset");
        self.sink.push(d);
    }

    fn unknown_function(&mut self, name: &Ident) {
        if let Some(since) = builtin::type_since(&name.name) {
            let text = &name.name;
            return self.lacks(message!("`{text}`", "`{text}` "), since, name.span);
        }
        self.lack(&name.name, Lacks::Function);
        if self.language.is_open() || !self.first_time(&name.name) {
            return;
        }
        let message = format!("function `{}` is not declared", name.name);
        let d = self.sink.start(errors::UNKNOWN_FUNCTION, name.span, message).with_label("unknown function");
        let below = self.unit.items.iter().find_map(|item| match &item.kind {
            ItemKind::Function(f) if f.name.name == name.name => Some(f.name.span),
            _ => None,
        });
        if let Some(span) = below {
            let file = self.sink.file.clone();
            let d = d.with_related(&file, span, "it is defined here");
            self.sink.push(
                d.with_help("a function must be declared before it is called: move it up, or put a prototype there"),
            );
            return;
        }
        let near = self.meant(&name.name, |checker| {
            let mut known: Vec<&str> = checker.functions.keys().map(String::as_str).collect();
            for name in builtin::function_names() {
                known.push(name);
            }
            known.extend(["vec2", "vec3", "vec4", "mat2", "mat3", "mat4", "float", "int", "uint"]);
            known.sort_unstable();
            known
        });
        self.sink.push(with_near(d, near));
    }

    fn no_overload(&mut self, name: &Ident, candidates: &[Candidate], types: &[Type]) {
        let list =
            |types: &mut dyn Iterator<Item = &Type>| types.map(ToString::to_string).collect::<Vec<_>>().join(", ");
        let given = list(&mut types.iter());
        let mut arities: Vec<usize> = candidates.iter().map(|c| c.params.len()).collect();
        arities.sort_unstable();
        arities.dedup();
        let same: Vec<&Candidate> = candidates.iter().filter(|c| c.params.len() == types.len()).collect();
        let message = if same.is_empty() {
            let counts = arities.iter().map(ToString::to_string).collect::<Vec<_>>().join(" or ");
            let plural = if arities == [1] { "" } else { "s" };
            format!("`{}` takes {counts} argument{plural}, not {}", name.name, types.len())
        } else {
            format!("`{}` does not take ({given})", name.name)
        };
        // The closest ones: those with the most arguments that fit, of those that take the first one where there are any.
        let takes_first = |c: &&Candidate| match (types.first(), c.params.first()) {
            (Some(given), Some((_, param))) => self.conversions.allow(given, param),
            _ => true,
        };
        let near: Vec<&Candidate> = match same.iter().any(takes_first) || !candidates.iter().any(|c| takes_first(&c)) {
            true => same,
            false => candidates.iter().filter(takes_first).collect(),
        };
        let mut close: Vec<(usize, String)> = near
            .iter()
            .map(|c| {
                let fitting = c.params.iter().zip(types).filter(|((_, p), t)| self.conversions.allow(t, p)).count();
                (fitting, list(&mut c.params.iter().map(|p| &p.1)))
            })
            .collect();
        close.sort_by_key(|c| std::cmp::Reverse(c.0));
        let shown: Vec<String> = close.iter().take(3).map(|c| format!("({})", c.1)).collect();
        let d = self.sink.start(errors::NO_OVERLOAD, name.span, message).with_label(format!("called with ({given})"));
        self.sink.push(if shown.is_empty() { d } else { d.with_help(format!("it takes {}", shown.join(" or "))) });
    }
}

/// The candidate that needs the fewest conversions, the first one of equals, and whether its
/// result is certain: with arguments of unknown type several may fit.
fn best(candidates: &[Candidate], types: &[Type], rules: Conversions) -> Option<(usize, bool)> {
    let unknown = types.iter().any(Type::is_error);
    let mut found: Option<(u32, usize)> = None;
    let mut certain = true;
    for (i, candidate) in candidates.iter().enumerate() {
        if candidate.params.len() != types.len() {
            continue;
        }
        let costs = candidate.params.iter().zip(types).map(|((direction, param), given)| match direction {
            Direction::In => cost(given, param, rules),
            Direction::Out => cost(param, given, rules),
            Direction::InOut => cost(given, param, rules).filter(|c| *c == 0),
        });
        let Some(total) = costs.sum::<Option<u32>>() else { continue };
        match found {
            Some((least, at)) => {
                if unknown && candidates[at].result != candidate.result {
                    certain = false;
                }
                if total < least {
                    found = Some((total, i));
                }
            }
            None => found = Some((total, i)),
        }
    }
    found.map(|(_, i)| (i, certain))
}

/// Conversions that one candidate needs.
fn best_cost(candidate: &Candidate, types: &[Type], rules: Conversions) -> Option<u32> {
    let costs = candidate.params.iter().zip(types).map(|((direction, param), given)| match direction {
        Direction::In => cost(given, param, rules),
        Direction::Out | Direction::InOut => cost(param, given, rules),
    });
    costs.sum()
}

/// True when the first candidate has a better conversion for an argument, and a worse one for none (GLSL 4.60
/// specification, section 6.1).
fn is_better(one: &Candidate, other: &Candidate, types: &[Type]) -> bool {
    let rank = |(direction, param): &(Direction, Type), given: &Type| {
        let (from, to) = if *direction == Direction::In { (given, param) } else { (param, given) };
        match (from.scalar(), to.scalar()) {
            _ if from == to => 0,
            (Some(a), Some(b)) if a.is_sized() => i32::try_from(to_other(a, b)).unwrap_or(i32::MAX),
            (Some(ScalarType::Float), Some(ScalarType::Double)) => 1,
            (_, Some(ScalarType::Double)) => 3,
            _ => 2,
        }
    };
    let ranks = |c: &Candidate| c.params.iter().zip(types).map(|(p, t)| rank(p, t)).collect::<Vec<_>>();
    let (a, b) = (ranks(one), ranks(other));
    a.iter().zip(&b).all(|(a, b)| a <= b) && a != b
}

/// The type as which a built-in function takes an argument: a texture without a sampler has the texels of one with it.
fn sampled(ty: &Type) -> Type {
    match ty {
        Type::Opaque(opaque) => Type::Opaque(opaque.sampled()),
        other => other.clone(),
    }
}
