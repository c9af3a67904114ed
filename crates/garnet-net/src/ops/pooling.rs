//! Maxima, with or without a trace of where they come from.

use garnet_kernel::{Features, NeighborTable, Workspace, global_max_forward, neighbor_max_forward};

pub(super) fn global_max(
    input: Features<'_>,
    output: &mut [f32],
    trace: Option<&mut Vec<u32>>,
    workspace: &Workspace,
) {
    let mut unwanted = Vec::new();
    let trace = trace.unwrap_or(&mut unwanted);
    trace.resize(output.len(), 0);
    global_max_forward(input, output, trace, workspace);
}

pub(super) fn neighbor_max(
    table: &NeighborTable,
    input: Features<'_>,
    output: &mut [f32],
    trace: Option<&mut Vec<u32>>,
    workspace: &Workspace,
) {
    let mut unwanted = Vec::new();
    let trace = match trace {
        Some(trace) => {
            trace.resize(output.len(), 0);
            trace
        }
        None => &mut unwanted,
    };
    neighbor_max_forward(table, input, output, trace, workspace);
}
