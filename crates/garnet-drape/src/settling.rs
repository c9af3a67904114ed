//! How long cloth settles that something else has brought to a moment of its drape.

use garnet_sim::Moment;

/// From which moment, and for how long, cloth settles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settling {
    /// The moment at which the cloth is where it was put.
    pub from: Moment,
    /// For about how many frames of a sixtieth of a second, after the motion if there is one.
    pub frames: u32,
    /// How many of them are simulated as one, at most. Contacts are looked for once in each: more
    /// cost less, and miss the contacts of cloth that moves far.
    pub at_once: u32,
}

impl Settling {
    /// For as long as cloth does by default from that moment on.
    pub const fn of(from: Moment) -> Self {
        Self {
            from,
            frames: from.settle_frames(),
            at_once: from.frames_at_once(),
        }
    }

    /// The same for cloth that a network predicts at that moment.
    pub const fn of_predicted(from: Moment) -> Self {
        Self {
            at_once: from.predicted_frames_at_once(),
            ..Self::of(from)
        }
    }

    /// For as long, but from the body at rest.
    pub(crate) const fn begun_again(self) -> Self {
        Self {
            frames: self.frames,
            ..Self::of(Moment::Start)
        }
    }

    /// Whether the cloth finds folds of its own: then it needs no relaxing where it is untangled.
    pub fn finds_folds(self) -> bool {
        self.from.finds_folds() && self.takes_time()
    }

    /// Whether anything is to be simulated.
    pub fn takes_time(self) -> bool {
        self.frames > 0 || self.from.is_on_way()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_not_predicted_of_the_motion_takes_time() {
        let settling = |from, frames| Settling {
            frames,
            ..Settling::of(from)
        };
        let takes_time = |from, frames| settling(from, frames).takes_time();
        assert!(!takes_time(Moment::Arrival, 0));
        assert!(takes_time(Moment::Midway, 0));
        assert!(takes_time(Moment::Start, 0));
        for from in Moment::ALL {
            assert!(Settling::of(from).takes_time());
        }
    }
}
