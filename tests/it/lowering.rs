//! Every shipped shader in the dialect of naga's GLSL reader, and shaders for other tests.

use base::text::SourceFile;
use engine::suite;
use program::lower::Target;
use program::{Language, Program, ProgramError, Translation};
use syntax::{Shader, Stage};

/// A shader with what is run of it.
pub struct Case {
    /// The text, named as its file.
    pub file: SourceFile,
    stage: Stage,
    target: Target,
}

/// Makes one test of each shipped shader: `main` of a stage, the entry of a library. The test
/// `every_shipped_shader_is_listed` holds the list complete.
macro_rules! each_shader {
    ($check:ident) => {
        $crate::lowering::each_shader! { $check;
            sphere cylinder morph morph_targets joints two_bones segment_distance bone_weight skinning
            hermite catmull_rom cardinal kochanek_bartels hair hair_vert
        }
    };
    ($check:ident; $($name:ident)*) => {
        const LISTED: &[&str] = &[$(stringify!($name)),*];

        #[test]
        fn every_shipped_shader_is_listed() {
            assert_eq!(LISTED, $crate::lowering::names());
        }

        $(#[test]
        fn $name() {
            $check(stringify!($name));
        })*
    };
}
pub(crate) use each_shader;

/// The vertex stage in front of the geometry stage `hair`. It only hands the position on, and no
/// suite judges it alone.
const HAIR_VERT: &str = include_str!("../../shaders/hair/hair.vert");

/// Uniforms whose parts stand further apart in a uniform buffer than their own size.
pub const UNIFORMS: &str = "#version 150 core
in vec4 position;
uniform float weights[3];
uniform vec2 offsets[2];
uniform int parts[2];
uniform vec3 directions[2];
uniform mat2 turn;
uniform mat3 normals[2];
layout(std140) uniform Scene { float near[2]; vec3 eye; float far; };
void main()
{
  vec2 xy = turn * position.xy + offsets[1] * weights[gl_VertexID % 3];
  vec3 n = normals[1] * directions[parts[1]] + eye * near[1];
  gl_Position = vec4(xy, n.z, far);
}
";

/// Names of all shipped shaders: of their suites, and `hair_vert`.
pub fn names() -> Vec<&'static str> {
    suite::shipped().map(|s| s.name).chain(["hair_vert"]).collect()
}

/// A shipped shader by name.
pub fn shipped(name: &str) -> Case {
    if name == "hair_vert" {
        let file = SourceFile::new("hair.vert", HAIR_VERT);
        return Case { file, stage: Stage::Vertex, target: Target::Stage };
    }
    let shipped = suite::find(name).unwrap();
    let suite = suite::parse(&SourceFile::new(shipped.path, shipped.toml)).unwrap();
    let target = suite.entry.map_or(Target::Stage, Target::Function);
    let stage = Stage::from_path(shipped.shader_name).unwrap();
    Case { file: SourceFile::new(shipped.shader_name, shipped.shader_text), stage, target }
}

/// A stage that a test states.
pub fn stage(name: &str, text: &str) -> Case {
    let stage = Stage::from_path(name).unwrap();
    Case { file: SourceFile::new(name, text), stage, target: Target::Stage }
}

impl Case {
    /// The shader as a program.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn try_program(&self) -> Result<Program, ProgramError> {
        let parsed = Shader::parse(&self.file, self.stage);
        assert!(parsed.diagnostics.is_empty(), "{:#?}", parsed.diagnostics);
        Program::from_source(&self.file, self.stage, |_| Ok(self.target.clone()))
    }

    /// The shader as a program.
    pub fn program(&self) -> Program {
        self.try_program().unwrap_or_else(|e| panic!("{e}\n{}", self.file.text()))
    }
}

/// Compares with `snapshots/FOLDER/NAME.snap`.
pub fn compare_snapshot(folder: &str, name: &str, text: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(format!("snapshots/{folder}"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!(name, text));
}

fn check(name: &str) {
    let case = shipped(name);
    let Ok(Translation::Text(text)) = case.program().translate(Language::NagaGlsl) else { panic!("{name}") };
    compare_snapshot("lowered", case.file.name(), &text);
}

each_shader!(check);
