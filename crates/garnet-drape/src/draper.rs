//! The drape: warp, predict, relax, untangle.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use garnet_knn::TORN_STRETCH;
use garnet_mesh::{Point3, edge_stretch};
#[cfg(feature = "package")]
use garnet_sim::Moment;
use garnet_skin::{BodyAtHome, PosedBody, Warp};
use garnet_untangle::{UntangleError, UntangleOptions, UntangleReport, Untangled};
use tracing::{debug, info};

use crate::blending::{REACHES, blended, worse};
#[cfg(feature = "package")]
use crate::predicted::Learned;
use crate::{BoundGarment, Error};

/// How a garment is draped.
///
/// ```
/// use garnet_drape::DrapeOptions;
///
/// let options = DrapeOptions::default().with_clearance(0.003).with_relax_frames(12);
/// assert_eq!(options.untangle.map(|untangle| untangle.clearance), Some(0.003));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct DrapeOptions {
    /// How the garment is brought to the body where no network predicts it.
    pub warp: Warp,
    /// How it is freed of penetrations; `None` leaves them.
    pub untangle: Option<UntangleOptions>,
    /// For how many frames of a sixtieth of a second the cloth is simulated where it was brought;
    /// `None` leaves that to what brings it. Only garments with a simulator are relaxed.
    pub relax_frames: Option<u32>,
    /// Whether warped cloth that is still strained when it has settled is simulated all the way
    /// from the body at rest, which takes seconds. Neighbouring frames of a motion would jump.
    pub simulates_strained: bool,
}

impl Default for DrapeOptions {
    fn default() -> Self {
        Self {
            warp: Warp::Shape,
            untangle: Some(UntangleOptions::default()),
            relax_frames: None,
            simulates_strained: false,
        }
    }
}

impl DrapeOptions {
    /// The same with another warp.
    #[must_use]
    pub fn with_warp(self, warp: Warp) -> Self {
        Self { warp, ..self }
    }

    /// The same with another smallest distance between cloth and skin, in metres.
    #[must_use]
    pub fn with_clearance(self, clearance: f32) -> Self {
        let untangle = self.untangle.unwrap_or_default();
        Self {
            untangle: Some(UntangleOptions {
                clearance,
                ..untangle
            }),
            ..self
        }
    }

    /// The same with a clearance for cloth on limbs that are `scale` times as thick as a person's:
    /// see [`garnet_skin::BoundGarment::scale`].
    #[must_use]
    pub fn with_clearance_scaled(self, scale: f32) -> Self {
        let scaled = |untangle: UntangleOptions| UntangleOptions {
            clearance: scale * untangle.clearance,
            ..untangle
        };
        Self {
            untangle: self.untangle.map(scaled),
            ..self
        }
    }

    /// The same, freed of penetrations as is said.
    #[must_use]
    pub fn with_untangling(self, untangle: UntangleOptions) -> Self {
        Self {
            untangle: Some(untangle),
            ..self
        }
    }

    /// The same with penetrations left as they are.
    #[must_use]
    pub fn without_untangling(self) -> Self {
        Self {
            untangle: None,
            ..self
        }
    }

    /// The same, with warped cloth that stays strained simulated from rest.
    #[must_use]
    pub fn simulating_strained(self) -> Self {
        Self {
            simulates_strained: true,
            ..self
        }
    }

    /// The same with so many frames of relaxation, each a sixtieth of a second.
    #[must_use]
    pub fn with_relax_frames(self, frames: u32) -> Self {
        Self {
            relax_frames: Some(frames),
            ..self
        }
    }
}

/// A garment that was draped, and the report.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Drape {
    /// Positions `[vertex]`, in metres, in the order of the garment's mesh.
    pub positions: Vec<Point3>,
    /// Whether each vertex is caught where the body runs through itself `[vertex]`; empty if
    /// untangling was not asked for.
    pub is_trapped: Vec<bool>,
    /// What untangling found and left; `None` if it was not asked for.
    pub report: Option<UntangleReport>,
    /// How the drape came about.
    pub provenance: Provenance,
    /// How long each step took.
    pub seconds: DrapeSeconds,
}

/// How a drape came about.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct Provenance {
    /// The moment at which a network has predicted the cloth; `None` without a prediction.
    #[cfg(feature = "package")]
    pub predicted: Option<Moment>,
    /// The moment from which the cloth was simulated; `None` if it was not.
    #[cfg(feature = "package")]
    pub relaxed_from: Option<Moment>,
    /// What of the body is farther outside of the network's training than is trusted: it predicted
    /// at the edge of what it knows. `None` of bodies that it knows.
    #[cfg(feature = "package")]
    pub beyond: Option<crate::Unfamiliar>,
    /// Why the drape is not the one that was asked for; `None` if it is.
    pub fallback: Option<Fallback>,
    /// Why the cloth could not be simulated from where it was brought; `None` if it could, or was
    /// not to be.
    pub unrelaxed: Option<Arc<Error>>,
    /// What relaxing would have made worse: the drape is that before it; `None` if it is not.
    pub worsened: Option<Worsened>,
    /// How much of the cloth is where it was before it was relaxed, since it would be worse there,
    /// by area, from 0 to 1.
    pub unrelaxed_share: f32,
    /// How much of the relaxed cloth was falling when time was up, from 0 to 1: it has not come to
    /// lie on the body yet, or never will.
    pub falling_share: f32,
}

/// What would have become worse of a drape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Worsened {
    /// What it is like.
    pub before: DrapeQuality,
    /// What it would have become.
    pub after: DrapeQuality,
}

impl fmt::Display for Worsened {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { before, after } = self;
        if after.inside > before.inside {
            let (after, before) = (after.inside, before.inside);
            write!(
                formatter,
                "{after} vertices would be left in the body, {before} are without it"
            )
        } else if after.crossing > before.crossing {
            let (after, before) = (after.crossing, before.crossing);
            write!(
                formatter,
                "{after} faces would cross the skin, {before} do without it"
            )
        } else {
            write!(
                formatter,
                "1 % of the edges would be more than {:.2} times as long as in the garment, the \
                 longest {:.1} times, and without it {:.2} and {:.1}",
                after.p99, after.longest, before.p99, before.longest
            )
        }
    }
}

/// How good a drape is, as settling may change it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DrapeQuality {
    /// Vertices that are left inside the body and not trapped.
    pub inside: usize,
    /// Faces that cross the skin between vertices that are not trapped.
    pub crossing: usize,
    /// What 1 % of the edges exceed, over their length at rest.
    pub p99: f32,
    /// The longest edge, over its length at rest.
    pub longest: f32,
}

/// Longest edges up to this are no worse than shorter ones, over their length at rest.
const USUAL_STRETCH: f32 = 1.3;

/// What 1 % of the edges exceed is usual up to this, over their length at rest: most drapes that
/// simulators accept have 1.02 to 1.1. More compares fewer drapes with those before they settled,
/// and is faster.
const USUAL_P99: f32 = 1.1;

/// Predicted cloth that has settled is not compared with what it was for so small a share of faces
/// in the skin: to untangle that, too, takes longer than `fast`. More is faster, and leaves some.
const MOST_CROSSING: f32 = 1e-3;

/// Of a garment of which more than this share would go back it is told that it was not relaxed.
const MOST_UNRELAXED: f32 = 0.5;

/// Edges count as longer if they are by this factor: rounding and chance are less.
const LONGER: f32 = 1.02;

impl DrapeQuality {
    /// Whether nothing is wrong with it that the drape before it settled might do better, which was
    /// brought there by a warp or a network; of cloth with so many faces.
    fn is_sound(&self, before: PlacedBy, faces: usize) -> bool {
        let is_free = self.inside == 0;
        let most_crossing = MOST_CROSSING * faces as f32;
        match before {
            // Settling is known to bring it nearer, and to take faces out of the skin.
            PlacedBy::Network => {
                is_free && self.crossing as f32 <= most_crossing && self.longest <= TORN_STRETCH
            }
            PlacedBy::Warp | PlacedBy::Simulation => {
                is_free
                    && self.crossing == 0
                    && self.p99 <= USUAL_P99
                    && self.longest <= USUAL_STRETCH
            }
        }
    }

    /// Whether it is worse than that of another drape.
    pub fn is_worse_than(&self, other: &Self) -> bool {
        self.inside > other.inside
            || self.crossing > other.crossing
            || self.p99 > LONGER * other.p99.max(1.0)
            || self.longest > (LONGER * other.longest).max(USUAL_STRETCH)
    }
}

impl Provenance {
    /// What was relaxed is given up for what was before.
    fn keep(&mut self, before: DrapeQuality, after: DrapeQuality) {
        self.worsened = Some(Worsened { before, after });
        #[cfg(feature = "package")]
        {
            self.relaxed_from = None;
        }
    }
}

/// Why a drape is not the one that was asked for.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Fallback {
    /// The network was not trusted: the garment was warped by pose and shape, or, if the network
    /// predicts cloth on the way, simulated all the way from the body at rest.
    #[cfg(feature = "package")]
    Unfamiliar(crate::Unfamiliar),
    /// What the network predicts on the way could not be simulated further: the garment was warped
    /// by pose and shape.
    OnTheWay,
    /// What the network predicts on the way was relaxed and is torn: the garment was simulated all
    /// the way from the body at rest.
    Torn {
        /// Its longest edge over that at rest.
        stretch: f32,
    },
    /// What was warped stayed strained when it settled: the garment was simulated all the way from
    /// the body at rest.
    Strained {
        /// What 1 % of the edges exceeded, over their length at rest.
        p99: f32,
        /// The longest edge, over its length at rest.
        longest: f32,
    },
}

impl Fallback {
    /// Whether it is because of the body, which is unlike those of the training: the network was
    /// not asked. Otherwise what it predicted was of no use.
    pub const fn is_of_body(&self) -> bool {
        match self {
            #[cfg(feature = "package")]
            Self::Unfamiliar(reason) => !matches!(reason, crate::Unfamiliar::Torn { .. }),
            Self::OnTheWay | Self::Torn { .. } | Self::Strained { .. } => false,
        }
    }
}

impl fmt::Display for Fallback {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            #[cfg(feature = "package")]
            Self::Unfamiliar(reason) => reason.fmt(formatter),
            Self::OnTheWay => formatter.write_str("what is midway could not be simulated further"),
            Self::Torn { stretch } => write!(
                formatter,
                "what is midway was caught on the body, an edge {stretch:.1} times as long"
            ),
            Self::Strained { p99, longest } => write!(
                formatter,
                "when it settled, 1 % of its edges stayed more than {p99:.2} times as long, the \
                 longest {longest:.1} times"
            ),
        }
    }
}

/// Times of the steps of a drape, in seconds.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct DrapeSeconds {
    /// The warp; or, for [`Draper::simulate`], the simulation.
    pub warp: f64,
    /// The network, with all that it needs of a scene; 0 without one.
    pub predict: f64,
    /// The simulation of what was brought; 0 if it was left there.
    pub relax: f64,
    /// Untangling; 0 if it was not asked for.
    pub untangle: f64,
}

impl DrapeSeconds {
    /// Seconds of all steps together.
    pub fn total(&self) -> f64 {
        self.warp + self.predict + self.relax + self.untangle
    }
}

/// What has brought a garment to where it is untangled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum PlacedBy {
    /// Skinning: cloth is stretched and compressed where the body bends.
    Warp,
    /// A network: its strain is relaxed further than that of a warp.
    Network,
    /// A simulation: it keeps its folds and its strain.
    Simulation,
}

/// A garment that was brought to a body, not yet untangled.
#[derive(Debug, Clone)]
pub struct Placed<'a> {
    home: BodyAtHome<'a>,
    brought: Brought,
}

/// Where a garment is near the body at home.
#[derive(Debug, Clone)]
pub(crate) struct Brought {
    /// Positions `[node]`, in metres.
    pub(crate) nodes: Vec<Point3>,
    pub(crate) by: PlacedBy,
    /// Where it was before it was relaxed, if that is a drape, too.
    pub(crate) unrelaxed: Option<(Vec<Point3>, PlacedBy)>,
    pub(crate) provenance: Provenance,
    pub(crate) seconds: DrapeSeconds,
}

impl<'a> Placed<'a> {
    /// A garment that something else has brought to a body: positions `[vertex]` of its mesh, in
    /// metres.
    ///
    /// # Errors
    ///
    /// [`Error::Skin`] if `body` is not of the body that the garment was bound to.
    ///
    /// # Panics
    ///
    /// If there are fewer positions than vertices.
    pub fn at(
        garment: &BoundGarment,
        body: &'a PosedBody,
        positions: &[Point3],
        by: PlacedBy,
    ) -> Result<Self, Error> {
        let home = body.at_home(garment.body())?;
        let positions = home.from_target(positions.to_vec());
        Ok(Self {
            brought: Brought {
                nodes: garment.cloth().weld().gather(&positions),
                by,
                unrelaxed: None,
                provenance: Provenance::default(),
                seconds: DrapeSeconds::default(),
            },
            home,
        })
    }

    #[cfg(feature = "package")]
    pub(crate) fn new(home: BodyAtHome<'a>, brought: Brought) -> Self {
        Self { home, brought }
    }

    /// Positions `[vertex]` of the mesh of `garment` on the body, in metres.
    pub fn positions(&self, garment: &BoundGarment) -> Vec<Point3> {
        let at_home = garment.cloth().weld().scatter(&self.brought.nodes);
        self.home.to_target(at_home)
    }

    /// How it came there.
    pub fn provenance(&self) -> &Provenance {
        &self.brought.provenance
    }

    /// How long each step took so far.
    pub fn seconds(&self) -> DrapeSeconds {
        self.brought.seconds
    }
}

/// Drapes a bound garment on one posed body after the other.
///
/// The garment is warped to the body; a network, if there is one, predicts where the cloth is; the
/// simulation, if there is one, relaxes it from there; and penetrations are removed. What takes
/// memory is kept inside, so that threads may share a draper.
#[derive(Debug, Clone)]
pub struct Draper {
    pub(crate) garment: Arc<BoundGarment>,
    pub(crate) options: DrapeOptions,
    #[cfg(feature = "package")]
    pub(crate) learned: Learned,
}

impl Draper {
    /// Warps a garment by pose and shape, and untangles it with the default clearance, which goes
    /// by the thickness of the limbs.
    pub fn new(garment: impl Into<Arc<BoundGarment>>) -> Self {
        let garment = garment.into();
        let scale = garment.cloth().scale();
        Self {
            garment,
            options: DrapeOptions::default().with_clearance_scaled(scale),
            #[cfg(feature = "package")]
            learned: Learned::default(),
        }
    }

    /// The same with other options.
    #[must_use]
    pub fn with_options(self, options: DrapeOptions) -> Self {
        Self { options, ..self }
    }

    /// How this draper drapes.
    pub fn options(&self) -> &DrapeOptions {
        &self.options
    }

    /// The garment that it drapes.
    pub fn garment(&self) -> &Arc<BoundGarment> {
        &self.garment
    }

    /// Drapes the garment on a posed body, wherever that [stands](PosedBody::at_home).
    ///
    /// # Errors
    ///
    /// [`Error::Skin`] or [`Error::Untangle`] if `body` is not of the body that the garment was
    /// bound to, or has coordinates out of any range. A network that is not trusted and a
    /// simulation that fails are no errors: see [`Provenance`].
    pub fn drape(&self, body: &PosedBody) -> Result<Drape, Error> {
        self.drape_until(body, &AtomicBool::new(false))
    }

    /// As [`Draper::drape`]; `stop` ends it.
    ///
    /// # Errors
    ///
    /// As [`Draper::drape`], and [`Error::is_stopped`] once `stop` is set.
    pub fn drape_until(&self, body: &PosedBody, stop: &AtomicBool) -> Result<Drape, Error> {
        let placed = self.place(body, stop)?;
        self.untangle(placed)
    }

    /// Drapes the garment on one body after the other.
    ///
    /// # Errors
    ///
    /// Each item as [`Draper::drape`].
    pub fn drape_all<'a>(
        &'a self,
        bodies: impl IntoIterator<Item = PosedBody> + 'a,
    ) -> impl Iterator<Item = Result<Drape, Error>> + 'a {
        bodies.into_iter().map(|body| self.drape(&body))
    }

    /// The first half of [`Draper::drape`]: all but untangling.
    ///
    /// # Errors
    ///
    /// As [`Draper::drape_until`].
    pub fn place<'a>(&self, body: &'a PosedBody, stop: &AtomicBool) -> Result<Placed<'a>, Error> {
        let home = body.at_home(self.garment.body())?;
        #[cfg(feature = "package")]
        let brought = self.brought(home.body(), stop)?;
        #[cfg(not(feature = "package"))]
        let brought = {
            let _ = stop;
            self.warped(home.body(), self.options.warp)?
        };
        Ok(Placed { home, brought })
    }

    /// The second half of [`Draper::drape`].
    ///
    /// # Errors
    ///
    /// [`Error::Untangle`] for a garment that was placed on another body.
    pub fn untangle(&self, placed: Placed<'_>) -> Result<Drape, Error> {
        let Placed { home, brought } = placed;
        let weld = self.garment.cloth().weld();
        let Brought {
            nodes,
            by,
            unrelaxed,
            mut provenance,
            mut seconds,
        } = brought;
        let Some(options) = &self.options.untangle else {
            return Ok(Drape {
                positions: home.to_target(weld.scatter(&nodes)),
                is_trapped: Vec::new(),
                report: None,
                provenance,
                seconds,
            });
        };
        let freed = |nodes: &[Point3], by: PlacedBy| {
            let options = match by {
                PlacedBy::Warp => *options,
                PlacedBy::Network => options.for_drapes(),
                PlacedBy::Simulation => options.for_simulated(),
            };
            self.garment.freed(home.body(), nodes, &options)
        };
        let start = Instant::now();
        let mut untangled = freed(&nodes, by)?;
        let settled = unrelaxed.map(|unrelaxed| (unrelaxed, self.quality(&untangled)));
        // To untangle the drape before, too, takes as long again.
        let faces = self.garment.mesh().num_faces();
        let doubtful = settled.filter(|((_, was_by), first)| !first.is_sound(*was_by, faces));
        if let Some(((unrelaxed, was_by), first)) = doubtful {
            let before = freed(&unrelaxed, was_by)?;
            let was = self.quality(&before);
            if first.is_worse_than(&was) {
                let found = (nodes.as_slice(), &before);
                if let Some((mended, share)) =
                    self.mended(home.body(), found, &untangled, &freed)?
                {
                    untangled = mended;
                    provenance.unrelaxed_share = share;
                } else {
                    untangled = before;
                    info!(?was, relaxed = ?first, "the drape before it was relaxed is better");
                    provenance.keep(was, first);
                }
            }
        }
        let positions = weld.scatter(&untangled.positions_nodes);
        let is_trapped = weld.scatter(&untangled.is_trapped);
        seconds.untangle = start.elapsed().as_secs_f64();
        debug!(
            seconds = seconds.untangle,
            inside = untangled.report.inside,
            crossing = untangled.report.crossing_faces,
            "untangled"
        );
        Ok(Drape {
            positions: home.to_target(positions),
            is_trapped,
            report: Some(untangled.report),
            provenance,
            seconds,
        })
    }

    /// Cloth that was relaxed to `nodes` and `relaxed` by untangling, but is worse than `before`:
    /// untangled otherwise, or where it was around what is worse; and how much of it is there. None
    /// if that is worse, too.
    fn mended(
        &self,
        body: &PosedBody,
        (nodes, before): (&[Point3], &Untangled),
        relaxed: &Untangled,
        freed: &impl Fn(&[Point3], PlacedBy) -> Result<Untangled, UntangleError>,
    ) -> Result<Option<(Untangled, f32)>, Error> {
        let was = self.quality(before);
        let is_sound = |other: &Untangled| !self.quality(other).is_worse_than(&was);
        // What untangling has strained gives way if its strain is relaxed, too.
        for by in [PlacedBy::Network, PlacedBy::Warp] {
            let other = freed(nodes, by)?;
            if is_sound(&other) {
                return Ok(Some((other, 0.0)));
            }
        }
        if self.quality(relaxed).p99 > LONGER * was.p99.max(1.0) {
            // All of the cloth is longer, not some places.
            return Ok(None);
        }
        let most = (LONGER * was.longest).max(USUAL_STRETCH);
        let is_worse = worse(&self.garment, body, relaxed, most)?;
        // Where cloth bends from one to the other, it may be worse, too.
        let mut is_ever_worse = is_worse.clone();
        for is_tried_again in [false, true] {
            for reach in REACHES {
                let around = if is_tried_again {
                    &is_ever_worse
                } else {
                    &is_worse
                };
                let (nodes, share) = blended(&self.garment, [before, relaxed], around, reach);
                if share > MOST_UNRELAXED {
                    break;
                }
                for by in [PlacedBy::Simulation, PlacedBy::Network] {
                    let other = freed(&nodes, by)?;
                    if is_sound(&other) {
                        info!(
                            share,
                            reach, "places go back to where they were before settling"
                        );
                        return Ok(Some((other, share)));
                    }
                    let still = worse(&self.garment, body, &other, most)?;
                    for (is_worse, still) in is_ever_worse.iter_mut().zip(still) {
                        *is_worse |= still;
                    }
                }
            }
        }
        Ok(None)
    }

    /// How good cloth is that was untangled.
    fn quality(&self, untangled: &Untangled) -> DrapeQuality {
        let cloth = self.garment.cloth();
        let is_free =
            |edge: &&[u32; 2]| !edge.iter().any(|&node| untangled.is_trapped[node as usize]);
        let edges: Vec<[u32; 2]> = (cloth.topology().edges().iter())
            .filter(is_free)
            .copied()
            .collect();
        let stretch = edge_stretch(cloth.rest_nodes(), &untangled.positions_nodes, &edges);
        let (p99, longest) = stretch.map_or((1.0, 1.0), |found| (found.p99, found.max));
        DrapeQuality {
            inside: untangled.report.inside,
            crossing: untangled.report.crossing_faces,
            p99,
            longest,
        }
    }

    /// The garment warped to a body at home.
    pub(crate) fn warped(&self, body: &PosedBody, warp: Warp) -> Result<Brought, Error> {
        let start = Instant::now();
        let nodes = self.garment.cloth().warped_nodes(body, warp)?;
        let seconds = start.elapsed().as_secs_f64();
        debug!(seconds, ?warp, "warped");
        Ok(Brought {
            nodes,
            by: PlacedBy::Warp,
            unrelaxed: None,
            provenance: Provenance::default(),
            seconds: DrapeSeconds {
                warp: seconds,
                ..DrapeSeconds::default()
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_drapes_without_a_fault_are_sound() {
        let sound = DrapeQuality {
            inside: 0,
            crossing: 0,
            p99: 1.05,
            longest: 1.25,
        };
        assert!(sound.is_sound(PlacedBy::Warp, 10_000));
        for faulty in [
            DrapeQuality { inside: 1, ..sound },
            DrapeQuality {
                crossing: 1,
                ..sound
            },
            DrapeQuality { p99: 1.2, ..sound },
            DrapeQuality {
                longest: 1.4,
                ..sound
            },
        ] {
            assert!(!faulty.is_sound(PlacedBy::Warp, 10_000), "{faulty:?}");
            assert!(faulty.is_worse_than(&sound), "{faulty:?}");
        }
        let some = DrapeQuality {
            crossing: 10,
            p99: 1.2,
            longest: 1.9,
            ..sound
        };
        assert!(some.is_sound(PlacedBy::Network, 10_000));
        assert!(!some.is_sound(PlacedBy::Network, 9_000));
        // What is sound is worse than nothing but what has less strain yet.
        let slack = DrapeQuality { p99: 1.0, ..sound };
        assert!(sound.is_worse_than(&slack) && !slack.is_worse_than(&sound));
    }
}
