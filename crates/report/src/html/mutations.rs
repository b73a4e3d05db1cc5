//! Results of mutation testing: which faults the suites did not notice.

use std::fmt::Write;

use serde_json::Value;

use super::escape::{Escaped, count};

/// The results, as `shadercheck mutate --format json` prints them. What is not there is left out.
pub(super) fn mutations(text: &mut String, results: &Value) {
    text.push_str(
        "<h2 id=\"mutations\">Faults that were put in</h2>\n<div class=\"wide\"><table><thead><tr><th>suite</th>\
         <th class=\"number\">faults</th><th class=\"number\">noticed</th><th class=\"number\">not noticed</th>\
         <th class=\"number\">moved nothing</th><th class=\"number\">score</th></tr></thead><tbody>",
    );
    let suites = results["suites"].as_array().map_or(&[][..], Vec::as_slice);
    for suite in suites {
        let score = &suite["score"];
        let n = |key: &str| count(score[key].as_u64().unwrap_or(0));
        let share =
            score["share"].as_f64().map_or_else(|| "–".to_owned(), |s| format!("{:.1} %", (s * 1000.0).floor() / 10.0));
        let _ = write!(
            text,
            "<tr><td>{}</td><td class=\"number\">{}</td><td class=\"number\">{}</td><td class=\"number\">{}</td>\
             <td class=\"number\">{}</td><td class=\"number\">{share}</td></tr>",
            Escaped(suite["suite"].as_str().unwrap_or_default()),
            n("mutants"),
            n("killed"),
            n("survived"),
            n("unmoved")
        );
    }
    text.push_str("</tbody></table></div>\n");
    for suite in suites {
        let name = suite["suite"].as_str().unwrap_or_default();
        let mutants = suite["mutants"].as_array().map_or(&[][..], Vec::as_slice);
        let left: Vec<&Value> = mutants.iter().filter(|m| m["outcome"] == "survived").collect();
        if left.is_empty() {
            continue;
        }
        let _ =
            write!(text, "<details class=\"plain\"><summary>{} not noticed by {}</summary>", left.len(), Escaped(name));
        for mutant in left {
            let word = |key: &str| mutant[key].as_str().unwrap_or_default().to_owned();
            let _ = write!(
                text,
                "<p>line {}: {}, {}</p><pre class=\"text\">{}</pre>",
                mutant["line"],
                Escaped(word("operator")),
                Escaped(word("what")),
                Escaped(word("diff"))
            );
        }
        text.push_str("</details>\n");
    }
}
