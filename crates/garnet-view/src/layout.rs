//! Where things stand in a picture.

use crate::{Picture, ViewError, color_bar, image::Rect, prepared::Legend, text};

/// Free pixels between neighboring views, in dots of a letter.
const GAP: u32 = 3;

/// The places of views, captions and color bars.
#[derive(Debug)]
pub(crate) struct Layout {
    /// Pixels for a dot of a letter.
    pub(crate) text_scale: u32,
    /// One place a view.
    pub(crate) views: Vec<Rect>,
    /// One place a view, without height if there are no captions.
    pub(crate) captions: Vec<Rect>,
    /// One place a legend, or none at all.
    pub(crate) bars: Vec<Rect>,
}

impl Layout {
    /// Divides a picture.
    pub(crate) fn new(picture: &Picture<'_>, legends: &[Legend<'_>]) -> Result<Self, ViewError> {
        let (width, height) = (picture.width, picture.height);
        let num_views = picture.views.len();
        let no_room = ViewError::NoRoom {
            num_views,
            width,
            height,
        };
        let text_scale = (width.min(height) / 400).max(1);
        let bar_width = color_bar::width(legends, text_scale);
        let bar_width = if bar_width <= width / 2 { bar_width } else { 0 };
        let free_width = width - bar_width;
        let Ok(num_views) = u32::try_from(num_views) else {
            return Err(no_room);
        };
        let num_columns = match picture.columns {
            None | Some(0) => num_views,
            Some(columns) => columns.min(num_views),
        };
        let num_rows = num_views.div_ceil(num_columns);
        if num_columns > free_width || num_rows > height {
            return Err(no_room);
        }
        let has_captions = picture.views.iter().any(|view| !view.caption.is_empty());
        let caption_height = 2 * text::height(text_scale);
        let caption_height = if has_captions && 3 * caption_height <= height / num_rows {
            caption_height
        } else {
            0
        };
        let cells = (0..num_views).map(|view| {
            let (column, row) = (view % num_columns, view / num_columns);
            let (left, right) = share(free_width, column, num_columns);
            let (top, bottom) = share(height, row, num_rows);
            let is_last = column + 1 == num_columns;
            let gap = if is_last { 0 } else { GAP * text_scale };
            let right = if gap < (right - left) / 8 {
                right - gap
            } else {
                right
            };
            Rect {
                x: left,
                y: top,
                width: right - left,
                height: bottom - top,
            }
        });
        let views: Vec<_> = cells
            .map(|cell| Rect {
                height: cell.height - caption_height,
                ..cell
            })
            .collect();
        let captions = views.iter().map(|view| Rect {
            y: view.y + view.height,
            height: caption_height,
            ..*view
        });
        let num_bars = if bar_width == 0 {
            0
        } else {
            legends.len() as u32
        };
        let bars = (0..num_bars).map(|bar| {
            let (top, bottom) = share(height, bar, num_bars);
            Rect {
                x: free_width,
                y: top,
                width: bar_width,
                height: bottom - top,
            }
        });
        Ok(Self {
            text_scale,
            captions: captions.collect(),
            bars: bars.collect(),
            views,
        })
    }
}

/// The ends of one of `count` nearly equal parts of a length.
fn share(length: u32, part: u32, count: u32) -> (u32, u32) {
    // No picture is large enough for the products to overflow.
    let end = |part: u32| (u64::from(length) * u64::from(part) / u64::from(count)) as u32;
    (end(part), end(part + 1))
}
