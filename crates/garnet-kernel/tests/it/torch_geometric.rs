//! Values of torch_geometric's FeaStConv, made by `benches/python/feast_reference.py`.

use garnet_kernel::{
    Activation, Adjacency, FeastGradients, FeastInput, FeastLayer, Features, Workspace,
    feast_backward, feast_forward,
};
use serde_json::Value;

use crate::values::{ROUNDING, assert_close};

fn numbers(case: &Value, name: &str) -> Vec<f64> {
    let list = case[name].as_array().expect("a list");
    list.iter()
        .map(|value| value.as_f64().expect("a number"))
        .collect()
}

fn count(case: &Value, name: &str) -> usize {
    usize::try_from(case[name].as_u64().expect("a count")).expect("it is small")
}

#[test]
fn outputs_and_gradients_are_those_of_feast_conv() {
    let file: Value =
        serde_json::from_str(include_str!("../data/feast_conv.json")).expect("valid JSON");
    for case in file["cases"].as_array().expect("a list") {
        let f32s = |name| {
            numbers(case, name)
                .iter()
                .map(|v| *v as f32)
                .collect::<Vec<f32>>()
        };
        let lists: Vec<Vec<u32>> =
            serde_json::from_value(case["neighbors"].clone()).expect("lists of numbers");
        let adjacency = Adjacency::from_lists(&lists).expect("in range");
        let (x, u, c, w, b) = (f32s("x"), f32s("u"), f32s("c"), f32s("w"), f32s("b"));
        let layer = FeastLayer {
            num_heads: count(case, "num_heads"),
            out_channels: count(case, "out_channels"),
            u: &u,
            c: &c,
            w: &w,
            b: &b,
            activation: Activation::None,
        };
        let features = [Features::new(&x, count(case, "in_channels"))];
        let input = FeastInput {
            adjacency: &adjacency,
            features: &features,
            residual: None,
        };
        let workspace = Workspace::new();
        let mut y = vec![0.0; layer.out_channels * adjacency.num_vertices()];
        feast_forward(&layer, &input, &mut y, &workspace);
        assert_close("y", &y, &numbers(case, "y"), ROUNDING);

        let (mut dx, mut du, mut dc) = (x.clone(), u.clone(), c.clone());
        let (mut dw, mut db) = (w.clone(), b.clone());
        let mut gradients = FeastGradients {
            features: &mut [Some(&mut dx)],
            residual: None,
            u: &mut du,
            c: &mut dc,
            w: &mut dw,
            b: &mut db,
        };
        feast_backward(
            &layer,
            &input,
            (&y, &f32s("dy")),
            &mut gradients,
            &workspace,
        );
        for (name, found) in [("dx", dx), ("du", du), ("dc", dc), ("dw", dw), ("db", db)] {
            assert_close(name, &found, &numbers(case, name), ROUNDING);
        }
    }
}
