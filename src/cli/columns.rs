//! Lists in columns without lines, as wide as the terminal.

use super::terminal::width;
use comfy_table::{ContentArrangement, Table, TableStyle};

/// An empty list.
pub(super) fn columns() -> Table {
    let mut table = Table::new();
    table.load_style(TableStyle::new()).set_content_arrangement(ContentArrangement::Dynamic).set_width(width());
    table
}

/// Its text, every line indented by `indent` and without trailing blanks.
pub(super) fn text(mut table: Table, indent: &str) -> String {
    /// Blanks between two columns.
    const GAP: u16 = 2;
    table.column_iter_mut().for_each(|column| {
        column.set_padding((0, GAP));
    });
    let lines: Vec<String> = table.lines().map(|line| format!("{indent}{}", line.trim_end())).collect();
    lines.join("\n")
}
