//! Curves in the plane of the cloth, as dense polylines.

/// A point of the flat pattern or of a chart.
pub(crate) type Point2 = [f64; 2];

/// Points of a curve, first to last.
pub(crate) type Polyline = Vec<Point2>;

pub(crate) fn lerp(a: Point2, b: Point2, share: f64) -> Point2 {
    [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])]
}

pub(crate) fn distance(a: Point2, b: Point2) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// A straight line.
pub(crate) fn line(a: Point2, b: Point2) -> Polyline {
    vec![a, b]
}

/// A cubic Bézier curve.
pub(crate) fn bezier(a: Point2, b: Point2, c: Point2, d: Point2) -> Polyline {
    const STEPS: usize = 64;
    let at = |step: usize| {
        let t = step as f64 / STEPS as f64;
        let (ab, bc, cd) = (lerp(a, b, t), lerp(b, c, t), lerp(c, d, t));
        lerp(lerp(ab, bc, t), lerp(bc, cd, t), t)
    };
    (0..=STEPS).map(at).collect()
}

/// A smooth curve through points: a Catmull-Rom spline with centripetal tangents.
pub(crate) fn spline(points: &[Point2]) -> Polyline {
    const STEPS: usize = 24;
    let last = points.len() - 1;
    let tangent = |i: usize| -> Point2 {
        if i == 0 || i == last {
            let (a, b) = if i == 0 { (0, 1) } else { (last - 1, last) };
            return [
                (points[b][0] - points[a][0]) / distance(points[a], points[b]),
                (points[b][1] - points[a][1]) / distance(points[a], points[b]),
            ];
        }
        let before = distance(points[i - 1], points[i]);
        let after = distance(points[i], points[i + 1]);
        let along = |axis: usize| {
            let first = (points[i][axis] - points[i - 1][axis]) / before;
            let second = (points[i + 1][axis] - points[i][axis]) / after;
            (first * after + second * before) / (before + after)
        };
        [along(0), along(1)]
    };
    let mut curve = vec![points[0]];
    for i in 0..last {
        let (a, d) = (points[i], points[i + 1]);
        let third = distance(a, d) / 3.0;
        let (from, to) = (tangent(i), tangent(i + 1));
        let b = [a[0] + third * from[0], a[1] + third * from[1]];
        let c = [d[0] - third * to[0], d[1] - third * to[1]];
        let piece = bezier(a, b, c, d);
        let step = piece.len() / STEPS;
        curve.extend(piece.into_iter().skip(step).step_by(step));
        curve.push(d);
    }
    curve.dedup_by(|a, b| distance(*a, *b) < 1e-9);
    curve
}

/// The length of a polyline.
pub(crate) fn length(curve: &[Point2]) -> f64 {
    curve
        .windows(2)
        .map(|pair| distance(pair[0], pair[1]))
        .sum()
}

/// The point at a share of the length of a polyline.
pub(crate) fn along(curve: &[Point2], share: f64) -> Point2 {
    let wanted = share * length(curve);
    let mut before = 0.0;
    for pair in curve.windows(2) {
        let size = distance(pair[0], pair[1]);
        if before + size >= wanted && size > 0.0 {
            return lerp(pair[0], pair[1], ((wanted - before) / size).clamp(0.0, 1.0));
        }
        before += size;
    }
    curve[curve.len() - 1]
}

/// `pieces + 1` points of a polyline at equal distances along it.
pub(crate) fn resampled(curve: &[Point2], pieces: usize) -> Polyline {
    let total = length(curve);
    let mut points = Vec::with_capacity(pieces + 1);
    points.push(curve[0]);
    let (mut segment, mut before) = (0, 0.0);
    for piece in 1..pieces {
        let wanted = total * piece as f64 / pieces as f64;
        loop {
            let size = distance(curve[segment], curve[segment + 1]);
            if before + size >= wanted || segment + 2 == curve.len() {
                let share = ((wanted - before) / size.max(1e-12)).clamp(0.0, 1.0);
                points.push(lerp(curve[segment], curve[segment + 1], share));
                break;
            }
            before += size;
            segment += 1;
        }
    }
    points.push(curve[curve.len() - 1]);
    points
}

/// The points at shares of the length of a polyline.
pub(crate) fn at_shares(curve: &[Point2], shares: &[f64]) -> Polyline {
    shares.iter().map(|&share| along(curve, share)).collect()
}

/// Where shares of the length of a polyline lie, in numbers of its points.
pub(crate) fn places(curve: &[Point2], shares: &[f64]) -> Vec<f64> {
    let total = length(curve);
    let place = |&share: &f64| {
        let mut before = 0.0;
        for (number, pair) in curve.windows(2).enumerate() {
            let size = distance(pair[0], pair[1]);
            if before + size >= share * total && size > 0.0 {
                return number as f64 + ((share * total - before) / size).clamp(0.0, 1.0);
            }
            before += size;
        }
        (curve.len() - 1) as f64
    };
    shares.iter().map(place).collect()
}

/// Which shares of the length lie at places in numbers of points.
pub(crate) fn shares_at(curve: &[Point2], places: &[f64]) -> Vec<f64> {
    let total = length(curve);
    let share = |&place: &f64| {
        let number = (place as usize).min(curve.len() - 2);
        let rest = (place - number as f64) * distance(curve[number], curve[number + 1]);
        (length(&curve[..=number]) + rest) / total
    };
    places.iter().map(share).collect()
}

/// `pieces + 1` points of a polyline at equal steps of its points' numbers.
pub(crate) fn stepped(curve: &[Point2], pieces: usize) -> Polyline {
    let last = curve.len() - 1;
    let at = |piece: usize| {
        let place = (piece * last) as f64 / pieces as f64;
        let before = (place as usize).min(last - 1);
        lerp(curve[before], curve[before + 1], place - before as f64)
    };
    (0..=pieces).map(at).collect()
}

/// A neckline, from its side to the middle, moved into its hole by a distance: along the shoulder
/// at the side, square to itself elsewhere. Its points lie where those of [`resampled`] do.
pub(crate) fn inside_of(neckline: &[Point2], shoulder_tip: Point2, by: f64) -> Polyline {
    const STEPS: usize = 96;
    let outer = resampled(neckline, STEPS);
    let unit = |from: Point2, to: Point2| {
        let size = distance(from, to).max(1e-12);
        [(to[0] - from[0]) / size, (to[1] - from[1]) / size]
    };
    let shoulder = unit(shoulder_tip, outer[0]);
    let moved = |i: usize| {
        let along = unit(outer[i.saturating_sub(1)], outer[(i + 1).min(STEPS)]);
        let fade = smoothstep(0.0, 0.3, i as f64 / STEPS as f64);
        let way = unit([0.0; 2], lerp(shoulder, [along[1], -along[0]], fade));
        [outer[i][0] + by * way[0], outer[i][1] + by * way[1]]
    };
    let mut inner: Polyline = (0..=STEPS).map(moved).collect();
    inner[STEPS][0] = 0.0;
    inner
}

/// The same curve from its end.
pub(crate) fn reversed(curve: &[Point2]) -> Polyline {
    curve.iter().rev().copied().collect()
}

/// Linear interpolation in a table of increasing arguments, constant beyond its ends.
pub(crate) fn interpolated(table: &[(f64, f64)], at: f64) -> f64 {
    let after = table.partition_point(|&(x, _)| x < at);
    if after == 0 {
        return table[0].1;
    }
    if after == table.len() {
        return table[after - 1].1;
    }
    let ((x0, y0), (x1, y1)) = (table[after - 1], table[after]);
    y0 + (y1 - y0) * (at - x0) / (x1 - x0).max(1e-12)
}

/// A smooth step from 0 at `low` to 1 at `high`.
pub(crate) fn smoothstep(low: f64, high: f64, at: f64) -> f64 {
    let t = ((at - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
