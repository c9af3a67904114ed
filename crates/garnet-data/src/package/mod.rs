//! Garment packages: a folder with a template, the body that it lies on, and trained variants.

mod before;
mod manifest;

use std::path::{Path, PathBuf};

use garnet_mesh::{Fingerprint, ObjFile, RestEdge, TriMesh, write_atomically};
use garnet_sim::{Cloth, RestShape};
use garnet_skin::{Body, Rig, read_rig, write_rig_npz};

pub use manifest::{
    Manifest, PACKAGE_SCHEMA, StoredFabric, StoredPattern, StoredRestBody, Variant,
};

use crate::rest_file;
use crate::{DataError, ReadAs, StoredParameters};
use before::Before;

/// Name of the manifest in a package.
pub const MANIFEST_FILE: &str = "garment.toml";

const TEMPLATE_FILE: &str = "template.obj";
const BODY_FILE: &str = "body.rig.npz";
const REST_FILE: &str = "template.rest.safetensors";

/// A garment that lies on a body at rest, and all that a simulation or a network needs to know of it.
///
/// In a folder it is `garment.toml`, `template.obj`, `body.rig.npz`, and for garments with a sewing
/// pattern `template.rest.safetensors`: the flat pattern and where it is shrunk.
#[derive(Debug, Clone)]
pub struct GarmentPackage {
    /// What the package says of itself.
    pub manifest: Manifest,
    /// The template as text, with groups and the flat pattern as UVs.
    pub template: ObjFile,
    /// The template's triangles.
    pub mesh: TriMesh,
    /// Lengths at rest.
    pub rest: RestShape,
    /// The body that the template lies on.
    pub body: Body,
}

/// What a package is made of.
#[derive(Debug)]
pub struct PackageParts {
    /// Name of the garment.
    pub name: String,
    /// The template as text.
    pub template: ObjFile,
    /// Lengths at rest.
    pub rest: RestShape,
    /// The fabric.
    pub fabric: StoredFabric,
    /// The sewing pattern, if there is one.
    pub pattern: Option<StoredPattern>,
    /// The body that the template lies on.
    pub body: Body,
    /// Its parameters, if it is a built-in one.
    pub parameters: Option<StoredParameters>,
}

impl GarmentPackage {
    /// Makes a package of its parts.
    ///
    /// # Errors
    ///
    /// [`DataError::Mesh`] if the template has no triangles.
    pub fn new(parts: PackageParts) -> Result<Self, DataError> {
        let mesh = parts.template.mesh()?;
        let manifest = Manifest {
            schema: PACKAGE_SCHEMA.to_owned(),
            name: parts.name,
            fingerprint: Fingerprint::of_topology(&mesh).to_string(),
            positions: Fingerprint::of_positions(mesh.positions()).to_string(),
            fabric: parts.fabric,
            pattern: parts.pattern,
            rest_body: StoredRestBody {
                rig: BODY_FILE.to_owned(),
                parameters: parts.parameters,
            },
            variants: Vec::new(),
        };
        Ok(Self {
            manifest,
            template: parts.template,
            mesh,
            rest: parts.rest,
            body: parts.body,
        })
    }

    /// The edges of the template and their lengths in its pattern, in metres, without those of ribs and waistbands; none without a pattern.
    ///
    /// On the body at rest edges are shorter where the cloth is pushed together, and longer where it hangs.
    ///
    /// # Errors
    ///
    /// [`DataError::Sim`] if the rest shape or the fabric of the package is none of cloth.
    pub fn flat_edges(&self) -> Result<Option<Vec<RestEdge>>, DataError> {
        if !matches!(self.rest, RestShape::Flat { .. }) {
            return Ok(None);
        }
        let fabric = self.manifest.fabric.fabric();
        let mesh = &self.mesh;
        let cloth = Cloth::new(mesh.faces(), mesh.num_vertices(), &self.rest, &fabric)?;
        let edges = cloth.springs().iter().zip(cloth.is_shrunk());
        let edges = edges.filter(|&(_, &is_shrunk)| !is_shrunk);
        let edges = edges.map(|(spring, _)| (spring.vertices, spring.rest_length));
        Ok(Some(edges.collect()))
    }

    /// Whether a path is a package: a folder with a manifest.
    pub fn is_at(path: &Path) -> bool {
        path.join(MANIFEST_FILE).is_file()
    }

    /// Where the template of a package is.
    pub fn template_at(folder: &Path) -> PathBuf {
        folder.join(TEMPLATE_FILE)
    }

    /// Reads a package.
    ///
    /// # Errors
    ///
    /// [`DataError`] that names the file: one is missing, damaged, of another version, or does not
    /// belong to the template.
    pub fn read(folder: &Path) -> Result<Self, DataError> {
        let manifest = Self::read_manifest(folder)?;
        let template = ObjFile::read(folder.join(TEMPLATE_FILE))?;
        let mesh = template.mesh()?;
        manifest.check_template(&folder.join(TEMPLATE_FILE), &mesh)?;
        let rest = match &manifest.pattern {
            Some(_) => rest_file::read(&folder.join(REST_FILE), mesh.num_faces())?,
            None => RestShape::Worn(mesh.positions().to_vec()),
        };
        let body = read_rig(folder.join(&manifest.rest_body.rig))?.into_body()?;
        Ok(Self {
            manifest,
            template,
            mesh,
            rest,
            body,
        })
    }

    /// Reads what the simulation of a package asks for besides its template, which has been read already: the fabric
    /// and the rest shape of a mesh of the template's topology.
    ///
    /// # Errors
    ///
    /// As [`GarmentPackage::read`].
    pub fn read_cloth(
        folder: &Path,
        mesh: &TriMesh,
    ) -> Result<(StoredFabric, RestShape), DataError> {
        let manifest = Self::read_manifest(folder)?;
        let is_template = Fingerprint::of_topology(mesh).to_string() == manifest.fingerprint;
        if is_template && manifest.pattern.is_some() {
            let rest = rest_file::read(&folder.join(REST_FILE), mesh.num_faces())?;
            return Ok((manifest.fabric, rest));
        }
        let package = Self::read(folder)?;
        Ok((package.manifest.fabric, package.rest))
    }

    /// Reads `garment.toml` alone.
    ///
    /// # Errors
    ///
    /// [`DataError::Read`], [`DataError::Text`] with the line, [`DataError::Foreign`] for another version, or
    /// [`DataError::Fabric`].
    pub fn read_manifest(folder: &Path) -> Result<Manifest, DataError> {
        let path = folder.join(MANIFEST_FILE);
        let text =
            std::fs::read_to_string(&path).map_err(|source| DataError::read(&path, source))?;
        let manifest: Manifest = toml::from_str(&text).map_err(|source| DataError::Text {
            path: path.clone(),
            reason: source.to_string(),
        })?;
        if manifest.schema != PACKAGE_SCHEMA {
            let what = format!(
                "its schema is `{}`, not `{PACKAGE_SCHEMA}`",
                manifest.schema
            );
            return Err(DataError::foreign(&path, ReadAs::Package, what));
        }
        let checked = manifest.fabric.fabric().check();
        checked.map_err(|source| DataError::Fabric { path, source })?;
        Ok(manifest)
    }

    /// The files that [`GarmentPackage::write`] may write.
    pub const fn file_names() -> [&'static str; 4] {
        [TEMPLATE_FILE, BODY_FILE, REST_FILE, MANIFEST_FILE]
    }

    /// Writes the package into a folder that is there; the manifest last, so that a folder with a
    /// manifest is whole. After an error the folder holds the files that it held before.
    ///
    /// # Errors
    ///
    /// [`DataError::Write`] or [`DataError::WriteRig`]; [`DataError::Read`] for a file that is there and cannot be read.
    pub fn write(&self, folder: &Path) -> Result<Vec<PathBuf>, DataError> {
        let before = Before::of(Self::file_names().map(|name| folder.join(name)))?;
        let written = self.write_files(folder);
        if written.is_err() {
            before.restore();
        }
        written
    }

    fn write_files(&self, folder: &Path) -> Result<Vec<PathBuf>, DataError> {
        let path = |name: &str| folder.join(name);
        let source = self.template.source();
        write_atomically(path(TEMPLATE_FILE), |writer| writer.write_all(source))?;
        write_rig_npz(path(BODY_FILE), &Rig::from(self.body.clone()))?;
        let mut written = vec![path(TEMPLATE_FILE), path(BODY_FILE)];
        let rest = path(REST_FILE);
        if rest_file::write(&rest, &self.rest)? {
            written.push(rest);
        } else if rest.exists() {
            // That of a pattern which was here before.
            std::fs::remove_file(&rest).map_err(|source| DataError::folder(&rest, source))?;
        }
        written.push(Self::write_manifest(folder, &self.manifest)?);
        Ok(written)
    }

    /// Writes `garment.toml` alone, and returns where it is.
    ///
    /// # Errors
    ///
    /// [`DataError::Write`].
    pub fn write_manifest(folder: &Path, manifest: &Manifest) -> Result<PathBuf, DataError> {
        let path = folder.join(MANIFEST_FILE);
        let text = toml::to_string(manifest).map_err(|source| DataError::Text {
            path: path.clone(),
            reason: source.to_string(),
        })?;
        write_atomically(&path, |writer| writer.write_all(text.as_bytes()))?;
        Ok(path)
    }
}
