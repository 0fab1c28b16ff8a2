//! One table for each element: from it come struct, reader, list of attributes, defaults and references.

use crate::document::Node;
use crate::error::MjcfError;
use crate::nearest::{nearest, short};
use crate::place::{Kind, Place};
use crate::value::Fault;

/// What an element is read for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scope {
    /// The element itself.
    Element,
    /// A default class, which has no name of its own and refers to little.
    Class,
}

/// Reads one attribute by its name; what [`table!`] makes.
pub(crate) trait Table {
    /// Sets an attribute; false if there is none of this name.
    fn set(&mut self, scope: Scope, name: &str, text: &str) -> Result<bool, Fault>;

    /// Names of the attributes, those that must be there first.
    fn attributes(&self, scope: Scope) -> Vec<&'static str>;

    /// Names of the attributes that must be there.
    fn required(&self) -> &'static [&'static str];

    fn set_place(&mut self, place: &Place);

    /// Visits the names of other elements.
    fn references(&mut self, visit: &mut dyn FnMut(Kind, &mut String));

    /// Forgets empty names and lists: they say nothing, but take away what the class said.
    fn tidy(&mut self);

    /// Bytes that it holds beyond its own size.
    fn held(&self) -> usize;
}

/// Declares an element.
///
/// `required` attributes must be there; `own` ones may, but not in a default class; `classed` ones may in both. What
/// stands after `as` tells how the text is read over what the class says (see `Reading`), what stands after `=` is
/// MuJoCo's default. Groups of attributes that several elements share come under `with`, and what is no attribute under
/// `plus`.
macro_rules! table {
    (
        $(#[$doc:meta])*
        $vis:vis struct $Struct:ident {
            $(required { $( $(#[$rdoc:meta])* $rfield:ident $($rxml:literal)? : $rty:ty $(as $rhow:ty)? ; )* })?
            $(own { $( $(#[$odoc:meta])* $ofield:ident $($oxml:literal)? : $oty:ty $(as $ohow:ty)? $(= $odef:expr)? ; )* })?
            $(classed { $( $(#[$cdoc:meta])* $cfield:ident $($cxml:literal)? : $cty:ty $(as $chow:ty)? $(= $cdef:expr)? ; )* })?
            $(with { $( $(#[$wdoc:meta])* $wfield:ident : $wty:ty ; )* })?
            $(plus { $( $(#[$pdoc:meta])* $pfield:ident : $pty:ty ; )* })?
        }
    ) => {
        $(#[$doc])*
        #[derive(Clone, Debug, Default, PartialEq)]
        #[non_exhaustive]
        $vis struct $Struct {
            /// Where it stands.
            pub place: $crate::Place,
            $($( $(#[$rdoc])* pub $rfield: $rty, )*)?
            $($( $(#[$odoc])* pub $ofield: Option<$oty>, )*)?
            $($( $(#[$cdoc])* pub $cfield: Option<$cty>, )*)?
            $($( $(#[$wdoc])* pub $wfield: $wty, )*)?
            $($( $(#[$pdoc])* pub $pfield: $pty, )*)?
        }

        impl $Struct {
            $($($( $crate::table::defaulted!($ofield, $oty, $odef); )?)*)?
            $($($( $crate::table::defaulted!($cfield, $cty, $cdef); )?)*)?

            /// What the file and its classes say, attribute by attribute, as MJCF writes it.
            // Elements that do not reach the tree have nobody who asks.
            #[allow(dead_code)]
            pub fn said(&self) -> Vec<(&'static str, String)> {
                #[allow(unused_imports)]
                use $crate::value::Value;
                #[allow(unused_mut)]
                let mut said: Vec<(&'static str, String)> = Vec::new();
                $( said.extend([$( ($crate::table::xml!($rfield $($rxml)?), self.$rfield.write()), )*]); )?
                $($( said.extend(self.$ofield.as_ref().map(|it| ($crate::table::xml!($ofield $($oxml)?), it.write()))); )*)?
                $($( said.extend(self.$cfield.as_ref().map(|it| ($crate::table::xml!($cfield $($cxml)?), it.write()))); )*)?
                $($( said.extend(self.$wfield.said()); )*)?
                said
            }
        }

        impl $crate::table::Table for $Struct {
            #[allow(unused_variables)]
            fn set(&mut self, scope: $crate::table::Scope, name: &str, text: &str) -> Result<bool, $crate::value::Fault> {
                #[allow(unused_imports)]
                use $crate::{table::{Scope, xml, how, default}, reading::Reading};
                $(if scope == Scope::Element {
                    $( if name == xml!($rfield $($rxml)?) {
                        self.$rfield = <how!($($rhow)?) as Reading<$rty>>::read(text, None, None)?;
                        return Ok(true);
                    } )*
                })?
                $(if scope == Scope::Element {
                    $( if name == xml!($ofield $($oxml)?) {
                        let before = self.$ofield.as_ref();
                        self.$ofield = Some(<how!($($ohow)?) as Reading<$oty>>::read(text, before, default!($($odef)?))?);
                        return Ok(true);
                    } )*
                })?
                $($( if name == xml!($cfield $($cxml)?) {
                    let before = self.$cfield.as_ref();
                    self.$cfield = Some(<how!($($chow)?) as Reading<$cty>>::read(text, before, default!($($cdef)?))?);
                    return Ok(true);
                } )*)?
                $($( if self.$wfield.set(scope, name, text)? {
                    return Ok(true);
                } )*)?
                Ok(false)
            }

            #[allow(unused_variables)]
            fn attributes(&self, scope: $crate::table::Scope) -> Vec<&'static str> {
                #[allow(unused_imports)]
                use $crate::table::{Scope, xml};
                #[allow(unused_mut)]
                let mut names: Vec<&'static str> = Vec::new();
                $(if scope == Scope::Element {
                    names.extend([$( xml!($rfield $($rxml)?), )*]);
                })?
                $(if scope == Scope::Element {
                    names.extend([$( xml!($ofield $($oxml)?), )*]);
                })?
                $( names.extend([$( xml!($cfield $($cxml)?), )*]); )?
                $($( names.extend(self.$wfield.attributes(scope)); )*)?
                names
            }

            fn required(&self) -> &'static [&'static str] {
                &[$($( $crate::table::xml!($rfield $($rxml)?), )*)?]
            }

            fn set_place(&mut self, place: &$crate::Place) {
                self.place = place.clone();
            }

            #[allow(unused_variables)]
            fn references(&mut self, visit: &mut dyn FnMut($crate::Kind, &mut String)) {
                #[allow(unused_imports)]
                use $crate::{table::how, reading::Reading};
                $($( <how!($($rhow)?) as Reading<$rty>>::refer(&mut self.$rfield, visit); )*)?
                $($( if let Some(value) = &mut self.$ofield {
                    <how!($($ohow)?) as Reading<$oty>>::refer(value, visit);
                } )*)?
                $($( if let Some(value) = &mut self.$cfield {
                    <how!($($chow)?) as Reading<$cty>>::refer(value, visit);
                } )*)?
                $($( self.$wfield.references(visit); )*)?
            }

            fn tidy(&mut self) {
                #[allow(unused_imports)]
                use $crate::value::Value;
                $($( if self.$ofield.as_ref().is_some_and(Value::is_nothing) {
                    self.$ofield = None;
                } )*)?
                $($( if self.$cfield.as_ref().is_some_and(Value::is_nothing) {
                    self.$cfield = None;
                } )*)?
            }

            fn held(&self) -> usize {
                #[allow(unused_imports)]
                use $crate::value::Value;
                0 $($( + self.$rfield.held() )*)?
                  $($( + self.$ofield.as_ref().map_or(0, Value::held) )*)?
                  $($( + self.$cfield.as_ref().map_or(0, Value::held) )*)?
                  $($( + self.$wfield.held() )*)?
            }
        }
    };
}
pub(crate) use table;

/// The name of a field's attribute.
macro_rules! xml {
    ($field:ident) => {
        stringify!($field)
    };
    ($field:ident $xml:literal) => {
        $xml
    };
}
pub(crate) use xml;

macro_rules! how {
    () => {
        $crate::reading::Whole
    };
    ($how:ty) => {
        $how
    };
}
pub(crate) use how;

macro_rules! default {
    () => {
        None
    };
    ($default:expr) => {
        Some($default)
    };
}
pub(crate) use default;

macro_rules! defaulted {
    ($field:ident, $ty:ty, $default:expr) => {
        #[doc = concat!("`", stringify!($field), "`, else MuJoCo's default `", stringify!($default), "`.")]
        pub fn $field(&self) -> $ty {
            self.$field.unwrap_or($default)
        }
    };
}
pub(crate) use defaulted;

/// Reads the attributes of a node into tables; those in `except` count as unknown.
pub(crate) fn fill(node: &Node, scope: Scope, tables: &mut [&mut dyn Table], except: &[&str]) -> Result<(), MjcfError> {
    for attribute in &node.attributes {
        let mut known = false;
        for table in tables.iter_mut().filter(|_| !except.contains(&&*attribute.name)) {
            known =
                table.set(scope, &attribute.name, &attribute.value).map_err(|fault| fault.of(node, &attribute.name))?;
            if known {
                break;
            }
        }
        if !known {
            let mut valid: Vec<_> = tables.iter().flat_map(|table| table.attributes(scope)).collect();
            valid.retain(|name| !except.contains(name));
            return Err(unknown_attribute(node, &attribute.name, &valid));
        }
    }
    for table in tables {
        table.set_place(&node.place);
        if scope == Scope::Element {
            need(node, table.required())?;
            table.tidy();
        }
    }
    Ok(())
}

pub(crate) fn unknown_attribute(node: &Node, name: &str, valid: &[&str]) -> MjcfError {
    let nearest = nearest(name, valid);
    MjcfError::UnknownAttribute { at: node.at_attribute(name), attribute: short(name), nearest }
}

/// Every one of these attributes must be there.
pub(crate) fn need(node: &Node, attributes: &[&'static str]) -> Result<(), MjcfError> {
    match attributes.iter().find(|name| node.get(name).is_none()) {
        Some(attribute) => Err(MjcfError::Missing { at: node.at(), attribute }),
        None => Ok(()),
    }
}

/// Of these attributes at most one may be there.
pub(crate) fn exclusive(node: &Node, attributes: &[&'static str]) -> Result<(), MjcfError> {
    let mut given = attributes.iter().filter(|name| node.get(name).is_some());
    match (given.next(), given.next()) {
        (Some(first), Some(second)) => Err(MjcfError::Exclusive { at: node.at_attribute(second), first, second }),
        _ => Ok(()),
    }
}
