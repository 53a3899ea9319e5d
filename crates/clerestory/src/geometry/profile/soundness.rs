//! What a section must be before rays are sent through it.

use std::f64::consts::TAU;

use super::Piece;
use super::part::Part;
use crate::error::{Error, Result};

/// Pieces and ends nearer than this share of their lengths touch.
pub(super) const NEAR: f64 = 1e-9;
/// About a joint, over this share of the shorter piece, no crossing is looked for: pieces may join smoothly there.
const JOINT: f64 = 1e-4;

type Point = [f64; 2];

pub(super) fn fail<T>(what: &str, remedy: &str) -> Result<T> {
    Err(Error::Argument(format!("profile: {what} ({remedy})")))
}

/// A place in millimetres, with as many digits as tell it from others nearby.
pub(super) fn place([z, y]: Point) -> String {
    let short = |m: f64| {
        let text = format!("{:.6}", m * 1e3);
        let text = text.trim_end_matches('0').trim_end_matches('.');
        if text == "-0" { "0".into() } else { text.to_owned() }
    };
    format!("z = {} mm, y = {} mm", short(z), short(y))
}

/// Each piece by itself.
pub fn pieces(pieces: &[Piece], period: f64) -> Result<()> {
    if !(period.is_finite() && period > 0.0) {
        return fail(&format!("its period is {} mm", period * 1e3), "give a pitch above 0");
    }
    if pieces.is_empty() {
        return fail("the section is empty", "give at least one piece");
    }
    for (k, piece) in pieces.iter().enumerate() {
        let number = k + 1;
        let numbers = [piece.from[0], piece.from[1], piece.to[0], piece.to[1], piece.turn];
        if !numbers.iter().all(|v| v.is_finite()) {
            return fail(
                &format!("piece {number} has an end or a turn that is not a finite number"),
                "check its coordinates",
            );
        }
        let length = distance(piece.from, piece.to);
        let size = numbers[..4].iter().fold(period, |a, b| a.max(b.abs()));
        if length <= 1e-12 * size {
            return fail(
                &format!("piece {number} at {} has no length", place(piece.from)),
                "leave it out, or draw a full circle as two half circles",
            );
        }
        if piece.turn.abs() >= TAU * (1.0 - 1e-9) {
            return fail(
                &format!(
                    "piece {number} from {} turns through {}°",
                    place(piece.from),
                    piece.turn.to_degrees()
                ),
                "give less than 360°",
            );
        }
    }
    Ok(())
}

fn distance(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn shifted([z, y]: Point, shift: f64) -> Point {
    [z, y + shift]
}

/// No two pieces may cross or touch other than end to end, within a period and beyond.
pub fn crossings(parts: &[Part], period: f64) -> Result<()> {
    // All copies that can be met going up from the part itself, by their lowest points.
    let tallest = parts.iter().map(|p| p.y[1] - p.y[0]).fold(0.0, f64::max);
    let lowest = parts.iter().map(|p| p.y[0]).fold(f64::INFINITY, f64::min);
    let highest = parts.iter().map(|p| p.y[0]).fold(f64::NEG_INFINITY, f64::max);
    let copies = 1.0 + (tallest / period).ceil() + ((highest - lowest) / period).ceil();
    if copies * parts.len() as f64 > 1e8 {
        return fail(
            &format!("it reaches over {copies} periods"),
            "give the pieces of one period, about as high as the period",
        );
    }
    let mut starts: Vec<(f64, f64, usize)> = Vec::new();
    for (k, part) in parts.iter().enumerate() {
        // The copy that begins in the first period above the lowest point.
        let home = -((part.y[0] - lowest) / period).floor();
        for n in 0..=((tallest / period).ceil() as i32 + 1) {
            let shift = (home + f64::from(n)) * period;
            starts.push((part.y[0] + shift, shift, k));
        }
    }
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (i, &(start, shift, k)) in starts.iter().enumerate() {
        if start >= lowest + period * (1.0 + NEAR) {
            break;
        }
        let part = &parts[k];
        let slack = NEAR * part.half;
        let end = part.y[1] + shift + slack;
        for &(_, other_shift, j) in starts[i + 1..].iter().take_while(|o| o.0 <= end) {
            let other = &parts[j];
            if other.z[0] <= part.z[1] + slack
                && part.z[0] <= other.z[1] + slack
                && let Some(at) = meeting(part, other, other_shift - shift)
            {
                return refuse(part, other, at);
            }
        }
    }
    Ok(())
}

fn refuse<T>(part: &Part, other: &Part, at: Point) -> Result<T> {
    let (a, b) = (part.piece.min(other.piece) + 1, part.piece.max(other.piece) + 1);
    if a == b {
        fail(
            &format!(
                "piece {a} crosses or touches itself or its own copy a period further at {}",
                place(at)
            ),
            "make the period greater or the piece smaller",
        )
    } else {
        fail(
            &format!("pieces {a} and {b} cross or touch at {}", place(at)),
            "keep them or their copies a period further apart, or end both where they meet",
        )
    }
}

/// Where two parts meet other than end to end; the second is shifted along y.
fn meeting(a: &Part, b: &Part, shift: f64) -> Option<Point> {
    let shorter = a.half.min(b.half);
    let tolerance = NEAR * (a.half + b.half);
    let b_ends = b.ends.map(|e| shifted(e, shift));
    let b_middle = shifted(b.middle, shift);
    let joints: Vec<Point> = a
        .ends
        .into_iter()
        .filter(|&e| b_ends.iter().any(|&f| distance(e, f) <= tolerance))
        .collect();
    let at_a_joint = |p: Point, near: f64| joints.iter().any(|&j| distance(j, p) <= near);
    // An end or the middle of one on the other: also where they lie on each other.
    for p in [a.ends[0], a.ends[1], a.middle] {
        if !at_a_joint(p, tolerance) && lies_on(p, b, b_middle, tolerance) {
            return Some(p);
        }
    }
    for p in [b_ends[0], b_ends[1], b_middle] {
        if !at_a_joint(p, tolerance) && lies_on(p, a, a.middle, tolerance) {
            return Some(p);
        }
    }
    crossings_of(a, b, b_middle)
        .into_iter()
        .flatten()
        .find(|&p| !at_a_joint(p, JOINT * shorter) && covers(a, a.middle, p) && covers(b, b_middle, p))
}

fn covers(part: &Part, middle: Point, p: Point) -> bool {
    part.covers([p[0] - middle[0], p[1] - middle[1]], 0.0)
}

/// Whether a point lies on a part whose middle is given.
fn lies_on(p: Point, part: &Part, middle: Point, tolerance: f64) -> bool {
    let p = [p[0] - middle[0], p[1] - middle[1]];
    // Distance to the line or circle, to first order.
    let square = p[0] * p[0] + p[1] * p[1];
    let off = 0.5 * part.curvature * square - (part.normal[0] * p[0] + part.normal[1] * p[1]);
    off.abs() <= tolerance && part.covers(p, tolerance)
}

/// Where two parts' lines or circles cross: none, one or two places.
fn crossings_of(a: &Part, b: &Part, b_middle: Point) -> [Option<Point>; 2] {
    if a.curvature == 0.0 {
        return through(a.middle, a.along(), b, b_middle);
    }
    if b.curvature == 0.0 {
        return through(b_middle, b.along(), a, a.middle);
    }
    // Two circles cross on their radical line: the difference of their equations.
    let o = [a.middle[0] - b_middle[0], a.middle[1] - b_middle[1]];
    let (ka, kb) = (a.curvature, b.curvature);
    // With p from a's middle: ka p²/2 = na·p and kb (p + o)²/2 = nb·(p + o). Times kb and ka:
    let normal = [0, 1].map(|d| ka * (b.normal[d] - kb * o[d]) - kb * a.normal[d]);
    let rest = ka * (0.5 * kb * (o[0] * o[0] + o[1] * o[1]) - (b.normal[0] * o[0] + b.normal[1] * o[1]));
    let square = normal[0] * normal[0] + normal[1] * normal[1];
    // Circles about one point have none.
    if square <= (1e-12 * ka * kb).powi(2) * (a.half * a.half + b.half * b.half) {
        return [None; 2];
    }
    let foot = [0, 1].map(|d| a.middle[d] + normal[d] * rest / square);
    let length = square.sqrt();
    through(foot, [-normal[1] / length, normal[0] / length], a, a.middle)
}

/// Where the line through a point crosses a part's line or circle.
fn through(from: Point, along: Point, part: &Part, middle: Point) -> [Option<Point>; 2] {
    let o = [from[0] - middle[0], from[1] - middle[1]];
    let n = part.normal;
    let nearest = -(o[0] * along[0] + o[1] * along[1]);
    let q = along[0] * o[1] - along[1] * o[0];
    let c = n[0] * along[0] + n[1] * along[1];
    let m = n[1] * along[0] - n[0] * along[1];
    let kq = part.curvature * q;
    let root = (c * c + kq * (2.0 * m - kq)).sqrt();
    let sum = c + root.copysign(c);
    // Parallel lines cross nowhere that counts: far away, or all along, which the ends tell.
    [sum / part.curvature, q * (kq - 2.0 * m) / sum].map(|t| {
        let t = nearest + t;
        t.is_finite().then(|| [from[0] + along[0] * t, from[1] + along[1] * t])
    })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::super::testing::{arc, segment, slat};
    use super::super::{Piece, Profile};

    fn refusal(pieces: &[Piece], period: f64) -> String {
        Profile::new(pieces, period).expect_err("it is not sound").to_string()
    }

    fn sound(pieces: &[Piece], period: f64) {
        if let Err(error) = Profile::new(pieces, period) {
            panic!("{error}");
        }
    }

    #[test]
    fn bad_numbers_are_refused() {
        let good = slat(0.08, 0.0, 0.0);
        for period in [0.0, -0.072, f64::NAN, f64::INFINITY] {
            assert!(refusal(&good, period).contains("period"), "{period}");
        }
        assert!(refusal(&[], 1.0).contains("empty"));
        let dot = refusal(&[good[0], segment([0.01, 0.02], [0.01, 0.02], 0)], 1.0);
        assert!(dot.contains("piece 2 at z = 10 mm, y = 20 mm has no length"), "{dot}");
        assert!(refusal(&[arc([0.0, 0.0], [1.0, 0.0], 2.0 * PI, 0)], 9.0).contains("turns through 360°"));
        assert!(refusal(&[arc([0.0, 0.0], [f64::NAN, 0.0], 0.0, 0)], 9.0).contains("finite"));
    }

    #[test]
    fn pieces_that_cross_are_refused_with_the_place() {
        let cross = [
            segment([-0.01, 0.0], [0.01, 0.0], 0),
            segment([0.0, -0.01], [0.0, 0.01], 0),
        ];
        let text = refusal(&cross, 0.1);
        assert!(
            text.contains("pieces 1 and 2 cross or touch at z = 0 mm, y = 0 mm"),
            "{text}"
        );
        // An arc through a segment; an arc through an arc.
        let bow = arc([-0.01, 0.0], [0.01, 0.0], -1.0, 0);
        assert!(refusal(&[bow, segment([0.003, -0.01], [0.002, 0.02], 0)], 0.1).contains("1 and 2"));
        assert!(refusal(&[bow, arc([-0.009, 0.004], [0.009, 0.004], 1.5, 0)], 0.1).contains("1 and 2"));
        // On each other: equal, in part, and folded back at a joint.
        assert!(refusal(&[bow, bow], 0.1).contains("1 and 2"));
        let (a, b) = (
            segment([0.0, 0.0], [0.02, 0.0], 0),
            segment([0.02, 0.0], [0.01, 0.0], 0),
        );
        assert!(refusal(&[a, b], 0.1).contains("z = 10 mm"));
        // A T.
        let text = refusal(&[a, segment([0.01, 0.0], [0.01, 0.03], 0)], 0.1);
        assert!(text.contains("end both where they meet"), "{text}");
    }

    #[test]
    fn slats_that_touch_are_refused() {
        // Flat slats wider than their pitch, closed: on each other.
        let text = refusal(&slat(0.08, 0.0, FRAC_PI_2), 0.072);
        assert!(
            text.contains("piece 1 crosses or touches itself or its own copy"),
            "{text}"
        );
        sound(&slat(0.08, 0.0, 1.5), 0.072);
        // Curved ones touch before they are closed.
        assert!(refusal(&slat(0.08, 1.0, FRAC_PI_2), 0.072).contains("its own copy"));
        sound(&slat(0.08, 1.0, 0.5), 0.072);
        // Over several periods.
        sound(&slat(1.0, 0.0, 1.0), 0.01);
        assert!(refusal(&slat(1.0, 0.2, 1.52), 0.01).contains("its own copy"));
    }

    #[test]
    fn pieces_may_join() {
        let h = 0.01;
        // A pane over the whole period, a prism, a circle of two arcs, a D, arcs that join smoothly.
        sound(&[segment([0.0, 0.0], [0.0, h], 0)], h);
        sound(
            &[segment([0.0, 0.0], [h, 0.3 * h], 0), segment([h, 0.3 * h], [0.0, h], 0)],
            h,
        );
        sound(
            &[arc([-h, 0.0], [h, 0.0], PI, 0), arc([h, 0.0], [-h, 0.0], PI, 0)],
            3.0 * h,
        );
        sound(
            &[arc([-h, 0.0], [h, 0.0], 2.0, 0), segment([h, 0.0], [-h, 0.0], 0)],
            3.0 * h,
        );
        sound(
            &[
                arc([0.0, 0.0], [h, 0.0], 1.0, 0),
                arc([h, 0.0], [2.0 * h, 0.0], -1.0, 0),
            ],
            3.0 * h,
        );
        sound(
            &[
                arc([0.0, 0.0], [h, 0.0], 1.0, 0),
                arc([h, 0.0], [h * 1.5, h * 0.8], 1.0001, 0),
            ],
            3.0 * h,
        );
    }
}
