//! How numbers and foreign names are spelled for people.

/// A count in groups of three digits: `12 345`.
pub(super) fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

/// A number at three significant digits without an exponent: `0.00123`, `12.3`, `1234`; `0` is exactly zero.
pub(super) fn significant(value: f64) -> String {
    if value.abs() <= 0.0 {
        return "0".to_owned();
    }
    let decimals = (2.0 - value.abs().log10().floor()).clamp(0.0, 12.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// A share 0..=1 as per cent: `0.609 %`.
pub(super) fn percent(share: f64) -> String {
    format!("{} %", significant(100.0 * share))
}

/// What stands where a figure does not apply.
pub(super) const NOTHING: &str = "–";

/// The figure, or [`NOTHING`].
pub(super) fn or_nothing(figure: Option<String>) -> String {
    figure.unwrap_or_else(|| NOTHING.to_owned())
}

/// A foreign name without control characters, which could otherwise command a terminal or break a line.
pub(super) fn printable(name: &str) -> String {
    name.chars().map(|c| if c.is_control() { '\u{FFFD}' } else { c }).collect()
}

/// A technique's spelling or a sentence in lines of at most `width` characters, broken after commas and spaces; what has
/// neither within a line is broken anywhere.
pub(super) fn wrapped(text: &str, width: usize) -> Vec<String> {
    let width = width.max(1);
    let mut lines: Vec<Vec<char>> = vec![Vec::new()];
    for piece in text.split_inclusive([',', ' ']) {
        let piece: Vec<char> = piece.chars().collect();
        for part in piece.chunks(width) {
            match lines.last_mut() {
                Some(line) if line.len() + part.len() <= width => line.extend(part),
                _ => lines.push(part.to_vec()),
            }
        }
    }
    lines.into_iter().map(|line| line.into_iter().collect::<String>().trim_end().to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_grouped_from_the_right() {
        let texts = [0, 7, 999, 1000, 12_345, 1_048_576].map(grouped);
        assert_eq!(texts, ["0", "7", "999", "1 000", "12 345", "1 048 576"]);
    }

    #[test]
    fn numbers_keep_three_digits() {
        let texts = [0.0, 0.001_234_5, 12.345, 1234.5, 1.0, -0.25, 1e-9, 100.0, 0.1].map(significant);
        assert_eq!(texts, ["0", "0.00123", "12.3", "1234", "1", "-0.25", "0.000000001", "100", "0.1"]);
        assert_eq!(percent(0.006_091), "0.609 %");
    }

    #[test]
    fn lines_break_after_commas_and_spaces_first() {
        assert_eq!(wrapped("map:size=1024,filter=pcf-box3", 16), ["map:size=1024,", "filter=pcf-box3"]);
        assert_eq!(wrapped("a b c", 4), ["a b", "c"]);
        assert_eq!(wrapped("abcdefgh,i", 3), ["abc", "def", "gh,", "i"]);
        assert_eq!(wrapped("", 0), [""]);
    }

    #[test]
    fn control_characters_do_not_reach_a_terminal() {
        assert_eq!(printable("a\x1b[31m\nb"), "a\u{FFFD}[31m\u{FFFD}b");
        assert_eq!(printable("Küche"), "Küche");
    }
}
