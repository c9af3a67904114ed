//! The JSON of a GLB of moving meshes.

use garnet_mesh::Point3;
use serde::Serialize;
use serde_json::{Value, json};

use super::{glb::Layout, glb_parts::GlbPart};
use crate::obj::ObjMaterial;

/// Numbers of glTF.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const VERTICES: u32 = 34962;
const TRIANGLES: u32 = 34963;

/// The smallest and the largest coordinates of points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bounds {
    min: [f32; 3],
    max: [f32; 3],
}

impl Bounds {
    /// Numbers that no others are longer than as text.
    pub(super) const LONGEST: Self = Self {
        min: [-1.175_494_4e-38; 3],
        max: [-1.175_494_4e-38; 3],
    };

    pub(super) fn of(points: &[Point3]) -> Self {
        let mut bounds = Self {
            min: [f32::INFINITY; 3],
            max: [f32::NEG_INFINITY; 3],
        };
        for point in points {
            for axis in 0..3 {
                bounds.min[axis] = bounds.min[axis].min(point[axis]);
                bounds.max[axis] = bounds.max[axis].max(point[axis]);
            }
        }
        bounds
    }
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Accessor {
    buffer_view: usize,
    byte_offset: u64,
    component_type: u32,
    count: usize,
    #[serde(rename = "type")]
    kind: &'static str,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    min: Vec<f32>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    max: Vec<f32>,
}

#[derive(Default)]
struct Accessors(Vec<Accessor>);

impl Accessors {
    fn push(
        &mut self,
        (buffer_view, byte_offset): (usize, u64),
        (component_type, kind): (u32, &'static str),
        count: usize,
    ) -> usize {
        self.0.push(Accessor {
            buffer_view,
            byte_offset,
            component_type,
            count,
            kind,
            min: Vec::new(),
            max: Vec::new(),
        });
        self.0.len() - 1
    }

    fn bound(&mut self, accessor: usize, min: &[f32], max: &[f32]) {
        self.0[accessor].min = min.to_vec();
        self.0[accessor].max = max.to_vec();
    }
}

#[derive(Default)]
struct Views(Vec<Value>);

impl Views {
    /// A view from a byte to another, with the stride and the purpose of vertices; nothing of
    /// nothing.
    fn push(&mut self, start: u64, end: u64, stride: Option<u32>, target: Option<u32>) -> usize {
        let mut view = json!({"buffer": 0, "byteOffset": start, "byteLength": end - start});
        if let Some(stride) = stride {
            view["byteStride"] = json!(stride);
        }
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.0.push(view);
        self.0.len() - 1
    }
}

/// Positions and normals of a frame of a part.
#[derive(Clone, Copy, Serialize)]
struct Shape {
    #[serde(rename = "POSITION")]
    position: usize,
    #[serde(rename = "NORMAL")]
    normal: usize,
}

/// The JSON of a file whose frames have these bounds `[frame × part]`.
#[expect(
    clippy::too_many_lines,
    reason = "a part of the document after the other"
)]
pub(super) fn document(layout: &Layout, bounds: &[Bounds]) -> String {
    let (starts, num_parts) = (&layout.starts, layout.parts.len());
    let (mut views, mut accessors) = (Views::default(), Accessors::default());
    let indices = views.push(0, starts.textures, None, Some(TRIANGLES));
    let after_textures = *starts.pictures.first().unwrap_or(&starts.times);
    let has_textures = after_textures > starts.textures;
    let textures =
        has_textures.then(|| views.push(starts.textures, after_textures, Some(8), Some(VERTICES)));
    let first = views.push(starts.first, starts.others, Some(12), Some(VERTICES));
    let is_moving = layout.num_frames > 1;
    let others = if is_moving {
        views.push(starts.others, starts.end, Some(12), Some(VERTICES))
    } else {
        first
    };
    // Frame after frame, part after part.
    let mut shapes: Vec<Vec<Shape>> = vec![Vec::new(); num_parts];
    let mut offset = 0;
    for (number, bounds) in bounds.iter().enumerate() {
        if number == num_parts {
            offset = 0;
        }
        let view = if number < num_parts { first } else { others };
        let count = layout.parts[number % num_parts].num_vertices();
        let position = accessors.push((view, offset), (FLOAT, "VEC3"), count);
        accessors.bound(position, &bounds.min, &bounds.max);
        offset += 12 * count as u64;
        let normal = accessors.push((view, offset), (FLOAT, "VEC3"), count);
        offset += 12 * count as u64;
        shapes[number % num_parts].push(Shape { position, normal });
    }
    let mut materials = Vec::new();
    let (mut meshes, mut at_index, mut at_texture) = (Vec::new(), 0, 0);
    for (number, part) in layout.parts.iter().enumerate() {
        let texture = textures.filter(|_| !part.texture.is_empty()).map(|view| {
            let count = part.texture.len();
            let accessor = accessors.push((view, at_texture), (FLOAT, "VEC2"), count);
            at_texture += 8 * count as u64;
            accessor
        });
        let first_material = materials.len();
        materials.extend(layout.materials[number].iter().map(material));
        let has_none = part.primitives.iter().any(|one| one.material.is_none());
        let plain = has_none.then(|| {
            materials.push(json!({
                "name": part.name,
                "doubleSided": true,
                "pbrMetallicRoughness": {"metallicFactor": 0},
            }));
            materials.len() - 1
        });
        let mut primitives = Vec::new();
        for primitive in &part.primitives {
            let count = 3 * primitive.faces.len();
            let accessor = accessors.push((indices, at_index), (UNSIGNED_INT, "SCALAR"), count);
            at_index += 4 * count as u64;
            let of_first = shapes[number][0];
            let mut attributes = json!(of_first);
            if let Some(texture) = texture {
                attributes["TEXCOORD_0"] = json!(texture);
            }
            let own = primitive.material.map(|own| first_material + own as usize);
            let mut value = json!({
                "attributes": attributes,
                "indices": accessor,
                "material": own.or(plain),
            });
            if is_moving {
                value["targets"] = json!(shapes[number][1..]);
            }
            primitives.push(value);
        }
        meshes.push(json!({"name": part.name, "primitives": primitives}));
    }
    let node = |(number, part): (usize, &GlbPart)| json!({"name": part.name, "mesh": number});
    let nodes: Vec<Value> = layout.parts.iter().enumerate().map(node).collect();
    let mut document = json!({
        "asset": {"version": "2.0", "generator": concat!("garnet ", env!("CARGO_PKG_VERSION"))},
        "scene": 0,
        "scenes": [{"nodes": (0..num_parts).collect::<Vec<_>>()}],
        "nodes": nodes,
        "meshes": meshes,
        "materials": materials,
        "buffers": [{"byteLength": starts.end}],
    });
    if is_moving {
        document["animations"] = json!([animation(layout, &mut views, &mut accessors)]);
    }
    if !layout.pictures.is_empty() {
        let mut images = Vec::new();
        for (picture, start) in layout.pictures.iter().zip(&starts.pictures) {
            let end = start + picture.bytes.len() as u64;
            let view = views.push(*start, end, None, None);
            images.push(json!({
                "name": picture.name, "mimeType": picture.kind, "bufferView": view,
            }));
        }
        let of_image = |source: usize| json!({"source": source});
        document["textures"] = (0..images.len()).map(of_image).collect();
        document["images"] = json!(images);
    }
    document["bufferViews"] = json!(views.0);
    document["accessors"] = json!(accessors.0);
    document.to_string()
}

/// At the time of a frame the weight of its target is one, that of all others zero.
fn animation(layout: &Layout, views: &mut Views, accessors: &mut Accessors) -> Value {
    let (starts, num_frames) = (&layout.starts, layout.num_frames);
    let times = views.push(starts.times, starts.weights, None, None);
    let weights = views.push(starts.weights, starts.first, None, None);
    let input = accessors.push((times, 0), (FLOAT, "SCALAR"), num_frames);
    let last = ((num_frames - 1) as f64 / layout.fps) as f32;
    accessors.bound(input, &[0.0], &[last]);
    let count = num_frames * (num_frames - 1);
    let output = accessors.push((weights, 0), (FLOAT, "SCALAR"), count);
    let channel = |node: usize| json!({"sampler": 0, "target": {"node": node, "path": "weights"}});
    let channels: Vec<Value> = (0..layout.parts.len()).map(channel).collect();
    json!({
        "name": "drape",
        "samplers": [{"input": input, "output": output, "interpolation": "LINEAR"}],
        "channels": channels,
    })
}

fn material(material: &ObjMaterial) -> Value {
    let mut look = json!({"baseColorFactor": material.color, "metallicFactor": 0});
    if let Some(picture) = material.picture {
        look["baseColorTexture"] = json!({"index": picture});
    }
    let mut value = json!({
        "name": material.name,
        "doubleSided": true,
        "pbrMetallicRoughness": look,
    });
    if material.color[3] < 1.0 {
        value["alphaMode"] = json!("BLEND");
    }
    value
}
