//! The same numbers from every instruction set and any number of threads.

use garnet_kernel::{
    Activation, Features, InstructionSet, NeighborTable, Workspace, neighbor_max_backward,
    neighbor_max_forward, neighbor_mean_backward, neighbor_mean_forward,
};

use crate::values::{ROUNDING, Values, assert_close, wide};
use crate::{feast, linear};

/// All results of all kernels on sizes that are no multiples of anything.
fn everything(workspace: &Workspace) -> Vec<(&'static str, Vec<f32>)> {
    let mut results: Vec<(&'static str, Vec<f32>)> = Vec::new();
    for case in [
        feast::Case::new(700, &[64, 3], 8, 33),
        feast::Case::new(2500, &[19], 9, 7),
        feast::Case::new(131, &[1], 1, 1),
        feast::Case::new(150, &[131], 16, 20),
    ] {
        let outcome = case.run(workspace);
        results.extend(
            outcome
                .tensors()
                .into_iter()
                .map(|(name, values)| (name, values.to_vec())),
        );
    }
    for case in [
        linear::Case::new(1000, &[67, -40, 130], 70, Activation::LeakyRelu),
        linear::Case::new(3, &[5], 2, Activation::None),
    ] {
        let outcome = case.run(workspace);
        results.extend(
            outcome
                .tensors()
                .into_iter()
                .map(|(name, values)| (name, values.to_vec())),
        );
    }
    let mut values = Values::new(7);
    let (rows, sources, k, channels) = (700, 90, 15, 37);
    let table =
        NeighborTable::new(sources, k, values.indices(rows * k, sources)).expect("in range");
    let (x, dy) = (
        values.numbers(sources * channels),
        values.numbers(rows * channels),
    );
    let (x, dy) = (Features::new(&x, channels), Features::new(&dy, channels));
    let (mut y, mut largest) = (vec![0.0; rows * channels], vec![0; rows * channels]);
    let mut dx = vec![0.0; sources * channels];
    neighbor_max_forward(&table, x, &mut y, &mut largest, workspace);
    neighbor_max_backward(&table, &largest, dy, &mut dx, workspace);
    results.extend([("max", y.clone()), ("dx of max", dx.clone())]);
    neighbor_mean_forward(&table, x, &mut y, workspace);
    neighbor_mean_backward(&table, dy, &mut dx, workspace);
    results.extend([("mean", y), ("dx of mean", dx)]);
    results
}

#[test]
fn all_instruction_sets_agree() {
    let best = everything(&Workspace::new());
    for instructions in InstructionSet::available() {
        let found = everything(&Workspace::with_instructions(instructions));
        for ((name, found), (_, expected)) in found.iter().zip(&best) {
            assert_close(name, found, &wide(expected), ROUNDING);
        }
    }
}

#[test]
fn levels_are_switched_off_for_workspaces_that_are_made_afterwards() {
    // Other tests of this process may use workspaces meanwhile: results agree, as above.
    let before = Workspace::new();
    InstructionSet::Portable.limit();
    assert_eq!(Workspace::new().instructions(), InstructionSet::Portable);
    assert_eq!(before.instructions(), InstructionSet::detected());
    InstructionSet::Avx512.limit();
    assert_eq!(Workspace::new().instructions(), InstructionSet::detected());
}

#[test]
fn results_do_not_depend_on_the_number_of_threads_nor_on_what_was_computed_before() {
    let workspace = Workspace::new();
    let run = |num_threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(num_threads)
            .build()
            .expect("threads");
        pool.install(|| everything(&workspace))
    };
    let one = run(1);
    for num_threads in [2, 3, 4] {
        for ((name, found), (_, expected)) in run(num_threads).iter().zip(&one) {
            let same = found
                .iter()
                .zip(expected)
                .all(|(a, b)| a.to_bits() == b.to_bits());
            assert!(same, "{name} differs with {num_threads} threads");
        }
    }
}
