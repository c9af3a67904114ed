//! Cutting garments to the measures of bodies, and putting them on.

use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;

use garnet_body::shape::{ParametricBody, standing, tape_measures};
use garnet_drape::{
    FinishedGirth, GarmentPackage, PackageParts, Region, Simulator, StoredFabric, StoredParameters,
    StoredPattern, check_stop, collider, stopping,
};
use garnet_io::ObjFile;
use garnet_mesh::Point3;
use garnet_pattern::{
    Fit, GarmentKind, Parameters, PatternError, SewnGarment, Size, Template, Wearer,
};
use garnet_sim::{Cloth, Fabric, GRIP, MovingBody, Quality, RestShape, Scene, Schedule, drape};
use garnet_skin::{Body, Garment};

use crate::DataError;
use crate::wearer::{default_rest_body, wearer, wearer_of};

/// Cuts garments of one topology to the measures of bodies, and puts them on.
#[derive(Debug, Clone)]
pub struct Tailor {
    template: Template,
    parameters: Parameters,
    num_vertices: usize,
    fabric: StoredFabric,
    size: Option<Size>,
}

/// The parameters of a stored pattern.
fn parameters_of(pattern: &StoredPattern) -> Result<Parameters, PatternError> {
    let kind: GarmentKind = pattern.kind.parse()?;
    let mut parameters = kind.parameters();
    for (name, &value) in &pattern.parameters {
        parameters.set(name, value)?;
    }
    Ok(parameters)
}

/// The girths of a garment that was cut by a stored pattern, in its size or for the body that it
/// lies on; empty if the measures of that are not known.
///
/// # Errors
///
/// [`DataError::Pattern`] if the pattern is none of this version.
pub fn finished_girths(
    pattern: &StoredPattern,
    body: &Body,
) -> Result<Vec<FinishedGirth>, DataError> {
    let parameters = parameters_of(pattern)?;
    let cut = match &pattern.size {
        Some(size) => size.parse::<Size>()?.measures(),
        None => match wearer_of(body).transpose()? {
            Some(wearer) => wearer.measures,
            None => return Ok(Vec::new()),
        },
    };
    let is_shirt = matches!(
        parameters.garment(),
        GarmentKind::Tshirt | GarmentKind::Sweater
    );
    let length = is_shirt
        .then(|| parameters.length_from_neck(&cut))
        .flatten();
    let finished = parameters.finished(&cut).into_iter();
    let girths = finished.filter_map(|found| {
        let mut regions = Region::ALL.into_iter();
        let region = regions.find(|region| region.name() == found.place)?;
        Some(FinishedGirth {
            region,
            girth: found.girth,
            from_neck: length.filter(|_| region == Region::Hip),
            band: found.band.map(|band| [band.above_hip, band.widest]),
        })
    });
    Ok(girths.collect())
}

/// A garment on the body that it was cut for.
#[derive(Debug, Clone)]
pub struct Worn {
    /// The garment.
    pub sewn: SewnGarment,
    /// Its positions on the body at rest `[vertex]`, in metres.
    pub positions: Vec<Point3>,
}

impl Tailor {
    /// Triangulates a pattern with about `num_vertices` vertices.
    ///
    /// # Errors
    ///
    /// [`DataError::Pattern`].
    pub fn new(
        parameters: Parameters,
        num_vertices: usize,
        fabric: StoredFabric,
    ) -> Result<Self, DataError> {
        Ok(Self {
            template: Template::new(parameters.garment(), num_vertices)?,
            parameters,
            num_vertices,
            fabric,
            size: None,
        })
    }

    /// The same, cutting a size instead of to measure.
    #[must_use]
    pub fn with_size(self, size: Option<Size>) -> Self {
        Self { size, ..self }
    }

    /// The size that is cut; none if garments are cut to measure.
    pub fn size(&self) -> Option<Size> {
        self.size
    }

    /// The tailor of a package that was made from a pattern; none if it was not.
    ///
    /// # Errors
    ///
    /// [`DataError::Pattern`] if the pattern of the package is none of this version.
    pub fn of_package(package: &GarmentPackage) -> Result<Option<Self>, DataError> {
        let Some(pattern) = &package.manifest.pattern else {
            return Ok(None);
        };
        let parameters = parameters_of(pattern)?;
        let fabric = package.manifest.fabric.clone();
        let size = pattern.size.as_deref().map(str::parse).transpose()?;
        let tailor = Self::new(parameters, pattern.vertices, fabric)?;
        Ok(Some(tailor.with_size(size)))
    }

    /// The template that garments are cut from.
    pub fn template(&self) -> &Template {
        &self.template
    }

    /// The same with other parameters of the same pattern.
    #[must_use]
    pub fn with_parameters(self, parameters: Parameters) -> Self {
        Self { parameters, ..self }
    }

    /// The parameters that garments are cut with.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// How the garment, cut in its size or to the measures of `wearer`, fits.
    pub fn fit(&self, wearer: &Wearer) -> Fit {
        let cut = self.size.map_or(wearer.measures, Size::measures);
        self.parameters.fit(&cut, &wearer.measures)
    }

    /// Cuts the garment in its size or to the measures of `wearer`, and puts it on `body`, which is
    /// the wearer at rest: the seams are closed, the cloth contracts onto the skin.
    ///
    /// # Errors
    ///
    /// [`DataError::Pattern`] if the parameters are not possible on this wearer, [`DataError::Sim`]
    /// if the cloth cannot be put on.
    pub fn dress(
        &self,
        body: &Body,
        wearer: &Wearer,
        stop: &AtomicBool,
    ) -> Result<Worn, DataError> {
        // Patterns know bodies that stand at the origin.
        if let Some((standing, back)) = standing(body) {
            let Worn { sewn, positions } = self.dress(&standing, wearer, stop)?;
            let positions = positions.iter().map(|place| back * place).collect();
            return Ok(Worn { sewn, positions });
        }
        let cut = self.size.map_or(wearer.measures, Size::measures);
        let sewn = self.template.sewn(&self.parameters, &cut, wearer)?;
        let rest = rest_of(&sewn);
        // A template has the edges of the pattern and its symmetry: a garment at rest is not to lie
        // in the folds that cloth which gives way to compression falls into, on the one side or the
        // other.
        let fabric = Fabric {
            compression: 1.0,
            ..self.fabric.fabric()
        };
        let cloth = Cloth::new(&sewn.faces, sewn.num_vertices(), &rest, &fabric)?;
        let positions = body.rest().positions();
        let scene = Scene {
            cloth: &cloth,
            start: &sewn.start,
            body: Some(MovingBody {
                collider: &collider(body, 1.0)?,
                motion: &|_| positions.to_vec(),
                wind: None,
                allowed_parts: None,
                likely_faces: None,
            }),
        };
        let mut schedule = wearing(cloth.mean_edge_length());
        let run = |scene: &Scene<'_>, schedule: &Schedule| {
            let worn = drape(scene, schedule, &mut stopping(stop, &mut |_| {}));
            check_stop(stop)?;
            Ok::<_, DataError>(worn?.positions)
        };
        let mut closed = Vec::new();
        if !hangs_from_shoulders(self.parameters.garment()) {
            closed = run(&scene, &without_weight(&schedule))?;
            schedule.contraction_frames = 0;
        }
        let start = if closed.is_empty() {
            scene.start
        } else {
            &closed
        };
        let positions = run(&Scene { start, ..scene }, &schedule)?;
        Ok(Worn { sewn, positions })
    }

    /// The simulator of a garment on the body that it was cut for.
    ///
    /// # Errors
    ///
    /// Those of [`Simulator::of_garment`].
    pub fn simulator(&self, worn: &Worn, body: &Body) -> Result<Simulator, DataError> {
        let mesh = worn
            .sewn
            .start_mesh()
            .with_positions(worn.positions.clone())?;
        let garment = Garment::new(mesh).bind(body)?;
        let (rest, fabric) = (rest_of(&worn.sewn), self.fabric.fabric());
        Ok(Simulator::of_garment(garment, body, &rest, &fabric)?)
    }

    /// A package of a garment on the body that it was cut for.
    ///
    /// # Errors
    ///
    /// [`DataError::Obj`] or [`DataError::Mesh`], which a sewn garment does not give.
    pub fn package(
        &self,
        name: String,
        worn: &Worn,
        body: Body,
        parameters: Option<StoredParameters>,
    ) -> Result<GarmentPackage, DataError> {
        let text = worn.sewn.obj(&worn.positions);
        Ok(GarmentPackage::new(PackageParts {
            name,
            template: ObjFile::parse(text.into_bytes(), "template.obj")?,
            rest: rest_of(&worn.sewn),
            fabric: self.fabric.clone(),
            pattern: Some(StoredPattern {
                kind: self.parameters.garment().name().to_owned(),
                vertices: self.num_vertices,
                size: self.size.map(|size| size.to_string()),
                made_to_measure: false,
                parameters: values(&self.parameters),
            }),
            body,
            parameters,
        })?)
    }
}

/// Name and value of each parameter.
pub(crate) fn values(parameters: &Parameters) -> BTreeMap<String, f64> {
    parameters
        .iter()
        .map(|parameter| (parameter.spec.name.to_owned(), parameter.value))
        .collect()
}

/// A built-in garment with its usual parameters and fabric, of about so many vertices, on the usual
/// body.
///
/// # Errors
///
/// [`DataError::Pattern`] for a number of vertices that the pattern does not have.
pub fn usual_package(kind: GarmentKind, num_vertices: usize) -> Result<GarmentPackage, DataError> {
    let parameters = default_rest_body();
    let built = ParametricBody::build(&parameters)?;
    // As the tape reads them on any body of this kind, so that garments are the same to the byte.
    let measures = tape_measures(built.body()).unwrap_or(*built.measures());
    let wearer = wearer(built.body(), &measures)?;
    let body = built.into_body();
    let tailor = Tailor::new(kind.parameters(), num_vertices, usual_fabric(kind))?;
    let worn = tailor.dress(&body, &wearer, &AtomicBool::new(false))?;
    let stored = Some(StoredParameters::from(&parameters));
    tailor.package(kind.name().to_owned(), &worn, body, stored)
}

/// The fabric that a garment is usually made of.
pub fn usual_fabric(kind: GarmentKind) -> StoredFabric {
    let (name, fabric) = match kind {
        GarmentKind::Tshirt | GarmentKind::Dress => ("interlock", Fabric::interlock()),
        GarmentKind::Sweater => ("knit", Fabric::knit()),
        GarmentKind::Jeans => ("denim", Fabric::denim()),
    };
    StoredFabric::new(name, &fabric)
}

/// Frames in which a garment contracts from its start shape, of a sixtieth of a second each.
const CONTRACTION_FRAMES: u32 = 45;

/// The schedule for putting a garment on a body that stands still.
fn wearing(edge_length: f32) -> Schedule {
    let mut schedule = Schedule::for_quality(Quality::Teacher, edge_length).of_one_layer();
    schedule.motion_frames = 0;
    schedule.contraction_frames = CONTRACTION_FRAMES;
    if let Some(first) = schedule.stages.first_mut() {
        first.frames += CONTRACTION_FRAMES;
    }
    schedule
}

/// Whether shoulders hold a garment while it is put on. Else it would fall before its waistband has
/// closed, and hang where the hips are wide enough.
const fn hangs_from_shoulders(garment: GarmentKind) -> bool {
    match garment {
        GarmentKind::Tshirt | GarmentKind::Sweater | GarmentKind::Dress => true,
        GarmentKind::Jeans => false,
    }
}

/// The part of a schedule in which cloth contracts, without its weight.
fn without_weight(schedule: &Schedule) -> Schedule {
    let mut schedule = schedule.clone();
    schedule.gravity = 0.0;
    schedule.stages.truncate(1);
    schedule
}

fn rest_of(sewn: &SewnGarment) -> RestShape {
    RestShape::Flat {
        corners: sewn.flat.clone(),
        shrink: sewn.shrink.clone(),
        grip: match sewn.parameters.garment() {
            // Knitted ribs give way: sleeves and hem ride up under raised arms.
            GarmentKind::Sweater => 0.0,
            GarmentKind::Tshirt | GarmentKind::Dress | GarmentKind::Jeans => GRIP,
        },
    }
}
