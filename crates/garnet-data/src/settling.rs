//! Where cloth is put that is to settle, and for how long it does.

use garnet_sim::Schedule;

/// Settling is counted in frames as long as the teacher's.
const FRAMES_A_SECOND: f32 = 60.0;

/// Where something else has put cloth that is to settle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Put {
    /// Where it would rest, but for its strain and finer folds.
    #[default]
    AtRest,
    /// Where it is when the body comes to its last place ([`Drape::arrived`](garnet_sim::Drape::arrived)): its folds are still to be found.
    AtArrival,
    /// Most of the way from there to where it rests: it still falls into its folds.
    Falling,
    /// Where it is when the body is [midway](crate::MIDWAY) ([`Drape::midway`](garnet_sim::Drape::midway)): the second half of the motion is still
    /// to be simulated.
    Midway,
    /// Where it lies on the body at rest: the whole motion is still to be simulated.
    OnRestBody,
}

impl Put {
    /// For how many frames of a sixtieth of a second such cloth settles by default, after the motion if there is one.
    ///
    /// Put where a pose-space deformation told that they rest, T-shirts came no nearer to an earlier teacher in more than 6 frames. Put where networks tell that
    /// they are midway, they come nearer with each frame up to 60 at least, for a hundredth of the time each ([`Schedule::after_arrival`]).
    pub const fn frames(self) -> u32 {
        match self {
            Self::AtRest | Self::Falling => 6,
            Self::AtArrival => 30,
            Self::Midway | Self::OnRestBody => 46,
        }
    }

    /// How many frames of a sixtieth of a second of the motion are still to be simulated.
    pub fn motion_frames(self) -> u32 {
        let motion = self.schedule(1.0, 0).seconds();
        (FRAMES_A_SECOND * motion).round() as u32
    }

    /// Whether the cloth lies about as it will in the end: on the skin that it lies on at rest.
    pub(crate) fn is_near_rest(self) -> bool {
        matches!(self, Self::AtRest | Self::Falling)
    }

    pub(crate) fn schedule(self, edge_length: f32, frames: u32) -> Schedule {
        match self {
            Self::AtRest => Schedule::settling(edge_length, frames),
            Self::AtArrival => Schedule::after_arrival(edge_length, frames),
            Self::Falling => Schedule::while_falling(edge_length, frames),
            Self::Midway => Schedule::after_midway(edge_length, frames),
            Self::OnRestBody => Schedule::from_rest(edge_length, frames),
        }
    }
}

/// How cloth settles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settling {
    /// Where it was put.
    pub put: Put,
    /// For about how many frames of a sixtieth of a second, after the motion if there is one.
    pub frames: u32,
}

impl Settling {
    /// For as long as cloth does by default that was put so.
    pub const fn of(put: Put) -> Self {
        Self {
            put,
            frames: put.frames(),
        }
    }

    /// Whether the cloth finds folds of its own; put where it rests it keeps most of those that it was given, and some of their strain.
    pub fn finds_folds(self) -> bool {
        self.put != Put::AtRest && self.takes_time()
    }

    /// Whether anything is to be simulated.
    pub fn takes_time(self) -> bool {
        self.frames > 0 || self.put.motion_frames() > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cloth_has_as_much_of_the_motion_before_it_as_was_not_told() {
        let puts = [
            Put::AtRest,
            Put::AtArrival,
            Put::Falling,
            Put::Midway,
            Put::OnRestBody,
        ];
        assert_eq!(puts.map(Put::motion_frames), [0, 0, 0, 30, 60]);
        assert!(
            !Settling {
                put: Put::AtArrival,
                frames: 0
            }
            .takes_time()
        );
        assert!(
            Settling {
                put: Put::Midway,
                frames: 0
            }
            .takes_time()
        );
        assert!(Settling::of(Put::AtRest).takes_time());
    }
}
