//! What is told about a garment package.

use std::{fmt, path::PathBuf, time::Duration};

use garnet::{package::GarmentPackage, pattern::Size, untangle::penetration};
use serde::Serialize;

use crate::drape::WarningReport;

/// What was made.
#[derive(Debug, Serialize)]
pub(crate) struct GarmentReport {
    schema: &'static str,
    name: String,
    written: Vec<String>,
    vertices: usize,
    triangles: usize,
    fabric: String,
    /// The size that it was cut in, `m` or `32x34`; null if it was made to measure.
    size: Option<String>,
    /// The size that comes next, if the size was chosen.
    second_size: Option<String>,
    /// Vertices of the template inside the rest body.
    inside: usize,
    deepest_m: f32,
    /// What may be wrong although the package was made.
    pub(crate) warnings: Vec<WarningReport>,
    seconds: f64,
}

impl GarmentReport {
    pub(crate) fn new(
        package: &GarmentPackage,
        written: &[PathBuf],
        warnings: Vec<WarningReport>,
        sizes: [Option<Size>; 2],
        time: Duration,
    ) -> Self {
        let [size, second_size] = sizes.map(|size| size.map(|size| size.to_string()));
        let found = penetration(package.mesh.positions(), package.body.skin());
        Self {
            schema: "garnet.garment/1",
            name: package.manifest.name.clone(),
            written: written
                .iter()
                .map(|path| path.display().to_string())
                .collect(),
            vertices: package.mesh.num_vertices(),
            triangles: package.mesh.num_faces(),
            fabric: package.manifest.fabric.name.clone(),
            size,
            second_size,
            inside: found.inside,
            deepest_m: found.deepest,
            warnings,
            seconds: time.as_secs_f64(),
        }
    }
}

impl fmt::Display for GarmentReport {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            formatter,
            "made the garment `{}` of {} vertices and {} triangles, {}, in {:.1} s",
            self.name, self.vertices, self.triangles, self.fabric, self.seconds
        )?;
        write!(formatter, "wrote {}", self.written.join(", "))?;
        if self.inside > 0 {
            write!(
                formatter,
                "\n  {} {} inside the body at rest, the deepest {:.1} mm",
                self.inside,
                if self.inside == 1 {
                    "vertex is"
                } else {
                    "vertices are"
                },
                1e3 * self.deepest_m
            )?;
        }
        Ok(())
    }
}
