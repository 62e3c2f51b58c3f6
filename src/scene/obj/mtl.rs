//! MTL files: the same line-by-line check, then tobj, then Phong materials.
//!
//! `newmtl`, `Ka`, `Kd`, `Ks`, `Ke`, `Ns` and `d` are read, every other key is ignored with one warning. What a material
//! leaves out: `Kd` is the default grey, `Ka` the same as `Kd`, `Ks` and `Ke` black, `d` opaque.

use super::super::{
    Material,
    error::{Place, SceneError},
    folder::{Folder, parent_of},
};
use glam::Vec3;
use std::{collections::BTreeSet, path::Path};

/// Largest specular exponent the MTL format knows.
const MAX_SHININESS: f32 = 1000.0;

/// Reads the MTL files that `obj` names, by line and name. A file that is not there is a warning.
pub(super) fn read_all(
    obj: &Path,
    files: &[(usize, String)],
    folder: &Folder,
    warnings: &mut Vec<String>,
) -> Result<Vec<Material>, SceneError> {
    let base = parent_of(obj);
    let mut materials = Vec::new();
    for (line, file) in files {
        match folder.read(base, file, &Place::line(obj, *line)) {
            Ok((path, bytes)) => materials.extend(read(&path, &String::from_utf8_lossy(&bytes), warnings)?),
            Err(missing @ SceneError::Reference { .. }) => {
                warnings.push(format!("{missing}\n  its materials become the default material"));
            }
            Err(error) => return Err(error),
        }
    }
    Ok(materials)
}

fn read(path: &Path, text: &str, warnings: &mut Vec<String>) -> Result<Vec<Material>, SceneError> {
    let canonical = canonical(path, text, warnings)?;
    let (materials, _) = tobj::load_mtl_buf(&mut canonical.as_bytes()).map_err(|e| SceneError::Mesh {
        place: Place::file(path),
        problem: format!("the MTL reader refuses it: {e}"),
    })?;
    Ok(materials.into_iter().map(|material| phong(path, material, warnings)).collect())
}

/// The known lines of an MTL file, each checked.
fn canonical(path: &Path, text: &str, warnings: &mut Vec<String>) -> Result<String, SceneError> {
    let mut kept = String::new();
    let mut ignored = BTreeSet::new();
    for (i, line) in text.strip_prefix('\u{feff}').unwrap_or(text).lines().enumerate() {
        let place = Place::line(path, i + 1);
        let fault = |problem: String| SceneError::Mesh { place: place.clone(), problem };
        let mut words = line.split_whitespace();
        let key = words.next().unwrap_or_default();
        match key {
            "newmtl" if words.next().is_some() => kept += line.trim(),
            "newmtl" => return Err(fault("newmtl needs a name".into())),
            "Ka" | "Kd" | "Ks" | "Ke" | "Ns" | "d" if kept.is_empty() => {
                return Err(fault(format!("{key} comes before the first newmtl")));
            }
            "Ka" | "Kd" | "Ks" | "Ke" => {
                let [r, g, b] = colour(words).map_err(fault)?;
                kept += &format!("{key} {r} {g} {b}");
            }
            "Ns" | "d" => kept += &format!("{key} {}", number(words.next().unwrap_or_default()).map_err(fault)?),
            comment if comment.is_empty() || comment.starts_with('#') => continue,
            _ => {
                if ignored.insert(key) {
                    warnings.push(format!("{place}: material key `{key}` is ignored"));
                }
                continue;
            }
        }
        kept.push('\n');
    }
    Ok(kept)
}

/// Three numbers, or one that stands for all three.
fn colour<'a>(words: impl Iterator<Item = &'a str>) -> Result<[f32; 3], String> {
    let numbers = words.take_while(|word| !word.starts_with('#')).map(number).collect::<Result<Vec<_>, _>>()?;
    match numbers[..] {
        [grey] => Ok([grey; 3]),
        [r, g, b] => Ok([r, g, b]),
        _ => Err(format!("a colour is three numbers, this one has {}", numbers.len())),
    }
}

fn number(word: &str) -> Result<f32, String> {
    word.parse()
        .ok()
        .filter(|number: &f32| number.is_finite() && *number >= 0.0)
        .ok_or_else(|| format!("`{word}` is not a number of at least 0"))
}

fn phong(path: &Path, material: tobj::Material, warnings: &mut Vec<String>) -> Material {
    let fallback = Material::default();
    let rgb = |colour: [f64; 3]| Vec3::from_array(colour.map(|channel| channel as f32));
    let mut clamped = |key, value: Option<f64>, otherwise: f32, max: f32| {
        let value = value.map_or(otherwise, |value| value as f32);
        if value > max {
            let place = Place::file(path);
            warnings
                .push(format!("{place}: material `{}`: {key} = {value} is above {max}, {max} is used", material.name));
        }
        value.min(max)
    };
    let shininess = clamped("Ns", material.shininess, fallback.shininess, MAX_SHININESS);
    let opacity = clamped("d", material.dissolve, fallback.opacity, 1.0);
    let diffuse = material.diffuse.map_or(fallback.diffuse, rgb);
    Material {
        name: material.name,
        ambient: material.ambient.map_or(diffuse, rgb),
        diffuse,
        specular: material.specular.map_or(fallback.specular, rgb),
        emission: material.emissive.map_or(fallback.emission, rgb),
        shininess,
        opacity,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_text(text: &str) -> (Result<Vec<Material>, String>, Vec<String>) {
        let mut warnings = Vec::new();
        let materials = read(Path::new("m.mtl"), text, &mut warnings).map_err(|e| e.to_string());
        (materials, warnings)
    }

    #[test]
    fn a_published_example_is_read_exactly() {
        let (materials, warnings) = read_text(
            "newmtl red\r\nNs 96.078431\r\nKa .3 0 0\r\nKd 0 0 .64\r\nKs .5 .5 .5\r\nd 1\r\nillum 2\r\nillum 2\r\n",
        );
        let red = &materials.unwrap()[0];
        assert_eq!((red.ambient, red.diffuse, red.specular), (Vec3::X * 0.3, Vec3::Z * 0.64, Vec3::splat(0.5)));
        assert_eq!((red.shininess, red.opacity), (96.078_43, 1.0));
        assert_eq!(warnings, ["m.mtl:7: material key `illum` is ignored"]);
    }

    #[test]
    fn what_is_left_out_has_a_default_and_what_is_too_large_is_clamped() {
        let (materials, warnings) = read_text("newmtl a\nKd 0.5\nNs 5000\n# end");
        let a = &materials.unwrap()[0];
        assert_eq!((a.ambient, a.diffuse, a.shininess), (Vec3::splat(0.5), Vec3::splat(0.5), 1000.0));
        assert_eq!(warnings, ["m.mtl: material `a`: Ns = 5000 is above 1000, 1000 is used"]);
    }

    #[test]
    fn faults_name_their_line() {
        for (bad, problem) in [
            ("Kd 1 1", "three numbers, this one has 2"),
            ("Kd", "three numbers, this one has 0"),
            ("Kd nan 0 0", "`nan` is not a number"),
            ("Ks -1 0 0", "`-1` is not a number of at least 0"),
            ("Ns", "`` is not a number"),
            ("newmtl", "newmtl needs a name"),
        ] {
            let message = read_text(&format!("newmtl a\n{bad}\n")).0.unwrap_err();
            assert!(message.starts_with("m.mtl:2: ") && message.contains(problem), "{message}");
        }
        assert!(read_text("Kd 1 1 1\n").0.unwrap_err().starts_with("m.mtl:1: Kd comes before"));
    }
}
