//! Training and evaluation.

pub use garnet_train::{
    Began, Begin, Candidate, Choice, Curve, Curves, DefaultVariant, DrapeScores, DrapedScene,
    EpochRecord, EvalEvent, Evaluation, Finish, GarNetConfig, LeftOut, LossConfig, LossValue,
    PRESET_NAMES, PenetrationCount, Percentiles, PoseSpaceConfig, Precision, Predictor, Recipe,
    Row, SceneName, SceneTraining, ScenesFound, Schedule, Scores, Stage, StageSeconds, StagedScene,
    Tally, Term, TrainConfig, TrainError, TrainEvent, TrainJob, Trained, Trouble, TroubleKind,
    Untangled, Variant, WhyDefault, Worn, chart, drape_scenes, evaluate, kind_name, kind_names,
    scenes_found, train, training_folder,
};
