//! A surface of pixels for charts, with letters from a bitmap font.

use std::convert::Infallible;

use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{BackendColor, BackendCoord, BackendTextStyle, DrawingBackend, DrawingErrorKind, FontTransform};
use spleen_font::{FONT_8X16, PSF2Font};

/// Pixels in rows, three bytes each.
pub(super) struct Raster {
    width: u32,
    height: u32,
    pixels: Vec<u8>,
}

/// Size of a letter.
const LETTER: (i32, i32) = (8, 16);

impl Raster {
    /// A white surface.
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, pixels: vec![0xff; width as usize * height as usize * 3] }
    }

    /// The surface as a PNG file.
    ///
    /// # Errors
    /// What the encoder says.
    pub fn encode(&self) -> Result<Vec<u8>, png::EncodingError> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::High);
        encoder.write_header()?.write_image_data(&self.pixels)?;
        Ok(bytes)
    }

    fn blend(&mut self, (x, y): (i32, i32), color: BackendColor) {
        let inside = (0..self.width as i32).contains(&x) && (0..self.height as i32).contains(&y);
        if !inside {
            return;
        }
        let at = (y as usize * self.width as usize + x as usize) * 3;
        let (r, g, b) = color.rgb;
        for (old, new) in self.pixels[at..at + 3].iter_mut().zip([r, g, b]) {
            *old = (f64::from(*old) * (1.0 - color.alpha) + f64::from(new) * color.alpha).round() as u8;
        }
    }
}

impl DrawingBackend for &mut Raster {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    fn ensure_prepared(&mut self) -> Result<(), DrawingErrorKind<Infallible>> {
        Ok(())
    }

    fn present(&mut self) -> Result<(), DrawingErrorKind<Infallible>> {
        Ok(())
    }

    fn draw_pixel(&mut self, at: BackendCoord, color: BackendColor) -> Result<(), DrawingErrorKind<Infallible>> {
        self.blend(at, color);
        Ok(())
    }

    fn draw_text<S: BackendTextStyle>(
        &mut self,
        text: &str,
        style: &S,
        (x, y): BackendCoord,
    ) -> Result<(), DrawingErrorKind<Infallible>> {
        let Ok(mut font) = PSF2Font::new(FONT_8X16) else { return Ok(()) };
        let (wide, high) = (LETTER.0 * text.chars().count() as i32, LETTER.1);
        let anchor = style.anchor();
        let left = match anchor.h_pos {
            HPos::Left => 0,
            HPos::Center => -wide / 2,
            HPos::Right => -wide,
        };
        let top = match anchor.v_pos {
            VPos::Top => 0,
            VPos::Center => -high / 2,
            VPos::Bottom => -high,
        };
        for (k, letter) in text.chars().enumerate() {
            let mut bytes = [0; 4];
            let Some(glyph) = font.glyph_for_utf8(letter.encode_utf8(&mut bytes).as_bytes()) else { continue };
            for (row, line) in glyph.enumerate() {
                for (column, on) in line.enumerate() {
                    let (dx, dy) = (left + k as i32 * LETTER.0 + column as i32, top + row as i32);
                    let at = match style.transform() {
                        FontTransform::None => (x + dx, y + dy),
                        FontTransform::Rotate90 => (x - dy, y + dx),
                        FontTransform::Rotate180 => (x - dx, y - dy),
                        FontTransform::Rotate270 => (x + dy, y - dx),
                    };
                    if on {
                        self.blend(at, style.color());
                    }
                }
            }
        }
        Ok(())
    }

    fn estimate_text_size<S: BackendTextStyle>(
        &self,
        text: &str,
        _style: &S,
    ) -> Result<(u32, u32), DrawingErrorKind<Infallible>> {
        Ok((LETTER.0 as u32 * text.chars().count() as u32, LETTER.1 as u32))
    }
}
