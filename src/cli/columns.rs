//! Lists in columns without lines, as wide as the terminal.

use super::terminal::width;
use comfy_table::{ContentArrangement, Table, TableStyle};

/// An empty list.
pub(super) fn columns() -> Table {
    let mut table = Table::new();
    table.load_style(TableStyle::new()).set_content_arrangement(ContentArrangement::Dynamic);
    table
}

/// Its text, every line indented by `indent` and without trailing blanks.
pub(super) fn text(mut table: Table, indent: &str) -> String {
    /// Blanks between two columns.
    const GAP: u16 = 2;
    table.set_width(width().saturating_sub(indent.len() as u16));
    table.column_iter_mut().for_each(|column| {
        column.set_padding((0, GAP));
    });
    let lines: Vec<String> = table.lines().map(|line| format!("{indent}{}", line.trim_end())).collect();
    lines.join("\n")
}

/// A sentence on lines of its own.
pub(super) fn paragraph(sentence: &str, indent: &str) -> String {
    let mut table = columns();
    table.add_row([sentence]);
    text(table, indent)
}
