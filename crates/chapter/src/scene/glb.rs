//! The container: JSON and one buffer, as glTF 2.0 has them in a binary file.

use serde_json::{Value, json};

const FLOAT: u32 = 5126;
const UNSIGNED_BYTE: u32 = 5121;
const UNSIGNED_INT: u32 = 5125;

/// What a part of the buffer is for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Use {
    /// Attributes of vertices.
    Vertices,
    /// Indices of vertices.
    Indices,
    /// Anything else: key frames, matrices.
    Other,
}

/// A buffer with its views and accessors.
#[derive(Default)]
pub(super) struct GlbBuffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl GlbBuffer {
    fn view(&mut self, data: &[u8], purpose: Use) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let mut view = json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": data.len() });
        match purpose {
            Use::Vertices => view["target"] = json!(34962),
            Use::Indices => view["target"] = json!(34963),
            Use::Other => {}
        }
        self.bytes.extend_from_slice(data);
        self.views.push(view);
        self.views.len() - 1
    }

    /// Floats in groups of `N`; their extent is stated, as positions and key frames need it.
    pub fn floats<const N: usize>(&mut self, data: &[[f32; N]], ty: &str, purpose: Use) -> usize {
        let bytes: Vec<u8> = data.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        let view = self.view(&bytes, purpose);
        let extent = |pick: fn(f32, f32) -> f32| -> Vec<f64> {
            (0..N).map(|k| data.iter().map(|group| group[k]).reduce(pick).map_or(0.0, f64::from)).collect()
        };
        self.accessors.push(json!({
            "bufferView": view, "componentType": FLOAT, "count": data.len(), "type": ty,
            "min": extent(f32::min), "max": extent(f32::max),
        }));
        self.accessors.len() - 1
    }

    /// Numbers of joints.
    pub fn joints(&mut self, data: &[[u8; 4]]) -> usize {
        let view = self.view(&data.concat(), Use::Vertices);
        self.accessors.push(json!({
            "bufferView": view, "componentType": UNSIGNED_BYTE, "count": data.len(), "type": "VEC4",
        }));
        self.accessors.len() - 1
    }

    /// Indices of vertices.
    pub fn indices(&mut self, data: &[u32]) -> usize {
        let bytes: Vec<u8> = data.iter().flat_map(|x| x.to_le_bytes()).collect();
        let view = self.view(&bytes, Use::Indices);
        self.accessors.push(json!({
            "bufferView": view, "componentType": UNSIGNED_INT, "count": data.len(), "type": "SCALAR",
        }));
        self.accessors.len() - 1
    }

    /// The file: `scene` has everything but buffers, views and accessors.
    pub fn finish(mut self, mut scene: Value) -> Vec<u8> {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        scene["buffers"] = json!([{ "byteLength": self.bytes.len() }]);
        scene["bufferViews"] = Value::Array(self.views);
        scene["accessors"] = Value::Array(self.accessors);
        let mut text = scene.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let total = 12 + 8 + text.len() + 8 + self.bytes.len();
        let mut out = b"glTF".to_vec();
        out.extend(2_u32.to_le_bytes());
        out.extend((total as u32).to_le_bytes());
        for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &self.bytes)] {
            out.extend((chunk.len() as u32).to_le_bytes());
            out.extend(kind);
            out.extend(chunk);
        }
        out
    }
}
