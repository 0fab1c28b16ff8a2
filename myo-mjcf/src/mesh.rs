//! Triangles of mesh files: STL, OBJ, and MuJoCo's own format.

use crate::files::{FileError, Folder};
use crate::{AssetFile, Mesh};
use std::collections::HashMap;
use std::path::Path;

/// Most bytes of a mesh file.
const MOST_BYTES: u64 = 64 << 20;
/// Most triangles of a mesh: MuJoCo's.
const MOST_FACES: usize = 200_000;
/// Bytes of an STL file before its triangles: a comment and their number.
const STL_HEAD: usize = 84;
/// Bytes of each: a normal, three points, two of no meaning.
const STL_FACE: usize = 50;

/// A surface of triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Triangles {
    /// Points (m), each once.
    pub points: Vec<[f32; 3]>,
    /// Indices of three points, counter-clockwise as seen from outside.
    pub faces: Vec<[u32; 3]>,
}

/// Why there are no triangles.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// The file cannot be opened.
    #[error("{file} {why}")]
    File {
        /// The file.
        file: String,
        /// Why.
        why: FileError,
    },
    /// It is not told which format it has.
    #[error("{file} is of an unknown format; known are STL, OBJ and MSH")]
    Format {
        /// The file.
        file: String,
    },
    /// The element names no file, and has no faces of its own.
    #[error("it has no file and no faces")]
    Empty,
    /// The contents are not what they should be.
    #[error("{file} {what}")]
    Contents {
        /// The file.
        file: String,
        /// What is wrong.
        what: String,
    },
}

impl Mesh {
    /// Its triangles in its own frame, scaled; no file outside of a folder is opened, and none at all without one.
    ///
    /// # Errors
    /// The file cannot be read, or is no mesh; a mesh of points alone has no triangles.
    pub fn triangles<'a>(&self, folder: impl Into<Option<&'a Folder>>) -> Result<Triangles, MeshError> {
        let (name, found) = match &self.path {
            Some(file) => {
                let missing = || MeshError::File { file: file.named.clone(), why: FileError::NoFolder };
                let folder = folder.into().ok_or_else(missing)?;
                (file.named.clone(), of_file(file, self.content_type.as_deref(), folder)?)
            }
            None => ("the mesh".to_owned(), self.written()?),
        };
        let contents = |what: String| MeshError::Contents { file: name.clone(), what };
        let mut triangles = found.map_err(contents)?;
        check(&triangles).map_err(contents)?;
        for point in &mut triangles.points {
            *point = self.placed(*point);
        }
        // A mirror turns a surface inside out.
        if self.scale().iter().product::<f64>() < 0.0 {
            triangles.faces.iter_mut().for_each(|face| face.swap(1, 2));
        }
        Ok(triangles)
    }

    /// Points and faces of the element itself.
    fn written(&self) -> Result<Result<Triangles, String>, MeshError> {
        let (Some(points), Some(faces)) = (&self.vertex, &self.face) else { return Err(MeshError::Empty) };
        let points = points.chunks_exact(3).map(|p| [p[0] as f32, p[1] as f32, p[2] as f32]).collect();
        let index = |k: i32| u32::try_from(k).unwrap_or(u32::MAX);
        let faces = faces.chunks_exact(3).map(|face| [index(face[0]), index(face[1]), index(face[2])]).collect();
        Ok(Ok(Triangles { points, faces }))
    }

    /// A point of the file in the frame of the mesh.
    fn placed(&self, point: [f32; 3]) -> [f32; 3] {
        let [w, x, y, z] = self.refquat();
        let turn = nalgebra::UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z));
        let moved = nalgebra::Vector3::from(point.map(f64::from)) - nalgebra::Vector3::from(self.refpos());
        let seen = turn.inverse_transform_vector(&moved);
        let scale = self.scale();
        [0, 1, 2].map(|axis| (seen[axis] * scale[axis]) as f32)
    }
}

/// What a file holds, or what is wrong with it.
fn of_file(file: &AssetFile, kind: Option<&str>, folder: &Folder) -> Result<Result<Triangles, String>, MeshError> {
    let opened = |why| MeshError::File { file: file.named.clone(), why };
    let ending = kind.unwrap_or(&file.named).to_ascii_lowercase();
    let read = match ending.rsplit(['.', '/']).next() {
        Some("stl") => stl,
        Some("obj") => obj,
        Some("msh" | "vnd.mujoco.msh" | "mujoco") => msh,
        _ => return Err(MeshError::Format { file: file.named.clone() }),
    };
    // An absolute path may lead into the folder, too.
    let path = Path::new(&file.path);
    let below = if path.is_absolute() { folder.relative(path).map_err(opened)? } else { file.path.clone() };
    Ok(read(&folder.bytes(&below, MOST_BYTES).map_err(opened)?))
}

/// Whether all points are places and all faces have points.
fn check(triangles: &Triangles) -> Result<(), String> {
    let Triangles { points, faces } = triangles;
    if faces.is_empty() {
        return Err("has no triangles".into());
    }
    if faces.len() > MOST_FACES {
        return Err(format!("has {} triangles; at most {MOST_FACES} are read", faces.len()));
    }
    if let Some(point) = points.iter().position(|point| point.iter().any(|x| !x.is_finite())) {
        return Err(format!("has a point {} that is no place", point + 1));
    }
    match faces.iter().flatten().find(|&&point| point as usize >= points.len()) {
        Some(point) => Err(format!("has a triangle with point {point}, counted from 0, of {}", points.len())),
        None => Ok(()),
    }
}

fn number(bytes: &[u8], at: usize) -> f32 {
    f32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
}

/// Binary STL: three points of each triangle, those of one place put together.
fn stl(bytes: &[u8]) -> Result<Triangles, String> {
    let Some(count) = bytes.get(80..STL_HEAD) else { return Err("is too short for an STL file".into()) };
    let count = u32::from_le_bytes([count[0], count[1], count[2], count[3]]) as usize;
    // The size tells what is binary; one of text begins with `solid`, as some binary ones do, too.
    if count.checked_mul(STL_FACE).is_none_or(|size| size != bytes.len() - STL_HEAD) {
        return Err(format!("is {} bytes long, which is not that of {count} triangles of binary STL", bytes.len()));
    }
    let (mut triangles, mut known) = (Triangles::default(), HashMap::new());
    for face in bytes[STL_HEAD..].chunks_exact(STL_FACE) {
        let mut corner = |k: usize| {
            let place = [0, 1, 2].map(|axis| number(face, 12 + 12 * k + 4 * axis));
            *known.entry(place.map(f32::to_bits)).or_insert_with(|| {
                triangles.points.push(place);
                triangles.points.len() as u32 - 1
            })
        };
        let face = [corner(0), corner(1), corner(2)];
        triangles.faces.push(face);
    }
    Ok(triangles)
}

/// Points and faces of an OBJ file; faces of more corners are cut from their first one.
fn obj(bytes: &[u8]) -> Result<Triangles, String> {
    let text = std::str::from_utf8(bytes).map_err(|_| "is not text in UTF-8")?;
    let mut triangles = Triangles::default();
    for (line, words) in text.lines().map(str::split_whitespace).enumerate() {
        let wrong = |what: &str| format!("has {what} in line {}", line + 1);
        let words: Vec<&str> = words.collect();
        match words.first() {
            Some(&"v") => {
                let x = |k: usize| words.get(k).and_then(|x| x.parse().ok()).ok_or_else(|| wrong("no point"));
                triangles.points.push([x(1)?, x(2)?, x(3)?]);
            }
            Some(&"f") => {
                let corner = |word: &&str| of_obj(word, triangles.points.len()).ok_or_else(|| wrong("no face"));
                let corners: Vec<u32> = words[1..].iter().map(corner).collect::<Result<_, _>>()?;
                if corners.len() < 3 {
                    return Err(wrong("no face"));
                }
                triangles.faces.extend(corners[1..].windows(2).map(|pair| [corners[0], pair[0], pair[1]]));
            }
            _ => {}
        }
    }
    Ok(triangles)
}

/// A corner such as `7/1/3`, counted from 1, or from the end below zero.
fn of_obj(word: &str, points: usize) -> Option<u32> {
    let number: i64 = word.split('/').next()?.parse().ok()?;
    let index = if number < 0 { points as i64 + number } else { number - 1 };
    u32::try_from(index).ok()
}

/// MuJoCo's own format: four counts, then points, normals, texture coordinates, faces.
fn msh(bytes: &[u8]) -> Result<Triangles, String> {
    let count = |k: usize| {
        let word = bytes.get(4 * k..4 * k + 4).ok_or("is too short for an MSH file")?;
        usize::try_from(i32::from_le_bytes([word[0], word[1], word[2], word[3]])).map_err(|_| "has a count below zero")
    };
    let [points, normals, places, faces] = [count(0)?, count(1)?, count(2)?, count(3)?];
    let numbers = 3 * points + 3 * normals + 2 * places;
    if bytes.len() != 16 + 4 * (numbers + 3 * faces) {
        return Err(format!("is {} bytes long, which is not what its counts say", bytes.len()));
    }
    let point = |k: usize| [0, 1, 2].map(|axis| number(bytes, 16 + 4 * (3 * k + axis)));
    // Bits of a whole number.
    let face = |k: usize| [0, 1, 2].map(|corner| number(bytes, 16 + 4 * (numbers + 3 * k + corner)).to_bits());
    Ok(Triangles { points: (0..points).map(point).collect(), faces: (0..faces).map(face).collect() })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A binary STL file.
    fn stl_of(faces: &[[[f32; 3]; 3]]) -> Vec<u8> {
        let mut bytes = vec![0; 80];
        bytes.extend((faces.len() as u32).to_le_bytes());
        for face in faces {
            bytes.extend([0; 12]);
            face.iter().flatten().for_each(|x| bytes.extend(x.to_le_bytes()));
            bytes.extend([0; 2]);
        }
        bytes
    }

    const PIECES: [[[f32; 3]; 3]; 2] =
        [[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]];

    #[test]
    fn all_formats_say_the_same() {
        let from_stl = stl(&stl_of(&PIECES)).unwrap();
        assert_eq!(from_stl.points.len(), 4);
        assert_eq!(from_stl.faces, [[0, 1, 2], [1, 3, 2]]);
        let text = "# a square\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\nf -3 -1 -2\n";
        assert_eq!(obj(text.as_bytes()).unwrap(), from_stl);
        let mut bytes = [4_i32, 0, 0, 2].map(i32::to_le_bytes).concat();
        from_stl.points.iter().flatten().for_each(|x| bytes.extend(x.to_le_bytes()));
        from_stl.faces.iter().flatten().for_each(|k| bytes.extend(k.to_le_bytes()));
        assert_eq!(msh(&bytes).unwrap(), from_stl);
        let square = obj(b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4").unwrap();
        assert_eq!(square.faces, [[0, 1, 2], [0, 2, 3]], "a face of four corners");
    }

    #[test]
    fn what_is_no_mesh_is_told() {
        let whole = stl_of(&PIECES);
        for cut in 0..whole.len() {
            assert!(stl(&whole[..cut]).is_err(), "{cut}");
        }
        let mut huge = whole.clone();
        huge[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(stl(&huge).unwrap_err().contains("4294967295 triangles"));
        assert!(msh(&[i32::MAX, i32::MAX, i32::MAX, i32::MAX].map(i32::to_le_bytes).concat()).is_err());
        assert!(msh(&[-1, 0, 0, 0].map(i32::to_le_bytes).concat()).is_err());
        assert!(obj(b"v 0 0 x").unwrap_err().contains("line 1"));
        assert!(obj(b"v 0 0 0\nf 1 2").is_err());
        let beyond = obj(b"v 0 0 0\nf 1 2 3").unwrap();
        assert!(check(&beyond).unwrap_err().contains("point 1, counted from 0, of 1"));
        let lost = Triangles { points: vec![[f32::NAN, 0.0, 0.0]], faces: vec![[0, 0, 0]] };
        assert!(check(&lost).unwrap_err().contains("no place"));
        let many = Triangles { points: vec![[0.0; 3]], faces: vec![[0; 3]; MOST_FACES + 1] };
        assert!(check(&many).unwrap_err().contains("200001 triangles"));
    }
}
