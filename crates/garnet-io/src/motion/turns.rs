//! Rotations of an npz archive: axis-angle vectors or matrices, told by shapes and by values.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::{
    MotionProblem,
    smpl::{JOINT_PARENTS, boxed, wrong_shape},
};
use crate::NpzFile;

/// How many joints models of the SMPL family have, with and without their root: a row of as many
/// numbers as these need is told by its length.
const FAMILY: [usize; 10] = [21, 22, 23, 24, 51, 52, 53, 54, 55, 75];

/// How many joints of a body alone are without the root: 21, and 23 in SMPL.
const ROOTLESS: [usize; 2] = [21, 23];

/// No model has more joints: what is longer is the axis of frames.
const MOST_JOINTS: usize = 128;

/// Fewer joints are no body.
const FEWEST_JOINTS: usize = 21;

/// How far the columns of a rotation may be from unit vectors at right angles: what a network
/// rounds, and half precision.
const ROUNDING: f64 = 0.01;

/// No joint but the root turns further, in radians: two whole turns.
const MOST_RADIANS: f64 = 4.0 * std::f64::consts::PI;

/// What an array of rotations is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// The root, in so many frames.
    Root(usize),
    /// All joints, or all but the root.
    Joints,
}

/// How a rotation is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    AxisAngle,
    /// Nine numbers, row after row.
    Matrix,
    /// Two columns of a matrix: the six numbers of its three rows.
    TwoColumns,
}

impl Form {
    const fn size(self) -> usize {
        match self {
            Self::AxisAngle => 3,
            Self::Matrix => 9,
            Self::TwoColumns => 6,
        }
    }
}

/// Rotations `[frame][joint]`.
#[derive(Debug)]
pub(super) struct JointTurns {
    pub num_joints: usize,
    pub all: Vec<UnitQuaternion<f32>>,
    /// What was taken for granted.
    pub note: Option<String>,
}

impl JointTurns {
    pub(super) fn num_frames(&self) -> usize {
        self.all.len() / self.num_joints.max(1)
    }

    pub(super) fn frames(&self) -> impl Iterator<Item = &[UnitQuaternion<f32>]> + Clone {
        self.all.chunks_exact(self.num_joints.max(1))
    }

    /// Whether the root is not among the joints.
    pub(super) fn has_no_root(&self) -> bool {
        ROOTLESS.contains(&self.num_joints)
    }

    /// The same with the root before them.
    pub(super) fn under(self, root: &Self) -> Self {
        let rows = root.all.iter().zip(self.frames());
        let all = rows.flat_map(|(root, row)| std::iter::once(root).chain(row));
        Self {
            num_joints: self.num_joints + 1,
            all: all.copied().collect(),
            note: self.note.or_else(|| root.note.clone()),
        }
    }
}

/// Reads rotations: axis-angle vectors `[T, 3 n]`, `[T, n, 3]`, matrices `[T, n, 3, 3]`,
/// `[T, n, 9]`, `[T, 9 n]`, or their first two columns `[T, n, 3, 2]`, `[T, n, 6]`, `[T, 6 n]`;
/// those of one frame without its axis, and those of a batch of one.
///
/// # Errors
///
/// [`MotionProblem`]: another shape, a value that is not finite, a matrix that is no rotation, or
/// numbers whose order is not told.
pub(super) fn turns(
    npz: &mut NpzFile,
    key: &'static str,
    kind: Kind,
) -> Result<JointTurns, MotionProblem> {
    let Some(array) = npz.array(key).map_err(boxed)? else {
        return Err(MotionProblem::NoFrames);
    };
    let values = array.floats();
    let values = values.map_err(|problem| boxed(npz.wrong(key, problem)))?;
    let layout = match kind {
        Kind::Root(num_frames) => of_root(&array.shape, num_frames).map(|form| (form, 1)),
        Kind::Joints => of_joints(&array.shape, &values),
    };
    let Some((form, num_joints)) = layout else {
        let expected = match kind {
            Kind::Root(num_frames) => format!("[{num_frames}, 3] or [{num_frames}, 3, 3]"),
            Kind::Joints => "[frames, 3 n], [frames, n, 3] or [frames, n, 3, 3]".to_owned(),
        };
        return Err(wrong_shape(npz, key, array.shape, expected));
    };
    let rows = || values.chunks_exact(form.size());
    let is_bad = |row: &[f64]| !row.iter().all(|&value| (value as f32).is_finite());
    if let Some(bad) = rows().position(is_bad) {
        let frame = bad / num_joints;
        return Err(MotionProblem::NonFinite { frame, key });
    }
    if let (Form::AxisAngle, Kind::Joints) = (form, kind) {
        check_angles(key, &values, num_joints)?;
    }
    let is_either = |row: &[f64]| two_rows(row).is_some();
    let mut all = Vec::with_capacity(values.len() / form.size());
    for (number, row) in rows().enumerate() {
        all.push(match turn(form, row) {
            Some(turn) => turn,
            None if is_either(row) => return Err(MotionProblem::RowsOrColumns { key }),
            None => {
                return Err(MotionProblem::NotARotation {
                    key,
                    frame: number / num_joints,
                    joint: joint_name(number % num_joints, num_joints),
                });
            }
        });
    }
    if form == Form::TwoColumns && rows().all(is_either) && !all.is_empty() {
        return Err(MotionProblem::RowsOrColumns { key });
    }
    let note = match form {
        Form::AxisAngle => None,
        Form::Matrix => Some(format!("`{key}` are read as rotation matrices")),
        Form::TwoColumns => {
            let first = "the first two columns of rotation matrices";
            Some(format!("`{key}` are read as {first}"))
        }
    };
    Ok(JointTurns {
        num_joints,
        all,
        note,
    })
}

/// Refuses angles in degrees. A root may have turned over and over in the course of a motion; other
/// joints cannot.
fn check_angles(key: &'static str, values: &[f64], num_joints: usize) -> Result<(), MotionProblem> {
    let first = usize::from(!ROOTLESS.contains(&num_joints));
    for (number, row) in values.chunks_exact(Form::AxisAngle.size()).enumerate() {
        let (frame, joint) = (number / num_joints, number % num_joints);
        let radians = row.iter().map(|value| value * value).sum::<f64>().sqrt();
        if joint >= first && radians > MOST_RADIANS {
            return Err(MotionProblem::TurnsOverAndOver {
                key,
                frame,
                joint: joint_name(joint, num_joints),
                radians,
            });
        }
    }
    Ok(())
}

/// What a joint is called in messages, of those without a root, too.
fn joint_name(joint: usize, num_joints: usize) -> String {
    let offset = usize::from(ROOTLESS.contains(&num_joints));
    match JOINT_PARENTS.get(joint + offset) {
        Some((name, _)) => format!("{joint} (`{name}`)"),
        None => joint.to_string(),
    }
}

/// The form of the rotations of a root: their count tells.
fn of_root(shape: &[usize], num_frames: usize) -> Option<Form> {
    let mut axes = shape.iter().copied().filter(|&axis| axis != 1);
    if num_frames != 1 && axes.next() != Some(num_frames) {
        return None;
    }
    let rest = axes.try_fold(1_usize, usize::checked_mul)?;
    let forms = [Form::AxisAngle, Form::Matrix, Form::TwoColumns];
    forms.into_iter().find(|form| form.size() == rest)
}

/// Form and number of the rotations of joints.
fn of_joints(shape: &[usize], values: &[f64]) -> Option<(Form, usize)> {
    let (axes, form) = match *shape {
        [ref axes @ .., 3, 3] if !axes.is_empty() => (axes, Form::Matrix),
        [ref axes @ .., 3, 2] if !axes.is_empty() => (axes, Form::TwoColumns),
        [ref axes @ .., 3] => (axes, Form::AxisAngle),
        [ref axes @ .., 9] => (axes, Form::Matrix),
        [ref axes @ .., 6] => (axes, Form::TwoColumns),
        [ref axes @ .., columns] => {
            let is_one = axes.iter().rev().skip(1).all(|&axis| axis == 1);
            return is_one.then(|| in_rows(columns, values)).flatten();
        }
        [] => return None,
    };
    let (&num_joints, frames) = axes.split_last()?;
    let is_batch = frames.iter().rev().skip(1).all(|&axis| axis == 1);
    // What has but one long axis may have it for frames.
    let is_body = match frames {
        [] => FAMILY.contains(&num_joints),
        _ => (1..=MOST_JOINTS).contains(&num_joints),
    };
    (is_batch && is_body).then_some((form, num_joints))
}

/// Form and number of the rotations in rows of so many numbers: what their values are, and else
/// what is usual.
fn in_rows(columns: usize, values: &[f64]) -> Option<(Form, usize)> {
    let joints = |form: Form| {
        let count = columns / form.size();
        (columns.is_multiple_of(form.size()) && count >= FEWEST_JOINTS).then_some(count)
    };
    let are_all = |form: Form| {
        let mut rows = values.chunks_exact(form.size());
        rows.len() > 0 && rows.all(|row| turn(form, row).or_else(|| two_rows(row)).is_some())
    };
    for form in [Form::Matrix, Form::TwoColumns] {
        if let Some(count) = joints(form).filter(|_| are_all(form)) {
            return Some((form, count));
        }
    }
    if columns.is_multiple_of(4) && values.chunks_exact(4).all(is_unit) && !values.is_empty() {
        return None;
    }
    let angles = joints(Form::AxisAngle);
    if let Some(count) = angles.filter(|count| FAMILY.contains(count)) {
        return Some((Form::AxisAngle, count));
    }
    // As many numbers as matrices of a model have are none of its angles.
    for form in [Form::Matrix, Form::TwoColumns] {
        if let Some(count) = joints(form).filter(|count| FAMILY.contains(count)) {
            return Some((form, count));
        }
    }
    let fewer = columns / Form::AxisAngle.size();
    let is_angles = columns.is_multiple_of(3) && (1..=MOST_JOINTS).contains(&fewer);
    is_angles.then_some((Form::AxisAngle, fewer))
}

fn is_unit(row: &[f64]) -> bool {
    let squared: f64 = row.iter().map(|value| value * value).sum();
    (squared - 1.0).abs() < ROUNDING
}

/// The rotation of a row of numbers; none if they are of another form.
fn turn(form: Form, row: &[f64]) -> Option<UnitQuaternion<f32>> {
    match (form, row) {
        (Form::AxisAngle, &[x, y, z]) => {
            Some(UnitQuaternion::from_scaled_axis(Vector3::new(x, y, z)).cast())
        }
        (Form::Matrix, row) if row.len() == 9 => rotation(Matrix3::from_row_slice(row)),
        (Form::TwoColumns, &[a, b, c, d, e, f]) => {
            rotation(of_columns(Vector3::new(a, c, e), Vector3::new(b, d, f)))
        }
        _ => None,
    }
}

/// The rotation whose first two rows, or columns, stand one after the other; none if they do not.
fn two_rows(row: &[f64]) -> Option<UnitQuaternion<f32>> {
    let &[a, b, c, d, e, f] = row else {
        return None;
    };
    rotation(of_columns(Vector3::new(a, b, c), Vector3::new(d, e, f)))
}

fn of_columns(first: Vector3<f64>, second: Vector3<f64>) -> Matrix3<f64> {
    Matrix3::from_columns(&[first, second, first.cross(&second)])
}

/// A matrix as a rotation; none if its columns are not orthonormal, or if it mirrors.
fn rotation(matrix: Matrix3<f64>) -> Option<UnitQuaternion<f32>> {
    let off = matrix.transpose() * matrix - Matrix3::identity();
    // A comparison that is false of what is no number.
    if !(off.amax() < ROUNDING && matrix.determinant() > 0.0) {
        return None;
    }
    let rotation = Rotation3::from_matrix_unchecked(matrix);
    let quaternion = UnitQuaternion::from_rotation_matrix(&rotation);
    Some(UnitQuaternion::new_normalize(
        quaternion.into_inner().cast(),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_length_of_a_row_tells_its_form_where_its_values_do_not() {
        let zeros = |columns: usize| in_rows(columns, &vec![0.0; columns]);
        for count in [21, 22, 23, 24, 52, 55] {
            assert_eq!(zeros(3 * count), Some((Form::AxisAngle, count)));
            assert_eq!(zeros(9 * count), Some((Form::Matrix, count)));
            assert_eq!(zeros(6 * count), Some((Form::TwoColumns, count)));
        }
        assert_eq!(zeros(71), None);
        assert_eq!(zeros(3 * 30), Some((Form::AxisAngle, 30)));
        let identities = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0].repeat(25);
        assert_eq!(in_rows(225, &identities), Some((Form::Matrix, 25)));
        // Quaternions are in this order or in that one.
        assert_eq!(in_rows(96, &[0.0, 0.0, 0.0, 1.0].repeat(24)), None);
    }

    #[test]
    fn a_matrix_is_a_rotation_if_it_neither_stretches_nor_mirrors() {
        let turned = UnitQuaternion::from_euler_angles(0.3, -1.2, 2.0);
        let matrix: Matrix3<f64> = turned.to_rotation_matrix().into_inner();
        let found = rotation(matrix).unwrap();
        assert!(found.angle_to(&turned.cast()) < 1e-3);
        assert!(rotation(-matrix).is_none());
        assert!(rotation(1.1 * matrix).is_none());
        assert!(rotation(f64::NAN * matrix).is_none());
        let six: Vec<f64> = (0..6).map(|place| matrix[(place / 2, place % 2)]).collect();
        let found = turn(Form::TwoColumns, &six).unwrap();
        assert!(found.angle_to(&turned.cast()) < 1e-3);
    }
}
