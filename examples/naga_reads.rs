//! What naga's own readers make of a text in GLSL, printed as WGSL; a text in WGSL goes through SPIR-V first. It shows the faults
//! in `upstream/`.
//!
//! ```sh
//! cargo run --example naga_reads -- upstream/naga-global-initialiser/repro.vert
//! ```

#![expect(clippy::print_stdout, reason = "a command prints its result")]

use std::error::Error;
use std::path::Path;

use naga::back::{spv, wgsl};
use naga::front::{glsl, spv as from_spv};
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{Module, ShaderStage};

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("name a file: .vert, .frag, .comp, .wgsl")?;
    let text = std::fs::read_to_string(&path)?;
    let ending = Path::new(&path).extension().and_then(|e| e.to_str()).unwrap_or_default();
    let module = match ending {
        "wgsl" => through_spirv(&naga::front::wgsl::parse_str(&text)?)?,
        "vert" => of_glsl(&text, ShaderStage::Vertex)?,
        "frag" => of_glsl(&text, ShaderStage::Fragment)?,
        _ => of_glsl(&text, ShaderStage::Compute)?,
    };
    let info = validator().validate(&module)?;
    print!("{}", wgsl::write_string(&module, &info, wgsl::WriterFlags::empty())?);
    Ok(())
}

fn validator() -> Validator {
    Validator::new(ValidationFlags::all(), Capabilities::all())
}

fn of_glsl(text: &str, stage: ShaderStage) -> Result<Module, Box<dyn Error>> {
    let options = glsl::Options::from(stage);
    Ok(glsl::Frontend::default().parse(&options, text).map_err(|errors| errors.emit_to_string(text))?)
}

/// The module as naga reads the SPIR-V that it writes of it.
fn through_spirv(module: &Module) -> Result<Module, Box<dyn Error>> {
    let info = validator().validate(module)?;
    let words = spv::write_vec(module, &info, &spv::Options::default(), None)?;
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    Ok(from_spv::parse_u8_slice(&bytes, &from_spv::Options::default())?)
}
