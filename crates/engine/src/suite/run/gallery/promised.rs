//! What is promised of each operation, beside what was measured.

use judge::profile::{Entry, Op, Promises};

/// One operation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Promised {
    /// Name, as profiles list it.
    pub op: &'static str,
    /// What the text of the specification promises.
    pub text: String,
    /// What the conformance suite accepts, where that is something else.
    pub conformance: Option<String>,
    /// What the device was measured to keep.
    pub measured: Option<String>,
}

/// Every operation of which anything is promised or measured.
pub fn promised(promises: &Promises) -> Vec<Promised> {
    let row = |op: Op| {
        let text = promises.text.entry(op).to_string();
        let conformance = promises.conformance.map(|profile| profile.entry(op).to_string());
        Promised {
            op: op.name(),
            conformance: conformance.filter(|accepted| *accepted != text),
            text,
            measured: promises.measured.as_ref().and_then(|profile| match profile.entry(op) {
                Entry::Measured(table) if table.samples > 0 => Some(accuracy(profile.entry(op))),
                Entry::Measured(_) | Entry::Promised(_) => None,
            }),
        }
    };
    Op::ALL.into_iter().map(row).collect()
}

/// A measurement with as many digits as it has.
fn accuracy(entry: &Entry) -> String {
    let Entry::Measured(table) = entry else { return entry.to_string() };
    let largest = table.max_ulp();
    let largest = match largest {
        0.0 => "0".to_owned(),
        ulp if ulp < 1000.0 => format!("{ulp:.2}"),
        ulp => format!("{ulp:.1e}"),
    };
    let by = table.definition.map_or_else(String::new, |definition| format!(", by {}", definition.text()));
    format!("{largest} ULP over {} samples{by}", table.samples)
}

#[cfg(test)]
mod tests {
    use super::*;
    use lanes::Api;

    #[test]
    fn every_operation_has_its_promise() {
        let rows = promised(&Promises::of_api(Api::Vulkan));
        assert_eq!(rows.len(), Op::ALL.len());
        let sin = rows.iter().find(|row| row.op == "sin").unwrap();
        assert!(!sin.text.is_empty() && sin.measured.is_none(), "{sin:?}");
        let measured = judge::profile::by_name("llvmpipe-22.3.6").cloned().map(std::sync::Arc::new);
        let rows = promised(&Promises { measured, ..Promises::of_api(Api::Vulkan) });
        let sin = rows.iter().find(|row| row.op == "sin").unwrap();
        assert!(sin.measured.as_ref().unwrap().contains(" ULP over "), "{sin:?}");
    }
}
