use shadercheck::bound::profile::by_name;
use shadercheck::bound::tape::{Model, Tape};
use shadercheck::interp::{self, LANES, Machine, OutputColumn};
use shadercheck::lane::{Lane as _, Stage, vulkan};
use shadercheck::property::Sampler;
use shadercheck::suite::run::prepare;

#[test]
fn look() {
    let lane = vulkan::open().unwrap();
    for shipped in shadercheck::suite::shipped() {
        let suite = shadercheck::suite::parse(&shadercheck::text::SourceFile::new(shipped.path, shipped.toml)).unwrap();
        let prepared =
            prepare(&suite, &shadercheck::text::SourceFile::new(shipped.shader_name, shipped.shader_text)).unwrap();
        let exe = interp::compile(&prepared.program).unwrap();
        let per = suite.strands.map_or(suite.per_case, |s| s.primitives()).max(1);
        let batch = Sampler::new(prepared.plan.clone(), 1).batch(0, 16384 / per, per);
        let actual = lane.prepare(&prepared.compute, batch.invocation_count()).unwrap().run(&batch).unwrap();
        for rearranged in [false, true] {
            let model = Model::Device { profile: by_name("vulkan-1.4").unwrap(), stage: Stage::Compute, rearranged };
            let t0 = std::time::Instant::now();
            let mut machine = Machine::new(&exe, Tape::new(model), interp::FUEL);
            let (mut inf, mut fork, mut bad, mut n) = (0, 0, 0, 0);
            let mut worst: f64 = 0.0;
            let mut rel = Vec::new();
            let mut causes = std::collections::BTreeMap::new();
            for first in (0..batch.invocation_count()).step_by(LANES) {
                let lanes = machine.run(&batch, first);
                let vertices = exe.max_vertices().map_or(1, |m| m as usize);
                for vertex in 0..vertices {
                    for word in 0..exe.outputs().len() {
                        let OutputColumn::Real(column) = machine.output(vertex, word) else { continue };
                        let column = *column;
                        let values = *machine.domain().values(column);
                        let bounds = machine.domain().bounds(column, &mut |_| false);
                        for lane in 0..lanes {
                            n += 1;
                            if machine.domain().fork(lane).is_some() {
                                fork += 1;
                                continue;
                            }
                            let b = bounds.bound[lane];
                            if !b.is_finite() {
                                inf += 1;
                                if let Some(c) = machine.domain().cause(column, lane) {
                                    *causes.entry(format!("{:?} {:?}", c.why, c.op)).or_insert(0) += 1;
                                }
                                continue;
                            }
                            let d = f64::from(f32::from_bits(actual.vertex(first + lane, vertex)[word]));
                            let err = (d - values[lane]).abs();
                            if !(err <= b) {
                                bad += 1;
                                if bad < 4 {
                                    println!("   {word} {d} {} bound {b}", values[lane]);
                                }
                            } else if b > 0.0 {
                                worst = worst.max(err / b);
                                rel.push(b / values[lane].abs());
                            }
                        }
                    }
                }
            }
            rel.sort_by(f64::total_cmp);
            println!(
                "{} rearr {rearranged}: {n} words, inf {inf}, fork {fork}, bad {bad}, worst {worst:.3}, rel bound med {:.2e} p99 {:.2e}; {:?} {causes:?}",
                suite.name,
                rel.get(rel.len() / 2).unwrap_or(&0.0),
                rel.get(rel.len() * 99 / 100).unwrap_or(&0.0),
                t0.elapsed()
            );
        }
    }
}

#[test]
fn literals() {
    for shipped in shadercheck::suite::shipped() {
        let suite = shadercheck::suite::parse(&shadercheck::text::SourceFile::new(shipped.path, shipped.toml)).unwrap();
        let prepared =
            prepare(&suite, &shadercheck::text::SourceFile::new(shipped.shader_name, shipped.shader_text)).unwrap();
        let exe = interp::compile(&prepared.program).unwrap();
        for (site, value) in exe.literals() {
            let span = exe.place(site).span.to_range();
            let text = span.map(|r| prepared.program.lowered.edited.text[r].to_owned());
            println!("{} {value} {text:?}", suite.name);
        }
    }
}
