//! Trained models of either kind, bound to a garment.

#[cfg_attr(not(feature = "burn"), path = "model/no_network.rs")]
mod network;

use std::path::{Path, PathBuf};

use garnet_mesh::Point3;
use garnet_sim::Moment;
use garnet_skin::Warp;

use crate::pose_space::{Cut, PoseSpaceHeader, deformation_name, is_pose_space};
use crate::{
    CheckpointError, CheckpointHeader, Cost, GarNetConfig, GarmentGraph, NetError, PoseSpace,
    ReferenceCase, SceneInput, TrainedRange, weight_file,
};
use network::Network;

/// What moves a warped garment to where the teacher would put it: a pose-space deformation, a
/// network, or a network that starts from a pose-space deformation.
#[derive(Debug)]
pub struct Model {
    pose_space: Option<PoseSpace>,
    network: Option<Network>,
    range: Option<TrainedRange>,
    /// How the garment is cut that it is bound to.
    cut: Cut,
}

/// The file of a model, read and checked, not yet bound to a garment: for those who bind the
/// garment meanwhile.
#[derive(Debug)]
pub struct ModelFile {
    path: PathBuf,
    content: Content,
}

#[derive(Debug)]
enum Content {
    PoseSpace(Box<PoseSpace>),
    /// The bytes of a network.
    Network(Vec<u8>),
}

impl ModelFile {
    /// Reads a file of weights.
    ///
    /// # Errors
    ///
    /// [`CheckpointError`] by name: the file is truncated, altered, foreign or of another version;
    /// a network may say so only when it is [bound](Model::bind). [`CheckpointError::NoNetworks`]
    /// for a network without the feature `burn`.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, CheckpointError> {
        let path = path.as_ref();
        let bytes = weight_file::read(path)?;
        Ok(Self {
            path: path.to_path_buf(),
            content: if is_pose_space(&weight_file::schema(path, &bytes)?) {
                Content::PoseSpace(Box::new(PoseSpace::from_bytes(path, &bytes)?))
            } else {
                network::check(path)?;
                Content::Network(bytes)
            },
        })
    }
}

/// What the file of a model says about itself.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ModelHeader {
    /// Checksum of the file.
    pub checksum: String,
    /// What the network is made of, if there is one.
    pub config: Option<GarNetConfig>,
    /// The moment at which the model predicts the cloth.
    pub moment: Moment,
    /// The file, and that of the pose-space deformation that a network starts from.
    pub files: Vec<PathBuf>,
}

impl ModelHeader {
    /// Reads what a file says about itself, and checks no numbers.
    ///
    /// # Errors
    ///
    /// As [`Model::load`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self, CheckpointError> {
        let path = path.as_ref();
        let bytes = weight_file::read(path)?;
        let mut files = vec![path.to_path_buf()];
        if is_pose_space(&weight_file::schema(path, &bytes)?) {
            let header = weight_file::parse::<PoseSpaceHeader>(path, &bytes)?.header;
            return Ok(Self {
                checksum: header.checksum,
                config: None,
                moment: header.moment,
                files,
            });
        }
        let header = weight_file::parse::<CheckpointHeader>(path, &bytes)?.header;
        let start = header.config.start;
        files.extend(start.deformation().map(|moment| beside(path, moment)));
        Ok(Self {
            checksum: header.checksum,
            config: Some(header.config),
            moment: Moment::Rest,
            files,
        })
    }
}

/// Where the pose-space deformation is that a network starts from.
fn beside(path: &Path, moment: Moment) -> PathBuf {
    path.with_file_name(format!("{}.safetensors", deformation_name(moment)))
}

impl Model {
    /// Reads a file of weights and binds it to a garment that lies on a body at rest, in metres.
    /// The pose-space deformation that a network starts from is in the same folder.
    ///
    /// # Errors
    ///
    /// [`CheckpointError`] by name: the file is truncated, altered, foreign or of another version,
    /// or, as [`CheckpointError::Unfit`], of another garment; [`CheckpointError::OtherStart`] for a
    /// network that was trained on another pose-space deformation.
    pub fn load(
        path: impl AsRef<Path>,
        garment: GarmentGraph,
        template: &[Point3],
        rest_body: &[Point3],
    ) -> Result<Self, CheckpointError> {
        Self::bind(ModelFile::read(path)?, garment, template, rest_body)
    }

    /// Binds a file that was read to a garment that lies on a body at rest, in metres.
    ///
    /// # Errors
    ///
    /// As [`Model::load`].
    pub fn bind(
        file: ModelFile,
        garment: GarmentGraph,
        template: &[Point3],
        rest_body: &[Point3],
    ) -> Result<Self, CheckpointError> {
        let path = file.path.as_path();
        let bytes = match file.content {
            Content::PoseSpace(space) => {
                let space = fitting(path, *space, &garment)?;
                return Ok(Self {
                    range: Some(space.range.clone()),
                    pose_space: Some(space),
                    network: None,
                    cut: *garment.cut(),
                });
            }
            Content::Network(bytes) => bytes,
        };
        network::bound(path, bytes, garment, template, rest_body)
    }

    /// How the garment has to be brought to the body.
    pub fn warp(&self) -> Warp {
        self.config()
            .map_or(Warp::Shape, |config| config.start.warp())
    }

    /// The moment at which it predicts the cloth. A network predicts where it rests.
    pub fn moment(&self) -> Moment {
        match (&self.network, &self.pose_space) {
            (None, Some(space)) => space.moment,
            _ => Moment::Rest,
        }
    }

    /// What the network is made of, if there is one.
    pub fn config(&self) -> Option<&GarNetConfig> {
        let network = self.network.as_ref();
        network.map(Network::config)
    }

    /// Whether it asks for [`SceneInput::body_normals`].
    pub fn needs_body_normals(&self) -> bool {
        (self.config()).is_some_and(GarNetConfig::needs_body_normals)
    }

    /// Weights and operations of a prediction.
    ///
    /// # Errors
    ///
    /// [`NetError::Config`] where there are no vertices.
    pub fn cost(&self, num_vertices: usize) -> Result<Cost, NetError> {
        let mut sum = Cost {
            parameters: 0,
            flops: 0,
        };
        let network = self.network.as_ref();
        let network = network.map(|network| network.cost(num_vertices));
        let space = self.pose_space.as_ref().map(PoseSpace::cost);
        for cost in network.transpose()?.into_iter().chain(space) {
            sum.parameters += cost.parameters;
            sum.flops += cost.flops;
        }
        Ok(sum)
    }

    /// Whether it has learned garments that are cut like the one that it is bound to, and is told
    /// so.
    pub fn knows_cut(&self) -> bool {
        (self.pose_space.as_ref()).is_some_and(|space| space.knows(&self.cut))
    }

    /// The poses and shapes that it was trained on, if the file tells.
    pub fn range(&self) -> Option<&TrainedRange> {
        self.range.as_ref()
    }

    /// Memory kept between scenes, in bytes.
    pub fn num_bytes(&self) -> usize {
        let network = self.network.as_ref().map_or(0, Network::num_bytes);
        let space = self.pose_space.as_ref();
        network
            + space.map_or(0, |space| {
                size_of::<f32>() * space.cost().parameters as usize
            })
    }

    /// Another garment of the same topology, as [`Model::predict_on`] takes it: other places at
    /// rest, other sewing parameters.
    ///
    /// # Errors
    ///
    /// [`NetError::OtherGarment`], or [`NetError::Count`] for another number of sewing parameters.
    pub fn accepted(&self, garment: GarmentGraph) -> Result<GarmentGraph, NetError> {
        match &self.network {
            Some(network) => network.accepted(garment),
            None => Ok(garment),
        }
    }

    /// Predicts the vertices of a scene `[vertex]`, in metres.
    ///
    /// # Errors
    ///
    /// As [`PoseSpace::coefficients`] and [`PoseSpace::moved`]; those of a network are
    /// [`NetError::Diverged`] and those of its scene.
    pub fn predict(&self, input: &SceneInput<'_>) -> Result<Vec<Point3>, NetError> {
        self.run(None, input)
    }

    /// As [`Model::predict`], of a garment that [`Model::accepted`] has given.
    ///
    /// # Errors
    ///
    /// As [`Model::predict`].
    pub fn predict_on(
        &self,
        garment: &GarmentGraph,
        input: &SceneInput<'_>,
    ) -> Result<Vec<Point3>, NetError> {
        self.run(Some(garment), input)
    }

    /// All that goes into [`Model::predict`], or with a garment into [`Model::predict_on`], and
    /// what comes out, for other implementations.
    ///
    /// # Errors
    ///
    /// As [`Model::predict`].
    pub fn case(
        &self,
        garment: Option<&GarmentGraph>,
        input: &SceneInput<'_>,
    ) -> Result<ReferenceCase, NetError> {
        let mut case = ReferenceCase::of_input(input);
        if let Some(network) = &self.network {
            let started = self.started(garment, input)?;
            let warped = started.as_deref().unwrap_or(input.warped);
            network.add_to(&mut case, garment, &SceneInput { warped, ..*input })?;
        }
        case.points("output.positions", &self.run(garment, input)?);
        Ok(case)
    }

    /// Where the pose-space deformation moves the warped garment, if there is one.
    fn started(
        &self,
        garment: Option<&GarmentGraph>,
        input: &SceneInput<'_>,
    ) -> Result<Option<Vec<Point3>>, NetError> {
        let Some(space) = &self.pose_space else {
            return Ok(None);
        };
        let cut = garment.map_or(&self.cut, GarmentGraph::cut);
        let shares = space.coefficients(input.parameters, cut)?;
        space
            .moved(input.warped, input.rotations, &shares)
            .map(Some)
    }

    fn run(
        &self,
        garment: Option<&GarmentGraph>,
        input: &SceneInput<'_>,
    ) -> Result<Vec<Point3>, NetError> {
        let started = self.started(garment, input)?;
        let warped = started.as_deref().unwrap_or(input.warped);
        let input = SceneInput { warped, ..*input };
        match (&self.network, garment) {
            (Some(network), Some(garment)) => network.predict_on(garment, &input),
            (Some(network), None) => network.predict(&input),
            (None, _) => Ok(warped.to_vec()),
        }
    }
}

fn fitting(
    path: &Path,
    space: PoseSpace,
    garment: &GarmentGraph,
) -> Result<PoseSpace, CheckpointError> {
    let (expected, found) = (space.garment, garment.fingerprint());
    if expected == found {
        return Ok(space);
    }
    Err(CheckpointError::Unfit {
        path: path.to_path_buf(),
        source: NetError::OtherGarment { expected, found },
    })
}
