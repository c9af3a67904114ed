//! A garment as springs, hinges and masses.

use std::sync::Arc;

use crate::rest_shape::RestFace;
use crate::xpbd::patchwork::Spare;
use crate::{Fabric, RestShape, SimError};
use garnet_mesh::{MeshError, Topology};

/// What is constant about a garment: its mesh, masses, springs and hinges.
///
/// Every solver of this crate minimizes the same energy
///
/// ```text
/// E(x) = Σ_edges ½ k (|xᵢ − xⱼ| − l)² + Σ_hinges ½ b |Σₘ wₘ xₘ|² + Σ_vertices m g y
/// ```
///
/// with the springs of Van Gelder 1998 (k = Y (A₀ + A₁) / l², a [share](Fabric::compression) of it
/// for edges shorter than l) and the quadratic bending of Bergou et al. 2006, with a coefficient
/// calibrated on a cantilever ([`BENDING_FACTOR`]).
///
/// # Examples
///
/// ```
/// use garnet_mesh::primitives::grid;
/// use garnet_sim::{Cloth, Fabric, RestShape};
///
/// let square = grid(10, 10, [1.0, 1.0]);
/// let rest = RestShape::Worn(square.positions().to_vec());
/// let cloth = Cloth::new(square.faces(), square.num_vertices(), &rest, &Fabric::cotton())?;
/// let mass: f32 = cloth.masses().iter().sum();
/// assert!((mass - Fabric::cotton().density).abs() < 1e-6);
/// # Ok::<(), garnet_sim::SimError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Cloth {
    topology: Arc<Topology>,
    fabric: Fabric,
    masses: Vec<f32>,
    is_pinned: Vec<bool>,
    springs: Vec<Spring>,
    is_shrunk: Vec<bool>,
    grip: f32,
    hinges: Vec<BendingHinge>,
    spare: Spare,
}

/// Resistance of an edge to a change of its length: energy ½ k (|x₁ − x₀| − l)², with another k
/// where it is shorter than l.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spring {
    /// The ends of the edge, the smaller first.
    pub vertices: [u32; 2],
    /// Rest length l, in metres.
    pub rest_length: f32,
    /// Stiffness k where the edge is stretched, N/m.
    pub stiffness: f32,
    /// Stiffness k where it is shortened, N/m.
    pub compression: f32,
}

impl Spring {
    /// The stiffness of an edge that is longer than at rest by `stretch`, N/m.
    pub fn stiffness_at(&self, stretch: f64) -> f64 {
        f64::from(if stretch < 0.0 {
            self.compression
        } else {
            self.stiffness
        })
    }
}

/// Resistance of two faces at an edge to a fold: energy ½ b |Σₘ wₘ xₘ|².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BendingHinge {
    /// The ends of the edge, then the third vertex of each face.
    pub vertices: [u32; 4],
    /// Weights w of the vertices, from the cotangents at rest; their sum is 0.
    pub weights: [f32; 4],
    /// Stiffness b, N/m.
    pub stiffness: f32,
}

/// The factor c in the stiffness b = c B / (A₀ + A₁) of a hinge.
///
/// Bergou et al. 2006 have 3, which counts a curvature once along each of three directions of
/// edges. On equilateral faces, which sewn garments mostly have, theory gives 1 for cylinders and
/// 9/8 for narrow strips; with 1.05 a heavy cantilever hangs as the elastica does, within 1.1 % for
/// gravito-bending numbers from 1 to 100 (`tests/physics/cantilever.rs`).
pub const BENDING_FACTOR: f32 = 1.05;

/// Cotangents of needles are cut here, so that no hinge becomes infinitely stiff.
const MAX_COTANGENT: f32 = 20.0;

impl Cloth {
    /// Makes cloth of `faces` over `num_vertices` vertices.
    ///
    /// Vertices that no face uses get no mass and stay where they are.
    ///
    /// # Errors
    ///
    /// [`SimError::Garment`] for faces that name missing vertices; [`SimError::NonManifoldEdge`],
    /// [`SimError::InvertedFace`], [`SimError::NoArea`], [`SimError::FoldedPattern`] or
    /// [`SimError::SeamMismatch`] for a mesh that no cloth can be; [`SimError::Count`] for a rest
    /// shape that does not fit; [`SimError::Fabric`].
    pub fn new(
        faces: &[[u32; 3]],
        num_vertices: usize,
        rest: &RestShape,
        fabric: &Fabric,
    ) -> Result<Self, SimError> {
        check_faces(faces, num_vertices)?;
        check_manifold(&Topology::new(num_vertices, faces))?;
        Self::of_any_faces(faces, num_vertices, rest, fabric)
    }

    /// The same of faces that need not be a manifold: edges with other than two faces do not bend.
    ///
    /// # Errors
    ///
    /// Those of [`Cloth::new`] but for [`SimError::NonManifoldEdge`] and
    /// [`SimError::InvertedFace`].
    pub fn of_any_faces(
        faces: &[[u32; 3]],
        num_vertices: usize,
        rest: &RestShape,
        fabric: &Fabric,
    ) -> Result<Self, SimError> {
        fabric.check()?;
        check_faces(faces, num_vertices)?;
        let topology = Topology::new(num_vertices, faces);
        let rest_faces = rest.faces(&topology)?;
        let mut masses = vec![0.0; num_vertices];
        for (face, rest) in faces.iter().zip(&rest_faces) {
            for &vertex in face {
                masses[vertex as usize] += fabric.density * rest.cut_area / 3.0;
            }
        }
        Ok(Self {
            springs: springs(&topology, &rest_faces, fabric),
            is_shrunk: are_shrunk(&topology, &rest_faces),
            grip: rest.grip()?,
            hinges: hinges(&topology, &rest_faces, fabric),
            is_pinned: masses.iter().map(|&mass| mass == 0.0).collect(),
            masses,
            fabric: *fabric,
            topology: Arc::new(topology),
            spare: Spare::default(),
        })
    }

    /// The same cloth with some vertices held where they start.
    ///
    /// # Errors
    ///
    /// [`SimError::Garment`] if there is no such vertex.
    pub fn with_pins(mut self, vertices: &[u32]) -> Result<Self, SimError> {
        self.spare = Spare::default();
        for &vertex in vertices {
            let num_vertices = self.num_vertices();
            match self.is_pinned.get_mut(vertex as usize) {
                Some(is_pinned) => *is_pinned = true,
                None => {
                    return Err(SimError::Garment(MeshError::FaceIndexOutOfRange {
                        face: 0,
                        index: vertex,
                        num_vertices,
                    }));
                }
            }
        }
        Ok(self)
    }

    /// How the faces hang together.
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// The same for those who keep it.
    pub(crate) fn shared_topology(&self) -> Arc<Topology> {
        Arc::clone(&self.topology)
    }

    /// What runs leave for the next.
    pub(crate) fn spare(&self) -> &Spare {
        &self.spare
    }

    /// Faces of the cloth `[face][corner]`, as numbers of vertices.
    pub fn faces(&self) -> &[[u32; 3]] {
        self.topology.faces()
    }

    /// How many vertices there are.
    pub fn num_vertices(&self) -> usize {
        self.masses.len()
    }

    /// What the cloth is made of.
    pub fn fabric(&self) -> &Fabric {
        &self.fabric
    }

    /// Mass of each vertex, kg: a third of its faces' before they were shrunk.
    pub fn masses(&self) -> &[f32] {
        &self.masses
    }

    /// Whether a vertex is held: pinned, or used by no face.
    pub fn is_pinned(&self) -> &[bool] {
        &self.is_pinned
    }

    /// One over the mass of each vertex, 1/kg; 0 for those that are held.
    pub fn inverse_masses(&self) -> Vec<f32> {
        let masses = self.masses.iter().zip(&self.is_pinned);
        masses
            .map(|(&mass, &is_pinned)| if is_pinned { 0.0 } else { mass.recip() })
            .collect()
    }

    /// The springs, one an edge, in the order of [`Topology::edges`].
    pub fn springs(&self) -> &[Spring] {
        &self.springs
    }

    /// Whether a face at an edge was shrunk `[edge]`: ribs and waistbands, which are worn
    /// stretched.
    pub fn is_shrunk(&self) -> &[bool] {
        &self.is_shrunk
    }

    /// What friction is multiplied by at each vertex `[vertex]`: the [grip](RestShape::Flat::grip)
    /// at shrunk faces, 0 at others.
    pub(crate) fn grips(&self) -> Vec<f32> {
        let mut grips = vec![0.0; self.num_vertices()];
        let edges = self.springs.iter().zip(&self.is_shrunk);
        for (spring, _) in edges.filter(|&(_, &is_shrunk)| is_shrunk) {
            for vertex in spring.vertices {
                grips[vertex as usize] = self.grip;
            }
        }
        grips
    }

    /// The hinges, one an edge with two faces, in the order of [`Topology::hinges`].
    pub fn hinges(&self) -> &[BendingHinge] {
        &self.hinges
    }

    /// Mean rest length of the edges, in metres.
    pub fn mean_edge_length(&self) -> f32 {
        let lengths = self
            .springs
            .iter()
            .map(|spring| f64::from(spring.rest_length));
        (lengths.sum::<f64>() / self.springs.len() as f64) as f32
    }
}

fn check_faces(faces: &[[u32; 3]], num_vertices: usize) -> Result<(), SimError> {
    if faces.is_empty() {
        return Err(SimError::Garment(MeshError::NoFaces));
    }
    let count = num_vertices.max(faces.len());
    if count >= u32::MAX as usize / 3 {
        return Err(SimError::Garment(MeshError::TooLarge { count }));
    }
    for (face, corners) in faces.iter().enumerate() {
        let [a, b, c] = *corners;
        if a == b || b == c || c == a {
            return Err(SimError::NoArea {
                face,
                corners: *corners,
            });
        }
        if let Some(&index) = corners
            .iter()
            .find(|&&index| index as usize >= num_vertices)
        {
            return Err(SimError::Garment(MeshError::FaceIndexOutOfRange {
                face,
                index,
                num_vertices,
            }));
        }
    }
    Ok(())
}

fn check_manifold(topology: &Topology) -> Result<(), SimError> {
    if let Some(&edge) = topology.non_manifold_edges().first() {
        return Err(SimError::NonManifoldEdge {
            vertices: topology.edges()[edge as usize],
            num_faces: topology.edge_faces(edge as usize).len(),
        });
    }
    if let Some(&edge) = topology.inconsistent_edges().first() {
        let faces = topology.edge_faces(edge as usize);
        return Err(SimError::InvertedFace {
            faces: [faces[0], faces[1]],
            vertices: topology.edges()[edge as usize],
        });
    }
    Ok(())
}

/// The slot of the corner of `face` that is opposite to an edge of it.
fn opposite_slot(face: [u32; 3], edge: [u32; 2]) -> usize {
    face.iter()
        .position(|vertex| !edge.contains(vertex))
        .expect("a face has three different corners")
}

fn springs(topology: &Topology, rest: &[RestFace], fabric: &Fabric) -> Vec<Spring> {
    let edges = topology.edges().iter().enumerate();
    edges
        .map(|(edge, &vertices)| {
            let faces = topology.edge_faces(edge);
            let (mut area, mut length) = (0.0, 0.0);
            for &face in faces {
                let slot = opposite_slot(topology.faces()[face as usize], vertices);
                area += rest[face as usize].area;
                length += rest[face as usize].sides[(slot + 1) % 3];
            }
            let rest_length = length / faces.len() as f32;
            let stiffness = fabric.membrane * area / (rest_length * rest_length);
            Spring {
                vertices,
                rest_length,
                stiffness,
                compression: fabric.compression * stiffness,
            }
        })
        .collect()
}

fn are_shrunk(topology: &Topology, rest: &[RestFace]) -> Vec<bool> {
    let is_shrunk = |&face: &u32| rest[face as usize].is_shrunk;
    let edges = 0..topology.edges().len();
    edges
        .map(|edge| topology.edge_faces(edge).iter().any(is_shrunk))
        .collect()
}

fn hinges(topology: &Topology, rest: &[RestFace], fabric: &Fabric) -> Vec<BendingHinge> {
    let mut hinges = Vec::with_capacity(topology.edges().len());
    for (edge, &[start, end]) in topology.edges().iter().enumerate() {
        let &[first, second] = topology.edge_faces(edge) else {
            continue;
        };
        let mut weights = [0.0; 4];
        let mut vertices = [start, end, 0, 0];
        let mut area = 0.0;
        for (side, face) in [first, second].into_iter().enumerate() {
            let corners = topology.faces()[face as usize];
            let cotangents = rest[face as usize].cotangents();
            let at = |vertex: u32| {
                let slot = corners.iter().position(|&corner| corner == vertex);
                let cotangent = cotangents[slot.expect("an edge joins corners of its faces")];
                cotangent.clamp(-MAX_COTANGENT, MAX_COTANGENT)
            };
            let (at_start, at_end) = (at(start), at(end));
            weights[0] += at_end;
            weights[1] += at_start;
            weights[2 + side] = -(at_start + at_end);
            vertices[2 + side] = corners[opposite_slot(corners, [start, end])];
            area += rest[face as usize].area;
        }
        hinges.push(BendingHinge {
            vertices,
            weights,
            stiffness: BENDING_FACTOR * fabric.bending / area,
        });
    }
    hinges
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use garnet_mesh::primitives::grid;

    /// Closed forms in `f32`.
    const ROUNDING: f32 = 1e-5;

    fn flat_cloth(size: [f32; 2], fabric: &Fabric) -> Cloth {
        let mesh = grid(8, 6, size);
        let rest = RestShape::Worn(mesh.positions().to_vec());
        Cloth::new(mesh.faces(), mesh.num_vertices(), &rest, fabric).unwrap()
    }

    #[test]
    fn flat_cloth_has_no_bending_energy() {
        let mesh = grid(8, 6, [0.4, 0.3]);
        let cloth = flat_cloth([0.4, 0.3], &Fabric::denim());
        for hinge in cloth.hinges() {
            let mut sum = garnet_mesh::Vector3::zeros();
            for (&vertex, &weight) in hinge.vertices.iter().zip(&hinge.weights) {
                sum += weight * mesh.positions()[vertex as usize].coords;
            }
            assert!(sum.norm() < ROUNDING, "{hinge:?}");
        }
    }

    #[test]
    fn cloth_that_is_pushed_together_has_its_share_of_the_energy() {
        let mesh = grid(8, 6, [0.4, 0.3]);
        let fabric = Fabric::interlock();
        let cloth = flat_cloth([0.4, 0.3], &fabric);
        let energy = |scale: f32| {
            let scaled: Vec<_> = mesh.positions().iter().map(|p| p * scale).collect();
            crate::Energy::of(&cloth, &scaled, 0.0).stretch
        };
        // Edges of 30 mm in steps of 1e-7 of their lengths, which change by a tenth.
        let share = energy(0.9) / energy(1.1);
        assert_relative_eq!(share, f64::from(fabric.compression), max_relative = 1e-4);
    }

    #[test]
    fn a_pattern_of_the_same_lengths_makes_the_same_cloth() {
        let mesh = grid(8, 6, [0.4, 0.3]);
        let fabric = Fabric::silk();
        let flat = |face: &[u32; 3]| {
            face.map(|vertex| {
                let position = mesh.positions()[vertex as usize];
                [position.x, position.y]
            })
        };
        let rest = RestShape::Flat {
            corners: mesh.faces().iter().map(flat).collect(),
            shrink: Vec::new(),
            grip: 0.0,
        };
        let cut = Cloth::new(mesh.faces(), mesh.num_vertices(), &rest, &fabric).unwrap();
        let worn = flat_cloth([0.4, 0.3], &fabric);
        for (cut, worn) in cut.springs().iter().zip(worn.springs()) {
            assert_relative_eq!(cut.rest_length, worn.rest_length, max_relative = ROUNDING);
            assert_relative_eq!(cut.stiffness, worn.stiffness, max_relative = 1e-4);
        }
    }

    #[test]
    fn shrinking_shortens_edges_and_keeps_the_mass() {
        let mesh = grid(2, 2, [1.0, 1.0]);
        let corners = |face: &[u32; 3]| {
            face.map(|vertex| {
                let position = mesh.positions()[vertex as usize];
                [position.x, position.y]
            })
        };
        let rest = RestShape::Flat {
            corners: mesh.faces().iter().map(corners).collect(),
            shrink: vec![0.9; mesh.num_faces()],
            grip: 0.0,
        };
        let fabric = Fabric::knit();
        let cloth = Cloth::new(mesh.faces(), mesh.num_vertices(), &rest, &fabric).unwrap();
        assert_relative_eq!(
            cloth.springs()[0].rest_length,
            0.45,
            max_relative = ROUNDING
        );
        let mass: f32 = cloth.masses().iter().sum();
        assert_relative_eq!(mass, fabric.density, max_relative = ROUNDING);
    }

    #[test]
    fn meshes_that_no_cloth_can_be_are_refused() {
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.5, 0.2]];
        let positions = corners.map(|[x, y]| crate::Point3::new(x, y, 0.0)).to_vec();
        let make = |faces: &[[u32; 3]]| {
            let rest = RestShape::Worn(positions.clone());
            Cloth::new(faces, positions.len(), &rest, &Fabric::silk()).unwrap_err()
        };
        let three = make(&[[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
        assert!(matches!(
            three,
            SimError::NonManifoldEdge { num_faces: 3, .. }
        ));
        let turned = make(&[[0, 1, 2], [1, 2, 3]]);
        assert!(matches!(
            turned,
            SimError::InvertedFace { faces: [0, 1], .. }
        ));
        assert!(matches!(
            make(&[[0, 1, 1]]),
            SimError::NoArea { face: 0, .. }
        ));
        assert!(matches!(make(&[]), SimError::Garment(MeshError::NoFaces)));
        assert!(matches!(make(&[[0, 1, 9]]), SimError::Garment(_)));
    }

    #[test]
    fn a_pattern_folded_over_itself_is_refused() {
        let rest = RestShape::Flat {
            corners: vec![
                [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]],
                [[1.0, 0.0], [0.0, 0.0], [0.2, 0.9]],
            ],
            shrink: Vec::new(),
            grip: 0.0,
        };
        let error = Cloth::new(&[[0, 1, 2], [1, 0, 3]], 4, &rest, &Fabric::silk()).unwrap_err();
        assert_eq!(error, SimError::FoldedPattern { faces: [0, 1] });
    }
}
