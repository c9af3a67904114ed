//! How long cloth settles that something else has brought to a moment of its drape.

use garnet_sim::Moment;

/// From which moment, and for how long, cloth settles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settling {
    /// The moment at which the cloth is where it was put.
    pub from: Moment,
    /// For about how many frames of a sixtieth of a second, after the motion if there is one.
    pub frames: u32,
}

impl Settling {
    /// For as long as cloth does by default from that moment on.
    pub const fn of(from: Moment) -> Self {
        Self {
            from,
            frames: from.settle_frames(),
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
        let takes_time = |from, frames| Settling { from, frames }.takes_time();
        assert!(!takes_time(Moment::Arrival, 0));
        assert!(takes_time(Moment::Midway, 0));
        assert!(takes_time(Moment::Start, 0));
        for from in Moment::ALL {
            assert!(Settling::of(from).takes_time());
        }
    }
}
