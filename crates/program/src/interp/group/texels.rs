//! Images that invocations read and write: memory whose elements are texels, and whose indices are coordinates.

use naga::StorageFormat;

use base::value::Scalar;
use number::half;

/// What a channel of a texel keeps of a number (Vulkan 1.4, "Texel Output Format Conversion"; GLSL 4.60, 4.4.6.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// All of a binary32 number.
    Float,
    /// The nearest binary16 number.
    Half,
    /// A number with the exponents of binary16, no sign, and so many bits behind the point.
    Small(u32),
    /// The nearest of 2^bits steps from 0 to 1.
    Unorm(u32),
    /// The nearest of 2^bits − 1 steps from −1 to 1.
    Snorm(u32),
    /// The lower bits of an integer, without a sign.
    Uint(u32),
    /// The lower bits of an integer, with a sign.
    Sint(u32),
}

impl Channel {
    /// Type of its numbers in a shader.
    pub fn scalar(self) -> Scalar {
        match self {
            Self::Float | Self::Half | Self::Small(_) | Self::Unorm(_) | Self::Snorm(_) => Scalar::F32,
            Self::Uint(_) => Scalar::U32,
            Self::Sint(_) => Scalar::I32,
        }
    }

    /// What it stands for where 1 is a whole number of steps.
    pub(in crate::interp) fn steps(self) -> f32 {
        match self {
            Self::Unorm(bits) => ((1_u32 << bits) - 1) as f32,
            Self::Snorm(bits) => ((1_u32 << (bits - 1)) - 1) as f32,
            Self::Float | Self::Half | Self::Small(_) | Self::Uint(_) | Self::Sint(_) => 1.0,
        }
    }

    /// Bits of the numbers of binary16 that are kept.
    pub(in crate::interp) fn half_bits(self) -> u32 {
        match self {
            Self::Small(fraction) => 0x7fff & !((1 << (10 - fraction)) - 1),
            _ => 0xffff,
        }
    }

    /// A word that it can hold, from one of its type.
    pub fn kept(self, word: u32) -> u32 {
        let real = f32::from_bits(word);
        let step = |low: f32| ((real.clamp(low, 1.0) * self.steps()).round() / self.steps()).to_bits();
        match self {
            Self::Float => word,
            Self::Half | Self::Small(_) => {
                let real = if self == Self::Half { real } else { real.abs() };
                let bits = half::to_bits(f64::from(real)) & self.half_bits() as u16;
                (half::from_bits(bits) as f32).to_bits()
            }
            Self::Unorm(_) => step(0.0),
            Self::Snorm(_) => step(-1.0),
            Self::Uint(bits) => word << (32 - bits) >> (32 - bits),
            Self::Sint(bits) => ((word << (32 - bits)).cast_signed() >> (32 - bits)).cast_unsigned(),
        }
    }

    /// The channels of a format, red first; `None` for one whose numbers have 64 bits.
    pub(in crate::interp) fn all_of(format: StorageFormat) -> Option<Vec<Self>> {
        use Channel::{Float, Half, Sint, Small, Snorm, Uint, Unorm};
        use StorageFormat as F;
        let (channel, count) = match format {
            F::R8Unorm => (Unorm(8), 1),
            F::R8Snorm => (Snorm(8), 1),
            F::R8Uint => (Uint(8), 1),
            F::R8Sint => (Sint(8), 1),
            F::R16Uint => (Uint(16), 1),
            F::R16Sint => (Sint(16), 1),
            F::R16Float => (Half, 1),
            F::R16Unorm => (Unorm(16), 1),
            F::R16Snorm => (Snorm(16), 1),
            F::Rg8Unorm => (Unorm(8), 2),
            F::Rg8Snorm => (Snorm(8), 2),
            F::Rg8Uint => (Uint(8), 2),
            F::Rg8Sint => (Sint(8), 2),
            F::R32Uint => (Uint(32), 1),
            F::R32Sint => (Sint(32), 1),
            F::R32Float => (Float, 1),
            F::Rg16Uint => (Uint(16), 2),
            F::Rg16Sint => (Sint(16), 2),
            F::Rg16Float => (Half, 2),
            F::Rg16Unorm => (Unorm(16), 2),
            F::Rg16Snorm => (Snorm(16), 2),
            F::Rgba8Unorm | F::Bgra8Unorm => (Unorm(8), 4),
            F::Rgba8Snorm => (Snorm(8), 4),
            F::Rgba8Uint => (Uint(8), 4),
            F::Rgba8Sint => (Sint(8), 4),
            F::Rgb10a2Uint => return Some(vec![Uint(10), Uint(10), Uint(10), Uint(2)]),
            F::Rgb10a2Unorm => return Some(vec![Unorm(10), Unorm(10), Unorm(10), Unorm(2)]),
            F::Rg11b10Ufloat => return Some(vec![Small(6), Small(6), Small(5)]),
            F::Rg32Uint => (Uint(32), 2),
            F::Rg32Sint => (Sint(32), 2),
            F::Rg32Float => (Float, 2),
            F::Rgba16Uint => (Uint(16), 4),
            F::Rgba16Sint => (Sint(16), 4),
            F::Rgba16Float => (Half, 4),
            F::Rgba16Unorm => (Unorm(16), 4),
            F::Rgba16Snorm => (Snorm(16), 4),
            F::Rgba32Uint => (Uint(32), 4),
            F::Rgba32Sint => (Sint(32), 4),
            F::Rgba32Float => (Float, 4),
            F::R64Uint => return None,
        };
        Some(vec![channel; count])
    }
}

/// The texels of an image.
#[derive(Clone, Debug, PartialEq)]
pub struct Texels {
    /// Channels of a texel, red first; empty for an image in a buffer that begins with its size in four words.
    pub channels: Vec<Channel>,
    /// Coordinates that choose a texel, the layer among them.
    pub axes: usize,
    /// Whether the last of the coordinates is a layer.
    pub layered: bool,
}

impl Texels {
    /// True for an image that lies in a buffer behind its size, as images do that naga has no type for.
    pub fn is_in_buffer(&self) -> bool {
        self.channels.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_channel_keeps_the_nearest_number_of_its_format() {
        let real = |channel: Channel, value: f32| f32::from_bits(channel.kept(value.to_bits()));
        assert_eq!(real(Channel::Float, 0.1), 0.1);
        assert_eq!(real(Channel::Half, 1.0 + 1.5 / 1024.0), 1.0 + 2.0 / 1024.0);
        assert_eq!((real(Channel::Unorm(8), 0.5), real(Channel::Unorm(8), -3.0)), (128.0 / 255.0, 0.0));
        assert_eq!((real(Channel::Snorm(8), -3.0), real(Channel::Snorm(8), 0.5)), (-1.0, 64.0 / 127.0));
        // 1 + 1/64 has six bits behind its point, and 1 + 1/32 five.
        assert_eq!((real(Channel::Small(6), 1.015_625), real(Channel::Small(5), 1.015_625)), (1.015_625, 1.0));
        assert_eq!(Channel::Uint(8).kept(0x1ff), 0xff);
        assert_eq!(Channel::Sint(8).kept(0xff), u32::MAX);
        assert_eq!(Channel::Uint(32).kept(u32::MAX), u32::MAX);
    }
}
