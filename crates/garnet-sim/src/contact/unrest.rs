//! Which vertices crumpled skin pushes to and fro.

use crate::Vector3;

/// For how long the skin under a vertex is not to be trusted.
///
/// Skinning crumples the skin of armpits and groins: spikes and turned faces push a vertex out on
/// one side, where the next face pushes it back. Such a vertex never rests and shakes the whole
/// garment. Skin that turns under a vertex is the sign of it.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Unrest {
    /// The normal of the skin at the last refresh; zero if there was none.
    normal: Vector3,
    /// In refreshes of moving skin: skin that stands still does not become sound.
    refreshes: u8,
}

/// Cosine of the angle by which sound skin turns from one refresh to the next at most.
const SOUND: f32 = 0.5;

/// How many refreshes each turn takes to be forgotten, and all together.
const TURN: u8 = 3;
const MOST: u8 = 12;

impl Unrest {
    /// Whether the vertex is to be held where it is, now that the skin under it has this normal.
    pub(crate) fn is_caught(&mut self, normal: Vector3, moves: bool) -> bool {
        let known = self.normal != Vector3::zeros();
        if known && self.normal.dot(&normal) < SOUND {
            self.refreshes = (self.refreshes + TURN).min(MOST);
        } else if moves {
            self.refreshes = self.refreshes.saturating_sub(1);
        }
        self.normal = normal;
        self.refreshes > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn skin_that_turns_is_trusted_again_once_it_moved_on() {
        let mut unrest = Unrest::default();
        let (up, side) = (Vector3::y(), Vector3::x());
        assert!(!unrest.is_caught(up, true));
        assert!(unrest.is_caught(side, true));
        for _ in 0..10 {
            assert!(unrest.is_caught(side, false), "still skin stays as it is");
        }
        assert!(unrest.is_caught(side, true));
        assert!(unrest.is_caught(side, true));
        assert!(!unrest.is_caught(side, true));
    }
}
