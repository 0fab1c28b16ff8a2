//! What shapes are made of and look like. Files are named, not read.

use crate::files::FileError;
use crate::reading::{ToMaterial, ToTexture};
use crate::table::table;
use crate::value::keywords;

keywords! {
    /// How the inertia of a mesh is computed.
    pub enum MeshInertia {
        /// From its convex hull.
        Convex = "convex",
        /// As older versions did.
        Legacy = "legacy",
        /// From the mesh itself.
        Exact = "exact",
        /// From its surface.
        Shell = "shell",
    }

    /// Kinds of textures.
    pub enum TextureKind {
        /// A picture.
        Flat = "2d",
        /// Six sides of a cube around a shape.
        Cube = "cube",
        /// Six sides of a cube around the scene.
        Skybox = "skybox",
    }
}

/// A file that an asset names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AssetFile {
    /// The file as the element names it.
    pub named: String,
    /// The folder of the main file, then `meshdir` or the like, then the file: what to open, before `..` is resolved.
    pub path: String,
}

impl AssetFile {
    /// The path below the root folder, as [`Files`](crate::Files) takes it.
    pub fn below_root(&self) -> Result<String, FileError> {
        crate::files::join("", &self.path).ok_or(FileError::Outside)
    }
}

table! {
    /// A mesh.
    pub struct Mesh {
        own {
            /// Its name, by default that of its file without folder and extension.
            name: String;
            /// The default class.
            class: String;
            /// Format of the file, where its extension does not tell.
            content_type: String;
            /// The file, as it is written; see `path`.
            file: String;
            /// Points, three numbers each (m).
            vertex: Vec<f64>;
            /// Normals, three numbers each.
            normal: Vec<f64>;
            /// Texture coordinates, two numbers each.
            texcoord: Vec<f64>;
            /// Triangles, three points each.
            face: Vec<i32>;
            /// Origin of the mesh in the coordinates of its file (m).
            refpos: [f64; 3] = [0.0; 3];
            /// Its orientation there.
            refquat: [f64; 4] = [1.0, 0.0, 0.0, 0.0];
            /// Whether normals are smooth over edges.
            smoothnormal: bool = false;
            /// A shape that MuJoCo makes, as a word.
            builtin: String;
            /// Numbers of that shape.
            params: Vec<f64>;
            /// The name of its material.
            material: String as ToMaterial;
        }
        classed {
            /// Scale along the axes of its file.
            scale: [f64; 3] = [1.0; 3];
            /// Most points of its convex hull, -1 is any.
            maxhullvert: i32 = -1;
            /// How its inertia is computed.
            inertia: MeshInertia = MeshInertia::Legacy;
        }
        plus {
            /// The file to open.
            path: Option<AssetFile>;
        }
    }
}

table! {
    /// Terrain.
    pub struct HeightField {
        required {
            /// Half sizes along x and y, height of the highest point, depth below the lowest (m).
            size: [f64; 4];
        }
        own {
            /// Its name, by default that of its file without folder and extension.
            name: String;
            /// Format of the file, where its extension does not tell.
            content_type: String;
            /// The file, as it is written; see `path`.
            file: String;
            /// Rows of heights.
            nrow: i32 = 0;
            /// Columns of heights.
            ncol: i32 = 0;
            /// Heights, row by row, the row of greatest y first.
            elevation: Vec<f64>;
        }
        plus {
            /// The file to open.
            path: Option<AssetFile>;
        }
    }
}

table! {
    /// A texture.
    pub struct Texture {
        own {
            /// Its name, by default that of its file without folder and extension.
            name: String;
            /// The default class.
            class: String;
            /// Format of the file, where its extension does not tell.
            content_type: String;
            /// The file, as it is written; see `paths`.
            file: String;
            /// The file of the right side of a cube.
            fileright: String;
            /// The file of the left side.
            fileleft: String;
            /// The file of the upper side.
            fileup: String;
            /// The file of the lower side.
            filedown: String;
            /// The file of the front side.
            filefront: String;
            /// The file of the back side.
            fileback: String;
        }
        classed {
            /// What it is.
            kind "type": TextureKind = TextureKind::Cube;
            /// How its numbers stand for colours, as a word.
            colorspace: String;
            /// Whether a saved model has its pixels, as a word.
            embed: String;
            /// Rows and columns of sides in one picture.
            gridsize: [i32; 2] = [1, 1];
            /// What the parts of the picture are.
            gridlayout: String;
            /// A pattern that MuJoCo makes, as a word.
            builtin: String;
            /// First colour of the pattern.
            rgb1: [f64; 3] = [0.8; 3];
            /// Second colour of the pattern.
            rgb2: [f64; 3] = [0.5; 3];
            /// Marks on the pattern, as a word.
            mark: String;
            /// Their colour.
            markrgb: [f64; 3] = [0.0; 3];
            /// Part of the pixels that random marks take.
            random: f64 = 0.01;
            /// Width (pixels).
            width: i32 = 0;
            /// Height (pixels).
            height: i32 = 0;
            /// Whether it is mirrored left to right.
            hflip: bool = false;
            /// Whether it is mirrored top to bottom.
            vflip: bool = false;
            /// Channels.
            nchannel: i32 = 3;
        }
        plus {
            /// The files to open, with the attributes that name them.
            paths: Vec<(&'static str, AssetFile)>;
        }
    }
}

table! {
    /// What a shape looks like.
    pub struct Material {
        own {
            /// Its name.
            name: String;
            /// The default class.
            class: String;
        }
        classed {
            /// The name of its texture.
            texture: String as ToTexture;
            /// How often the texture repeats.
            texrepeat: [f64; 2] = [1.0; 2];
            /// Whether it repeats by length, not by shape.
            texuniform: bool = false;
            /// Emission.
            emission: f64 = 0.0;
            /// Specular reflection.
            specular: f64 = 0.5;
            /// Shininess.
            shininess: f64 = 0.5;
            /// Reflectance.
            reflectance: f64 = 0.0;
            /// Metallic part, -1 is unknown.
            metallic: f64 = -1.0;
            /// Roughness, -1 is unknown.
            roughness: f64 = -1.0;
            /// Its colour.
            rgba: [f64; 4] = [1.0; 4];
        }
        plus {
            /// Textures by what they are for.
            layers: Vec<Layer>;
        }
    }
}

table! {
    /// A texture of a material.
    pub struct Layer {
        required {
            /// The name of the texture.
            texture: String as ToTexture;
            /// What it is for, as a word.
            role: String;
        }
    }
}

table! {
    /// A model that may be attached.
    pub(crate) struct ModelAsset {
        required {
            /// The file.
            file: String;
        }
        own {
            /// Its name, by default what its file says.
            name: String;
            /// Format of the file.
            content_type: String;
        }
    }
}
