//! Tables.

use super::text::indexed;
use maud::{Markup, Render, html};

/// What stands in a cell without a value.
pub(crate) const NONE: &str = "\u{2013}";

/// The text of a value, or a dash.
pub(crate) fn or_dash<T>(value: Option<T>, show: impl FnOnce(T) -> String) -> String {
    value.map_or_else(|| NONE.to_owned(), show)
}

/// The head of a column; the letter after an underscore is an index.
#[derive(Debug, Clone, Copy)]
pub(crate) enum ColumnHead<'a> {
    Text(&'a str),
    /// Numbers stand at the right.
    Number(&'a str),
}

impl Render for ColumnHead<'_> {
    fn render(&self) -> Markup {
        match self {
            Self::Text(title) => html! { th scope="col" { (indexed(title)) } },
            Self::Number(title) => html! { th.n scope="col" { (indexed(title)) } },
        }
    }
}

/// A table whose rows are `body`.
pub(crate) fn table<'a>(
    caption: impl Render,
    columns: impl IntoIterator<Item = ColumnHead<'a>>,
    body: &Markup,
) -> Markup {
    let caption = caption.render();
    html! {
        div.scroll { table {
            @if !caption.0.is_empty() { caption { (caption) } }
            thead { tr { @for column in columns { (column) } } }
            tbody { (body) }
        } }
    }
}

/// A row of a table of results.
pub(crate) struct ResultRow {
    name: &'static str,
    value: String,
    unit: &'static str,
    note: String,
}

pub(crate) fn row(
    name: &'static str,
    value: String,
    unit: &'static str,
    note: impl Into<String>,
) -> ResultRow {
    ResultRow { name, value, unit, note: note.into() }
}

/// Quantities with their values.
pub(crate) fn results(caption: &str, rows: &[ResultRow]) -> Markup {
    html! {
        div.scroll {
            table.results {
                caption { (caption) }
                thead { tr { th scope="col" { "Quantity" } th.n scope="col" { "Value" } th scope="col" { "Unit" } th scope="col" { "Note" } } }
                tbody {
                    @for row in rows {
                        tr {
                            th scope="row" { (indexed(row.name)) }
                            td.n { (row.value) }
                            td { (row.unit) }
                            td { (row.note) }
                        }
                    }
                }
            }
        }
    }
}
