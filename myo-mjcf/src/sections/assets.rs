//! Meshes, textures, materials, height fields, and models to attach.

use crate::document::{Document, Node};
use crate::elements::*;
use crate::error::MjcfError;
use crate::files::{FileError, folder_of, join};
use crate::limits::too_much;
use crate::place::Kind;
use crate::read::Reader;
use crate::table::{Scope, exclusive, fill};
use std::collections::hash_map::Entry;
use std::rc::Rc;

const ASSETS: [&str; 6] = ["mesh", "hfield", "skin", "texture", "material", "model"];

/// Attributes that name files of a texture.
const TEXTURE_FILES: [&str; 7] = ["file", "fileright", "fileleft", "fileup", "filedown", "filefront", "fileback"];

impl Reader<'_> {
    pub(crate) fn asset(&mut self, node: &Node) -> Result<(), MjcfError> {
        match &*node.tag {
            "mesh" => self.mesh(node)?,
            "hfield" => self.height_field(node)?,
            "texture" => self.texture(node)?,
            "material" => return self.material(node),
            "model" => self.model(node)?,
            "skin" => {
                self.refuse(node, "skins are not read; leave them out");
                return Ok(());
            }
            _ => return Err(node.unknown("asset", &ASSETS)),
        }
        self.childless(node)
    }

    fn mesh(&mut self, node: &Node) -> Result<(), MjcfError> {
        let class = self.classes.of(node, "class")?.unwrap_or_else(|| self.classes.main());
        let mut mesh = self.element(node, (*class.mesh).clone(), &[])?;
        exclusive(node, &["builtin", "file"])?;
        exclusive(node, &["builtin", "vertex"])?;
        let folder = self.out.compiler.mesh_folder();
        mesh.path = mesh.file.as_deref().map(|file| self.asset_file(folder, file));
        mesh.name = mesh.name.or_else(|| mesh.file.as_deref().map(stem));
        self.out.meshes.push(mesh);
        Ok(())
    }

    fn height_field(&mut self, node: &Node) -> Result<(), MjcfError> {
        let mut field = self.element(node, HeightField::default(), &[])?;
        let folder = self.out.compiler.mesh_folder();
        field.path = field.file.as_deref().map(|file| self.asset_file(folder, file));
        field.name = field.name.or_else(|| field.file.as_deref().map(stem));
        let heights = field.elevation.as_ref().map_or(0, Vec::len);
        if heights > 0 && i64::from(field.nrow()) * i64::from(field.ncol()) != heights as i64 {
            let text = format!("{heights} numbers");
            let at = node.at_attribute("elevation");
            return Err(MjcfError::OutOfRange {
                at,
                attribute: "elevation",
                text,
                expected: "nrow times ncol numbers",
            });
        }
        self.out.height_fields.push(field);
        Ok(())
    }

    fn texture(&mut self, node: &Node) -> Result<(), MjcfError> {
        let class = self.classes.of(node, "class")?.unwrap_or_else(|| self.classes.main());
        let mut texture = self.element(node, (*class.texture).clone(), &[])?;
        let folder = self.out.compiler.texture_folder();
        let files = TEXTURE_FILES.iter().filter_map(|name| Some((*name, node.get(name).filter(|it| !it.is_empty())?)));
        texture.paths = files.map(|(name, file)| (name, self.asset_file(folder, file))).collect();
        texture.name = texture.name.or_else(|| texture.file.as_deref().map(stem));
        self.out.textures.push(texture);
        Ok(())
    }

    fn material(&mut self, node: &Node) -> Result<(), MjcfError> {
        let class = self.classes.of(node, "class")?.unwrap_or_else(|| self.classes.main());
        let mut material = self.element(node, (*class.material).clone(), &[])?;
        if let Some(layers) = self.layers(node)? {
            material.layers = layers;
        }
        self.out.materials.push(material);
        Ok(())
    }

    /// The layers of a material, if it has any.
    pub(crate) fn layers(&mut self, node: &Node) -> Result<Option<Vec<Layer>>, MjcfError> {
        let mut layers = Vec::new();
        for child in self.document.children(node) {
            if &*child.tag != "layer" {
                return Err(child.unknown("material", &["layer"]));
            }
            if node.get("texture").is_some() {
                return Err(child.misplaced("a material has a `texture` or layers; leave one of them out"));
            }
            layers.push(self.element(child, Layer::default(), &[])?);
            self.childless(child)?;
        }
        Ok(Some(layers).filter(|layers| !layers.is_empty()))
    }

    fn model(&mut self, node: &Node) -> Result<(), MjcfError> {
        let mut asset = ModelAsset::default();
        fill(node, Scope::Element, &mut [&mut asset], &[])?;
        let failed = |path: &str, why| MjcfError::File { at: node.at_attribute("file"), path: path.to_owned(), why };
        let path = join(folder_of(&self.document.path), &asset.file);
        let path = path.ok_or_else(|| failed(&asset.file, FileError::Outside))?;
        if self.attaching.contains(&path) {
            return Err(MjcfError::IncludedTwice { at: node.at_attribute("file"), path });
        }
        self.budget.includes += 1;
        if self.budget.includes > self.budget.limits.includes {
            return Err(too_much(node.spot(), "included files", self.budget.limits.includes as u64));
        }
        let document = Document::load(self.files, &path, 0, self.budget).map_err(|error| match error {
            MjcfError::Main { why, .. } => failed(&path, why),
            other => other,
        })?;
        let name = asset.name.or_else(|| document.root().get("model").map(str::to_owned));
        let name = name.ok_or_else(|| MjcfError::Missing { at: node.at(), attribute: "name" })?;
        match self.models.entry(name) {
            Entry::Vacant(free) => drop(free.insert(Rc::new(document))),
            Entry::Occupied(taken) => {
                let first = taken.get().root().place.clone();
                return Err(MjcfError::DuplicateName { at: node.at(), kind: Kind::Model, first });
            }
        }
        Ok(())
    }

    fn asset_file(&self, folder: &str, file: &str) -> AssetFile {
        let named = file.to_owned();
        let file = if self.out.compiler.strippath() { base(file) } else { file };
        let parts = [folder_of(&self.document.path), folder, file];
        // An absolute part makes those before it meaningless.
        let start = parts.iter().rposition(|part| part.starts_with(['/', '\\'])).unwrap_or(0);
        let parts: Vec<_> = parts[start..].iter().copied().filter(|part| !part.is_empty()).collect();
        AssetFile { named, path: parts.join("/") }
    }
}

fn base(file: &str) -> &str {
    file.rsplit(['/', '\\']).next().unwrap_or(file)
}

/// The name of a file without folder and extension.
fn stem(file: &str) -> String {
    let base = base(file);
    base.rsplit_once('.').map_or(base, |(stem, _)| stem).to_owned()
}
