//! Garments made for one body, on a body of another topology.

use garnet_body::Registration;
use garnet_mesh::{Point3, TriMesh};
use garnet_skin::{Body, Pose, PosedBody, Warp};

use crate::{BoundGarment, Draper, Error, Garment};

/// A garment and the body that it was made for, brought to another body.
///
/// Its own body stands in for the other one: each of its vertices has a place on the other skin,
/// wherever that moves. The garment lies on the other body at rest as it does on the stand-in, and
/// a network that was trained on the own body drapes on the stand-in; only penetrations are removed
/// from the other skin itself.
#[derive(Debug, Clone)]
pub struct Refit {
    garment: BoundGarment,
    registration: Registration,
}

impl Refit {
    /// Brings a garment that lies on the body `own` at rest to the body `other`.
    ///
    /// # Errors
    ///
    /// [`Error::Figure`] if one of the skeletons is no human figure, and those of
    /// [`Garment::bind`].
    pub fn new(garment: Garment, own: &Body, other: &Body) -> Result<Self, Error> {
        let (registration, garment) =
            rayon::join(|| Registration::new(own, other), || garment.bind(own));
        Ok(Self {
            registration: registration?,
            garment: garment?,
        })
    }

    /// The body that the garment was made for.
    pub fn own(&self) -> &Body {
        self.garment.body()
    }

    /// The garment on that body.
    pub fn garment(&self) -> &BoundGarment {
        &self.garment
    }

    /// The garment on the other body at rest, free of penetrations.
    ///
    /// # Errors
    ///
    /// As [`Refit::stand_in`], and those of binding and untangling.
    pub fn dressed(&self, other: &Body) -> Result<TriMesh, Error> {
        let stand_in = self.stand_in(other.rest().positions())?;
        let warped = self.garment.warped(&stand_in, Warp::Shape)?;
        let warped = self.garment.mesh().with_positions(warped)?;
        let bound = Garment::new(warped).bind(other)?;
        let rest = other.posed(&Pose::rest(other.skeleton().num_joints()))?;
        let drape = Draper::new(bound).drape(&rest)?;
        Ok(self.garment.mesh().with_positions(drape.positions)?)
    }

    /// The own body with shape and pose of the other one, from the vertices `[vertex]` of that, in
    /// metres.
    ///
    /// # Errors
    ///
    /// [`Error::Skin`] if they are too degenerate to find the pose.
    pub fn stand_in(&self, skin: &[Point3]) -> Result<PosedBody, Error> {
        Ok(self.own().fitted(&self.registration.carried(skin))?)
    }
}
