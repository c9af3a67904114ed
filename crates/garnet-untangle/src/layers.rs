//! Cloth that lies on cloth: linings, hems turned in, pockets, double walls.
//!
//! Two layers a few millimetres apart have no room between them for pushes of their own. So the
//! smaller of two sheets that lie on each other at rest is not pushed at all: each of its nodes
//! keeps its place over or under the larger sheet, and the larger one keeps as much more distance
//! from the skin as lies between them.

use std::cmp::Ordering;

use garnet_knn::Surface;
use garnet_mesh::{Point3, Topology, Vector3};
use garnet_skin::BoundGarment;
use rayon::prelude::*;

/// Cloth no farther than this from other cloth at rest lies on it, in metres: padding and thick
/// hems. Larger ones take neighbouring flaps and folds for layers.
pub(crate) const LAYER_DISTANCE: f32 = 0.008;

/// Two layers are about parallel: the cosine between their normals, and between the way from one
/// to the other and the normal, is at least this.
const PARALLEL_COSINE: f32 = 0.7;

/// Nearer layers have no direction from one to the other, in metres.
const MIN_GAP: f32 = 5e-5;

/// Neighbouring faces that turn by an angle with a lower cosine belong to two sheets: a fold.
const FOLD_COSINE: f32 = 0.3;

/// Where one of them faces the skin and the other does not, by an angle with a lower cosine than
/// this: a fold that is made of several edges.
const TURN_COSINE: f32 = 0.87;

/// The smooth normal of cloth that is followed is at least this long. It is 1 long where cloth is
/// flat, and shorter at creases, over which no place is kept: it grows as the crease opens.
const LEAST_NORMAL: f32 = 0.5;

/// The foot of a follower is within its face, or outside of it by no larger shares than this: small
/// faces tell nothing of places far beside them.
const MAX_BESIDE: f32 = 0.5;

/// Cloth that follows cloth that follows others, at most so often: as layers of padded clothes.
/// Where a mesh is crumpled, errors of each level add up.
const MAX_LEVELS: usize = 3;

/// A node follows another sheet if at least this share of its neighbours in its own one do.
const FOLLOWING_SHARE: f32 = 0.5;

/// Followers that one task places.
const CHUNK: usize = 256;

/// Which nodes follow other cloth; nothing is kept of garments of one layer.
#[derive(Debug, Clone, Default)]
pub(crate) struct Layers {
    /// In the order in which they are placed, by levels: the cloth that a level follows belongs to
    /// the levels before it.
    followers: Vec<Follower>,
    levels: Vec<usize>,
    /// Faces of one sheet around a corner that is followed, one after the other.
    fans: Vec<u32>,
    /// Whether each node follows `[node]`; empty if none does.
    is_follower: Vec<bool>,
    /// Whether each node follows or is followed `[node]`; empty if none is.
    is_layered: Vec<bool>,
    /// What each node keeps from the skin beyond the clearance `[node]`, in metres; empty if none
    /// follows.
    rooms: Vec<f32>,
}

/// A node that keeps its place over a face of other cloth.
#[derive(Debug, Clone)]
struct Follower {
    node: u32,
    corners: [u32; 3],
    /// Shares of the corners in the foot of the node; their sum is 1.
    shares: [f32; 3],
    /// Over the face, along its smooth normal, in lengths of that.
    height: f32,
    /// Where the faces around each corner are in the list of all.
    fans: [[u32; 2]; 3],
}

/// The sheets of a garment: faces that hang together without a fold.
#[derive(Debug)]
pub(crate) struct Sheets {
    /// `[face]`.
    of_face: Vec<u32>,
    /// `[sheet]`, in square metres.
    areas: Vec<f64>,
    /// Whether the normals of a sheet's faces lead away from the skin `[sheet]`.
    faces_out: Vec<bool>,
    /// Unit normals `[face]`.
    normals: Vec<Vector3>,
}

impl Sheets {
    /// `body_normals` are of the faces of the rest skin.
    pub(crate) fn new(garment: &BoundGarment, body_normals: &[Vector3]) -> Self {
        let (rest, faces, topology) = (garment.rest_nodes(), garment.faces(), garment.topology());
        let cross = |face: &[u32; 3]| cross_of(rest, face);
        let crosses: Vec<Vector3> = faces.iter().map(cross).collect();
        let unit = |cross: &Vector3| cross.try_normalize(0.0).unwrap_or_else(Vector3::zeros);
        let normals: Vec<Vector3> = crosses.iter().map(unit).collect();
        let outwards = |(face, cross): (&[u32; 3], &Vector3)| {
            let skin = face.map(|node| garment.skin()[node as usize].face as usize);
            let outwards: Vector3 = skin.map(|face| body_normals[face]).iter().sum();
            outwards.dot(cross)
        };
        let outwards: Vec<f32> = faces.iter().zip(&crosses).map(outwards).collect();
        let mut neighbours = vec![[u32::MAX; 3]; faces.len()];
        let mut counts = vec![0_usize; faces.len()];
        for edge in 0..topology.edges().len() {
            let &[a, b] = topology.edge_faces(edge) else {
                continue;
            };
            let [one, other] = [a, b].map(|face| face as usize);
            let limit = if (outwards[one] < 0.0) == (outwards[other] < 0.0) {
                FOLD_COSINE
            } else {
                TURN_COSINE
            };
            let is_one_sheet = normals[one].dot(&normals[other]) > limit;
            if is_one_sheet && counts[one] < 3 && counts[other] < 3 {
                neighbours[one][counts[one]] = b;
                neighbours[other][counts[other]] = a;
                counts[one] += 1;
                counts[other] += 1;
            }
        }
        let mut of_face = vec![u32::MAX; faces.len()];
        let (mut areas, mut faces_out) = (Vec::new(), Vec::new());
        let mut stack = Vec::new();
        for start in 0..faces.len() {
            if of_face[start] != u32::MAX {
                continue;
            }
            let sheet = areas.len() as u32;
            let (mut area, mut votes) = (0.0, 0.0);
            of_face[start] = sheet;
            stack.push(start);
            while let Some(face) = stack.pop() {
                area += 0.5 * f64::from(crosses[face].norm());
                votes += f64::from(outwards[face]);
                for &next in &neighbours[face][..counts[face]] {
                    if of_face[next as usize] == u32::MAX {
                        of_face[next as usize] = sheet;
                        stack.push(next as usize);
                    }
                }
            }
            areas.push(area);
            faces_out.push(votes >= 0.0);
        }
        Self {
            of_face,
            areas,
            faces_out,
            normals,
        }
    }

    /// The larger of two sheets comes first.
    fn order(&self, a: u32, b: u32) -> Ordering {
        let [area_a, area_b] = [a, b].map(|sheet| self.areas[sheet as usize]);
        area_b.total_cmp(&area_a).then(a.cmp(&b))
    }

    /// The largest sheet at each node `[node]`; none at nodes without faces.
    fn of_nodes(&self, topology: &Topology) -> Vec<Option<u32>> {
        let largest = |node: usize| {
            let sheets = topology.vertex_faces(node).iter();
            let sheets = sheets.map(|&face| self.of_face[face as usize]);
            sheets.min_by(|&a, &b| self.order(a, b))
        };
        (0..topology.num_vertices()).map(largest).collect()
    }
}

impl Layers {
    /// Finds the cloth that lies on other cloth at rest, of which `surface` is the surface.
    pub(crate) fn new(garment: &BoundGarment, surface: &Surface, sheets: &Sheets) -> Self {
        if sheets.areas.len() < 2 {
            return Self::default();
        }
        let topology = garment.topology();
        let sheet_of_node = sheets.of_nodes(topology);
        let is_found = |node: usize| {
            let sheet = sheet_of_node[node]?;
            let is_larger = |other: u32| sheets.order(other, sheet) == Ordering::Less;
            Lead::under(
                garment,
                surface,
                sheets,
                (node, sheet),
                is_larger,
                PARALLEL_COSINE,
            )
        };
        let nodes = 0..garment.rest_nodes().len();
        let mut leads: Vec<Option<Lead>> = (nodes.clone().into_par_iter().with_min_len(CHUNK))
            .map(is_found)
            .collect();
        if leads.iter().all(Option::is_none) {
            return Self::default();
        }
        let is_among_others = |node: usize| {
            let own = topology.neighbors(node).iter().map(|&other| other as usize);
            let own = own.filter(|&other| sheet_of_node[other] == sheet_of_node[node]);
            let (mut count, mut following) = (0_usize, 0_usize);
            for other in own {
                count += 1;
                following += usize::from(leads[other].is_some());
            }
            following as f32 >= FOLLOWING_SHARE * count as f32
        };
        let stays: Vec<bool> = nodes.clone().map(is_among_others).collect();
        for (lead, stays) in leads.iter_mut().zip(stays) {
            *lead = lead.take().filter(|_| stays);
        }
        // In a corner no cloth is parallel: single nodes there go with those around them.
        let joined = |node: usize| {
            let sheet = sheet_of_node[node].filter(|_| leads[node].is_none())?;
            let around = topology.neighbors(node);
            let near = around
                .iter()
                .filter_map(|&other| leads[other as usize].as_ref());
            let followed: Vec<u32> = near
                .map(|lead| sheets.of_face[lead.face as usize])
                .collect();
            if (followed.len() as f32) < FOLLOWING_SHARE * around.len() as f32 {
                return None;
            }
            let is_followed = |other: u32| {
                followed.contains(&other) && sheets.order(other, sheet) == Ordering::Less
            };
            Lead::under(garment, surface, sheets, (node, sheet), is_followed, 0.0)
        };
        let joined: Vec<Option<Lead>> = nodes.map(joined).collect();
        for (lead, joined) in leads.iter_mut().zip(joined) {
            *lead = lead.take().or(joined);
        }
        Self::of_leads(garment, sheets, &sheet_of_node, &leads)
    }

    fn of_leads(
        garment: &BoundGarment,
        sheets: &Sheets,
        sheet_of_node: &[Option<u32>],
        leads: &[Option<Lead>],
    ) -> Self {
        let mut order: Vec<usize> = (0..leads.len()).filter(|&n| leads[n].is_some()).collect();
        if order.is_empty() {
            return Self::default();
        }
        // Sheets follow larger ones alone, so that those are placed before them.
        let by_sheet = |&a: &usize, &b: &usize| match (sheet_of_node[a], sheet_of_node[b]) {
            (Some(one), Some(other)) => sheets.order(one, other).then(a.cmp(&b)),
            _ => a.cmp(&b),
        };
        order.sort_by(by_sheet);
        let mut level_of = vec![0_usize; leads.len()];
        let mut layers = Self {
            is_follower: leads.iter().map(Option::is_some).collect(),
            is_layered: leads.iter().map(Option::is_some).collect(),
            rooms: vec![0.0; leads.len()],
            ..Self::default()
        };
        for node in order {
            let Some(lead) = &leads[node] else { continue };
            let corners = garment.faces()[lead.face as usize];
            let level = corners.map(|corner| level_of[corner as usize]);
            let level = 1 + level.into_iter().max().unwrap_or(0);
            if level > MAX_LEVELS {
                layers.is_follower[node] = false;
                continue;
            }
            level_of[node] = level;
            for corner in corners {
                layers.is_layered[corner as usize] = true;
            }
            let sheet = sheets.of_face[lead.face as usize];
            if lead.height * outwards(sheets, sheet) < 0.0 {
                for corner in corners {
                    let room = &mut layers.rooms[corner as usize];
                    *room = room.max(lead.height.abs());
                }
            }
            let fans = corners.map(|corner| {
                let start = layers.fans.len() as u32;
                let around = garment.topology().vertex_faces(corner as usize).iter();
                let own = around.filter(|&&face| sheets.of_face[face as usize] == sheet);
                layers.fans.extend(own);
                [start, layers.fans.len() as u32]
            });
            layers.followers.push(Follower {
                node: node as u32,
                corners,
                shares: lead.shares,
                height: lead.height / lead.normal_length,
                fans,
            });
        }
        let level = |follower: &Follower| level_of[follower.node as usize];
        layers.followers.sort_by_key(level);
        layers.levels = layers.followers.iter().map(level).collect();
        layers
    }

    /// Whether the garment has one layer everywhere.
    pub(crate) fn is_single(&self) -> bool {
        self.followers.is_empty()
    }

    /// How many nodes follow other cloth.
    pub(crate) fn num_followers(&self) -> usize {
        self.followers.len()
    }

    /// Whether a node follows other cloth.
    #[inline]
    pub(crate) fn is_follower(&self, node: usize) -> bool {
        self.is_follower.get(node).copied().unwrap_or(false)
    }

    /// Whether a node follows other cloth or is followed.
    pub(crate) fn is_layered(&self, node: usize) -> bool {
        self.is_layered.get(node).copied().unwrap_or(false)
    }

    /// What a node keeps from the skin beyond the clearance, for the layers below it, in metres.
    pub(crate) fn room(&self, node: usize) -> f32 {
        self.rooms.get(node).copied().unwrap_or(0.0)
    }

    /// Each follower and the nodes that it follows, of which those that follow others came before.
    pub(crate) fn leads(&self) -> impl DoubleEndedIterator<Item = (u32, [u32; 3])> + '_ {
        let followers = self.followers.iter();
        followers.map(|follower| (follower.node, follower.corners))
    }

    /// Puts all followers where the cloth that they follow has them.
    pub(crate) fn place(&self, faces: &[[u32; 3]], positions: &mut [Point3]) {
        for followers in self.by_level() {
            let place = |follower: &Follower| self.place_of(follower, faces, positions, 1.0);
            let places: Vec<Point3> = (followers.par_iter().with_min_len(CHUNK))
                .map(place)
                .collect();
            for (follower, place) in followers.iter().zip(places) {
                positions[follower.node as usize] = place;
            }
        }
    }

    /// Places of followers at shares of their distance from the cloth that they follow.
    pub(crate) fn lowered<const N: usize>(
        &self,
        faces: &[[u32; 3]],
        positions: &[Point3],
        is_asked: impl Fn(usize) -> bool + Sync,
        shares: &[f32; N],
    ) -> Vec<(u32, [Point3; N])> {
        let asked = self
            .followers
            .par_iter()
            .filter(|f| is_asked(f.node as usize));
        let places = |follower: &Follower| {
            let place = |share: f32| self.place_of(follower, faces, positions, share);
            (follower.node, shares.map(place))
        };
        asked.map(places).collect()
    }

    /// Followers whose leads follow none of them.
    fn by_level(&self) -> impl Iterator<Item = &[Follower]> {
        let mut rest = &self.followers[..];
        let mut levels = &self.levels[..];
        std::iter::from_fn(move || {
            let &level = levels.first()?;
            let count = levels.partition_point(|&other| other <= level);
            let followers;
            (followers, rest) = rest.split_at(count);
            levels = &levels[count..];
            Some(followers)
        })
    }

    fn place_of(
        &self,
        follower: &Follower,
        faces: &[[u32; 3]],
        positions: &[Point3],
        share_of_height: f32,
    ) -> Point3 {
        let mut foot = Vector3::zeros();
        let mut normal = Vector3::zeros();
        let corners = follower.corners.into_iter().zip(follower.shares);
        for ((corner, share), [start, end]) in corners.zip(follower.fans) {
            foot += share * positions[corner as usize].coords;
            let fan = self.fans[start as usize..end as usize].iter();
            normal += share * fan_normal(fan, faces, positions);
        }
        Point3::from(foot + share_of_height * follower.height * normal)
    }
}

/// 1 for sheets whose normals lead away from the skin, else -1.
fn outwards(sheets: &Sheets, sheet: u32) -> f32 {
    if sheets.faces_out[sheet as usize] {
        1.0
    } else {
        -1.0
    }
}

/// 1 or -1 `[node]`: turns normals away from the skin, where a garment has layers by the largest
/// sheet at each node.
pub(crate) fn orientation_by_sheet(
    sheets: &Sheets,
    topology: &Topology,
    of_component: &[f32],
    layers: &Layers,
) -> Vec<f32> {
    let components = topology.components();
    let mut is_layered = vec![false; topology.num_components()];
    for (node, leads) in layers.leads() {
        for node in [node, leads[0]] {
            is_layered[components[node as usize] as usize] = true;
        }
    }
    let of_nodes = sheets.of_nodes(topology).into_iter().enumerate();
    let sign = |(node, sheet): (usize, Option<u32>)| match sheet {
        Some(sheet) if is_layered[components[node] as usize] => outwards(sheets, sheet),
        _ => of_component[node],
    };
    of_nodes.map(sign).collect()
}

/// The cloth that a node lies on.
#[derive(Debug)]
struct Lead {
    face: u32,
    shares: [f32; 3],
    /// In metres.
    height: f32,
    /// Of the smooth normal of the face.
    normal_length: f32,
}

impl Lead {
    /// The nearest cloth of a sheet that a node may follow, if it is near enough and parallel to
    /// the node's own `sheet` by `least_cosine`.
    fn under(
        garment: &BoundGarment,
        surface: &Surface,
        sheets: &Sheets,
        (node, sheet): (usize, u32),
        may_follow: impl Fn(u32) -> bool,
        least_cosine: f32,
    ) -> Option<Self> {
        let (rest, faces) = (garment.rest_nodes(), garment.faces());
        let own = garment.topology().vertex_faces(node).iter();
        let own = own.filter(|&&face| sheets.of_face[face as usize] == sheet);
        let own_normal = fan_normal(own, faces, rest);
        let least = least_cosine * own_normal.norm();
        let is_followed = |face: u32| {
            may_follow(sheets.of_face[face as usize])
                && sheets.normals[face as usize].dot(&own_normal).abs() >= least
                && !faces[face as usize].contains(&(node as u32))
        };
        let hint = *garment.topology().vertex_faces(node).first()?;
        let closest = surface.closest_where_from(
            rest[node],
            garment.scale() * LAYER_DISTANCE,
            hint,
            is_followed,
        )?;
        let corners = faces[closest.face as usize];
        let [a, b, c] = corners.map(|corner| rest[corner as usize]);
        let lead_sheet = sheets.of_face[closest.face as usize];
        let mut normal = Vector3::zeros();
        for (corner, share) in corners.into_iter().zip(closest.barycentric) {
            let around = garment.topology().vertex_faces(corner as usize).iter();
            let fan = around.filter(|&&face| sheets.of_face[face as usize] == lead_sheet);
            normal += share * fan_normal(fan, faces, rest);
        }
        let normal_length = normal.norm();
        if normal_length < LEAST_NORMAL {
            return None;
        }
        let normal = normal / normal_length;
        let offset = rest[node] - closest.point;
        let gap = offset.norm();
        let (ab, ac) = (b - a, c - a);
        let across = ab.cross(&ac);
        let tilt = across.dot(&normal);
        if tilt <= 0.0 {
            return None;
        }
        let height = offset.dot(&across) / tilt;
        if gap > MIN_GAP && height.abs() < least_cosine * gap {
            return None;
        }
        // What is not along the normal is along the face.
        let beside = offset - height * normal;
        let (bb, bc, cc) = (ab.dot(&ab), ab.dot(&ac), ac.dot(&ac));
        let determinant = bb * cc - bc * bc;
        if determinant <= f32::EPSILON * bb * cc {
            return None;
        }
        let (along_b, along_c) = (beside.dot(&ab), beside.dot(&ac));
        let to_b = (along_b * cc - along_c * bc) / determinant;
        let to_c = (along_c * bb - along_b * bc) / determinant;
        let [share_a, share_b, share_c] = closest.barycentric;
        let shares = [share_a - to_b - to_c, share_b + to_b, share_c + to_c];
        let is_beside = |share: &f32| !(-MAX_BESIDE..=1.0 + MAX_BESIDE).contains(share);
        if shares.iter().any(is_beside) {
            return None;
        }
        Some(Self {
            face: closest.face,
            shares,
            height,
            normal_length,
        })
    }
}

/// The normal of faces around a corner, each by its area: of length 1 where they are in one plane,
/// and the shorter the more sharply the cloth is folded there.
fn fan_normal<'a>(
    fan: impl Iterator<Item = &'a u32>,
    faces: &[[u32; 3]],
    positions: &[Point3],
) -> Vector3 {
    let mut sum = Vector3::zeros();
    let mut total = 0.0;
    for &face in fan {
        let cross = cross_of(positions, &faces[face as usize]);
        sum += cross;
        total += cross.norm();
    }
    if total > 0.0 { sum / total } else { sum }
}

fn cross_of(positions: &[Point3], face: &[u32; 3]) -> Vector3 {
    let [a, b, c] = face.map(|node| positions[node as usize]);
    (b - a).cross(&(c - a))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Binding, UntangleOptions, untangle};
    use garnet_mesh::TriMesh;
    use garnet_mesh::primitives::icosphere;
    use garnet_skin::{Body, Garment, Joint, Pose, Skeleton, SkinWeights, Warp};
    use nalgebra::{Rotation3, Translation3};

    const RADIUS: f32 = 0.2;

    fn ball() -> Body {
        let mesh = icosphere(4, RADIUS);
        let joint = Joint {
            name: "root".to_owned(),
            parent: None,
            rest_position: Point3::origin(),
        };
        let skeleton = Skeleton::new(vec![joint]).unwrap();
        let weights = SkinWeights::from_dense(1, &vec![1.0; mesh.num_vertices()]).unwrap();
        Body::new(mesh, skeleton, weights).unwrap()
    }

    /// Balls one in the other, the faces of every second one turned inwards if `is_turned`.
    fn shells(heights: &[f32], is_turned: bool) -> TriMesh {
        let (mut positions, mut faces) = (Vec::new(), Vec::new());
        for (index, height) in heights.iter().enumerate() {
            let ball = icosphere(3, RADIUS + height);
            let first = positions.len() as u32;
            positions.extend_from_slice(ball.positions());
            faces.extend(ball.faces().iter().map(|&[a, b, c]| {
                let face = if is_turned && index % 2 == 1 {
                    [a, c, b]
                } else {
                    [a, b, c]
                };
                face.map(|vertex| vertex + first)
            }));
        }
        TriMesh::new(positions, faces).unwrap()
    }

    #[test]
    fn every_layer_but_the_largest_follows_and_is_placed_where_it_lay() {
        let num_nodes = icosphere(3, RADIUS).num_vertices();
        for (heights, is_turned) in [
            (&[0.01][..], false),
            (&[0.01, 0.006], true),
            (&[0.003, 0.006, 0.012], false),
        ] {
            let garment = Garment::new(shells(heights, is_turned))
                .bind(&ball())
                .unwrap();
            let layers = Binding::new(&garment).unwrap().layers;
            assert_eq!(layers.num_followers(), (heights.len() - 1) * num_nodes);
            let turn = Rotation3::from_euler_angles(0.3, 1.1, -0.4);
            let way = Translation3::new(0.5, -0.1, 0.2) * turn;
            let moved: Vec<Point3> = garment.rest_nodes().iter().map(|p| way * p).collect();
            let mut placed = moved.clone();
            for (node, place) in placed.iter_mut().enumerate() {
                if layers.is_follower(node) {
                    *place = Point3::origin();
                }
            }
            layers.place(garment.faces(), &mut placed);
            for (place, expected) in placed.iter().zip(&moved) {
                assert!((place - expected).norm() < 2e-5, "{place} {expected}");
            }
        }
    }

    #[test]
    fn cloth_over_crumpled_cloth_stays_near_it_when_that_unfolds() {
        let mut mesh = shells(&[0.003, 0.008], false);
        let num_nodes = mesh.num_vertices() / 2;
        // Every third node of the larger layer is drawn out to a spike, some beyond the other one.
        let spiked = |(vertex, point): (usize, &Point3)| {
            let height = if vertex >= num_nodes && vertex % 3 == 0 {
                0.002 * (vertex % 7) as f32 - 0.012
            } else {
                0.0
            };
            point + point.coords.normalize() * height
        };
        let smooth = mesh.clone();
        mesh = mesh
            .with_positions(mesh.positions().iter().enumerate().map(spiked).collect())
            .unwrap();
        let garment = Garment::new(mesh).bind(&ball()).unwrap();
        let layers = Binding::new(&garment).unwrap().layers;
        assert!(layers.num_followers() > 0);
        let smooth = garment.weld().gather(smooth.positions());
        let mut placed = smooth.clone();
        layers.place(garment.faces(), &mut placed);
        for (place, smooth) in placed.iter().zip(&smooth) {
            assert!((place - smooth).norm() < 0.04, "{place} {smooth}");
        }
    }

    #[test]
    fn layers_farther_apart_than_cloth_on_cloth_are_two_garments() {
        let garment = Garment::new(shells(&[0.03, 0.005], false))
            .bind(&ball())
            .unwrap();
        assert_eq!(Binding::new(&garment).unwrap().num_layered(), 0);
    }

    #[test]
    fn layers_that_are_pushed_out_of_the_body_keep_their_order() {
        let body = ball();
        let mesh = shells(&[0.007, 0.003], true);
        let garment = Garment::new(mesh).bind(&body).unwrap();
        let binding = Binding::new(&garment).unwrap();
        let posed = body.posed(&Pose::rest(1)).unwrap();
        let warped = garment.warped_nodes(&posed, Warp::Shape).unwrap();
        let top = Point3::new(0.0, RADIUS, 0.0);
        // Both are dented, the outer one deeper: they cross and are inside.
        let dented = |point: &Point3| {
            let depth = if point.coords.norm() > RADIUS + 0.005 {
                0.03
            } else {
                0.015
            };
            let dent = depth * (1.0 - (point - top).norm() / 0.08).max(0.0);
            point * (1.0 - dent / RADIUS)
        };
        let dented: Vec<Point3> = warped.iter().map(dented).collect();
        assert!(binding.cloth_crossings(dented.clone()).unwrap() > 0);
        let options = UntangleOptions::default();
        let freed = untangle(&garment, &binding, &posed, &dented, &options).unwrap();
        assert!(freed.report.inside_before > 0);
        assert_eq!((freed.report.inside, freed.report.crossing_faces), (0, 0));
        let num_nodes = garment.rest_nodes().len();
        for node in (0..num_nodes).filter(|&node| binding.layers.is_follower(node)) {
            let height = freed.positions_nodes[node].coords.norm() - RADIUS;
            assert!(height > 0.0 && height < 0.02, "{height}");
        }
        assert_eq!(binding.cloth_crossings(freed.positions_nodes).unwrap(), 0);
    }
}
