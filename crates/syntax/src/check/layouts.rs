//! Which layout qualifiers there are, where they belong, and their values (GLSL 4.60 specification,
//! section 4.4).

use super::super::ast::{ExprKind, LayoutEntry, Qualifiers};
use super::super::fold::Const;
use super::super::interface::Storage;
use super::super::language::{Feature, Since};
use super::super::types::{ArraySize, Type};
use super::super::{Stage, errors};
use super::Checker;
use base::diagnostic::{Message, message};

/// What carries a layout qualifier.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Bearer {
    /// A variable at file scope.
    Variable(Storage),
    /// A block.
    Block(Storage),
    /// A member of a block.
    Member(Storage),
    /// `layout(…) in;`
    Stage(Storage),
    /// A redeclared built-in variable.
    Builtin,
    /// A local variable, parameter or member of a structure.
    Nothing,
}

/// Keys, whether a value belongs to them, and when they came.
const KEYS: &[(&str, bool, Since)] = &[
    (
        "location",
        true,
        (
            330,
            300,
            &[
                "ARB_explicit_attrib_location",
                "ARB_separate_shader_objects",
                "EXT_separate_shader_objects",
                "ARB_explicit_uniform_location",
            ],
        ),
    ),
    ("index", true, (330, u32::MAX, &["ARB_explicit_attrib_location"])),
    ("component", true, (440, u32::MAX, &["ARB_enhanced_layouts"])),
    (
        "binding",
        true,
        (
            420,
            310,
            &[
                "ARB_shading_language_420pack",
                "ARB_shader_atomic_counters",
                "ARB_shader_storage_buffer_object",
                "ARB_shader_image_load_store",
            ],
        ),
    ),
    ("offset", true, (420, 310, &["ARB_enhanced_layouts", "ARB_shader_atomic_counters"])),
    ("align", true, (440, u32::MAX, &["ARB_enhanced_layouts"])),
    ("shared packed row_major column_major", false, (140, 300, &["ARB_uniform_buffer_object"])),
    ("std140", false, (140, 300, &["ARB_uniform_buffer_object", "ARB_shader_storage_buffer_object"])),
    ("std430", false, (430, 310, &["ARB_shader_storage_buffer_object"])),
    ("origin_upper_left pixel_center_integer", false, (150, u32::MAX, &["ARB_fragment_coord_conventions"])),
    (
        "points lines triangles lines_adjacency triangles_adjacency line_strip triangle_strip",
        false,
        (150, 310, &["ARB_tessellation_shader"]),
    ),
    ("max_vertices", true, (150, 320, &[])),
    ("invocations", true, (400, 320, &["ARB_gpu_shader5"])),
    ("stream", true, (400, u32::MAX, &["ARB_gpu_shader5"])),
    ("vertices", true, (400, 320, &["ARB_tessellation_shader"])),
    (
        "quads isolines equal_spacing fractional_even_spacing fractional_odd_spacing cw ccw point_mode",
        false,
        (400, 320, &["ARB_tessellation_shader"]),
    ),
    ("local_size_x local_size_y local_size_z", true, (430, 310, &[])),
    (
        "depth_any depth_greater depth_less depth_unchanged",
        false,
        (420, u32::MAX, &["ARB_conservative_depth", "AMD_conservative_depth", "EXT_conservative_depth"]),
    ),
    ("early_fragment_tests", false, (420, 310, &[])),
    ("xfb_buffer xfb_offset xfb_stride", true, (440, u32::MAX, &["ARB_enhanced_layouts"])),
    (
        "rgba32f rgba16f rg32f rg16f r11f_g11f_b10f r32f r16f rgba16 rgb10_a2 rgba8 rg16 rg8 r16 r8 rgba16_snorm \
         rgba8_snorm rg16_snorm rg8_snorm r16_snorm r8_snorm rgba32i rgba16i rgba8i rg32i rg16i rg8i r32i r16i r8i \
         rgba32ui rgba16ui rgb10_a2ui rgba8ui rg32ui rg16ui rg8ui r32ui r16ui r8ui",
        false,
        (420, 310, &[]),
    ),
    ("size1x8 size1x16 size1x32 size2x32 size4x32", false, (420, u32::MAX, &["EXT_shader_image_load_store"])),
];

impl Checker<'_> {
    /// Checks all layout qualifiers; their values have been typed.
    pub(super) fn layout_rules(&mut self, qualifiers: &Qualifiers, bearer: Bearer, ty: Option<&Type>) {
        let mut count = 0;
        let mut seen: Vec<&str> = Vec::new();
        for (entries, span) in qualifiers.layouts() {
            count += 1;
            if count > 1 && !self.language.stated(Feature::MixedQualifiers.since()) {
                self.lacks(Feature::MixedQualifiers.name(), Feature::MixedQualifiers.since(), span);
            }
            let open = self.language.is_open();
            if open {
                // What an extension may bring is let through; values follow the same rules.
                for entry in entries {
                    self.layout_value(entry);
                }
            }
            if !open && bearer == Bearer::Nothing {
                self.qualifier(
                    span,
                    message!(
                        "it belongs to variables and blocks of the interface",
                        "インターフェースの変数かブロックに付ける修飾子です"
                    ),
                );
                continue;
            }
            for entry in entries {
                let key = entry.key.name.as_str();
                if seen.contains(&key) && !self.language.stated(Feature::MixedQualifiers.since()) {
                    self.layout_error(entry, message!("it stands there twice", "二度書かれています"));
                }
                seen.push(key);
                if !open {
                    self.layout_entry(entry, bearer, ty);
                }
            }
        }
    }

    pub(super) fn layout_error(&mut self, entry: &LayoutEntry, why: Message) {
        let key = &entry.key.name;
        let d = self
            .sink
            .start(
                errors::LAYOUT,
                entry.span,
                message!("`layout({key})` cannot stand here", "`layout({key})` はここに書けません"),
            )
            .with_label(message!("this layout qualifier", "この layout 修飾子"));
        self.sink.push(d.with_why(why));
    }

    fn layout_entry(&mut self, entry: &LayoutEntry, bearer: Bearer, ty: Option<&Type>) {
        let key = entry.key.name.to_ascii_lowercase();
        // Before 4.20 case does not matter; `origin_upper_left` is looked up as written.
        let row = KEYS.iter().find(|(keys, ..)| keys.split_whitespace().any(|k| k == key));
        let Some((_, valued, since)) = row else {
            return self
                .layout_error(entry, message!("the language has no such key", "そのようなキーは言語にありません"));
        };
        match (entry.value, *valued) {
            (None, true) => return self.layout_error(entry, message!("it needs a value", "値が必要です")),
            (Some(_), false) => return self.layout_error(entry, message!("it takes no value", "値は取りません")),
            (Some(_), true) => {
                if !self.layout_value(entry) {
                    return;
                }
            }
            (None, false) => {}
        }
        if !self.belongs(&key, bearer, ty) {
            return self.layout_error(entry, message!("it does not belong to this", "この宣言には付けられません"));
        }
        if key == "location" {
            return self.location(entry, bearer);
        }
        if !self.language.since(*since) {
            self.lacks(message!("`layout({key})`", "`layout({key})` "), *since, entry.span);
        }
    }

    /// Checks the value of a key that takes one; false when it is wrong.
    fn layout_value(&mut self, entry: &LayoutEntry) -> bool {
        let key = entry.key.name.to_ascii_lowercase();
        let valued = KEYS.iter().any(|(keys, valued, _)| *valued && keys.split_whitespace().any(|k| k == key));
        let Some(value) = entry.value.filter(|_| valued) else { return true };
        let ty = self.type_of(value).clone();
        let folded = self.value_of(value).and_then(Const::as_integer);
        let integer = ty.is_scalar() && ty.scalar().is_some_and(|s| s.is_integer());
        // A geometry stage tells of these two by itself.
        let own = matches!(key.as_str(), "max_vertices" | "invocations") && self.stage == Stage::Geometry;
        let why = if ty.is_error() || own && !(integer && self.is_constant(value)) {
            return true;
        } else if folded.is_some_and(|v| v < 0) {
            message!("its value must not be negative", "値を負にはできません")
        } else if !integer {
            message!("its value must be an integer", "値は整数でなければなりません")
        } else if !self.is_constant(value) {
            message!("its value must be constant", "値は定数でなければなりません")
        } else {
            match (key.as_str(), folded) {
                ("local_size_x" | "local_size_y" | "local_size_z" | "vertices" | "invocations", Some(0)) => {
                    message!("its value must be positive", "値は正でなければなりません")
                }
                ("align", Some(n)) if n == 0 || n & (n - 1) != 0 => {
                    message!("its value must be a power of two", "値は 2 の累乗でなければなりません")
                }
                ("index", Some(n)) if n > 1 && self.stage == Stage::Fragment => {
                    message!("its value is 0 or 1", "値は 0 か 1 です")
                }
                ("component", Some(n)) if n > 3 => message!("its value is 0 to 3", "値は 0 から 3 です"),
                _ => {
                    self.below_limit(entry);
                    if !self.is_literal(value) {
                        self.need(Feature::LayoutExpressions, self.arena.get(value).span);
                    }
                    return true;
                }
            }
        };
        self.layout_error(entry, why);
        false
    }

    fn is_literal(&self, value: super::ExprId) -> bool {
        match &self.arena.get(value).kind {
            ExprKind::Paren(inner) => self.is_literal(*inner),
            ExprKind::Literal(_) | ExprKind::Error => true,
            _ => false,
        }
    }

    fn location(&mut self, entry: &LayoutEntry, bearer: Bearer) {
        let feature = match bearer {
            Bearer::Variable(Storage::Uniform) => Feature::LayoutLocationUniform,
            Bearer::Variable(Storage::In) if self.stage == Stage::Vertex => Feature::LayoutLocation,
            Bearer::Variable(Storage::Out) if self.stage == Stage::Fragment => Feature::LayoutLocation,
            _ => Feature::LayoutLocationVarying,
        };
        self.need(feature, entry.span);
    }

    /// True when the key belongs to what bears it.
    fn belongs(&self, key: &str, bearer: Bearer, ty: Option<&Type>) -> bool {
        use Bearer::{Block, Builtin, Member, Nothing, Variable};
        use Storage::{Buffer, In, Out, Uniform};
        // What a library is included by may be any stage.
        let of = |stage| self.stage == stage || self.stage == Stage::Library;
        let opaque = ty.is_some_and(Type::contains_opaque);
        match key {
            "location" => matches!(bearer, Variable(In | Out | Uniform) | Block(In | Out) | Member(In | Out)),
            "index" => of(Stage::Fragment) && bearer == Variable(Out),
            "component" => matches!(bearer, Variable(In | Out) | Member(In | Out)),
            "binding" => {
                matches!(bearer, Block(Uniform | Buffer))
                    || bearer == Variable(Uniform) && opaque
                    || bearer == Bearer::Stage(Uniform)
            }
            "offset" => {
                matches!(bearer, Member(Uniform | Buffer))
                    || matches!(bearer, Variable(Uniform) | Bearer::Stage(Uniform))
            }
            "align" => matches!(bearer, Block(Uniform | Buffer) | Member(Uniform | Buffer)),
            "shared" | "packed" | "std140" | "std430" => {
                matches!(bearer, Block(Uniform | Buffer) | Bearer::Stage(Uniform | Buffer))
            }
            "row_major" | "column_major" => {
                matches!(bearer, Block(Uniform | Buffer) | Bearer::Stage(Uniform | Buffer) | Member(Uniform | Buffer))
            }
            "origin_upper_left" | "pixel_center_integer" => of(Stage::Fragment) && bearer == Builtin,
            "depth_any" | "depth_greater" | "depth_less" | "depth_unchanged" => {
                of(Stage::Fragment) && bearer == Builtin
            }
            "points" | "lines" | "lines_adjacency" | "triangles_adjacency" => {
                of(Stage::Geometry) && matches!(bearer, Bearer::Stage(In | Out))
            }
            "triangles" => {
                of(Stage::Geometry) && matches!(bearer, Bearer::Stage(In | Out))
                    || of(Stage::TessEvaluation) && bearer == Bearer::Stage(In)
            }
            "line_strip" | "triangle_strip" | "max_vertices" => of(Stage::Geometry) && bearer == Bearer::Stage(Out),
            "invocations" => of(Stage::Geometry) && bearer == Bearer::Stage(In),
            "stream" => {
                of(Stage::Geometry) && matches!(bearer, Bearer::Stage(Out) | Variable(Out) | Block(Out) | Member(Out))
            }
            "vertices" => of(Stage::TessControl) && bearer == Bearer::Stage(Out),
            "quads"
            | "isolines"
            | "equal_spacing"
            | "fractional_even_spacing"
            | "fractional_odd_spacing"
            | "cw"
            | "ccw"
            | "point_mode" => of(Stage::TessEvaluation) && bearer == Bearer::Stage(In),
            "local_size_x" | "local_size_y" | "local_size_z" => of(Stage::Compute) && bearer == Bearer::Stage(In),
            "early_fragment_tests" => of(Stage::Fragment) && bearer == Bearer::Stage(In),
            "xfb_offset" => matches!(bearer, Variable(Out) | Block(Out) | Member(Out) | Builtin),
            "xfb_buffer" | "xfb_stride" => {
                matches!(bearer, Bearer::Stage(Out) | Variable(Out) | Block(Out) | Member(Out) | Builtin)
            }
            // Formats of images.
            _ => bearer == Variable(Uniform) && opaque && bearer != Nothing,
        }
    }

    /// An input of a geometry shader must be an array: one element for each vertex.
    pub(super) fn geometry_input(&mut self, name: &super::super::ast::Ident, ty: &Type, dims: base::text::Span) {
        if self.stage != Stage::Geometry || ty.is_error() {
            return;
        }
        match ty {
            Type::Array(_, size) => {
                if let (ArraySize::Known(n), Some(wanted)) = (size, self.vertices)
                    && *n != wanted
                {
                    let text = &name.name;
                    let message = message!(
                        "`{text}` has {n} elements, but the input primitive has {wanted} vertices",
                        "`{text}` の要素は {n} 個ですが、入力プリミティブの頂点は {wanted} 個です"
                    );
                    self.sink.error(errors::ARRAY, dims, message, message!("size of the input", "入力の大きさ"));
                }
            }
            _ => {
                let text = &name.name;
                let d = self
                    .sink
                    .start(
                        errors::GEOMETRY_INPUT,
                        name.span,
                        message!(
                            "the geometry input `{text}` is no array",
                            "ジオメトリ入力 `{text}` が配列ではありません"
                        ),
                    )
                    .with_label(message!("one value for a whole primitive", "プリミティブ全体に一つの値"))
                    .with_why(message!(
                        "a geometry shader gets one element for each vertex of the primitive",
                        "ジオメトリシェーダの入力は、プリミティブの頂点ごとに一要素を持つ配列です"
                    ))
                    .with_help(message!("write `{text}[]`", "`{text}[]` と書いてください"));
                self.sink.push(d);
            }
        }
    }
}
