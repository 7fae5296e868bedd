//! The description of a binary glTF file, and its buffer.

use nalgebra::{Point3, Vector3};
use serde_json::{Map, Value, json};

/// Metres in a millimetre.
pub const METRES: f64 = 1e-3;

/// The bytes at the beginning of a binary glTF file and of its chunks: `glTF`, `JSON` and `BIN`.
const MAGIC: u32 = 0x4654_6C67;
const JSON_CHUNK: u32 = 0x4E4F_534A;
const BIN_CHUNK: u32 = 0x004E_4942;
const VERSION: u32 = 2;
const HEADER_BYTES: usize = 12;
const CHUNK_HEADER_BYTES: usize = 8;

/// Numbers that stand for types of components, for targets of views and for modes, as glTF has them.
const UNSIGNED_BYTE: u32 = 5121;
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// The turn about x by which z of the part points up where y does: a quaternion x, y, z, w.
const Z_UP: [f64; 4] = [-std::f64::consts::FRAC_1_SQRT_2, 0.0, 0.0, std::f64::consts::FRAC_1_SQRT_2];

/// How the elements of a mesh are joined.
#[derive(Debug, Clone, Copy)]
pub enum Mode {
    LineStrip = 3,
    Triangles = 4,
}

/// How a solid looks: the index of its material.
#[derive(Debug, Clone, Copy)]
pub enum Look {
    Part,
    Stock,
    Cutter,
}

/// One of the arrays of the buffer, for several accessors: its values lie behind each other.
#[derive(Debug, Clone, Copy)]
pub struct Array {
    view: usize,
    component: u32,
    kind: &'static str,
    bytes: usize,
    is_normalized: bool,
}

/// A file under way.
pub struct Document {
    origin: Point3<f64>,
    bytes: Vec<u8>,
    nodes: Vec<Value>,
    meshes: Vec<Value>,
    accessors: Vec<Value>,
    views: Vec<Value>,
}

impl Document {
    /// A file whose coordinates count from `origin`, mm.
    pub fn new(origin: Point3<f64>) -> Self {
        let (nodes, meshes, accessors, views) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self { origin, bytes: Vec::new(), nodes, meshes, accessors, views }
    }

    /// The place of the part that is the origin of the buffer, mm.
    pub fn origin(&self) -> Vector3<f64> {
        self.origin.coords
    }

    /// A place in metres, as the buffer holds it.
    pub fn place(&self, p: &Point3<f64>) -> [f32; 3] {
        let from = (p - self.origin) * METRES;
        [from.x as f32, from.y as f32, from.z as f32]
    }

    /// An accessor of all of these places, with their box.
    pub fn points(&mut self, points: &[Point3<f64>]) -> usize {
        let placed: Vec<[f32; 3]> = points.iter().map(|p| self.place(p)).collect();
        let array = self.vec3(&placed);
        self.places(array, 0, &placed)
    }

    pub fn vectors(&mut self, vectors: &[Vector3<f64>]) -> usize {
        let short: Vec<[f32; 3]> = vectors.iter().map(|v| [v.x as f32, v.y as f32, v.z as f32]).collect();
        let array = self.vec3(&short);
        self.accessor(array, 0, short.len())
    }

    /// An accessor of the corners of triangles.
    pub fn indices(&mut self, triangles: &[[u32; 3]]) -> usize {
        let bytes: Vec<u8> = triangles.iter().flatten().flat_map(|k| k.to_le_bytes()).collect();
        let view = self.view(&bytes, None, ELEMENT_ARRAY_BUFFER);
        let array = Array { view, component: UNSIGNED_INT, kind: "SCALAR", bytes: 4, is_normalized: false };
        self.accessor(array, 0, 3 * triangles.len())
    }

    pub fn vec3(&mut self, values: &[[f32; 3]]) -> Array {
        let bytes: Vec<u8> = values.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        self.array(&bytes, FLOAT, "VEC3", 12)
    }

    pub fn scalars(&mut self, values: &[f32]) -> Array {
        let bytes: Vec<u8> = values.iter().flat_map(|x| x.to_le_bytes()).collect();
        self.array(&bytes, FLOAT, "SCALAR", 4)
    }

    /// Colours: red, green, blue and opacity.
    pub fn colors(&mut self, values: &[[u8; 4]]) -> Array {
        let array = self.array(values.as_flattened(), UNSIGNED_BYTE, "VEC4", 4);
        Array { is_normalized: true, ..array }
    }

    fn array(&mut self, bytes: &[u8], component: u32, kind: &'static str, size: usize) -> Array {
        let view = self.view(bytes, Some(size), ARRAY_BUFFER);
        Array { view, component, kind, bytes: size, is_normalized: false }
    }

    fn view(&mut self, bytes: &[u8], stride: Option<usize>, target: u32) -> usize {
        let mut view = json!({
            "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len(), "target": target
        });
        if let Some(stride) = stride {
            view["byteStride"] = json!(stride);
        }
        self.bytes.extend_from_slice(bytes);
        self.views.push(view);
        self.views.len() - 1
    }

    /// An accessor of `count` values of an array from `first` on.
    pub fn accessor(&mut self, array: Array, first: usize, count: usize) -> usize {
        let Array { view, component, kind, bytes, is_normalized } = array;
        let mut accessor = json!({
            "bufferView": view, "byteOffset": first * bytes, "componentType": component, "count": count, "type": kind
        });
        if is_normalized {
            accessor["normalized"] = json!(true);
        }
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// An accessor of places of an array from `first` on, with their box.
    pub fn places(&mut self, array: Array, first: usize, places: &[[f32; 3]]) -> usize {
        let accessor = self.accessor(array, first, places.len());
        let extreme = |pick: fn(f32, f32) -> f32, start: f32| {
            [0, 1, 2].map(|axis| f64::from(places.iter().map(|p| p[axis]).fold(start, pick)))
        };
        self.accessors[accessor]["min"] = json!(extreme(f32::min, f32::INFINITY));
        self.accessors[accessor]["max"] = json!(extreme(f32::max, f32::NEG_INFINITY));
        accessor
    }

    /// A mesh of one primitive.
    pub fn mesh(
        &mut self,
        name: &str,
        mode: Mode,
        attributes: Vec<(&'static str, usize)>,
        indices: Option<usize>,
        look: Option<Look>,
    ) -> usize {
        let attributes: Map<String, Value> =
            attributes.into_iter().map(|(name, accessor)| (name.to_owned(), json!(accessor))).collect();
        let mut primitive = json!({ "attributes": attributes, "mode": mode as u32 });
        if let Some(indices) = indices {
            primitive["indices"] = json!(indices);
        }
        // Lines have the last material, behind those of the solids.
        primitive["material"] = json!(look.map_or(MATERIALS.len(), |look| look as usize));
        self.meshes.push(json!({ "name": name, "primitives": [primitive] }));
        self.meshes.len() - 1
    }

    /// A node with its name and what else is told of it.
    pub fn node(&mut self, told: Value, mesh: Option<usize>, children: &[usize]) -> usize {
        let mut node = told;
        if let Some(mesh) = mesh {
            node["mesh"] = json!(mesh);
        }
        if !children.is_empty() {
            node["children"] = json!(children);
        }
        self.nodes.push(node);
        self.nodes.len() - 1
    }

    /// The bytes of the file. `nodes` stand below the root, `about` is told of the root.
    pub fn finish(mut self, title: &str, nodes: &[usize], about: Value) -> Vec<u8> {
        let Point3 { coords: origin } = self.origin;
        let moved = [origin.x, origin.z, -origin.y].map(|mm| mm * METRES + 0.0);
        let root = json!({ "name": title, "rotation": Z_UP, "translation": moved, "extras": about });
        let root = self.node(root, None, nodes);
        let mut file = json!({
            "asset": { "version": "2.0", "generator": "toolpathd" },
            "scene": 0,
            "scenes": [{ "name": title, "nodes": [root] }],
            "nodes": self.nodes,
        });
        if !self.bytes.is_empty() {
            file["buffers"] = json!([{ "byteLength": self.bytes.len() }]);
            file["bufferViews"] = Value::Array(self.views);
            file["accessors"] = Value::Array(self.accessors);
            file["meshes"] = Value::Array(self.meshes);
            file["materials"] = materials();
        }
        packed(&file.to_string(), self.bytes)
    }
}

/// The colours of solids: red, green, blue and opacity, linear.
const MATERIALS: [(&str, [f64; 4]); 3] = [
    ("part", [0.42, 0.46, 0.5, 1.0]),
    ("stock", [0.62, 0.55, 0.4, 0.25]),
    ("cutter", [0.75, 0.6, 0.15, 1.0]),
];

fn materials() -> Value {
    let solid = |(name, color): &(&str, [f64; 4])| {
        let mut material = json!({
            "name": name,
            "doubleSided": true,
            "pbrMetallicRoughness": { "baseColorFactor": color, "metallicFactor": 0.1, "roughnessFactor": 0.6 },
        });
        if color[3] < 1.0 {
            material["alphaMode"] = json!("BLEND");
        }
        material
    };
    let lines = json!({
        "name": "lines",
        "pbrMetallicRoughness": { "baseColorFactor": [1.0, 1.0, 1.0, 1.0], "metallicFactor": 0.0 },
    });
    MATERIALS.iter().map(solid).chain([lines]).collect()
}

/// The header, the description padded with blanks, and the buffer padded with zeros.
fn packed(json: &str, mut bytes: Vec<u8>) -> Vec<u8> {
    let mut text = json.as_bytes().to_vec();
    text.resize(text.len().next_multiple_of(4), b' ');
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    let chunks = [(JSON_CHUNK, text), (BIN_CHUNK, bytes)];
    let filled = || chunks.iter().filter(|(_, chunk)| !chunk.is_empty());
    let length = HEADER_BYTES + filled().map(|(_, chunk)| CHUNK_HEADER_BYTES + chunk.len()).sum::<usize>();
    let mut file = Vec::with_capacity(length);
    let number =
        |file: &mut Vec<u8>, n: usize| file.extend(u32::try_from(n).unwrap_or(u32::MAX).to_le_bytes());
    file.extend(MAGIC.to_le_bytes());
    file.extend(VERSION.to_le_bytes());
    number(&mut file, length);
    for (kind, chunk) in filled() {
        number(&mut file, chunk.len());
        file.extend(kind.to_le_bytes());
        file.extend_from_slice(chunk);
    }
    file
}
