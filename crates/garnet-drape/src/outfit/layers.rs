//! Two layers in order: nothing of the inner one outside of the outer one.

use garnet_knn::{ClosestPoint, Surface};
use garnet_mesh::{Point3, Topology, Vector3};
use garnet_skin::PosedBody;
use rayon::prelude::*;

use super::WornGarment;
use super::sheet::{Sheet, anchors};
use crate::Error;

/// Outer cloth farther under the inner cloth of the same part of the body than this is not brought
/// out, in metres: more takes the far side of a limb for the near one, less leaves a skirt outside
/// of the hem that is worn over it. Tried: 30 and 80 mm.
const REACH: f32 = 0.08;

/// The same of inner cloth over the outer one. More takes cloth on the lap for what is under a hem
/// there. Tried: 20 to 80 mm.
const REACH_OUT: f32 = 0.02;

/// The same of cloth of two parts of the body, as a sleeve and a skirt beside it. More pulls
/// sleeves through cloth that the body traps. Tried: 10 and 30 mm.
const FOREIGN_REACH: f32 = 0.03;

/// Cloth belongs to the same part of the body if the skin under it at rest is no farther apart than
/// this, in metres: more than garments slide, less than from arm to trunk.
const SAME_PART: f32 = 0.12;

/// One layer lies over the other where they face the same way: the cosine between their normals is
/// more than this.
const ALONG: f32 = 0.0;

/// Rounds in which layers are parted. More part what is left of deep folds.
const ROUNDS: usize = 24;

/// By how much more nodes of crossing faces are parted, each round, in metres.
const MORE: f32 = 7e-4;
/// By how much more such nodes are parted after many rounds, at most, in metres.
const MOST_MORE: f32 = 7e-3;

/// How often a push is handed on to neighbours. Less leaves spikes, more moves cloth that was in
/// order.
const SPREADS: usize = 4;
/// Which share of a push is handed on each time; less and more do as with [`SPREADS`].
const HANDED_ON: f32 = 0.8;

/// A node is moved by this at most in a round, in metres.
const MAX_STEP: f32 = 6e-3;

/// Layers that are nearer to each other by less than this stay where they are, in metres.
const TOLERANCE: f32 = 1e-4;

/// Edges that parting makes longer than this, over their length at rest, draw their ends together
/// again, unless they were as long before. Lower values keep more folds in each other, higher ones
/// stretch cloth that settled.
const LONGEST: f32 = 1.1;

/// The last rounds, in which they do. More keep folds of the inner cloth in the outer one, fewer
/// leave edges twice as long. See docs/experiments/089-strain-of-parted-layers.md.
const LAST_ROUNDS: usize = 2;

/// How often edges draw together in such a round. More let fewer of them stay long.
const DRAWS: usize = 16;

/// How layers are parted. Lengths are metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LayerOptions {
    /// What is kept between two layers.
    pub gap: f32,
    /// What the inner layer keeps from the skin while it gives way.
    pub clearance: f32,
}

impl Default for LayerOptions {
    fn default() -> Self {
        Self {
            gap: 1.5e-3,
            clearance: 2e-3,
        }
    }
}

/// How two layers run through each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct LayerCount {
    /// Faces of the outer garment that cross the inner one, and all of its faces.
    pub outer_crossing: usize,
    /// All faces of the outer garment.
    pub outer_faces: usize,
    /// Faces of the inner garment that cross the outer one.
    pub inner_crossing: usize,
    /// All faces of the inner garment.
    pub inner_faces: usize,
    /// Nodes of the inner garment that lie outside of the outer one.
    pub inner_outside: usize,
    /// All nodes of the inner garment.
    pub inner_nodes: usize,
}

impl LayerCount {
    /// The larger of the shares of faces that cross the other garment.
    pub fn crossing_share(&self) -> f64 {
        let share = |count: usize, all: usize| count as f64 / all.max(1) as f64;
        let outer = share(self.outer_crossing, self.outer_faces);
        outer.max(share(self.inner_crossing, self.inner_faces))
    }
}

/// What is known of two garments over each other.
struct Pair<'a, 'b> {
    inner: &'b Sheet<'a>,
    outer: &'b Sheet<'a>,
    /// Skin under the nodes of both at rest, on the body of the outer one.
    inner_anchors: &'b [Point3],
    outer_anchors: &'b [Point3],
}

impl Pair<'_, '_> {
    /// Whether a face of the inner garment is of the part of the body that a node of the outer one
    /// is of.
    fn is_part_of_outer(&self, inner_face: u32, outer_node: usize) -> bool {
        let node = self.inner.surface.faces()[inner_face as usize][0];
        is_near(
            self.inner_anchors[node as usize],
            self.outer_anchors[outer_node],
        )
    }

    fn is_part_of_inner(&self, outer_face: u32, inner_node: usize) -> bool {
        let node = self.outer.surface.faces()[outer_face as usize][0];
        is_near(
            self.outer_anchors[node as usize],
            self.inner_anchors[inner_node],
        )
    }

    /// The inner cloth under or over a node of the outer one, and how far above it the node is.
    fn under(&self, outer_node: usize) -> Option<(ClosestPoint, f32)> {
        let place = self.outer.surface.positions()[outer_node];
        let own = |face: u32| self.is_part_of_outer(face, outer_node);
        let near = self.inner.surface.closest_where(place, REACH, own);
        let near = near.or_else(|| self.inner.surface.closest_within(place, FOREIGN_REACH))?;
        if self.inner.is_rim(&near) {
            return None;
        }
        let outward = self.inner.outward(&near);
        let height = (place - near.point).dot(&outward);
        let is_along = || self.outer.outward_at(outer_node).dot(&outward) > ALONG;
        (height > -FOREIGN_REACH || is_along()).then_some((near, height))
    }

    /// The outer cloth of the same part of the body over a node of the inner one, and how far
    /// outside of it the node is.
    fn over(&self, inner_node: usize) -> Option<(ClosestPoint, f32)> {
        let place = self.inner.surface.positions()[inner_node];
        let own = |face: u32| self.is_part_of_inner(face, inner_node);
        let near = self.outer.surface.closest_where(place, REACH_OUT, own)?;
        if self.outer.is_rim(&near) {
            return None;
        }
        let outward = self.outer.outward(&near);
        // Where it is not, cloth lies on the outer side of what it meets: a lap on a hem.
        let is_along = self.inner.outward_at(inner_node).dot(&outward) > ALONG;
        let height = (place - near.point).dot(&outward);
        is_along.then_some((near, height))
    }
}

fn is_near(a: Point3, b: Point3) -> bool {
    (a - b).norm_squared() < SAME_PART * SAME_PART
}

/// Moves two garments that are worn over each other until neither runs through the other, as far
/// as there is room: the inner one gives way to the skin, the outer one outwards.
///
/// # Errors
///
/// [`Error::Mesh`] or [`Error::Knn`] for positions out of any range.
pub(super) fn part_layers<'a>(
    inner: &mut WornGarment<'a>,
    outer: &mut WornGarment<'a>,
    body: &PosedBody,
    options: LayerOptions,
) -> Result<(), Error> {
    let mut sheets = [Sheet::new(inner)?, Sheet::new(outer)?];
    let of_inner = anchors(inner.garment, outer.garment);
    let of_outer = anchors(outer.garment, outer.garment);
    let mut more = sheets
        .each_ref()
        .map(|sheet| vec![0.0_f32; sheet.surface.positions().len()]);
    let limits = sheets.each_ref().map(longest_edges);
    for round in 0..ROUNDS {
        let pair = Pair {
            inner: &sheets[0],
            outer: &sheets[1],
            inner_anchors: &of_inner,
            outer_anchors: &of_outer,
        };
        let crossings = pair.inner.surface.intersections(&pair.outer.surface);
        for (side, more) in more.iter_mut().enumerate() {
            let sheet = [pair.inner, pair.outer][side];
            let mut faces: Vec<u32> = crossings.iter().map(|crossing| crossing[side]).collect();
            faces.sort_unstable();
            faces.dedup();
            let mut nodes: Vec<u32> = faces
                .iter()
                .flat_map(|&face| sheet.surface.faces()[face as usize])
                .collect();
            nodes.sort_unstable();
            nodes.dedup();
            for node in nodes {
                let more = &mut more[node as usize];
                *more = (*more + MORE).min(MOST_MORE);
            }
        }
        let pushes = pushes(&pair, &more, body.skin(), options);
        if crossings.is_empty()
            && pushes
                .iter()
                .flatten()
                .all(|push| *push == Vector3::zeros())
        {
            break;
        }
        for ((sheet, pushes), limits) in sheets.iter_mut().zip(pushes).zip(&limits) {
            let topology = sheet.garment.cloth().topology();
            let pushes = spread(topology, &pushes);
            let places = sheet.surface.positions().iter().zip(pushes);
            let mut places: Vec<Point3> = places.map(|(place, push)| place + push).collect();
            if round + LAST_ROUNDS >= ROUNDS {
                draw_together(topology, limits, &mut places);
            }
            sheet.surface.refit(&places)?;
        }
    }
    for (worn, sheet) in [inner, outer].into_iter().zip(&sheets) {
        let weld = worn.garment.cloth().weld();
        worn.positions = weld.scatter(sheet.surface.positions());
    }
    Ok(())
}

/// A place at which the outer garment gives way by what the inner one does not.
struct Other {
    /// Nodes of the outer garment.
    nodes: [u32; 3],
    /// By how much the layers are too near, in metres.
    missing: f32,
    outward: Vector3,
    /// Nodes of the inner garment and their shares in the place.
    inner: [u32; 3],
    shares: [f32; 3],
}

/// By how much, and in which direction, nodes of the inner garment would have to give way, once for
/// each place where the layers are too near; and these places.
fn wishes(
    pair: &Pair<'_, '_>,
    more: &[Vec<f32>; 2],
    gap: f32,
) -> (Vec<(u32, Vector3)>, Vec<Other>) {
    let inner_nodes = pair.inner.surface.positions();
    let outer_nodes = pair.outer.surface.positions();
    let under: Vec<Option<(ClosestPoint, f32)>> = (0..outer_nodes.len())
        .into_par_iter()
        .map(|node| pair.under(node))
        .collect();
    let over: Vec<Option<(ClosestPoint, f32)>> = (0..inner_nodes.len())
        .into_par_iter()
        .map(|node| pair.over(node))
        .collect();
    let mut asks = Vec::new();
    let mut others = Vec::new();
    for (node, found) in under.iter().enumerate() {
        let Some((near, height)) = found else {
            continue;
        };
        let missing = gap + more[1][node] - height;
        if missing > TOLERANCE {
            let outward = pair.inner.outward(near);
            let corners = pair.inner.surface.faces()[near.face as usize];
            asks.extend(corners.map(|corner| (corner, -missing * outward)));
            others.push(Other {
                nodes: [node as u32; 3],
                missing,
                outward,
                inner: corners,
                shares: near.barycentric,
            });
        }
    }
    for (node, found) in over.iter().enumerate() {
        let Some((near, height)) = found else {
            continue;
        };
        let missing = gap + more[0][node] + height;
        if missing > TOLERANCE {
            let outward = pair.outer.outward(near);
            asks.push((node as u32, -missing * outward));
            others.push(Other {
                nodes: pair.outer.surface.faces()[near.face as usize],
                missing,
                outward,
                inner: [node as u32; 3],
                shares: [1.0, 0.0, 0.0],
            });
        }
    }
    (asks, others)
}

/// Where the nodes of both garments are pushed.
fn pushes(
    pair: &Pair<'_, '_>,
    more: &[Vec<f32>; 2],
    skin: &Surface,
    options: LayerOptions,
) -> [Vec<Vector3>; 2] {
    let (asks, others) = wishes(pair, more, options.gap);
    let inner_nodes = pair.inner.surface.positions();
    let outer_nodes = pair.outer.surface.positions();
    let mut wanted = [
        vec![Vector3::zeros(); inner_nodes.len()],
        vec![Vector3::zeros(); outer_nodes.len()],
    ];
    for (node, push) in asks {
        let kept = &mut wanted[0][node as usize];
        if push.norm_squared() > kept.norm_squared() {
            *kept = push;
        }
    }
    // The inner garment gives way as far as the skin lets it, the outer one by what is left.
    let place_and_push = inner_nodes.par_iter().zip(&mut wanted[0]);
    place_and_push.for_each(|(place, push)| {
        let length = push.norm();
        if length > 0.0 {
            let closest = skin.closest(*place);
            let room = (closest.distance_squared.sqrt() - options.clearance).max(0.0);
            *push *= length.min(room).min(MAX_STEP) / length;
        }
    });
    let [given, moved] = &mut wanted;
    for other in others {
        let inner = other.inner.into_iter().zip(other.shares);
        let gives = inner.map(|(node, share)| -share * given[node as usize].dot(&other.outward));
        let left = other.missing - gives.sum::<f32>();
        if left > TOLERANCE {
            let push = left * other.outward;
            for node in other.nodes {
                let kept = &mut moved[node as usize];
                if push.norm_squared() > kept.norm_squared() {
                    *kept = push;
                }
            }
        }
    }
    for push in wanted.iter_mut().flatten() {
        let length = push.norm();
        if length > MAX_STEP {
            *push *= MAX_STEP / length;
        }
    }
    wanted
}

/// Pushes handed on to the nodes around, which move less the farther they are.
fn spread(topology: &Topology, pushes: &[Vector3]) -> Vec<Vector3> {
    let mut spread = pushes.to_vec();
    for _ in 0..SPREADS {
        let next = (0..spread.len()).map(|node| {
            if pushes[node] != Vector3::zeros() {
                return pushes[node];
            }
            let around = topology.neighbors(node);
            let sum: Vector3 = around.iter().map(|&other| spread[other as usize]).sum();
            HANDED_ON / around.len().max(1) as f32 * sum
        });
        spread = next.collect();
    }
    spread
}

/// How long each edge of a sheet may become, in metres `[edge]`: [`LONGEST`] or what it is.
fn longest_edges(sheet: &Sheet<'_>) -> Vec<f32> {
    let cloth = sheet.garment.cloth();
    let length =
        |places: &[Point3], [a, b]: [u32; 2]| (places[a as usize] - places[b as usize]).norm();
    let edges = cloth.topology().edges().iter();
    edges
        .map(|&edge| {
            let at_rest = length(cloth.rest_nodes(), edge);
            (LONGEST * at_rest).max(length(sheet.surface.positions(), edge))
        })
        .collect()
}

/// Draws the ends of edges together that are longer than their limits `[edge]`: each node goes the
/// mean of what its edges ask for.
fn draw_together(topology: &Topology, limits: &[f32], places: &mut [Point3]) {
    for _ in 0..DRAWS {
        let mut moves = vec![(Vector3::zeros(), 0.0_f32); places.len()];
        for (&[a, b], &limit) in topology.edges().iter().zip(limits) {
            let apart = places[b as usize] - places[a as usize];
            let length = apart.norm();
            if length > limit {
                let half = 0.5 * (1.0 - limit / length) * apart;
                for (node, step) in [(a, half), (b, -half)] {
                    let (sum, count) = &mut moves[node as usize];
                    *sum += step;
                    *count += 1.0;
                }
            }
        }
        for (place, (sum, count)) in places.iter_mut().zip(moves) {
            if count > 0.0 {
                *place += sum / count;
            }
        }
    }
}

/// Counts what of two garments, worn over each other, runs through the other.
///
/// # Errors
///
/// [`Error::Mesh`] for positions out of any range.
pub(super) fn count_layers(
    inner: &WornGarment<'_>,
    outer: &WornGarment<'_>,
) -> Result<LayerCount, Error> {
    let sheets = [Sheet::new(inner)?, Sheet::new(outer)?];
    let of_inner = anchors(inner.garment, outer.garment);
    let of_outer = anchors(outer.garment, outer.garment);
    let pair = Pair {
        inner: &sheets[0],
        outer: &sheets[1],
        inner_anchors: &of_inner,
        outer_anchors: &of_outer,
    };
    let crossings = sheets[0].surface.intersections(&sheets[1].surface);
    let count = |side: usize| {
        let mut faces: Vec<u32> = crossings.iter().map(|crossing| crossing[side]).collect();
        faces.sort_unstable();
        faces.dedup();
        faces.len()
    };
    let nodes = sheets[0].surface.positions().len();
    let is_outside = |&node: &usize| pair.over(node).is_some_and(|(_, height)| height > 0.0);
    Ok(LayerCount {
        inner_crossing: count(0),
        outer_crossing: count(1),
        inner_faces: sheets[0].surface.faces().len(),
        outer_faces: sheets[1].surface.faces().len(),
        inner_outside: (0..nodes).into_par_iter().filter(is_outside).count(),
        inner_nodes: nodes,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BoundGarment, Garment};
    use garnet_mesh::primitives::{capsule, tube};
    use garnet_skin::{Body, Joint, Pose, Skeleton, SkinWeights};

    fn limb() -> Body {
        let limb = capsule(0.08, 0.9, 48, 24);
        let joint = Joint {
            name: "limb".to_owned(),
            parent: None,
            rest_position: Point3::origin(),
        };
        let weights = SkinWeights::from_dense(1, &vec![1.0; limb.num_vertices()]).unwrap();
        Body::new(limb, Skeleton::new(vec![joint]).unwrap(), weights).unwrap()
    }

    fn sleeve(body: &Body, radius: f32, length: f32) -> BoundGarment {
        let sleeve = Garment::new(tube(radius, length, 64, 40));
        sleeve.bind(body).unwrap()
    }

    fn worn(garment: &BoundGarment) -> WornGarment<'_> {
        WornGarment {
            garment,
            positions: garment.mesh().positions().to_vec(),
        }
    }

    /// Folds: the radius goes up and down round the limb.
    fn folded(garment: &BoundGarment, depth: f32) -> WornGarment<'_> {
        let place = |p: &Point3| {
            let angle = p.z.atan2(p.x);
            let wider = 1.0 + depth * (9.0 * angle + 14.0 * p.y).sin();
            Point3::new(wider * p.x, p.y, wider * p.z)
        };
        let positions = garment.mesh().positions().iter().map(place).collect();
        WornGarment { garment, positions }
    }

    #[test]
    fn a_wide_sleeve_over_a_narrow_one_is_in_order_and_one_in_it_is_not() {
        let body = limb();
        let (narrow, wide) = (sleeve(&body, 0.09, 0.6), sleeve(&body, 0.10, 0.4));
        let found = count_layers(&worn(&narrow), &worn(&wide)).unwrap();
        assert_eq!(found.outer_crossing + found.inner_crossing, 0);
        assert_eq!(found.inner_outside, 0);
        let found = count_layers(&worn(&wide), &worn(&narrow)).unwrap();
        assert_eq!(found.outer_crossing + found.inner_crossing, 0);
        assert!(found.inner_outside as f32 > 0.9 * found.inner_nodes as f32);
    }

    #[test]
    fn folds_through_each_other_are_parted() {
        let body = limb();
        let (narrow, wide) = (sleeve(&body, 0.092, 0.6), sleeve(&body, 0.095, 0.4));
        let (mut inner, mut outer) = (folded(&narrow, 0.05), worn(&wide));
        let before = count_layers(&inner, &outer).unwrap();
        assert!(before.crossing_share() > 0.1, "{before:?}");
        let posed = body.posed(&Pose::rest(1)).unwrap();
        part_layers(&mut inner, &mut outer, &posed, LayerOptions::default()).unwrap();
        let after = count_layers(&inner, &outer).unwrap();
        assert!(after.crossing_share() < 0.002, "{after:?}");
        assert!(after.inner_outside < 3, "{after:?}");
        // Nothing is pushed into the skin for it.
        assert!(!posed.skin().contains_all(&inner.positions).contains(&true));
        let first = folded(&narrow, 0.05);
        let moved = inner.positions.iter().zip(&first.positions);
        let farthest = moved.map(|(a, b)| (a - b).norm()).fold(0.0, f32::max);
        assert!(farthest < 0.02, "{farthest}");
    }

    #[test]
    fn parted_cloth_is_hardly_longer_than_it_was() {
        let body = limb();
        let (narrow, wide) = (sleeve(&body, 0.092, 0.6), sleeve(&body, 0.095, 0.4));
        let (mut inner, mut outer) = (folded(&narrow, 0.12), worn(&wide));
        let limits = [&inner, &outer].map(|worn| longest_edges(&Sheet::new(worn).unwrap()));
        let posed = body.posed(&Pose::rest(1)).unwrap();
        part_layers(&mut inner, &mut outer, &posed, LayerOptions::default()).unwrap();
        for (worn, limits) in [&inner, &outer].into_iter().zip(limits) {
            let sheet = Sheet::new(worn).unwrap();
            let places = sheet.surface.positions();
            let edges = worn.garment.cloth().topology().edges().iter().zip(&limits);
            let is_long = |(&[a, b], &limit): (&[u32; 2], &f32)| {
                (places[a as usize] - places[b as usize]).norm() > 1.1 * limit
            };
            let long = edges
                .clone()
                .map(is_long)
                .filter(|is_long| *is_long)
                .count();
            let share = long as f64 / limits.len() as f64;
            println!("{share}");
            assert!(share < 0.01, "{share}");
        }
    }

    #[test]
    fn layers_in_order_stay_where_they_are() {
        let body = limb();
        let (narrow, wide) = (sleeve(&body, 0.09, 0.6), sleeve(&body, 0.10, 0.4));
        let (mut inner, mut outer) = (worn(&narrow), worn(&wide));
        let posed = body.posed(&Pose::rest(1)).unwrap();
        part_layers(&mut inner, &mut outer, &posed, LayerOptions::default()).unwrap();
        assert_eq!(inner.positions, worn(&narrow).positions);
        assert_eq!(outer.positions, worn(&wide).positions);
    }

    #[test]
    fn the_dressed_body_is_as_thick_as_what_it_wears() {
        let body = limb();
        let (narrow, wide) = (sleeve(&body, 0.09, 0.6), sleeve(&body, 0.11, 0.3));
        let posed = body.posed(&Pose::rest(1)).unwrap();
        let found = super::super::dressed(&posed, &[worn(&narrow)], &wide).unwrap();
        let pairs = found.skin().positions().iter().zip(body.rest().positions());
        for (dressed, bare) in pairs {
            let round = |p: &Point3| p.x.hypot(p.z);
            if bare.y.abs() < 0.1 {
                assert!((round(dressed) - 0.09).abs() < 1.5e-3, "{dressed}");
            }
            if bare.y.abs() > 0.33 {
                assert!((dressed - bare).norm() < 1e-5, "{dressed}");
            }
        }
    }
}
