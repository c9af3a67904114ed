//! What the scenes share.

use std::ops::ControlFlow;

use garnet_mesh::TriMesh;
use garnet_sim::{
    Cloth, Drape, Event, Fabric, Point3, RestShape, Scene, Schedule, SelfContact, SimError, Stage,
};

/// Cloth whose rest shape is the mesh.
pub(crate) fn cloth_of(mesh: &TriMesh, fabric: &Fabric) -> Cloth {
    let rest = RestShape::Worn(mesh.positions().to_vec());
    Cloth::new(mesh.faces(), mesh.num_vertices(), &rest, fabric).expect("a mesh that cloth can be")
}

/// One stage without any damping, of frames of a sixtieth of a second.
pub(crate) fn undamped(frames: u32, rate: f32) -> Schedule {
    Schedule {
        frame_seconds: 1.0 / 60.0,
        motion_part: [0.0, 1.0],
        motion_frames: 0,
        motion_rate: rate,
        motion_friction: 1.0,
        balance_steps: 0,
        stages: vec![Stage {
            frames,
            rate,
            extra_drag: 0.0,
            friction: 1.0,
        }],
        refreshes_per_frame: 1,
        pair_interval: 1,
        bending_interval: 2,
        patches: 1,
        contraction_frames: 0,
        length_share: 1.0,
        over_relaxation: 1.0,
        drag: 0.0,
        carry: 0.0,
        max_speed: 100.0,
        max_push_speed: 0.2,
        gravity: 0.0,
        self_contact: SelfContact::Off,
    }
}

/// Runs a scene to its end.
pub(crate) fn run(scene: &Scene<'_>, schedule: &Schedule) -> Result<Drape, SimError> {
    garnet_sim::drape(scene, schedule, &mut |_| ControlFlow::Continue(()))
}

/// Runs a scene without body and looks at each frame.
pub(crate) fn run_free(
    cloth: &Cloth,
    start: &[Point3],
    schedule: &Schedule,
    look: &mut dyn FnMut(&[Point3]),
) -> Drape {
    let scene = Scene {
        cloth,
        start,
        body: None,
    };
    let mut observer = |event: Event<'_>| {
        if let Event::Frame { positions, .. } = event {
            look(positions);
        }
        ControlFlow::Continue(())
    };
    garnet_sim::drape(&scene, schedule, &mut observer).expect("cloth that holds together")
}

/// The center of mass, in double precision.
pub(crate) fn center(cloth: &Cloth, positions: &[Point3]) -> nalgebra::Vector3<f64> {
    let (mut sum, mut total) = (nalgebra::Vector3::zeros(), 0.0);
    for (position, &mass) in positions.iter().zip(cloth.masses()) {
        sum += position.coords.cast::<f64>() * f64::from(mass);
        total += f64::from(mass);
    }
    sum / total
}
