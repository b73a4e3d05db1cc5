//! Work that is written reads back as it was, whatever it is.

use super::wire::{Reader, Wire, Writer};
use super::{Front, Work};
use crate::vulkan::Naga;
use base::text::SourceFile;
use base::value::Batch;
use program::lower::Target;
use program::{InputSource, Kernel, Program};
use syntax::Stage;

fn program(name: &str, text: &str, target: &Target) -> Program {
    let stage = Stage::from_path(name).unwrap();
    Program::from_source(&SourceFile::new(name, text), stage, |_| Ok(target.clone())).unwrap()
}

/// The words of a kernel, and what they are read as.
fn both_ways(kernel: &Kernel) -> (Vec<u32>, crate::vulkan::Job, crate::vulkan::Job) {
    let Work::Wgpu(job) = Naga.work(kernel).unwrap() else { panic!("work of another lane") };
    let mut writer = Writer::default();
    job.put(&mut writer);
    let words = writer.finish().unwrap();
    let mut reader = Reader::new(&words);
    let back = Wire::take(&mut reader).expect("words that were just written");
    assert!(reader.is_empty());
    (words, *job, back)
}

const VERTEX: &str = "#version 450
struct S { vec3 a; mat3x2 b[2]; };
layout(std140, binding = 0) uniform Block { S s; float k; };
uniform sampler2D map;
layout(location = 0) in vec4 p;
layout(location = 1) in ivec2 i;
layout(location = 0) out vec3 q;
layout(location = 1) flat out uint n;
const float table[3] = float[](1.0, -0.0, 1e-42);
float f(inout vec3 v, out float w) { w = modf(v.x, v.y) + frexp(v.z, n == 1u ? i.x : i.y, i.y); return determinant(mat3(v, v, v)); }
void main() {
  q = vec3(0.0);
  for (int j = 0; j < i.x; ++j) { if (j == 3) continue; q += s.a * table[j % 3]; if (q.x > k) break; }
  switch (i.y) { case 0: q.x = 1.0; case 1: q.y = 2.0; break; default: q.z = 3.0; }
  n = bitfieldReverse(uint(i.x)) >> 3u;
  q.xy += s.b[1] * q + texelFetch(map, i, 0).xy + textureLod(map, p.xy, 0.0).zw;
  gl_Position = mix(p, p.wzyx, bvec4(true, false, i.x > 1, isnan(p.x)));
}";

#[test]
fn every_form_of_a_kernel_reads_back_as_it_was() {
    let text = VERTEX.replace("float f(inout vec3 v, out float w) { w = modf(v.x, v.y) + frexp(v.z, n == 1u ? i.x : i.y, i.y); return determinant(mat3(v, v, v)); }\n", "");
    let program = program("a.vert", &text, &Target::Stage);
    let batch = Batch {
        invocation_record: program.invocation_record().into(),
        case_record: program.case_record().into(),
        per_case: 1,
        invocations: vec![7; program.invocation_record().words()],
        cases: vec![9; program.case_record().words()],
    };
    let mut kernels = vec![program.compute_kernel().unwrap(), program.vertex_kernel(&[4, 2]).unwrap()];
    kernels.extend(
        [InputSource::Uniforms, InputSource::Constants].map(|source| program.kernel_from(source, &batch).unwrap()),
    );
    kernels.push(program.compute_kernel().unwrap().with_fuel(77).unwrap());
    for kernel in kernels {
        let (_, job, back) = both_ways(&kernel);
        // Places of the text are left out; nothing else is.
        let place = |line: &&str| ["start: ", "end: "].iter().any(|name| line.trim_start().starts_with(name));
        let (before, after) = (format!("{:#?}", job.module), format!("{:#?}", back.module));
        let (before, after) = (before.lines().filter(|l| !place(l)), after.lines().filter(|l| !place(l)));
        assert_eq!(before.clone().count(), after.clone().count(), "{:?}", kernel.form);
        before.zip(after).for_each(|(before, after)| assert_eq!(before, after, "{:?}", kernel.form));
        assert_eq!(format!("{:?}", job.form), format!("{:?}", back.form));
        assert_eq!((job.invocation, job.case, job.output), (back.invocation, back.case, back.output));
        assert_eq!(format!("{:?}", job.textures), format!("{:?}", back.textures));
    }
}

#[test]
fn words_that_are_cut_off_or_changed_bring_nothing_down() {
    let program =
        program("g.glsl", "float f(float a, out int b) { b = int(a); return sin(a); }", &Target::Function("f".into()));
    let (words, ..) = both_ways(&program.compute_kernel().unwrap());
    for end in 0..words.len() {
        let mut reader = Reader::new(&words[..end]);
        let read: Option<crate::vulkan::Job> = Wire::take(&mut reader);
        assert!(read.is_none(), "{end}");
    }
    for at in 0..words.len() {
        for change in [1, 0x8000_0000, 0xffff_ffff] {
            let mut words = words.clone();
            words[at] ^= change;
            let _: Option<crate::vulkan::Job> = Wire::take(&mut Reader::new(&words));
        }
    }
}
