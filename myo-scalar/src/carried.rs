//! What loops and branches hand on.

use crate::scalar::Scalar;

/// The variables of a loop or branch: everything that its body changes and that a later run of the body, or the code after
/// it, reads. A symbolic number needs to know them; others ignore them.
pub trait Carried<S: Scalar> {
    /// Shows every variable, always in the same order and number.
    fn visit(&mut self, visitor: &mut impl Visitor<S>);
}

/// Sees variables.
pub trait Visitor<S: Scalar> {
    /// A number.
    fn number(&mut self, x: &mut S);
    /// A truth value.
    fn mask(&mut self, x: &mut S::Mask);
    /// An integer.
    fn word(&mut self, x: &mut S::Word);

    /// Numbers.
    fn numbers<'a>(&mut self, xs: impl IntoIterator<Item = &'a mut S>)
    where
        S: 'a,
    {
        for x in xs {
            self.number(x);
        }
    }
}
