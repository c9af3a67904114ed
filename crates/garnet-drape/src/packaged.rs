//! Garment packages that drape.

use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use garnet_body::poses::{Poser, key_pose};
use garnet_mesh::Point3;
use garnet_sim::Moment;
use garnet_skin::{Body, Pose, PosedBody};

use crate::{
    BoundGarment, Choice, ChoiceOptions, Draper, Error, Garment, GarmentPackage, Limit, Manifest,
    Network, PackageError, Settling, Simulator, StoredCost, calibration,
};

/// Poses of the library in which costs are measured: arms up, legs bent, and wide.
const USUAL_POSES: [&str; 3] = ["wave", "sit", "warrior_two"];

/// The garment of a package, bound to its body, with its trained variants.
///
/// # Examples
///
/// ```no_run
/// use garnet_drape::Package;
/// use garnet_io::ObjFile;
///
/// let shirt = Package::open("models/tshirt")?;
/// let draper = shirt.draper("fast")?;
/// let reach = ObjFile::read("models/demo/reach.obj")?;
/// let drape = draper.drape(&shirt.body().fitted(reach.positions())?)?;
/// shirt.write("draped.obj", &drape.positions)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Package {
    folder: PathBuf,
    content: GarmentPackage,
    garment: Arc<BoundGarment>,
    simulator: OnceLock<Arc<Simulator>>,
    /// Whether the garment is in another size than the template.
    is_other_size: bool,
}

impl Package {
    /// Reads a package and binds its garment to its body.
    ///
    /// # Errors
    ///
    /// What [`GarmentPackage::read`] and [`Garment::bind`] refuse.
    pub fn open(folder: impl AsRef<Path>) -> Result<Self, Error> {
        let folder = folder.as_ref();
        let content = GarmentPackage::read(folder)?;
        let garment = Garment::new(content.mesh.clone()).bind(&content.body)?;
        Ok(Self {
            folder: folder.to_path_buf(),
            content,
            garment: Arc::new(garment),
            simulator: OnceLock::new(),
            is_other_size: false,
        })
    }

    /// The same with its garment on another body, as one that was [cut to the
    /// measures](Manifest::is_made_to_measure) of that one.
    ///
    /// # Errors
    ///
    /// [`Error::Package`] for a garment of another topology, and what [`Garment::bind`] refuses.
    pub fn with_content(&self, content: GarmentPackage) -> Result<Self, Error> {
        let expected = &self.manifest().fingerprint;
        if content.manifest.fingerprint != *expected {
            let found = &content.manifest.fingerprint;
            let what = format!("a garment of the fingerprint {found}, not {expected}");
            return Err(PackageError::foreign(&self.folder, what).into());
        }
        let garment = Garment::new(content.mesh.clone()).bind(&content.body)?;
        Ok(Self {
            is_other_size: self.is_other_size,
            folder: self.folder.clone(),
            content,
            garment: Arc::new(garment),
            simulator: OnceLock::new(),
        })
    }

    /// The same garment under so many times the gravity of the earth, where it is simulated: what
    /// its variants predict is of the earth's.
    ///
    /// # Errors
    ///
    /// As [`Package::simulator`].
    pub fn with_gravity(&self, times: f32) -> Result<Self, Error> {
        let simulator = self.new_simulator()?.with_gravity(times);
        Ok(Self {
            is_other_size: self.is_other_size,
            folder: self.folder.clone(),
            content: self.content.clone(),
            garment: Arc::clone(&self.garment),
            simulator: OnceLock::from(Arc::new(simulator)),
        })
    }

    /// The sizes that the package has beside its template, as `l`.
    ///
    /// # Errors
    ///
    /// [`Error::Package`] for a damaged file.
    pub fn sizes(&self) -> Result<Vec<String>, Error> {
        Ok(self.content.sizes(&self.folder)?)
    }

    /// The same with its garment in another of its [sizes](Package::sizes), on the body that it is
    /// cut for: targets are [`Package::body`] of what is returned.
    ///
    /// # Errors
    ///
    /// [`Error::Package`] for a size that there is not, or a damaged file, and what
    /// [`Garment::bind`] refuses.
    pub fn in_size(&self, size: &str) -> Result<Self, Error> {
        match self.content.in_size(&self.folder, size)? {
            Some(content) => Ok(Self {
                is_other_size: true,
                ..self.with_content(content)?
            }),
            None => Err(PackageError::NoSize {
                name: size.to_owned(),
                known: self.sizes()?.join(", "),
            }
            .into()),
        }
    }

    /// What the package says of itself: its variants, with their errors and costs.
    pub fn manifest(&self) -> &Manifest {
        &self.content.manifest
    }

    /// What is in the package.
    pub fn content(&self) -> &GarmentPackage {
        &self.content
    }

    /// The body that the garment lies on at rest; targets are this body, [posed](Body::posed) or
    /// [fitted](Body::fitted).
    pub fn body(&self) -> &Body {
        self.garment.body()
    }

    /// The garment on that body.
    pub fn garment(&self) -> &Arc<BoundGarment> {
        &self.garment
    }

    /// What simulates the garment; it is made once.
    ///
    /// # Errors
    ///
    /// As [`Simulator::of_garment`].
    pub fn simulator(&self) -> Result<Arc<Simulator>, Error> {
        if let Some(simulator) = self.simulator.get() {
            return Ok(Arc::clone(simulator));
        }
        let simulator = self.new_simulator()?;
        Ok(Arc::clone(
            self.simulator.get_or_init(|| Arc::new(simulator)),
        ))
    }

    fn new_simulator(&self) -> Result<Simulator, Error> {
        let fabric = self.manifest().fabric.fabric();
        let cloth = Arc::clone(self.garment.shared_cloth());
        let simulator = Simulator::of_garment(cloth, self.body(), &self.content.rest, &fabric)?;
        Ok(simulator)
    }

    /// Drapes by a variant: `fast`, `balanced`, `accurate`, or another name that the package has.
    ///
    /// # Errors
    ///
    /// [`Error::Package`] for a variant that there is not, and what [`Network::load`] refuses.
    pub fn draper(&self, variant: &str) -> Result<Draper, Error> {
        self.draper_relaxed(variant, None)
    }

    /// Drapes by the variant that the package names as its default; without variants, by the warp.
    ///
    /// # Errors
    ///
    /// As [`Package::draper`].
    pub fn default_draper(&self) -> Result<Draper, Error> {
        match self.manifest().default_variant() {
            Some(variant) => self.draper(&variant.name),
            None => Ok(Draper::new(Arc::clone(&self.garment))),
        }
    }

    /// Drapes by the variant that keeps within a limit; by the warp, if none does. The choice says
    /// so.
    ///
    /// # Errors
    ///
    /// As [`Package::draper`].
    pub fn draper_within(&self, limit: Limit) -> Result<(Draper, Choice), Error> {
        self.chosen(&ChoiceOptions::new(limit))
    }

    /// The same for a posed body: within a distance is what is so in nine of ten poses that are as
    /// far from the training.
    ///
    /// # Errors
    ///
    /// As [`Package::draper`].
    pub fn draper_within_on(
        &self,
        limit: Limit,
        body: &PosedBody,
    ) -> Result<(Draper, Choice), Error> {
        let poses = self.manifest().poses.as_ref();
        self.chosen(&ChoiceOptions {
            far: poses.and_then(|poses| poses.distance_of(body, &self.garment)),
            ..ChoiceOptions::new(limit)
        })
    }

    fn chosen(&self, options: &ChoiceOptions) -> Result<(Draper, Choice), Error> {
        let choice = Choice::new(&self.folder, self.manifest(), options);
        let draper = match choice.candidate() {
            Some(chosen) => self.draper_relaxed(&chosen.variant, Some(chosen.is_relaxed))?,
            None => Draper::new(Arc::clone(&self.garment)),
        };
        Ok((draper, choice))
    }

    fn draper_relaxed(&self, name: &str, is_relaxed: Option<bool>) -> Result<Draper, Error> {
        let weights = if self.is_other_size {
            self.manifest().weights_of_sizes(&self.folder, name)?
        } else {
            self.manifest().weights_of(&self.folder, name)?
        };
        let parameters = self.manifest().sewing_parameters();
        let network = Network::load(weights, &self.garment, &parameters)?;
        let relaxation = self
            .manifest()
            .relaxation(name, network.moment(), is_relaxed);
        let draper = Draper::new(Arc::clone(&self.garment));
        let draper = draper.with_network(network, relaxation.frames);
        // For those who ask for more frames than the variant does, too.
        Ok(draper.with_simulator(self.simulator()?))
    }

    /// Measures what drapes of a variant cost here: the mean over a few poses of a human body, or
    /// the body at rest of another one, after one drape that is not measured.
    ///
    /// # Errors
    ///
    /// As [`Package::draper`] and [`Draper::drape`].
    pub fn measure(&self, variant: &str) -> Result<MeasuredCost, Error> {
        let targets = self.usual_targets()?;
        let seconds = |draper: &Draper| {
            draper.drape(&targets[0])?;
            let drapes = targets.iter().map(|target| draper.drape(target));
            let times = drapes.map(|drape| Ok(drape?.seconds.total()));
            let sum: f64 = times.sum::<Result<f64, Error>>()?;
            Ok::<_, Error>(sum / targets.len() as f64)
        };
        let relaxed = |is_relaxed| {
            let draper = self.draper_relaxed(variant, Some(is_relaxed))?;
            let takes_time = draper.relaxation().takes_time();
            let seconds = (takes_time == is_relaxed).then(|| seconds(&draper));
            seconds.transpose()
        };
        Ok(MeasuredCost {
            cost: StoredCost {
                calibration: calibration(),
                warp: seconds(&Draper::new(Arc::clone(&self.garment)))?,
            },
            seconds: relaxed(false)?,
            settled_seconds: relaxed(true)?,
        })
    }

    /// The body in the poses that costs are measured in.
    fn usual_targets(&self) -> Result<Vec<PosedBody>, Error> {
        let skeleton = self.body().skeleton();
        let poses: Vec<Pose> = match Poser::new(skeleton) {
            Ok(poser) => (USUAL_POSES.iter().filter_map(|name| key_pose(name)))
                .map(|pose| poser.pose(&pose.angles))
                .collect(),
            Err(_) => vec![Pose::rest(skeleton.num_joints())],
        };
        let targets = poses.iter().map(|pose| Ok(self.body().posed(pose)?));
        targets.collect()
    }

    /// Writes a drape as OBJ: the template with all but its `v` and `vn` lines byte for byte.
    ///
    /// # Errors
    ///
    /// [`Error::Obj`] for another number of positions than the template has vertices, or if the
    /// file cannot be written.
    pub fn write(&self, path: impl AsRef<Path>, positions: &[Point3]) -> Result<(), Error> {
        Ok(self
            .content
            .template
            .write_with_positions(path, positions)?)
    }
}

/// What drapes of a variant cost on a machine, in seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct MeasuredCost {
    /// The machine, and the warp on it.
    pub cost: StoredCost,
    /// A drape without relaxation; `None` where the cloth is on no body without it.
    pub seconds: Option<f64>,
    /// A drape with relaxation.
    pub settled_seconds: Option<f64>,
}

impl Manifest {
    /// Stores what a variant costs, on the machine that the manifest speaks of: that of the first
    /// variant which was measured.
    pub fn set_cost(&mut self, variant: &str, measured: &MeasuredCost) {
        let cost = *self.cost.get_or_insert(measured.cost);
        let share = cost.calibration / measured.cost.calibration;
        let mut variants = self.variants.iter_mut();
        if let Some(variant) = variants.find(|other| other.name == variant) {
            variant.seconds = measured.seconds.map(|seconds| share * seconds);
            variant.settled_seconds = measured.settled_seconds.map(|seconds| share * seconds);
        }
    }

    /// How what a variant predicts at a moment is relaxed: as the variant says, or as is said here.
    pub fn relaxation(&self, name: &str, moment: Moment, is_relaxed: Option<bool>) -> Settling {
        let variant = self.variant(name);
        let by_default = Settling::of_predicted(moment);
        let own = variant.map_or(by_default, |variant| variant.settling(moment));
        let frames = variant.and_then(|variant| variant.settle_frames);
        match is_relaxed {
            None => own,
            Some(false) => Settling { frames: 0, ..own },
            Some(true) => Settling {
                frames: frames.unwrap_or(by_default.frames),
                ..own
            },
        }
    }
}
