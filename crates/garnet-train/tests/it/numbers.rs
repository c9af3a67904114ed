//! Each number of a configuration has a range, and what is out of it is told by name.

use garnet_net::GarNetConfig;
use garnet_train::{PoseSpaceConfig, Predictor, TrainConfig, TrainError};
use toml::{Table, Value};

use crate::invented::{Invented, run, tiny};

/// Fields that may be zero.
const MAY_BE_ZERO: [&str; 28] = [
    "seed",
    "warm_up",
    "max_gradient",
    "patience",
    "weight_decay",
    "mean_of_weights",
    "save_every",
    "pose_space.rounds",
    "pose_space.folds",
    "loss.vertex",
    "loss.distance",
    "loss.penetration",
    "loss.normal",
    "loss.bending",
    "loss.mean_curvature",
    "loss.uniform_curvature",
    "loss.rayleigh.0",
    "loss.rayleigh.1",
    "loss.rayleigh.2",
    "loss.strain",
    "loss.gravity",
    "loss.fold",
    "loss.penetration_tolerance",
    "loss.penetration_offset",
    "network.body.reach",
    "network.body.points",
    "network.num_sewing_parameters",
    "network.num_body_parameters",
];

/// A configuration with all its fields, those of the network among them.
fn all_fields() -> Value {
    let config = TrainConfig {
        network: Table::try_from(GarNetConfig::preset("small").unwrap()).unwrap(),
        ..TrainConfig::default()
    };
    Value::try_from(config).unwrap()
}

/// The places of all numbers, as `loss.rayleigh.2`.
fn numbers(value: &Value, at: &str, found: &mut Vec<String>) {
    let at_name = |name: &str| {
        if at.is_empty() {
            name.to_owned()
        } else {
            format!("{at}.{name}")
        }
    };
    match value {
        Value::Integer(_) | Value::Float(_) => found.push(at.to_owned()),
        Value::Array(values) => {
            for (index, value) in values.iter().enumerate() {
                numbers(value, &at_name(&index.to_string()), found);
            }
        }
        Value::Table(values) => {
            for (name, value) in values {
                numbers(value, &at_name(name), found);
            }
        }
        _ => {}
    }
}

fn place<'a>(value: &'a mut Value, at: &str) -> &'a mut Value {
    at.split('.').fold(value, |value, name| match value {
        Value::Array(values) => &mut values[name.parse::<usize>().unwrap()],
        Value::Table(values) => values.get_mut(name).unwrap(),
        _ => panic!("{at}"),
    })
}

fn checked(config: &Value) -> Result<(), TrainError> {
    TrainConfig::parse(&toml::to_string(config).unwrap())?.validate()
}

#[test]
fn each_number_has_a_range() {
    let config = all_fields();
    checked(&config).unwrap();
    let mut places = Vec::new();
    numbers(&config, "", &mut places);
    assert!(places.len() > 60, "{places:?}");
    for at in &places {
        let mut changed = config.clone();
        let mut told = |value: Value| {
            *place(&mut changed, at) = value;
            checked(&changed).map_err(|error| error.to_string())
        };
        let zero = match place(&mut config.clone(), at) {
            Value::Integer(_) => Value::Integer(0),
            _ => Value::Float(0.0),
        };
        let found = told(zero);
        assert_eq!(
            found.is_ok(),
            MAY_BE_ZERO.contains(&at.as_str()),
            "{at} = 0: {found:?}"
        );
        let huge = i64::MAX;
        let mut wrong = vec![
            Value::Integer(-1),
            Value::Integer(huge),
            Value::Float(f64::NAN),
            Value::Float(f64::INFINITY),
            Value::Float(f64::NEG_INFINITY),
            Value::Float(-0.5),
            Value::Float(1e30),
        ];
        // Any seed will do.
        wrong.retain(|value| at != "seed" || *value != Value::Integer(huge));
        for value in wrong {
            let text = value.to_string();
            let error = told(value).expect_err(&format!("{at} = {text}"));
            let mut names = at.rsplit('.');
            let name = names.find(|name| name.parse::<u8>().is_err()).unwrap();
            let has_line = at == "seed" && error.contains("line ");
            assert!(has_line || error.contains(name), "{at} = {text}: {error}");
            assert!(error.len() < 200, "{at} = {text}: {error}");
        }
    }
}

#[test]
fn what_never_ended_is_refused_with_its_range() {
    for (text, expected) in [
        (
            "[pose_space]\nhidden = 0",
            "`pose_space.hidden` is `0`, but has to be from 1 to 4096",
        ),
        (
            "[pose_space]\nhidden = 1000000",
            "`pose_space.hidden` is `1000000`, but has to be from 1 to 4096",
        ),
        (
            "[pose_space]\npasses = 4000000000",
            "`pose_space.passes` is `4000000000`, but has to be from 1 to 100000",
        ),
        (
            "[pose_space]\npasses = 5000000000",
            "`pose_space.passes` is `5000000000`, but has to be from 1 to 100000",
        ),
        (
            "[pose_space]\nfolds = 1",
            "`pose_space.folds` is `1`, but has to be from 2 to 16",
        ),
        (
            "epochs = -3",
            "`epochs` is `-3`, but has to be from 1 to 1000000",
        ),
    ] {
        let config = TrainConfig::parse(text).and_then(|config| config.validate());
        assert_eq!(config.unwrap_err().to_string(), expected);
    }
}

#[test]
fn widths_that_together_ask_for_too_much_are_refused() {
    let blocks = "[network.garment]\nheads = 32\nblocks = [4096, 4096, 4096, 4096, 4096, 4096]";
    let error = TrainConfig::parse(blocks).unwrap().validate().unwrap_err();
    let error = error.to_string();
    assert!(
        error.starts_with("`weights` of the network is `"),
        "{error}"
    );
}

#[test]
fn the_least_of_each_number_is_fitted_with() {
    let invented = Invented::new();
    for predictor in [Predictor::Scenes, Predictor::Networks] {
        let pose_space = PoseSpaceConfig {
            shapes: 1,
            scenes: 1,
            searched: 1,
            rounds: 0,
            region_shapes: 1,
            region_searched: 1,
            hidden: 1,
            passes: 1,
            predictor,
            ..PoseSpaceConfig::default()
        };
        let config = TrainConfig {
            pose_space,
            ..tiny(1)
        };
        config.validate().unwrap();
        run(&invented.job("pose-space", config)).unwrap();
    }
}
