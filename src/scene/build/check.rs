//! Checks of single values, each error with the line the value stands on.

use super::{
    super::{
        error::{Place, SceneError},
        source::Source,
    },
    transform::{Frame, MAX_COORDINATE_M, unit},
};
use glam::{DVec3, Vec3};
use std::fmt::Display;

/// One table of a scene file (`light[1]`), for checks of its values.
pub(super) struct Entry<'a> {
    source: &'a Source,
    table: String,
}

impl<'a> Entry<'a> {
    /// The table of that path.
    pub(super) fn new(source: &'a Source, table: impl Into<String>) -> Self {
        Self { source, table: table.into() }
    }
    /// The keys outside all tables.
    pub(super) fn root(source: &'a Source) -> Self {
        Self::new(source, "")
    }

    fn path(&self, key: &str) -> String {
        if self.table.is_empty() { key.to_owned() } else { format!("{}.{key}", self.table) }
    }

    /// Where the key stands.
    pub(super) fn place(&self, key: &str) -> Place {
        self.source.place(&self.path(key))
    }

    /// An error about the key's value.
    pub(super) fn fault(&self, key: &str, problem: impl Display) -> SceneError {
        SceneError::Value { place: self.place(key), key: self.path(key), problem: problem.to_string() }
    }

    /// A finite number that `allowed` accepts; `range` says in words which those are.
    pub(super) fn number(
        &self,
        key: &str,
        value: f64,
        allowed: impl Fn(f64) -> bool,
        range: &str,
    ) -> Result<f64, SceneError> {
        if value.is_finite() && allowed(value) {
            return Ok(value);
        }
        Err(self.fault(key, format!("= {value}: must be {range}")))
    }

    /// Three finite numbers.
    pub(super) fn vector(&self, key: &str, value: [f64; 3]) -> Result<DVec3, SceneError> {
        let vector = DVec3::from_array(value);
        if vector.is_finite() {
            Ok(vector)
        } else {
            Err(self.fault(key, format!("= {value:?}: must be finite numbers")))
        }
    }

    /// A vector that is not zero, made a unit vector.
    pub(super) fn direction(&self, key: &str, value: [f64; 3]) -> Result<DVec3, SceneError> {
        let vector = self.vector(key, value)?;
        unit(vector).ok_or_else(|| self.fault(key, "= [0, 0, 0] points nowhere: must not be zero"))
    }

    /// A point of the file's world, in the rebased one, not yet rounded.
    pub(super) fn point(&self, key: &str, value: [f64; 3], frame: &Frame) -> Result<DVec3, SceneError> {
        let point = frame.point(self.vector(key, value)?);
        if point.abs().max_element() <= MAX_COORDINATE_M {
            return Ok(point);
        }
        let problem =
            format!("= {value:?}: lies over {MAX_COORDINATE_M:e} m from the meshes, too far for f32 arithmetic");
        Err(self.fault(key, problem))
    }

    /// Linear RGB of at least 0.
    pub(super) fn colour(&self, key: &str, value: [f64; 3]) -> Result<Vec3, SceneError> {
        let colour = self.vector(key, value)?.as_vec3();
        if colour.is_finite() && colour.min_element() >= 0.0 {
            return Ok(colour + Vec3::ZERO);
        }
        Err(self.fault(key, format!("= {value:?}: each number must be at least 0 and fit into f32")))
    }

    /// One of the known names.
    pub(super) fn known(&self, key: &str, what: &'static str, name: &str, known: &[&str]) -> Result<usize, SceneError> {
        known.iter().position(|candidate| *candidate == name).ok_or_else(|| SceneError::Unknown {
            place: self.place(key),
            what,
            name: name.to_owned(),
            known: known.iter().map(ToString::to_string).collect(),
        })
    }

    /// What the word stands for.
    pub(super) fn choice<T: Copy>(
        &self,
        key: &'static str,
        word: &str,
        choices: &[(&str, T)],
    ) -> Result<T, SceneError> {
        let known: Vec<&str> = choices.iter().map(|(name, _)| *name).collect();
        self.known(key, key, word, &known).map(|index| choices[index].1)
    }

    /// What the word stands for, if there is one.
    pub(super) fn choice_or_default<T: Copy + Default>(
        &self,
        key: &'static str,
        word: Option<&str>,
        choices: &[(&str, T)],
    ) -> Result<T, SceneError> {
        word.map_or(Ok(T::default()), |word| self.choice(key, word, choices))
    }
}
