//! How a language writes types and declarations: the words in which reports name inputs.

use naga::{AddressSpace, Binding, GlobalVariable, Handle};

use crate::{Entry, Port, PortAt, Program, Written};
use base::value::{Field, Scalar, Shape};

impl Written {
    /// A type as the language writes it: `vec3`, `vec3f`. SPIR-V has no words of its own, and gets those of GLSL.
    pub fn type_name(self, shape: Shape) -> String {
        match self {
            Self::Glsl | Self::SpirV | Self::SpirVAssembly => shape.to_string(),
            Self::Wgsl => wgsl(shape),
            Self::Hlsl | Self::Slang => hlsl(shape),
        }
    }

    /// A name with its type: `vec3 x`, `x: vec3f`.
    pub fn declaration(self, name: &str, shape: Shape) -> String {
        let ty = self.type_name(shape);
        match self {
            Self::Glsl | Self::SpirV | Self::SpirVAssembly => format!("{ty} {name}"),
            Self::Wgsl => format!("{name}: {ty}"),
            Self::Hlsl | Self::Slang => match ty.split_once('[') {
                Some((element, count)) => format!("{element} {name}[{count}"),
                None => format!("{ty} {name}"),
            },
        }
    }

    /// The shape that a type is, in whatever language it is written: `vec2`, `vec2f`, `vec2<f32>`, `float2`.
    pub fn shape_named(text: &str) -> Option<Shape> {
        let text: String = text.chars().filter(|c| !c.is_whitespace()).collect();
        if let Ok(shape) = text.parse() {
            return Some(shape);
        }
        if text == "f16" {
            return Some(Shape::FLOAT.halved());
        }
        let scalar =
            [("f32", Scalar::F32), ("i32", Scalar::I32), ("u32", Scalar::U32)].into_iter().find(|(n, _)| *n == text);
        if let Some((_, scalar)) = scalar {
            return Some(Shape::vector(scalar, 1));
        }
        if let Some(inside) = text.strip_prefix("array<") {
            let (element, len) = inside.strip_suffix('>')?.rsplit_once(',')?;
            let element = Self::shape_named(element).filter(|shape| shape.array.is_none())?;
            return Some(element.array_of(len.trim_end_matches('u').parse().ok()?));
        }
        let sizes = |text: &str| -> Option<(u8, u8)> {
            let size = |text: &str| text.parse::<u8>().ok().filter(|n| (2..=4).contains(n));
            let (columns, rows) = text.split_once('x')?;
            Some((size(columns)?, size(rows)?))
        };
        let matrix = |(columns, rows)| Shape { scalar: Scalar::F32, columns, rows, array: None, half: false };
        if let Some(inside) = text.strip_prefix("mat") {
            let size = inside.strip_suffix('f').or_else(|| inside.strip_suffix("<f32>"))?;
            return sizes(size).map(matrix);
        }
        if let Some(inside) = text.strip_prefix("vec") {
            let (rows, scalar) = inside.split_at_checked(1)?;
            let scalar = match scalar {
                "h" | "<f16>" => {
                    let rows = rows.parse().ok().filter(|n| (2..=4).contains(n))?;
                    return Some(Shape::vector(Scalar::F32, rows).halved());
                }
                "f" | "<f32>" => Scalar::F32,
                "i" | "<i32>" => Scalar::I32,
                "u" | "<u32>" => Scalar::U32,
                "<bool>" => Scalar::Bool,
                _ => return None,
            };
            return rows.parse().ok().filter(|n| (2..=4).contains(n)).map(|rows| Shape::vector(scalar, rows));
        }
        // In HLSL and Slang the number of rows stands first.
        let names = [("float", Scalar::F32), ("uint", Scalar::U32), ("int", Scalar::I32), ("bool", Scalar::Bool)];
        let (rest, scalar) = names.iter().find_map(|(name, scalar)| Some((text.strip_prefix(name)?, *scalar)))?;
        if let Some((rows, columns)) = sizes(rest).filter(|_| scalar == Scalar::F32) {
            return Some(matrix((columns, rows)));
        }
        rest.parse().ok().filter(|n| (2..=4).contains(n)).map(|rows| Shape::vector(scalar, rows))
    }
}

/// The number of rows stands first.
fn hlsl(shape: Shape) -> String {
    let scalar = match shape.scalar {
        Scalar::F32 if shape.half => "float16_t",
        Scalar::F32 => "float",
        Scalar::I32 => "int",
        Scalar::U32 => "uint",
        Scalar::Bool => "bool",
    };
    let element = match (shape.columns, shape.rows) {
        (1, 1) => scalar.to_owned(),
        (1, rows) => format!("{scalar}{rows}"),
        (columns, rows) => format!("{scalar}{rows}x{columns}"),
    };
    shape.array.map_or_else(|| element.clone(), |count| format!("{element}[{count}]"))
}

fn wgsl(shape: Shape) -> String {
    let (scalar, short) = match shape.scalar {
        Scalar::F32 if shape.half => ("f16", "h"),
        Scalar::F32 => ("f32", "f"),
        Scalar::I32 => ("i32", "i"),
        Scalar::U32 => ("u32", "u"),
        Scalar::Bool => ("bool", "<bool>"),
    };
    let element = match (shape.columns, shape.rows) {
        (1, 1) => scalar.to_owned(),
        (1, rows) => format!("vec{rows}{short}"),
        (columns, rows) => format!("mat{columns}x{rows}{short}"),
    };
    shape.array.map_or(element.clone(), |len| format!("array<{element}, {len}>"))
}

impl Program {
    /// An input as its author declares it: `vec3 x`, `x: vec3f`, `@location(0) normal: vec3f`, `var<uniform> scale: f32`.
    pub fn declaration(&self, input: &Field) -> String {
        let plain = self.written.declaration(&input.name, input.shape);
        if self.written != Written::Wgsl {
            return plain;
        }
        let mut ports = self.inputs.iter().chain(&self.uniforms);
        let port = ports.find(|port| port.field.name == input.name);
        match port.and_then(|port| self.attribute(port)) {
            Some(attribute) => format!("{attribute} {plain}"),
            None => plain,
        }
    }

    /// What stands in front of the name of an input in WGSL.
    fn attribute(&self, port: &Port) -> Option<String> {
        match port.at {
            PortAt::Argument(index) | PortAt::Arguments { first: index, .. } => {
                let Entry::Point(point) = self.entry else { return None };
                let argument = self.module.entry_points.get(point)?.function.arguments.get(index as usize)?;
                match argument.binding.as_ref()? {
                    Binding::Location { location, .. } => Some(format!("@location({location})")),
                    Binding::BuiltIn(_) => None,
                }
            }
            PortAt::Global(global)
            | PortAt::Member(global, _)
            | PortAt::Part { global, .. }
            | PortAt::Vertices { global, .. } => self.space(global),
            PortAt::Reference(_) | PortAt::Result | PortAt::ResultMember(_) => None,
        }
    }

    fn space(&self, global: Handle<GlobalVariable>) -> Option<String> {
        match self.module.global_variables[global].space {
            AddressSpace::Uniform => Some("var<uniform>".to_owned()),
            AddressSpace::Storage { .. } => Some("var<storage>".to_owned()),
            AddressSpace::Private => Some("var<private>".to_owned()),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_language_has_its_words() {
        let matrix = Shape { columns: 4, rows: 3, ..Shape::FLOAT };
        assert_eq!(Written::Wgsl.declaration("x", Shape::VEC3), "x: vec3f");
        assert_eq!(Written::Wgsl.type_name(Shape::vector(Scalar::Bool, 2)), "vec2<bool>");
        assert_eq!(Written::Wgsl.type_name(matrix), "mat4x3f");
        assert_eq!(Written::Wgsl.type_name(Shape::FLOAT.array_of(4)), "array<f32, 4>");
        assert_eq!(Written::Glsl.declaration("x", Shape::VEC3), "vec3 x");
        assert_eq!(Written::Hlsl.declaration("x", Shape::VEC3), "float3 x");
        assert_eq!(Written::Slang.declaration("x", Shape::FLOAT.array_of(4)), "float x[4]");
        assert_eq!(Written::Hlsl.type_name(matrix), "float3x4");
    }

    #[test]
    fn a_type_is_known_in_every_language() {
        let shapes = [
            Shape::FLOAT,
            Shape::INT,
            Shape::vector(Scalar::Bool, 3),
            Shape::vector(Scalar::U32, 2),
            Shape { columns: 2, rows: 3, ..Shape::FLOAT },
            Shape::VEC4.array_of(8),
        ];
        for shape in shapes {
            for written in [Written::Glsl, Written::Wgsl] {
                let name = written.type_name(shape);
                assert_eq!(Written::shape_named(&name), Some(shape), "{name}");
            }
        }
        assert_eq!(Written::shape_named("vec3<f32>"), Some(Shape::VEC3));
        assert_eq!(Written::shape_named("array<vec4f, 8u>"), Some(Shape::VEC4.array_of(8)));
        assert_eq!(Written::shape_named("float3x2"), Some(Shape { columns: 2, rows: 3, ..Shape::FLOAT }));
        assert_eq!(Written::shape_named("int2"), Some(Shape::vector(Scalar::I32, 2)));
        for text in ["vec5f", "float1", "vec3", "vec", "mat3f", "texture", "array<f32>", ""] {
            assert_eq!(Written::shape_named(text).is_some(), text == "vec3", "{text}");
        }
    }
}
