//! Dance: positions as in Warren, *Classical Ballet Technique*, 1989, and social dances.

use crate::poses::{
    Arm, KeyPose, Leg,
    key_pose::{arm, leg, pose},
};

/// Arms low and round.
const LOW: Arm = arm(16.0, 16.0, -48.0).elbow(34.0).pronation(10.0);
/// Arms round before the waist: first position.
const FRONT: Arm = arm(56.0, 18.0, -62.0).elbow(52.0);
/// Arms out to the sides: second position.
const OPEN: Arm = arm(18.0, 76.0, 0.0).elbow(20.0).pronation(10.0);
/// Arms round overhead: fifth position.
const HIGH: Arm = arm(146.0, 36.0, -66.0).elbow(34.0);

/// Legs turned out, heels together.
const TURNED_OUT: Leg = leg(0.0, 5.0, 46.0).sole();

pub(in super::super) const DANCE: &[KeyPose] = &[
    pose("ballet_low").both_legs(TURNED_OUT).both_arms(LOW),
    pose("port_de_bras_one")
        .both_legs(TURNED_OUT)
        .both_arms(FRONT),
    pose("port_de_bras_two")
        .both_legs(TURNED_OUT)
        .both_arms(OPEN),
    pose("port_de_bras_three")
        .both_legs(TURNED_OUT)
        .neck(0.0, 4.0, 24.0)
        .arms(OPEN, FRONT),
    pose("port_de_bras_four")
        .both_legs(TURNED_OUT)
        .neck(-4.0, 0.0, 20.0)
        .arms(HIGH, FRONT),
    pose("port_de_bras_five")
        .both_legs(TURNED_OUT)
        .neck(-6.0, 0.0, 0.0)
        .both_arms(HIGH),
    pose("demi_plie")
        .both_legs(leg(32.0, 34.0, 52.0).knee(62.0).sole())
        .both_arms(LOW),
    pose("grand_plie_second")
        .both_legs(leg(36.0, 62.0, 66.0).knee(82.0).sole())
        .both_arms(OPEN),
    pose("releve")
        .both_legs(leg(0.0, 5.0, 40.0).ankle(-42.0).planted())
        .both_arms(HIGH),
    pose("tendu_front")
        .legs(
            leg(32.0, 4.0, 46.0).ankle(-45.0),
            leg(0.0, 4.0, 46.0).sole(),
        )
        .arms(OPEN, HIGH),
    pose("tendu_side")
        .legs(
            leg(6.0, 34.0, 50.0).ankle(-45.0),
            leg(0.0, 4.0, 46.0).sole(),
        )
        .both_arms(OPEN),
    pose("tendu_back")
        .pelvis(10.0, 0.0, 0.0)
        .spine(-12.0, 0.0, 0.0)
        .legs(
            leg(-24.0, 8.0, 40.0).ankle(-45.0),
            leg(10.0, 4.0, 46.0).sole(),
        )
        .arms(FRONT, OPEN),
    pose("first_arabesque")
        .pelvis(46.0, 0.0, 0.0)
        .spine(-42.0, 0.0, 0.0)
        .neck(-8.0, 0.0, 0.0)
        .legs(
            leg(-42.0, 8.0, 30.0).ankle(-55.0),
            leg(46.0, 4.0, 30.0).sole(),
        )
        .arms(
            arm(6.0, 86.0, 0.0).pronation(50.0),
            arm(96.0, 6.0, 0.0).pronation(60.0),
        ),
    pose("third_arabesque")
        .pelvis(46.0, 0.0, 0.0)
        .spine(-42.0, 0.0, 0.0)
        .neck(-8.0, 0.0, 0.0)
        .legs(
            leg(-42.0, 8.0, 30.0).ankle(-55.0),
            leg(46.0, 4.0, 30.0).sole(),
        )
        .both_arms(arm(100.0, 8.0, 0.0).pronation(60.0)),
    pose("penchee")
        .pelvis(84.0, 0.0, 0.0)
        .spine(-22.0, 0.0, 0.0)
        .neck(-12.0, 0.0, 0.0)
        .legs(
            leg(-34.0, 8.0, 20.0).ankle(-55.0),
            leg(80.0, 4.0, 20.0).sole(),
        )
        .arms(arm(-20.0, 60.0, 0.0), arm(110.0, 6.0, 0.0).pronation(60.0)),
    pose("attitude_back")
        .pelvis(32.0, 0.0, 0.0)
        .spine(-34.0, 0.0, 0.0)
        .legs(
            leg(-34.0, 26.0, 44.0).knee(78.0).ankle(-50.0),
            leg(32.0, 4.0, 30.0).sole(),
        )
        .arms(HIGH, OPEN),
    pose("attitude_front")
        .legs(
            leg(68.0, 24.0, 48.0).knee(72.0).ankle(-50.0),
            leg(0.0, 4.0, 46.0).sole(),
        )
        .arms(OPEN, HIGH),
    pose("retire")
        .legs(
            leg(44.0, 54.0, 62.0).knee(114.0).ankle(-50.0),
            leg(0.0, 3.0, 40.0).sole(),
        )
        .both_arms(FRONT),
    pose("developpe_front")
        .pelvis(-6.0, 0.0, 0.0)
        .legs(
            leg(92.0, 10.0, 46.0).knee(2.0).ankle(-50.0),
            leg(-6.0, 4.0, 44.0).sole(),
        )
        .both_arms(OPEN),
    pose("developpe_side")
        .pelvis(0.0, -12.0, 0.0)
        .spine(0.0, 8.0, 0.0)
        .legs(
            leg(28.0, 84.0, 70.0).ankle(-50.0),
            leg(0.0, 16.0, 40.0).sole(),
        )
        .arms(OPEN, HIGH),
    pose("cambre_back")
        .pelvis(-8.0, 0.0, 0.0)
        .spine(-22.0, 0.0, 0.0)
        .neck(-24.0, 0.0, 12.0)
        .both_legs(leg(-8.0, 5.0, 46.0).sole())
        .both_arms(HIGH),
    pose("cambre_side")
        .spine(0.0, 34.0, 0.0)
        .neck(0.0, 8.0, 24.0)
        .both_legs(TURNED_OUT)
        .arms(FRONT, HIGH),
    pose("lunge_fourth")
        .pelvis(6.0, 0.0, 0.0)
        .legs(
            leg(52.0, 8.0, 36.0).knee(48.0).sole(),
            leg(-24.0, 8.0, 40.0).sole(),
        )
        .arms(FRONT, OPEN),
    pose("grand_jete")
        .pelvis(10.0, 0.0, 0.0)
        .spine(-14.0, 0.0, 0.0)
        .legs(
            leg(92.0, 6.0, 30.0).knee(4.0).ankle(-50.0),
            leg(-56.0, 10.0, 30.0).knee(10.0).ankle(-50.0),
        )
        .arms(OPEN, arm(84.0, 6.0, 0.0).pronation(50.0)),
    pose("contraction")
        .pelvis(-18.0, 0.0, 0.0)
        .spine(52.0, 0.0, 0.0)
        .neck(24.0, 0.0, 0.0)
        .both_legs(leg(18.0, 12.0, 16.0).knee(42.0).sole())
        .both_arms(arm(64.0, 24.0, -60.0).elbow(44.0)),
    pose("jazz_lunge")
        .pelvis(0.0, 0.0, 0.0)
        .spine(0.0, 14.0, 12.0)
        .neck(0.0, 0.0, 30.0)
        .legs(
            leg(30.0, 52.0, 52.0).knee(66.0).sole(),
            leg(-2.0, 34.0, 16.0).sole(),
        )
        .arms(arm(20.0, 34.0, -58.0).elbow(86.0), arm(0.0, 132.0, 20.0)),
    pose("disco_point")
        .pelvis(0.0, 8.0, 0.0)
        .spine(0.0, -10.0, 8.0)
        .neck(0.0, 0.0, -20.0)
        .legs(
            leg(0.0, 6.0, 8.0).sole(),
            leg(20.0, 16.0, 16.0).knee(32.0).sole(),
        )
        .arms(arm(-16.0, 48.0, -50.0).elbow(80.0), arm(30.0, 138.0, 20.0)),
    pose("twist_left")
        .pelvis(4.0, 0.0, -16.0)
        .spine(4.0, 0.0, 36.0)
        .neck(0.0, 0.0, -14.0)
        .both_legs(leg(30.0, 6.0, 0.0).knee(46.0).sole())
        .arms(
            arm(-12.0, 34.0, -14.0).elbow(74.0),
            arm(34.0, 26.0, -40.0).elbow(76.0),
        ),
    pose("swing_kick")
        .pelvis(-4.0, 0.0, 6.0)
        .spine(10.0, 0.0, -12.0)
        .legs(
            leg(52.0, 4.0, 10.0).knee(16.0).ankle(-30.0),
            leg(8.0, 4.0, 8.0).knee(16.0).sole(),
        )
        .arms(
            arm(-28.0, 14.0, 0.0).elbow(28.0),
            arm(44.0, 14.0, 0.0).elbow(38.0),
        ),
    pose("ballroom_frame")
        .spine(-6.0, 0.0, 0.0)
        .neck(-4.0, 0.0, 18.0)
        .arms(
            arm(24.0, 78.0, 62.0).elbow(88.0),
            arm(46.0, 62.0, -26.0).elbow(88.0),
        ),
    pose("salsa_step")
        .pelvis(0.0, 9.0, -8.0)
        .spine(2.0, -12.0, 12.0)
        .legs(
            leg(6.0, 0.0, 8.0).knee(4.0).sole(),
            leg(26.0, 12.0, 8.0).knee(42.0).sole(),
        )
        .arms(
            arm(8.0, 24.0, -10.0).elbow(88.0),
            arm(-6.0, 28.0, -10.0).elbow(92.0),
        ),
    pose("flamenco")
        .spine(-10.0, 8.0, 10.0)
        .neck(-4.0, 0.0, 34.0)
        .legs(
            leg(10.0, 4.0, 20.0).knee(14.0).sole(),
            leg(0.0, 4.0, 20.0).sole(),
        )
        .arms(HIGH, arm(20.0, 30.0, -70.0).elbow(82.0)),
    pose("body_wave")
        .pelvis(-12.0, 0.0, 0.0)
        .spine(-18.0, 0.0, 0.0)
        .neck(-14.0, 0.0, 0.0)
        .both_legs(leg(6.0, 8.0, 8.0).knee(36.0).sole())
        .both_arms(arm(-16.0, 32.0, 0.0).elbow(24.0)),
];
