//! How fast the linter is: a project of 3,000 files, made on the spot, read from disk and linted as the
//! command does it. Prints files a second and the peak of memory.

#![expect(clippy::print_stdout, reason = "a benchmark prints its figures")]

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use shadercheck::cli::lint::{LintArgs, run};

/// Programs of a vertex shader, a fragment shader and a host file each.
const PROGRAMS: usize = 1000;
/// Repetitions; the fastest counts, since other work on the machine only ever slows a run down.
const REPEAT: usize = 5;

fn main() -> anyhow::Result<()> {
    let folder = tempfile::tempdir()?;
    let mut bytes = 0;
    for n in 0..PROGRAMS {
        let place = folder.path().join(format!("module{:02}", n % 40));
        fs::create_dir_all(&place)?;
        bytes += write(&place, &format!("scene{n}.vert"), &vertex(n))?;
        bytes += write(&place, &format!("scene{n}.frag"), &fragment(n))?;
        bytes += write(&place, &format!("scene{n}.cpp"), &host(n))?;
    }
    let args = LintArgs {
        paths: vec![folder.path().to_owned()],
        format: Some("concise".to_owned()),
        no_config: true,
        ..LintArgs::default()
    };
    let mut fastest = Duration::MAX;
    let (mut found, mut memory) = (0, None);
    for _ in 0..REPEAT {
        let (mut out, mut err) = (Vec::new(), Vec::new());
        let start = Instant::now();
        run(&args, &mut out, &mut err, false)?;
        fastest = fastest.min(start.elapsed());
        // Of the first run: what a later one adds is what the allocator has not given back.
        memory = memory.or_else(peak);
        found = out.iter().filter(|b| **b == b'\n').count();
    }
    let files = 3 * PROGRAMS;
    println!("lint: {files} files, {:.1} MB, {found} findings, fastest of {REPEAT}", bytes as f64 / 1e6);
    println!(
        "{:.2} s, {:.0} files/s, {:.1} MB/s, peak of memory {}",
        fastest.as_secs_f64(),
        files as f64 / fastest.as_secs_f64(),
        bytes as f64 / 1e6 / fastest.as_secs_f64(),
        memory.map_or_else(|| "unknown".to_owned(), |kb| format!("{} MB", kb / 1024)),
    );
    Ok(())
}

fn write(folder: &Path, name: &str, text: &str) -> anyhow::Result<usize> {
    fs::write(folder.join(name), text)?;
    Ok(text.len())
}

/// Peak of resident memory in kB, on systems that tell it.
fn peak() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse().ok()
}

fn vertex(n: usize) -> String {
    let bones = 4 + n % 60;
    format!(
        "#version 150 core

// Skinned vertices of scene {n}.
const int BONES = {bones};

uniform mat4 view;
uniform mat4 projection;
uniform mat4 bones[BONES];
uniform float scale{n};

in vec4 position;
in vec3 normal;
in vec2 uv;
in vec4 weights;
in vec4 indices;

out vec3 eyeNormal;
out vec3 eyePosition;
out vec2 texcoord;

mat4 blended()
{{
  mat4 sum = weights.x * bones[int(indices.x)];
  sum += weights.y * bones[int(indices.y)];
  sum += weights.z * bones[int(indices.z)];
  sum += weights.w * bones[int(indices.w)];
  return sum;
}}

float wave(float x, float phase)
{{
  float height = 0.0;
  for (int i = 1; i <= {octaves}; ++i)
  {{
    float f = float(i);
    height += sin(x * f + phase) / f;
  }}
  return height;
}}

void main(void)
{{
  mat4 skin = blended();
  vec4 moved = skin * vec4(position.xyz * scale{n}, 1.0);
  moved.y += 0.05 * wave(moved.x, scale{n});
  vec4 eye = view * moved;
  eyeNormal = normalize(mat3(view) * mat3(skin) * normal);
  eyePosition = eye.xyz;
  texcoord = uv;
  gl_Position = projection * eye;
}}
",
        octaves = 2 + n % 5
    )
}

fn fragment(n: usize) -> String {
    let lights = 1 + n % 8;
    // One in twenty has a finding, so that reporting is part of the time.
    let turn = if n.is_multiple_of(20) { "6.283185" } else { "6.28318530717958648" };
    format!(
        "#version 150 core

// Lights of scene {n}.
const int LIGHTS = {lights};

struct Light
{{
  vec3 position;
  vec3 color;
  float radius;
}};

uniform Light lights[LIGHTS];
uniform sampler2D albedo;
uniform float shininess;
uniform float time;

in vec3 eyeNormal;
in vec3 eyePosition;
in vec2 texcoord;

out vec4 color;

vec3 shade(Light light, vec3 n, vec3 v, vec3 base)
{{
  vec3 l = light.position - eyePosition;
  float d = length(l);
  vec3 dir = l / max(d, 1.0e-4);
  float fall = 1.0 / (1.0 + d * d / (light.radius * light.radius + 1.0e-3));
  float diffuse = max(dot(n, dir), 0.0);
  vec3 h = normalize(dir + v);
  float specular = pow(max(dot(n, h), 0.0), max(shininess, 1.0));
  return fall * light.color * (base * diffuse + vec3(0.04 * specular));
}}

void main(void)
{{
  vec3 n = normalize(eyeNormal);
  vec3 v = normalize(-eyePosition);
  vec3 base = texture(albedo, texcoord).rgb;
  vec3 sum = 0.03 * base;
  for (int i = 0; i < LIGHTS; ++i)
  {{
    sum += shade(lights[i], n, v, base);
  }}
  float pulse = 0.5 + 0.5 * sin({turn} * time);
  if (pulse > 0.75 && sum.r < 1.0)
  {{
    sum *= 1.0 + 0.01 * pulse;
  }}
  color = vec4(pow(sum, vec3(1.0 / 2.2)), 1.0);
}}
"
    )
}

fn host(n: usize) -> String {
    let mut draws = String::new();
    for i in 0..4 + n % 12 {
        draws.push_str(&format!(
            "  // Part {i}.
  glBindVertexArray(parts[{i}].vao);
  glBindTexture(GL_TEXTURE_2D, parts[{i}].texture);
  glUniform1f(scaleLoc, parts[{i}].scale);
  if (parts[{i}].visible && frame % {period} != 0)
  {{
    glDrawElements(GL_TRIANGLES, parts[{i}].count, GL_UNSIGNED_INT, nullptr);
  }}
",
            period = 2 + i
        ));
    }
    format!(
        "#include <cmath>
#include <vector>
#include <GL/glew.h>

namespace scene{n} {{

struct Part
{{
  GLuint vao, texture;
  GLsizei count;
  float scale;
  bool visible;
}};

extern GLuint loadProgram(const char *vert, const char *frag);

class Scene
{{
public:
  Scene() : program(loadProgram(\"scene{n}.vert\", \"scene{n}.frag\"))
  {{
    viewLoc = glGetUniformLocation(program, \"view\");
    projectionLoc = glGetUniformLocation(program, \"projection\");
    scaleLoc = glGetUniformLocation(program, \"scale{n}\");
    timeLoc = glGetUniformLocation(program, \"time\");
    shininessLoc = glGetUniformLocation(program, \"shininess\");
  }}

  void draw(const float *view, const float *projection, float seconds);

private:
  const GLuint program;
  GLint viewLoc, projectionLoc, scaleLoc, timeLoc, shininessLoc;
  std::vector<Part> parts;
  int frame = 0;
}};

void Scene::draw(const float *view, const float *projection, float seconds)
{{
  glUseProgram(program);
  glUniformMatrix4fv(viewLoc, 1, GL_FALSE, view);
  glUniformMatrix4fv(projectionLoc, 1, GL_FALSE, projection);
  glUniform1f(timeLoc, std::fmod(seconds, 60.0f));
  glUniform1f(shininessLoc, 32.0f);
{draws}  ++frame;
}}

}}
"
    )
}
