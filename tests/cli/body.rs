//! Bodies, motions and bodies of one's own.

use std::fs;
use std::process::Output;

use garnet::body::shape::{BodyParameters, ParametricBody};
use garnet::io::{ObjFile, write_rig_npz};
use garnet::{Body, Point3, Rig, TriMesh, UnitQuaternion, Vector3};

use crate::fixtures::{Fixture, stderr};
use crate::glb::glb_of;

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

/// The column of the left arm's rotation about z, of which -90 lets it hang.
const LEFT_ARM_Z: usize = 6 + 3 * 3;

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
    let one = fixture.garnet("body --sex 1 --pose walk.bvh -o one.obj");
    done(&one);
    let note = "of the 2 frames of `walk.bvh` frame 0 is taken";
    assert!(stderr(&one).contains(note), "{}", stderr(&one));
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
fn frames_of_a_motion_stand_where_they_stand_in_all_of_it() {
    let fixture = Fixture::new();
    let lifted = |height: f32| {
        let mut columns = vec![0.0; NUM_COLUMNS];
        columns[1] = height;
        let words: Vec<String> = columns.iter().map(ToString::to_string).collect();
        words.join(" ") + "\n"
    };
    let text = BVH.replace("Frames: 2", "Frames: 4");
    let frames = [95.0, 100.0, 105.0, 110.0].map(lifted).concat();
    fs::write(fixture.path("jump.bvh"), text + &frames).unwrap();
    let lowest = |arguments: &str, name: &str| {
        done(&fixture.garnet(&format!("body --motion jump.bvh {arguments}")));
        let heights = heights(&fixture, name);
        heights.into_iter().fold(f32::INFINITY, f32::min)
    };
    let in_all = lowest("-o all", "all/jump_0003.obj");
    // By 15 cm, in the proportions of the body.
    assert!((0.13..0.17).contains(&in_all), "{in_all}");
    let in_two = lowest("--frames 2:4 -o two", "two/jump_0003.obj");
    assert!((in_two - in_all).abs() < 1e-6, "{in_two}");
}

#[test]
fn arms_are_kept_out_of_the_trunk_in_one_frame_as_in_all() {
    let fixture = Fixture::new();
    let frame = |step: u32| {
        let mut columns = vec![0.0; NUM_COLUMNS];
        columns[1] = 95.0;
        // Down onto the trunk and up again.
        columns[LEFT_ARM_Z] = -96.0 + (step as f32 - 30.0).abs();
        let words: Vec<String> = columns.iter().map(ToString::to_string).collect();
        words.join(" ") + "\n"
    };
    let frames: String = (0..60).map(frame).collect();
    fixture.text(
        "swing.bvh",
        &(BVH.replace("Frames: 2", "Frames: 60") + &frames),
    );
    let posed = |arguments: &str, name: &str| {
        let output = fixture.garnet(&format!("body --motion swing.bvh {arguments}"));
        done(&output);
        let file = ObjFile::read(fixture.path(name)).unwrap();
        (file.positions().to_vec(), stderr(&output))
    };
    let (in_all, told) = posed("-o all", "all/swing_0030.obj");
    let is_told = told.contains("arms are kept out of other parts of the body")
        && told.contains("of 60 frames");
    assert!(is_told, "{told}");
    let (alone, _) = posed("--frames 30:31 -o alone", "alone/swing_0030.obj");
    let moved = in_all.iter().zip(&alone).map(|(a, b)| (a - b).norm());
    let moved = moved.fold(0.0, f32::max);
    assert!(moved < 2e-3, "{moved}");
    let (_, told) = posed("--frames 0:1 -o apart", "apart/swing_0000.obj");
    assert!(!told.contains("arms are kept"), "{told}");

    // So are those of a body of one's own, here with its faces in another order.
    let woman = mean_woman();
    let faces = woman.rest().faces().iter().rev().copied().collect();
    let mesh = TriMesh::new(woman.rest().positions().to_vec(), faces).unwrap();
    let own = Body::new(mesh, woman.skeleton().clone(), woman.weights().clone()).unwrap();
    write_rig_npz(fixture.path("own.rig.npz"), &Rig::from(own)).unwrap();
    for (arguments, is_told) in [("", true), ("--keep-arms", false)] {
        let command = format!("body own.rig.npz --motion swing.bvh {arguments} -o own");
        let output = fixture.garnet(&command);
        done(&output);
        let told = stderr(&output);
        assert_eq!(told.contains("arms are kept"), is_told, "{told}");
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

fn mean_woman() -> Body {
    let built = ParametricBody::build(&BodyParameters::new(1.0)).unwrap();
    built.into_body()
}

/// Heights of the vertices of an OBJ, in metres.
fn heights(fixture: &Fixture, name: &str) -> Vec<f32> {
    let file = ObjFile::read(fixture.path(name)).unwrap();
    file.positions().iter().map(|point| point.y).collect()
}

#[test]
fn options_of_motions_are_told_or_refused_where_they_do_nothing() {
    let fixture = Fixture::new();
    for option in ["--in-place", "--fps 10", "--ground", "--pose-up z"] {
        let output = fixture.garnet(&format!("body -o rest.obj {option}"));
        assert_eq!(output.status.code(), Some(2), "{option}");
        assert!(
            stderr(&output).contains("is given without a pose"),
            "{option}"
        );
        assert!(!fixture.path("rest.obj").exists(), "{option}");
    }
    for option in [
        "--in-place",
        "--fps 10",
        "--ground",
        "--keep-arms",
        "--keep-flips",
        "--pose-up z",
    ] {
        let output = fixture.garnet(&format!("body --pose sit -o sits.obj {option}"));
        done(&output);
        let told = stderr(&output);
        assert!(
            told.contains("`sit` is no motion: its place, time and arms"),
            "{option}: {told}"
        );
    }
}

#[test]
fn a_taller_body_in_another_pose_than_its_rig_keeps_its_size() {
    let fixture = Fixture::new();
    for (stature, name) in [(168, "rig"), (188, "tall")] {
        let make = format!("body --sex male --stature {stature} -o {name}.obj -q");
        done(&fixture.garnet(&make));
    }
    // Arms raised by 43 degrees, about the axis that points forward.
    let pose = r#"{"joints": {"left_shoulder": [0, 0, 0.3665, 0.9304],
        "right_shoulder": [0, 0, -0.3665, 0.9304]}}"#;
    fs::write(fixture.folder().join("arms.json"), pose).unwrap();
    done(&fixture.garnet("body tall.obj --pose arms.json -o raised.obj -q"));
    let own = fixture.garnet("body tall.obj --pose wave -o own.obj");
    done(&own);
    let other = fixture.garnet("body raised.obj --rig rig.rig.npz --pose wave -o other.obj");
    done(&other);
    assert!(stderr(&other).contains("is in another pose than its rig"));
    assert!(stderr(&other).contains("has another shape than its rig"));
    let places = |name: &str| {
        ObjFile::read(fixture.path(name))
            .unwrap()
            .positions()
            .to_vec()
    };
    let (own, other) = (places("own.obj"), places("other.obj"));
    let distances = own.iter().zip(&other).map(|(a, b)| (a - b).norm());
    let mean = distances.sum::<f32>() / own.len() as f32;
    // With bones of the rig's lengths it is 100 mm.
    assert!(mean < 0.025, "{mean}");
}

#[test]
fn a_rigged_glb_is_posed_as_the_same_body_in_a_rig_file() {
    let fixture = Fixture::new();
    let body = mean_woman();
    fixture.bytes("own.glb", &glb_of(&body));
    write_rig_npz(fixture.path("own.rig.npz"), &Rig::from(body)).unwrap();
    done(&fixture.garnet("body own.glb --pose reach_high -o of_glb.obj"));
    done(&fixture.garnet("body own.rig.npz --pose reach_high -o of_rig.obj"));
    let [of_glb, of_rig] = ["of_glb.obj", "of_rig.obj"].map(|name| heights(&fixture, name));
    assert_eq!(of_glb.len(), of_rig.len());
    for (of_glb, of_rig) in of_glb.iter().zip(&of_rig) {
        // The GLB keeps four of as many as eight influences.
        assert!((of_glb - of_rig).abs() < 0.02, "{of_glb} {of_rig}");
    }
    let tallest = of_glb.iter().copied().fold(0.0, f32::max);
    assert!(tallest > 2.0, "the hands are overhead: {tallest}");
}

#[test]
fn a_pose_of_the_library_leaves_a_body_where_it_stands_and_looks() {
    let fixture = Fixture::new();
    let body = mean_woman();
    write_rig_npz(fixture.path("own.rig.npz"), &Rig::from(body.clone())).unwrap();
    let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), std::f32::consts::PI);
    let away = Vector3::new(50.0, 0.0, -20.0);
    let moved = |point: &Point3| turn * point + away;
    let rest = body.rest();
    let places = rest.positions().iter().map(moved).collect();
    let skeleton = (body.skeleton().clone()).placed(|_, joint| moved(&joint.rest_position));
    let far = Body::new(
        rest.with_positions(places).unwrap(),
        skeleton.unwrap(),
        body.weights().clone(),
    );
    write_rig_npz(fixture.path("far.rig.npz"), &Rig::from(far.unwrap())).unwrap();
    for name in ["own", "far"] {
        done(&fixture.garnet(&format!(
            "body {name}.rig.npz --pose wave -o {name}_posed.obj"
        )));
    }
    let [own, far] = ["own_posed.obj", "far_posed.obj"].map(|name| {
        let file = ObjFile::read(fixture.path(name)).unwrap();
        file.positions().to_vec()
    });
    // The pelvis of the one at the origin is brought over it, by some millimetres.
    for (own, far) in own.iter().zip(&far) {
        assert!((moved(own) - far).norm() < 0.02, "{own} {far}");
    }
}

#[test]
fn a_glb_without_a_skin_is_refused_by_name() {
    let fixture = Fixture::new();
    let bytes = glb_of(&mean_woman());
    let name = b"\"skins\"";
    let at = bytes.windows(name.len()).position(|window| window == name);
    let mut without = bytes.clone();
    without[at.unwrap()..][..name.len()].copy_from_slice(b"\"extra\"");
    fixture.bytes("bare.glb", &without);
    fixture.bytes("cut.glb", &bytes[..bytes.len() / 2]);
    for name in ["bare.glb", "cut.glb"] {
        let output = fixture.garnet(&format!("body {name} --pose reach_high -o none.obj"));
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(text.contains(name), "{text}");
        assert!(!fixture.path("none.obj").exists());
    }
}

#[test]
fn numbers_that_are_no_angles_are_refused_with_frame_and_joint() {
    let fixture = Fixture::new();
    let text = bvh();
    let row = text.lines().last().unwrap();
    let mut numbers: Vec<&str> = row.split_whitespace().collect();
    let last = numbers.len() - 1;
    numbers[last] = "1e38";
    let damaged = text.replace(row, &numbers.join(" "));
    fixture.text("damaged.bvh", &damaged);
    let output = fixture.garnet("body --sex 1 --motion damaged.bvh -o frames");
    let told = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{told}");
    assert!(told.contains("more than a hundred turns"), "{told}");
    assert!(told.contains("frame 1, joint"), "{told}");
    assert!(!fixture.path("frames").exists());
}

#[test]
fn a_rig_that_is_not_its_own_is_not_overwritten() {
    let fixture = Fixture::new();
    fixture.text("kept.rig.npz", "precious");
    for name in ["kept.obj", "body.obj"] {
        // That beside `body.obj` has other joints.
        let rig = name.replace(".obj", ".rig.npz");
        let before = fixture.read(&rig);
        let output = fixture.garnet(&format!("body -o {name}"));
        assert_eq!(output.status.code(), Some(2), "{name}");
        assert!(
            stderr(&output).contains("it would be lost"),
            "{}",
            stderr(&output)
        );
        assert_eq!(fixture.read(&rig), before);
    }
    fs::create_dir(fixture.path("people")).unwrap();
    fixture.text("people/measures.csv", "name,phone\n");
    let output = fixture.garnet("body --sample 1 -o people");
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("no such table"),
        "{}",
        stderr(&output)
    );
    // Its own are.
    for _ in 0..2 {
        let output = fixture.garnet("body -o own.obj -q");
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    }
}
