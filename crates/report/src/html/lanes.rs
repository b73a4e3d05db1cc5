//! What each lane is, and what is promised of its operations beside what was measured.

use std::fmt::Write;

use super::Page;
use super::escape::Escaped;

/// Lanes with their tables of operations.
pub(super) fn lanes(text: &mut String, page: &Page<'_>) {
    if page.summary.lanes.is_empty() {
        return;
    }
    text.push_str("<h2 id=\"lanes\">Lanes</h2>\n");
    for used in &page.summary.lanes {
        let (lane, against) = (&used.description, &used.against);
        let promises: Vec<&str> =
            [&against.promise].into_iter().chain(&against.conformance).map(String::as_str).collect();
        let _ = writeln!(
            text,
            "<h3>{}</h3><dl class=\"facts\"><div><dt>driver</dt><dd>{}</dd></div><div><dt>executes</dt><dd>{}</dd></div>\
             <div><dt>reads shaders</dt><dd>{}</dd></div><div><dt>promises</dt><dd>{}</dd></div>\
             <div><dt>measured</dt><dd>{}</dd></div></dl>",
            Escaped(lane.name),
            Escaped(&lane.driver),
            Escaped(&lane.executor),
            Escaped(&lane.front_end),
            Escaped(promises.join(", ")),
            Escaped(against.measured.as_deref().unwrap_or("not"))
        );
        let Some((_, rows)) = page.promises.iter().find(|(name, _)| name == lane.name) else { continue };
        let measured = rows.iter().any(|row| row.measured.is_some());
        let _ = write!(
            text,
            "<details class=\"plain\"><summary>What is promised of {} operations{}</summary><div class=\"wide\"><table><thead><tr>\
             <th>operation</th><th>promised by {}</th>",
            rows.len(),
            if measured { ", and what was measured" } else { "" },
            Escaped(&against.promise)
        );
        if let Some(suite) = &against.conformance {
            let _ = write!(text, "<th>accepted by {}</th>", Escaped(suite));
        }
        if measured {
            text.push_str("<th>largest error measured</th>");
        }
        text.push_str("</tr></thead><tbody>");
        for row in rows {
            let _ = write!(text, "<tr><td class=\"mono\">{}</td><td>{}</td>", Escaped(row.op), Escaped(&row.text));
            if against.conformance.is_some() {
                let _ = write!(text, "<td>{}</td>", Escaped(row.conformance.as_deref().unwrap_or("the same")));
            }
            if measured {
                let _ = write!(text, "<td>{}</td>", Escaped(row.measured.as_deref().unwrap_or("–")));
            }
            text.push_str("</tr>");
        }
        text.push_str("</tbody></table></div></details>\n");
    }
}
