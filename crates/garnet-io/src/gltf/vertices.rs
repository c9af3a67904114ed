//! Vertices, weights and faces of the primitives of skinned meshes.

use gltf::json::{
    Index,
    accessor::Type,
    mesh::{Primitive, Semantic},
    validation::Checked,
};
use nalgebra::{Point3 as NaPoint3, Vector3};

use super::{
    GltfProblem,
    accessor::{self, Fractions},
    modes,
    rig::Reader,
};
use crate::FileProblem;

/// Influences of a vertex on joints of its skin.
pub(super) type Influences = Vec<(usize, f32)>;

/// Vertices of a mesh and what they follow.
#[derive(Debug, Default, Clone)]
pub(super) struct Vertices {
    /// In the space of the mesh, with the default weights of its morph targets.
    pub positions: Vec<NaPoint3<f64>>,
    pub influences: Vec<Influences>,
}

/// What a primitive reads: the accessors of positions, joints, weights and morph targets.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Source {
    positions: usize,
    sets: Vec<(usize, usize)>,
    targets: Vec<(usize, u64)>,
}

impl Reader<'_> {
    /// What a primitive with a skin reads, with the default weights of the morph targets of its
    /// mesh.
    pub(super) fn source(
        number: usize,
        primitive: &Primitive,
        morph_weights: &[f32],
    ) -> Result<Source, GltfProblem> {
        let source = Self::bare_source(number, primitive, morph_weights)?;
        if source.sets.is_empty() {
            return Err(GltfProblem::Primitive {
                primitive: number,
                what: "it has no joints or weights",
            });
        }
        Ok(source)
    }

    /// What a primitive reads, with or without joints and weights.
    pub(super) fn bare_source(
        number: usize,
        primitive: &Primitive,
        morph_weights: &[f32],
    ) -> Result<Source, GltfProblem> {
        let wrong = |what| GltfProblem::Primitive {
            primitive: number,
            what,
        };
        let attribute = |semantic| {
            let index: Option<&Index<_>> = primitive.attributes.get(&Checked::Valid(semantic));
            index.map(Index::value)
        };
        let positions = attribute(Semantic::Positions).ok_or(wrong("it has no positions"))?;
        let sets: Vec<(usize, usize)> = (0..)
            .map_while(|set| {
                attribute(Semantic::Joints(set)).zip(attribute(Semantic::Weights(set)))
            })
            .collect();
        let targets = primitive.targets.iter().flatten().zip(morph_weights);
        let targets = targets.filter(|&(_, &weight)| weight != 0.0 && weight.is_finite());
        let targets = targets.filter_map(|(target, &weight)| {
            let positions = target.positions.as_ref()?;
            Some((positions.value(), f64::from(weight).to_bits()))
        });
        Ok(Source {
            positions,
            sets,
            targets: targets.collect(),
        })
    }

    /// The vertices that a primitive reads.
    pub(super) fn vertices(&self, number: usize, source: &Source) -> Result<Vertices, FileProblem> {
        let wrong = |what| GltfProblem::Primitive {
            primitive: number,
            what,
        };
        let points = self.read(source.positions, Type::Vec3)?;
        let rows = points.rows();
        let mut positions: Vec<NaPoint3<f64>> = rows
            .map(|row| NaPoint3::new(row[0], row[1], row[2]))
            .collect();
        for &(target, weight) in &source.targets {
            let weight = f64::from_bits(weight);
            let offsets = accessor::read_or_zeros(
                self.root,
                &self.buffers,
                target,
                Type::Vec3,
                Fractions::AsDeclared,
                positions.len(),
            )?;
            if offsets.num_rows() != positions.len() {
                return Err(wrong("a morph target has another number of vertices").into());
            }
            for (position, row) in positions.iter_mut().zip(offsets.rows()) {
                *position += weight * Vector3::new(row[0], row[1], row[2]);
            }
        }
        let mut influences = vec![Vec::with_capacity(4); points.num_rows()];
        for &(joints, weights) in &source.sets {
            let joints = self.read(joints, Type::Vec4)?;
            let weights = accessor::read(
                self.root,
                &self.buffers,
                weights,
                Type::Vec4,
                Fractions::Always,
            )?;
            if joints.num_rows() != points.num_rows() || weights.num_rows() != points.num_rows() {
                return Err(
                    wrong("it has another number of joints or weights than of positions").into(),
                );
            }
            let rows = joints.rows().zip(weights.rows()).zip(&mut influences);
            for ((joints, weights), influences) in rows {
                for (&joint, &weight) in joints.iter().zip(weights) {
                    let joint = accessor::whole(joint);
                    let joint = joint.ok_or_else(|| wrong("a joint is no whole number"))?;
                    influences.push((joint, weight as f32));
                }
            }
        }
        Ok(Vertices {
            positions,
            influences,
        })
    }

    /// The faces of a primitive on `num_vertices` vertices.
    pub(super) fn faces(
        &self,
        number: usize,
        primitive: &Primitive,
        num_vertices: usize,
    ) -> Result<Vec<[u32; 3]>, GltfProblem> {
        let wrong = |what| GltfProblem::Primitive {
            primitive: number,
            what,
        };
        let corners: Vec<usize> = match primitive.indices {
            Some(indices) => {
                let values = self.read(indices.value(), Type::Scalar)?.values;
                let numbers = values.into_iter().map(accessor::whole);
                let numbers: Option<Vec<usize>> = numbers.collect();
                numbers.ok_or(wrong("an index is no whole number"))?
            }
            None => (0..num_vertices).collect(),
        };
        let Checked::Valid(mode) = primitive.mode else {
            return Err(wrong("its mode is unknown"));
        };
        // What is a vertex starts nothing anew.
        let restart = modes::restart(self.root, primitive).filter(|&number| number >= num_vertices);
        let triangles = modes::triangles(mode, &corners, restart);
        let triangles = triangles.ok_or(wrong("its indices do not divide into triangles"))?;
        let mut named = triangles.as_flattened().iter();
        if let Some(&index) = named.find(|&&corner| corner >= num_vertices) {
            return Err(GltfProblem::OutOfRange {
                user: format!("primitive {number}"),
                part: "vertex",
                index,
                count: num_vertices,
            });
        }
        let face = |face: [usize; 3]| face.map(|corner| corner as u32);
        Ok(triangles.into_iter().map(face).collect())
    }
}
