//! JSON Schemas of `experiment.toml`, robot files and log maps, for editors that complete and check
//! them.

use schemars::{JsonSchema, schema_for};
use serde_json::Value;

use crate::description::config::Config;
use crate::description::robot::RobotTable;

/// JSON Schema (draft 2020-12) of `experiment.toml`.
#[must_use]
pub fn schema() -> Value {
    schema_for!(Config).to_value()
}

/// JSON Schema (draft 2020-12) of a robot file: the tables of `[robot]`, without the name of
/// another file.
#[must_use]
pub fn robot_schema() -> Value {
    let mut schema = schema_for!(RobotTable).to_value();
    if let Some(Value::Object(keys)) = schema.get_mut("properties") {
        keys.remove("file");
    }
    schema["title"] = "Robot file".into();
    schema
}

/// JSON Schema (draft 2020-12) of a log map.
#[must_use]
pub fn map_schema() -> Value {
    schema_for!(LogMap).to_value()
}

/// Log map: which signals of a recording are which. The keys of `frfid_files::LogMap`, which knows
/// no schemas.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields)]
#[expect(dead_code, reason = "read by nobody but the schema's derive")]
struct LogMap {
    /// Plant input, channel by channel.
    u: Vec<Signal>,
    /// Plant output, channel by channel.
    y: Vec<Signal>,
    /// Reference, one for each input; none without it.
    #[schemars(default)]
    r: Vec<Signal>,
    /// Position, one for each output; none without it.
    #[schemars(default)]
    position: Vec<Signal>,
    /// Clock of the player in a recording of a plan: its count of samples, unit `1`, or times that are added up.
    #[schemars(default)]
    plan_clock: Vec<Signal>,
    /// Number of the plan that was played, unit `1`.
    plan_id: Option<Signal>,
    /// Whether `u` was commanded or measured; measured without it.
    input_kind: Option<InputKind>,
    /// Column or array of the sample times of a CSV, MAT or NPZ, unit `s`, `ms`, `us` or `ns`.
    time: Option<Signal>,
    /// Sample time in s, where there are no sample times, or beside them where stamps leave it open.
    sample_time_s: Option<f64>,
    /// How a CSV is written; found in it without.
    csv: Option<CsvTable>,
    /// From when on the recordings are used, in s after their first sample.
    start_s: Option<f64>,
    /// Until when the recordings are used, in s after their first sample.
    end_s: Option<f64>,
    /// Period of the excitation in s; found in the reference without it.
    period_s: Option<f64>,
    /// Excited lines, as multiples of one over the period, rising; found without it.
    lines: Option<Vec<usize>>,
    /// Whether nothing repeats in the recordings; looked for without it.
    #[schemars(default)]
    aperiodic: bool,
    /// Realization of each run, in their order; by their order and their phases without it.
    realization_of: Option<Vec<usize>>,
}

/// One signal: where it comes from, its unit, its sign and scale.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields)]
#[expect(dead_code, reason = "read by nobody but the schema's derive")]
struct Signal {
    /// `TOPIC:FIELD[PLACE]` of an MCAP or a rosbag2, name of a column or array elsewhere.
    source: String,
    /// Unit in the recording: `rad`, `deg`, `rad/s`, `rpm`, `N m`, `A`, `%`, `counts`, ...
    unit: String,
    /// What 100 % is, `"5 N m"`, of a signal in `%`, or what 1 is of one in `pu`.
    full_scale: Option<String>,
    /// Counts of one turn, of a signal in `counts` or `counts/s`.
    counts_per_turn: Option<f64>,
    /// What results call it; its source without it.
    name: Option<String>,
    /// Factor on top of the unit, -1 for a sensor that counts the other way round; 1 without it.
    scale: Option<f64>,
}

/// Whether the plant input is what the controller commanded or what the drive measured.
#[derive(JsonSchema)]
#[schemars(rename_all = "kebab-case")]
#[expect(dead_code, reason = "read by nobody but the schema's derive")]
enum InputKind {
    /// The command, after limits and quantisation.
    Commanded,
    /// A measurement, with the sensor's noise.
    Measured,
}

/// How a CSV is written, where it is not to be guessed.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields)]
#[expect(dead_code, reason = "read by nobody but the schema's derive")]
struct CsvTable {
    /// What separates columns: `","`, `";"`, a tab, `"|"` or `" "`.
    separator: Option<char>,
    /// The decimal mark, `"."` or `","`.
    decimal: Option<char>,
    /// The line with the names of the columns, from 1; 0 where there is none.
    header_line: Option<usize>,
    /// The encoding: `"utf-8"`, `"utf-16le"`, `"windows-1252"`, ...
    encoding: Option<String>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::text::TomlText;

    /// The keys that the reader of a log map names when it meets one that it does not know.
    fn keys_of(text: &str) -> Vec<String> {
        let read = TomlText::new("x.toml", text).parse::<frfid_files::LogMap>();
        let message = read.expect_err("an unknown key").message;
        let (_, known) = message
            .split_once("expected one of ")
            .expect("it names them");
        let names = known.split('`').skip(1).step_by(2);
        let mut names: Vec<String> = names.map(str::to_owned).collect();
        names.sort();
        names
    }

    fn properties(schema: &Value) -> Vec<String> {
        let keys = schema["properties"].as_object().expect("an object").keys();
        let mut keys: Vec<String> = keys.cloned().collect();
        keys.sort();
        keys
    }

    #[test]
    fn the_schema_of_a_map_has_the_keys_that_are_read() {
        let schema = map_schema();
        assert_eq!(properties(&schema), keys_of("x = 1"));
        let signal = keys_of("u = [{ x = 1 }]");
        assert_eq!(properties(&schema["$defs"]["Signal"]), signal);
        let csv = keys_of("csv = { x = 1 }");
        assert_eq!(properties(&schema["$defs"]["CsvTable"]), csv);
        assert_eq!(schema["required"], serde_json::json!(["u", "y"]));
    }

    #[test]
    fn a_robot_file_names_no_other_file() {
        let schema = robot_schema();
        assert!(schema["properties"]["file"].is_null());
        assert!(schema["properties"]["body"].is_object());
    }
}
