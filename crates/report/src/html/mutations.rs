//! Results of mutation testing: which faults the suites did not notice.

use maud::{Markup, html};
use serde_json::Value;

use super::text::count;

/// The results, as `shadercheck mutate --format json` prints them. What is not there is left out.
pub(super) fn mutations(results: &Value) -> Markup {
    let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
    let word = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let suites = list(&results["suites"]);
    html! {
        h2 id="mutations" { "Faults that were put in" }
        div.wide {
            table {
                thead {
                    tr {
                        th { "suite" }
                        @for name in ["faults", "noticed", "not noticed", "moved nothing", "score"] {
                            th.number { (name) }
                        }
                    }
                }
                tbody {
                    @for suite in &suites {
                        tr {
                            td { (word(&suite["suite"])) }
                            @for key in ["mutants", "killed", "survived", "unmoved"] {
                                td.number { (count(suite["score"][key].as_u64().unwrap_or(0))) }
                            }
                            td.number {
                                @match suite["score"]["share"].as_f64() {
                                    Some(share) => { (format!("{:.1} %", (share * 1000.0).floor() / 10.0)) }
                                    None => { "–" }
                                }
                            }
                        }
                    }
                }
            }
        }
        @for suite in &suites {
            @let mutants = list(&suite["mutants"]);
            @let left: Vec<&Value> = mutants.iter().filter(|m| m["outcome"] == "survived").collect();
            @if !left.is_empty() {
                details.plain {
                    summary { (left.len()) " not noticed by " (word(&suite["suite"])) }
                    @for mutant in left {
                        p {
                            "line " (mutant["line"].to_string()) ": " (word(&mutant["operator"])) ", "
                            (word(&mutant["what"]))
                        }
                        pre.text { (word(&mutant["diff"])) }
                    }
                }
            }
        }
    }
}
