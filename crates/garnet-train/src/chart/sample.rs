//! What is measured of a way to drape on one scene.

use serde::{Deserialize, Serialize};

use crate::{PenetrationCount, Percentiles, SceneName, Scores, Tally};

/// A way to drape, measured on a scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Sample {
    /// Number of the body in its split.
    pub body: u32,
    /// Number of the scene on the body.
    pub pose: u32,
    /// How long it took.
    pub seconds: Seconds,
    /// Before untangling.
    pub before: Tally,
    /// After untangling; none of simulations, which are left as they are.
    pub after: Option<Tally>,
    /// What is not as it should be, after untangling or as the simulation left it.
    pub left: PenetrationCount,
}

/// Wall times of the stages of one drape, in seconds.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Seconds {
    /// Skinning or warp.
    pub warp: f64,
    /// The network with all that it needs of a scene.
    pub network: f64,
    /// Untangling.
    pub untangle: f64,
    /// The simulation, or the settling of what a network has put.
    pub simulation: f64,
}

/// Wall times of single scenes, in seconds.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Times {
    /// From the posed body to the drape.
    pub total: Percentiles,
    /// Skinning or warp.
    pub warp: Percentiles,
    /// The network with all that it needs of a scene.
    pub network: Percentiles,
    /// Untangling.
    pub untangle: Percentiles,
    /// The simulation, or the settling of what a network has put.
    pub simulation: Percentiles,
}

/// What was measured of a way to drape, over scenes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Figures {
    /// Over how many.
    pub scenes: usize,
    /// Times of single scenes.
    pub seconds: Times,
    /// Before untangling.
    pub before: Scores,
    /// As it is used: after untangling, or as the simulation left it.
    pub after: Scores,
    /// Mean distance of the vertices of a scene, in metres, over the scenes.
    pub scene_distance: Percentiles,
    /// What is not as it should be, after untangling or as the simulation left it, in all scenes.
    #[serde(flatten)]
    pub left: PenetrationCount,
}

impl Seconds {
    /// From the posed body to the drape.
    pub fn total(&self) -> f64 {
        self.warp + self.network + self.untangle + self.simulation
    }
}

impl Sample {
    /// Whether it is of a scene.
    pub fn is_of(&self, scene: SceneName) -> bool {
        (self.body, self.pose) == (scene.body, scene.pose)
    }

    /// As it is used.
    fn used(&self) -> &Tally {
        self.after.as_ref().unwrap_or(&self.before)
    }
}

impl Figures {
    /// The tally of some samples.
    pub fn of<'a>(samples: impl IntoIterator<Item = &'a Sample>) -> Self {
        let samples: Vec<&Sample> = samples.into_iter().collect();
        let times = |stage: fn(&Seconds) -> f64| {
            let times = samples.iter().map(|sample| stage(&sample.seconds));
            Percentiles::of(times.collect())
        };
        let (mut before, mut after) = (Tally::default(), Tally::default());
        let mut left = PenetrationCount::NOTHING;
        for sample in &samples {
            before.merge(&sample.before);
            after.merge(sample.used());
            left.add(sample.left);
        }
        let distances = samples.iter().map(|sample| sample.used().scores().distance);
        Self {
            scenes: samples.len(),
            seconds: Times {
                total: times(Seconds::total),
                warp: times(|seconds| seconds.warp),
                network: times(|seconds| seconds.network),
                untangle: times(|seconds| seconds.untangle),
                simulation: times(|seconds| seconds.simulation),
            },
            before: before.scores(),
            after: after.scores(),
            scene_distance: Percentiles::of(distances.collect()),
            left,
        }
    }
}
