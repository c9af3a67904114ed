//! The coarse simulation that guides a network; simulations are part of the feature `train`.

use std::path::Path;

use garnet_mesh::{Fingerprint, TriMesh};
use garnet_skin::{Body, PosedBody, Vector3};

use crate::Error;

/// Why a simulation failed.
pub(crate) type Failure = String;

#[cfg(feature = "train")]
pub(crate) use with_simulation::Guide;
#[cfg(not(feature = "train"))]
pub(crate) use without_simulation::Guide;

#[cfg(feature = "train")]
mod with_simulation {
    use std::sync::atomic::AtomicBool;

    use garnet_data::DataError;

    use super::*;

    /// The guide of a network.
    #[derive(Debug)]
    pub(crate) struct Guide(garnet_data::Guide);

    impl Guide {
        pub(crate) fn read(
            folder: &Path,
            garment: &TriMesh,
            body: &Body,
            expected: Fingerprint,
        ) -> Result<Self, Error> {
            let guide = garnet_data::Guide::read(folder, garment, body).map_err(Box::new)?;
            guide.check(folder, expected).map_err(Box::new)?;
            Ok(Self(guide))
        }

        /// As [`garnet_data::Guide::offsets`].
        pub(crate) fn offsets(
            &self,
            body: &PosedBody,
        ) -> Result<Result<Vec<Vector3>, Failure>, Error> {
            match self.0.offsets(body, &AtomicBool::new(false)) {
                Ok(offsets) => Ok(Ok(offsets)),
                Err(DataError::Sim(error)) => Ok(Err(error.to_string())),
                Err(error) => Err(Box::new(error).into()),
            }
        }
    }
}

#[cfg(not(feature = "train"))]
mod without_simulation {
    use super::*;

    /// The guide of a network, which only builds that simulate can follow.
    #[derive(Debug)]
    pub(crate) struct Guide(std::convert::Infallible);

    impl Guide {
        pub(crate) fn read(_: &Path, _: &TriMesh, _: &Body, _: Fingerprint) -> Result<Self, Error> {
            Err(Error::NeedsSimulation)
        }

        pub(crate) fn offsets(
            &self,
            _: &PosedBody,
        ) -> Result<Result<Vec<Vector3>, Failure>, Error> {
            match self.0 {}
        }
    }
}
