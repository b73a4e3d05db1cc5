//! What each lane is, and what is promised of its operations beside what was measured.

use engine::suite::run::Promised;
use maud::{Markup, html};

use super::Page;

/// Lanes with their tables of operations.
pub(super) fn lanes(page: &Page<'_>) -> Markup {
    html! {
        @if !page.summary.lanes.is_empty() { h2 id="lanes" { "Lanes" } }
        @for used in &page.summary.lanes {
            @let (lane, against) = (&used.description, &used.against);
            @let promises: Vec<&str> =
                [&against.promise].into_iter().chain(&against.conformance).map(String::as_str).collect();
            h3 { (lane.name) }
            dl.facts {
                div { dt { "driver" } dd { (lane.driver) } }
                div { dt { "executes" } dd { (lane.executor) } }
                div { dt { "reads shaders" } dd { (lane.front_end) } }
                div { dt { "promises" } dd { (promises.join(", ")) } }
                div { dt { "measured" } dd { (against.measured.as_deref().unwrap_or("not")) } }
            }
            @if let Some((_, rows)) = page.promises.iter().find(|(name, _)| name == lane.name) {
                (operations(rows, &against.promise, against.conformance.as_deref()))
            }
        }
    }
}

/// What a lane promises of each operation.
fn operations(rows: &[Promised], promise: &str, conformance: Option<&str>) -> Markup {
    let measured = rows.iter().any(|row| row.measured.is_some());
    html! {
        details.plain {
            summary {
                "What is promised of " (rows.len()) " operations" @if measured { ", and what was measured" }
            }
            div.wide {
                table {
                    thead {
                        tr {
                            th { "operation" }
                            th { "promised by " (promise) }
                            @if let Some(suite) = conformance { th { "accepted by " (suite) } }
                            @if measured { th { "largest error measured" } }
                        }
                    }
                    tbody {
                        @for row in rows {
                            tr {
                                td.mono { (row.op) }
                                td { (row.text) }
                                @if conformance.is_some() { td { (row.conformance.as_deref().unwrap_or("the same")) } }
                                @if measured { td { (row.measured.as_deref().unwrap_or("–")) } }
                            }
                        }
                    }
                }
            }
        }
    }
}
