//! What a drape is like, in numbers.

use crate::reference::Balance;
use crate::{Cloth, Point3};
use garnet_knn::{PROBE_DISTANCE, Room, Surface, Traps};
use garnet_mesh::TriMesh;
use rayon::prelude::*;

/// How well a garment lies after a run.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct DrapeReport {
    /// Length over rest length − 1 of the edges, without those of ribs and waistbands.
    pub strain: Strain,
    /// That of ribs and waistbands, if there are any.
    pub rib_strain: Option<Strain>,
    /// Speeds over the last tenth of a second; none of cloth that was brought into balance.
    pub speeds: Speeds,
    /// How the cloth was brought into balance, if it was.
    pub balance: Option<Balance>,
    /// Where the garment is in the skin.
    pub penetration: Penetration,
    /// Vertices in the skin that the simulator has lost: data sets go by them.
    pub lost: Lost,
    /// Vertices at the rims of contacts of the body with itself that were inside at the end of the
    /// last step, and were put on the nearest skin.
    pub num_freed: usize,
    /// Where the garment crosses itself.
    pub self_intersections: SelfIntersections,
    /// Energy of the garment.
    pub energy: Energy,
    /// Substeps that were simulated.
    pub num_substeps: u64,
    /// Time that was simulated, in seconds.
    pub seconds: f32,
}

/// Length over rest length − 1, over the edges of a garment.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Strain {
    /// The median.
    pub p50: f32,
    /// The 99th of a hundred.
    pub p99: f32,
    /// The largest.
    pub max: f32,
    /// The edge of the largest, as an index into [`Cloth::springs`].
    pub max_edge: usize,
}

/// Speeds of the vertices of a garment, m/s.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Speeds {
    /// Root of the mean square.
    pub rms: f32,
    /// The largest.
    pub max: f32,
    /// Share of the vertices that are faster than [`STILL_SPEED`], from 0 to 1.
    pub share_moving: f32,
}

/// Vertices with a speed below this count as settled, m/s.
pub const STILL_SPEED: f32 = 0.005;

/// Vertices of a garment that are *inside* ([`Surface::contains`]) or *trapped* ([`Traps`]): the
/// words mean what they mean of any drape.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub struct Penetration {
    /// How many are inside and not trapped.
    pub num_inside: usize,
    /// The deepest of them, in metres below the nearest skin.
    pub deepest: f32,
    /// How many are trapped, inside or not.
    pub num_trapped: usize,
    /// How many are trapped and inside.
    pub num_trapped_inside: usize,
}

/// Vertices of a garment inside the skin that are not *caught by the simulator*: those that
/// contacts should have kept out. A scene of a data set may have so many and no more.
///
/// A vertex is caught by the simulator if there is no room before its closest point: skin of
/// another part, or the opposite wall of a slit or crease that the vertex is no deeper in than 15
/// mm. That is less than to be [trapped](Traps), which skin near embedded skin is enough for, and
/// more, for slits trap what is no deeper than 5 mm. Data sets are accepted by this rule and stay
/// what they are.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub struct Lost {
    /// How many there are.
    pub num: usize,
    /// The deepest of them, in metres.
    pub deepest: f32,
    /// How many vertices are inside and caught by the simulator.
    pub num_caught: usize,
}

/// Energy of a garment, in joules.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub struct Energy {
    /// Of the springs.
    pub stretch: f64,
    /// Of the hinges.
    pub bending: f64,
    /// Of the weight, from y = 0.
    pub gravity: f64,
}

impl Energy {
    /// The energy of `cloth` at `positions` `[vertex]` under a gravity in m/s².
    pub fn of(cloth: &Cloth, positions: &[Point3], gravity: f32) -> Self {
        let at = |vertex: u32| positions[vertex as usize].coords.cast::<f64>();
        let mut energy = Self::default();
        for spring in cloth.springs() {
            let [a, b] = spring.vertices.map(at);
            let stretch = (a - b).norm() - f64::from(spring.rest_length);
            energy.stretch += 0.5 * spring.stiffness_at(stretch) * stretch * stretch;
        }
        for hinge in cloth.hinges() {
            let places = hinge.vertices.map(at);
            let weighted = places.iter().zip(hinge.weights);
            let fold: nalgebra::Vector3<f64> = weighted
                .map(|(place, weight)| place * f64::from(weight))
                .sum();
            energy.bending += 0.5 * f64::from(hinge.stiffness) * fold.norm_squared();
        }
        for (position, &mass) in positions.iter().zip(cloth.masses()) {
            energy.gravity += f64::from(mass) * f64::from(gravity) * f64::from(position.y);
        }
        energy
    }

    /// The sum of all energies, in joules.
    pub fn total(&self) -> f64 {
        self.stretch + self.bending + self.gravity
    }
}

impl Strain {
    /// The strain of `cloth` at `positions` `[vertex]`, without ribs and waistbands; of these alone
    /// if there is nothing else.
    ///
    /// # Panics
    ///
    /// Never: cloth has an edge.
    pub fn of(cloth: &Cloth, positions: &[Point3]) -> Self {
        let strain = Self::where_shrunk(cloth, positions, false);
        strain
            .or_else(|| Self::of_ribs(cloth, positions))
            .expect("cloth has an edge")
    }

    /// The strain of ribs and waistbands at `positions` `[vertex]`, if there are any.
    pub fn of_ribs(cloth: &Cloth, positions: &[Point3]) -> Option<Self> {
        Self::where_shrunk(cloth, positions, true)
    }

    fn where_shrunk(cloth: &Cloth, positions: &[Point3], is_shrunk: bool) -> Option<Self> {
        let springs = cloth.springs().iter().enumerate();
        let springs = springs.filter(|&(edge, _)| cloth.is_shrunk()[edge] == is_shrunk);
        let strain = springs.map(|(edge, spring)| {
            let [a, b] = spring.vertices.map(|vertex| positions[vertex as usize]);
            ((a - b).norm() / spring.rest_length - 1.0, edge)
        });
        let mut sorted: Vec<(f32, usize)> = strain.collect();
        sorted.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        if sorted.is_empty() {
            return None;
        }
        let at = |share: f64| sorted[((sorted.len() - 1) as f64 * share) as usize];
        Some(Self {
            p50: at(0.5).0,
            p99: at(0.99).0,
            max: at(1.0).0,
            max_edge: at(1.0).1,
        })
    }
}

impl Speeds {
    /// Those of cloth at rest.
    pub const STILL: Self = Self {
        rms: 0.0,
        max: 0.0,
        share_moving: 0.0,
    };

    /// The speeds of vertices that went from one place to another in some seconds.
    pub fn between(before: &[Point3], after: &[Point3], seconds: f32) -> Self {
        let (mut sum, mut max, mut moving) = (0.0_f64, 0.0_f32, 0_usize);
        for (a, b) in before.iter().zip(after) {
            let speed = (b - a).norm() / seconds;
            sum += f64::from(speed * speed);
            max = max.max(speed);
            moving += usize::from(speed > STILL_SPEED);
        }
        let count = before.len().max(1) as f64;
        Self {
            rms: (sum / count).sqrt() as f32,
            max,
            share_moving: (moving as f64 / count) as f32,
        }
    }
}

/// Cloth no deeper than this next to a slit or a crease is caught in it by the simulator, in
/// metres. A smaller one rejects scenes with closed armpits, a larger one lets cloth slide into the
/// body there.
const CAUGHT_DEPTH: f32 = 0.015;

impl Penetration {
    /// Counts the points `[vertex]` that are inside `skin` or trapped; `scale` is that of
    /// [`Traps::near`].
    ///
    /// # Panics
    ///
    /// Never: points are finite, and no skin has more faces than can be numbered.
    pub fn of(points: &[Point3], skin: &Surface, scale: f32) -> Self {
        let traps = Traps::near(skin, points, scale).expect("a skin can be searched");
        let is_inside = skin.contains_all(points);
        let closest = skin.closest_all(points);
        let mut penetration = Self::default();
        for (closest, is_inside) in closest.iter().zip(is_inside) {
            if traps.holds(closest) {
                penetration.num_trapped += 1;
                penetration.num_trapped_inside += usize::from(is_inside);
            } else if is_inside {
                penetration.num_inside += 1;
                let depth = closest.distance_squared.sqrt();
                penetration.deepest = penetration.deepest.max(depth);
            }
        }
        penetration
    }
}

impl Lost {
    /// Counts the points `[vertex]` that are inside `skin`.
    pub fn of(points: &[Point3], skin: &Surface) -> Self {
        let mut lost = Self::default();
        for &point in points {
            let depth = match place(point, skin) {
                Place::Outside => continue,
                Place::Caught => {
                    lost.num_caught += 1;
                    continue;
                }
                Place::Inside { way_out } => (way_out - point).norm() - PROBE_DISTANCE,
                Place::Deep { distance } => distance,
            };
            lost.num += 1;
            lost.deepest = lost.deepest.max(depth);
        }
        lost
    }
}

/// Where a point is, as the simulator sees it.
enum Place {
    Outside,
    /// Inside, next to skin without room before it.
    Caught,
    /// Inside, deep next to a slit or crease, before whose skin the opposite wall of the same part
    /// is.
    Deep {
        distance: f32,
    },
    /// Inside, next to free skin: the point before it is outside.
    Inside {
        way_out: Point3,
    },
}

fn place(point: Point3, skin: &Surface) -> Place {
    let (low, high) = skin.bounds();
    let is_near = (0..3).all(|axis| (low[axis]..=high[axis]).contains(&point[axis]));
    if !is_near || !skin.contains(point) {
        return Place::Outside;
    }
    let closest = skin.closest(point);
    let normal = skin.face_normal(closest.face);
    let distance = closest.distance_squared.sqrt();
    match skin.room_before(closest.point, normal) {
        Room::Free => Place::Inside {
            way_out: closest.point + PROBE_DISTANCE * normal,
        },
        room if room.catches(distance, CAUGHT_DEPTH) => Place::Caught,
        _ => Place::Deep { distance },
    }
}

/// Puts points `[vertex]` that are inside `skin` before it, where there is room and they are no
/// deeper than [`MAX_FREED`]; returns how many.
pub(crate) fn free(points: &mut [Point3], skin: &Surface) -> usize {
    let freed = points.par_iter_mut().filter_map(|point| {
        let Place::Inside { way_out } = place(*point, skin) else {
            return None;
        };
        let is_near = (way_out - *point).norm_squared() <= MAX_FREED * MAX_FREED;
        is_near.then(|| *point = way_out)
    });
    freed.count()
}

/// Vertices deeper than this are left inside, in metres: the garment is not where it belongs. Where
/// limbs run through each other cloth lies up to so deep, and may have slid out of what they share.
const MAX_FREED: f32 = 0.02;

/// Pairs of triangles of a garment that cross.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct SelfIntersections {
    /// Pairs with room around them.
    pub num_free: usize,
    /// Pairs with a vertex that lies where the body has no room for two layers of cloth: in an
    /// armpit that closes, where limbs run through each other, in crumpled skin.
    pub num_squeezed: usize,
}

impl SelfIntersections {
    /// `is_squeezed` `[vertex]`; nowhere if empty.
    pub(crate) fn of(cloth: &Cloth, positions: &[Point3], is_squeezed: &[bool]) -> Self {
        let Ok(mesh) = TriMesh::new(positions.to_vec(), cloth.faces().to_vec()) else {
            return Self::default();
        };
        let pairs = Surface::new(&mesh).self_intersections();
        let is_squeezed = |&vertex: &u32| is_squeezed.get(vertex as usize).is_some_and(|&is| is);
        let has_squeezed = |pair: &&[u32; 2]| {
            let vertices = pair.iter().flat_map(|&face| &cloth.faces()[face as usize]);
            vertices.into_iter().any(is_squeezed)
        };
        let num_squeezed = pairs.iter().filter(has_squeezed).count();
        Self {
            num_free: pairs.len() - num_squeezed,
            num_squeezed,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Fabric, RestShape};
    use garnet_mesh::primitives::{grid, icosphere};

    #[test]
    fn sheets_that_cross_are_counted_apart_where_there_is_no_room() {
        let sheet = grid(1, 1, [0.2, 0.2]);
        let upright = |p: &Point3| Point3::new(p.x - 0.01, p.z + 0.02, p.y);
        let mut positions = sheet.positions().to_vec();
        positions.extend(sheet.positions().iter().map(upright));
        let faces = sheet.faces().iter().copied();
        let faces: Vec<[u32; 3]> = faces
            .clone()
            .chain(faces.map(|face| face.map(|vertex| vertex + 4)))
            .collect();
        let rest = RestShape::Worn(positions.clone());
        let cloth = Cloth::new(&faces, 8, &rest, &Fabric::cotton()).unwrap();
        let free = SelfIntersections::of(&cloth, &positions, &[]);
        assert!(free.num_free > 0 && free.num_squeezed == 0, "{free:?}");
        let squeezed = SelfIntersections::of(&cloth, &positions, &[true; 8]);
        assert_eq!(squeezed.num_squeezed, free.num_free);
        assert_eq!(squeezed.num_free, 0);
    }

    #[test]
    fn cloth_stretched_by_a_tenth_has_a_strain_of_a_tenth() {
        let mesh = grid(4, 4, [0.2, 0.2]);
        let rest = RestShape::Worn(mesh.positions().to_vec());
        let cloth =
            Cloth::new(mesh.faces(), mesh.num_vertices(), &rest, &Fabric::cotton()).unwrap();
        let larger: Vec<Point3> = mesh.positions().iter().map(|p| p * 1.1).collect();
        let strain = Strain::of(&cloth, &larger);
        assert!((strain.p50 - 0.1).abs() < 1e-5 && (strain.max - 0.1).abs() < 1e-5);
        // All directions are stretched alike: E = ½ Y/(1 − ν) · 2 ε² · A, with ν = 1/3 only on
        // regular meshes; here the springs' own sum is the definition.
        let energy = Energy::of(&cloth, &larger, 0.0);
        let expected: f64 = 3.0 * 0.5 * 1000.0 * 0.04 * 0.01;
        assert!(
            (energy.stretch - expected).abs() < 0.35 * expected,
            "{energy:?}"
        );
    }

    #[test]
    fn points_are_inside_a_sphere_or_not() {
        let sphere = Surface::new(&icosphere(3, 0.5));
        let points = [0.0, 0.45, 0.6].map(|x| Point3::new(x, 0.0, 0.0));
        let penetration = Penetration::of(&points, &sphere, 1.0);
        assert_eq!((penetration.num_inside, penetration.num_trapped), (2, 0));
        assert!((penetration.deepest - 0.5).abs() < 0.01);
        let lost = Lost::of(&points, &sphere);
        assert_eq!((lost.num, lost.num_caught), (2, 0));
        assert!((lost.deepest - 0.5).abs() < 0.01);
    }

    #[test]
    fn a_vertex_that_moves_is_counted() {
        let before = vec![Point3::origin(); 4];
        let mut after = before.clone();
        after[0].x = 0.001;
        let speeds = Speeds::between(&before, &after, 0.1);
        assert!((speeds.max - 0.01).abs() < 1e-6);
        assert!((speeds.share_moving - 0.25).abs() < 1e-6);
    }
}
