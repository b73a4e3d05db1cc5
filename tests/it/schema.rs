//! JSON Schema, as much of it as the schemas in `docs` use.

use serde_json::Value;

/// The part of JSON Schema that ours uses.
pub(crate) fn conforms(root: &Value, schema: &Value, value: &Value, at: &str, faults: &mut Vec<String>) {
    if let Some(reference) = schema["$ref"].as_str() {
        return conforms(root, root.pointer(&reference[1..]).unwrap(), value, at, faults);
    }
    if let Some(any) = schema["anyOf"].as_array() {
        let fits = any.iter().any(|schema| {
            let mut own = Vec::new();
            conforms(root, schema, value, at, &mut own);
            own.is_empty()
        });
        if !fits {
            faults.push(format!("{at}: {value} fits none of the forms"));
        }
        return;
    }
    let is = |name: &str| match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "integer" => value.is_u64() || value.is_i64(),
        "number" => value.is_number(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        other => panic!("the schema has a type `{other}`"),
    };
    let typed = match &schema["type"] {
        Value::String(name) => is(name),
        Value::Array(names) => names.iter().any(|name| is(name.as_str().unwrap())),
        _ => true,
    };
    let listed = schema["enum"].as_array().is_none_or(|list| list.contains(value));
    let fixed = schema.get("const").is_none_or(|only| only == value);
    let least = schema["minimum"].as_f64().is_none_or(|least| value.as_f64().is_none_or(|x| x >= least));
    let pattern = schema["pattern"].as_str().is_none_or(|pattern| match (pattern, value.as_str()) {
        (_, None) => true,
        ("^[0-9a-f]{64}$", Some(text)) => text.len() == 64 && text.bytes().all(|b| b.is_ascii_hexdigit()),
        ("^([0-9a-f]{4}|[0-9a-f]{8}|[0-9a-f]{16})$", Some(text)) => {
            [4, 8, 16].contains(&text.len()) && text.bytes().all(|b| b.is_ascii_hexdigit())
        }
        ("^0x[0-9a-f]{8}$", Some(text)) => {
            text.len() == 10 && text.starts_with("0x") && text.bytes().skip(2).all(|b| b.is_ascii_hexdigit())
        }
        ("^[0-9]+$", Some(text)) => text.bytes().all(|b| b.is_ascii_digit()),
        ("^1\\.[0-9]+$", Some(text)) => text.starts_with("1."),
        (other, _) => panic!("the schema has a pattern `{other}`"),
    });
    if !(typed && listed && fixed && least && pattern) {
        faults.push(format!("{at}: {value} does not fit"));
        return;
    }
    if let Some(members) = value.as_object() {
        for name in schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str) {
            if !members.contains_key(name) {
                faults.push(format!("{at}: `{name}` is missing"));
            }
        }
        for (name, member) in members {
            let below = format!("{at}/{name}");
            match (schema["properties"].get(name), &schema["additionalProperties"]) {
                (Some(schema), _) => conforms(root, schema, member, &below, faults),
                (None, Value::Bool(false)) => faults.push(format!("{below} is not known")),
                (None, other @ Value::Object(_)) => conforms(root, other, member, &below, faults),
                (None, _) => {}
            }
        }
    }
    if let (Some(list), Some(items)) = (value.as_array(), schema.get("items")) {
        for (k, item) in list.iter().enumerate() {
            conforms(root, items, item, &format!("{at}/{k}"), faults);
        }
    }
}

/// The schema with objects that may have the listed members alone: what a schema leaves open for later versions is
/// closed for this one.
pub(crate) fn closed(mut schema: Value) -> Value {
    match &mut schema {
        Value::Object(members) => {
            members.values_mut().for_each(|member| *member = closed(member.take()));
            if members.get("type") == Some(&"object".into()) && members.contains_key("properties") {
                members.insert("additionalProperties".to_owned(), false.into());
            }
        }
        Value::Array(items) => items.iter_mut().for_each(|item| *item = closed(item.take())),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
    }
    schema
}
