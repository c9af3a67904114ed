//! Draping: warp, then untangle.

use garnet_mesh::Point3;
use garnet_skin::{PosedBody, Warp};
use garnet_untangle::{UntangleOptions, UntangleReport, untangle};

use crate::{BoundGarment, Error};

/// How a garment is draped.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DrapeOptions {
    /// How the garment is brought to the target body.
    pub warp: Warp,
    /// How it is freed of penetrations; `None` leaves the warp as it is.
    pub untangle: Option<UntangleOptions>,
}

/// A draped garment.
#[derive(Debug, Clone)]
pub struct Drape {
    /// Positions `[vertex]`, in metres, in the order of the garment's mesh.
    pub positions: Vec<Point3>,
    /// Whether each vertex is caught where the body runs through itself `[vertex]`; empty if
    /// untangling was not asked for.
    pub is_trapped: Vec<bool>,
    /// What untangling found and left; `None` if it was not asked for.
    pub report: Option<UntangleReport>,
}

/// Drapes bound garments on posed bodies.
#[derive(Debug, Clone, Copy, Default)]
pub struct Draper {
    options: DrapeOptions,
}

/// A garment warped to a body, not yet untangled.
#[derive(Debug, Clone)]
pub struct Warped {
    /// Positions `[node]`, in metres; see [`garnet_skin::Weld`].
    pub(crate) nodes: Vec<Point3>,
    pub(crate) put_by: PutBy,
}

/// What has brought a garment to where it is untangled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PutBy {
    Skinning,
    Network,
    Simulation,
}

impl Warped {
    /// A garment that a network has brought to the body, to be untangled: positions
    /// `[vertex]` of its mesh, in metres. Its strain is relaxed further than that of a warp.
    ///
    /// # Panics
    ///
    /// If there are fewer positions than vertices.
    pub fn at(garment: &BoundGarment, positions: &[Point3]) -> Self {
        Self {
            nodes: garment.cloth.weld().gather(positions),
            put_by: PutBy::Network,
        }
    }

    /// A garment that a simulation has brought to the body, to be untangled: positions
    /// `[vertex]` of its mesh, in metres. It keeps its folds and its strain.
    ///
    /// # Panics
    ///
    /// If there are fewer positions than vertices.
    pub fn simulated(garment: &BoundGarment, positions: &[Point3]) -> Self {
        Self {
            put_by: PutBy::Simulation,
            ..Self::at(garment, positions)
        }
    }

    /// Positions `[vertex]` of the mesh of the garment, in metres.
    pub fn positions(&self, garment: &BoundGarment) -> Vec<Point3> {
        garment.cloth.weld().scatter(&self.nodes)
    }
}

impl Draper {
    /// Warps by pose and shape and untangles with the default clearance.
    pub fn new() -> Self {
        Self::with_options(DrapeOptions {
            warp: Warp::Shape,
            untangle: Some(UntangleOptions::default()),
        })
    }

    /// Drapes as `options` say.
    pub fn with_options(options: DrapeOptions) -> Self {
        Self { options }
    }

    /// How this draper drapes.
    pub fn options(&self) -> &DrapeOptions {
        &self.options
    }

    /// Drapes a garment on a posed body.
    ///
    /// # Errors
    ///
    /// [`Error::Skin`] or [`Error::Untangle`] if `body` is not of the body that the garment was
    /// bound to.
    pub fn drape(&self, garment: &BoundGarment, body: &PosedBody) -> Result<Drape, Error> {
        let warped = self.warp(garment, body)?;
        self.finish(garment, body, &warped)
    }

    /// Drapes a garment on one body after the other.
    ///
    /// # Errors
    ///
    /// Each item as [`Draper::drape`].
    pub fn drape_all<'a>(
        &'a self,
        garment: &'a BoundGarment,
        bodies: impl IntoIterator<Item = PosedBody> + 'a,
    ) -> impl Iterator<Item = Result<Drape, Error>> + 'a {
        let bodies = bodies.into_iter();
        bodies.map(move |body| self.drape(garment, &body))
    }

    /// The first half of [`Draper::drape`], for those who time the halves.
    ///
    /// # Errors
    ///
    /// As [`Draper::drape`].
    pub fn warp(&self, garment: &BoundGarment, body: &PosedBody) -> Result<Warped, Error> {
        let nodes = garment.cloth.warped(body, self.options.warp)?;
        Ok(Warped {
            nodes,
            put_by: PutBy::Skinning,
        })
    }

    /// The second half of [`Draper::drape`].
    ///
    /// # Errors
    ///
    /// As [`Draper::drape`].
    pub fn finish(
        &self,
        garment: &BoundGarment,
        body: &PosedBody,
        warped: &Warped,
    ) -> Result<Drape, Error> {
        let weld = garment.cloth.weld();
        let Some(options) = &self.options.untangle else {
            return Ok(Drape {
                positions: weld.scatter(&warped.nodes),
                is_trapped: Vec::new(),
                report: None,
            });
        };
        let options = match warped.put_by {
            PutBy::Skinning => *options,
            PutBy::Network => options.for_drapes(),
            PutBy::Simulation => options.for_simulated(),
        };
        let (cloth, binding) = (&garment.cloth, &garment.binding);
        let untangled = untangle(cloth, binding, body, &warped.nodes, &options)?;
        Ok(Drape {
            positions: weld.scatter(&untangled.positions),
            is_trapped: weld.scatter(&untangled.is_trapped),
            report: Some(untangled.report),
        })
    }
}
