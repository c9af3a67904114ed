//! What is measured of a drape, and when it is broken.

use std::collections::BTreeSet;

use garnet_drape::BoundGarment;
use garnet_knn::{Surface, Traps};
use garnet_mesh::{Point3, Topology, TriMesh, vertex_normals};
use serde::{Deserialize, Serialize};

use crate::StressError;
use crate::method::Draped;
use crate::scene::Scene;

/// Edges longer than this over their length at rest break a drape.
const MOST_STRETCH: f32 = 3.0;

/// Cloth may move by this much more than the skin next to it, in the mean over what moves, metres a
/// degree.
const MOST_JUMP: f64 = 5e-3;

/// Vertices that move by less do not count as moved, in metres.
const LEAST_STEP: f32 = 1e-3;

/// More of a lining than this is not under its layer, or more of the faces of one of two garments
/// cross the other one, and the order is lost.
const MOST_OUT_OF_ORDER: f64 = 0.01;

/// A scene takes longer than this in seconds, and it has failed.
const MOST_SECONDS: f64 = 10.0;

/// What is measured of a drape.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Measured {
    /// Vertices that are inside the body and not trapped by it.
    pub inside: usize,
    /// The deepest of them, in metres.
    pub deepest: f32,
    /// Vertices that are trapped.
    pub trapped: usize,
    /// The largest length of an edge over that at rest, away from trapped vertices.
    pub stretch: f32,
    /// Faces that cross the skin away from trapped vertices; none if the method does not tell.
    pub crossing_faces: Option<usize>,
    /// Mean distance to the simulator's drape of the scene, in metres, if there is one.
    pub from_simulator: Option<f64>,
    /// By how much cloth moved more than the skin, in metres a degree, since the level before.
    pub jump: Option<f64>,
    /// Share of the vertices of a lining that are not under their layer, or of the faces of one of
    /// two garments that cross the other one, whichever is more; none of one layer.
    pub out_of_order: Option<f64>,
    /// How long it took.
    pub seconds: f64,
}

/// Why a drape is broken.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Broken {
    /// A coordinate is no number.
    NotFinite,
    /// So many free vertices are inside the body.
    Inside(usize),
    /// An edge is so many times as long as at rest.
    Torn(f32),
    /// Cloth moved by so much more than the skin, in metres a degree.
    Jump(f64),
    /// So much of a lining is not under its layer, or of a garment runs through another one.
    Order(f64),
    /// Relative to the size of the garment, it is so far from what it has to be.
    Differs(f64),
    /// It took so many seconds.
    Slow(f64),
    /// It was refused, or failed.
    Failed(String),
}

impl std::fmt::Display for Broken {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotFinite => formatter.write_str("not finite"),
            Self::Inside(count) => write!(formatter, "{count} inside"),
            Self::Torn(stretch) => write!(formatter, "stretched {stretch:.1} times"),
            Self::Jump(jump) => write!(formatter, "jumps {:.0} mm a degree", 1e3 * jump),
            Self::Order(share) => write!(formatter, "{:.0} % out of order", 100.0 * share),
            Self::Differs(share) => write!(formatter, "differs by {share:.0e}"),
            Self::Slow(seconds) => write!(formatter, "takes {seconds:.0} s"),
            Self::Failed(reason) => write!(formatter, "fails: {reason}"),
        }
    }
}

/// Judges a drape by its scene alone: inside is decided by the winding of the whole body, whatever
/// the method says of itself.
pub(crate) fn measured(scene: &Scene, draped: &Draped) -> Result<Option<Measured>, StressError> {
    let positions = &draped.positions;
    if !positions
        .iter()
        .all(|place| place.coords.iter().all(|x| x.is_finite()))
    {
        return Ok(None);
    }
    let skin = scene.judge();
    let trapped = if let Some(told) = &draped.is_trapped {
        told.clone()
    } else {
        let traps = Traps::near(skin, positions, scene.garment.cloth().scale())?;
        let closest = skin.closest_all(positions);
        closest.iter().map(|found| traps.holds(found)).collect()
    };
    let inside = skin.contains_all(positions);
    let free = (0..positions.len()).filter(|&vertex| inside[vertex] && !trapped[vertex]);
    let free: Vec<Point3> = free.map(|vertex| positions[vertex]).collect();
    let depths = skin.closest_all(&free);
    let depths = depths.iter().map(|found| found.distance_squared.sqrt());
    Ok(Some(Measured {
        inside: free.len(),
        deepest: depths.fold(0.0, f32::max),
        trapped: trapped.iter().filter(|&&is| is).count(),
        stretch: stretch(scene, positions, &trapped),
        crossing_faces: draped.crossing_faces,
        out_of_order: out_of_order(scene, positions)?,
        seconds: draped.seconds,
        ..Measured::default()
    }))
}

/// The largest stretch of an edge without a trapped end.
fn stretch(scene: &Scene, positions: &[Point3], trapped: &[bool]) -> f32 {
    let mesh = scene.garment.mesh();
    let topology = Topology::new(mesh.num_vertices(), mesh.faces());
    let rest = mesh.positions();
    let mut largest = 0.0_f32;
    for edge in topology.edges() {
        let [a, b] = edge.map(|vertex| vertex as usize);
        if trapped[a] || trapped[b] {
            continue;
        }
        // What is a point at rest has no stretch.
        let before = (rest[a] - rest[b]).norm().max(scene.least_edge());
        largest = largest.max((positions[a] - positions[b]).norm() / before);
    }
    largest
}

/// How much of two layers is not in order; none of one layer.
fn out_of_order(scene: &Scene, positions: &[Point3]) -> Result<Option<f64>, StressError> {
    if let Some([outer, inner]) = &scene.garments {
        let (over, under) = positions.split_at(outer.mesh().num_vertices());
        let surface = |places: &[Point3], garment: &BoundGarment| {
            TriMesh::new(places.to_vec(), garment.mesh().faces().to_vec())
                .map(|mesh| Surface::new(&mesh))
        };
        let [over, under] = [surface(over, outer)?, surface(under, inner)?];
        return Ok(Some(crossing_share(&over, &under)));
    }
    let beyond = |count| beyond_lining(scene, positions, count);
    Ok(scene.num_outer.map(beyond))
}

/// Share of the lining's vertices that are not on the inner side of their outer vertex.
fn beyond_lining(scene: &Scene, positions: &[Point3], num_outer: usize) -> f64 {
    let normals = vertex_normals(positions, scene.garment.mesh().faces());
    let (outer, lining) = positions.split_at(num_outer);
    let pairs = outer.iter().zip(lining).zip(&normals);
    let beyond = pairs.filter(|((outer, under), normal)| (*outer - *under).dot(normal) < 0.0);
    beyond.count() as f64 / num_outer.max(1) as f64
}

/// Share of the faces that cross the other surface, of the one with the larger share.
fn crossing_share(outer: &Surface, inner: &Surface) -> f64 {
    let crossings = outer.intersections(inner);
    let share = |side: usize, all: usize| {
        let faces: BTreeSet<u32> = crossings.iter().map(|pair| pair[side]).collect();
        faces.len() as f64 / all.max(1) as f64
    };
    share(0, outer.faces().len()).max(share(1, inner.faces().len()))
}

/// By how much cloth moved more than the skin next to it from one level to the next, in the mean
/// over the vertices that moved, in metres a degree.
pub(crate) fn jump(
    [before, after]: [&[Point3]; 2],
    [scene_before, scene_after]: [&Scene; 2],
    degrees: f64,
) -> f64 {
    let (skin, moved_skin) = (scene_before.posed.skin(), scene_after.posed.skin());
    let mut sum = 0.0;
    let mut count = 0;
    for ((before, after), found) in before.iter().zip(after).zip(skin.closest_all(before)) {
        let step = (after - before).norm();
        let corners = skin.faces()[found.face as usize].map(|corner| corner as usize);
        let mut of_skin = Vector::zeros();
        for (corner, share) in corners.into_iter().zip(found.barycentric) {
            of_skin += share * (moved_skin.positions()[corner] - skin.positions()[corner]);
        }
        if step > LEAST_STEP {
            sum += f64::from((step - of_skin.norm()).max(0.0));
            count += 1;
        }
    }
    sum / f64::from(count.max(1)) / degrees.max(1e-9)
}

type Vector = garnet_mesh::Vector3;

/// Which invariant a drape breaks, if any; the gravest first.
pub(crate) fn broken(found: &Measured, jump_of_simulator: Option<f64>) -> Option<Broken> {
    let allowed = jump_of_simulator.map_or(MOST_JUMP, |jump| jump.max(MOST_JUMP));
    let jump = found.jump.filter(|jump| *jump > allowed);
    if found.inside > 0 {
        Some(Broken::Inside(found.inside))
    } else if found.stretch > MOST_STRETCH {
        Some(Broken::Torn(found.stretch))
    } else if let Some(share) = found
        .out_of_order
        .filter(|share| *share > MOST_OUT_OF_ORDER)
    {
        Some(Broken::Order(share))
    } else if let Some(jump) = jump {
        Some(Broken::Jump(jump))
    } else if found.seconds > MOST_SECONDS {
        Some(Broken::Slow(found.seconds))
    } else {
        None
    }
}
