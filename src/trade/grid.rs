//! Grids of configurations: `map:size=256..4096,filter=nearest|pcf-box3` is every combination of its values.
//!
//! `a..b` doubles from a up to b, `|` separates values, both outside parentheses only. What an axis may be called and
//! which values are legal is the technique's own declaration.

use crate::technique::{Spec, SpecError};
use std::collections::HashSet;

/// Most configurations of one sweep: weeks of work, and surely a typing mistake.
const MOST: usize = 20_000;

/// Why a grid is none.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum GridError {
    /// One of its configurations is not legal.
    #[error("grid '{grid}': {why}")]
    Spec {
        /// The grid as typed.
        grid: String,
        /// What is wrong with the configuration.
        #[source]
        why: SpecError,
    },
    /// A range that holds nothing.
    #[error("grid '{grid}': '{range}' is no range: a..b doubles from a whole number a > 0 up to b >= a")]
    Range {
        /// The grid as typed.
        grid: String,
        /// The range.
        range: String,
    },
    /// Too many combinations.
    #[error("grid '{grid}' has more than {MOST} configurations")]
    TooMany {
        /// The grid as typed.
        grid: String,
    },
}

/// Every configuration of some grids, each once, the last axis running fastest.
///
/// # Errors
/// [`GridError`] names the grid and what is wrong with it.
pub fn specs_of_grids(grids: &[String]) -> Result<Vec<Spec>, GridError> {
    let mut specs: Vec<Spec> = Vec::new();
    let mut known: HashSet<String> = HashSet::new();
    for grid in grids {
        for typed in combinations(grid)? {
            // Spelled shortly: a grid names defaults, too, which rows need not repeat.
            let spec = Spec::parse(&typed).and_then(|spec| Spec::parse(&spec.short()));
            let spec = spec.map_err(|why| GridError::Spec { grid: grid.clone(), why })?;
            if known.insert(spec.to_string()) {
                specs.push(spec);
            }
        }
    }
    Ok(specs)
}

fn combinations(grid: &str) -> Result<Vec<String>, GridError> {
    let (family, rest) = grid.split_once(':').unwrap_or((grid, ""));
    let mut combined = vec![String::new()];
    for axis in split_outside(rest, ',').into_iter().filter(|axis| !axis.trim().is_empty()) {
        // What is no key=value is left for the specification's own error message.
        let (key, values) = axis.split_once('=').map_or((axis, None), |(key, values)| (key, Some(values)));
        let spelled = match values {
            None => vec![key.to_owned()],
            Some(values) => values_of(grid, values)?.into_iter().map(|value| format!("{key}={value}")).collect(),
        };
        if combined.len() * spelled.len() > MOST {
            return Err(GridError::TooMany { grid: grid.to_owned() });
        }
        let with = |start: &String| -> Vec<String> {
            let comma = if start.is_empty() { "" } else { "," };
            spelled.iter().map(|part| format!("{start}{comma}{part}")).collect()
        };
        combined = combined.iter().flat_map(with).collect();
    }
    let colon = |rest: &String| if rest.is_empty() { "" } else { ":" };
    Ok(combined.iter().map(|rest| format!("{}{}{rest}", family.trim(), colon(rest))).collect())
}

fn values_of(grid: &str, values: &str) -> Result<Vec<String>, GridError> {
    let mut all = Vec::new();
    for value in split_outside(values, '|') {
        match value.split_once("..").filter(|_| !value.contains('(')) {
            None => all.push(value.trim().to_owned()),
            Some((from, to)) => {
                let bad = || GridError::Range { grid: grid.to_owned(), range: value.to_owned() };
                let number = |text: &str| text.trim().parse::<u32>().map_err(|_| bad());
                let (from, to) = (number(from)?, number(to)?);
                if from == 0 || to < from {
                    return Err(bad());
                }
                let doubled = std::iter::successors(Some(from), |n| n.checked_mul(2));
                all.extend(doubled.take_while(|n| *n <= to).map(|n| n.to_string()));
            }
        }
    }
    Ok(all)
}

/// Splits at a character outside parentheses, however deeply they nest.
fn split_outside(text: &str, separator: char) -> Vec<&str> {
    let mut depth = 0_i32;
    text.split(|c: char| {
        depth += i32::from(c == '(') - i32::from(c == ')');
        c == separator && depth == 0
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shorts(grids: &[&str]) -> Vec<String> {
        let grids: Vec<String> = grids.iter().map(|grid| (*grid).to_owned()).collect();
        specs_of_grids(&grids).unwrap().iter().map(Spec::short).collect()
    }

    fn refusal(grid: &str) -> String {
        specs_of_grids(&[grid.to_owned()]).unwrap_err().to_string()
    }

    #[test]
    fn ranges_double_and_lists_combine_in_order() {
        assert_eq!(shorts(&["map:size=256..4096"]).len(), 5);
        assert_eq!(
            shorts(&["map:size=256..512,filter=nearest|pcf-box3", "volume:count=z-pass|z-fail"]),
            [
                "map:size=256",
                "map:size=256,filter=pcf-box3",
                "map:size=512",
                "map:size=512,filter=pcf-box3",
                "volume:count=z-pass",
                "volume",
            ]
        );
        // A range ends at the last doubling; a list may mix both; a configuration stands once.
        assert_eq!(
            shorts(&["map:size=100..500|128", "map:size=128"]),
            ["map:size=100", "map:size=200", "map:size=400", "map:size=128"]
        );
        assert_eq!(shorts(&["map"]), ["map"]);
    }

    #[test]
    fn parentheses_keep_what_is_inside_together() {
        assert_eq!(split_outside("a=(b|c,(d,e)),f=g", ','), ["a=(b|c,(d,e))", "f=g"]);
        assert_eq!(combinations("x:a=(1|2,b=3..4)|c").unwrap(), ["x:a=(1|2,b=3..4)", "x:a=c"]);
    }

    #[test]
    fn what_is_wrong_is_said_with_the_grid() {
        assert!(refusal("map:size=9..3").contains("'9..3' is no range"));
        assert!(refusal("map:size=0..3").contains("'0..3' is no range"));
        assert!(refusal("map:size=a..b").contains("'a..b' is no range"));
        assert!(
            refusal("map:size=512,filters=nearest")
                .starts_with("grid 'map:size=512,filters=nearest': technique 'map' has no parameter 'filters'")
        );
        assert!(refusal("map:size=1..16384,bias_constant_ulps=1..65536,bias_slope=1..64,fit_margin_texels=1..8,bias_cap_texels=1..8192").contains("more than"));
    }
}
