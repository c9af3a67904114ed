//! The passes of untangling, one a file but for `flatten`, which is in that of `follow`;
//! [`untangle`](crate::untangle) lists them in the order in which it runs them.

mod ease;
mod follow;
mod give_in;
mod lift;
mod mend;
mod push;
mod relax;
mod rescue;
mod retreat;
mod unfold;
mod verify;

pub(crate) use ease::ease;
pub(crate) use follow::{flatten, follow};
pub(crate) use give_in::give_in;
pub(crate) use lift::lift;
pub(crate) use mend::mend;
pub(crate) use push::push;
pub(crate) use relax::{StretchRange, clamped_edges, relax};
pub(crate) use rescue::rescue;
pub(crate) use retreat::retreat;
pub(crate) use unfold::unfold;
pub(crate) use verify::verify;
