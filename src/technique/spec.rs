//! Technique specifications: `family:axis=value,axis=value` as typed, and canonically with every parameter spelled out.

use super::preset::{PRESETS, expanded};
use super::{Ascending, Technique, registry};
use crate::suggest::hint;
use crate::technique::param::{Param, Value};
use std::fmt;

/// A technique with a value for each of its parameters. Its `Display` is the canonical spelling.
#[derive(Clone)]
pub struct Spec {
    /// What the user typed.
    pub typed: String,
    technique: &'static dyn Technique,
    values: Vec<(&'static str, Value)>,
}

/// Why a specification cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SpecError {
    /// No such family.
    #[error("unknown technique '{typed}'{hint}; 'gnomon list techniques' and 'gnomon list presets' show all")]
    Family {
        /// What was typed.
        typed: String,
        /// The nearest known one.
        hint: String,
    },
    /// The family has no such parameter.
    #[error("technique '{family}' has no parameter '{key}'{hint}; 'gnomon list techniques' shows all")]
    Key {
        /// The family.
        family: &'static str,
        /// What was typed.
        key: String,
        /// The nearest known one.
        hint: String,
    },
    /// A part is not `key=value`.
    #[error("'{part}' in '{typed}' is not key=value")]
    Grammar {
        /// The part.
        part: String,
        /// The whole.
        typed: String,
    },
    /// A key stands twice.
    #[error("'{key}' stands twice in '{typed}'")]
    Twice {
        /// The key.
        key: String,
        /// The whole.
        typed: String,
    },
    /// A value is not legal.
    #[error("'{key}' of '{family}' {why}")]
    Value {
        /// The family.
        family: &'static str,
        /// The parameter.
        key: &'static str,
        /// What would be legal.
        why: String,
    },
}

impl Spec {
    /// Reads `family`, `family:key=value,…` in any order of keys, or a preset; a value in parentheses may hold commas.
    ///
    /// # Errors
    /// [`SpecError`] says what is wrong and what would be right.
    pub fn parse(typed: &str) -> Result<Self, SpecError> {
        let trimmed = typed.trim();
        let preset = expanded(trimmed);
        let spelled = preset.as_deref().unwrap_or(trimmed);
        let (family, rest) = spelled.split_once(':').unwrap_or((spelled, ""));
        let technique = registry().iter().copied().find(|t| t.id() == family).ok_or_else(|| unknown(typed, family))?;
        let params = technique.params();
        let mut values: Vec<(&'static str, Value)> = params.iter().map(|p| (p.name, p.default)).collect();
        let mut seen = Vec::new();
        for part in parts(rest) {
            let grammar = || SpecError::Grammar { part: part.to_owned(), typed: typed.to_owned() };
            let (key, value) = part.split_once('=').ok_or_else(grammar)?;
            let (key, value) = (key.trim(), value.trim());
            let index = params.iter().position(|p| p.name == key).ok_or_else(|| SpecError::Key {
                family: technique.id(),
                key: key.to_owned(),
                hint: hint(key, params.iter().map(|p| p.name)),
            })?;
            if seen.contains(&index) {
                return Err(SpecError::Twice { key: key.to_owned(), typed: typed.to_owned() });
            }
            seen.push(index);
            let Param { name, .. } = params[index];
            values[index].1 = params[index].parse(value).map_err(|why| SpecError::Value {
                family: technique.id(),
                key: name,
                why,
            })?;
        }
        Ok(Self { typed: trimmed.to_owned(), technique, values })
    }

    /// The technique.
    #[must_use]
    pub fn technique(&self) -> &'static dyn Technique {
        self.technique
    }

    /// The same specification with one parameter changed, typed canonically.
    ///
    /// # Errors
    /// [`SpecError`] if there is no such parameter or the value is not legal.
    pub fn with(&self, key: &str, value: &str) -> Result<Self, SpecError> {
        let mut typed: Vec<String> =
            self.short_parts().into_iter().filter(|part| part.split('=').next() != Some(key)).collect();
        typed.push(format!("{key}={value}"));
        Self::parse(&format!("{}:{}", self.technique.id(), typed.join(",")))
    }

    /// "bias none → closed-form": the parameters in which another specification of the family differs.
    #[must_use]
    pub fn changes_to(&self, other: &Self) -> String {
        let changes = self.values.iter().zip(&other.values).filter(|(old, new)| old != new);
        changes.map(|((name, old), (_, new))| format!("{name} {old} → {new}")).collect::<Vec<_>>().join(", ")
    }

    /// Only the parameters that differ from their defaults.
    #[must_use]
    pub fn short(&self) -> String {
        let parts = self.short_parts();
        let colon = if parts.is_empty() { "" } else { ":" };
        format!("{}{colon}{}", self.technique.id(), parts.join(","))
    }

    fn short_parts(&self) -> Vec<String> {
        let defaults = self.technique.params().iter().map(|param| param.default);
        let changed = self.values.iter().zip(defaults).filter(|((_, value), default)| value != default);
        changed.map(|((name, value), _)| format!("{name}={value}")).collect()
    }

    fn value(&self, name: &str) -> Value {
        let found = self.values.iter().find(|(key, _)| *key == name);
        found.map_or_else(|| unreachable!("{name} is not declared by {}", self.technique.id()), |(_, value)| *value)
    }

    /// A declared choice and the number that trails it (1 if none does).
    #[must_use]
    pub fn choice(&self, name: &str) -> (&'static str, u32) {
        match self.value(name) {
            Value::Choice(choice, number) => (choice, number.unwrap_or(1)),
            other => unreachable!("{name}={other} is not declared as a choice"),
        }
    }

    /// A declared technique.
    #[must_use]
    pub fn nested(&self, name: &str) -> Self {
        let value = self.value(name);
        let Value::Technique(inner) = value else { unreachable!("{name}={value} is not declared as a technique") };
        Self::parse(inner).unwrap_or_else(|error| unreachable!("{inner} was parsed before: {error}"))
    }

    /// A declared whole number.
    #[must_use]
    pub fn integer(&self, name: &str) -> i64 {
        match self.value(name) {
            Value::Integer(value) => value,
            other => unreachable!("{name}={other} is not declared as an integer"),
        }
    }

    /// A declared number; `None` for `auto`.
    #[must_use]
    pub fn real_or_auto(&self, name: &str) -> Option<f64> {
        match self.value(name) {
            Value::Real(value) => Some(value),
            Value::Auto => None,
            other => unreachable!("{name}={other} is not declared as a number"),
        }
    }

    /// Declared ascending numbers; `None` for `auto`.
    #[must_use]
    pub fn ascending_or_auto(&self, name: &str) -> Option<Ascending> {
        match self.value(name) {
            Value::Ascending(numbers) => Some(numbers),
            Value::Auto => None,
            other => unreachable!("{name}={other} is not declared as ascending numbers"),
        }
    }

    /// A declared number that has no `auto`.
    #[must_use]
    pub fn real(&self, name: &str) -> f64 {
        self.real_or_auto(name).unwrap_or_else(|| unreachable!("{name} has no auto"))
    }
}

/// What was meant by a family or preset that is none.
fn unknown(typed: &str, family: &str) -> SpecError {
    let hint = if family == "preset" {
        let name = typed.split([':', ',']).nth(1).unwrap_or("");
        hint(name.trim(), PRESETS.iter().map(|preset| preset.name))
    } else {
        let short_names = PRESETS.iter().filter(|preset| preset.is_short_name).map(|preset| preset.name);
        hint(family, registry().iter().map(|t| t.id()).chain(short_names))
    };
    SpecError::Family { typed: typed.to_owned(), hint }
}

/// Splits at commas outside parentheses.
fn parts(rest: &str) -> Vec<&str> {
    let mut depth = 0_i32;
    let outside = |c: char| {
        depth += i32::from(c == '(') - i32::from(c == ')');
        c == ',' && depth == 0
    };
    rest.split(outside).filter(|part| !part.trim().is_empty()).collect()
}

impl PartialEq for Spec {
    /// Equal if the canonical spellings are; how they were typed does not matter.
    fn eq(&self, other: &Self) -> bool {
        self.technique.id() == other.technique.id() && self.values == other.values
    }
}

impl fmt::Display for Spec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts: Vec<String> = self.values.iter().map(|(name, value)| format!("{name}={value}")).collect();
        write!(f, "{}:{}", self.technique.id(), parts.join(","))
    }
}

impl fmt::Debug for Spec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Spec({self})")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn canonical_spelling_parses_back_to_itself() {
        let spec = Spec::parse("map:filter=pcf-box5,size=2048").unwrap();
        assert_eq!(Spec::parse(&spec.to_string()).unwrap().to_string(), spec.to_string());
        assert_eq!(spec.short(), "map:size=2048,filter=pcf-box5");
        assert_eq!(Spec::parse("map").unwrap().short(), "map");
    }

    #[test]
    fn one_parameter_can_be_changed() {
        let spec = Spec::parse("map:size=512,filter=pcf-box5").unwrap();
        assert_eq!(spec.with("size", "64").unwrap().short(), "map:size=64,filter=pcf-box5");
        assert!(spec.with("size", "0").is_err());
        assert_eq!(spec.changes_to(&spec.with("size", "64").unwrap()), "size 512 → 64");
    }

    #[test]
    fn mistakes_name_what_would_be_right() {
        let message = |typed: &str| Spec::parse(typed).unwrap_err().to_string();
        assert!(message("mpa").contains("did you mean 'map'"));
        assert!(message("map:sise=3").contains("did you mean 'size'"));
        assert!(message("map:size=0").contains("from 1 to 16384"));
        assert!(message("map:size").contains("not key=value"));
        assert!(message("map:size=1,size=2").contains("twice"));
    }
}
