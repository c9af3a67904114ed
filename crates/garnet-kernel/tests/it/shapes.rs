//! Wrong shapes are named before anything is computed.

use std::panic::{AssertUnwindSafe, catch_unwind};

use garnet_kernel::{
    Activation, Adjacency, FeastInput, FeastLayer, Features, LinearInput, LinearLayer, Workspace,
    feast_forward, global_max_forward, linear_forward,
};

/// The message with which a call panics.
fn message(call: impl FnOnce()) -> String {
    let panic = catch_unwind(AssertUnwindSafe(call)).expect_err("the shapes are wrong");
    panic.downcast_ref::<String>().cloned().unwrap_or_else(|| {
        panic
            .downcast_ref::<&str>()
            .map(ToString::to_string)
            .unwrap_or_default()
    })
}

#[test]
fn wrong_shapes_of_a_convolution_are_named() {
    let adjacency = Adjacency::from_faces(3, &[[0, 1, 2]]).expect("valid");
    let layer = FeastLayer {
        num_heads: 2,
        out_channels: 4,
        u: &[0.0; 6],
        c: &[0.0; 2],
        w: &[0.0; 24],
        b: &[0.0; 4],
        activation: Activation::None,
    };
    let run = |layer: FeastLayer<'_>, x: &[f32], len: usize| {
        message(|| {
            let features = [Features::new(x, 3)];
            let input = FeastInput {
                adjacency: &adjacency,
                features: &features,
                residual: None,
            };
            feast_forward(&layer, &input, &mut vec![0.0; len], &Workspace::new());
        })
    };
    assert_eq!(
        run(layer, &[0.0; 9], 11),
        "`y` has 11 values, expected 3 rows of 4 = 12"
    );
    assert_eq!(
        run(layer, &[0.0; 8], 12),
        "`features` has 8 values, expected 3 rows of 3 = 9"
    );
    let wrong_w = FeastLayer {
        w: &[0.0; 12],
        ..layer
    };
    assert_eq!(
        run(wrong_w, &[0.0; 9], 12),
        "`w` has 12 values, expected 6 rows of 4 = 24"
    );
    let no_heads = FeastLayer {
        num_heads: 0,
        ..layer
    };
    assert_eq!(
        run(no_heads, &[0.0; 9], 12),
        "a FeaStNet layer needs one head at least"
    );
}

#[test]
fn wrong_shapes_of_a_linear_layer_are_named() {
    let layer = LinearLayer {
        out_channels: 2,
        w: &[0.0; 8],
        b: None,
        activation: Activation::None,
    };
    let found = message(|| {
        let parts = [LinearInput::PerRow(Features::new(&[0.0; 9], 3))];
        linear_forward(&layer, &parts, &mut [0.0; 6], &Workspace::new());
    });
    assert_eq!(found, "`w` has 8 values, expected 3 rows of 2 = 6");
}

#[test]
fn the_maximum_over_nothing_is_refused() {
    let found = message(|| {
        global_max_forward(
            Features::new(&[], 2),
            &mut [0.0; 2],
            &mut [0; 2],
            &Workspace::new(),
        );
    });
    assert_eq!(found, "the maximum over no rows is undefined");
}
