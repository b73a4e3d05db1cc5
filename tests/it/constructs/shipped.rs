//! Every shipped shader means the same by edits in place and built from its syntax tree.

use base::text::SourceFile;
use engine::suite::run::prepare;
use engine::suite::{find, parse, shipped};
use program::Program;
use program::interp::{self, Binary32, Binary64};
use program::lower::Target;
use property::Sampler;
use syntax::{Shader, Stage};

#[test]
fn both_ways_to_a_module_mean_the_same() {
    for shipped in shipped() {
        let shipped = find(shipped.name).unwrap();
        let suite = parse(&SourceFile::new(shipped.path, shipped.toml)).unwrap();
        let file = SourceFile::new(shipped.shader_name, shipped.shader_text);
        let prepared = prepare(&suite, &file).unwrap();
        let shader = Shader::parse(&file, Stage::from_path(file.name()).unwrap()).shader;
        let target = prepared.suite.entry.clone().map_or(Target::Stage, Target::Function);
        let tree = Program::build(&shader, &target).unwrap_or_else(|e| panic!("{}: {e}", shipped.name));
        let edits = &prepared.program;
        let names = |p: &Program| -> Vec<String> {
            let all = p.inputs.iter().chain(&p.uniforms).chain(&p.outputs);
            all.map(|port| format!("{} {}", port.field.name, port.field.shape)).collect()
        };
        assert_eq!(names(&tree), names(edits), "{}", shipped.name);
        let per_case = prepared.suite.strands.map_or(prepared.suite.per_case, |s| s.primitives()).max(1);
        let batch = Sampler::new(prepared.plan.clone(), 11).batch(0, 64, per_case);
        let single = |p: &Program| interp::run::<Binary32>(p, &batch).unwrap();
        let real = |p: &Program| interp::run::<Binary64>(p, &batch).unwrap();
        let (a, b) = (single(&tree), single(edits));
        let (c, d) = (real(&tree), real(edits));
        for invocation in 0..batch.invocation_count() {
            assert_eq!(a.stored(invocation), b.stored(invocation), "{}", shipped.name);
            for vertex in 0..a.stored(invocation) {
                assert_eq!(a.vertex(invocation, vertex), b.vertex(invocation, vertex), "{}", shipped.name);
                let pairs = c.vertex(invocation, vertex).iter().zip(d.vertex(invocation, vertex));
                assert!(pairs.into_iter().all(|(x, y)| x.to_bits() == y.to_bits()), "{}", shipped.name);
            }
        }
    }
}
