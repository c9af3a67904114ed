//! Training and evaluation.

pub use garnet_train::{
    Began, Begin, Candidate, Choice, Curve, Curves, DefaultVariant, DrapeScores, EpochRecord,
    EvalEvent, Evaluation, Exercise, Exhibit, Finish, GarNetConfig, Left, LossConfig, LossValue,
    PRESET_NAMES, Percentiles, PoseSpaceConfig, Precision, Recipe, Row, SceneName, Schedule,
    Scores, Stage, StageSeconds, StagedScene, Tally, Term, ToldBy, TrainConfig, TrainError,
    TrainEvent, TrainJob, Trained, Trouble, TroubleKind, Untangled, Variant, WhyDefault, Worn,
    chart, evaluate, exhibit, kind_name, kind_names, train, training_folder,
};
