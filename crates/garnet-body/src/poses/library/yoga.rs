//! Yoga: asanas as in Iyengar, *Light on Yoga*, 1966, in forms that many people reach.

use crate::poses::{
    Arm, KeyPose, Leg,
    key_pose::{STAND, arm, leg, pose},
};

const OVERHEAD: Arm = arm(168.0, 12.0, 0.0).elbow(5.0);
const LEVEL: Arm = arm(0.0, 88.0, 0.0).pronation(75.0);
const PRAYER: Arm = arm(25.0, 28.0, -48.0).elbow(122.0).wrist(-30.0, 0.0);
const TALL: Leg = leg(0.0, 2.0, 4.0).sole();

pub(in super::super) const YOGA: &[KeyPose] = &[
    pose("mountain")
        .both_legs(TALL)
        .both_arms(arm(0.0, 13.0, 25.0).elbow(4.0).pronation(-15.0)),
    pose("mountain_prayer").both_legs(TALL).both_arms(PRAYER),
    pose("upward_salute")
        .both_legs(TALL)
        .spine(-8.0, 0.0, 0.0)
        .neck(-12.0, 0.0, 0.0)
        .both_arms(OVERHEAD),
    pose("standing_side_bend")
        .both_legs(TALL)
        .pelvis(0.0, -4.0, 0.0)
        .spine(0.0, 32.0, 0.0)
        .neck(0.0, 8.0, 0.0)
        .both_arms(OVERHEAD),
    pose("standing_back_bend")
        .pelvis(-14.0, 0.0, 0.0)
        .spine(-32.0, 0.0, 0.0)
        .neck(-18.0, 0.0, 0.0)
        .both_legs(leg(-14.0, 5.0, 4.0).sole())
        .both_arms(OVERHEAD),
    pose("forward_fold")
        .pelvis(94.0, 0.0, 0.0)
        .spine(52.0, 0.0, 0.0)
        .neck(10.0, 0.0, 0.0)
        .both_legs(leg(86.0, 4.0, 2.0).knee(6.0).sole())
        .both_arms(arm(126.0, 12.0, 0.0).elbow(48.0)),
    pose("half_lift")
        .pelvis(72.0, 0.0, 0.0)
        .spine(12.0, 0.0, 0.0)
        .neck(-18.0, 0.0, 0.0)
        .both_legs(leg(66.0, 4.0, 2.0).knee(4.0).sole())
        .both_arms(arm(72.0, 6.0, 0.0).elbow(5.0)),
    pose("chair")
        .pelvis(34.0, 0.0, 0.0)
        .spine(4.0, 0.0, 0.0)
        .both_legs(leg(92.0, 4.0, 2.0).knee(86.0).sole())
        .both_arms(arm(160.0, 14.0, 0.0).elbow(6.0)),
    pose("revolved_chair")
        .pelvis(42.0, 0.0, 0.0)
        .spine(12.0, 0.0, 42.0)
        .neck(0.0, 0.0, 35.0)
        .both_legs(leg(98.0, 4.0, 2.0).knee(84.0).sole())
        .both_arms(PRAYER),
    pose("tree")
        .legs(
            leg(0.0, 2.0, 4.0).sole(),
            leg(44.0, 56.0, 58.0).knee(120.0).ankle(-15.0),
        )
        .both_arms(arm(156.0, 22.0, -64.0).elbow(32.0)),
    pose("tree_prayer")
        .legs(
            leg(0.0, 2.0, 4.0).sole(),
            leg(44.0, 56.0, 58.0).knee(120.0).ankle(-15.0),
        )
        .both_arms(PRAYER),
    pose("warrior_one")
        .pelvis(8.0, 0.0, 0.0)
        .spine(-16.0, 0.0, 0.0)
        .neck(-8.0, 0.0, 0.0)
        .legs(
            leg(72.0, 2.0, 2.0).knee(66.0).sole(),
            leg(-38.0, 6.0, 25.0).knee(3.0).sole(),
        )
        .both_arms(OVERHEAD),
    pose("warrior_two")
        .neck(0.0, 0.0, 72.0)
        .legs(
            leg(18.0, 62.0, 74.0).knee(62.0).sole(),
            leg(-4.0, 44.0, 12.0).sole(),
        )
        .both_arms(LEVEL),
    pose("reverse_warrior")
        .spine(-6.0, -28.0, 0.0)
        .neck(0.0, 0.0, 45.0)
        .legs(
            leg(18.0, 62.0, 74.0).knee(62.0).sole(),
            leg(-4.0, 44.0, 12.0).sole(),
        )
        .arms(
            arm(0.0, 168.0, 40.0).elbow(5.0),
            arm(-8.0, 50.0, 0.0).pronation(20.0),
        ),
    pose("warrior_three")
        .pelvis(82.0, 0.0, 0.0)
        .neck(-15.0, 0.0, 0.0)
        .legs(
            leg(80.0, 2.0, 4.0).knee(4.0).sole(),
            leg(-4.0, 2.0, 0.0).ankle(0.0),
        )
        .both_arms(OVERHEAD),
    pose("triangle")
        .pelvis(0.0, 34.0, 0.0)
        .spine(0.0, 34.0, 0.0)
        .neck(0.0, 5.0, -55.0)
        .legs(leg(6.0, 76.0, 55.0).sole(), leg(-2.0, -6.0, 8.0).sole())
        .arms(arm(0.0, 88.0, 40.0), arm(0.0, 92.0, 40.0)),
    pose("extended_side_angle")
        .pelvis(0.0, 30.0, 0.0)
        .spine(0.0, 30.0, 0.0)
        .neck(0.0, 0.0, -40.0)
        .legs(
            leg(28.0, 84.0, 72.0).knee(72.0).sole(),
            leg(-4.0, 18.0, 10.0).sole(),
        )
        .arms(arm(25.0, 62.0, -20.0).elbow(85.0), arm(10.0, 165.0, 30.0)),
    pose("high_lunge")
        .pelvis(14.0, 0.0, 0.0)
        .spine(-8.0, 0.0, 0.0)
        .legs(
            leg(84.0, 2.0, 2.0).knee(70.0).sole(),
            leg(-30.0, 2.0, 2.0).knee(4.0).ankle(8.0).planted(),
        )
        .both_arms(OVERHEAD),
    pose("low_lunge")
        .pelvis(10.0, 0.0, 0.0)
        .spine(-18.0, 0.0, 0.0)
        .neck(-8.0, 0.0, 0.0)
        .legs(
            leg(98.0, 2.0, 2.0).knee(88.0).sole(),
            leg(-22.0, 2.0, 0.0).knee(52.0).ankle(-45.0).planted(),
        )
        .both_arms(OVERHEAD),
    pose("goddess")
        .both_legs(leg(26.0, 58.0, 70.0).knee(68.0).sole())
        .both_arms(arm(0.0, 88.0, 88.0).elbow(88.0)),
    pose("dancer")
        .pelvis(28.0, 0.0, 0.0)
        .spine(-28.0, 0.0, 0.0)
        .neck(-5.0, 0.0, 0.0)
        .legs(
            leg(28.0, 2.0, 4.0).sole(),
            leg(-30.0, 8.0, 0.0).knee(98.0).ankle(-35.0),
        )
        .arms(arm(118.0, 4.0, 0.0), arm(-58.0, 12.0, -20.0).elbow(8.0)),
    pose("star")
        .both_legs(leg(0.0, 28.0, 20.0).sole())
        .both_arms(arm(0.0, 112.0, 20.0)),
    pose("downward_dog")
        .pelvis(128.0, 0.0, 0.0)
        .spine(8.0, 0.0, 0.0)
        .neck(15.0, 0.0, 0.0)
        .both_legs(leg(94.0, 5.0, 0.0).knee(4.0).ankle(18.0).planted())
        .both_arms(arm(162.0, 14.0, 0.0).pronation(60.0).wrist(-40.0, 0.0))
        .on_hands(),
    pose("plank")
        .pelvis(78.0, 0.0, 0.0)
        .both_legs(leg(2.0, 4.0, 0.0).ankle(8.0).planted())
        .both_arms(arm(82.0, 8.0, 0.0).pronation(70.0).wrist(-70.0, 0.0))
        .on_hands(),
    pose("table")
        .pelvis(84.0, 0.0, 0.0)
        .both_legs(leg(84.0, 5.0, 0.0).knee(90.0).ankle(-50.0).planted())
        .both_arms(arm(86.0, 6.0, 0.0).pronation(70.0).wrist(-70.0, 0.0))
        .on_hands(),
    pose("cat")
        .pelvis(66.0, 0.0, 0.0)
        .spine(46.0, 0.0, 0.0)
        .neck(30.0, 0.0, 0.0)
        .both_legs(leg(66.0, 5.0, 0.0).knee(90.0).ankle(-50.0).planted())
        .both_arms(arm(108.0, 6.0, 0.0).pronation(70.0).wrist(-70.0, 0.0))
        .on_hands(),
    pose("cobra")
        .pelvis(82.0, 0.0, 0.0)
        .spine(-46.0, 0.0, 0.0)
        .neck(-24.0, 0.0, 0.0)
        .both_legs(leg(-6.0, 4.0, 0.0).knee(2.0).ankle(-48.0))
        .both_arms(
            arm(44.0, 14.0, -10.0)
                .elbow(26.0)
                .pronation(60.0)
                .wrist(-50.0, 0.0),
        ),
    pose("kneel").both_legs(leg(2.0, 5.0, 0.0).knee(90.0).ankle(-50.0).planted()),
    pose("camel")
        .pelvis(-8.0, 0.0, 0.0)
        .spine(-48.0, 0.0, 0.0)
        .neck(-40.0, 0.0, 0.0)
        .both_legs(leg(-14.0, 6.0, 0.0).knee(88.0).ankle(-50.0).planted())
        .both_arms(arm(-42.0, 16.0, 10.0).elbow(6.0)),
    pose("staff")
        .both_legs(leg(88.0, 4.0, 4.0).ankle(5.0))
        .both_arms(arm(-8.0, 14.0, 0.0).elbow(12.0).pronation(60.0)),
    pose("boat")
        .pelvis(-36.0, 0.0, 0.0)
        .spine(10.0, 0.0, 0.0)
        .neck(10.0, 0.0, 0.0)
        .both_legs(leg(88.0, 3.0, 0.0).knee(12.0).ankle(-25.0))
        .both_arms(arm(62.0, 10.0, 0.0).elbow(4.0)),
    pose("bound_angle")
        .spine(6.0, 0.0, 0.0)
        .both_legs(leg(70.0, 62.0, 79.0).knee(114.0).ankle(-15.0))
        .both_arms(arm(30.0, 10.0, -12.0).elbow(24.0)),
    pose("garland")
        .pelvis(18.0, 0.0, 0.0)
        .spine(16.0, 0.0, 0.0)
        .both_legs(leg(104.0, 50.0, 30.0).knee(116.0).sole())
        .both_arms(arm(38.0, 16.0, -44.0).elbow(112.0).wrist(-30.0, 0.0)),
    pose("knee_to_chest")
        .legs(STAND, leg(106.0, 10.0, 6.0).knee(114.0).ankle(-20.0))
        .both_arms(arm(42.0, 4.0, -26.0).elbow(52.0)),
];
