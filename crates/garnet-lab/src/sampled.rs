//! What garments are draped on: the built-in body at rest, and poses of its library.

use std::error::Error;

use garnet_body::{
    poses::{PoseSampler, Poser, SelfContact, SoundPose},
    shape::ParametricBody,
};
use garnet_data::{default_rest_body, wearer_of};
use garnet_pattern::Wearer;
use garnet_skin::Body;

/// Poses are drawn with this seed.
const SEED: u64 = 7;

/// The built-in body, its measures, and so many poses.
pub(crate) fn posed_body(num_poses: u64) -> Result<(Body, Wearer, Vec<SoundPose>), Box<dyn Error>> {
    let body = ParametricBody::build(&default_rest_body())?.into_body();
    let wearer = wearer_of(&body).ok_or("the built-in body has measures")??;
    let poser = Poser::new(body.skeleton())?;
    let contact = SelfContact::new(&body)?;
    let sampler = PoseSampler::new(SEED);
    let poses: Result<Vec<SoundPose>, _> = (0..num_poses)
        .map(|index| sampler.sample_for(&poser, &contact, index))
        .collect();
    Ok((body, wearer, poses?))
}
