//! Parameters of built-in bodies as files hold them.

use std::collections::BTreeMap;

use garnet_body::shape::{BodyParameters, Measure};
use serde::{Deserialize, Serialize};

/// Parameters of a built-in body as files hold them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredParameters {
    /// The sex, 0 for male to 1 for female.
    pub sex: f64,
    /// The body mass index, kg/m², if it was given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bmi: Option<f64>,
    /// The measures that were given, in metres, by their names.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub measures: BTreeMap<String, f64>,
}

impl From<&BodyParameters> for StoredParameters {
    fn from(parameters: &BodyParameters) -> Self {
        let given = parameters.given();
        Self {
            sex: parameters.sex(),
            bmi: parameters.bmi(),
            measures: given
                .map(|(measure, value)| (measure.name().to_owned(), value))
                .collect(),
        }
    }
}

impl StoredParameters {
    /// The parameters as the body is built from them.
    ///
    /// # Errors
    ///
    /// The name of the measure that there is not.
    pub fn parameters(&self) -> Result<BodyParameters, String> {
        let mut parameters = BodyParameters::new(self.sex);
        if let Some(bmi) = self.bmi {
            parameters = parameters.with_bmi(bmi);
        }
        for (name, &value) in &self.measures {
            let all = Measure::ALL.into_iter();
            let found = all.into_iter().find(|measure| measure.name() == name);
            let Some(measure) = found else {
                return Err(name.clone());
            };
            parameters = parameters.with(measure, value);
        }
        Ok(parameters)
    }
}
