//! An outfit, put on one garment after the other.

use garnet_io::largest_distance;
use garnet_mesh::Point3;
use garnet_skin::PosedBody;

use super::{LayerCount, LayerOptions, WornGarment, count_layers, dressed, part_layers};
use crate::{Drape, Draper, Error, Placed, PlacedBy};

/// The bodies of two garments are one if no vertex is farther apart than this, in metres.
const SAME_BODY: f32 = 1e-4;

/// An outfit on one posed body: each garment is draped over those that are worn already.
///
/// [`Outfit::drape`] puts garments on, the innermost first. [`Outfit::free`] frees them of the skin
/// that they were pushed into by others, and [`Outfit::into_drapes`] gives the drapes. Who drapes
/// by other means takes the body that the next garment meets from [`Outfit::body_for`], and hands
/// the drape to [`Outfit::put_on`].
#[derive(Debug, Clone, Default)]
pub struct Outfit {
    garments: Vec<Put>,
}

/// One garment on the body.
#[derive(Debug, Clone)]
struct Put {
    draper: Draper,
    /// The wearer, without other garments, as a pose of the body of this one.
    wearer: PosedBody,
    drape: Drape,
}

impl Put {
    fn worn(&self) -> WornGarment<'_> {
        WornGarment {
            garment: self.draper.garment(),
            positions: self.drape.positions.clone(),
        }
    }

    /// Frees a garment that was moved of the skin; the report then tells both.
    fn free(&mut self) -> Result<(), Error> {
        let Some(first) = self.drape.report.clone() else {
            return Ok(());
        };
        let garment = self.draper.garment();
        let (places, by) = (&self.drape.positions, PlacedBy::Simulation);
        let placed = Placed::at(garment, &self.wearer, places, by)?;
        let freed = self.draper.untangle(placed)?;
        self.drape.seconds.untangle += freed.seconds.untangle;
        self.drape.positions = freed.positions;
        self.drape.is_trapped = freed.is_trapped;
        self.drape.report = freed.report.map(|mut report| {
            report.inside_before = first.inside_before;
            report.deepest_before = first.deepest_before;
            report.moved = report.moved.max(first.moved);
            report.max_displacement = report.max_displacement.max(first.max_displacement);
            report
        });
        Ok(())
    }
}

/// How two garments of an outfit run through each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct LayerPair {
    /// Number of the inner garment, from 0, the innermost.
    pub inner: usize,
    /// Number of the outer garment.
    pub outer: usize,
    /// What crosses.
    pub count: LayerCount,
}

impl Outfit {
    /// The wearer of the next garment: `posed`, which is of the body of that, or that body at the
    /// skin of who wears the first garment, if that is another.
    ///
    /// # Errors
    ///
    /// [`Error::Skin`] if the two bodies have not the same number of vertices.
    pub fn wearer_for(&self, draper: &Draper, posed: PosedBody) -> Result<PosedBody, Error> {
        let Some(first) = self.garments.first() else {
            return Ok(posed);
        };
        let skin = first.wearer.skin().positions();
        if is_same(posed.skin().positions(), skin) {
            return Ok(posed);
        }
        Ok(draper.garment().body().fitted(skin)?)
    }

    /// The body as the next garment meets it: `wearer`, thicker where others are worn already.
    ///
    /// # Errors
    ///
    /// [`Error::Skin`] if `wearer` is not of the body of the garment; [`Error::Knn`] or
    /// [`Error::Mesh`] for garments that are out of any range.
    pub fn body_for(&self, draper: &Draper, wearer: &PosedBody) -> Result<PosedBody, Error> {
        if self.garments.is_empty() {
            return Ok(wearer.clone());
        }
        let worn: Vec<WornGarment<'_>> = self.garments.iter().map(Put::worn).collect();
        dressed(wearer, &worn, draper.garment())
    }

    /// Puts on a garment that was draped on [`Outfit::body_for`], and parts it from those under it,
    /// and these from each other. Drapes that are not untangled stay as they are.
    ///
    /// # Errors
    ///
    /// [`Error::Mesh`] or [`Error::Knn`] for positions out of any range.
    pub fn put_on(&mut self, draper: Draper, wearer: PosedBody, drape: Drape) -> Result<(), Error> {
        self.garments.push(Put {
            draper,
            wearer,
            drape,
        });
        for outer in (1..self.garments.len()).rev() {
            for inner in (0..outer).rev() {
                self.part(inner, outer)?;
            }
        }
        Ok(())
    }

    /// Drapes a garment over those that are worn already, and puts it on.
    ///
    /// `posed` is of the body of the garment, as [`Body::fitted`](garnet_skin::Body::fitted) makes
    /// it of the skin of any built-in body. All garments are worn by who wears the first.
    ///
    /// # Errors
    ///
    /// As [`Draper::drape`] and [`Outfit::put_on`].
    pub fn drape(&mut self, draper: Draper, posed: PosedBody) -> Result<(), Error> {
        let wearer = self.wearer_for(&draper, posed)?;
        let drape = draper.drape(&self.body_for(&draper, &wearer)?)?;
        self.put_on(draper, wearer, drape)
    }

    /// How the garments run through each other, pair by pair.
    ///
    /// # Errors
    ///
    /// [`Error::Mesh`] for positions out of any range.
    pub fn layers(&self) -> Result<Vec<LayerPair>, Error> {
        let outers = 1..self.garments.len();
        let pairs = outers.flat_map(|outer| (0..outer).map(move |inner| (inner, outer)));
        let counted = pairs.map(|(inner, outer)| {
            let [under, over] = [inner, outer].map(|number| self.garments[number].worn());
            let count = count_layers(&under, &over)?;
            Ok(LayerPair {
                inner,
                outer,
                count,
            })
        });
        counted.collect()
    }

    /// Frees what was moved of the skin: the last step, before [`Outfit::layers`] and
    /// [`Outfit::into_drapes`].
    ///
    /// # Errors
    ///
    /// As [`Draper::untangle`].
    pub fn free(&mut self) -> Result<(), Error> {
        self.garments.iter_mut().try_for_each(Put::free)
    }

    /// The drapes, the innermost first.
    pub fn into_drapes(self) -> Vec<Drape> {
        let drapes = self.garments.into_iter().map(|put| put.drape);
        drapes.collect()
    }

    fn part(&mut self, inner: usize, outer: usize) -> Result<(), Error> {
        let [under, over] = [inner, outer].map(|number| &self.garments[number]);
        let Some(untangle) = over.draper.options().untangle else {
            return Ok(());
        };
        let options = LayerOptions {
            clearance: untangle.clearance,
            ..LayerOptions::default()
        };
        let (mut of_inner, mut of_outer) = (under.worn(), over.worn());
        part_layers(&mut of_inner, &mut of_outer, &over.wearer, options)?;
        let places = [of_inner.positions, of_outer.positions];
        for (number, places) in [inner, outer].into_iter().zip(places) {
            self.garments[number].drape.positions = places;
        }
        Ok(())
    }
}

fn is_same(places: &[Point3], others: &[Point3]) -> bool {
    places.len() == others.len() && largest_distance(places, others) < SAME_BODY
}
