//! Meshes that touch.

use super::hull::{Touching, touching};
use crate::description::Hull;
use myo_mjcf::{FileError, Folder, Geom, Mesh, MeshError, MeshInertia, Mjcf, Shape};
use nalgebra::Point3;
use std::collections::HashMap;

/// Most triangles that are read of a file's meshes together.
const MOST_TRIANGLES: usize = 5_000_000;
/// Most points that are added to their hulls: so many take some ten seconds.
const MOST_ADDED: usize = 100_000;

/// What of a file's meshes touches, or why that is not known.
pub(super) struct Meshes<'a> {
    mjcf: &'a Mjcf,
    folder: Option<&'a Folder>,
    /// By their numbers.
    read: HashMap<usize, Result<Touching, String>>,
    triangles: usize,
    /// Points that may still be added to hulls.
    left: usize,
    /// Numbers of those that were asked for.
    used: Vec<usize>,
}

impl<'a> Meshes<'a> {
    pub fn of(mjcf: &'a Mjcf, folder: Option<&'a Folder>) -> Self {
        Self { mjcf, folder, read: HashMap::new(), triangles: 0, left: MOST_ADDED, used: vec![] }
    }

    /// Reads the mesh of a geom, if it has one for a shape.
    pub fn read(&mut self, geom: &Geom) {
        if let Some(number) = self.number(geom)
            && !self.read.contains_key(&number)
        {
            let found = self.found(&self.mjcf.meshes[number]);
            self.read.insert(number, found);
        }
    }

    fn number(&self, geom: &Geom) -> Option<usize> {
        let name = geom.mesh.as_ref().filter(|_| geom.kind() == Shape::Mesh)?;
        self.mjcf.meshes.iter().position(|mesh| mesh.name.as_ref() == Some(name))
    }

    fn found(&mut self, mesh: &Mesh) -> Result<Touching, String> {
        if mesh.inertia() != MeshInertia::Legacy {
            return Err("its frame is not that of `inertia=\"legacy\"`, the only one that is known".into());
        }
        if mesh.maxhullvert() != -1 {
            return Err("`maxhullvert` is not known".into());
        }
        if self.triangles > MOST_TRIANGLES {
            return Err(format!("it comes after {MOST_TRIANGLES} triangles of other meshes; no more are read"));
        }
        let told = |why: MeshError| match why {
            MeshError::File { why: FileError::Outside, .. } => format!("{why} (`--root FOLDER`, `root=` in Python)"),
            why => why.to_string(),
        };
        let triangles = mesh.triangles(self.folder).map_err(told)?;
        self.triangles += triangles.faces.len();
        touching(&triangles, &mut self.left).map_err(|why| why.to_string())
    }

    /// The mesh that a geom has for a shape.
    pub fn touching(&self, geom: &Geom) -> Option<&Touching> {
        self.read.get(&self.number(geom)?)?.as_ref().ok()
    }

    /// Why there is none.
    pub fn why_not(&self, geom: &Geom) -> Option<&str> {
        self.read.get(&self.number(geom)?)?.as_ref().err().map(String::as_str)
    }

    /// Its place among [`Self::hulls`].
    pub fn hull(&mut self, geom: &Geom) -> Option<usize> {
        let number = self.number(geom)?;
        let place = self.used.iter().position(|&used| used == number);
        Some(place.unwrap_or_else(|| {
            self.used.push(number);
            self.used.len() - 1
        }))
    }

    /// Those that were asked for.
    pub fn hulls(&self) -> Vec<Hull> {
        let hull = |number: &usize| self.read.get(number)?.as_ref().ok().map(|touching| touching.hull.clone());
        self.used.iter().filter_map(hull).collect()
    }

    /// Middle (m, in its frame) and radius (m) of a ball that holds a geom; none of one without end, or whose size is not known.
    pub fn ball(&self, geom: &Geom) -> Option<(Point3<f64>, f64)> {
        if let Some(touching) = self.touching(geom) {
            return Some((Point3::from(touching.frame.translation.vector), touching.reach));
        }
        super::apart::reach(geom).map(|reach| (Point3::origin(), reach))
    }
}
