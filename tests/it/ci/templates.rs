//! The forms for issues have the keys that GitHub knows, and what they require can be filled in.

use std::fs;

use serde::Deserialize;

use crate::binary::root;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Form {
    name: String,
    description: String,
    #[serde(default)]
    #[expect(dead_code, reason = "only its type is looked at")]
    labels: Vec<String>,
    body: Vec<Question>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Question {
    #[serde(rename = "type")]
    #[expect(dead_code, reason = "only its type is looked at")]
    element: Element,
    id: String,
    attributes: Attributes,
    #[serde(default)]
    validations: Validations,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Element {
    Input,
    Textarea,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Attributes {
    label: String,
    #[expect(dead_code, reason = "only its type is looked at")]
    description: Option<String>,
    #[expect(dead_code, reason = "only its type is looked at")]
    placeholder: Option<String>,
    #[expect(dead_code, reason = "only its type is looked at")]
    render: Option<String>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Validations {
    required: bool,
}

/// What is wrong with a form.
fn faults(text: &str) -> Vec<String> {
    let form = match serde_norway::from_str::<Form>(text) {
        Ok(form) => form,
        Err(error) => return vec![error.to_string()],
    };
    let mut faults = Vec::new();
    if form.name.is_empty() || form.description.is_empty() {
        faults.push("it says nothing of itself".to_owned());
    }
    for (k, question) in form.body.iter().enumerate() {
        let same = |other: &Question| other.id == question.id || other.attributes.label == question.attributes.label;
        if form.body[..k].iter().any(same) {
            faults.push(format!("two questions are called `{}`", question.id));
        }
    }
    if !form.body.iter().any(|question| question.validations.required) {
        faults.push("it asks for nothing".to_owned());
    }
    faults
}

#[test]
fn forms_have_keys_that_are_known() {
    let folder = root().join(".github/ISSUE_TEMPLATE");
    let mut forms = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.file_name().unwrap() != "config.yml" {
            assert_eq!(faults(&fs::read_to_string(&path).unwrap()), Vec::<String>::new(), "{}", path.display());
            forms += 1;
        }
    }
    assert_eq!(forms, 4);
}

#[test]
fn planted_faults_in_a_form_are_reported() {
    let text = fs::read_to_string(root().join(".github/ISSUE_TEMPLATE/false-accusation.yml")).unwrap();
    for (from, to, part) in [
        ("required: true", "require: true", "unknown field `require`"),
        ("type: textarea", "type: textbox", "unknown variant `textbox`"),
        ("id: shader", "id: finding", "two questions are called `finding`"),
        ("required: true", "required: false", ""),
    ] {
        let faults = faults(&text.replace(from, to));
        assert!(faults.iter().any(|fault| fault.contains(part)), "`{to}`: {faults:?}");
    }
}
