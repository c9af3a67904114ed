//! Coarse simulations that guide networks.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use garnet_knn::Surface;
use garnet_mesh::{Fingerprint, ObjFile, Point3, TriMesh, write_atomically};
use garnet_sim::RestShape;
use garnet_skin::{Body, Garment, PosedBody, Vector3, Warp, WarpedGarment};

use crate::package::StoredFabric;
use crate::rest_file;
use crate::wearer::wearer_of;
use crate::{BodyPath, DataError, GarmentPackage, Tailor, Teacher};

const TEMPLATE_FILE: &str = "guide.obj";
const REST_FILE: &str = "guide.rest.safetensors";

/// A garment of a package with few vertices, whose quick simulation tells about where the cloth is when a body comes
/// to its pose.
///
/// What is left to tell, learned models learn with a tenth of the scenes: how far a coarse simulation is from a
/// fine one depends on the pose much less than the cloth itself (compare *Kavan et al. 2011, Physics-inspired
/// upsampling for cloth simulation in games*).
#[derive(Debug, Clone)]
pub struct Guide {
    template: ObjFile,
    rest: RestShape,
    fingerprint: Fingerprint,
    teacher: Teacher,
    body: Body,
    /// For each vertex of the garment the triangle of the coarse one that it lies on, and the weights of its corners.
    places: Vec<([u32; 3], [f32; 3])>,
}

impl Guide {
    /// Cuts the garment of a package again, with about `num_vertices` vertices, and puts it on the body of the package.
    ///
    /// # Errors
    ///
    /// [`DataError::Unguided`] for packages without a sewing pattern or built-in body; those of [`Tailor::dress`].
    pub fn cut(package: &GarmentPackage, num_vertices: usize) -> Result<Self, DataError> {
        let no = |reason| DataError::Unguided { reason };
        let tailor = Tailor::of_package(package)?;
        let tailor = tailor.ok_or_else(|| no("it was not made from a sewing pattern"))?;
        let wearer = wearer_of(&package.body);
        let wearer = wearer.ok_or_else(|| no("it does not lie on a built-in body"))??;
        let tailor = tailor.with_vertices(num_vertices)?;
        let worn = tailor.dress(&package.body, &wearer, &AtomicBool::new(false))?;
        let name = package.manifest.name.clone();
        let coarse = tailor.package(name, &worn, package.body.clone(), None)?;
        let fabric = &package.manifest.fabric;
        Self::new(
            coarse.template,
            coarse.rest,
            fabric,
            &package.body,
            &package.mesh,
        )
    }

    /// Reads the guide of a package, for the `garment` on `body` that the package has.
    ///
    /// # Errors
    ///
    /// [`DataError`] that names the file: it is missing, damaged, or no cloth.
    pub fn read(folder: &Path, garment: &TriMesh, body: &Body) -> Result<Self, DataError> {
        let template = ObjFile::read(folder.join(TEMPLATE_FILE))?;
        let rest = rest_file::read(&folder.join(REST_FILE), template.mesh()?.num_faces())?;
        let fabric = GarmentPackage::read_manifest(folder)?.fabric;
        Self::new(template, rest, &fabric, body, garment)
    }

    /// Writes it into the folder of its package.
    ///
    /// # Errors
    ///
    /// [`DataError::Write`].
    pub fn write(&self, folder: &Path) -> Result<(), DataError> {
        rest_file::write(&folder.join(REST_FILE), &self.rest)?;
        let source = self.template.source();
        write_atomically(folder.join(TEMPLATE_FILE), |writer| {
            writer.write_all(source)
        })?;
        Ok(())
    }

    fn new(
        template: ObjFile,
        rest: RestShape,
        fabric: &StoredFabric,
        body: &Body,
        garment: &TriMesh,
    ) -> Result<Self, DataError> {
        let mesh = template.mesh()?;
        let surface = Surface::new(&mesh);
        let found = surface.closest_all(garment.positions());
        let places = found.iter();
        let places = places.map(|found| (mesh.faces()[found.face as usize], found.barycentric));
        let bound = Garment::new(mesh.clone()).bind(body)?;
        Ok(Self {
            fingerprint: Fingerprint::of_positions(mesh.positions()),
            teacher: Teacher::of_garment(bound, body, &rest, &fabric.fabric())?,
            body: body.clone(),
            places: places.collect(),
            template,
            rest,
        })
    }

    /// Fingerprint of its vertices at rest: networks are trained with one guide.
    pub fn fingerprint(&self) -> Fingerprint {
        self.fingerprint
    }

    /// Refuses a guide in a folder that is not the one that a network was trained with.
    ///
    /// # Errors
    ///
    /// [`DataError::Foreign`].
    pub fn check(&self, folder: &Path, expected: Fingerprint) -> Result<(), DataError> {
        if self.fingerprint == expected {
            return Ok(());
        }
        let found = self.fingerprint;
        let what = format!("the network was trained with {expected}, its fingerprint is {found}");
        Err(DataError::foreign(&folder.join(TEMPLATE_FILE), what))
    }

    /// How many vertices are simulated.
    pub fn num_simulated(&self) -> usize {
        self.teacher.num_simulated()
    }

    /// How far from the warp by pose and shape the vertices of the garment are, about, when the body comes to its place, in the
    /// skinning frames `[vertex]`, in metres.
    ///
    /// # Errors
    ///
    /// [`DataError::Stopped`], [`DataError::Sim`] if the cloth flies apart, [`DataError::Skin`] for a body of
    /// another topology.
    pub fn offsets(&self, posed: &PosedBody, stop: &AtomicBool) -> Result<Vec<Vector3>, DataError> {
        let path = BodyPath::to_posed(&self.body, posed);
        let arrived = self.teacher.sketched(&path, stop)?;
        let garment = self.teacher.garment();
        let warped = WarpedGarment::new(garment, &self.body, posed, Warp::Shape)?;
        let offset = |((from, to), turn): ((&Point3, &Point3), &nalgebra::UnitQuaternion<f32>)| {
            turn.inverse() * (to - from)
        };
        let pairs = warped.positions.iter().zip(&arrived);
        let offsets: Vec<Vector3> = pairs.zip(&warped.rotations).map(offset).collect();
        let at = |(corners, weights): &([u32; 3], [f32; 3])| {
            let corners = corners.iter().zip(weights);
            corners.fold(Vector3::zeros(), |sum, (&corner, &weight)| {
                sum + weight * offsets[corner as usize]
            })
        };
        Ok(self.places.iter().map(at).collect())
    }
}
