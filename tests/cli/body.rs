//! Bodies, motions and bodies of one's own.

use std::fs;
use std::process::Output;

use crate::fixtures::{Fixture, stderr};

/// A walker of BVH in centimetres, two frames: standing, and the left thigh raised.
const BVH: &str = "\
HIERARCHY
ROOT Hips
{
OFFSET 0 95 0
CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
JOINT Spine
{
OFFSET 0 12 0
CHANNELS 3 Zrotation Xrotation Yrotation
JOINT Neck
{
OFFSET 0 40 0
CHANNELS 3 Zrotation Xrotation Yrotation
JOINT Head
{
OFFSET 0 10 0
CHANNELS 3 Zrotation Xrotation Yrotation
End Site
{
OFFSET 0 15 0
}
}
}
JOINT LeftArm
{
OFFSET 18 36 0
CHANNELS 3 Zrotation Xrotation Yrotation
JOINT LeftForeArm
{
OFFSET 28 0 0
CHANNELS 3 Zrotation Xrotation Yrotation
JOINT LeftHand
{
OFFSET 25 0 0
CHANNELS 3 Zrotation Xrotation Yrotation
End Site
{
OFFSET 15 0 0
}
}
}
}
JOINT RightArm
{
OFFSET -18 36 0
CHANNELS 3 Zrotation Xrotation Yrotation
JOINT RightForeArm
{
OFFSET -28 0 0
CHANNELS 3 Zrotation Xrotation Yrotation
JOINT RightHand
{
OFFSET -25 0 0
CHANNELS 3 Zrotation Xrotation Yrotation
End Site
{
OFFSET -15 0 0
}
}
}
}
}
JOINT LeftUpLeg
{
OFFSET 9 -2 0
CHANNELS 3 Zrotation Xrotation Yrotation
JOINT LeftLeg
{
OFFSET 0 -41 0
CHANNELS 3 Zrotation Xrotation Yrotation
JOINT LeftFoot
{
OFFSET 0 -41 0
CHANNELS 3 Zrotation Xrotation Yrotation
End Site
{
OFFSET 0 -6 14
}
}
}
}
JOINT RightUpLeg
{
OFFSET -9 -2 0
CHANNELS 3 Zrotation Xrotation Yrotation
JOINT RightLeg
{
OFFSET 0 -41 0
CHANNELS 3 Zrotation Xrotation Yrotation
JOINT RightFoot
{
OFFSET 0 -41 0
CHANNELS 3 Zrotation Xrotation Yrotation
End Site
{
OFFSET 0 -6 14
}
}
}
}
}
MOTION
Frames: 2
Frame Time: 0.04
";

/// Columns of a frame: six of the hips, three of each of the other 15 joints.
const NUM_COLUMNS: usize = 6 + 3 * 15;

/// The column of the left thigh's rotation about x.
const LEFT_THIGH_X: usize = 6 + 3 * 9 + 1;

fn bvh() -> String {
    let frame = |thigh: f32| {
        let mut columns = vec![0.0; NUM_COLUMNS];
        columns[1] = 95.0;
        columns[LEFT_THIGH_X] = thigh;
        let words: Vec<String> = columns.iter().map(ToString::to_string).collect();
        words.join(" ") + "\n"
    };
    BVH.to_owned() + &frame(0.0) + &frame(-60.0)
}

fn done(output: &Output) {
    assert_eq!(output.status.code(), Some(0), "{}", stderr(output));
}

#[test]
fn frames_of_a_motion_pose_the_built_in_body() {
    let fixture = Fixture::new();
    let folder = fixture.folder();
    fs::write(folder.join("walk.bvh"), bvh()).unwrap();
    done(&fixture.garnet("body --sex 1 --motion walk.bvh -o frames"));
    let heights: Vec<f32> = ["walk_0000.obj", "walk_0001.obj"]
        .iter()
        .map(|name| {
            let text = fs::read_to_string(folder.join("frames").join(name)).unwrap();
            let front = text.lines().filter_map(|line| line.strip_prefix("v "));
            let depth = |line: &str| line.split(' ').nth(2).unwrap().parse::<f32>().unwrap();
            front.map(depth).fold(0.0, f32::max)
        })
        .collect();
    assert!(
        heights[1] > heights[0] + 0.1,
        "the knee comes forward: {heights:?}"
    );
}

#[test]
fn a_garment_is_draped_on_several_frames_of_a_motion() {
    let fixture = Fixture::new();
    let folder = fixture.folder();
    fs::write(folder.join("walk.bvh"), bvh()).unwrap();
    let models = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/demo/");
    let (tunic, rig) = (
        format!("{models}tunic.obj"),
        format!("{models}body.rig.npz"),
    );
    let files = format!("drape {tunic} --rig {rig} --pose walk.bvh:0:2");
    done(&fixture.garnet(&format!("{files} -o draped --body-out bodies")));
    for name in ["walk_0000.obj", "walk_0001.obj"] {
        assert!(folder.join("draped").join(name).is_file());
        assert!(folder.join("bodies").join(name).is_file());
    }
}

#[test]
fn truncated_motions_are_refused_with_the_line() {
    let fixture = Fixture::new();
    let text = bvh();
    for length in [40, 700, text.len() - 30] {
        fs::write(fixture.folder().join("cut.bvh"), &text[..length]).unwrap();
        let output = fixture.garnet("body --motion cut.bvh -o none");
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(text.contains("cut.bvh") && text.contains("line"), "{text}");
        assert!(!fixture.folder().join("none").exists());
    }
}
