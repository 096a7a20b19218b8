//! Checks JSON against the part of JSON Schema that docs/stats.schema.json uses.

use serde_json::Value;

/// Everything in `value` that the schema does not allow, as sentences.
pub(crate) fn violations(schema: &Value, value: &Value) -> Vec<String> {
    let mut found = Vec::new();
    Checker {
        root: schema,
        found: &mut found,
    }
    .check(schema, value, "$");
    found
}

struct Checker<'a> {
    root: &'a Value,
    found: &'a mut Vec<String>,
}

impl Checker<'_> {
    fn check(&mut self, schema: &Value, value: &Value, place: &str) {
        for (keyword, rule) in schema.as_object().unwrap() {
            match keyword.as_str() {
                "$ref" => {
                    let name = rule.as_str().unwrap().strip_prefix("#/$defs/").unwrap();
                    let target = self.root["$defs"][name].clone();
                    self.check(&target, value, place);
                }
                "type" => self.expect(
                    is_type(rule.as_str().unwrap(), value),
                    place,
                    &format!("is not of type {rule}"),
                ),
                "const" => self.expect(value == rule, place, &format!("is not {rule}")),
                "enum" => self.expect(
                    rule.as_array().unwrap().contains(value),
                    place,
                    "is none of the choices",
                ),
                "minimum" => self.expect(
                    value.as_f64() >= rule.as_f64(),
                    place,
                    &format!("is below {rule}"),
                ),
                "maximum" => self.expect(
                    value.as_f64() <= rule.as_f64(),
                    place,
                    &format!("is above {rule}"),
                ),
                "required" => {
                    for name in rule.as_array().unwrap() {
                        let there = value.get(name.as_str().unwrap()).is_some();
                        self.expect(there, place, &format!("lacks {name}"));
                    }
                }
                "properties" => {
                    for (name, member) in value.as_object().unwrap() {
                        match rule.get(name) {
                            Some(schema) => self.check(schema, member, &format!("{place}.{name}")),
                            None => self.expect(
                                schema["additionalProperties"] != false,
                                place,
                                &format!("has {name}"),
                            ),
                        }
                    }
                }
                "items" => {
                    for (i, item) in value.as_array().unwrap().iter().enumerate() {
                        self.check(rule, item, &format!("{place}[{i}]"));
                    }
                }
                "$schema" | "$id" | "$defs" | "title" | "description" | "additionalProperties" => {}
                other => panic!("the checker does not know the keyword {other}"),
            }
        }
    }

    fn expect(&mut self, holds: bool, place: &str, otherwise: &str) {
        if !holds {
            self.found.push(format!("{place} {otherwise}"));
        }
    }
}

fn is_type(name: &str, value: &Value) -> bool {
    match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "number" => value.is_number(),
        "integer" => value.is_u64() || value.is_i64(),
        other => panic!("the checker does not know the type {other}"),
    }
}
