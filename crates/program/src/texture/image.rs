//! Contents of textures: small images whose numbers every lane holds exactly.

use std::sync::Arc;

use super::{Dimension, Texel, TextureKind};

/// Steps of a depth from 0 to 1.
const DEPTHS: f64 = 65535.0;

/// An image of which a texture can be made: rows from the first one on, four channels a pixel, from 0 to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Where it comes from, for reports.
    pub about: String,
    /// Pixels of a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Four channels for each pixel.
    pub pixels: Vec<[f32; 4]>,
}

/// The texels of a texture of one level.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    about: String,
    size: [u32; 3],
    /// Four words a texel: bits of binary32 numbers, or integers. Of a depth the first word counts.
    words: Arc<[u32]>,
}

/// A well-mixed word of two others.
fn mixed(a: u64, b: u64) -> u64 {
    let mut x = a ^ b.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

fn seed_of(name: &str) -> u64 {
    name.bytes().fold(0xcbf2_9ce4_8422_2325, |key, byte| mixed(key, u64::from(byte)))
}

/// The word of a number in a texel of that kind, for a number from 0 to 1.
fn word(texel: Texel, number: f64) -> u32 {
    match texel {
        Texel::Float => (number as f32).to_bits(),
        // Whole numbers on both sides of 0, and as many of them.
        Texel::Int => ((number * 256.0).floor() as i32 - 128).cast_unsigned(),
        Texel::Uint => (number * 256.0).floor() as u32,
        Texel::Depth => ((((number * DEPTHS).round()) / DEPTHS) as f32).to_bits(),
    }
}

impl Image {
    /// Texels as words, four a texel; `None` for another number of words than that.
    pub fn of_words(about: String, size: [u32; 3], words: Arc<[u32]>) -> Option<Self> {
        let texels = size.iter().try_fold(4_usize, |count, &n| count.checked_mul(n as usize));
        (texels == Some(words.len())).then_some(Self { about, size, words })
    }

    /// Texels that all differ, other ones for each name: a wrong coordinate shows. Every number is one of
    /// binary32.
    pub fn procedural(name: &str, kind: TextureKind) -> Self {
        Self::procedural_of(name, kind, kind.usual_size())
    }

    /// The same with a width, a height, and a depth or a number of layers.
    pub fn procedural_of(name: &str, kind: TextureKind, size: [u32; 3]) -> Self {
        let count = size.iter().map(|&n| u64::from(n)).product::<u64>();
        let places = count.next_power_of_two();
        let seed = seed_of(name);
        let mut words = Vec::with_capacity(4 * count as usize);
        for k in 0..count {
            // An odd factor permutes the places.
            let place = k.wrapping_mul(2 * (places / 3) + 5).wrapping_add(seed) % places;
            let first = (place as f64 + 0.5) / places as f64;
            let noise = mixed(seed, k);
            let channel = |n: u64| ((noise >> (8 * n)) & 0xff) as f64 / 256.0;
            words.push(match kind.texel {
                Texel::Int => (place as i32 - (places / 2) as i32).cast_unsigned(),
                Texel::Uint => place as u32,
                Texel::Float | Texel::Depth => word(kind.texel, first),
            });
            words.extend([0, 1, 2].map(|n| word(kind.texel, channel(n))));
        }
        Self { about: "procedural".to_owned(), size, words: words.into() }
    }

    /// White and black texels by turns.
    pub fn checker(kind: TextureKind) -> Self {
        let size @ [width, height, layers] = kind.usual_size();
        let mut words = Vec::new();
        for (z, y, x) in (0..layers).flat_map(|z| (0..height).flat_map(move |y| (0..width).map(move |x| (z, y, x)))) {
            let bright = f64::from((x + y + z) % 2);
            let last = if kind.texel == Texel::Float { 1.0 } else { bright };
            words.extend([bright, bright, bright, last].map(|n| match kind.texel {
                Texel::Int | Texel::Uint => n as u32,
                Texel::Float | Texel::Depth => word(kind.texel, n),
            }));
        }
        Self { about: "checker".to_owned(), size, words: words.into() }
    }

    /// The same number in every channel of every texel; integers are rounded towards 0, depths into 0 to 1.
    pub fn constant(kind: TextureKind, channels: [f32; 4]) -> Self {
        let size = kind.usual_size();
        let count = size.iter().product::<u32>() as usize;
        let words = channels.map(|n| match kind.texel {
            Texel::Float => n.to_bits(),
            Texel::Int => (n as i32).cast_unsigned(),
            Texel::Uint => n as u32,
            Texel::Depth => word(Texel::Depth, f64::from(n.clamp(0.0, 1.0))),
        });
        let about = format!("constant {channels:?}");
        Self { about, size, words: words.repeat(count).into() }
    }

    /// A picture in every layer. `None` where the texture has another form: a cube takes a square one, and
    /// a texture of one coordinate takes its first row.
    pub fn of_picture(kind: TextureKind, picture: &Picture) -> Option<Self> {
        let layers = kind.usual_size()[2];
        let rows = match kind.dimension {
            Dimension::D1 => 1,
            Dimension::Cube if picture.width != picture.height => return None,
            Dimension::D2 | Dimension::D3 | Dimension::Cube => picture.height,
        };
        let pixels = picture.pixels.get(..(picture.width * rows) as usize)?;
        let one: Vec<u32> =
            pixels.iter().flat_map(|p| p.map(|n| word(kind.texel, f64::from(n.clamp(0.0, 1.0))))).collect();
        let size = [picture.width, rows, layers];
        Some(Self { about: picture.about.clone(), size, words: one.repeat(layers as usize).into() })
    }

    /// The same texels, each in the place of the one before it: a fault to be found.
    #[must_use]
    pub fn shifted(&self) -> Self {
        let mut words = self.words.to_vec();
        words.rotate_left(4);
        Self { about: format!("{}, shifted", self.about), size: self.size, words: words.into() }
    }

    /// Width, height, and depth or layers.
    pub fn size(&self) -> [u32; 3] {
        self.size
    }

    /// What it is, in a word or two.
    pub fn about(&self) -> &str {
        &self.about
    }

    /// Four words for each texel, row after row and layer after layer.
    pub fn words(&self) -> &Arc<[u32]> {
        &self.words
    }

    /// The depths in steps of 1/65535, for a device that holds them so.
    pub fn depths(&self) -> Vec<u16> {
        let step = |word: u32| (f64::from(f32::from_bits(word)) * DEPTHS).round() as u16;
        self.words.iter().step_by(4).map(|&word| step(word)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds() -> Vec<TextureKind> {
        let mut all = Vec::new();
        for texel in [Texel::Float, Texel::Int, Texel::Uint, Texel::Depth] {
            for (dimension, arrayed) in
                [(Dimension::D1, false), (Dimension::D2, false), (Dimension::D2, true), (Dimension::D3, false)]
            {
                all.push(TextureKind { dimension, arrayed, texel });
            }
            all.push(TextureKind { dimension: Dimension::Cube, arrayed: true, texel });
        }
        all
    }

    #[test]
    fn every_texel_of_a_procedural_image_is_another_one() {
        for kind in kinds() {
            let image = Image::procedural("diffuse", kind);
            let count = image.size().iter().product::<u32>() as usize;
            assert_eq!(image.words().len(), 4 * count);
            let mut first: Vec<u32> = image.words().iter().step_by(4).copied().collect();
            first.sort_unstable();
            first.dedup();
            assert_eq!(first.len(), count, "{kind}");
        }
        let kind = kinds()[1];
        assert_ne!(Image::procedural("a", kind), Image::procedural("b", kind));
        assert_eq!(Image::procedural("a", kind), Image::procedural("a", kind));
    }

    #[test]
    fn depths_are_the_numbers_that_a_device_holds() {
        let kind = TextureKind { dimension: Dimension::D2, arrayed: false, texel: Texel::Depth };
        let image = Image::procedural("shadow", kind);
        for (step, &bits) in image.depths().iter().zip(image.words().iter().step_by(4)) {
            assert_eq!((f64::from(*step) / 65535.0) as f32, f32::from_bits(bits));
        }
    }

    #[test]
    fn a_picture_is_repeated_in_every_layer_and_squares_alone_make_a_cube() {
        let picture =
            Picture { about: "p.png".to_owned(), width: 2, height: 1, pixels: vec![[0.0, 0.25, 0.5, 1.0], [1.0; 4]] };
        let kind = TextureKind { dimension: Dimension::D2, arrayed: true, texel: Texel::Float };
        let image = Image::of_picture(kind, &picture).unwrap();
        assert_eq!(image.size(), [2, 1, 3]);
        assert_eq!(image.words()[8 + 1], 0.25_f32.to_bits());
        assert_eq!(Image::of_picture(TextureKind { dimension: Dimension::Cube, ..kind }, &picture), None);
    }
}
