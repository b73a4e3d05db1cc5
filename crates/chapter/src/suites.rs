//! The suites of the chapter and of the note on hair, with the texts of their shaders.

use engine::suite::ShippedSuite;

/// One entry: folder, name of the suite, extension of the shader.
macro_rules! suites {
    ($($folder:literal $name:literal $extension:literal;)*) => {
        &[$(ShippedSuite {
            name: $name,
            path: concat!($folder, "/", $name, ".suite.toml"),
            toml: include_str!(concat!(env!("SHADERCHECK_SHADERS"), "/", $folder, "/", $name, ".suite.toml")),
            shader_name: concat!($name, ".", $extension),
            shader_text: include_str!(concat!(env!("SHADERCHECK_SHADERS"), "/", $folder, "/", $name, ".", $extension)),
        }),*]
    };
}

/// The suites of the chapter and of the note on hair, in the order in which they are run and listed.
pub static SUITES: &[ShippedSuite] = suites! {
    "chapter9" "sphere" "vert";
    "chapter9" "cylinder" "vert";
    "chapter9" "morph" "vert";
    "chapter9" "morph_targets" "vert";
    "chapter9" "joints" "vert";
    "chapter9" "two_bones" "vert";
    "chapter9" "segment_distance" "glsl";
    "chapter9" "bone_weight" "glsl";
    "chapter9" "skinning" "vert";
    "hair" "hermite" "glsl";
    "hair" "catmull_rom" "glsl";
    "hair" "cardinal" "glsl";
    "hair" "kochanek_bartels" "glsl";
    "hair" "hair" "geom";
};
