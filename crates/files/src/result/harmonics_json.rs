//! JSON of harmonics: the arrays of inputs and outputs, (channel, order, frequency).

use frfid_signals::{Amplitudes, Harmonics};
use serde::{Deserialize, Serialize};

use crate::result::json_array::{Complexes, Flaw, Reals};

#[derive(Serialize, Deserialize)]
pub(crate) struct HarmonicsJson {
    frequency_hz: Reals,
    orders: Vec<usize>,
    input: AmplitudesJson,
    output: AmplitudesJson,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    response: Option<Complexes>,
}

#[derive(Serialize, Deserialize)]
struct AmplitudesJson {
    amplitude: Reals,
    floor: Reals,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    deviation: Option<Reals>,
}

impl HarmonicsJson {
    pub(crate) fn of(harmonics: &Harmonics) -> Self {
        Self {
            frequency_hz: Reals::of(&harmonics.frequency_hz),
            orders: harmonics.orders.clone(),
            input: AmplitudesJson::of(&harmonics.input),
            output: AmplitudesJson::of(&harmonics.output),
            response: harmonics.response.as_ref().map(Complexes::of),
        }
    }

    pub(crate) fn read(self) -> Result<Harmonics, Flaw> {
        let response = self.response;
        let response = response.map(|response| response.into_array("harmonics.response"));
        Ok(Harmonics {
            frequency_hz: self.frequency_hz.into_list("harmonics.frequency_hz")?,
            orders: self.orders,
            input: self.input.read("harmonics.input")?,
            output: self.output.read("harmonics.output")?,
            response: response.transpose()?,
        })
    }
}

impl AmplitudesJson {
    fn of(amplitudes: &Amplitudes) -> Self {
        Self {
            amplitude: Reals::of_array(&amplitudes.amplitude),
            floor: Reals::of_array(&amplitudes.floor),
            deviation: amplitudes.deviation.as_ref().map(Reals::of_array),
        }
    }

    fn read(self, what: &'static str) -> Result<Amplitudes, Flaw> {
        let deviation = self.deviation;
        let deviation = deviation.map(|deviation| deviation.into_array(what));
        Ok(Amplitudes {
            amplitude: self.amplitude.into_array(what)?,
            floor: self.floor.into_array(what)?,
            deviation: deviation.transpose()?,
        })
    }
}
