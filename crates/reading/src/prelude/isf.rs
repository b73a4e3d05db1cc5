//! What a shader in the Interactive Shader Format declares in the JSON in front of it: inputs, passes and pictures
//! (<https://docs.isf.video/ref_json.html>). The host makes uniforms of them.

use serde_json::Value;

/// The lines of GLSL that a host puts in front for the JSON of a text, with the ranges that inputs state; none for a text
/// without such JSON.
pub fn declarations(text: &str) -> Option<Vec<String>> {
    let header = header(text)?;
    let mut lines = Vec::new();
    for input in array(&header, "INPUTS") {
        let (Some(name), Some(kind)) = (name_of(input, "NAME"), input.get("TYPE").and_then(Value::as_str)) else {
            continue;
        };
        let number = |key: &str| input.get(key).and_then(Value::as_f64);
        let range = match kind {
            "float" | "long" => number("MIN").zip(number("MAX")),
            "color" => Some((0.0, 1.0)),
            _ => None,
        };
        let stated = range.filter(|(low, high)| low < high);
        let stated = stated.map(|(low, high)| format!(" // shadercheck: {name} in [{low}, {high}]"));
        lines.push(format!("uniform {} {name};{}", glsl_type(kind), stated.unwrap_or_default()));
    }
    let sampler = |name: &str| format!("uniform sampler2D {name};");
    lines.extend(array(&header, "PASSES").filter_map(|pass| name_of(pass, "TARGET")).map(sampler));
    lines.extend(array(&header, "IMPORTED").filter_map(|picture| name_of(picture, "NAME")).map(sampler));
    // Before version 2, pictures and buffers that are kept stood under their names, or as plain names.
    for key in ["IMPORTED", "PERSISTENT_BUFFERS"] {
        let named = header.get(key).and_then(Value::as_object).into_iter().flatten().map(|(name, _)| name.as_str());
        let plain = array(&header, key).filter_map(Value::as_str);
        lines.extend(named.chain(plain).filter(|name| is_name(name)).map(sampler));
    }
    // A pass may write what an input is named.
    let mut seen = std::collections::HashSet::new();
    lines.retain(|line| seen.insert(line.clone()));
    Some(lines)
}

/// The JSON in the comment at the beginning of a text.
fn header(text: &str) -> Option<Value> {
    // Lines of comment may stand in front.
    let is_code = |line: &&str| !line.trim().is_empty() && !line.trim_start().starts_with("//");
    let first = text.trim_start_matches('\u{feff}').lines().find(is_code)?;
    let comment = text[text.find(first)?..].trim_start().strip_prefix("/*")?;
    let comment = &comment[..comment.find("*/")?];
    let json = comment.get(comment.find('{')?..=comment.rfind('}')?)?;
    let header: Value =
        serde_json::from_str(json).or_else(|_| serde_json::from_str(&without_last_commas(json))).ok()?;
    ["INPUTS", "ISFVSN", "PASSES", "CATEGORIES"].iter().any(|key| header.get(key).is_some()).then_some(header)
}

/// JSON without the commas behind last elements, which hosts read over.
fn without_last_commas(json: &str) -> String {
    let mut parts = json.split(',').peekable();
    let mut out = String::new();
    while let Some(part) = parts.next() {
        out.push_str(part);
        let is_last = parts.peek().is_none_or(|next| next.trim_start().starts_with(['}', ']']));
        if !is_last {
            out.push(',');
        }
    }
    out
}

fn array<'v>(header: &'v Value, key: &str) -> impl Iterator<Item = &'v Value> {
    header.get(key).and_then(Value::as_array).into_iter().flatten()
}

fn name_of<'v>(value: &'v Value, key: &str) -> Option<&'v str> {
    value.get(key)?.as_str().filter(|name| is_name(name))
}

fn is_name(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

fn glsl_type(kind: &str) -> &'static str {
    match kind {
        "event" | "bool" => "bool",
        "long" => "int",
        "point2D" => "vec2",
        "color" => "vec4",
        "image" | "audio" | "audioFFT" => "sampler2D",
        "cube" => "samplerCube",
        _ => "float",
    }
}

#[cfg(test)]
mod tests {
    use super::declarations;

    #[test]
    fn inputs_passes_and_pictures_are_declared() {
        let text = r#"/*{ "ISFVSN": "2", "INPUTS": [
            { "NAME": "inputImage", "TYPE": "image" },
            { "NAME": "amount", "TYPE": "float", "MIN": 0, "MAX": 2.5, "DEFAULT": 1 },
            { "NAME": "tint", "TYPE": "color" }, { "NAME": "at", "TYPE": "point2D" },
            { "NAME": "mode", "TYPE": "long", "VALUES": [0, 1] }, { "NAME": "go", "TYPE": "event" }, { "TYPE": "float" } ],
            "PASSES": [ { "TARGET": "kept", "PERSISTENT": true }, {} ], "IMPORTED": { "noise": { "PATH": "n.png" } } }*/
            void main() {}"#;
        let expected = [
            "uniform sampler2D inputImage;",
            "uniform float amount; // shadercheck: amount in [0, 2.5]",
            "uniform vec4 tint; // shadercheck: tint in [0, 1]",
            "uniform vec2 at;",
            "uniform int mode;",
            "uniform bool go;",
            "uniform sampler2D kept;",
            "uniform sampler2D noise;",
        ];
        assert_eq!(declarations(text).unwrap(), expected);
    }

    #[test]
    fn hands_that_wrote_the_json_are_forgiven() {
        let text = "// A name\n\n/*{ \"INPUTS\": [ { \"NAME\": \"a\", \"TYPE\": \"float\", }, ], }*/\nvoid main() {}";
        assert_eq!(declarations(text).unwrap(), ["uniform float a;"]);
        assert_eq!(declarations(&format!("void f() {{}}\n{text}")), None, "it does not stand in front");
    }

    #[test]
    fn other_comments_declare_nothing() {
        for text in ["void main() {}", "/* { a comment } */", "/*{ \"name\": \"x\" }*/", "// {\"INPUTS\": []}", "/*{"] {
            assert_eq!(declarations(text), None, "{text}");
        }
        // What is no name is left to be told as missing.
        let odd = "/*{ \"INPUTS\": [{ \"NAME\": \"a b\", \"TYPE\": \"float\" }] }*/";
        assert_eq!(declarations(odd).unwrap(), [""; 0]);
    }
}
