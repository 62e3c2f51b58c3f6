//! A few ascending numbers as the value of one parameter, typed with slashes between them: `10/20/50`.

use std::fmt;

/// One to seven numbers, each larger than the one before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ascending {
    numbers: [f64; Self::MOST],
    count: usize,
}

impl Ascending {
    /// As many as there may be: between eight cascades.
    pub const MOST: usize = 7;

    /// Reads what is typed; `None` unless it is one to seven ascending numbers from `min` to `max`.
    #[must_use]
    pub fn parse(typed: &str, min: f64, max: f64) -> Option<Self> {
        let read: Option<Vec<f64>> = typed.split('/').map(|number| number.trim().parse().ok()).collect();
        let read = read.filter(|read| read.len() <= Self::MOST && read.is_sorted_by(|a, b| a < b))?;
        let mut numbers = [0.0; Self::MOST];
        numbers[..read.len()].copy_from_slice(&read);
        read.iter().all(|number| (min..=max).contains(number)).then_some(Self { numbers, count: read.len() })
    }

    /// The numbers.
    #[must_use]
    pub fn as_slice(&self) -> &[f64] {
        &self.numbers[..self.count]
    }
}

impl fmt::Display for Ascending {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let numbers: Vec<String> = self.as_slice().iter().map(f64::to_string).collect();
        f.write_str(&numbers.join("/"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ascending_numbers_are_read_back_as_they_are_spelled() {
        for typed in ["10", "0.5/1.25/1e3", "1/2/3/4/5/6/7"] {
            let read = Ascending::parse(typed, 0.1, 1e6).unwrap();
            assert_eq!(Ascending::parse(&read.to_string(), 0.1, 1e6), Some(read), "{typed}");
        }
        assert_eq!(Ascending::parse(" 10 / 20.50 ", 0.1, 1e6).unwrap().to_string(), "10/20.5");
    }

    #[test]
    fn all_else_is_refused() {
        for typed in ["", "/", "10/", "10/10", "20/10", "10/NaN", "0/10", "10/1e7", "10;20", "1/2/3/4/5/6/7/8", "inf"] {
            assert_eq!(Ascending::parse(typed, 0.1, 1e6), None, "{typed}");
        }
    }
}
