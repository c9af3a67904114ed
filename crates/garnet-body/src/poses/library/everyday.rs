//! Everyday poses.

use crate::poses::{
    KeyPose,
    key_pose::{HANG, arm, leg, pose},
};

pub(in super::super) const EVERYDAY: &[KeyPose] = &[
    pose("stand"),
    pose("stand_at_ease")
        .pelvis(0.0, -6.0, 0.0)
        .spine(2.0, 8.0, 0.0)
        .neck(4.0, 0.0, 10.0)
        .legs(
            leg(12.0, 8.0, 14.0).knee(20.0).sole(),
            leg(0.0, 6.0, 6.0).sole(),
        )
        .arms(HANG, arm(-4.0, 12.0, -10.0).elbow(22.0).pronation(25.0)),
    pose("a_pose").both_arms(arm(0.0, 45.0, 0.0).elbow(5.0)),
    pose("t_pose").both_arms(arm(0.0, 88.0, 0.0).elbow(3.0)),
    pose("hands_on_hips")
        .both_legs(leg(0.0, 9.0, 10.0).sole())
        .both_arms(
            arm(-16.0, 46.0, -52.0)
                .elbow(82.0)
                .pronation(15.0)
                .wrist(10.0, 0.0),
        ),
    pose("arms_crossed").spine(2.0, 0.0, 0.0).arms(
        arm(22.0, 8.0, -64.0).elbow(94.0).pronation(30.0),
        arm(44.0, 8.0, -60.0).elbow(86.0).pronation(30.0),
    ),
    pose("hands_behind_back")
        .spine(-2.0, 0.0, 0.0)
        .both_arms(arm(-32.0, 22.0, -62.0).elbow(62.0)),
    pose("hands_in_pockets")
        .spine(3.0, 0.0, 0.0)
        .both_arms(arm(-20.0, 22.0, -24.0).elbow(42.0).pronation(10.0)),
    pose("phone_at_ear")
        .neck(4.0, -8.0, 0.0)
        .arms(HANG, arm(45.0, 50.0, 17.0).elbow(146.0).pronation(20.0)),
    pose("texting")
        .spine(5.0, 0.0, 0.0)
        .neck(28.0, 0.0, 0.0)
        .both_arms(arm(22.0, 8.0, -32.0).elbow(98.0).pronation(-10.0)),
    pose("drink")
        .neck(-6.0, 0.0, 0.0)
        .arms(HANG, arm(42.0, 22.0, -32.0).elbow(118.0).pronation(20.0)),
    pose("wave")
        .neck(0.0, 0.0, -10.0)
        .arms(HANG, arm(12.0, 92.0, 82.0).elbow(82.0).pronation(30.0)),
    pose("point")
        .neck(0.0, 0.0, 12.0)
        .arms(arm(82.0, 16.0, 0.0).elbow(6.0).pronation(45.0), HANG),
    pose("salute").arms(HANG, arm(32.0, 82.0, 38.0).elbow(128.0).pronation(45.0)),
    pose("scratch_head")
        .neck(8.0, 6.0, 0.0)
        .arms(HANG, arm(54.0, 96.0, 62.0).elbow(132.0)),
    pose("shrug").neck(0.0, 6.0, 0.0).both_arms(
        arm(12.0, 18.0, 38.0)
            .elbow(84.0)
            .pronation(-60.0)
            .collar(22.0, 0.0),
    ),
    pose("carry_box")
        .spine(-4.0, 0.0, 0.0)
        .both_legs(leg(4.0, 7.0, 6.0).knee(6.0).sole())
        .both_arms(arm(20.0, 10.0, -4.0).elbow(78.0).pronation(-30.0)),
    pose("look_back")
        .spine(0.0, 0.0, 32.0)
        .neck(0.0, 0.0, 58.0)
        .both_legs(leg(2.0, 8.0, 8.0).sole()),
    pose("lean_forward")
        .pelvis(34.0, 0.0, 0.0)
        .spine(18.0, 0.0, 0.0)
        .neck(-14.0, 0.0, 0.0)
        .both_legs(leg(32.0, 7.0, 4.0).knee(8.0).sole())
        .both_arms(
            arm(68.0, 12.0, 0.0)
                .elbow(22.0)
                .pronation(60.0)
                .wrist(-40.0, 0.0),
        ),
    pose("sit")
        .both_legs(leg(88.0, 7.0, 2.0).knee(88.0).sole())
        .both_arms(arm(24.0, 8.0, -6.0).elbow(56.0).pronation(60.0)),
    pose("sit_slouched")
        .pelvis(-22.0, 0.0, 0.0)
        .spine(32.0, 0.0, 0.0)
        .neck(6.0, 0.0, 0.0)
        .legs(
            leg(68.0, 12.0, 14.0).knee(72.0).sole(),
            leg(66.0, 14.0, 14.0).knee(64.0).sole(),
        )
        .both_arms(arm(22.0, 14.0, -10.0).elbow(66.0).pronation(50.0)),
    pose("sit_leaning_on_knees")
        .pelvis(24.0, 0.0, 0.0)
        .spine(28.0, 0.0, 0.0)
        .neck(-12.0, 0.0, 0.0)
        .both_legs(leg(110.0, 16.0, 6.0).knee(86.0).sole())
        .both_arms(arm(66.0, 14.0, -22.0).elbow(64.0).pronation(30.0)),
    pose("type_at_desk")
        .spine(4.0, 0.0, 0.0)
        .neck(10.0, 0.0, 0.0)
        .both_legs(leg(88.0, 6.0, 2.0).knee(90.0).sole())
        .both_arms(arm(22.0, 8.0, -10.0).elbow(82.0).pronation(75.0)),
    pose("squat")
        .pelvis(36.0, 0.0, 0.0)
        .spine(10.0, 0.0, 0.0)
        .both_legs(leg(108.0, 14.0, 12.0).knee(104.0).sole())
        .both_arms(arm(88.0, 8.0, 0.0).pronation(60.0)),
    pose("pick_up")
        .pelvis(46.0, 0.0, 0.0)
        .spine(36.0, 0.0, 0.0)
        .neck(-10.0, 0.0, 0.0)
        .legs(
            leg(100.0, 10.0, 8.0).knee(86.0).sole(),
            leg(96.0, 12.0, 8.0).knee(78.0).sole(),
        )
        .arms(
            arm(82.0, 10.0, 0.0).elbow(12.0),
            arm(58.0, 14.0, 0.0).elbow(22.0),
        ),
    pose("tie_shoe")
        .pelvis(26.0, 0.0, 0.0)
        .spine(40.0, 0.0, 0.0)
        .neck(12.0, 0.0, 0.0)
        .legs(
            leg(106.0, 14.0, 4.0).knee(94.0).sole(),
            leg(26.0, 4.0, 0.0).knee(104.0).ankle(10.0).planted(),
        )
        .arms(
            arm(66.0, 22.0, -10.0).elbow(18.0),
            arm(70.0, -12.0, -10.0).elbow(14.0),
        ),
    pose("stairs_up")
        .pelvis(8.0, 0.0, 4.0)
        .spine(4.0, 0.0, -6.0)
        .legs(
            leg(72.0, 2.0, 4.0).knee(78.0).ankle(8.0),
            leg(6.0, 2.0, 4.0).knee(4.0).sole(),
        )
        .arms(
            arm(-18.0, 8.0, 0.0).elbow(20.0),
            arm(28.0, 6.0, 0.0).elbow(32.0),
        ),
    pose("stairs_push_off")
        .pelvis(10.0, 0.0, -4.0)
        .spine(4.0, 0.0, 6.0)
        .legs(
            leg(48.0, 2.0, 4.0).knee(52.0).ankle(10.0),
            leg(-10.0, 2.0, 4.0).knee(18.0).ankle(-20.0),
        )
        .arms(
            arm(20.0, 8.0, 0.0).elbow(28.0),
            arm(-14.0, 8.0, 0.0).elbow(18.0),
        ),
    pose("kneel_on_one_knee")
        .legs(
            leg(90.0, 4.0, 4.0).knee(90.0).sole(),
            leg(0.0, 4.0, 0.0).knee(88.0).ankle(-45.0).planted(),
        )
        .arms(arm(32.0, 8.0, -16.0).elbow(52.0), HANG),
    pose("lean_on_one_leg")
        .pelvis(0.0, 8.0, 0.0)
        .spine(0.0, -10.0, 0.0)
        .legs(
            leg(0.0, -2.0, 6.0).sole(),
            leg(14.0, 14.0, 16.0).knee(22.0).sole(),
        )
        .arms(
            arm(-16.0, 46.0, -50.0).elbow(80.0),
            arm(2.0, 22.0, 0.0).elbow(12.0),
        ),
    pose("stand_wide")
        .both_legs(leg(0.0, 18.0, 14.0).sole())
        .both_arms(STAND_ARMS),
    pose("step_forward")
        .legs(
            leg(26.0, 2.0, 6.0).knee(6.0).sole(),
            leg(-16.0, 2.0, 6.0).knee(4.0).ankle(10.0).planted(),
        )
        .both_arms(HANG),
];

const STAND_ARMS: crate::poses::Arm = arm(4.0, 14.0, 0.0).elbow(18.0).pronation(25.0);
