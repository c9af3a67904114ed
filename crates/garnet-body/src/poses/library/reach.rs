//! Reaching.

use crate::poses::{
    Arm, KeyPose,
    key_pose::{HANG, arm, leg, pose},
};

const FORWARD: Arm = arm(86.0, 4.0, 0.0).elbow(4.0).pronation(50.0);

pub(in super::super) const REACH: &[KeyPose] = &[
    pose("reach_front").both_arms(FORWARD),
    pose("reach_front_far")
        .pelvis(18.0, 0.0, 0.0)
        .spine(18.0, 0.0, 0.0)
        .neck(-16.0, 0.0, 0.0)
        .both_legs(leg(16.0, 6.0, 6.0).knee(4.0).sole())
        .both_arms(arm(102.0, 4.0, 0.0).pronation(50.0).collar(4.0, 18.0)),
    pose("reach_left")
        .spine(0.0, 12.0, 0.0)
        .neck(0.0, 0.0, 50.0)
        .arms(arm(0.0, 94.0, 0.0).pronation(40.0).collar(4.0, 0.0), HANG),
    pose("reach_sides").both_arms(arm(0.0, 92.0, 10.0)),
    pose("reach_high")
        .neck(-18.0, 0.0, 0.0)
        .both_legs(leg(0.0, 5.0, 5.0).ankle(-30.0).planted())
        .both_arms(arm(166.0, 10.0, 0.0).elbow(6.0).collar(8.0, 0.0)),
    pose("reach_high_left")
        .spine(0.0, -12.0, 0.0)
        .neck(-18.0, 0.0, 14.0)
        .arms(
            arm(166.0, 14.0, 0.0).elbow(4.0).collar(10.0, 0.0),
            arm(2.0, 22.0, 0.0).elbow(12.0),
        ),
    pose("reach_shelf")
        .neck(-14.0, 0.0, 0.0)
        .spine(-6.0, 0.0, 0.0)
        .both_arms(arm(132.0, 8.0, 0.0).elbow(16.0).pronation(40.0)),
    pose("reach_low")
        .pelvis(44.0, 0.0, 0.0)
        .spine(34.0, 0.0, 0.0)
        .neck(-12.0, 0.0, 0.0)
        .both_legs(leg(64.0, 8.0, 6.0).knee(42.0).sole())
        .both_arms(arm(86.0, 6.0, 0.0).elbow(6.0)),
    pose("reach_low_left")
        .pelvis(30.0, 10.0, 10.0)
        .spine(28.0, 20.0, 12.0)
        .neck(0.0, 0.0, 10.0)
        .legs(
            leg(56.0, 18.0, 12.0).knee(46.0).sole(),
            leg(38.0, 6.0, 8.0).knee(24.0).sole(),
        )
        .arms(
            arm(58.0, 34.0, 0.0).elbow(6.0),
            arm(10.0, 20.0, 0.0).elbow(30.0),
        ),
    pose("reach_floor_beside")
        .spine(6.0, 34.0, 0.0)
        .pelvis(0.0, 10.0, 0.0)
        .legs(
            leg(36.0, 16.0, 14.0).knee(58.0).sole(),
            leg(30.0, -4.0, 8.0).knee(40.0).sole(),
        )
        .arms(
            arm(0.0, 46.0, 0.0).elbow(4.0),
            arm(0.0, 62.0, 0.0).elbow(10.0),
        ),
    pose("reach_across")
        .spine(4.0, 0.0, -26.0)
        .neck(0.0, 0.0, -24.0)
        .arms(arm(80.0, -22.0, -10.0).elbow(10.0).pronation(40.0), HANG),
    pose("reach_behind")
        .spine(0.0, 0.0, 28.0)
        .neck(0.0, 0.0, 46.0)
        .arms(
            arm(-46.0, 34.0, 0.0).elbow(8.0),
            arm(10.0, 14.0, -10.0).elbow(28.0),
        ),
    pose("reach_behind_both")
        .spine(-10.0, 0.0, 0.0)
        .neck(-4.0, 0.0, 0.0)
        .both_arms(arm(-50.0, 14.0, 0.0).elbow(4.0)),
    pose("reach_up_and_down").spine(0.0, -6.0, 0.0).arms(
        arm(168.0, 10.0, 0.0).elbow(4.0),
        arm(-12.0, 12.0, 0.0).elbow(2.0),
    ),
    pose("reach_diagonal")
        .spine(0.0, -10.0, 8.0)
        .neck(-8.0, 0.0, 20.0)
        .arms(
            arm(30.0, 134.0, 10.0).elbow(4.0),
            arm(-14.0, 44.0, 0.0).elbow(4.0),
        ),
    pose("twist_reach")
        .spine(0.0, 0.0, 38.0)
        .neck(0.0, 0.0, 30.0)
        .both_arms(arm(0.0, 86.0, 0.0).pronation(60.0)),
    pose("hands_behind_head")
        .neck(4.0, 0.0, 0.0)
        .both_arms(arm(30.0, 112.0, 70.0).elbow(126.0)),
    pose("hand_to_opposite_shoulder")
        .arms(arm(62.0, -8.0, -52.0).elbow(118.0).pronation(30.0), HANG),
    pose("hand_between_shoulders")
        .neck(8.0, 0.0, 0.0)
        .arms(arm(146.0, 42.0, 0.0).elbow(128.0), HANG),
    pose("hand_to_small_of_back").arms(arm(-28.0, 24.0, -66.0).elbow(68.0), HANG),
    pose("hug").spine(10.0, 0.0, 0.0).neck(8.0, 6.0, 0.0).arms(
        arm(74.0, 26.0, -56.0).elbow(52.0),
        arm(64.0, 30.0, -56.0).elbow(52.0),
    ),
    pose("push")
        .pelvis(12.0, 0.0, 0.0)
        .spine(8.0, 0.0, 0.0)
        .neck(-10.0, 0.0, 0.0)
        .legs(
            leg(48.0, 4.0, 6.0).knee(44.0).sole(),
            leg(-22.0, 4.0, 10.0).knee(6.0).sole(),
        )
        .both_arms(
            arm(78.0, 10.0, -6.0)
                .elbow(22.0)
                .pronation(60.0)
                .wrist(-60.0, 0.0),
        ),
    pose("pull")
        .pelvis(-4.0, 0.0, 0.0)
        .legs(
            leg(38.0, 6.0, 8.0).knee(34.0).sole(),
            leg(8.0, 8.0, 10.0).knee(32.0).sole(),
        )
        .both_arms(arm(34.0, 16.0, -10.0).elbow(72.0)),
    pose("throw")
        .spine(-8.0, 0.0, -32.0)
        .neck(0.0, 0.0, 30.0)
        .legs(
            leg(34.0, 6.0, 10.0).knee(12.0).sole(),
            leg(-8.0, 10.0, 20.0).knee(12.0).sole(),
        )
        .arms(
            arm(72.0, 22.0, 0.0).elbow(10.0),
            arm(-12.0, 94.0, 82.0).elbow(96.0),
        ),
    pose("serve")
        .spine(-22.0, -8.0, -16.0)
        .neck(-26.0, 0.0, 10.0)
        .both_legs(leg(12.0, 8.0, 12.0).knee(32.0).sole())
        .arms(
            arm(158.0, 16.0, 0.0).elbow(4.0),
            arm(-10.0, 96.0, 78.0).elbow(104.0),
        ),
    pose("swim")
        .pelvis(12.0, 0.0, 0.0)
        .spine(10.0, 0.0, -14.0)
        .both_legs(leg(14.0, 6.0, 6.0).knee(8.0).sole())
        .arms(
            arm(158.0, 10.0, 0.0).elbow(8.0),
            arm(-34.0, 16.0, 0.0).elbow(24.0),
        ),
];
