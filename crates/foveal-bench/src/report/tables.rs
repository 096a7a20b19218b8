//! A bench's figures and its commands, as the verdict and the sections show them.

use maud::{Markup, html};

use super::bench::Column;
use super::html::Figures;

/// Commands of the list at a pointer, one a line.
pub(super) fn commands(f: &Figures<'_>, list: &str) -> Markup {
    html! {
        p {
            @for index in 0..f.len(list) {
                code { (f.text(&format!("{list}/{index}"))) }
                br;
            }
        }
    }
}

/// The rows as a table: medians, and under them the passes' range where they differ.
pub(super) fn table(f: &Figures<'_>, at: &str, columns: &[Column]) -> Markup {
    let rows = f.len(&format!("{at}/rows"));
    html! {
        @if rows > 0 {
            h3 { "Ours, here" }
            .scroll {
                table {
                    tr {
                        th {}
                        @for column in columns {
                            th { (column.title) }
                        }
                    }
                    @for row in 0..rows {
                        tr {
                            td { (f.text(&format!("{at}/rows/{row}/label"))) }
                            @for column in columns {
                                td { (cell(f, &format!("{at}/rows/{row}"), column)) }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn cell(f: &Figures<'_>, row: &str, column: &Column) -> Markup {
    let figure = |pointer: &str| f.figure(pointer, column.factor, column.digits);
    let [least, most] = [0, 1].map(|i| format!("{row}/spread/{}/{i}", column.key));
    let has_range = f.number(&least).is_some() && f.number(&most).is_some();
    html! {
        (figure(&format!("{row}/{}", column.key)))
        @if has_range {
            br;
            small { (figure(&least)) " \u{2013} " (figure(&most)) }
        }
    }
}
