//! From the records of a data set to garments that are warped to posed bodies.

use std::borrow::Cow;
use std::path::Path;
use std::sync::{Arc, OnceLock};

use garnet_body::shape::ParametricBody;
use garnet_data::{BodyRecord, Dataset, Posed, SceneRecord, Shard, Sizing, Split};
use garnet_drape::{BodyPath, GarmentPackage};
use garnet_mesh::{Point3, TriMesh};
use garnet_net::GarmentGraph;
use garnet_sim::{FALLEN, Moment};
use garnet_skin::{Body, BoundGarment, Garment, Pose, PosedBody, Warp, WarpedGarment};
use rayon::prelude::*;

use crate::{SceneName, TrainError};

/// The garment of a package and the scenes of a data set of it.
#[derive(Debug)]
pub struct Stage {
    /// The package.
    pub package: GarmentPackage,
    /// The data set.
    pub dataset: Dataset,
    /// The template, bound to the body of the package.
    template: Arc<Worn>,
}

/// A garment on the body that it was bound to at rest.
#[derive(Debug)]
pub struct Worn {
    /// The garment.
    pub garment: BoundGarment,
    /// The body at rest.
    pub body: Body,
    /// What a network knows of the garment, with its sewing parameters in the order of their names,
    /// lengths in metres.
    pub graph: GarmentGraph,
    /// The garment at rest `[vertex]`, in metres.
    pub rest: Arc<[Point3]>,
    ready: OnceLock<Arc<garnet_drape::BoundGarment>>,
}

impl Worn {
    /// The garment as drapes take it; it is made once.
    ///
    /// # Errors
    ///
    /// [`TrainError::Drape`] for a garment too degenerate to be untangled.
    pub fn ready(&self) -> Result<Arc<garnet_drape::BoundGarment>, TrainError> {
        if let Some(ready) = self.ready.get() {
            return Ok(Arc::clone(ready));
        }
        let body = Arc::new(self.body.clone());
        let ready = garnet_drape::BoundGarment::of_cloth(self.garment.clone(), body)?;
        Ok(Arc::clone(self.ready.get_or_init(|| Arc::new(ready))))
    }

    fn new(garment: BoundGarment, body: Body, parameters: &[f32]) -> Result<Self, TrainError> {
        Ok(Self {
            graph: GarmentGraph::new(garment.mesh(), parameters)?,
            rest: garment.mesh().positions().into(),
            ready: OnceLock::new(),
            garment,
            body,
        })
    }
}

/// A garment on a posed body, and how the teacher drapes it there.
#[derive(Debug)]
pub struct StagedScene {
    /// Which it is.
    pub name: SceneName,
    /// The sequence that the pose is from; empty if it is from none.
    pub sequence: String,
    /// Who wears what.
    pub worn: Arc<Worn>,
    /// The body in its pose.
    pub posed: PosedBody,
    /// What the teacher made of it `[vertex]`, in metres; see [`Stage::check_moment`].
    pub draped: Vec<Point3>,
    /// Where the garment was when the body came to its last place `[vertex]`, in metres, if the
    /// data set has it.
    pub arrived: Option<Vec<Point3>>,
    /// Where the garment was when the body was [midway](Moment::Midway) `[vertex]`, in metres, if
    /// the data set has it.
    pub midway: Option<Vec<Point3>>,
    /// The body of the data set at rest and its pose; none of those made elsewhere.
    pub own: Option<(Arc<Body>, Pose)>,
}

impl StagedScene {
    /// Takes the body, and the cloth on it, to where a drape takes them before anything looks at
    /// them.
    fn come_home(&mut self) -> Result<(), TrainError> {
        let home = self.posed.at_home(&self.worn.body)?;
        let on_way = [self.arrived.as_mut(), self.midway.as_mut()];
        let cloth = on_way.into_iter().flatten().chain([&mut self.draped]);
        for places in cloth {
            *places = home.from_target(std::mem::take(places));
        }
        if let Some(moved) = home.moved() {
            self.posed = moved;
        }
        Ok(())
    }

    /// The garment, warped to a body that [`StagedScene::posed_for`] gives.
    ///
    /// # Errors
    ///
    /// [`TrainError::Skin`].
    pub fn warped(&self, warp: Warp, posed: &PosedBody) -> Result<WarpedGarment, TrainError> {
        let Worn { garment, body, .. } = &*self.worn;
        Ok(WarpedGarment::new(garment, body, posed, warp)?)
    }

    /// The body at the moment at which a model predicts the cloth: in its pose, or on its way.
    ///
    /// # Errors
    ///
    /// [`TrainError::Skin`].
    pub fn posed_for(&self, moment: Moment) -> Result<Cow<'_, PosedBody>, TrainError> {
        if moment.is_on_way() {
            let posed = (self.seen_path()).posed(&self.worn.body, moment.motion_share())?;
            return Ok(Cow::Owned(posed));
        }
        Ok(Cow::Borrowed(&self.posed))
    }

    /// How a drape moves the body from rest, which knows of it what is [posed](Self::posed).
    pub fn seen_path(&self) -> BodyPath {
        BodyPath::to_posed(&self.worn.body, &self.posed)
    }

    /// Where the simulator has the cloth at a moment `[vertex]`, in metres: what a model is to
    /// predict.
    ///
    /// # Errors
    ///
    /// [`TrainError::NotKept`] if the data set does not have it.
    pub fn cloth_at(&self, moment: Moment) -> Result<Cow<'_, [Point3]>, TrainError> {
        let (places, when) = match moment {
            Moment::Rest => return Ok(Cow::Borrowed(&self.draped)),
            Moment::Start => return Ok(Cow::Borrowed(&self.worn.rest)),
            Moment::Arrival | Moment::Falling => (&self.arrived, "its body arrived"),
            Moment::Midway => (&self.midway, "its body was midway"),
        };
        let scene = self.name;
        let places = (places.as_deref()).ok_or(TrainError::NotKept { scene, when })?;
        if moment != Moment::Falling {
            return Ok(Cow::Borrowed(places));
        }
        let pairs = places.iter().zip(&self.draped);
        let fallen = pairs.map(|(from, to)| from + FALLEN * (to - from));
        Ok(Cow::Owned(fallen.collect()))
    }

    /// How the teacher moved the body from rest.
    ///
    /// # Errors
    ///
    /// [`TrainError::Skin`].
    pub fn path(&self) -> Result<BodyPath, TrainError> {
        let body = &self.worn.body;
        match &self.own {
            Some((own, pose)) => Ok(BodyPath::to_shape(body, own, pose)?),
            None => Ok(self.seen_path()),
        }
    }
}

/// The package with its garment in the size that a data set is of; as it is, if that is of none.
///
/// # Errors
///
/// [`TrainError::Package`] for a damaged file of sizes.
fn in_size_of(
    package: GarmentPackage,
    folder: &Path,
    dataset: &Dataset,
) -> Result<GarmentPackage, TrainError> {
    let theirs = &dataset.manifest.garment.positions;
    if package.manifest.positions == *theirs {
        return Ok(package);
    }
    for size in package.sizes(folder)? {
        let sized = package.in_size(folder, &size)?;
        if let Some(sized) = sized.filter(|sized| sized.manifest.positions == *theirs) {
            return Ok(sized);
        }
    }
    Ok(package)
}

impl Stage {
    /// Refuses a data set whose cloth has not settled for all but what it was simulated for.
    ///
    /// # Errors
    ///
    /// [`TrainError::NotSettled`].
    pub fn check_moment(&self, moment: Moment) -> Result<(), TrainError> {
        let manifest = &self.dataset.manifest;
        // Before bodies arrive they are midway.
        let is_on_way = moment == Moment::Midway && manifest.until == Moment::Arrival;
        if manifest.until.is_rest() || manifest.until == moment || is_on_way {
            return Ok(());
        }
        Err(TrainError::NotSettled {
            garment: manifest.garment.name.clone(),
        })
    }

    /// Brings the package in a folder together with a data set of its garment, as it is or in
    /// another size.
    ///
    /// # Errors
    ///
    /// As [`Stage::new`], and [`TrainError::Package`] or [`TrainError::Data`] for what cannot be
    /// read.
    pub fn open(folder: &Path, dataset: &Path) -> Result<Self, TrainError> {
        let dataset = Dataset::open(dataset)?;
        let package = GarmentPackage::read(folder)?;
        let package = in_size_of(package, folder, &dataset)?;
        Self::new(package, dataset)
    }

    /// Brings a package and a data set of its garment together.
    ///
    /// # Errors
    ///
    /// [`TrainError::OtherTemplate`] for a data set of another garment, [`TrainError::Skin`] for a
    /// template that cannot be bound.
    pub fn new(package: GarmentPackage, dataset: Dataset) -> Result<Self, TrainError> {
        let (ours, theirs) = (&package.manifest, &dataset.manifest.garment);
        let pairs = [
            (
                "other faces or another vertex count",
                &ours.fingerprint,
                &theirs.fingerprint,
            ),
            ("other vertices at rest", &ours.positions, &theirs.positions),
        ];
        for (what, expected, found) in pairs {
            if expected != found {
                return Err(TrainError::OtherTemplate {
                    what,
                    found_name: theirs.name.clone(),
                    found: found.clone(),
                    name: ours.name.clone(),
                    expected: expected.clone(),
                });
            }
        }
        let parameters = package.manifest.sewing_parameters();
        let garment = Garment::new(package.mesh.clone()).bind(&package.body)?;
        let template = Worn::new(garment, package.body.clone(), &parameters)?;
        Ok(Self {
            package,
            dataset,
            template: Arc::new(template),
        })
    }

    /// The template on the body of the package.
    pub fn template(&self) -> &Arc<Worn> {
        &self.template
    }

    /// Whether bodies wear garments cut for them.
    pub fn is_made_to_measure(&self) -> bool {
        self.dataset.manifest.sizing == Sizing::MadeToMeasure
    }

    /// How many sewing parameters the garments of the data set have.
    ///
    /// # Errors
    ///
    /// [`TrainError::Data`].
    pub fn num_sewing_parameters(&self) -> Result<usize, TrainError> {
        for shard in self.dataset.split(Split::Train) {
            if let Some(body) = shard?
                .bodies
                .first()
                .filter(|body| !body.garment.is_empty())
            {
                return Ok(body.garment.len());
            }
        }
        Ok(self.template.graph.sewing_parameters().len())
    }

    /// How many scenes a split has.
    ///
    /// # Errors
    ///
    /// [`TrainError::Data`], or [`TrainError::EmptySplit`] if there are none.
    pub fn num_scenes(&self, split: Split) -> Result<usize, TrainError> {
        let mut count = 0;
        for shard in self.dataset.split(split) {
            count += shard?.scenes.len();
        }
        match count {
            0 => Err(TrainError::EmptySplit { split }),
            count => Ok(count),
        }
    }

    /// The scenes of a split, in order.
    ///
    /// # Errors
    ///
    /// As [`Stage::num_scenes`].
    pub fn scene_names(&self, split: Split) -> Result<Vec<SceneName>, TrainError> {
        let mut names = Vec::new();
        for shard in self.dataset.split(split) {
            let shard = shard?;
            for body in &shard.bodies {
                let scenes = shard.scenes.iter();
                let on_body = scenes.filter(|scene| scene.body == body.number);
                names.extend(on_body.map(|scene| SceneName::of(split, scene)));
            }
        }
        if names.is_empty() {
            return Err(TrainError::EmptySplit { split });
        }
        Ok(names)
    }

    /// Gives all scenes of a split to `take`, bodies in parallel, and what that makes of them to
    /// `observer`, in order.
    ///
    /// # Errors
    ///
    /// The first of those of the data set, of [`TrainError::Scene`] for a scene that cannot be
    /// prepared, of `take`, and of `observer`.
    pub fn for_each<T: Send>(
        &self,
        split: Split,
        take: impl Fn(StagedScene) -> Result<T, TrainError> + Sync,
        observer: &mut dyn FnMut(T) -> Result<(), TrainError>,
    ) -> Result<(), TrainError> {
        self.for_each_of(split, |_| true, take, observer)
    }

    /// As [`Stage::for_each`], for the scenes alone that `keep` lets through.
    ///
    /// # Errors
    ///
    /// As [`Stage::for_each`].
    pub fn for_each_of<T: Send>(
        &self,
        split: Split,
        keep: impl Fn(SceneName) -> bool + Sync,
        take: impl Fn(StagedScene) -> Result<T, TrainError> + Sync,
        observer: &mut dyn FnMut(T) -> Result<(), TrainError>,
    ) -> Result<(), TrainError> {
        for shard in self.dataset.split(split) {
            let shard = shard?;
            let bodies = shard.bodies.chunks(rayon::current_num_threads().max(1));
            for bodies in bodies {
                let taken: Vec<Vec<T>> = (bodies.par_iter())
                    .map(|body| self.scenes_on(&shard, body, &keep, &take))
                    .collect::<Result<_, _>>()?;
                taken.into_iter().flatten().try_for_each(&mut *observer)?;
            }
        }
        Ok(())
    }

    fn scenes_on<T>(
        &self,
        shard: &Shard,
        body: &BodyRecord,
        keep: &impl Fn(SceneName) -> bool,
        take: &impl Fn(StagedScene) -> Result<T, TrainError>,
    ) -> Result<Vec<T>, TrainError> {
        let name = |scene: &SceneRecord| SceneName::of(shard.split, scene);
        let scenes: Vec<&SceneRecord> = (shard.scenes.iter())
            .filter(|scene| scene.body == body.number && keep(name(scene)))
            .collect();
        let Some(first) = scenes.first() else {
            return Ok(Vec::new());
        };
        let dressed = self.dressed(body).map_err(|source| TrainError::Scene {
            scene: name(first),
            source: Box::new(source),
        })?;
        let staged = scenes
            .into_iter()
            .map(|scene| take(dressed.staged(scene, name(scene))?));
        staged.collect()
    }

    /// Builds a body and puts its garment on it.
    fn dressed(&self, record: &BodyRecord) -> Result<Dressed, TrainError> {
        let own = match &record.parameters {
            None => None,
            Some(stored) => {
                let parameters = stored.parameters().map_err(|name| TrainError::Body {
                    reason: format!("there is no measure `{name}`"),
                })?;
                let built = ParametricBody::build(&parameters);
                let built = built.map_err(|error| TrainError::Body {
                    reason: error.to_string(),
                })?;
                Some(built.into_body())
            }
        };
        let parameters: Vec<f32> = record.garment.values().map(|&value| value as f32).collect();
        let worn = match (&own, &record.worn) {
            (Some(body), Some(places)) => {
                let mesh = TriMesh::new(places.clone(), self.package.mesh.faces().to_vec())?;
                let garment = Garment::new(mesh).bind(body)?;
                Arc::new(Worn::new(garment, body.clone(), &parameters)?)
            }
            _ if parameters.is_empty() => Arc::clone(&self.template),
            _ => Arc::new(Worn {
                garment: self.template.garment.clone(),
                body: self.template.body.clone(),
                graph: self
                    .template
                    .graph
                    .clone()
                    .with_sewing_parameters(&parameters)?,
                rest: Arc::clone(&self.template.rest),
                ready: OnceLock::new(),
            }),
        };
        Ok(Dressed {
            is_cut_to_measure: own.is_some() && record.worn.is_some(),
            own: own.map(Arc::new),
            worn,
            until: self.dataset.manifest.until,
        })
    }
}

/// A body of the data set and what it wears.
struct Dressed {
    /// The body at rest; none for bodies made elsewhere.
    own: Option<Arc<Body>>,
    worn: Arc<Worn>,
    /// Whether the garment was cut for the body.
    is_cut_to_measure: bool,
    /// How far scenes were simulated.
    until: Moment,
}

impl Dressed {
    fn staged(&self, scene: &SceneRecord, name: SceneName) -> Result<StagedScene, TrainError> {
        let expected = self.worn.garment.mesh().num_vertices();
        check("garment vertices", &scene.garment, expected, name)?;
        let on_way = [
            ("vertices of the arrived garment", &scene.arrived),
            ("vertices of the garment midway", &scene.midway),
        ];
        for (what, places) in on_way {
            if let Some(places) = places {
                check(what, places, expected, name)?;
            }
        }
        let posed = self.posed(scene, name).map_err(|source| match source {
            TrainError::Count { .. } | TrainError::NotFinite { .. } => source,
            source => TrainError::Scene {
                scene: name,
                source: Box::new(source),
            },
        })?;
        let mut staged = StagedScene {
            name,
            sequence: scene.sequence.clone(),
            worn: Arc::clone(&self.worn),
            posed,
            draped: scene.garment.clone(),
            arrived: match self.until {
                Moment::Arrival => Some(scene.garment.clone()),
                _ => scene.arrived.clone(),
            },
            midway: match self.until {
                Moment::Midway => Some(scene.garment.clone()),
                _ => scene.midway.clone(),
            },
            own: match (&self.own, &scene.posed) {
                (Some(own), Posed::Pose(pose)) => Some((Arc::clone(own), pose.clone())),
                _ => None,
            },
        };
        // The poses of the library are at home.
        if let Posed::Mesh(_) = scene.posed {
            staged.come_home()?;
        }
        Ok(staged)
    }

    /// The body as a drape finds it: a garment that was cut for the body is moved by the pose;
    /// the template only sees the vertices of the target, and pose and shape are recovered.
    fn posed(&self, scene: &SceneRecord, name: SceneName) -> Result<PosedBody, TrainError> {
        let target = match (&scene.posed, &self.own) {
            (Posed::Pose(pose), Some(own)) => own.posed(pose)?,
            (Posed::Pose(pose), None) => return Ok(self.worn.body.posed(pose)?),
            (Posed::Mesh(places), _) => {
                let expected = self.worn.body.rest().num_vertices();
                check("body vertices", places, expected, name)?;
                return Ok(self.worn.body.fitted(places)?);
            }
        };
        if self.is_cut_to_measure {
            return Ok(target);
        }
        Ok(self.worn.body.fitted(target.skin().positions())?)
    }
}

fn check(
    what: &'static str,
    places: &[Point3],
    expected: usize,
    scene: SceneName,
) -> Result<(), TrainError> {
    if places.len() != expected {
        return Err(TrainError::Count {
            scene,
            what,
            found: places.len(),
            expected,
        });
    }
    let is_stray = |place: &Point3| !place.iter().all(|value| value.is_finite());
    match places.iter().position(is_stray) {
        Some(index) => Err(TrainError::NotFinite { scene, what, index }),
        None => Ok(()),
    }
}
