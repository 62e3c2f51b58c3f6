//! Parameters, declared once per technique: from the declaration come parsing, `list`, canonical names, sweeps.

use super::{Ascending, Spec};
use std::collections::BTreeSet;
use std::fmt;
use std::sync::{Mutex, PoisonError};

/// One parameter of a technique.
#[derive(Debug, Clone, PartialEq)]
pub struct Param {
    /// The key, with its unit in the name where it has one.
    pub name: &'static str,
    /// The unit in words; empty for a pure choice or number.
    pub unit: &'static str,
    /// What values it takes.
    pub kind: Kind,
    /// Its value when it is not typed.
    pub default: Value,
    /// One line of help.
    pub help: &'static str,
}

/// What values a parameter takes.
#[derive(Debug, Clone, PartialEq)]
pub enum Kind {
    /// One of these.
    Choice(Vec<Choice>),
    /// A whole number.
    Integer {
        /// Smallest legal value.
        min: i64,
        /// Largest legal value.
        max: i64,
    },
    /// A number; `auto` too if `auto` is true.
    Real {
        /// Smallest legal value.
        min: f64,
        /// Largest legal value.
        max: f64,
        /// Whether `auto` is legal.
        auto: bool,
    },
    /// A few ascending numbers with slashes between them, or `auto`.
    Ascending {
        /// Smallest legal number.
        min: f64,
        /// Largest legal number.
        max: f64,
    },
    /// Another technique, in parentheses: `(volume:count=z-fail)`.
    Technique,
}

/// One value of a choice; `pcf-box3` is the choice `pcf-box` with the number 3.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Choice {
    /// Its name.
    pub name: &'static str,
    /// The number that may trail it.
    pub number: Option<ChoiceNumber>,
}

/// The number that may trail a choice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ChoiceNumber {
    /// Smallest legal number.
    pub min: u32,
    /// Largest legal number.
    pub max: u32,
    /// The number when none is typed.
    pub default: u32,
}

/// A parameter's value. Its `Display` is the canonical spelling.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Value {
    /// A choice and its number.
    Choice(&'static str, Option<u32>),
    /// A whole number.
    Integer(i64),
    /// A number.
    Real(f64),
    /// A few numbers.
    Ascending(Ascending),
    /// Another technique's short spelling.
    Technique(&'static str),
    /// Left to gnomon.
    Auto,
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Choice(name, number) => {
                write!(f, "{name}")?;
                number.map_or(Ok(()), |number| write!(f, "{number}"))
            }
            Self::Integer(value) => write!(f, "{value}"),
            Self::Real(value) => write!(f, "{value}"),
            Self::Ascending(numbers) => write!(f, "{numbers}"),
            Self::Technique(spec) => write!(f, "({spec})"),
            Self::Auto => write!(f, "auto"),
        }
    }
}

impl Choice {
    /// A choice without a number.
    #[must_use]
    pub const fn plain(name: &'static str) -> Self {
        Self { name, number: None }
    }
}

impl Param {
    /// Reads a typed value.
    ///
    /// # Errors
    /// In one sentence, what would be legal.
    pub fn parse(&self, typed: &str) -> Result<Value, String> {
        match &self.kind {
            Kind::Choice(choices) => parse_choice(typed, choices),
            Kind::Integer { min, max } => typed
                .parse()
                .ok()
                .filter(|value| (*min..=*max).contains(value))
                .map(Value::Integer)
                .ok_or_else(|| format!("takes a whole number from {min} to {max}, not '{typed}'")),
            Kind::Technique => {
                let inside = typed.strip_prefix('(').and_then(|rest| rest.strip_suffix(')')).unwrap_or(typed);
                let spec = Spec::parse(inside).map_err(|error| format!("takes a technique in parentheses: {error}"))?;
                Ok(Value::Technique(interned(spec.short())))
            }
            Kind::Real { auto: true, .. } | Kind::Ascending { .. } if typed == "auto" => Ok(Value::Auto),
            Kind::Real { min, max, auto } => {
                typed.parse().ok().filter(|value| (*min..=*max).contains(value)).map(Value::Real).ok_or_else(|| {
                    let or_auto = if *auto { " or auto" } else { "" };
                    format!("takes a number from {} to {}{or_auto}, not '{typed}'", spelled(*min), spelled(*max))
                })
            }
            Kind::Ascending { min, max } => {
                Ascending::parse(typed, *min, *max).map(Value::Ascending).ok_or_else(|| {
                    let (most, min, max) = (Ascending::MOST, spelled(*min), spelled(*max));
                    format!("takes up to {most} ascending numbers from {min} to {max} as in 10/20/50, or auto, not '{typed}'")
                })
            }
        }
    }

    /// What values it takes, for `list`: `1..16384`, `nearest | pcf-box1..32`.
    #[must_use]
    pub fn range(&self) -> String {
        match &self.kind {
            Kind::Choice(choices) => choices.iter().map(Choice::spelling).collect::<Vec<_>>().join(" | "),
            Kind::Technique => "a technique in parentheses".to_owned(),
            Kind::Integer { min, max } => format!("{min}..{max}"),
            Kind::Real { min, max, auto } => {
                format!("{}..{}{}", spelled(*min), spelled(*max), if *auto { " | auto" } else { "" })
            }
            Kind::Ascending { min, max } => {
                format!("a/b/… ascending, {}..{} | auto", spelled(*min), spelled(*max))
            }
        }
    }
}

impl Choice {
    fn spelling(&self) -> String {
        self.number.map_or_else(|| self.name.to_owned(), |n| format!("{}{}..{}", self.name, n.min, n.max))
    }
}

/// A limit as people write it: with an exponent where there would be many zeros.
fn spelled(limit: f64) -> String {
    let has_many_zeros = limit.abs() >= 1e6 || (limit.abs() < 1e-3 && limit.abs() > 0.0);
    if has_many_zeros { format!("{limit:e}") } else { limit.to_string() }
}

/// The text for as long as the program runs: specifications are small and few, and their values are copied freely.
fn interned(text: String) -> &'static str {
    static KNOWN: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());
    // A thread that panicked while it held the set left it whole.
    let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(same) = known.get(text.as_str()) {
        return same;
    }
    let kept: &'static str = Box::leak(text.into_boxed_str());
    known.insert(kept);
    kept
}

fn parse_choice(typed: &str, choices: &[Choice]) -> Result<Value, String> {
    let legal = || {
        let spellings: Vec<String> = choices.iter().map(Choice::spelling).collect();
        let hint = crate::suggest::hint(typed, choices.iter().map(|c| c.name));
        format!("takes {}, not '{typed}'{hint}", spellings.join(", "))
    };
    if let Some(choice) = choices.iter().find(|choice| choice.name == typed) {
        return Ok(Value::Choice(choice.name, choice.number.map(|number| number.default)));
    }
    let digits = typed.len() - typed.trim_end_matches(|c: char| c.is_ascii_digit()).len();
    let (name, number) = typed.split_at(typed.len() - digits);
    choices
        .iter()
        .find(|choice| choice.name == name)
        .and_then(|choice| {
            let value = number.parse().ok()?;
            let legal = choice.number?;
            (legal.min..=legal.max).contains(&value).then_some(Value::Choice(choice.name, Some(value)))
        })
        .ok_or_else(legal)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filter() -> Param {
        let number = Some(ChoiceNumber { min: 1, max: 32, default: 3 });
        let choices = vec![Choice::plain("nearest"), Choice { name: "pcf-box", number }];
        let default = Value::Choice("nearest", None);
        Param { name: "filter", unit: "", kind: Kind::Choice(choices), default, help: "" }
    }

    #[test]
    fn the_trailing_number_is_optional_and_checked() {
        assert_eq!(filter().parse("pcf-box5"), Ok(Value::Choice("pcf-box", Some(5))));
        assert_eq!(filter().parse("pcf-box"), Ok(Value::Choice("pcf-box", Some(3))));
        assert!(filter().parse("pcf-box33").is_err());
        assert!(filter().parse("nearest2").is_err());
        assert!(filter().parse("pcf").unwrap_err().contains("pcf-box"));
    }

    #[test]
    fn limits_are_short_and_read_back_as_themselves() {
        for (limit, expected) in
            [(0.0, "0"), (0.01, "0.01"), (64.0, "64"), (1e4, "10000"), (-1e6, "-1e6"), (1e-12, "1e-12")]
        {
            assert_eq!(spelled(limit), expected);
            assert_eq!(spelled(limit).parse(), Ok(limit));
        }
    }

    #[test]
    fn lists_may_be_left_to_gnomon() {
        let param = Param { kind: Kind::Ascending { min: 1.0, max: 9.0 }, default: Value::Auto, ..filter() };
        assert_eq!(param.parse("auto"), Ok(Value::Auto));
        assert_eq!(param.parse("2/3.50").unwrap().to_string(), "2/3.5");
        assert!(param.parse("3/2").unwrap_err().contains("ascending numbers from 1 to 9"));
    }

    #[test]
    fn numbers_out_of_range_are_refused() {
        let param =
            Param { kind: Kind::Real { min: 0.0, max: 1.0, auto: false }, default: Value::Real(0.0), ..filter() };
        assert_eq!(param.parse("0.5"), Ok(Value::Real(0.5)));
        for wrong in ["-1", "NaN", "inf", "auto", "", "1e999"] {
            assert!(param.parse(wrong).is_err(), "{wrong}");
        }
    }
}
