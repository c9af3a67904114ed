//! The garment of a package in other sizes, as a file.
//!
//! A size has the faces of the template: what differs is the body that it is cut for, where its
//! vertices lie on that at rest, and where the points of its pattern lie in the plane.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use garnet_body::shape::{BodyParameters, Measure, ParametricBody};
use garnet_mesh::{Fingerprint, MOST_BYTES, StagedFile, read_bounded};
use garnet_sim::RestShape;

use super::{GarmentPackage, PackageError, StoredParameters};
use crate::tensors::{Array, Contents, to_bytes};

const SIZES_FILE: &str = "sizes.safetensors";
const SCHEMA: &str = "garnet.sizes/1";

/// What the names of the tensors begin with.
const PLACES: &str = "positions.";
const PATTERN: &str = "pattern.";
const BODY: &str = "body.";

/// The measures of a body that are stored, after its sex.
const MEASURES: [Measure; 4] = [
    Measure::Stature,
    Measure::Chest,
    Measure::Waist,
    Measure::Hip,
];

/// Points of two sizes that are one in the template are no farther apart than this, in metres.
const SAME_POINT: f32 = 1e-5;

/// The points of a flat pattern: the point of each corner `[face][corner]`, and how many there are.
fn points_of(corners: &[[[f32; 2]; 3]]) -> (Vec<[usize; 3]>, usize) {
    let mut numbers: HashMap<[u32; 2], usize> = HashMap::new();
    let mut number = |corner: [f32; 2]| {
        let next = numbers.len();
        *numbers.entry(corner.map(f32::to_bits)).or_insert(next)
    };
    let points = corners.iter().map(|face| face.map(&mut number)).collect();
    (points, numbers.len())
}

impl GarmentPackage {
    /// The sizes that are stored in a package beside its template, by their names.
    ///
    /// # Errors
    ///
    /// [`PackageError`] for a file that is damaged.
    pub fn sizes(&self, folder: &Path) -> Result<Vec<String>, PackageError> {
        let Some(bytes) = stored(folder)? else {
            return Ok(Vec::new());
        };
        let contents = self.sound(&bytes, &folder.join(SIZES_FILE))?;
        let names = contents.iter().flat_map(Contents::names);
        let sizes = names.filter_map(|name| name.strip_prefix(PLACES).map(str::to_owned));
        let mut sizes: Vec<String> = sizes.collect();
        sizes.sort();
        Ok(sizes)
    }

    /// The package with its garment in a size that is stored beside the template; none if it is
    /// not.
    ///
    /// # Errors
    ///
    /// [`PackageError`] for a file that is damaged.
    pub fn in_size(&self, folder: &Path, size: &str) -> Result<Option<Self>, PackageError> {
        let Some(bytes) = stored(folder)? else {
            return Ok(None);
        };
        let path = folder.join(SIZES_FILE);
        let Some(contents) = self.sound(&bytes, &path)? else {
            return Ok(None);
        };
        let named = [PLACES, PATTERN, BODY].map(|kind| contents.array(&format!("{kind}{size}")));
        let [Some(places), Some(pattern), Some(body)] = named else {
            return Ok(None);
        };
        let RestShape::Flat {
            corners,
            shrink,
            grip,
        } = &self.rest
        else {
            return Ok(None);
        };
        let (points, num_points) = points_of(corners);
        let num_vertices = self.mesh.num_vertices();
        let foreign = |what: String| PackageError::foreign(&path, format!("size `{size}` {what}"));
        let shapes = [&*places.shape, &*pattern.shape, &*body.shape];
        if shapes
            != [
                &[1, num_vertices, 3][..],
                &[num_points, 2],
                &[1 + MEASURES.len()],
            ]
        {
            return Err(foreign("is not of the template".to_owned()));
        }
        let numbers: Vec<f64> = body.values.iter().map(|&value| f64::from(value)).collect();
        let measures = MEASURES.into_iter().zip(&numbers[1..]);
        let parameters = measures.fold(
            BodyParameters::new(numbers[0]),
            |body, (measure, &value)| body.with(measure, value),
        );
        let built = ParametricBody::build(&parameters);
        let built = built.map_err(|error| foreign(format!("is for no body: {error}")))?;
        let at = |point: usize| [pattern.values[2 * point], pattern.values[2 * point + 1]];
        let mesh = self.mesh.with_positions(places.points(0))?;
        let mut manifest = self.manifest.clone();
        manifest.rest_body.parameters = Some(StoredParameters::from(&parameters));
        manifest.positions = Fingerprint::of_positions(mesh.positions()).to_string();
        if let Some(pattern) = &mut manifest.pattern {
            pattern.size = Some(size.to_owned());
        }
        Ok(Some(Self {
            manifest,
            mesh,
            rest: RestShape::Flat {
                corners: points.iter().map(|face| face.map(at)).collect(),
                shrink: shrink.clone(),
                grip: *grip,
            },
            body: built.into_body(),
            template: self.template.clone(),
        }))
    }

    /// Stores the garment in other sizes, each with its name and whom it is cut for, beside the
    /// template. Of the bodies sex, stature and the girths of chest, waist and hip are kept.
    ///
    /// # Errors
    ///
    /// [`PackageError::Foreign`] for a garment that is not the template in another size, or
    /// [`PackageError::Write`].
    pub fn write_sizes(
        &self,
        folder: &Path,
        sizes: &[(String, BodyParameters, Self)],
    ) -> Result<PathBuf, PackageError> {
        let path = folder.join(SIZES_FILE);
        let mut arrays = Vec::new();
        for (name, body, cut) in sizes {
            let foreign = || {
                let what = format!("size `{name}` is not the template in another size");
                PackageError::foreign(&path, what)
            };
            let pattern = self.pattern_of(cut).ok_or_else(foreign)?;
            let places = cut.mesh.positions();
            let places = Array::of_points([places].into_iter(), places.len());
            arrays.push((format!("{PLACES}{name}"), places));
            arrays.push((format!("{PATTERN}{name}"), pattern));
            let measures = MEASURES.map(|measure| body.measure(measure));
            let measures: Option<Vec<f64>> = measures.into_iter().collect();
            let numbers = [vec![body.sex()], measures.ok_or_else(foreign)?].concat();
            let body = Array {
                shape: vec![numbers.len()],
                values: numbers.into_iter().map(|number| number as f32).collect(),
            };
            arrays.push((format!("{BODY}{name}"), body));
        }
        let arrays: Vec<(&str, &Array)> = (arrays.iter())
            .map(|(name, array)| (name.as_str(), array))
            .collect();
        let text = format!("{SCHEMA} {}", self.manifest.positions);
        let bytes = to_bytes(&arrays, &text, |checksum| format!("{text} {checksum}"));
        let bytes = bytes.map_err(|source| PackageError::tensors(&path, source))?;
        StagedFile::new(&path, |writer| writer.write_all(&bytes))?.put()?;
        Ok(path)
    }

    /// Where the points of the pattern of another size lie `[point, 2]`; none if it is not of this
    /// garment.
    fn pattern_of(&self, cut: &Self) -> Option<Array> {
        let (RestShape::Flat { corners, .. }, RestShape::Flat { corners: other, .. }) =
            (&self.rest, &cut.rest)
        else {
            return None;
        };
        if self.mesh.faces() != cut.mesh.faces() {
            return None;
        }
        let (points, num_points) = points_of(corners);
        let mut places: Vec<Option<[f32; 2]>> = vec![None; num_points];
        for (point, place) in points.as_flattened().iter().zip(other.as_flattened()) {
            let known = places[*point].get_or_insert(*place);
            let apart = (known[0] - place[0]).hypot(known[1] - place[1]);
            if apart > SAME_POINT {
                return None;
            }
        }
        let places: Option<Vec<[f32; 2]>> = places.into_iter().collect();
        Some(Array {
            shape: vec![num_points, 2],
            values: places?.as_flattened().to_vec(),
        })
    }

    /// What is in a file of sizes; none if they are those of another template.
    fn sound<'a>(
        &self,
        bytes: &'a [u8],
        path: &Path,
    ) -> Result<Option<Contents<'a>>, PackageError> {
        let contents = Contents::of(bytes).map_err(|source| PackageError::tensors(path, source))?;
        let no_sizes = || PackageError::foreign(path, format!("it is no `{SCHEMA}`"));
        let contents = contents.ok_or_else(no_sizes)?;
        let (text, expected) = contents.text.rsplit_once(' ').ok_or_else(no_sizes)?;
        let (schema, template) = text.split_once(' ').ok_or_else(no_sizes)?;
        if schema != SCHEMA {
            return Err(no_sizes());
        }
        PackageError::check(path, contents.checksum(text), expected)?;
        let is_of_template = template == self.manifest.positions;
        Ok(is_of_template.then_some(contents))
    }
}

/// The bytes of the file, if it is there.
fn stored(folder: &Path) -> Result<Option<Vec<u8>>, PackageError> {
    let path = folder.join(SIZES_FILE);
    if !path.is_file() {
        return Ok(None);
    }
    let bytes = read_bounded(&path, MOST_BYTES);
    Ok(Some(
        bytes.map_err(|source| PackageError::read(&path, source))?,
    ))
}
