//! Advice for scenes and poses that cannot be read.

use std::error::Error as StdError;

use garnet::{
    body::poses::key_poses,
    io::{Misplaced, PoseError, PoseProblem, SceneError, SceneProblem},
};

use super::{for_file, for_joints, for_mesh, for_motion, for_obj, for_retarget, for_skin};
use crate::hints::did_you_mean_or;

/// The advice for a link of a chain of errors, if it is one of a scene or a pose.
pub(super) fn for_link(link: &(dyn StdError + 'static)) -> Option<String> {
    if let Some(error) = link.downcast_ref::<SceneError>() {
        return for_scene(error);
    }
    if let Some(problem) = link.downcast_ref::<SceneProblem>() {
        return for_scene_problem(problem).map(str::to_owned);
    }
    link.downcast_ref::<PoseError>().and_then(for_pose)
}

fn for_scene(error: &SceneError) -> Option<String> {
    let hint = match error {
        SceneError::Obj(error) => for_obj(error)?,
        SceneError::File(error) => for_file(&error.problem)?,
        SceneError::Skin(error) => for_skin(error)?,
        SceneError::Pose(error) => return for_pose(error),
        SceneError::OutOfRange { unit, .. } => {
            return Some(format!(
                "it was read in {}; `--units` overrides this",
                unit.name()
            ));
        }
        SceneError::NoBody { .. } => "give the OBJ of the body, and this file with `--rig`",
        SceneError::NoRig { .. } => {
            "give the skeleton and weights of the body with `--rig FILE` (npz, GLB, glTF, VRM or JSON), and \
             the body on which the garment lies with `--rest-body OBJ` if the rig does not hold it"
        }
        SceneError::NoRestBody { .. } => {
            "give the body on which the garment lies with `--rest-body OBJ`"
        }
        SceneError::OtherTopology { .. } => {
            "export the posed body from the same mesh, with the order of its vertices kept; or give \
             its own `--rig` and `--rest-body`, or the rest body itself with `--pose`"
        }
        SceneError::BodyAsGarment { .. } => {
            "the garment comes first, then the body: `garnet drape GARMENT BODY -o OUT`"
        }
        SceneError::OtherSize { .. } => "export both in the same unit, or name it with `--units`",
        SceneError::NotAtRest { path, .. } => {
            return Some(format!(
                "`--pose` poses the rest body: a body at rest of another shape is given as \
                 `--rest-body {}`, a body that is posed already without `--pose`",
                path.display()
            ));
        }
        SceneError::Unplaced { .. } => {
            "turn it upright as it is worn, its front to that of the body, in a modelling program: \
             `--place` finds unit and place, sizes from 0.75 to 1.35 of its own, the axis that is up, and \
             turns about it"
        }
        SceneError::Misplaced {
            body_unit, problem, ..
        } => {
            if let Misplaced::Unit { garment, or, .. } = problem {
                let other =
                    or.map(|unit| format!(", `--units {unit},{body_unit}` in {}", unit.name()));
                return Some(format!(
                    "if so, `--units {garment},{body_unit}` reads the garment in {} and the bodies \
                     in {}{}; `--place` brings it to the body",
                    garment.name(),
                    body_unit.name(),
                    other.unwrap_or_default()
                ));
            }
            for_misplaced(problem)
        }
        _ => return None,
    };
    Some(hint.to_owned())
}

fn for_scene_problem(problem: &SceneProblem) -> Option<&'static str> {
    match problem {
        SceneProblem::JointsOutside { .. } => Some(
            "export rig and rest body from one scene, in one place and unit, or name the unit with `--units`",
        ),
        SceneProblem::Mesh(error) => for_mesh(error),
        SceneProblem::Skin(error) => for_skin(error),
        _ => None,
    }
}

pub(super) fn for_misplaced(problem: &Misplaced) -> &'static str {
    match problem {
        Misplaced::Unit { .. } => {
            "`--place` brings it to the body; `--units GARMENT,BODY` names the units of both"
        }
        Misplaced::Axis { .. } => {
            "`--place` brings it to the body; `--up` overrides what was detected for both"
        }
        Misplaced::Strays { .. } => {
            "delete what is no part of the garment; `garnet info` tells how many pieces it has"
        }
        Misplaced::Aside { .. } | Misplaced::Through { .. } => {
            "let the garment lie on the body in its rest pose, or bring it there by `--place`; \
             `garnet info` shows the boxes of both"
        }
        _ => {
            "`--place` brings it to the body; `garnet info` shows the boxes of both, and `--units \
             GARMENT,BODY` and `--up` override what was detected"
        }
    }
}

fn for_pose(error: &PoseError) -> Option<String> {
    let hint = match error {
        PoseError::Motion(error) => for_motion(&error.problem)?,
        PoseError::Figure(error) | PoseError::Frames { source: error, .. } => {
            return for_joints(error).or_else(|| for_retarget(error).map(str::to_owned));
        }
        PoseError::Skin(error) => for_skin(error)?,
        PoseError::BadFrames { problem, .. } => match problem {
            PoseProblem::OfLibrary => {
                "it is a pose of the library, which has one frame: leave out `:FRAME` and `--motion`"
            }
            _ => {
                "frames are one, as 12, or FIRST:END:STEP, as 0:100:5 or 1s:2.5s, with END after \
                 FIRST and a step of 1 at least"
            }
        },
        PoseError::Unknown { name, .. } => {
            let names: Vec<&str> = key_poses().map(|pose| pose.name).collect();
            let all = format!("the poses of the library are: {}", names.join(", "));
            return Some(did_you_mean_or(name, names, &all));
        }
        _ => return None,
    };
    Some(hint.to_owned())
}
