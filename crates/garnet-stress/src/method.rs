//! The ways to drape that are compared.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use garnet_drape::{BodyPath, BoundGarment, DrapeOptions, Draper, Outfit, Package, Quality};
use garnet_knn::{Traps, VertexTree};
use garnet_mesh::{Point3, Vector3, vertex_normals};
use garnet_skin::{DualQuaternion, Warp};
use serde::Serialize;

use crate::StressError;
use crate::scene::Scene;

/// A way to drape.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Method {
    /// Linear skinning by the weights of the nearest vertex of the body.
    NearestLinear,
    /// Linear skinning by weights that are smoothed over the cloth.
    Linear,
    /// Dual-quaternion skinning that takes signs as they come.
    UnsignedDualQuaternion,
    /// The warp: dual-quaternion skinning and the change of shape.
    Warp,
    /// The warp, then every vertex is pushed out along the normal of the nearest vertex of the
    /// body.
    PushOut,
    /// The warp, untangled.
    Untangled,
    /// A variant of the package, untangled.
    Variant(String),
    /// The simulator, in the quality `fast`.
    Simulator,
}

impl fmt::Display for Method {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::NearestLinear => "linear, nearest weights",
            Self::Linear => "linear",
            Self::UnsignedDualQuaternion => "dual quaternions, unsigned",
            Self::Warp => "warp",
            Self::PushOut => "warp, pushed out",
            Self::Untangled => "warp, untangled",
            Self::Variant(name) => name,
            Self::Simulator => "simulator",
        })
    }
}

impl Method {
    /// Those that do not know cloth.
    pub const CLASSIC: [Self; 5] = [
        Self::NearestLinear,
        Self::Linear,
        Self::UnsignedDualQuaternion,
        Self::Warp,
        Self::PushOut,
    ];

    /// Whether it is to hold up to the bar of each axis.
    pub const fn is_ours(&self) -> bool {
        matches!(self, Self::Untangled | Self::Variant(_))
    }

    /// Whether it drapes the garment of the package alone.
    pub(crate) const fn is_of_package(&self) -> bool {
        matches!(self, Self::Variant(_) | Self::Simulator)
    }
}

/// A drape, before it is judged.
#[derive(Debug)]
pub(crate) struct Draped {
    /// `[vertex]`, in metres.
    pub(crate) positions: Vec<Point3>,
    /// Vertices that are told as caught by the body `[vertex]`; none if the method does not tell.
    pub(crate) is_trapped: Option<Vec<bool>>,
    pub(crate) crossing_faces: Option<usize>,
    /// Why another method drapes in place of the network.
    pub(crate) fallback: Option<String>,
    pub(crate) seconds: f64,
}

/// Drapes scenes by one method.
pub(crate) struct Way<'a> {
    pub(crate) method: Method,
    package: &'a Package,
    /// Of a variant.
    draper: Option<Draper>,
}

impl<'a> Way<'a> {
    pub(crate) fn new(package: &'a Package, method: Method) -> Result<Self, StressError> {
        let draper = match &method {
            Method::Variant(name) => Some(package.draper(name)?),
            _ => None,
        };
        Ok(Self {
            method,
            package,
            draper,
        })
    }

    pub(crate) fn drape(&self, scene: &Scene, stop: &AtomicBool) -> Result<Draped, StressError> {
        let start = Instant::now();
        let mut draped = match &self.method {
            Method::NearestLinear => plain(nearest_linear(scene)?),
            Method::Linear => plain(warped(scene, Warp::Linear)?),
            Method::UnsignedDualQuaternion => plain(unsigned(scene)),
            Method::Warp => plain(warped(scene, Warp::Shape)?),
            Method::PushOut => plain(pushed_out(scene)?),
            Method::Untangled => match &scene.garments {
                Some(garments) => outfit(garments, scene, stop)?,
                None => by(&Draper::new(Arc::clone(&scene.garment)), scene, stop)?,
            },
            Method::Variant(name) => match (&scene.package, &self.draper) {
                (Some(package), _) => by(&package.draper(name)?, scene, stop)?,
                (None, Some(draper)) => by(draper, scene, stop)?,
                (None, None) => return Err(StressError::NoVariant),
            },
            Method::Simulator => {
                simulated(scene.package.as_ref().unwrap_or(self.package), scene, stop)?
            }
        };
        draped.seconds = start.elapsed().as_secs_f64();
        Ok(draped)
    }
}

fn plain(positions: Vec<Point3>) -> Draped {
    Draped {
        positions,
        is_trapped: None,
        crossing_faces: None,
        fallback: None,
        seconds: 0.0,
    }
}

fn by(draper: &Draper, scene: &Scene, stop: &AtomicBool) -> Result<Draped, StressError> {
    let options = draper.options().with_clearance(scene.clearance);
    let draper = draper.clone().with_options(options);
    let drape = draper.drape_until(&scene.posed, stop)?;
    Ok(Draped {
        positions: drape.positions,
        is_trapped: Some(drape.is_trapped),
        crossing_faces: drape.report.map(|report| report.crossing_faces),
        fallback: drape.provenance.fallback.map(|reason| reason.to_string()),
        seconds: 0.0,
    })
}

/// Two garments, the inner one put on first.
fn outfit(
    [outer, inner]: &[Arc<BoundGarment>; 2],
    scene: &Scene,
    stop: &AtomicBool,
) -> Result<Draped, StressError> {
    let mut outfit = Outfit::default();
    for garment in [inner, outer] {
        let draper = Draper::new(Arc::clone(garment));
        let options = draper.options().with_clearance(scene.clearance);
        let draper = draper.with_options(options);
        let wearer = outfit.wearer_for(&draper, scene.posed.clone())?;
        let drape = draper.drape_until(&outfit.body_for(&draper, &wearer)?, stop)?;
        outfit.put_on(draper, wearer, drape)?;
    }
    outfit.free()?;
    let mut positions = Vec::new();
    let mut is_trapped = Vec::new();
    for drape in outfit.into_drapes().into_iter().rev() {
        positions.extend(drape.positions);
        is_trapped.extend(drape.is_trapped);
    }
    Ok(Draped {
        is_trapped: Some(is_trapped),
        ..plain(positions)
    })
}

fn warped(scene: &Scene, warp: Warp) -> Result<Vec<Point3>, StressError> {
    let options = DrapeOptions::default().with_warp(warp).without_untangling();
    let draper = Draper::new(Arc::clone(&scene.garment)).with_options(options);
    Ok(draper.drape(&scene.posed)?.positions)
}

fn nearest_linear(scene: &Scene) -> Result<Vec<Point3>, StressError> {
    let body = scene.garment.body();
    let tree = VertexTree::new(body.rest().positions())?;
    let transforms = scene.posed.posed_from_rest();
    let moved = |place: &Point3| {
        let nearest = tree.nearest(*place).map_or(0, |found| found.index as usize);
        let mut sum = Vector3::zeros();
        for (joint, weight) in body.weights().vertex(nearest) {
            sum += weight * (transforms[joint] * place).coords;
        }
        Point3::from(sum)
    };
    Ok(scene.garment.mesh().positions().iter().map(moved).collect())
}

fn unsigned(scene: &Scene) -> Vec<Point3> {
    let cloth = scene.garment.cloth();
    let transforms = scene.posed.posed_from_rest().iter();
    let transforms: Vec<_> = transforms.map(DualQuaternion::from_isometry).collect();
    let nodes = cloth.rest_nodes().iter().enumerate().map(|(node, place)| {
        let mut sum: Option<DualQuaternion> = None;
        for (joint, weight) in cloth.weights().vertex(node) {
            let part = transforms[joint];
            let (real, dual) = (part.real * weight, part.dual * weight);
            sum = Some(match sum {
                None => DualQuaternion { real, dual },
                Some(sum) => DualQuaternion {
                    real: sum.real + real,
                    dual: sum.dual + dual,
                },
            });
        }
        let blend = sum.and_then(DualQuaternion::normalized);
        blend.map_or(*place, |blend| blend.transform_point(place))
    });
    cloth.weld().scatter(&nodes.collect::<Vec<Point3>>())
}

/// The usual post-process: one pass along the normals of the nearest vertices.
fn pushed_out(scene: &Scene) -> Result<Vec<Point3>, StressError> {
    let skin = scene.posed.skin();
    let normals = vertex_normals(skin.positions(), skin.faces());
    let tree = VertexTree::new(skin.positions())?;
    let mut positions = warped(scene, Warp::Shape)?;
    for place in &mut positions {
        let Some(found) = tree.nearest(*place) else {
            continue;
        };
        let nearest = found.index as usize;
        let height = (*place - skin.positions()[nearest]).dot(&normals[nearest]);
        if height < scene.clearance {
            *place += (scene.clearance - height) * normals[nearest];
        }
    }
    Ok(positions)
}

fn simulated(package: &Package, scene: &Scene, stop: &AtomicBool) -> Result<Draped, StressError> {
    let simulator = package.simulator()?;
    let home = scene.posed.at_home(package.body())?;
    let path = BodyPath::to_posed(package.body(), home.body());
    let result = simulator.drape(&path, Quality::Fast, stop, &mut |_| {})?;
    let positions = home.to_target(result.positions);
    let skin = scene.posed.skin();
    let traps = Traps::near(skin, &positions, scene.garment.cloth().scale())?;
    let closest = skin.closest_all(&positions);
    Ok(Draped {
        is_trapped: Some(closest.iter().map(|found| traps.holds(found)).collect()),
        positions,
        crossing_faces: None,
        fallback: None,
        seconds: 0.0,
    })
}
