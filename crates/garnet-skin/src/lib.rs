//! Skeletons, poses, weights, dual-quaternion skinning, weight transfer to garments, pose recovery, rig and scene files.
