//! How the model is seen: known names, values as they stand.

use crate::document::Node;
use crate::elements::Raw;
use crate::error::MjcfError;
use crate::read::Reader;
use crate::table::{Scope, fill, unknown_attribute};

const VISUALS: [(&str, &[&str]); 6] = [
    (
        "global",
        &[
            "cameraid",
            "orthographic",
            "fovy",
            "ipd",
            "azimuth",
            "elevation",
            "linewidth",
            "glow",
            "offwidth",
            "offheight",
            "realtime",
            "ellipsoidinertia",
            "bvactive",
        ],
    ),
    ("quality", &["shadowsize", "offsamples", "numslices", "numstacks", "numquads"]),
    ("headlight", &["ambient", "diffuse", "specular", "active"]),
    (
        "map",
        &[
            "stiffness",
            "stiffnessrot",
            "force",
            "torque",
            "alpha",
            "fogstart",
            "fogend",
            "znear",
            "zfar",
            "haze",
            "shadowclip",
            "shadowscale",
            "actuatortendon",
        ],
    ),
    (
        "scale",
        &[
            "forcewidth",
            "contactwidth",
            "contactheight",
            "connect",
            "com",
            "camera",
            "light",
            "selectpoint",
            "jointlength",
            "jointwidth",
            "actuatorlength",
            "actuatorwidth",
            "framelength",
            "framewidth",
            "constraint",
            "slidercrank",
            "frustum",
        ],
    ),
    (
        "rgba",
        &[
            "fog",
            "haze",
            "force",
            "inertia",
            "joint",
            "actuator",
            "actuatornegative",
            "actuatorpositive",
            "com",
            "camera",
            "light",
            "selectpoint",
            "connect",
            "contactpoint",
            "contactforce",
            "contactfriction",
            "contacttorque",
            "contactgap",
            "rangefinder",
            "constraint",
            "slidercrank",
            "crankbroken",
            "frustum",
            "bv",
            "bvactive",
        ],
    ),
];

impl Reader<'_> {
    pub(crate) fn visual(&mut self, section: &Node) -> Result<(), MjcfError> {
        fill(section, Scope::Element, &mut [], &[])?;
        for node in self.document.children(section) {
            let Some((_, valid)) = VISUALS.iter().find(|(tag, _)| *tag == &*node.tag) else {
                return Err(node.unknown("visual", &VISUALS.map(|(tag, _)| tag)));
            };
            if let Some(other) = node.attributes.iter().find(|attribute| !valid.contains(&&*attribute.name)) {
                return Err(unknown_attribute(node, &other.name, valid));
            }
            let attributes = node.attributes.iter().map(|it| (it.name.to_string(), it.value.to_string())).collect();
            self.budget.book(1, 0, || node.spot())?;
            self.out.visual.push(Raw { place: node.place.clone(), tag: node.tag.to_string(), attributes });
            self.childless(node)?;
        }
        Ok(())
    }
}
