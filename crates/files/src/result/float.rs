//! Numbers in JSON, every `f64` there and back: JSON has no word for NaN and infinity, here they
//! are `null`, `"inf"`, `"-inf"`.

use std::fmt;

use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// One number.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Number(pub(crate) f64);

impl Serialize for Number {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0 {
            value if value.is_finite() => serializer.serialize_f64(value),
            value if value.is_nan() => serializer.serialize_unit(),
            value => serializer.serialize_str(if value > 0.0 { "inf" } else { "-inf" }),
        }
    }
}

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(AnyNumber)
    }
}

struct AnyNumber;

impl Visitor<'_> for AnyNumber {
    type Value = Number;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number, null for one that is not known, \"inf\" or \"-inf\"")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Number, E> {
        Ok(Number(value))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Number, E> {
        Ok(Number(value as f64))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Number, E> {
        Ok(Number(value as f64))
    }

    fn visit_unit<E: Error>(self) -> Result<Number, E> {
        Ok(Number(f64::NAN))
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<Number, E> {
        match value {
            "inf" => Ok(Number(f64::INFINITY)),
            "-inf" => Ok(Number(f64::NEG_INFINITY)),
            _ => Err(E::invalid_value(serde::de::Unexpected::Str(value), &self)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn there_and_back(value: f64) -> f64 {
        let text = serde_json::to_string(&Number(value)).expect("a number");
        serde_json::from_str::<Number>(&text).expect(&text).0
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn every_bit_pattern_comes_back(bits: u64) {
            let value = f64::from_bits(bits);
            let back = there_and_back(value);
            prop_assert!(back.to_bits() == bits || value.is_nan() && back.is_nan());
        }
    }

    #[test]
    fn the_special_ones_too() {
        for value in [
            0.0,
            -0.0,
            5e-324,
            -f64::MAX,
            f64::INFINITY,
            f64::NEG_INFINITY,
            1.0,
            1e22,
        ] {
            assert_eq!(there_and_back(value).to_bits(), value.to_bits());
        }
        assert!(there_and_back(f64::NAN).is_nan());
        let error = serde_json::from_str::<Number>("\"NaN\"").map(drop);
        let error = error.expect_err("NaN is null").to_string();
        assert!(error.contains("a number, null"), "{error}");
    }
}
