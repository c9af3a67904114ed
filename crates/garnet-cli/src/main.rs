//! The `garnet` command.

fn main() {}
