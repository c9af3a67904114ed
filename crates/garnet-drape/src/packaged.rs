//! A garment package that drapes by itself.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use garnet_mesh::Point3;
use garnet_skin::{Body, PosedBody};

use crate::{BodyPath, GarmentPackage, Moment, Settling, Teacher};
use crate::{BoundGarment, Drape, Draper, Error, Garment, Moved, Network, Unfamiliar, Warped};

/// A garment of a package with one of its networks, ready for one body after another: what `garnet drape PACKAGE` does.
///
/// The network tells where the cloth is, the simulation lets it settle from there if that brings it nearer to the teacher, and
/// it is freed of penetrations. The parts are [`Network`], [`Teacher`] and [`Draper`].
///
/// # Examples
///
/// ```no_run
/// use std::path::Path;
///
/// use garnet_drape::PackagedGarment;
/// use garnet_io::{ObjFile, write_obj};
///
/// let mut shirt = PackagedGarment::open(Path::new("models/tshirt"), None)?;
/// let reach = ObjFile::read("models/demo/reach.obj")?;
/// let target = shirt.body().fitted(reach.positions())?;
/// let drape = shirt.drape(&target)?.drape;
/// write_obj("draped.obj", &shirt.garment().mesh().with_positions(drape.positions)?)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct PackagedGarment {
    body: Body,
    garment: BoundGarment,
    network: Network,
    teacher: Teacher,
    settling: Settling,
    draper: Draper,
}

/// A drape by a network.
#[derive(Debug)]
pub struct PackagedDrape {
    /// Where the garment is.
    pub drape: Drape,
    /// Why the network was not asked: the garment was warped by pose and shape, or, if the network tells where cloth is midway,
    /// simulated all the way from the body at rest.
    pub fallback: Option<Unfamiliar>,
    /// Why the cloth did not settle: it is where the network has put it, or, if that was on the way, warped.
    pub unsettled: Option<Error>,
}

impl PackagedGarment {
    /// Reads a package, binds its garment to its body, and reads the weights of a variant; of the default one
    /// if none is named.
    ///
    /// # Errors
    ///
    /// What [`GarmentPackage::read`], [`Garment::bind`] and [`Network::load`] refuse, and [`Error::Package`] for a variant that the package
    /// does not have.
    pub fn open(folder: &Path, variant: Option<&str>) -> Result<Self, Error> {
        let package = GarmentPackage::read(folder)?;
        let manifest = &package.manifest;
        let default = manifest.default_variant();
        let name = variant.or(default.map(|variant| variant.name.as_str()));
        let name = name.unwrap_or("default");
        let weights = manifest.weights_of(folder, name)?;
        let garment = Garment::new(package.mesh.clone()).bind(&package.body)?;
        let parameters = manifest.sewing_parameters();
        let network = Network::load(weights, &garment, &package.body, &parameters)?;
        let from = network.moment();
        let settling = (manifest.variant(name)).map(|variant| variant.settling(from));
        Ok(Self {
            teacher: Teacher::new(&package)?,
            settling: settling.unwrap_or(Settling::of(from)),
            body: package.body,
            garment,
            network,
            draper: Draper::new(),
        })
    }

    /// The body that the garment lies on at rest; targets are this body, [posed](Body::posed) or [fitted](Body::fitted).
    pub fn body(&self) -> &Body {
        &self.body
    }

    /// The garment on that body.
    pub fn garment(&self) -> &BoundGarment {
        &self.garment
    }

    /// Drapes the garment on the body in another pose and shape, wherever it [stands](PosedBody::at_home).
    ///
    /// # Errors
    ///
    /// [`Error::Skin`] if `target` is not of [this body](Self::body); [`Error::Net`] or [`Error::Untangle`] for
    /// coordinates out of any range. A simulation that fails is [no error](PackagedDrape::unsettled).
    pub fn drape(&mut self, target: &PosedBody) -> Result<PackagedDrape, Error> {
        let home = target.at_home(&self.body)?;
        let mut draped = self.drape_at_home(home.body())?;
        draped.drape.positions = home.to_target(draped.drape.positions);
        Ok(draped)
    }

    fn drape_at_home(&mut self, target: &PosedBody) -> Result<PackagedDrape, Error> {
        let moment = self.settling.from;
        let on_way = if moment.is_on_way() {
            let path = BodyPath::to_posed(&self.body, target);
            Some(path.posed(&self.body, moment.motion_share())?)
        } else {
            None
        };
        let seen = on_way.as_ref().unwrap_or(target);
        let warped = self.network.warped(&self.garment, seen)?;
        let Moved { garment, fallback } = self.network.moved(&self.garment, seen, &warped)?;
        let from = match (&fallback, &on_way) {
            (None, _) => Some((garment.positions(&self.garment), self.settling)),
            (Some(_), Some(_)) => {
                let settling = Settling {
                    from: Moment::Start,
                    ..self.settling
                };
                Some((self.garment.mesh().positions().to_vec(), settling))
            }
            // What fell back to the warp is far from where cloth rests.
            (Some(_), None) => None,
        };
        let settled = from.map(|(from, settling)| self.settled(target, &from, settling));
        let (put, unsettled) = match settled {
            Some(Ok(settled)) => (settled, None),
            None => (garment, None),
            Some(Err(error)) if on_way.is_none() => (garment, Some(error)),
            Some(Err(error)) => (self.draper.warp(&self.garment, target)?, Some(error)),
        };
        Ok(PackagedDrape {
            drape: self.draper.finish(&self.garment, target, &put)?,
            fallback,
            unsettled,
        })
    }

    fn settled(
        &self,
        target: &PosedBody,
        from: &[Point3],
        settling: Settling,
    ) -> Result<Warped, Error> {
        let never = AtomicBool::new(false);
        let settled = (self.teacher).settled(&self.body, target, from, settling, &never)?;
        Ok(Warped::settled(&self.garment, &settled, settling))
    }
}

impl Warped {
    /// A garment that has [settled](Teacher::settled) where something else had put it, to be untangled: positions `[vertex]` of its mesh, in metres.
    ///
    /// # Panics
    ///
    /// If there are fewer positions than vertices.
    pub fn settled(garment: &BoundGarment, positions: &[Point3], settling: Settling) -> Self {
        if settling.finds_folds() {
            Self::simulated(garment, positions)
        } else {
            Self::at(garment, positions)
        }
    }
}
