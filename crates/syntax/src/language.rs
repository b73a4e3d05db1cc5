//! What a version, a profile and the extensions of a shader bring along: features by the first
//! version of desktop GLSL and of GLSL ES that has them, and the extensions that add them.

use super::ast::Ident;
use super::sink::Sink;
use super::{Extension, Profile, Version, errors};
use base::diagnostic::{Lang, Message, message};
use base::text::Span;

/// No version has it.
pub(crate) const NEVER: u32 = u32::MAX;

/// When something came: first desktop version, first ES version, extensions without `GL_`.
pub(crate) type Since = (u32, u32, &'static [&'static str]);

/// The language that a shader is written in.
#[derive(Clone, Debug)]
pub(crate) struct Language {
    number: u32,
    profile: Profile,
    enabled: Vec<String>,
    /// An extension is on whose words and functions are not known here: what is unknown may be its.
    open: bool,
}

/// Parts of the language that came later than its first version.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Feature {
    ArrayLength,
    ArrayValues,
    ArraysOfArrays,
    BitOperators,
    BlockInstances,
    Blocks,
    ConstantCalls,
    DoubleInputs,
    Doubles,
    FloatSuffix,
    ImplicitConversions,
    InOutBlocks,
    InOutStorage,
    InitializerLists,
    Interpolation,
    Invariant,
    LayoutExpressions,
    LayoutLocation,
    LayoutLocationUniform,
    LayoutLocationVarying,
    LocalConstants,
    MixedQualifiers,
    OpaqueIndex,
    Precision,
    ScalarSwizzles,
    StorageBlocks,
    StructArrayConstructors,
    Switch,
    UniformInitializers,
    UnsignedIntegers,
    VectorLength,
    Centroid,
}

impl Feature {
    /// When it came.
    pub(crate) fn since(self) -> Since {
        match self {
            Self::ArrayLength | Self::ArrayValues | Self::StructArrayConstructors => (120, 300, &[]),
            Self::ArraysOfArrays => (430, 310, &["ARB_arrays_of_arrays"]),
            Self::BitOperators | Self::UnsignedIntegers => (130, 300, &["EXT_gpu_shader4"]),
            Self::Switch => (130, 300, &[]),
            Self::InOutStorage => (
                130,
                300,
                &[
                    "ARB_explicit_attrib_location",
                    "ARB_separate_shader_objects",
                    "ARB_fragment_coord_conventions",
                    "ARB_conservative_depth",
                    "AMD_conservative_depth",
                ],
            ),
            Self::Interpolation => (130, 300, &["EXT_gpu_shader4"]),
            Self::Centroid => (120, 300, &[]),
            Self::BlockInstances => (150, 300, &["ARB_uniform_buffer_object", "ARB_shader_storage_buffer_object"]),
            Self::Blocks => (140, 300, &["ARB_uniform_buffer_object", "ARB_shader_storage_buffer_object"]),
            Self::InOutBlocks => (
                150,
                320,
                &[
                    "OES_shader_io_blocks",
                    "EXT_shader_io_blocks",
                    "OES_geometry_shader",
                    "EXT_geometry_shader",
                    "OES_tessellation_shader",
                    "EXT_tessellation_shader",
                    "ANDROID_extension_pack_es31a",
                ],
            ),
            Self::StorageBlocks => (430, 310, &["ARB_shader_storage_buffer_object"]),
            Self::ConstantCalls => (120, 100, &[]),
            Self::DoubleInputs => (410, NEVER, &["ARB_vertex_attrib_64bit"]),
            Self::Doubles => (400, NEVER, &["ARB_gpu_shader_fp64"]),
            Self::FloatSuffix => (120, 300, &["EXT_gpu_shader4"]),
            Self::ImplicitConversions => (120, NEVER, &["EXT_shader_implicit_conversions"]),
            Self::InitializerLists | Self::LocalConstants | Self::ScalarSwizzles | Self::VectorLength => {
                (420, NEVER, &["ARB_shading_language_420pack"])
            }
            Self::MixedQualifiers => (420, 310, &["ARB_shading_language_420pack", "ARB_enhanced_layouts"]),
            Self::LayoutLocation => (330, 300, &["ARB_explicit_attrib_location", "ARB_separate_shader_objects"]),
            Self::LayoutLocationUniform => (430, 310, &["ARB_explicit_uniform_location"]),
            Self::LayoutLocationVarying => {
                (410, 310, &["ARB_separate_shader_objects", "EXT_separate_shader_objects", "ARB_enhanced_layouts"])
            }
            Self::LayoutExpressions => (440, 310, &["ARB_enhanced_layouts"]),
            Self::Invariant => (120, 100, &[]),
            Self::OpaqueIndex => (400, 320, &["ARB_gpu_shader5", "EXT_gpu_shader5", "OES_gpu_shader5"]),
            Self::Precision => (130, 100, &["ARB_ES2_compatibility", "ARB_ES3_compatibility"]),
            Self::UniformInitializers => (120, NEVER, &[]),
        }
    }

    /// What it is called in messages.
    pub(crate) fn name(self) -> Message {
        match self {
            Self::ArrayLength => message!("`.length()`", "`.length()`"),
            Self::ArrayValues => message!("an array as a value", "値としての配列"),
            Self::StructArrayConstructors => message!("an array constructor", "配列コンストラクタ"),
            Self::ArraysOfArrays => message!("an array of arrays", "配列の配列"),
            Self::BitOperators => message!("this integer operator", "この整数演算子"),
            Self::UnsignedIntegers => message!("an unsigned integer", "符号なし整数"),
            Self::Switch => message!("`switch`", "`switch`"),
            Self::InOutStorage => message!("`in` or `out` at file scope", "大域変数の `in`・`out`"),
            Self::Interpolation => message!("an interpolation qualifier", "補間修飾子"),
            Self::Centroid => message!("`centroid`", "`centroid`"),
            Self::Blocks => message!("a uniform block", "uniform ブロック"),
            Self::BlockInstances => message!("an instance name of a block", "ブロックのインスタンス名"),
            Self::InOutBlocks => message!("an input or output block", "入出力ブロック"),
            Self::StorageBlocks => message!("a storage block", "ストレージブロック"),
            Self::ConstantCalls => message!("a function in a constant expression", "定数式の中の関数"),
            Self::DoubleInputs => message!("a vertex attribute of `double`", "`double` の頂点属性"),
            Self::Doubles => message!("`double`", "`double`"),
            Self::FloatSuffix => message!("the suffix `f`", "接尾辞 `f`"),
            Self::ImplicitConversions => message!("an implicit conversion", "暗黙の型変換"),
            Self::InitializerLists => message!("an initialiser list", "初期化子リスト"),
            Self::ScalarSwizzles => message!("a swizzle of a scalar", "スカラのスウィズル"),
            Self::VectorLength => message!("`.length()` of a vector or matrix", "ベクトル・行列の `.length()`"),
            Self::LocalConstants => message!("a local constant of the run", "実行時に決まるローカル定数"),
            Self::MixedQualifiers => message!("this order of qualifiers", "この順序の修飾子"),
            Self::LayoutExpressions => message!("an expression as a layout value", "layout の値としての式"),
            Self::LayoutLocation => message!("`layout(location)`", "`layout(location)`"),
            Self::LayoutLocationUniform => message!("`layout(location)` of a uniform", "uniform の `layout(location)`"),
            Self::LayoutLocationVarying => {
                message!("`layout(location)` between stages", "ステージ間の変数の `layout(location)`")
            }
            Self::Invariant => message!("`invariant`", "`invariant`"),
            Self::OpaqueIndex => message!("an index that varies into samplers", "サンプラ配列の可変な添字"),
            Self::Precision => message!("a precision qualifier", "精度修飾子"),
            Self::UniformInitializers => message!("an initialiser of a uniform", "uniform の初期化子"),
        }
    }
}

/// Extensions whose words, functions and rules the tables know, without `GL_`. `all` and those that change
/// nothing here count as known.
const KNOWN: &[&str] = &[
    "ARB_arrays_of_arrays",
    "ARB_compatibility",
    "ARB_conservative_depth",
    "AMD_conservative_depth",
    "ARB_derivative_control",
    "ARB_draw_buffers",
    "ARB_draw_instanced",
    "ARB_enhanced_layouts",
    "ARB_ES2_compatibility",
    "ARB_ES3_compatibility",
    "ARB_explicit_attrib_location",
    "ARB_explicit_uniform_location",
    "ARB_fragment_coord_conventions",
    "ARB_gpu_shader_fp64",
    "ARB_separate_shader_objects",
    "ARB_shader_bit_encoding",
    "ARB_shader_stencil_export",
    "AMD_shader_stencil_export",
    "ARB_shader_storage_buffer_object",
    "ARB_shader_texture_lod",
    "ARB_shading_language_420pack",
    "ARB_shading_language_packing",
    "ARB_tessellation_shader",
    "ARB_texture_cube_map_array",
    "ARB_texture_gather",
    "ARB_texture_multisample",
    "ARB_texture_query_levels",
    "ARB_texture_query_lod",
    "ARB_texture_rectangle",
    "ARB_uniform_buffer_object",
    "ARB_vertex_attrib_64bit",
    "ARB_viewport_array",
    "EXT_control_flow_attributes",
    "EXT_null_initializer",
    "EXT_shared_memory_block",
    "EXT_shader_16bit_storage",
    "EXT_shader_8bit_storage",
    "EXT_shader_explicit_arithmetic_types",
    "EXT_shader_explicit_arithmetic_types_float16",
    "EXT_shader_explicit_arithmetic_types_float32",
    "EXT_shader_explicit_arithmetic_types_float64",
    "EXT_shader_explicit_arithmetic_types_int8",
    "EXT_shader_explicit_arithmetic_types_int16",
    "EXT_shader_explicit_arithmetic_types_int32",
    "EXT_shader_subgroup_extended_types_float16",
    "EXT_shader_subgroup_extended_types_int16",
    "EXT_shader_subgroup_extended_types_int8",
    "KHR_shader_subgroup_arithmetic",
    "KHR_shader_subgroup_ballot",
    "KHR_shader_subgroup_basic",
    "KHR_shader_subgroup_clustered",
    "KHR_shader_subgroup_quad",
    "KHR_shader_subgroup_rotate",
    "KHR_shader_subgroup_shuffle",
    "KHR_shader_subgroup_shuffle_relative",
    "KHR_shader_subgroup_vote",
    "EXT_separate_shader_objects",
    "EXT_texture_array",
    "MESA_shader_integer_functions",
    "OES_standard_derivatives",
    "OES_texture_3D",
    "EXT_frag_depth",
    "ARB_cull_distance",
    "ARB_fragment_layer_viewport",
];

impl Language {
    pub(crate) fn new(version: &Version, extensions: &[Extension]) -> Self {
        let mut enabled: Vec<String> = Vec::new();
        for e in extensions {
            let name = e.name.strip_prefix("GL_").unwrap_or(&e.name).to_owned();
            if e.behavior != "disable" && !enabled.contains(&name) {
                enabled.push(name);
            }
        }
        let open = enabled.iter().any(|e| e != "all" && !KNOWN.contains(&e.as_str()));
        Self { number: version.number, profile: version.profile, enabled, open }
    }

    pub(crate) fn number(&self) -> u32 {
        self.number
    }

    pub(crate) fn es(&self) -> bool {
        self.profile == Profile::Es
    }

    /// True in the core profile, where what 1.30 deprecated is gone: from 1.40 on.
    pub(crate) fn core(&self) -> bool {
        match self.profile {
            Profile::Core => self.number >= 140 && !self.enabled("ARB_compatibility"),
            Profile::Compatibility => self.number == 140 && !self.enabled("ARB_compatibility"),
            Profile::Es => false,
        }
    }

    /// True when an extension is on of which the tables know nothing.
    pub(crate) fn is_open(&self) -> bool {
        self.open
    }

    /// True when the version is at least the one of its profile.
    pub(crate) fn at_least(&self, desktop: u32, es: u32) -> bool {
        self.number >= if self.es() { es } else { desktop }
    }

    /// True when the extension, without `GL_`, is on.
    pub(crate) fn enabled(&self, extension: &str) -> bool {
        self.enabled.iter().any(|e| e == extension)
    }

    pub(crate) fn since(&self, (desktop, es, extensions): Since) -> bool {
        self.at_least(desktop, es) || extensions.iter().any(|e| self.enabled(e)) || self.open
    }

    /// The same without what an extension may bring of which nothing is known.
    pub(crate) fn stated(&self, (desktop, es, extensions): Since) -> bool {
        self.at_least(desktop, es) || extensions.iter().any(|e| self.enabled(e))
    }

    /// True when an extension is on whose name has this word.
    pub(crate) fn enabled_with(&self, word: &str) -> bool {
        self.enabled.iter().any(|e| e.contains(word))
    }

    /// True where samplers and images are numbers that any variable may hold.
    pub(crate) fn bindless(&self) -> bool {
        self.enabled("ARB_bindless_texture") || self.enabled("NV_bindless_texture")
    }

    pub(crate) fn has(&self, feature: Feature) -> bool {
        self.since(feature.since())
    }

    /// `GLSL 1.20`, `GLSL ES 3.00`.
    pub(crate) fn name(&self) -> String {
        name(self.number, self.es())
    }

    /// Tells that something came later than this version.
    pub(crate) fn lacks(&self, sink: &mut Sink, what: &Message, since: Since, span: Span) {
        let (en, ja) = (what.in_lang(Lang::En), what.in_lang(Lang::Ja));
        let wanted = self.wanted(since);
        let (wanted_en, wanted_ja) = (wanted.in_lang(Lang::En), wanted.in_lang(Lang::Ja));
        let version = self.name();
        // Only an extension brings it.
        let extension = wanted_en.starts_with('`');
        let code = if extension { errors::EXTENSION } else { errors::NEEDS_VERSION };
        let message = Message::new(format!("{en} needs {wanted_en}"), format!("{ja}には {wanted_ja} が必要です"));
        let help = if extension {
            let name = wanted_en.trim_matches('`');
            message!(
                "put `#extension {name} : enable` behind `#version`",
                "`#version` の後に `#extension {name} : enable` を書いてください"
            )
        } else {
            Message::new(
                format!("declare {wanted_en}, or write it without this"),
                format!("{wanted_ja} を宣言するか、これを使わずに書いてください"),
            )
        };
        let d = sink
            .start(code, span, message)
            .with_label(message!("this shader is {version}", "このシェーダは {version} です"))
            .with_help(help);
        sink.push(d);
    }

    /// What has to be there for something: "GLSL 1.30", "GLSL 4.20 or `GL_ARB_…`".
    pub(crate) fn wanted(&self, (desktop, es, extensions): Since) -> Message {
        let first = if self.es() { es } else { desktop };
        let fits = |e: &&&str| {
            let only_es = e.starts_with("OES_") || e.starts_with("ANDROID_");
            let only_desktop = e.starts_with("ARB_");
            if self.es() { !only_desktop } else { !only_es }
        };
        let extension = extensions.iter().find(fits).map(|e| format!("`GL_{e}`"));
        let version = (first != NEVER).then(|| name(first, self.es()));
        match (version, extension) {
            (Some(v), Some(e)) => message!("{v} or {e}", "{v} または {e}"),
            (Some(one), None) | (None, Some(one)) => message!("{one}", "{one}"),
            (None, None) if self.es() => message!("desktop GLSL", "デスクトップ版の GLSL"),
            (None, None) => message!("GLSL ES", "GLSL ES"),
        }
    }
}

fn name(number: u32, es: bool) -> String {
    let es = if es { "ES " } else { "" };
    format!("GLSL {es}{}.{:02}", number / 100, number % 100)
}

/// True for a name of the language itself.
pub(crate) fn is_builtin_name(name: &Ident) -> bool {
    name.name.starts_with("gl_")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn language(number: u32, profile: Profile, extensions: &[&str]) -> Language {
        let extensions: Vec<_> = extensions
            .iter()
            .map(|e| Extension { name: (*e).to_owned(), behavior: "enable".to_owned(), span: base::text::Span::at(0) })
            .collect();
        Language::new(&Version { number, profile, span: None }, &extensions)
    }

    #[test]
    fn features_come_with_versions_profiles_and_extensions() {
        let old = language(120, Profile::Compatibility, &[]);
        assert!(!old.has(Feature::Switch) && old.has(Feature::FloatSuffix) && !old.core());
        assert!(language(140, Profile::Compatibility, &[]).core());
        assert!(!language(140, Profile::Compatibility, &["GL_ARB_compatibility"]).core());
        let es = language(300, Profile::Es, &[]);
        assert!(es.has(Feature::Switch) && !es.has(Feature::ImplicitConversions));
        let packed = language(150, Profile::Core, &["GL_ARB_shading_language_420pack"]);
        assert!(packed.has(Feature::ScalarSwizzles) && !packed.has(Feature::Doubles) && !packed.is_open());
        // An extension that is not known may bring anything.
        assert!(language(150, Profile::Core, &["GL_XYZ_new_things"]).has(Feature::Doubles));
    }

    #[test]
    fn what_is_wanted_is_named_for_the_profile() {
        let old = language(120, Profile::Compatibility, &[]);
        assert_eq!(&*old.wanted(Feature::Switch.since()), "GLSL 1.30");
        assert_eq!(&*old.wanted(Feature::ScalarSwizzles.since()), "GLSL 4.20 or `GL_ARB_shading_language_420pack`");
        let es = language(300, Profile::Es, &[]);
        assert_eq!(&*es.wanted(Feature::InOutBlocks.since()), "GLSL ES 3.20 or `GL_OES_shader_io_blocks`");
        assert_eq!(&*es.wanted(Feature::Doubles.since()), "desktop GLSL");
    }
}
