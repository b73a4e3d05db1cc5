//! Textures of a suite: what a sampler is bound to.

use std::sync::Arc;

use super::{RunTextureError, Suite};
use base::nearest;
use program::Program;
use program::texture::{Image, Picture, TextureKind};

/// What a texture holds.
#[derive(Clone, Debug, PartialEq)]
pub enum Contents {
    /// Texels that all differ, as without a word about it.
    Procedural,
    /// White and black texels by turns.
    Checker,
    /// The same numbers in every texel.
    Constant([f32; 4]),
    /// A picture beside the suite file.
    File {
        /// Its name, relative to the suite file.
        name: String,
        /// The picture, once it has been read.
        picture: Option<Picture>,
    },
}

/// A texture that a suite names.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundTexture {
    /// The way to the sampler as the shader writes it, such as `material.diffuse` or `maps[2]`.
    pub sampler: String,
    /// What it is bound to.
    pub contents: Contents,
    /// Where the suite says so.
    pub at: String,
}

/// Words for what a texture holds.
pub(super) const WORDS: [&str; 2] = ["procedural", "checker"];

impl Contents {
    /// The image for a kind of texture; `None` where a picture does not fit.
    fn image(&self, name: &str, kind: TextureKind) -> Option<Image> {
        match self {
            Self::Procedural => Some(Image::procedural(name, kind)),
            Self::Checker => Some(Image::checker(kind)),
            Self::Constant(channels) => Some(Image::constant(kind, *channels)),
            Self::File { picture, .. } => Image::of_picture(kind, picture.as_ref()?),
        }
    }
}

/// Binds what a suite says to the samplers of a program. One that the program does not look at is an error
/// where it `must` be there.
pub(super) fn bind(suite: &Suite, program: &mut Program, must: bool) -> Result<(), RunTextureError> {
    for bound in &suite.textures {
        let at = || bound.at.clone();
        let Some(texture) = program.textures.iter_mut().find(|t| t.name == bound.sampler) else {
            if !must {
                continue;
            }
            let names = || program.textures.iter().map(|t| t.name.as_str());
            let help = match nearest(&bound.sampler, names()) {
                Some(near) => format!("did you mean `{near}`?"),
                None if program.textures.is_empty() => "it looks at no texture".to_owned(),
                None => format!("it looks at: {}", names().collect::<Vec<_>>().join(", ")),
            };
            let message = format!("what is run has no sampler `{}`; {help}", bound.sampler);
            return Err(RunTextureError { at: at(), message });
        };
        let Some(image) = bound.contents.image(&texture.name, texture.kind) else {
            let message =
                format!("this picture does not fit `{}` ({}); a cube takes a square one", texture.name, texture.kind);
            return Err(RunTextureError { at: at(), message });
        };
        texture.contents = Arc::new(image);
    }
    Ok(())
}

/// Reads the bytes of a PNG file.
///
/// # Errors
/// Why it is none, in words.
pub(super) fn decode(name: &str, bytes: &[u8]) -> Result<Picture, String> {
    let wrong = |error: png::DecodingError| error.to_string();
    let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().map_err(wrong)?;
    let (width, height) = reader.info().size();
    // Before memory is taken for it: a few bytes may state any size.
    if width > SIDE || height > SIDE {
        return Err(format!("it is {width} by {height}; pictures of up to {SIDE} by {SIDE} are taken"));
    }
    let size = reader.output_buffer_size().ok_or("it is too large")?;
    let mut data = vec![0; size];
    let info = reader.next_frame(&mut data).map_err(wrong)?;
    let one = |byte: u8| (f64::from(byte) / 255.0) as f32;
    let channels = info.color_type.samples();
    let pixel = |p: &[u8]| match *p {
        [l] => [one(l), one(l), one(l), 1.0],
        [l, a] => [one(l), one(l), one(l), one(a)],
        [r, g, b] => [one(r), one(g), one(b), 1.0],
        [r, g, b, a, ..] => [one(r), one(g), one(b), one(a)],
        [] => [0.0; 4],
    };
    let pixels = data[..info.buffer_size()].chunks_exact(channels).map(pixel).collect();
    Ok(Picture { about: name.to_owned(), width: info.width, height: info.height, pixels })
}

/// Longest side of a picture.
const SIDE: u32 = 1024;

#[cfg(test)]
mod tests {
    use super::*;

    fn png_of(color: png::ColorType, data: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 2, 1);
        encoder.set_color(color);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.write_header().unwrap().write_image_data(data).unwrap();
        bytes
    }

    #[test]
    fn pictures_of_every_kind_have_four_channels() {
        let gray = decode("g", &png_of(png::ColorType::Grayscale, &[0, 51])).unwrap();
        assert_eq!(gray.pixels, [[0.0, 0.0, 0.0, 1.0], [0.2, 0.2, 0.2, 1.0]]);
        let full = decode("f", &png_of(png::ColorType::Rgba, &[0, 51, 102, 255, 255, 255, 0, 0])).unwrap();
        assert_eq!((full.width, full.height, full.pixels[0]), (2, 1, [0.0, 0.2, 0.4, 1.0]));
        assert!(decode("x", b"no picture").is_err());
    }
}
