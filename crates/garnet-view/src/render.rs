//! From a description to pixels.

use rayon::prelude::*;

use crate::{
    Image, Picture, View, ViewError, color_bar,
    image::Rect,
    layout::Layout,
    lens::Lens,
    letters,
    lighting::Studio,
    occlusion::Occlusion,
    palette,
    prepared::{Coat, Legend, Prepared, prepared},
    raster::Bands,
    resolve::{BAND_ROWS, Drawing},
    scene::Scene,
    text::{self, Pen},
};

/// Draws a picture.
///
/// The same picture gives the same bytes with any number of threads.
///
/// # Errors
///
/// What [`ViewError`] names, but [`ViewError::Encode`] and [`ViewError::Write`].
pub fn render(picture: &Picture<'_>) -> Result<Image, ViewError> {
    picture.check()?;
    letters::ready()?;
    let layers = prepared(picture)?;
    let legends = legends(&picture.views, &layers);
    let layout = Layout::new(picture, &legends)?;
    let mut image = Image::filled(picture.width, picture.height, picture.background);
    for (view, &rect) in picture.views.iter().zip(&layout.views) {
        draw_view(&mut image, picture, &layers, view, rect);
    }
    // All captions of a picture have one size, in which the longest is whole.
    let captions = picture.views.iter().zip(&layout.captions);
    let is_whole = |scale: u32| {
        let mut captions = captions.clone();
        captions.all(|(view, rect)| text::width(&view.caption, scale) <= rect.width)
    };
    let caption_scale = (1..=layout.text_scale)
        .rev()
        .find(|&scale| is_whole(scale))
        .unwrap_or(1);
    for (view, &rect) in captions.clone() {
        draw_caption(&mut image, &view.caption, rect, caption_scale)?;
    }
    for (legend, &rect) in legends.iter().zip(&layout.bars) {
        color_bar::draw(&mut image, legend, rect, layout.text_scale)?;
    }
    Ok(image)
}

/// The layers that a view names, or all.
fn chosen(named: Option<&Vec<usize>>, num_layers: usize) -> Vec<usize> {
    named.map_or_else(|| (0..num_layers).collect(), Clone::clone)
}

/// What the bars must tell, each thing once.
fn legends<'a>(views: &[View], layers: &'a [Prepared<'a>]) -> Vec<Legend<'a>> {
    let mut legends = Vec::new();
    for (index, layer) in layers.iter().enumerate() {
        let is_shown = views
            .iter()
            .any(|view| chosen(view.shown.as_ref(), layers.len()).contains(&index));
        if let (true, Coat::Heat(scale)) = (is_shown, &layer.coat)
            && !legends.contains(&scale.legend)
        {
            legends.push(scale.legend);
        }
    }
    legends
}

fn draw_view(
    image: &mut Image,
    picture: &Picture<'_>,
    layers: &[Prepared<'_>],
    view: &View,
    rect: Rect,
) {
    let size = [rect.width, rect.height];
    let framed = chosen(view.framed.as_ref(), layers.len());
    // Vertices without faces are not seen, so they need no room.
    let points = framed.iter().flat_map(|&layer| {
        let mesh = layers[layer].layer.mesh;
        let corners = mesh.faces().iter().flatten();
        corners.map(move |&vertex| mesh.positions()[vertex as usize])
    });
    let lens = Lens::framing(&view.camera, points, size);
    let studio = Studio::new(&lens);
    let shown = chosen(view.shown.as_ref(), layers.len());
    let scene = Scene::new(lens, layers, &shown);
    let groups = scene.groups();
    let num_bands = rect.height.div_ceil(BAND_ROWS) as usize;
    let bands = groups
        .par_iter()
        .map(|group| Bands::new(&group.pieces, f64::from(BAND_ROWS), num_bands))
        .collect();
    let drawing = Drawing {
        scene: &scene,
        studio,
        occlusion: Occlusion::new(&scene, &groups[0].pieces, size),
        groups: &groups,
        bands,
        background: picture.background,
        supersampling: picture.supersampling as usize,
        rect,
    };
    let row_bytes = 3 * image.width() as usize;
    image
        .rows_mut(rect.y, rect.y + rect.height)
        .par_chunks_mut(BAND_ROWS as usize * row_bytes)
        .enumerate()
        .for_each(|(band, rows)| drawing.draw_band(band, rows, row_bytes));
}

fn draw_caption(image: &mut Image, caption: &str, rect: Rect, scale: u32) -> Result<(), ViewError> {
    if rect.height == 0 {
        return Ok(());
    }
    let line = text::fitted(caption, scale, rect.width);
    let pen = Pen {
        x: rect.x + (rect.width - text::width(&line, scale).min(rect.width)) / 2,
        y: rect.y + (rect.height - text::height(scale).min(rect.height)) / 2,
        scale,
        color: palette::INK,
    };
    text::draw(image, &line, pen)
}

#[cfg(test)]
mod tests;
