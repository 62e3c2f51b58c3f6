//! What the stencil does for each kind of count.
//!
//! z-pass: T. Heidmann, "Real Shadows, Real Time", 1991. z-fail: B. Bilodeau, M. Songy, "Real Time Shadows", 1999; J.
//! Carmack, correspondence, 2000. Formulas: docs/volume.md#counting.

use wgpu::{CompareFunction, Face, StencilFaceState, StencilOperation};

/// Which side of the surface faces are counted on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    /// Before it: entering adds, leaving takes away.
    Before,
    /// Behind it: leaving adds, entering takes away.
    Behind,
}

/// One draw of volume faces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Counting {
    /// Where faces are counted.
    pub(super) side: Side,
    /// The faces are wound inward: front and back change places.
    pub(super) inward: bool,
    /// The stencil stops at its ends instead of wrapping.
    pub(super) clamps: bool,
    /// Faces at exactly the surface's depth count as before it.
    pub(super) inclusive: bool,
}

/// The two halves of a count drawn in two passes; additions come first, so that a stencil that stops at 0 loses as
/// little as it can.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Half {
    /// Faces that add.
    Additions,
    /// Faces that take away.
    Subtractions,
}

impl Counting {
    /// Stencil operations of front and back faces.
    pub(super) fn faces(self) -> [StencilFaceState; 2] {
        let (add, subtract) = if self.clamps {
            (StencilOperation::IncrementClamp, StencilOperation::DecrementClamp)
        } else {
            (StencilOperation::IncrementWrap, StencilOperation::DecrementWrap)
        };
        let state = |operation| {
            let keep = StencilFaceState { compare: CompareFunction::Always, ..StencilFaceState::IGNORE };
            match self.side {
                Side::Before => StencilFaceState { pass_op: operation, ..keep },
                Side::Behind => StencilFaceState { depth_fail_op: operation, ..keep },
            }
        };
        if self.front_adds() { [state(add), state(subtract)] } else { [state(subtract), state(add)] }
    }

    /// The faces to cull so that one half remains.
    pub(super) fn culled(self, half: Half) -> Face {
        if self.front_adds() == (half == Half::Additions) { Face::Back } else { Face::Front }
    }

    /// The depth comparison that tells before from behind.
    pub(super) fn depth_compare(self, reversed: bool) -> CompareFunction {
        match (reversed, self.inclusive) {
            (true, false) => CompareFunction::Greater,
            (true, true) => CompareFunction::GreaterEqual,
            (false, false) => CompareFunction::Less,
            (false, true) => CompareFunction::LessEqual,
        }
    }

    fn front_adds(self) -> bool {
        (self.side == Side::Before) != self.inward
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counting(side: Side, inward: bool) -> Counting {
        Counting { side, inward, clamps: false, inclusive: false }
    }

    #[test]
    fn entering_adds_before_and_takes_away_behind() {
        let [front, back] = counting(Side::Before, false).faces();
        assert_eq!(front.pass_op, StencilOperation::IncrementWrap);
        assert_eq!(back.pass_op, StencilOperation::DecrementWrap);
        let [front, back] = counting(Side::Behind, false).faces();
        assert_eq!(front.depth_fail_op, StencilOperation::DecrementWrap);
        assert_eq!(back.depth_fail_op, StencilOperation::IncrementWrap);
        assert_eq!((front.pass_op, front.fail_op), (StencilOperation::Keep, StencilOperation::Keep));
    }

    #[test]
    fn inward_faces_exchange_front_and_back() {
        for side in [Side::Before, Side::Behind] {
            let [front, back] = counting(side, false).faces();
            assert_eq!(counting(side, true).faces(), [back, front]);
        }
    }

    #[test]
    fn a_half_keeps_the_faces_of_its_sign() {
        assert_eq!(counting(Side::Behind, false).culled(Half::Additions), Face::Front);
        assert_eq!(counting(Side::Before, false).culled(Half::Additions), Face::Back);
        assert_eq!(counting(Side::Behind, true).culled(Half::Subtractions), Face::Front);
    }
}
