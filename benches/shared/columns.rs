//! Tables as the benches print them.

use comfy_table::{CellAlignment, ContentArrangement, Row, Table, presets};

/// Returns an empty table, which Markdown reads too.
///
/// The first `words` columns hold words, the others numbers.
pub fn table(header: impl Into<Row>, words: usize) -> Table {
    let mut table = Table::new();
    table.load_style(presets::ASCII_MARKDOWN).set_content_arrangement(ContentArrangement::Disabled);
    table.set_header(header);
    for column in table.column_iter_mut().skip(words) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}

/// Formats a number with `decimals` decimals, or `None` as a dash.
pub fn decimal(number: Option<f64>, decimals: usize) -> String {
    number.map_or("-".into(), |number| format!("{number:.decimals$}"))
}
