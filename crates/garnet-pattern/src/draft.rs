//! What a cutter draws: the outlines of the left half of a garment.

use crate::curve::Polyline;

/// The two layers of a garment that lies on a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Layer {
    Front,
    Back,
}

/// What an arc of an outline meets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Meets {
    /// The arc of the same name of another patch of this side.
    Seam,
    /// A fold within a panel: as a seam, but no thread runs there.
    Fold,
    /// Its own mirror image across a seam in the middle.
    MiddleSeam,
    /// Its own mirror image, within the panel.
    MiddleFold,
    /// Nothing: neck, cuff, hem.
    Rim,
}

/// One named side of a patch, in its counter-clockwise order seen from the front.
#[derive(Debug, Clone)]
pub(crate) struct Arc {
    /// Arcs of the same name are sampled alike and sewn.
    pub(crate) name: &'static str,
    pub(crate) meets: Meets,
    /// Whether this patch runs through the named line from its end to its start.
    pub(crate) is_reversed: bool,
    /// In the flat pattern, in the patch's own direction, in metres.
    pub(crate) flat: Polyline,
    /// The same line in the chart of the start shape: equal lengths of the flat line lie between
    /// its points.
    pub(crate) chart: Polyline,
    /// Whether front and back close here in the start shape.
    pub(crate) closes: bool,
    /// Whether points of this line keep their places on its bends while parameters change; arcs
    /// of the same name follow it.
    pub(crate) guides: bool,
}

impl Arc {
    pub(crate) fn new(
        name: &'static str,
        meets: Meets,
        is_reversed: bool,
        flat: Polyline,
        chart: Polyline,
    ) -> Self {
        Self {
            name,
            meets,
            is_reversed,
            flat,
            chart,
            closes: false,
            guides: false,
        }
    }

    /// The same arc, where front and back close in the start shape.
    pub(crate) fn closing(mut self) -> Self {
        self.closes = true;
        self
    }

    /// The same arc, a bent one that keeps its points on its bends.
    pub(crate) fn guiding(mut self) -> Self {
        self.guides = true;
        self
    }
}

/// A piece of one layer of the left half, meshed on its own.
#[derive(Debug, Clone)]
pub(crate) struct Patch {
    /// The panel it belongs to; panels that are cut twice get `left` and `right` before it.
    pub(crate) panel: &'static str,
    /// Whether left and right are panels of their own.
    pub(crate) is_cut_twice: bool,
    pub(crate) layer: Layer,
    /// Rest lengths are those of the flat pattern times this.
    pub(crate) shrink: f32,
    /// Counter-clockwise, each beginning where the one before ends.
    pub(crate) arcs: Vec<Arc>,
}

/// All patches of the left half, those of a panel one after another.
#[derive(Debug, Clone)]
pub(crate) struct Draft {
    pub(crate) patches: Vec<Patch>,
}
