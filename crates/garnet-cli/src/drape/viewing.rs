//! The page that shows the drapes.

use std::path::{Path, PathBuf};

use garnet::{Drape, Point3, PosedBody, io::Target};
use garnet_view::Coloring;

use super::{Bound, args::Source, ready::package_of, sink::fps_of};
use crate::{
    console::Console,
    render::{
        colors::{Scale, distances, mean_stretches},
        problems::problems,
    },
    view::Drapes,
};

/// What is shown of all drapes so far.
pub(super) struct Viewing {
    path: PathBuf,
    cloth: Vec<Vec<Point3>>,
    skin: Vec<Vec<Point3>>,
    /// Of each drape, in percent.
    stretches: Vec<Vec<f32>>,
    /// Of each drape, in millimetres.
    distances: Vec<Vec<f32>>,
    /// Of each drape.
    problems: Vec<Vec<f32>>,
    names: Vec<String>,
}

impl Viewing {
    pub(super) fn new(path: &Path) -> Self {
        Self {
            path: path.to_path_buf(),
            cloth: Vec::new(),
            skin: Vec::new(),
            stretches: Vec::new(),
            distances: Vec::new(),
            problems: Vec::new(),
            names: Vec::new(),
        }
    }

    pub(super) fn see(
        &mut self,
        bound: &Bound,
        target: &Target,
        drape: &Drape,
        body: &PosedBody,
    ) -> anyhow::Result<()> {
        let rest = bound.rest_positions();
        let stretches = mean_stretches(&bound.edges, rest, &drape.positions);
        self.stretches.push(stretches);
        self.distances
            .push(distances(&drape.positions, body.skin(), 1e3));
        let faces = bound.garment.mesh().faces();
        self.problems
            .push(problems(&drape.positions, faces, body.skin())?);
        self.cloth.push(drape.positions.clone());
        self.skin.push(body.skin().positions().to_vec());
        let stem = target.path.file_stem().unwrap_or_default();
        let name = target.stem.clone();
        self.names
            .push(name.unwrap_or_else(|| stem.to_string_lossy().into_owned()));
        Ok(())
    }

    /// Writes the page.
    pub(super) fn finish(
        self,
        bound: &Bound,
        source: &Source,
        console: &Console,
    ) -> anyhow::Result<()> {
        let coloring = |scale: Scale, values: Vec<Vec<f32>>| Coloring {
            label: scale.label,
            map: scale.map,
            range: scale.range,
            values,
        };
        let of_file = bound.rest.file.as_ref().map(garnet::io::ObjFile::triangles);
        let body = match &of_file {
            Some(faces) => faces,
            // Without the faces that close holes of the skin.
            None => bound.garment.body().rest().faces(),
        };
        // A package is called by its folder, of which the template says nothing.
        let named = package_of(source).and_then(Path::file_name);
        let stem = bound.garment_file.path().file_stem();
        let stem = named.or(stem).unwrap_or_default();
        let drapes = Drapes {
            name: stem.to_string_lossy().into_owned(),
            garment: bound.garment.mesh().faces(),
            body,
            cloth: self.cloth,
            skin: self.skin,
            colorings: vec![
                coloring(Scale::stretch(), self.stretches),
                coloring(Scale::distance(), self.distances),
                coloring(Scale::problems(), self.problems),
            ],
            frames: self.names,
            fps: fps_of(bound),
        };
        drapes.write(&self.path, console)
    }
}
