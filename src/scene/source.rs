//! The text of a scene file and the line of every key in it, so that a check made long after parsing can still say
//! where the value stands.
//!
//! Unknown keys are found here, before serde sees the text, because serde's own message cannot name the nearest known
//! key. The known keys are the fields of the structs in [`mod@super::file`]; there is no second list to keep in step.

use super::{
    error::{Place, SceneError},
    file::{BudgetEntry, CameraEntry, LightEntry, MeshEntry, PlaneEntry, SceneFile},
};
use serde::{
    Deserialize, Deserializer,
    de::{Error as _, Visitor, value::Error as Caught},
    forward_to_deserialize_any,
};
use std::{
    collections::HashMap,
    path::{Path, PathBuf},
};
use toml::{
    Spanned,
    de::{DeTable, DeValue},
};

/// Where each key of a scene file stands.
#[derive(Debug)]
pub(super) struct Source {
    /// The scene file, or the OBJ file a scene was made around.
    pub(super) path: PathBuf,
    /// Line, from 1, of each key (`camera.eye`, `light[0].kind`) and table (`light[0]`).
    lines: HashMap<String, usize>,
}

impl Source {
    /// A scene made around an OBJ: no lines to name.
    pub(super) fn without_text(path: &Path) -> Self {
        Self { path: path.to_path_buf(), lines: HashMap::new() }
    }

    /// The line of `key`, or of its table if the key is not written down, or the file as a whole.
    pub(super) fn place(&self, key: &str) -> Place {
        let table = key.rsplit_once('.').map_or(key, |(table, _)| table);
        let line = self.lines.get(key).or_else(|| self.lines.get(table)).copied();
        Place { file: self.path.clone(), line }
    }
}

/// Reads the text of a scene file.
pub(super) fn parse(path: &Path, text: &str) -> Result<(SceneFile, Source), SceneError> {
    let line_ends = LineEnds::of(text);
    let toml_error = |e: &toml::de::Error| {
        let line = e.span().map_or(1, |span| line_ends.line_of(span.start));
        SceneError::Toml { place: Place::line(path, line), message: with_hint(e.message()) }
    };
    let root = DeTable::parse(text).map_err(|e| toml_error(&e))?;
    let lines = KeyLines { path, line_ends: &line_ends, lines: HashMap::new() }.walk(root.get_ref())?;
    let file = SceneFile::deserialize(toml::Deserializer::from(root)).map_err(|e| toml_error(&e))?;
    Ok((file, Source { path: path.to_path_buf(), lines }))
}

/// Adds what to do to serde's two commonest complaints.
fn with_hint(message: &str) -> String {
    let message = message.trim_end();
    if message.contains("missing field") {
        format!("{message}: this key has no default, write it")
    } else if message.contains("expected a sequence") || message.contains("expected an array") {
        format!("{message}: lists are written [x, y, z], repeated tables [[mesh]], [[light]], [[plane]], [[budget]]")
    } else {
        message.to_owned()
    }
}

/// Byte offsets of the line ends of a text.
struct LineEnds(Vec<usize>);

impl LineEnds {
    fn of(text: &str) -> Self {
        Self(text.bytes().enumerate().filter(|&(_, byte)| byte == b'\n').map(|(offset, _)| offset).collect())
    }
    /// The line, from 1, of a byte offset.
    fn line_of(&self, offset: usize) -> usize {
        1 + self.0.partition_point(|&end| end < offset)
    }
}

/// Walks a parsed file, noting lines and refusing unknown keys.
struct KeyLines<'a> {
    path: &'a Path,
    line_ends: &'a LineEnds,
    lines: HashMap<String, usize>,
}

impl KeyLines<'_> {
    fn walk(mut self, root: &DeTable<'_>) -> Result<HashMap<String, usize>, SceneError> {
        self.table("", root, fields_of::<SceneFile>())?;
        for (key, value) in root {
            let Some(known) = fields_of_table(key.get_ref()) else { continue };
            match value.get_ref() {
                DeValue::Table(table) => self.table(key.get_ref(), table, known)?,
                DeValue::Array(items) => self.tables(key.get_ref(), items.iter(), known)?,
                _ => {}
            }
        }
        Ok(self.lines)
    }

    fn tables<'i>(
        &mut self,
        name: &str,
        items: impl Iterator<Item = &'i Spanned<DeValue<'i>>>,
        known: &'static [&'static str],
    ) -> Result<(), SceneError> {
        for (i, item) in items.enumerate() {
            if let DeValue::Table(table) = item.get_ref() {
                let name = format!("{name}[{i}]");
                self.lines.insert(name.clone(), self.line_ends.line_of(item.span().start));
                self.table(&name, table, known)?;
            }
        }
        Ok(())
    }

    fn table(&mut self, name: &str, table: &DeTable<'_>, known: &'static [&'static str]) -> Result<(), SceneError> {
        let line_of = |key: &Spanned<_>| self.line_ends.line_of(key.span().start);
        let unknown = table.keys().filter(|key| !known.contains(&key.get_ref().as_ref()));
        if let Some((line, name)) = unknown.map(|key| (line_of(key), key.to_string())).min() {
            let known = known.iter().map(ToString::to_string).collect();
            return Err(SceneError::Unknown { place: Place::line(self.path, line), what: "key", name, known });
        }
        for key in table.keys() {
            let path = if name.is_empty() { key.to_string() } else { format!("{name}.{key}") };
            self.lines.insert(path, line_of(key));
        }
        Ok(())
    }
}

/// The keys of one of the tables a scene file may hold.
fn fields_of_table(name: &str) -> Option<&'static [&'static str]> {
    match name {
        "camera" => Some(fields_of::<CameraEntry>()),
        "mesh" => Some(fields_of::<MeshEntry>()),
        "light" => Some(fields_of::<LightEntry>()),
        "plane" => Some(fields_of::<PlaneEntry>()),
        "budget" => Some(fields_of::<BudgetEntry>()),
        _ => None,
    }
}

/// The names serde's derive gave a struct's fields, caught by a deserialiser that never delivers.
fn fields_of<T: for<'de> Deserialize<'de>>() -> &'static [&'static str] {
    struct Catcher<'a>(&'a mut &'static [&'static str]);
    impl<'de> Deserializer<'de> for Catcher<'_> {
        type Error = Caught;
        fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Caught> {
            Err(Caught::custom("not a struct"))
        }
        fn deserialize_struct<V: Visitor<'de>>(
            self,
            _: &'static str,
            fields: &'static [&'static str],
            _: V,
        ) -> Result<V::Value, Caught> {
            *self.0 = fields;
            Err(Caught::custom("fields caught"))
        }
        forward_to_deserialize_any! {
            bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option unit
            unit_struct newtype_struct seq tuple tuple_struct map enum identifier ignored_any
        }
    }
    let mut fields: &'static [&'static str] = &[];
    drop(T::deserialize(Catcher(&mut fields)));
    fields
}

#[cfg(test)]
mod tests {
    use super::*;

    const MINIMAL: &str = "about = \"x\"\n[camera]\neye = [0, 0, 1]\ntarget = [0, 0, 0]\n\n[[mesh]]\nfile = \"a.obj\"\n\
                           [[light]]\nkind = \"point\"\n\n[[light]]\n# comment\nkind = \"spot\"\ncone_deg = 10\n";

    fn error(text: &str) -> String {
        parse(Path::new("scene.toml"), text).unwrap_err().to_string()
    }

    #[test]
    fn every_key_has_its_line() {
        let (file, source) = parse(Path::new("scene.toml"), MINIMAL).unwrap();
        assert_eq!(file.light.len(), 2);
        let line = |key: &str| source.place(key).line;
        assert_eq!(line("about"), Some(1));
        assert_eq!(line("camera.target"), Some(4));
        assert_eq!(line("mesh[0].file"), Some(7));
        assert_eq!(line("light[1].cone_deg"), Some(14));
        assert_eq!(line("light[1].target"), Some(11), "a key left out stands where its table stands");
        assert_eq!(line("size"), None);
    }

    #[test]
    fn unknown_keys_name_the_nearest() {
        assert_eq!(
            error(&MINIMAL.replace("cone_deg", "conedeg")),
            "scene.toml:14: unknown key `conedeg`; did you mean `cone_deg`?"
        );
        assert!(
            error(&format!("sise = [1, 1]\n{MINIMAL}"))
                .contains("scene.toml:1: unknown key `sise`; did you mean `size`?")
        );
    }

    #[test]
    fn wrong_types_and_broken_syntax_name_the_line() {
        let wrong_type = error(&MINIMAL.replace("cone_deg = 10", "cone_deg = \"wide\""));
        assert!(wrong_type.starts_with("scene.toml:14: invalid type: string \"wide\""), "{wrong_type}");
        let broken = error(&MINIMAL.replace("[[mesh]]", "[[mesh]"));
        assert!(broken.starts_with("scene.toml:6: "), "{broken}");
        let single = error(&MINIMAL.replace("[[mesh]]", "[mesh]"));
        assert!(single.starts_with("scene.toml:6: ") && single.contains("[[mesh]]"), "{single}");
    }

    #[test]
    fn a_missing_key_names_its_table() {
        let missing = error(&MINIMAL.replace("eye = [0, 0, 1]\n", ""));
        assert!(missing.starts_with("scene.toml:2: missing field `eye`"), "{missing}");
    }
}
