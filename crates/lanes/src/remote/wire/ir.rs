//! What a module of naga consists of.

use super::basic::Counts;
use super::{Reader, Wire, Writer, tag, wire};
use naga::{
    AddressSpace, ArraySize, AtomicFunction, Barrier, BinaryOperator, Binding, BuiltIn, Constant, DerivativeAxis,
    DerivativeControl, EntryPoint, Expression, Function, FunctionArgument, FunctionResult, GlobalVariable, ImageClass,
    ImageDimension, ImageQuery, Interpolation, Literal, LocalVariable, MathFunction, MemoryDecorations, Module,
    Override, PredeclaredType, RelationalFunction, ResourceBinding, SampleLevel, Sampling, Scalar, ScalarKind,
    ShaderStage, SpecialTypes, Statement, StorageAccess, StructMember, SwitchCase, SwitchValue, SwizzleComponent, Type,
    TypeInner, UnaryOperator, VectorSize,
};

wire! { enum VectorSize { Bi, Tri, Quad } }
wire! { enum ScalarKind { Sint, Uint, Float, Bool, AbstractInt, AbstractFloat } }
wire! { struct Scalar { kind, width } }
wire! { enum ArraySize { Constant(a), Pending(a), Dynamic } }
wire! { enum Interpolation { Perspective, Linear, Flat, PerVertex } }
wire! { enum Sampling { Center, Centroid, Sample, First, Either } }
wire! { struct StructMember { name, ty, binding, offset } }
wire! { enum ImageDimension { D1, D2, D3, Cube } }
wire! { enum ImageClass { Sampled { kind, multi }, Depth { multi } } refused { External, Storage } }
wire! { struct Type { name, inner } }
wire! { enum TypeInner {
    Scalar(a), Vector { size, scalar }, Matrix { columns, rows, scalar }, Atomic(a), Pointer { base, space },
    ValuePointer { size, scalar, space }, Array { base, size, stride }, Struct { members, span },
    Image { dim, arrayed, class }, Sampler { comparison }, BindingArray { base, size },
} refused { CooperativeMatrix, AccelerationStructure, RayQuery } }
wire! { enum AddressSpace {
    Function, Private, WorkGroup, Uniform, Storage { access }, Handle, Immediate,
} refused { TaskPayload, RayPayload, IncomingRayPayload } }
wire! { struct ResourceBinding { group, binding } }
wire! { enum BuiltIn {
    Position { invariant }, ViewIndex, BaseInstance, BaseVertex, ClipDistances, CullDistance, InstanceIndex, PointSize,
    VertexIndex, DrawIndex, PrimitiveIndex, FragDepth, PointCoord, FrontFacing, SampleIndex, SampleMask,
    GlobalInvocationId, LocalInvocationId, LocalInvocationIndex, WorkGroupId, WorkGroupSize, NumWorkGroups,
} refused {
    Barycentric, NumSubgroups, SubgroupId, SubgroupSize, SubgroupInvocationId, MeshTaskSize, CullPrimitive, PointIndex,
    LineIndices, TriangleIndices, VertexCount, Vertices, PrimitiveCount, Primitives, RayInvocationId,
    NumRayInvocations, InstanceCustomData, GeometryIndex, WorldRayOrigin, WorldRayDirection, ObjectRayOrigin,
    ObjectRayDirection, RayTmin, RayTCurrentMax, ObjectToWorld, WorldToObject, HitKind,
} }
wire! { enum Binding {
    BuiltIn(a), Location { location, interpolation, sampling, blend_src, per_primitive },
} }
wire! { enum Literal {
    F64(a), F32(a), U16(a), I16(a), U32(a), I32(a), U64(a), I64(a), Bool(a), AbstractInt(a), AbstractFloat(a),
} refused { F16 } }
wire! { struct Override { name, id, ty, init } }
wire! { struct Constant { name, ty, init } }
wire! { struct GlobalVariable { name, space, binding, ty, init, memory_decorations } }
wire! { struct LocalVariable { name, ty, init } }
wire! { enum UnaryOperator { Negate, LogicalNot, BitwiseNot } }
wire! { enum BinaryOperator {
    Add, Subtract, Multiply, Divide, Modulo, Equal, NotEqual, Less, LessEqual, Greater, GreaterEqual, And, ExclusiveOr,
    InclusiveOr, LogicalAnd, LogicalOr, ShiftLeft, ShiftRight,
} }
wire! { enum AtomicFunction { Add, Subtract, And, ExclusiveOr, InclusiveOr, Min, Max, Exchange { compare } } }
wire! { enum DerivativeControl { Coarse, Fine, None } }
wire! { enum DerivativeAxis { X, Y, Width } }
wire! { enum RelationalFunction { All, Any, IsNan, IsInf } }
wire! { enum MathFunction {
    Abs, Min, Max, Clamp, Saturate, Cos, Cosh, Sin, Sinh, Tan, Tanh, Acos, Asin, Atan, Atan2, Asinh, Acosh, Atanh,
    Radians, Degrees, Ceil, Floor, Round, Fract, Trunc, Modf, Frexp, Ldexp, Exp, Exp2, Log, Log2, Pow, Dot,
    Dot4I8Packed, Dot4U8Packed, Outer, Cross, Distance, Length, Normalize, FaceForward, Reflect, Refract, Sign, Fma,
    Mix, Step, SmoothStep, Sqrt, InverseSqrt, Inverse, Transpose, Determinant, QuantizeToF16, CountTrailingZeros,
    CountLeadingZeros, CountOneBits, ReverseBits, ExtractBits, InsertBits, FirstTrailingBit, FirstLeadingBit,
    Pack4x8snorm, Pack4x8unorm, Pack2x16snorm, Pack2x16unorm, Pack2x16float, Pack4xI8, Pack4xU8, Pack4xI8Clamp,
    Pack4xU8Clamp, Unpack4x8snorm, Unpack4x8unorm, Unpack2x16snorm, Unpack2x16unorm, Unpack2x16float, Unpack4xI8,
    Unpack4xU8,
} }
wire! { enum SampleLevel { Auto, Zero, Exact(a), Bias(a), Gradient { x, y } } }
wire! { enum ImageQuery { Size { level }, NumLevels, NumLayers, NumSamples } }
wire! { enum SwizzleComponent { X, Y, Z, W } }
wire! { enum Expression {
    Literal(a), Constant(a), Override(a), ZeroValue(a), Compose { ty, components }, Access { base, index },
    AccessIndex { base, index }, Splat { size, value }, Swizzle { size, vector, pattern }, FunctionArgument(a),
    GlobalVariable(a), LocalVariable(a), Load { pointer },
    ImageSample { image, sampler, gather, coordinate, array_index, offset, level, depth_ref, clamp_to_edge },
    ImageLoad { image, coordinate, array_index, sample, level }, ImageQuery { image, query }, Unary { op, expr },
    Binary { op, left, right }, Select { condition, accept, reject }, Derivative { axis, ctrl, expr },
    Relational { fun, argument }, Math { fun, arg, arg1, arg2, arg3 }, As { expr, kind, convert }, CallResult(a),
    AtomicResult { ty, comparison }, WorkGroupUniformLoadResult { ty }, ArrayLength(a),
} refused {
    RayQueryVertexPositions, RayQueryProceedResult, RayQueryGetIntersection, SubgroupBallotResult,
    SubgroupOperationResult, CooperativeLoad, CooperativeMultiplyAdd,
} }
wire! { enum SwitchValue { I32(a), U32(a), Default } }
wire! { struct SwitchCase { value, body, fall_through } }
wire! { enum Statement {
    Emit(a), Block(a), If { condition, accept, reject }, Switch { selector, cases }, Loop { body, continuing, break_if },
    Break, Continue, Return { value }, Kill, ControlBarrier(a), MemoryBarrier(a), Store { pointer, value },
    Atomic { pointer, fun, value, result }, WorkGroupUniformLoad { pointer, result },
    Call { function, arguments, result },
} refused {
    ImageStore, ImageAtomic, RayQuery, RayPipelineFunction, SubgroupBallot, SubgroupGather,
    SubgroupCollectiveOperation, CooperativeStore,
} }
wire! { struct FunctionArgument { name, ty, binding } }
wire! { struct FunctionResult { ty, binding } }
wire! { enum PredeclaredType {
    AtomicCompareExchangeWeakResult(a), ModfResult { size, scalar }, FrexpResult { size, scalar },
} }
wire! { struct SpecialTypes {
    ray_desc, ray_intersection, ray_vertex_return, external_texture_params, external_texture_transfer_function,
    predeclared_types,
} }
wire! { enum ShaderStage { Vertex, Fragment, Compute } refused {
    Task, Mesh, RayGeneration, Miss, AnyHit, ClosestHit,
} }

/// Sets of flags, by their bits.
macro_rules! flags {
    ($($name:ty),*) => { $(impl Wire for $name {
        fn put(&self, to: &mut Writer) {
            self.bits().put(to);
        }

        fn take(from: &mut Reader<'_>) -> Option<Self> {
            Self::from_bits(Wire::take(from)?)
        }
    })* };
}
flags!(StorageAccess, MemoryDecorations, Barrier);

impl Wire for Function {
    fn put(&self, to: &mut Writer) {
        let Self {
            name,
            arguments,
            result,
            local_variables,
            expressions,
            named_expressions,
            body,
            // Says how a validator warns.
            diagnostic_filter_leaf: _,
        } = self;
        name.put(to);
        arguments.put(to);
        result.put(to);
        local_variables.put(to);
        expressions.put(to);
        named_expressions.put(to);
        body.put(to);
    }

    fn take(from: &mut Reader<'_>) -> Option<Self> {
        Some(Self {
            name: Wire::take(from)?,
            arguments: Wire::take(from)?,
            result: Wire::take(from)?,
            local_variables: Wire::take(from)?,
            expressions: Wire::take(from)?,
            named_expressions: Wire::take(from)?,
            body: Wire::take(from)?,
            diagnostic_filter_leaf: None,
        })
    }
}

impl Wire for EntryPoint {
    fn put(&self, to: &mut Writer) {
        let Self {
            name,
            stage,
            early_depth_test,
            workgroup_size,
            workgroup_size_overrides,
            function,
            mesh_info,
            task_payload,
            incoming_ray_payload,
        } = self;
        let others = early_depth_test.is_some() || mesh_info.is_some();
        if others || task_payload.is_some() || incoming_ray_payload.is_some() {
            to.refuse("a stage of another kind");
        }
        name.put(to);
        stage.put(to);
        workgroup_size.put(to);
        workgroup_size_overrides.put(to);
        function.put(to);
    }

    fn take(from: &mut Reader<'_>) -> Option<Self> {
        Some(Self {
            name: Wire::take(from)?,
            stage: Wire::take(from)?,
            early_depth_test: None,
            workgroup_size: Wire::take(from)?,
            workgroup_size_overrides: Wire::take(from)?,
            function: Wire::take(from)?,
            mesh_info: None,
            task_payload: None,
            incoming_ray_payload: None,
        })
    }
}

/// How many handles of each kind a module has.
fn counts(module: &Module) -> Counts {
    let functions =
        || module.functions.iter().map(|(_, f)| f).chain(module.entry_points.iter().map(|point| &point.function));
    let locals = functions().map(|f| f.local_variables.len()).max().unwrap_or(0);
    let expressions = functions().map(|f| f.expressions.len()).chain([module.global_expressions.len()]).max();
    [
        module.types.len(),
        module.constants.len(),
        module.overrides.len(),
        module.global_variables.len(),
        module.functions.len(),
        locals,
        expressions.unwrap_or(0),
    ]
    .map(|count| count as u32)
}

impl Wire for Module {
    fn put(&self, to: &mut Writer) {
        let Self {
            types,
            special_types,
            constants,
            overrides,
            global_variables,
            global_expressions,
            functions,
            entry_points,
            // Say how a validator warns, and what a reader of the text is told.
            diagnostic_filters: _,
            diagnostic_filter_leaf: _,
            doc_comments: _,
        } = self;
        counts(self).put(to);
        types.put(to);
        special_types.put(to);
        constants.put(to);
        overrides.put(to);
        global_variables.put(to);
        global_expressions.put(to);
        functions.put(to);
        entry_points.put(to);
    }

    fn take(from: &mut Reader<'_>) -> Option<Self> {
        let counts = Wire::take(from)?;
        from.make_handles(counts)?;
        Some(Self {
            types: Wire::take(from)?,
            special_types: Wire::take(from)?,
            constants: Wire::take(from)?,
            overrides: Wire::take(from)?,
            global_variables: Wire::take(from)?,
            global_expressions: Wire::take(from)?,
            functions: Wire::take(from)?,
            entry_points: Wire::take(from)?,
            ..Self::default()
        })
    }
}
