//! A motion: a skeleton at rest and its poses.

use garnet_skin::{Joint, Point3, Pose, Skeleton, SkinError, Vector3};

use super::{
    Figure, Role, Side, Upward,
    error::THE_MOTION,
    rotation::{Direction, unit},
};

/// How to read a motion file; the default detects both.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ReadOptions {
    /// Metres in one unit of the file. Detected from the length of the legs without it.
    pub metres_per_unit: Option<f64>,
    /// The direction that points up in the file. Detected from the rest pose without it.
    pub up: Option<Upward>,
}

/// A skeleton at rest and its poses, in metres, Y up.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// Joint names, parents and rest positions.
    pub skeleton: Skeleton,
    /// One pose a frame: local rotations about the world's axes at rest, and the shift of the root.
    pub frames: Vec<Pose>,
    /// Seconds from one frame to the next, if the file says.
    pub frame_time: Option<f64>,
    /// What was taken for granted or left out, in the order of the file; for the user to read.
    pub notes: Vec<String>,
}

/// Units of length in motion files: their length in metres and what to call them.
const UNITS: [(f64, &str); 7] = [
    (1.0, "metres"),
    (0.1, "decimetres"),
    // Acclaim files of the CMU database have `length 0.45`: one unit is 1/0.45 inch.
    (0.0254 / 0.45, "units of 5.64 cm, as in the CMU database"),
    (0.0254, "inches"),
    (0.01, "centimetres"),
    (0.001, "millimetres"),
    (0.3048, "feet"),
];

/// Length of thigh and shank of a mean adult, in metres: hip joint to knee 0.41, knee to ankle
/// 0.41 (0.245 and 0.246 of a stature of 1.68 m; Winter 2009, figure 4.1).
const MEAN_LEG_LENGTH: f64 = 0.825;

impl Motion {
    /// Brings a skeleton and its poses to metres and Y up.
    ///
    /// The unit is the one in which the legs come closest to those of an adult; the up axis is that
    /// from the ankles to the head at rest. Where the skeleton is no human figure, it is taken as
    /// metres and Y up.
    ///
    /// # Errors
    ///
    /// [`SkinError`] if a joint is no longer finite.
    pub fn in_metres(
        skeleton: &Skeleton,
        frames: Vec<Pose>,
        options: &ReadOptions,
    ) -> Result<Self, SkinError> {
        let mut notes = Vec::new();
        let figure = Figure::new(skeleton, THE_MOTION).ok();
        let metres = options.metres_per_unit.unwrap_or_else(|| {
            let Some(figure) = &figure else {
                notes.push("no legs were found: lengths are read as metres".to_owned());
                return 1.0;
            };
            let (metres, name) = nearest_unit(figure.leg_length());
            notes.push(format!("lengths are read as {name}"));
            metres
        });
        let up = options.up.unwrap_or_else(|| {
            let upward = figure.as_ref().map_or_else(Direction::y, Figure::upward);
            let up = Upward::nearest(&upward.cast());
            notes.push(format!("{up} is read as the up axis"));
            let in_frames = figure.as_ref().and_then(|figure| stands_along(figure, skeleton, &frames));
            if let Some(other) = in_frames.filter(|other| *other != up) {
                notes.push(format!(
                    "at rest the figure stands along {up}, in the frames along {other}: if it is to \
                     stand there, too, `--pose-up {other}` reads it so"
                ));
            }
            up
        });
        let to_y_up = up.to_y_up();
        let metres = metres as f32;
        let moved = |vector: Vector3| to_y_up * (vector * metres);
        let joints = skeleton.joints().iter().map(|joint| Joint {
            rest_position: Point3::from(moved(joint.rest_position.coords)),
            ..joint.clone()
        });
        let frames = frames.into_iter().map(|frame| Pose {
            root_translation: moved(frame.root_translation),
            rotations: frame
                .rotations
                .into_iter()
                .map(|rotation| to_y_up * rotation * to_y_up.inverse())
                .collect(),
        });
        Ok(Self {
            skeleton: Skeleton::new(joints.collect())?,
            frames: frames.collect(),
            frame_time: None,
            notes,
        })
    }
}

/// About so many frames tell along which axis a figure stands.
const FRAMES_LOOKED_AT: usize = 50;

/// The mean of the ways up must be at least so long along an axis.
const LEAST_UPRIGHT: f64 = 0.5;

/// The axis along which the figure stands in the frames: that of the mean of the unit vectors from
/// the ankles to the head; none if it keeps to none.
fn stands_along(figure: &Figure, skeleton: &Skeleton, frames: &[Pose]) -> Option<Upward> {
    let head = figure.joint(Role::Head)?;
    let [left, right] = Side::BOTH.map(|side| figure.joint(Role::Ankle(side)));
    let (left, right) = (left?, right?);
    let step = frames.len().div_ceil(FRAMES_LOOKED_AT).max(1);
    let upward = frames.iter().step_by(step).filter_map(|pose| {
        let transforms = skeleton.transforms(pose).ok()?;
        let place = |joint: usize| -> Direction {
            let place = transforms[joint] * skeleton.joints()[joint].rest_position;
            place.coords.cast()
        };
        unit(&(place(head) - 0.5 * (place(left) + place(right))))
    });
    let upward: Vec<Direction> = upward.collect();
    let mean = upward.iter().sum::<Direction>() / upward.len().max(1) as f64;
    let nearest = Upward::nearest(&mean.cast());
    let along: f64 = mean.dot(&nearest.direction().cast());
    (along > LEAST_UPRIGHT).then_some(nearest)
}

fn nearest_unit(leg_length: f64) -> (f64, &'static str) {
    let off = |metres: f64| (leg_length * metres / MEAN_LEG_LENGTH).ln().abs();
    let nearest = UNITS
        .into_iter()
        .min_by(|a, b| off(a.0).total_cmp(&off(b.0)));
    nearest.unwrap_or(UNITS[0])
}
