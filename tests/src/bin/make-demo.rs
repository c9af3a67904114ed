//! Writes the files of `models/demo` anew: `cargo run -p garnet-tests --bin make-demo`.

use garnet_tests::demo::Demo;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    Demo::new().write()
}
