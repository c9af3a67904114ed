//! Garment packages: a folder with a template, the body that it lies on, and trained variants.

mod before;
mod error;
mod manifest;
mod rest_file;
mod sizes_file;
mod stored_parameters;
mod together;

use std::path::{Path, PathBuf};

use garnet_io::{ObjFile, read_rig, rig_npz};
use garnet_mesh::{Fingerprint, RestEdge, StagedFile, TriMesh, read_text};
use garnet_sim::{Cloth, RestShape};
use garnet_skin::{Body, Rig};

pub use error::{PackageError, toml_problem};
pub use manifest::{
    Manifest, PACKAGE_SCHEMA, StoredCost, StoredFabric, StoredPattern, StoredRestBody, Variant,
};

pub use stored_parameters::StoredParameters;

use crate::FileLock;
use before::Before;
use together::Together;

/// Name of the manifest in a package.
pub const MANIFEST_FILE: &str = "garment.toml";

/// The largest manifest that is read, in bytes: a thousand variants have 300 kB.
const MOST_TEXT: u64 = 1 << 24;

const TEMPLATE_FILE: &str = "template.obj";
const BODY_FILE: &str = "body.rig.npz";
const REST_FILE: &str = "template.rest.safetensors";

/// What a run has that writes a package.
const PACKAGE_LOCK: &str = "package.lock";

/// How the name of the file ends that a run has which trains a variant.
const TRAINING_LOCK: &str = ".training.lock";

/// What a run has for the moment in which it changes the manifest.
const MANIFEST_LOCK: &str = "garment.toml.lock";

/// A garment that lies on a body at rest, and all that a simulation or a network needs to know of
/// it.
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
    /// [`PackageError::Mesh`] if the template has no triangles.
    pub fn new(parts: PackageParts) -> Result<Self, PackageError> {
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
                checksum: None,
                parameters: parts.parameters,
            },
            cost: None,
            poses: None,
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

    /// The edges of the template and their lengths in its pattern, in metres, without those of ribs
    /// and waistbands; none without a pattern.
    ///
    /// On the body at rest edges are shorter where the cloth is pushed together, and longer where
    /// it hangs.
    ///
    /// # Errors
    ///
    /// [`PackageError::Sim`] if the rest shape or the fabric of the package is none of cloth.
    pub fn flat_edges(&self) -> Result<Option<Vec<RestEdge>>, PackageError> {
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

    /// Reads a package from its folder.
    ///
    /// # Errors
    ///
    /// [`PackageError`] that names the file: one is missing, damaged, of another version, or does
    /// not belong to the template.
    pub fn read(folder: &Path) -> Result<Self, PackageError> {
        let manifest = Self::read_manifest(folder)?;
        let template = ObjFile::read_regular(folder.join(TEMPLATE_FILE))?;
        let mesh = template.mesh()?;
        manifest.check_template(&folder.join(TEMPLATE_FILE), &mesh)?;
        let rest = match &manifest.pattern {
            Some(_) => rest_file::read(&folder.join(REST_FILE), mesh.num_faces())?,
            None => RestShape::Worn(mesh.positions().to_vec()),
        };
        manifest.check_rig(folder)?;
        let body = read_rig(folder.join(&manifest.rest_body.rig))?.into_body()?;
        Ok(Self {
            manifest,
            template,
            mesh,
            rest,
            body,
        })
    }

    /// Reads what the simulation of a package asks for besides its template, which has been read
    /// already: the fabric and the rest shape of a mesh of the template's topology.
    ///
    /// # Errors
    ///
    /// As [`GarmentPackage::read`].
    pub fn read_cloth(
        folder: &Path,
        mesh: &TriMesh,
    ) -> Result<(StoredFabric, RestShape), PackageError> {
        let manifest = Self::read_manifest(folder)?;
        let is_template = Fingerprint::of_topology(mesh).to_string() == manifest.fingerprint;
        if is_template && manifest.pattern.is_some() {
            let rest = rest_file::read(&folder.join(REST_FILE), mesh.num_faces())?;
            return Ok((manifest.fabric, rest));
        }
        let package = Self::read(folder)?;
        Ok((package.manifest.fabric, package.rest))
    }

    /// Reads `garment.toml` of a package alone.
    ///
    /// # Errors
    ///
    /// [`PackageError::Read`], [`PackageError::Text`] with the line, [`PackageError::Foreign`] for
    /// another version, or [`PackageError::Fabric`].
    pub fn read_manifest(folder: &Path) -> Result<Manifest, PackageError> {
        let path = folder.join(MANIFEST_FILE);
        let text = read_text(&path, MOST_TEXT);
        let text = text.map_err(|source| PackageError::read(&path, source))?;
        let manifest: Manifest =
            toml::from_str(&text).map_err(|source| PackageError::toml(&path, &text, &source))?;
        if manifest.schema != PACKAGE_SCHEMA {
            let what = format!(
                "its schema is `{}`, not `{PACKAGE_SCHEMA}`",
                manifest.schema
            );
            return Err(PackageError::foreign(&path, what));
        }
        if let Some(name) = manifest.outside() {
            let what = format!("it names `{name}`, which is outside of the package");
            return Err(PackageError::foreign(&path, what));
        }
        manifest.check_numbers(&path)?;
        let checked = manifest.fabric.fabric().check();
        checked.map_err(|source| PackageError::Fabric { path, source })?;
        Ok(manifest)
    }

    /// The files that [`GarmentPackage::write`] may write.
    pub const fn file_names() -> [&'static str; 4] {
        [TEMPLATE_FILE, BODY_FILE, REST_FILE, MANIFEST_FILE]
    }

    /// Refuses a folder in which another run writes or trains.
    ///
    /// # Errors
    ///
    /// [`PackageError::InUse`] with the process, [`PackageError::Read`] or
    /// [`PackageError::Folder`].
    pub fn check_unused(folder: &Path) -> Result<(), PackageError> {
        Self::locked(folder).map(drop)
    }

    /// Takes a folder to write a package into, if it is there.
    fn locked(folder: &Path) -> Result<Option<FileLock>, PackageError> {
        if !folder.is_dir() {
            return Ok(None);
        }
        let lock = FileLock::take(&folder.join(PACKAGE_LOCK), folder)?;
        let failed = |source| PackageError::read(folder, source);
        for entry in std::fs::read_dir(folder).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            if path.to_string_lossy().ends_with(TRAINING_LOCK) {
                FileLock::check(&path, folder)?;
            }
        }
        Ok(Some(lock))
    }

    /// Takes the variant of a package for a training, until the value is dropped.
    ///
    /// # Errors
    ///
    /// [`PackageError::InUse`] with `what`, the folder of the training, while another run trains
    /// that variant, or with `folder` while one writes the package; [`PackageError::Folder`].
    pub fn lock_variant(folder: &Path, name: &str, what: &Path) -> Result<FileLock, PackageError> {
        let lock = FileLock::take(&folder.join(format!("{name}{TRAINING_LOCK}")), what)?;
        FileLock::check(&folder.join(PACKAGE_LOCK), folder)?;
        Ok(lock)
    }

    /// Changes the manifest of a package, and returns it; other runs that do so at the same time
    /// wait for each other.
    ///
    /// # Errors
    ///
    /// As [`GarmentPackage::read_manifest`] and [`GarmentPackage::write_manifest`], or
    /// [`PackageError::InUse`].
    pub fn change_manifest(
        folder: &Path,
        change: impl FnOnce(&mut Manifest),
    ) -> Result<Manifest, PackageError> {
        let _lock = FileLock::wait(&folder.join(MANIFEST_LOCK), folder)?;
        let mut manifest = Self::read_manifest(folder)?;
        change(&mut manifest);
        Self::write_manifest(folder, &manifest)?;
        Ok(manifest)
    }

    /// Writes the package into a folder that is there.
    ///
    /// All files are written under temporary names first. Then an older manifest is removed, the
    /// files come to their places one after the other, and the new manifest last. A process that is
    /// killed meanwhile leaves the package that was there, or the new one, or, for as long as a few
    /// renames take, a folder without manifest, which nothing takes for a package, with files of
    /// both; and beside them temporary files, which
    /// [`remove_stale_temporaries`](garnet_mesh::remove_stale_temporaries) knows. After an error
    /// the folder holds the files that it held before.
    ///
    /// # Errors
    ///
    /// [`PackageError::Write`] or [`PackageError::WriteRig`]; [`PackageError::Read`] for a file
    /// that is there and cannot be read; [`PackageError::InUse`] while another run writes or trains
    /// there.
    pub fn write(&self, folder: &Path) -> Result<Vec<PathBuf>, PackageError> {
        let _lock = Self::locked(folder)?;
        let before = Before::of(Self::file_names().map(|name| folder.join(name)))?;
        let written = self.staged(folder)?.put();
        if written.is_err() {
            before.restore();
        }
        written
    }

    /// All files of the package under temporary names.
    fn staged(&self, folder: &Path) -> Result<Together, PackageError> {
        let path = |name: &str| folder.join(name);
        let (template, body, rest) = (path(TEMPLATE_FILE), path(BODY_FILE), path(REST_FILE));
        let source = self.template.source();
        let of_template = StagedFile::new(&template, |writer| writer.write_all(source))?;
        let rig = rig_npz(&body, &Rig::from(self.body.clone()))?;
        let of_body = StagedFile::new(&body, |writer| writer.write_all(&rig))?;
        let mut manifest = self.manifest.clone();
        manifest.rest_body.checksum = Some(Fingerprint::of_bytes(&rig).to_string());
        let mut parts = vec![(template, of_template), (body, of_body)];
        let mut surplus = None;
        match rest_file::stage(&rest, &self.rest)? {
            Some(of_rest) => parts.push((rest, of_rest)),
            // That of a pattern which was here before.
            None => surplus = Some(rest),
        }
        Ok(Together {
            parts,
            surplus,
            manifest: Self::staged_manifest(folder, &manifest)?,
        })
    }

    /// Writes `garment.toml` alone, and returns where it is.
    ///
    /// # Errors
    ///
    /// [`PackageError::Write`].
    pub fn write_manifest(folder: &Path, manifest: &Manifest) -> Result<PathBuf, PackageError> {
        let (path, staged) = Self::staged_manifest(folder, manifest)?;
        staged.put()?;
        Ok(path)
    }

    /// Where `garment.toml` belongs, and the file under a temporary name.
    fn staged_manifest(
        folder: &Path,
        manifest: &Manifest,
    ) -> Result<(PathBuf, StagedFile), PackageError> {
        let path = folder.join(MANIFEST_FILE);
        let text = toml::to_string(manifest).map_err(|source| PackageError::Text {
            path: path.clone(),
            reason: source.to_string(),
        })?;
        let staged = StagedFile::new(&path, |writer| writer.write_all(text.as_bytes()))?;
        Ok((path, staged))
    }
}
