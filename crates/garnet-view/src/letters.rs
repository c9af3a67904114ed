//! The letters of charts: a part of `DejaVu` Sans, so that every machine draws the same.

use std::sync::OnceLock;

use plotters::style::{FontStyle, register_font};

/// The name that charts use; what shows an SVG takes its own letters of that kind.
pub(crate) const FAMILY: &str = "sans-serif";

/// Makes the letters known to the plotter.
pub(crate) fn ready() -> Result<(), String> {
    static READY: OnceLock<bool> = OnceLock::new();
    let is_ready = *READY.get_or_init(|| {
        let fonts: [(FontStyle, &'static [u8]); 2] = [
            (
                FontStyle::Normal,
                include_bytes!("../assets/DejaVuSans.ttf"),
            ),
            (
                FontStyle::Bold,
                include_bytes!("../assets/DejaVuSans-Bold.ttf"),
            ),
        ];
        fonts
            .into_iter()
            .all(|(style, bytes)| register_font(FAMILY, style, bytes).is_ok())
    });
    if is_ready {
        Ok(())
    } else {
        Err("the letters cannot be read".to_owned())
    }
}
