//! Fragment stages under a suite: what samplers are bound to, wrong texels, and who is to blame for them.

use std::fs;
use std::sync::Arc;

use base::value::Batch;
use lanes::{Actual, Description, Lane, LaneError, Runner, Stage, embedded};
use program::Kernel;

use super::{check, folder};
use crate::binary::{Ran, command};

/// A suite about `lit.frag`.
fn suite(rest: &str) -> String {
    format!(
        "suite = \"lit\"\nshader = \"lit.frag\"\nstage = \"fragment\"\nsamples = 2000\n{rest}\n\
         [[inputs]]\nnames = [\"uv\"]\ngenerator = \"interval\"\nrange = [0.0, 1.0]\n\
         [[inputs]]\nnames = [\"gain\"]\ngenerator = \"interval\"\nrange = [0.5, 2.0]\n\
         [floors]\nundetermined = 0.2\nreason = \"coordinates at the edges of texels\"\n"
    )
}

const LIT: &str = "#version 330\nin vec2 uv;\nuniform float gain;\nuniform sampler2D map;\nout vec4 color;\n\
                   void main() { vec4 t = texture(map, uv); if (t.w < 0.25) discard; color = t * gain; }\n";

/// Runs the suite with these lines in it on a shader, beside what the shader was.
fn lit(shader: &str, rest: &str) -> Ran {
    check(&[("lit.frag", shader), ("old.frag", LIT), ("lit.suite.toml", &suite(rest))], &[])
}

#[test]
fn a_fragment_stage_runs_and_its_textures_are_reported() {
    let ran = lit(LIT, "").expect(0);
    assert!(ran.out.contains("texture map: 2D, float, 16 x 8, procedural"), "{}", ran.out);
    let ran = lit(LIT, "textures = { map = \"checker\" }").expect(0);
    assert!(ran.out.contains("texture map: 2D, float, 16 x 8, checker"), "{}", ran.out);
}

#[test]
fn a_wrong_texel_is_blamed_on_the_shader() {
    let wrong = LIT.replace("texture(map, uv)", "texture(map, uv.yx)");
    let ran = lit(&wrong, "reference = \"old.frag\"").expect(1);
    assert!(ran.out.contains("the shader deviates from"), "{}", ran.out);
    lit(LIT, "reference = \"old.frag\"").expect(0);
    // With the same number everywhere it does not matter which texel it is.
    lit(&wrong, "reference = \"old.frag\"\ntextures = { map = [0.5, 0.25, 0.125, 1.0] }").expect(0);
}

#[test]
fn a_wrong_discard_is_blamed_on_the_shader() {
    let wrong = LIT.replace("t.w < 0.25", "t.w > 0.25");
    let ran = lit(&wrong, "reference = \"old.frag\"").expect(1);
    assert!(ran.out.contains("the shader deviates from"), "{}", ran.out);
}

#[test]
fn a_picture_is_bound_and_what_does_not_fit_is_reported_at_its_place() {
    let folder = folder(&[("lit.frag", LIT), ("lit.suite.toml", &suite("textures = { map = \"wood.png\" }"))]);
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 4, 2);
    encoder.set_color(png::ColorType::Rgba);
    encoder.write_header().unwrap().write_image_data(&[200; 32]).unwrap();
    fs::write(folder.path().join("wood.png"), bytes).unwrap();
    let ran = Ran::from(command(folder.path(), "check . --lane embedded").output().unwrap()).expect(0);
    assert!(ran.out.contains("texture map: 2D, float, 4 x 2, wood.png"), "{}", ran.out);
    for (textures, said) in [
        ("{ maps = \"checker\" }", "lit.suite.toml:5:14: what is run has no sampler `maps`; did you mean `map`?"),
        ("{ map = \"chequer\" }", "did you mean `checker`?"),
        ("{ map = [1.0, 2.0] }", "is a text or four numbers"),
        ("{ map = \"gone.png\" }", "gone.png"),
    ] {
        let ran = lit(LIT, &format!("textures = {textures}")).expect(2);
        assert!(format!("{}{}", ran.out, ran.err).contains(said), "{ran:?}");
    }
}

/// The embedded lane, on which every texture is one texel off.
struct Shifted(Box<dyn Lane>);

struct ShiftedRunner(Box<dyn Runner>);

impl Lane for Shifted {
    fn description(&self) -> &Description {
        self.0.description()
    }

    fn prepare(&self, kernel: &Kernel, capacity: usize) -> Result<Box<dyn Runner>, LaneError> {
        let mut kernel = kernel.clone();
        let mut program = (*kernel.program).clone();
        for texture in &mut program.textures {
            texture.contents = Arc::new(texture.contents.shifted());
        }
        kernel.program = Arc::new(program);
        Ok(Box::new(ShiftedRunner(self.0.prepare(&kernel, capacity)?)))
    }
}

impl Runner for ShiftedRunner {
    fn capacity(&self) -> usize {
        self.0.capacity()
    }

    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        self.0.run(batch)
    }
}

#[test]
fn a_lane_that_takes_the_neighbouring_texel_is_to_blame() {
    use engine::suite::run::{Request, prepare, run};
    use judge::profile::Promises;
    let file = base::text::SourceFile::new("lit.suite.toml", suite(""));
    let suite = engine::suite::parse(&file).unwrap();
    let prepared = prepare(&suite, &base::text::SourceFile::new("lit.frag", LIT)).unwrap();
    let judged = |lane: &dyn Lane| {
        let request = Request {
            samples: Some(512),
            seed: 7,
            quick: false,
            replay: Vec::new(),
            replay_only: false,
            promises: Promises::of_lane(lane.description()),
            arguments: "lit".to_owned(),
        };
        run(&prepared, lane, Stage::Compute, &request, &mut |_| {}).unwrap()
    };
    let right = judged(&*embedded::open().unwrap());
    assert_eq!((right.verdicts.deviated, right.errors().len()), (0, 0));
    let wrong = judged(&Shifted(embedded::open().unwrap()));
    assert!(wrong.verdicts.deviated > 400, "{}", wrong.verdicts.deviated);
    assert_eq!(wrong.verdicts.shader_deviated, 0);
    assert!(wrong.errors()[0].message.contains("the lane deviates from the shader"), "{}", wrong.errors()[0].message);
}

#[test]
fn a_driver_takes_the_texels_that_are_meant() {
    let text = "#version 430\nin vec3 p;\nuniform sampler2D a;\nuniform isampler2D b;\nuniform usampler3D c;\n\
                uniform sampler2DArray d;\nuniform samplerCubeArray e;\nuniform sampler1D f;\nuniform samplerCubeShadow g;\n\
                uniform sampler2DArrayShadow h;\nuniform sampler3D i;\nuniform samplerCube k;\n\
                out vec4 x;\nout vec4 y;\nout vec4 z;\nvoid main() {\n\
                x = texture(a, p.xy) + textureOffset(a, p.xy, ivec2(1, -2)) + textureGather(a, p.yz, 1);\n\
                y = texture(d, p) + texture(e, vec4(p, 1.0)) + texture(f, p.x) + texture(i, p) + texture(k, p);\n\
                z = vec4(texelFetch(b, ivec2(p.xy), 0)) + vec4(texelFetch(c, ivec3(p), 0));\n\
                z.x += texture(g, vec4(p, 0.5)) + texture(h, vec4(p, 0.25)) + float(textureSize(d, 0).z);\n\
                if (x.w > 1.5) discard;\n}\n";
    let folder = folder(&[("all.frag", text)]);
    let args = "fuzz all.frag --samples 8192 --lane vulkan --domain p=[0,1] --format json";
    let ran = Ran::from(command(folder.path(), args).output().unwrap()).expect(0);
    let main = &ran.json()["files"][0]["functions"][0];
    assert_eq!(main["textures"].as_array().unwrap().len(), 10, "{main:#}");
    let lane = &main["lanes"][0];
    let count = |key: &str| lane[key].as_u64().unwrap();
    assert!(count("agreed") > 3000 && count("deviated") == 0, "{lane:#}");
}
