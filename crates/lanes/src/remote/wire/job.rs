//! What lanes are asked to run.

use std::sync::Arc;

use super::{Reader, Wire, Writer, tag, wire};
use crate::{native, vulkan};
use base::value::{Field, Record, Scalar, Shape};
use program::texture::{Dimension, Image, Texel, TextureKind};
use program::{
    Attribute, BoundBuffer, Count, Drawn, Form, OutputLayout, Primitives, Texture, UniformBlock, UniformPlace,
};
use syntax::interface::{InputPrimitive, OutputPrimitive};

wire! { enum Scalar { F32, I32, U32, Bool } }
wire! { struct Shape { scalar, columns, rows, array, half } }
wire! { struct Field { name, shape } }
wire! { struct OutputLayout { vertex, max_vertices } }
wire! { struct Attribute { field, location, components } }
wire! { enum Count { Vertex, Instance, BaseVertex, BaseInstance, Draw } }
wire! { struct Drawn { name, count, word } }
wire! { struct UniformPlace { word, byte } }
wire! { struct BoundBuffer { group, binding, bytes, uniform, writable, before, after } }
wire! { struct UniformBlock { bytes, places } }
wire! { enum Form { Compute, Uniforms, Constants, Vertex { attributes, blocks, drawn }, Geometry, Dispatch { groups, buffers } } }
wire! { enum Dimension { D1, D2, D3, Cube } }
wire! { enum Texel { Float, Int, Uint, Depth } }
wire! { struct TextureKind { dimension, arrayed, texel } }
wire! { struct Texture { name, kind, image, sampler, contents } }
wire! { enum InputPrimitive { Points, Lines, LinesAdjacency, Triangles, TrianglesAdjacency } }
wire! { enum OutputPrimitive { Points, LineStrip, TriangleStrip } }
wire! { struct Primitives { input, output, max_vertices } }
// The module comes first: others have handles of it.
wire! { struct vulkan::Job { module, form, invocation, case, output, textures } }
wire! { enum native::Kinds { Vertex { attributes, drawn }, Geometry { primitives, front }, Dispatch { groups, size, buffers } } }
wire! { struct native::Job { stage, module, invocation, case, output, captured } }

impl Wire for Arc<Record> {
    fn put(&self, to: &mut Writer) {
        let fields = self.fields();
        to.word(fields.len() as u32);
        fields.iter().for_each(|field| field.put(to));
    }

    fn take(from: &mut Reader<'_>) -> Option<Self> {
        Vec::take(from).map(|fields| Arc::new(Record::new(fields)))
    }
}

impl Wire for Arc<Image> {
    fn put(&self, to: &mut Writer) {
        self.about().to_owned().put(to);
        self.size().put(to);
        self.words().put(to);
    }

    fn take(from: &mut Reader<'_>) -> Option<Self> {
        let (about, size) = (String::take(from)?, <[u32; 3]>::take(from)?);
        Image::of_words(about, size, Wire::take(from)?).map(Arc::new)
    }
}
