//! What `body` tells of its bodies.

use std::fmt::{self, Write};

use garnet::body::shape::{BodyParameters, Measure, ParametricBody};
use serde::Serialize;

/// A given length that is missed by more is told, in metres.
const NOTABLE_LENGTH: f64 = 0.005;

/// A given body mass index that is missed by more is told.
const NOTABLE_BMI: f64 = 0.5;

/// The document of `body`: `garnet.body/1`.
#[derive(Debug, Serialize)]
pub(crate) struct BodyReport {
    /// `garnet.body/1`.
    pub(crate) schema: &'static str,
    /// In the order of the outputs.
    pub(crate) bodies: Vec<BodyOutput>,
    /// What was taken for granted.
    pub(crate) notes: Vec<String>,
    pub(crate) seconds: f64,
}

/// One body that was written.
#[derive(Debug, Serialize)]
pub(crate) struct BodyOutput {
    pub(crate) output: String,
    /// Skeleton, weights and rest mesh.
    pub(crate) rig: String,
    pub(crate) vertices: usize,
    /// The pose or frame; none for the body at rest.
    pub(crate) pose: Option<String>,
    /// What the tape measures at rest; none for a body that is not the built-in one.
    pub(crate) tape: Option<Tape>,
}

/// What the tape measures on a built-in body.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Tape {
    /// 0 is male, 1 is female.
    pub(crate) sex: f64,
    pub(crate) mass_kg: f64,
    pub(crate) volume_m3: f64,
    /// Mass over squared stature, in kg/m².
    pub(crate) bmi: f64,
    /// What was asked for; none if it was predicted.
    pub(crate) asked_bmi: Option<f64>,
    pub(crate) measures: Vec<MeasuredLength>,
}

/// One measure.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct MeasuredLength {
    pub(crate) name: &'static str,
    pub(crate) m: f64,
    /// What was asked for; none if it was predicted.
    pub(crate) asked_m: Option<f64>,
}

impl Tape {
    pub(crate) fn new(parameters: &BodyParameters, built: &ParametricBody) -> Self {
        let stature = built.measures()[Measure::Stature];
        let measured = built.measures().iter().map(|(measure, m)| MeasuredLength {
            name: measure.name(),
            m,
            asked_m: parameters.measure(measure),
        });
        Self {
            sex: parameters.sex(),
            mass_kg: built.mass(),
            volume_m3: built.volume(),
            bmi: built.mass() / (stature * stature),
            asked_bmi: parameters.bmi(),
            measures: measured.collect(),
        }
    }

    /// What is said of the measures that could not be met beside the others. A girth that cannot be
    /// met is an error; a length is not.
    pub(crate) fn conflicts(&self) -> impl Iterator<Item = String> + '_ {
        let lengths = self.measures.iter().filter_map(|measure| {
            let asked = measure.asked_m?;
            let is_off = (measure.m - asked).abs() > NOTABLE_LENGTH;
            is_off.then(|| {
                format!(
                    "{} is {:.1} cm, not {:.1} as asked for: the other measures leave no room for it",
                    measure.name,
                    100.0 * measure.m,
                    100.0 * asked
                )
            })
        });
        let asked = self.asked_bmi;
        let bmi = asked.filter(|asked| (self.bmi - asked).abs() > NOTABLE_BMI);
        let bmi = bmi.map(|asked| {
            format!(
                "the body mass index is {:.1}, not {asked:.1} as asked for: the measures leave no \
                 room for it",
                self.bmi
            )
        });
        lengths.chain(bmi)
    }
}

impl fmt::Display for Tape {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            formatter,
            "  {:<18}{:>6.1} kg, body mass index {:.1} kg/m²",
            "mass", self.mass_kg, self.bmi
        )?;
        for measure in &self.measures {
            write!(
                formatter,
                "\n  {:<18}{:>6.1} cm",
                measure.name,
                100.0 * measure.m
            )?;
            if let Some(asked) = measure.asked_m {
                write!(formatter, " (asked for {:.1})", 100.0 * asked)?;
            }
        }
        Ok(())
    }
}

/// One line a body and one column a measure, lengths in centimetres.
pub(crate) fn table_of(bodies: &[BodyOutput]) -> String {
    let names =
        Measure::ALL.map(|measure| format!(",{}_cm", measure.name().replace([' ', '-'], "_")));
    let mut text = format!("file,sex,mass_kg,bmi{}\n", names.concat());
    for body in bodies {
        let Some(tape) = &body.tape else { continue };
        let lengths = tape
            .measures
            .iter()
            .map(|measure| format!(",{:.1}", 100.0 * measure.m));
        let name = std::path::Path::new(&body.output)
            .file_name()
            .unwrap_or_default();
        let written = writeln!(
            text,
            "{},{},{:.1},{:.1}{}",
            name.to_string_lossy(),
            tape.sex,
            tape.mass_kg,
            tape.bmi,
            lengths.collect::<String>()
        );
        debug_assert!(written.is_ok(), "a string takes all text");
    }
    text
}
