//! All cells of the table.

use std::sync::atomic::{AtomicBool, Ordering};

use garnet_drape::Package;
use garnet_mesh::Point3;
use serde::{Deserialize, Serialize};

use crate::StressError;
use crate::axis::{AXES, Axis, Kind};
use crate::method::{Draped, Method, Way};
use crate::scene::{Scene, Scenes};
use crate::verdict::{Broken, Measured, broken, jump, measured};

/// Scenes that only stand elsewhere may differ by this much of the garment's size: single
/// precision at the distance of the bar.
const MOST_DIFFERENCE: f64 = 1e-4;

/// What a stress test runs, and how.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct StressOptions {
    /// The axes; all, by default.
    pub axes: Vec<&'static Axis>,
    /// The methods; without the package's variants, by default.
    pub methods: Vec<Method>,
    /// Few levels, none beyond the bar.
    pub is_quick: bool,
    /// Of noise, holes and damage.
    pub seed: u64,
}

impl Default for StressOptions {
    fn default() -> Self {
        let ours = [Method::Untangled];
        Self {
            axes: AXES.iter().collect(),
            methods: Method::CLASSIC.into_iter().chain(ours).collect(),
            is_quick: false,
            seed: 1,
        }
    }
}

/// A method at a level of an axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Cell {
    /// Name of the axis.
    pub axis: String,
    /// Name of the method.
    pub method: String,
    /// The level, in the axis' unit.
    pub level: f64,
    /// What was measured; none of what is not finite or failed.
    pub measured: Option<Measured>,
    /// Which invariant broke.
    pub broken: Option<Broken>,
    /// Why another method draped in place of the network.
    pub fallback: Option<String>,
}

/// How far a method holds on an axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Hold {
    /// Name of the axis.
    pub axis: &'static str,
    /// Name of the method.
    pub method: String,
    /// The highest level up to which all levels hold; none if the first does not.
    pub held: Option<f64>,
    /// The level after it, and what broke there; none if all hold.
    pub broke: Option<(f64, Broken)>,
    /// The first level at which another method draped in place of the network, if one did.
    pub falls_back: Option<f64>,
    /// Whether it fails: it is ours, and breaks at the bar or before.
    pub fails: bool,
}

/// Runs all cells that `known` has not, axis by axis, and tells each.
///
/// Cells depend on package, options and version alone, but for their times.
///
/// # Errors
///
/// [`StressError`] if the package cannot be draped at all; what fails in a cell is its result.
pub fn run(
    package: &Package,
    options: &StressOptions,
    known: &[Cell],
    observer: &mut dyn FnMut(&Cell),
    stop: &AtomicBool,
) -> Result<Vec<Cell>, StressError> {
    let scenes = Scenes::new(package, options.seed)?;
    let mut methods = options.methods.clone();
    // The others are compared with it.
    methods.sort_by_key(|method| *method != Method::Simulator);
    let ways = methods.into_iter().map(|method| Way::new(package, method));
    let ways: Vec<Way<'_>> = ways.collect::<Result<_, _>>()?;
    let mut cells = Vec::new();
    for axis in &options.axes {
        let mut of_axis = OfAxis::new(axis, &ways, known);
        if let Some(whole) = of_axis.whole(&scenes, options.is_quick) {
            whole.iter().for_each(&mut *observer);
            cells.extend(whole);
            continue;
        }
        for &level in axis.levels(options.is_quick) {
            if stop.load(Ordering::Relaxed) {
                return Ok(cells);
            }
            for cell in of_axis.at(&scenes, level, stop)? {
                observer(&cell);
                cells.push(cell);
            }
        }
    }
    Ok(cells)
}

/// A scene and what was draped in it `[method]`.
struct Before {
    level: f64,
    scene: Scene,
    positions: Vec<Option<Vec<Point3>>>,
}

/// Goes along an axis.
struct OfAxis<'a> {
    axis: &'static Axis,
    ways: &'a [Way<'a>],
    known: &'a [Cell],
    before: Option<Before>,
    /// The first drapes, in scenes that have to look like the first.
    first: Option<Before>,
}

impl<'a> OfAxis<'a> {
    fn new(axis: &'static Axis, ways: &'a [Way<'a>], known: &'a [Cell]) -> Self {
        Self {
            axis,
            ways,
            known,
            before: None,
            first: None,
        }
    }

    fn known(&self, way: &Way<'_>, level: f64) -> Option<&Cell> {
        let name = way.method.to_string();
        self.known.iter().find(|cell| {
            cell.axis == self.axis.name
                && cell.method == name
                && cell.level.to_bits() == level.to_bits()
        })
    }

    /// The methods that drape in scenes of the axis, each with whether it does.
    fn asked(&self) -> impl Iterator<Item = (&'a Way<'a>, bool)> {
        let has_network = self.axis.kind.is_of_package();
        let ways = self.ways.iter();
        ways.map(move |way| (way, has_network || !way.method.is_of_package()))
    }

    /// The cells of a level, if all are known.
    fn all_known(&self, level: f64) -> Option<Vec<Cell>> {
        let asked = self.asked().filter(|(_, is_asked)| *is_asked);
        asked
            .map(|(way, _)| self.known(way, level).cloned())
            .collect()
    }

    /// All cells of the axis, if all are known: those of a motion need no drape then, either.
    fn whole(&self, scenes: &Scenes<'_>, is_quick: bool) -> Option<Vec<Cell>> {
        let mut whole = Vec::new();
        for &level in self.axis.levels(is_quick) {
            match self.all_known(level) {
                Some(cells) => whole.extend(cells),
                // There is nothing to know where there is no scene.
                None if matches!(scenes.at(self.axis, level), Ok(None)) => {}
                None => return None,
            }
        }
        Some(whole)
    }

    fn at(
        &mut self,
        scenes: &Scenes<'_>,
        level: f64,
        stop: &AtomicBool,
    ) -> Result<Vec<Cell>, StressError> {
        // Cells of motions and comparisons need what was draped before.
        let stands_alone = !self.axis.kind.is_motion() && !is_compared(self.axis.kind);
        if let (true, Some(known)) = (stands_alone, self.all_known(level)) {
            return Ok(known);
        }
        let scene = match scenes.at(self.axis, level) {
            Ok(Some(scene)) => scene,
            Ok(None) => return Ok(Vec::new()),
            Err(error) => return Ok(self.all_fail(level, &error)),
        };
        let mut cells = Vec::new();
        let mut positions: Vec<Option<Vec<Point3>>> = Vec::new();
        let mut of_simulator: Option<(Vec<Point3>, Option<f64>)> = None;
        for (number, (way, is_asked)) in self.asked().enumerate() {
            if !is_asked {
                positions.push(None);
                continue;
            }
            let draped = draped(way, &scene, stop);
            if stop.load(Ordering::Relaxed) {
                return Ok(cells);
            }
            let (mut cell, found) = self.judged(way, level, &scene, draped)?;
            if let (Some(measured), Some(found)) = (&mut cell.measured, &found) {
                measured.jump = self.jump(number, level, &scene, found);
                let simulated = of_simulator.as_ref();
                measured.from_simulator = simulated.map(|(other, _)| mean_distance(found, other));
                let allowed = simulated.and_then(|(_, jump)| *jump);
                cell.broken =
                    broken(measured, allowed).or_else(|| self.differs(number, &scene, found));
                if way.method == Method::Simulator {
                    of_simulator = Some((found.clone(), measured.jump));
                }
            }
            positions.push(found);
            cells.push(self.known(way, level).cloned().unwrap_or(cell));
        }
        let now = Before {
            level,
            scene,
            positions,
        };
        if self.first.is_none() && is_compared(self.axis.kind) {
            self.first = Some(now);
        } else {
            self.before = Some(now);
        }
        Ok(cells)
    }

    fn all_fail(&self, level: f64, error: &StressError) -> Vec<Cell> {
        let asked = self.asked().filter(|(_, is_asked)| *is_asked);
        let cells = asked.map(|(way, _)| Cell {
            broken: Some(Broken::Failed(error.to_string())),
            ..self.cell(way, level)
        });
        cells.collect()
    }

    fn cell(&self, way: &Way<'_>, level: f64) -> Cell {
        Cell {
            axis: self.axis.name.to_owned(),
            method: way.method.to_string(),
            level,
            measured: None,
            broken: None,
            fallback: None,
        }
    }

    /// The cell without what other scenes decide, and the positions.
    fn judged(
        &self,
        way: &Way<'_>,
        level: f64,
        scene: &Scene,
        draped: Result<Draped, StressError>,
    ) -> Result<(Cell, Option<Vec<Point3>>), StressError> {
        let mut cell = self.cell(way, level);
        let draped = match draped {
            Ok(draped) => draped,
            Err(error) => {
                cell.broken = Some(Broken::Failed(error.to_string()));
                return Ok((cell, None));
            }
        };
        cell.fallback.clone_from(&draped.fallback);
        cell.measured = measured(scene, &draped)?;
        if cell.measured.is_none() {
            cell.broken = Some(Broken::NotFinite);
            return Ok((cell, None));
        }
        Ok((cell, Some(draped.positions)))
    }

    fn jump(&self, number: usize, level: f64, scene: &Scene, found: &[Point3]) -> Option<f64> {
        let before = self
            .before
            .as_ref()
            .filter(|_| self.axis.kind.is_motion())?;
        let places = before.positions.get(number)?.as_ref()?;
        let degrees = level - before.level;
        Some(jump([places, found], [&before.scene, scene], degrees))
    }

    /// Whether a drape differs from the first one where it must not.
    fn differs(&self, number: usize, scene: &Scene, found: &[Point3]) -> Option<Broken> {
        let first = self.first.as_ref()?;
        let expected = first.positions.get(number)?.as_ref()?;
        let farthest = match (scene.moved_by, scene.threads) {
            (Some(moved), _) => farthest(found, expected.iter().map(|place| moved * place)),
            (None, Some(_)) => farthest(found, expected.iter().copied()),
            (None, None) if scene.is_as_first => farthest(found, expected.iter().copied()),
            (None, None) => return None,
        };
        let share = f64::from(farthest) / scene.size().max(1e-9);
        let most = if scene.threads.is_some() {
            0.0
        } else {
            MOST_DIFFERENCE
        };
        (share > most).then_some(Broken::Differs(share))
    }
}

fn is_compared(kind: Kind) -> bool {
    matches!(
        kind,
        Kind::Place | Kind::Threads | Kind::Antipodal | Kind::UnscaledWeights
    )
}

fn draped(way: &Way<'_>, scene: &Scene, stop: &AtomicBool) -> Result<Draped, StressError> {
    match scene.threads {
        None => way.drape(scene, stop),
        Some(threads) => {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()?;
            pool.install(|| way.drape(scene, stop))
        }
    }
}

fn farthest(found: &[Point3], expected: impl Iterator<Item = Point3>) -> f32 {
    let distances = found.iter().zip(expected).map(|(a, b)| (a - b).norm());
    distances.fold(0.0, f32::max)
}

fn mean_distance(found: &[Point3], other: &[Point3]) -> f64 {
    let pairs = found.iter().zip(other);
    let sum: f64 = pairs.map(|(a, b)| f64::from((a - b).norm())).sum();
    sum / found.len().max(1) as f64
}

/// How far each method holds on each axis, in the order of the options.
pub fn holds(options: &StressOptions, cells: &[Cell]) -> Vec<Hold> {
    let mut holds = Vec::new();
    for axis in &options.axes {
        for method in &options.methods {
            let name = method.to_string();
            let of_both = |cell: &&Cell| cell.axis == axis.name && cell.method == name;
            let mut cells: Vec<&Cell> = cells.iter().filter(of_both).collect();
            if cells.is_empty() {
                continue;
            }
            cells.sort_by(|a, b| a.level.total_cmp(&b.level));
            let first = cells.iter().position(|cell| cell.broken.is_some());
            let broke = first.and_then(|first| {
                let cell = cells[first];
                cell.broken.clone().map(|broken| (cell.level, broken))
            });
            let held = cells[..first.unwrap_or(cells.len())]
                .last()
                .map(|cell| cell.level);
            let falls_back = cells.iter().find(|cell| cell.fallback.is_some());
            let is_at_bar = |(level, _): &(f64, Broken)| *level <= axis.bar;
            holds.push(Hold {
                axis: axis.name,
                method: name,
                held,
                falls_back: falls_back.map(|cell| cell.level),
                fails: method.is_ours() && broke.as_ref().is_some_and(is_at_bar),
                broke,
            });
        }
    }
    holds
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell(method: &Method, level: f64, broken: Option<Broken>) -> Cell {
        Cell {
            axis: "elbow".to_owned(),
            method: method.to_string(),
            level,
            measured: Some(Measured::default()),
            broken,
            fallback: None,
        }
    }

    #[test]
    fn a_method_holds_up_to_its_first_broken_level() {
        let options = StressOptions {
            axes: vec![&AXES[0]],
            methods: vec![Method::Linear, Method::Untangled, Method::Warp],
            ..StressOptions::default()
        };
        let mut cells = Vec::new();
        for level in [0.0, 10.0, 20.0] {
            let torn = (level > 5.0).then_some(Broken::Torn(4.0));
            cells.push(cell(&Method::Linear, level, torn));
            let inside = (level > 15.0).then_some(Broken::Inside(3));
            cells.push(cell(&Method::Untangled, level, inside));
        }
        let found = holds(&options, &cells);
        // Of the third there are no cells.
        assert_eq!(found.len(), 2);
        assert_eq!((found[0].held, found[0].fails), (Some(0.0), false));
        assert_eq!(found[0].broke, Some((10.0, Broken::Torn(4.0))));
        assert_eq!((found[1].held, found[1].fails), (Some(10.0), true));
    }

    #[test]
    fn ours_may_break_beyond_the_bar() {
        let options = StressOptions {
            axes: vec![&AXES[0]],
            methods: vec![Method::Untangled],
            ..StressOptions::default()
        };
        let cells = [
            cell(&Method::Untangled, 150.0, None),
            cell(&Method::Untangled, 160.0, Some(Broken::NotFinite)),
        ];
        let found = holds(&options, &cells);
        assert_eq!((found[0].held, found[0].fails), (Some(150.0), false));
    }
}
