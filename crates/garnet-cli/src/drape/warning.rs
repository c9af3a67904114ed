//! What may be wrong with inputs and outputs although the work was done.

use std::{
    collections::HashSet,
    fmt,
    path::{Path, PathBuf},
};

use garnet::{
    Body, BoundGarment, Point3, Provenance, TriMesh,
    data::{Limits, SceneReport},
    io::{empty_sleeves, threaded_openings},
    knn::Surface,
    mesh::{Bounds, MeshDiagnosis, diagnose},
    package::Moment,
    untangle::{UntangleReport, free_crossing_faces},
};

use super::{
    report::{PenetrationReport, WarningReport},
    strained::{Strained, torn_where_caught},
};

/// What may be wrong with a file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Warning {
    pub(crate) path: PathBuf,
    pub(crate) problem: Problem,
}

/// All that is warned of.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Problem {
    UnusedVertices(usize),
    DuplicateVertices(usize),
    /// Vertices on the rims of a garment that rounding has moved off those that they are one with.
    NearVertices(usize),
    ZeroAreaFaces(usize),
    /// Faces with 1 or 2 corners, which are no cloth.
    SmallFaces(usize),
    /// So many vertices of the garment are those of the body.
    HoldsBody(usize),
    DuplicateFaces(usize),
    NonManifoldEdges(usize),
    InconsistentEdges(usize),
    Components(usize),
    OpenBody(usize),
    /// So many vertices of the garment lie over holes of the body, and the share that they are.
    OverHoles(usize, f32),
    SelfIntersectingBody(usize),
    /// The faces of the body looked inwards.
    InsideOutBody,
    /// So much of the garment looks towards the skin, from 0 to 1.
    InsideOutGarment(f32),
    /// The body is so small, in metres, that its file may be in inches or feet.
    SmallBody(f32),
    /// The body is smaller than any doll: its height in metres.
    TinyBody(f32),
    /// So many faces of the body looked inwards.
    TurnedFaces(usize),
    /// A limb is out of the cloth that is round it at rest: its joint, and what share of it.
    LimbOutside(String, f32),
    /// Edges are longer than cloth can be, over their length at rest.
    Torn(Strained),
    /// The same of an edge at a vertex that is caught where the body runs through itself.
    TornWhereCaught(f32),
    /// What 1 % of the edges exceed, over their length at rest.
    Tight(Strained),
    /// The garment starts inside the rest body: how many vertices deeper than the limit, and the
    /// deepest in metres.
    StartsInside {
        count: usize,
        limit: f32,
        deepest: f32,
    },
    /// So many openings of the garment have no limb through them, of how many.
    Unthreaded(usize, usize),
    /// So many more pairs of faces of a garment with layers run through each other than at rest.
    LayersCross(usize),
    /// No limb goes through a sleeve: the joint nearest to its opening, and its middle, in metres.
    EmptySleeve(String, Point3),
    /// Faces of the garment that cross the skin of the rest body.
    CrossingAtRest(usize),
    Trapped(usize),
    Squeezed(usize),
    BelowClearance(usize, f32),
    CrossingFaces(usize),
    /// The same of cloth that was not untangled.
    CrossingUntouched(usize),
    /// What share of the simulated vertices still moves.
    Moving(f32),
    /// Cloth is left in the body: how many vertices, and the deepest in metres.
    Inside(usize, f32),
    /// The garment is not cut for its wearer, and why.
    NotCut(String),
    /// Where the size that was asked for does not fit.
    Misfit(String),
    /// A variant has learned another cut of the garment: its name.
    OtherCut(String),
    /// The target was fitted with this error, in metres.
    PoorFit(f32),
    /// The body lies along z.
    Lies,
    /// The network was not used, and why, and whether the whole motion was simulated in its place.
    Fallback(String, bool),
    /// What of the body a network does not know: it predicts the nearest that it knows.
    Beyond(String),
    /// The cloth was left where the network put it, and why.
    Unsettled(String),
    /// So much of the cloth still falls, from 0 to 1.
    Falling(f32),
    /// So much of the cloth was left where it was put, from 0 to 1.
    PartlySettled(f32),
    /// The reference solver has not brought the cloth into balance in so many steps, and the
    /// largest force left over, in mean weights of a vertex.
    OutOfBalance(usize, f64),
}

impl Problem {
    /// The name of the problem in reports.
    pub(crate) fn kind(&self) -> &'static str {
        match self {
            Self::UnusedVertices(_) => "unused_vertices",
            Self::DuplicateVertices(_) => "duplicate_vertices",
            Self::NearVertices(_) => "near_vertices",
            Self::ZeroAreaFaces(_) => "zero_area_faces",
            Self::SmallFaces(_) => "small_faces",
            Self::HoldsBody(_) => "holds_body",
            Self::DuplicateFaces(_) => "duplicate_faces",
            Self::NonManifoldEdges(_) => "non_manifold_edges",
            Self::InconsistentEdges(_) => "inconsistent_edges",
            Self::Components(_) => "components",
            Self::OpenBody(_) => "open_body",
            Self::OverHoles(..) => "over_holes",
            Self::SelfIntersectingBody(_) => "self_intersecting_body",
            Self::InsideOutBody => "inside_out_body",
            Self::InsideOutGarment(_) => "inside_out_garment",
            Self::SmallBody(_) => "small_body",
            Self::TinyBody(_) => "tiny_body",
            Self::TurnedFaces(_) => "turned_faces",
            Self::LimbOutside(..) => "limb_outside",
            Self::Torn(_) => "torn",
            Self::TornWhereCaught(_) => "torn_where_caught",
            Self::Tight(_) => "tight",
            Self::StartsInside { .. } => "starts_inside",
            Self::Unthreaded(..) => "unthreaded",
            Self::LayersCross(_) => "layers_cross",
            Self::EmptySleeve(..) => "empty_sleeve",
            Self::CrossingAtRest(_) => "crossing_at_rest",
            Self::Trapped(_) => "trapped",
            Self::Squeezed(_) => "squeezed",
            Self::BelowClearance(..) => "below_clearance",
            Self::CrossingFaces(_) | Self::CrossingUntouched(_) => "crossing_faces",
            Self::Moving(_) => "moving",
            Self::Inside(..) => "inside",
            Self::NotCut(_) => "not_cut",
            Self::Misfit(_) => "misfit",
            Self::OtherCut(_) => "other_cut",
            Self::PoorFit(_) => "poor_fit",
            Self::Lies => "lies",
            Self::Fallback(..) => "fallback",
            Self::Beyond(_) => "beyond_training",
            Self::Unsettled(_) => "unsettled",
            Self::Falling(_) => "falling",
            Self::PartlySettled(_) => "partly_settled",
            Self::OutOfBalance(..) => "out_of_balance",
        }
    }

    /// How many there are, where it is a number of things.
    pub(crate) fn count(&self) -> Option<usize> {
        match *self {
            Self::UnusedVertices(count)
            | Self::DuplicateVertices(count)
            | Self::NearVertices(count)
            | Self::ZeroAreaFaces(count)
            | Self::SmallFaces(count)
            | Self::HoldsBody(count)
            | Self::DuplicateFaces(count)
            | Self::NonManifoldEdges(count)
            | Self::InconsistentEdges(count)
            | Self::Components(count)
            | Self::OpenBody(count)
            | Self::OverHoles(count, _)
            | Self::SelfIntersectingBody(count)
            | Self::TurnedFaces(count)
            | Self::StartsInside { count, .. }
            | Self::Unthreaded(count, _)
            | Self::CrossingAtRest(count)
            | Self::Trapped(count)
            | Self::LayersCross(count)
            | Self::Squeezed(count)
            | Self::BelowClearance(count, _)
            | Self::CrossingFaces(count)
            | Self::CrossingUntouched(count)
            | Self::Inside(count, _) => Some(count),
            Self::InsideOutBody
            | Self::InsideOutGarment(_)
            | Self::EmptySleeve(..)
            | Self::SmallBody(_)
            | Self::TinyBody(_)
            | Self::LimbOutside(..)
            | Self::Torn(_)
            | Self::TornWhereCaught(_)
            | Self::Tight(_)
            | Self::Moving(_)
            | Self::NotCut(_)
            | Self::Misfit(_)
            | Self::OtherCut(_)
            | Self::PoorFit(_)
            | Self::Lies
            | Self::Fallback(..)
            | Self::Beyond(_)
            | Self::Unsettled(_)
            | Self::Falling(_)
            | Self::PartlySettled(_)
            | Self::OutOfBalance(..) => None,
        }
    }

    /// How bad it is beside others of its kind.
    fn severity(&self) -> f64 {
        match *self {
            Self::Torn(Strained { stretch, .. }) | Self::Tight(Strained { stretch, .. }) => {
                stretch.into()
            }
            Self::TornWhereCaught(value)
            | Self::Moving(value)
            | Self::PoorFit(value)
            | Self::Inside(_, value)
            | Self::LimbOutside(_, value)
            | Self::InsideOutGarment(value)
            | Self::Falling(value)
            | Self::PartlySettled(value)
            | Self::StartsInside { deepest: value, .. } => value.into(),
            Self::OutOfBalance(_, residual) => residual,
            _ => self.count().unwrap_or(0) as f64,
        }
    }
}

impl fmt::Display for Warning {
    #[expect(clippy::too_many_lines, reason = "a text for each problem")]
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let path = self.path.display();
        let of = |count: usize, [one, many]: [&str; 2], [is, are]: [&str; 2]| match count {
            1 => format!("1 {one} of `{path}` {is}"),
            _ => format!("{count} {many} of `{path}` {are}"),
        };
        let vertices = |count, verbs| of(count, ["vertex", "vertices"], verbs);
        let faces = |count, verbs| of(count, ["face", "faces"], verbs);
        let edges = |count| of(count, ["edge", "edges"], ["has", "have"]);
        let (is, has) = (["is", "are"], ["has", "have"]);
        let text = match self.problem {
            Problem::UnusedVertices(count) => {
                vertices(count, ["belongs", "belong"]) + " to no face"
            }
            Problem::DuplicateVertices(count) => {
                vertices(count, is) + " at the place of another and moved with it"
            }
            Problem::NearVertices(count) => {
                vertices(count, is) + " within rounding of another on its rim: sewn to it"
            }
            Problem::ZeroAreaFaces(count) => faces(count, has) + " no area",
            Problem::SmallFaces(count) => {
                faces(count, has) + " 1 or 2 corners: kept in the file, left out of the cloth"
            }
            Problem::HoldsBody(count) => vertices(count, ["lies", "lie"]) + ON_BODY,
            Problem::DuplicateFaces(count) => faces(count, has) + " the vertices of another",
            Problem::NonManifoldEdges(count) => edges(count) + " more than two faces",
            Problem::InconsistentEdges(count) => {
                edges(count) + " faces that look to different sides"
            }
            Problem::Components(count) => {
                format!("`{path}` is made of {count} parts that share no vertex")
            }
            Problem::OpenBody(count) => format!(
                "the body `{path}` is open (rims: {count}): its holes are closed for what cloth lies \
                 on and what is inside"
            ),
            Problem::OverHoles(count, share) => {
                vertices(count, ["lies", "lie"]) + &over_holes(share)
            }
            Problem::SelfIntersectingBody(count) => {
                format!("the body `{path}` runs through itself (pairs of faces: {count})")
            }
            Problem::InsideOutBody => format!("the body `{path}` {INSIDE_OUT}"),
            Problem::InsideOutGarment(share) => format!(
                "`{path}` is inside out: {:.0} % of its faces look towards the body, as its normals do; it is draped as it is worn, and the faces of the file are kept",
                100.0 * share
            ),
            Problem::SmallBody(height) => format!(
                "the body `{path}` is taken to be {:.0} cm tall; if its file is in inches or feet, \
                 say so by `--units in` or `--units ft`",
                100.0 * height
            ),
            Problem::TinyBody(height) => format!(
                "the body `{path}` is {:.1} mm tall: its file may be in another unit (`--units`)",
                1000.0 * height
            ),
            Problem::TurnedFaces(count) => format!(
                "{count} faces of the body `{path}` look inwards, and are taken the other way round"
            ),
            Problem::LimbOutside(ref joint, share) => format!(
                "`{joint}` has come out of the cloth that is round it at rest, in `{path}`: {:.0} % of \
                 its skin",
                100.0 * share
            ),
            Problem::Torn(strained) => strained.torn(&self.path),
            Problem::TornWhereCaught(stretch) => torn_where_caught(&self.path, stretch),
            Problem::Tight(strained) => strained.tight(&self.path),
            Problem::StartsInside {
                count,
                limit,
                deepest,
            } => vertices(count, ["starts", "start"]) + &too_deep(limit, deepest),
            Problem::Unthreaded(count, openings) => format!(
                "no limb of the body goes through {count} of the {openings} openings of `{path}`: it may \
                 lie elsewhere than on the body. `--place` looks for its place; where that finds none, \
                 `--rest-body` names the body that it was made on"
            ),
            Problem::LayersCross(count) => format!(
                "cloth of `{path}` runs through cloth that lies on it: {count} pairs of faces more \
                 than at rest (`garnet render --color-by problems` shows where)"
            ),
            Problem::EmptySleeve(ref joint, center) => empty_sleeve(&self.path, joint, center),
            Problem::CrossingAtRest(count) => faces(count, ["crosses", "cross"]) + AT_REST,
            Problem::Trapped(count) => {
                vertices(count, is) + " caught where the body runs through itself"
            }
            Problem::Squeezed(count) => {
                vertices(count, is)
                    + " nearer to the skin than the clearance, between parts of the body that \
                       leave no more room"
            }
            Problem::BelowClearance(count, least) => {
                let least = millimetres(least);
                vertices(count, is)
                    + &format!(" nearer to the skin than the clearance, the nearest {least} mm")
            }
            Problem::CrossingFaces(count) => faces(count, ["crosses", "cross"]) + CROSSING,
            Problem::CrossingUntouched(count) => faces(count, ["crosses", "cross"]) + LIFTED_BY,
            Problem::Moving(share) => still_moving(&self.path, share),
            Problem::Inside(count, deepest) => {
                let deepest = millimetres(deepest);
                vertices(count, is) + &format!(" left inside the body, the deepest {deepest} mm")
            }
            Problem::OtherCut(ref variant) => format!(
                "`{variant}` has learned the garment of `{path}` as it is, not in this cut, which \
                 it drapes less exactly; `--method sim` simulates it"
            ),
            Problem::Misfit(ref reason) => format!("{reason} (`{path}`)"),
            Problem::NotCut(ref reason) => {
                format!("`{path}` is not cut for its wearer, as it should be: {reason}")
            }
            Problem::PoorFit(residual) => format!(
                "the body of `{path}` is not the rest body in another pose: a vertex is {} mm from \
                 where the skeleton puts it",
                millimetres(residual)
            ),
            Problem::Lies => format!(
                "the body of `{path}` lies along z, and gravity pulls along -y; if it stands, name the \
                 axis that points up in its file by `--up`"
            ),
            Problem::Beyond(ref reason) => format!(
                "the network knows the body of `{path}` in part: {reason}; it predicts the nearest that \
                 it knows, which is less accurate"
            ),
            Problem::Fallback(ref reason, true) => {
                format!("`{path}` is simulated all the way from the body at rest: {reason}")
            }
            Problem::Fallback(ref reason, false) => format!(
                "the network is not used on `{path}`, and the warp by pose and shape is: {reason}"
            ),
            Problem::Unsettled(ref reason) => {
                format!("`{path}` is not settled by simulation: {reason}")
            }
            Problem::Falling(share) => falling(&self.path, share),
            Problem::PartlySettled(share) => format!(
                "{:.0} % of `{path}` is where it was before it settled, which would have brought it \
                 into the skin or stretched it there",
                (100.0 * share).ceil()
            ),
            Problem::OutOfBalance(steps, residual) => out_of_balance(&self.path, steps, residual),
        };
        formatter.write_str(&text)
    }
}

/// What vertices do that are those of the body.
const ON_BODY: &str = " on the skin as those of the body do: one part of the garment is the body \
                       itself, and is draped like a suit; export the garment without it";

/// What faces do that cross the skin.
const CROSSING: &str = " the skin between vertices that are outside";

/// What faces do that cross the skin of the rest body.
const AT_REST: &str = " the skin of the rest body, which looks out through the cloth there";

/// What to do about those of cloth that was not untangled.
const LIFTED_BY: &str = " the skin: `garnet drape --method sim` simulates, too, and frees them";

/// What is done with a body whose faces look inwards.
const INSIDE_OUT: &str = "is inside out: its faces look inwards, and are taken the other way round";

fn over_holes(share: f32) -> String {
    let share = 1e2 * share;
    format!(
        " over holes of the body ({share:.1} % of the garment): skin is missing there, and the \
         cloth follows the bones and the rims of the holes"
    )
}

fn too_deep(limit: f32, deepest: f32) -> String {
    format!(
        " more than {} mm inside the rest body, the deepest {} mm: the garment may belong to \
         another body",
        short_millimetres(limit),
        millimetres(deepest)
    )
}

fn still_moving(path: &Path, share: f32) -> String {
    let [share, limit] = [share, Limits::default().moving].map(|share| 100.0 * share);
    let path = path.display();
    format!(
        "{share:.1} % of the vertices of `{path}` still move by more than 5 mm/s: of settled cloth \
         {limit:.1} % do at most"
    )
}

fn falling(path: &Path, share: f32) -> String {
    let (path, share) = (path.display(), 100.0 * share);
    format!(
        "{share:.0} % of `{path}` still falls when its frames are over: nothing holds it on the body \
         in this pose, or it needs more (`--settle FRAMES`)"
    )
}

fn out_of_balance(path: &Path, steps: usize, residual: f64) -> String {
    let path = path.display();
    format!(
        "`{path}` is not in balance after {steps} steps of the reference solver: a force of \
         {residual:.2} mean weights of a vertex is left on one"
    )
}

fn empty_sleeve(path: &Path, joint: &str, Point3 { coords }: Point3) -> String {
    let [x, y, z] = coords.into();
    let path = path.display();
    format!(
        "no limb goes through the sleeve of `{path}` that ends at {x:.2} {y:.2} {z:.2} m, beside \
         `{joint}` of the rest body: `--place` brings sleeves to their limbs, or `--rest-body` names \
         the body that the garment was made on"
    )
}

/// Millimetres without a decimal where they are many.
fn short_millimetres(metres: f32) -> String {
    let decimals = usize::from(metres < 0.01);
    format!("{:.decimals$}", 1e3 * metres)
}

fn millimetres(metres: f32) -> String {
    format!("{:.1}", 1e3 * metres)
}

impl From<&Warning> for WarningReport {
    fn from(warning: &Warning) -> Self {
        Self {
            kind: warning.problem.kind(),
            path: warning.path.display().to_string(),
            count: warning.problem.count(),
            text: warning.to_string(),
            severity: warning.problem.severity(),
        }
    }
}

/// A garment whose vertices are deeper than this in the rest body may belong to another, in metres
/// of limbs as thick as a person's.
const MAX_START_DEPTH: f32 = 0.03;

/// A target that differs from the posed rest body by more than a change of shape does, in metres.
const MAX_RESIDUAL: f32 = 0.15;

/// What is unusual about a garment and its body, read from `paths`, and about where it lies.
pub(crate) fn warnings_of(paths: [&Path; 2], garment: &BoundGarment) -> Vec<WarningReport> {
    let problems = of_garment(garment.mesh()).into_iter();
    let problems = problems.chain(of_start(garment)).chain(of_holes(garment));
    let problems = problems.chain(of_openings(garment.mesh(), garment.body()));
    let problems = problems.chain(of_skin_at_rest(garment));
    let problems = problems.chain(of_sides(garment));
    let problems = problems.map(|problem| (paths[0], problem));
    let of_body = of_height(garment.body()).map(|problem| (paths[1], problem));
    let warnings = problems.chain(of_body).map(|(path, problem)| Warning {
        path: path.to_path_buf(),
        problem,
    });
    warnings
        .map(|warning| WarningReport::from(&warning))
        .collect()
}

/// Heights of bodies in metres, from the smallest that is taken for one, that are rather those of
/// people in inches, read as centimetres, or in feet, read as decimetres.
const SMALLEST_PERSON: [f32; 2] = [0.5, 0.85];

/// Bodies that are smaller than this in all directions are smaller than any doll, in metres.
const SMALLEST_DOLL: f32 = 0.03;

/// Whether a body is rather one in another unit.
fn of_height(body: &Body) -> Option<Problem> {
    let bounds = Bounds::of_faces(body.rest().positions(), body.rest().faces());
    let height = bounds.unwrap_or_default().extent().max();
    (height < SMALLEST_DOLL).then_some(Problem::TinyBody(height))
}

/// What is unusual about a garment.
pub(crate) fn of_garment(mesh: &TriMesh) -> Vec<Problem> {
    let diagnosis = diagnose(mesh);
    let mut problems = of_mesh(&diagnosis);
    if diagnosis.num_components > 1 {
        problems.push(Problem::Components(diagnosis.num_components));
    }
    problems
}

/// What is unusual about a rest body.
pub(crate) fn of_body(body: &Body) -> Vec<Problem> {
    let (mesh, skin) = (body.rest(), body.skin());
    let (diagnosis, pairs) = rayon::join(|| diagnose(mesh), || skin.self_intersections());
    let mut problems = of_mesh(&diagnosis);
    // Seams of textures are closed in the skin.
    let sewn = &skin.faces()[..mesh.num_faces()];
    let is_sewn = sewn != mesh.faces();
    let sewn = is_sewn.then(|| TriMesh::new(mesh.positions().to_vec(), sewn.to_vec()));
    let sewn = sewn.and_then(Result::ok).map(|mesh| diagnose(&mesh));
    let of_skin = sewn.as_ref().unwrap_or(&diagnosis);
    if of_skin.num_components > 1 {
        problems.push(Problem::Components(of_skin.num_components));
    }
    if body.num_rims() > 0 {
        problems.push(Problem::OpenBody(body.num_rims()));
    }
    if !pairs.is_empty() {
        problems.push(Problem::SelfIntersectingBody(pairs.len()));
    }
    if body.was_inside_out() {
        problems.push(Problem::InsideOutBody);
    }
    let bounds = Bounds::of_faces(body.rest().positions(), body.rest().faces());
    let height = bounds.unwrap_or_default().extent().y;
    if (SMALLEST_PERSON[0]..SMALLEST_PERSON[1]).contains(&height) {
        problems.push(Problem::SmallBody(height));
    }
    problems.extend(of_height(body));
    if body.num_turned_faces() > 0 {
        problems.push(Problem::TurnedFaces(body.num_turned_faces()));
    }
    problems
}

fn of_mesh(diagnosis: &MeshDiagnosis) -> Vec<Problem> {
    let found = [
        Problem::UnusedVertices(diagnosis.unused_vertices.len()),
        Problem::DuplicateVertices(diagnosis.duplicate_vertices.len()),
        Problem::ZeroAreaFaces(diagnosis.degenerate_faces.len()),
        Problem::DuplicateFaces(diagnosis.duplicate_faces.len()),
        Problem::NonManifoldEdges(diagnosis.non_manifold_edges.len()),
        Problem::InconsistentEdges(diagnosis.inconsistent_edges.len()),
    ];
    found
        .into_iter()
        .filter(|problem| problem.count() != Some(0))
        .collect()
}

/// Whether vertices of a garment are sewn to others beside them.
pub(crate) fn of_rims(garment: &BoundGarment) -> Option<Problem> {
    let (weld, places) = (garment.cloth().weld(), garment.mesh().positions());
    let sewn = weld.scatter(&weld.gather(places));
    let count = sewn.iter().zip(places).filter(|(a, b)| a != b).count();
    (count > 0).then_some(Problem::NearVertices(count))
}

/// What is unusual about a garment whose vertices are sewn to others beside them: it has no more
/// parts than its cloth.
pub(crate) fn sewn(problems: Vec<Problem>, garment: &BoundGarment) -> Vec<Problem> {
    let components = garment.cloth().topology().components();
    let faces = garment.cloth().faces().iter();
    let parts: HashSet<u32> = faces.map(|face| components[face[0] as usize]).collect();
    let parts = parts.len();
    let of_cloth = |problem| match problem {
        Problem::Components(_) => (parts > 1).then_some(Problem::Components(parts)),
        other => Some(other),
    };
    problems.into_iter().filter_map(of_cloth).collect()
}

/// Vertices of a garment that lie over holes of its body.
pub(crate) fn num_over_holes(garment: &BoundGarment) -> usize {
    let cloth = garment.cloth();
    let nodes = cloth.weld().node_of_vertex().iter();
    nodes
        .filter(|&&node| cloth.is_over_hole(node as usize))
        .count()
}

/// Sleeves of a garment that no limb goes through, or whether limbs go through half of its openings
/// at most.
pub(crate) fn of_openings(garment: &TriMesh, body: &Body) -> Vec<Problem> {
    let [openings, threaded] = threaded_openings(garment, body);
    let bare = openings - threaded;
    if bare == 0 {
        return Vec::new();
    }
    let name = |joint: usize| body.skeleton().joints()[joint].name.clone();
    let empty = empty_sleeves(garment, body).into_iter();
    let empty = empty.map(|sleeve| Problem::EmptySleeve(name(sleeve.joint), sleeve.center));
    let empty: Vec<Problem> = empty.collect();
    // More than sleeves are bare: the garment lies elsewhere.
    if bare >= 2 && bare >= threaded && bare > empty.len() {
        return vec![Problem::Unthreaded(bare, openings)];
    }
    empty
}

/// A garment of which more than this share looks towards the skin is inside out: of one with a
/// lining half does.
const INWARD_SHARE: f32 = 0.8;

/// Whether a garment is inside out.
pub(crate) fn of_sides(garment: &BoundGarment) -> Option<Problem> {
    let share = garment.cloth().inward_share();
    (share > INWARD_SHARE).then_some(Problem::InsideOutGarment(share))
}

/// Whether a garment lies over holes of its body.
pub(crate) fn of_holes(garment: &BoundGarment) -> Option<Problem> {
    let count = num_over_holes(garment);
    let share = count as f32 / garment.mesh().num_vertices().max(1) as f32;
    (count > 0).then_some(Problem::OverHoles(count, share))
}

/// Whether a garment starts deep inside the rest body.
pub(crate) fn of_start(garment: &BoundGarment) -> Option<Problem> {
    let cloth = garment.cloth();
    let max_depth = MAX_START_DEPTH * cloth.scale();
    let nodes = cloth.rest_nodes().iter().zip(cloth.skin()).enumerate();
    let far = nodes.filter_map(|(node, (position, skin))| {
        let distance = skin.distance_squared.sqrt();
        (distance > max_depth && cloth.is_cloth(node)).then_some((*position, distance))
    });
    let (positions, distances): (Vec<_>, Vec<f32>) = far.unzip();
    let is_inside = cloth.rest_skin().contains_all(&positions);
    let inside = distances
        .into_iter()
        .zip(is_inside)
        .filter(|(_, inside)| *inside);
    let depths: Vec<f32> = inside.map(|(depth, _)| depth).collect();
    let deepest = depths.iter().copied().fold(0.0, f32::max);
    (!depths.is_empty()).then_some(Problem::StartsInside {
        count: depths.len(),
        limit: max_depth,
        deepest,
    })
}

/// Whether skin of the rest body comes through the cloth, be all vertices outside.
fn of_skin_at_rest(garment: &BoundGarment) -> Option<Problem> {
    let cloth = Surface::new(garment.mesh());
    let crossing = free_crossing_faces(&cloth, garment.cloth().rest_skin()).len();
    (crossing > 0).then_some(Problem::CrossingAtRest(crossing))
}

/// More of settled cloth that falls is told, from 0 to 1: corners that swing are less.
pub(crate) const MOST_FALLING: f32 = 0.1;

/// What is wrong with the fit of a target.
pub(crate) fn of_fit(residual: f32) -> Option<Problem> {
    (residual > MAX_RESIDUAL).then_some(Problem::PoorFit(residual))
}

/// Whether simulated cloth has not come to rest.
pub(crate) fn of_rest(report: &SceneReport) -> Option<Problem> {
    let is_moving = report.moving > Limits::default().moving;
    is_moving.then_some(Problem::Moving(report.moving))
}

/// Whether cloth that was to settle falls. What a network leaves in motion is not told: it was
/// trained to end there.
pub(crate) fn of_falling(provenance: &Provenance) -> Option<Problem> {
    let was_drape = provenance.relaxed_from == Some(Moment::Rest) && provenance.worsened.is_none();
    let falls = was_drape && provenance.falling_share > MOST_FALLING;
    falls.then_some(Problem::Falling(provenance.falling_share))
}

/// What is left of cloth that is not untangled.
pub(crate) fn of_penetration(found: &PenetrationReport) -> Vec<Problem> {
    let left = [
        Problem::Inside(found.inside, found.deepest_m),
        Problem::Trapped(found.trapped.unwrap_or(0)),
        Problem::CrossingUntouched(found.crossing_faces),
    ];
    let is_any = |problem: &Problem| problem.count() != Some(0);
    left.into_iter().filter(is_any).collect()
}

/// What untangling left.
pub(crate) fn of_result(report: &UntangleReport) -> Vec<Problem> {
    let below = report.below_clearance.saturating_sub(report.squeezed);
    let left = [
        Problem::Inside(report.inside, report.deepest),
        Problem::Trapped(report.trapped),
        Problem::Squeezed(report.squeezed),
        Problem::BelowClearance(below, report.min_distance),
        Problem::CrossingFaces(report.crossing_faces),
    ];
    left.into_iter()
        .filter(|problem| problem.count() != Some(0))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_and_many_are_told_apart() {
        let text = |problem| {
            let path = PathBuf::from("tee.obj");
            Warning { path, problem }.to_string()
        };
        let (one, many) = (Problem::UnusedVertices(1), Problem::CrossingFaces(2));
        assert_eq!(text(one), "1 vertex of `tee.obj` belongs to no face");
        let expected = "2 faces of `tee.obj` cross the skin between vertices that are outside";
        assert_eq!(text(many), expected);
    }
}
