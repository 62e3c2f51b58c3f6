//! `gnomon list --matrix`: which technique handles which kind of light and what it needs, as a Markdown table, the one
//! of docs/matrix.md.

use super::context::open_gpu;
use super::terminal::say;
use crate::technique::{MatrixRow, light_kinds, matrix};

pub(super) fn print() -> anyhow::Result<()> {
    let gpu = open_gpu()?;
    say(&markdown(&light_kinds(), &matrix(&gpu)));
    Ok(())
}

/// The table, then the reasons for each "no" by number.
fn markdown(kinds: &[&str], rows: &[MatrixRow]) -> String {
    let mut reasons: Vec<&str> = Vec::new();
    let mut lines = vec![format!("| technique | {} | needs |", kinds.join(" | "))];
    lines.push(format!("|---|{}", "---|".repeat(kinds.len() + 1)));
    for row in rows {
        let cells = row.handles.iter().map(|handled| match handled {
            Ok(()) => "yes".to_owned(),
            Err(why) => {
                let at = reasons.iter().position(|known| known == why).unwrap_or(reasons.len());
                if at == reasons.len() {
                    reasons.push(why);
                }
                format!("no ({})", at + 1)
            }
        });
        let cells: Vec<String> = cells.collect();
        lines.push(format!("| `{}` | {} | {} |", row.spec, cells.join(" | "), row.needs.join(", ")));
    }
    if !reasons.is_empty() {
        lines.push(String::new());
    }
    lines.extend(reasons.iter().enumerate().map(|(at, why)| format!("{}. {why}", at + 1)));
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_reasons_share_a_number() {
        let row = |spec: &str, handles: [Result<(), &str>; 2]| MatrixRow {
            spec: spec.to_owned(),
            handles: handles.into_iter().map(|handled| handled.map_err(str::to_owned)).collect(),
            needs: vec!["a sky"],
        };
        let rows = [row("a", [Ok(()), Err("why")]), row("b", [Err("why"), Err("why not")])];
        let expected = "| technique | x | y | needs |\n|---|---|---|---|\n| `a` | yes | no (1) | a sky |\n\
                        | `b` | no (1) | no (2) | a sky |\n\n1. why\n2. why not";
        assert_eq!(markdown(&["x", "y"], &rows), expected);
    }
}
