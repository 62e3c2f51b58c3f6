//! The line-by-line check of an OBJ file, and the canonical text it leaves for the parser.
//!
//! The subset: `v`, `vt` (counted, unused), `vn`, `f` (any number of corners, positive or relative indices), `o`, `g`,
//! `usemtl`, `mtllib`, `s` (ignored), comments and `\` continuations. `l`, `p` and all else are ignored with one warning
//! each. `g` names an object only in a file without `o`: exporters that write both put materials into groups.

use super::super::error::{Place, SceneError};
use std::{
    borrow::Cow,
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

/// What a scan found. Faces and objects are in file order.
#[derive(Debug, Default)]
pub(super) struct Scan {
    /// The file in canonical form: no comments, one face per line with absolute indices `v` or `v//vn`, objects called
    /// by their index in `objects`.
    pub(super) canonical: String,
    pub(super) faces: Vec<Face>,
    /// Names; the first, the file's own, holds the faces that come before any `o`.
    pub(super) objects: Vec<String>,
    /// Line and name of each `mtllib`.
    pub(super) material_files: Vec<(usize, String)>,
    /// Each material once, with the line that first uses it.
    pub(super) materials_used: Vec<(usize, String)>,
    pub(super) warnings: Vec<String>,
}

/// What the parser does not keep about a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Face {
    /// Line in the file, from 1.
    pub(super) line: usize,
    /// At least 3.
    pub(super) corners: usize,
    /// Whether every corner names a normal.
    pub(super) has_normals: bool,
}

/// Checks a whole file.
pub(super) fn scan(path: &Path, text: &str) -> Result<Scan, SceneError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut scanner = Scanner {
        path,
        line: 0,
        object_key: if text.lines().any(|line| first_word(line) == "o") { "o" } else { "g" },
        defined: Defined::default(),
        ignored: BTreeMap::new(),
        seen_materials: BTreeSet::new(),
        scan: Scan::default(),
    };
    scanner.start_object(&path.file_stem().unwrap_or_default().to_string_lossy());
    for (line, record) in logical_lines(text) {
        scanner.line = line;
        scanner.record(&record)?;
    }
    scanner.finish()
}

/// How many of each the lines so far define: what an index may refer to.
#[derive(Debug, Default, Clone, Copy)]
struct Defined {
    positions: usize,
    texture_coordinates: usize,
    normals: usize,
}

struct Scanner<'a> {
    path: &'a Path,
    line: usize,
    /// The record that starts an object: `o`, or `g` in a file without `o`.
    object_key: &'static str,
    defined: Defined,
    /// First line and number of the records passed over, by their key.
    ignored: BTreeMap<String, (usize, usize)>,
    seen_materials: BTreeSet<String>,
    scan: Scan,
}

impl Scanner<'_> {
    fn fault(&self, problem: String) -> SceneError {
        SceneError::Mesh { place: Place::line(self.path, self.line), problem }
    }

    fn record(&mut self, record: &str) -> Result<(), SceneError> {
        let key = first_word(record);
        let name = record[key.len()..].trim();
        let values = || record.split('#').next().unwrap_or_default().split_whitespace().skip(1);
        match key {
            "v" => self.position(&values().collect::<Vec<_>>())?,
            "vn" => self.normal(&values().collect::<Vec<_>>())?,
            "vt" => self.defined.texture_coordinates += 1,
            "f" => self.face(&values().collect::<Vec<_>>())?,
            "o" | "g" if key == self.object_key => self.start_object(if name.is_empty() { "unnamed" } else { name }),
            "usemtl" => self.use_material(name)?,
            "mtllib" => self.scan.material_files.push((self.line, name.to_owned())),
            "s" | "g" => {}
            _ => self.ignored.entry(key.to_owned()).or_insert((self.line, 0)).1 += 1,
        }
        Ok(())
    }

    fn start_object(&mut self, name: &str) {
        self.scan.canonical += &format!("o {}\n", self.scan.objects.len());
        self.scan.objects.push(name.to_owned());
    }

    fn use_material(&mut self, name: &str) -> Result<(), SceneError> {
        if name.is_empty() {
            return Err(self.fault("usemtl needs the name of a material".into()));
        }
        if self.seen_materials.insert(name.to_owned()) {
            self.scan.materials_used.push((self.line, name.to_owned()));
        }
        self.emit("usemtl", &[name]);
        Ok(())
    }

    fn position(&mut self, words: &[&str]) -> Result<(), SceneError> {
        // x y z, then a weight w that divides them, or a colour.
        if !matches!(words.len(), 3 | 4 | 6) {
            return Err(self.fault(format!("a vertex is `v x y z`, this one has {} numbers", words.len())));
        }
        let numbers = self.numbers(words)?;
        let kept = if words.len() == 4 { 4 } else { 3 };
        let weight = if kept == 4 { numbers[3] } else { 1.0 };
        if numbers.iter().take(3).any(|x| !(x / weight).is_finite()) {
            return Err(self.fault(format!("the weight {weight} of the vertex makes its position infinite")));
        }
        self.defined.positions += 1;
        self.emit("v", &words[..kept]);
        Ok(())
    }

    fn normal(&mut self, words: &[&str]) -> Result<(), SceneError> {
        if words.len() != 3 {
            return Err(self.fault(format!("a normal is `vn x y z`, this one has {} numbers", words.len())));
        }
        self.numbers(words)?;
        self.defined.normals += 1;
        self.emit("vn", words);
        Ok(())
    }

    fn numbers(&self, words: &[&str]) -> Result<Vec<f64>, SceneError> {
        let number = |word: &&str| match word.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => Err(self.fault(format!("`{word}` is not a finite number; export the mesh again"))),
        };
        words.iter().map(number).collect()
    }

    fn face(&mut self, words: &[&str]) -> Result<(), SceneError> {
        if words.len() < 3 {
            return Err(self.fault(format!("a face needs at least 3 corners, this one has {}", words.len())));
        }
        let corners = words.iter().map(|word| self.corner(word)).collect::<Result<Vec<_>, _>>()?;
        let has_normals = corners.iter().all(|(_, normal)| normal.is_some());
        let corner_text = |&(position, normal): &(usize, Option<usize>)| match normal.filter(|_| has_normals) {
            Some(normal) => format!("{position}//{normal}"),
            None => position.to_string(),
        };
        let texts: Vec<String> = corners.iter().map(corner_text).collect();
        self.emit("f", &texts);
        self.scan.faces.push(Face { line: self.line, corners: corners.len(), has_normals });
        Ok(())
    }

    /// Position and normal, both from 1, of `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn corner(&self, word: &str) -> Result<(usize, Option<usize>), SceneError> {
        let mut parts = word.split('/');
        let mut next = |what, defined| match parts.next() {
            None | Some("") => Ok(None),
            Some(text) => self.index(text, what, defined).map(Some),
        };
        let position = next("vertex", self.defined.positions)?;
        next("texture coordinate", self.defined.texture_coordinates)?;
        let normal = next("normal", self.defined.normals)?;
        match (position, parts.next()) {
            (Some(position), None) => Ok((position, normal)),
            _ => Err(self.fault(format!("`{word}` is no face corner: write v, v/vt, v//vn or v/vt/vn"))),
        }
    }

    /// An index counted from 1; a negative one counts back from the last defined.
    fn index(&self, text: &str, what: &str, defined: usize) -> Result<usize, SceneError> {
        let index: i64 = text.parse().map_err(|_| self.fault(format!("`{text}` is no {what} index")))?;
        let absolute = match usize::try_from(index.unsigned_abs()) {
            Ok(back) if index < 0 => (defined + 1).checked_sub(back),
            forward => forward.ok(),
        };
        absolute.filter(|i| (1..=defined).contains(i)).ok_or_else(|| {
            let why = if index == 0 { "; indices count from 1" } else { "" };
            self.fault(format!("there is no {what} {index}: {defined} are defined above this line{why}"))
        })
    }

    fn emit(&mut self, key: &str, words: &[impl AsRef<str>]) {
        self.scan.canonical += key;
        for word in words {
            self.scan.canonical.push(' ');
            self.scan.canonical += word.as_ref();
        }
        self.scan.canonical.push('\n');
    }

    fn finish(mut self) -> Result<Scan, SceneError> {
        let place = Place::file(self.path);
        if self.scan.faces.is_empty() {
            let problem = "the file has no faces (no `f` line): nothing to draw and nothing to cast a shadow".into();
            return Err(SceneError::Mesh { place, problem });
        }
        for (key, (line, count)) in &self.ignored {
            let place = Place::line(self.path, *line);
            self.scan.warnings.push(format!("{place}: `{key}` records are ignored ({count} in this file)"));
        }
        let bare = self.scan.faces.iter().filter(|face| !face.has_normals).count();
        if bare > 0 && bare < self.scan.faces.len() {
            self.scan.warnings.push(format!(
                "{place}: {bare} of {} faces have no normals; they are shaded flat",
                self.scan.faces.len()
            ));
        }
        Ok(self.scan)
    }
}

fn first_word(line: &str) -> &str {
    line.split_whitespace().next().unwrap_or_default()
}

/// Lines with their number from 1: continuations joined, comments and empty lines left out, spaces trimmed.
fn logical_lines(text: &str) -> impl Iterator<Item = (usize, Cow<'_, str>)> {
    let mut lines = text.lines().enumerate();
    std::iter::from_fn(move || {
        let (number, first) = lines.next()?;
        let mut joined = Cow::Borrowed(first.trim());
        while !joined.starts_with('#') {
            if !joined.ends_with('\\') {
                break;
            }
            let line = joined.to_mut();
            line.pop();
            line.push(' ');
            line.push_str(lines.next().map_or("", |(_, next)| next.trim()));
        }
        Some((number + 1, joined))
    })
    .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

    fn scan_text(rest: &str) -> Result<Scan, String> {
        scan(Path::new("a/m.obj"), &format!("{TRIANGLE}{rest}")).map_err(|e| e.to_string())
    }

    #[test]
    fn canonical_text_has_absolute_indices_and_no_texture_coordinates() {
        let scan = scan_text("vt 0 0\nvn 0 0 1\nf -3/1/-1 2/-1/1 3//1 # corner\nf 1 2 \\\n 3\n").unwrap();
        assert!(scan.canonical.ends_with("vn 0 0 1\nf 1//1 2//1 3//1\nf 1 2 3\n"), "{}", scan.canonical);
        assert_eq!(scan.faces[0], Face { line: 6, corners: 3, has_normals: true });
        assert_eq!(scan.faces[1], Face { line: 7, corners: 3, has_normals: false });
        assert_eq!(scan.warnings.len(), 1, "mixed faces are told: {:?}", scan.warnings);
    }

    #[test]
    fn every_fault_names_its_line() {
        for (bad, problem) in [
            ("v 0 nan 0\n", "`nan` is not a finite number"),
            ("v 0 inf 0\n", "`inf` is not a finite number"),
            ("v 0 1e999 0\n", "`1e999` is not a finite number"),
            ("v 0 one 0\n", "`one` is not a finite number"),
            ("v 0 0\n", "a vertex is `v x y z`, this one has 2 numbers"),
            ("v 0 1 0 0\n", "weight 0"),
            ("vn 0 inf 0\n", "`inf` is not a finite number"),
            ("f 1 2 4\n", "there is no vertex 4: 3 are defined"),
            ("f 1 2 -4\n", "there is no vertex -4: 3 are defined"),
            ("f 0 1 2\n", "there is no vertex 0: 3 are defined above this line; indices count from 1"),
            ("f 1//1 2//1 3//1\n", "there is no normal 1: 0 are defined"),
            ("f 1/1 2/1 3/1\n", "there is no texture coordinate 1"),
            ("f 99999999999999999999 2 3\n", "is no vertex index"),
            ("f 1///1 2 3\n", "is no face corner"),
            ("f // 2 3\n", "is no face corner"),
            ("f 1 2\n", "at least 3 corners"),
            ("f 1\n", "at least 3 corners"),
            ("usemtl\n", "usemtl needs"),
        ] {
            let message = scan_text(bad).unwrap_err();
            assert!(message.starts_with("a/m.obj:4: ") && message.contains(problem), "{bad}: {message}");
        }
    }

    #[test]
    fn a_file_without_faces_is_refused() {
        assert!(scan_text("l 1 2\n").unwrap_err().starts_with("a/m.obj: the file has no faces"));
    }

    #[test]
    fn lines_and_points_are_ignored_with_one_warning_each() {
        let scan = scan_text("l 1 2\nl 2 3\np 1\nf 1 2 3\n").unwrap();
        assert_eq!(
            scan.warnings,
            [
                "a/m.obj:4: `l` records are ignored (2 in this file)",
                "a/m.obj:6: `p` records are ignored (1 in this file)"
            ]
        );
        assert_eq!(scan.faces.len(), 1);
    }

    #[test]
    fn groups_are_objects_only_without_objects() {
        assert_eq!(scan_text("g a\nf 1 2 3\ng b\nf 1 2 3\n").unwrap().objects, ["m", "a", "b"]);
        assert_eq!(scan_text("o a\ng b\nf 1 2 3\n").unwrap().objects, ["m", "a"]);
    }

    #[test]
    fn windows_line_ends_and_byte_order_mark_change_nothing() {
        let unix = "v 0 0 0\n\n# x\nv 1 0 0\nv 0 -0 1\no a b\nusemtl Material #25\nf 1 2 3\n";
        let windows = format!("\u{feff}{}", unix.replace('\n', "\r\n"));
        let [unix, windows] = [unix, &windows].map(|text| scan(Path::new("m.obj"), text).unwrap());
        assert_eq!(unix.canonical, windows.canonical);
        assert_eq!(windows.objects, ["m", "a b"]);
        assert_eq!(windows.materials_used, [(7, "Material #25".to_owned())]);
    }
}
