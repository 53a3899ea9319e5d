//! Whether the pieces of a section agree on what medium lies between them.

use super::soundness::{NEAR, fail, place};
use super::{Part, Profile};
use crate::error::{Error, Result};
use crate::geometry::{Geometry, Meeting, Ray, Vec3};

/// A piece as it is seen from one of its ends.
struct Spoke {
    part: usize,
    end: usize,
    /// Direction in which it leaves (radians).
    angle: f64,
    /// Medium on the right and on the left of that direction.
    media: [u16; 2],
}

/// Fails where the media between pieces do not fit: about an end, where a body is open or a piece the wrong way round; and
/// from piece to piece, where one lies inside of a body that the other does not know of.
pub(super) fn check(profile: &Profile, media: &[[u16; 2]]) -> Result<()> {
    for part in &profile.parts {
        if part.surface as usize >= media.len() {
            return Err(Error::Argument(format!(
                "profile: piece {} refers to surface {} of {} (number surfaces from 0)",
                part.piece + 1,
                part.surface,
                media.len()
            )));
        }
    }
    ends(profile, media)?;
    sights(profile, media)
}

/// About every end the medium on the left of a piece is that on the right of the next.
fn ends(profile: &Profile, media: &[[u16; 2]]) -> Result<()> {
    let period = profile.period;
    // Ends by z, in the first period.
    let mut all: Vec<([f64; 2], usize, usize)> = Vec::with_capacity(2 * profile.parts.len());
    for (k, part) in profile.parts.iter().enumerate() {
        for (end, p) in part.ends.iter().enumerate() {
            all.push(([p[0], p[1].rem_euclid(period)], k, end));
        }
    }
    all.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
    let mut seen = vec![false; all.len()];
    let widest = profile.parts.iter().map(|p| p.half).fold(0.0, f64::max);
    for i in 0..all.len() {
        if seen[i] {
            continue;
        }
        let (at, first, _) = all[i];
        let mut spokes = Vec::new();
        for (j, &(p, k, end)) in all.iter().enumerate().skip(i) {
            if p[0] - at[0] > 2.0 * NEAR * widest {
                break;
            }
            let near = NEAR * (profile.parts[first].half + profile.parts[k].half);
            let along = (p[1] - at[1]).abs();
            if !seen[j] && p[0] - at[0] <= near && along.min(period - along) <= near {
                seen[j] = true;
                spokes.push(spoke(&profile.parts[k], k, end, media));
            }
        }
        spokes.sort_by(|a, b| a.angle.total_cmp(&b.angle));
        for (k, spoke) in spokes.iter().enumerate() {
            let next = &spokes[(k + 1) % spokes.len()];
            if spoke.media[1] != next.media[0] {
                return refuse(profile, spoke, next);
            }
        }
    }
    Ok(())
}

fn spoke(part: &Part, number: usize, end: usize, media: &[[u16; 2]]) -> Spoke {
    let p = part.ends[end];
    let normal = part.normal_at([p[0] - part.middle[0], p[1] - part.middle[1]]);
    // From its first end a piece leaves along its way, from its last end against it.
    let sign = if end == 0 { 1.0 } else { -1.0 };
    let [front, back] = media[part.surface as usize];
    Spoke {
        part: number,
        end,
        // Of pieces that leave in one direction, the one that turns more to the left comes later.
        angle: (-sign * normal[0]).atan2(sign * normal[1]) + 1e-7 * sign * part.curvature * part.half,
        media: if end == 0 { [back, front] } else { [front, back] },
    }
}

fn refuse(profile: &Profile, a: &Spoke, b: &Spoke) -> Result<()> {
    let at = place(profile.parts[a.part].ends[a.end]);
    let number = |s: &Spoke| profile.parts[s.part].piece + 1;
    if a.part == b.part && a.end == b.end {
        return fail(
            &format!(
                "piece {}, between media {} and {}, ends alone at {at}",
                number(a),
                a.media[1],
                a.media[0]
            ),
            "close the body: join its pieces end to end, or with their copies a period further",
        );
    }
    fail(
        &format!(
            "pieces {} and {} join at {at}, but between them one has medium {} and the other medium {}",
            number(a),
            number(b),
            a.media[1],
            b.media[0]
        ),
        "the front is on the left of the way: swap a piece's ends, or the media of its surface",
    )
}

/// What a piece sees from its middle has the same medium on the side that faces it.
fn sights(profile: &Profile, media: &[[u16; 2]]) -> Result<()> {
    for (k, part) in profile.parts.iter().enumerate() {
        for (side, sign) in [(0, 1.0), (1, -1.0)] {
            let own = media[part.surface as usize][side];
            // A little aslant, so that it is not an end that is seen.
            let ([nz, ny], [tz, ty]) = (part.normal, part.along());
            let direction = Vec3::new(0.0, sign * ny + 0.123 * ty, sign * nz + 0.123 * tz).unit();
            let mut ray = Ray {
                origin: Vec3::new(0.0, part.middle[1], part.middle[0]),
                direction,
                piece: k as u32,
            };
            let (medium, what) = match profile.meet(&mut ray) {
                Meeting::Hit(hit) => {
                    let face = usize::from(direction.dot(hit.normal) > 0.0);
                    (
                        media[hit.surface as usize][face],
                        format!("piece {}", profile.parts[ray.piece as usize].piece + 1),
                    )
                }
                Meeting::Leaves => (0, "the space about the sample".into()),
                Meeting::Lost => continue,
            };
            if medium != own {
                return fail(
                    &format!(
                        "piece {} at {} has medium {own} {}, but {what}, which it faces, has medium {medium}",
                        part.piece + 1,
                        place(part.middle),
                        ["before its front", "behind its back"][side]
                    ),
                    "the front is on the left of the way: swap a piece's ends, or the media of its surface",
                );
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::super::testing::{arc, segment, slat};
    use super::super::{Piece, Profile};
    use crate::error::Result;
    use crate::geometry::Geometry;

    const H: f64 = 50e-6;

    fn check(pieces: &[Piece], media: &[[u16; 2]]) -> Result<()> {
        Profile::new(pieces, H).expect("sound").check_media(media)
    }

    fn refusal(pieces: &[Piece], media: &[[u16; 2]]) -> String {
        check(pieces, media).expect_err("it is not closed").to_string()
    }

    fn prism() -> [Piece; 3] {
        // Front outwards: on the left of the way up along the flat side, and down along the other.
        [
            segment([0.0, 0.0], [0.0, H], 0),
            segment([H, H], [1.5 * H, 0.5 * H], 0),
            segment([1.5 * H, 0.5 * H], [H, 0.0], 0),
        ]
    }

    #[test]
    fn closed_bodies_pass() {
        let glass = [[0, 1]];
        check(&prism(), &glass).expect("closed");
        check(&slat(0.8 * H, 0.5, 0.2), &[[0, 0]]).expect("no body");
        let bar = |z: f64, r: f64| {
            let (a, b) = ([z - r * H, 0.5 * H], [z + r * H, 0.5 * H]);
            [arc(a, b, -PI, 0), arc(b, a, -PI, 0)]
        };
        check(&bar(0.0, 0.3), &glass).expect("closed");
        // A bar in a bar, a lens on a sheet of another medium, a black plate in glass.
        let mut tube = bar(0.0, 0.3).to_vec();
        tube.extend(bar(0.0, 0.2).map(|p| Piece { surface: 1, ..p }));
        check(&tube, &[[0, 1], [1, 2]]).expect("closed");
        let lens = [
            segment([0.0, 0.0], [0.0, H], 0),
            segment([0.5 * H, H], [0.5 * H, 0.0], 1),
            arc([0.5 * H, H], [0.5 * H, 0.0], -2.0, 2),
        ];
        check(&lens, &[[0, 1], [2, 1], [0, 2]]).expect("closed");
        let mut plate = prism().to_vec();
        plate.push(segment([0.4 * H, 0.3 * H], [0.6 * H, 0.7 * H], 1));
        check(&plate, &[[0, 1], [1, 1]]).expect("closed");
    }

    #[test]
    fn open_bodies_are_refused_with_the_place() {
        let [a, b, c] = prism();
        let text = refusal(&[a, b], &[[0, 1]]);
        assert!(text.contains("piece 2, between media 0 and 1, ends alone"), "{text}");
        assert!(
            text.contains("z = 0.075 mm, y = 0.025 mm") || text.contains("z = 0.05 mm"),
            "{text}"
        );
        // Only one side of the sheet.
        assert!(refusal(&[a], &[[0, 1]]).contains("piece 1 at z = 0 mm, y = 0.025 mm has medium 1 behind its back"));
        // A gap of a thousandth.
        let gap = segment([1.5 * H, 0.5 * H], [H, 0.001 * H], 0);
        assert!(refusal(&[a, b, gap], &[[0, 1]]).contains("ends alone"));
        // The wrong way round.
        let turned = Piece {
            from: c.to,
            to: c.from,
            ..c
        };
        let text = refusal(&[a, b, turned], &[[0, 1]]);
        assert!(
            text.contains("pieces 3 and 2 join") || text.contains("pieces 2 and 3 join"),
            "{text}"
        );
        let flat = Piece {
            from: a.to,
            to: a.from,
            ..a
        };
        assert!(refusal(&[flat, b, c], &[[0, 1]]).contains("which it faces, has medium"));
        // A plate in glass that believes to be in air; a surface that is not there.
        let plate = segment([0.4 * H, 0.3 * H], [0.6 * H, 0.7 * H], 1);
        assert!(refusal(&[a, b, c, plate], &[[0, 1], [0, 0]]).contains("medium"));
        assert!(refusal(&[a, b, c, plate], &[[0, 1]]).contains("surface 1 of 1"));
    }
}
