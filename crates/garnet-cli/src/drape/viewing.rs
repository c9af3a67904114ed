//! The page that shows the drapes.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use garnet::{Drape, Point3, PosedBody, io::Target};
use garnet_view::Coloring;

use super::{Bound, args::Source, fit::Fitting, ready::package_of, sink::fps_of};
use crate::{
    console::Console,
    render::{
        colors::{Scale, distances, mean_stretches},
        problems::problems,
    },
    view::{Drapes, write_drapes},
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
    /// How the garment fits, of each drape; empty where that is not known.
    fits: Vec<Arc<Vec<f32>>>,
    /// That of the body that the garment lies on, once it was found.
    own_fit: Option<Arc<Vec<f32>>>,
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
            fits: Vec::new(),
            own_fit: None,
            names: Vec::new(),
        }
    }

    pub(super) fn see(
        &mut self,
        (bound, target): (&Bound, &Target),
        fitting: Option<&Fitting>,
        drape: &Drape,
        body: &PosedBody,
    ) -> anyhow::Result<()> {
        // Frames of one wearer fit alike.
        let is_own = body.shape_offsets().is_none();
        let known = self.own_fit.clone().filter(|_| is_own);
        let fit = known.unwrap_or_else(|| {
            let levels = fitting.and_then(|it| it.levels((bound, target), body));
            Arc::new(levels.unwrap_or_default())
        });
        if is_own {
            self.own_fit = Some(Arc::clone(&fit));
        }
        self.fits.push(fit);
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
        let path = self.path.clone();
        let body = bound.rest_faces();
        write_drapes(vec![self.drapes((bound, &body), source)], &path, console)
    }

    /// All drapes, on a body with these faces.
    pub(super) fn drapes<'a>(
        self,
        (bound, body): (&'a Bound, &'a [[u32; 3]]),
        source: &Source,
    ) -> Drapes<'a> {
        let coloring = |scale: Scale, values: Vec<Vec<f32>>| Coloring {
            label: scale.label,
            map: scale.map,
            range: scale.range,
            values,
        };
        // A package is called by its folder, of which the template says nothing.
        let named = package_of(source).and_then(Path::file_name);
        let stem = bound.garment_file.path().file_stem();
        let stem = named.or(stem).unwrap_or_default();
        let mut colorings = vec![
            coloring(Scale::stretch(), self.stretches),
            coloring(Scale::distance(), self.distances),
            coloring(Scale::problems(), self.problems),
        ];
        if self.fits.iter().all(|levels| !levels.is_empty()) {
            let mut fits = self.fits;
            if fits.windows(2).all(|pair| Arc::ptr_eq(&pair[0], &pair[1])) {
                fits.truncate(1);
            }
            let fits = fits.iter().map(|levels| levels.to_vec()).collect();
            colorings.push(coloring(Scale::fit(), fits));
        }
        Drapes {
            name: stem.to_string_lossy().into_owned(),
            garment: bound.garment.mesh().faces(),
            body,
            cloth: self.cloth,
            skin: self.skin,
            colorings,
            frames: self.names,
            fps: fps_of(bound),
        }
    }
}
