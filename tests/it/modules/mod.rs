//! Texts that are read as modules, WGSL, SPIR-V, HLSL and Slang, through every command that takes a shader.

mod compiled;
mod read;
mod refused;
mod suites;

use std::fs;
use std::path::Path;

use crate::binary::{Ran, run_in};

/// A vertex and two fragment stages, constants of the pipeline, structures, a texture, derivatives and `discard`.
const SCENE: &str = "\
struct Uniforms { mvp: mat4x4<f32>, tint: vec3f, k: f32 }
@group(0) @binding(0) var<uniform> u: Uniforms;
@group(1) @binding(3) var tex: texture_2d<f32>;
@group(1) @binding(4) var smp: sampler;
override scale: f32 = 2.0;
override count: u32;
struct VsIn { @location(0) position: vec3f, @location(1) uv: vec2f, @builtin(vertex_index) index: u32 }
struct VsOut { @builtin(position) clip: vec4f, @location(0) uv: vec2f }
const offsets = array<f32, 3>(0.0, 1.0, 2.0);
fn lift(p: vec3f, by: f32) -> vec3f { return p + vec3f(0.0, by, 0.0); }
struct Ray { origin: vec3f, dir: vec3f }
fn hit(ray: Ray, t: ptr<function, f32>) -> Ray { *t = length(ray.dir); return Ray(ray.origin + ray.dir * *t, ray.dir); }
@vertex fn vs_main(in: VsIn) -> VsOut {
  var out: VsOut;
  out.clip = u.mvp * vec4f(lift(in.position, offsets[in.index]) * scale, 1.0);
  out.uv = in.uv * f32(count);
  return out;
}
@fragment fn fs_main(in: VsOut) -> @location(0) vec4f {
  if (in.uv.x < 0.25) { discard; }
  return textureSample(tex, smp, in.uv) * vec4f(u.tint, u.k);
}
@fragment fn fs_slope(@location(0) uv: vec2f) -> @location(0) vec2f { return vec2f(dpdx(uv.x * uv.y), fwidth(uv.x)); }
";

/// A folder with these files.
fn folder(files: &[(&str, &[u8])]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        fs::write(folder.path().join(name), bytes).unwrap();
    }
    folder
}

/// Runs the binary in a folder that holds the scene.
fn scene(args: &str) -> Ran {
    let folder = folder(&[("scene.wgsl", SCENE.as_bytes())]);
    run_in(folder.path(), args)
}

/// The folder of the chapter's shaders in other languages.
fn languages() -> &'static Path {
    Path::new("fixtures/languages")
}
