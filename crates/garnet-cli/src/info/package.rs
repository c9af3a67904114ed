//! What is in a garment package.

use std::{collections::BTreeMap, path::Path};

use garnet::Package;
use garnet::package::{GarmentPackage, Variant};
use garnet::pattern::{GarmentKind, Size};
use serde::Serialize;

use super::table::Table;

/// What is in a garment package.
#[derive(Debug, Serialize)]
pub(crate) struct PackageInfo {
    name: String,
    /// The garment as OBJ.
    template: String,
    vertices: usize,
    triangles: usize,
    fabric: String,
    /// Which pattern it was cut from; none of a garment of one's own.
    pattern: Option<String>,
    /// The size that it was cut in; none if it was cut for its body, or has no pattern.
    size: Option<String>,
    /// How it was cut, in metres or as shares.
    parameters: BTreeMap<String, f64>,
    /// The body that it lies on.
    rig: String,
    body_vertices: usize,
    /// Sizes that are stored beside the template.
    sizes: Vec<String>,
    /// The trained networks.
    variants: Vec<VariantInfo>,
}

/// What is known of a network.
#[derive(Debug, Serialize)]
struct VariantInfo {
    name: String,
    weights: String,
    /// Whether it is taken if none is asked for.
    is_default: bool,
    /// Mean distance to the teacher on the test scenes of its training, in metres.
    error_m: Option<f64>,
    /// The same after settling.
    settled_error_m: Option<f64>,
    flop: Option<f64>,
    /// Why its weights cannot be used; none if they can.
    problem: Option<String>,
}

impl PackageInfo {
    pub(crate) fn read(folder: &Path) -> anyhow::Result<Self> {
        let content = GarmentPackage::read(folder)?;
        let mut sizes = content.sizes(folder)?;
        sizes.sort_by_key(|name| {
            let mut known = Size::ALL.iter();
            known.position(|size| size.to_string().eq_ignore_ascii_case(name))
        });
        let GarmentPackage {
            manifest,
            mesh,
            body,
            ..
        } = content;
        let bound = if manifest.variants.is_empty() {
            None
        } else {
            Some(Package::open(folder).map_err(anyhow::Error::new))
        };
        let problem = |name: &str| match bound.as_ref()? {
            Ok(package) => {
                let refused = package.draper(name).err().map(anyhow::Error::new);
                refused.map(|error| format!("{error:#}"))
            }
            Err(error) => Some(format!("{error:#}")),
        };
        let default = manifest.default_variant().map(|variant| &variant.name);
        let of = |variant: &Variant| VariantInfo {
            name: variant.name.clone(),
            weights: shown(&folder.join(&variant.weights)),
            is_default: default == Some(&variant.name),
            error_m: variant.distance_error,
            settled_error_m: variant.settled_error,
            flop: variant.flop,
            problem: problem(&variant.name),
        };
        Ok(Self {
            template: shown(&GarmentPackage::template_at(folder)),
            vertices: mesh.num_vertices(),
            triangles: mesh.num_faces(),
            pattern: manifest.pattern.as_ref().map(|found| found.kind.clone()),
            size: manifest
                .pattern
                .as_ref()
                .and_then(|found| found.size.clone()),
            parameters: (manifest.pattern.as_ref())
                .map_or_else(BTreeMap::new, |found| found.parameters.clone()),
            rig: shown(&folder.join(&manifest.rest_body.rig)),
            body_vertices: body.rest().num_vertices(),
            sizes,
            variants: manifest.variants.iter().map(of).collect(),
            fabric: manifest.fabric.name.clone(),
            name: manifest.name.clone(),
        })
    }

    /// A parameter in its unit.
    fn shown(&self, name: &str, value: f64) -> String {
        let kind = self.pattern.as_deref().map(str::parse::<GarmentKind>);
        let specs = kind
            .and_then(Result::ok)
            .map_or(&[][..], GarmentKind::specs);
        let spec = specs.iter().find(|spec| spec.name == name);
        spec.map_or_else(|| value.to_string(), |spec| spec.shown(value))
    }

    pub(crate) fn fill(&self, table: &mut Table) {
        table.row("kind", "garment package");
        table.row("name", &self.name);
        table.row("template", &self.template);
        table.row("vertices", self.vertices);
        table.row("triangles", self.triangles);
        table.row("fabric", &self.fabric);
        table.row("pattern", self.pattern.as_deref().unwrap_or("none"));
        if let Some(size) = &self.size {
            table.row("size", size);
        }
        if !self.parameters.is_empty() {
            table.row(
                "cut",
                "lengths are those on the mean wearer: sizes scale them",
            );
        }
        for (name, value) in &self.parameters {
            table.row(&format!("  {name}"), self.shown(name, *value));
        }
        table.row("body", &self.rig);
        table.row("body vertices", self.body_vertices);
        if !self.sizes.is_empty() {
            table.row("sizes", self.sizes.join(", "));
        }
        table.row("networks", self.variants.len());
        for variant in &self.variants {
            table.row(&format!("  {}", variant.name), variant.told());
        }
    }
}

impl VariantInfo {
    fn told(&self) -> String {
        let of = |error: Option<f64>, what: &str| {
            error.map(|error| format!("{:.2} mm {what}", 1e3 * error))
        };
        let parts = [
            of(self.error_m, "from the simulation"),
            of(self.settled_error_m, "settled"),
            self.flop.map(|flop| format!("{:.2} GFLOP", flop / 1e9)),
            self.is_default.then(|| "the default".to_owned()),
            self.problem
                .as_ref()
                .map(|why| format!("cannot be used: {why}")),
        ];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        parts.join(", ")
    }
}

fn shown(path: &Path) -> String {
    path.display().to_string()
}
