//! Selector `topic:field[index or joint]`: one number in a decoded message.

use crate::ros::value::Value;

/// One step into a message.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Step {
    Field(String),
    Place(usize),
    Named(String),
}

impl Step {
    /// Whether it names something.
    fn is_sound(&self) -> bool {
        !matches!(self, Self::Field(name) | Self::Named(name) if name.is_empty())
    }
}

/// Where a signal is: its topic and the way into the message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Selector {
    pub(crate) topic: String,
    steps: Vec<Step>,
}

/// Fields that name the entries of the arrays beside or below them: JointState, control_msgs,
/// DynamicJointState.
const NAMES: [&str; 4] = ["name", "joint_names", "interface_names", "names"];

impl Selector {
    /// Reads `topic:field`, where the way into the message is made of `field`, `.field`, `[place]`
    /// and `[joint]`.
    pub(crate) fn parse(source: &str) -> Option<Self> {
        let (topic, way) = source.split_once(':')?;
        let steps = steps(way)?;
        let starts_well = !topic.is_empty() && matches!(steps.first(), Some(Step::Field(_)));
        (starts_well && steps.iter().all(Step::is_sound)).then(|| Self {
            topic: topic.into(),
            steps,
        })
    }

    /// The number in this message; `None` where the message does not have this joint or entry.
    pub(crate) fn pick(&self, message: &Value) -> Result<Option<f64>, String> {
        let mut at = message;
        let mut around = vec![message];
        for step in &self.steps {
            let place = match step {
                Step::Field(name) => {
                    at = at.field(name).ok_or_else(|| no_field(name, at))?;
                    around.push(at);
                    continue;
                }
                Step::Place(place) => Some(*place),
                Step::Named(name) => place_of(name, &around)?,
            };
            let Some(place) = place else { return Ok(None) };
            at = match at {
                Value::Numbers(numbers) if step == self.steps.last().unwrap_or(step) => {
                    return Ok(numbers.get(place).copied());
                }
                Value::List(list) => match list.get(place) {
                    Some(entry) => entry,
                    None => return Ok(None),
                },
                _ => return Err("no array to take an entry of".into()),
            };
            around.push(at);
        }
        at.number()
            .map(Some)
            .ok_or_else(|| "not a number; name an entry of it: field[0] or field[joint]".into())
    }
}

/// The steps of a way into a message; `None` for a bracket that is not closed.
fn steps(way: &str) -> Option<Vec<Step>> {
    let mut steps = Vec::new();
    let mut rest = way;
    while !rest.is_empty() {
        let (step, after) = match rest.strip_prefix('[') {
            Some(inside) => entry_step(inside)?,
            None => field_step(rest),
        };
        steps.push(step);
        rest = after.strip_prefix('.').unwrap_or(after);
    }
    Some(steps)
}

/// The step to a place or a name in brackets, of which the first is gone, and what follows it.
fn entry_step(inside: &str) -> Option<(Step, &str)> {
    let (name, after) = inside.split_once(']')?;
    let named = |_| Step::Named(name.into());
    Some((name.parse().map_or_else(named, Step::Place), after))
}

/// The step to a field, and what follows it.
fn field_step(way: &str) -> (Step, &str) {
    let (name, after) = way.split_at(way.find(['.', '[']).unwrap_or(way.len()));
    (Step::Field(name.into()), after)
}

fn no_field(name: &str, at: &Value) -> String {
    match at {
        Value::Message(fields) => {
            let names: Vec<_> = fields.iter().map(|(name, _)| name.as_str()).collect();
            format!("no field {name}; there are {}", names.join(", "))
        }
        _ => format!("no field {name}: this is no message"),
    }
}

/// The names of the entries of arrays beside or below a message, if it has any.
pub(crate) fn names_of(message: &Value) -> Option<Vec<String>> {
    let lists = NAMES.iter().filter_map(|names| message.field(names));
    let text = |value: &Value| match value {
        Value::Text(text) => Some(text.clone()),
        _ => None,
    };
    let texts = |list: &Value| match list {
        Value::List(list) => list.iter().map(text).collect::<Option<Vec<String>>>(),
        _ => None,
    };
    lists.filter_map(texts).find(|names| !names.is_empty())
}

/// The place of a joint in the nearest list of names that has it.
fn place_of(joint: &str, around: &[&Value]) -> Result<Option<usize>, String> {
    let lists = around.iter().rev();
    for list in lists.flat_map(|value| NAMES.iter().filter_map(|names| value.field(names))) {
        let Value::List(list) = list else { continue };
        let is_joint = |k: &usize| matches!(&list[*k], Value::Text(name) if name == joint);
        let mut places = (0..list.len()).filter(is_joint);
        match (places.next(), places.next()) {
            (None, _) => {}
            (place, None) => return Ok(place),
            _ => return Err(format!("the joint {joint} twice")),
        }
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(names: &[&str]) -> Value {
        Value::List(
            names
                .iter()
                .map(|name| Value::Text((*name).into()))
                .collect(),
        )
    }

    fn message(fields: Vec<(&str, Value)>) -> Value {
        Value::Message(
            fields
                .into_iter()
                .map(|(name, value)| (name.into(), value))
                .collect(),
        )
    }

    fn pick(source: &str, value: &Value) -> Result<Option<f64>, String> {
        Selector::parse(source).expect("sound").pick(value)
    }

    #[test]
    fn joint_states_by_place_and_by_name() {
        let state = message(vec![
            ("name", texts(&["a", "b"])),
            ("velocity", Value::Numbers(vec![1.0, 2.0])),
        ]);
        assert_eq!(pick("/js:velocity[1]", &state), Ok(Some(2.0)));
        assert_eq!(pick("/js:velocity[a]", &state), Ok(Some(1.0)));
        assert_eq!(pick("/js:velocity[c]", &state), Ok(None));
        assert_eq!(pick("/js:velocity[7]", &state), Ok(None));
        assert!(
            pick("/js:effort[0]", &state)
                .expect_err("no such field")
                .contains("name, velocity")
        );
        assert_eq!(
            pick("/js:velocity", &state),
            Err("not a number; name an entry of it: field[0] or field[joint]".into())
        );
        let twins = message(vec![
            ("name", texts(&["a", "a"])),
            ("velocity", Value::Numbers(vec![1.0, 2.0])),
        ]);
        assert_eq!(
            pick("/js:velocity[a]", &twins),
            Err("the joint a twice".into())
        );
    }

    #[test]
    fn names_further_out_and_dynamic_joint_states() {
        let inner = |value| {
            message(vec![
                ("interface_names", texts(&["p", "v"])),
                ("values", Value::Numbers(vec![0.0, value])),
            ])
        };
        let point = message(vec![("positions", Value::Numbers(vec![5.0, 6.0]))]);
        let state = message(vec![
            ("joint_names", texts(&["a", "b"])),
            ("reference", point),
            (
                "interface_values",
                Value::List(vec![inner(1.0), inner(2.0)]),
            ),
            ("speed", Value::Number(0.5)),
        ]);
        assert_eq!(pick("/s:reference.positions[b]", &state), Ok(Some(6.0)));
        assert_eq!(
            pick("/s:interface_values[b].values[v]", &state),
            Ok(Some(2.0))
        );
        assert_eq!(pick("/s:speed", &state), Ok(Some(0.5)));
    }

    #[test]
    fn nonsense_is_refused() {
        for source in [
            "velocity[0]",
            "/t:",
            ":a",
            "/t:a[",
            "/t:[0]",
            "/t:a[]",
            "/t:a..b",
        ] {
            assert_eq!(Selector::parse(source), None, "{source}");
        }
    }
}
