//! Where names stand beside their marks, so that none hides another.

/// A place, x to the right and y downwards.
pub(super) type Place = [f64; 2];

/// A box along the axes: its corner with the least coordinates, and its size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Area {
    pub(super) at: Place,
    pub(super) size: Place,
}

/// A mark with the size of its name.
#[derive(Debug, Clone, Copy)]
pub(super) struct Named {
    pub(super) at: Place,
    pub(super) radius: f64,
    pub(super) size: Place,
}

/// What names should stay away from, beside each other and each other's ties.
#[derive(Debug, Clone, Default)]
pub(super) struct Obstacles {
    /// Marks and other names: not to be covered.
    pub(super) areas: Vec<Area>,
    /// Lines: better not covered.
    pub(super) lines: Vec<[Place; 2]>,
}

/// Free space between a mark and the places for its name.
const GAPS: [f64; 8] = [3.0, 9.0, 18.0, 30.0, 45.0, 64.0, 86.0, 110.0];

/// Directions that are tried, the first ones preferred.
const DIRECTIONS: [Place; 12] = [
    [1.0, 0.0],
    [1.0, -0.7],
    [-1.0, 0.0],
    [1.0, 0.7],
    [-1.0, -0.7],
    [-1.0, 0.7],
    [0.0, -1.0],
    [0.0, 1.0],
    [0.5, -1.0],
    [-0.5, -1.0],
    [0.5, 1.0],
    [-0.5, 1.0],
];

/// How often all names are placed again, the others where they are.
const ROUNDS: usize = 4;

/// Free space that names keep from each other.
const APART: f64 = 2.0;

/// Boxes for the names, in order.
pub(super) fn placed(names: &[Named], obstacles: &Obstacles, frame: Area) -> Vec<Area> {
    let mut boxes: Vec<Option<Area>> = vec![None; names.len()];
    for _ in 0..ROUNDS {
        for (number, name) in names.iter().enumerate() {
            boxes[number] = None;
            let others = names.iter().zip(&boxes);
            let others: Vec<(Area, [Place; 2])> = others
                .filter_map(|(name, area)| Some(((*area)?, area.as_ref()?.tie(name.at))))
                .collect();
            let cost = |area: &Area, bias: f64| {
                let covered = |other: &Area| area.wider(APART).overlap(*other);
                let names: f64 = others.iter().map(|(other, _)| covered(other)).sum();
                let marks: f64 = obstacles.areas.iter().map(covered).sum();
                let own = area.tie(name.at);
                let ties = others.iter().map(|(other, tie)| {
                    f64::from(u8::from(other.meets(own))) + f64::from(u8::from(area.meets(*tie)))
                });
                let hidden = obstacles.areas.iter();
                let hidden = hidden.filter(|mark| mark.meets(own) && !mark.has(name.at));
                let bias = bias + 60.0 * (ties.sum::<f64>() + hidden.count() as f64);
                let crossed = (obstacles.lines.iter()).filter(|line| area.wider(1.0).meets(**line));
                let outside = area.size[0] * area.size[1] - area.overlap(frame);
                20.0 * (names + marks) + 40.0 * outside + 60.0 * crossed.count() as f64 + bias
            };
            let best = candidates(name)
                .min_by(|(a, bias_a), (b, bias_b)| cost(a, *bias_a).total_cmp(&cost(b, *bias_b)));
            boxes[number] = best.map(|(area, _)| area);
        }
    }
    boxes.into_iter().flatten().collect()
}

/// Places for a name, each with how little it is liked.
fn candidates(name: &Named) -> impl Iterator<Item = (Area, f64)> + '_ {
    GAPS.iter().enumerate().flat_map(move |(far, gap)| {
        DIRECTIONS.iter().enumerate().map(move |(rank, direction)| {
            let reach = name.radius + gap;
            let at = [0, 1].map(|axis| {
                let center = name.at[axis] + direction[axis] * reach;
                center + 0.5 * (direction[axis].clamp(-1.0, 1.0) - 1.0) * name.size[axis]
            });
            let size = name.size;
            (Area { at, size }, 25.0 * far as f64 + rank as f64)
        })
    })
}

impl Area {
    /// Around a place.
    pub(super) fn around(center: Place, radius: f64) -> Self {
        Self {
            at: center.map(|value| value - radius),
            size: [2.0 * radius; 2],
        }
    }

    /// With a margin.
    fn wider(self, margin: f64) -> Self {
        Self {
            at: self.at.map(|value| value - margin),
            size: self.size.map(|value| value + 2.0 * margin),
        }
    }

    /// Whether a place is in it.
    fn has(self, place: Place) -> bool {
        self.meets([place, place])
    }

    /// The area that both cover.
    fn overlap(self, other: Self) -> f64 {
        let sides = [0, 1].map(|axis| {
            let low = self.at[axis].max(other.at[axis]);
            let high = (self.at[axis] + self.size[axis]).min(other.at[axis] + other.size[axis]);
            (high - low).max(0.0)
        });
        sides[0] * sides[1]
    }

    /// The line from a place to the nearest place in it.
    pub(super) fn tie(self, place: Place) -> [Place; 2] {
        let nearest =
            [0, 1].map(|axis| place[axis].clamp(self.at[axis], self.at[axis] + self.size[axis]));
        [place, nearest]
    }

    /// Whether a line runs through it (Liang and Barsky 1984).
    fn meets(self, [from, to]: [Place; 2]) -> bool {
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for axis in [0, 1] {
            let step = to[axis] - from[axis];
            let low = self.at[axis] - from[axis];
            let high = low + self.size[axis];
            if step.abs() < 1e-12 {
                if low > 0.0 || high < 0.0 {
                    return false;
                }
                continue;
            }
            let (first, last) = (low / step, high / step);
            enter = enter.max(first.min(last));
            leave = leave.min(first.max(last));
        }
        enter <= leave
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Area = Area {
        at: [0.0, 0.0],
        size: [900.0, 500.0],
    };

    fn named(at: Place) -> Named {
        Named {
            at,
            radius: 5.0,
            size: [80.0, 14.0],
        }
    }

    #[test]
    fn names_of_near_marks_do_not_overlap() {
        let marks: Vec<Place> = (0..8)
            .map(|number| {
                [
                    400.0 + 9.0 * f64::from(number),
                    200.0 + f64::from(number % 3),
                ]
            })
            .collect();
        let names: Vec<Named> = marks.iter().copied().map(named).collect();
        let areas = marks.iter().map(|&mark| Area::around(mark, 5.0)).collect();
        let obstacles = Obstacles {
            areas,
            lines: Vec::new(),
        };
        let boxes = placed(&names, &obstacles, FRAME);
        assert_eq!(boxes.len(), names.len());
        for (number, area) in boxes.iter().enumerate() {
            for other in boxes[..number].iter().chain(&obstacles.areas) {
                assert!(area.overlap(*other) < 1e-9, "{number}");
            }
        }
    }

    #[test]
    fn names_stay_in_the_frame() {
        for at in [[898.0, 2.0], [2.0, 498.0], [2.0, 2.0], [898.0, 498.0]] {
            let area = placed(&[named(at)], &Obstacles::default(), FRAME)[0];
            let inside = area.overlap(FRAME) - area.size[0] * area.size[1];
            assert!(inside.abs() < 1e-9, "{at:?} {area:?}");
        }
    }

    #[test]
    fn lines_are_avoided_where_there_is_room() {
        let line = [[0.0, 100.0], [900.0, 100.0]];
        let obstacles = Obstacles {
            areas: Vec::new(),
            lines: vec![line],
        };
        let area = placed(&[named([300.0, 100.0])], &obstacles, FRAME)[0];
        assert!(!area.meets(line));
        assert!(Area::around([300.0, 100.0], 5.0).meets(line));
    }
}
