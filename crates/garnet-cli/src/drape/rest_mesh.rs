//! The mesh of the rest body, and units and axes of the files of a body.

use std::path::{Path, PathBuf};

use anyhow::Context;
use garnet::{Kinship, KnownMesh, Point3, Rig, TriMesh, io::ObjFile, kinship};

use super::{
    args::SourceFiles,
    files::BodyFile,
    frame::{Frame, detected_unit, detected_up, shorter},
};
use crate::failure::refused;

/// The mesh of the rest body, in the unit of its file.
#[derive(Debug)]
pub(crate) struct RestMesh {
    pub(crate) mesh: TriMesh,
    pub(crate) path: PathBuf,
    pub(crate) is_obj: bool,
}

/// Units and axes of the files of a body.
#[derive(Debug)]
pub(crate) struct Frames {
    /// Of the OBJ files.
    pub(crate) obj: Frame,
    /// Of the rest mesh.
    pub(crate) rest: Frame,
    /// Of the rig.
    pub(crate) rig: Frame,
    /// Of each body.
    pub(crate) bodies: Vec<Frame>,
}

impl RestMesh {
    pub(crate) fn taken(
        obj: Option<&ObjFile>,
        rig: &Rig,
        rig_path: &Path,
        source: &SourceFiles,
    ) -> anyhow::Result<Self> {
        // With a rest mesh in the rig, an unposed BODY is compared with it and not needed.
        let is_needed = source.rest_body.is_some() || rig.rest.is_none();
        match (obj.filter(|_| is_needed), &rig.rest) {
            (Some(file), _) => Ok(Self {
                mesh: mesh_of(file)?,
                path: file.path().to_path_buf(),
                is_obj: true,
            }),
            (None, Some(mesh)) => Ok(Self {
                mesh: mesh.clone(),
                path: rig_path.to_path_buf(),
                is_obj: false,
            }),
            (None, None) => Err(refused(
                "there is no rest body",
                format!(
                    "`{}` holds a skeleton and weights alone",
                    rig_path.display()
                ),
                "give the body on which the garment lies with `--rest-body OBJ`",
            )),
        }
    }

    pub(crate) fn frames(
        &self,
        bodies: &[BodyFile],
        source: &SourceFiles,
    ) -> anyhow::Result<Frames> {
        let mut decades = Vec::with_capacity(bodies.len());
        for body in bodies {
            decades.push(self.decades(&body.path, &body.positions)?);
        }
        let first = decades.first().copied().unwrap_or_default();
        let detected = detected_unit(&self.mesh);
        let unit = match (source.units.body, self.is_obj) {
            (None, _) => detected,
            (Some(unit), true) => unit,
            (Some(unit), false) => shorter(unit, -first).unwrap_or(unit),
        };
        let up = detected_up(&self.mesh);
        let obj_up = source.up.unwrap_or(up);
        let rest = Frame {
            unit,
            up: if self.is_obj { obj_up } else { up },
        };
        let of_bodies = bodies.iter().zip(decades).map(|(body, decades)| {
            let unit = shorter(unit, decades).ok_or_else(|| {
                refused(
                    format!(
                        "`{}` is not of the size of the rest body",
                        body.path.display()
                    ),
                    format!("its edges are 10^{decades} times as long"),
                    "export both in the same unit, or name it with `--units`",
                )
            })?;
            Ok(Frame { unit, up: obj_up })
        });
        let of_bodies = of_bodies.collect::<anyhow::Result<Vec<Frame>>>()?;
        let obj_unit = match (self.is_obj, of_bodies.first()) {
            (false, Some(body)) => body.unit,
            _ => unit,
        };
        Ok(Frames {
            obj: Frame {
                unit: obj_unit,
                up: obj_up,
            },
            rig: rest,
            rest,
            bodies: of_bodies,
        })
    }

    /// How much longer the edges of another mesh of this topology are, as a power of ten.
    fn decades(&self, path: &Path, positions: &[Point3]) -> anyhow::Result<i32> {
        let (found, expected) = (positions.len(), self.mesh.num_vertices());
        if found != expected {
            return Err(other_topology(
                path,
                format!(
                    "it has {found} vertices, the rest body `{}` has {expected}",
                    self.path.display()
                ),
            ));
        }
        match kinship(self.mesh.positions(), positions, self.mesh.faces()) {
            Kinship::Scaled { decades } => Ok(decades),
            Kinship::Stranger => Err(other_topology(
                path,
                format!(
                    "its vertices are in another order than those of the rest body `{}`",
                    self.path.display()
                ),
            )),
        }
    }
}

pub(crate) fn other_topology(path: &Path, cause: String) -> anyhow::Error {
    refused(
        format!(
            "`{}` has another topology than the rest body",
            path.display()
        ),
        cause,
        "export the posed body from the same mesh, with the order of its vertices kept; or give its \
         own `--rig` and `--rest-body`, or the rest body itself with `--pose`",
    )
}

/// Refuses a target that is not the rest body in another pose and shape, whose vertices are at `positions`, in metres,
/// and whose polygons have `edges`.
pub(crate) fn check_target(
    path: &Path,
    positions: &[Point3],
    edges: &[[u32; 2]],
    rest: &KnownMesh<'_>,
) -> anyhow::Result<()> {
    let checked = rest.check(positions, edges).map(|_| ());
    checked.map_err(|difference| other_topology(path, difference.told("the rest body")))
}

pub(crate) fn mesh_of(file: &ObjFile) -> anyhow::Result<TriMesh> {
    file.mesh()
        .with_context(|| format!("cannot read `{}`", file.path().display()))
}
