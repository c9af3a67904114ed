//! What is simulated: a garment, where it starts, and the body that it lies on.

use crate::rest_shape::check_count;
use crate::{Cloth, Collider, Motion, Point3, SimError};
use garnet_mesh::check_range;

/// A garment at its start and a body that moves.
#[derive(Clone, Copy)]
pub struct Scene<'a> {
    /// The garment.
    pub cloth: &'a Cloth,
    /// Where its vertices are at the start `[vertex]`, in metres: on the body at time 0, and best
    /// at rest there. Cloth that is dropped from afar finds other folds for each body.
    pub start: &'a [Point3],
    /// What the garment lies on, if anything.
    pub body: Option<MovingBody<'a>>,
}

/// A collider and how it moves.
#[derive(Clone, Copy)]
pub struct MovingBody<'a> {
    /// The faces of the body.
    pub collider: &'a Collider,
    /// Where its vertices are at each time from 0 to 1.
    pub motion: &'a Motion<'a>,
    /// The air between garment and body while the body moves. `None`: it stands still.
    pub wind: Option<Wind<'a>>,
    /// Parts of the body that each garment vertex may touch `[vertex]`: bit k stands for part k.
    /// `None`: all may touch all.
    pub allowed_parts: Option<&'a [u32]>,
    /// The face of the body that each garment vertex lies on, or one near it, if that is known
    /// `[vertex]`: cloth that starts near the skin then needs no search for it.
    pub likely_faces: Option<&'a [u32]>,
}

/// Air that goes along with a body and carries loose cloth.
#[derive(Clone, Copy)]
pub struct Wind<'a> {
    /// Where the garment's vertices `[vertex]` would be at each time from 0 to 1 if they went along
    /// with the body, as skinning moves them.
    pub motion: &'a Motion<'a>,
    /// How loose the garment is around each vertex `[vertex]`: 1 for cloth that the wind carries, 0
    /// for cloth that skin alone does.
    pub looseness: &'a [f32],
}

impl std::fmt::Debug for Scene<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("Scene")
            .field("num_vertices", &self.cloth.num_vertices())
            .field("body", &self.body)
            .finish_non_exhaustive()
    }
}

impl std::fmt::Debug for Wind<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("Wind")
            .field("num_vertices", &self.looseness.len())
            .finish_non_exhaustive()
    }
}

impl std::fmt::Debug for MovingBody<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("MovingBody")
            .field("num_faces", &self.collider.faces().len())
            .finish_non_exhaustive()
    }
}

impl Scene<'_> {
    /// Refuses a start that does not fit the garment or is not finite, and masks that do not fit.
    ///
    /// # Errors
    ///
    /// [`SimError::Count`] or [`SimError::Garment`].
    pub fn check(&self) -> Result<(), SimError> {
        let num_vertices = self.cloth.num_vertices();
        check_count("positions of the garment", self.start.len(), num_vertices)?;
        check_range(self.start).map_err(SimError::Garment)?;
        if let Some(masks) = self.body.and_then(|body| body.allowed_parts) {
            check_count("masks of allowed parts", masks.len(), num_vertices)?;
        }
        if let Some(body) = self.body
            && let Some(faces) = body.likely_faces
        {
            check_count("faces that vertices lie on", faces.len(), num_vertices)?;
            let num_faces = body.collider.faces().len();
            if let Some(&face) = faces.iter().find(|&&face| face as usize >= num_faces) {
                return Err(SimError::Count {
                    what: "faces of the body that vertices lie on",
                    found: face as usize + 1,
                    expected: num_faces,
                });
            }
        }
        if let Some(wind) = self.body.and_then(|body| body.wind) {
            check_count("loosenesses", wind.looseness.len(), num_vertices)?;
        }
        Ok(())
    }

    /// The parts that each vertex may touch; 0 for those that are held or touch nothing.
    pub(crate) fn masks(&self) -> Vec<u32> {
        let allowed = self.body.and_then(|body| body.allowed_parts);
        let masks = self.cloth.is_pinned().iter().enumerate();
        masks
            .map(|(vertex, &is_pinned)| match (is_pinned, allowed) {
                (true, _) => 0,
                (false, None) => u32::MAX,
                (false, Some(allowed)) => allowed[vertex],
            })
            .collect()
    }
}
